// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/scan_work.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>

#include "handpiece/assess/preparation/preparation.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/scan/registration/registration.h"

namespace handpiece::assessment {
namespace {

namespace fs = std::filesystem;
using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;

constexpr double kLeastOverlap = 0.25;  ///< of the scan that is uncut: a crown preparation leaves little
constexpr double kStrangeMm = 1.0;      ///< so far outside the whole tooth it is gingiva or another tooth
constexpr double kAroundZoneMm = 0.3;   ///< nothing this near to where may be cut is registered on
constexpr double kSmoothMm = 0.2;       ///< reach of the filter against the scanner's noise
constexpr int kSmoothRounds = 3;
constexpr double kSeedMm = 0.1;       ///< at least so deep under the whole tooth something was cut
constexpr double kBesideMm = 0.2;     ///< of cut surface the margin may lie so far
constexpr double kLeastCutMm2 = 0.1;  ///< less is a speck of the scan

constexpr const char* kRemedy =
    "scan the tooth of this exercise, cut away gingiva, base and other teeth, and give the file's unit with --unit";

[[noreturn]] void refuse(const std::string& problem, const std::string& where) {
    throw core::Error(problem, where, kRemedy);
}

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

/// A third of the area of the faces about each vertex.
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

/// Signed distance of each vertex to the whole tooth, negative in it [mm].
std::vector<double> distancesTo(const TriangleTree& whole, const TriangleMesh& mesh) {
    std::vector<double> distances(mesh.vertices.size());
    core::parallelFor(distances.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            distances[i] = whole.signedDistance(mesh.vertices[i]);
    });
    return distances;
}

/// Vertices by cell, for neighbours within a reach.
class Cells {
  public:
    Cells(const std::vector<Vec3>& points, double mm) : points_(points), mm_(mm) {
        for (std::uint32_t i = 0; i < points.size(); ++i)
            cells_[keyOf(cellOf(points[i]))].push_back(i);
    }
    template <class Visit>
    void around(const Vec3& p, const Visit& visit) const {
        const std::array<std::int64_t, 3> c = cellOf(p);
        for (std::int64_t z = c[2] - 1; z <= c[2] + 1; ++z)
            for (std::int64_t y = c[1] - 1; y <= c[1] + 1; ++y)
                for (std::int64_t x = c[0] - 1; x <= c[0] + 1; ++x)
                    if (const auto at = cells_.find(keyOf({x, y, z})); at != cells_.end())
                        for (const std::uint32_t i : at->second)
                            if ((points_[i] - p).squaredNorm() < mm_ * mm_) visit(i);
    }

  private:
    [[nodiscard]] std::array<std::int64_t, 3> cellOf(const Vec3& p) const {
        return {static_cast<std::int64_t>(std::floor(p.x() / mm_)), static_cast<std::int64_t>(std::floor(p.y() / mm_)),
                static_cast<std::int64_t>(std::floor(p.z() / mm_))};
    }
    static std::int64_t keyOf(const std::array<std::int64_t, 3>& c) {
        constexpr std::int64_t kHalf = 1 << 20;
        return ((c[0] + kHalf) << 42) ^ ((c[1] + kHalf) << 21) ^ (c[2] + kHalf);
    }
    const std::vector<Vec3>& points_;
    double mm_;
    std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;
};

double biweight(double t) {
    return t < 1.0 ? (1.0 - t * t) * (1.0 - t * t) : 0.0;
}
Vec3 unit(const Vec3& n) {
    return n.norm() > 1e-300 ? Vec3(n.normalized()) : Vec3(Vec3::Zero());
}

/// Twice the area long, of each face.
std::vector<Vec3> faceNormals(const TriangleMesh& mesh) {
    std::vector<Vec3> normals;
    normals.reserve(mesh.triangles.size());
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3& a = mesh.vertices[t[0]];
        normals.push_back((mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a));
    }
    return normals;
}

/// Unit normals of vertices, from all that lies within reach and looks about the same way: across an edge the mean
/// would be of neither side.
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

/// Faces that noise has turned against what lies around them.
std::vector<char> foldedFaces(const TriangleMesh& mesh, const std::vector<Vec3>& faces, const std::vector<Vec3>& even) {
    std::vector<char> folded(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const geometry::Triangle& t = mesh.triangles[f];
        folded[f] = unit(faces[f]).dot(unit(even[t[0]] + even[t[1]] + even[t[2]])) < 0.3;
    }
    return folded;
}

/// Noise taken off along the normals, edges left: a bilateral filter (Fleishman, Drori & Cohen-Or 2003) whose two
/// weights are biweights instead of Gaussians. What stands off by more than 3.5 times the noise is shape. Vertices of
/// folded faces also go along the surface, between their neighbours.
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

/// Root of the mean square, by area, of those asked for.
struct Spread {
    double rmsMm = 0.0, areaMm2 = 0.0;
};
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

/// Vertices of cut surface: pieces that lie deep enough, and what hangs on them that is deeper than `growMm`.
std::vector<char> cutVertices(const TriangleMesh& mesh, const std::vector<double>& distances,
                              const std::vector<double>& areas, double growMm) {
    const std::size_t n = mesh.vertices.size();
    const double seedMm = std::max(kSeedMm, 2.0 * growMm);
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

/// What a scan shows as gone: how far a place lies from it, negative in it.
class Removed {
  public:
    /// Beside a cut the surface counts where it is deeper than `growMm`, farther off nowhere.
    Removed(const TriangleMesh& mesh, const std::vector<char>& cut, const TriangleTree& whole, double growMm)
        : tree_(mesh), whole_(whole), growMm_(growMm) {
        TriangleMesh rim{mesh.vertices, {}};
        const geometry::MeshEdges edges(mesh);
        for (const auto& e : edges.edges())
            if (e.count != 2) rim.triangles.push_back({e.low, e.high, e.high});
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
    [[nodiscard]] double operator()(const Vec3& p) const {
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

  private:
    /// By the parity of meetings along most of seven ways up, where even an open crown has no border. A fold is met
    /// twice more.
    [[nodiscard]] bool isInside(const Vec3& p) const {
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

    TriangleTree tree_;
    std::unique_ptr<TriangleTree> rim_, cut_, beside_, folded_;
    std::vector<Vec3> even_;  ///< by face
    const TriangleTree& whole_;
    double growMm_;
};

registration::Registered registered(const TriangleMesh& scan, const TriangleMesh& whole,
                                    const registration::RegisterSettings& settings, const std::string& where,
                                    const core::Progress& progress) {
    try {
        return registration::registerOnto(scan, whole, settings, progress);
    } catch (const core::Error& error) {
        if (error.problem() == "cancelled") throw;
        refuse("this scan does not fit the exercise's tooth: " + error.problem(), where);
    }
}

}  // namespace

bool isScan(const fs::path& path) {
    const geometry::MeshFormat format = geometry::meshFormatOf(path);
    return format == geometry::MeshFormat::stl || format == geometry::MeshFormat::ply;
}

Work readScan(const fs::path& path, const tasks::Task& task, double mmPerUnit, const core::Progress& progress) {
    TriangleMesh mesh = geometry::scaled(geometry::readMesh(path), mmPerUnit);
    const geometry::UnitGuess guess = geometry::probableUnit(mesh.bounds().size().norm());
    if (guess.unit != geometry::LengthUnit::millimetre)
        throw core::Error(fmt::format("this scan is {:.3g} mm large, which is no tooth{}", mesh.bounds().size().norm(),
                                      guess.unit == geometry::LengthUnit::unknown
                                          ? std::string()
                                          : fmt::format("; it looks like {}", geometry::unitName(guess.unit))),
                          path.string(), "give the unit of the file with --unit: mm, cm, m, inch or um");
    return workOfScan(std::move(mesh), task, path.string(), progress);
}

Work workOfScan(TriangleMesh mesh, const tasks::Task& task, const std::string& where, const core::Progress& progress) {
    geometry::requireValidIndices(mesh, where);
    mesh = kept(mesh, std::vector<char>(mesh.triangles.size(), 1));
    if (mesh.triangles.empty()) refuse("this scan has no surface", where);

    tooth::LoadSettings settings;
    settings.field.voxelMm = task.voxelMm;
    const std::shared_ptr<const tooth::ToothModel> whole =
        tooth::loadModel(task.toothCase, settings, core::part(progress, 0.0, 0.3));
    std::optional<preparation::Laid> laid;
    if (task.preparation) laid = preparation::layOn(task.toothCase, *task.preparation);
    const auto mayBeCut = [&](const Vec3& p) { return laid && laid->zones->allowedMm(p) < kAroundZoneMm; };

    // Roughly by all of it; what is cut is left behind by the trimming.
    const registration::Registered roughly =
        registered(mesh, whole->outer, {{}, kLeastOverlap}, where, core::part(progress, 0.3, 0.6));
    mesh = geometry::transformed(std::move(mesh), roughly.movingInFixed);
    {
        const std::vector<double> far = distancesTo(whole->tree, mesh);
        std::vector<char> keep(mesh.triangles.size());
        for (std::size_t f = 0; f < keep.size(); ++f) {
            const geometry::Triangle& t = mesh.triangles[f];
            keep[f] = far[t[0]] < kStrangeMm && far[t[1]] < kStrangeMm && far[t[2]] < kStrangeMm;
        }
        const double before = geometry::surfaceAreaMm2(mesh);
        mesh = kept(mesh, keep);
        const double share = before > 0.0 ? geometry::surfaceAreaMm2(mesh) / before : 0.0;
        if (share < 0.5)
            refuse(fmt::format("{:.0f} % of this scan lie {:g} mm and more outside of the exercise's tooth",
                               100.0 * (1.0 - share), kStrangeMm),
                   where);
    }
    // Exactly by what was not cut.
    const auto isUncut = [&](const Vec3& p, double distance) { return std::abs(distance) < kFarOffMm && !mayBeCut(p); };
    {
        const std::vector<double> far = distancesTo(whole->tree, mesh);
        std::vector<char> uncut(mesh.vertices.size()), keep(mesh.triangles.size());
        for (std::size_t i = 0; i < uncut.size(); ++i)
            uncut[i] = isUncut(mesh.vertices[i], far[i]);
        for (std::size_t f = 0; f < keep.size(); ++f)
            keep[f] = uncut[mesh.triangles[f][0]] && uncut[mesh.triangles[f][1]] && uncut[mesh.triangles[f][2]];
        const TriangleMesh rest = kept(mesh, keep);
        if (const double area = geometry::surfaceAreaMm2(rest); area < kLeastUncutMm2)
            refuse(
                fmt::format("only {:.0f} mm2 of this scan are uncut surface of the exercise's tooth; {:.0f} are needed "
                            "to register on",
                            area, kLeastUncutMm2),
                where);
        const registration::Registered exact =
            registered(rest, whole->outer, {core::Pose{}, 0.9}, where, core::part(progress, 0.6, 0.75));
        mesh = geometry::transformed(std::move(mesh), exact.movingInFixed);
    }

    std::vector<double> far = distancesTo(whole->tree, mesh), areas = vertexAreas(mesh);
    double all = 0.0, outside = 0.0, elsewhere = 0.0, stray = 0.0;
    Vec3 worst = Vec3::Zero();
    double worstMm = 0.0;
    std::vector<char> uncut(mesh.vertices.size());
    for (std::size_t i = 0; i < far.size(); ++i) {
        const bool isInZone = mayBeCut(mesh.vertices[i]);
        all += areas[i];
        if (far[i] > kFarOffMm) outside += areas[i];
        if (!isInZone) {
            elsewhere += areas[i];
            if (far[i] < -kFarOffMm) stray += areas[i];
        }
        if (far[i] > worstMm) {
            worstMm = far[i];
            worst = mesh.vertices[i];
        }
        uncut[i] = !isInZone && std::abs(far[i]) < kFarOffMm;
    }
    Spread rest = spreadOf(far, areas, uncut);
    const std::string at = fmt::format(" (rms {:.3f} mm over {:.0f} mm2 of uncut surface)", rest.rmsMm, rest.areaMm2);
    if (outside > kMostOutsideShare * all)
        refuse(
            fmt::format("this scan does not fit the exercise's tooth: {:.0f} % of it lie more than {:g} mm outside of "
                        "it, farthest {:.2f} mm at x {:.1f}, y {:.1f}, z {:.1f}; {:.0f} % are the most{}",
                        100.0 * outside / all, kFarOffMm, worstMm, worst.x(), worst.y(), worst.z(),
                        100.0 * kMostOutsideShare, at),
            where);
    if (laid && stray > kMostStrayCutShare * elsewhere)
        refuse(
            fmt::format("this scan does not fit the exercise's tooth: {:.0f} % of what the exercise leaves uncut lie "
                        "more than {:g} mm under it; {:.0f} % are the most{}",
                        100.0 * stray / elsewhere, kFarOffMm, 100.0 * kMostStrayCutShare, at),
            where);
    if (rest.rmsMm > kMostScanRmsMm)
        refuse(fmt::format("this scan does not fit the exercise's tooth{}; {:g} mm are the most", at, kMostScanRmsMm),
               where);

    score::ScanFit fit;
    fit.rmsMm = rest.rmsMm;
    fit.uncutMm2 = rest.areaMm2;
    mesh = smoothed(std::move(mesh), rest.rmsMm);
    far = distancesTo(whole->tree, mesh);
    fit.noiseMm = spreadOf(far, areas, uncut).rmsMm;
    fit.voxelMm = task.voxelMm;
    const double growMm = 2.0 * fit.rmsMm;
    const std::vector<char> cut = cutVertices(mesh, far, areas, growMm);
    core::Box box;
    for (std::size_t i = 0; i < cut.size(); ++i) {
        if (!cut[i]) continue;
        fit.cutMm2 += areas[i];
        box.extend(mesh.vertices[i]);
        // What is gone lies between the two surfaces.
        box.extend(whole->tree.nearest(mesh.vertices[i]).pointMm);
    }
    Work work;
    work.teeth = {whole};
    if (!box.isEmpty()) {
        const auto removed = std::make_shared<const Removed>(mesh, cut, whole->tree, growMm);
        const zones::Zones gone(
            [removed](const Vec3& p) {
                return zones::PastTarget{(*removed)(p), -zones::kFarMm};
            },
            box.grown(0.3), {});
        work.state = zones::idealState(gone, whole);
    }
    work.noHand = "a scan says nothing of the hand";
    work.proof = fmt::format(
        "a scan, registered on {:.0f} mm2 of uncut surface, rms {:.3f} mm: it says what the tooth is like, not how it "
        "came to be so",
        fit.uncutMm2, fit.rmsMm);
    work.context.device = "scan";
    work.scan = fit;
    core::report(progress, 1.0);
    return work;
}

namespace {

/// How a kind takes up the scan's error.
enum class Takes {
    mean,
    floor,
    extreme,
    spread,
    slope,
    shortSlope,
    roughness,
    volume,
    share,
    widthShare,
    area,
    pulp,
    ridge
};
struct TakesRow {
    std::string_view kind;
    Takes takes;
};
constexpr TakesRow kTakes[] = {
    {"axial-depth", Takes::floor},
    {"caries-left", Takes::volume},
    {"caries-left-periphery", Takes::volume},
    {"caries-left-pulpal", Takes::volume},
    {"cavosurface-angle", Takes::shortSlope},
    {"floor-depth", Takes::floor},
    {"floor-depth-shortest", Takes::floor},
    {"floor-flatness", Takes::spread},
    {"floor-tilt", Takes::slope},
    {"gouge-depth", Takes::extreme},
    {"isthmus", Takes::extreme},
    {"isthmus-share", Takes::widthShare},
    {"margin-continuity", Takes::share},
    {"margin-height", Takes::mean},
    {"margin-width", Takes::mean},
    {"marginal-ridge-left", Takes::ridge},
    {"occlusal-convergence", Takes::slope},
    {"outline-extent", Takes::extreme},
    {"proximal-clearance", Takes::extreme},
    {"pulp-exposed", Takes::pulp},
    {"reduction", Takes::mean},
    {"remaining-dentine", Takes::extreme},
    {"removed", Takes::volume},
    {"removed-share", Takes::share},
    {"roughness", Takes::roughness},
    {"undercut-area", Takes::area},
    {"undercut-depth", Takes::extreme},
    {"unsupported-enamel", Takes::volume},
    {"wall-angle", Takes::slope},
    {"wall-height", Takes::mean},
};

}  // namespace

double widened(const measures::Measured& m, const score::ScanFit& scan, std::optional<double> overPulpMm) {
    constexpr double kDegrees = 57.295779513082321;
    const auto row =
        std::find_if(std::begin(kTakes), std::end(kTakes), [&](const TakesRow& one) { return one.kind == m.kind; });
    if (row == std::end(kTakes)) return m.uncertainty;
    // Where the tooth lies is known by as many places as there are square millimetres of uncut surface; a square
    // millimetre's unevenness is one draw. The field made of the scan adds a tenth of a voxel at edges.
    const double lies = scan.rmsMm / std::sqrt(std::max(1.0, scan.uncutMm2)) + 0.1 * scan.voxelMm;
    const double noise = scan.noiseMm;
    const bool isExtreme =
        m.of.statistic == "least" || m.of.statistic == "greatest" || m.of.statistic == "p5" || m.of.statistic == "p95";
    // Of a mean over four patches; of the one that stands out most.
    const double mean = core::hypot(2.0 * lies, noise), extreme = core::hypot(2.0 * lies, 5.0 * noise);
    double more = 0.0;
    switch (row->takes) {
        case Takes::mean:
            more = isExtreme ? extreme : mean;
            break;
        case Takes::floor:  // where it ends is less sure, and what lies over it is not level
            more = isExtreme ? extreme : mean + 0.25 * scan.voxelMm;
            break;
        case Takes::extreme:
            more = extreme;
            break;
        case Takes::spread:
            more = 4.0 * noise + 2.0 * lies;
            break;
        case Takes::slope:  // over a millimetre
            more = kDegrees * (isExtreme ? extreme : mean);
            break;
        case Takes::shortSlope:  // over 0.3 mm
            more = kDegrees * mean / 0.3;
            break;
        case Takes::roughness:
            more = 2e3 * noise;
            break;
        case Takes::volume:
            more = scan.cutMm2 * mean;
            break;
        case Takes::share:  // as deep as a millimetre
            more = 100.0 * mean;
            break;
        case Takes::widthShare:
            more = std::abs(*m.value) * extreme;
            break;
        case Takes::area:
            more = std::sqrt(scan.cutMm2) * extreme;
            break;
        case Takes::ridge:  // noise lets another slope of a groove count for the ridge: 3 of 12 scans, worst 1.04 mm
            more = extreme + 1.05;
            break;
        case Takes::pulp:  // none where the pulp lies surely under the surface
            if (!overPulpMm || *overPulpMm <= extreme) more = std::sqrt(scan.cutMm2) * extreme;
            break;
    }
    return m.uncertainty + more;
}

}  // namespace handpiece::assessment
