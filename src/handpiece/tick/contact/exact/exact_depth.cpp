// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/exact/exact_depth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "handpiece/tick/contact/method.h"

namespace handpiece::contact {

using core::Vec3;
using geometry::kNoTriangle;
using instrument::MedialBall;

static_assert(sizeof(KernelNode) == sizeof(geometry::TreeNode) &&
              offsetof(KernelNode, maxZ) == offsetof(geometry::TreeNode, maxZ) &&
              offsetof(KernelNode, child) == offsetof(geometry::TreeNode, child) &&
              offsetof(KernelNode, count) == offsetof(geometry::TreeNode, count) &&
              offsetof(KernelNode, lanes) == offsetof(geometry::TreeNode, lanes));
static_assert(sizeof(KernelTriangle) == sizeof(geometry::TreeTriangle) &&
              offsetof(KernelTriangle, ac) == offsetof(geometry::TreeTriangle, ac) &&
              offsetof(KernelTriangle, thin) == offsetof(geometry::TreeTriangle, thin));
static_assert(SurfaceHit::kNone == kNoTriangle);

namespace {

/// Concave up to what rounding does to a straight line.
constexpr double kSlopeSlack = 1e-9;
constexpr double kSamePlaceMm = 1e-9;
constexpr double kCrossingMm = 1e-6;  // so much of the axis counts as outside about a ball that is

/// Few places hold most tops; where a wall runs along the axis many are nearly as deep.
double toleranceAfter(int measured) {
    return measured < AxisSearch::kFineCuts ? AxisSearch::kFineToleranceMm : kDepthToleranceMm;
}

Vec3 vectorOf(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

}  // namespace

ExactSurface::ExactSurface(const geometry::TriangleTree& tree, const field::DistanceField& field, core::SimdLevel level)
    : tree_(tree), field_(field), kernels_(HANDPIECE_AT_SIMD_LEVEL(level, exactKernels)()) {
    view_.nodes = reinterpret_cast<const KernelNode*>(tree.nodes().data());
    view_.triangles = reinterpret_cast<const KernelTriangle*>(tree.triangles().data());
    view_.triangleCount = static_cast<std::uint32_t>(tree.triangles().size());
}

bool ExactSurface::isInside(const Vec3& p, const SurfaceHit& hit) const noexcept {
    const double d = farBound(p);
    if (std::abs(d) > sureMm()) return d < 0.0;
    return tree_.side(p, {(p - vectorOf(hit.point)).norm(), vectorOf(hit.point), hit.triangle, hit.feature}) < 0.0;
}

BallDepth ExactSurface::ball(const Vec3& centreMm, double radiusMm, std::uint32_t seed, double boundMm) const noexcept {
    SurfaceHit hit;
    hit.value = boundMm;
    hit.triangle = seed;
    kernels_.nearestToPoint(view_, centreMm.data(), hit);
    BallDepth result;
    if (hit.triangle == kNoTriangle) return result;
    result.inside = isInside(centreMm, hit);
    result.depthMm = radiusMm + (result.inside ? hit.value : -hit.value);
    result.centreMm = centreMm;
    result.surfaceMm = vectorOf(hit.point);
    result.triangle = hit.triangle;
    result.feature = hit.feature;
    return result;
}

Vec3 ExactSurface::outward(const BallDepth& ball) const noexcept {
    const Vec3 normal = tree_.pseudonormal(ball.triangle, ball.feature);
    const double length = normal.norm();
    return length > 0.0 ? Vec3(normal / length) : Vec3::Zero();
}

Vec3 ExactSurface::closestOn(std::uint32_t triangle, const Vec3& p) const noexcept {
    double q[3];
    kernels_.closestOnTriangle(view_.triangles[triangle], p.data(), q);
    return vectorOf(q);
}

AxisSearch::AxisSearch(const instrument::Bur& bur) {
    for (const instrument::MedialCurve& curve : bur.medialAxis()) {
        if (!curve.onAxis || curve.balls.empty()) continue;
        std::vector<MedialBall> balls = curve.balls;
        if (balls.front().zMm > balls.back().zMm) std::reverse(balls.begin(), balls.end());
        // Cut where the radius turns upwards (a waist): each run is concave.
        std::vector<MedialBall> run;
        for (const MedialBall& ball : balls) {
            if (!run.empty() && ball.zMm - run.back().zMm < kSamePlaceMm) continue;
            if (run.size() >= 2) {
                const MedialBall &a = run[run.size() - 2], &b = run.back();
                const double before = (b.radiusMm - a.radiusMm) / (b.zMm - a.zMm);
                const double after = (ball.radiusMm - b.radiusMm) / (ball.zMm - b.zMm);
                if (after > before + kSlopeSlack) {
                    addRun(run);
                    run = {b};
                }
            }
            run.push_back(ball);
        }
        addRun(run);
    }
    reset();
}

void AxisSearch::addRun(const std::vector<MedialBall>& balls) {
    Run run;
    for (const MedialBall& ball : balls) {
        run.z.push_back(ball.zMm);
        run.radius.push_back(ball.radiusMm);
    }
    for (std::size_t i = 0; i + 1 < run.z.size(); ++i)
        run.slope.push_back((run.radius[i + 1] - run.radius[i]) / (run.z[i + 1] - run.z[i]));
    if (run.slope.empty()) run.slope.push_back(0.0);
    run.constant = std::all_of(run.slope.begin(), run.slope.end(), [](double s) { return s == 0.0; });
    run.plain.count = static_cast<std::int32_t>(run.z.size());
    run.plain.constant = run.constant;
    const double maxRadius = *std::max_element(run.radius.begin(), run.radius.end());
    leastRadiusMm_ = std::min(leastRadiusMm_, *std::min_element(run.radius.begin(), run.radius.end()));
    run.plain.maxRadius = static_cast<float>(maxRadius);
    if (!run.constant) {
        // The piece's own lines lie above a concave radius; a few of them hug it well enough for bounds.
        const std::size_t pieces = run.slope.size(), wanted = std::min<std::size_t>(pieces, kMaxRunLines);
        for (std::size_t i = 0; i < wanted; ++i) {
            const std::size_t piece = wanted == 1 ? 0 : i * (pieces - 1) / (wanted - 1);
            const double slope = run.slope[piece];
            if (std::abs(slope) > 0.999) continue;
            const auto line = static_cast<std::size_t>(run.plain.lines++);
            run.plain.lineRadius[line] = static_cast<float>(run.radius[piece] - slope * run.z[piece]);
            run.plain.lineSlope[line] = static_cast<float>(slope);
            run.plain.lineCosine[line] = static_cast<float>(std::sqrt(1.0 - slope * slope));
        }
    }
    runs_.push_back(std::move(run));
    for (Run& r : runs_) {
        r.plain.z = r.z.data();
        r.plain.radius = r.radius.data();
        r.plain.slope = r.slope.data();
    }
}

void AxisSearch::search(const ExactSurface& surface, const BurFrame& frame, BallDepth& best, double& mostMm) noexcept {
    for (std::size_t i = 0; i < runs_.size(); ++i) {
        const Run& run = runs_[i];
        std::uint32_t& seed = seeds_[std::min(i, kMaxSeeds - 1)];
        SurfaceHit hit;
        // The bound is that of balls outside: an axis in the tooth must still find its nearest triangle.
        const bool isOutside = std::isfinite(best.depthMm) && !mayEnter(surface, frame, run);
        hit.value = isOutside ? -best.depthMm : std::numeric_limits<double>::infinity();
        hit.triangle = seed;
        surface.kernels().nearestToRun(surface.view(), run.plain, frame.tip.data(), frame.z.data(), hit);
        if (hit.triangle == kNoTriangle) continue;
        seed = hit.triangle;
        const Vec3 centre = frame.onAxis(hit.z), point = vectorOf(hit.point);
        if (isOutside) {
            if (-hit.value > best.depthMm) best = {-hit.value, centre, point, hit.triangle, hit.feature, false};
            continue;
        }
        const double distance = (centre - point).norm();
        bool mayEnter = distance < kSamePlaceMm;
        if (!mayEnter && !run.constant) {
            // A narrow part may be in the tooth while a wide one outside is nearest: does the surface cut the axis?
            AxisRun thread;
            const double ends[2] = {run.z.front(), run.z.back()}, none[2] = {0.0, 0.0};
            thread.z = ends;
            thread.radius = none;
            thread.slope = none;
            thread.count = 2;
            thread.constant = true;
            SurfaceHit crossing;
            crossing.value = kSamePlaceMm;
            crossing.triangle = kNoTriangle;
            surface.kernels().nearestToRun(surface.view(), thread, frame.tip.data(), frame.z.data(), crossing);
            mayEnter = crossing.triangle != kNoTriangle;
        }
        const bool inside = surface.isInside(centre, hit);
        // No ball of the run with its centre outside is deeper: one inside as near is deeper still.
        const double depth = inside ? 2.0 * distance - hit.value : -hit.value;
        if (depth > best.depthMm) best = {depth, centre, point, hit.triangle, hit.feature, inside};
        if (inside || mayEnter) searchInside(surface, run, frame, hit, best, mostMm);
    }
}

bool AxisSearch::mayEnter(const ExactSurface& surface, const BurFrame& frame) const noexcept {
    return std::any_of(runs_.begin(), runs_.end(), [&](const Run& run) { return mayEnter(surface, frame, run); });
}

bool AxisSearch::mayEnter(const ExactSurface& surface, const BurFrame& frame, const Run& run) noexcept {
    // A distance clears the axis that far on.
    for (double z = run.z.front();;) {
        const double clear = surface.farBound(frame.onAxis(z));
        if (clear < surface.sureMm()) return true;
        if (z + clear >= run.z.back()) return false;
        z += clear;
    }
}

namespace {

/// What the points of the tooth seen so far allow: a point q bounds the depth of every ball by R + |c - q|, wherever
/// its centre lies, and a ball found outside clears the stretch of axis that its distance spans.
///
/// With q at `a` along the axis and `b` away from it |c(s) - q|^2 = s^2 + (a^2 + b^2 - 2 a s), so the least of these
/// distances follows the lower envelope of lines in s. Between the ends of the envelope's pieces and the run's own
/// balls the bound is a cone over a straight line, convex: its top is at one of those places.
class AxisBound {
  public:
    AxisBound(const std::vector<double>& z, const std::vector<double>& radius, const std::vector<double>& slope)
        : z_(z), radius_(radius), slope_(slope) {}

    void begin(double along, double away2) noexcept {
        lines_[lineCount_++] = {along, along * along + away2};
        for (std::size_t i = 0; i < z_.size(); ++i)
            offer(z_[i], radius_[i]);
    }
    void addPoint(double along, double away2) noexcept {
        if (lineCount_ == kMaxLines) return;
        const Line added{along, along * along + away2};
        int at = 0;
        while (at < lineCount_ && lines_[at].along < along)
            ++at;
        if (at < lineCount_ && lines_[at].along - along < kSameLine) {
            if (lines_[at].offset <= added.offset) return;
            remove(at);
        }
        if (at > 0 && at < lineCount_ && isAbove(added, meeting(lines_[at - 1], lines_[at]), lines_[at])) return;
        for (int i = lineCount_++; i > at; --i)
            lines_[i] = lines_[i - 1];
        lines_[at] = added;
        while (at + 2 < lineCount_ && isAbove(lines_[at + 1], meeting(added, lines_[at + 2]), added))
            remove(at + 1);
        while (at >= 2 && isAbove(lines_[at - 1], meeting(lines_[at - 2], added), added))
            remove(--at);
        for (int i = 0; i < count_; ++i) {
            Place& p = places_[static_cast<std::size_t>(i)];
            p.bound = std::min(p.bound, p.radius + distance(added, p.s));
        }
        if (at > 0) offerMeeting(lines_[at - 1], added);
        if (at + 1 < lineCount_) offerMeeting(added, lines_[at + 1]);
    }
    /// The tooth is farther than `freeMm` from the axis at s: no centre there lies in it.
    void clear(double s, double freeMm) noexcept {
        if (clearedCount_ == kMaxCleared) return;
        cleared_[clearedCount_++] = {s - freeMm, s + freeMm};
        drop([&](const Place& p) { return std::abs(p.s - s) < freeMm; });
        for (const double end : {s - freeMm, s + freeMm})
            if (end > z_.front() && end < z_.back()) offer(end, radiusAt(end));
    }
    struct Place {
        double s, radius, bound;
    };
    /// Where the bound is largest; bounded by minus infinity when nothing is left above `floorMm`. What lies below is
    /// forgotten.
    [[nodiscard]] Place highest(double floorMm) noexcept {
        drop([&](const Place& p) { return p.bound <= floorMm; });
        Place top{0.0, 0.0, -std::numeric_limits<double>::infinity()};
        for (int i = 0; i < count_; ++i)
            if (places_[static_cast<std::size_t>(i)].bound > top.bound) top = places_[static_cast<std::size_t>(i)];
        return top;
    }
    /// Of places that found no room.
    [[nodiscard]] double restMm() const noexcept { return restMm_; }

  private:
    struct Line {
        double along, offset;  ///< offset - 2 along s
    };
    struct Stretch {
        double from, to;
    };
    static constexpr double kSameLine = 1e-12;
    static constexpr int kMaxLines = AxisSearch::kMaxCuts + 1;
    static constexpr int kMaxCleared = AxisSearch::kMaxCuts + AxisSearch::kMaxLooks;
    static constexpr int kMaxPlaces = 1024;  // the run's balls, two a point, two a stretch

    static double meeting(const Line& a, const Line& b) noexcept {
        return 0.5 * (b.offset - a.offset) / (b.along - a.along);
    }
    static bool isAbove(const Line& line, double s, const Line& other) noexcept {
        return line.offset - 2.0 * line.along * s >= other.offset - 2.0 * other.along * s;
    }
    static double distance(const Line& line, double s) noexcept {
        return std::sqrt(std::max(0.0, s * s + line.offset - 2.0 * line.along * s));
    }
    void remove(int line) noexcept {
        std::copy(lines_ + line + 1, lines_ + lineCount_, lines_ + line);
        --lineCount_;
    }
    template <class Which>
    void drop(const Which& which) noexcept {
        count_ = static_cast<int>(std::remove_if(places_.begin(), places_.begin() + count_, which) - places_.begin());
    }
    void offerMeeting(const Line& a, const Line& b) noexcept {
        const double s = meeting(a, b);
        if (s > z_.front() && s < z_.back()) offer(s, radiusAt(s));
    }
    void offer(double s, double radius) noexcept {
        for (int i = 0; i < clearedCount_; ++i)
            if (s > cleared_[i].from && s < cleared_[i].to) return;
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i < lineCount_; ++i)
            least = std::min(least, distance(lines_[i], s));
        if (count_ < kMaxPlaces)
            places_[static_cast<std::size_t>(count_++)] = {s, radius, radius + least};
        else
            restMm_ = std::max(restMm_, radius + least);
    }
    [[nodiscard]] double radiusAt(double s) const noexcept {
        if (z_.size() == 1) return radius_[0];
        const auto next = std::upper_bound(z_.begin() + 1, z_.end() - 1, s) - z_.begin();
        const auto piece = static_cast<std::size_t>(next - 1);
        return radius_[piece] + slope_[piece] * (s - z_[piece]);
    }

    const std::vector<double>&z_, &radius_, &slope_;
    Line lines_[kMaxLines];
    Stretch cleared_[kMaxCleared];
    std::array<Place, kMaxPlaces> places_;
    int lineCount_ = 0, clearedCount_ = 0, count_ = 0;
    double restMm_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

/// What of the run lies in the tooth is left only when nothing there can be deeper by more than kTolerance, or when the
/// work ends: then `mostMm` says how deep it could be. The outside is known: nearestToRun's answer is its deepest.
void AxisSearch::searchInside(const ExactSurface& surface, const Run& run, const BurFrame& frame,
                              const SurfaceHit& first, BallDepth& best, double& mostMm) const noexcept {
    AxisBound bound(run.z, run.radius, run.slope);
    const auto split = [&](const Vec3& q, double& along) {
        const Vec3 w = q - frame.tip;
        along = w.dot(frame.z);
        return (w - along * frame.z).squaredNorm();
    };
    double along = 0.0, away2 = split(vectorOf(first.point), along);
    bound.begin(along, away2);
    std::uint32_t seed = first.triangle;
    for (int measured = 0, looks = 0;;) {
        const AxisBound::Place top = bound.highest(best.depthMm + toleranceAfter(measured));
        if (!std::isfinite(top.bound)) break;
        if (measured == kMaxCuts || looks == kMaxLooks) {
            mostMm = std::max(mostMm, top.bound);
            break;
        }
        const Vec3 centre = frame.onAxis(top.s);
        const double far = surface.farBound(centre);
        if (far > 2.0 * surface.sureMm()) {  // outside, and no triangle need say so
            bound.clear(top.s, far - surface.sureMm());
            ++looks;
            continue;
        }
        const BallDepth found = surface.ball(centre, top.radius, seed);
        ++measured;
        seed = found.triangle;
        if (found.depthMm > best.depthMm) best = found;
        if (!found.inside) bound.clear(top.s, std::max((centre - found.surfaceMm).norm(), kCrossingMm));
        away2 = split(found.surfaceMm, along);
        bound.addPoint(along, away2);
    }
    mostMm = std::max(mostMm, bound.restMm());
}

}  // namespace handpiece::contact
