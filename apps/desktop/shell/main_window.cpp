// SPDX-License-Identifier: Apache-2.0
#include "shell/main_window.h"

#include <QActionGroup>
#include <QApplication>
#include <QCloseEvent>
#include <QDir>
#include <QDropEvent>
#include <QFileDialog>
#include <QMenu>
#include <QMessageBox>
#include <QMimeData>
#include <QPushButton>
#include <QScreen>
#include <QStatusBar>
#include <QUrl>

#include "panels/icon_factory.h"
#include "panels/notice_bar.h"
#include "shell/error_dialog.h"
#include "shell/mend_dialog.h"

namespace handpiece::desktop {

MainWindow::MainWindow(Simulator& simulator, Settings& settings, QWidget* parent)
    : QMainWindow(parent), simulator_(simulator), settings_(settings), actions_(new Actions(this)) {
    setObjectName(QStringLiteral("mainWindow"));
    setWindowIcon(applicationIcon());
    setAcceptDrops(true);
    questions.fileToOpen = [this](const QString& title, const QString& start, const QString& filter) {
        return QFileDialog::getOpenFileName(this, title, start, filter);
    };
    questions.fileToSave = [this](const QString& title, const QString& start, const QString& filter) {
        return QFileDialog::getSaveFileName(this, title, start, filter);
    };
    questions.unsaved = [this] {
        QMessageBox box(QMessageBox::Question, tr("Save what was cut?"),
                        tr("The tooth has been cut since it was saved."),
                        QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, this);
        box.setObjectName(QStringLiteral("unsavedDialog"));
        box.setInformativeText(tr("Without saving, it can only be watched in the recording, not cut on."));
        box.setDefaultButton(QMessageBox::Save);
        const int answer = box.exec();
        return answer == QMessageBox::Save      ? Questions::Unsaved::save
               : answer == QMessageBox::Discard ? Questions::Unsaved::discard
                                                : Questions::Unsaved::cancel;
    };
    makePanels();
    makeBars();
    makeMenus();
    connectFiles();
    connectWork();
    connectView();
    connectPanels();
    connectSound();
    connectDevice();
    recallBindings();
    recallLook();
    recallRecordings();
    showCode();

    const QString layout = settings_.value(QStringLiteral("window/layout"), QStringLiteral("practice")).toString();
    resize(firstSize(screen()->availableGeometry().size()));
    if (const QByteArray geometry = settings_.value(QStringLiteral("window/geometry")).toByteArray();
        !geometry.isEmpty())
        restoreGeometry(geometry);
    setDetail(layout == QLatin1String("laboratory") ? Detail::laboratory
              : layout == QLatin1String("paper")    ? Detail::paper
                                                    : Detail::practice);
    showSettings();
    showSound();
    showDocument();
    view_->setFocus();
}

QSize MainWindow::firstSize(const QSize& room) {
    // The frame's title is outside of what resize() counts.
    constexpr int kTitle = 38;
    return QSize(1440, 900).boundedTo(room - QSize(0, kTitle));
}

MainWindow::~MainWindow() {
    // Panels tell nobody of their end.
    simulator_.disconnect(this);
}

void MainWindow::rememberAll() {
    rememberLayout();
    settings_.set(QStringLiteral("window/geometry"), saveGeometry());
    settings_.set(QStringLiteral("window/layout"), layoutKey(detail_).section(QLatin1Char('/'), 1));
    rememberEye();
    settings_.sync();
}

void MainWindow::greet() {
    if (!settings_.setAside().isEmpty()) tell(QStringLiteral("settings-broken"), {settings_.setAside()});
    crashed_ = simulator_.crashed();
    if (!crashed_.empty()) tell(QStringLiteral("crashed"), {titleOf(crashed_.front().note)});
}

void MainWindow::tell(const QString& id, const QStringList& arguments) {
    const NoticeText text = noticeText(id, arguments);
    const QString remedy = id == QLatin1String("crashed")         ? tr("Bring it back")
                           : id == QLatin1String("case-vanished") ? tr("Save as...")
                           : id == QLatin1String("device-lost")   ? tr("Reconnect")
                           : id == QLatin1String("device-absent") ? tr("Try again")
                                                                  : QString();
    notices_->add({id,
                   text.grave  ? NoticeBar::Kind::error
                   : text.hint ? NoticeBar::Kind::hint
                               : NoticeBar::Kind::warning,
                   text.text, remedy, id == QLatin1String("crashed") ? tr("Not now") : QString()});
    if (!text.hint) return;
    // A hint goes by itself: what was refused or saved a while ago is no news.
    QTimer*& timer = hints_[id];
    if (timer == nullptr) {
        timer = new QTimer(this);
        timer->setSingleShot(true);
        connect(timer, &QTimer::timeout, notices_, [this, id] { notices_->remove(id); });
    }
    timer->start(hintMs);
}

void MainWindow::tellSaved(const QString& file) {
    const QStringList arguments{QDir::toNativeSeparators(file)};
    const QString shown = notices_->current();
    if (shown.isEmpty() || shown == QLatin1String("saved")) {
        tell(QStringLiteral("saved"), arguments);
    } else {
        // It never covers what is told of the work.
        statusBar()->showMessage(noticeText(QStringLiteral("saved"), arguments).text, hintMs);
    }
}

void MainWindow::showProblem(const Problem& problem) {
    // One at a time: the first is the cause of the others more often than not.
    if (errorDialog_) return;
    errorDialog_ = new ErrorDialog(problem, this);
    if (canMend(problem.id, toPath(lastOpened_)))
        connect(errorDialog_->addRemedy("errorMend", tr("Mend..."),
                                        tr("Close holes and turn faces; nothing is written unasked")),
                &QPushButton::clicked, this, &MainWindow::mend);
    errorDialog_->open();
}

void MainWindow::mend() {
    const QString file = lastOpened_;
    auto* dialog = new MendDialog(toPath(file), this);
    connect(dialog, &MendDialog::saveRequested, this, [this, dialog, file] {
        const QFileInfo info(file);
        const QString start = info.dir().filePath(tr("%1-mended.stl").arg(info.completeBaseName()));
        const QString to = questions.fileToSave(tr("Save the mended surface"), start, tr("Surfaces (*.stl *.ply)"));
        if (to.isEmpty()) return;
        try {
            dialog->save(toPath(to));
        } catch (const core::Error& error) {
            showProblem(problemOf(error));
            return;
        }
        dialog->accept();
        openFile(to);
    });
    dialog->open();
}

void MainWindow::closeEvent(QCloseEvent* event) {
    if (closing_) {
        event->accept();
        return;
    }
    event->ignore();
    view_->escape();
    ifFree([this] {
        closing_ = true;
        rememberAll();
        simulator_.close();
        close();
    });
}

void MainWindow::changeEvent(QEvent* event) {
    if (event->type() == QEvent::WindowStateChange && isMinimized()) view_->escape();
    QMainWindow::changeEvent(event);
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
    const QList<QUrl> urls = event->mimeData()->urls();
    if (urls.size() == 1 && urls.front().isLocalFile()) event->acceptProposedAction();
}

void MainWindow::dropEvent(QDropEvent* event) {
    const QList<QUrl> urls = event->mimeData()->urls();
    if (urls.isEmpty()) return;
    event->acceptProposedAction();
    openFile(urls.front().toLocalFile());
}

namespace {

struct Notices {
    Q_DECLARE_TR_FUNCTIONS(Notices)
  public:
    static NoticeText of(const QString& id, const QStringList& arguments);
};

NoticeText Notices::of(const QString& id, const QStringList& arguments) {
    const QString first = arguments.value(0), second = arguments.value(1);
    if (id == QLatin1String("recording-stopped"))
        return {tr("This session is not being recorded: %1").arg(first), true};
    if (id == QLatin1String("pulp-exposed")) return {tr("The pulp is exposed."), true};
    if (id == QLatin1String("force-limited")) return {tr("The device gives all the force it has."), false, true};
    if (id == QLatin1String("stalled")) return {tr("The bur has stalled: press less."), false, true};
    if (id == QLatin1String("device-fault")) return {tr("The device reports a fault."), true};
    if (id == QLatin1String("device-lost"))
        return {tr("%1 %2 The mouse holds the handpiece now; nothing that was cut is lost.").arg(first, second), true};
    if (id == QLatin1String("school-settings"))
        return {tr("The school's settings have a mistake. Technical detail: %1").arg(first)};
    if (id == QLatin1String("device-absent")) return {tr("%1 %2 The mouse holds the handpiece.").arg(first, second)};
    if (id == QLatin1String("pedal-absent")) return {tr("%1 %2 The button alone is the pedal.").arg(first, second)};
    if (id == QLatin1String("pedal-lost"))
        return {tr("The foot pedal %1 was unplugged: it is up. Plugged in again, it counts once it has been up.")
                    .arg(first)};
    if (id == QLatin1String("device-trouble")) return {tr("The device gives no force. %1 %2").arg(first, second), true};
    if (id == QLatin1String("out-of-bricks")) return {tr("There is no memory left to cut more of this tooth."), true};
    if (id == QLatin1String("recording-incomplete"))
        return {tr("The recording has a gap: ticks that are missing: %1").arg(first)};
    if (id == QLatin1String("samples-lost")) return {tr("The computer is too busy. Samples lost: %1").arg(first)};
    if (id == QLatin1String("nothing-to-undo")) return {tr("There is nothing to undo."), false, true};
    if (id == QLatin1String("nothing-to-redo")) return {tr("There is nothing to redo."), false, true};
    if (id == QLatin1String("nothing-to-reset")) return {tr("Nothing was cut yet."), false, true};
    if (id == QLatin1String("not-while-cutting")) return {tr("Not while you cut: lift the bur first."), false, true};
    if (id == QLatin1String("hull-only-touches"))
        return {tr("With the convex hull the bur touches and does not cut."), false, true};
    if (id == QLatin1String("refused")) return {tr("This could not be done: %1").arg(first)};
    if (id == QLatin1String("neighbour-touched")) return {tr("The neighbouring tooth was touched.")};
    if (id == QLatin1String("first-dentine")) return {tr("The bur has reached dentine."), false, true};
    if (id == QLatin1String("hull-needs-whole-tooth"))
        return {tr("The convex hull knows the whole tooth only, and this one is cut. Reset the tooth first.")};
    if (id == QLatin1String("settings-broken"))
        return {tr("The settings could not be read and start anew. The old file is kept at %1").arg(first)};
    if (id == QLatin1String("crashed"))
        return {tr("The last session ended without saving. What was cut of \"%1\" can be brought back, now or later "
                   "with File, Recover.")
                    .arg(first)};
    if (id == QLatin1String("code-later"))
        return {tr("Your code goes into what you save from now on. This recording began without it.")};
    if (id == QLatin1String("bur-missing"))
        return {tr("The bur it was cut with, %1, is not at hand: %2 is in its place.").arg(first, second)};
    if (id == QLatin1String("bur-locked")) return {tr("This exercise does not allow the bur %1.").arg(first)};
    if (id == QLatin1String("help-locked")) return {tr("Not in this exercise: %1.").arg(first), false, true};
    if (id == QLatin1String("handed-in"))
        return {
            tr("Handed in: %1, with its tooth. Recordings in it: %2 (%3 MB).").arg(first, second, arguments.value(2)),
            false, true};
    if (id == QLatin1String("handed-in-part"))
        return {tr("Handed in: %1, with its tooth. Recordings in it: %2 (%3 MB). Recordings that are no longer there, "
                   "or too large together, and not in it: %4.")
                    .arg(first, second, arguments.value(2), arguments.value(3))};
    if (id == QLatin1String("case-vanished"))
        return {tr("The tooth you opened is no longer at %1. It was saved together with the attempt.").arg(first)};
    if (id == QLatin1String("saved")) return {tr("Saved: %1").arg(first), false, true};
    if (id == QLatin1String("translation-missing"))
        return {tr("There is no translation into this language: the window speaks English."), false};
    if (id == QLatin1String("opengl-missing"))
        return {tr("There is no picture. Everything else goes on. Technical detail: %1").arg(first), true};
    return {arguments.isEmpty() ? id : id + QStringLiteral(": ") + arguments.join(QStringLiteral(", "))};
}

}  // namespace

NoticeText noticeText(const QString& id, const QStringList& arguments) {
    return Notices::of(id, arguments);
}

}  // namespace handpiece::desktop
