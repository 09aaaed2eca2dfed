// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/built_in_laws.h"

#include <algorithm>

namespace handpiece::force {
namespace {

using core::Vec3;

constexpr double kShallowMm = 1e-9;  // below it a direction cannot be told

/// Spring and damper along `direction`, which leads out of the tooth; the damper grows from none to all over the first
/// of the depth, or touching would click.
Vec3 pushOut(const LawInput& input, const Vec3& direction, double depthMm, double stiffnessNPerMm,
             double dampingNSPerMm) noexcept {
    const double ramp = std::min(1.0, depthMm / input.parameters.dampingRampMm);
    const double approach = -input.velocityMmS.dot(direction);
    return std::max(0.0, stiffnessNPerMm * depthMm + ramp * dampingNSPerMm * approach) * direction;
}

class ProxyLaw final : public ForceLaw {
  public:
    [[nodiscard]] Vec3 pushN(const LawInput& input) noexcept override {
        const Touch& touch = input.touch;
        const Vec3 spring = touch.proxyInTooth.positionMm - touch.deviceInTooth.positionMm;
        const double length = spring.norm();
        if (!touch.touching || length < kShallowMm) return Vec3::Zero();
        const KelvinVoigt kv = couplingOf(input);
        return pushOut(input, spring / length, length, kv.stiffnessNPerMm, kv.dampingNSPerMm);
    }
};

class PenaltyLaw final : public ForceLaw {
  public:
    [[nodiscard]] bool usesProxy() const noexcept override { return false; }
    [[nodiscard]] Vec3 pushN(const LawInput& input) noexcept override {
        const contact::Depth& depth = input.touch.depth;
        if (!(depth.depthMm > 0.0)) return Vec3::Zero();
        const Parameters& p = input.parameters;
        const Limits& limits = input.limits;
        const double k = std::min(p.penaltyStiffnessNPerMm * p.stiffnessMultiplier, limits.maxStiffnessNPerMm);
        const double b = std::min(p.penaltyDampingNSPerMm * p.dampingMultiplier, limits.maxDampingNSPerMm);
        return pushOut(input, depth.normal, depth.depthMm, k, b);
    }
};

}  // namespace

std::unique_ptr<ForceLaw> makeProxyLaw() {
    return std::make_unique<ProxyLaw>();
}

std::unique_ptr<ForceLaw> makePenaltyLaw() {
    return std::make_unique<PenaltyLaw>();
}

}  // namespace handpiece::force
