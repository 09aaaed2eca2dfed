// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/exact/exact_depth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

ExactKernels kernelsFor(core::SimdLevel level) {
#if defined(__x86_64__)
    if (level == core::SimdLevel::avx512) return simd_avx512::exactKernels();
    if (level == core::SimdLevel::avx2) return simd_avx2::exactKernels();
#endif
    static_cast<void>(level);
    return simd_base::exactKernels();
}

Vec3 vectorOf(const double (&v)[3]) {
    return {v[0], v[1], v[2]};
}

}  // namespace

ExactSurface::ExactSurface(const geometry::TriangleTree& tree, const field::DistanceField& field, core::SimdLevel level)
    : tree_(tree), field_(field), kernels_(kernelsFor(level)) {
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
    const float* n = &tree_.pseudonormals()[21 * std::size_t{ball.triangle} + 3 * std::size_t{ball.feature}];
    const Vec3 normal(n[0], n[1], n[2]);
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

void AxisSearch::search(const ExactSurface& surface, const BurFrame& frame, BallDepth& best) noexcept {
    for (std::size_t i = 0; i < runs_.size(); ++i) {
        const Run& run = runs_[i];
        std::uint32_t& seed = seeds_[std::min(i, kMaxSeeds - 1)];
        SurfaceHit hit;
        // The bound is that of balls outside: an axis in the tooth must still find its nearest triangle.
        hit.value = std::numeric_limits<double>::infinity();
        hit.triangle = seed;
        surface.kernels().nearestToRun(surface.view(), run.plain, frame.tip.data(), frame.z.data(), hit);
        if (hit.triangle == kNoTriangle) continue;
        seed = hit.triangle;
        const Vec3 centre = frame.onAxis(hit.z), point = vectorOf(hit.point);
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
        if (!inside && -hit.value > best.depthMm) best = {-hit.value, centre, point, hit.triangle, hit.feature, false};
        if (inside || mayEnter) searchInside(surface, run, frame, hit, best);
    }
}

bool AxisSearch::mayEnter(const ExactSurface& surface, const BurFrame& frame) const noexcept {
    return std::any_of(runs_.begin(), runs_.end(), [&](const Run& run) {
        // A distance clears the axis that far on.
        for (double z = run.z.front();;) {
            const double clear = surface.farBound(frame.onAxis(z));
            if (clear < surface.sureMm()) return true;
            if (z + clear >= run.z.back()) return false;
            z += clear;
        }
    });
}

namespace {

/// What the triangles seen so far allow: a point q at distance d bounds the inside depth of every ball by its own
/// distance to q, and a ball found outside clears the stretch of axis that its distance spans.
class Cuts {
  public:
    Cuts(const std::vector<double>& z, const std::vector<double>& radius, const std::vector<double>& slope)
        : z_(z), radius_(radius), slope_(slope) {
        for (const double at : z)
            offer(at);
    }
    void addPoint(double along, double away2) noexcept {
        if (count_ == kMax) return;
        const int first = count_++;
        along_[first] = along;
        away2_[first] = away2;
        for (int i = 0; i < candidates_; ++i)
            bound_[i] = std::min(bound_[i], radiusAt(at_[i]) + distance(first, at_[i]));
        // Two such distances are equal in one place; the bound peaks there or at a ball.
        for (int j = 0; j < first; ++j) {
            const double gap = along_[j] - along_[first];
            if (std::abs(gap) < 1e-12) continue;
            const double s =
                0.5 * (along_[j] * along_[j] + away2_[j] - along_[first] * along_[first] - away2_[first]) / gap;
            if (s > z_.front() && s < z_.back()) offer(s);
        }
    }
    void clear(double from, double to) noexcept {
        if (cleared_ == kMax) return;
        from_[cleared_] = from;
        to_[cleared_++] = to;
        for (int i = 0; i < candidates_; ++i)
            if (at_[i] > from && at_[i] < to) bound_[i] = -1.0;
        if (from > z_.front()) offer(from);
        if (to < z_.back()) offer(to);
    }
    /// Where the bound is largest, and the bound.
    [[nodiscard]] double highest(double& bound) const noexcept {
        int top = 0;
        for (int i = 1; i < candidates_; ++i)
            if (bound_[i] > bound_[top]) top = i;
        bound = bound_[top];
        return at_[top];
    }
    [[nodiscard]] double radiusAt(double s) const noexcept {
        std::size_t low = 0, high = z_.size() - 1;
        if (high == 0) return radius_[0];
        while (high - low > 1) {
            const std::size_t middle = (low + high) / 2;
            (s < z_[middle] ? high : low) = middle;
        }
        return radius_[low] + slope_[low] * (s - z_[low]);
    }

  private:
    static constexpr int kMax = AxisSearch::kMaxCuts + 4;
    static constexpr int kCandidates = 512;
    [[nodiscard]] double distance(int cut, double s) const noexcept {
        const double d = s - along_[cut];
        return std::sqrt(d * d + away2_[cut]);
    }
    void offer(double s) noexcept {
        if (candidates_ == kCandidates) return;
        for (int i = 0; i < cleared_; ++i)
            if (s > from_[i] && s < to_[i]) return;
        double bound = std::numeric_limits<double>::infinity();
        const double r = radiusAt(s);
        for (int i = 0; i < count_; ++i)
            bound = std::min(bound, r + distance(i, s));
        at_[candidates_] = s;
        bound_[candidates_++] = bound;
    }
    const std::vector<double>&z_, &radius_, &slope_;
    double along_[kMax], away2_[kMax], from_[kMax], to_[kMax];
    int count_ = 0, cleared_ = 0, candidates_ = 0;
    double at_[kCandidates], bound_[kCandidates];
};

}  // namespace

void AxisSearch::searchInside(const ExactSurface& surface, const Run& run, const BurFrame& frame,
                              const SurfaceHit& first, BallDepth& best) const noexcept {
    Cuts cuts(run.z, run.radius, run.slope);
    const auto add = [&](const Vec3& q) {
        const Vec3 w = q - frame.tip;
        const double along = w.dot(frame.z);
        cuts.addPoint(along, (w - along * frame.z).squaredNorm());
    };
    add(vectorOf(first.point));
    std::uint32_t seed = first.triangle;
    for (int i = 0; i < kMaxCuts; ++i) {
        double bound = 0.0;
        const double s = cuts.highest(bound);
        if (bound <= best.depthMm + kTolerance) return;
        const BallDepth found = surface.ball(frame.onAxis(s), cuts.radiusAt(s), seed);
        seed = found.triangle;
        if (found.depthMm > best.depthMm) best = found;
        const double distance = (found.centreMm - found.surfaceMm).norm();
        add(found.surfaceMm);
        if (!found.inside) cuts.clear(s - std::max(distance, 1e-6), s + std::max(distance, 1e-6));
    }
}

}  // namespace handpiece::contact
