// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/zones/zones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/field/brick_index.h"

namespace handpiece::zones {
namespace {

using core::Vec3;

/// Of a corner of two half spaces.
double cornerDistance(double a, double b) {
    return a > 0.0 && b > 0.0 ? core::hypot(a, b) : std::max(a, b);
}

}  // namespace

double PastTarget::distanceMm() const {
    return cornerDistance(wallMm, floorMm);
}

Zones::Zones(TargetFunction target, const core::Box& box, const Leeway& leeway, geometry::ScalarFunction protectedMm)
    : target_(std::move(target)), box_(box), leeway_(leeway), protected_(std::move(protectedMm)) {
    if (!(leeway.sideMm >= 0.0 && leeway.sideMm <= 10.0 && leeway.floorMm >= 0.0 && leeway.floorMm <= 10.0))
        throw core::Error("leeway is not within 0 and 10 mm", "zones", "give what may go beside the target");
    if (box.isEmpty()) throw core::Error("the target is empty", "zones", "give a target that lies in the tooth");
}

double Zones::protectedMm(const Vec3& p) const {
    return protected_ ? protected_(p) : kFarMm;
}

double Zones::allowedMm(const PastTarget& past) const {
    return cornerDistance(past.wallMm - leeway_.sideMm, past.floorMm - leeway_.floorMm);
}

Zone Zones::at(const Vec3& p) const {
    const Distances d = distancesMm(p);
    if (d.kept < 0.0) return Zone::protectedZone;
    if (d.target < 0.0) return Zone::target;
    if (d.allowed >= 0.0) return Zone::container;
    return d.wall < 0.0 ? Zone::leewayFloor : Zone::leewaySide;
}

Zones::Distances Zones::distancesMm(const Vec3& p) const {
    const PastTarget past = target_(p);
    return {past.distanceMm(), past.wallMm, allowedMm(past), protectedMm(p)};
}

double ZoneVolumes::removedMm3(Zone zone) const {
    const tooth::TissueVolumes& volumes = removed[static_cast<std::size_t>(zone)];
    return std::accumulate(volumes.begin(), volumes.end(), 0.0);
}

double ZoneVolumes::targetMm3() const {
    return std::accumulate(target.begin(), target.end(), 0.0);
}

ZoneVolumes zoneVolumes(const Zones& zones, const tooth::ToothMirror& cut) {
    const tooth::ToothModel& model = cut.model();
    const field::FieldView view = model.field.view();
    const auto inverseVoxel = static_cast<float>(view.inverseVoxelMm);
    const double voxelMm3 = view.voxelMm * view.voxelMm * view.voxelMm;
    const auto perLayer = static_cast<std::uint32_t>(view.bricks[0]) * static_cast<std::uint32_t>(view.bricks[1]);
    const double edgeMm = field::kBrickCells * view.voxelMm;
    std::vector<ZoneVolumes> layers(static_cast<std::size_t>(view.bricks[2]));
    core::parallelFor(layers.size(), 1, [&](std::size_t begin, std::size_t end) {
        std::array<float, field::kBrickValues> uncut, scratch;
        for (std::size_t layer = begin; layer < end; ++layer)
            for (std::uint32_t i = 0; i < perLayer; ++i) {
                const std::uint32_t dense = static_cast<std::uint32_t>(layer) * perLayer + i;
                if (view.brickIndex[dense] < 0 && view.coarse[dense] >= 0.0f) continue;
                const std::array<std::int32_t, 3> brick = field::brickAt(view.bricks, dense);
                const Vec3 origin(view.originMm[0] + brick[0] * edgeMm, view.originMm[1] + brick[1] * edgeMm,
                                  view.originMm[2] + brick[2] * edgeMm);
                const bool isChanged = cut.isChanged(dense);
                const core::Box& box = zones.box();
                if (!isChanged && ((origin.array() > box.max.array() + view.voxelMm).any() ||
                                   (origin.array() + edgeMm < box.min.array() - view.voxelMm).any()))
                    continue;
                model.uncutBrick(dense, uncut.data());
                const float* now = isChanged ? cut.values(dense, scratch.data()) : uncut.data();
                const std::uint8_t* tissues = model.field.storage().tissues->of(dense);
                for (int z = 0; z < field::kBrickCells; ++z)
                    for (int y = 0; y < field::kBrickCells; ++y)
                        for (int x = 0; x < field::kBrickCells; ++x) {
                            const int at = x + field::kBrickNodes * (y + field::kBrickNodes * z);
                            const float before = tooth::occupancy(uncut[static_cast<std::size_t>(at)], inverseVoxel);
                            if (before <= 0.0f) continue;
                            const float gone = before - tooth::occupancy(now[at], inverseVoxel);
                            const Vec3 p = origin + view.voxelMm * Vec3(x, y, z);
                            const double whole = uncut[static_cast<std::size_t>(at)];
                            const auto share = [&](double distanceMm) {
                                return static_cast<double>(
                                    tooth::occupancy(static_cast<float>(distanceMm), inverseVoxel));
                            };
                            layers[layer].target[tissues[at]] +=
                                share(std::max({whole, zones.targetMm(p), -zones.protectedMm(p)})) * voxelMm3;
                            if (!(gone > 0.0f)) continue;
                            // Each of these holds the one before, so what lies between two of them is told right even
                            // where the cut runs along a border.
                            const Zones::Distances d = zones.distancesMm(p);
                            const double removed = std::max(whole, -static_cast<double>(now[at]));
                            const double free = std::max(removed, -d.kept);
                            const double inTarget = share(std::max(free, d.target)),
                                         underIt = share(std::max({free, d.allowed, d.wall})),
                                         allowed = share(std::max(free, d.allowed)), notKept = share(free),
                                         all = share(removed);
                            const std::array<double, kZoneCount> shares = {inTarget, allowed - underIt,
                                                                           underIt - inTarget, all - notKept,
                                                                           notKept - allowed};
                            for (std::size_t k = 0; k < kZoneCount; ++k)
                                layers[layer].removed[k][tissues[at]] +=
                                    static_cast<double>(gone) * shares[k] / all * voxelMm3;
                        }
            }
    });
    ZoneVolumes total;
    for (const ZoneVolumes& layer : layers)
        for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
            for (std::size_t k = 0; k < kZoneCount; ++k)
                total.removed[k][t] += layer.removed[k][t];
            total.target[t] += layer.target[t];
        }
    return total;
}

}  // namespace handpiece::zones
