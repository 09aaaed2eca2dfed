// SPDX-License-Identifier: Apache-2.0
// roughness
#include <cmath>

#include "handpiece/assess/measures/take.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr double kCutOffMm = 0.8;  // ISO 4288 [recalled]; the measure's own definition

}  // namespace

Taken takeRoughness(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none("nothing was cut");
    std::vector<Vec3> surface;
    const DrawFrame& frame = tooth.frame();
    Vec3 place = Vec3::Zero();
    const auto finish = [&]() -> Taken {
        const std::vector<double> off = rough(surface, kCutOffMm);
        if (off.size() < 50) return none("too little surface for its roughness");
        double squares = 0.0;
        for (const double z : off)
            squares += z * z;
        return at(1000.0 * std::sqrt(squares / static_cast<double>(off.size())), place, "this surface");
    };
    if (of.side.empty()) {
        if (tooth.form() == Form::crown) return none("of a crown preparation: name a side");
        if (tooth.floors().empty() || tooth.floors().front().flat.empty())
            return none("no floor faces the path of draw; name a side for its wall");
        const Floor& floor = tooth.floors().front();
        for (const int node : floor.flat)
            surface.push_back(tooth.heights().drawOf(node));
        place = frame.from({floor.plane.middle.x(), floor.plane.middle.y(), floor.plane.at});
        return finish();
    }
    const auto towards = sideDirection(tooth.preparation().axes, of.side);
    if (!towards) return none("the path of draw runs along that side, or it is not known");
    const Vec3 across = frame.w.cross(*towards);
    const auto add = [&](const Vec3& p) {
        surface.emplace_back(across.dot(p), frame.w.dot(p), towards->dot(p));
        place = p;
    };
    if (tooth.form() == Form::cavity) {
        // A corner between two walls is no roughness.
        for (const WallStation& wall : tooth.walls()) {
            if (wall.floor != 0 || wall.side != of.side || wall.isCorner) continue;
            for (const WallStation::Sample& s : wall.samples)
                if (s.w > wall.middleFromW && s.w < wall.middleToW)
                    add(frame.from(wall.start) + (s.w - wall.start.z()) * frame.w + s.r * wall.h);
        }
    } else {
        // Where the surface was cut, in the middle of the height of its walls.
        double low = -1e300, high = 1e300;
        for (const AxialStation& wall : tooth.axialWalls())
            if (wall.middle.isFound && wall.hasMargin && wall.side == of.side) {
                low = std::max(low, wall.marginW + 0.25 * (wall.topW - wall.marginW));
                high = std::min(high, wall.marginW + 0.85 * (wall.topW - wall.marginW));
            }
        for (const SurfacePoint& point : tooth.cutPoints()) {
            const double w = frame.w.dot(point.p);
            if (w > low && w < high && point.n.dot(*towards) > kSin45) add(point.p);
        }
    }
    if (surface.empty()) return none("no " + of.side + " wall");
    return finish();
}

}  // namespace handpiece::measures
