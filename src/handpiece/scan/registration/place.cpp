// SPDX-License-Identifier: Apache-2.0
// The tooth's own frame: occlusal where the enamel lies, long axis by inertia, mesial by the crown's longer side.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/scan/registration/moments.h"
#include "handpiece/scan/registration/registration.h"

namespace handpiece::registration {
namespace {

using core::Mat3;
using core::Vec3;
using geometry::TriangleMesh;

/// Enamel thinner than this is the two surfaces' noise.
constexpr double kMinEnamelMm = 0.05;
/// A fine surface is looked at through one of its vertices a cell: where the neck runs needs no more.
constexpr std::size_t kManyFaces = 60000;
constexpr double kCellMm = 0.25;
/// With less of either there is no telling which end is the crown.
constexpr double kMinShare = 0.02;
/// A hint that is this near to the other axis (cosine) says nothing.
constexpr double kParallel = 0.98;

/// The same surface with one vertex, of its own, in each cell. Not manifold; no triangle twice.
TriangleMesh thinned(const TriangleMesh& mesh) {
    const Vec3 from = mesh.bounds().min;
    std::vector<std::pair<std::array<int, 3>, std::uint32_t>> cells(mesh.vertices.size());
    for (std::uint32_t v = 0; v < cells.size(); ++v) {
        const Vec3 at = (mesh.vertices[v] - from) / kCellMm;
        cells[v] = {{static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z())}, v};
    }
    std::sort(cells.begin(), cells.end());
    TriangleMesh thin;
    std::vector<std::uint32_t> number(mesh.vertices.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (i == 0 || cells[i].first != cells[i - 1].first) thin.vertices.push_back(mesh.vertices[cells[i].second]);
        number[cells[i].second] = static_cast<std::uint32_t>(thin.vertices.size() - 1);
    }
    for (const geometry::Triangle& t : mesh.triangles) {
        geometry::Triangle made{number[t[0]], number[t[1]], number[t[2]]};
        if (geometry::repeatsCorner(made)) continue;
        std::rotate(made.begin(), std::min_element(made.begin(), made.end()), made.end());
        thin.triangles.push_back(made);
    }
    std::sort(thin.triangles.begin(), thin.triangles.end());
    thin.triangles.erase(std::unique(thin.triangles.begin(), thin.triangles.end()), thin.triangles.end());
    return thin;
}

/// Which triangles of the outer surface have enamel under them.
std::vector<std::uint8_t> enamelOf(const TriangleMesh& outer, const TriangleMesh& dentine) {
    const geometry::TriangleTree tree(dentine);
    std::vector<std::uint8_t> isEnamel(outer.triangles.size(), 0), isAtVertex(outer.vertices.size(), 0);
    core::parallelFor(outer.vertices.size(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            isAtVertex[i] = tree.signedDistance(outer.vertices[i]) > kMinEnamelMm ? 1 : 0;
        }
    });
    for (std::size_t i = 0; i < isEnamel.size(); ++i) {
        const geometry::Triangle& t = outer.triangles[i];
        isEnamel[i] = isAtVertex[t[0]] + isAtVertex[t[1]] + isAtVertex[t[2]] >= 2 ? 1 : 0;
    }
    return isEnamel;
}

/// Leaves the largest connected piece of each kind; the rest takes the kind around it, so that specks of noise and a
/// cavity do not count as the neck.
void keepLargest(std::vector<std::uint8_t>& isEnamel, const TriangleMesh& outer, const geometry::MeshEdges& edges) {
    for (const std::uint8_t kind : {std::uint8_t{1}, std::uint8_t{0}}) {
        geometry::DisjointSets sets(outer.triangles.size());
        for (const auto& e : edges.edges()) {
            const auto halves = edges.halfEdges(e);
            for (std::size_t i = 1; i < halves.size(); ++i)
                if (isEnamel[halves[0] / 3] == isEnamel[halves[i] / 3]) sets.join(halves[0] / 3, halves[i] / 3);
        }
        std::map<std::uint32_t, double> area;
        for (std::uint32_t i = 0; i < outer.triangles.size(); ++i) {
            if (isEnamel[i] != kind) continue;
            const geometry::Triangle& t = outer.triangles[i];
            area[sets.find(i)] +=
                (outer.vertices[t[1]] - outer.vertices[t[0]]).cross(outer.vertices[t[2]] - outer.vertices[t[0]]).norm();
        }
        if (area.empty()) return;
        const auto largest = std::max_element(area.begin(), area.end(),
                                              [](const auto& a, const auto& b) { return a.second < b.second; });
        for (std::uint32_t i = 0; i < outer.triangles.size(); ++i)
            if (isEnamel[i] == kind && sets.find(i) != largest->first) isEnamel[i] = kind ^ 1u;
    }
}

struct Crown {
    Moments enamel, rest;  ///< of their areas
    Moments neck;          ///< of the line between them, by length
    [[nodiscard]] double share() const { return enamel.weight / (enamel.weight + rest.weight); }
    [[nodiscard]] bool isFound() const { return share() > kMinShare && share() < 1.0 - kMinShare && neck.weight > 0.0; }
};

Crown crownOf(const TriangleMesh& outer, const std::vector<std::uint8_t>& isEnamel, const geometry::MeshEdges& edges) {
    Crown crown;
    for (std::size_t i = 0; i < outer.triangles.size(); ++i) {
        const geometry::Triangle& t = outer.triangles[i];
        const Vec3 &a = outer.vertices[t[0]], &b = outer.vertices[t[1]], &c = outer.vertices[t[2]];
        (isEnamel[i] ? crown.enamel : crown.rest).add((a + b + c) / 3.0, 0.5 * (b - a).cross(c - a).norm());
    }
    for (const auto& e : edges.edges()) {
        const auto halves = edges.halfEdges(e);
        if (halves.size() != 2 || isEnamel[halves[0] / 3] == isEnamel[halves[1] / 3]) continue;
        const Vec3 &a = outer.vertices[e.low], &b = outer.vertices[e.high];
        crown.neck.add(0.5 * (a + b), (b - a).norm());
    }
    crown.enamel.finish();
    crown.rest.finish();
    crown.neck.finish();
    return crown;
}

/// How much of the enamel lies above the neck and of the rest below: 0.5 no order at all, 1 all.
double orderAlong(const TriangleMesh& outer, const std::vector<std::uint8_t>& isEnamel, const Vec3& occlusal,
                  double neckAt) {
    double right = 0.0, all = 0.0;
    for (std::size_t i = 0; i < outer.triangles.size(); ++i) {
        const geometry::Triangle& t = outer.triangles[i];
        const Vec3 &a = outer.vertices[t[0]], &b = outer.vertices[t[1]], &c = outer.vertices[t[2]];
        const double area = (b - a).cross(c - a).norm();
        all += area;
        if (((a + b + c).dot(occlusal) / 3.0 > neckAt) == (isEnamel[i] != 0)) right += area;
    }
    return all > 0.0 ? right / all : 0.5;
}

/// True where a crown is longer from mesial to distal than from buccal to lingual, after Wheeler's mean sizes [R]:
/// upper incisors and lower molars; milk molars too.
bool isLongerMesially(int fdi) {
    const int quadrant = fdi / 10, place = fdi % 10;
    if (fdi == 0) return true;
    const bool isMilk = quadrant >= 5, isUpper = quadrant == 1 || quadrant == 2 || quadrant == 5 || quadrant == 6;
    if (isMilk) return place != 3 && !(isUpper && place >= 4);
    if (place <= 2) return isUpper;
    return place >= 6 && !isUpper;
}

Vec3 perpendicular(const Vec3& v, const Vec3& to) {
    return v - v.dot(to) * to;
}

/// The longer direction of the crown seen along the axis, and how much longer it is.
struct Longer {
    Vec3 direction;
    double ratio = 1.0;
};
Longer longerSide(const TriangleMesh& outer, const Vec3& occlusal, double fromHeight) {
    const Vec3 u = occlusal.unitOrthogonal(), v = occlusal.cross(u);
    Moments m;
    for (const geometry::Triangle& t : outer.triangles) {
        const Vec3 &a = outer.vertices[t[0]], &b = outer.vertices[t[1]], &c = outer.vertices[t[2]];
        const Vec3 p = (a + b + c) / 3.0;
        if (p.dot(occlusal) > fromHeight) m.add(Vec3(p.dot(u), p.dot(v), 0.0), (b - a).cross(c - a).norm());
    }
    m.finish();
    const Axes axes = principalAxes(m.covariance);
    const Vec3 direction = axes.vectors(0, 0) * u + axes.vectors(1, 0) * v;
    return {direction.normalized(), std::sqrt(axes.spread[0] / std::max(axes.spread[1], 1e-12))};
}

Vec3 unit(const Vec3& v, const char* what) {
    if (!v.allFinite() || !(v.norm() > 1e-9))
        throw core::Error(fmt::format("the direction {} is none", what), "placing", "give three numbers, not all zero");
    return v.normalized();
}

}  // namespace

Placed place(const surfacing::Surfaces& surfaces, const Hints& hints) {
    const TriangleMesh& outer = surfaces.outer.mesh;
    if (outer.triangles.empty())
        throw core::Error("there is no surface to place", "placing", "check the segmentation: it found no tooth");
    Placed placed;
    const Moments whole = volumeMoments(outer);
    const Axes axes = principalAxes(whole.covariance);

    const auto dentine = std::find_if(surfaces.tissues.begin(), surfaces.tissues.end(), [](const auto& s) {
        return s.tissue == cases::Tissue::dentine && !s.mesh.triangles.empty();
    });
    std::vector<std::uint8_t> isEnamel;
    Crown crown;
    TriangleMesh seen = outer;
    if (dentine != surfaces.tissues.end()) {
        if (outer.triangles.size() > kManyFaces) seen = thinned(outer);
        const geometry::MeshEdges edges(seen);
        isEnamel = enamelOf(seen, dentine->mesh);
        keepLargest(isEnamel, seen, edges);
        crown = crownOf(seen, isEnamel, edges);
    }

    Vec3 occlusal;
    double confidence = 1.0;
    if (hints.occlusal) {
        occlusal = unit(*hints.occlusal, "to the occlusal surface");
    } else if (crown.isFound()) {
        const Vec3 towards = (crown.enamel.mean - crown.rest.mean).normalized();
        // The long axis of the whole; a stump or a crown alone has none, then the plane of the neck decides.
        int nearest = 0;
        for (int i = 1; i < 3; ++i)
            if (std::abs(axes.vectors.col(i).dot(towards)) > std::abs(axes.vectors.col(nearest).dot(towards)))
                nearest = i;
        const bool isLong = nearest == 0 && axes.spread[0] > 1.5 * axes.spread[1];
        occlusal = isLong ? Vec3(axes.vectors.col(0)) : Vec3(principalAxes(crown.neck.covariance).vectors.col(2));
        if (occlusal.dot(towards) < 0.0) occlusal = -occlusal;
        if (!isLong) placed.notes.emplace_back("the tooth has no clear long axis: the plane of its cervix was taken");
        confidence = std::clamp(occlusal.dot(towards), 0.0, 1.0);
    } else {
        occlusal = axes.vectors.col(0);
        // The roots' end is the thin one.
        if (volumeSkew(outer, whole.mean, occlusal) > 0.0) occlusal = -occlusal;
        const double length = std::sqrt(axes.spread[0] / std::max(axes.spread[1], 1e-9));
        confidence = std::clamp(0.4 * (length - 1.0), 0.0, 0.4);
        placed.notes.emplace_back(
            "no boundary between enamel and root was found: the crown was guessed from the shape alone; check that it "
            "points up");
    }
    double neckAt = 0.0;
    Vec3 centre;
    if (crown.isFound()) {
        neckAt = crown.neck.mean.dot(occlusal);
        centre = crown.neck.mean;
        if (!hints.occlusal)
            confidence *= std::clamp(2.0 * orderAlong(seen, isEnamel, occlusal, neckAt) - 1.0, 0.0, 1.0);
    } else {
        double low = 1e300, high = -1e300;
        for (const Vec3& p : outer.vertices) {
            low = std::min(low, p.dot(occlusal));
            high = std::max(high, p.dot(occlusal));
        }
        // Crowns are about two fifths of a tooth's length.
        neckAt = high - 0.4 * (high - low);
        centre = whole.mean;
        placed.notes.emplace_back("the cervix was put at three fifths of the length: z = 0 is a guess");
    }
    placed.confidence = confidence;
    if (confidence < 0.6)
        placed.notes.emplace_back(
            fmt::format("the direction of the occlusal surface is uncertain (confidence {:.2f})", confidence));

    Vec3 mesial;
    if (hints.mesial) {
        const Vec3 hinted = unit(*hints.mesial, "to mesial");
        if (std::abs(hinted.dot(occlusal)) > kParallel)
            throw core::Error("mesial and occlusal point the same way", "placing",
                              "give a direction to mesial that lies across the tooth");
        mesial = perpendicular(hinted, occlusal).normalized();
        placed.isMesialGuessed = false;
    } else {
        const Longer longer = longerSide(outer, occlusal, neckAt);
        const bool isAlong = isLongerMesially(hints.fdiNumber);
        mesial = isAlong ? longer.direction : Vec3(occlusal.cross(longer.direction));
        // Either end is as likely; the scanner's axes decide, so that the same tooth always comes out alike.
        Eigen::Index most = 0;
        mesial.cwiseAbs().maxCoeff(&most);
        if (mesial[most] < 0.0) mesial = -mesial;
        placed.notes.emplace_back(fmt::format(
            "mesial is a guess by the crown's {} side (spread {:.0f} % wider than the other): turn the tooth by "
            "hand where it "
            "matters",
            isAlong ? "longer" : "shorter", 100.0 * (longer.ratio - 1.0)));
    }
    Mat3 toTooth;
    toTooth.row(0) = mesial;
    toTooth.row(1) = occlusal.cross(mesial);
    toTooth.row(2) = occlusal;
    placed.scanInTooth.orientation = core::Quat(toTooth).normalized();
    Vec3 origin = perpendicular(centre, occlusal) + neckAt * occlusal;
    placed.scanInTooth.positionMm = -(placed.scanInTooth.orientation * origin);
    return placed;
}

}  // namespace handpiece::registration
