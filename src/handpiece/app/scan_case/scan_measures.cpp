// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_case/scan_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::scan_case {
namespace {

using core::Vec3;
using geometry::TriangleMesh;

constexpr double kMinEnamelMm = 0.03;                      ///< thinner is where the surfaces meet
constexpr double kTopFrom = 2.0 / 3.0, kSidesFrom = 0.25;  ///< of the crown's height
constexpr std::size_t kMaxPlaces = 20000;

struct Sample {
    Vec3 at;
    double mm;
};

std::optional<Thickness> thicknessOf(std::vector<Sample> samples) {
    constexpr std::size_t kFewest = 20;
    if (samples.size() < kFewest) return {};
    std::stable_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.mm < b.mm; });
    return Thickness{samples.front().mm, samples[samples.size() / 2].mm, samples.back().mm, samples.size(),
                     samples.front().at};
}

std::vector<Vec3> vertexNormals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3 n = (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
        for (const std::uint32_t v : t)
            normals[v] += n;
    }
    for (Vec3& n : normals)
        if (n.norm() > 0.0) n.normalize();
    return normals;
}

const TriangleMesh* partOf(const cases::Case& c, cases::Tissue tissue) {
    for (const cases::Part& part : c.parts)
        if (part.tissue == tissue) return &part.mesh;
    return nullptr;
}

/// Nearest distances from every n-th vertex of a mesh to a surface; negative inside.
std::vector<Sample> distances(const TriangleMesh& from, const geometry::TriangleTree& to) {
    const std::size_t step = from.vertices.size() / kMaxPlaces + 1;
    std::vector<Sample> samples((from.vertices.size() + step - 1) / step);
    core::parallelFor(samples.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            samples[i] = {from.vertices[i * step], to.signedDistance(from.vertices[i * step])};
    });
    return samples;
}

SurfaceQuality qualityOf(const surfacing::Surface& s, const std::string& name, double percent) {
    const geometry::MeshReport r = geometry::inspect(s.mesh);
    SurfaceQuality q;
    q.name = name;
    q.percent = percent;
    q.vertices = r.vertices;
    q.faces = r.faces;
    q.shells = r.shells;
    q.openEdges = r.openEdges;
    q.nonManifoldEdges = r.nonManifoldEdges;
    q.crossings = geometry::selfIntersections(s.mesh).size();
    q.genus = r.genus;
    q.volumeMm3 = r.volumeMm3;
    q.areaMm2 = r.areaMm2;
    q.errorBoundMm = s.errorBoundMm;
    q.isClosed = r.closed() && r.oriented() && r.nonManifoldVertices == 0;
    return q;
}

}  // namespace

ScanMeasures measure(const ScanResult& result, const core::Progress& progress) {
    ScanMeasures m;
    m.volumesMm3 = result.volumesMm3;
    m.toothMm3 = std::accumulate(m.volumesMm3.begin(), m.volumesMm3.end(), 0.0);
    const auto finest = std::max_element(result.cases.begin(), result.cases.end(),
                                         [](const auto& a, const auto& b) { return a.percent < b.percent; });
    if (finest == result.cases.end()) return m;
    const cases::Case& c = finest->toothCase;
    const core::Box box = c.outer.bounds();
    m.sizeMm = box.size();
    m.crownMm = std::max(0.0, box.max.z());
    const TriangleMesh* dentine = partOf(c, cases::Tissue::dentine);
    const TriangleMesh* pulp = partOf(c, cases::Tissue::pulp);
    if (dentine != nullptr) {
        const geometry::TriangleTree tree(*dentine);
        const std::vector<Vec3> normals = vertexNormals(c.outer);
        const std::size_t step = c.outer.vertices.size() / kMaxPlaces + 1;
        std::vector<Sample> top, sides;
        const std::vector<Sample> all = distances(c.outer, tree);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (all[i].mm < kMinEnamelMm) continue;
            const Vec3& n = normals[i * step];
            const double height = all[i].at.z() / std::max(m.crownMm, 1e-9);
            if (height > kTopFrom && n.z() > 0.3) top.push_back(all[i]);
            if (height > kSidesFrom && height < kTopFrom && std::abs(n.z()) < 0.6) sides.push_back(all[i]);
        }
        m.enamelTop = thicknessOf(std::move(top));
        m.enamelSides = thicknessOf(std::move(sides));
        if (pulp != nullptr) {
            std::vector<Sample> over;
            for (const Sample& s : distances(*pulp, tree))
                if (s.at.z() > 0.0) over.push_back({s.at, -s.mm});
            m.dentineOverPulp = thicknessOf(std::move(over));
        }
    }
    core::report(progress, 0.3);
    m.scanVoxelMm = result.scan->volume.grid.spacingMm.maxCoeff();
    m.voxelMm = result.region->grid.spacingMm.x();
    m.blurMm = result.region->blurMm;
    m.noise = result.region->noise;
    const segmentation::Thresholds& t = result.region->thresholds;
    const double contrast = std::abs(static_cast<double>(t.enamel) - static_cast<double>(t.dentine));
    if (!result.labels && contrast > 0.0) m.noiseShare = m.noise / contrast;
    std::size_t done = 0;
    for (const ScannedCase& each : result.cases) {
        m.surfaces.push_back(qualityOf(each.surfaces->outer, "outer", each.percent));
        for (const surfacing::Surface& s : each.surfaces->tissues)
            m.surfaces.push_back(
                qualityOf(s, fmt::format("{}{}", cases::properties(s.tissue).name, s.isAuthored ? " (authored)" : ""),
                          each.percent));
        core::report(progress, 0.3 + 0.7 * static_cast<double>(++done) / static_cast<double>(result.cases.size()));
    }
    return m;
}

std::vector<std::string> limitsOf(const ScanResult& result, const ScanMeasures& m) {
    constexpr double kThinCanalMm = 0.2;  ///< root canals near the apex [R]
    std::vector<std::string> limits;
    limits.push_back(fmt::format(
        "A voxel is {:.0f} µm: what is thinner than about two of them ({:.0f} µm) is widened, broken or lost.{}",
        1e3 * m.scanVoxelMm, 2e3 * m.scanVoxelMm,
        2.0 * m.scanVoxelMm > kThinCanalMm
            ? " Root canals near the apex are of that size: the pulp may end too early, and side canals are not shown."
            : ""));
    if (result.labels) {
        limits.emplace_back(
            "The scan was labels: somebody or something else decided where each tissue ends, to the voxel. Between "
            "voxels "
            "the surfaces are smooth guesses, and no grey value could be held against them.");
    } else {
        limits.emplace_back(
            "Tissues are told apart by how much X-ray they absorb, and by nothing else. Early caries that has lost "
            "little "
            "mineral looks sound; the stain and softness that a dentist feels do not show at all.");
        if (m.noiseShare > 0.3)
            limits.push_back(
                fmt::format("The noise is {:.0f} % of the step from dentine to enamel: the boundary between them is "
                            "uncertain by more "
                            "than the voxel says.",
                            100.0 * m.noiseShare));
    }
    if (m.volumesMm3[static_cast<std::size_t>(cases::Tissue::restoration)] > 0.0 && !result.labels)
        limits.emplace_back(
            "There is a filling or metal. It throws bright and dark streaks: tissues beside it may be misread, and its "
            "own edge is too wide.");
    if (m.volumesMm3[static_cast<std::size_t>(cases::Tissue::pulp)] <= 0.0)
        limits.emplace_back(
            "No pulp was found: drilling into it will not be noticed. It may be calcified, or below the scan's "
            "resolution.");
    if (m.volumesMm3[static_cast<std::size_t>(cases::Tissue::enamel)] <= 0.0)
        limits.emplace_back("No enamel was told apart from dentine: the whole crown cuts alike.");
    if (result.placed.isMesialGuessed)
        limits.emplace_back(
            "Which side is mesial cannot be seen on one tooth: it was guessed, and buccal with it. Views named so may "
            "be "
            "turned by half a turn or a quarter.");
    for (const ScannedCase& c : result.cases)
        for (const surfacing::Surface& s : c.surfaces->tissues)
            if (s.isAuthored) {
                limits.emplace_back("A lesion here was placed by a person: this tooth did not have it.");
                return limits;
            }
    return limits;
}

}  // namespace handpiece::scan_case
