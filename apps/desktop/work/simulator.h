// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The student's work behind the window: what is open, the sitting or the replay, recording, saving, sound. Knows no
/// widgets.

#include <QObject>
#include <QStringList>
#include <QTimer>
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "desktop/framework/job.h"
#include "desktop/framework/problem.h"
#include "desktop/framework/settings.h"
#include "desktop/work/device_manager.h"
#include "desktop/work/documents.h"
#include "desktop/work/foot.h"
#include "desktop/work/outside_files.h"
#include "desktop/work/replay_driver.h"
#include "desktop/work/session_shelf.h"
#include "handpiece/app/course/finished_work.h"
#include "handpiece/app/exercise/permissions.h"
#include "handpiece/app/simulation/live_session.h"
#include "handpiece/senses/measure/pulp_light.h"
#include "handpiece/senses/sound/player.h"
#include "handpiece/tick/device/pointer_device.h"

namespace handpiece::desktop {

/// Lives on the window's thread and never blocks it for long: loading, saving and cutting again are jobs, one at a
/// time, and whatever was open stays open until a job has succeeded.
class Simulator : public QObject {
    Q_OBJECT
  public:
    /// Review: a tooth that was handed in is looked at, not worked at.
    enum class Mode { empty, liveSession, replay, review };
    struct Options {
        Folders folders = Folders::standard();
        SessionShelf::Limits shelf;
        Starter starter;                    ///< that an empty start opens
        std::filesystem::path casesFolder;  ///< a school's; may be empty
        bool sound = true, realTime = true, record = true;
        double rateHz = 1000.0;  ///< of the tick, of teeth that are opened; a session has its own
        int voxelUm = 50;
        measure::PulpLimits pulpLimits;
        DeviceManager::Options hands;
        PedalDesk pedals;
    };
    explicit Simulator(const Options& options, QObject* parent = nullptr);
    ~Simulator() override;

    /// Of the lamps that tell what is left over the pulp: the teacher's.
    [[nodiscard]] const measure::PulpLimits& pulpLimits() const noexcept { return options_.pulpLimits; }

    [[nodiscard]] const Starter& firstStarter() const noexcept { return options_.starter; }
    [[nodiscard]] const std::filesystem::path& casesFolder() const noexcept { return options_.casesFolder; }

    // What is open.

    [[nodiscard]] Mode mode() const noexcept { return mode_; }
    [[nodiscard]] const Document& document() const noexcept { return document_; }
    /// Null while nothing is open.
    [[nodiscard]] const std::shared_ptr<const cases::Case>& toothCase() const noexcept { return toothCase_; }
    [[nodiscard]] const std::shared_ptr<simulation::LiveTooth>& tooth() const noexcept { return tooth_; }
    /// As it is cut by now, where tooth() may be a picture behind; with a tooth open.
    [[nodiscard]] tooth::StateDelta state() const;
    /// For the picture, made with each sitting; null in a replay.
    [[nodiscard]] const std::shared_ptr<simulation::SampleFeed>& pictureFeed() const noexcept { return pictureFeed_; }
    /// Null in a replay, and while a device holds the handpiece: the mouse looks and measures then.
    [[nodiscard]] const std::shared_ptr<device::PointerMailbox>& mailbox() const noexcept { return mailbox_; }
    [[nodiscard]] const core::Pose& startPose() const noexcept { return startPose_; }
    [[nodiscard]] std::shared_ptr<const instrument::Bur> bur() const noexcept { return settings_.bur; }
    [[nodiscard]] const std::string& burCuttingParameters() const noexcept { return settings_.cuttingParameters.name; }
    [[nodiscard]] const QString& burName() const noexcept { return burName_; }
    [[nodiscard]] const QString& driveName() const noexcept { return driveName_; }
    [[nodiscard]] double setSpeedRpm() const noexcept { return speedRpm_; }
    /// What the person chose for all that names no drive: that of an exercise, an attempt, a replay holds for it alone.
    [[nodiscard]] const QString& chosenDriveName() const noexcept { return chosenDrive_; }
    [[nodiscard]] double chosenSpeedRpm() const noexcept { return chosenRpm_; }
    [[nodiscard]] const force::Parameters& parameters() const noexcept { return settings_.parameters; }
    [[nodiscard]] const device::Capability& capability() const noexcept { return settings_.capability; }
    [[nodiscard]] bool isHullMethod() const noexcept { return hull_; }
    [[nodiscard]] int voxelUm() const noexcept { return voxelUm_; }
    /// That a tooth opened from now on has; an attempt has its own.
    [[nodiscard]] int startVoxelUm() const noexcept { return options_.voxelUm; }
    [[nodiscard]] const messages::HapticSample& sample() const noexcept { return sample_; }
    /// Of the sitting; of the last one when there is none.
    [[nodiscard]] const simulation::LiveSessionStatus& status() const noexcept { return status_; }
    /// Of the tooth that is open, or that a replay covers; null without one.
    [[nodiscard]] const cases::Exercise* exercise() const;
    /// What may be done now: whoever does it asks here.
    [[nodiscard]] exercise::Permissions permissions() const;
    /// Something was cut, or put back, that no file holds.
    [[nodiscard]] bool isUnsaved() const noexcept { return unsaved_; }
    [[nodiscard]] bool isBusy() const noexcept { return job_ != nullptr; }
    [[nodiscard]] const ReplayDriver* replay() const noexcept { return replay_.get(); }
    /// Work that a crash left behind, the newest first.
    [[nodiscard]] std::vector<Crashed> crashed() const { return shelf_.crashed(); }

    /// While the tooth that comes cannot be cut yet: it can be touched, with the mouse. Nothing of it is recorded.
    struct Touch {
        std::shared_ptr<Touchable> of;
        std::unique_ptr<simulation::LiveSession> session;
        std::shared_ptr<simulation::SampleFeed> feed;
        std::shared_ptr<device::PointerMailbox> mailbox;
        core::Pose startPose;
    };
    /// Null while there is none.
    [[nodiscard]] const Touch* touch() const noexcept { return touch_.get(); }

    /// Runs `then` once a file that a person named may be looked into; what is wrong with it is told by failed().
    void readApart(const std::filesystem::path& path, std::function<void()> then);

    // Documents. A new one takes the place of the old one once it is ready: whoever calls asks about unsaved work
    // first.

    void openStarter(const Starter& starter);
    void openFirst() { openStarter(options_.starter); }
    /// A case, an attempt, a mesh or a session, whatever the file is; of a case the tooth `fdi` (0: its own).
    void open(const std::filesystem::path& path, int fdi = 0);
    /// An exercise, folder or file, begun anew: its tooth, its voxel, its locks. Unaided: kUnaidedLocks as well.
    void openExercise(const std::filesystem::path& path, bool unaided = false);
    /// Of the tooth that is open; null without one.
    [[nodiscard]] const std::shared_ptr<const tasks::Task>& task() const noexcept { return document_.task; }
    /// Work on an exercise, scored.
    struct Finished {
        course::FinishedWork work;
        std::filesystem::path taskPath;
        std::vector<std::string> recordings;   ///< that led to it
        std::int64_t began = 0, finished = 0;  ///< [ms since 1970]
        double workedS = 0.0;                  ///< without pauses; 0: not known
    };
    /// How long the tooth that is open was worked on: without pauses, replays and what lay between sittings. Undo turns
    /// no clock back.
    [[nodiscard]] double workedS() const { return elapsedS_ + (liveSession_ ? status_.timeS : 0.0); }
    /// The exercise's time is up and its limit hard: the pedal is dead, nothing is taken back.
    [[nodiscard]] bool isTimeOver() const noexcept { return isTimeOver_->load(std::memory_order_relaxed); }
    /// Closes the recording and judges it, with those of the same attempt before it, beside everything else; its replay
    /// lies open at its end then, and finished() tells the rest. Cancelled or refused: the tooth comes back as it was.
    void finish();
    // An exam: while it runs nothing else can be opened, and its recording stays marked until it ends. `elsewhere` of
    // permissions() says so.

    struct Exam {
        std::string sitting;              ///< as the station's service calls it
        std::vector<std::string> locked;  ///< all helps that its candidate does not have
        std::filesystem::path exercise;
    };
    /// Opens its tooth, or goes on with the work at it that a program left that ended: whatever goes on here is given
    /// up.
    void beginExam(const Exam& exam);
    [[nodiscard]] const std::optional<Exam>& exam() const noexcept { return exam_; }
    /// As beginExam() again, where nothing came of it.
    void openExam();
    /// Closes its recording: all of them, in the order of the work. The tooth waits for goOnWithExam() or endExam().
    [[nodiscard]] std::vector<std::filesystem::path> closeExam();
    /// It could not be handed over: the tooth comes back.
    void goOnWithExam();
    /// It was handed over or given up: its tooth goes.
    void endExam();
    /// Exams of which recordings were left, by their sittings, but for the one that runs.
    [[nodiscard]] std::vector<std::string> leftExams() const;
    /// They become recordings like any other.
    void forgetExam(const std::string& sitting);
    /// The pedal is dead.
    void pause(bool isPaused) { isPaused_->store(isPaused, std::memory_order_relaxed); }

    void recover(const Crashed& crashed, std::function<void()> then = {});
    /// The recordings, and how much room there is for them.
    [[nodiscard]] const SessionShelf& shelf() const noexcept { return shelf_; }
    /// Gives up what a crash left behind; the recording itself stays for a while.
    void forget(const Crashed& crashed) { shelf_.settle(crashed.session); }
    void forget(const Finished& done) { shelf_.settle(done.work.session); }
    [[nodiscard]] const Folders& folders() const noexcept { return options_.folders; }
    /// What somebody else made is read through it; jobs that open a file which a person named ask it first, with their
    /// progress.
    [[nodiscard]] const std::shared_ptr<const OutsideFiles>& outside() const noexcept { return outside_; }
    void cancelJob();
    /// At once, or when the work that goes on is over; the last one asked for, the others are given up.
    void whenFree(std::function<void()> what);
    /// Plays what this sitting has recorded so far; closeReplay() brings the tooth back as it was.
    void replayThis();
    /// Back to the tooth that replayThis() left, or to nothing; `then` once it is there.
    void closeReplay(std::function<void()> then = {});
    /// The tooth that waits behind a replay holds work that no file holds.
    [[nodiscard]] bool isUnsavedBehindReplay() const noexcept { return leftFor_ && leftFor_->file.note.unsaved; }
    void giveUpBehindReplay();
    /// The recording under way; empty when there is none.
    [[nodiscard]] const std::filesystem::path& recording() const noexcept { return shelf_.current(); }
    /// It holds a tick at least: before the first there is nothing to play or to keep.
    [[nodiscard]] bool isRecorded() const noexcept {
        return mode_ == Mode::liveSession && !shelf_.current().empty() && sample_.tick > 0;
    }
    /// To `path` (.handpiece, or a folder); `then` runs once it is saved.
    void saveAs(const std::filesystem::path& path, std::function<void()> then = {});
    /// Saves it as one file for a teacher, with its tooth and its recordings; the work goes on at the same tooth.
    void handIn(const std::filesystem::path& path);
    /// Opens an attempt to be looked at: nothing is locked, nothing changes it.
    void review(const std::filesystem::path& attempt);
    [[nodiscard]] bool isReviewing() const noexcept { return reviewed_ != nullptr; }
    /// What is reviewed, also while one of its recordings is watched. Only while isReviewing().
    [[nodiscard]] const Document& reviewed() const;
    /// One of document().recordings of a review, by its place; closeReplay() leads back.
    void watchRecording(std::size_t which);
    void exportStl(const std::filesystem::path& path);
    /// What is left of each tissue, a closed STL each, into a folder.
    void exportTissues(const std::filesystem::path& folder);
    /// A page to print about the recording under way, or the one that is replayed.
    void writeReport(const std::filesystem::path& file);
    /// A copy of the recording under way, as far as it has come.
    void copyRecording(const std::filesystem::path& file);
    /// Ends sitting or replay. Unsaved work counts as given up.
    void close();

    // Who holds the handpiece. Another device, or none, takes over the tooth as it is.

    [[nodiscard]] DeviceManager& hands() noexcept { return hands_; }
    [[nodiscard]] const DeviceManager& hands() const noexcept { return hands_; }
    /// The foot pedal, beside the mouse or a device.
    [[nodiscard]] Foot& foot() noexcept { return foot_; }
    /// The device of the sitting under way; null: the mouse.
    [[nodiscard]] const std::shared_ptr<Hand>& usedHand() const noexcept { return usedHand_; }
    /// Whether a person's hand feels what the tooth gives back; a mouse, a SpaceMouse or a gamepad lets nobody.
    [[nodiscard]] bool givesForce() const { return usedHand_ && usedHand_->info().pushes; }
    /// The mouse works on while something else has the device (its set-up, its check), until it is given back.
    void lendHand(bool away);

    // The work.

    void undo();
    void redo();
    void reset();
    /// By name, or a mesh file of one's own. A problem is told by failed().
    void setBur(const QString& nameOrFile);
    void setDrive(const QString& name);
    void setSpeed(double rpm);
    void setMultipliers(double stiffness, double damping, double friction);
    void setHullMethod(bool hull);
    /// From where and how one works from now on, for the record: an hour or 0, by mirror only, with a finger rest.
    void noteWorkingWay(int hour, bool mirrorOnly, bool fingerRest);
    /// Whether the depth stop is on from now on, and how deep one pass goes, likewise.
    void noteHand(bool isStopOn, std::optional<double> perPassMm);
    /// The paper's penalty force instead of the proxy's.
    void setForceMode(force::LawId mode);
    /// A knock at each touch; the hum of the bur. Both off where nothing can be felt anyway: the mouse.
    void setEventBasedForce(bool contact, bool vibration);
    /// Cuts the tooth again with other voxels, by replaying what was recorded.
    void setVoxel(int um);
    /// Of the student: goes into recordings that begin from now on, and into attempts. An untouched tooth is opened
    /// again, so that its recording has it too. Of it letters a to z, digits, - and _ are kept, 32 at most.
    void setCode(const QString& asked);
    [[nodiscard]] const QString& code() const noexcept { return code_; }

    // Replay.

    void play(bool playing);
    void seek(double timeS);
    void setReplaySpeed(double speed);

    // Sound.

    void setMix(const sound::Mix& mix);
    [[nodiscard]] const sound::Mix& mix() const noexcept { return mix_; }
    void setEar(const sound::Ear& ear);
    /// Reads the files beside everything else, then calls `done` with what was wrong, if anything; the sound before
    /// stays then. One reading at a time: another asks again once it is done.
    void setRecordings(const sound::Recording& motor, const sound::Recording& cutting,
                       std::function<void(const std::optional<Problem>&)> done);
    [[nodiscard]] bool isReadingSound() const noexcept { return soundJob_ != nullptr; }
    [[nodiscard]] sound::PlayerStatus soundStatus() const;

  signals:
    /// Another tooth, or none. Settings of the work may differ too.
    void documentChanged();
    /// Bur, drive, speed, parameters, method or voxel.
    void settingsChanged();
    void unsavedChanged(bool unsaved);
    void saved(const QString& file);
    void failed(const handpiece::desktop::Problem& problem);
    void jobStarted(const QString& title);
    /// What of it is being done now.
    void jobStepped(const QString& step);
    /// While nothing is open: the tooth that comes, to be looked at.
    void sketched(const std::shared_ptr<const handpiece::cases::Case>& sketch);
    /// While nothing is open: touch() is there, until jobEnded(), after which nothing of it may be used.
    void touchBegan();
    void jobProgressed(double fraction);
    void jobEnded();
    /// About 30 times a second: sample() and status() are new.
    void ticked();
    void plotted(const std::vector<handpiece::simulation::PlotPoint>& points);
    void noticed(const QString& id, const QStringList& arguments);
    /// What was done to the tooth is to be undone, all of it.
    void wasReset();
    /// What was cut is still marked as unsaved: forget() it once its result is kept.
    void finished(const handpiece::desktop::Simulator::Finished& done);
    /// The exercise locks it.
    void refused(handpiece::exercise::Operation operation);

  private:
    struct Ear;
    struct Reviewed;
    /// A tooth put away, to come back to: all of it but what a worker makes anew.
    struct Left {
        Crashed file;  ///< its recording, should the program end before
        LoadedTooth tooth;
        history::History history;
    };
    [[nodiscard]] Left leaveLiveSession();
    void takeOver(const Crashed& file);
    void comeBack(const std::shared_ptr<Left>& left, std::function<void()> then = {});
    void start(const QString& title, Job::Work work, std::function<void()> done, std::function<void()> otherwise = {});
    void goOn();
    void load(LoadRequest request, const QString& title, std::function<void()> done = {});
    [[nodiscard]] LoadListener loadListener();
    void beginTouch(std::shared_ptr<Touchable> of);
    [[nodiscard]] static QString stepText(LoadStep step);
    void loadFor(LoadRequest request, const QString& title, std::function<void(LoadedTooth)> then);
    void showReviewed();
    [[nodiscard]] cases::Attempt attemptNow(bool handedIn);
    [[nodiscard]] bool may(exercise::Operation operation);
    void openSession(const std::filesystem::path& path, bool keepsReview = false);
    void sit(LoadedTooth loaded);
    void watch(std::unique_ptr<ReplayDriver> driver);
    void takeReplayed(const simulation::SimulationSettings& settings);
    void stopAll(bool keepsReview = false);
    [[nodiscard]] std::unique_ptr<device::Device> takeHandpiece();
    void passHandpiece();
    void stopLiveSession(bool keepMarker);
    void poll();
    void markUnsaved(bool unsaved, bool inAnyCase = false);
    void watchTime();
    void tellTimeOver();
    [[nodiscard]] bool isCutSinceSaved() const {
        return sample_.removedMm3 != savedMm3_ || sample_.removedOthersMm3 != savedOthersMm3_;
    }
    [[nodiscard]] SessionNote noteNow() const;
    [[nodiscard]] LoadRequest request() const;
    [[nodiscard]] LoadRequest requestAgain() const;
    void bringBack(const Crashed& crashed, std::function<void()> then = {});
    [[nodiscard]] bool mayWork();
    [[nodiscard]] bool mayTakeBack();
    void tellDrill();
    void noteDriveChosen();
    [[nodiscard]] ReplayDriver::Heard replayEar();

    Options options_;
    std::shared_ptr<const OutsideFiles> outside_;
    Foot foot_;
    DeviceManager hands_;
    std::shared_ptr<Hand> usedHand_;
    bool handLentAway_ = false, handChanged_ = false;
    SessionShelf shelf_;
    Mode mode_ = Mode::empty;
    Document document_;
    std::shared_ptr<const cases::Case> toothCase_;
    std::shared_ptr<simulation::LiveTooth> tooth_;
    std::shared_ptr<simulation::SampleFeed> pictureFeed_, pollFeed_;
    std::shared_ptr<device::PointerMailbox> mailbox_;
    core::Pose startPose_;
    simulation::SimulationSettings settings_;
    QString burName_ = QStringLiteral("330"), driveName_ = QStringLiteral("turbine"), code_;
    simulation::WorkingWay way_{0, false, false, false};  ///< as told last
    std::string sessionCode_;                             ///< that the recording carries, or the next one will
    QString chosenDrive_ = driveName_;
    double speedRpm_ = 0.0, chosenRpm_ = 0.0, elapsedS_ = 0.0;
    bool hull_ = false, isTimeTold_ = false;
    /// The tick reads it.
    std::shared_ptr<std::atomic<bool>> isTimeOver_ = std::make_shared<std::atomic<bool>>(false);
    std::shared_ptr<std::atomic<bool>> isPaused_ = std::make_shared<std::atomic<bool>>(false);
    std::optional<Exam> exam_;
    bool isExamLost_ = false;  ///< its recording could not be brought back
    int voxelUm_ = 50;
    messages::HapticSample sample_;
    simulation::LiveSessionStatus status_;
    std::shared_ptr<Left> leftFor_;  ///< what replayThis() left
    std::shared_ptr<Reviewed> reviewed_;
    tooth::TissueVolumes savedMm3_{};  ///< removed when it was last saved or opened
    double savedOthersMm3_ = 0.0;      ///< of the teeth around it
    bool unsaved_ = false;
    sound::Mix mix_;
    std::unique_ptr<sound::Player> player_;
    std::shared_ptr<Ear> ear_;
    std::unique_ptr<simulation::LiveSession> liveSession_;
    std::unique_ptr<Touch> touch_;
    std::unique_ptr<ReplayDriver> replay_;
    std::unique_ptr<Job> job_, soundJob_;
    int loads_ = 0;
    std::function<void()> waiting_;  ///< for job_ to end
    QTimer timer_;
};

}  // namespace handpiece::desktop
