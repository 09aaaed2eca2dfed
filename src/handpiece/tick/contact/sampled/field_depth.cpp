// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/sampled/field_depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::contact {

using core::Vec2;
using core::Vec3;
using instrument::MedialBall;

namespace {

constexpr std::size_t kStarts = 4;
/// Two points of the rings nearer to each other than this lead to the same top.
constexpr double kApartMm = 0.12;
/// A point of the rings is at most half a diagonal of their mesh from the deepest place, in spacings.
constexpr double kWindow = 0.75;
/// The same of the shells inside.
constexpr double kInnerWindowMm = 0.09;
constexpr double kFirstLookMm = 0.03, kLastLookMm = 0.01, kAnchorMm = 0.05;
constexpr int kLooks = 12;
/// The same once more by what the field is between its nodes.
constexpr double kFirstSharpLookMm = 0.016, kLastSharpLookMm = 9e-4;
constexpr int kSharpLooks = 8, kSharpClimbs = 2;
/// A climb on a smooth wall ends where its next step promises no more.
constexpr double kWallGainMm = 1e-5;
/// Two climbs that come this near to one another end at one top.
constexpr double kSameTopMm = 0.03;
/// A mixed cell is off by less than that where two walls meet in it.
constexpr double kMixedErrorMm = 0.02;
/// What a sharp climb may still find above the place where the mixed one ended.
constexpr double kClimbMm = 0.012, kGainMm = 0.001;
constexpr double kOnSurfaceMm = 2e-5, kBesideMm = 0.004;
constexpr int kProjections = 3;
constexpr double kShellMm = 0.15, kShellSpacingMm = 0.12;
constexpr double kCornerCosine = 0.995;  // outlines that turn by less than six degrees are smooth
constexpr double kAxisSpacingMm = 0.06;
constexpr double kTinyMm = 1e-9;

// A middle and seven places around it.
constexpr int kAround = 7;
constexpr double kCosine[8] = {0.0,
                               1.0,
                               0.6234898018587336,
                               -0.2225209339563144,
                               -0.9009688679024191,
                               -0.9009688679024191,
                               -0.2225209339563144,
                               0.6234898018587336};
constexpr double kSine[8] = {0.0,
                             0.0,
                             0.7818314824680298,
                             0.9749279121818236,
                             0.4338837391175581,
                             -0.4338837391175581,
                             -0.9749279121818236,
                             -0.7818314824680298};
// Weights of the seven in the second harmonic: cosine^2 - sine^2, 2 cosine sine.
constexpr double kCosine2[8] = {0.0,
                                1.0,
                                -0.2225209339563143,
                                -0.9009688679024190,
                                0.6234898018587335,
                                0.6234898018587335,
                                -0.9009688679024190,
                                -0.2225209339563143};
constexpr double kSine2[8] = {0.0,
                              0.0,
                              0.9749279121818236,
                              -0.4338837391175582,
                              -0.7818314824680299,
                              0.7818314824680299,
                              0.4338837391175582,
                              -0.9749279121818236};
void store(double (&to)[3], const Vec3& v) noexcept {
    for (int k = 0; k < 3; ++k)
        to[k] = v[k];
}

double curvatureOf(const instrument::ProfilePiece& piece) {
    if (!piece.isArc || piece.radiusMm <= 0.0) return 0.0;
    return (piece.convex ? 1.0 : -1.0) / piece.radiusMm;
}

/// Largest s for which -phiB at s inwards from p is `deeperPerMm` s.
double inscribedAt(const instrument::Bur& bur, const Vec2& p, const Vec2& normal, double deeperPerMm) {
    constexpr double kSlackMm = 1e-5;
    double low = 0.0, high = bur.maxRadiusMm() + bur.lengthMm();
    for (int i = 0; i < 40; ++i) {
        const double s = 0.5 * (low + high);
        const Vec2 c = p - s * normal;
        const bool fits = c.x() >= 0.0 && -bur.signedDistance({c.x(), 0.0, c.y()}) >= deeperPerMm * s - kSlackMm;
        (fits ? low : high) = s;
    }
    return low;
}

}  // namespace

FieldDepth::FieldDepth(KnownSurface& surface, const instrument::Bur& bur, core::SimdLevel level)
    : surface_(surface),
      field_(surface.field()),
      bur_(bur),
      view_(field_.view()),
      kernels_(ringKernelsFor(level)),
      outMm_(kSaturated * field_.reach().outMm),
      inMm_(kSaturated * field_.reach().inMm),
      // Half a diagonal of the rings' mesh, and what a trilinear cell may be off.
      clearMm_(std::max(
          0.0, std::sqrt(std::max(0.0, outMm_ * outMm_ - 0.5 * bur.surfaceSpacingMm() * bur.surfaceSpacingMm())) -
                   0.1 * view_.voxelMm)),
      windowMm_(kWindow * bur.surfaceSpacingMm()),
      inner_({}),
      probe_({}) {
    addSpots();
    measureInscribed();
    measureRoom();
    addShells();
    addProbes();
    for (const instrument::MedialCurve& curve : bur.medialAxis())
        if (curve.onAxis) axis_.insert(axis_.end(), curve.balls.begin(), curve.balls.end());
    std::sort(axis_.begin(), axis_.end(), [](const MedialBall& a, const MedialBall& b) { return a.zMm < b.zMm; });
}

/// A spot a ring, with the outline's curvature on both sides of it, and whether the outline has a corner there. Rings
/// follow the outline from piece to piece; the last of one is the first of the next.
void FieldDepth::addSpots() {
    const auto& rings = bur_.rings();
    for (const instrument::SurfaceRing& r : rings) {
        const double around = r.rhoMm > kTinyMm ? r.normalRho / r.rhoMm : 0.0;
        Spot spot{};
        spot.rho = r.rhoMm;
        spot.z = r.zMm;
        spot.normalRho = r.normalRho;
        spot.normalZ = r.normalZ;
        spot.curvatureAround = around;
        spot.deeperPerMm = 1.0;
        spots_.push_back(spot);
    }
    std::size_t first = 0;
    for (const instrument::ProfilePiece& piece : bur_.profile().pieces) {
        std::size_t last = first + 1;
        while (last + 1 < rings.size() && (Vec2(rings[last].rhoMm, rings[last].zMm) - piece.to).norm() > kTinyMm)
            ++last;
        for (std::size_t i = first; i <= last; ++i) {
            if (i > first) spots_[i].curvatureBefore = curvatureOf(piece);
            if (i < last) spots_[i].curvatureAfter = curvatureOf(piece);
            const Vec2 outward = -instrument::inwardNormalAt(piece, i == first ? 0.0 : i == last ? 1.0 : 0.5);
            const bool isEnd = (i == first || i == last) && rings[i].rhoMm > kTinyMm;
            if (isEnd && outward.dot(Vec2(rings[i].normalRho, rings[i].normalZ)) < kCornerCosine)
                spots_[i].isCorner = true;
        }
        first = last;
    }
}

/// How far inwards from each spot the nearest point of the bur's surface stays this one: there its parallel surfaces
/// end.
void FieldDepth::measureInscribed() {
    for (Spot& s : spots_) {
        const Vec2 place(s.rho, s.z), normal(s.normalRho, s.normalZ);
        if (s.rho < kTinyMm) {  // round about the axis: both curvatures are the outline's
            const double end = s.z < 0.5 * bur_.lengthMm() ? s.curvatureAfter : s.curvatureBefore;
            s.curvatureBefore = s.curvatureAfter = s.curvatureAround = end;
        }
        if (s.isCorner) {
            constexpr double kStepMm = 1e-4;
            const Vec2 inside = place - kStepMm * normal;
            s.deeperPerMm = std::clamp(-bur_.signedDistance({inside.x(), 0.0, inside.y()}) / kStepMm, 0.0, 1.0);
        }
        s.inscribedMm = inscribedAt(bur_, place, normal, s.deeperPerMm);
    }
}

/// How far along the outline to the next corner on both sides, and how the inscribed depth changes on the way.
void FieldDepth::measureRoom() {
    constexpr double kNoCornerMm = 1e3;
    const auto stepTo = [&](std::size_t i, std::size_t j) {
        return core::hypot(spots_[i].rho - spots_[j].rho, spots_[i].z - spots_[j].z);
    };
    const auto inscribedOf = [&](std::size_t i) { return spots_[i].isCorner ? 0.0 : spots_[i].inscribedMm; };
    for (std::size_t i = 0; i < spots_.size(); ++i) {
        Spot& s = spots_[i];
        s.roomBefore = s.roomAfter = kNoCornerMm;
        if (i > 0) {
            s.slopeBefore = (inscribedOf(i) - inscribedOf(i - 1)) / stepTo(i, i - 1);
            s.roomBefore = (spots_[i - 1].isCorner ? 0.0 : spots_[i - 1].roomBefore) + stepTo(i, i - 1);
        }
    }
    for (std::size_t i = spots_.size() - 1; i-- > 0;) {
        Spot& s = spots_[i];
        s.slopeAfter = (inscribedOf(i + 1) - inscribedOf(i)) / stepTo(i, i + 1);
        s.roomAfter = (spots_[i + 1].isCorner ? 0.0 : spots_[i + 1].roomAfter) + stepTo(i, i + 1);
    }
}

/// Rings of points inside the bur, on its parallel surfaces: what is asked where the bur lies deeper than the field's
/// values on its own surface can tell.
void FieldDepth::addShells() {
    const auto& rings = bur_.rings();
    const auto stepTo = [&](std::size_t i, std::size_t j) {
        return core::hypot(spots_[i].rho - spots_[j].rho, spots_[i].z - spots_[j].z);
    };
    std::vector<instrument::SurfaceRing> shells;
    double nextAlong = 0.0, along = 0.0;
    for (std::size_t i = 0; i < rings.size(); ++i) {
        const Spot& s = spots_[i];
        if (i > 0) along += stepTo(i, i - 1);
        if (along < nextAlong && !s.isCorner) continue;
        nextAlong = along + kShellSpacingMm - 1e-6;
        for (double in = kShellMm; in < s.inscribedMm; in += kShellMm) {
            instrument::SurfaceRing shell = rings[i];
            shell.rhoMm = std::max(0.0, s.rho - in * s.normalRho);
            shell.zMm = s.z - in * s.normalZ;
            const double eights = std::ceil(2.0 * std::numbers::pi * shell.rhoMm / kShellSpacingMm / 8.0);
            shell.count = shell.rhoMm < kTinyMm ? 1 : 8 * static_cast<std::uint32_t>(std::max(1.0, eights));
            shells.push_back(shell);
            innerSpot_.push_back(i);
            innerIn_.push_back(static_cast<float>(in));
            innerDepth_.push_back(static_cast<float>(s.deeperPerMm * in));
        }
    }
    inner_ = RingArrays(shells);
}

/// Every second point of every second ring, and all corners: enough to begin a climb from.
void FieldDepth::addProbes() {
    const auto& rings = bur_.rings();
    std::vector<instrument::SurfaceRing> probes;
    for (std::size_t i = 0; i < rings.size(); ++i) {
        if (i % 2 != 0 && !spots_[i].isCorner && i + 1 != rings.size()) continue;
        instrument::SurfaceRing ring = rings[i];
        if (ring.count >= 16) ring.count = ring.count / 16 * 8;
        probes.push_back(ring);
        probeSpot_.push_back(i);
    }
    probe_ = RingArrays(probes);
}

double FieldDepth::radiusAt(double z) const noexcept {
    auto high = std::upper_bound(axis_.begin(), axis_.end(), z,
                                 [](double value, const MedialBall& b) { return value < b.zMm; });
    if (high == axis_.begin()) return axis_.front().radiusMm;
    if (high == axis_.end()) return axis_.back().radiusMm;
    const MedialBall &a = *(high - 1), &b = *high;
    return a.radiusMm + (b.radiusMm - a.radiusMm) * (z - a.zMm) / (b.zMm - a.zMm);
}

double FieldDepth::depthAt(const BurFrame& frame, const Vec3& p, double distanceMm) const noexcept {
    return -distanceMm - bur_.signedDistance(frame.toBur * (p - frame.tip));
}

/// Out of the tooth: the field's slope, or that of the bricks' centres where the field is level.
Vec3 FieldDepth::outward(const Vec3& p) const noexcept {
    const Vec3 fine = field_.normal(p);
    const double d = field_.distance(p);
    if (!fine.isZero() && d > -inMm_ && d < outMm_) return fine;
    const double perBrick = view_.inverseVoxelMm / field::kBrickCells;
    std::int32_t at[3];
    for (int k = 0; k < 3; ++k) {
        const double g = (p[k] - view_.originMm[k]) * perBrick;
        at[k] = static_cast<std::int32_t>(std::clamp(g, 0.0, static_cast<double>(view_.bricks[k] - 1)));
    }
    const auto coarse = [&](int axis, int step) {
        std::int32_t there[3] = {at[0], at[1], at[2]};
        there[axis] = std::clamp(there[axis] + step, 0, view_.bricks[axis] - 1);
        return static_cast<double>(
            view_.coarse[there[0] + static_cast<std::int64_t>(view_.bricks[0]) *
                                        (there[1] + static_cast<std::int64_t>(view_.bricks[1]) * there[2])]);
    };
    const Vec3 slope(coarse(0, 1) - coarse(0, -1), coarse(1, 1) - coarse(1, -1), coarse(2, 1) - coarse(2, -1));
    const double length = slope.norm();
    return length > kTinyMm ? Vec3(slope / length) : fine;
}

std::size_t FieldDepth::nearestSpot(std::size_t from, double rho, double z) const noexcept {
    const auto away = [&](std::size_t i) {
        const double a = spots_[i].rho - rho, b = spots_[i].z - z;
        return a * a + b * b;
    };
    // Corners are tops of their own: nobody climbs onto them from beside.
    std::size_t best = from;
    double least = away(from);
    constexpr std::size_t kReach = 4;
    const std::size_t first = from > kReach ? from - kReach : 0, last = std::min(spots_.size() - 1, from + kReach);
    for (std::size_t i = first; i <= last; ++i) {
        if (spots_[i].isCorner || away(i) >= least) continue;
        bool between = false;
        for (std::size_t k = std::min(i, from); k <= std::max(i, from); ++k)
            between = between || spots_[k].isCorner;
        if (between) continue;
        best = i;
        least = away(i);
    }
    return best;
}

/// From a point beside the bur's surface to the deepest place nearby. Where it is on the outline and around it is
/// looked for in eight places at a time; how far inwards follows from the tooth's surface. From a corner, where going
/// inwards is a choice, that takes the place of going along the outline.
class FieldDepth::DepthAscent {
  public:
    DepthAscent(FieldDepth& depth, const BurFrame& frame, const Start& start)
        : depth_(depth), frame_(frame), at_(start.spot), in_(start.inMm) {
        anchor(start.spot, start.cosine, start.sine);
    }

    /// Up to the top between the nodes' values as they are mixed. False where it is lower than `atLeastMm` or the same
    /// as one of `others`.
    bool climb(double atLeastMm, std::span<const std::optional<DepthAscent>> others) noexcept {
        double window = kFirstLookMm;
        for (int i = 0; i < kLooks && window > kLastLookMm; ++i) {
            const double reached = look(window, false);
            if (top_ + 3.0 * window + kMixedErrorMm < atLeastMm) return false;
            for (const std::optional<DepthAscent>& other : others)
                if (other && (other->topMm_ - topMm_).squaredNorm() < kSameTopMm * kSameTopMm) return false;
            if (reached < 0.7) window *= 0.4;
            if (std::abs(u_) > kAnchorMm || std::abs(arc_) > kAnchorMm) anchorAnew();
        }
        return true;
    }
    /// What the depth is about here. Outside the tooth a field that has been cut may tell less than the distance: so
    /// from near its surface on.
    [[nodiscard]] double estimate() noexcept {
        double d = 0.0;
        for (int i = 0; i < kProjections; ++i) {
            d = depth_.surface_.distance(placeAt(bends(), u_, arc_, in_));
            if (d <= kGainMm || in_ <= 0.0) break;
            in_ = std::max(0.0, in_ - d);
            d = 0.0;
        }
        return spot_->deeperPerMm * in_ - d;
    }
    /// On from there by what the field is between its nodes.
    void climbSharply(FieldTouch& best) noexcept {
        double window = kFirstSharpLookMm, last = -std::numeric_limits<double>::infinity();
        for (int i = 0; i < kSharpLooks && window > kLastSharpLookMm && !isTop_; ++i) {
            const bool onWall = stepOnWall(window);
            const double reached = onWall ? 1.0 : look(window, true);
            if (top_ + 2.0 * window < best.depthMm) return;
            // Along a wall that follows the bur there is way without gain.
            if (!onWall && (reached < 0.7 || top_ < last + kGainMm)) window *= 0.25;
            last = top_;
            if (std::abs(u_) > kAnchorMm || std::abs(arc_) > kAnchorMm) anchorAnew();
        }
        settle(best);
    }

  private:
    void anchor(std::size_t spot, double cosine, double sine) noexcept {
        at_ = spot;
        spot_ = &depth_.spots_[spot];
        cosine_ = cosine;
        sine_ = sine;
        const Vec3 radial = cosine * frame_.x + sine * frame_.y;
        alongArc_ = cosine * frame_.y - sine * frame_.x;
        normal_ = spot_->normalRho * radial + spot_->normalZ * frame_.z;
        alongU_ = spot_->normalRho * frame_.z - spot_->normalZ * radial;
        place_ = frame_.tip + spot_->rho * radial + spot_->z * frame_.z;
        // Where the bur curls up inwards its parallel surfaces end.
        const double sharpest =
            std::max({spot_->curvatureBefore, spot_->curvatureAfter, spot_->curvatureAround, kTinyMm});
        curlsAt_ = spot_->isCorner ? spot_->inscribedMm : 0.98 / sharpest;
    }
    void anchorAnew() noexcept {
        const double rho = spot_->rho - u_ * spot_->normalZ, z = spot_->z + u_ * spot_->normalRho;
        const double out = core::hypot(rho, arc_);
        if (out < kTinyMm) return;
        const double c = rho / out, s = arc_ / out;
        const std::size_t next = spot_->isCorner ? at_ : depth_.nearestSpot(at_, out, z);
        anchor(next, c * cosine_ - s * sine_, s * cosine_ + c * sine_);
        u_ = spot_->isCorner ? 0.0 : (z - spot_->z) * spot_->normalRho - (out - spot_->rho) * spot_->normalZ;
        arc_ = 0.0;
        in_ = std::min(in_, most(u_));
        forget();
    }
    [[nodiscard]] double most(double u) const noexcept {
        if (spot_->isCorner) return spot_->inscribedMm;
        const double inscribed = spot_->inscribedMm + u * (u < 0.0 ? spot_->slopeBefore : spot_->slopeAfter);
        return std::clamp(inscribed, 0.0, curlsAt_);
    }
    /// How the bur's parallel surface bends `in_` inside it; from a corner, how the rim does.
    struct Bends {
        double before, after, around;
    };
    [[nodiscard]] Bends bends() const noexcept {
        if (spot_->isCorner) return {0.0, 0.0, 1.0 / std::max(spot_->rho, kTinyMm)};
        const auto inside = [this](double curvature) { return curvature / (1.0 - curvature * in_); };
        return {inside(spot_->curvatureBefore), inside(spot_->curvatureAfter), inside(spot_->curvatureAround)};
    }
    /// Steps along the outline and inwards that lead from the anchor to a place of the chart.
    void stepsTo(const Bends& bends, double u, double arc, double in, double& alongU, double& inwards) const noexcept {
        const double around = 0.5 * bends.around * arc * arc;
        if (spot_->isCorner) {  // along the rim, which bends towards the axis
            alongU = spot_->normalZ * around;
            inwards = in + spot_->normalRho * around;
        } else {
            alongU = u;
            inwards = in + 0.5 * (u < 0.0 ? bends.before : bends.after) * u * u + around;
        }
    }
    [[nodiscard]] Vec3 placeAt(const Bends& bends, double u, double arc, double in) const noexcept {
        double alongU = 0.0, inwards = 0.0;
        stepsTo(bends, u, arc, in, alongU, inwards);
        return {place_[0] + alongU * alongU_[0] + arc * alongArc_[0] - inwards * normal_[0],
                place_[1] + alongU * alongU_[1] + arc * alongArc_[1] - inwards * normal_[1],
                place_[2] + alongU * alongU_[2] + arc * alongArc_[2] - inwards * normal_[2]};
    }
    /// On the bur's inner ridge the way along it leads up or down.
    [[nodiscard]] bool isOnRidge() const noexcept { return !spot_->isCorner && in_ >= most(u_) - kTinyMm; }

    /// On a smooth wall, whose slope and bend the field knows: Newton's step, at most a window long. False where there
    /// is none. The step after one that led down begins where that one did, in a narrower window.
    bool stepOnWall(double& window) noexcept {
        if (spot_->isCorner || isOnRidge()) return false;
        const Bends bend = bends();
        field::SharpLookup::Wall wall;
        if (!depth_.surface_.wallAt(placeAt(bend, u_, arc_, in_), wall)) {
            forget();
            return false;
        }
        const double top = in_ - wall.distanceMm;
        if (top < before_.top - kWallGainMm) {
            u_ = before_.u;
            arc_ = before_.arc;
            in_ = before_.in;
            top_ = before_.top;
            window *= 0.25;
            forget();
            return true;
        }
        top_ = top;
        before_ = {u_, arc_, in_, top};
        const double along = u_ < 0.0 ? bend.before : bend.after, outward = wall.slope.dot(normal_);
        const Vec3 alongSide = alongU_ - along * u_ * normal_, around = alongArc_ - bend.around * arc_ * normal_;
        const Vec3 bendSide = wall.bendPerMm * alongSide, bendAround = wall.bendPerMm * around;
        const double gu = -wall.slope.dot(alongSide), ga = -wall.slope.dot(around);
        const double uu = along * outward - alongSide.dot(bendSide),
                     aa = bend.around * outward - around.dot(bendAround), ua = -alongSide.dot(bendAround),
                     det = uu * aa - ua * ua;
        double du = gu, da = ga;
        if (uu < 0.0 && aa < 0.0 && det > 1e-6 * uu * aa) {
            du = (ua * ga - aa * gu) / det;
            da = (ua * gu - uu * ga) / det;
        } else {  // no top in sight: as far as the window goes
            const double slope = std::sqrt(gu * gu + ga * ga);
            du *= window / std::max(slope, kTinyMm);
            da *= window / std::max(slope, kTinyMm);
        }
        const double share = std::min(1.0, window / std::max(kTinyMm, std::sqrt(du * du + da * da)));
        const double toU = u_ + share * du, u = std::clamp(toU, -spot_->roomBefore, spot_->roomAfter);
        du = u - u_;
        da *= share;
        if (u != toU && aa < 0.0)  // a corner is in the way: along it
            da = std::clamp(-(ga + ua * du) / aa, -window, window);
        const double gain = gu * du + ga * da + 0.5 * (uu * du * du + aa * da * da) + ua * du * da;
        isTop_ = gain < kWallGainMm;
        u_ = u;
        arc_ += da;
        in_ = std::clamp(top + gain, 0.0, most(u_));
        return true;
    }
    void forget() noexcept { before_.top = -std::numeric_limits<double>::infinity(); }

    /// Looks around and steps towards the top; returns how far, in windows.
    double look(double window, bool sharply) noexcept {
        const bool isCorner = spot_->isCorner, onRidge = isOnRidge();
        const Bends bend = bends();
        double us[8], arcs[8], ins[8], alongU[8], inwards[8];
        const double low = u_ - window, high = u_ + window;
        const bool isFree = !isCorner && !onRidge && low >= -spot_->roomBefore && high <= spot_->roomAfter &&
                            in_ <= std::min({most(low), most(0.0), most(high)});
        if (isFree) {  // as below, without limits
            for (int i = 0; i < 8; ++i) {
                us[i] = alongU[i] = u_ + window * kCosine[i];
                arcs[i] = arc_ + window * kSine[i];
                ins[i] = in_;
                inwards[i] = in_ + 0.5 * ((us[i] < 0.0 ? bend.before : bend.after) * us[i] * us[i] +
                                          bend.around * arcs[i] * arcs[i]);
            }
        } else {
            for (int i = 0; i < 8; ++i) {
                us[i] = isCorner ? 0.0 : std::clamp(u_ + window * kCosine[i], -spot_->roomBefore, spot_->roomAfter);
                arcs[i] = arc_ + window * kSine[i];
                ins[i] = isCorner  ? std::clamp(in_ + window * kCosine[i], 0.0, most(0.0))
                         : onRidge ? most(us[i])
                                   : std::min(in_, most(us[i]));
                stepsTo(bend, us[i], arcs[i], ins[i], alongU[i], inwards[i]);
            }
        }
        double distance[8];
        if (sharply) {
            std::array<Vec3, 8> places;
            for (std::size_t i = 0; i < 8; ++i)
                for (int k = 0; k < 3; ++k)
                    places[i][k] =
                        place_[k] + alongU[i] * alongU_[k] + arcs[i] * alongArc_[k] - inwards[i] * normal_[k];
            depth_.surface_.distances(places, distance);
        } else {
            AroundQuery query;
            store(query.centre, place_);
            store(query.alongU, alongU_);
            store(query.alongArc, alongArc_);
            store(query.inward, -normal_);
            query.farOutMm = static_cast<float>(depth_.field_.reach().outMm);
            query.farInMm = static_cast<float>(depth_.field_.reach().inMm);
            query.reachMm = 0.2 + in_;
            for (int i = 0; i < 8; ++i) {
                query.u[i] = static_cast<float>(alongU[i]);
                query.arc[i] = static_cast<float>(arcs[i]);
                query.in[i] = static_cast<float>(inwards[i]);
            }
            float mixed[8];
            depth_.kernels_.around(depth_.view_, query, mixed);
            std::copy_n(mixed, 8, distance);
        }
        double value[8];
        int highest = 0;
        for (int i = 0; i < 8; ++i) {
            value[i] = spot_->deeperPerMm * ins[i] - distance[i];
            if (value[i] > value[highest]) highest = i;
        }
        top_ = value[highest];
        double reached = highest == 0 ? 0.0 : 1.0;
        double toFirst = isCorner ? ins[highest] : us[highest], toArc = arcs[highest];
        double mean = 0.0, c1 = 0.0, s1 = 0.0, c2 = 0.0, s2 = 0.0;
        for (int i = 1; i < 8; ++i) {
            mean += value[i];
            c1 += value[i] * kCosine[i];
            s1 += value[i] * kSine[i];
            c2 += value[i] * kCosine2[i];
            s2 += value[i] * kSine2[i];
        }
        // A quadratic through them, in units of the window.
        const double bowl = 4.0 * (mean / kAround - value[0]), gu = 2.0 * c1 / kAround, ga = 2.0 * s1 / kAround;
        const double saddle = 8.0 * c2 / kAround, cross = 4.0 * s2 / kAround;
        const double uu = 0.5 * (bowl + saddle), aa = 0.5 * (bowl - saddle), det = uu * aa - cross * cross;
        if (uu < 0.0 && aa < 0.0 && det > 1e-6 * uu * aa) {
            const double du = -(aa * gu - cross * ga) / det, da = -(uu * ga - cross * gu) / det;
            reached = std::sqrt(du * du + da * da);
            const double share = reached > 1.0 ? 1.0 / reached : 1.0;
            toFirst = (isCorner ? in_ : u_) + window * share * du;
            toArc = arc_ + window * share * da;
        }
        arc_ = toArc;
        if (isCorner) {
            in_ = std::clamp(toFirst, 0.0, most(0.0));
        } else {
            u_ = std::clamp(toFirst, -spot_->roomBefore, spot_->roomAfter);
            in_ = std::clamp(ins[highest] - distance[highest], 0.0, most(u_));
        }
        topMm_ = placeAt(bend, u_, arc_, in_);
        return reached;
    }

  public:
    /// Onto the tooth's surface, and what the depth is there.
    void settle(FieldTouch& best) noexcept {
        bool lies = false;
        for (int i = 0; i <= kProjections; ++i) {
            // Where it did not come to lie on the surface in time the bur's own tells the distance.
            if (i == kProjections && (lies || in_ <= 0.0)) break;
            if (i == kProjections) in_ = 0.0;
            const Bends bend = bends();
            const Vec3 p = placeAt(bend, u_, arc_, in_);
            const double d = depth_.surface_.distance(p), depth = depth_.depthAt(frame_, p, d);
            // Outside the tooth a field that has been cut may tell less than the distance.
            const bool trusted = (d <= kOnSurfaceMm && d > -depth_.inMm_) || in_ <= 0.0;
            lies = lies || trusted;
            if (trusted && depth > best.depthMm) {
                best.depthMm = depth;
                best.normal = awayAt(bend, p);
                best.surfaceMm = p - d * best.normal;
            }
            const double next = std::clamp(in_ - d, 0.0, most(u_));
            if (std::abs(next - in_) < kOnSurfaceMm || (spot_->isCorner && d <= 0.0)) break;
            in_ = next;
        }
    }

  private:
    [[nodiscard]] Vec3 awayAt(const Bends& bend, const Vec3& p) const noexcept {
        if (spot_->isCorner) {
            const Vec3 slope = depth_.outward(p);
            if (!slope.isZero()) return slope;
            return -normal_;
        }
        return -(normal_ + (u_ < 0.0 ? bend.before : bend.after) * u_ * alongU_ + bend.around * arc_ * alongArc_)
                    .normalized();
    }

    FieldDepth& depth_;
    const BurFrame& frame_;
    std::size_t at_;
    const Spot* spot_ = nullptr;
    double cosine_ = 1.0, sine_ = 0.0;
    Vec3 place_, normal_, alongU_, alongArc_;
    Vec3 topMm_ = Vec3::Zero();  ///< where the climb has come to
    double curlsAt_ = 0.0;
    double u_ = 0.0, arc_ = 0.0, in_, top_ = 0.0;
    bool isTop_ = false;
    struct {
        double u, arc, in, top;
    } before_{0.0, 0.0, 0.0, -std::numeric_limits<double>::infinity()};  ///< the last step on a wall
};

FieldTouch FieldDepth::search(const core::Pose& burInTooth, SurfaceSampler& rings) noexcept {
    FieldTouch best;
    const BurFrame frame(burInTooth);
    double topZ = 0.0;
    const double top = deepestOfAxis(frame, topZ);
    if (top > inMm_) {  // deeper than the values on its surface can tell
        climbAxis(frame, top, topZ, best);
        searchInside(frame, best);
        return best;
    }
    // What the rings have sensed here serves again; else every second point of every second ring is near enough to
    // begin to climb.
    const bool sensed = rings.hasSensed(burInTooth, outMm_, windowMm_);
    if (!sensed) sense(probe_, frame, 2.0 * windowMm_);
    const double least = sensed ? rings.leastMm() : leastOf(probe_);
    if (!(least <= outMm_)) return best;
    if (least <= -inMm_) searchInside(frame, best);
    const RingArrays& arrays = sensed ? rings.arrays() : probe_;
    std::array<RingPoint, kStarts> points;
    const std::size_t count = pickNearest(arrays, nullptr, sensed ? windowMm_ : 2.0 * windowMm_, kApartMm, points);
    std::array<Start, kStarts> starts;
    std::size_t found = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const RingPoint& p = points[i];
        if (p.gapMm <= -inMm_) continue;
        const std::size_t spot = sensed ? p.ring : probeSpot_[p.ring];
        const double in = spots_[spot].isCorner ? 0.0 : std::max(0.0, -p.gapMm);
        starts[found++] = {spot, static_cast<double>(arrays.cosines[p.angle]),
                           static_cast<double>(arrays.sines[p.angle]), in};
    }
    climbFrom(frame, {starts.data(), found}, best);
    return best;
}

void FieldDepth::sense(const RingArrays& arrays, const BurFrame& frame, double windowMm) const noexcept {
    RingQuery query{};
    query.tip = frame.tip.data();
    query.x = frame.x.data();
    query.y = frame.y.data();
    query.z = frame.z.data();
    query.thresholdMm = static_cast<float>(outMm_);
    query.farOutMm = static_cast<float>(field_.reach().outMm);
    query.farInMm = static_cast<float>(field_.reach().inMm);
    query.tissue = 0;
    query.onlyDistances = true;
    query.windowMm = static_cast<float>(windowMm);
    kernels_.sense(view_, arrays.bur, query, arrays.touch);
}

/// Values on the bur's surface no longer tell how deep it is: its inside does.
void FieldDepth::searchInside(const BurFrame& frame, FieldTouch& best) noexcept {
    if (inner_.rings.empty()) return;
    sense(inner_, frame, 0.0);
    std::array<RingPoint, kStarts> points;
    std::array<Start, kStarts> starts;
    const std::size_t count = pickNearest(inner_, innerDepth_.data(), kInnerWindowMm, kApartMm, points);
    for (std::size_t i = 0; i < count; ++i) {
        const RingPoint& p = points[i];
        starts[i] = {innerSpot_[p.ring], static_cast<double>(inner_.cosines[p.angle]),
                     static_cast<double>(inner_.sines[p.angle]), static_cast<double>(innerIn_[p.ring])};
    }
    climbFrom(frame, {starts.data(), count}, best);
}

/// All of them in the mixed field, then the highest on between the nodes.
void FieldDepth::climbFrom(const BurFrame& frame, std::span<const Start> starts, FieldTouch& best) noexcept {
    std::array<std::optional<DepthAscent>, kStarts> ascents;
    std::array<double, kStarts> tops{};
    double highest = best.depthMm;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        DepthAscent& ascent = ascents[i].emplace(*this, frame, starts[i]);
        if (!ascent.climb(highest, {ascents.data(), i})) {
            ascents[i].reset();
            continue;
        }
        tops[i] = ascent.estimate();
        highest = std::max(highest, tops[i]);
    }
    for (int climbs = 0; climbs < kSharpClimbs; ++climbs) {
        std::size_t top = kStarts;
        for (std::size_t i = 0; i < starts.size(); ++i)
            if (ascents[i] && (top == kStarts || tops[i] > tops[top])) top = i;
        if (top == kStarts || tops[top] + kClimbMm < best.depthMm) return;
        ascents[top]->climbSharply(best);
        ascents[top].reset();
    }
}

void FieldDepth::takeAxis(const BurFrame& frame, double z, FieldTouch& best) noexcept {
    Vec3 p = frame.onAxis(z);
    double d = surface_.distance(p);
    const Vec3 away = outward(p);
    Vec3 q = p;
    if (d > 0.0) {  // beside an edge a field that has been cut tells less than the distance: ask on the surface
        for (int i = 0; i < kProjections; ++i)
            q -= surface_.distance(q) * surface_.lookup().normal(q);
        p = q;
        d = surface_.distance(p);
        if (d > kBesideMm) return;  // farther out than values tell: no way led onto the surface
    } else {
        q = p - d * away;
    }
    const double depth = depthAt(frame, p, d);
    if (depth > best.depthMm) best = {depth, away, q};
}

double FieldDepth::scanAxis(const BurFrame& frame, double fromZ, double step, int count, double& topZ) const noexcept {
    AroundQuery query{};
    store(query.alongU, frame.z);
    query.farOutMm = static_cast<float>(field_.reach().outMm);
    query.farInMm = static_cast<float>(field_.reach().inMm);
    query.reachMm = 8.0 * step;
    double top = -std::numeric_limits<double>::infinity();
    for (int first = 0; first < count; first += 8) {
        const double from = fromZ + first * step;
        store(query.centre, frame.onAxis(from));
        double z[8];
        for (int i = 0; i < 8; ++i) {
            z[i] = std::clamp(from + step * i, axis_.front().zMm, axis_.back().zMm);
            query.u[i] = static_cast<float>(z[i] - from);
        }
        float distance[8];
        kernels_.around(view_, query, distance);
        for (int i = 0; i < 8; ++i) {
            const auto d = static_cast<double>(distance[i]);
            // Farther out than the band the field does not say how far.
            if (!(d < outMm_)) continue;
            const double value = radiusAt(z[i]) - d;
            if (value > top) {
                top = value;
                topZ = z[i];
            }
        }
    }
    return top;
}

/// The deepest ball of the axis to within its spacing; minus infinity when all of it is farther out than the band.
double FieldDepth::deepestOfAxis(const BurFrame& frame, double& topZ) const noexcept {
    if (axis_.empty()) return -std::numeric_limits<double>::infinity();
    const double low = axis_.front().zMm, length = axis_.back().zMm - low;
    const int steps = std::max(1, static_cast<int>(std::ceil(length / kAxisSpacingMm)));
    return scanAxis(frame, low, length / steps, steps + 1, topZ);
}

void FieldDepth::climbAxis(const BurFrame& frame, double top, double topZ, FieldTouch& best) noexcept {
    for (double step = 0.25 * kAxisSpacingMm; step > 1e-4; step *= 0.25) {
        double z = topZ;
        const double value = scanAxis(frame, std::max(axis_.front().zMm, topZ - 3.5 * step), step, 8, z);
        if (value <= top) continue;
        top = value;
        topZ = z;
    }
    takeAxis(frame, topZ, best);
}

}  // namespace handpiece::contact
