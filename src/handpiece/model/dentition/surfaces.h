// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A specification as functions of space, negative inside. Private to this room.

#include <algorithm>
#include <array>

#include "handpiece/model/dentition/anatomy.h"

namespace handpiece::dentition {

/// max(a, b) with the edge rounded over `width`, never below max.
[[nodiscard]] inline double smoothMax(double a, double b, double width) {
    const double h = std::max(width - std::abs(a - b), 0.0) / width;
    return std::max(a, b) + 0.25 * width * h * h;
}
[[nodiscard]] inline double smoothMin(double a, double b, double width) {
    return -smoothMax(-a, -b, width);
}
[[nodiscard]] double smoothStep(double from, double to, double x);
/// A line with its corners cut (Chaikin); the ends stay.
[[nodiscard]] std::vector<core::Vec3> rounded(std::vector<core::Vec3> points);

/// A smooth curve through values at heights, which never swings beyond them (Fritsch and Carlson).
class Profile {
  public:
    struct Knot {
        double z, value, slope = 0.0;
    };
    explicit Profile(std::vector<Knot> knots);
    [[nodiscard]] double at(double z) const;

  private:
    std::vector<Knot> knots_;
};

/// A body seen from its four sides, each outline a profile, with a cross-section between an ellipse and a rectangle;
/// closed like an ellipsoid below and, if asked, above.
class Loft {
  public:
    struct Outlines {
        Profile mesial, distal, buccal, lingual;  ///< how far it stands out towards +x, -x, -y, +y
        Profile square, waist;
    };
    struct Ends {
        double bottomZ, bottomLength;
        double topZ = 0.0, topLength = 0.0;  ///< length 0: open
    };
    Loft(Outlines outlines, Ends ends, double lean = 0.0, double wedge = 0.0, double skew = 0.0);
    Loft(const std::vector<Section>& sections, Ends ends, double lean = 0.0, double wedge = 0.0, double skew = 0.0);
    [[nodiscard]] double value(const core::Vec3& p) const;

  private:
    Outlines outlines_;
    Ends ends_;
    double lean_, wedge_, skew_;  ///< of the crown: they fade out below the cervix
};

/// A smooth field of random heights, about normal with a spread of 1, of waves some 2 to 5 mm long.
class Unevenness {
  public:
    Unevenness() = default;
    Unevenness(std::uint64_t seed, const core::Box& box);
    [[nodiscard]] double at(const core::Vec3& p) const;
    /// A place in it for finer waves: the same field, smaller, folded over and over.
    [[nodiscard]] core::Vec3 folded(const core::Vec3& p) const;

  private:
    [[nodiscard]] std::size_t index(int i, int j, int k) const {
        return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(size_[0]) +
               static_cast<std::size_t>(i);
    }

    core::Vec3 origin_ = core::Vec3::Zero();
    int size_[3] = {0, 0, 0};
    std::vector<double> nodes_;
};

/// One tooth in the frame of anatomy.h.
class Anatomy {
  public:
    explicit Anatomy(Spec spec);

    [[nodiscard]] double outer(const core::Vec3& p) const;
    [[nodiscard]] double enamel(const core::Vec3& p) const;
    [[nodiscard]] double dentine(const core::Vec3& p) const;
    [[nodiscard]] double pulp(const core::Vec3& p) const;
    [[nodiscard]] double cementum(const core::Vec3& p) const;
    [[nodiscard]] double aboveCervix(const core::Vec3& p) const;
    [[nodiscard]] core::Box bounds() const;
    [[nodiscard]] const Spec& spec() const { return spec_; }

    /// The point of the surface where the way from `from` along `direction` first leaves the tooth, looked for from
    /// outside; false when it misses.
    [[nodiscard]] bool surfaceAlong(const core::Vec3& from, const core::Vec3& direction, core::Vec3& found) const;
    /// The highest point of the surface near one of it: up the slope in small steps.
    [[nodiscard]] core::Vec3 climbed(core::Vec3 p) const;
    /// The outermost point of the surface in a direction, by climbing from the one seen from `start`.
    [[nodiscard]] core::Vec3 outermost(const core::Vec3& direction, const core::Vec3& start) const;

    [[nodiscard]] double buccalCervixZ() const { return cervix_[2]; }
    // Measured on the surface.
    core::Vec3 highest, lowest, mesialContact, distalContact, buccalContour, lingualContour;

  private:
    struct Curve {
        core::Vec3 a, b, c;  ///< a + 2 b t + c t^2
        double round, slope, reach, topZ;
        core::Vec2 middle;
        std::array<core::Vec2, 7> along{};  ///< places of it from one end to the other, from above
    };
    struct Bump {
        core::Vec3 centre, inverseRadii;
        double depth;
    };
    struct Plane {
        core::Vec3 at, normal;
    };
    struct Line {
        std::vector<core::Vec3> points;
        std::vector<double> widths;  ///< shares of halfWidth, one a point
        double halfWidth, fromZ, toZ;
        core::Vec2 middle;
        double reach;
    };
    [[nodiscard]] double occlusalHeight(double x, double y) const;
    [[nodiscard]] static double heightOver(const Curve& curve, double x, double y, double atLeast);
    [[nodiscard]] double grooveDepth(const core::Vec3& p) const;
    [[nodiscard]] double body(const core::Vec3& p) const;  ///< without grooves and the step at the cervix
    [[nodiscard]] double chamber(const core::Vec3& p) const;
    [[nodiscard]] double step(double above) const;
    [[nodiscard]] double core(const core::Vec3& p, double bodyValue) const;
    void settleGrooves();
    void grind();
    void measure();

    Spec spec_;
    Loft crown_;
    std::vector<Loft> roots_;
    std::vector<Loft> chamber_;
    std::vector<Curve> rim_, curves_;
    std::vector<Line> lines_;
    std::vector<Bump> bumps_;
    std::vector<Plane> facets_;
    Unevenness uneven_;
    double cervix_[4];  ///< heights of the cemento-enamel junction: mesial, distal, buccal, lingual
    double topZ_, apexZ_, reach_;
};

}  // namespace handpiece::dentition
