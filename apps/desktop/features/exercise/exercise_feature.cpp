// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/exercise_feature.h"

#include <QDockWidget>
#include <QInputDialog>
#include <QLabel>
#include <QLineEdit>
#include <QLocale>
#include <QMessageBox>
#include <QPushButton>
#include <QRegularExpressionValidator>
#include <QStatusBar>
#include <numeric>

#include "desktop/features/exercise/exercise_panel.h"
#include "desktop/framework/helps.h"
#include "desktop/work/documents.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/course/finished_work.h"
#include "handpiece/base/core/error.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

using Command = ExerciseFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::code, "actionCode", QT_TRANSLATE_NOOP("Commands", "Your code..."),
     QT_TRANSLATE_NOOP("Commands", "The code your teacher gave you: it goes into recordings and saved attempts"),
     "info", "Ctrl+I", in(Shelf::file, 8), exercise::Operation::elsewhere},
    {Command::handIn, "actionHandIn", QT_TRANSLATE_NOOP("Commands", "Hand in..."),
     QT_TRANSLATE_NOOP("Commands", "Give the attempt to your teacher: one file with the tooth and what was recorded"),
     "save-as", "Ctrl+Shift+I", in(Shelf::file, 12), exercise::Operation::elsewhere},
    {Command::exercise, "actionExercise", QT_TRANSLATE_NOOP("Commands", "Exercise"),
     QT_TRANSLATE_NOOP("Commands", "Show the exercise: its title and what to do"), "info", "F9", in(Shelf::view, 24)},
};

QString inLanguage(const cases::Texts& texts) {
    const std::string_view text = cases::inLanguage(texts, QLocale().bcp47Name().toStdString());
    return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size()));
}

ExerciseFeature::Choice askLookOrGoOn(QWidget* window, const QString& student) {
    QMessageBox box(QMessageBox::Question, ExerciseFeature::tr("Handed in"),
                    student.isEmpty() ? ExerciseFeature::tr("This attempt was handed in.")
                                      : ExerciseFeature::tr("This attempt was handed in by %1.").arg(student),
                    QMessageBox::Cancel, window);
    box.setObjectName(QStringLiteral("handedInDialog"));
    box.setTextFormat(Qt::PlainText);
    box.setInformativeText(
        ExerciseFeature::tr("Look at it with every help: measure, cut it open, watch what was recorded. Or go on "
                            "cutting where it ended, as the exercise has it."));
    QPushButton* look = box.addButton(ExerciseFeature::tr("Look at it"), QMessageBox::AcceptRole);
    look->setObjectName(QStringLiteral("handedInLook"));
    QPushButton* goOn = box.addButton(ExerciseFeature::tr("Go on with it"), QMessageBox::ActionRole);
    goOn->setObjectName(QStringLiteral("handedInGoOn"));
    box.setDefaultButton(look);
    box.exec();
    return box.clickedButton() == look   ? ExerciseFeature::Choice::look
           : box.clickedButton() == goOn ? ExerciseFeature::Choice::goOn
                                         : ExerciseFeature::Choice::cancel;
}

/// What a code may be made of.
void restrictCode(const QInputDialog& dialog) {
    if (auto* line = dialog.findChild<QLineEdit*>())
        line->setValidator(
            new QRegularExpressionValidator(QRegularExpression(QStringLiteral("[A-Za-z0-9_-]{0,32}")), line));
}

std::optional<QString> askStudent(QWidget* window, const QString& now) {
    QInputDialog dialog(window);
    dialog.setObjectName(QStringLiteral("studentDialog"));
    dialog.setWindowTitle(ExerciseFeature::tr("Hand in"));
    dialog.setLabelText(
        ExerciseFeature::tr("Whose work is it? Your code, given by your teacher: no name. It is asked once; change it "
                            "with File, Your code."));
    dialog.setTextValue(now);
    restrictCode(dialog);
    if (dialog.exec() != QDialog::Accepted) return std::nullopt;
    return dialog.textValue();
}

}  // namespace

ExerciseFeature::ExerciseFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), panel_(new ExercisePanel), code_(new QLabel) {
    QWidget* window = &window_;
    questions.lookOrGoOn = [window](const QString& student) { return askLookOrGoOn(window, student); };
    questions.student = [window](const QString& now) { return askStudent(window, now); };
    // Shown while there is something to read, until a person closes it.
    dock_ = window_.docks().add({"exerciseDock",
                                 tr("Exercise"),
                                 10,
                                 {{Detail::practice, Qt::LeftDockWidgetArea, 10, 290},
                                  {Detail::laboratory, Qt::LeftDockWidgetArea, 10, 290},
                                  {Detail::paper, Qt::LeftDockWidgetArea, 10, 290}},
                                 [this] { return isWanted_; }},
                                panel_);
    connect(dock_->toggleViewAction(), &QAction::triggered, this, [this](bool shown) { isWanted_ = shown; });
    dock_->installEventFilter(this);
    code_->setObjectName(QStringLiteral("codeNote"));
    code_->setToolTip(tr("The code your teacher gave you: File, Your code..."));
    window_.statusBar()->addPermanentWidget(code_);
    connect(panel_, &ExercisePanel::watchRequested, this,
            [this](int which) { simulator_.watchRecording(static_cast<std::size_t>(which)); });
    connect(panel_, &ExercisePanel::finishRequested, this, [this] { simulator_.finish(); });
    connect(panel_, &ExercisePanel::goOnRequested, this, [this] {
        if (simulator_.isReviewing()) simulator_.open(fs::path(simulator_.reviewed().attemptFile));
    });
    connect(&live_, &LiveZones::counted, panel_, [this](const LiveShares& shares) { panel_->setShares(&shares); });
    connect(&live_, &LiveZones::valued, panel_, [this](const std::vector<course::LiveValue>& values) {
        if (rubric_) panel_->setValues(values, *rubric_);
    });
    connectCommands();
    showCode();
    window_.openers.push_back([this](const QString& path) { return open(path); });
}

void ExerciseFeature::connectCommands() {
    on(commands_[Command::exercise], [this] {
        isWanted_ = true;
        window_.docks().showWanted();
        dock_->raise();
    });
    on(commands_[Command::handIn], [this] { handIn(); });
    on(commands_[Command::code], [this] { editCode(); });
    window_.commands().enableWhile(commands_[Command::exercise],
                                   [this] { return simulator_.exercise() != nullptr || simulator_.isReviewing(); });
    window_.commands().enableWhile(commands_[Command::handIn], [this] {
        return !simulator_.isBusy() && simulator_.mode() == Simulator::Mode::liveSession;
    });
}

/// Closed by its own button or in the menu of panels: it stays so until it is asked for.
bool ExerciseFeature::eventFilter(QObject* watched, QEvent* event) {
    if (watched == dock_ && event->type() == QEvent::Close) isWanted_ = false;
    return QObject::eventFilter(watched, event);
}

void ExerciseFeature::showDocument() {
    const cases::Exercise* exercise = simulator_.exercise();
    ExerciseText text;
    if (exercise) {
        text.title = inLanguage(exercise->title);
        text.instructions = inLanguage(exercise->instructions);
        if (!simulator_.isReviewing())
            for (const std::string& name : exercise->lockedHelps)
                if (const auto help = helpOf(name)) text.locked << helpWords(*help);
    }
    text.review.isOn = simulator_.isReviewing();
    if (text.review.isOn) {
        text.review.student = QString::fromStdString(simulator_.reviewed().student);
        for (const RecordingPlace& recording : simulator_.reviewed().recordings)
            text.review.recordings.push_back({QString::fromStdString(recording.name), recording.packed});
    }
    text.canFinish = simulator_.mode() == Simulator::Mode::liveSession && simulator_.task() &&
                     !simulator_.task()->rubric.empty() && !simulator_.exam();
    const bool isAtWork = simulator_.mode() == Simulator::Mode::liveSession;
    const std::shared_ptr<const tasks::Task>& task = simulator_.task();
    const exercise::Permissions may = simulator_.permissions();
    // By oneself, and in an exam, nobody tells.
    text.hasLiveBar =
        isAtWork && task && task->hasLiveBar && task->preparation && !simulator_.exam() && !isUnaided(*task);
    text.saysWhatUndoDoes = text.canFinish && !may.locks(exercise::Operation::undo);
    panel_->setText(text);
    panel_->setShares(nullptr);
    panel_->setValues({}, {});
    rubric_.reset();
    if (text.hasLiveBar && !may.locks(exercise::Operation::depthReadout)) try {
            rubric_ = std::make_shared<const rubric::Rubric>(course::rubricOf(*task));
        } catch (const core::Error&) {
            rubric_.reset();  // it cannot be judged, which finishing tells
        }
    if (text.hasLiveBar)
        live_.watch(task, simulator_.tooth(), rubric_);
    else
        live_.stop();
    showTick();
    isWanted_ = exercise != nullptr || text.review.isOn;
    window_.docks().showWanted();
}

void ExerciseFeature::showTick() {
    const auto& task = simulator_.task();
    const bool isAtWork = task && simulator_.mode() == Simulator::Mode::liveSession;
    if (isAtWork && task->minutes && !simulator_.exam())
        panel_->setClock(simulator_.workedS(), 60.0 * *task->minutes);
    else
        panel_->setClock(std::nullopt);
    const auto& removed = simulator_.sample().removedMm3;
    if (isAtWork) live_.tell(std::accumulate(std::begin(removed), std::end(removed), 0.0));
}

bool ExerciseFeature::askCode() {
    if (!simulator_.code().isEmpty()) return true;
    const std::optional<QString> code = questions.student(simulator_.code());
    if (code) takeCode(*code);
    return code.has_value();
}

void ExerciseFeature::handIn() {
    if (simulator_.exercise() != nullptr && !askCode()) return;
    QString name = QString::fromStdString(simulator_.document().name);
    if (!simulator_.code().isEmpty()) name += QLatin1Char('-') + simulator_.code();
    const QString file =
        window_.questions.save(tr("Hand in"), name + QStringLiteral(".handpiece"),
                               tr("Attempt with its tooth (*.handpiece)"), QStringLiteral(".handpiece"));
    // A tooth that is opened again with the code comes first.
    if (!file.isEmpty()) simulator_.whenFree([this, file] { simulator_.handIn(toPath(file)); });
}

bool ExerciseFeature::open(const QString& file) {
    const fs::path path = toPath(file);
    cases::Attempt attempt;
    try {
        if (fileKindOf(path) == FileKind::attempt) attempt = cases::readAttempt(path);
    } catch (const core::Error& error) {
        emit simulator_.failed(problemOf(error));
        return true;
    }
    if (!attempt.handedIn) return false;
    switch (questions.lookOrGoOn(QString::fromStdString(attempt.student))) {
        case Choice::look:
            simulator_.review(path);
            break;
        case Choice::goOn:
            simulator_.open(path);
            break;
        case Choice::cancel:
            break;
    }
    return true;
}

void ExerciseFeature::takeCode(const QString& code) {
    simulator_.setCode(code);
    settings_.set(QStringLiteral("work/code"), simulator_.code());
    showCode();
}

void ExerciseFeature::editCode() {
    auto* dialog = new QInputDialog(&window_);
    dialog->setObjectName(QStringLiteral("codeDialog"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Your code"));
    dialog->setLabelText(tr("Code (given by your teacher). No name: recordings and saved attempts carry it."));
    dialog->setTextValue(simulator_.code());
    restrictCode(*dialog);
    connect(dialog, &QInputDialog::textValueSelected, this, &ExerciseFeature::takeCode);
    dialog->open();
}

void ExerciseFeature::showCode() {
    code_->setText(simulator_.code().isEmpty() ? QString() : tr("Code: %1").arg(simulator_.code()));
    code_->setVisible(!simulator_.code().isEmpty());
}

}  // namespace handpiece::desktop
