// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A bur's pose as lookups want it: made once a query, by whoever is asked.

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::contact {

/// The bur frame in the tooth frame: where the tip lies and which way the axes point, z up the shank. Kernels, which
/// know no vectors, read the numbers where they lie: tip.data() and so on.
struct BurFrame {
    core::Vec3 tip = core::Vec3::Zero(), x = core::Vec3::UnitX(), y = core::Vec3::UnitY(), z = core::Vec3::UnitZ();
    core::Mat3 toBur = core::Mat3::Identity();  ///< its rows are the axes: turns the tooth frame into the bur's

    BurFrame() = default;
    explicit BurFrame(const core::Pose& burInTooth) noexcept HANDPIECE_REALTIME : tip(burInTooth.positionMm) {
        const core::Mat3 rotation = burInTooth.orientation.toRotationMatrix();
        x = rotation.col(0);
        y = rotation.col(1);
        z = rotation.col(2);
        toBur = rotation.transpose();
    }

    /// A place of the bur's axis.
    [[nodiscard]] core::Vec3 onAxis(double zMm) const noexcept HANDPIECE_REALTIME { return tip + zMm * z; }
    /// The box of a bur of this length and radius, `byMm` wider on every side.
    [[nodiscard]] core::Box boxAround(double lengthMm, double radiusMm, double byMm) const noexcept HANDPIECE_REALTIME {
        const core::Vec3 end = onAxis(lengthMm);
        core::Vec3 wide;
        for (int k = 0; k < 3; ++k)
            wide[k] = byMm + radiusMm * std::sqrt(std::max(0.0, 1.0 - z[k] * z[k]));
        return {tip.cwiseMin(end) - wide, tip.cwiseMax(end) + wide};
    }
};

}  // namespace handpiece::contact
