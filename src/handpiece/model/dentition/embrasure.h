// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What fills the room between two adjacent teeth: the interdental papilla, and the sheets towards lip and tongue that
/// gingiva between them stays behind. Private to this room.

#include <array>
#include <vector>

#include "handpiece/model/dentition/stander.h"

namespace handpiece::dentition {

class Embrasure {
  public:
    /// `outward` [unit]: towards lip or cheek, about.
    Embrasure(const Stander& one, const Stander& two, const core::Vec3& contactMm, const core::Vec3& outward);

    struct Values {
        double papilla;  ///< negative in it
        double sheets;   ///< positive where no gingiva is to stand; very negative away from the papilla
    };
    /// `toOne`, `toTwo`: distances from the teeth.
    [[nodiscard]] Values at(const core::Vec3& p, double toOne, double toTwo) const;

  private:
    /// The straight line that touches both teeth from outside at one height, like a ruler laid on them.
    struct Ruler {
        double level = 0.0, slope = 0.0, from = 0.0, to = 0.0;
        friend Ruler operator+(const Ruler& a, const Ruler& b) {
            return {a.level + b.level, a.slope + b.slope, a.from + b.from, a.to + b.to};
        }
        friend Ruler operator-(const Ruler& a, const Ruler& b) { return a + -1.0 * b; }
        friend Ruler operator*(double f, const Ruler& a) { return {f * a.level, f * a.slope, f * a.from, f * a.to}; }
    };
    struct Side {
        double sign = 1.0;                        ///< of outward: +1 towards the lip, -1 the tongue
        double marginOne = 0.0, marginTwo = 0.0;  ///< heights of the gingival margin in the middle of either tooth
        std::vector<Ruler> rulers;                ///< from the lowest up
    };
    [[nodiscard]] bool layRuler(const Stander& one, const Stander& two, const Side& side, double height,
                                Ruler& ruler) const;
    [[nodiscard]] Ruler rulerAt(const Side& side, double height) const;

    core::Vec3 contact_, along_, up_, out_;
    double alongOne_, alongTwo_;  ///< where the teeth's necks are
    double lowest_ = 0.0, bottom_ = 0.0, tip_ = 0.0;
    std::array<Side, 2> sides_;
};

}  // namespace handpiece::dentition
