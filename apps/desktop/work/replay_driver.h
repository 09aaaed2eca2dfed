// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Plays a session at the speed of the clock, on a thread of its own.

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "desktop/framework/problem.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/model/instrument/bur.h"

namespace handpiece::desktop {

/// How a replay stands.
struct ReplayNow {
    double timeS = 0.0;
    bool playing = false, seeking = false;
    messages::HapticSample sample;
    simulation::SimulationSettings settings;  ///< in force then
};

/// Any thread may ask; the player itself is touched by the driver's thread alone.
class ReplayDriver {
  public:
    /// Called on the driver's thread after each step, with its length [s].
    using Heard = std::function<void(const messages::HapticSample& sample, double stepS,
                                     const simulation::SimulationSetup& station)>;
    explicit ReplayDriver(std::unique_ptr<simulation::SessionPlayer> player, Heard heard = {});
    ~ReplayDriver();
    ReplayDriver(const ReplayDriver&) = delete;
    ReplayDriver& operator=(const ReplayDriver&) = delete;

    void play(bool playing);
    /// Times real time.
    void setSpeed(double speed);
    /// The latest of several wins.
    void seek(double timeS);
    [[nodiscard]] ReplayNow now() const;
    /// Why it stopped, once.
    [[nodiscard]] std::optional<Problem> takeProblem();

    // What never changes while it plays.
    [[nodiscard]] double durationS() const noexcept { return durationS_; }
    [[nodiscard]] const std::shared_ptr<simulation::LiveTooth>& tooth() const noexcept { return tooth_; }
    [[nodiscard]] const cases::Case& toothCase() const noexcept { return toothCase_; }
    [[nodiscard]] const std::vector<session::Event>& events() const noexcept { return events_; }
    [[nodiscard]] double rateHz() const noexcept { return rateHz_; }
    /// Of the engine that recorded it.
    [[nodiscard]] std::int32_t engineRevision() const noexcept { return engineRevision_; }
    [[nodiscard]] const std::vector<simulation::PlotPoint>& plot() const noexcept { return plot_; }
    [[nodiscard]] const simulation::SimulationSettings& firstSettings() const noexcept { return settings_; }

  private:
    void run();
    void publish();

    std::unique_ptr<simulation::SessionPlayer> player_;
    Heard heard_;
    double durationS_, rateHz_;
    std::int32_t engineRevision_;
    std::shared_ptr<simulation::LiveTooth> tooth_;
    cases::Case toothCase_;
    std::vector<session::Event> events_;
    std::vector<simulation::PlotPoint> plot_;
    simulation::SimulationSettings settings_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    ReplayNow now_;
    std::optional<Problem> problem_;
    double speed_ = 1.0;
    std::optional<double> seek_;
    bool end_ = false;
    std::thread thread_;
};

}  // namespace handpiece::desktop
