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
    // A scan's noise decides which places count: what surely does, and what might, say how much hangs on that.
    const double noise = tooth.preparation().noiseMm;
    const double aslant = std::min(0.2, 10.0 * noise), under = 3.0 * noise;
    std::vector<double> left(points.size(), kFar), surely(noise > 0.0 ? points.size() : 0, kFar), maybe = surely;
    core::parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        CutTooth::Look look(tooth);
        for (std::size_t i = begin; i < end; ++i) {
            const SurfacePoint& point = points[i];
            // On a wall that lies towards this side.
            const double upright = std::abs(point.n.dot(frame.w)), faces = -point.n.dot(*towards);
            if (upright > kSin45 + aslant || faces < 0.5 - aslant) continue;
            const double deep = -tooth.whole().tree.signedDistance(point.p);
            if (deep < kUnderMm - under) continue;
            const bool counts = upright <= kSin45 && faces >= 0.5 && deep >= kUnderMm;
            const bool isSure = upright <= kSin45 - aslant && faces >= 0.5 + aslant && deep >= kUnderMm + under;
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
                if (!(out > 0.0)) continue;
                const double slope = look.normalBefore(point.p + out * along).dot(along), open = 2.0 * noise;
                if (counts && slope > kSin45) left[i] = std::min(left[i], out);
                if (noise > 0.0 && isSure && slope > kSin45 + open) surely[i] = std::min(surely[i], out);
                if (noise > 0.0 && slope > kSin45 - open) maybe[i] = std::min(maybe[i], out);
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
    Taken taken = at(least, place, "thinnest place of the ridge");
    if (noise > 0.0) {
        const double sure = *std::min_element(surely.begin(), surely.end());
        const double might = *std::min_element(maybe.begin(), maybe.end());
        if (sure == kFar) return none("the scan does not show surely which slope is the ridge");
        taken.offMm = std::max(sure - least, least - might);
    }
    return taken;
}

}  // namespace handpiece::measures
