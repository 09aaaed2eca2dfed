// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The least of phiB over the tooth's surface, for a bur with a convex outline, in plain data so that it can be
/// compiled once per instruction set.

#include <cstdint>

#include "handpiece/tick/contact/exact/exact_kernels.h"

namespace handpiece::contact {

/// A line or arc of the outline in the half-plane (rho, z); the bur lies on its left.
struct OutlinePiece {
    double from[2], to[2];
    double normalFrom[2], normalTo[2];  ///< unit, out of the bur, at its ends
    double centre[2], radius;           ///< of an arc; radius 0: a line
};
/// The bur lies below: normalRho rho + normalZ z <= offset.
struct OutlineTangent {
    float normalRho, normalZ, offset;
};
inline constexpr int kMaxOutlinePieces = 16, kMaxOutlineTangents = 40;

/// The outline of a convex bur of revolution.
struct Outline {
    OutlinePiece pieces[kMaxOutlinePieces];
    OutlineTangent tangents[kMaxOutlineTangents];
    std::int32_t pieceCount = 0, tangentCount = 0;
    double middleZ = 0.0;        ///< on the axis, inside the bur
    double middleDepthMm = 0.0;  ///< - phiB there
};

/// The place of the surface that is nearest to the bur, or deepest in it.
struct OutlineHit {
    double distance = 0.0;                       ///< phiB there, negative in the bur; goes in as the bound to beat
    double point[3] = {0, 0, 0};                 ///< of the surface
    double inwards[3] = {0, 0, 0};               ///< unit, against the slope of phiB there
    std::uint32_t triangle = SurfaceHit::kNone;  ///< goes in as a seed
};

using NearestToOutline = void (*)(const TreeView& tree, const Outline& outline, const double tip[3],
                                  const double axis[3], OutlineHit& hit) noexcept;

namespace simd_base {
NearestToOutline nearestToOutline() noexcept;
}
namespace simd_avx2 {
NearestToOutline nearestToOutline() noexcept;
}
namespace simd_avx512 {
NearestToOutline nearestToOutline() noexcept;
}

}  // namespace handpiece::contact
