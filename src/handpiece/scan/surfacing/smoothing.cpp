// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/surfacing/smoothing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/self_intersection.h"

namespace handpiece::surfacing {

using core::Vec3;
using geometry::Triangle;
using geometry::TriangleMesh;

namespace {

// Taubin 1995: what the first step shrinks the second swells; waves longer than about 2 pi / sqrt(pass band) edges
// stay.
constexpr double kShrink = 0.5, kSwell = -0.53;
constexpr std::size_t kGrain = 8192;
constexpr int kVolumeRounds = 3, kUncrossRounds = 12;

double sixVolume(const TriangleMesh& mesh, const Triangle& t, const Vec3& origin) {
    return (mesh.vertices[t[0]] - origin).dot((mesh.vertices[t[1]] - origin).cross(mesh.vertices[t[2]] - origin));
}

void step(const std::vector<Vec3>& from, std::vector<Vec3>& to, const Rings& rings, double factor,
          const std::vector<Vec3>& home, double reachMm) {
    core::parallelFor(from.size(), kGrain, [&](std::size_t b, std::size_t e) {
        for (std::size_t v = b; v < e; ++v) {
            Vec3 sum = Vec3::Zero();
            for (const std::uint32_t* n = rings.begin(v); n != rings.end(v); ++n)
                sum += from[*n];
            const Vec3 p = from[v] + factor * (sum / static_cast<double>(rings.count(v)) - from[v]);
            const Vec3 away = p - home[v];
            const double squared = away.squaredNorm();
            to[v] = squared > reachMm * reachMm ? (home[v] + reachMm / std::sqrt(squared) * away).eval() : p;
        }
    });
}

/// What lies between each shell's triangles and the smooth surface through their corners: each edge bulges by what its
/// ends' normals tell, each triangle by the mean of the parabolas over its edges.
std::vector<double> bulgesMm3(const TriangleMesh& mesh, const std::vector<Vec3>& normals, const Shells& shells) {
    std::vector<double> bulge(shells.volumeMm3.size(), 0.0);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const Triangle& t = mesh.triangles[f];
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const Vec3 &na = normals[t[0]], &nb = normals[t[1]], &nc = normals[t[2]];
        const double heights = ((nb - na).dot(b - a) + (nc - nb).dot(c - b) + (na - nc).dot(a - c)) / 8.0;
        bulge[shells.ofFace[f]] += 0.5 * (b - a).cross(c - a).norm() * heights / 3.0;
    }
    return bulge;
}

/// The vertices of crossing faces and their neighbours, in their order.
std::vector<std::uint32_t> around(const TriangleMesh& mesh, const Rings& rings,
                                  const std::vector<geometry::CrossingFaces>& crossings) {
    std::vector<std::uint32_t> found;
    for (const geometry::CrossingFaces& c : crossings)
        for (const std::uint32_t f : {c.first, c.second})
            for (const std::uint32_t v : mesh.triangles[f]) {
                found.push_back(v);
                found.insert(found.end(), rings.begin(v), rings.end(v));
            }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace

Rings::Rings(const TriangleMesh& mesh) : first_(mesh.vertices.size() + 1, 0), around_(3 * mesh.triangles.size()) {
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t)
            ++first_[v + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
    // Each neighbour follows the vertex in exactly one face of a closed surface.
    for (const Triangle& t : mesh.triangles)
        for (std::size_t c = 0; c < 3; ++c)
            around_[fill[t[c]]++] = t[(c + 1) % 3];
}

Shells shellsOf(const TriangleMesh& mesh) {
    std::vector<std::uint32_t> parent(mesh.vertices.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t v) {
        while (parent[v] != v)
            v = parent[v] = parent[parent[v]];
        return v;
    };
    for (const Triangle& t : mesh.triangles) {
        const std::uint32_t a = root(t[0]), b = root(t[1]), c = root(t[2]), least = std::min({a, b, c});
        parent[a] = parent[b] = parent[c] = least;
    }
    Shells shells;
    shells.ofFace.resize(mesh.triangles.size());
    std::vector<std::uint32_t> number(mesh.vertices.size(), 0xffffffffu);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const Triangle& t = mesh.triangles[f];
        std::uint32_t& n = number[root(t[0])];
        if (n == 0xffffffffu) {
            n = static_cast<std::uint32_t>(shells.volumeMm3.size());
            shells.volumeMm3.push_back(0.0);
            shells.areaMm2.push_back(0.0);
        }
        shells.ofFace[f] = n;
        shells.volumeMm3[n] += sixVolume(mesh, t, mesh.vertices.front()) / 6.0;
        shells.areaMm2[n] +=
            0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
    }
    return shells;
}

TriangleMesh keptShells(const TriangleMesh& mesh, const Shells& shells, const std::vector<bool>& keep) {
    TriangleMesh kept;
    std::vector<std::uint32_t> number(mesh.vertices.size(), 0xffffffffu);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        if (keep[shells.ofFace[f]])
            for (const std::uint32_t v : mesh.triangles[f])
                number[v] = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] != 0) continue;
        number[v] = static_cast<std::uint32_t>(kept.vertices.size());
        kept.vertices.push_back(mesh.vertices[v]);
    }
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const Triangle& t = mesh.triangles[f];
        if (keep[shells.ofFace[f]]) kept.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    }
    return kept;
}

std::vector<Vec3> vertexNormals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
    for (const Triangle& t : mesh.triangles) {
        const Vec3 n = (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
        for (const std::uint32_t v : t)
            normals[v] += n;
    }
    for (Vec3& n : normals) {
        const double length = n.norm();
        if (length > 0.0) n /= length;
    }
    return normals;
}

double setVolumes(TriangleMesh& mesh, const Shells& shells, const std::vector<double>& wantedMm3, double mostMm) {
    std::vector<std::uint32_t> shellOfVertex(mesh.vertices.size(), 0);
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        for (const std::uint32_t v : mesh.triangles[f])
            shellOfVertex[v] = shells.ofFace[f];
    std::vector<double> way(wantedMm3.size(), 0.0);
    for (int round = 0; round < kVolumeRounds; ++round) {
        std::vector<double> volume(wantedMm3.size(), 0.0), area(wantedMm3.size(), 0.0);
        const Vec3 origin = mesh.vertices.front();
        for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
            const Triangle& t = mesh.triangles[f];
            volume[shells.ofFace[f]] += sixVolume(mesh, t, origin) / 6.0;
            area[shells.ofFace[f]] +=
                0.5 *
                (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
        }
        std::vector<double> offset(wantedMm3.size());
        for (std::size_t s = 0; s < offset.size(); ++s)
            way[s] += offset[s] = std::clamp((wantedMm3[s] - volume[s]) / area[s], -mostMm, mostMm);
        const std::vector<Vec3> normals = vertexNormals(mesh);
        core::parallelFor(mesh.vertices.size(), kGrain, [&](std::size_t b, std::size_t e) {
            for (std::size_t v = b; v < e; ++v)
                mesh.vertices[v] += offset[shellOfVertex[v]] * normals[v];
        });
    }
    double longest = 0.0;
    for (const double w : way)
        longest = std::max(longest, std::abs(w));
    return longest;
}

void smoothKeepingVolume(TriangleMesh& mesh, const std::vector<Vec3>& normals, const Smoothing& smoothing,
                         const core::Progress& progress) {
    if (mesh.triangles.empty()) return;
    const Rings rings(mesh);
    const Shells shells = shellsOf(mesh);
    const std::vector<Vec3> home = mesh.vertices;
    std::vector<double> wanted;
    if (!normals.empty()) wanted = bulgesMm3(mesh, normals, shells);
    std::vector<Vec3> other(home.size());
    for (int round = 0; round < smoothing.rounds; ++round) {
        step(mesh.vertices, other, rings, kShrink, home, smoothing.reachMm);
        step(other, mesh.vertices, rings, kSwell, home, smoothing.reachMm);
        core::report(progress, 0.6 * (round + 1) / smoothing.rounds);
    }
    // The normals of a staircase say nothing: those of the surface that it became do.
    if (normals.empty()) wanted = bulgesMm3(mesh, vertexNormals(mesh), shells);
    for (std::size_t s = 0; s < wanted.size(); ++s)
        wanted[s] += shells.volumeMm3[s];
    setVolumes(mesh, shells, wanted, 0.5 * smoothing.reachMm);
    core::report(progress, 0.75);
    // Thin sheets may have gone through each other: there the marched surface, which never does, is taken back.
    std::vector<std::uint8_t> back(home.size(), 0);
    for (int round = 0; round < kUncrossRounds; ++round) {
        const std::vector<geometry::CrossingFaces> crossings = geometry::selfIntersections(mesh);
        core::report(progress, 0.8 + 0.2 * round / kUncrossRounds);
        if (crossings.empty()) break;
        for (const std::uint32_t v : around(mesh, rings, crossings)) {
            // Half the way, then all of it.
            mesh.vertices[v] = back[v] == 0 ? (0.5 * (mesh.vertices[v] + home[v])).eval() : home[v];
            back[v] = 1;
        }
    }
    core::report(progress, 1.0);
}

double uncross(TriangleMesh& mesh, std::size_t& left) {
    std::vector<geometry::CrossingFaces> crossings = geometry::selfIntersections(mesh);
    left = crossings.size();
    if (left == 0) return 0.0;
    const Rings rings(mesh);
    const std::vector<Vec3> home = mesh.vertices;
    std::vector<std::uint32_t> moved;
    for (int round = 0; round < 2 * kUncrossRounds && left > 0; ++round) {
        const std::vector<std::uint32_t> found = around(mesh, rings, crossings);
        std::vector<Vec3> to;
        for (const std::uint32_t v : found) {
            Vec3 sum = Vec3::Zero();
            for (const std::uint32_t* n = rings.begin(v); n != rings.end(v); ++n)
                sum += mesh.vertices[*n];
            to.push_back(0.5 * (mesh.vertices[v] + sum / static_cast<double>(rings.count(v))));
        }
        for (std::size_t i = 0; i < found.size(); ++i)
            mesh.vertices[found[i]] = to[i];
        moved.insert(moved.end(), found.begin(), found.end());
        crossings = geometry::selfIntersections(mesh);
        left = crossings.size();
    }
    double longest = 0.0;
    for (const std::uint32_t v : moved)
        longest = std::max(longest, (mesh.vertices[v] - home[v]).norm());
    return longest;
}

}  // namespace handpiece::surfacing
