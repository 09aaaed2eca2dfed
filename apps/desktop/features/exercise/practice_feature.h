// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A student's way: choose an exercise, work on it, finish, see the result and why, again or the next; how it went on.

#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "desktop/features/exercise/exercise_steps.h"
#include "desktop/features/exercise/result_dialog.h"
#include "desktop/framework/feature.h"
#include "desktop/work/work_glass.h"
#include "desktop/work/zone_glass.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/store/store.h"

class QPushButton;

namespace handpiece::desktop {

class ExerciseFeature;
class ExercisesDialog;
class ProgressDialog;
class SectionCard;

class PracticeFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { exercises, finish, zones, result, progress };
    /// It asks `exercise` for the student's code.
    PracticeFeature(const FeatureContext& context, ExerciseFeature& exercise);
    void showDocument() override;
    void showTick() override;

    /// Opened when it is first asked for; null, and told why, where it cannot be.
    [[nodiscard]] school::Store* store();

  private:
    void openDialogs();
    void begin(const std::filesystem::path& path, bool unaided = false);
    void again();
    void readDue();
    void openResult(const QString& attempt, std::function<void()> then = {});
    void showOlder(const school::Attempt& attempt, std::shared_ptr<const Simulator::Finished> done);
    void take(const Simulator::Finished& done);
    void keep();
    void keep(const OwnJudgement& own);
    void showEvidence(const measures::Evidence& evidence, const QString& words);
    void show(const std::filesystem::path& session, const measures::Evidence& evidence, const QString& words,
              bool playsWhole);
    void showIdealGlass();
    void showSection(const core::Vec3& placeMm);
    void hideSection();
    void showTeacherWork(const std::optional<measures::Evidence>& at);
    void turnTo(const core::Vec3& placeMm);
    void makeRoom();
    void write(const QString& title, const QString& told, const QString& file, Job::Work work);
    void savePage();
    void handIn();
    void takeReturned(const std::filesystem::path& file);
    void showProgress();
    [[nodiscard]] std::optional<Reached> reachedAt(const std::string& id);
    void makeIdeal();
    [[nodiscard]] std::filesystem::path placeOf(const tasks::Task& task);
    void showZones();

    ExerciseFeature& exercise_;
    CommandSet<Command> commands_;
    std::unique_ptr<school::Store> store_;
    ExercisesDialog* exercises_;
    ResultDialog* result_;
    QPushButton* back_;     ///< to the result, where it had to make room
    SectionCard* section_;  ///< through the place that is shown
    Job* sectioning_ = nullptr;
    ProgressDialog* progress_;
    std::shared_ptr<const Simulator::Finished> done_;
    std::string attempt_;            ///< its id in the store; empty: it could not be kept
    std::optional<double> stopAtS_;  ///< the replay
    std::unique_ptr<Job> ideal_;
    Job* writing_ = nullptr;                               ///< a page, a hand-in
    Job* older_ = nullptr;                                 ///< a result of before, on its way
    std::map<std::string, std::vector<std::string>> due_;  ///< criteria by exercise
    ZoneGlass glass_;
    WorkGlass work_;
    /// Of the exercise whose result is shown.
    std::shared_ptr<const std::vector<std::byte>> teacherWork_;
    std::shared_ptr<const core::PrivateFolder> teacherFolder_;  ///< in which it lies, once it is played
    Job* findingTeacher_ = nullptr;
};

}  // namespace handpiece::desktop
