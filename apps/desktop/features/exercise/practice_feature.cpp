// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/practice_feature.h"

#include <QDateTime>
#include <QFileDialog>
#include <QFileInfo>
#include <QLocale>
#include <QPushButton>
#include <numeric>
#include <utility>

#include "desktop/features/exercise/assessment_words.h"
#include "desktop/features/exercise/exercise_feature.h"
#include "desktop/features/exercise/exercises_dialog.h"
#include "desktop/features/exercise/progress_dialog.h"
#include "desktop/features/exercise/section_card.h"
#include "desktop/picture/show_view.h"
#include "desktop/picture/start_view.h"
#include "desktop/widgets/parts.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/recording.h"
#include "handpiece/app/assessment/student_page.h"
#include "handpiece/app/course/retest.h"
#include "handpiece/app/report/assessment_pictures.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/attempt.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;
using Command = PracticeFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::exercises, "actionExercises", QT_TRANSLATE_NOOP("Commands", "Exercises..."),
     QT_TRANSLATE_NOOP("Commands", "Choose an exercise: what it asks, the ideal, your best so far"), "exercise",
     "Ctrl+Shift+L", in(Shelf::file, 3), in(Shelf::fileBar, 2), brief(QT_TRANSLATE_NOOP("Commands", "Exercises")),
     exercise::Operation::elsewhere},
    {Command::finish, "actionFinish", QT_TRANSLATE_NOOP("Commands", "Finish"),
     QT_TRANSLATE_NOOP("Commands", "Your work on this exercise is done: it is judged, and you see why"), "check",
     "Ctrl+Shift+W", in(Shelf::file, 9), exercise::Operation::elsewhere},
    {Command::zones, "actionZones", QT_TRANSLATE_NOOP("Commands", "Task in the picture"),
     QT_TRANSLATE_NOOP("Commands", "What is to go and what must stay, as glass over the tooth"), "transparency",
     "Ctrl+Shift+Y", in(Shelf::view, 24), kCheckable, exercise::Operation::transparency},
    {Command::result, "actionResult", QT_TRANSLATE_NOOP("Commands", "Result"),
     QT_TRANSLATE_NOOP("Commands", "The result of the work that was finished last"), "report", "Ctrl+Shift+B",
     in(Shelf::view, 25), exercise::Operation::elsewhere},
    {Command::progress, "actionProgress", QT_TRANSLATE_NOOP("Commands", "Progress..."),
     QT_TRANSLATE_NOOP("Commands", "Your results over the attempts at each exercise"), "plot", "Ctrl+Shift+H",
     in(Shelf::view, 26), exercise::Operation::elsewhere},
};
// A way into the seconds in which something happened, and out of them.
constexpr double kBeforeS = 1.5, kAfterS = 1.5;

}  // namespace

PracticeFeature::PracticeFeature(const FeatureContext& context, ExerciseFeature& exercise)
    : Feature(context),
      exercise_(exercise),
      commands_(window_.commands(), kCommands),
      exercises_(new ExercisesDialog(simulator_.folders().starters, &window_)),
      result_(new ResultDialog(&window_)),
      back_(named(new QPushButton(tr("Back to the result")), "resultBack", tr("Back to the result"))),
      section_(new SectionCard),
      progress_(new ProgressDialog(&window_)) {
    openDialogs();
    back_->hide();
    view_.addStrip(back_);
    view_.addStrip(section_, StripStack::Where::corner);
    connect(back_, &QPushButton::clicked, commands_[Command::result], &QAction::trigger);
    Commands& commands = window_.commands();
    on(commands_[Command::exercises], [this] {
        readDue();
        exercises_->show();
        exercises_->raise();
        exercises_->activateWindow();
    });
    on(commands_[Command::finish], [this] { simulator_.finish(); });
    on(commands_[Command::result], [this] {
        result_->show();
        result_->raise();
    });
    on(commands_[Command::progress], [this] { showProgress(); });
    commands.enableWhile(commands_[Command::finish], [this] {
        return !simulator_.isBusy() && simulator_.isRecorded() && simulator_.task() &&
               !simulator_.task()->rubric.empty();
    });
    commands.enableWhile(commands_[Command::zones], [this] {
        return simulator_.mode() == Simulator::Mode::liveSession && simulator_.task() && simulator_.task()->preparation;
    });
    connect(commands_[Command::zones], &QAction::toggled, this, &PracticeFeature::showZones);
    const auto showGlass = [this] {
        std::vector<view::GlassSurface> all = glass_.surfaces();
        all.insert(all.end(), work_.surfaces().begin(), work_.surfaces().end());
        view_.setGlass(std::move(all));
    };
    connect(&glass_, &ZoneGlass::changed, this, showGlass);
    connect(&work_, &WorkGlass::changed, this, showGlass);
    connect(&glass_, &ZoneGlass::refused, &window_, &MainWindow::showProblem);
    commands.enableWhile(commands_[Command::result], [this] { return done_ != nullptr; });
    connect(&simulator_, &Simulator::finished, this, &PracticeFeature::take);
    window_.openersBeside.push_back([this](const QFileInfo& info) {
        if (!info.isFile() || info.suffix().compare(QLatin1String("json"), Qt::CaseInsensitive) != 0) return false;
        takeReturned(toPath(info.absoluteFilePath()));
        return true;
    });
    window_.openers.push_back([this](const QString& file) {
        try {
            if (!tasks::isTask(toPath(file))) return false;
        } catch (const core::Error&) {
            return false;  // whoever opens it tells what is wrong
        }
        simulator_.openExercise(toPath(file));
        return true;
    });
}

void PracticeFeature::openDialogs() {
    exercises_->dueOf = [this](const std::string& id) {
        const auto at = due_.find(id);
        return at == due_.end() ? std::vector<std::string>() : at->second;
    };
    exercises_->reachedAt = [this](const std::string& id) { return reachedAt(id); };
    if (const QString folder = settings_.value(QStringLiteral("exercises/folder")).toString(); !folder.isEmpty())
        exercises_->setFolder(toPath(folder));
    else if (!simulator_.casesFolder().empty())
        exercises_->setFolder(simulator_.casesFolder());
    connect(exercises_, &ExercisesDialog::beginRequested, this, &PracticeFeature::begin);
    connect(exercises_, &ExercisesDialog::folderRequested, this, [this] {
        const QString folder = QFileDialog::getExistingDirectory(exercises_, tr("A folder with exercises"),
                                                                 window_.questions.startFolder());
        if (folder.isEmpty()) return;
        settings_.set(QStringLiteral("exercises/folder"), folder);
        exercises_->setFolder(toPath(folder));
    });
    connect(result_, &ResultDialog::opened, back_, &QWidget::hide);
    connect(result_, &QDialog::finished, this, [this] { back_->setVisible(!section_->isHidden()); });
    connect(result_, &ResultDialog::judged, this, [this](const OwnJudgement& own) { keep(own); });
    connect(result_, &ResultDialog::evidenceChosen, this, &PracticeFeature::showEvidence);
    connect(result_, &ResultDialog::teacherWorkRequested, this, &PracticeFeature::showTeacherWork);
    connect(result_, &ResultDialog::pageRequested, this, &PracticeFeature::savePage);
    connect(result_, &ResultDialog::againRequested, this, &PracticeFeature::again);
    connect(result_, &ResultDialog::handInRequested, this, &PracticeFeature::handIn);
    connect(progress_, &ProgressDialog::resultRequested, this, [this](const QString& id) { openResult(id); });
    connect(progress_, &ProgressDialog::handInRequested, this,
            [this](const QString& id) { openResult(id, [this] { handIn(); }); });
    connect(progress_, &ProgressDialog::returnedRequested, this, [this] {
        const QString file = window_.questions.open(tr("Marks from your teacher"), tr("Marks (*.json);;All files (*)"));
        if (!file.isEmpty()) takeReturned(toPath(file));
    });
    connect(result_, &ResultDialog::practiseRequested, this, [this](const QString& id) {
        readDue();
        exercises_->show();
        exercises_->raise();
        exercises_->chooseExercise(id.toStdString());
    });
    connect(result_, &ResultDialog::nextRequested, this, [this] {
        readDue();
        exercises_->show();
        exercises_->raise();
        exercises_->chooseAfter(done_->work.task->id);
    });
}

school::Store* PracticeFeature::store() {
    if (store_) return store_.get();
    try {
        store_ = std::make_unique<school::Store>(simulator_.folders().sessions.parent_path() / "results.db");
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
    return store_.get();
}

void PracticeFeature::begin(const fs::path& path, bool unaided) {
    window_.whenMayLeave([this, path, unaided] {
        exercises_->hide();
        result_->close();
        simulator_.openExercise(path, unaided);
    });
}

void PracticeFeature::again() {
    if (core::isThere(done_->taskPath)) return begin(done_->taskPath);
    // It lies elsewhere by now: in the list, perhaps.
    commands_[Command::exercises]->trigger();
}

void PracticeFeature::readDue() {
    due_.clear();
    school::Store* kept = store();
    if (!kept) return;
    try {
        for (const school::Retest& retest : kept->retests())
            if (retest.due <= QDateTime::currentMSecsSinceEpoch()) due_[retest.exercise].push_back(retest.criterion);
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
}

void PracticeFeature::showDocument() {
    stopAtS_.reset();
    const auto& task = simulator_.task();
    const bool isAtWork = task && simulator_.mode() == Simulator::Mode::liveSession;
    if (simulator_.mode() != Simulator::Mode::replay) {
        back_->hide();
        hideSection();
    }
    const bool isGiven =
        isAtWork && task->preparation && !simulator_.permissions().locks(exercise::Operation::transparency);
    // What is asked is seen from the beginning; by oneself it is not, nor where an exercise locks it.
    commands_[Command::zones]->setChecked(isGiven && !isUnaided(*task) && !simulator_.exam());
    showZones();
    if (!isAtWork || simulator_.exam()) return;
    if (school::Store* kept = store()) {
        const auto now = QDateTime::currentMSecsSinceEpoch();
        const QString title = task->toothCase.exercise ? inThisLanguage(task->toothCase.exercise->title) : QString();
        try {
            // An attempt that is resumed is not where its exercise is.
            const fs::path& path = simulator_.document().taskPath;
            kept->see({task->id, task->version, rubric::hashText(tasks::contentHash(*task)), title.toStdString(), now,
                       now, cases::isAttempt(path) ? std::string() : path.string()});
        } catch (const core::Error& error) {
            window_.showProblem(problemOf(error));
        }
    }
}

void PracticeFeature::showZones() {
    const auto& task = simulator_.task();
    glass_.setZones({preparation::SeenZone::protectedZone});
    if (commands_[Command::zones]->isChecked() && task && task->preparation) {
        glass_.show(std::shared_ptr<const cases::Case>(task, &task->toothCase), *task->preparation);
        work_.watch(task, simulator_.tooth());
    } else {
        glass_.hide();
        work_.stop();
    }
}

void PracticeFeature::showTick() {
    if (work_.isWatching()) {
        const auto& removed = simulator_.sample().removedMm3;
        work_.tell(std::accumulate(std::begin(removed), std::end(removed), 0.0));
    }
    if (!stopAtS_ || simulator_.mode() != Simulator::Mode::replay || !simulator_.replay()) return;
    const ReplayNow now = simulator_.replay()->now();
    if (now.seeking || now.timeS < *stopAtS_) return;
    simulator_.play(false);
    stopAtS_.reset();
}

void PracticeFeature::take(const Simulator::Finished& done) {
    done_ = std::make_shared<const Simulator::Finished>(done);
    result_->setResult(done_, nullptr, done.work.task->ownJudgement);
    keep();
    makeIdeal();
    result_->show();
    result_->raise();
    result_->activateWindow();
}

/// Before it is seen: nothing that happens from here on loses it.
void PracticeFeature::keep() {
    attempt_.clear();
    school::Store* kept = store();
    if (!kept) return;
    const score::Result& result = done_->work.result;
    school::Attempt attempt;
    attempt.id = school::newId();
    attempt.exercise = result.identity.exercise;
    attempt.exerciseHash = result.identity.exerciseHash;
    attempt.rubricHash = rubric::hashText(result.assessment.rubricHash);
    attempt.sessionHashes = result.identity.sessionHashes;
    attempt.recordings = done_->recordings;
    attempt.began = done_->began;
    attempt.finished = done_->finished;
    attempt.device = result.assessment.context.device;
    attempt.motionScale = result.assessment.context.motionScale;
    attempt.score = result.assessment.score;
    attempt.maxScore = result.assessment.maxScore;
    attempt.wholeScore = result.assessment.wholeScore;
    attempt.passed = score::nameOf(result.assessment.passed);
    attempt.borderline = result.assessment.borderline;
    attempt.proven = result.identity.proven;
    attempt.workedS = done_->workedS;
    attempt.limitS = 60.0 * done_->work.task->minutes.value_or(0.0);
    attempt.result = assessment::resultJson(result.assessment, result.identity);
    try {
        kept->add(attempt, course::nextRetests(kept->retests(attempt.exercise), attempt, result.assessment,
                                               isUnaided(*done_->work.task)));
        attempt_ = attempt.id;
        simulator_.forget(*done_);
    } catch (const core::Error& error) {
        // The recording stays marked: the next start offers it.
        window_.showProblem(problemOf(error));
    }
}

void PracticeFeature::keep(const OwnJudgement& own) {
    if (attempt_.empty()) return;
    try {
        store()->add(
            school::Judgement{attempt_, own.percent, own.words.toStdString(), QDateTime::currentMSecsSinceEpoch()});
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
}

void PracticeFeature::openResult(const QString& id, std::function<void()> then) {
    school::Store* kept = store();
    if (!kept || older_) return;
    std::optional<school::Attempt> attempt;
    std::vector<school::Exercise> exercises;
    try {
        attempt = kept->attempt(id.toStdString());
        exercises = kept->exercises();
    } catch (const core::Error& error) {
        return window_.showProblem(problemOf(error));
    }
    if (!attempt) return;
    school::Exercise of{attempt->exercise, 1, {}, {}, 0, 0, {}};
    for (const school::Exercise& exercise : exercises)
        if (exercise.id == attempt->exercise && (of.hash != attempt->exerciseHash || of.place.empty())) of = exercise;
    const auto done = std::make_shared<Simulator::Finished>();
    older_ = new Job(
        tr("Opening the result"),
        [done, attempt, of, sessions = simulator_.folders().sessions](const core::Progress& progress) {
            auto task = std::make_shared<tasks::Task>();
            try {
                if (!of.place.empty() && core::isThere(of.place)) *task = tasks::readTask(of.place);
            } catch (const core::Error&) {
                *task = {};  // it is another file by now: the result stands without it
            }
            if (task->id != attempt->exercise) *task = {};
            if (task->id.empty()) {
                task->id = attempt->exercise;
                task->toothCase.exercise.emplace();
                task->toothCase.exercise->title = {{"en", of.title}};
            }
            if (attempt->limitS > 0.0) task->minutes = attempt->limitS / 60.0;
            std::vector<assessment::ChainLink> chain;
            for (const std::string& name : attempt->recordings)
                chain.push_back({name, sessions / name, false});
            done->work = course::reopen(assessment::parseResult(attempt->result, "results.db"), chain, task, progress);
            done->taskPath = of.place;
            done->recordings = attempt->recordings;
            done->began = attempt->began;
            done->finished = attempt->finished;
            done->workedS = attempt->workedS;
        },
        this);
    connect(older_, &Job::done, this, [this, done, attempt, then = std::move(then)] {
        std::exchange(older_, nullptr)->deleteLater();
        showOlder(*attempt, done);
        if (then) then();
    });
    connect(older_, &Job::failed, this, [this](const Problem& problem) {
        std::exchange(older_, nullptr)->deleteLater();
        window_.showProblem(problem);
    });
    older_->start();
}

void PracticeFeature::showOlder(const school::Attempt& attempt, std::shared_ptr<const Simulator::Finished> done) {
    done_ = std::move(done);
    attempt_ = attempt.id;
    result_->setResult(done_, nullptr, false);
    std::optional<OwnJudgement> own;
    std::vector<school::Comment> comments;
    std::vector<marking::ReturnedMarks> returned;
    try {
        if (const auto said = store_->judgementOf(attempt.id))
            own = OwnJudgement{said->percent, QString::fromStdString(said->words)};
        comments = store_->commentsOn(attempt.id);
        for (const school::Returned& one : store_->returnedOf(attempt.id))
            returned.push_back(marking::parseReturned(one.marks, "results.db"));
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
    result_->setSaid(std::move(own), comments, std::move(returned));
    makeIdeal();
    result_->show();
    result_->raise();
    result_->activateWindow();
}

/// Kept with the attempt that they are of, and shown.
void PracticeFeature::takeReturned(const fs::path& file) {
    school::Store* kept = store();
    if (!kept) return;
    try {
        const std::vector<std::byte> bytes = core::readFile(file, marking::kMaxReturnedBytes);
        const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        const marking::ReturnedMarks marks = marking::parseReturned(text, file.string());
        std::string of;
        for (const school::Attempt& attempt : kept->attempts(marks.exercise))
            if (areOf(marks, assessment::parseResult(attempt.result, "results.db").identity)) of = attempt.id;
        if (of.empty())
            throw core::Error("these marks are of no work that was finished here", file.string(),
                              "open them where that work was finished")
                .as("returned-of-another", {marks.exercise});
        kept->add(school::Returned{of, marks.marker, text, QDateTime::currentMSecsSinceEpoch()});
        openResult(QString::fromStdString(of));
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
}

/// And what else there is to look at beside one's own work.
void PracticeFeature::makeIdeal() {
    struct Beside {
        course::Parts ideal;
        std::shared_ptr<const std::vector<std::byte>> teacherWork;
    };
    teacherWork_.reset();
    teacherFolder_.reset();
    const auto beside = std::make_shared<Beside>();
    ideal_ = std::make_unique<Job>(
        tr("Cutting the ideal"), [beside, task = done_->work.task, from = done_->taskPath,
                                  place = placeOf(*done_->work.task)](const core::Progress& progress) {
            beside->teacherWork = task->teacherWork;
            // What was resumed from an attempt came without it.
            if (!beside->teacherWork && !place.empty() && place != from && core::isThere(place)) {
                try {
                    if (const tasks::Task there = tasks::readTask(place);
                        tasks::contentHash(there) == tasks::contentHash(*task))
                        beside->teacherWork = there.teacherWork;
                } catch (const core::Error&) {
                    beside->teacherWork.reset();  // it is another file by now
                }
            }
            beside->ideal = course::idealOf(*task, progress);
        });
    connect(ideal_.get(), &Job::done, this, [this, beside, of = done_] {
        if (done_ != of) return;
        teacherWork_ = beside->teacherWork;
        result_->setHasTeacherWork(teacherWork_ != nullptr);
        result_->setIdeal(beside->ideal, tr("This exercise asks for no preparation: there is no ideal."));
    });
    connect(ideal_.get(), &Job::failed, this, [this, beside, of = done_](const Problem& problem) {
        if (done_ != of) return;
        teacherWork_ = beside->teacherWork;
        result_->setHasTeacherWork(teacherWork_ != nullptr);
        result_->setIdeal({}, tr("The ideal cannot be shown. %1").arg(problem.what));
    });
    result_->setIdeal({}, tr("The ideal is being cut: it can be chosen in some seconds."));
    ideal_->start();
}

/// Of the exercise's folder or file when it was seen last; empty: not known.
fs::path PracticeFeature::placeOf(const tasks::Task& task) {
    fs::path place;
    try {
        if (school::Store* kept = store())
            for (const school::Exercise& exercise : kept->exercises())
                if (exercise.id == task.id && exercise.hash == rubric::hashText(tasks::contentHash(task)))
                    place = exercise.place;
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
    return place;
}

/// From where one worked: as the exercise begins, else from above.
void PracticeFeature::turnTo(const core::Vec3& placeMm) {
    const report::Bearings& bearings = done_->work.bearings;
    const core::Box& box = simulator_.tooth()->model().outer.bounds();
    view::Camera worked =
        view::standardView(view::StandardView::occlusal, box, view::standingOf(bearings.fdi, bearings.buccalSign),
                           {std::max(1, view_.width()), std::max(1, view_.height())});
    if (const auto& exercise = done_->work.task->toothCase.exercise; exercise && exercise->view)
        worked = lookingAs(worked, *exercise->view);
    const core::Vec3 middle = bearings.asked.isEmpty() ? box.centre() : bearings.asked.centre();
    view_.setCamera(lookingAtPlace(placeMm, bearings.draw, middle, worked));
}

/// On a small screen the result lies over what it shows.
void PracticeFeature::makeRoom() {
    const QRect picture(view_.mapToGlobal(QPoint(0, 0)), view_.size());
    QRect middle(0, 0, picture.width() / 2, picture.height() / 2);
    middle.moveCenter(picture.center());
    if (!result_->isVisible() || !result_->frameGeometry().intersects(middle)) return;
    result_->hide();
    back_->show();
}

void PracticeFeature::showEvidence(const measures::Evidence& evidence, const QString& words) {
    if (!done_) return;
    // Of a chain the one in which it happened.
    const std::vector<assessment::Recording>& chain = done_->work.work.recordings;
    const fs::path session =
        evidence.timeS && evidence.session < chain.size() ? chain[evidence.session].path : done_->work.session;
    if (!session.empty()) show(session, evidence, words, false);  // else it is no longer kept, which the result tells
}

/// Opened where another lies open.
void PracticeFeature::show(const fs::path& session, const measures::Evidence& evidence, const QString& words,
                           bool playsWhole) {
    if (simulator_.mode() != Simulator::Mode::replay || simulator_.document().caseFile != session) {
        window_.whenMayLeave([this, session, evidence, words, playsWhole] {
            simulator_.open(session);
            simulator_.whenFree([this, session, evidence, words, playsWhole] {
                if (simulator_.mode() == Simulator::Mode::replay && simulator_.document().caseFile == session)
                    show(session, evidence, words, playsWhole);
            });
        });
        return;
    }
    makeRoom();
    if (evidence.placeMm) turnTo(*evidence.placeMm);
    view_.setMark(evidence.placeMm, words);
    showIdealGlass();
    hideSection();
    if (evidence.placeMm && !playsWhole) showSection(*evidence.placeMm);
    const double endS = simulator_.replay()->durationS();
    if (evidence.timeS) {
        simulator_.seek(std::max(0.0, *evidence.timeS - kBeforeS));
        stopAtS_ = std::min(endS, *evidence.timeS + kAfterS);
        simulator_.play(true);
    } else {
        stopAtS_.reset();
        simulator_.seek(playsWhole ? 0.0 : endS);
        simulator_.play(playsWhole);
    }
}

/// The ideal over one's own cut: what still stands in it is seen through it, what is gone beyond it lies outside.
void PracticeFeature::showIdealGlass() {
    const std::shared_ptr<const tasks::Task>& task = done_->work.task;
    if (!task->preparation || task->toothCase.parts.empty()) return;
    glass_.setZones({preparation::SeenZone::target});
    glass_.show(std::shared_ptr<const cases::Case>(task, &task->toothCase), *task->preparation);
}

/// Of the work as it was finished, whatever second of it is played.
void PracticeFeature::showSection(const core::Vec3& placeMm) {
    if (done_->work.work.teeth.empty()) return;
    const auto made = std::make_shared<std::optional<report::PlaceSection>>();
    sectioning_ = new Job(
        tr("Drawing the section"),
        [done = done_, placeMm, made](const core::Progress&) {
            const course::FinishedWork& work = done->work;
            tooth::ToothMirror own(work.work.teeth.front());
            own.apply(work.work.state);
            *made = report::placeSection(*work.task, own, work.bearings, placeMm);
        },
        this);
    connect(sectioning_, &Job::done, this, [this, made, done = done_] {
        std::exchange(sectioning_, nullptr)->deleteLater();
        if (!*made) return;
        section_->setSection(std::move(**made), done->work.bearings, view_.camera().right());
        section_->show();
    });
    connect(sectioning_, &Job::failed, this, [this](const Problem& problem) {
        std::exchange(sectioning_, nullptr)->deleteLater();
        window_.showProblem(problem);
    });
    sectioning_->start();
}

void PracticeFeature::hideSection() {
    if (sectioning_) std::exchange(sectioning_, nullptr)->abandon(this);
    section_->hide();
}

/// When the teacher's bur cut at this place, where it did.
void PracticeFeature::showTeacherWork(const std::optional<measures::Evidence>& at) {
    if (!teacherWork_ || findingTeacher_) return;
    const auto there = std::make_shared<measures::Evidence>();
    if (at) there->placeMm = at->placeMm;
    if (!teacherFolder_) teacherFolder_ = std::make_shared<const core::PrivateFolder>();
    const fs::path session = teacherFolder_->path() / tasks::kTeacherWorkFile;
    findingTeacher_ = new Job(
        tr("Looking into your teacher's work"),
        [there, session, work = teacherWork_, voxelMm = done_->work.task->voxelMm,
         outside = simulator_.outside()](const core::Progress& progress) {
            if (!core::isThere(session)) core::writeFile(session, *work, {true, false});
            outside->read(session, progress);
            if (!there->placeMm) return;
            std::vector<measures::Measured> place(1);
            place.front().evidence.push_back(*there);
            const assessment::Recording recording{session, session.filename().string(), {}, {}};
            static_cast<void>(assessment::readRecord(std::span(&recording, 1), place, voxelMm, {}, {}, progress));
            *there = place.front().evidence.front();
        },
        this);
    connect(findingTeacher_, &Job::done, this, [this, there, session, folder = teacherFolder_] {
        std::exchange(findingTeacher_, nullptr)->deleteLater();
        if (folder == teacherFolder_) show(session, *there, {}, true);
    });
    connect(findingTeacher_, &Job::failed, this, [this](const Problem& problem) {
        std::exchange(findingTeacher_, nullptr)->deleteLater();
        window_.showProblem(problem);
    });
    findingTeacher_->start();
}

std::optional<Reached> PracticeFeature::reachedAt(const std::string& id) {
    school::Store* kept = store();
    if (!kept) return {};
    try {
        return reachedIn(kept->attempts(id));
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
    return {};
}

void PracticeFeature::showProgress() {
    school::Store* kept = store();
    if (!kept) return;
    try {
        progress_->setResults(kept->exercises(), kept->attempts(), done_ ? done_->work.task->id : std::string());
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
        return;
    }
    progress_->show();
    progress_->raise();
}

/// Beside everything else, one thing at a time; `told` once it is there.
void PracticeFeature::write(const QString& title, const QString& told, const QString& file, Job::Work work) {
    if (file.isEmpty() || writing_) return;
    result_->setNote(title, true);
    writing_ = new Job(title, std::move(work), this);
    const auto end = [this](const QString& words) {
        std::exchange(writing_, nullptr)->deleteLater();
        result_->setNote(words);
    };
    connect(writing_, &Job::done, this, [this, end, file, told] {
        end(told);
        window_.tellSaved(file);
    });
    connect(writing_, &Job::failed, this, [this, end](const Problem& problem) {
        end(QStringList{problem.what, problem.remedy}.join(QLatin1Char(' ')).trimmed());
        window_.showProblem(problem);
    });
    writing_->start();
}

void PracticeFeature::savePage() {
    if (!done_ || writing_) return;
    const QString file =
        window_.questions.save(tr("Save the result"), QString::fromStdString(done_->work.task->id) + ".html",
                               tr("Page (*.html)"), QStringLiteral(".html"));
    write(tr("Writing the page"), tr("Written: %1").arg(file), file,
          [done = done_, path = toPath(file)](const core::Progress& progress) {
              const course::FinishedWork& work = done->work;
              const report::AssessmentPictures pictures =
                  report::assessmentPictures(*work.task, work.work.teeth, work.work.state, work.result.assessment,
                                             work.rubric, {}, core::part(progress, 0.0, 0.3));
              core::writeFile(path,
                              assessment::studentPage(work.work, work.result, *work.task, work.rubric, pictures, true,
                                                      core::part(progress, 0.3, 1.0)),
                              {true, true});
          });
}

void PracticeFeature::handIn() {
    if (!done_ || writing_) return;
    if (done_->work.work.teeth.empty()) return window_.showProblem(problemById(QStringLiteral("nothing-to-hand-in")));
    if (!exercise_.askCode()) return;
    course::HandInWords words;
    words.student = simulator_.code().toStdString();
    try {
        if (school::Store* kept = attempt_.empty() ? nullptr : store())
            if (const auto own = kept->judgementOf(attempt_)) {
                words.expectedPercent = own->percent;
                words.expectedWords = own->words;
            }
    } catch (const core::Error& error) {
        return window_.showProblem(problemOf(error));
    }
    QString name = QString::fromStdString(done_->work.task->id);
    if (!simulator_.code().isEmpty()) name += QLatin1Char('-') + simulator_.code();
    const QString file =
        window_.questions.save(tr("Hand in"), name + QStringLiteral(".handpiece"),
                               tr("Attempt with its tooth (*.handpiece)"), QStringLiteral(".handpiece"));
    const std::size_t recordings = done_->work.work.recordings.size();
    const QString told =
        recordings > 0 ? tr("Handed in: %1, with its tooth. Recordings in it: %2. Give this file to your teacher.")
                             .arg(file, QLocale().toString(recordings))
                       : tr("Handed in: %1, with its tooth. No recordings are in it, because one of them is missing. "
                            "Give this file to your teacher.")
                             .arg(file);
    write(tr("Handing in"), told, file,
          [done = done_, words, path = toPath(file), outside = simulator_.outside()](const core::Progress&) {
              for (const assessment::Recording& one : done->work.work.recordings)
                  outside->made(one.path);
              course::handIn(done->work, words, path);
              outside->made(path);
          });
}

}  // namespace handpiece::desktop
