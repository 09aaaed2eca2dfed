// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/gingiva.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <numbers>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/model/dentition/surfaces.h"
#include "handpiece/model/dentition/tooth_body.h"

namespace handpiece::dentition {
namespace {

using core::Box;
using core::Pose;
using core::Vec2;
using core::Vec3;
using geometry::TriangleMesh;

constexpr double kFarMm = 4.3;   ///< distances to teeth are told up to here
constexpr double kSeenMm = 6.0;  ///< farther inside a tooth than any place of it
/// Distances to a tooth are looked up between nodes this far apart, an error of some microns; farther off than
/// kNearMm every other node is between its neighbours.
constexpr double kNodeMm = 0.4, kNearMm = 1.0;
/// The gingiva reaches so far into a tooth: the edge of its socket, as jagged as its triangles are large, lies unseen,
/// and its margin is where its own smooth surface meets the tooth.
constexpr double kIntoToothMm = 0.3;
/// Its highest place lies so far inside; farther in it goes down again, or a bur that cuts just over the margin would
/// press what nobody sees.
constexpr double kHighestInsideMm = 0.15, kFallsInside = 1.5;
constexpr double kThinnestSeptumMm = 0.4;  ///< between two roots; thinner bone is left out
constexpr double kWidestSeptum = 2.1, kWidestPapilla = 1.9;
/// Under it the gingiva between two teeth that stand apart widens on as their roots taper, or a pit is left there.
constexpr double kWidensOn = 0.3, kNarrowPapilla = 1.2, kWidestBetween = 2.4;
/// A papilla widens so much a millimetre down from its tip, as the embrasure does: less leaves a way through under it.
constexpr double kPapillaWidens = 0.7;
constexpr double kBaseUnderApexMm = 2.0, kBoneOutOfBaseMm = 1.0;
constexpr double kSteepest = 4.0;  ///< Lipschitz bound of all that follows

/// smoothMin that blends less the farther away both are: none where a value is told only as "at least `cap`", so that
/// nothing jumps where a tooth comes into sight.
double blend(double a, double b, double width, double cap) {
    const double share = std::clamp(1.0 - std::max(a, b) / cap, 0.0, 1.0);
    return share > 0.0 ? smoothMin(a, b, width * share) : std::min(a, b);
}

/// A distance from a tooth as the margin of the gingiva takes it: it grows again deep inside.
double asMarginTakes(double distanceMm) {
    return distanceMm > -kHighestInsideMm ? distanceMm
                                          : -kHighestInsideMm - kFallsInside * (distanceMm + kHighestInsideMm);
}

/// Piecewise linear through points with x rising; level beyond them.
template <std::size_t N>
double through(const double (&points)[N][2], double x) {
    if (x <= points[0][0]) return points[0][1];
    for (std::size_t i = 1; i < N; ++i)
        if (x < points[i][0]) {
            const double t = (x - points[i - 1][0]) / (points[i][0] - points[i - 1][0]);
            return points[i - 1][1] + t * (points[i][1] - points[i - 1][1]);
        }
    return points[N - 1][1];
}

/// Signed distances from a tooth, in its frame, within kFarMm; looked up between nodes.
class DistanceGrid {
  public:
    explicit DistanceGrid(const ToothBody& body) : from_(body.box.grown(kFarMm + kNodeMm).min) {
        const Vec3 size = body.box.grown(kFarMm + kNodeMm).size();
        for (int axis = 0; axis < 3; ++axis)
            count_[axis] = 3 + 2 * static_cast<std::size_t>(0.5 * size[axis] / kNodeMm);
        values_.resize(count_[0] * count_[1] * count_[2]);
        measure(body, 2);
        measure(body, 1);
    }
    [[nodiscard]] double at(const Vec3& p) const {
        const Vec3 u = (p - from_) / kNodeMm;
        std::size_t first[3];
        double t[3];
        for (int axis = 0; axis < 3; ++axis) {
            if (!(u[axis] >= 0.0 && u[axis] < static_cast<double>(count_[axis] - 1))) return kFarMm;
            first[axis] = static_cast<std::size_t>(u[axis]);
            t[axis] = u[axis] - static_cast<double>(first[axis]);
        }
        const float* v = &values_[(first[2] * count_[1] + first[1]) * count_[0] + first[0]];
        double sum = 0.0;
        for (std::size_t k = 0; k < 2; ++k)
            for (std::size_t j = 0; j < 2; ++j) {
                const float* row = v + (k * count_[1] + j) * count_[0];
                sum += (k ? t[2] : 1.0 - t[2]) * (j ? t[1] : 1.0 - t[1]) * ((1.0 - t[0]) * row[0] + t[0] * row[1]);
            }
        return sum;
    }

  private:
    [[nodiscard]] float& node(std::size_t i, std::size_t j, std::size_t k) {
        return values_[(k * count_[1] + j) * count_[0] + i];
    }
    /// Every `stride`-th node; those of 1 that lie between nodes of 2, by these where they are far off.
    void measure(const ToothBody& body, std::size_t stride) {
        core::parallelFor((count_[2] + stride - 1) / stride, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin * stride; k < end * stride; k += stride)
                for (std::size_t j = 0; j < count_[1]; j += stride) {
                    std::uint32_t seed = geometry::kNoTriangle;
                    for (std::size_t i = 0; i < count_[0]; i += stride) {
                        const std::size_t oddI = i % 2, oddJ = j % 2, oddK = k % 2;
                        if (stride == 1) {
                            if (oddI + oddJ + oddK == 0) continue;
                            float sum = 0.0f;
                            for (std::size_t corner = 0; corner < 8; ++corner)
                                sum += node(corner & 1 ? i + oddI : i - oddI, corner & 2 ? j + oddJ : j - oddJ,
                                            corner & 4 ? k + oddK : k - oddK);
                            if (std::abs(sum) > 8.0f * static_cast<float>(kNearMm)) {
                                node(i, j, k) = 0.125f * sum;
                                continue;
                            }
                        }
                        const Vec3 p = from_ + kNodeMm * Vec3(static_cast<double>(i), static_cast<double>(j),
                                                              static_cast<double>(k));
                        const geometry::NearestPoint n = body.tree.nearest(p, kSeenMm, seed);
                        seed = n.triangle;
                        double distance = kFarMm;
                        if (seed != geometry::kNoTriangle)
                            distance = std::clamp(body.tree.side(p, n) * n.distanceMm, -kFarMm, kFarMm);
                        node(i, j, k) = static_cast<float>(distance);
                    }
                }
        });
    }

    Vec3 from_;
    std::size_t count_[3];
    std::vector<float> values_;
};

/// One tooth of the arch: its surface, and the height over its cemento-enamel junction.
class Stander {
  public:
    explicit Stander(const ArchTooth& t)
        : body_(t.tooth->outer),
          grid_(body_),
          pose_(t.inArch),
          turn_(t.inArch.orientation.toRotationMatrix()),
          axis_(turn_.col(2)) {
        const cases::Landmark* ring = nullptr;
        for (const cases::Landmark& landmark : t.tooth->landmarks)
            if (landmark.kind == cases::LandmarkKind::cementoEnamelJunction) ring = &landmark;
        if (!ring || ring->pointsMm.size() < 8)
            throw core::Error(fmt::format("tooth {} has no cemento-enamel junction", t.tooth->fdiNumber), "gingiva",
                              "add the landmark");
        // z = c0 + c1 x + c2 y + c3 x^2 + c4 xy + c5 y^2: smooth over the whole tooth, and the junction within some
        // hundredths of a millimetre.
        using Vec6 = Eigen::Matrix<double, 6, 1>;
        Eigen::Matrix<double, 6, 6> square = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
        Vec6 right = Vec6::Zero();
        for (const Vec3& p : ring->pointsMm) {
            const Vec6 row = terms(p);
            square += row * row.transpose();
            right += p.z() * row;
            reach_ = std::max(reach_, core::hypot(p.x(), p.y()));
        }
        junction_ = square.ldlt().solve(right);
        rootMm_ = -body_.box.min.z();
        Box box;
        for (int corner = 0; corner < 8; ++corner)
            box.extend(pose_.apply(Vec3(corner & 1 ? body_.box.min.x() : body_.box.max.x(),
                                        corner & 2 ? body_.box.min.y() : body_.box.max.y(),
                                        corner & 4 ? body_.box.min.z() : body_.box.max.z())));
        near_ = box.grown(kFarMm);
    }
    [[nodiscard]] const ToothBody& body() const { return body_; }
    [[nodiscard]] const Pose& pose() const { return pose_; }
    [[nodiscard]] const Box& near() const { return near_; }
    [[nodiscard]] const Vec3& axis() const { return axis_; }
    [[nodiscard]] double rootMm() const { return rootMm_; }

    struct Seen {
        double distance;     ///< from its surface, within kFarMm
        double aboveCervix;  ///< over the junction
    };
    [[nodiscard]] Seen see(const Vec3& p) const {
        const Vec3 q = turn_.transpose() * (p - pose_.positionMm);
        const double distance = grid_.at(q);
        if (distance >= kFarMm) return {kFarMm, 0.0};
        // Beside the tooth the junction goes on as it is at its edge.
        Vec3 at = q;
        if (const double r = core::hypot(q.x(), q.y()); r > reach_) at *= reach_ / r;
        return {distance, q.z() - junction_.dot(terms(at))};
    }

  private:
    static Eigen::Matrix<double, 6, 1> terms(const Vec3& p) {
        Eigen::Matrix<double, 6, 1> row;
        row << 1.0, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
        return row;
    }
    ToothBody body_;
    DistanceGrid grid_;
    Pose pose_;
    core::Mat3 turn_;
    Vec3 axis_;
    Box near_;
    Eigen::Matrix<double, 6, 1> junction_;
    double reach_ = 0.0, rootMm_ = 0.0;
};

class Arch {
  public:
    explicit Arch(std::span<const ArchTooth> teeth) {
        standers_.reserve(teeth.size());
        for (const ArchTooth& t : teeth)
            standers_.emplace_back(t);
        for (std::size_t i = 1; i < teeth.size(); ++i)
            contacts_.push_back(gapBetween(standers_[i - 1].body(), standers_[i - 1].pose(), standers_[i].body(),
                                           standers_[i].pose(), kFarMm)
                                    .pointMm);
        for (std::size_t i = 1; i < teeth.size(); ++i)
            papillaAxes_.push_back((standers_[i - 1].axis() + standers_[i].axis()).normalized());
        for (std::size_t i = 1; i < teeth.size(); ++i) {
            const double room = roomAtCrestMm(i);
            septumWidths_.push_back(std::clamp(0.7 * room + 0.3, 0.8, kWidestSeptum));
            papillaWidths_.push_back(std::clamp(0.5 * room + 0.4, 0.9, kWidestPapilla));
        }
        up_ = standers_[teeth.size() / 2].axis().z() > 0.0 ? 1.0 : -1.0;
        for (const Stander& s : standers_) {
            for (const double z : {s.body().box.min.z(), 0.0})
                base_ = std::min(base_, up_ * s.pose().apply(Vec3(0.0, 0.0, z)).z());
            box_.extend(s.near().min);
            box_.extend(s.near().max);
        }
        base_ -= kBaseUnderApexMm;
        (up_ > 0.0 ? box_.min.z() : box_.max.z()) = up_ * (base_ - 1.0);
    }

    [[nodiscard]] const Box& box() const { return box_; }

    struct Values {
        double gingiva, bone;
    };
    /// Negative inside.
    [[nodiscard]] Values at(const Vec3& p) const {
        // Distances over the heights: a thickness that grows downwards from the margin or the crest.
        static constexpr double kRoll[][2] = {{-8, 1.3},   {-3, 1.15},   {-1, 0.9},  {-0.2, 0.55},
                                              {0.42, 0.0}, {1.0, -0.55}, {4.0, -2.5}};
        static constexpr double kPlate[][2] = {{-14, 1.8},   {-8, 1.4},   {-4, 1.0},
                                               {-2.2, 0.55}, {-1.5, 0.0}, {1.5, -3.0}};
        constexpr double kRollCap = 2.2, kPlateCap = 1.7;  // less than kFarMm less the thickest of each
        // Where a tooth comes into sight a septum is no nearer than what bounds the plate, and fades in from there.
        constexpr double kFadeMm = 0.8;
        double nearest = kFarMm, second = kFarMm, roll = kRollCap, plate = kPlateCap, papilla = kFarMm - kWidestBetween;
        double ligament = kLigamentMm, septum = kPlateCap;
        Stander::Seen before{kFarMm, 0.0};
        for (std::size_t i = 0; i < standers_.size(); ++i) {
            const Stander& s = standers_[i];
            Stander::Seen seen{kFarMm, 0.0};
            if (((p - s.near().max).array() < 0.0).all() && ((s.near().min - p).array() < 0.0).all()) seen = s.see(p);
            if (seen.distance < kFarMm) {
                second = std::min(second, std::max(nearest, seen.distance));
                if (seen.distance < nearest) {
                    nearest = seen.distance;
                    const double fromMiddle = std::min(1.0, std::abs(2.0 * seen.aboveCervix / s.rootMm() + 1.0));
                    ligament = kLigamentMm + (kLigamentAtEndsMm - kLigamentMm) * fromMiddle * fromMiddle;
                }
                roll = blend(roll, asMarginTakes(seen.distance) - through(kRoll, seen.aboveCervix), 1.6, kRollCap);
                plate = blend(plate, seen.distance - through(kPlate, seen.aboveCervix), 2.0, kPlateCap);
            }
            if (i > 0 && std::min(seen.distance, before.distance) < kFarMm) {
                const double under = (contacts_[i - 1] - p).dot(papillaAxes_[i - 1]) - kPapillaBelowContactMm;
                const double width = papillaWidths_[i - 1],
                             most = width + std::min(kWidensOn * std::max(under - 2.0, 0.0),
                                                     0.7 * std::max(width - kNarrowPapilla, 0.0));
                const double wide = under < 0.0 ? under : smoothMin(kPapillaWidens * under, most, 0.6);
                // Between two teeth, not over the faces of narrow ones: the farther of the two counts more.
                const double one = seen.distance, two = before.distance;
                const double between = core::hypot(std::max(one, 0.0), std::max(two, 0.0)) / std::numbers::sqrt2 +
                                       0.5 * asMarginTakes(std::min({one, two, 0.0}));
                papilla = std::min(papilla, between - wide);
                // The crest between two teeth runs level, from under the one's junction to under the other's.
                if (std::max(one, two) < kFarMm) {
                    const double toOne = std::max(one, 0.01), toTwo = std::max(two, 0.01);
                    const double above = (toTwo * seen.aboveCervix + toOne * before.aboveCervix) / (toOne + toTwo);
                    const double aside = between - septumWidths_[i - 1];
                    const double fade = std::max(0.0, (std::max(one, two) - kFarMm) / kFadeMm + 1.0);
                    septum = std::min(septum, smoothMax(above + kCrestUnderCervixMm, aside, 1.0) + fade * kPlateCap);
                }
            }
            before = seen;
        }
        const double base = base_ - up_ * p.z();
        plate = smoothMin(plate, septum, 1.0);
        const double hull = smoothMax(smoothMin(plate, band(p), 2.0), base, 0.8);
        const double sockets = std::max(ligament - nearest, kThinnestSeptumMm + 2.0 * ligament - nearest - second);
        double gingiva = smoothMin(smoothMin(roll, papilla, 0.8), hull - kGingivaThicknessMm, 1.0);
        gingiva = smoothMax(gingiva, base + kBoneOutOfBaseMm, 0.5);
        return {smoothMax(gingiva, -kIntoToothMm - nearest, 0.1), smoothMax(hull, sockets, 0.25)};
    }

  private:
    /// Least way from tooth i - 1 over to tooth i at the crest's height, by steps from axis to axis.
    [[nodiscard]] double roomAtCrestMm(std::size_t i) const {
        const Stander &a = standers_[i - 1], &b = standers_[i];
        const auto crestOf = [](const Stander& s) -> Vec3 {
            return s.pose().positionMm - kCrestUnderCervixMm * s.axis();
        };
        double least = 2.0 * kFarMm;
        constexpr int kSteps = 200;
        for (int step = 0; step <= kSteps; ++step) {
            const Vec3 p = crestOf(a) + static_cast<double>(step) / kSteps * (crestOf(b) - crestOf(a));
            const double one = a.see(p).distance, two = b.see(p).distance;
            if (one > 0.0 && two > 0.0) least = std::min(least, one + two);
        }
        return least;
    }

    /// The jaw's ridge under the crest, along the roots.
    [[nodiscard]] double band(const Vec3& p) const {
        double least = 1e9;
        Vec3 before = Vec3::Zero();
        for (std::size_t i = 0; i < standers_.size(); ++i) {
            const Stander& s = standers_[i];
            const Vec3 axis = s.axis();
            // Where the tooth's axis is at this height, the lean held to what a jaw follows.
            const double down = std::clamp((s.pose().positionMm.z() - p.z()) * up_, 0.0, 14.0);
            const Vec3 lean = axis / std::max(0.5, axis.z() * up_);
            const Vec3 centre = s.pose().positionMm - down * Vec3(lean.x(), lean.y(), 0.0);
            const double half = 0.5 * (s.body().box.max.y() - s.body().box.min.y());
            const Vec3 now(centre.x(), centre.y(), half);
            if (i > 0) {
                const Vec2 along = (now - before).head<2>(), to = p.head<2>() - before.head<2>();
                const double t = std::clamp(to.dot(along) / along.squaredNorm(), 0.0, 1.0);
                const double crest = (1.0 - t) * standers_[i - 1].pose().positionMm.z() * up_ +
                                     t * s.pose().positionMm.z() * up_ - kCrestUnderCervixMm;
                const double deep = crest - up_ * p.z();
                const double width = 0.9 * ((1.0 - t) * before.z() + t * half) + 0.08 * std::clamp(deep, 0.0, 15.0);
                const double side = (to - t * along).norm() - width;
                least = std::min(least, smoothMax(side, 2.5 - deep, 2.5));
            }
            before = now;
        }
        return least;
    }

    std::vector<Stander> standers_;
    std::vector<Vec3> contacts_, papillaAxes_;
    std::vector<double> septumWidths_;   ///< of the bone's crest between two teeth, towards lip and tongue
    std::vector<double> papillaWidths_;  ///< of the gingiva between two teeth at its widest, from either
    Box box_;
    double up_ = 1.0, base_ = 1e9;
};

/// Where thin edges have come to cross while faces were thinned out, other samples do not: tried a few times, then left
/// as it was sampled.
TriangleMesh solidOf(const Box& box, const geometry::ScalarFunction& f, double spacingMm, std::size_t faces,
                     const core::Progress& progress) {
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = kSteepest;
    settings.usualSlope = 1.0;
    settings.relaxations = 0;
    settings.project = false;  // between the nodes: sharp edges are planed off, not folded
    constexpr int kTries = 4;
    TriangleMesh fine;
    for (int i = 0; i < kTries; ++i) {
        const double begun = static_cast<double>(i) / kTries, tried = static_cast<double>(i + 1) / kTries;
        const core::Progress share = core::part(progress, begun, tried);
        settings.spacingMm = spacingMm * (1.0 - 0.03 * i);
        fine = largestShell(geometry::isosurface(box, f, settings, core::part(share, 0.0, 0.5)));
        TriangleMesh thinned =
            fine.triangles.size() <= faces ? fine : geometry::decimate(fine, faces, core::part(share, 0.5, 1.0)).mesh;
        if (geometry::selfIntersections(thinned, 1).empty()) return thinned;
    }
    return fine;
}

}  // namespace

Periodontium makePeriodontium(std::span<const ArchTooth> teeth, const PeriodontiumOptions& options,
                              const core::Progress& progress) {
    if (teeth.size() < 2) throw core::Error("an arch needs two teeth", "gingiva");
    const Arch arch(teeth);
    Periodontium made;
    made.gingiva = solidOf(
        arch.box(), [&](const Vec3& p) { return arch.at(p).gingiva; }, options.spacingMm, options.gingivaFaces,
        core::part(progress, 0.0, 0.6));
    made.bone = solidOf(
        arch.box(), [&](const Vec3& p) { return arch.at(p).bone; }, options.spacingMm, options.boneFaces,
        core::part(progress, 0.6, 1.0));
    return made;
}

}  // namespace handpiece::dentition
