// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {

using cases::Tissue;
using core::Vec3;

namespace {
constexpr double kMinPieceMm3 = 0.01;

void keepInside(Field& inside, const Field& other) {
    core::parallelFor(inside.size(), 1 << 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n)
            inside[n] = std::min(inside[n], other[n]);
    });
}
void keepOutside(Field& inside, const Field& other) {
    core::parallelFor(inside.size(), 1 << 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n)
            inside[n] = std::min(inside[n], -other[n]);
    });
}

/// Calls body(index, millimetres from the centre) for the voxels within `reachMm` of a place.
void around(const Work& work, const Vec3& centreMm, const Vec3& reachMm,
            const std::function<void(std::size_t, const Vec3&)>& body) {
    const Vec3 centre = work.grid.toVoxels(centreMm);
    const Vec3 reach = reachMm / work.spacingMm() + Vec3::Constant(kBand + 1);
    std::array<int, 3> low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        const double last = work.shape.size[axis] - 1;
        low[axis] = static_cast<int>(std::clamp(std::floor(centre[a] - reach[a]), 0.0, last));
        high[axis] = static_cast<int>(std::clamp(std::ceil(centre[a] + reach[a]), 0.0, last));
    }
    for (int k = low[2]; k <= high[2]; ++k)
        for (int j = low[1]; j <= high[1]; ++j)
            for (int i = low[0]; i <= high[0]; ++i)
                body(work.shape.index(i, j, k), (Vec3(i, j, k) - centre) * work.spacingMm());
}

void applyMark(Work& work, const Mark& mark) {
    const Tissue tissue = mark.tissue;
    const bool isTooth = tissue == Tissue::enamel || tissue == Tissue::dentine || tissue == Tissue::cementum ||
                         tissue == Tissue::pulp || tissue == Tissue::caries || tissue == Tissue::restoration;
    const auto make = [&](Field& field) {
        if (field.empty()) field.assign(work.shape.count(), -kBand);
    };
    if (tissue == Tissue::pulp) make(work.pulp);
    if (tissue == Tissue::dentine || tissue == Tissue::cementum) make(work.dentine);
    if (tissue == Tissue::caries) {
        make(work.caries);
    }
    if (tissue == Tissue::restoration) make(work.restoration);
    around(work, mark.centreMm, Vec3::Constant(mark.radiusMm), [&](std::size_t n, const Vec3& from) {
        const float ball =
            std::clamp(static_cast<float>((mark.radiusMm - from.norm()) / work.spacingMm()), -kBand, kBand);
        const auto add = [&](Field& field) {
            if (!field.empty()) field[n] = std::max(field[n], ball);
        };
        const auto take = [&](Field& field) {
            if (!field.empty()) field[n] = std::min(field[n], -ball);
        };
        isTooth ? add(work.outer) : take(work.outer);
        const bool isCore = tissue == Tissue::dentine || tissue == Tissue::cementum || tissue == Tissue::pulp;
        if (isCore) add(work.dentine);
        if (tissue == Tissue::enamel || !isTooth) take(work.dentine);
        tissue == Tissue::pulp ? add(work.pulp) : take(work.pulp);
        tissue == Tissue::caries ? add(work.caries) : take(work.caries);
        tissue == Tissue::restoration ? add(work.restoration) : take(work.restoration);
    });
}

/// Keeps the one large piece of the tooth; specks of other tissues go.
void tidy(const Work& work, Field& inside, bool isOnePiece) {
    Mask mask(inside.size());
    core::parallelFor(mask.size(), 1 << 18, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n)
            mask[n] = inside[n] > 0;
    });
    const Parts parts = connectedParts(work.shape, mask);
    const std::uint32_t main = parts.largest();
    const double least = std::max(6.0, kMinPieceMm3 / work.grid.voxelMm3());
    const auto isKept = [&](std::uint32_t p) {
        return isOnePiece ? p == main : static_cast<double>(parts.counts[p]) >= least;
    };
    bool any = false;
    for (std::uint32_t p = 1; p < parts.counts.size(); ++p)
        any = any || isKept(p);
    if (!any) {
        inside.clear();
        return;
    }
    core::parallelFor(mask.size(), 1 << 18, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n)
            if (parts.of[n] != 0 && !isKept(parts.of[n])) inside[n] = -0.5f;
    });
}

Field lesionsOf(const Work& work, const Settings& settings) {
    Field result;
    for (const AuthoredLesion& lesion : settings.lesions) {
        if (result.empty()) result.assign(work.shape.count(), -kBand);
        const Vec3 r = lesion.halfAxesMm;
        around(work, lesion.centreMm, r, [&](std::size_t n, const Vec3& from) {
            // Along the scanner's axes, as a person gives it.
            const Vec3 p = work.grid.axes * from;
            const double k0 = p.cwiseQuotient(r).norm(), k1 = p.cwiseQuotient(r.cwiseProduct(r)).norm();
            const double mm = k1 > 1e-9 ? (1 - k0) * k0 / k1 : r.minCoeff();
            result[n] = std::max(result[n], std::clamp(static_cast<float>(mm / work.spacingMm()), -kBand, kBand));
        });
    }
    return result;
}

Solid solidOf(Work& work, Field&& inside, Tissue tissue, bool isAuthored) {
    Solid solid;
    solid.tissue = tissue;
    solid.isAuthored = isAuthored;
    solid.distanceMm = std::move(inside);
    const auto h = static_cast<float>(work.spacingMm());
    core::parallelFor(solid.distanceMm.size(), 1 << 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n)
            solid.distanceMm[n] = -h * std::clamp(solid.distanceMm[n], -kBand, kBand);
    });
    return solid;
}
}  // namespace

Region toRegion(Work&& work, const Settings& settings, const core::Progress& progress) {
    for (const Mark& mark : settings.marks)
        applyMark(work, mark);
    core::report(progress, 0.1);
    tidy(work, work.outer, true);
    if (work.outer.empty()) throw nothingFound("nothing is left of the tooth");
    core::report(progress, 0.3);
    for (Field* field : {&work.pulp, &work.caries, &work.restoration})
        if (!field->empty()) {
            keepInside(*field, work.outer);
            tidy(work, *field, false);
            core::report(progress, 0.5);
        }
    if (!work.pulp.empty()) {
        if (!work.caries.empty()) keepOutside(work.caries, work.pulp);
        core::parallelFor(work.dentine.size(), 1 << 18, [&](std::size_t from, std::size_t to) {
            for (std::size_t n = from; n < to; ++n)
                work.dentine[n] = std::max(work.dentine[n], work.pulp[n]);
        });
    }
    if (!work.dentine.empty()) keepInside(work.dentine, work.outer);
    core::report(progress, 0.7);
    Field lesions = lesionsOf(work, settings);
    if (!lesions.empty()) {
        keepInside(lesions, work.outer);
        if (!work.pulp.empty()) keepOutside(lesions, work.pulp);
        tidy(work, lesions, false);
        if (lesions.empty()) work.notes.emplace_back("a lesion lies where no tooth is, and was left out");
    }
    Region region;
    region.grid = work.grid;
    region.thresholds = work.levels;
    region.blurMm = work.sigma * work.spacingMm();
    region.noise = work.noise;
    region.notes = std::move(work.notes);
    region.outer = solidOf(work, std::move(work.outer), Tissue::none, false);
    if (!work.dentine.empty()) region.solids.push_back(solidOf(work, std::move(work.dentine), Tissue::dentine, false));
    if (!work.pulp.empty()) region.solids.push_back(solidOf(work, std::move(work.pulp), Tissue::pulp, false));
    if (!work.caries.empty()) region.solids.push_back(solidOf(work, std::move(work.caries), Tissue::caries, false));
    if (!lesions.empty()) region.solids.push_back(solidOf(work, std::move(lesions), Tissue::caries, true));
    if (!work.restoration.empty())
        region.solids.push_back(solidOf(work, std::move(work.restoration), Tissue::restoration, false));
    core::report(progress, 1);
    return region;
}

volume::Labels labelsOf(const Region& region) {
    volume::Labels labels;
    labels.grid = region.grid;
    labels.values.assign(region.grid.count(), 0);
    const auto number = [](Tissue tissue) -> std::uint8_t {
        switch (tissue) {
            case Tissue::caries:
                return 1;
            case Tissue::dentine:
            case Tissue::cementum:
                return 3;
            case Tissue::pulp:
                return 4;
            case Tissue::restoration:
                return 5;
            default:
                return 2;
        }
    };
    core::parallelFor(labels.values.size(), 1 << 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n) {
            if (region.outer.distanceMm[n] >= 0) continue;
            std::uint8_t label = 2;
            for (const Solid& solid : region.solids)
                if (solid.distanceMm[n] < 0) label = number(solid.tissue);
            labels.values[n] = label;
        }
    });
    return labels;
}

std::array<double, cases::kTissueCount> volumesMm3(const Region& region) {
    const auto h = static_cast<float>(region.grid.spacingMm.x());
    const std::size_t slice =
        static_cast<std::size_t>(region.grid.size[0]) * static_cast<std::size_t>(region.grid.size[1]);
    const auto slices = static_cast<std::size_t>(region.grid.size[2]);
    std::vector<std::array<double, cases::kTissueCount>> sums(slices);
    core::parallelFor(slices, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
            for (std::size_t n = k * slice; n < (k + 1) * slice; ++n) {
                const float whole = coverage(-region.outer.distanceMm[n] / h);
                if (whole <= 0) continue;
                float taken = 0;
                for (std::size_t s = region.solids.size(); s-- > 0;) {
                    const Solid& solid = region.solids[s];
                    const float reaches = std::max(taken, std::min(whole, coverage(-solid.distanceMm[n] / h)));
                    sums[k][static_cast<std::size_t>(solid.tissue)] += static_cast<double>(reaches - taken);
                    taken = reaches;
                }
                sums[k][static_cast<std::size_t>(Tissue::enamel)] += static_cast<double>(whole - taken);
            }
    });
    std::array<double, cases::kTissueCount> result{};
    for (const auto& s : sums)
        for (std::size_t t = 0; t < result.size(); ++t)
            result[t] += s[t] * region.grid.voxelMm3();
    return result;
}

}  // namespace handpiece::segmentation
