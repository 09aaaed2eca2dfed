// SPDX-License-Identifier: Apache-2.0
// removed, removed-share, adjacent-removed, adjacent-depth
#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/brick_index.h"

namespace handpiece::measures {
namespace {
using cases::Tissue;
using core::Vec3;

static_assert(std::equal(std::begin(kZones), std::end(kZones), zones::kZoneNames.begin(), zones::kZoneNames.end()),
              "rubrics name the zones as tasks have them");

struct Amount {
    double removed = 0.0, whole = 0.0;
    std::string reason;
};
Amount amountOf(CutTooth& tooth, const Selection& of, bool withWhole) {
    Amount amount;
    const Preparation& p = tooth.preparation();
    const auto sumOf = [&](const tooth::TissueVolumes& mm3) {
        double sum = 0.0;
        for (std::size_t i = 0; i < cases::kTissueCount; ++i)
            if (isAsked(of, static_cast<Tissue>(i))) sum += mm3[i];
        return sum;
    };
    if (!of.zone.empty()) {
        const auto name = std::find(zones::kZoneNames.begin(), zones::kZoneNames.end(), of.zone);
        if (p.zones == nullptr || name == zones::kZoneNames.end())
            return {0.0, 0.0, "the task has no zone \"" + of.zone + "\""};
        const auto zone = static_cast<std::size_t>(name - zones::kZoneNames.begin());
        amount.removed = sumOf(tooth.removedVolumes()[zone]);
        if (!withWhole) return amount;
        if (zone >= zones::WholeVolumes{}.size())
            return {0.0, 0.0, "only of target and leeway is it known how much there was: ask for mm3"};
        amount.whole = sumOf(tooth.wholeVolumes()[zone]);
        return amount;
    }
    if (p.removedMm3)
        amount.removed = sumOf(*p.removedMm3);
    else
        amount.removed = volumeOf(*p.whole, *p.cut, true,
                                  [&](const Vec3&, Tissue tissue) { return isAsked(of, tissue) ? 1.0 : 0.0; });
    if (withWhole) amount.whole = sumOf(p.whole->volumesMm3);
    return amount;
}

/// A place of the tooth's surface as it is, about which most of the target still stands: the deepest of its brick;
/// none: nothing of it is left. To a voxel, for the eye to be turned there.
std::optional<Vec3> mostOfTargetLeft(const zones::Zones& zones, const tooth::ToothMirror& cut) {
    const tooth::ToothModel& whole = cut.model();
    const field::FieldView view = whole.field.view();
    const auto dense = static_cast<std::uint32_t>(whole.field.storage().coarse.size());
    const double h = view.voxelMm, edge = field::kBrickCells * h;
    struct Left {
        double voxels = 0.0, targetMm = 0.0;
        Vec3 at = Vec3::Zero();
    };
    std::vector<Left> of(dense);
    core::parallelFor(dense, 16, [&](std::size_t begin, std::size_t end) {
        std::array<float, field::kBrickValues> scratch;
        for (std::size_t i = begin; i < end; ++i) {
            const auto id = static_cast<std::uint32_t>(i);
            // Nothing is left of bricks far outside.
            if (!cut.isChanged(id) && view.brickIndex[i] < 0 && view.coarse[i] >= 0.0f) continue;
            const auto brick = field::brickAt(view.bricks, id);
            Vec3 low;
            for (int k = 0; k < 3; ++k)
                low[k] = view.originMm[k] + edge * brick[static_cast<std::size_t>(k)];
            if ((low.array() > zones.box().max.array()).any() || ((low.array() + edge) < zones.box().min.array()).any())
                continue;
            const float* now = cut.values(id, scratch.data());
            for (int z = 0; z < field::kBrickCells; ++z)
                for (int y = 0; y < field::kBrickCells; ++y)
                    for (int x = 0; x < field::kBrickCells; ++x) {
                        const auto value = static_cast<double>(
                            now[static_cast<std::size_t>(x + field::kBrickNodes * (y + field::kBrickNodes * z))]);
                        if (value > 0.0) continue;
                        const Vec3 p = low + h * Vec3(x, y, z);
                        double target = zones.targetMm(p);
                        if (target < 0.0) target = std::max(target, -zones.protectedMm(p));
                        if (target >= 0.0) continue;
                        of[i].voxels += 1.0;
                        if (value >= -h && target < of[i].targetMm) of[i].targetMm = target, of[i].at = p;
                    }
        }
    });
    // With what stands in the bricks beside it.
    double most = 0.0;
    std::optional<Vec3> place;
    for (std::uint32_t id = 0; id < dense; ++id) {
        if (of[id].targetMm >= 0.0) continue;
        const auto brick = field::brickAt(view.bricks, id);
        double about = 0.0;
        for (int k = 0; k < 27; ++k) {
            const std::array<std::int32_t, 3> beside{brick[0] + k % 3 - 1, brick[1] + k / 3 % 3 - 1,
                                                     brick[2] + k / 9 - 1};
            const bool isIn = std::equal(beside.begin(), beside.end(), std::begin(view.bricks),
                                         [](std::int32_t at, std::int32_t count) { return at >= 0 && at < count; });
            if (isIn) about += of[field::denseOf(view.bricks, beside)].voxels;
        }
        if (about > most) most = about, place = of[id].at;
    }
    return place;
}

/// Where what was cut lies farthest past the target (of leeway, at the side or under the floor), past all that may go
/// (of the container), or in what must stay; none where it does not.
std::optional<Vec3> farthestInto(CutTooth& tooth, std::string_view zone) {
    std::optional<Vec3> place;
    double most = 0.0;
    for (const SurfacePoint& point : tooth.cutPoints()) {
        const zones::Zones::Distances d = tooth.preparation().zones->distancesMm(point.p);
        const double past = zone == "protected"      ? -d.kept
                            : zone == "container"    ? d.allowed
                            : zone == "leeway-side"  ? (d.wall >= 0.0 ? d.target : 0.0)
                            : zone == "leeway-floor" ? (d.wall < 0.0 ? d.target : 0.0)
                                                     : 0.0;
        if (past <= most) continue;
        most = past;
        place = point.p;
    }
    return place;
}

}  // namespace

bool isAsked(const Selection& of, Tissue tissue) {
    return of.tissue.empty() || of.tissue == cases::properties(tissue).name;
}

double volumeOf(const tooth::ToothModel& whole, const tooth::ToothMirror& cut, bool ofRemoved,
                const std::function<double(const Vec3&, Tissue)>& weight) {
    const field::FieldView view = whole.field.view();
    const auto dense = static_cast<std::uint32_t>(whole.field.storage().coarse.size());
    const auto perVoxel = static_cast<float>(view.inverseVoxelMm);
    std::vector<double> sums(dense, 0.0);
    core::parallelFor(dense, 16, [&](std::size_t begin, std::size_t end) {
        std::array<float, field::kBrickValues> uncut, scratch;
        for (std::size_t i = begin; i < end; ++i) {
            const auto id = static_cast<std::uint32_t>(i);
            if (ofRemoved && !cut.isChanged(id)) continue;
            // Bricks far outside hold nothing.
            if (!cut.isChanged(id) && view.brickIndex[i] < 0 && view.coarse[i] > 0.0f) continue;
            whole.uncutBrick(id, uncut.data());
            const float* now = cut.values(id, scratch.data());
            const auto brick = field::brickAt(view.bricks, id);
            // Each node once: those on the far faces belong to the next brick.
            for (int z = 0; z < field::kBrickCells; ++z)
                for (int y = 0; y < field::kBrickCells; ++y)
                    for (int x = 0; x < field::kBrickCells; ++x) {
                        const std::size_t n =
                            static_cast<std::size_t>(x + field::kBrickNodes * (y + field::kBrickNodes * z));
                        const double left = static_cast<double>(tooth::occupancy(now[n], perVoxel));
                        const double amount =
                            ofRemoved ? static_cast<double>(tooth::occupancy(uncut[n], perVoxel)) - left : left;
                        if (amount == 0.0) continue;
                        const auto tissue = static_cast<Tissue>(whole.tissues.nodes()->of(id)[n]);
                        const int node[3] = {x, y, z};
                        Vec3 p;
                        for (int k = 0; k < 3; ++k)
                            p[k] = view.originMm[k] +
                                   view.voxelMm * (field::kBrickCells * brick[static_cast<std::size_t>(k)] + node[k]);
                        sums[i] += amount * weight(p, tissue);
                    }
        }
    });
    double sum = 0.0;
    for (const double part : sums)
        sum += part;
    return sum * view.voxelMm * view.voxelMm * view.voxelMm;
}

Taken takeRemoved(CutTooth& tooth, const Selection& of) {
    const Amount amount = amountOf(tooth, of, false);
    if (!amount.reason.empty()) return none(amount.reason);
    Taken taken{amount.removed, {}};
    if (!of.zone.empty() && amount.removed > 0.0)
        if (const std::optional<Vec3> place = farthestInto(tooth, of.zone))
            taken.evidence.push_back({{}, *place, {}, kMostHere});
    return taken;
}

Taken takeRemovedShare(CutTooth& tooth, const Selection& of) {
    const Amount amount = amountOf(tooth, of, true);
    if (!amount.reason.empty()) return none(amount.reason);
    if (!(amount.whole > 0.0)) return none("the whole tooth has none of it");
    Taken share{100.0 * amount.removed / amount.whole, {}};
    if (of.zone == zones::kZoneNames[static_cast<std::size_t>(zones::Zone::target)] && *share.value < 100.0)
        if (const std::optional<Vec3> place = mostOfTargetLeft(*tooth.preparation().zones, *tooth.preparation().cut))
            share.evidence.push_back({{}, *place, {}, "most is still to be cut here"});
    if (!of.zone.empty() && amount.removed > 0.0)
        if (const std::optional<Vec3> place = farthestInto(tooth, of.zone))
            share.evidence.push_back({{}, *place, {}, kMostHere});
    return share;
}

Taken takeAdjacentRemoved(CutTooth& tooth, const Selection&) {
    const auto others = tooth.preparation().others;
    if (others.empty()) return none("no tooth that can be cut stands beside it");
    double sum = 0.0;
    for (const Preparation::Other& other : others)
        sum += volumeOf(*other.whole, *other.cut, true, [](const Vec3&, Tissue) { return 1.0; });
    return {sum, {}};
}

Taken takeAdjacentDepth(CutTooth& tooth, const Selection&) {
    const auto others = tooth.preparation().others;
    if (others.empty()) return none("no tooth that can be cut stands beside it");
    Taken deepest{0.0, {}};
    for (const Preparation::Other& other : others) {
        Preparation alone;
        alone.whole = other.whole;
        alone.cut = other.cut;
        CutTooth cut(alone);
        for (const SurfacePoint& point : cut.cutPoints()) {
            const double depth = -other.whole->tree.signedDistance(point.p);
            if (depth <= *deepest.value) continue;
            deepest = at(depth, other.inTooth.apply(point.p), "tooth " + std::to_string(other.fdiNumber));
        }
    }
    return deepest;
}

}  // namespace handpiece::measures
