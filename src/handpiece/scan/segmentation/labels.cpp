// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {

using core::Vec3;

namespace {
constexpr std::uint8_t kCaries = 1, kEnamel = 2, kDentine = 3, kPulp = 4, kRestoration = 5;
constexpr double kSmoothVoxels = 0.9;
constexpr double kLargestMm3 = 6000.0;  ///< four of the largest molars

constexpr double kMostMm3 = 40000.0;  ///< more than all teeth of a mouth

core::Error noSingleTeeth(double volumeMm3) {
    return core::Error(
               fmt::format("what the labels call tissues of a tooth is {:.0f} mm3: no tooth is as large", volumeMm3),
               "labels",
               "these may be labels of jaws and rows of teeth (1 upper skull, 2 mandible, 3 upper and 4 lower teeth), "
               "which tell no single tooth: use labels of single teeth by FDI numbers")
        .as("labels-no-single-teeth");
}

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

}  // namespace

Field smoothed(const Shape& shape, Field&& share) {
    constexpr int kSlices = 48;  // at once, so that blurring takes no more room than it needs
    const int reach = 2 * blurReach(kSmoothVoxels);
    Field inside(share.size()), part, once, twice, scratch;
    const std::size_t slice = shape.sliceStride();
    for (int from = 0; from < shape.size[2]; from += kSlices) {
        const int to = std::min(shape.size[2], from + kSlices), low = std::max(0, from - reach),
                  high = std::min(shape.size[2], to + reach);
        const Shape slab{{shape.size[0], shape.size[1], high - low}};
        part.assign(share.begin() + static_cast<std::ptrdiff_t>(slice * static_cast<std::size_t>(low)),
                    share.begin() + static_cast<std::ptrdiff_t>(slice * static_cast<std::size_t>(high)));
        // Twice the blurred less the twice blurred: smooth, but a small ball does not shrink.
        blur(slab, part, once, scratch, kSmoothVoxels);
        blur(slab, once, twice, scratch, kSmoothVoxels);
        // Halfway is the surface; a voxel's own side is kept.
        const std::size_t start = slice * static_cast<std::size_t>(from),
                          skipped = slice * static_cast<std::size_t>(from - low);
        core::parallelFor(slice * static_cast<std::size_t>(to - from), 1 << 16, [&](std::size_t b, std::size_t e) {
            for (std::size_t n = b; n < e; ++n) {
                const std::size_t at = skipped + n;
                const float f = (2 * once[at] - twice[at] - 0.5f) * 2.5066f * static_cast<float>(kSmoothVoxels);
                inside[start + n] = part[at] > 0.5f ? std::max(f, 0.02f) : std::min(f, -0.02f);
            }
        });
    }
    Field().swap(share);
    redistance(shape, inside, kBand);
    return inside;
}

namespace {
/// A box of voxels of a block.
struct Piece {
    std::array<int, 3> low{};
    Shape shape;

    /// body(index in the block, index in the piece) for the first voxel of each row, in parallel.
    template <class Body>
    void rows(const Shape& block, const Body& body) const {
        forRows(shape, [&](int j, int k) { body(block.index(low[0], low[1] + j, low[2] + k), shape.index(0, j, k)); });
    }
};

/// The box of the voxels with a label that `counts` says, with what spreading and smoothing may add to it.
Piece pieceOf(const Shape& block, const Mask& label, const std::array<bool, kRestoration + 1>& counts) {
    constexpr int kMargin = 16;  // 4 by which tissues go on beside the tooth, both blurs, and the band of distances
    std::array<int, 3> low = block.size, high{-1, -1, -1};
    for (int k = 0; k < block.size[2]; ++k)
        for (int j = 0; j < block.size[1]; ++j) {
            const std::uint8_t* row = &label[block.index(0, j, k)];
            for (int i = 0; i < block.size[0]; ++i)
                if (counts[row[i]]) {
                    low = {std::min(low[0], i), std::min(low[1], j), std::min(low[2], k)};
                    high = {std::max(high[0], i), std::max(high[1], j), k};
                }
        }
    Piece piece;
    for (std::size_t a = 0; a < 3; ++a) {
        piece.low[a] = std::max(0, low[a] - kMargin);
        piece.shape.size[a] = std::max(0, std::min(block.size[a], high[a] + 1 + kMargin) - piece.low[a]);
    }
    return piece;
}
}  // namespace

Region segmentLabels(const volume::Labels& labels, const Settings& settings, const core::Progress& progress) {
    const volume::Grid& scan = labels.grid;
    if (labels.values.empty() || labels.values.size() != scan.count())
        throw core::Error("the label volume has no voxels", "labels", "read it again");
    if (!(scan.spacingMm.minCoeff() > 0) || !scan.spacingMm.allFinite())
        throw core::Error("the spacing of the voxels is not known", "labels", "give it in millimetres");
    if (scan.spacingMm.maxCoeff() > 0.6 * (1.0 + 1e-6))  // files keep it as 32-bit numbers
        throw core::Error(fmt::format("the labels are too coarse: voxels of {:.3g} mm", scan.spacingMm.maxCoeff()),
                          "labels", "use labels of 0.6 mm or finer")
            .as("scan-too-coarse", {fmt::format("{:.3g}", scan.spacingMm.maxCoeff()), "0.6"});
    // Where the tooth's labels are.
    std::array<int, 3> low{1 << 30, 1 << 30, 1 << 30}, high{-1, -1, -1};
    bool hasUnknown = false;
    std::size_t tooth = 0;
    for (int k = 0; k < scan.size[2]; ++k) {
        core::report(progress, 0.05 * k / scan.size[2]);
        for (int j = 0; j < scan.size[1]; ++j)
            for (int i = 0; i < scan.size[0]; ++i) {
                const std::uint8_t label = labels.values[scan.index(i, j, k)];
                if (label == 0) continue;
                if (label > 7) hasUnknown = true;
                if (label > kRestoration) continue;
                ++tooth;
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
    if (const double mm3 = static_cast<double>(tooth) * scan.voxelMm3(); mm3 > kMostMm3) throw noSingleTeeth(mm3);
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
            double nearest = core::pow(1.5 / h, 2);
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
        const double volumeMm3 = static_cast<double>(parts.counts[chosen]) * h * h * h;
        if (volumeMm3 > kLargestMm3) throw noSingleTeeth(volumeMm3);
        for (std::size_t n = 0; n < solid.size(); ++n)
            if (parts.of[n] != chosen) label[n] = solid[n] = 0;
    }
    core::report(progress, 0.25);
    {
        const Mask cavity = closedCavities(shape, solid, h);
        for (std::size_t n = 0; n < solid.size(); ++n)
            if (cavity[n]) {
                solid[n] = 1;
                label[n] = kPulp;
            }
    }
    core::report(progress, 0.4);

    // Beside the tooth's surface the tissue that reaches it goes on, so that only one surface is there.
    Mask near = solid;
    for (int round = 0; round < 4; ++round)
        near = dilated(shape, near);
    const auto tissue = [&](std::initializer_list<std::uint8_t> in, std::initializer_list<std::uint8_t> ignored) {
        std::array<bool, kRestoration + 1> isIn{}, isHidden{}, counts{};
        for (const std::uint8_t l : in)
            isIn[l] = counts[l] = true;
        for (const std::uint8_t l : ignored)
            isHidden[l] = counts[l] = true;
        const Piece piece = pieceOf(shape, label, counts);
        Field share(piece.shape.count(), 0.0f);
        {
            Mask unknown(share.size(), 2);
            piece.rows(shape, [&](std::size_t n, std::size_t at) {
                for (const std::size_t end = n + piece.shape.rowStride(); n < end; ++n, ++at)
                    if (solid[n] && !isHidden[label[n]])
                        unknown[at] = 0, share[at] = isIn[label[n]] ? 1.0f : 0.0f;
                    else if (near[n])
                        unknown[at] = 1;
            });
            spreadInto(piece.shape, share, unknown);
        }
        Field inside = smoothed(piece.shape, std::move(share));
        core::report(progress, 0.6);
        if (piece.shape.size == shape.size) return inside;
        Field all(shape.count(), -kBand);
        piece.rows(shape, [&](std::size_t n, std::size_t at) {
            std::copy_n(inside.begin() + static_cast<std::ptrdiff_t>(at), piece.shape.rowStride(),
                        all.begin() + static_cast<std::ptrdiff_t>(n));
        });
        return all;
    };
    const auto has = [&](std::uint8_t which) { return std::find(label.begin(), label.end(), which) != label.end(); };
    work.outer = smoothed(shape, Field(solid.begin(), solid.end()));
    core::report(progress, 0.5);
    // Where labels tell enamel alone there is no dentine to be told.
    if (has(kEnamel) && has(kDentine))
        work.dentine = tissue({kDentine, kPulp}, {kCaries, kRestoration});
    else if (!has(kEnamel))
        work.dentine.assign(shape.count(), kBand);
    if (has(kPulp)) work.pulp = tissue({kPulp}, {});
    if (has(kCaries)) work.caries = tissue({kCaries}, {});
    if (has(kRestoration)) work.restoration = tissue({kRestoration}, {});
    work.sigma = 0;
    for (Mask* mask : {&label, &solid, &near})
        Mask().swap(*mask);
    return toRegion(std::move(work), settings, core::part(progress, 0.9, 1));
}

}  // namespace handpiece::segmentation
