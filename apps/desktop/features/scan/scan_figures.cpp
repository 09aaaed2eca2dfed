// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/scan_figures.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::desktop {
namespace {

constexpr std::size_t kMaxPoints = 20000;  // a percentile needs no more

Thickness thicknessOf(const std::vector<core::Vec3>& all, const geometry::TriangleMesh& to) {
    Thickness thickness;
    if (all.empty() || to.triangles.empty()) return thickness;
    const geometry::TriangleTree tree(to);
    const std::size_t step = std::max<std::size_t>(1, all.size() / kMaxPoints);
    std::vector<double> away((all.size() + step - 1) / step);
    core::parallelFor(away.size(), 256, [&](std::size_t from, std::size_t end) {
        for (std::size_t i = from; i < end; ++i)
            away[i] = tree.nearest(all[i * step]).distanceMm;
    });
    std::sort(away.begin(), away.end());
    // Of a hundred the least and the most: a single vertex at an edge says nothing.
    const auto at = [&](double share) {
        return away[static_cast<std::size_t>(share * static_cast<double>(away.size() - 1))];
    };
    return {true, at(0.01), at(0.5), at(0.99)};
}

}  // namespace

ScanFigures figuresOf(const scan_case::ScanResult& result, const std::vector<cases::Part>& shownParts,
                      const core::Progress& progress) {
    ScanFigures figures;
    const surfacing::Surfaces* surfaces =
        !result.cases.empty() && result.cases.back().surfaces ? result.cases.back().surfaces.get() : result.full.get();
    if (!surfaces) return figures;
    const core::Pose& pose = result.placed.scanInTooth;
    const geometry::TriangleMesh outer = geometry::transformed(surfaces->outer.mesh, pose);
    figures.sizeMm = outer.bounds().size();
    figures.vertices = outer.vertices.size();
    figures.faces = outer.triangles.size();
    figures.errorBoundMm = surfaces->outer.errorBoundMm;
    const geometry::TriangleMesh* dentine = nullptr;
    const geometry::TriangleMesh* pulp = nullptr;
    for (const surfacing::Surface& surface : surfaces->tissues) {
        figures.vertices += surface.mesh.vertices.size();
        figures.faces += surface.mesh.triangles.size();
        figures.errorBoundMm = std::max(figures.errorBoundMm, surface.errorBoundMm);
        if (surface.tissue == cases::Tissue::dentine) dentine = &surface.mesh;
        if (surface.tissue == cases::Tissue::pulp) pulp = &surface.mesh;
    }
    core::report(progress, 0.2);
    if (dentine)
        for (const cases::Part& part : shownParts)
            if (part.name == "outside" && part.tissue == cases::Tissue::enamel)
                figures.enamel = thicknessOf(part.mesh.vertices, geometry::transformed(*dentine, pose));
    core::report(progress, 0.5);
    if (pulp) {
        std::vector<core::Vec3> inCrown;
        for (const core::Vec3& v : pulp->vertices)
            if (const core::Vec3 p = pose.apply(v); p.z() > 0) inCrown.push_back(p);
        figures.overPulp = thicknessOf(inCrown, outer);
    }
    core::report(progress, 0.7);
    if (!result.cases.empty())
        figures.findings = cases::checkCase(result.cases.back().toothCase, core::part(progress, 0.7, 1.0));
    return figures;
}

}  // namespace handpiece::desktop
