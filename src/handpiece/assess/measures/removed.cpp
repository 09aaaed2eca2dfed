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
        const zones::ZoneVolumes volumes = zones::zoneVolumes(*p.zones, *p.cut);
        const auto zone = static_cast<std::size_t>(name - zones::kZoneNames.begin());
        amount.removed = sumOf(volumes.removed[zone]);
        if (!withWhole) return amount;
        if (zone >= volumes.whole.size())
            return {0.0, 0.0, "only of target and leeway is it known how much there was: ask for mm3"};
        amount.whole = sumOf(volumes.whole[zone]);
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
    return amount.reason.empty() ? Taken{amount.removed, {}} : none(amount.reason);
}

Taken takeRemovedShare(CutTooth& tooth, const Selection& of) {
    const Amount amount = amountOf(tooth, of, true);
    if (!amount.reason.empty()) return none(amount.reason);
    if (!(amount.whole > 0.0)) return none("the whole tooth has none of it");
    return {100.0 * amount.removed / amount.whole, {}};
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
