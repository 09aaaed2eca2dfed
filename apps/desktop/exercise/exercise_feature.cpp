// SPDX-License-Identifier: Apache-2.0
#include "exercise/exercise_feature.h"

#include <QDockWidget>
#include <QInputDialog>
#include <QLineEdit>
#include <QLocale>
#include <QMessageBox>
#include <QPushButton>
#include <QRegularExpressionValidator>

#include "exercise/exercise_panel.h"
#include "exercise/exercise_words.h"
#include "handpiece/base/core/error.h"
#include "shell/actions.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;
using exercise::Operation;

// The commands that an exercise may lock; those of the panels and of the picture ask for themselves.
constexpr std::pair<const char*, Operation> kGoverned[] = {
    {"actionUndo", Operation::undo},         {"actionRedo", Operation::redo},       {"actionReset", Operation::reset},
    {"actionMeasure", Operation::calliper},  {"actionDepth", Operation::depthTool}, {"actionPulp", Operation::pulpTool},
    {"actionSection", Operation::section},   {"actionCompare", Operation::compare}, {"actionMirror", Operation::mirror},
    {"actionChooseTooth", Operation::chart}, {"actionReport", Operation::report},
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

std::optional<QString> askStudent(QWidget* window, const QString& now) {
    QInputDialog dialog(window);
    dialog.setObjectName(QStringLiteral("studentDialog"));
    dialog.setWindowTitle(ExerciseFeature::tr("Hand in"));
    dialog.setLabelText(
        ExerciseFeature::tr("Whose work is it? Your code, given by your teacher: no name. It is asked once; change it "
                            "with File, Your code."));
    dialog.setTextValue(now);
    if (auto* line = dialog.findChild<QLineEdit*>())
        line->setValidator(
            new QRegularExpressionValidator(QRegularExpression(QStringLiteral("[A-Za-z0-9_-]{0,32}")), line));
    if (dialog.exec() != QDialog::Accepted) return std::nullopt;
    return dialog.textValue();
}

}  // namespace

ExerciseFeature::ExerciseFeature(Simulator& simulator, Settings& settings, const Actions& actions, ExercisePanel* panel,
                                 QDockWidget* dock, QWidget* window)
    : QObject(window), simulator_(simulator), settings_(settings), actions_(actions), panel_(panel), dock_(dock) {
    questions.lookOrGoOn = [window](const QString& student) { return askLookOrGoOn(window, student); };
    questions.student = [window](const QString& now) { return askStudent(window, now); };
    connect(&simulator_, &Simulator::documentChanged, this, &ExerciseFeature::showDocument);
    connect(panel_, &ExercisePanel::watchRequested, this,
            [this](int which) { simulator_.watchRecording(static_cast<std::size_t>(which)); });
    connect(panel_, &ExercisePanel::goOnRequested, this, [this] {
        if (simulator_.isReviewing()) simulator_.open(fs::path(simulator_.reviewed().attemptFile));
    });
    connect(actions_["actionExercise"], &QAction::triggered, this, [this] {
        isWanted_ = true;
        placeDock();
        dock_->raise();
    });
    connect(actions_["actionHandIn"], &QAction::triggered, this, &ExerciseFeature::handIn);
    connect(dock_->toggleViewAction(), &QAction::triggered, this, [this](bool shown) { isWanted_ = shown; });
    dock_->installEventFilter(this);
    showDocument();
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
            for (const std::string& help : exercise->lockedHelps)
                text.locked << lockWords(help);
    }
    text.review.isOn = simulator_.isReviewing();
    if (text.review.isOn) {
        text.review.student = QString::fromStdString(simulator_.reviewed().student);
        for (const RecordingPlace& recording : simulator_.reviewed().recordings)
            text.review.recordings.push_back({QString::fromStdString(recording.name), recording.packed});
    }
    panel_->setText(text);
    isWanted_ = exercise != nullptr || text.review.isOn;
    placeDock();
    showAllowed();
}

void ExerciseFeature::placeDock() {
    dock_->setVisible(isWanted_);
}

void ExerciseFeature::showAllowed() {
    const exercise::Permissions now = simulator_.permissions();
    for (const auto& [name, operation] : kGoverned) {
        if (!now.allows(operation)) actions_[name]->setEnabled(false);
        actions_.setLocked(name, now.locks(operation));
    }
    actions_["actionExercise"]->setEnabled(simulator_.exercise() != nullptr || simulator_.isReviewing());
    actions_["actionHandIn"]->setEnabled(!simulator_.isBusy() && simulator_.mode() == Simulator::Mode::liveSession);
}

void ExerciseFeature::handIn() {
    if (simulator_.code().isEmpty() && simulator_.exercise() != nullptr) {
        const std::optional<QString> code = questions.student(simulator_.code());
        if (!code) return;
        simulator_.setCode(*code);
        settings_.set(QStringLiteral("work/code"), simulator_.code());
        emit codeChanged();
    }
    QString name = QString::fromStdString(simulator_.document().name);
    if (!simulator_.code().isEmpty()) name += QLatin1Char('-') + simulator_.code();
    const QString file = questions.fileToHandIn ? questions.fileToHandIn(name) : QString();
    // A tooth that is opened again with the code comes first.
    if (!file.isEmpty()) simulator_.whenFree([this, file] { simulator_.handIn(toPath(file)); });
}

void ExerciseFeature::open(const std::filesystem::path& path) {
    cases::Attempt attempt;
    try {
        if (fileKindOf(path) == FileKind::attempt) attempt = cases::readAttempt(path);
    } catch (const core::Error& error) {
        emit simulator_.failed(problemOf(error));
        return;
    }
    if (!attempt.handedIn) {
        simulator_.open(path);
        return;
    }
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
}

}  // namespace handpiece::desktop
