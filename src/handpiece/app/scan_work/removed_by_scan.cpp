// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_work/removed_by_scan.h"

#include <algorithm>
#include <array>

#include "handpiece/assess/measures/preparation.h"
#include "handpiece/base/geometry/mesh_edges.h"

namespace handpiece::scan_work {
namespace {

constexpr double kBesideMm = 0.2;     ///< of cut surface the margin may lie so far
constexpr double kLeastCutMm2 = 0.1;  ///< less is a speck of the scan

}  // namespace

std::vector<char> cutVertices(const TriangleMesh& mesh, const std::vector<double>& distances,
                              const std::vector<double>& areas, double growMm) {
    const std::size_t n = mesh.vertices.size();
    const double seedMm = std::max(measures::kScanSeedMm, 2.0 * growMm);
    geometry::DisjointSets sets(n);
    const geometry::MeshEdges edges(mesh);
    const auto isAtAll = [&](std::uint32_t v) { return distances[v] < -growMm; };
    for (const auto& e : edges.edges())
        if (isAtAll(e.low) && isAtAll(e.high)) sets.join(e.low, e.high);
    // A piece counts by how much of it is surely cut.
    std::vector<double> deepMm2(n, 0.0);
    for (std::uint32_t v = 0; v < n; ++v)
        if (distances[v] < -seedMm) deepMm2[sets.find(v)] += areas[v];
    std::vector<char> cut(n, 0);
    for (std::uint32_t v = 0; v < n; ++v)
        cut[v] = isAtAll(v) && deepMm2[sets.find(v)] >= kLeastCutMm2;
    return cut;
}

Removed::Removed(const TriangleMesh& mesh, const std::vector<char>& cut, const TriangleTree& whole, double growMm)
    : tree_(mesh), whole_(whole), growMm_(growMm) {
    TriangleMesh rim{mesh.vertices, {}};
    const geometry::MeshEdges edges(mesh);
    for (const auto& e : edges.edges())
        if (e.count == 1) rim.triangles.push_back({e.low, e.high, e.high});
    if (!rim.triangles.empty()) rim_ = std::make_unique<TriangleTree>(rim);
    const std::vector<Vec3> normals = faceNormals(mesh);
    const std::vector<Vec3> even = evenNormals(mesh, normals, Cells(mesh.vertices, kSmoothMm));
    for (const geometry::Triangle& t : mesh.triangles)
        even_.push_back(even[t[0]] + even[t[1]] + even[t[2]]);
    const std::vector<char> folded = foldedFaces(mesh, normals, even);
    // What a folded face's corner or edge says is no better.
    std::vector<char> isBad(mesh.vertices.size(), 0);
    for (std::size_t f = 0; f < folded.size(); ++f)
        if (folded[f])
            for (const std::uint32_t v : mesh.triangles[f])
                isBad[v] = 1;
    TriangleMesh bad{mesh.vertices, {}};
    for (const geometry::Triangle& t : mesh.triangles)
        if (isBad[t[0]] || isBad[t[1]] || isBad[t[2]]) bad.triangles.push_back(t);
    if (!bad.triangles.empty()) folded_ = std::make_unique<TriangleTree>(bad);
    std::vector<Vec3> cutMm;
    for (std::size_t i = 0; i < cut.size(); ++i)
        if (cut[i]) cutMm.push_back(mesh.vertices[i]);
    const Cells cells(cutMm, kBesideMm);
    TriangleMesh cutFaces{mesh.vertices, {}}, beside = cutFaces;
    for (const geometry::Triangle& t : mesh.triangles) {
        if (cut[t[0]] || cut[t[1]] || cut[t[2]]) {
            cutFaces.triangles.push_back(t);
            continue;
        }
        bool isNear = false;
        for (const std::uint32_t v : t)
            cells.around(mesh.vertices[v], [&](std::uint32_t) { isNear = true; });
        if (isNear) beside.triangles.push_back(t);
    }
    if (!cutFaces.triangles.empty()) cut_ = std::make_unique<TriangleTree>(cutFaces);
    if (!beside.triangles.empty()) beside_ = std::make_unique<TriangleTree>(beside);
}

double Removed::operator()(const Vec3& p) const {
    const geometry::NearestPoint n = tree_.nearest(p);
    const auto isOn = [&](const std::unique_ptr<TriangleTree>& faces) {
        return faces && faces->nearest(n.pointMm, 1e-7).triangle != geometry::kNoTriangle;
    };
    // Past its border a scan says nothing.
    if (isOn(rim_)) return n.distanceMm;
    // The nearest feature's normal says nothing where noise has folded the surface. Where what lies around it says
    // another, how often a way out meets the surface decides.
    double side = tree_.side(p, n);
    const bool isDoubtful = !(side * even_[tree_.triangles()[n.triangle].index].dot(p - n.pointMm) > 0.0);
    if (isDoubtful || isOn(folded_)) side = isInside(p) ? -1.0 : 1.0;
    const double d = side * n.distanceMm;
    if (isOn(cut_)) return -d;
    return isOn(beside_) ? std::max(-d, whole_.signedDistance(p) + growMm_) : n.distanceMm;
}

/// By the parity of meetings along most of seven ways up, where even an open crown has no border. A fold is met
/// twice more.
bool Removed::isInside(const Vec3& p) const {
    // Spread 25 degrees about +z, off the grid's directions.
    static const std::array<Vec3, 7> kWays = [] {
        std::array<Vec3, 7> ways{Vec3(0.013, 0.007, 1.0).normalized()};
        constexpr double kTilt = 0.47;
        constexpr double kAround[6][2] = {{0.98, 0.20},   {0.32, 0.95},   {-0.66, 0.75},
                                          {-0.98, -0.20}, {-0.32, -0.95}, {0.66, -0.75}};
        for (std::size_t i = 0; i < 6; ++i)
            ways[i + 1] = Vec3(kTilt * kAround[i][0], kTilt * kAround[i][1], 1.0).normalized();
        return ways;
    }();
    constexpr double kStepMm = 1e-6;
    constexpr int kMostMeetings = 64;
    int odd = 0;
    for (const Vec3& way : kWays) {
        Vec3 from = p;
        int meetings = 0;
        for (; meetings < kMostMeetings; ++meetings) {
            const geometry::RayMeeting met = tree_.firstMeeting(from, way);
            if (met.triangle == geometry::kNoTriangle) break;
            from += (met.distanceMm + kStepMm) * way;
        }
        odd += meetings % 2;
    }
    return odd > 3;
}

}  // namespace handpiece::scan_work
