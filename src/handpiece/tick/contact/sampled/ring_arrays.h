// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Rings of points and what is found at them, in the plain arrays that the kernels read. Private to this room.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "handpiece/base/core/simd.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/bur_frame.h"
#include "handpiece/tick/contact/sampled/ring_kernels.h"

namespace handpiece::contact {

inline constexpr std::size_t kSectors = 16;  ///< of a turn

/// Rings of one point or more, laid out once; the touch arrays are written by the kernels. Its arrays never move.
class RingArrays {
  public:
    explicit RingArrays(std::span<const instrument::SurfaceRing> rings);

    std::vector<BurRing> rings;
    std::vector<float> cosines, sines;
    std::vector<std::uint8_t> sector;  ///< beside the cosines
    std::vector<float> heights;        ///< of the rings
    // What was found.
    std::vector<float> axisDistance, distance, gx, gy, gz, least;
    std::vector<std::uint8_t> tissue, live, creased, liveRing;
    std::unique_ptr<bool> skippedDeep = std::make_unique<bool>(false);
    BurRings bur;
    RingTouch touch;
};

/// Least distance found; kNotLiveMm when no point is live.
[[nodiscard]] double leastOf(const RingArrays& arrays) noexcept;

/// Where point j of a ring lies in the tooth frame.
[[nodiscard]] inline core::Vec3 placeOf(const RingArrays& arrays, const BurFrame& frame, const BurRing& ring,
                                        std::int32_t j) noexcept {
    const auto a = static_cast<std::size_t>(ring.angles + j);
    return frame.onAxis(ring.zMm) + ring.rhoMm * (static_cast<double>(arrays.cosines[a]) * frame.x +
                                                  static_cast<double>(arrays.sines[a]) * frame.y);
}
/// A point of the rings in or near the tooth.
struct RingPoint {
    std::size_t ring = 0, angle = 0;  ///< which ring, and where its cosine and sine stand
    double gapMm = 0.0;
};
/// The nearest live points, at least `apartMm` from one another and no farther than the nearest and `windowMm`; each
/// ring counts as nearer by its `inMm` (null: 0). Returns how many.
std::size_t pickNearest(const RingArrays& arrays, const float* inMm, double windowMm, double apartMm,
                        std::span<RingPoint> out) noexcept;

/// Bands of the bur's surface about its rings: one a ring, two where a corner of the outline parts it.
[[nodiscard]] std::vector<BearingBand> bearingBands(const instrument::Bur& bur);

[[nodiscard]] RingKernels ringKernelsFor(core::SimdLevel level);

}  // namespace handpiece::contact
