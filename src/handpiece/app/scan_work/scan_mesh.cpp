// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_work/scan_mesh.h"

#include <algorithm>
#include <map>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/mesh_edges.h"

namespace handpiece::scan_work {
namespace {

constexpr int kSmoothRounds = 3;
constexpr double kDenseMm = 0.07;  ///< closer points are gathered: their mean has less noise, and a field needs no more

/// Vertices at the same place, to the bit, are one.
TriangleMesh welded(const TriangleMesh& mesh) {
    std::map<std::array<double, 3>, std::uint32_t> at;
    TriangleMesh out;
    std::vector<std::uint32_t> number;
    number.reserve(mesh.vertices.size());
    for (const Vec3& v : mesh.vertices) {
        const auto [place, isNew] =
            at.try_emplace(core::toArray(v + Vec3::Zero()), static_cast<std::uint32_t>(out.vertices.size()));
        if (isNew) out.vertices.push_back(v);
        number.push_back(place->second);
    }
    for (const geometry::Triangle& t : mesh.triangles)
        out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    return kept(out, std::vector<char>(out.triangles.size(), 1));
}

/// Neighbours agree; each shell looks away from its own middle, which a crown open below does too.
TriangleMesh outwards(TriangleMesh mesh) {
    const geometry::MeshEdges edges(mesh);
    const geometry::Orientation agree = geometry::agreeingOrientation(mesh, edges);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        if (agree.turn[f]) std::swap(mesh.triangles[f][1], mesh.triangles[f][2]);
    const geometry::Shells shells = geometry::shellsOf(mesh, edges);
    std::vector<Vec3> middle(shells.count, Vec3::Zero());
    std::vector<double> area(shells.count, 0.0), flux(shells.count, 0.0);
    const std::vector<Vec3> normals = faceNormals(mesh);
    const auto centre = [&](std::size_t f) {
        const geometry::Triangle& t = mesh.triangles[f];
        return Vec3((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0);
    };
    for (std::size_t f = 0; f < normals.size(); ++f) {
        middle[shells.ofFace[f]] += normals[f].norm() * centre(f);
        area[shells.ofFace[f]] += normals[f].norm();
    }
    for (std::size_t f = 0; f < normals.size(); ++f) {
        const std::uint32_t shell = shells.ofFace[f];
        if (area[shell] > 0.0) flux[shell] += normals[f].dot(centre(f) - middle[shell] / area[shell]);
    }
    for (std::size_t f = 0; f < normals.size(); ++f)
        if (flux[shells.ofFace[f]] < 0.0) std::swap(mesh.triangles[f][1], mesh.triangles[f][2]);
    return mesh;
}

/// Points of one cell that look the same way become their mean.
TriangleMesh gathered(const TriangleMesh& mesh) {
    const double area = geometry::surfaceAreaMm2(mesh);
    if (mesh.vertices.empty() || !(area > 0.0)) return mesh;
    // Twice as dense as the cells at least: else there is nothing to gain.
    if (area / static_cast<double>(mesh.vertices.size()) > 0.3 * kDenseMm * kDenseMm) return mesh;
    std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
    const std::vector<Vec3> faces = faceNormals(mesh);
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const std::uint32_t v : mesh.triangles[f])
            normals[v] += faces[f];
    struct Cell {
        Vec3 sum = Vec3::Zero();
        double count = 0.0;
    };
    std::map<std::array<int, 4>, std::uint32_t> at;
    std::vector<Cell> cells;
    std::vector<std::uint32_t> number;
    number.reserve(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vec3& p = mesh.vertices[i];
        int axis = 0;
        (void)normals[i].cwiseAbs().maxCoeff(&axis);
        const int way = 2 * axis + (normals[i][axis] < 0.0 ? 1 : 0);
        const auto cellOf = [](double v) { return static_cast<int>(std::floor(v / kDenseMm)); };
        const auto [place, isNew] = at.try_emplace({cellOf(p.x()), cellOf(p.y()), cellOf(p.z()), way},
                                                   static_cast<std::uint32_t>(cells.size()));
        if (isNew) cells.emplace_back();
        cells[place->second].sum += p;
        cells[place->second].count += 1.0;
        number.push_back(place->second);
    }
    TriangleMesh out;
    for (const Cell& cell : cells)
        out.vertices.push_back(cell.sum / cell.count);
    std::map<geometry::Triangle, char> there;
    for (const geometry::Triangle& t : mesh.triangles) {
        geometry::Triangle made{number[t[0]], number[t[1]], number[t[2]]};
        geometry::Triangle sorted = made;
        std::sort(sorted.begin(), sorted.end());
        if (!geometry::repeatsCorner(made) && there.try_emplace(sorted, 1).second) out.triangles.push_back(made);
    }
    return kept(out, std::vector<char>(out.triangles.size(), 1));
}

/// Small holes get a fan about their middle; the largest border is where the scan ends.
void closeSmallHoles(TriangleMesh& mesh) {
    const geometry::MeshEdges edges(mesh);
    std::unordered_map<std::uint32_t, std::uint32_t> next;
    std::vector<std::uint32_t> starts;
    std::unordered_map<std::uint32_t, int> ways;
    for (const auto& e : edges.edges()) {
        if (e.count != 1) continue;
        const geometry::HalfEdge h = edges.halfEdges(e)[0];
        const std::uint32_t from = geometry::fromVertex(mesh, h), to = geometry::toVertex(mesh, h);
        next[from] = to;
        ++ways[from];
        starts.push_back(from);
    }
    std::sort(starts.begin(), starts.end());
    std::unordered_map<std::uint32_t, char> done;
    for (const std::uint32_t start : starts) {
        std::vector<std::uint32_t> loop;
        double around = 0.0;
        std::uint32_t at = start;
        bool isPlain = true;
        while (isPlain && !done[at]) {
            done[at] = 1;
            isPlain = ways[at] == 1 && next.count(at) != 0;
            if (!isPlain) break;
            loop.push_back(at);
            around += (mesh.vertices[next[at]] - mesh.vertices[at]).norm();
            at = next[at];
        }
        if (!isPlain || at != start || loop.size() < 3 || around > kHoleMm) continue;
        Vec3 middle = Vec3::Zero();
        for (const std::uint32_t v : loop)
            middle += mesh.vertices[v] / static_cast<double>(loop.size());
        const auto centre = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(middle);
        for (std::size_t i = 0; i < loop.size(); ++i)
            mesh.triangles.push_back({loop[(i + 1) % loop.size()], loop[i], centre});
    }
}

double biweight(double t) {
    return t < 1.0 ? (1.0 - t * t) * (1.0 - t * t) : 0.0;
}

}  // namespace

/// Faces that name three vertices; vertices that faces name.
TriangleMesh kept(const TriangleMesh& mesh, const std::vector<char>& keepFace) {
    TriangleMesh out;
    constexpr std::uint32_t kNone = 0xffffffffu;
    std::vector<std::uint32_t> number(mesh.vertices.size(), kNone);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        if (!keepFace[f] || geometry::repeatsCorner(mesh.triangles[f])) continue;
        geometry::Triangle made{};
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t& n = number[mesh.triangles[f][k]];
            if (n == kNone) {
                n = static_cast<std::uint32_t>(out.vertices.size());
                out.vertices.push_back(mesh.vertices[mesh.triangles[f][k]]);
            }
            made[k] = n;
        }
        out.triangles.push_back(made);
    }
    return out;
}

TriangleMesh keptVertices(const TriangleMesh& mesh, const std::vector<char>& keepVertex) {
    std::vector<char> keep(mesh.triangles.size());
    for (std::size_t f = 0; f < keep.size(); ++f) {
        const geometry::Triangle& t = mesh.triangles[f];
        keep[f] = keepVertex[t[0]] && keepVertex[t[1]] && keepVertex[t[2]];
    }
    return kept(mesh, keep);
}

TriangleMesh tidied(TriangleMesh mesh) {
    mesh = gathered(outwards(welded(mesh)));
    closeSmallHoles(mesh);
    return mesh;
}

TriangleMesh turned(TriangleMesh mesh) {
    for (geometry::Triangle& t : mesh.triangles)
        std::swap(t[1], t[2]);
    return mesh;
}

std::vector<double> vertexAreas(const TriangleMesh& mesh) {
    std::vector<double> areas(mesh.vertices.size(), 0.0);
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3& a = mesh.vertices[t[0]];
        const double area = 0.5 * (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
        for (const std::uint32_t v : t)
            areas[v] += area / 3.0;
    }
    return areas;
}

std::vector<double> distancesTo(const TriangleTree& surface, const TriangleMesh& mesh) {
    std::vector<double> distances(mesh.vertices.size());
    core::parallelFor(distances.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            distances[i] = surface.signedDistance(mesh.vertices[i]);
    });
    return distances;
}

Spread spreadOf(const std::vector<double>& distances, const std::vector<double>& areas,
                const std::vector<char>& asked) {
    Spread spread;
    double sum = 0.0;
    for (std::size_t i = 0; i < distances.size(); ++i)
        if (asked[i]) {
            sum += areas[i] * distances[i] * distances[i];
            spread.areaMm2 += areas[i];
        }
    if (spread.areaMm2 > 0.0) spread.rmsMm = std::sqrt(sum / spread.areaMm2);
    return spread;
}

std::vector<Vec3> faceNormals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals;
    normals.reserve(mesh.triangles.size());
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3& a = mesh.vertices[t[0]];
        normals.push_back((mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a));
    }
    return normals;
}

std::vector<Vec3> evenNormals(const TriangleMesh& mesh, const std::vector<Vec3>& faces, const Cells& cells) {
    std::vector<Vec3> plain(mesh.vertices.size(), Vec3::Zero()), even = plain;
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const std::uint32_t v : mesh.triangles[f])
            plain[v] += faces[f];
    core::parallelFor(plain.size(), 128, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            // A folded vertex has no way of its own: twice, the second time with what the first found.
            Vec3 way = unit(plain[i]);
            for (int pass = 0; pass < 2; ++pass) {
                Vec3 sum = Vec3::Zero();
                cells.around(mesh.vertices[i], [&](std::uint32_t j) {
                    if (unit(plain[j]).dot(way) > 0.5) sum += plain[j];
                });
                way = unit(sum);
            }
            even[i] = way;
        }
    });
    return even;
}

std::vector<char> foldedFaces(const TriangleMesh& mesh, const std::vector<Vec3>& faces, const std::vector<Vec3>& even) {
    std::vector<char> folded(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const geometry::Triangle& t = mesh.triangles[f];
        folded[f] = unit(faces[f]).dot(unit(even[t[0]] + even[t[1]] + even[t[2]])) < 0.3;
    }
    return folded;
}

TriangleMesh smoothed(TriangleMesh mesh, double noiseMm) {
    const double shapeMm = std::max(3.5 * noiseMm, 1e-3);
    const std::size_t n = mesh.vertices.size();
    const geometry::MeshEdges edges(mesh);
    for (int round = 0; round < kSmoothRounds; ++round) {
        const Cells cells(mesh.vertices, kSmoothMm);
        const std::vector<Vec3> faces = faceNormals(mesh), normals = evenNormals(mesh, faces, cells);
        const std::vector<char> folded = foldedFaces(mesh, faces, normals);
        std::vector<char> slides(n, 0);
        for (std::size_t f = 0; f < folded.size(); ++f)
            if (folded[f])
                for (const std::uint32_t v : mesh.triangles[f])
                    slides[v] = 1;
        std::vector<Vec3> sums(n, Vec3::Zero());
        std::vector<double> counts(n, 0.0);
        for (const auto& e : edges.edges()) {
            if (e.count != 2) slides[e.low] = slides[e.high] = 0;
            sums[e.low] += mesh.vertices[e.high];
            sums[e.high] += mesh.vertices[e.low];
            counts[e.low] += 1.0;
            counts[e.high] += 1.0;
        }
        std::vector<Vec3> moved = mesh.vertices;
        core::parallelFor(n, 128, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                double sum = 0.0, weights = 0.0;
                cells.around(mesh.vertices[i], [&](std::uint32_t j) {
                    const Vec3 d = mesh.vertices[j] - mesh.vertices[i];
                    if (normals[j].dot(normals[i]) < 0.6) return;
                    const double h = normals[i].dot(d);
                    const double w = biweight(d.norm() / kSmoothMm) * biweight(std::abs(h) / shapeMm);
                    sum += w * h;
                    weights += w;
                });
                if (weights > 0.0) moved[i] += sum / weights * normals[i];
                if (!slides[i] || !(counts[i] > 0.0)) continue;
                const Vec3 d = sums[i] / counts[i] - mesh.vertices[i];
                moved[i] += 0.5 * (d - normals[i].dot(d) * normals[i]);
            }
        });
        mesh.vertices = std::move(moved);
    }
    return mesh;
}

}  // namespace handpiece::scan_work
