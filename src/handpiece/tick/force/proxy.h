// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The proxy: the bur as the eye sees it, held on the surface while the device's own pose goes into the tooth.

#include <cstdint>

#include "handpiece/base/core/fixed_vector.h"
#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/force/constraint_projection.h"

namespace handpiece::force {

struct ProxySettings {
    int iterations = 8;      ///< constraint passes a tick, at most; two more when the last one ended inside the tooth.
                             ///< Ticks shorter than a millisecond take fewer: what is left is walked in the next
    double maxStepMm = 0.1;  ///< between two passes, unless more clearance is proven: no wall can be stepped over
    double toleranceMm = 0.001;  ///< how deep a pose may be and still count as on the surface
};

/// Constraint-based god-object of the whole bur (Zilles & Salisbury 1995; Ortega 2007): of the poses the tooth allows,
/// near the last one, the nearest to the device. Orientation is the device's; translation is solved for.
///
/// One thread; keeps its pose between ticks. After start() in a tooth it is pushed out along the surface.
class Proxy {
  public:
    explicit Proxy(const ProxySettings& settings) : settings_(settings) {}

    /// Begins at the device's pose; pushed out when that lies in the tooth.
    void start(contact::Method& method, const core::Pose& deviceInTooth) noexcept HANDPIECE_REALTIME;

    /// Goes to the device's pose whatever the tooth says: for a force that knows no proxy.
    void follow(const core::Pose& deviceInTooth) noexcept HANDPIECE_REALTIME {
        pose_ = lastDevice_ = deviceInTooth;
        touching_ = false;
        memory_.clear();
    }

    /// Moves the proxy after the device. `depthAtDevice` is method.depth() at the device's pose: it spares all passes
    /// when the way there is free.
    void update(contact::Method& method, const core::Pose& deviceInTooth, const contact::Depth& depthAtDevice,
                double periodS) noexcept HANDPIECE_REALTIME;

    [[nodiscard]] const core::Pose& pose() const noexcept { return pose_; }
    /// True when the tooth holds it away from the device.
    [[nodiscard]] bool touching() const noexcept { return touching_; }
    /// Tissue of the constraint that pushes most; none when not touching.
    [[nodiscard]] cases::Tissue strongestTissue() const noexcept { return strongestTissue_; }
    /// Whether something holds it that takes no cut, and of all that holds it the part that can be cut: a vector along
    /// which that pushes, of length 1 when it is all.
    [[nodiscard]] bool isHeldOnly() const noexcept { return isHeldOnly_; }
    [[nodiscard]] const core::Vec3& cutShare() const noexcept { return cutShare_; }
    /// Of what holds it, the share that bears on parts behind the bur, 0 to 1, and where in the mean.
    [[nodiscard]] double behindShare() const noexcept { return behindShare_; }
    [[nodiscard]] const core::Vec3& behindPointMm() const noexcept { return behindPointMm_; }
    [[nodiscard]] contact::Piece strongestBehind() const noexcept { return strongestBehind_; }  ///< of those parts
    /// Smallest signed gap at the last pass [mm]: not below -tolerance, unless the bur is wedged.
    [[nodiscard]] double gapMm() const noexcept { return gapMm_; }
    /// Constraint passes of the last update.
    [[nodiscard]] int passes() const noexcept { return passes_; }

    void setSettings(const ProxySettings& settings) noexcept { settings_ = settings; }

  private:
    /// A half-space met at a pose nearby.
    struct Memory {
        contact::Constraint constraint;
        core::Pose at;
    };
    double evaluate(contact::Method& method) noexcept;
    void recall() noexcept;
    void remember(const contact::Constraint& exact) noexcept;
    void settleOutside(contact::Method& method) noexcept;
    void noteWhatHolds(const Projection& allowed) noexcept;
    [[nodiscard]] int passesIn(double periodS) const noexcept;
    [[nodiscard]] core::Vec3 freeStep(const core::Vec3& wanted, const Projection& allowed) const noexcept;

    ProxySettings settings_;
    core::Pose pose_, lastDevice_;
    contact::ConstraintSet constraints_;
    core::FixedVector<Memory, 6> memory_;  // exact depth names but one of two walls at a time
    std::uint64_t toothVersion_ = 0;       // that memory_ is of
    double radiusMm_ = 0.1;                // trust region: shrinks while steps turn back on themselves
    double reachMm_ = 0.2;                 // of the constraints asked for: twice the step that they allow
    double gapMm_ = 0.0, clearanceMm_ = 0.0;
    core::Vec3 lastRest_ = core::Vec3::Zero();
    bool touching_ = false;
    cases::Tissue strongestTissue_ = cases::Tissue::none;
    bool isHeldOnly_ = false;
    core::Vec3 cutShare_ = core::Vec3::Zero();
    double behindShare_ = 0.0;
    core::Vec3 behindPointMm_ = core::Vec3::Zero();
    contact::Piece strongestBehind_ = contact::Piece::bur;
    int passes_ = 0;
};

}  // namespace handpiece::force
