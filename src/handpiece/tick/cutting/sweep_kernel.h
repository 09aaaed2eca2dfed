// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Raises a brick's values to minus the distance to a bur's outline. Plain data, compiled once per instruction set; the
/// same bits at every one.
///
/// Positions are 32-bit integers in the bur's frame, in units so small that their rounding is below a nanometre: sums
/// of them are exact, so a node has the same position in every brick that holds it, whatever the order of the sums.

#include <cstdint>

#include "handpiece/model/case/tissue.h"
#include "handpiece/model/field/field_view.h"

namespace handpiece::cutting {

/// A piece of the outline, in kernel units. A line: its start, unit direction and length; a point's offset from it is
/// measured along the outward normal (uz, -ur). An arc: its centre, and its chord for telling which points face it.
struct SweepPiece {
    float r0, z0;            ///< a line's start; an arc's centre
    float ur, uz, length;    ///< line
    float radius, bulge;     ///< arc: radius > 0; bulge +1 convex, -1 concave. A line has radius 0
    float chordR, chordZ;    ///< arc: unit chord times bulge
    float chordOffset;       ///< arc: a point (v from the centre) faces it when radius chord x v + chordOffset |v| <= 0
    float ends[2][2];        ///< arc: its ends
    float endSign[2];        ///< side on which points beyond an end lie: 0 that of the piece itself, 1 out, -1 in
    std::int32_t endsCount;  ///< arc: bit e set when the neighbour does not measure to end e
};

/// All bricks of one pose.
struct SweepPass {
    const std::int32_t*
        offset[3];              ///< kSweepRoom each, aligned to 64 bytes: node i's place from its brick's first node
    const std::int32_t* owned;  ///< -1 for nodes that the brick counts, else 0
    const SweepPiece* pieces;
    float unitMm;
    float bandOutMm;
    float perMm, half;  ///< a value v counts for half - perMm v quanta, rounded, at least 0, at most kSweepQuanta
    float showsMm;      ///< a rise shows when it comes from below this to above minus this
};
inline constexpr int kSweepNodes = field::kBrickValues;
/// Nodes are looked at in steps of sixteen; the last step reaches back.
inline constexpr int kSweepSteps = (kSweepNodes + 15) / 16;
inline constexpr int kSweepDues = 48;   ///< with room to read whole vectors; beyond the steps kSweepMostWay
inline constexpr int kSweepRoom = 752;  ///< with what the last steps write or read too much
/// Of a node that is all tissue.
inline constexpr std::int32_t kSweepQuanta = 1 << 23;

/// How much of the outline a brick needs.
enum class SweepForm : std::uint8_t { general, lines, line, wall, ball, capsule };

struct SweepBrick {
    std::int32_t base[3];       ///< place of the first node
    const std::uint16_t* list;  ///< the pieces that can be nearest
    std::int32_t count;
    /// lines: two of them; line: the one piece is a line and every node faces it; wall: the same, up along the axis;
    /// ball: the same for an arc round the axis; capsule: the same for such an arc and the cylinder of its radius above
    /// its centre.
    SweepForm form;
    const std::uint8_t* tissue;  ///< per node; null: all of tissue `uniform`
    std::uint8_t uniform;
    /// The bur's way so far, rounded up, and for each step the way before which nothing in it can rise, in quanta of
    /// kSweepWayMm.
    std::int32_t way;
    std::int32_t* due;  ///< kSweepDues
};
inline constexpr float kSweepWayMm = 1e-5f;
/// Farther than this a way is not counted; of a step that can never rise.
inline constexpr std::int32_t kSweepMostWay = 2000000000;
struct SweepOutcome {
    bool rose, shows;  ///< `shows`: within 1.8 voxels of the surface
    std::int32_t due;  ///< the earliest of its steps
};
/// Plain row of brick centres.
struct SweepRow {
    std::int32_t base[3], step[3];
    std::int32_t count;
};

struct SweepKernels {
    void (*makeOffsets)(const std::int32_t (&axes)[3][3], std::int32_t* const (&offset)[3]);
    /// `quanta`: what was taken is added, by tissue.
    SweepOutcome (*raise)(const SweepPass& pass, const SweepBrick& brick, float* values, std::int64_t* quanta);
    /// The largest of minus the distance over a brick's nodes [mm].
    float (*highest)(const SweepPass& pass, const SweepBrick& brick);
    /// Raises the coarse values (negative, of bricks that are not stored) of a row of bricks; `list` as in SweepBrick.
    void (*raiseRow)(const SweepPass& pass, const SweepRow& row, const std::uint16_t* list, std::int32_t listCount,
                     const std::int32_t* brickIndex, float* coarse);
};

namespace simd_base {
SweepKernels sweepKernels() noexcept;
}
namespace simd_avx2 {
SweepKernels sweepKernels() noexcept;
}
namespace simd_avx512 {
SweepKernels sweepKernels() noexcept;
}

}  // namespace handpiece::cutting
