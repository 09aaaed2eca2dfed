// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/files/files_feature.h"

#include <QDateTime>
#include <QDir>
#include <QFileInfo>
#include <QLocale>
#include <QMenu>
#include <QMessageBox>
#include <QPointer>
#include <QPushButton>
#include <QSaveFile>
#include <QStatusBar>
#include <mutex>

#include "desktop/features/files/mend_dialog.h"
#include "desktop/framework/job_strip.h"
#include "desktop/framework/mnemonics.h"
#include "desktop/widgets/notation.h"
#include "desktop/widgets/status_line.h"
#include "desktop/work/simulator.h"
#include "desktop/work/this_language.h"
#include "handpiece/app/scan_case/textures.h"
#include "handpiece/base/geometry/read_notes.h"

namespace handpiece::desktop {
namespace {

using exercise::Operation;

using Command = FilesFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::openCase, "actionOpenCase", QT_TRANSLATE_NOOP("Commands", "Open case..."),
     QT_TRANSLATE_NOOP("Commands", "Open a case, or an attempt that was saved"), "open", "Ctrl+O", in(Shelf::file, 0),
     in(Shelf::fileBar, 0), brief(QT_TRANSLATE_NOOP("Commands", "Open")), exercise::Operation::elsewhere},
    {Command::openStl, "actionOpenStl", QT_TRANSLATE_NOOP("Commands", "Open STL..."),
     QT_TRANSLATE_NOOP("Commands", "Open one closed surface as a tooth of enamel"), "file", "Ctrl+Shift+O",
     in(Shelf::file, 1), exercise::Operation::elsewhere},
    {Command::resume, "actionResume", QT_TRANSLATE_NOOP("Commands", "Resume last attempt"),
     QT_TRANSLATE_NOOP("Commands", "Go on with the tooth that was saved last"), "recent", "Ctrl+L", in(Shelf::file, 6),
     in(Shelf::fileBar, 3), brief(QT_TRANSLATE_NOOP("Commands", "Resume")), exercise::Operation::elsewhere},
    {Command::save, "actionSave", QT_TRANSLATE_NOOP("Commands", "Save"),
     QT_TRANSLATE_NOOP("Commands", "Save what was cut"), "save", "Ctrl+S", in(Shelf::file, 10), in(Shelf::fileBar, 4),
     onCard(4), exercise::Operation::elsewhere},
    {Command::saveAs, "actionSaveAs", QT_TRANSLATE_NOOP("Commands", "Save as..."),
     QT_TRANSLATE_NOOP("Commands", "Save what was cut under another name"), "save-as", "Ctrl+Shift+S",
     in(Shelf::file, 11), in(Shelf::fileBar, 5), exercise::Operation::elsewhere},
    {Command::stl, "actionExportStl", QT_TRANSLATE_NOOP("Commands", "Export STL..."),
     QT_TRANSLATE_NOOP("Commands", "Write what is left of the tooth as one closed STL surface"), "file", "Ctrl+E",
     in(Shelf::file, 13), exercise::Operation::elsewhere},
    {Command::tissues, "actionExportTissues", QT_TRANSLATE_NOOP("Commands", "Export tissues..."),
     QT_TRANSLATE_NOOP("Commands", "Write what is left of each tissue as a closed STL surface of its own"), "file",
     "Ctrl+Shift+E", in(Shelf::file, 14), exercise::Operation::elsewhere},
    {Command::picture, "actionPicture", QT_TRANSLATE_NOOP("Commands", "Picture..."),
     QT_TRANSLATE_NOOP("Commands", "Keep what is seen as a PNG file"), "picture", "Ctrl+P", in(Shelf::file, 30),
     in(Shelf::toolBar, 42), onCard(5), exercise::Operation::elsewhere},
    {Command::report, "actionReport", QT_TRANSLATE_NOOP("Commands", "Report..."),
     QT_TRANSLATE_NOOP("Commands", "Write a page to print: before and after, volumes, times, forces"), "report",
     "Ctrl+R", in(Shelf::file, 31), Operation::report},
    {Command::quit, "actionQuit", QT_TRANSLATE_NOOP("Commands", "Quit"),
     QT_TRANSLATE_NOOP("Commands", "Close the program"), "exit", "Ctrl+Q", in(Shelf::file, 40)},
};

}  // namespace

FilesFeature::FilesFeature(const FeatureContext& context)
    : Feature(context),
      commands_(window_.commands(), kCommands),
      recent_(withMnemonics(new QMenu(tr("Open recent"), window_.shelves().menu(Shelf::file)))) {
    recent_->setObjectName(QStringLiteral("menuRecent"));
    window_.commands().place(in(Shelf::file, 5), recent_->menuAction());
    connect(recent_, &QMenu::aboutToShow, this, &FilesFeature::listRecent);
    listRecent();
    window_.questions.unsaved = [this] { return askUnsaved(); };
    window_.whenMayLeave = [this](std::function<void()> then) { leave(std::move(then)); };
    window_.closeWork = [this] { simulator_.close(); };
    window_.whenRead = [this](const QString& path, std::function<void()> then) {
        // Another window may be there by then.
        simulator_.readApart(toPath(path), [self = QPointer<FilesFeature>(this), then = std::move(then)] {
            if (self) then();
        });
    };
    connect(&window_, &MainWindow::problemShown, this, &FilesFeature::offerToMend);
    window_.openers.push_back([this](const QString& path) {
        lastOpened_ = path;
        // Of another file; showDocument() comes after this one has told.
        window_.notices().remove(Notice::fileLeftOut);
        simulator_.open(toPath(path));
        return true;
    });
    connectCommands();
    enableCommands();
    connectJobs();
    connectMessages();
}

void FilesFeature::showDocument() {
    // What was told of the tooth before.
    window_.notices().takeBack(End::toothOpened);
    if (!simulator_.recording().empty()) window_.notices().takeBack(End::recorded);
    showTitle();
}

void FilesFeature::connectCommands() {
    const Questions& questions = window_.questions;
    on(commands_[Command::openCase], [this, &questions] {
        window_.openFile(questions.open(tr("Open case"),
                                        tr("Cases and attempts (*.handpiece case.toml attempt.toml);;All files (*)")));
    });
    on(commands_[Command::openStl], [this, &questions] {
        window_.openFile(questions.open(tr("Open STL"), tr("Surfaces (*.stl *.ply *.obj);;All files (*)")));
    });
    on(commands_[Command::resume], [this] { resumeLast(); });
    on(commands_[Command::save], [this] { save(false); });
    on(commands_[Command::saveAs], [this] { save(true); });
    on(commands_[Command::stl], [this, &questions] {
        const QString file =
            questions.save(tr("Export STL"), QStringLiteral("tooth.stl"), tr("STL (*.stl)"), QStringLiteral(".stl"));
        if (!file.isEmpty()) simulator_.exportStl(toPath(file));
    });
    on(commands_[Command::tissues], [this, &questions] {
        const QString folder = questions.save(tr("Folder for the tissues"), QStringLiteral("tissues"), {}, {});
        if (!folder.isEmpty()) simulator_.exportTissues(toPath(folder));
    });
    on(commands_[Command::picture], [this] { writePicture(); });
    on(commands_[Command::report], [this, &questions] {
        const QString file = questions.save(tr("Write the report"), QStringLiteral("report.html"),
                                            tr("Page to print (*.html)"), QStringLiteral(".html"));
        if (!file.isEmpty()) simulator_.writeReport(toPath(file));
    });
    on(commands_[Command::quit], [this] { window_.close(); });
}

void FilesFeature::enableCommands() {
    using Mode = Simulator::Mode;
    const auto enable = [this](std::initializer_list<Command> commands, const std::function<bool()>& can) {
        for (const Command command : commands)
            window_.commands().enableWhile(commands_[command], can);
    };
    enable({Command::openCase, Command::openStl, Command::resume}, [this] { return !simulator_.isBusy(); });
    enable({Command::save, Command::saveAs},
           [this] { return !simulator_.isBusy() && simulator_.mode() == Mode::liveSession; });
    enable({Command::stl, Command::tissues, Command::picture}, [this] { return simulator_.mode() != Mode::empty; });
    enable({Command::report}, [this] {
        return !simulator_.isBusy() && simulator_.mode() != Mode::empty && simulator_.mode() != Mode::review;
    });
}

void FilesFeature::connectJobs() {
    JobStrip& job = window_.job();
    connect(&simulator_, &Simulator::jobStarted, this, [this, &job](const QString& title) {
        job.begin(title);
        prepared_ = 0.0;
        view_.setWaiting(title + QStringLiteral(" ..."));
    });
    connect(&simulator_, &Simulator::jobStepped, &job, &JobStrip::setStep);
    connect(&simulator_, &Simulator::sketched, this, [this](const std::shared_ptr<const cases::Case>& sketch) {
        simulator_.touch() ? showTouch(sketch) : view_.showSketch(*sketch);
    });
    connect(&simulator_, &Simulator::touchBegan, this, [this] { showTouch(simulator_.touch()->of->toothCase); });
    connect(&simulator_, &Simulator::jobProgressed, &job, &JobStrip::setFraction);
    connect(&simulator_, &Simulator::jobProgressed, this, [this](double fraction) { prepared_ = fraction; });
    connect(&view_, &ViewWidget::pressedChanged, this, [this](bool pressed) {
        if (pressed && simulator_.touch())
            window_.notices().tell(Notice::onlyTouch, {QString::number(static_cast<int>(100.0 * prepared_))});
    });
    connect(&simulator_, &Simulator::jobEnded, this, [this, &job] {
        job.end();
        view_.setWaiting({});
        window_.notices().remove(Notice::onlyTouch);
        // Nothing came of it, or the tooth itself comes now.
        if (simulator_.touch()) view_.keepEye();
        if (view_.hasSketch() || simulator_.touch()) view_.clearTooth();
    });
    connect(&job, &JobStrip::cancelRequested, &simulator_, &Simulator::cancelJob);
    window_.statusFields.push_back(
        [this](StatusFigures& figures) { figures.busy = simulator_.status().restoring || simulator_.isBusy(); });
}

/// The tooth that can be touched, in what is known of its surroundings.
void FilesFeature::showTouch(const std::shared_ptr<const cases::Case>& surroundings) {
    const Simulator::Touch& touch = *simulator_.touch();
    if (view_.hasTooth()) view_.keepEye();
    view_.setTooth(touch.of->liveTooth, surroundings, touch.feed);
    view_.setPointer(touch.mailbox, touch.startPose);
    if (simulator_.bur()) view_.setBur(simulator_.bur());
    // What the hints say cannot be done yet.
    cases::Exercise withoutHints;
    withoutHints.lockedHelps = {"guide"};
    view_.setPermissions(exercise::permissionsOf(&withoutHints, exercise::WorkMode::work));
}

struct FilesFeature::Ear {
    std::mutex mutex;
    FilesFeature* of;
};

FilesFeature::~FilesFeature() {
    const std::lock_guard lock(ear_->mutex);
    ear_->of = nullptr;
}

void FilesFeature::hearOfFiles() {
    scan_case::readTextures();
    ear_ = std::make_shared<Ear>();
    ear_->of = this;
    geometry::listenToNotes([ear = ear_](const std::string& where, const std::string& note) {
        const std::lock_guard lock(ear->mutex);
        if (ear->of == nullptr) return;
        const QString file =
            QFileInfo(QString::fromLocal8Bit(where.data(), static_cast<qsizetype>(where.size()))).fileName();
        QMetaObject::invokeMethod(
            ear->of,
            [of = ear->of, file, what = QString::fromStdString(note)] {
                of->window_.notices().tell(Notice::fileLeftOut, {file, what});
            },
            Qt::QueuedConnection);
    });
}

void FilesFeature::connectMessages() {
    hearOfFiles();
    connect(&simulator_, &Simulator::failed, &window_, &MainWindow::showProblem);
    connect(&simulator_, &Simulator::saved, this, &FilesFeature::takeSaved);
    connect(&simulator_, &Simulator::unsavedChanged, this, &FilesFeature::showTitle);
    connect(&simulator_, &Simulator::noticed, this, [this](const QString& id, const QStringList& arguments) {
        if (const auto notice = noticeOf(id)) {
            window_.notices().tell(*notice, arguments);
        } else {
            window_.statusBar()->showMessage((QStringList{id} + arguments).join(QStringLiteral(", ")));
        }
    });
    connect(&window_.notices(), &Notices::remedyChosen, this, [this](Notice notice) {
        if (notice == Notice::caseVanished) save(true);
    });
}

/// Asks about unsaved work; runs `then` unless that was cancelled.
void FilesFeature::leave(std::function<void()> then) {
    if (simulator_.isBusy()) {
        // Cancelled work takes its time to end. What is unsaved is known afterwards; a new window has its own wishes.
        simulator_.cancelJob();
        simulator_.whenFree([self = QPointer<FilesFeature>(this), then = std::move(then)]() mutable {
            if (self) self->leave(std::move(then));
        });
        return;
    }
    const bool behind = simulator_.isUnsavedBehindReplay();
    if (!simulator_.isUnsaved() && !behind) {
        then();
        return;
    }
    switch (window_.questions.unsaved()) {
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

Questions::Unsaved FilesFeature::askUnsaved() {
    QMessageBox box(QMessageBox::Question, tr("Save what was cut?"), tr("The tooth has been cut since it was saved."),
                    QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, &window_);
    box.setObjectName(QStringLiteral("unsavedDialog"));
    box.setInformativeText(tr("Without saving, it can only be watched in the recording, not cut on."));
    box.setDefaultButton(QMessageBox::Save);
    const int answer = box.exec();
    return answer == QMessageBox::Save      ? Questions::Unsaved::save
           : answer == QMessageBox::Discard ? Questions::Unsaved::discard
                                            : Questions::Unsaved::cancel;
}

void FilesFeature::resumeLast() {
    const QString file = settings_.value(QStringLiteral("files/lastAttempt")).toString();
    if (file.isEmpty()) {
        window_.showProblem(problemById(QStringLiteral("no-attempt")));
        return;
    }
    leave([this, file] {
        window_.notices().remove(Notice::fileLeftOut);
        simulator_.open(toPath(file));
    });
}

void FilesFeature::save(bool underNewName, std::function<void()> then) {
    const std::filesystem::path& known = simulator_.document().attemptFile;
    QString file = toQString(known);
    if (underNewName || known.empty()) {
        const QString name = QString::fromStdString(simulator_.document().name) + QStringLiteral(".handpiece");
        file = window_.questions.save(tr("Save the attempt"), known.empty() ? name : file,
                                      tr("Attempt with its tooth (*.handpiece)"), QStringLiteral(".handpiece"));
    }
    if (!file.isEmpty()) simulator_.saveAs(toPath(file), std::move(then));
}

void FilesFeature::takeSaved(const QString& file) {
    if (file.endsWith(QLatin1String(".handpiece")) || QFileInfo(file).isDir()) {
        settings_.set(QStringLiteral("files/lastAttempt"), file);
        settings_.addRecent(file);
        settings_.sync();
    }
    settings_.set(QStringLiteral("files/folder"), QFileInfo(file).absolutePath());
    window_.tellSaved(file);
    showTitle();
}

void FilesFeature::writePicture() {
    const QString time = QDateTime::currentDateTime().toString(QStringLiteral("yyyyMMdd-HHmmss"));
    const QImage image = view_.snapshot();
    const QString file = window_.questions.save(tr("Keep the picture"), QStringLiteral("tooth-%1.png").arg(time),
                                                tr("Picture (*.png)"), QStringLiteral(".png"));
    if (file.isEmpty()) return;
    QSaveFile out(file);
    if (!out.open(QIODevice::WriteOnly) || !image.save(&out, "PNG") || !out.commit()) {
        window_.showProblem(problemById(QStringLiteral("not-writable"), {out.errorString()}, file));
        return;
    }
    window_.tellSaved(file);
}

void FilesFeature::listRecent() {
    recent_->clear();
    int number = 0;
    for (const QString& file : settings_.recentFiles()) {
        QAction* action = recent_->addAction(menuText(QDir::toNativeSeparators(file)));
        action->setObjectName(QStringLiteral("actionRecent_%1").arg(++number));
        action->setToolTip(tr("Open it again"));
        connect(action, &QAction::triggered, this, [this, file] { window_.openFile(file); });
    }
    recent_->menuAction()->setEnabled(number > 0);
}

/// Empty where what is open is none.
QString FilesFeature::exerciseTitle() const {
    const auto& open = simulator_.toothCase();
    return open && open->exercise ? inThisLanguage(open->exercise->title) : QString();
}

/// Of which tooth and when, where the program named the file by its time; a name that a person gave, or a code that
/// hides whose it is, stays. Empty: such a name.
QString FilesFeature::recordingTitle() const {
    const QFileInfo file(toQString(simulator_.document().caseFile));
    const QDateTime when = QDateTime::fromString(file.baseName().left(15), QStringLiteral("yyyyMMdd-HHmmss"));
    if (!when.isValid()) return {};
    QString tooth = toothName(simulator_.toothCase()->fdiNumber);
    if (const QString exercise = exerciseTitle(); !exercise.isEmpty()) tooth = exercise;
    if (tooth.isEmpty()) tooth = QString::fromStdString(simulator_.toothCase()->name);  // a block
    return tr("Recording of %1, %2").arg(tooth, QLocale().toString(when, QLocale::ShortFormat));
}

void FilesFeature::showTitle() {
    const Document& document = simulator_.document();
    QString name = QString::fromStdString(document.name);
    if (simulator_.mode() == Simulator::Mode::replay && simulator_.toothCase() &&
        document.caseFile.filename() == document.name) {
        if (const QString told = recordingTitle(); !told.isEmpty()) name = told;
    }
    // An exercise is known by its title, until it is saved under a name of the student's own; its file by the tooth's.
    if (const QString exercise = exerciseTitle(); simulator_.task() && simulator_.mode() != Simulator::Mode::replay &&
                                                  document.attemptFile.empty() && !exercise.isEmpty())
        name = exercise;
    // A starter tooth has a name in every language until it is saved under one of the student's own.
    if (document.starter && document.attemptFile.empty() && simulator_.toothCase())
        name = toothName(simulator_.toothCase()->fdiNumber);
    window_.setWindowTitle(name.isEmpty() ? QStringLiteral("Handpiece")
                                          : QStringLiteral("%1[*] - Handpiece").arg(name));
    window_.setWindowModified(simulator_.isUnsaved());
}

void FilesFeature::offerToMend(ErrorDialog* dialog) {
    if (canMend(dialog->problem().id, toPath(lastOpened_)))
        connect(
            dialog->addRemedy("errorMend", tr("Mend..."), tr("Close holes and turn faces; nothing is written unasked")),
            &QPushButton::clicked, this, &FilesFeature::mend);
}

void FilesFeature::mend() {
    const QString file = lastOpened_;
    auto* dialog = new MendDialog(toPath(file), &window_);
    connect(dialog, &MendDialog::saveRequested, this, [this, dialog, file] {
        const QFileInfo info(file);
        QString start = info.dir().filePath(tr("%1-mended.stl").arg(info.completeBaseName()));
        if (dialog->hasColours() && start.endsWith(QStringLiteral(".stl"))) start.replace(start.size() - 3, 3, "ply");
        const QString to =
            window_.questions.fileToSave(tr("Save the mended surface"), start, tr("Surfaces (*.stl *.ply)"));
        if (to.isEmpty()) return;
        try {
            dialog->save(toPath(to));
        } catch (const core::Error& error) {
            window_.showProblem(problemOf(error));
            return;
        }
        dialog->accept();
        window_.openFile(to);
    });
    dialog->open();
}

}  // namespace handpiece::desktop
