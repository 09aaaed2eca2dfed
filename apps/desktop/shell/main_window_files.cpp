// SPDX-License-Identifier: Apache-2.0
// Opening, saving, pictures, reports.
#include <QBuffer>
#include <QComboBox>
#include <QCryptographicHash>
#include <QDateTime>
#include <QDialog>
#include <QDialogButtonBox>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QInputDialog>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMenu>
#include <QMessageBox>
#include <QPointer>
#include <QPushButton>
#include <QRegularExpressionValidator>
#include <QSaveFile>
#include <QVBoxLayout>

#include "exercise/exercise_feature.h"
#include "handpiece/base/core/file.h"
#include "panels/notation.h"
#include "panels/notice_bar.h"
#include "panels/plot_panel.h"
#include "panels/replay_bar.h"
#include "panels/tooth_chart.h"
#include "shell/error_dialog.h"
#include "shell/job_strip.h"
#include "shell/main_window.h"

namespace handpiece::desktop {
namespace {

/// Throws core::Error with the same sentences as all other files.
void writeBytes(const QString& file, const QByteArray& bytes) {
    core::writeFile(toPath(file), std::string_view(bytes.constData(), static_cast<std::size_t>(bytes.size())));
}

QString withExtension(QString file, const QString& extension) {
    if (!file.isEmpty() && QFileInfo(file).suffix().isEmpty()) file += extension;
    return file;
}

/// A folder that is no case and no attempt, or a file whose name only scans have.
bool mayBeScan(const QFileInfo& info) {
    if (info.isDir()) {
        const QDir folder(info.absoluteFilePath());
        return !folder.exists(QStringLiteral("case.toml")) && !folder.exists(QStringLiteral("attempt.toml")) &&
               !folder.isEmpty();
    }
    static const QStringList endings{QStringLiteral("nrrd"), QStringLiteral("nhdr"), QStringLiteral("nii"),
                                     QStringLiteral("mha"),  QStringLiteral("mhd"),  QStringLiteral("dcm"),
                                     QStringLiteral("zip"),  QStringLiteral("tif"),  QStringLiteral("tiff")};
    const QString name = info.fileName().toLower();
    return endings.contains(info.suffix().toLower()) || name.endsWith(QLatin1String(".nii.gz")) ||
           name == QLatin1String("dicomdir") || name == QLatin1String("scan.toml");
}

}  // namespace

void MainWindow::connectFiles() {
    const Actions& a = *actions_;
    const auto on = [this, &a](const char* name, auto f) { connect(a[name], &QAction::triggered, this, f); };
    on("actionOpenCase", [this] {
        openFile(questions.fileToOpen(tr("Open case"), startFolder(),
                                      tr("Cases and attempts (*.handpiece case.toml attempt.toml);;All files (*)")));
    });
    on("actionOpenStl", [this] {
        openFile(
            questions.fileToOpen(tr("Open STL"), startFolder(), tr("Surfaces (*.stl *.ply *.obj);;All files (*)")));
    });
    on("actionNewScan", [this] {
        if (newCaseFromScan) newCaseFromScan({});
    });
    on("actionOpenSession", [this] {
        openFile(questions.fileToOpen(tr("Open recording"), toQString(Folders::standard().sessions),
                                      tr("Recordings (*.h5);;All files (*)")));
    });
    on("actionChooseTooth", [this] { chooseTooth(); });
    on("actionResume", [this] { resumeLast(); });
    on("actionRecover", [this] { chooseRecovery(); });
    on("actionCode", [this] { editCode(); });
    on("actionSave", [this] { save(false); });
    on("actionSaveAs", [this] { save(true); });
    exercise_->questions.fileToHandIn = [this](const QString& name) {
        return withExtension(
            questions.fileToSave(tr("Hand in"), QDir(startFolder()).filePath(name + QStringLiteral(".handpiece")),
                                 tr("Attempt with its tooth (*.handpiece)")),
            QStringLiteral(".handpiece"));
    };
    connect(exercise_, &ExerciseFeature::codeChanged, this, &MainWindow::showCode);
    on("actionExportStl", [this] {
        const QString file = withExtension(
            questions.fileToSave(tr("Export STL"), QDir(startFolder()).filePath(QStringLiteral("tooth.stl")),
                                 tr("STL (*.stl)")),
            QStringLiteral(".stl"));
        if (!file.isEmpty()) simulator_.exportStl(toPath(file));
    });
    on("actionExportTissues", [this] {
        const QString folder = questions.fileToSave(tr("Folder for the tissues"),
                                                    QDir(startFolder()).filePath(QStringLiteral("tissues")), QString());
        if (!folder.isEmpty()) simulator_.exportTissues(toPath(folder));
    });
    on("actionPicture", [this] { writePicture(); });
    on("actionReport", [this] { writeReport(); });
    on("actionKeepRecording", [this] { keepRecording(); });
    on("actionReplay", [this] { simulator_.replayThis(); });
    on("actionQuit", [this] { close(); });
    on("actionAbout", [this] { showAbout(); });
    connect(recent_, &QMenu::aboutToShow, this, &MainWindow::showRecent);
    showRecent();
    connect(resolution_, &QComboBox::activated, this, [this](int index) {
        const auto kind =
            simulator_.document().starter ? simulator_.document().starter->kind : starter::ToothKind::lowerFirstMolar;
        if (index > 0) openStarter({kind, static_cast<std::size_t>(resolution_->itemData(index).toULongLong())});
    });

    connect(&simulator_, &Simulator::failed, this, &MainWindow::showProblem);
    connect(&simulator_, &Simulator::noticed, this,
            [this](const QString& id, const QStringList& arguments) { tell(id, arguments); });
    connect(&simulator_, &Simulator::jobStarted, this, [this](const QString& title) {
        job_->begin(title);
        view_->setWaiting(title + QStringLiteral(" ..."));
        showTick();
    });
    connect(&simulator_, &Simulator::jobStepped, job_, &JobStrip::setStep);
    connect(&simulator_, &Simulator::sketched, this,
            [this](const std::shared_ptr<const cases::Case>& sketch) { view_->showSketch(*sketch); });
    connect(&simulator_, &Simulator::jobProgressed, job_, &JobStrip::setFraction);
    connect(&simulator_, &Simulator::jobEnded, this, [this] {
        job_->end();
        view_->setWaiting({});
        if (view_->hasSketch()) view_->clearTooth();  // nothing came of it, or the tooth itself comes now
        showTick();
    });
    connect(job_, &JobStrip::cancelRequested, &simulator_, &Simulator::cancelJob);
    connect(&simulator_, &Simulator::saved, this, [this](const QString& file) {
        if (file.endsWith(QLatin1String(".handpiece")) || QFileInfo(file).isDir()) {
            settings_.set(QStringLiteral("files/lastAttempt"), file);
            settings_.addRecent(file);
            settings_.sync();
        }
        settings_.set(QStringLiteral("files/folder"), QFileInfo(file).absolutePath());
        tellSaved(file);
        showTitle();
    });
    connect(notices_, &NoticeBar::remedyChosen, this, [this](const QString& id) {
        if (id == QLatin1String("case-vanished")) save(true);
        if (id == QLatin1String("crashed") && !crashed_.empty())
            ifFree([this] { simulator_.recover(crashed_.front()); });
    });
}

QString MainWindow::startFolder() const {
    // The folder of last time may be gone: a stick that was pulled out.
    const QString last = settings_.value(QStringLiteral("files/folder")).toString();
    return !last.isEmpty() && QFileInfo(last).isDir() ? last : workFolder();
}

/// Asks about unsaved work; runs `then` unless that was cancelled.
void MainWindow::ifFree(std::function<void()> then) {
    if (simulator_.isBusy()) {
        // Cancelled work takes its time to end. What is unsaved is known afterwards; a new window has its own wishes.
        simulator_.cancelJob();
        simulator_.whenFree([self = QPointer<MainWindow>(this), then = std::move(then)]() mutable {
            if (self) self->ifFree(std::move(then));
        });
        return;
    }
    const bool behind = simulator_.isUnsavedBehindReplay();
    if (!simulator_.isUnsaved() && !behind) {
        then();
        return;
    }
    switch (questions.unsaved()) {
        case Questions::Unsaved::save:
            if (behind) {
                simulator_.closeReplay([this, then = std::move(then)] { save(false, then); });
            } else {
                save(false, std::move(then));
            }
            break;
        case Questions::Unsaved::discard:
            if (behind) simulator_.giveUpBehindReplay();
            then();
            break;
        case Questions::Unsaved::cancel:
            break;
    }
}

void MainWindow::openFile(const QString& file) {
    if (file.isEmpty()) return;
    QFileInfo info(file);
    if (newCaseFromScan && mayBeScan(info)) {
        newCaseFromScan(info.absoluteFilePath());
        return;
    }
    // case.toml and attempt.toml stand for their folders.
    const QString path = info.suffix() == QLatin1String("toml") ? info.absolutePath() : info.absoluteFilePath();
    ifFree([this, path] {
        settings_.set(QStringLiteral("files/folder"), QFileInfo(path).absolutePath());
        lastOpened_ = path;
        exercise_->open(toPath(path));
    });
}

void MainWindow::openStarter(const Starter& starter) {
    ifFree([this, starter] { simulator_.openStarter(starter); });
}

void MainWindow::resumeLast() {
    const QString file = settings_.value(QStringLiteral("files/lastAttempt")).toString();
    if (file.isEmpty()) {
        showProblem(problemById(QStringLiteral("no-attempt")));
        return;
    }
    ifFree([this, file] { simulator_.open(toPath(file)); });
}

QString MainWindow::titleOf(const SessionNote& note) {
    if (note.attemptFile.isEmpty())
        for (const starter::ToothKindInfo& info : starter::toothKinds())
            if (note.starter == QLatin1String(info.name.data(), static_cast<qsizetype>(info.name.size())))
                return toothName(info.fdiNumber);
    return note.title;
}

void MainWindow::chooseRecovery() {
    crashed_ = simulator_.crashed();
    auto* dialog = new QDialog(this);
    dialog->setObjectName(QStringLiteral("recoverDialog"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Work that ended without saving"));
    auto* column = new QVBoxLayout(dialog);
    auto* text = new QLabel(crashed_.empty() ? tr("There is none: everything was saved or given up.")
                                             : tr("Choose what to bring back:"));
    column->addWidget(text);
    auto* list = new QListWidget;
    list->setObjectName(QStringLiteral("recoverList"));
    list->setAccessibleName(tr("Work that ended without saving"));
    list->setToolTip(tr("The newest first"));
    for (const Crashed& crashed : crashed_)
        list->addItem(tr("%1, %2").arg(
            titleOf(crashed.note),
            QLocale().toString(QFileInfo(toQString(crashed.session)).lastModified(), QLocale::ShortFormat)));
    list->setCurrentRow(0);
    list->setVisible(!crashed_.empty());
    column->addWidget(list);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    auto* back = buttons->addButton(tr("Bring it back"), QDialogButtonBox::AcceptRole);
    back->setObjectName(QStringLiteral("recoverBack"));
    back->setToolTip(tr("Open the tooth as it was when the program ended"));
    auto* forget = buttons->addButton(tr("Give it up"), QDialogButtonBox::DestructiveRole);
    forget->setObjectName(QStringLiteral("recoverForget"));
    forget->setToolTip(tr("It is not offered again; its recording stays for a while"));
    for (QPushButton* button : {back, forget})
        button->setEnabled(!crashed_.empty());
    column->addWidget(buttons);
    const auto chosen = [this, list]() -> std::optional<Crashed> {
        const auto row = static_cast<std::size_t>(list->currentRow());
        return row < crashed_.size() ? std::optional(crashed_[row]) : std::nullopt;
    };
    connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, dialog, [this, dialog, chosen] {
        const std::optional<Crashed> one = chosen();
        dialog->accept();
        notices_->remove(QStringLiteral("crashed"));
        if (one) ifFree([this, one] { simulator_.recover(*one); });
    });
    connect(forget, &QPushButton::clicked, dialog, [this, list, chosen, back, forget] {
        const std::optional<Crashed> one = chosen();
        if (!one) return;
        simulator_.forget(*one);
        crashed_.erase(crashed_.begin() + list->currentRow());
        delete list->takeItem(list->currentRow());
        notices_->remove(QStringLiteral("crashed"));
        for (QPushButton* button : {back, forget})
            button->setEnabled(!crashed_.empty());
    });
    dialog->open();
}

void MainWindow::editCode() {
    auto* dialog = new QInputDialog(this);
    dialog->setObjectName(QStringLiteral("codeDialog"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Your code"));
    dialog->setLabelText(tr("Code (given by your teacher). No name: recordings and saved attempts carry it."));
    dialog->setTextValue(simulator_.code());
    if (auto* line = dialog->findChild<QLineEdit*>())
        line->setValidator(
            new QRegularExpressionValidator(QRegularExpression(QStringLiteral("[A-Za-z0-9_-]{0,32}")), line));
    connect(dialog, &QInputDialog::textValueSelected, this, [this](const QString& text) {
        simulator_.setCode(text);
        settings_.set(QStringLiteral("work/code"), simulator_.code());
        showCode();
    });
    dialog->open();
}

void MainWindow::showCode() {
    code_->setText(simulator_.code().isEmpty() ? QString() : tr("Code: %1").arg(simulator_.code()));
    code_->setVisible(!simulator_.code().isEmpty());
}

void MainWindow::showRecent() {
    recent_->clear();
    int number = 0;
    for (const QString& file : settings_.recentFiles()) {
        QAction* action = recent_->addAction(QDir::toNativeSeparators(file));
        action->setObjectName(QStringLiteral("actionRecent_%1").arg(++number));
        action->setToolTip(tr("Open it again"));
        connect(action, &QAction::triggered, this, [this, file] { openFile(file); });
    }
    recent_->menuAction()->setEnabled(number > 0);
}

void MainWindow::save(bool underNewName, std::function<void()> then) {
    const std::filesystem::path& known = simulator_.document().attemptFile;
    std::error_code error;
    QString file = toQString(known);
    if (underNewName || known.empty()) {
        const QString name = QString::fromStdString(simulator_.document().name);
        file =
            withExtension(questions.fileToSave(
                              tr("Save the attempt"),
                              known.empty() ? QDir(startFolder()).filePath(name + QStringLiteral(".handpiece")) : file,
                              tr("Attempt with its tooth (*.handpiece)")),
                          QStringLiteral(".handpiece"));
    }
    if (!file.isEmpty()) simulator_.saveAs(toPath(file), std::move(then));
}

void MainWindow::writePicture() {
    const QString time = QDateTime::currentDateTime().toString(QStringLiteral("yyyyMMdd-HHmmss"));
    const QImage image = view_->snapshot();
    const QString file =
        withExtension(questions.fileToSave(tr("Keep the picture"),
                                           QDir(startFolder()).filePath(QStringLiteral("tooth-%1.png").arg(time)),
                                           tr("Picture (*.png)")),
                      QStringLiteral(".png"));
    if (file.isEmpty()) return;
    QSaveFile out(file);
    if (!out.open(QIODevice::WriteOnly) || !image.save(&out, "PNG") || !out.commit()) {
        showProblem(problemById(QStringLiteral("not-writable"), {out.errorString()}, file));
        return;
    }
    tellSaved(file);
}

void MainWindow::writeReport() {
    const QString file = withExtension(
        questions.fileToSave(tr("Write the report"), QDir(startFolder()).filePath(QStringLiteral("report.html")),
                             tr("Page to print (*.html)")),
        QStringLiteral(".html"));
    if (!file.isEmpty()) simulator_.writeReport(toPath(file));
}

void MainWindow::keepRecording() {
    if (simulator_.recording().empty()) {
        showProblem(problemById(QStringLiteral("no-recording")));
        return;
    }
    const QString name = toQString(simulator_.recording().filename());
    const QString file = withExtension(
        questions.fileToSave(tr("Keep the recording"), QDir(startFolder()).filePath(name), tr("Recording (*.h5)")),
        QStringLiteral(".h5"));
    if (!file.isEmpty()) simulator_.copyRecording(toPath(file));
}

void MainWindow::savePlot(const QString& format) {
    const QString file = withExtension(
        questions.fileToSave(tr("Save the plots"), QDir(startFolder()).filePath(QStringLiteral("plots.") + format),
                             QStringLiteral("%1 (*.%1)").arg(format)),
        QLatin1Char('.') + format);
    if (file.isEmpty()) return;
    try {
        if (format == QLatin1String("png")) {
            QByteArray bytes;
            QBuffer buffer(&bytes);
            buffer.open(QIODevice::WriteOnly);
            plots_->picture().save(&buffer, "PNG");
            writeBytes(file, bytes);
        } else {
            writeBytes(file, format == QLatin1String("svg") ? plots_->svg() : plots_->csv());
        }
        tellSaved(file);
    } catch (const core::Error& error) {
        showProblem(problemOf(error));
    }
}

void MainWindow::chooseTooth() {
    auto* dialog = new QDialog(this);
    dialog->setObjectName(QStringLiteral("toothDialog"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Choose a tooth"));
    auto* column = new QVBoxLayout(dialog);
    auto* row = new QHBoxLayout;
    auto* notation = new QComboBox;
    notation->setObjectName(QStringLiteral("notationBox"));
    notation->setAccessibleName(tr("Notation"));
    notation->setToolTip(tr("How teeth are numbered"));
    notation->addItems({tr("FDI (ISO 3950)"), tr("Universal"), tr("Palmer")});
    notation->setCurrentIndex(static_cast<int>(settings_.number(QStringLiteral("window/notation"), 0.0, 0.0, 2.0)));
    row->addWidget(new QLabel(tr("Notation")));
    row->addWidget(notation);
    row->addStretch();
    column->addLayout(row);
    auto* chart = new ToothChart;
    chart->setNotation(static_cast<Notation>(notation->currentIndex()));
    std::set<int> available;
    for (const starter::ToothKindInfo& info : starter::toothKinds())
        available.insert(info.fdiNumber);
    chart->setAvailable(available);
    if (simulator_.toothCase()) chart->setChosen(simulator_.toothCase()->fdiNumber);
    column->addWidget(chart, 1);
    auto* note = new QLabel(tr("The teeth in full colour come with the program. Others are opened as cases."));
    note->setWordWrap(true);
    column->addWidget(note);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    connect(notation, &QComboBox::activated, dialog, [this, chart](int index) {
        chart->setNotation(static_cast<Notation>(index));
        settings_.set(QStringLiteral("window/notation"), index);
    });
    connect(chart, &ToothChart::toothChosen, dialog, [this, dialog](int fdi) {
        for (const starter::ToothKindInfo& info : starter::toothKinds()) {
            if (info.fdiNumber != fdi) continue;
            dialog->accept();
            openStarter(
                {info.kind, simulator_.document().starter ? simulator_.document().starter->faces : Starter{}.faces});
        }
    });
    dialog->open();
    chart->setFocus();
}

void MainWindow::showAbout() {
    QMessageBox box(this);
    box.setObjectName(QStringLiteral("aboutDialog"));
    box.setWindowTitle(tr("About Handpiece"));
    box.setIconPixmap(windowIcon().pixmap(64));
    box.setTextFormat(Qt::RichText);
    box.setText(tr("<h3>Handpiece %1</h3><p>An open dental surgery simulator: touch a tooth and drill it.</p>")
                    .arg(QStringLiteral(HANDPIECE_VERSION)));
    box.setInformativeText(
        tr("<p>Licensed under the Apache License 2.0. For teaching; no medical device.</p>"
           "<p>It stands on: Qt %1 (LGPL 3), OpenAL Soft (LGPL 2), Mesa (MIT), Eigen (MPL 2), fmt (MIT), oneTBB "
           "(Apache 2.0), "
           "Qhull (Qhull licence), HDF5 (BSD), libzip (BSD), zlib (zlib), libpng (libpng), toml++ (MIT), "
           "nlohmann-json (MIT), CLI11 (BSD).</p><p>Draws with: %2</p><p>Sound: %3</p>")
            .arg(QLatin1String(qVersion()),
                 view_->rendererDescription().isEmpty() ? tr("nothing yet")
                                                        : view_->rendererDescription().toHtmlEscaped(),
                 QString::fromStdString(simulator_.soundStatus().device).toHtmlEscaped()));
    if (auto* informative = box.findChild<QLabel*>(QStringLiteral("qt_msgbox_informativelabel")))
        informative->setTextFormat(Qt::RichText);
    box.exec();
}

}  // namespace handpiece::desktop
