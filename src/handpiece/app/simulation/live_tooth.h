// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tooth worked on, and those around it that have been cut, as their listeners see them: mirror, surface and probe,
/// kept up by one thread, read by others.

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "handpiece/app/simulation/gingiva_cuts.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/senses/measure/tooth_probe.h"
#include "handpiece/senses/surface/brick_update.h"
#include "handpiece/senses/surface/surface.h"

namespace handpiece::simulation {

struct SimulationSetup;
struct StandingTooth;

/// Fed by one thread (never the tick's); the rest from any thread. Meshes are made without holding anybody up: who
/// measures waits for the copying of changed bricks only, and for removed depths where they are wanted. News hold one
/// entry a brick, whoever reads them or not.
class LiveTooth {
  public:
    /// Builds the surface of the uncut tooth, then puts `state` in place. Throws core::Error when cancelled.
    LiveTooth(std::shared_ptr<const tooth::ToothModel> model, const tooth::StateDelta& state,
              const core::Progress& progress = {});
    /// With the teeth around it. Their surfaces are made when they are first cut, on a thread of their own, and then
    /// come as news.
    LiveTooth(const SimulationSetup& station, const tooth::StateDelta& state, const core::Progress& progress = {});
    ~LiveTooth();

    [[nodiscard]] const tooth::ToothModel& model() const noexcept { return *model_; }
    [[nodiscard]] const std::shared_ptr<const tooth::ToothModel>& modelShared() const noexcept { return model_; }

    /// Of all teeth that can be cut, by their numbers.
    [[nodiscard]] const tooth::Teeth& teeth() const noexcept { return teeth_; }

    // The feeder.
    void hear(const tooth::BrickSnapshot& brick);
    void apply(const tooth::StateDelta& change);
    /// Meshes for what was heard since the last call; what was heard shows in the probe and in state() from then on.
    /// Milliseconds: call it at the rate of pictures.
    void refresh();
    /// The same, but does nothing and says false while somebody measures: for a thread that must not wait.
    bool tryRefresh();

    // Anybody.

    /// What was done to the gingiva around it.
    [[nodiscard]] GingivaCuts& gingiva() noexcept { return gingiva_; }
    /// The surface before any cut, and news since the last call, in the order to be drawn. One reader: whoever asks for
    /// the uncut surface begins anew, and all that was cut so far is news again.
    [[nodiscard]] std::vector<surface::BrickUpdate> uncutSurface();
    [[nodiscard]] std::vector<surface::BrickUpdate> takeNews();
    /// True when takeNews() would give something.
    [[nodiscard]] bool hasNews() const noexcept { return hasNews_.load(std::memory_order_acquire); }
    /// From now on news carry removed depths; those of all that was cut so far come again.
    void wantRemovedDepths(bool wanted);
    /// Calls f(const measure::ToothProbe&) on the tooth as it is now, and returns what that returns.
    template <class F>
    auto withProbe(F&& f) const {
        const std::lock_guard lock(mutex_);
        return f(*probe_);
    }
    /// A stroke begins: withStrokeStart() is of the tooth as it is now, until the next one.
    void beginStroke();
    template <class F>
    auto withStrokeStart(F&& f) const {
        const std::lock_guard lock(mutex_);
        return f(*strokeStart_);
    }
    /// What stands around the tooth.
    [[nodiscard]] const std::vector<StandingTooth>& standing() const noexcept { return standing_; }
    /// Of the mouth, as far as it is kept up.
    [[nodiscard]] tooth::StateDelta state(const tooth::RemovedMm3& removedMm3) const;
    /// Waits for surfaces that are being made and brings all up to date: for pictures that are drawn once.
    void settle();

  private:
    LiveTooth(const StandingTooth& standing, const tooth::StateDelta& state);
    void build(const tooth::StateDelta& state, const core::Progress& progress);
    void takeUpPending();
    void tellWhetherNews();
    void shape(std::unique_lock<std::mutex> lock);
    [[nodiscard]] bool isNearCut(std::uint32_t dense) const;

    struct Parts;
    class Neighbours;
    std::shared_ptr<const tooth::ToothModel> model_;
    tooth::Teeth teeth_;  ///< one of a neighbour has none
    std::uint16_t number_ = 0;
    core::Pose inScene_;
    mutable std::mutex mutex_;
    std::unique_ptr<Parts> parts_;
    std::unique_ptr<measure::ToothProbe> probe_, strokeStart_;
    std::vector<StandingTooth> standing_;
    std::unique_ptr<Neighbours> neighbours_;  ///< null without any
    std::atomic<bool> hasNews_{false};
    GingivaCuts gingiva_;
};

}  // namespace handpiece::simulation
