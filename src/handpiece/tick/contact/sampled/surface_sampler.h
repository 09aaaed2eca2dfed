// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The bur's surface points in the tooth's field: contact patches and constraints. Private to this room.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/base/core/simd.h"
#include "handpiece/model/field/distance_field.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/contact/sampled/known_surface.h"
#include "handpiece/tick/contact/sampled/ring_arrays.h"

namespace handpiece::contact {

/// A value beyond this share of what a field is held to says no more than "at least".
inline constexpr double kSaturated = 0.98;

/// Feels the surface, which must outlive this, with the bur's surface rings. Cost depends on the contact, never on the
/// mesh. For one thread.
class SurfaceSampler {
  public:
    SurfaceSampler(KnownSurface& surface, const instrument::Bur& bur, core::SimdLevel level);

    void patches(const core::Pose& burInTooth, PatchSet& out) noexcept;
    Status constraints(const core::Pose& burInTooth, double reachMm, ConstraintSet& out) noexcept;
    /// As Method::bearing. The bur turns clockwise for whoever looks down its shank: about -z of its frame.
    void bearing(const core::Pose& burInTooth, const core::Vec3& direction, double leadMm, double leastRadiusMm,
                 Bearing& out) noexcept;

    /// More is known of the surface than when it was sensed last.
    void senseAnew() noexcept { sensedVersion_ = 0; }

    /// True when what was sensed last is of this pose and holds every point up to `windowMm` above the nearest.
    [[nodiscard]] bool hasSensed(const core::Pose& burInTooth, double thresholdMm, double windowMm) const noexcept;
    /// Least distance of the rings' points where they were sensed last; kNotLiveMm when none was within the threshold.
    [[nodiscard]] double leastMm() const noexcept;
    [[nodiscard]] const RingArrays& arrays() const noexcept { return arrays_; }

  private:
    struct Run {                      ///< neighbouring points of a ring in contact
        std::int32_t ring, from, to;  ///< to is one past the last
        std::int32_t root;
    };
    struct Sums {
        TouchSums lanes;
        double area, pressure;
        std::array<double, cases::kTissueCount> tissue;
        std::int32_t root;
    };
    static constexpr std::size_t kMaxRuns = 1024, kMaxSums = 2 * kMaxPatches;
    static constexpr std::size_t kRingsPerBlock = 3;

    void sense(const core::Pose& burInTooth, double thresholdMm, bool skipsDeep) noexcept;
    void sharpen() noexcept;
    [[nodiscard]] bool isSensed(const core::Pose& pose) const noexcept;
    [[nodiscard]] std::uint8_t tissueAt(std::int32_t at) const noexcept;
    std::size_t findRuns() noexcept;
    void joinRuns(std::size_t begin, std::size_t middle, std::size_t end) noexcept;
    [[nodiscard]] std::int32_t rootOf(std::int32_t run) noexcept;
    [[nodiscard]] std::size_t sumRuns(std::size_t runs, Status& status) noexcept;
    /// Keys sort by distance, then by ring and place in it.
    [[nodiscard]] std::uint64_t keyOf(std::size_t ring, std::int32_t j) const noexcept;
    [[nodiscard]] bool isLocalMinimum(std::size_t ring, std::int32_t j) const noexcept;
    std::size_t findMinima() noexcept;
    std::size_t addSectors(std::size_t minima) noexcept;

    KnownSurface& surface_;
    const field::DistanceField& field_;
    field::FieldView view_;
    RingKernels kernels_;
    RingArrays arrays_;
    std::vector<BearingBand> bands_;
    std::vector<std::uint8_t> tissues_;  ///< that can be touched, rising
    std::uint8_t tissueOfAll_;           ///< the only one, or kManyTissues
    RingQuery query_{};
    core::Pose sensedPose_;
    std::uint64_t sensedVersion_ = 0;

    std::vector<Run> runs_;
    std::array<Sums, kMaxSums> sums_;
    std::vector<std::uint64_t> candidates_;
    std::vector<std::uint64_t> nearest_;  ///< key of the nearest point by block of rings and sector
    BurFrame frame_;                      ///< where the rings were sensed last
};

}  // namespace handpiece::contact
