// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The bur's surface points in the tooth's field: contact patches and constraints. Private to this room.

#include <cstdint>
#include <vector>

#include "handpiece/base/core/simd.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_field.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/contact/ring_kernels.h"

namespace handpiece::contact {

/// Feels the field with the bur's surface rings. Cost depends on the contact, never on the mesh. For one thread.
class RingSensor {
  public:
    RingSensor(const tooth::ToothField& field, const instrument::Bur& bur, core::SimdLevel level);

    void patches(const core::Pose& burInTooth, PatchSet& out) noexcept;
    Status constraints(const core::Pose& burInTooth, double reachMm, ConstraintSet& out) noexcept;

  private:
    struct Ring {
        double z, rho, area;
        int count, eights;
        std::size_t first;    ///< its first point in the arrays below; each ring has a multiple of eight
        std::size_t angles;   ///< its cosines and sines
        std::size_t middles;  ///< cosines and sines of the middles of its eights
        double chordMm;       ///< from the middle of eight points to the outermost
    };
    struct Run {                      ///< neighbouring points of a ring in contact
        std::int32_t ring, from, to;  ///< to is one past the last
        std::int32_t root;
    };
    static constexpr std::size_t kMaxRuns = 1024;
    static constexpr int kSectors = 16;

    /// Looks up every point that may be nearer than `thresholdMm`; sets live_ and, with gradients, gx_ gy_ gz_.
    void sense(const core::Pose& burInTooth, double thresholdMm) noexcept;
    void senseEight(std::size_t ring, const FieldRow& row, int eight, double thresholdMm) noexcept;
    [[nodiscard]] core::Vec3 pointMm(const Ring& ring, int j) const noexcept;
    [[nodiscard]] tooth::Tissue tissueAt(const Ring& ring, int j) const noexcept;
    [[nodiscard]] core::Vec3 normalAt(std::size_t at) const noexcept;
    std::size_t findRuns() noexcept;
    void joinRuns(std::size_t begin, std::size_t middle, std::size_t end) noexcept;
    [[nodiscard]] std::int32_t rootOf(std::int32_t run) noexcept;
    [[nodiscard]] bool isLocalMinimum(std::size_t ring, int j) const noexcept;

    const tooth::ToothField& field_;
    tooth::FieldView view_;
    RingKernels kernels_;
    std::vector<Ring> rings_;
    std::vector<double> cosines_, sines_;
    std::vector<double> heights_, zeros_;         ///< of the rings, for lookups along the axis
    std::vector<float> axisDistance_;             ///< of the rings' middles
    std::vector<float> distance_, gx_, gy_, gz_;  ///< by point
    std::vector<std::uint8_t> tissue_;            ///< by point
    std::vector<std::uint8_t> live_;              ///< by point: looked up and within the threshold
    std::vector<std::uint8_t> liveRing_;          ///< by ring: has such points
    std::vector<Run> runs_;
    std::vector<std::uint32_t> candidates_;
    core::Vec3 tip_ = core::Vec3::Zero(), x_ = core::Vec3::UnitX(), y_ = core::Vec3::UnitY(), z_ = core::Vec3::UnitZ();
};

}  // namespace handpiece::contact
