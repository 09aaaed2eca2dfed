// SPDX-License-Identifier: Apache-2.0
// One surface of a tooth onto another: features find the place, trimmed point-to-plane ICP makes it exact.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/base/core/split_mix.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/scan/registration/features.h"
#include "handpiece/scan/registration/registration.h"

namespace handpiece::registration {
namespace {

using core::Mat3;
using core::Pose;
using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;

constexpr double kCoarseMm = 0.45, kFineMm = 0.22;  ///< between points
constexpr double kFeatureMm = 2.2;
constexpr std::size_t kCandidatesEach = 12;  ///< counterparts tried for each point
constexpr std::size_t kTrials = 400'000, kTrialBlock = 2000;
constexpr std::size_t kMinPoints = 60;
constexpr double kMaxRmsMm = 0.3;

struct Random {
    std::uint64_t state;
    std::size_t below(std::size_t n) { return static_cast<std::size_t>(core::nextSplitMix(state) % n); }
};

/// The rigid motion that takes points onto others (Kabsch).
Pose motionOf(const std::array<Vec3, 3>& from, const std::array<Vec3, 3>& to) {
    const Vec3 a = (from[0] + from[1] + from[2]) / 3.0, b = (to[0] + to[1] + to[2]) / 3.0;
    Mat3 h = Mat3::Zero();
    for (std::size_t i = 0; i < 3; ++i)
        h += (from[i] - a) * (to[i] - b).transpose();
    const Eigen::JacobiSVD<Mat3> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 r = svd.matrixV() * svd.matrixU().transpose();
    if (r.determinant() < 0.0) {
        Mat3 v = svd.matrixV();
        v.col(2) = -v.col(2);
        r = v * svd.matrixU().transpose();
    }
    Pose pose;
    pose.orientation = core::Quat(r).normalized();
    pose.positionMm = b - pose.orientation * a;
    return pose;
}

/// A surface to register onto.
struct Fixed {
    const TriangleTree& tree;

    struct Meeting {
        Vec3 pointMm, normal;
        double distanceMm;
        bool isFound;
    };
    [[nodiscard]] Meeting meet(const Vec3& p, double boundMm) const {
        const geometry::NearestPoint n = tree.nearest(p, boundMm);
        if (n.triangle == geometry::kNoTriangle) return {p, Vec3::Zero(), boundMm, false};
        const float* v = tree.pseudonormals().data() + (std::size_t{n.triangle} * 7 + n.feature) * 3;
        return {n.pointMm, Vec3(static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])),
                n.distanceMm, true};
    }
};

struct Hypothesis {
    Pose pose;
    double score = 0.0;
    std::size_t order = 0;  ///< ties go to the earlier
};
bool isBetter(const Hypothesis& a, const Hypothesis& b) {
    return a.score != b.score ? a.score > b.score : a.order < b.order;
}

/// Share of every `step`-th point that lies on the surface, near ones counting more; normals must agree.
double scoreOf(const Fixed& fixed, const Points& points, std::size_t step, const Pose& pose, double reachMm) {
    double sum = 0.0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < points.size(); i += step, ++n) {
        const auto m = fixed.meet(pose.apply(points.at[i]), reachMm);
        if (!m.isFound || m.normal.dot(pose.orientation * points.normal[i]) < 0.6) continue;
        const double d = m.distanceMm / reachMm;
        sum += 1.0 - d * d;
    }
    return n > 0 ? sum / static_cast<double>(n) : 0.0;
}

struct Refined {
    Pose pose;
    double sigmaMm = 0.0;  ///< of the best `share`
};

/// Trimmed point-to-plane ICP: the nearest `share` of the points pull, at most those within three standard deviations.
Refined refine(const Fixed& fixed, const Points& points, std::size_t step, Pose pose, double share, int rounds,
               double reachMm, const core::Progress& progress = {}) {
    struct Pull {
        Vec3 at, normal;
        double gap = 0.0, distance = 0.0;
    };
    const std::size_t count = (points.size() + step - 1) / step;
    std::vector<Pull> all(count), pulls;
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : points.at)
        centre += p / static_cast<double>(points.size());
    double sigma = reachMm;
    for (int round = 0; round < rounds; ++round) {
        core::parallelFor(count, 128, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const Vec3 p = pose.apply(points.at[k * step]);
                const auto m = fixed.meet(p, reachMm);
                const bool agrees = m.isFound && m.normal.dot(pose.orientation * points.normal[k * step]) > 0.4;
                all[k] = {p, m.normal, agrees ? m.normal.dot(p - m.pointMm) : 0.0, agrees ? m.distanceMm : 1e300};
            }
        });
        pulls.clear();
        for (const Pull& p : all)
            if (p.distance < 1e300) pulls.push_back(p);
        if (pulls.size() < 12) return {pose, 1e300};
        std::stable_sort(pulls.begin(), pulls.end(),
                         [](const Pull& a, const Pull& b) { return a.distance < b.distance; });
        const std::size_t least =
            std::clamp(static_cast<std::size_t>(share * static_cast<double>(count)), std::size_t{12}, pulls.size());
        double sum = 0.0;
        for (std::size_t i = 0; i < least; ++i)
            sum += pulls[i].gap * pulls[i].gap;
        sigma = std::sqrt(sum / static_cast<double>(least));
        std::size_t used = least;
        while (used < pulls.size() && pulls[used].distance < 3.0 * sigma)
            ++used;
        const Vec3 about = pose.apply(centre);
        Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
        Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
        for (std::size_t i = 0; i < used; ++i) {
            Eigen::Matrix<double, 6, 1> row;
            row << (pulls[i].at - about).cross(pulls[i].normal), pulls[i].normal;
            a += row * row.transpose();
            b -= pulls[i].gap * row;
        }
        // A trace of damping: what slides freely (a ball, a cylinder) stays where it is.
        a.diagonal().array() += 1e-6 * a.trace() / 6.0;
        const Eigen::Matrix<double, 6, 1> x = a.ldlt().solve(b);
        if (!x.allFinite()) return {pose, 1e300};
        const double angle = x.head<3>().norm();
        Pose step1;
        if (angle > 1e-15) step1.orientation = core::rotationAbout(x.head<3>() / angle, std::min(angle, 0.3));
        step1.positionMm = about - step1.orientation * about + x.tail<3>();
        pose = (step1 * pose).normalised();
        core::report(progress, static_cast<double>(round + 1) / rounds);
        if (angle < 1e-7 && x.tail<3>().norm() < 1e-7) break;
    }
    return {pose, sigma};
}

double angleDegrees(const core::Quat& a, const core::Quat& b) {
    return 2.0 * core::acos(std::clamp(std::abs(a.dot(b)), 0.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// The counterparts of each chosen point: the fixed points whose surroundings look most alike.
struct Matches {
    std::vector<std::uint32_t> points;  ///< of `moving`
    std::vector<std::array<std::uint32_t, kCandidatesEach>> counterparts;
};

Matches match(const std::vector<Feature>& moving, const std::vector<Feature>& fixed, const core::Progress& progress) {
    // Those that look least like the average are worth most.
    Feature mean{};
    for (const Feature& f : moving)
        for (std::size_t b = 0; b < f.size(); ++b)
            mean[b] += f[b] / static_cast<float>(moving.size());
    const auto difference = [](const Feature& a, const Feature& b) {
        float sum = 0.0f;
        for (std::size_t i = 0; i < a.size(); ++i)
            sum += (a[i] - b[i]) * (a[i] - b[i]);
        return sum;
    };
    std::vector<std::pair<float, std::uint32_t>> special;
    for (std::uint32_t i = 0; i < moving.size(); ++i)
        special.emplace_back(-difference(moving[i], mean), i);
    std::sort(special.begin(), special.end());
    Matches matches;
    const std::size_t n = std::min(special.size(), std::max<std::size_t>(special.size() / 2, 300));
    for (std::size_t i = 0; i < n; ++i)
        matches.points.push_back(special[i].second);
    std::sort(matches.points.begin(), matches.points.end());
    matches.counterparts.resize(n);
    core::parallelFor(n, 16, [&](std::size_t begin, std::size_t end) {
        std::vector<std::pair<float, std::uint32_t>> found(fixed.size());
        for (std::size_t i = begin; i < end; ++i) {
            for (std::uint32_t j = 0; j < fixed.size(); ++j)
                found[j] = {difference(moving[matches.points[i]], fixed[j]), j};
            std::partial_sort(found.begin(), found.begin() + kCandidatesEach, found.end());
            for (std::size_t k = 0; k < kCandidatesEach; ++k)
                matches.counterparts[i][k] = found[k].second;
        }
        core::report(progress, 0.5);
    });
    return matches;
}

/// Poses that three matched points agree on, the best first; no two nearly alike.
std::vector<Hypothesis> search(const Points& moving, const Points& fixed, const Matches& matches, const Fixed& surface,
                               const core::Progress& progress) {
    core::Box box;
    for (const Vec3& p : moving.at)
        box.extend(p);
    const double leastEdge = std::clamp(0.2 * box.size().norm(), 1.0, 4.0);
    const std::size_t sparse = std::max<std::size_t>(1, moving.size() / 80);
    constexpr std::size_t kKept = 4;  // of each block
    const std::size_t blocks = kTrials / kTrialBlock;
    std::vector<std::vector<Hypothesis>> kept(blocks);
    core::parallelFor(blocks, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) {
            Random random{0x5EED0000ull + block};
            for (std::size_t trial = 0; trial < kTrialBlock; ++trial) {
                std::array<Vec3, 3> from, to, fromNormal, toNormal;
                bool isFit = true;
                for (std::size_t k = 0; k < 3 && isFit; ++k) {
                    const std::size_t i = random.below(matches.points.size());
                    const std::uint32_t j = matches.counterparts[i][random.below(kCandidatesEach)];
                    from[k] = moving.at[matches.points[i]];
                    fromNormal[k] = moving.normal[matches.points[i]];
                    to[k] = fixed.at[j];
                    toNormal[k] = fixed.normal[j];
                    for (std::size_t l = 0; l < k && isFit; ++l) {
                        const double a = (from[k] - from[l]).norm(), b = (to[k] - to[l]).norm();
                        isFit = a > leastEdge && std::abs(a - b) < kCoarseMm + 0.03 * a &&
                                std::abs(fromNormal[k].dot(fromNormal[l]) - toNormal[k].dot(toNormal[l])) < 0.4;
                    }
                }
                if (!isFit) continue;
                const Pose pose = motionOf(from, to);
                for (std::size_t k = 0; k < 3 && isFit; ++k)
                    isFit = (pose.orientation * fromNormal[k]).dot(toNormal[k]) > 0.7;
                if (!isFit) continue;
                const Hypothesis h{pose, scoreOf(surface, moving, sparse, pose, 1.0), block * kTrialBlock + trial};
                std::vector<Hypothesis>& best = kept[block];
                best.insert(std::upper_bound(best.begin(), best.end(), h, isBetter), h);
                if (best.size() > kKept) best.pop_back();
            }
            core::report(progress, static_cast<double>(block) / static_cast<double>(blocks));
        }
    });
    std::vector<Hypothesis> all, distinct;
    for (const auto& some : kept)
        all.insert(all.end(), some.begin(), some.end());
    std::sort(all.begin(), all.end(), isBetter);
    const Vec3 centre = box.centre();
    for (const Hypothesis& h : all) {
        const bool isNew = std::none_of(distinct.begin(), distinct.end(), [&](const Hypothesis& d) {
            return angleDegrees(d.pose.orientation, h.pose.orientation) < 8.0 &&
                   (d.pose.apply(centre) - h.pose.apply(centre)).norm() < 0.8;
        });
        if (isNew) distinct.push_back(h);
        if (distinct.size() == 24) break;
    }
    return distinct;
}

void requireSurface(const TriangleMesh& mesh, const char* which) {
    if (mesh.triangles.empty()) throw core::Error("the surface is empty", which, "give a mesh with triangles");
    for (const Vec3& v : mesh.vertices)
        if (!v.allFinite()) throw core::Error("a vertex is not finite", which, "repair the mesh first");
    for (const geometry::Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t)
            if (v >= mesh.vertices.size())
                throw core::Error("a triangle names a vertex that is not there", which, "repair the mesh first");
}

[[noreturn]] void failed(const std::string& why) {
    throw core::Error(why, "registration",
                      "put the scan roughly in place by hand, cut away what is not this tooth, and check that it is in "
                      "millimetres");
}

}  // namespace

Registered registerOnto(const TriangleMesh& moving, const TriangleMesh& fixed, const RegisterSettings& settings,
                        const core::Progress& progress) {
    requireSurface(moving, "the scan to register");
    requireSurface(fixed, "the surface to register onto");
    if (!(settings.overlap > 0.0 && settings.overlap <= 1.0))
        throw core::Error("the overlap must lie above 0 and not above 1", fmt::format("{}", settings.overlap),
                          "give the share of the scan that shows this tooth, as 0.5");
    if (settings.roughly && !settings.roughly->isValid())
        throw core::Error("the rough pose is none", "registration", "give a position and a unit quaternion");
    const TriangleTree tree(fixed);
    const Fixed surface{tree};
    const Points fine = spread(moving, kFineMm);
    if (fine.size() < kMinPoints)
        failed(fmt::format("the scan is too small: {} points of {:.2f} mm", fine.size(), kFineMm));

    std::vector<Hypothesis> starts;
    if (settings.roughly) {
        starts.push_back({*settings.roughly, 0.0, 0});
    } else {
        const Points coarse = spread(moving, kCoarseMm), coarseFixed = spread(fixed, kCoarseMm);
        if (coarse.size() < kMinPoints || coarseFixed.size() < kMinPoints)
            failed("the surfaces are too small for features");
        const std::vector<Feature> features = featuresOf(coarse, kFeatureMm, core::part(progress, 0.0, 0.1));
        const std::vector<Feature> fixedFeatures = featuresOf(coarseFixed, kFeatureMm, core::part(progress, 0.1, 0.2));
        const Matches matches = match(features, fixedFeatures, core::part(progress, 0.2, 0.3));
        starts = search(coarse, coarseFixed, matches, surface, core::part(progress, 0.3, 0.7));
        if (starts.empty()) failed("no place was found where the scan looks like the tooth");
    }
    // Each start runs a little way; the one that comes to lie best is made exact.
    const std::size_t step = std::max<std::size_t>(1, fine.size() / 500);
    const double reach = settings.roughly ? 5.0 : 2.0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        for (const double reachMm : {reach, 1.0})
            starts[i].pose = refine(surface, fine, step, starts[i].pose, settings.overlap, 12, reachMm).pose;
        starts[i].score = scoreOf(surface, fine, step, starts[i].pose, 0.3);
        core::report(progress, 0.7 + 0.2 * static_cast<double>(i + 1) / static_cast<double>(starts.size()));
    }
    std::sort(starts.begin(), starts.end(), isBetter);
    const Refined exact =
        refine(surface, fine, 1, starts.front().pose, settings.overlap, 60, 1.0, core::part(progress, 0.9, 1.0));

    // Counted: what lies within three standard deviations of the best part, or closer than any scanner sees.
    const double within = std::clamp(3.0 * exact.sigmaMm, 0.1, 3.0 * kMaxRmsMm);
    std::vector<double> distances;
    for (std::size_t i = 0; i < fine.size(); ++i) {
        const auto m = surface.meet(exact.pose.apply(fine.at[i]), within);
        if (m.isFound && m.normal.dot(exact.pose.orientation * fine.normal[i]) > 0.6) distances.push_back(m.distanceMm);
    }
    Registered result;
    result.movingInFixed = exact.pose;
    result.overlap = static_cast<double>(distances.size()) / static_cast<double>(fine.size());
    if (result.overlap < settings.overlap)
        failed(fmt::format("only {:.0f} % of the scan lies on the tooth; {:.0f} % were asked", 100.0 * result.overlap,
                           100.0 * settings.overlap));
    double sum = 0.0;
    for (const double d : distances)
        sum += d * d;
    result.rmsMm = std::sqrt(sum / static_cast<double>(distances.size()));
    std::sort(distances.begin(), distances.end());
    result.worstMm = distances[static_cast<std::size_t>(0.95 * static_cast<double>(distances.size() - 1))];
    if (result.rmsMm > kMaxRmsMm)
        failed(fmt::format("the scan lies {:.2f} mm off the tooth (rms); at most {:.1f} are accepted", result.rmsMm,
                           kMaxRmsMm));
    core::report(progress, 1.0);
    return result;
}

}  // namespace handpiece::registration
