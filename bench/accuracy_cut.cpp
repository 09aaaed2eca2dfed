// SPDX-License-Identifier: Apache-2.0
#include "accuracy_cut.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/simd.h"
#include "handpiece/model/instrument/piece.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/cutting/sweeper.h"
#include "measure.h"
#include "support/random.h"

namespace handpiece::bench {
namespace {

using core::Vec2;
using core::Vec3;

using test::uniform;

constexpr int kCutPasses = 9;
constexpr double kStrokeStepMm = 0.02;  ///< of a quick hand in one tick

/// A straight stroke of a bur that does not turn: the least over the way of a convex function, to rounding.
struct Stroke {
    core::Pose from;
    Vec3 wayMm;
};

double strokeDistance(const instrument::Bur& bur, const Stroke& stroke, const Vec3& p) {
    const core::Quat toBur = stroke.from.orientation.conjugate();
    const Vec3 start = toBur * (p - stroke.from.positionMm), way = toBur * stroke.wayMm;
    const auto at = [&](double s) { return bur.signedDistance(start - s * way); };
    constexpr double kGolden = 0.6180339887498949;
    double low = 0.0, high = 1.0, a = 1.0 - kGolden, b = kGolden, fa = at(a), fb = at(b);
    double best = std::min({at(0.0), at(1.0), fa, fb});
    const double length = way.norm();
    while ((high - low) * length > 2e-4) {
        if (fa < fb) {
            high = b;
            b = a;
            fb = fa;
            a = high - kGolden * (high - low);
            fa = at(a);
        } else {
            low = a;
            a = b;
            fa = fb;
            b = low + kGolden * (high - low);
            fb = at(b);
        }
        best = std::min({best, fa, fb});
    }
    return best;
}

/// The tooth minus what was swept, in closed form on triangles and outlines: exact inside, and on the surface.
class Truth {
  public:
    Truth(const geometry::TriangleTree& tree, const instrument::Bur& bur, const std::vector<Stroke>& strokes)
        : tree_(tree), bur_(bur), strokes_(strokes) {
        // The outline as one line, with a fan of normals at every convex corner.
        const auto& pieces = bur.profile().pieces;
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            const double length = instrument::lengthMm(pieces[i]);
            const int steps = std::max(2, static_cast<int>(std::ceil(length / kSpacingMm)));
            for (int k = 0; k < steps; ++k)
                add({pieces[i], pieces[i], (k + 0.5) / steps, 0.5 * length / steps, false});
            if (i + 1 == pieces.size() ||
                instrument::jointBetween(pieces[i], pieces[i + 1]) != instrument::Joint::convex)
                continue;
            for (int k = 0; k < 5; ++k)
                add({pieces[i], pieces[i + 1], (k + 0.5) / 5, 0.1, true});
        }
    }

    [[nodiscard]] double tooth(const Vec3& p) const {
        double d = tree_.signedDistance(p);
        for (const Stroke& stroke : strokes_)
            d = std::max(d, -strokeDistance(bur_, stroke, p));
        return d;
    }

    /// Depth of an overlap; minus infinity when no place of the bur's surface that was asked lies in the tooth. -(phiT
    /// + phiB) never falls on the way inwards from the bur's surface as long as that leads through the tooth: so each
    /// such way is followed to its last place in the tooth, and the best of them climbed by shrinking grids.
    [[nodiscard]] double depth(const core::Pose& pose) const {
        std::vector<Start> starts;
        for (const Spot& spot : spots_) {
            const Vec2 at = placeOf(spot, spot.t);
            const int around = std::max(8, static_cast<int>(std::ceil(2.0 * std::numbers::pi * at.x() / kSpacingMm)));
            for (int k = 0; k < around; ++k) {
                const double angle = 2.0 * std::numbers::pi * (k + 0.5) / around;
                const Vec3 p = pose.apply({at.x() * std::cos(angle), at.x() * std::sin(angle), at.y()});
                const double d = tree_.signedDistance(p);
                if (d > kSpacingMm) continue;
                const double inTooth = tooth(p);
                if (inTooth < 0.75 * kSpacingMm) starts.push_back({inTooth, &spot, spot.t, angle, at.x()});
            }
        }
        std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.distance < b.distance; });
        std::vector<Start> kept;
        for (const Start& start : starts) {
            const Vec3 p = pose.apply(pointOf(start));
            const bool isNew = std::none_of(kept.begin(), kept.end(), [&](const Start& other) {
                return (pose.apply(pointOf(other)) - p).norm() < 1.5 * kSpacingMm &&
                       other.spot->corner == start.spot->corner;
            });
            if (isNew) kept.push_back(start);
            if (kept.size() == 80) break;
        }
        for (Start& start : kept)
            start.value = along(pose, *start.spot, start.t, start.angle);
        std::sort(kept.begin(), kept.end(), [](const Start& a, const Start& b) { return a.value > b.value; });
        double best = -std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < std::min<std::size_t>(kept.size(), 12); ++i)
            best = std::max(best, climbed(pose, kept[i]));
        return best;
    }

    /// What the depth is at least: -(phiT + phiB) at the place in the tooth that is nearest to p, as the walls lead.
    [[nodiscard]] double atLeast(const core::Pose& pose, Vec3 p, const Vec3& normal) const {
        constexpr double kStep = 1e-5;
        const auto at = [&](const Vec3& x) {
            const double d = tooth(x);
            return d <= 0.0 ? -d - bur_.signedDistance(pose.orientation.conjugate() * (x - pose.positionMm))
                            : -std::numeric_limits<double>::infinity();
        };
        // The place may lie deeper in the tooth than its surface there.
        double deepest = -std::numeric_limits<double>::infinity();
        for (double in = 0.002; in < 0.4; in += 0.004)
            deepest = std::max(deepest, at(p - in * normal));
        for (int i = 0; i < 40; ++i) {
            const double d = tooth(p);
            if (d <= 0.0) return std::max(deepest, at(p));
            Vec3 slope;
            for (int k = 0; k < 3; ++k)
                slope[k] = (tooth(p + kStep * Vec3::Unit(k)) - tooth(p - kStep * Vec3::Unit(k))) / (2.0 * kStep);
            p -= (d + 1e-8) * slope / std::max(slope.squaredNorm(), 0.05);
        }
        return deepest;
    }

  private:
    static constexpr double kSpacingMm = 0.05;
    struct Spot {
        instrument::ProfilePiece piece, next;
        double t, half;
        bool corner;
        double halfT = 0.0;
    };
    struct Start {
        double distance;
        const Spot* spot;
        double t, angle, rho, value = 0.0;
    };
    void add(Spot spot) {
        spot.halfT = spot.corner ? 0.1 : spot.half / std::max(1e-9, instrument::lengthMm(spot.piece));
        spots_.push_back(spot);
    }
    static Vec2 placeOf(const Spot& spot, double t) { return instrument::pointAt(spot.piece, spot.corner ? 1.0 : t); }
    static Vec2 inwardOf(const Spot& spot, double t) {
        if (!spot.corner) return instrument::inwardNormalAt(spot.piece, t);
        const Vec2 a = instrument::inwardNormalAt(spot.piece, 1.0), b = instrument::inwardNormalAt(spot.next, 0.0);
        const double whole = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)), turn = t * whole;
        return {a.x() * std::cos(turn) - a.y() * std::sin(turn), a.x() * std::sin(turn) + a.y() * std::cos(turn)};
    }
    static Vec3 pointOf(const Start& start) {
        const Vec2 at = placeOf(*start.spot, start.t);
        return {at.x() * std::cos(start.angle), at.x() * std::sin(start.angle), at.y()};
    }
    [[nodiscard]] double climbed(const core::Pose& pose, const Start& start) const {
        const double around = kSpacingMm / std::max(start.rho, 0.02);
        double window = 1.0, value = start.value, t = start.t, angle = start.angle, turn = 0.0;
        // Where two walls meet the top is an edge, and few ways lead up along it: each window is looked round thrice.
        for (int idle = 0; window > 1e-3;) {
            const double t0 = t, angle0 = angle;
            for (int i = 0; i < 8; ++i) {
                const double way = turn + i * std::numbers::pi / 4.0;
                const double nextT = std::clamp(t0 + std::cos(way) * window * start.spot->halfT, 0.0, 1.0);
                const double next = angle0 + std::sin(way) * window * around;
                const double v = along(pose, *start.spot, nextT, next);
                if (v > value) {
                    value = v;
                    t = nextT;
                    angle = next;
                }
            }
            turn += 0.7;
            idle = t == t0 && angle == angle0 ? idle + 1 : 0;
            if (idle < 3) continue;
            window *= 0.5;
            idle = 0;
        }
        return value;
    }
    /// The largest of -(phiT + phiB) on the way inwards; minus the distance where the way begins outside.
    [[nodiscard]] double along(const core::Pose& pose, const Spot& spot, double t, double angle) const {
        const Vec2 at = placeOf(spot, t), in = inwardOf(spot, t);
        const double c = std::cos(angle), s = std::sin(angle);
        const Vec3 from(at.x() * c, at.x() * s, at.y()), way(in.x() * c, in.x() * s, in.y());
        double reached = 0.0, d = tooth(pose.apply(from));
        if (d > 0.0) return -d;
        // A distance inside the tooth is clear to walk.
        for (int i = 0; i < 60 && d < -1e-7; ++i) {
            const double next = reached - d;
            const Vec3 p = from + next * way;
            if (p.head<2>().dot(Vec2(c, s)) < 0.0) break;  // beyond the axis
            if (-bur_.signedDistance(p) < -bur_.signedDistance(from + reached * way)) break;
            reached = next;
            d = tooth(pose.apply(p));
        }
        const Vec3 p = from + reached * way;
        return -tooth(pose.apply(p)) - bur_.signedDistance(p);
    }

    const geometry::TriangleTree& tree_;
    const instrument::Bur& bur_;
    const std::vector<Stroke>& strokes_;
    std::vector<Spot> spots_;
};

core::Quat tilted(std::mt19937_64& generator, double mostRad) {
    const double turn = uniform(generator, 0.0, 2.0 * std::numbers::pi);
    return core::Quat(Eigen::AngleAxisd(uniform(generator, 0.0, mostRad), Vec3(std::cos(turn), std::sin(turn), 0.0)));
}

/// Over (x, y), lowered until the bur is as deep in the uncut tooth.
core::Pose loweredTo(contact::Method& uncut, const core::Box& box, double x, double y, const core::Quat& q,
                     double depthMm) {
    double high = box.max.z() + 1.0, low = box.max.z() - 5.0;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (uncut.depth({{x, y, middle}, q}).depthMm < depthMm ? high : low) = middle;
    }
    return {{x, y, low}, q};
}

std::vector<Stroke> strokesOf(const std::string& cut, contact::Method& uncut, const core::Box& box,
                              std::mt19937_64& generator) {
    const Vec3 centre = box.centre();
    const double x = centre.x() + uniform(generator, -1.0, 1.0), y = centre.y() + uniform(generator, -1.0, 1.0);
    const core::Quat q = tilted(generator, 0.25);
    const double turn = uniform(generator, 0.0, 2.0 * std::numbers::pi);
    const Vec3 way(std::cos(turn), std::sin(turn), uniform(generator, -0.05, 0.05));
    std::vector<Stroke> strokes;
    const auto groove = [&](const Vec3& middle, const Vec3& along, const core::Quat& turned) {
        strokes.push_back({{middle - along, turned}, 2.0 * along});
    };
    if (cut == "groove") {
        groove(loweredTo(uncut, box, x, y, q, 0.35).positionMm, 1.2 * way, q);
    } else if (cut == "plunge") {
        const core::Pose deep = loweredTo(uncut, box, x, y, q, 0.45);
        const Vec3 up = q * Vec3::UnitZ();
        strokes.push_back({{deep.positionMm + 1.5 * up, q}, -2.0 * up});
    } else if (cut == "crossing") {
        const Vec3 middle = loweredTo(uncut, box, x, y, q, 0.35).positionMm;
        groove(middle, 1.2 * way, q);
        const double other = turn + uniform(generator, 0.5, 2.6);
        groove(middle + Vec3(0, 0, uniform(generator, -0.15, 0.15)), 1.2 * Vec3(std::cos(other), std::sin(other), 0.0),
               tilted(generator, 0.25));
    } else if (cut == "undercut") {
        const core::Pose deep = loweredTo(uncut, box, x, y, q, 0.45);
        const Vec3 up = q * Vec3::UnitZ(), bottom = deep.positionMm - 0.6 * up;
        strokes.push_back({{deep.positionMm + 1.5 * up, q}, -2.1 * up});
        strokes.push_back({{bottom, q}, 0.5 * way});
    } else {
        for (int i = 0; i < 3; ++i) {
            const double a = turn + 0.35 * i;
            const Vec3 next(x + 0.7 * i * std::cos(a), y + 0.7 * i * std::sin(a), 0.0);
            const Vec3 from = loweredTo(uncut, box, next.x(), next.y(), q, 0.12).positionMm;
            const Vec3 to =
                loweredTo(uncut, box, next.x() + 0.7 * std::cos(a), next.y() + 0.7 * std::sin(a), q, 0.12).positionMm;
            strokes.push_back({{from, q}, to - from});
        }
    }
    return strokes;
}

/// The tooth after the strokes, in steps of a quick hand.
std::shared_ptr<tooth::ToothState> cutBy(const std::shared_ptr<const tooth::ToothModel>& tooth,
                                         const instrument::Bur& bur, const std::vector<Stroke>& strokes) {
    auto state = std::make_shared<tooth::ToothState>(tooth);
    cutting::Sweeper sweeper(*state, bur, core::simdLevel());
    for (const Stroke& stroke : strokes) {
        const int steps = static_cast<int>(std::ceil(stroke.wayMm.norm() / kStrokeStepMm));
        for (int i = 0; i <= steps; ++i)
            (void)sweeper.sweepTo(
                {stroke.from.positionMm + (static_cast<double>(i) / steps) * stroke.wayMm, stroke.from.orientation});
        sweeper.settle();
    }
    return state;
}

/// Where the edges of the tooth's triangles pass into what was swept: places of the true margin.
std::vector<Vec3> marginOf(const geometry::TriangleMesh& mesh, const instrument::Bur& bur,
                           const std::vector<Stroke>& strokes) {
    const auto swept = [&](const Vec3& p) {
        double d = std::numeric_limits<double>::infinity();
        for (const Stroke& stroke : strokes)
            d = std::min(d, strokeDistance(bur, stroke, p));
        return d;
    };
    std::vector<std::uint8_t> isGone(mesh.vertices.size());
    core::parallelFor(isGone.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
            isGone[v] = swept(mesh.vertices[v]) < 0.0;
    });
    std::vector<Vec3> margin;
    for (const geometry::Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            if (a > b || isGone[a] == isGone[b]) continue;
            Vec3 gone = mesh.vertices[isGone[a] != 0 ? a : b], left = mesh.vertices[isGone[a] != 0 ? b : a];
            for (int i = 0; i < 30; ++i) {
                const Vec3 middle = 0.5 * (gone + left);
                (swept(middle) < 0.0 ? gone : left) = middle;
            }
            margin.push_back(gone);
        }
    return margin;
}

}  // namespace

MarginAccuracy measureMargin(const std::shared_ptr<const tooth::ToothModel>& tooth,
                             const std::shared_ptr<const instrument::Bur>& bur, const std::string& cut, unsigned seed) {
    std::mt19937_64 generator(seed);
    const auto uncut = contact::makeFieldMethod(tooth, bur);
    const std::vector<Stroke> strokes = strokesOf(cut, *uncut, tooth->outer.bounds(), generator);
    const auto state = cutBy(tooth, *bur, strokes);
    tooth::ToothMirror mirror(tooth);
    state->handOver(state->waitingBricks(), [&](const tooth::BrickSnapshot& snapshot) {
        mirror.apply(snapshot);
        return true;
    });
    const geometry::TriangleTree exported(surface::closedSurface(surface::MirrorSource(mirror)));
    std::vector<double> errors;
    for (const Vec3& p : marginOf(tooth->outer, *bur, strokes))
        errors.push_back(1e3 * exported.nearest(p).distanceMm);
    std::sort(errors.begin(), errors.end());
    if (errors.empty()) return {};
    return {errors.size(), percentile(errors, 0.5), percentile(errors, 0.95), errors.back()};
}

CutAccuracy measureCut(const std::shared_ptr<const tooth::ToothModel>& tooth,
                       const std::shared_ptr<const instrument::Bur>& bur, const std::string& cut, std::size_t count,
                       unsigned seed) {
    std::mt19937_64 generator(seed);
    const auto uncut = contact::makeFieldMethod(tooth, bur);
    CutAccuracy result{bur->name(), cut, tooth->field.settings().voxelMm, count};
    std::vector<double> errors, times;
    // Several cuts, so that no lucky place on the grid tells for all.
    constexpr std::size_t kPlaces = 4;
    for (std::size_t place = 0; place < kPlaces; ++place) {
        const std::vector<Stroke> strokes = strokesOf(cut, *uncut, tooth->outer.bounds(), generator);
        const auto state = cutBy(tooth, *bur, strokes);
        const auto method = contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(state), bur);
        const Truth truth(tooth->tree, *bur, strokes);
        std::vector<core::Pose> poses;
        std::vector<double> wanted;
        std::vector<contact::Depth> touches;
        // Random pushes out of random places of the strokes; those that press by some microns to two tenths count.
        for (int tries = 0; poses.size() < (count + kPlaces - 1) / kPlaces && tries < 100000; ++tries) {
            const Stroke& stroke = strokes[static_cast<std::size_t>(uniform(generator, 0, 1) * double(strokes.size()))];
            core::Pose pose = stroke.from;
            pose.positionMm +=
                uniform(generator, 0.0, 1.0) * stroke.wayMm +
                std::exp(uniform(generator, std::log(0.004), std::log(0.2))) * test::randomDirection(generator);
            pose.orientation = pose.orientation * tilted(generator, tries % 3 == 0 ? 0.3 : tries % 3 == 1 ? 0.02 : 0.0);
            const contact::Depth told = method->depth(pose);
            if (!(told.depthMm > 0.002 && told.depthMm < 0.2)) continue;
            poses.push_back(pose);
            touches.push_back(told);
        }
        wanted.resize(poses.size());
        core::parallelFor(poses.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                wanted[i] = std::max(truth.depth(poses[i]),
                                     truth.atLeast(poses[i], touches[i].toothPointMm, touches[i].normal));
        });
        for (std::size_t i = 0; i < poses.size(); ++i) {
            double told = 0.0, fastest = std::numeric_limits<double>::infinity();
            for (int pass = 0; pass < kCutPasses; ++pass) {
                (void)method->depth(
                    poses[(i + 1) % poses.size()]);  // what was sensed at the same pose would serve again
                const auto begin = std::chrono::steady_clock::now();
                told = method->depth(poses[i]).depthMm;
                const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
                fastest = std::min(fastest, took.count());
            }
            errors.push_back(1e3 * std::abs(told - wanted[i]));
            times.push_back(fastest);
        }
    }
    std::sort(errors.begin(), errors.end());
    std::sort(times.begin(), times.end());
    result.poses = errors.size();
    result.errorMedianUm = percentile(errors, 0.5);
    result.errorP99Um = percentile(errors, 0.99);
    result.errorWorstUm = errors.back();
    result.timeUs = percentile(times, 0.5);
    result.timeP99Us = percentile(times, 0.99);
    return result;
}

}  // namespace handpiece::bench
