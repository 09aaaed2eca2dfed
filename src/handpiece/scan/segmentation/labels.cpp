// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {

using core::Vec3;

namespace {
constexpr std::uint8_t kCaries = 1, kEnamel = 2, kDentine = 3, kPulp = 4, kRestoration = 5;
constexpr double kSmoothVoxels = 0.9;

/// Labels on the block's grid, the commonest of what a voxel holds.
Mask labelsOn(const Work& work, const volume::Labels& labels, const core::Progress& progress) {
    const volume::Grid& scan = labels.grid;
    const Vec3 first = scan.toVoxels(work.grid.originMm);
    const Vec3 step = Vec3::Constant(work.spacingMm()).cwiseQuotient(scan.spacingMm);
    std::array<int, 3> sub{1, 1, 1};
    for (std::size_t axis = 0; axis < 3; ++axis)
        sub[axis] = std::max(1, static_cast<int>(std::lround(step[static_cast<int>(axis)])));
    Mask result(work.shape.count(), 0);
    forRows(work.shape, [&](int j, int k) {
        if (j == 0) core::report(progress, static_cast<double>(k) / work.shape.size[2]);
        for (int i = 0; i < work.shape.size[0]; ++i) {
            std::array<int, kRestoration + 1> counts{};
            for (int c = 0; c < sub[2]; ++c)
                for (int b = 0; b < sub[1]; ++b)
                    for (int a = 0; a < sub[0]; ++a) {
                        const Vec3 at =
                            first + step.cwiseProduct(Vec3(i + (a + 0.5) / sub[0] - 0.5, j + (b + 0.5) / sub[1] - 0.5,
                                                           k + (c + 0.5) / sub[2] - 0.5));
                        std::uint8_t label = 0;
                        std::array<int, 3> v{};
                        bool isInside = true;
                        for (std::size_t axis = 0; axis < 3; ++axis) {
                            v[axis] = static_cast<int>(std::floor(at[static_cast<int>(axis)] + 0.5));
                            isInside = isInside && v[axis] >= 0 && v[axis] < scan.size[axis];
                        }
                        if (isInside) label = labels.values[scan.index(v[0], v[1], v[2])];
                        ++counts[label <= kRestoration ? label : 0];
                    }
            result[work.shape.index(i, j, k)] =
                static_cast<std::uint8_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
        }
    });
    return result;
}

/// A distance to the smoothed boundary of what is set, nowhere further than half a voxel from the boundary between the
/// voxels: a voxel's centre never changes sides.
Field smoothed(const Shape& shape, const Field& share, Field& scratch, Field& scratch2) {
    Field inside;
    // Twice the blurred less the twice blurred: smooth, but a small ball does not shrink.
    blur(shape, share, scratch2, scratch, kSmoothVoxels);
    blur(shape, scratch2, inside, scratch, kSmoothVoxels);
    // Halfway is the surface; a voxel's own side is kept.
    core::parallelFor(inside.size(), 1 << 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t n = from; n < to; ++n) {
            const float f = (2 * scratch2[n] - inside[n] - 0.5f) * 2.5066f * static_cast<float>(kSmoothVoxels);
            inside[n] = share[n] > 0.5f ? std::max(f, 0.02f) : std::min(f, -0.02f);
        }
    });
    redistance(shape, inside, kBand);
    return inside;
}
}  // namespace

Region segmentLabels(const volume::Labels& labels, const Settings& settings, const core::Progress& progress) {
    const volume::Grid& scan = labels.grid;
    if (labels.values.empty() || labels.values.size() != scan.count())
        throw core::Error("the label volume has no voxels", "labels", "read it again");
    if (!(scan.spacingMm.minCoeff() > 0) || !scan.spacingMm.allFinite())
        throw core::Error("the spacing of the voxels is not known", "labels", "give it in millimetres");
    if (scan.spacingMm.maxCoeff() > 0.6)
        throw core::Error(fmt::format("the labels are too coarse: voxels of {:.3g} mm", scan.spacingMm.maxCoeff()),
                          "labels", "use labels of 0.6 mm or finer")
            .as("scan-too-coarse", {fmt::format("{:.3g}", scan.spacingMm.maxCoeff()), "0.6"});
    // Where the tooth's labels are.
    std::array<int, 3> low{1 << 30, 1 << 30, 1 << 30}, high{-1, -1, -1};
    bool hasUnknown = false;
    for (int k = 0; k < scan.size[2]; ++k) {
        core::report(progress, 0.05 * k / scan.size[2]);
        for (int j = 0; j < scan.size[1]; ++j)
            for (int i = 0; i < scan.size[0]; ++i) {
                const std::uint8_t label = labels.values[scan.index(i, j, k)];
                if (label == 0) continue;
                if (label > 7) hasUnknown = true;
                if (label > kRestoration) continue;
                const std::array<int, 3> at{i, j, k};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], at[axis]);
                    high[axis] = std::max(high[axis], at[axis]);
                }
            }
    }
    if (high[0] < 0)
        throw core::Error(
            "empty segmentation: no label of a tooth (1 caries, 2 enamel, 3 dentine, 4 pulp, 5 restoration)", "labels",
            "map the file's numbers to these")
            .as("labels-empty");
    Work work;
    if (hasUnknown) work.notes.emplace_back("labels above 7 mean nothing here and were left out");
    const double h = settings.spacingMm > 0 ? settings.spacingMm : std::max(0.03, scan.spacingMm.minCoeff());
    const double margin = 6 * h;
    const bool isSame = ((scan.spacingMm.array() / h - 1).abs() < 1e-6).all();
    Vec3 from = Vec3(low[0], low[1], low[2]).cwiseProduct(scan.spacingMm) - Vec3::Constant(margin);
    const Vec3 to = Vec3(high[0], high[1], high[2]).cwiseProduct(scan.spacingMm) + Vec3::Constant(margin);
    if (isSame) from = (from / h).array().round() * h;
    for (std::size_t axis = 0; axis < 3; ++axis)
        work.grid.size[axis] =
            static_cast<int>(std::ceil((to[static_cast<int>(axis)] - from[static_cast<int>(axis)]) / h - 1e-6)) + 1;
    work.grid.spacingMm = Vec3::Constant(h);
    work.grid.axes = scan.axes;
    work.grid.originMm = scan.originMm + scan.axes * from;
    work.shape = {work.grid.size};
    const Shape& shape = work.shape;
    Mask label = labelsOn(work, labels, core::part(progress, 0.05, 0.15));

    // The tooth meant.
    Mask solid(label.size());
    for (std::size_t n = 0; n < solid.size(); ++n)
        solid[n] = label[n] != 0;
    {
        const Parts parts = connectedParts(shape, solid);
        std::uint32_t chosen = parts.largest();
        if (settings.toothAtMm) {
            const Vec3 at = work.grid.toVoxels(*settings.toothAtMm);
            double nearest = std::pow(1.5 / h, 2);
            chosen = 0;
            for (std::size_t n = 0; n < solid.size(); ++n) {
                if (!solid[n]) continue;
                const auto c = shape.at(n);
                const double d = (Vec3(c[0], c[1], c[2]) - at).squaredNorm();
                if (d < nearest) nearest = d, chosen = parts.of[n];
            }
        }
        if (chosen == 0)
            throw core::Error("there is no tooth at the place that was pointed at", "labels",
                              "point at a labelled voxel")
                .as("no-tooth-there");
        for (std::size_t n = 0; n < solid.size(); ++n)
            if (parts.of[n] != chosen) label[n] = solid[n] = 0;
    }
    core::report(progress, 0.25);
    const Mask cavity = closedCavities(shape, solid, h);
    for (std::size_t n = 0; n < solid.size(); ++n)
        if (cavity[n]) {
            solid[n] = 1;
            label[n] = kPulp;
        }
    core::report(progress, 0.4);

    // Beside the tooth's surface the tissue that reaches it goes on, so that only one surface is there.
    Mask near = solid;
    for (int round = 0; round < 4; ++round)
        near = dilated(shape, near);
    const auto tissue = [&](std::initializer_list<std::uint8_t> in, std::initializer_list<std::uint8_t> ignored) {
        Field share(label.size(), 0.0f);
        Mask unknown(label.size(), 2);
        for (std::size_t n = 0; n < label.size(); ++n) {
            const bool isIn = std::find(in.begin(), in.end(), label[n]) != in.end();
            const bool isHidden = std::find(ignored.begin(), ignored.end(), label[n]) != ignored.end();
            if (solid[n] && !isHidden)
                unknown[n] = 0, share[n] = isIn ? 1.0f : 0.0f;
            else if (near[n])
                unknown[n] = 1;
        }
        spreadInto(shape, share, unknown);
        Field inside = smoothed(shape, share, work.scratch, work.scratch2);
        core::report(progress, 0.6);
        return inside;
    };
    const auto has = [&](std::uint8_t which) { return std::find(label.begin(), label.end(), which) != label.end(); };
    Field share(solid.size());
    for (std::size_t n = 0; n < share.size(); ++n)
        share[n] = solid[n];
    work.outer = smoothed(shape, share, work.scratch, work.scratch2);
    share = {};
    core::report(progress, 0.5);
    if (has(kEnamel))
        work.dentine = tissue({kDentine, kPulp}, {kCaries, kRestoration});
    else
        work.dentine.assign(shape.count(), kBand);
    if (has(kPulp)) work.pulp = tissue({kPulp}, {});
    if (has(kCaries)) work.caries = tissue({kCaries}, {});
    if (has(kRestoration)) work.restoration = tissue({kRestoration}, {});
    work.sigma = 0;
    return toRegion(std::move(work), settings, core::part(progress, 0.9, 1));
}

}  // namespace handpiece::segmentation
