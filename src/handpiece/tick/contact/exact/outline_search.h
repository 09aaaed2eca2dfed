// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tooth's surface against a bur with sharp rims. Private to this room.

#include <memory>

#include "handpiece/base/core/simd.h"
#include "handpiece/base/core/vec.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/bur_frame.h"
#include "handpiece/tick/contact/exact/exact_depth.h"
#include "handpiece/tick/contact/exact/outline_kernels.h"

namespace handpiece::contact {

/// Of a medial ball (c, R) with its centre outside the tooth, and the tooth's nearest place q, phiB(q) <= |c - q| - R:
/// so none of those balls is deeper than - min of phiB over the tooth's surface, and that is never deeper than the
/// depth. For a convex bur phiB is convex, and tangents bound it over boxes and triangles. What is left to the axis and
/// the sheets are the balls with their centres in the tooth. Those are small where a deeper place m of the bur lies
/// outside: on the way from c to m phiB is -R at most, and where that way leaves the tooth it is no less than the
/// least found. While the two are apart there are none.
///
/// The answer does not depend on the last one; its triangle only saves time.
class OutlineSearch {
  public:
    OutlineSearch(const instrument::Bur& bur, core::SimdLevel level);

    /// Whether this bur can be searched for so: convex, of few pieces, and with sheets worth sparing.
    [[nodiscard]] bool isFit() const noexcept { return outline_ != nullptr; }
    /// Raises `best` to - min of phiB over the surface, and returns how large a ball with its centre in the tooth that
    /// is deeper can be [mm]: 0 where the two are apart, for then this is all; infinity where that is not known.
    [[nodiscard]] double search(const ExactSurface& surface, const BurFrame& frame, BallDepth& best) noexcept;
    void reset() noexcept { seed_ = geometry::kNoTriangle; }

  private:
    std::unique_ptr<const Outline> outline_;
    NearestToOutline nearest_;
    std::uint32_t seed_ = geometry::kNoTriangle;
};

}  // namespace handpiece::contact
