// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/shown_scan.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "handpiece/base/core/parallel.h"

namespace handpiece::desktop {
namespace {

using segmentation::Region;
using segmentation::Solid;

/// Trilinear; at the border its nearest value.
float sampled(const Solid& solid, const volume::Grid& grid, const core::Vec3& ijk) {
    std::array<int, 3> low{}, high{};
    std::array<double, 3> share{};
    for (int a = 0; a < 3; ++a) {
        const auto n = static_cast<std::size_t>(a);
        const double at = std::clamp(ijk[a], 0.0, static_cast<double>(grid.size[n] - 1));
        low[n] = std::min(static_cast<int>(at), grid.size[n] - 1);
        high[n] = std::min(low[n] + 1, grid.size[n] - 1);
        share[n] = at - low[n];
    }
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        std::array<int, 3> at{};
        double weight = 1.0;
        for (std::size_t a = 0; a < 3; ++a) {
            const bool isHigh = (corner >> a) & 1;
            at[a] = isHigh ? high[a] : low[a];
            weight *= isHigh ? share[a] : 1.0 - share[a];
        }
        if (weight > 0.0) sum += weight * solid.distanceMm[grid.index(at[0], at[1], at[2])];
    }
    return static_cast<float>(sum);
}

/// What lies under a face of the tooth's outside, a little below it.
cases::Tissue tissueUnder(const Region& region, const core::Vec3& pointMm) {
    const core::Vec3 ijk = region.grid.toVoxels(pointMm);
    cases::Tissue under = cases::Tissue::enamel;
    for (const Solid& solid : region.solids)
        if (sampled(solid, region.grid, ijk) < 0) under = solid.tissue;
    return under;
}

/// The outside in pieces by tissue, as open meshes to be looked at.
void addOutside(const geometry::TriangleMesh& outer, const Region& region, const core::Pose& scanInTooth,
                std::vector<cases::Part>& parts) {
    std::array<geometry::TriangleMesh, cases::kTissueCount> pieces;
    std::array<std::unordered_map<std::uint32_t, std::uint32_t>, cases::kTissueCount> taken;
    const double below = 0.7 * region.grid.spacingMm.minCoeff();
    std::vector<cases::Tissue> tissues(outer.triangles.size());
    core::parallelFor(tissues.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t t = from; t < to; ++t) {
            const geometry::Triangle& f = outer.triangles[t];
            const core::Vec3 &a = outer.vertices[f[0]], &b = outer.vertices[f[1]], &c = outer.vertices[f[2]];
            const core::Vec3 normal = (b - a).cross(c - a).normalized();
            tissues[t] = tissueUnder(
                region, (a + b + c) / 3.0 - below * (normal.allFinite() ? normal : core::Vec3(core::Vec3::Zero())));
        }
    });
    for (std::size_t t = 0; t < tissues.size(); ++t) {
        const auto n = static_cast<std::size_t>(tissues[t]);
        geometry::Triangle face{};
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t v = outer.triangles[t][corner];
            const auto [place, isNew] = taken[n].emplace(v, static_cast<std::uint32_t>(pieces[n].vertices.size()));
            if (isNew) pieces[n].vertices.push_back(scanInTooth.apply(outer.vertices[v]));
            face[corner] = place->second;
        }
        pieces[n].triangles.push_back(face);
    }
    for (std::size_t n = 0; n < pieces.size(); ++n)
        if (!pieces[n].triangles.empty())
            parts.push_back({"outside", static_cast<cases::Tissue>(n), 0, std::move(pieces[n])});
}

}  // namespace

GreyHistogram histogramOf(const volume::Volume& volume) {
    GreyHistogram histogram;
    if (volume.values.empty()) return histogram;
    const auto [least, most] = std::minmax_element(volume.values.begin(), volume.values.end());
    // Two rounds: the ends first, since one bright speck of metal would leave all else in a few bins.
    constexpr int kFine = 4096;
    constexpr double kEnds = 1e-3;
    const float low = *least, width = std::max(1e-6f, *most - *least);
    std::vector<std::uint64_t> fine(kFine);
    for (const float value : volume.values)
        ++fine[static_cast<std::size_t>(std::clamp((value - low) / width * kFine, 0.0f, kFine - 1.0f))];
    const auto cut = static_cast<std::uint64_t>(kEnds * static_cast<double>(volume.values.size()));
    int first = 0, last = kFine - 1;
    for (std::uint64_t sum = 0; first < last && (sum += fine[static_cast<std::size_t>(first)]) <= cut;)
        ++first;
    for (std::uint64_t sum = 0; last > first && (sum += fine[static_cast<std::size_t>(last)]) <= cut;)
        --last;
    histogram.low = low + width * static_cast<float>(first) / kFine;
    histogram.high = low + width * static_cast<float>(last + 1) / kFine;
    // Bins between whole numbers would stay empty.
    constexpr float kMaxBins = 256.0f;
    const bool isWhole = std::all_of(volume.values.begin(), volume.values.end(),
                                     [](float v) { return v == std::floor(v) && std::abs(v) < 1e7f; });
    float each = (histogram.high - histogram.low) / kMaxBins;
    if (isWhole) {
        each = std::max(1.0f, std::ceil(each));
        histogram.low = std::floor(histogram.low) - 0.5f;
        histogram.high = histogram.low + each * std::ceil((histogram.high - histogram.low) / each);
    }
    each = std::max(each, 1e-12f);
    histogram.counts.assign(
        static_cast<std::size_t>(std::max(1.0f, std::round((histogram.high - histogram.low) / each))), 0);
    for (const float value : volume.values) {
        const float bin = (value - histogram.low) / each;
        if (bin >= 0.0f && bin < static_cast<float>(histogram.counts.size()))
            ++histogram.counts[static_cast<std::size_t>(bin)];
    }
    return histogram;
}

volume::Volume coarsened(const volume::Volume& volume, bool isLabels) {
    const volume::Grid& g = volume.grid;
    std::array<int, 3> block{};
    for (std::size_t a = 0; a < 3; ++a)
        block[a] =
            std::clamp(static_cast<int>(std::ceil(kPreviewMm / g.spacingMm[static_cast<int>(a)] - 0.01)), 1, g.size[a]);
    const auto sizeOf = [&](std::size_t a) { return static_cast<std::size_t>(g.size[a] / block[a]); };
    while (sizeOf(0) * sizeOf(1) * sizeOf(2) > kPreviewVoxels)
        for (std::size_t a = 0; a < 3; ++a)
            block[a] = std::min(block[a] + 1, g.size[a]);
    if (block == std::array<int, 3>{1, 1, 1}) return volume;
    volume::Volume coarse;
    coarse.grid = g;
    core::Vec3 first;
    for (int a = 0; a < 3; ++a) {
        const auto n = static_cast<std::size_t>(a);
        coarse.grid.size[n] = g.size[n] / block[n];
        coarse.grid.spacingMm[a] = g.spacingMm[a] * block[n];
        first[a] = isLabels ? 0.0 : 0.5 * (block[n] - 1);
    }
    coarse.grid.originMm = g.toMm(first);
    coarse.values.resize(coarse.grid.count());
    const auto& c = coarse.grid.size;
    core::parallelFor(static_cast<std::size_t>(c[2]), 1, [&](std::size_t from, std::size_t to) {
        for (int k = static_cast<int>(from); k < static_cast<int>(to); ++k)
            for (int j = 0; j < c[1]; ++j)
                for (int i = 0; i < c[0]; ++i) {
                    if (isLabels) {
                        coarse.values[coarse.grid.index(i, j, k)] =
                            volume.values[g.index(i * block[0], j * block[1], k * block[2])];
                        continue;
                    }
                    double sum = 0.0;
                    for (int z = 0; z < block[2]; ++z)
                        for (int y = 0; y < block[1]; ++y) {
                            const float* row =
                                &volume.values[g.index(i * block[0], j * block[1] + y, k * block[2] + z)];
                            for (int x = 0; x < block[0]; ++x)
                                sum += row[x];
                        }
                    coarse.values[coarse.grid.index(i, j, k)] =
                        static_cast<float>(sum / (double(block[0]) * block[1] * block[2]));
                }
    });
    return coarse;
}

ShownScan shownScan(volume::Scan scan, const scan_case::ScanJob& job, const core::Progress& progress) {
    ShownScan shown;
    if (const auto labels = scan_case::readLabels(scan, job)) {
        shown.labels = labels->labels;
        shown.labelKey = labels->key;
    }
    shown.histogram = histogramOf(scan.volume);
    core::report(progress, 0.5);
    const bool isLabels = shown.labels != nullptr;
    volume::Scan coarse{coarsened(scan.volume, isLabels), scan.series};
    core::report(progress, 1.0);
    const bool same = coarse.volume.grid.size == scan.volume.grid.size;
    if (isLabels) {
        shown.coarseLabels = shown.labels;
        scan_case::ScanJob asLabels = job;
        asLabels.isLabels = true;
        if (!same) shown.coarseLabels = scan_case::readLabels(coarse, asLabels)->labels;
    }
    shown.scan = std::make_shared<const volume::Scan>(std::move(scan));
    shown.coarse = same ? shown.scan : std::make_shared<const volume::Scan>(std::move(coarse));
    return shown;
}

std::shared_ptr<const volume::Scan> previewScan(const ShownScan& shown, const segmentation::Settings& settings) {
    // From a click in the crown to the end of the longest root, and some more.
    constexpr double kReachMm = 27.0;
    if (!settings.toothAtMm || shown.labels || shown.coarse == shown.scan) return shown.coarse;
    const volume::Volume& whole = shown.scan->volume;
    const core::Vec3 at = whole.grid.toVoxels(*settings.toothAtMm);
    volume::Scan part{{}, shown.scan->series};
    part.volume.grid = whole.grid;
    std::array<int, 3> first{};
    for (int a = 0; a < 3; ++a) {
        const auto n = static_cast<std::size_t>(a);
        const double reach = kReachMm / whole.grid.spacingMm[a];
        first[n] = std::clamp(static_cast<int>(at[a] - reach), 0, whole.grid.size[n] - 1);
        const int last = std::clamp(static_cast<int>(at[a] + reach), first[n], whole.grid.size[n] - 1);
        part.volume.grid.size[n] = last - first[n] + 1;
    }
    if (2 * part.volume.grid.count() > whole.grid.count()) return shown.coarse;
    part.volume.grid.originMm = whole.grid.toMm(core::Vec3(first[0], first[1], first[2]));
    const auto& size = part.volume.grid.size;
    part.volume.values.reserve(part.volume.grid.count());
    for (int k = 0; k < size[2]; ++k)
        for (int j = 0; j < size[1]; ++j) {
            const auto row = whole.values.begin() +
                             static_cast<std::ptrdiff_t>(whole.grid.index(first[0], first[1] + j, first[2] + k));
            part.volume.values.insert(part.volume.values.end(), row, row + size[0]);
        }
    part.volume = coarsened(part.volume, false);
    return std::make_shared<const volume::Scan>(std::move(part));
}

ShownResult shownResult(scan_case::ScanResult result, const core::Progress& progress) {
    ShownResult shown;
    // The finest there is; a case's surfaces where there is one.
    const surfacing::Surfaces* surfaces =
        !result.cases.empty() && result.cases.back().surfaces ? result.cases.back().surfaces.get() : result.full.get();
    if (surfaces && result.region) {
        const core::Pose& pose = result.placed.scanInTooth;
        addOutside(surfaces->outer.mesh, *result.region, pose, shown.parts);
        for (const surfacing::Surface& surface : surfaces->tissues)
            shown.parts.push_back({"inside", surface.tissue, 0, geometry::transformed(surface.mesh, pose)});
        for (const core::Vec3& v : surfaces->outer.mesh.vertices)
            shown.bounds.extend(pose.apply(v));
    }
    core::report(progress, 0.3);
    if (!result.cases.empty()) shown.figures = figuresOf(result, shown.parts, core::part(progress, 0.3, 1.0));
    shown.result = std::move(result);
    return shown;
}

double scaleByMolar(const volume::Volume& volume, const core::Progress& progress) {
    const segmentation::Thresholds thresholds = segmentation::findThresholds(volume, core::part(progress, 0.0, 0.6));
    const auto teeth = segmentation::findTeeth(volume, thresholds, core::part(progress, 0.6, 1.0));
    if (teeth.empty())
        throw core::Error("no tooth stands out in this scan", {},
                          "read the spacing from the scanner's record and type it");
    const double longest = teeth.front().boundsMm.size().maxCoeff();
    return longest > 0 ? kMeanMolarMm / longest : 0.0;
}

}  // namespace handpiece::desktop
