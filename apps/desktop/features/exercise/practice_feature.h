// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A student's way: choose an exercise, work on it, finish, see the result and why, again or the next; how it went on.

#include <memory>
#include <optional>

#include "desktop/features/exercise/result_dialog.h"
#include "desktop/framework/feature.h"
#include "desktop/work/zone_glass.h"
#include "handpiece/school/store/store.h"

namespace handpiece::desktop {

class ExercisesDialog;
class ProgressDialog;

class PracticeFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { exercises, finish, zones, result, progress };
    explicit PracticeFeature(const FeatureContext& context);
    void showDocument() override;
    void showTick() override;

    /// Opened when it is first asked for; null, and told why, where it cannot be.
    [[nodiscard]] school::Store* store();

  private:
    void openDialogs();
    void begin(const std::filesystem::path& path);
    void take(const Simulator::Finished& done);
    void keep();
    void keep(const OwnJudgement& own);
    void showEvidence(const measures::Evidence& evidence);
    void turnTo(const core::Vec3& placeMm);
    void savePage();
    void showProgress();
    [[nodiscard]] QString bestOf(const std::string& id);
    void makeIdeal();
    void showZones();

    CommandSet<Command> commands_;
    std::unique_ptr<school::Store> store_;
    ExercisesDialog* exercises_;
    ResultDialog* result_;
    ProgressDialog* progress_;
    std::shared_ptr<const Simulator::Finished> done_;
    std::string attempt_;            ///< its id in the store; empty: it could not be kept
    std::optional<double> stopAtS_;  ///< the replay
    std::unique_ptr<Job> ideal_;
    Job* page_ = nullptr;  ///< being written
    ZoneGlass glass_;
};

}  // namespace handpiece::desktop
