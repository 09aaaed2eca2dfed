// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/fillet.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::instrument {
namespace {

using core::Vec2;

constexpr double kSamePlaceMm = 1e-9;
constexpr double kOnAxisMm = 1e-6;
constexpr double kMinRadiusMm = 1e-3;  // smaller ones are not worth an arc
constexpr double kKeptShare = 0.45;    // of a piece at most is taken away by the fillet at one of its ends

/// Nearest point of a piece to `p`, and how far along the piece it is (0..1).
struct Foot {
    Vec2 at;
    double t;
};
Foot footOn(const ProfilePiece& piece, const Vec2& p) {
    if (!piece.isArc) {
        const Vec2 way = piece.to - piece.from;
        const double t = std::clamp((p - piece.from).dot(way) / way.squaredNorm(), 0.0, 1.0);
        return {piece.from + t * way, t};
    }
    const Vec2 from = piece.from - piece.centre, to = p - piece.centre;
    const double angle = core::atan2(from.x() * to.y() - from.y() * to.x(), from.dot(to));
    const double t = std::clamp(angle / arcSweepRad(piece), 0.0, 1.0);
    return {pointAt(piece, t), t};
}

double turnRad(const ProfilePiece& before, const ProfilePiece& after) {
    const Vec2 a = inwardNormalAt(before, 1.0), b = inwardNormalAt(after, 0.0);
    return core::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

/// The medial sheet that starts in a corner, from the corner on.
std::optional<std::vector<MedialBall>> sheetFrom(const Bur& bur, const Vec2& corner) {
    for (const MedialCurve& curve : bur.medialAxis()) {
        if (curve.onAxis || curve.balls.size() < 2) continue;
        const auto isHere = [&](const MedialBall& b) {
            return b.radiusMm < kSamePlaceMm && (Vec2(b.rhoMm, b.zMm) - corner).norm() < kSamePlaceMm;
        };
        if (isHere(curve.balls.front())) return curve.balls;
        if (isHere(curve.balls.back())) return std::vector<MedialBall>(curve.balls.rbegin(), curve.balls.rend());
    }
    return std::nullopt;
}

/// The centre near `start` of a ball of that radius touching both pieces: balls of a sheet are exact to microns.
Vec2 centreAt(const ProfilePiece& before, const ProfilePiece& after, const Vec2& start, double radius) {
    Vec2 centre = start;
    for (int i = 0; i < 4; ++i) {
        const Vec2 a = centre - footOn(before, centre).at, b = centre - footOn(after, centre).at;
        const double da = a.norm(), db = b.norm();
        const Vec2 ua = a / da, ub = b / db;
        const double determinant = ua.x() * ub.y() - ua.y() * ub.x();
        if (!(std::abs(determinant) > 1e-6)) break;
        const double ra = radius - da, rb = radius - db;
        centre += Vec2(ra * ub.y() - rb * ua.y(), rb * ua.x() - ra * ub.x()) / determinant;
    }
    return centre;
}

ProfilePiece shortened(ProfilePiece piece, const Vec2& from, const Vec2& to) {
    piece.from = from;
    piece.to = to;
    return piece;
}

}  // namespace

Bur filleted(const Bur& bur, double radiusMm) {
    const std::vector<ProfilePiece>& pieces = bur.profile().pieces;
    struct Cut {
        Vec2 before = Vec2::Zero(), after = Vec2::Zero();  // where the arc touches the pieces
        Vec2 centre = Vec2::Zero();
        double radius = 0.0;
    };
    std::vector<Cut> cuts(pieces.size());  // at the start of each piece
    bool any = false;
    for (std::size_t i = 1; i < pieces.size(); ++i) {
        const ProfilePiece &before = pieces[i - 1], &after = pieces[i];
        const Vec2 corner = after.from;
        if (corner.x() < kOnAxisMm || jointBetween(before, after) != Joint::convex ||
            std::abs(turnRad(before, after)) < kFilletCornerRad)
            continue;
        const auto sheet = sheetFrom(bur, corner);
        if (!sheet) continue;
        // The largest ball that still touches both pieces well away from their other ends.
        Cut best;
        for (std::size_t k = 1; k < sheet->size(); ++k) {
            const MedialBall &low = (*sheet)[k - 1], &high = (*sheet)[k];
            if (high.radiusMm <= low.radiusMm) break;
            constexpr int kSteps = 16;
            bool fits = true;
            for (int s = 1; s <= kSteps && fits; ++s) {
                const double wanted = low.radiusMm + (high.radiusMm - low.radiusMm) * s / kSteps;
                const double radius = std::min(wanted, radiusMm);
                const double t = (radius - low.radiusMm) / (high.radiusMm - low.radiusMm);
                const Vec2 near(low.rhoMm + t * (high.rhoMm - low.rhoMm), low.zMm + t * (high.zMm - low.zMm));
                const Vec2 centre = centreAt(before, after, near, radius);
                const Foot a = footOn(before, centre), b = footOn(after, centre);
                fits = a.t > 1.0 - kKeptShare && b.t < kKeptShare;
                if (fits) best = {a.at, b.at, centre, radius};
                if (radius >= radiusMm) fits = false;
            }
            if (!fits) break;
        }
        if (best.radius < kMinRadiusMm) continue;
        cuts[i] = best;
        any = true;
    }
    if (!any) return bur;
    Profile rounded;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const bool starts = cuts[i].radius > 0.0, ends = i + 1 < pieces.size() && cuts[i + 1].radius > 0.0;
        if (starts) {
            ProfilePiece arc;
            arc.isArc = true;
            arc.convex = true;
            arc.from = cuts[i].before;
            arc.to = cuts[i].after;
            arc.centre = cuts[i].centre;
            arc.radiusMm = cuts[i].radius;
            rounded.pieces.push_back(arc);
        }
        rounded.pieces.push_back(
            shortened(pieces[i], starts ? cuts[i].after : pieces[i].from, ends ? cuts[i + 1].before : pieces[i].to));
    }
    return {bur.name(), std::move(rounded)};
}

}  // namespace handpiece::instrument
