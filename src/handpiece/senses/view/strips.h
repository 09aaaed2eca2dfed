// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A slanting thing's part of the picture as narrow rectangles, where one rectangle would be mostly empty. Private to
/// this room.

#include <span>
#include <vector>

#include "handpiece/senses/view/passes.h"

namespace handpiece::view {

/// Rows of rectangles, one over the other, that cover what was added.
class Strips {
  public:
    /// Nothing outside `bounds` is ever covered.
    explicit Strips(const PixelRect& bounds);
    /// The hull of these points [pixels] and two more pixels around it.
    void addHull(std::span<const gl::Vec2f> points);
    void addAll();
    /// Those with something in them; none overlap.
    [[nodiscard]] std::vector<PixelRect> rects() const;

  private:
    struct Range {
        int x0, x1;
    };
    PixelRect bounds_;
    std::vector<Range> rows_;
};

}  // namespace handpiece::view
