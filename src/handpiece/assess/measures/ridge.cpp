// SPDX-License-Identifier: Apache-2.0
// marginal-ridge-left
#include <algorithm>
#include <limits>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr int kMostCrossings = 8;
constexpr double kUnderMm = 0.2;  // nearer under the uncut surface the margin's own edge is measured
// Towards the side, and 15 degrees off.
constexpr double kAways[3][2] = {{1.0, 0.0}, {0.9659258, 0.2588190}, {0.9659258, -0.2588190}};

}  // namespace

Taken takeMarginalRidge(CutTooth& tooth, const Selection& of) {
    if (of.side != "mesial" && of.side != "distal") return none("a marginal ridge is mesial or distal: name the side");
    const auto towards = sideDirection(tooth.preparation().axes, of.side);
    if (!towards) return none("the path of draw runs along that side");
    if (tooth.cutPoints().empty()) return none("nothing was cut");
    if (tooth.form() == Form::crown) return none("a crown preparation leaves no marginal ridge");
    const std::vector<SurfacePoint>& points = tooth.cutPoints();
    const DrawFrame& frame = tooth.frame();
    const Vec3 square = frame.w.cross(*towards);
    constexpr double kFar = std::numeric_limits<double>::infinity();
    std::vector<double> left(points.size(), kFar);
    core::parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        CutTooth::Look look(tooth);
        for (std::size_t i = begin; i < end; ++i) {
            const SurfacePoint& point = points[i];
            // On a wall that lies towards this side.
            if (std::abs(point.n.dot(frame.w)) > kSin45 || point.n.dot(*towards) > -0.5) continue;
            if (tooth.whole().tree.signedDistance(point.p) > -kUnderMm) continue;
            for (const auto& away : kAways) {
                const Vec3 along = away[0] * *towards + away[1] * square;
                // To the outside: a groove that is crossed on the way is none.
                double out = 0.0;
                for (int crossing = 0; crossing < kMostCrossings; ++crossing) {
                    const geometry::RayMeeting met = tooth.whole().tree.firstMeeting(point.p + out * along, along);
                    if (met.triangle == geometry::kNoTriangle) break;
                    out += met.distanceMm + 1e-4;
                }
                out -= 1e-4;
                // Through the ridge, not through a cusp's slope over it.
                if (out > 0.0 && look.normalBefore(point.p + out * along).dot(along) > kSin45)
                    left[i] = std::min(left[i], out);
            }
        }
    });
    double least = kFar;
    Vec3 place = Vec3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i)
        if (left[i] < least) {
            least = left[i];
            place = points[i].p;
        }
    if (least == kFar) return none("no " + of.side + " wall: the cavity is open there, or has none that steep");
    return at(least, place, "thinnest place of the ridge");
}

}  // namespace handpiece::measures
