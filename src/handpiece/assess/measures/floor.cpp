// SPDX-License-Identifier: Apache-2.0
// floor-depth, floor-depth-shortest, floor-flatness, floor-tilt
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

/// The pulpal floor comes first; "gingival" asks for the largest of those that lie lower.
const Floor* floorOf(CutTooth& tooth, const Selection& of, std::string& reason) {
    if (tooth.cutPoints().empty()) {
        reason = "nothing was cut";
        return nullptr;
    }
    if (tooth.form() == Form::crown) {
        reason = "a crown preparation has no floor";
        return nullptr;
    }
    const std::vector<Floor>& floors = tooth.floors();
    if (floors.empty() || !floors.front().plane.isFound) {
        reason = "no floor faces the path of draw";
        return nullptr;
    }
    if (of.side.empty()) return &floors.front();
    if (of.side != "gingival") {
        reason = "a floor is the pulpal or the gingival one";
        return nullptr;
    }
    for (std::size_t i = 1; i < floors.size(); ++i)
        if (floors[i].plane.isFound && floors[i].plane.at < floors.front().plane.at - kLowerMm) return &floors[i];
    reason = "no floor lies lower than the pulpal one";
    return nullptr;
}

double flatAreaMm2(const Floor& floor) {
    return kProbeMm * kProbeMm * static_cast<double>(floor.flat.size());
}

double unevenIn(const Floor& floor) {
    return meanOf(floor.unevenMm, flatAreaMm2(floor) / (kPieceMm * kPieceMm));
}
/// All of it for the deepest place; else the flat part without its outermost ring, where the corner's radius begins.
const std::vector<int>& placesOf(const Floor& floor, const Selection& of) {
    return of.statistic == "greatest" ? floor.nodes : floor.inner.empty() ? floor.flat : floor.inner;
}
/// What of that ring's change belongs to the value, and what is open (from measures_study).
struct Edge {
    double inside, insidePerVoxelMm, open;
};
constexpr Edge kOfDepth{0.42, -2.2, 1.0}, kOfShortest{0.0, 0.0, 1.05};

/// The corner begins somewhere in the outermost ring. `inner`: the values without it.
void addEdge(const CutTooth& tooth, const Floor& floor, const Selection& of, std::span<const double> inner,
             const std::function<double(int)>& valueOf, const Edge& edge, Taken& taken) {
    if (of.statistic == "greatest" || floor.inner.empty()) return;
    std::vector<double> all;
    for (const int node : floor.flat)
        all.push_back(valueOf(node));
    const auto changeOf = [&](std::string_view statistic) {
        return statisticOf(all, statistic, nullptr) - statisticOf(inner, statistic, nullptr);
    };
    const double change = changeOf(of.statistic.empty() ? "median" : of.statistic);
    constexpr double kScanOpen = 2.0;  // a scanned corner is known to two rings
    // A median may stay where it is by chance; the mean tells that as well.
    taken.offMm = (tooth.preparation().noiseMm > 0.0 ? kScanOpen : edge.open) *
                  std::max(std::abs(change), std::abs(changeOf("mean")));
    *taken.value += std::clamp(edge.inside + edge.insidePerVoxelMm * tooth.voxelMm(), 0.0, 1.0) * change;
}

Vec3 normalOf(const Plane& plane) {
    return Vec3(-plane.slope.x(), -plane.slope.y(), 1.0).normalized();
}

}  // namespace

Taken takeFloorDepth(CutTooth& tooth, const Selection& of) {
    std::string reason;
    const Floor* floor = floorOf(tooth, of, reason);
    if (floor == nullptr) return none(reason);
    const HeightMap& map = tooth.heights();
    Places places;
    // A pit beside a wall counts for the deepest.
    for (const int node : placesOf(*floor, of)) {
        const HeightMap::Node& n = map.nodes[static_cast<std::size_t>(node)];
        places.add(n.before - n.now, tooth.frame().from(map.drawOf(node)));
    }
    Taken taken = places.taken(of, "median", "depth of the floor");
    taken.residual = unevenIn(*floor);
    const auto depthAt = [&](int node) {
        const HeightMap::Node& n = map.nodes[static_cast<std::size_t>(node)];
        return n.before - n.now;
    };
    addEdge(tooth, *floor, of, places.values, depthAt, kOfDepth, taken);
    return taken;
}

Taken takeFloorDepthShortest(CutTooth& tooth, const Selection& of) {
    std::string reason;
    const Floor* floor = floorOf(tooth, of, reason);
    if (floor == nullptr) return none(reason);
    const std::vector<int>& nodes = placesOf(*floor, of);
    Places places;
    places.values.resize(nodes.size());
    places.mm.resize(nodes.size());
    core::parallelFor(nodes.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            places.mm[i] = tooth.frame().from(tooth.heights().drawOf(nodes[i]));
            places.values[i] = -tooth.whole().tree.signedDistance(places.mm[i]);
        }
    });
    Taken taken = places.taken(of, "median", "shortest way to the uncut surface");
    taken.residual = unevenIn(*floor);
    const auto shortestFrom = [&](int node) {
        return -tooth.whole().tree.signedDistance(tooth.frame().from(tooth.heights().drawOf(node)));
    };
    addEdge(tooth, *floor, of, places.values, shortestFrom, kOfShortest, taken);
    return taken;
}

Taken takeFloorFlatness(CutTooth& tooth, const Selection& of) {
    std::string reason;
    const Floor* floor = floorOf(tooth, of, reason);
    if (floor == nullptr) return none(reason);
    const HeightMap& map = tooth.heights();
    const double upright = normalOf(floor->plane).z();
    std::vector<double> off;
    std::size_t lowest = 0;
    for (const int node : floor->flat) {
        const Vec3 q = map.drawOf(node);
        off.push_back(upright * (q.z() - floor->plane.of(q.x(), q.y())));
        if (off.back() < off[lowest]) lowest = off.size() - 1;
    }
    const Vec3 place = tooth.frame().from(map.drawOf(floor->flat[lowest]));
    std::sort(off.begin(), off.end());
    Taken taken = at(percentile(off, 0.975) - percentile(off, 0.025), place, "deepest under the floor's plane");
    taken.residual = unevenIn(*floor);
    return taken;
}

Taken takeFloorTilt(CutTooth& tooth, const Selection& of) {
    std::string reason;
    const Floor* floor = floorOf(tooth, of, reason);
    if (floor == nullptr) return none(reason);
    const Vec3 middle(floor->plane.middle.x(), floor->plane.middle.y(), floor->plane.at);
    Taken taken =
        at(kDegrees * core::atan(floor->plane.slope.norm()), tooth.frame().from(middle), "middle of the floor");
    // Of a slope over a breadth b with n even pieces: root of 12 times their scatter over b root n.
    const double breadth = std::sqrt(flatAreaMm2(*floor));
    taken.residual = kDegrees * 3.46 / breadth * meanOf(floor->unevenMm, breadth / kPieceMm, breadth / kPieceMm);
    return taken;
}

}  // namespace handpiece::measures
