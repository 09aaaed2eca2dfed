// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The searches on their own. Private to this room.

#include <optional>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/scan/landmarks/relief.h"

namespace handpiece::landmarks {

inline constexpr double kAverageAgeYears = 25.0;

/// The best pairs of expected and found places: as many as lie within reach of each other, then the nearest.
/// For each expected one the index of the found one, or -1.
[[nodiscard]] std::vector<int> paired(const std::vector<core::Vec2>& expected, const std::vector<core::Vec2>& found,
                                      double reachMm);

/// How far a crown is turned about z from where the average one of its FDI number stands, by their shapes from above.
struct Turn {
    double rad = 0.0;        ///< anticlockwise, from above; 0 as long as the crown may as well stand as it should
    double misfitMm = 0.0;   ///< mean difference of heights there
    double asGivenMm = 0.0;  ///< the same as the crown stands
};
[[nodiscard]] Turn turnOf(int fdiNumber, const geometry::TriangleMesh& outer);

/// A valley or crest of a surface seen from above that runs about where `expected` does: its places in the same order,
/// as far as it shows; empty where less than most of it does.
enum class LineOf { valley, crest };
[[nodiscard]] std::vector<core::Vec2> lineAlong(const Relief& relief, const std::vector<core::Vec2>& expected,
                                                LineOf what);

/// The outermost points of the surface around an axis along z.
class Around {
  public:
    Around(const geometry::TriangleTree& tree, const core::Vec2& axis) : tree_(tree), axis_(axis) {}
    /// Seen from outside; none where the tooth is not.
    [[nodiscard]] std::optional<core::Vec3> side(double rad, double z) const;
    [[nodiscard]] const core::Vec2& axis() const { return axis_; }

  private:
    const geometry::TriangleTree& tree_;
    core::Vec2 axis_;
};

/// The ring of greatest widths; empty where the sides are too straight to tell.
[[nodiscard]] std::vector<core::Vec3> heightOfContour(const Around& around, double lowZ, double highZ);
/// The ring where the dentine comes to the surface; empty where it does not all around.
[[nodiscard]] std::vector<core::Vec3> cementoEnamelJunction(const Around& around, const geometry::TriangleTree& dentine,
                                                            double highZ);
/// The outermost place of a surface towards `out` between two heights, or, if one of `adjacent` is near, the nearest to
/// that.
[[nodiscard]] std::optional<core::Vec3> contactOn(const geometry::TriangleMesh& outer, const core::Vec3& out,
                                                  double lowZ, double highZ,
                                                  const std::vector<geometry::TriangleTree>& adjacent);

}  // namespace handpiece::landmarks
