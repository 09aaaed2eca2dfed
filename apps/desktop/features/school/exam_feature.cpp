// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/school/exam_feature.h"

#include <QApplication>
#include <QEvent>
#include <QFile>
#include <QLabel>
#include <QMessageBox>
#include <QPushButton>
#include <QSaveFile>

#include "desktop/features/school/exam_bar.h"
#include "desktop/features/school/exam_dialog.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"
#include "desktop/work/simulator.h"

namespace handpiece::desktop {
namespace {

using Command = ExamFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::begin, "actionBeginExam", QT_TRANSLATE_NOOP("Commands", "Begin an exam..."),
     QT_TRANSLATE_NOOP("Commands", "An exam of your school, with an invigilator beside you, by the code on your slip"),
     "lock", "Ctrl+Shift+A", in(Shelf::file, 4), exercise::Operation::elsewhere},
};
constexpr int kClockMs = 250, kAgainMs = 2000;

/// Covers the whole picture, however it is resized.
class Cover : public QLabel {
  public:
    explicit Cover(QWidget* over) : QLabel(over) {
        setAlignment(Qt::AlignCenter);
        setAutoFillBackground(true);
        setFont(scaledFont(font(), 1.6, true));
        over->installEventFilter(this);
        hide();
    }

  protected:
    bool eventFilter(QObject* watched, QEvent* event) override {
        if (event->type() == QEvent::Resize) setGeometry(static_cast<QWidget*>(watched)->rect());
        return false;
    }
};

}  // namespace

ExamFeature::ExamFeature(const FeatureContext& context)
    : Feature(context),
      commands_(window_.commands(), kCommands),
      link_(this),
      bar_(new ExamBar),
      dialog_(new ExamDialog(&window_)),
      receipt_(new ReceiptDialog(&window_)),
      cover_(named(new Cover(&view_), "examCover", tr("Pause"))) {
    cover_->setText(tr("Pause"));
    window_.addBelow(bar_);
    bar_->hide();
    on(commands_[Command::begin], [this] {
        window_.whenMayLeave([this] {
            dialog_->restart();
            dialog_->open();
            link_.begin();
        });
    });
    // Also while a tooth is being prepared, which the first time takes a while: it is given up.
    window_.commands().enableWhile(commands_[Command::begin], [this] { return !simulator_.exam(); });
    mayClose = [this] {
        QMessageBox* box =
            question("examCloseDialog", tr("An exam runs."),
                     tr("Its time runs on when the window is closed. Start the program again to go on with it."),
                     tr("Close all the same"), tr("Stay"));
        box->setAttribute(Qt::WA_DeleteOnClose, false);  // it is asked what was clicked
        box->exec();
        box->deleteLater();
        return box->clickedButton() && box->buttonRole(box->clickedButton()) == QMessageBox::AcceptRole;
    };
    // Nothing may, while an exam runs.
    window_.openersBeside.insert(window_.openersBeside.begin(), [this](const QFileInfo&) { return isShut(); });
    window_.whenMayLeave = [this, before = window_.whenMayLeave](std::function<void()> then) {
        if (!isShut()) before(std::move(then));
    };
    window_.whenMayClose = [this, before = window_.whenMayClose](std::function<void()> then) {
        if (!simulator_.exam()) return before(std::move(then));
        if (mayClose()) then();
    };
    connect(&window_, &MainWindow::greet, this, &ExamFeature::greet);
    connect(&simulator_, &Simulator::jobStarted, this, &ExamFeature::showBar);
    connect(&simulator_, &Simulator::jobEnded, this, &ExamFeature::showBar);
    connect(dialog_, &ExamDialog::lookRequested, &link_, &ExamLink::look);
    connect(dialog_, &ExamDialog::beginRequested, this,
            [this](const QString& candidate, const QString& invigilator, const QString& pin) {
                if (!closeDialogs()) return dialog_->showProblem(problemById(QStringLiteral("exam-windows")));
                link_.beginExam(candidate, invigilator, pin);
            });
    connect(dialog_, &QDialog::rejected, this, [this] {
        if (simulator_.exam() || isTaken_) return;
        link_.end();
        if (simulator_.mode() == Simulator::Mode::empty && !simulator_.isBusy()) simulator_.openFirst();
    });
    connect(receipt_, &ReceiptDialog::saveRequested, this, [this] {
        const QString file = window_.questions.save(
            tr("Save the receipt"), QStringLiteral("receipt-%1.txt").arg(receipt_->ending().sitting.left(8)),
            tr("Text (*.txt)"), QStringLiteral(".txt"));
        if (file.isEmpty()) return;
        QSaveFile out(file);
        const QByteArray text = receipt_->text().toUtf8();
        if (!out.open(QIODevice::WriteOnly) || out.write(text) != text.size() || !out.commit())
            return window_.showProblem(problemById(QStringLiteral("not-writable"), {out.errorString()}, file));
        window_.tellSaved(file);
    });
    connect(bar_, &ExamBar::pauseToggled, this, &ExamFeature::pause);
    connect(bar_, &ExamBar::openRequested, &simulator_, &Simulator::openExam);
    connect(bar_, &ExamBar::handOverRequested, this, &ExamFeature::askHandOver);
    connectLink();
    connect(&clock_, &QTimer::timeout, this, &ExamFeature::showTime);
    again_.setInterval(kAgainMs);
    connect(&again_, &QTimer::timeout, this, [this] {
        if (simulator_.exam() && !link_.isRunning()) {
            link_.begin();
            showDocument();
        }
        const ExamEnding& shown = receipt_->ending();
        if (receipt_->isVisible() && shown.receipt.isEmpty() && !shown.isGivenUp && !simulator_.exam())
            link_.askEnding(shown.sitting);
    });
    again_.start();
    // Made anew for another language.
    if (simulator_.exam()) {
        isTaken_ = true;
        link_.begin();
    }
}

void ExamFeature::connectLink() {
    connect(&link_, &ExamLink::deskHeard, this, &ExamFeature::hearDesk);
    connect(&link_, &ExamLink::offered, dialog_, &ExamDialog::showOffer);
    connect(&link_, &ExamLink::begun, this, &ExamFeature::hearDesk);
    connect(&link_, &ExamLink::exerciseKept, this, &ExamFeature::openTooth);
    connect(&link_, &ExamLink::ended, this, &ExamFeature::hearEnding);
    connect(&link_, &ExamLink::failed, this, &ExamFeature::hearProblem);
}

/// Somebody may have been at an exam when the program ended.
void ExamFeature::greet() {
    if (ExamLink::isSetUp() || !simulator_.leftExams().empty()) link_.begin();
}

void ExamFeature::hearDesk(const ExamDesk& desk) {
    desk_ = desk;
    sinceDesk_.restart();
    isSilent_ = false;
    if (!desk.title.isEmpty()) title_ = desk.title;
    const QString mine = simulator_.exam() ? QString::fromStdString(simulator_.exam()->sitting) : QString();
    const auto ask = [this](const QString& sitting) {
        if (!ending_.isEmpty()) return;
        ending_ = sitting;
        link_.askEnding(sitting);
    };
    if (!mine.isEmpty()) {
        // Ended by somebody else.
        if (desk.sitting != mine && !isHandingOver_) ask(mine);
    } else if (!desk.sitting.isEmpty()) {
        takeUp(desk);
    } else if (const std::vector<std::string> left = simulator_.leftExams(); !left.empty()) {
        ask(QString::fromStdString(left.front()));
    } else if (!dialog_->isVisible() && !receipt_->isVisible()) {
        link_.end();
    }
    showBar();
}

QString ExamFeature::exerciseFile(const QString& sitting) const {
    return toQString(simulator_.folders().sessions.parent_path() / "exam" / (sitting.toStdString() + ".handpiece"));
}

void ExamFeature::takeUp(const ExamDesk& desk) {
    if (isTaken_) return;
    isTaken_ = true, isOverTold_ = false;
    dialog_->hide();
    (void)closeDialogs();
    link_.fetchExercise(exerciseFile(desk.sitting));
}

void ExamFeature::openTooth() {
    if (simulator_.exam() || desk_.sitting.isEmpty()) return;
    Simulator::Exam exam;
    exam.sitting = desk_.sitting.toStdString();
    for (const QString& help : desk_.locked)
        exam.locked.push_back(help.toStdString());
    exam.exercise = toPath(exerciseFile(desk_.sitting));
    simulator_.beginExam(exam);
    showBar();
}

void ExamFeature::showDocument() {
    const auto& exam = simulator_.exam();
    if (exam && simulator_.mode() == Simulator::Mode::liveSession && !simulator_.recording().empty()) {
        QStringList recordings;
        for (const RecordingPlace& place : simulator_.document().recordings)
            if (!place.packed) recordings << toQString(place.in);
        recordings << toQString(simulator_.recording());
        link_.watch(QString::fromStdString(exam->sitting), recordings);
    }
    showBar();
}

void ExamFeature::hearProblem(const QString& of, const Problem& problem) {
    const bool isGone = problem.id == QLatin1String("exam-program");
    if (of == QLatin1String("look") || of == QLatin1String("begin")) {
        dialog_->showProblem(problem);
    } else if (of == QLatin1String("exercise")) {
        isTaken_ = false;  // the next word of the service begins it again
        window_.showProblem(problem);
    } else if (of == QLatin1String("finish")) {
        isHandingOver_ = false;
        simulator_.goOnWithExam();
        window_.showProblem(problem);
    } else if (of == QLatin1String("ending")) {
        const QString sitting = std::exchange(ending_, {});
        if (problem.id == QLatin1String("exam-none") && !sitting.isEmpty()) {
            if (simulator_.exam()) window_.showProblem(problem);
            simulator_.endExam();
            simulator_.forgetExam(sitting.toStdString());
            isTaken_ = false;
        }
    } else {
        isSilent_ = true;
        if (isGone && dialog_->isVisible()) dialog_->showProblem(problem);
    }
    showBar();
}

void ExamFeature::hearEnding(const ExamEnding& ending) {
    ending_.clear();
    const auto& exam = simulator_.exam();
    const bool isMine = exam && ending.sitting.toStdString() == exam->sitting;
    const bool isShown = receipt_->isVisible() && receipt_->ending().sitting == ending.sitting;
    if (isMine) {
        isHandingOver_ = isTaken_ = false;
        pause(false);
        for (const char* name : {"examOverDialog", "examHandOverDialog"})
            if (auto* box = window_.findChild<QMessageBox*>(QLatin1String(name))) box->close();
        simulator_.endExam();
    } else {
        simulator_.forgetExam(ending.sitting.toStdString());
    }
    QFile::remove(exerciseFile(ending.sitting));
    receipt_->show(isMine || isShown ? title_ : QString(), ending);
    if (isMine) simulator_.openFirst();
    showBar();
}

qint64 ExamFeature::leftMs() const {
    return desk_.deadlineMs - desk_.nowMs - (sinceDesk_.isValid() ? sinceDesk_.elapsed() : 0);
}

void ExamFeature::showTime() {
    if (!simulator_.exam() || desk_.deadlineMs == 0) return;
    bar_->setLeft(leftMs());
    if (leftMs() < 0 && !isOverTold_ && !isHandingOver_) tellTimeOver();
}

void ExamFeature::showBar() {
    const bool runs = simulator_.exam().has_value();
    if (bar_->isHidden() == runs) {
        bar_->setVisible(runs);
        window_.refresh(simulator_.permissions());
    }
    if (!runs) {
        clock_.stop();
        return;
    }
    if (!clock_.isActive()) clock_.start(kClockMs);
    const bool isAtWork = simulator_.mode() == Simulator::Mode::liveSession;
    bar_->setTitle(title_);
    if (desk_.deadlineMs > 0) {
        bar_->setAllowance(allowanceWords(desk_.extraPercent, desk_.pauseMinutes));
        bar_->setHasPause(desk_.pauseMinutes > 0);
    }
    bar_->setNeedsTooth(!isAtWork && !simulator_.isBusy() && !isHandingOver_);
    bar_->setBusy(!isAtWork || simulator_.isBusy() || isHandingOver_);
    bar_->setTrouble(
        isHandingOver_ ? QString()
        : isSilent_    ? tr("The station's exam service does not answer. Go on working, and call the invigilator.")
        : isAtWork && simulator_.recording().empty() ? tr("Your work is not recorded. Call the invigilator.")
                                                     : QString());
    showTime();
}

void ExamFeature::pause(bool isPaused) {
    bar_->setPaused(isPaused);
    simulator_.pause(isPaused);
    cover_->setGeometry(view_.rect());
    cover_->setVisible(isPaused);
    cover_->raise();
}

QMessageBox* ExamFeature::question(const char* name, const QString& text, const QString& more, const QString& accept,
                                   const QString& reject) {
    auto* box = new QMessageBox(QMessageBox::Question, tr("Exam"), text, QMessageBox::NoButton, &window_);
    box->setObjectName(QLatin1String(name));
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->setTextFormat(Qt::PlainText);
    box->setInformativeText(more);
    box->addButton(accept, QMessageBox::AcceptRole)->setObjectName(QLatin1String(name) + QStringLiteral("Yes"));
    QPushButton* stay = box->addButton(reject, QMessageBox::RejectRole);
    stay->setObjectName(QLatin1String(name) + QStringLiteral("No"));
    box->setDefaultButton(stay);
    box->setEscapeButton(stay);
    return box;
}

void ExamFeature::askHandOver() {
    offerHandOver("examHandOverDialog", tr("Hand your work over?"),
                  tr("This ends the exam. Nothing can be changed afterwards."), tr("Go on working"));
}

void ExamFeature::tellTimeOver() {
    isOverTold_ = true;
    offerHandOver("examOverDialog", tr("The time of this exam is over."),
                  tr("Hand your work over now. You can still go on, but how late it was handed over is "
                     "shown to the teacher who decides about the result."),
                  tr("Not yet"));
}

void ExamFeature::offerHandOver(const char* name, const QString& text, const QString& more, const QString& reject) {
    QMessageBox* box = question(name, text, more, tr("Hand over"), reject);
    connect(box, &QMessageBox::buttonClicked, this, [this, box](QAbstractButton* button) {
        if (box->buttonRole(button) == QMessageBox::AcceptRole) handOver();
    });
    box->open();
}

void ExamFeature::handOver() {
    if (!simulator_.exam() || isHandingOver_) return;
    if (simulator_.isBusy()) return simulator_.whenFree([this] { handOver(); });
    if (!simulator_.isRecorded()) return window_.showProblem(problemById(QStringLiteral("no-recording")));
    pause(false);
    const QString sitting = QString::fromStdString(simulator_.exam()->sitting);
    QStringList recordings;
    for (const std::filesystem::path& one : simulator_.closeExam())
        recordings << toQString(one);
    isHandingOver_ = true;
    link_.finish(sitting, recordings);
    showBar();
}

/// What else is open of this program. False: something stayed, because there is unsaved work in it.
bool ExamFeature::closeDialogs() {
    bool areClosed = true;
    for (QWidget* one : QApplication::topLevelWidgets())
        if (auto* dialog = qobject_cast<QDialog*>(one);
            dialog && dialog->isVisible() && dialog != dialog_ && dialog != receipt_)
            areClosed = dialog->close() && areClosed;
    return areClosed;
}

/// Then it is told, too.
bool ExamFeature::isShut() {
    if (!simulator_.exam()) return false;
    window_.notices().tell(Notice::examRuns);
    return true;
}

}  // namespace handpiece::desktop
