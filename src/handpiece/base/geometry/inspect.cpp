// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/mesh_io_formats.h"

namespace handpiece::geometry {
namespace {

core::Vec3 centreOf(const TriangleMesh& mesh, const Triangle& t) {
    return (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
}

bool hasNoArea(const TriangleMesh& mesh, const Triangle& t) {
    const core::Vec3& a = mesh.vertices[t[0]];
    return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).squaredNorm() == 0.0;
}

std::size_t countDuplicateFaces(const TriangleMesh& mesh) {
    std::vector<Triangle> sorted;
    sorted.reserve(mesh.triangles.size());
    // In buckets by the lowest vertex: sorting all of them at once would cost more than everything else here.
    std::vector<std::uint32_t> start(mesh.vertices.size() + 1, 0);
    for (const Triangle& t : mesh.triangles)
        ++start[std::min({t[0], t[1], t[2]}) + 1];
    for (std::size_t i = 1; i < start.size(); ++i)
        start[i] += start[i - 1];
    sorted.resize(mesh.triangles.size());
    std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
    for (Triangle t : mesh.triangles) {
        std::sort(t.begin(), t.end());
        sorted[next[t[0]]++] = t;
    }
    std::size_t count = 0;
    for (std::size_t v = 0; v + 1 < start.size(); ++v) {
        const auto begin = sorted.begin() + start[v], end = sorted.begin() + start[v + 1];
        std::sort(begin, end);
        for (auto at = begin; at != end && at + 1 != end; ++at)
            count += *at == *(at + 1);
    }
    return count;
}

// Faces around a vertex fall into fans joined through edges; a manifold vertex has one fan.
void countVertexFlaws(const TriangleMesh& mesh, const MeshEdges& edges, const std::vector<std::uint8_t>& used,
                      MeshReport& report) {
    DisjointSets fans(3 * mesh.triangles.size());
    for (const MeshEdges::Edge& e : edges.edges()) {
        const std::span<const HalfEdge> half = edges.halfEdges(e);
        const auto cornerAt = [&](HalfEdge h, std::uint32_t v) {
            return fromVertex(mesh, h) == v ? h : nextHalfEdge(h);
        };
        for (const HalfEdge h : half.subspan(1)) {
            fans.join(cornerAt(half[0], e.low), cornerAt(h, e.low));
            fans.join(cornerAt(half[0], e.high), cornerAt(h, e.high));
        }
    }
    std::vector<std::uint32_t> fanCount(mesh.vertices.size(), 0);
    for (HalfEdge h = 0; h < 3 * mesh.triangles.size(); ++h)
        if (!repeatsCorner(mesh.triangles[h / 3]) && fans.find(h) == h) ++fanCount[fromVertex(mesh, h)];
    for (std::size_t v = 0; v < fanCount.size(); ++v) {
        if (fanCount[v] > 1 && report.nonManifoldVertices++ == 0) report.firstNonManifoldVertexMm = mesh.vertices[v];
        if (!used[v]) ++report.unusedVertices;
    }
}

}  // namespace

std::string_view unitName(LengthUnit unit) {
    switch (unit) {
        case LengthUnit::micrometre:
            return "um";
        case LengthUnit::millimetre:
            return "mm";
        case LengthUnit::centimetre:
            return "cm";
        case LengthUnit::metre:
            return "m";
        case LengthUnit::inch:
            return "inch";
        case LengthUnit::unknown:
            break;
    }
    return "unknown";
}

LengthUnit unitByName(std::string_view name) {
    for (const LengthUnit unit :
         {LengthUnit::micrometre, LengthUnit::millimetre, LengthUnit::centimetre, LengthUnit::metre, LengthUnit::inch})
        if (unitName(unit) == name) return unit;
    return LengthUnit::unknown;
}

double millimetresPer(LengthUnit unit) {
    switch (unit) {
        case LengthUnit::micrometre:
            return 1e-3;
        case LengthUnit::millimetre:
            return 1.0;
        case LengthUnit::centimetre:
            return 10.0;
        case LengthUnit::metre:
            return 1000.0;
        case LengthUnit::inch:
            return 25.4;
        case LengthUnit::unknown:
            break;
    }
    return 0.0;
}

UnitGuess probableUnit(double diagonal) {
    // Teeth are 5 to 40 mm, burs 0.3 to 30, dental arches and handpieces up to 250.
    if (!(diagonal > 0.0) || !std::isfinite(diagonal)) return {LengthUnit::unknown, 0.0, "the box has no size"};
    if (diagonal >= 0.3 && diagonal <= 60.0)
        return {LengthUnit::millimetre, 1.0, fmt::format("a diagonal of {:.4g} mm suits a tooth or a bur", diagonal)};
    if (diagonal > 60.0 && diagonal <= 250.0)
        return {LengthUnit::millimetre, 1.0,
                fmt::format("a diagonal of {:.4g} mm suits a dental arch or a handpiece", diagonal)};
    // Where several units would do, the one whose object is nearest to a tooth, in proportion.
    constexpr double kToothMm = 15.0;
    UnitGuess best{LengthUnit::unknown, 0.0,
                   fmt::format("a diagonal of {:.4g} suits no dental object in um, mm, cm, m or inch", diagonal)};
    double bestOff = core::log(200.0 / kToothMm);
    for (const LengthUnit unit :
         {LengthUnit::metre, LengthUnit::inch, LengthUnit::centimetre, LengthUnit::micrometre}) {
        const double mm = diagonal * millimetresPer(unit), off = std::abs(core::log(mm / kToothMm));
        if (mm < 0.3 || mm > 60.0 || off >= bestOff) continue;
        bestOff = off;
        best = {unit, millimetresPer(unit),
                fmt::format("a diagonal of {:.4g} is {} for a dental object in mm; in {} it would be {:.4g} mm",
                            diagonal, diagonal < 1.0 ? "too small" : "too large", unitName(unit), mm)};
    }
    return best;
}

MeshReport inspect(const TriangleMesh& mesh) {
    requireValidIndices(mesh, "mesh");
    MeshReport report;
    report.vertices = mesh.vertices.size();
    report.faces = mesh.triangles.size();
    report.areaMm2 = surfaceAreaMm2(mesh);
    report.volumeMm3 = enclosedVolumeMm3(mesh);

    std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
    std::size_t repeated = 0;
    for (const Triangle& t : mesh.triangles) {
        for (const std::uint32_t v : t)
            used[v] = 1;
        const bool repeats = repeatsCorner(t);
        repeated += repeats;
        report.degenerateFaces += repeats || hasNoArea(mesh, t);
    }
    formats::VertexMerger<double> places(mesh.vertices.size());
    std::size_t usedVertices = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (!used[v]) continue;
        const core::Vec3& p = mesh.vertices[v];
        report.boxMm.extend(p);
        places.add(p.x(), p.y(), p.z());
        ++usedVertices;
    }
    report.duplicateVertices = usedVertices - places.size();
    report.duplicateFaces = countDuplicateFaces(mesh);
    report.unit = probableUnit(report.boxMm.isEmpty() ? 0.0 : report.boxMm.size().norm());

    const MeshEdges edges(mesh);
    const Shells shells = shellsOf(mesh, edges);
    report.shells = shells.count;
    report.edges = edges.edges().size();
    std::vector<std::uint8_t> closed(shells.count, 1);
    DisjointSets boundary(mesh.vertices.size());
    std::vector<std::uint32_t> boundaryVertices;
    for (const MeshEdges::Edge& e : edges.edges()) {
        if (e.count == 2) continue;
        const core::Vec3 middle = 0.5 * (mesh.vertices[e.low] + mesh.vertices[e.high]);
        closed[shells.ofFace[edges.halfEdges(e)[0] / 3]] = 0;
        if (e.count == 1) {
            if (report.openEdges++ == 0) report.firstOpenEdgeMm = middle;
            boundary.join(e.low, e.high);
            boundaryVertices.push_back(e.low);
            boundaryVertices.push_back(e.high);
        } else if (report.nonManifoldEdges++ == 0) {
            report.firstNonManifoldEdgeMm = middle;
        }
    }
    for (std::uint32_t& v : boundaryVertices)
        v = boundary.find(v);
    std::sort(boundaryVertices.begin(), boundaryVertices.end());
    report.boundaryLoops = static_cast<std::size_t>(std::unique(boundaryVertices.begin(), boundaryVertices.end()) -
                                                    boundaryVertices.begin());

    const Orientation orientation = agreeingOrientation(mesh, edges);
    report.orientable = orientation.orientable;
    report.flippedFaces = orientation.turned;
    const auto flipped = std::find(orientation.turn.begin(), orientation.turn.end(), std::uint8_t{1});
    if (flipped != orientation.turn.end())
        report.firstFlippedFaceMm =
            centreOf(mesh, mesh.triangles[static_cast<std::size_t>(flipped - orientation.turn.begin())]);

    countVertexFlaws(mesh, edges, used, report);

    TriangleMesh agreed;  // the shells as they would face once their neighbours agree
    const TriangleMesh* facing = &mesh;
    if (orientation.turned > 0) {
        agreed = mesh;
        for (std::size_t f = 0; f < agreed.triangles.size(); ++f)
            if (orientation.turn[f]) std::swap(agreed.triangles[f][1], agreed.triangles[f][2]);
        facing = &agreed;
    }
    const std::vector<double> volumes = shellVolumesMm3(*facing, shells);
    const std::vector<std::uint32_t> depth = nestingOf(mesh, shells, closed);
    for (std::size_t s = 0; s < shells.count; ++s)
        if (closed[s] && volumes[s] != 0.0 && (volumes[s] > 0.0) != (depth[s] % 2 == 0)) {
            if (report.insideOutShells++ == 0 && !report.firstFlippedFaceMm) {
                const auto first = std::find(shells.ofFace.begin(), shells.ofFace.end(), static_cast<std::uint32_t>(s));
                report.firstFlippedFaceMm =
                    centreOf(mesh, mesh.triangles[static_cast<std::size_t>(first - shells.ofFace.begin())]);
            }
        }

    report.eulerCharacteristic = static_cast<std::int64_t>(usedVertices) - static_cast<std::int64_t>(report.edges) +
                                 static_cast<std::int64_t>(report.faces - repeated);
    if (report.closed() && report.nonManifoldVertices == 0 && report.orientable && repeated == 0)
        report.genus = static_cast<std::int64_t>(report.shells) - report.eulerCharacteristic / 2;
    return report;
}

}  // namespace handpiece::geometry
