// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::instrument {

using core::Vec2;

namespace {

constexpr double kJointToleranceMm = 1e-9;

double cross(const Vec2& a, const Vec2& b) noexcept {
    return a.x() * b.y() - a.y() * b.x();
}

Vec2 tangentAt(const ProfilePiece& piece, double t) {
    const Vec2 n = inwardNormalAt(piece, t);
    return {n.y(), -n.x()};
}

/// Largest value of the outline along a direction (unit axis 0 or 1).
double extent(const Profile& profile, int axis) {
    double most = 0.0;
    for (const ProfilePiece& piece : profile.pieces) {
        most = std::max({most, piece.from[axis], piece.to[axis]});
        if (!piece.isArc) continue;
        Vec2 top = piece.centre;
        top[axis] += piece.radiusMm;
        if (isOnArc(piece, top)) most = std::max(most, top[axis]);
    }
    return most;
}

/// Least value of the outline along a direction.
double lowest(const ProfilePiece& piece, int axis) {
    double least = std::min(piece.from[axis], piece.to[axis]);
    if (piece.isArc) {
        Vec2 bottom = piece.centre;
        bottom[axis] -= piece.radiusMm;
        if (isOnArc(piece, bottom)) least = std::min(least, bottom[axis]);
    }
    return least;
}

/// The outline as chords of at most 2 degrees, each with the piece it comes from.
struct Chord {
    Vec2 from, to;
    std::size_t piece;
};
std::vector<Chord> chordsOf(const Profile& profile) {
    std::vector<Chord> chords;
    for (std::size_t i = 0; i < profile.pieces.size(); ++i) {
        const ProfilePiece& piece = profile.pieces[i];
        const int steps =
            piece.isArc ? 1 + static_cast<int>(std::abs(arcSweepRad(piece)) * 90.0 / std::numbers::pi) : 1;
        for (int k = 0; k < steps; ++k)
            chords.push_back({pointAt(piece, static_cast<double>(k) / steps), pointAt(piece, (k + 1.0) / steps), i});
    }
    return chords;
}

bool cross(const Chord& a, const Chord& b) {
    const Vec2 da = a.to - a.from, db = b.to - b.from;
    return cross(da, b.from - a.from) * cross(da, b.to - a.from) < 0.0 &&
           cross(db, a.from - b.from) * cross(db, a.to - b.from) < 0.0;
}

[[noreturn]] void refuse(const std::string& what) {
    throw core::Error("this outline is no bur: " + what, {}, "check the points and arcs of the outline");
}

}  // namespace

double arcStartRad(const ProfilePiece& arc) {
    return core::atan2(arc.from.y() - arc.centre.y(), arc.from.x() - arc.centre.x());
}

double arcSweepRad(const ProfilePiece& arc) {
    const Vec2 a = arc.from - arc.centre, b = arc.to - arc.centre;
    double sweep = core::atan2(cross(a, b), a.dot(b));
    // A half circle may come out as either +pi or -pi: the bulge says which.
    if (arc.convex && sweep < 0.0) sweep += 2.0 * std::numbers::pi;
    if (!arc.convex && sweep > 0.0) sweep -= 2.0 * std::numbers::pi;
    return sweep;
}

double lengthMm(const ProfilePiece& piece) {
    return piece.isArc ? piece.radiusMm * std::abs(arcSweepRad(piece)) : (piece.to - piece.from).norm();
}

Vec2 pointAt(const ProfilePiece& piece, double t) {
    if (t <= 0.0) return piece.from;
    if (t >= 1.0) return piece.to;
    if (!piece.isArc) return piece.from + t * (piece.to - piece.from);
    const double angle = arcStartRad(piece) + t * arcSweepRad(piece);
    return piece.centre + piece.radiusMm * Vec2(core::cos(angle), core::sin(angle));
}

Vec2 inwardNormalAt(const ProfilePiece& piece, double t) {
    if (!piece.isArc) {
        const Vec2 d = (piece.to - piece.from).normalized();
        return {-d.y(), d.x()};
    }
    const Vec2 outOfCentre = (pointAt(piece, t) - piece.centre) / piece.radiusMm;
    return piece.convex ? Vec2(-outOfCentre) : outOfCentre;
}

double turnedAreaMm2(const ProfilePiece& piece, double t0, double t1) {
    const double twoPi = 2.0 * std::numbers::pi;
    if (!piece.isArc) {
        const double middleRho = piece.from.x() + 0.5 * (t0 + t1) * (piece.to.x() - piece.from.x());
        return twoPi * middleRho * (t1 - t0) * lengthMm(piece);
    }
    const double start = arcStartRad(piece), sweep = arcSweepRad(piece);
    const double a = start + t0 * sweep, b = start + t1 * sweep;
    return twoPi * piece.radiusMm *
           std::abs(piece.centre.x() * (b - a) + piece.radiusMm * (core::sin(b) - core::sin(a)));
}

Joint jointBetween(const ProfilePiece& before, const ProfilePiece& after) {
    const double turn = cross(tangentAt(before, 1.0), tangentAt(after, 0.0));
    if (std::abs(turn) < kSmoothJointRad && tangentAt(before, 1.0).dot(tangentAt(after, 0.0)) > 0.0)
        return Joint::smooth;
    return turn > 0.0 ? Joint::convex : Joint::reflex;
}

double Profile::lengthMm() const {
    return extent(*this, 1);
}
double Profile::maxRadiusMm() const {
    return extent(*this, 0);
}

double signedDistanceMm(const Profile& profile, double rhoMm, double zMm) noexcept {
    const Vec2 p(std::abs(rhoMm), zMm);
    const std::size_t count = profile.pieces.size();
    constexpr std::size_t kNoVertex = static_cast<std::size_t>(-1);
    double bestSquared = std::numeric_limits<double>::infinity();
    std::size_t bestVertex = kNoVertex;
    bool inside = false;
    for (std::size_t i = 0; i < count; ++i) {
        const ProfilePiece& piece = profile.pieces[i];
        const Vec2 w = p - piece.from;
        double squared = 0.0;
        std::size_t vertex = kNoVertex;
        bool in = false;
        if (!piece.isArc) {
            const Vec2 d = piece.to - piece.from;
            const double along = w.dot(d), dd = d.squaredNorm();
            if (along <= 0.0) {
                squared = w.squaredNorm();
                vertex = i;
            } else if (along >= dd) {
                squared = (p - piece.to).squaredNorm();
                vertex = i + 1;
            } else {
                const double side = cross(d, w);
                squared = side * side / dd;
                in = side > 0.0;
            }
        } else {
            const Vec2 v = p - piece.centre;
            const double distance = v.norm();
            if (distance < 1e-12 || isOnArc(piece, piece.centre + v * (piece.radiusMm / distance))) {
                const double off = distance - piece.radiusMm;
                squared = off * off;
                in = piece.convex ? off < 0.0 : off > 0.0;
            } else {
                const double toStart = w.squaredNorm(), toEnd = (p - piece.to).squaredNorm();
                squared = std::min(toStart, toEnd);
                vertex = toStart <= toEnd ? i : i + 1;
            }
        }
        if (squared < bestSquared) {
            bestSquared = squared;
            bestVertex = vertex;
            inside = in;
        }
    }
    if (bestVertex != kNoVertex) {
        // At a corner the sum of the two normals decides; on the axis the mirrored piece is the other one.
        const bool first = bestVertex == 0, last = bestVertex == count;
        Vec2 n = last ? Vec2::Zero() : inwardNormalAt(profile.pieces[bestVertex], 0.0);
        if (!first) n += inwardNormalAt(profile.pieces[bestVertex - 1], 1.0);
        if (first || last) n.x() = 0.0;
        const Vec2& corner = last ? profile.pieces[count - 1].to : profile.pieces[bestVertex].from;
        inside = n.dot(p - corner) > 0.0;
    }
    const double distance = std::sqrt(bestSquared);
    return inside ? -distance : distance;
}

double volumeMm3(const Profile& profile) {
    double integral = 0.0;  // of rho^2 dz
    for (const ProfilePiece& piece : profile.pieces) {
        const double a = piece.from.x(), b = piece.to.x();
        if (!piece.isArc) {
            integral += (piece.to.y() - piece.from.y()) * (a * a + a * b + b * b) / 3.0;
            continue;
        }
        const double c = piece.centre.x(), r = piece.radiusMm;
        const auto primitive = [&](double angle) {
            const double s = core::sin(angle);
            return r * (c * c * s + c * r * (angle + 0.5 * core::sin(2.0 * angle)) + r * r * (s - s * s * s / 3.0));
        };
        const double start = arcStartRad(piece);
        integral += primitive(start + arcSweepRad(piece)) - primitive(start);
    }
    return std::numbers::pi * integral;
}

double surfaceAreaMm2(const Profile& profile) {
    double area = 0.0;
    for (const ProfilePiece& piece : profile.pieces)
        area += turnedAreaMm2(piece, 0.0, 1.0);
    return area;
}

void validate(const Profile& profile) {
    if (profile.pieces.empty()) refuse("it has no pieces");
    for (std::size_t i = 0; i < profile.pieces.size(); ++i) {
        const ProfilePiece& piece = profile.pieces[i];
        if (!piece.from.allFinite() || !piece.to.allFinite() ||
            (piece.isArc && !(piece.centre.allFinite() && std::isfinite(piece.radiusMm))))
            refuse(fmt::format("piece {} has a number that is not finite", i));
        if ((piece.to - piece.from).norm() < kJointToleranceMm) refuse(fmt::format("piece {} has no length", i));
        if (piece.isArc && (piece.radiusMm <= 0.0 ||
                            std::abs((piece.from - piece.centre).norm() - piece.radiusMm) > kJointToleranceMm ||
                            std::abs((piece.to - piece.centre).norm() - piece.radiusMm) > kJointToleranceMm))
            refuse(fmt::format("the ends of arc {} are not on its circle", i));
        if (lowest(piece, 0) < -kJointToleranceMm) refuse(fmt::format("piece {} crosses the axis", i));
        if (lowest(piece, 1) < -kJointToleranceMm) refuse(fmt::format("piece {} goes below the tip (z < 0)", i));
        if (i > 0 && (piece.from - profile.pieces[i - 1].to).norm() > kJointToleranceMm)
            refuse(fmt::format("pieces {} and {} do not meet", i - 1, i));
        if (i > 0) {
            const Vec2 before = tangentAt(profile.pieces[i - 1], 1.0), after = tangentAt(piece, 0.0);
            if (before.dot(after) < 0.0 && std::abs(cross(before, after)) < kSmoothJointRad)
                refuse(fmt::format("it turns back on itself between pieces {} and {}", i - 1, i));
        }
    }
    if (std::abs(profile.pieces.front().from.x()) > kJointToleranceMm) refuse("it does not start on the axis");
    if (std::abs(profile.pieces.back().to.x()) > kJointToleranceMm) refuse("it does not end on the axis");
    if (std::abs(profile.pieces.front().from.y()) > kJointToleranceMm) refuse("its tip is not at z = 0");
    const std::vector<Chord> chords = chordsOf(profile);
    for (std::size_t i = 0; i < chords.size(); ++i)
        for (std::size_t j = i + 2; j < chords.size(); ++j)
            if (cross(chords[i], chords[j]))
                refuse(fmt::format("pieces {} and {} cross", chords[i].piece, chords[j].piece));
    if (!(volumeMm3(profile) > 1e-12)) refuse("it encloses no volume");
}

}  // namespace handpiece::instrument
