// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/segmentation/segment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {

using core::Vec3;

namespace {
constexpr double kCoarsestMm = 0.6;   ///< a wider voxel is as wide as enamel is thick
constexpr double kFinestMm = 0.03;    ///< of a result
constexpr double kTipShare = 0.2;     ///< of the tooth's largest cross-section that the border may cut off at its roots
constexpr double kGrazeShare = 0.03;  ///< likewise anywhere

void checkScan(const volume::Grid& grid, std::size_t values) {
    if (values == 0 || values != grid.count()) throw core::Error("the scan has no voxels", "scan", "read it again");
    const double coarsest = grid.spacingMm.maxCoeff();
    if (!(grid.spacingMm.minCoeff() > 0) || !std::isfinite(coarsest))
        throw core::Error("the spacing of the voxels is not known", "scan", "give it in millimetres");
    if (coarsest > kCoarsestMm * (1.0 + 1e-6))  // files keep it as 32-bit numbers
        throw core::Error(
            fmt::format("the scan is too coarse: voxels of {:.3g} x {:.3g} x {:.3g} mm cannot show enamel "
                        "and pulp",
                        grid.spacingMm.x(), grid.spacingMm.y(), grid.spacingMm.z()),
            "scan", fmt::format("use a scan of {} mm or finer", kCoarsestMm))
            .as("scan-too-coarse", {fmt::format("{:.3g}", coarsest), fmt::format("{}", kCoarsestMm)});
}

void checkPoint(const volume::Grid& grid, const Vec3& mm, const char* what) {
    const Vec3 at = grid.toVoxels(mm);
    bool isInside = at.allFinite();
    for (int axis = 0; axis < 3; ++axis)
        isInside = isInside && at[axis] >= -0.5 && at[axis] <= grid.size[static_cast<std::size_t>(axis)] - 0.5;
    if (!isInside)
        throw core::Error(
            fmt::format("{} at ({:.2f}, {:.2f}, {:.2f}) mm lies outside the scan", what, mm.x(), mm.y(), mm.z()),
            "scan", "give it in the scanner's millimetres");
}

void checkSettings(const volume::Grid& grid, const Settings& settings) {
    for (const Mark& mark : settings.marks) {
        checkPoint(grid, mark.centreMm, "a mark");
        if (!(mark.radiusMm > 0) || !std::isfinite(mark.radiusMm))
            throw core::Error("a mark has no radius", "scan", "give it a radius in millimetres");
    }
    for (const AuthoredLesion& lesion : settings.lesions) {
        checkPoint(grid, lesion.centreMm, "a lesion");
        if (!(lesion.halfAxesMm.minCoeff() > 0) || !lesion.halfAxesMm.allFinite())
            throw core::Error("a lesion has no size", "scan", "give it three half axes in millimetres");
    }
    for (const CutPlane& plane : settings.cutPlanes)
        if (!(plane.normal.norm() > 0) || !plane.normal.allFinite() || !plane.pointMm.allFinite())
            throw core::Error("a cut plane has no direction", "scan", "give it a point and a normal");
    if (settings.toothAtMm) checkPoint(grid, *settings.toothAtMm, "the tooth");
    if (settings.spacingMm != 0 && !(settings.spacingMm >= 0.01 && settings.spacingMm <= kCoarsestMm))
        throw core::Error(fmt::format("a spacing of {:.3g} mm cannot be made", settings.spacingMm), "--spacing",
                          fmt::format("choose 0.01 to {} mm", kCoarsestMm));
    if (settings.thresholds) {
        const Thresholds& t = *settings.thresholds;
        if (!(t.outside < t.toothFrom && t.toothFrom < t.dentine && t.dentine <= t.enamel && t.dentine < t.enamelFrom))
            throw core::Error("the thresholds are not in order", "scan",
                              "outside, tooth from, dentine, enamel from and enamel rise in this order");
    }
}

std::size_t choose(const CoarseTeeth& teeth, const volume::Grid& grid, const Settings& settings) {
    if (teeth.teeth.empty()) throw nothingFound("nothing in it is as bright and as large as a tooth");
    if (!settings.toothAtMm) return 0;
    const Vec3 at = teeth.coarse.fromVoxels(grid.toVoxels(*settings.toothAtMm));
    const Vec3 reach = Vec3::Constant(1.5).cwiseQuotient(teeth.coarse.spacingMm);
    double nearest = 1e300;
    std::size_t best = teeth.teeth.size();
    const Shape& shape = teeth.coarse.shape;
    std::array<int, 3> low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<int>(axis);
        low[axis] = std::max(0, static_cast<int>(std::floor(at[a] - reach[a])));
        high[axis] = std::min(shape.size[axis] - 1, static_cast<int>(std::ceil(at[a] + reach[a])));
    }
    for (int k = low[2]; k <= high[2]; ++k)
        for (int j = low[1]; j <= high[1]; ++j)
            for (int i = low[0]; i <= high[0]; ++i) {
                const std::uint32_t tooth = teeth.of[shape.index(i, j, k)];
                if (tooth == 0) continue;
                const double d = (Vec3(i, j, k) - at).cwiseProduct(teeth.coarse.spacingMm).squaredNorm();
                if (d < nearest) nearest = d, best = tooth - 1;
            }
    if (best == teeth.teeth.size())
        throw core::Error(fmt::format("there is no tooth at ({:.2f}, {:.2f}, {:.2f}) mm", settings.toothAtMm->x(),
                                      settings.toothAtMm->y(), settings.toothAtMm->z()),
                          "scan", "point at the crown or a root of a tooth")
            .as("no-tooth-there");
    return best;
}

/// Roots that end at the border are noted; a crown or a whole root that does is no tooth.
void checkBorder(Work& work, const volume::Grid& scan) {
    const Shape& shape = work.shape;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const bool isHigh : {false, true}) {
            // The scan's last layer, in the block's voxels.
            Vec3 corner = Vec3::Zero();
            if (isHigh) corner[static_cast<int>(axis)] = scan.size[axis] - 1;
            const double place = work.grid.toVoxels(scan.toMm(corner))[static_cast<int>(axis)];
            const int layer = static_cast<int>(std::lround(place));
            if (layer < 0 || layer >= shape.size[axis]) continue;
            std::vector<std::size_t> areas(static_cast<std::size_t>(shape.size[axis]), 0);
            std::size_t cut = 0, cutEnamel = 0;
            for (std::size_t n = 0; n < work.outer.size(); ++n) {
                if (work.outer[n] <= 0) continue;
                const int c = shape.at(n)[axis];
                ++areas[static_cast<std::size_t>(c)];
                if (c != layer) continue;
                ++cut;
                cutEnamel += work.damped[n] > work.levels.enamelFrom ? 1 : 0;
            }
            const auto most = static_cast<double>(*std::max_element(areas.begin(), areas.end()));
            if (cut == 0 || most == 0) continue;
            const double share = static_cast<double>(cut) / most, enamel = static_cast<double>(cutEnamel) / most;
            if (share > kTipShare || enamel > kGrazeShare)
                throw core::Error("the tooth is cut off by the border of the scan", "scan",
                                  "choose another tooth, or a scan that shows all of it")
                    .as("tooth-cut-off");
            if (share > 0.002)
                work.notes.emplace_back(
                    "the border of the scan cuts off a little of the tooth (tips of its roots); it is closed there");
        }
}
}  // namespace

Region segment(const volume::Volume& volume, const Settings& settings, const core::Progress& progress) {
    checkScan(volume.grid, volume.values.size());
    checkSettings(volume.grid, settings);
    Work work;
    work.levels = settings.thresholds ? *settings.thresholds : findThresholds(volume, core::part(progress, 0, 0.08));
    const CoarseTeeth teeth = partTeeth(volume, work.levels, core::part(progress, 0.08, 0.15));
    const std::size_t chosen = choose(teeth, volume.grid, settings);
    if (teeth.hasNeighbour[chosen])
        work.notes.emplace_back("the tooth touches an adjacent one; it was parted where the two are narrowest");
    const double h =
        settings.spacingMm > 0 ? settings.spacingMm : std::max(kFinestMm, volume.grid.spacingMm.minCoeff());
    const core::Box& bounds = teeth.teeth[chosen].boundsMm;
    cutOut(work, volume, bounds.min.cwiseQuotient(volume.grid.spacingMm),
           bounds.max.cwiseQuotient(volume.grid.spacingMm), h, core::part(progress, 0.15, 0.2));
    damp(work, core::part(progress, 0.2, 0.25));
    findOuter(work, teeth, chosen, volume.grid, settings, core::part(progress, 0.25, 0.45));
    checkBorder(work, volume.grid);
    findTissues(work, settings, core::part(progress, 0.45, 0.6));
    refine(work, core::part(progress, 0.6, 0.95));
    return toRegion(std::move(work), settings, core::part(progress, 0.95, 1));
}

}  // namespace handpiece::segmentation
