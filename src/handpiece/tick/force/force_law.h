// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How a contact becomes a push: what one law of force does otherwise than another. examples/own_force_law.cpp.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/tick/force/parameters.h"
#include "handpiece/tick/force/touch.h"

namespace handpiece::force {

/// All that a law may make its push of.
struct LawInput {
    const Touch& touch;
    const core::Vec3& velocityMmS;  ///< of the device, filtered
    const Parameters& parameters;
    const Limits& limits;
};

/// Spring, damper and friction of what is touched.
struct KelvinVoigt {
    double stiffnessNPerMm, dampingNSPerMm, friction;
};
/// Means over the tissues that are pressed, times the multipliers, capped by the device.
[[nodiscard]] KelvinVoigt couplingOf(const LawInput& input) noexcept HANDPIECE_REALTIME;

/// One law. ForceModel owns one of each that there is, in its thread, and does for all of them what is alike: whether
/// the pose is believed, fading in, friction and the sideways force of the turning bur, the device's force and slope.
class ForceLaw {
  public:
    virtual ~ForceLaw() = default;

    /// Whether the bur is held on the surface by a proxy. Without one it is where the hand has it: there are no patches
    /// and no friction.
    [[nodiscard]] virtual bool usesProxy() const noexcept HANDPIECE_REALTIME { return true; }

    /// The force with which the tooth pushes the hand [N], tooth frame; zero when they do not touch. Asked once a tick
    /// while the pose is believed and the bur is not waiting to be clear. What is not finite counts as zero.
    [[nodiscard]] virtual core::Vec3 pushN(const LawInput& input) noexcept HANDPIECE_REALTIME = 0;

    /// Contact begins anew (another tooth, a pose that was lost): forgets what went before.
    virtual void reset() noexcept HANDPIECE_REALTIME {}
};

/// Makes a law; called off the tick.
using LawFactory = std::function<std::unique_ptr<ForceLaw>()>;

/// Gives a law of one's own a name, for as long as the program runs. Before any ForceModel is made, from main. Throws
/// core::Error for a name that is taken.
LawId addLaw(std::string name, LawFactory make);
[[nodiscard]] std::size_t lawCount();
/// One of each, by LawId.
[[nodiscard]] std::vector<std::unique_ptr<ForceLaw>> makeLaws();

}  // namespace handpiece::force
