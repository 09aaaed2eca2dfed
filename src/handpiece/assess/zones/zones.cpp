// SPDX-License-Identifier: Apache-2.0
#include "handpiece/assess/zones/zones.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/field/brick_index.h"
#include "handpiece/model/tooth/tooth_state.h"

namespace handpiece::zones {
namespace {

using core::Vec3;

/// Where a node of a brick lies: the same bits whichever of the bricks that hold it asks.
Vec3 nodeMm(const field::FieldView& view, std::uint32_t dense, int x, int y, int z) {
    const std::array<std::int32_t, 3> brick = field::brickAt(view.bricks, dense);
    const int node[3] = {x, y, z};
    Vec3 p;
    for (int k = 0; k < 3; ++k)
        p[k] = view.originMm[k] + view.voxelMm * (field::kBrickCells * brick[static_cast<std::size_t>(k)] + node[k]);
    return p;
}
/// True when a brick may reach into the box, grown by `byMm`.
bool isNear(const field::FieldView& view, std::uint32_t dense, const core::Box& box, double byMm) {
    const Vec3 low = nodeMm(view, dense, 0, 0, 0),
               high = nodeMm(view, dense, field::kBrickCells, field::kBrickCells, field::kBrickCells);
    return !((low.array() > box.max.array() + byMm).any() || (high.array() < box.min.array() - byMm).any());
}

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
    return {past.distanceMm(), past.besideMm, allowedMm(past), protectedMm(p)};
}

std::optional<double> Zones::distanceMm(std::string_view zone, const Vec3& p) const {
    const Distances d = distancesMm(p);
    const double free = -d.kept;
    if (zone == "target") return std::max(d.target, free);
    if (zone == "leeway-side") return std::max({d.allowed, -d.target, -d.wall, free});
    if (zone == "leeway-floor") return std::max({d.allowed, -d.target, d.wall, free});
    if (zone == "protected") return d.kept;
    if (zone == "container") return std::max(-d.allowed, free);
    return std::nullopt;
}

double ZoneVolumes::removedMm3(Zone zone) const {
    return tooth::sumOf(removed[static_cast<std::size_t>(zone)]);
}

double ZoneVolumes::targetMm3() const {
    return tooth::sumOf(whole[static_cast<std::size_t>(Zone::target)]);
}

namespace {

/// Calls f(dense brick, layer) for the bricks of a tooth that hold something, its layers in parallel.
template <class F>
void forBricksOf(const tooth::ToothModel& model, F&& f) {
    const field::FieldView view = model.field.view();
    const auto perLayer = static_cast<std::uint32_t>(view.bricks[0]) * static_cast<std::uint32_t>(view.bricks[1]);
    core::parallelFor(static_cast<std::size_t>(view.bricks[2]), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t layer = begin; layer < end; ++layer)
            for (std::uint32_t i = 0; i < perLayer; ++i) {
                const std::uint32_t dense = static_cast<std::uint32_t>(layer) * perLayer + i;
                if (view.brickIndex[dense] >= 0 || view.coarse[dense] < 0.0f) f(dense, layer);
            }
    });
}

/// The nodes that a brick's voxels belong to: f(place in the brick, tooth frame).
template <class F>
void forNodesOf(const field::FieldView& view, std::uint32_t dense, F&& f) {
    for (int z = 0; z < field::kBrickCells; ++z)
        for (int y = 0; y < field::kBrickCells; ++y)
            for (int x = 0; x < field::kBrickCells; ++x)
                f(static_cast<std::size_t>(x + field::kBrickNodes * (y + field::kBrickNodes * z)),
                  nodeMm(view, dense, x, y, z));
}

template <std::size_t N>
std::array<tooth::TissueVolumes, N> sumOf(const std::vector<std::array<tooth::TissueVolumes, N>>& layers) {
    std::array<tooth::TissueVolumes, N> total{};
    for (const auto& layer : layers)
        for (std::size_t k = 0; k < N; ++k)
            for (std::size_t t = 0; t < cases::kTissueCount; ++t)
                total[k][t] += layer[k][t];
    return total;
}

/// What of a voxel lies in the target, in all in and under it, in what may go, outside of what is kept, and in the
/// tooth. Each holds those before it (target and what is under it both lie in what may go), so what lies between two of
/// them is told right even where a surface runs along a border.
std::array<double, 5> nested(double inside, const Zones::Distances& d, float inverseVoxel) {
    const double free = std::max(inside, -d.kept);
    const auto share = [&](double mm) {
        return static_cast<double>(tooth::occupancy(static_cast<float>(mm), inverseVoxel));
    };
    return {share(std::max(free, d.target)), share(std::max({free, d.allowed, d.wall})),
            share(std::max(free, d.allowed)), share(free), share(inside)};
}

}  // namespace

WholeVolumes wholeVolumes(const Zones& zones, const tooth::ToothModel& model) {
    const field::FieldView view = model.field.view();
    const auto inverseVoxel = static_cast<float>(view.inverseVoxelMm);
    const double voxelMm3 = view.voxelMm * view.voxelMm * view.voxelMm;
    const double reachMm = view.voxelMm + std::max(zones.leeway().sideMm, zones.leeway().floorMm);
    std::vector<WholeVolumes> layers(static_cast<std::size_t>(view.bricks[2]));
    forBricksOf(model, [&](std::uint32_t dense, std::size_t layer) {
        if (!isNear(view, dense, zones.box(), reachMm)) return;
        std::array<float, field::kBrickValues> uncut;
        model.uncutBrick(dense, uncut.data());
        const std::uint8_t* tissues = model.field.storage().tissues->of(dense);
        forNodesOf(view, dense, [&](std::size_t at, const Vec3& p) {
            if (!(tooth::occupancy(uncut[at], inverseVoxel) > 0.0f)) return;
            const auto [target, under, allowed, notKept, all] = nested(uncut[at], zones.distancesMm(p), inverseVoxel);
            const std::array<double, 3> wholes = {target, allowed - under, under - target};
            for (std::size_t k = 0; k < wholes.size(); ++k)
                layers[layer][k][tissues[at]] += wholes[k] * voxelMm3;
        });
    });
    return sumOf(layers);
}

RemovedVolumes removedVolumes(const Zones& zones, const tooth::ToothMirror& cut) {
    const tooth::ToothModel& model = cut.model();
    const field::FieldView view = model.field.view();
    const auto inverseVoxel = static_cast<float>(view.inverseVoxelMm);
    const double voxelMm3 = view.voxelMm * view.voxelMm * view.voxelMm;
    std::vector<RemovedVolumes> layers(static_cast<std::size_t>(view.bricks[2]));
    forBricksOf(model, [&](std::uint32_t dense, std::size_t layer) {
        if (!cut.isChanged(dense)) return;
        std::array<float, field::kBrickValues> uncut, scratch;
        model.uncutBrick(dense, uncut.data());
        const float* now = cut.values(dense, scratch.data());
        const std::uint8_t* tissues = model.field.storage().tissues->of(dense);
        forNodesOf(view, dense, [&](std::size_t at, const Vec3& p) {
            const float before = tooth::occupancy(uncut[at], inverseVoxel);
            const float gone = before > 0.0f ? before - tooth::occupancy(now[at], inverseVoxel) : 0.0f;
            if (!(gone > 0.0f)) return;
            const double inside = std::max<double>(uncut[at], -now[at]);
            const auto [target, under, allowed, notKept, all] = nested(inside, zones.distancesMm(p), inverseVoxel);
            const std::array<double, kZoneCount> shares = {target, allowed - under, under - target, all - notKept,
                                                           notKept - allowed};
            for (std::size_t k = 0; k < kZoneCount; ++k)
                layers[layer][k][tissues[at]] += static_cast<double>(gone) * shares[k] / all * voxelMm3;
        });
    });
    return sumOf(layers);
}

ZoneVolumes zoneVolumes(const Zones& zones, const tooth::ToothMirror& cut) {
    return {removedVolumes(zones, cut), wholeVolumes(zones, cut.model())};
}

tooth::StateDelta idealState(const Zones& zones, std::shared_ptr<const tooth::ToothModel> whole) {
    tooth::ToothState state(std::move(whole));
    const tooth::ToothModel& model = state.model();
    const field::FieldView view = state.field().view();
    const auto low = static_cast<float>(-model.settings.bandMm), high = static_cast<float>(model.bandOutMm);
    const auto bricks = static_cast<std::uint32_t>(view.bricks[0]) * static_cast<std::uint32_t>(view.bricks[1]) *
                        static_cast<std::uint32_t>(view.bricks[2]);
    // Places of bricks the target may reach; what it does to them in parallel, in their order.
    std::vector<std::uint32_t> near;
    for (std::uint32_t dense = 0; dense < bricks; ++dense) {
        if (model.field.storage().brickIndex[dense] < 0 && view.coarse[dense] >= 0.0f) continue;
        if (isNear(view, dense, zones.box(), high)) near.push_back(dense);
    }
    std::vector<std::array<float, field::kBrickValues>> cut(near.size());
    std::vector<char> reaches(near.size(), 0);
    core::parallelFor(near.size(), 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (int k = 0; k < field::kBrickValues; ++k) {
                const Vec3 p = nodeMm(view, near[i], k % 9, k / 9 % 9, k / 81);
                const auto value = static_cast<float>(std::min(-zones.targetMm(p), zones.protectedMm(p)));
                cut[i][static_cast<std::size_t>(k)] = std::clamp(value, low, high);
                reaches[i] |= value > low;
            }
        }
    });
    for (std::size_t i = 0; i < near.size(); ++i) {
        if (!reaches[i]) continue;
        const std::int32_t stored = state.storeBrick(near[i]);
        if (state.outOfBricks())
            throw core::Error("the target is larger than the tooth's memory for cuts", "zones", "give a larger voxel");
        if (stored < 0) continue;
        float* values = state.values(stored);
        bool changes = false;
        for (std::size_t k = 0; k < field::kBrickValues; ++k) {
            changes = changes || cut[i][k] > values[k];
            values[k] = std::max(values[k], cut[i][k]);
        }
        if (changes) state.noteChanged(near[i], true);
    }
    const tooth::TissueVolumes left = state.volumesMm3();
    tooth::TissueVolumes removed;
    for (std::size_t t = 0; t < cases::kTissueCount; ++t)
        removed[t] = model.volumesMm3[t] - left[t];
    state.addRemoved(removed);
    return state.state();
}

}  // namespace handpiece::zones
