// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/exact/outline_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::contact {

using core::Vec2;
using core::Vec3;
using instrument::ProfilePiece;

namespace {

constexpr int kTangents = 17;  // from -z over rho to +z, beside those of the pieces' ends
constexpr double kStraightMm = 1e-9;
constexpr double kUnsureMm = 1e-5;  // more than a hit falls short of the least

void store(double (&to)[2], const Vec2& v) {
    to[0] = v.x();
    to[1] = v.y();
}

bool isConvex(const std::vector<ProfilePiece>& pieces) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (pieces[i].isArc && !pieces[i].convex) return false;
        if (i > 0 && jointBetween(pieces[i - 1], pieces[i]) == instrument::Joint::reflex) return false;
    }
    return true;
}

/// How far the bur reaches along a direction of the half-plane.
double supportOf(const std::vector<ProfilePiece>& pieces, const Vec2& direction) {
    double most = -std::numeric_limits<double>::infinity();
    for (const ProfilePiece& p : pieces) {
        most = std::max({most, direction.dot(p.from), direction.dot(p.to)});
        const Vec2 top = p.centre + p.radiusMm * direction;
        if (p.isArc && isOnArc(p, top)) most = std::max(most, direction.dot(top));
    }
    return most;
}

/// Whether a sheet begins at a rim that meets the tooth: those by the shank alone are told in a lookup or two.
bool hasRimBelow(const instrument::Bur& bur) {
    const auto& curves = bur.medialAxis();
    return std::any_of(curves.begin(), curves.end(), [&](const instrument::MedialCurve& curve) {
        return !curve.onAxis && std::any_of(curve.balls.begin(), curve.balls.end(),
                                            [&](const auto& ball) { return ball.zMm < 0.5 * bur.lengthMm(); });
    });
}

std::unique_ptr<const Outline> outlineOf(const instrument::Bur& bur) {
    const std::vector<ProfilePiece>& pieces = bur.profile().pieces;
    if (!hasRimBelow(bur) || pieces.size() > static_cast<std::size_t>(kMaxOutlinePieces) || !isConvex(pieces))
        return nullptr;
    auto outline = std::make_unique<Outline>();
    const auto addTangent = [&](const Vec2& normal) {
        // A normal towards the axis, of rounding, bounds nothing on the other side of it.
        if (normal.x() < 0.0 || outline->tangentCount == kMaxOutlineTangents) return;
        outline->tangents[outline->tangentCount++] = {static_cast<float>(normal.x()), static_cast<float>(normal.y()),
                                                      static_cast<float>(supportOf(pieces, normal))};
    };
    for (int i = 0; i < kTangents; ++i) {
        const double angle = std::numbers::pi * (static_cast<double>(i) / (kTangents - 1) - 0.5);
        addTangent({std::max(0.0, core::cos(angle)), core::sin(angle)});
    }
    for (const ProfilePiece& p : pieces) {
        if ((p.to - p.from).norm() < kStraightMm) continue;
        OutlinePiece& piece = outline->pieces[outline->pieceCount++];
        const Vec2 first = -inwardNormalAt(p, 0.0), last = -inwardNormalAt(p, 1.0);
        store(piece.from, p.from);
        store(piece.to, p.to);
        store(piece.normalFrom, first);
        store(piece.normalTo, last);
        store(piece.centre, p.centre);
        piece.radius = p.isArc ? p.radiusMm : 0.0;
        addTangent(first);
        if (p.isArc) addTangent(last);
    }
    outline->middleZ = 0.5 * bur.lengthMm();
    outline->middleDepthMm = -bur.signedDistance({0.0, 0.0, outline->middleZ});
    return outline;
}

}  // namespace

OutlineSearch::OutlineSearch(const instrument::Bur& bur, core::SimdLevel level)
    : outline_(outlineOf(bur)), nearest_(HANDPIECE_AT_SIMD_LEVEL(level, nearestToOutline)()) {}

double OutlineSearch::search(const ExactSurface& surface, const BurFrame& frame, BallDepth& best) noexcept {
    OutlineHit hit;
    hit.distance = -best.depthMm;
    hit.triangle = seed_;
    nearest_(surface.view(), *outline_, frame.tip.data(), frame.z.data(), hit);
    constexpr double kAny = std::numeric_limits<double>::infinity();
    if (hit.triangle != geometry::kNoTriangle) {
        seed_ = hit.triangle;
        best.depthMm = -hit.distance;
        best.surfaceMm = Vec3(hit.point[0], hit.point[1], hit.point[2]);
        // Somewhere on the way to the ball's centre: which of the balls there it is does not matter.
        best.centreMm = best.surfaceMm + Vec3(hit.inwards[0], hit.inwards[1], hit.inwards[2]);
        best.triangle = hit.triangle;
        best.inside = false;
    }
    // A bur that lies in the tooth may meet little of its surface, or none.
    if (!(surface.farBound(frame.onAxis(outline_->middleZ)) > surface.sureMm())) return kAny;
    if (hit.distance > 0.0) return 0.0;
    const double largest = kUnsureMm - hit.distance;
    return largest < outline_->middleDepthMm ? largest : kAny;
}

}  // namespace handpiece::contact
