// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/scan_work/fit_scan.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/scan/registration/registration.h"

namespace handpiece::scan_work {
namespace {

constexpr double kLeastOverlap = 0.25;   ///< of the scan that is uncut: a crown preparation leaves little
constexpr double kStrangeMm = 1.0;       ///< so far outside of every tooth it is gingiva, base or another tooth
constexpr double kAroundZoneMm = 0.3;    ///< nothing this near to where may be cut is registered on
constexpr double kStandsBesideMm = 1.0;  ///< so near a tooth stands beside it
constexpr double kMostLooseMm = 0.02;    ///< what holds the tooth worse needs the teeth beside it
constexpr double kMostStrangeShare = 0.8;
constexpr double kMostNearShare = 0.3;  ///< outside of the tooth, gingiva that hangs on it included
constexpr int kExactRounds = 2;

constexpr const char* kRemedy =
    "scan the tooth of this exercise, cut away base and teeth that the case has not, give the file's unit with --unit, "
    "and where little of the tooth is left uncut scan the teeth beside it too or give an earlier scan with --before";

double areaOf(const std::vector<double>& areas, const std::vector<char>& asked) {
    double sum = 0.0;
    for (std::size_t i = 0; i < areas.size(); ++i)
        if (asked[i]) sum += areas[i];
    return sum;
}

/// Unsigned distances, `farMm` where there is nothing nearer.
std::vector<double> near(const TriangleTree* surface, const TriangleMesh& mesh, double farMm) {
    std::vector<double> distances(mesh.vertices.size(), farMm);
    if (surface == nullptr) return distances;
    core::parallelFor(distances.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const geometry::NearestPoint n = surface->nearest(mesh.vertices[i], farMm);
            if (n.triangle != geometry::kNoTriangle) distances[i] = n.distanceMm;
        }
    });
    return distances;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh both = a;
    const auto first = static_cast<std::uint32_t>(a.vertices.size());
    both.vertices.insert(both.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const geometry::Triangle& t : b.triangles)
        both.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    return both;
}

/// The vertices of a scan in its place, and what they lie on.
struct Places {
    std::vector<double> toTooth, toOthers, areas;
    Places(const TriangleMesh& mesh, const Scene& scene)
        : toTooth(distancesTo(scene.whole.tree, mesh)),
          toOthers(near(scene.beside.get(), mesh, 2.0)),
          areas(vertexAreas(mesh)) {}
    /// Outside of the tooth and nearer to another.
    [[nodiscard]] bool isBeside(std::size_t i) const {
        return toTooth[i] > 0.0 && toOthers[i] < std::min(toTooth[i], kStrangeMm);
    }
};

/// Share of a scan that lies on some surface that is known.
double explained(const TriangleMesh& mesh, const Scene& scene) {
    const Places p(mesh, scene);
    double all = 0.0, on = 0.0;
    for (std::size_t i = 0; i < p.areas.size(); ++i) {
        all += p.areas[i];
        if (std::min(std::abs(p.toTooth[i]), p.toOthers[i]) < kFarOffMm) on += p.areas[i];
    }
    return all > 0.0 ? on / all : 0.0;
}

/// Roughly by all of it, on the tooth alone and on it with those beside: what explains more of the scan.
std::optional<core::Pose> roughly(const TriangleMesh& scan, const Scene& scene, std::string& problem,
                                  const core::Progress& progress) {
    constexpr double kEnough = 0.85;
    std::optional<core::Pose> best;
    double most = 0.0;
    const auto attempt = [&](const TriangleMesh& onto, const core::Progress& share) {
        try {
            const core::Pose pose = registration::registerOnto(scan, onto, {{}, kLeastOverlap}, share).movingInFixed;
            const double found = explained(geometry::transformed(scan, pose), scene);
            if (found > most) {
                most = found;
                best = pose;
            }
        } catch (const core::Error& error) {
            if (error.problem() == "cancelled") throw;
            if (problem.empty()) problem = error.problem();
        }
    };
    attempt(scene.whole.outer, core::part(progress, 0.0, 0.5));
    if (scene.beside && most < kEnough)
        attempt(joined(scene.whole.outer, scene.others), core::part(progress, 0.5, 1.0));
    return best;
}

/// Moves a scan by what of it is asked, onto a surface.
void moveExactly(TriangleMesh& scan, const std::vector<char>& asked, const TriangleMesh& onto, const Scene& scene,
                 const core::Progress& progress) {
    try {
        const registration::Registered exact =
            registration::registerOnto(keptVertices(scan, asked), onto, {core::Pose{}, 0.9}, progress);
        scan = geometry::transformed(std::move(scan), exact.movingInFixed);
    } catch (const core::Error& error) {
        if (error.problem() == "cancelled") throw;
        scene.refuse("this scan does not fit the exercise's tooth: " + error.problem());
    }
}

Hold holdOn(const TriangleMesh& scan, const std::vector<char>& asked, const std::vector<double>& areas, double rmsMm,
            const Vec3& about) {
    const std::vector<Vec3> faces = faceNormals(scan);
    const std::vector<Vec3> even = evenNormals(scan, faces, Cells(scan.vertices, kSmoothMm));
    std::vector<Vec3> points, normals;
    std::vector<double> mm2;
    for (std::size_t i = 0; i < asked.size(); ++i)
        if (asked[i]) {
            points.push_back(scan.vertices[i]);
            normals.push_back(even[i]);
            mm2.push_back(areas[i]);
        }
    return holdOf(points, normals, mm2, rmsMm, about);
}

/// The scan moved into its place, and what held it there.
struct Placed {
    TriangleMesh scan;
    score::RegisteredOn on = score::RegisteredOn::uncutSurface;
    Spread rest;
    Hold hold;
};

/// Where what may be cut lies, as seen from what holds it.
Vec3 middleOfWork(const Scene& scene) {
    if (scene.laid) return scene.laid->zones->box().centre();
    Vec3 middle = scene.whole.outer.bounds().centre();
    middle.z() = 0.7 * scene.whole.outer.bounds().max.z();
    return middle;
}

Placed placed(TriangleMesh scan, const Scene& scene, bool isUncutAtAll, const core::Progress& progress) {
    Placed result;
    std::string problem;
    const auto refuseMirrored = [&] {
        // A mirrored file fits when it is mirrored once more: that is worth saying.
        TriangleMesh mirrored = turned(scan);
        for (Vec3& v : mirrored.vertices)
            v.x() = -v.x();
        std::string ignored;
        const std::optional<core::Pose> pose = roughly(mirrored, scene, ignored, core::Progress{});
        if (pose && explained(geometry::transformed(mirrored, *pose), scene) > 0.6)
            scene.refuse("this scan is mirrored: it fits the exercise's tooth when left and right are exchanged");
    };
    std::optional<core::Pose> pose = roughly(scan, scene, problem, core::part(progress, 0.0, 0.6));
    constexpr double kDoubtful = 0.5;  // explained less, it may be inside out: an open plate's shape does not tell
    if (!pose || explained(geometry::transformed(scan, *pose), scene) < kDoubtful) {
        const TriangleMesh other = turned(scan);
        std::string ignored;
        const std::optional<core::Pose> turnedPose = roughly(other, scene, ignored, core::part(progress, 0.6, 0.8));
        const auto share = [&](const TriangleMesh& mesh, const std::optional<core::Pose>& p) {
            return p ? explained(geometry::transformed(mesh, *p), scene) : 0.0;
        };
        if (share(other, turnedPose) > share(scan, pose) + 0.05) {
            scan = other;
            pose = turnedPose;
        }
    }
    if (!pose) {
        refuseMirrored();
        scene.refuse("this scan does not fit the exercise's tooth: " + problem);
    }
    const TriangleMesh asRead = scan;
    scan = geometry::transformed(std::move(scan), *pose);
    const Vec3 about = middleOfWork(scene);
    double area = 0.0;
    for (int round = 0; round < kExactRounds; ++round) {
        const Places p(scan, scene);
        std::vector<char> uncut(p.areas.size()), beside(p.areas.size()), both(p.areas.size());
        for (std::size_t i = 0; i < uncut.size(); ++i) {
            uncut[i] = !p.isBeside(i) && std::abs(p.toTooth[i]) < kFarOffMm &&
                       (isUncutAtAll || !scene.mayBeCut(scan.vertices[i]));
            beside[i] = p.isBeside(i) && p.toOthers[i] < kFarOffMm;
            both[i] = uncut[i] || beside[i];
        }
        area = areaOf(p.areas, uncut);
        result.on = score::RegisteredOn::uncutSurface;
        const double rms = std::max(0.01, spreadOf(p.toTooth, p.areas, uncut).rmsMm);
        if (area < kLeastUncutMm2 || holdOn(scan, uncut, p.areas, rms, about).liesMm > kMostLooseMm) {
            result.on = score::RegisteredOn::adjacentTeeth;
            area = areaOf(p.areas, both);
            if (area < kLeastUncutMm2 || areaOf(p.areas, beside) < 0.5 * kLeastUncutMm2) {
                if (areaOf(p.areas, uncut) < kLeastUncutMm2) {
                    scan = asRead;
                    refuseMirrored();
                    scene.refuse(
                        fmt::format("only {:.0f} mm2 of this scan are uncut surface of the exercise's tooth; {:.0f} "
                                    "are needed to register on",
                                    area, kLeastUncutMm2));
                }
                result.on = score::RegisteredOn::uncutSurface;  // loosely: its hold says how
                area = areaOf(p.areas, uncut);
            }
        }
        const bool withOthers = result.on == score::RegisteredOn::adjacentTeeth;
        moveExactly(scan, withOthers ? both : uncut,
                    withOthers ? joined(scene.whole.outer, scene.others) : scene.whole.outer, scene,
                    core::part(progress, 0.8 + 0.1 * round, 0.9 + 0.1 * round));
        if (round + 1 < kExactRounds) continue;
        const Places now(scan, scene);
        std::vector<char> used(now.areas.size());
        std::vector<double> off(now.areas.size());
        for (std::size_t i = 0; i < used.size(); ++i) {
            const bool on = withOthers && now.isBeside(i);
            off[i] = on ? now.toOthers[i] : now.toTooth[i];
            used[i] = std::abs(off[i]) < kFarOffMm &&
                      (on || (!now.isBeside(i) && (isUncutAtAll || !scene.mayBeCut(scan.vertices[i]))));
        }
        result.rest = spreadOf(off, now.areas, used);
        result.hold = holdOn(scan, used, now.areas, result.rest.rmsMm, about);
    }
    result.scan = std::move(scan);
    return result;
}

/// The scan onto an earlier one that lies in its place: on all that is the same.
Placed placedOn(TriangleMesh scan, const Placed& before, const Scene& scene, const core::Progress& progress) {
    Placed result;
    result.on = score::RegisteredOn::earlierScan;
    try {
        scan = geometry::transformed(std::move(scan), registration::registerOnto(scan, before.scan, {{}, kLeastOverlap},
                                                                                 core::part(progress, 0.0, 0.7))
                                                          .movingInFixed);
    } catch (const core::Error& error) {
        if (error.problem() == "cancelled") throw;
        scene.refuse("this scan does not fit the earlier one: " + error.problem());
    }
    const TriangleTree tree(before.scan);
    const auto same = [&] {
        std::vector<double> off = near(&tree, scan, 2.0);
        std::vector<char> asked(off.size());
        for (std::size_t i = 0; i < off.size(); ++i)
            asked[i] = off[i] < kFarOffMm && !scene.mayBeCut(scan.vertices[i]);
        return std::pair(std::move(off), std::move(asked));
    };
    for (int round = 0; round < kExactRounds; ++round) {
        const std::vector<char> asked = same().second;
        const double area = areaOf(vertexAreas(scan), asked);
        if (area < kLeastUncutMm2)
            scene.refuse(
                fmt::format("only {:.0f} mm2 of this scan are as in the earlier one; {:.0f} are needed to "
                            "register on",
                            area, kLeastUncutMm2));
        moveExactly(scan, asked, before.scan, scene, core::part(progress, 0.7 + 0.15 * round, 0.85 + 0.15 * round));
    }
    const auto [off, asked] = same();
    const std::vector<double> areas = vertexAreas(scan);
    result.rest = spreadOf(off, areas, asked);
    result.hold = holdOn(scan, asked, areas, result.rest.rmsMm, middleOfWork(scene));
    // Two steps to the case's tooth.
    result.hold.liesMm = core::hypot(result.hold.liesMm, before.hold.liesMm);
    result.hold.turnsRad = core::hypot(result.hold.turnsRad, before.hold.turnsRad);
    result.rest.rmsMm = std::max(result.rest.rmsMm, before.rest.rmsMm);
    result.scan = std::move(scan);
    return result;
}

/// What is neither the tooth nor one beside it: far outside of all, and what lies outside of the tooth and hangs on
/// that.
std::vector<char> strangeOf(const TriangleMesh& mesh, const Places& p) {
    std::vector<char> strange(p.areas.size(), 0);
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < strange.size(); ++i)
        if (p.toTooth[i] >= kStrangeMm && !p.isBeside(i)) {
            strange[i] = 1;
            open.push_back(i);
        }
    std::vector<std::vector<std::uint32_t>> next(strange.size());
    const geometry::MeshEdges edges(mesh);
    for (const auto& e : edges.edges()) {
        next[e.low].push_back(e.high);
        next[e.high].push_back(e.low);
    }
    while (!open.empty()) {
        const std::uint32_t i = open.back();
        open.pop_back();
        for (const std::uint32_t j : next[i])
            if (!strange[j] && !p.isBeside(j) && p.toTooth[j] > kFarOffMm) {
                strange[j] = 1;
                open.push_back(j);
            }
    }
    return strange;
}

}  // namespace

Scene::Scene(const tasks::Task& ofTask, const tooth::ToothModel& model, std::string source)
    : task(ofTask), whole(model), where(std::move(source)) {
    if (task.preparation) laid = preparation::layOn(task.toothCase, *task.preparation);
    const core::Box own = whole.outer.bounds().grown(kStandsBesideMm);
    for (std::size_t i = 0; i < task.toothCase.others.size(); ++i) {
        const cases::PlacedTooth& other = task.toothCase.others[i];
        // An antagonist is no part of a scan of this jaw.
        const bool isUpper = other.fdiNumber / 10 <= 2, isOwnUpper = task.toothCase.fdiNumber / 10 <= 2;
        if (other.fdiNumber != 0 && task.toothCase.fdiNumber != 0 && isUpper != isOwnUpper) continue;
        TriangleMesh surface = geometry::transformed(other.surface(), other.inCase);
        const core::Box box = surface.bounds();
        if ((box.min.array() > own.max.array()).any() || (box.max.array() < own.min.array()).any()) continue;
        besides.push_back(i);
        others = joined(others, surface);
    }
    if (!others.triangles.empty()) beside = std::make_unique<const TriangleTree>(others);
}

bool Scene::mayBeCut(const Vec3& p) const {
    return laid && laid->zones->allowedMm(p) < kAroundZoneMm;
}

void Scene::refuse(const std::string& problem) const {
    throw core::Error(problem, where, kRemedy);
}

Hold holdOf(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<double>& mm2,
            double rmsMm, const Vec3& about) {
    Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
        Eigen::Matrix<double, 6, 1> row;
        row << (points[i] - about).cross(normals[i]), normals[i];
        a += mm2[i] * row * row.transpose();
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> factors(a);
    if (factors.info() != Eigen::Success || !(factors.rcond() > 1e-12)) return {};
    const Eigen::Matrix<double, 6, 6> c = rmsMm * rmsMm * factors.solve(Eigen::Matrix<double, 6, 6>::Identity());
    const auto largest = [](const core::Mat3& part) {
        const Eigen::SelfAdjointEigenSolver<core::Mat3> solver(part, Eigen::EigenvaluesOnly);
        return std::sqrt(std::max(0.0, solver.eigenvalues()[2]));
    };
    return {largest(c.bottomRightCorner<3, 3>()), largest(c.topLeftCorner<3, 3>())};
}

Fitted fitted(TriangleMesh scan, const Scene& scene, const TriangleMesh* before, const core::Progress& progress) {
    Placed place;
    if (before != nullptr) {
        const Placed earlier = placed(*before, scene, true, core::part(progress, 0.0, 0.4));
        if (earlier.rest.rmsMm > kMostScanRmsMm)
            scene.refuse(
                fmt::format("the earlier scan does not fit the exercise's tooth (rms {:.3f} mm over {:.0f} "
                            "mm2); {:g} mm are the most",
                            earlier.rest.rmsMm, earlier.rest.areaMm2, kMostScanRmsMm));
        place = placedOn(std::move(scan), earlier, scene, core::part(progress, 0.4, 1.0));
    } else {
        place = placed(std::move(scan), scene, false, progress);
    }
    Fitted result;
    const TriangleMesh& mesh = place.scan;
    const Places all(mesh, scene);
    const std::vector<char> strange = strangeOf(mesh, all);
    double area = 0.0, besideMm2 = 0.0, strangeMm2 = 0.0, nearMm2 = 0.0, outside = 0.0, ofTooth = 0.0, elsewhere = 0.0,
           stray = 0.0, worstMm = 0.0;
    Vec3 worst = Vec3::Zero();
    std::vector<char> isTooth(strange.size());
    for (std::size_t i = 0; i < strange.size(); ++i) {
        area += all.areas[i];
        if (all.isBeside(i)) {
            besideMm2 += all.areas[i];
            continue;
        }
        const double off = all.toTooth[i];
        if (off < kStrangeMm) nearMm2 += off > kFarOffMm ? all.areas[i] : 0.0;
        if (strange[i]) {
            strangeMm2 += all.areas[i];
            continue;
        }
        isTooth[i] = 1;
        ofTooth += all.areas[i];
        if (off > kFarOffMm) outside += all.areas[i];
        if (!scene.mayBeCut(mesh.vertices[i])) {
            elsewhere += all.areas[i];
            if (off < -kFarOffMm) stray += all.areas[i];
        }
        if (off > worstMm) {
            worstMm = off;
            worst = mesh.vertices[i];
        }
    }
    const std::string at =
        fmt::format(" (rms {:.3f} mm over {:.0f} mm2 of {})", place.rest.rmsMm, place.rest.areaMm2, wordsOf(place.on));
    if (strangeMm2 > kMostStrangeShare * (area - besideMm2) || !(ofTooth > 0.0))
        scene.refuse(
            fmt::format("this scan does not fit the exercise's tooth: {:.0f} % of it are neither that tooth "
                        "nor one beside it{}",
                        100.0 * strangeMm2 / std::max(1e-9, area - besideMm2), at));
    if (outside > kMostOutsideShare * ofTooth)
        scene.refuse(
            fmt::format("this scan does not fit the exercise's tooth: {:.0f} % of it lie more than {:g} mm outside of "
                        "it, farthest {:.2f} mm at x {:.1f}, y {:.1f}, z {:.1f}; {:.0f} % are the most{}",
                        100.0 * outside / ofTooth, kFarOffMm, worstMm, worst.x(), worst.y(), worst.z(),
                        100.0 * kMostOutsideShare, at));
    if (nearMm2 > kMostNearShare * (ofTooth + nearMm2))
        scene.refuse(
            fmt::format("this scan does not fit the exercise's tooth: {:.0f} % of what lies near it are {:g} "
                        "to {:g} mm outside of it; {:.0f} % are the most{}",
                        100.0 * nearMm2 / (ofTooth + nearMm2), kFarOffMm, kStrangeMm, 100.0 * kMostNearShare, at));
    // A crown preparation leaves nothing elsewhere but what is under its margin.
    if (scene.laid && elsewhere >= kLeastUncutMm2 && stray > kMostStrayCutShare * elsewhere)
        scene.refuse(
            fmt::format("this scan does not fit the exercise's tooth: {:.0f} % of what the exercise leaves uncut lie "
                        "more than {:g} mm under it; {:.0f} % are the most{}",
                        100.0 * stray / elsewhere, kFarOffMm, 100.0 * kMostStrayCutShare, at));
    if (place.rest.rmsMm > kMostScanRmsMm)
        scene.refuse(
            fmt::format("this scan does not fit the exercise's tooth{}; {:g} mm are the most", at, kMostScanRmsMm));

    result.fit.registeredOn = place.on;
    result.fit.rmsMm = place.rest.rmsMm;
    result.fit.uncutMm2 = place.rest.areaMm2;
    result.fit.liesMm = place.hold.liesMm;
    result.fit.turnsDeg = 57.295779513082321 * place.hold.turnsRad;
    result.fit.voxelMm = scene.task.voxelMm;
    result.tooth = keptVertices(mesh, isTooth);
    const std::vector<double> far = distancesTo(scene.whole.tree, result.tooth);
    for (std::size_t i = 0; i < far.size(); ++i)
        result.uncut.push_back(!scene.mayBeCut(result.tooth.vertices[i]) && std::abs(far[i]) < kFarOffMm);
    // What lies on each tooth beside it: nearer to it than to any other.
    constexpr double kOnMm = 0.5;
    for (const std::size_t number : scene.besides) {
        const cases::PlacedTooth& other = scene.task.toothCase.others[number];
        const TriangleTree tree(geometry::transformed(other.surface(), other.inCase));
        const std::vector<double> off = near(&tree, mesh, kOnMm);
        std::vector<char> on(off.size());
        for (std::size_t i = 0; i < off.size(); ++i)
            on[i] = all.isBeside(i) && off[i] < kOnMm && off[i] <= all.toOthers[i] + 1e-9;
        result.beside.push_back(keptVertices(mesh, on));
    }
    return result;
}

}  // namespace handpiece::scan_work
