// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/editor_feature.h"

#include <QFileInfo>
#include <QLocale>
#include <QMessageBox>
#include <QPointer>
#include <QPushButton>
#include <QTimer>
#include <optional>
#include <utility>

#include "desktop/features/editor/editor_dialog.h"
#include "desktop/features/editor/editor_pages.h"
#include "desktop/picture/start_view.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/course/finished_work.h"
#include "handpiece/app/simulation/tissue_export.h"
#include "handpiece/model/starter/block.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

using Command = EditorFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::anew, "actionNewExercise", QT_TRANSLATE_NOOP("Commands", "New exercise..."),
     QT_TRANSLATE_NOOP("Commands", "For teachers: set a task, from its tooth to how it is judged"), "check",
     "Ctrl+Shift+N", in(Shelf::tools, 41), exercise::Operation::elsewhere},
    {Command::edit, "actionEditExercise", QT_TRANSLATE_NOOP("Commands", "Edit exercise..."),
     QT_TRANSLATE_NOOP("Commands", "For teachers: change an exercise that was saved"), "open", "Ctrl+Shift+G",
     in(Shelf::tools, 42), exercise::Operation::elsewhere},
};

/// Of the window before. The window's thread only.
std::optional<draft::Draft>& leftBehind() {
    static std::optional<draft::Draft> left;
    return left;
}

Questions::Unsaved askAboutDraft(QWidget* over) {
    QMessageBox box(QMessageBox::Question, EditorFeature::tr("Exercise editor"),
                    EditorFeature::tr("The exercise was changed, and no file holds it."), QMessageBox::NoButton, over);
    box.setObjectName(QStringLiteral("editorUnsavedDialog"));
    QPushButton* save = box.addButton(EditorFeature::tr("Save"), QMessageBox::AcceptRole);
    QPushButton* discard = box.addButton(EditorFeature::tr("Do not save"), QMessageBox::DestructiveRole);
    box.addButton(EditorFeature::tr("Cancel"), QMessageBox::RejectRole);
    box.setDefaultButton(save);
    box.exec();
    return box.clickedButton() == save      ? Questions::Unsaved::save
           : box.clickedButton() == discard ? Questions::Unsaved::discard
                                            : Questions::Unsaved::cancel;
}

}  // namespace

EditorFeature::EditorFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), dialog_(new EditorDialog(&window_)) {
    askUnsaved = [this] { return askAboutDraft(dialog_); };
    connectDialog();
    on(commands_[Command::anew], [this] {
        dialog_->whenMayLeave([this] {
            dialog_->begin({});
            show();
        });
    });
    on(commands_[Command::edit], [this] { dialog_->whenMayLeave([this] { open(); }); });
    window_.installEventFilter(this);
    connect(&window_, &MainWindow::languageChosen, this, [this] { comesBack_ = true; });
    if (std::optional<draft::Draft> left = std::exchange(leftBehind(), std::nullopt)) {
        dialog_->takeOver(std::move(*left));
        QTimer::singleShot(0, this, &EditorFeature::show);
    }
}

EditorFeature::~EditorFeature() {
    if (comesBack_ && dialog_->draft().isUnsaved()) leftBehind() = dialog_->draft();
}

/// A draft is asked about before the window closes, as work at a tooth is.
bool EditorFeature::eventFilter(QObject* watched, QEvent* event) {
    if (watched == &window_ && event->type() == QEvent::Close && !mayLeave()) {
        event->ignore();
        return true;
    }
    return QObject::eventFilter(watched, event);
}

bool EditorFeature::isBusy() const {
    return making_ || proving_ || checking_ || cutting_ || again_ || dialog_->isSettling() ||
           dialog_->preparationPage()->isBusy();
}

bool EditorFeature::mayLeave() {
    if (!dialog_->draft().isUnsaved()) return true;
    const Questions::Unsaved answer = askUnsaved();
    if (answer == Questions::Unsaved::cancel) return false;
    if (answer == Questions::Unsaved::save) return save(false);
    dialog_->begin({});  // given up: it is not asked about again
    return true;
}

void EditorFeature::connectDialog() {
    dialog_->whenMayLeave = [this](const std::function<void()>& then) {
        if (mayLeave()) then();
    };
    connect(dialog_, &EditorDialog::saveRequested, this, [this] { save(false); });
    connect(dialog_, &EditorDialog::saveAsRequested, this, [this] { save(true); });
    connect(dialog_, &EditorDialog::tryRequested, this, &EditorFeature::tryOut);
    connect(dialog_, &EditorDialog::settled, this, &EditorFeature::check);
    connect(dialog_, &EditorDialog::viewRequested, this, [this](bool ofPreparation) {
        const view::Camera camera =
            ofPreparation ? dialog_->preparationPage()->camera().value_or(view_.camera()) : view_.camera();
        dialog_->change("", [&](draft::Content& c) {
            c.exercise.view = cases::View{camera.eyeMm, camera.targetMm, camera.up};
        });
    });
    connect(dialog_, &EditorDialog::viewShown, this, [this] {
        const auto& start = dialog_->draft().now().exercise.view;
        if (!start || !view_.hasTooth()) return;
        view_.setCamera(lookingAs(view_.camera(), *start));
        window_.raise();
    });
    connect(dialog_->preparationPage(), &PreparationPage::idealRequested, this, &EditorFeature::cutIdeal);
    connect(dialog_->workPage(), &WorkPage::teacherWorkRequested, this, &EditorFeature::takeTeacherWork);
    connect(dialog_->preparationPage(), &PreparationPage::workRequested, this, &EditorFeature::takeWork);
    connect(dialog_->toothPage(), &ToothPage::starterRequested, this, &EditorFeature::takeStarter);
    connect(dialog_->toothPage(), &ToothPage::caseRequested, this, &EditorFeature::takeCase);
    connect(dialog_->toothPage(), &ToothPage::blockRequested, this, [this](int layers) {
        make(tr("Making the block..."),
             [layers](const core::Progress&) { return starter::makeBlock(static_cast<starter::BlockLayers>(layers)); });
    });
}

void EditorFeature::show() {
    dialog_->show();
    dialog_->raise();
    dialog_->activateWindow();
}

void EditorFeature::open() {
    QString file =
        window_.questions.open(tr("Edit exercise"), tr("Exercises (*.handpiece exercise.toml);;All files (*)"));
    if (file.isEmpty()) return;
    if (file.endsWith(QLatin1String("exercise.toml"))) file = QFileInfo(file).absolutePath();
    simulator_.whenFree([self = QPointer<EditorFeature>(this), path = toPath(file)] {
        if (self)
            self->simulator_.readApart(path, [self, path] {
                if (self) self->edit(path);
            });
    });
}

void EditorFeature::edit(const fs::path& exercise) {
    try {
        dialog_->begin(draft::contentOf(tasks::readTask(exercise)), exercise);
        show();
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
}

void EditorFeature::make(const QString& title, std::function<cases::Case(const core::Progress&)> how) {
    if (making_) return;
    const auto made = std::make_shared<std::shared_ptr<const cases::Case>>();
    dialog_->toothPage()->setWork(title);
    start(
        making_, title,
        [how = std::move(how), made](const core::Progress& progress) {
            *made = std::make_shared<const cases::Case>(how(progress));
        },
        [this] { dialog_->toothPage()->setWork({}); },
        [this, made] {
            dialog_->change("", [&](draft::Content& c) {
                c.tooth = *made;
                c.teacherWork.reset();  // of the tooth before
            });
        });
}

void EditorFeature::start(std::unique_ptr<Job>& job, const QString& title,
                          std::function<void(const core::Progress&)> how, std::function<void()> end,
                          std::function<void()> done) {
    job = std::make_unique<Job>(title, std::move(how));
    const auto ended = [&job, end = std::move(end)] {
        job.release()->deleteLater();
        end();
    };
    connect(job.get(), &Job::done, this, [ended, done = std::move(done)] {
        ended();
        done();
    });
    connect(job.get(), &Job::failed, this, [this, ended](const Problem& problem) {
        ended();
        window_.showProblem(problem);
    });
    connect(job.get(), &Job::cancelled, this, ended);
    job->start();
}

void EditorFeature::takeStarter(int fdi, int seed) {
    Starter starter = simulator_.firstStarter();
    starter.fdi = fdi;
    starter.patient.seed = static_cast<std::uint64_t>(seed);
    make(tr("Making the tooth..."), [starter, folder = simulator_.folders().starters](const core::Progress& progress) {
        return starterCase(starter, folder, progress);
    });
}

void EditorFeature::takeCase() {
    QString file =
        window_.questions.open(tr("Case of the exercise"), tr("Cases (*.handpiece case.toml);;All files (*)"));
    if (file.isEmpty()) return;
    if (file.endsWith(QLatin1String("case.toml"))) file = QFileInfo(file).absolutePath();
    make(tr("Reading the case..."),
         [path = toPath(file), outside = simulator_.outside()](const core::Progress& progress) {
             outside->read(path, progress);
             return cases::readCase(path);
         });
}

void EditorFeature::takeTeacherWork() {
    if (proving_) return;
    const draft::Content now = dialog_->draft().now();
    if (!now.tooth) return window_.showProblem(problemById(QStringLiteral("teacher-work-without-tooth")));
    const QString file = window_.questions.open(tr("Your own work"), tr("Recordings (*.h5);;All files (*)"));
    if (file.isEmpty()) return;
    struct Taken {
        std::shared_ptr<const std::vector<std::byte>> file;
        std::optional<score::Result> result;
    };
    const auto taken = std::make_shared<Taken>();
    const bool isJudged = now.preparation && now.rubric && !draft::hasErrors(dialog_->problems());
    dialog_->workPage()->setTeacherWorkNote(tr("It is cut again..."));
    start(
        proving_, QString(),
        [now, taken, isJudged, path = toPath(file), outside = simulator_.outside()](const core::Progress& progress) {
            const tasks::Task task = draft::taskOf(now);
            outside->read(path, core::part(progress, 0.0, 0.2));
            const assessment::ProvenWork proven = assessment::provenWork(path, task, core::part(progress, 0.2, 0.8));
            taken->file = proven.file;
            // A session does not say of which exercise it is: its points do.
            if (isJudged)
                taken->result = assessment::scoreWork(proven.work, task, *now.rubric, core::part(progress, 0.8, 1.0));
        },
        [this] { dialog_->workPage()->setTeacherWorkNote({}); },
        [this, taken, tooth = now.tooth, voxelMm = now.voxelMm] {
            // What it was proven against may be another by now.
            const draft::Content& is = dialog_->draft().now();
            if (is.tooth != tooth || is.voxelMm != voxelMm)
                return window_.showProblem(problemById(QStringLiteral("teacher-work-too-late")));
            dialog_->change("", [&](draft::Content& c) { c.teacherWork = taken->file; });
            if (!taken->result) return;
            const score::Assessment& judged = taken->result->assessment;
            const QString points = QLocale().toString(judged.score, 'f', 1),
                          most = QLocale().toString(judged.maxScore, 'f', 0);
            dialog_->workPage()->setTeacherWorkPoints(taken->file, tr("%1 of %2 points").arg(points, most));
            if (judged.passed == score::Passed::no)
                window_.showProblem(problemById(QStringLiteral("teacher-work-fails"), {points, most}));
        });
}

void EditorFeature::takeWork() {
    if (making_) return;
    const QString file = window_.questions.open(tr("Work that becomes the target"),
                                                tr("Attempts and sessions (*.handpiece *.h5);;All files (*)"));
    if (file.isEmpty()) return;
    const auto next = std::make_shared<draft::Content>(dialog_->draft().now());
    dialog_->toothPage()->setWork(tr("Reading the work..."));
    dialog_->preparationPage()->setEnabled(false);
    start(
        making_, tr("Reading the work..."),
        [path = toPath(file), next, outside = simulator_.outside()](const core::Progress& progress) {
            outside->read(path, core::part(progress, 0.0, 0.3));
            const std::optional<simulation::CutTeeth> cut =
                simulation::readCutTeeth(path, {}, true, core::part(progress, 0.3, 1.0));
            if (!cut)
                throw core::Error("this is neither a session nor an attempt", path.string(),
                                  "name session.h5, or an attempt's folder or .handpiece file")
                    .as("no-work");
            tooth::ToothMirror mirror(cut->teeth.front());
            mirror.apply(cut->state);
            auto toothCase = std::make_shared<cases::Case>(cut->toothCase);
            toothCase->exercise.reset();
            auto work = std::make_shared<const preparation::RecordedWork>(
                preparation::recordWork(mirror, cut->toothCase.buccalSign));
            *next = draft::withWork(std::move(*next), std::move(toothCase), std::move(work));
        },
        [this] {
            dialog_->toothPage()->setWork({});
            dialog_->preparationPage()->setEnabled(true);
        },
        [this, next] { dialog_->change("", [&](draft::Content& c) { c = std::move(*next); }); });
}

/// One look at a time; what changed meanwhile is looked at after it.
void EditorFeature::check() {
    if (checking_) {
        again_ = true;
        return;
    }
    again_ = false;
    const draft::Content now = dialog_->draft().now();
    if (!now.tooth || !now.preparation) return dialog_->setToothProblems({});
    const auto found = std::make_shared<std::vector<draft::Problem>>();
    checking_ =
        std::make_unique<Job>(QString(), [now, found](const core::Progress&) { *found = draft::problemsOnTooth(now); });
    dialog_->setChecking(true);
    const auto end = [this] {
        checking_.release()->deleteLater();
        dialog_->setChecking(false);
        if (again_) check();
    };
    connect(checking_.get(), &Job::done, this, [this, end, found] {
        dialog_->setToothProblems(*found);
        end();
    });
    connect(checking_.get(), &Job::failed, this, [this, end](const Problem& problem) {
        dialog_->setToothProblems({{draft::Part::preparation,
                                    rubric::Severity::error,
                                    problem.what.toStdString(),
                                    problem.remedy.toStdString(),
                                    {}}});
        end();
    });
    connect(checking_.get(), &Job::cancelled, this, end);
    checking_->start();
}

void EditorFeature::cutIdeal() {
    if (cutting_) return;
    const auto ideal = std::make_shared<course::Parts>();
    const draft::Content now = dialog_->draft().now();
    cutting_ = std::make_unique<Job>(QString(), [now, ideal](const core::Progress& progress) {
        *ideal = course::idealOf(draft::taskOf(now), progress);
    });
    dialog_->preparationPage()->setIdeal(nullptr);
    const auto end = [this] { cutting_.release()->deleteLater(); };
    connect(cutting_.get(), &Job::done, this, [this, end, ideal] {
        end();
        if (*ideal) dialog_->preparationPage()->setIdeal(*ideal);
    });
    connect(cutting_.get(), &Job::failed, this, [this, end](const Problem& problem) {
        end();
        dialog_->preparationPage()->clearIdeal();
        window_.showProblem(problem);
    });
    connect(cutting_.get(), &Job::cancelled, this, end);
    cutting_->start();
}

/// What one made oneself is opened again without being read apart.
void EditorFeature::write(const fs::path& file) {
    const tasks::Task task = draft::taskOf(dialog_->draft().now());
    tasks::writeTask(task, file);
    simulator_.outside()->made(file);
    if (task.teacherWork) simulator_.outside()->made(*task.teacherWork);
}

bool EditorFeature::save(bool elsewhere) {
    fs::path file = dialog_->draft().file();
    if (elsewhere || file.empty()) {
        const QString asked = window_.questions.save(
            tr("Save the exercise"), QString::fromStdString(dialog_->draft().now().id) + QStringLiteral(".handpiece"),
            tr("Exercise (*.handpiece)"), QStringLiteral(".handpiece"));
        if (asked.isEmpty()) return false;
        file = toPath(asked);
    }
    try {
        write(file);
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
        return false;
    }
    dialog_->noteSaved(file);
    window_.tellSaved(toQString(file));
    return true;
}

void EditorFeature::tryOut() {
    fs::path file = dialog_->draft().file();
    try {
        if (dialog_->draft().isUnsaved() || file.empty()) {
            // What was tried before may still be open: a file of its own each time.
            file = toPath(tried_.filePath(QStringLiteral("try-%1.handpiece").arg(++tries_)));
            write(file);
        }
    } catch (const core::Error& error) {
        return window_.showProblem(problemOf(error));
    }
    window_.openFile(toQString(file));
    window_.activateWindow();
}

}  // namespace handpiece::desktop
