// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/medial_axis.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::instrument {

using core::Vec2;
using core::Vec3;

namespace {

constexpr int kAxis = -1;
constexpr double kSampleSpacingMm = 0.01;
constexpr double kSameBallMm = 1e-8;

double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// A piece of the outline, or a reflex corner between two, around which the normal turns.
struct Element {
    bool isCorner = false;
    std::size_t piece = 0;  ///< or the piece before the corner
    Vec2 corner = Vec2::Zero();
    double startRad = 0.0, sweepRad = 0.0;  ///< of the inward normal at a corner
};

/// The largest ball that touches the outline at one point, and the element that stops it from growing.
struct Touch {
    MedialBall ball;
    int partner = kAxis;
};

class Walk {
  public:
    explicit Walk(const Profile& profile) : profile_(profile) {
        const std::size_t count = profile.pieces.size();
        for (std::size_t i = 0; i < count; ++i) {
            elements_.push_back({false, i, Vec2::Zero(), 0.0, 0.0});
            if (i + 1 == count) break;
            joints_.push_back(jointBetween(profile.pieces[i], profile.pieces[i + 1]));
            if (joints_.back() != Joint::reflex) continue;
            const Vec2 a = inwardNormalAt(profile.pieces[i], 1.0), b = inwardNormalAt(profile.pieces[i + 1], 0.0);
            elements_.push_back(
                {true, i, profile.pieces[i].to, core::atan2(a.y(), a.x()), core::atan2(cross(a, b), a.dot(b))});
        }
    }

    std::vector<MedialCurve> curves() {
        for (std::size_t e = 0; e < elements_.size(); ++e)
            walkElement(static_cast<int>(e));
        return finish();
    }

  private:
    [[nodiscard]] Touch touchAt(int e, double t) const {
        const Element& element = elements_[static_cast<std::size_t>(e)];
        if (element.isCorner) {
            const double angle = element.startRad + t * element.sweepRad;
            return grow(e, element.corner, {core::cos(angle), core::sin(angle)}, t);
        }
        const ProfilePiece& piece = profile_.pieces[element.piece];
        return grow(e, pointAt(piece, t), inwardNormalAt(piece, t), t);
    }

    [[nodiscard]] Touch grow(int e, const Vec2& p, const Vec2& n, double t) const {
        const Element& self = elements_[static_cast<std::size_t>(e)];
        if (!self.isCorner) {
            // A ball in a convex corner has no size: no rounding may let it out.
            const auto isConvex = [&](std::size_t joint) {
                return joint < joints_.size() && joints_[joint] == Joint::convex;
            };
            if (t <= 0.0 && self.piece > 0 && isConvex(self.piece - 1)) return {{p.x(), p.y(), 0.0}, e - 1};
            if (t >= 1.0 && isConvex(self.piece)) return {{p.x(), p.y(), 0.0}, e + 1};
        }
        double best = std::numeric_limits<double>::infinity();
        int partner = kAxis;
        if (n.x() < -1e-15) best = std::max(0.0, p.x()) / -n.x();
        const auto offer = [&](double radius, int who) {
            if (radius < best - 1e-13) {
                best = radius;
                partner = who;
            }
        };
        if (!self.isCorner) {
            const ProfilePiece& piece = profile_.pieces[self.piece];
            if (piece.isArc && piece.convex) offer(piece.radiusMm, e);
        }
        for (int f = 0; f < static_cast<int>(elements_.size()); ++f) {
            if (f == e) continue;
            if (const std::optional<double> radius = stoppedBy(self, p, n, elements_[static_cast<std::size_t>(f)]))
                offer(*radius, f);
        }
        Vec2 centre = p + best * n;
        if (partner == kAxis || (partner == e && std::abs(centre.x()) < 1e-12)) {
            centre.x() = 0.0;
            partner = kAxis;
        }
        if (centre.x() < 1e-11) centre.x() = 0.0;  // the end of a sheet on the axis
        return {{centre.x(), centre.y(), best}, partner};
    }

    /// Radius at which the ball growing from p along n meets an element from the inside.
    [[nodiscard]] std::optional<double> stoppedBy(const Element& self, const Vec2& p, const Vec2& n,
                                                  const Element& other) const {
        if (other.isCorner) {
            if (!self.isCorner && (self.piece == other.piece || self.piece == other.piece + 1)) return {};
            const Vec2 to = other.corner - p;
            const double toward = 2.0 * n.dot(to);
            if (toward <= 1e-12) return {};
            return to.squaredNorm() / toward;
        }
        const ProfilePiece& piece = profile_.pieces[other.piece];
        Joint joint = Joint::convex;
        std::optional<Vec2> shared;
        if (self.isCorner) {
            if (other.piece == self.piece || other.piece == self.piece + 1) {
                joint = Joint::reflex;
                shared = self.corner;
            }
        } else if (other.piece == self.piece + 1) {
            joint = joints_[self.piece];
            shared = piece.from;
        } else if (other.piece + 1 == self.piece) {
            joint = joints_[other.piece];
            shared = piece.to;
        }
        // Pieces that meet smoothly never stop each other: their circles touch at the joint and nowhere else.
        if (shared && joint == Joint::smooth) return {};
        double radius = 0.0;
        Vec2 foot;
        if (!piece.isArc) {
            const Vec2 m = inwardNormalAt(piece, 0.0), d = piece.to - piece.from;
            const double off = m.dot(p - piece.from), closing = 1.0 - n.dot(m);
            if (closing < 1e-12 || off < -1e-12) return {};
            radius = std::max(0.0, off) / closing;
            foot = p + radius * (n - m);
            const double along = d.dot(foot - piece.from), slack = 1e-10 * d.norm();
            if (along < -slack || along > d.squaredNorm() + slack) return {};
        } else {
            const Vec2 v = p - piece.centre;
            const double r = piece.radiusMm, sign = piece.convex ? 1.0 : -1.0;
            const double off = sign * (r * r - v.squaredNorm()), closing = 2.0 * (r + sign * n.dot(v));
            if (closing < 1e-12 || off < -1e-12) return {};
            radius = std::max(0.0, off) / closing;
            const Vec2 fromCentre = p + radius * n - piece.centre;
            const double length = fromCentre.norm();
            if (length > 1e-12) {
                foot = piece.centre + fromCentre * (r / length);
                if (!isOnArc(piece, foot) && (foot - piece.from).norm() > 1e-10 && (foot - piece.to).norm() > 1e-10)
                    return {};
            } else {
                foot = piece.from;
            }
        }
        if (shared && joint == Joint::reflex && (foot - *shared).norm() < 1e-9) return {};
        return radius;
    }

    void walkElement(int e) {
        const Element& element = elements_[static_cast<std::size_t>(e)];
        const double length = element.isCorner ? std::abs(element.sweepRad) : lengthMm(profile_.pieces[element.piece]);
        const int samples = std::max(32, static_cast<int>(std::ceil(length / kSampleSpacingMm)));
        double t = 0.0;
        Touch touch = touchAt(e, 0.0);
        intervalStart_ = 0.0;
        for (int i = 1; i <= samples; ++i) {
            const double next = i == samples ? 1.0 : static_cast<double>(i) / samples;
            const Touch nextTouch = touchAt(e, next);
            findChanges(e, t, touch, next, nextTouch);
            t = next;
            touch = nextTouch;
        }
        closeInterval(e, 1.0, touch.partner);
    }

    /// Closes an interval at each place between a and b where the partner changes.
    void findChanges(int e, double ta, const Touch& a, double tb, const Touch& b) {
        if (a.partner == b.partner) return;
        if (tb - ta < 1e-13) {
            closeInterval(e, ta, a.partner);
            intervalStart_ = tb;
            return;
        }
        const double middle = 0.5 * (ta + tb);
        if (middle <= ta || middle >= tb) {
            closeInterval(e, ta, a.partner);
            intervalStart_ = tb;
            return;
        }
        const Touch m = touchAt(e, middle);
        findChanges(e, ta, a, middle, m);
        findChanges(e, middle, m, tb, b);
    }

    void closeInterval(int e, double end, int partner) {
        const double start = intervalStart_;
        if (partner == e) {
            lone_.push_back(touchAt(e, 0.5 * (start + end)).ball);
            return;
        }
        if (partner != kAxis && partner < e) return;  // walked from the other side
        std::vector<MedialBall> balls{touchAt(e, start).ball};
        subdivide(e, start, balls.front(), end, touchAt(e, end).ball, balls, 0);
        MedialCurve curve{std::move(balls), partner == kAxis};
        if (curve.onAxis)
            for (MedialBall& ball : curve.balls)
                ball.rhoMm = 0.0;
        std::vector<MedialCurve>& kind = curve.onAxis ? axis_ : sheets_;
        if (!kind.empty() && distance(kind.back().balls.back(), curve.balls.front()) < kSameBallMm)
            kind.back().balls.insert(kind.back().balls.end(), curve.balls.begin() + 1, curve.balls.end());
        else
            kind.push_back(std::move(curve));
    }

    static Vec3 asPoint(const MedialBall& b) { return {b.rhoMm, b.zMm, b.radiusMm}; }
    static double distance(const MedialBall& a, const MedialBall& b) { return (asPoint(a) - asPoint(b)).norm(); }
    static double distanceToChord(const MedialBall& ball, const MedialBall& from, const MedialBall& to) {
        const Vec3 d = asPoint(to) - asPoint(from), w = asPoint(ball) - asPoint(from);
        const double dd = d.squaredNorm();
        const double u = dd > 0.0 ? std::clamp(w.dot(d) / dd, 0.0, 1.0) : 0.0;
        return (w - u * d).norm();
    }

    /// Appends balls after `a` up to and including `b`, dense enough for the tolerance.
    void subdivide(int e, double ta, const MedialBall& a, double tb, const MedialBall& b, std::vector<MedialBall>& out,
                   int depth) const {
        constexpr double kTolerance = 0.05 * kMedialToleranceMm;
        const MedialBall m = touchAt(e, 0.5 * (ta + tb)).ball;
        const bool isStraight = distanceToChord(m, a, b) < kTolerance &&
                                distanceToChord(touchAt(e, 0.75 * ta + 0.25 * tb).ball, a, b) < kTolerance &&
                                distanceToChord(touchAt(e, 0.25 * ta + 0.75 * tb).ball, a, b) < kTolerance;
        if (isStraight || depth == 24) {
            out.push_back(b);
            return;
        }
        subdivide(e, ta, a, 0.5 * (ta + tb), m, out, depth + 1);
        subdivide(e, 0.5 * (ta + tb), m, tb, b, out, depth + 1);
    }

    /// Drops balls that lie on the chord of their neighbours within the tolerance (Douglas and Peucker).
    static std::vector<MedialBall> simplified(const std::vector<MedialBall>& balls) {
        std::vector<char> keep(balls.size(), 0);
        keep.front() = keep.back() = 1;
        std::vector<std::pair<std::size_t, std::size_t>> open{{0, balls.size() - 1}};
        while (!open.empty()) {
            const auto [first, last] = open.back();
            open.pop_back();
            double worst = 0.95 * kMedialToleranceMm;
            std::size_t at = first;
            for (std::size_t i = first + 1; i < last; ++i) {
                const double d = distanceToChord(balls[i], balls[first], balls[last]);
                if (d > worst) {
                    worst = d;
                    at = i;
                }
            }
            if (at == first) continue;
            keep[at] = 1;
            open.push_back({first, at});
            open.push_back({at, last});
        }
        std::vector<MedialBall> kept;
        for (std::size_t i = 0; i < balls.size(); ++i)
            if (keep[i]) kept.push_back(balls[i]);
        return kept;
    }

    /// Along a cylinder all radii are the same to the last bit.
    static std::vector<MedialBall> evened(std::vector<MedialBall> balls) {
        for (std::size_t i = 1; i < balls.size(); ++i)
            if (std::abs(balls[i].radiusMm - balls[i - 1].radiusMm) < 1e-13) balls[i].radiusMm = balls[i - 1].radiusMm;
        return balls;
    }

    static bool isPoint(const MedialCurve& curve) {
        return std::all_of(curve.balls.begin(), curve.balls.end(),
                           [&](const MedialBall& b) { return distance(b, curve.balls.front()) < kSameBallMm; });
    }

    std::vector<MedialCurve> finish() {
        std::vector<MedialCurve> curves;
        std::vector<MedialBall> points = lone_;
        for (std::vector<MedialCurve>* kind : {&axis_, &sheets_})
            for (MedialCurve& curve : *kind) {
                if (isPoint(curve))
                    points.push_back(curve.balls.front());
                else
                    curves.push_back({evened(simplified(curve.balls)), curve.onAxis});
            }
        // The centre of a round edge ends a sheet and needs no curve of its own; that of a sphere is all there is.
        for (const MedialBall& point : points) {
            const bool isKnown = std::any_of(curves.begin(), curves.end(), [&](const MedialCurve& curve) {
                for (std::size_t i = 0; i + 1 < curve.balls.size(); ++i)
                    if (distanceToChord(point, curve.balls[i], curve.balls[i + 1]) < kMedialToleranceMm) return true;
                return false;
            });
            if (!isKnown && point.radiusMm > kSameBallMm) curves.push_back({{point, point}, point.rhoMm == 0.0});
        }
        std::stable_partition(curves.begin(), curves.end(), [](const MedialCurve& curve) { return curve.onAxis; });
        return curves;
    }

    const Profile& profile_;
    std::vector<Element> elements_;
    std::vector<Joint> joints_;  ///< between pieces i and i + 1
    double intervalStart_ = 0.0;
    std::vector<MedialCurve> axis_, sheets_;
    std::vector<MedialBall> lone_;
};

}  // namespace

std::vector<MedialCurve> medialAxis(const Profile& profile) {
    return Walk(profile).curves();
}

}  // namespace handpiece::instrument
