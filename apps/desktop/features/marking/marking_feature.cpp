// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/marking/marking_feature.h"

#include <QDir>
#include <QDockWidget>
#include <QFileDialog>
#include <QFileInfo>
#include <QKeyEvent>
#include <QMouseEvent>

#include "desktop/features/marking/agreement_page.h"
#include "desktop/features/marking/sheet_panel.h"
#include "desktop/work/simulator.h"
#include "handpiece/app/assessment/marks_agreement.h"
#include "handpiece/app/assessment/score_work.h"
#include "handpiece/app/marking/desk_csv.h"
#include "handpiece/app/marking/returned_marks.h"
#include "handpiece/app/sandboxed/sandboxed.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/senses/view/occlusal.h"

namespace handpiece::desktop {
namespace {

namespace fs = std::filesystem;

using Command = MarkingFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::desk, "actionMarkingDesk", QT_TRANSLATE_NOOP("Commands", "Marking desk..."),
     QT_TRANSLATE_NOOP("Commands", "For teachers: score, look at and mark a folder of returned work"), "check",
     "Ctrl+Shift+T", in(Shelf::tools, 40), exercise::Operation::elsewhere},
};

/// A folder that holds what students give back, and is no case, attempt or exercise itself.
bool mayBeReturnedWork(const QFileInfo& info) {
    if (!info.isDir()) return false;
    const QDir folder(info.absoluteFilePath());
    for (const char* own : {"case.toml", "attempt.toml", "exercise.toml"})
        if (folder.exists(QLatin1String(own))) return false;
    if (!folder.entryList({QStringLiteral("*.h5"), QStringLiteral("*.handpiece")}, QDir::Files).isEmpty()) return true;
    for (const QString& below : folder.entryList(QDir::Dirs | QDir::NoDotAndDotDot)) {
        const QDir inner(folder.filePath(below));
        if (inner.exists(QStringLiteral("attempt.toml")) || inner.exists(QStringLiteral("result.json")) ||
            !inner.entryList({QStringLiteral("*.h5"), QStringLiteral("*.handpiece")}, QDir::Files).isEmpty())
            return true;
    }
    return false;
}

/// Where results are kept, so that a desk that is opened again has them at once.
constexpr const char* kKept = ".marking";
/// How near the eye comes to a place.
constexpr double kNearMm = 30.0;
/// Wide enough for the criteria; high enough for what the work says of itself.
constexpr int kSheetPixels = 380, kAboutPixels = 90;

}  // namespace

MarkingFeature::MarkingFeature(const FeatureContext& context)
    : Feature(context),
      commands_(window_.commands(), kCommands),
      dialog_(new DeskDialog(&window_)),
      sheet_(new SheetPanel) {
    askFolder = [this](const QString& title) {
        return QFileDialog::getExistingDirectory(dialog_, title, window_.questions.startFolder());
    };
    dock_ = window_.docks().add({"markingDock",
                                 tr("Marking"),
                                 12,
                                 {{Detail::practice, Qt::LeftDockWidgetArea, 36, 510, "drillDock"},
                                  {Detail::laboratory, Qt::LeftDockWidgetArea, 36, 510, "drillDock"},
                                  {Detail::paper, Qt::LeftDockWidgetArea, 36, 510, "drillDock"}},
                                 [this] { return isWanted_; }},
                                sheet_);
    connect(dock_->toggleViewAction(), &QAction::triggered, this, [this](bool shown) { isWanted_ = shown; });
    on(commands_[Command::desk], [this] { open(); });
    window_.openersBeside.push_back([this](const QFileInfo& info) {
        if (!mayBeReturnedWork(info)) return false;
        open(info.absoluteFilePath());
        return true;
    });
    dialog_->setMarker(settings_.value(QStringLiteral("marking/marker")).toString());
    // Where one was, also after the language was changed, which makes the window anew.
    if (const QString folder = settings_.value(QStringLiteral("marking/folder")).toString();
        !folder.isEmpty() && QFileInfo(folder).isDir()) {
        dialog_->setFolder(folder);
        dialog_->setExercise(settings_.value(QStringLiteral("marking/exercise")).toString());
        dialog_->setBlind(settings_.value(QStringLiteral("marking/blind")).toBool());
    }
    connect(dialog_, &DeskDialog::folderRequested, this, [this] {
        if (const QString folder = askFolder(tr("Folder of the returned work")); !folder.isEmpty()) open(folder);
    });
    connect(dialog_, &DeskDialog::exerciseRequested, this, [this] {
        const QString file =
            window_.questions.open(tr("Exercise"), tr("Exercises (*.handpiece exercise.toml);;All files (*)"));
        if (!file.isEmpty())
            dialog_->setExercise(file.endsWith(QLatin1String("exercise.toml")) ? QFileInfo(file).absolutePath() : file);
    });
    connect(dialog_, &DeskDialog::rubricRequested, this, [this] {
        const QString file = window_.questions.open(tr("Rubric"), tr("Rubrics (*.toml);;All files (*)"));
        if (!file.isEmpty()) dialog_->setRubricFile(file);
    });
    connect(dialog_, &DeskDialog::beginRequested, this, [this] {
        wish_ = dialog_->wish();
        begin();
    });
    connect(dialog_, &DeskDialog::scoreRequested, this, &MarkingFeature::begin);
    connect(dialog_, &DeskDialog::cancelRequested, this, [this] {
        if (job_) job_->cancel();
    });
    connect(dialog_, &DeskDialog::openRequested, this, &MarkingFeature::openWork);
    connect(dialog_, &DeskDialog::exportRequested, this, &MarkingFeature::write);
    connect(dialog_, &DeskDialog::agreementRequested, this, &MarkingFeature::computeAgreement);
    connect(sheet_, &SheetPanel::stepRequested, this, [this](int step) {
        if (const QString code = dialog_->beside(code_, step); !code.isEmpty()) openWork(code);
    });
    connect(sheet_, &SheetPanel::tableRequested, this, [this] { open(); });
    connect(sheet_, &SheetPanel::markRequested, this, [this](const std::string& id, const marking::Mark& mark) {
        tryTo([&](marking::Desk& desk) { desk.setMark(code_.toStdString(), id, mark); });
    });
    connect(sheet_, &SheetPanel::giveInRequested, this,
            [this] { tryTo([this](marking::Desk& desk) { desk.giveIn(code_.toStdString()); }); });
    connect(sheet_, &SheetPanel::overrideRequested, this, [this](const std::string& id, const marking::Override& said) {
        tryTo([&](marking::Desk& desk) { desk.override(code_.toStdString(), id, said); });
    });
    connect(sheet_, &SheetPanel::withdrawRequested, this, [this](const std::string& id) {
        tryTo([&](marking::Desk& desk) { desk.withdraw(code_.toStdString(), id); });
    });
    connect(sheet_, &SheetPanel::decisionRequested, this, [this](const std::optional<marking::Decision>& decision) {
        tryTo([&](marking::Desk& desk) { desk.decide(code_.toStdString(), decision); });
    });
    connect(sheet_, &SheetPanel::placeWanted, this, [this](bool wanted) {
        isPlaceWanted_ = wanted;
        if (wanted) view_.setFocus();
    });
    view_.installEventFilter(this);
    connect(sheet_, &SheetPanel::commentRequested, this, &MarkingFeature::comment);
    connect(sheet_, &SheetPanel::commentRemoved, this, [this](int number) {
        tryTo([&](marking::Desk& desk) { desk.removeComment(code_.toStdString(), number); });
    });
    connect(sheet_, &SheetPanel::returnRequested, this, &MarkingFeature::returnWork);
    connect(sheet_, &SheetPanel::placeRequested, this, &MarkingFeature::goTo);
}

MarkingFeature::~MarkingFeature() {
    // They tell of their work here: they end first.
    for (const QPointer<Job>& job : {job_, agreementJob_, copyJob_})
        delete job;
}

/// A click that says where a comment belongs; Escape gives that up.
bool MarkingFeature::eventFilter(QObject* watched, QEvent* event) {
    if (watched != &view_ || !isPlaceWanted_) return Feature::eventFilter(watched, event);
    if (event->type() == QEvent::KeyPress && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
        forgetPlace();
        return true;
    }
    if (event->type() != QEvent::MouseButtonPress) return Feature::eventFilter(watched, event);
    const auto* press = static_cast<QMouseEvent*>(event);
    if (press->button() != Qt::LeftButton) return Feature::eventFilter(watched, event);
    if (const auto place = placeUnder(press->position())) {
        pickedMm_ = place;
        pickedS_.reset();
        if (simulator_.mode() == Simulator::Mode::replay && simulator_.replay())
            pickedS_ = simulator_.replay()->now().timeS;
        sheet_->setPlace(place);
    }
    return true;
}

std::optional<core::Vec3> MarkingFeature::placeUnder(const QPointF& point) const {
    std::optional<core::Vec3> place;
    if (!simulator_.tooth()) return place;
    view::Viewport port{view_.width(), view_.height()};
    core::Vec2 pixel(point.x(), point.y());
    if (view_.isComparing()) {  // one eye, two halves
        port.width = std::max(1, port.width / 2);
        if (pixel.x() >= port.width) pixel.x() -= port.width;
    }
    const view::Ray ray = view::rayThrough(view_.camera(), port, pixel);
    simulator_.tooth()->withProbe([&](const measure::ToothProbe& probe) {
        if (const auto hit = probe.cast(ray.originMm, ray.direction)) place = hit->pointMm;
    });
    return place;
}

void MarkingFeature::forgetPlace() {
    pickedMm_.reset();
    pickedS_.reset();
    sheet_->setPlace({});
}

void MarkingFeature::open(const QString& folder) {
    if (!folder.isEmpty()) {
        // The exercise of another folder is not this one's.
        bool isTaken = toPath(folder) == toPath(dialog_->wish().folder) && !dialog_->wish().exercise.isEmpty();
        dialog_->setFolder(folder);
        // Where the exercise came along with the work, it is that.
        for (const QFileInfo& info : QDir(folder).entryInfoList(QDir::Files | QDir::Dirs | QDir::NoDotAndDotDot)) {
            try {
                if (isTaken || !tasks::isTask(toPath(info.absoluteFilePath())) ||
                    cases::isAttempt(toPath(info.absoluteFilePath())))
                    continue;
                dialog_->setExercise(info.absoluteFilePath());
                isTaken = true;
            } catch (const core::Error&) {
                continue;  // it has a row of its own in the table, with what is wrong
            }
        }
    }
    dialog_->show();
    dialog_->raise();
    dialog_->activateWindow();
}

void MarkingFeature::startJob(const QString& title, Job::Work work, std::function<void()> done) {
    auto* job = new Job(title, std::move(work), this);
    job_ = job;
    dialog_->setWork(title, 0.0);
    connect(job, &Job::progressed, this, [this, title](double share) { dialog_->setWork(title, share); });
    connect(job, &Job::done, this, [this, done = std::move(done)] {
        endJob();
        done();
    });
    connect(job, &Job::cancelled, this, [this] {
        endJob();
        dialog_->setNote(tr("Cancelled. What has been scored stays; \"Score again\" goes on."));
    });
    connect(job, &Job::failed, this, [this](const Problem& problem) {
        endJob();
        dialog_->setNote(problem.what + QLatin1Char(' ') + problem.remedy);
        window_.showProblem(problem);
    });
    job->start();
}

void MarkingFeature::endJob() {
    if (job_) job_->deleteLater();
    job_ = nullptr;
    dialog_->setWork({}, 0.0);
    dialog_->refresh();
    showSheet();
}

void MarkingFeature::begin() {
    if (job_ || wish_.folder.isEmpty()) return;
    settings_.set(QStringLiteral("marking/marker"), wish_.marker);
    settings_.set(QStringLiteral("marking/folder"), wish_.folder);
    settings_.set(QStringLiteral("marking/exercise"), wish_.exercise);
    settings_.set(QStringLiteral("marking/blind"), wish_.isBlind);
    dialog_->setNote({});
    struct Found {
        tasks::Task task;
        rubric::Rubric rubric;
        std::vector<marking::ReturnedWork> works;
    };
    const auto found = std::make_shared<Found>();
    startJob(
        tr("Looking for work"),
        [found, wish = wish_, outside = simulator_.outside()](const core::Progress& progress) {
            const std::string exercise = toPath(wish.exercise).string();
            outside->read(exercise, core::part(progress, 0.0, 0.3));
            found->task = tasks::readTask(exercise);
            if (wish.rubric.isEmpty() && found->task.rubric.empty())
                throw core::Error("this exercise has no rubric", exercise, "choose one").as("exercise-without-rubric");
            found->rubric = wish.rubric.isEmpty() ? rubric::parseRubric(found->task.rubric, exercise + "/rubric.toml")
                                                  : rubric::rubricByNameOrFile(toPath(wish.rubric).string());
            rubric::requireSound(found->rubric);
            found->works = marking::findWork(toPath(wish.folder), core::part(progress, 0.3, 1.0));
        },
        [this, found] { takeDesk(wish_, std::move(found->works), std::move(found->task), std::move(found->rubric)); });
}

void MarkingFeature::takeDesk(const DeskWish& wish, std::vector<marking::ReturnedWork> works, tasks::Task task,
                              rubric::Rubric rubric) {
    marking::DeskSetup setup;
    setup.folder = toPath(wish.folder);
    setup.marker = wish.marker.toStdString();
    setup.exercise = task.id;
    setup.exerciseHash = rubric::hashText(tasks::contentHash(task));
    setup.rubric = std::move(rubric);
    setup.isBlind = wish.isBlind;
    std::shared_ptr<marking::Desk> desk;
    try {
        desk = std::make_shared<marking::Desk>(std::move(setup), std::move(works));
    } catch (const core::Error& error) {
        const Problem problem = problemOf(error);
        dialog_->setNote(problem.what + QLatin1Char(' ') + problem.remedy);
        window_.showProblem(problem);
        return;
    }
    task_ = std::make_shared<const tasks::Task>(std::move(task));
    if (!code_.isEmpty() && !desk->has(code_.toStdString())) code_.clear();
    sheet_->showWork(nullptr, {}, {}, false, false);
    dialog_->setDesk(desk.get());
    desk_ = std::move(desk);
    showSheet();
    if (desk_->works().empty()) dialog_->setNote(tr("There is no returned work in this folder."));
    score();
}

void MarkingFeature::score() {
    marking::ScoreSettings settings;
    settings.prove = wish_.prove;
    settings.kept = desk_->folder() / kKept;
    startJob(
        tr("Scoring"),
        [this, desk = desk_, works = desk_->works(), rubric = desk_->rubric(), task = task_, settings,
         outside = simulator_.outside()](const core::Progress& progress) mutable {
            // Each work is judged in a process that holds nothing but it, the exercise and the rubric.
            const core::PrivateFolder folder;
            sandboxed::Returned asked{{}, folder.path() / "exercise.handpiece", rubric::rubricToml(rubric)};
            asked.prove = settings.prove, asked.draws = settings.pictures;
            tasks::Task plain = *task;
            plain.teacherWork.reset();
            tasks::writeTask(plain, asked.exercise);
            settings.judge = [asked, outside](const marking::ReturnedWork& work, const core::Progress& its) {
                sandboxed::Returned of = asked;
                of.work = work.path;
                marking::Judged judged;
                outside->once("returned " + work.id, [&] { judged = sandboxed::returned(of, its); });
                return judged;
            };
            marking::scoreAll(
                works, *task, rubric, settings, progress, [this, desk](std::size_t which, marking::Scored scored) {
                    const auto shared = std::make_shared<marking::Scored>(std::move(scored));
                    QMetaObject::invokeMethod(this, [this, desk, which, shared] {
                        desk->take(which, std::move(*shared));
                        if (desk != desk_) return;
                        dialog_->refresh();
                        if (!code_.isEmpty() && &desk_->work(code_.toStdString()) == &desk_->works()[which])
                            showSheet();
                    });
                });
        },
        [this] { showSheet(); });
}

void MarkingFeature::openWork(const QString& code) {
    if (!desk_ || !desk_->has(code.toStdString())) return;
    if (code != code_) forgetPlace();
    code_ = code;
    const bool isNew = !dock_->isVisible();
    isWanted_ = true;
    window_.docks().showWanted();
    dock_->raise();
    if (isNew) {
        window_.resizeDocks({dock_}, {kSheetPixels}, Qt::Horizontal);
        // The sheet needs the height of the column more than what the work says of itself.
        if (auto* about = window_.findChild<QDockWidget*>(QStringLiteral("exerciseDock")))
            window_.resizeDocks({about, dock_}, {kAboutPixels, window_.height()}, Qt::Vertical);
    }
    dialog_->select(code);
    dialog_->hide();  // it would lie over the picture; the sheet leads back to it
    window_.raise();
    window_.activateWindow();
    showSheet();
    const marking::ReturnedWork work = desk_->work(code.toStdString());
    if (work.isResultOnly || !core::isThere(work.path)) return;
    const bool isSession = !cases::isPackageName(work.path) && !cases::isAttempt(work.path);
    // Of a chain the one that came last.
    const fs::path shown =
        core::isFolder(work.path) && isSession ? assessment::sessionsIn(work.path).back() : work.path;
    if (desk_->isRevealed(code.toStdString())) return look(shown, isSession);
    // Under its code, without whose it is; its recordings stay away, for their names may tell.
    if (copyJob_) copyJob_->deleteLater();
    const fs::path place = toPath(shown_.filePath(code + (isSession ? ".h5" : ".handpiece")));
    auto* job = new Job(
        tr("Opening %1").arg(code),
        [from = shown, place, isSession, outside = simulator_.outside()](const core::Progress& progress) {
            if (core::isThere(place)) return;
            outside->read(from, progress);
            if (isSession) return fs::create_symlink(core::wholePath(from), place);
            cases::OpenAttempt open = cases::openAttempt(from);
            open.attempt.student.clear();
            open.attempt.session.clear();
            open.attempt.recordings.clear();
            cases::writeAttempt(open.attempt, place, &open.toothCase);
            outside->made(place);
        },
        this);
    copyJob_ = job;
    connect(job, &Job::done, this, [this, job, place, isSession, code] {
        job->deleteLater();
        if (code == code_) look(place, isSession);
    });
    connect(job, &Job::failed, this, [this, job, code](Problem problem) {
        job->deleteLater();
        // Its own words name files.
        problem.what = tr("%1 cannot be opened; why is told once your marks are in.").arg(code);
        problem.where.clear();
        problem.remedy = tr("It may go in without marks.");
        window_.showProblem(problem);
    });
    job->start();
}

void MarkingFeature::look(const fs::path& path, bool isSession) {
    window_.whenMayLeave([this, path, isSession] {
        opening_ = code_;
        goesToEnd_ = isSession;
        if (isSession)
            simulator_.open(path);
        else
            simulator_.review(path);
    });
}

void MarkingFeature::showDocument() {
    const bool isReplay = simulator_.mode() == Simulator::Mode::replay;
    sheet_->setHasTime(isReplay);
    const bool isWork = isReplay || simulator_.mode() == Simulator::Mode::review;
    if (!isWork)
        inPicture_.clear();
    else if (!opening_.isEmpty())
        inPicture_ = std::exchange(opening_, {});
    sheet_->setIsShown(!code_.isEmpty() && inPicture_ == code_);
    if (!goesToEnd_ || !isReplay || !simulator_.replay()) return;
    // What is marked is how it ended.
    goesToEnd_ = false;
    simulator_.seek(simulator_.replay()->durationS());
}

void MarkingFeature::showSheet() {
    if (!desk_ || code_.isEmpty()) {
        sheet_->showWork(nullptr, {}, {}, false, false);
        return sheet_->setIsShown(false);
    }
    const auto& codes = desk_->codes();
    const auto at = std::find(codes.begin(), codes.end(), code_.toStdString()) - codes.begin();
    sheet_->showWork(desk_.get(), code_, tr("%1 of %2").arg(at + 1).arg(codes.size()),
                     !dialog_->beside(code_, -1).isEmpty(), !dialog_->beside(code_, 1).isEmpty());
    sheet_->setIsShown(inPicture_ == code_);
}

bool MarkingFeature::tryTo(const std::function<void(marking::Desk& desk)>& change) {
    if (!desk_ || code_.isEmpty()) return false;
    bool isKept = false;
    try {
        change(*desk_);
        isKept = true;
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
    dialog_->refresh();
    showSheet();
    return isKept;
}

void MarkingFeature::comment(const QString& text, bool atPlace, bool atTime) {
    marking::Comment said;
    said.text = text.toStdString();
    if (const std::string id = sheet_->criterion(); id != marking::kTotal) said.criterion = id;
    if (pickedMm_) {
        said.placeMm = pickedMm_;
        said.timeS = pickedS_;
    } else if (atPlace && simulator_.tooth()) {
        said.placeMm = placeUnder({0.5 * view_.width(), 0.5 * view_.height()});
        if (!said.placeMm) {
            dialog_->setNote(tr("There is no tooth in the middle of the picture: the comment has no place."));
        }
    }
    if (atTime && simulator_.replay()) said.timeS = simulator_.replay()->now().timeS;
    // Of what was handed in any of its recordings may be the one that is watched.
    if (said.timeS && simulator_.isReviewing()) {
        const std::vector<RecordingPlace>& all = simulator_.reviewed().recordings;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i].name == simulator_.document().caseFile.filename()) said.session = i;
    }
    if (!tryTo([&](marking::Desk& desk) { desk.comment(code_.toStdString(), said); })) return;
    forgetPlace();
    sheet_->clearComment();
}

void MarkingFeature::goTo(const std::optional<core::Vec3>& placeMm, const std::optional<double>& timeS) {
    if (timeS && simulator_.mode() == Simulator::Mode::replay && simulator_.replay()) {
        simulator_.play(false);
        simulator_.seek(std::clamp(*timeS, 0.0, simulator_.replay()->durationS()));
    }
    if (!placeMm || !view_.hasTooth() || !simulator_.tooth()) return;
    // From where the eye is, or from occlusal where the tooth itself is in the way.
    view::Camera camera = view_.camera();
    const auto isSeen = [&](const core::Vec3& along) {
        return simulator_.tooth()->withProbe([&](const measure::ToothProbe& probe) {
            const auto hit = probe.cast(*placeMm - kNearMm * along, along);
            return !hit || (hit->pointMm - *placeMm).norm() < 0.3;
        });
    };
    core::Vec3 along = camera.forward();
    if (const core::Vec3 down(0.0, 0.02, -1.0); !isSeen(along) && isSeen(down.normalized())) {
        along = down.normalized();
        const cases::Case& toothCase = *simulator_.toothCase();
        camera.up = view::occlusalUp(view::standingOf(toothCase.fdiNumber, toothCase.buccalSign));
    }
    camera.targetMm = *placeMm;
    camera.eyeMm = *placeMm - kNearMm * along;
    view_.setCamera(camera);
}

void MarkingFeature::computeAgreement() {
    if (!desk_ || !desk_->isBlind() || agreementJob_) return;
    struct Computed {
        marking::DeskAgreement agreement;
        QString note;
    };
    const auto computed = std::make_shared<Computed>();
    // The desk as it is now: marks may change meanwhile.
    const auto copy = std::make_shared<const marking::Desk>(*desk_);
    dialog_->agreement()->setNote(tr("Computing..."));
    auto* job = new Job(
        tr("Agreement"),
        [computed, copy](const core::Progress&) {
            const marking::Desk::Others others = copy->othersOfFolder();
            computed->agreement = marking::agreementOfDesk(*copy, others.desks);
            for (const std::string& problem : others.problems)
                computed->note += QString::fromStdString(problem) + QLatin1Char('\n');
        },
        this);
    agreementJob_ = job;
    connect(job, &Job::done, this, [this, job, computed] {
        job->deleteLater();
        agreementJob_ = nullptr;
        QString text = computed->note;
        text += computed->agreement.criteria.empty()
                    ? tr("There is nothing to compare yet: marks count once they are in.")
                    : tr("Marks that were given blind alone; works whose machine's score is hidden are left out.");
        dialog_->agreement()->show(computed->agreement, text);
    });
    connect(job, &Job::failed, this, [this, job](const Problem& problem) {
        job->deleteLater();
        agreementJob_ = nullptr;
        dialog_->agreement()->setNote(problem.what);
    });
    job->start();
}

/// As the work's file is called, so that it goes to the same student.
QString MarkingFeature::returnedName(const std::string& code) const {
    const fs::path name = desk_->work(code).name;
    return toQString(name.parent_path() / name.stem()).replace(QLatin1Char('/'), QLatin1Char('-')) +
           QStringLiteral("-marks.json");
}

void MarkingFeature::returnWork() {
    if (!desk_ || code_.isEmpty()) return;
    const std::string code = code_.toStdString();
    try {
        const std::string marks = marking::returnedJson(marking::returnedMarks(*desk_, code));
        const QString file = window_.questions.save(tr("Return to student"), returnedName(code), tr("Marks (*.json)"),
                                                    QStringLiteral(".json"));
        if (file.isEmpty()) return;
        core::writeFile(toPath(file), marks);
        window_.tellSaved(file);
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
}

/// Of each work that has a score and is to be seen, once.
void MarkingFeature::returnAll(const QString& folder) {
    core::prepareOutputFolder(toPath(folder));
    for (const std::string& code : desk_->codes())
        if (desk_->machine(code) != nullptr && !desk_->isRepeat(code))
            core::writeFile(toPath(folder) / toPath(returnedName(code)),
                            marking::returnedJson(marking::returnedMarks(*desk_, code)));
}

void MarkingFeature::write(const QString& what) {
    if (!desk_) return;
    const bool isReturned = what == QLatin1String("returned");
    const bool isFolder = isReturned || what == QLatin1String("agreement"), isPage = what == QLatin1String("class"),
               isMarks = what == QLatin1String("marks");
    const QString file =
        isReturned ? window_.questions.save(tr("Folder for the marks"), QStringLiteral("marks"), {}, {})
        : isFolder ? window_.questions.save(tr("Folder for the agreement"), QStringLiteral("agreement"), {}, {})
        : isPage   ? window_.questions.save(tr("Write the page"), QStringLiteral("class.html"), tr("Page (*.html)"),
                                            QStringLiteral(".html"))
                   : window_.questions.save(tr("Write the table"),
                                          isMarks ? QStringLiteral("marks.csv") : QStringLiteral("results.csv"),
                                            tr("Table (*.csv)"), QStringLiteral(".csv"));
    if (file.isEmpty()) return;
    try {
        if (!isFolder) {
            const auto names = what == QLatin1String("codes") ? marking::Naming::codesOnly : marking::Naming::withFiles;
            core::writeFile(toPath(file), isMarks  ? marking::marksCsv(*desk_, desk_->othersOfFolder().desks)
                                          : isPage ? marking::classPage(*desk_, names)
                                                   : marking::resultsCsv(*desk_, names));
        } else if (isReturned) {
            returnAll(file);
        } else {
            const marking::DeskAgreement agreement = marking::agreementOfDesk(*desk_, desk_->othersOfFolder().desks);
            core::prepareOutputFolder(toPath(file));
            core::writeFile(toPath(file) / "agreement.json", assessment::agreementJson(agreement.criteria));
            core::writeFile(toPath(file) / "agreement.txt", assessment::agreementText(agreement.criteria));
            for (std::size_t i = 0; i < agreement.pictures.size(); ++i)
                core::writeFile(toPath(file) / fmt::format("{:02}.svg", i + 1), agreement.pictures[i].svg);
        }
        window_.tellSaved(file);
    } catch (const core::Error& error) {
        window_.showProblem(problemOf(error));
    }
}

}  // namespace handpiece::desktop
