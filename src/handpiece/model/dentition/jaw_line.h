// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The ridge of a jaw along the roots of its teeth, as smooth as a curve through them. Private to this room.

#include <span>
#include <vector>

#include "handpiece/model/dentition/stander.h"

namespace handpiece::dentition {

class JawLine {
  public:
    /// `up`: +1 of the lower arch, -1 of the upper.
    JawLine(std::span<const Stander> teeth, double up);
    /// Negative inside; about a distance [mm].
    [[nodiscard]] double at(const core::Vec3& p) const;
    /// It is no less than this at p: for those who need only what is small.
    [[nodiscard]] double least(const core::Vec3& p) const;

  private:
    struct Root {
        core::Vec2 neck, lean;  ///< where the tooth's axis is at its neck, and how far aside it is 1 mm deeper
        double heightMm, halfMm;
    };
    std::vector<Root> roots_;
    double up_, highest_;
};

}  // namespace handpiece::dentition
