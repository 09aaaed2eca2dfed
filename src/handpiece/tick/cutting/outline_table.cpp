// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/cutting/outline_table.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::cutting {

using core::Vec2;
using instrument::Joint;
using instrument::ProfilePiece;

namespace {

constexpr std::size_t kGroups = 64;
/// Lists leave nothing out by less than this, so that rounding never decides which piece is nearest.
constexpr double kSlackMm = 1e-3;

float signOf(Joint joint) {
    return joint == Joint::convex ? 1.0f : joint == Joint::reflex ? -1.0f : 0.0f;
}

/// Which side points beyond the axis end of an outline lie on; `rise`: of the outline's direction out of the axis (at
/// the tip) or into it (at the top).
float signAtAxis(double rise) {
    return rise > instrument::kSmoothJointRad ? 1.0f : rise < -instrument::kSmoothJointRad ? -1.0f : 0.0f;
}

double riseAt(const ProfilePiece& piece, double t) {
    return -instrument::inwardNormalAt(piece, t).x();  // the direction is the inward normal turned clockwise
}

SweepPiece sweepPiece(const instrument::Profile& profile, std::size_t i, double unitMm) {
    const ProfilePiece& piece = profile.pieces[i];
    const std::size_t last = profile.pieces.size() - 1;
    const auto scaled = [&](double mm) { return static_cast<float>(mm / unitMm); };
    SweepPiece out{};
    const bool free[2] = {i == 0, i == last};
    out.endSign[0] =
        free[0] ? signAtAxis(riseAt(piece, 0.0)) : signOf(instrument::jointBetween(profile.pieces[i - 1], piece));
    out.endSign[1] =
        free[1] ? signAtAxis(riseAt(piece, 1.0)) : signOf(instrument::jointBetween(piece, profile.pieces[i + 1]));
    const Vec2 chord = (piece.to - piece.from).normalized();
    if (!piece.isArc) {
        out.r0 = scaled(piece.from.x());
        out.z0 = scaled(piece.from.y());
        out.ur = static_cast<float>(chord.x());
        out.uz = static_cast<float>(chord.y());
        out.length = scaled((piece.to - piece.from).norm());
        return out;
    }
    out.r0 = std::abs(piece.centre.x()) < 1e-9 ? 0.0f : scaled(piece.centre.x());
    out.z0 = scaled(piece.centre.y());
    out.radius = scaled(piece.radiusMm);
    out.bulge = piece.convex ? 1.0f : -1.0f;
    out.chordR = static_cast<float>(chord.x()) * out.bulge;
    out.chordZ = static_cast<float>(chord.y()) * out.bulge;
    const Vec2 toCentre = piece.centre - piece.from;
    out.chordOffset = scaled(chord.x() * toCentre.y() - chord.y() * toCentre.x()) * out.bulge;
    for (int e = 0; e < 2; ++e) {
        const Vec2& end = e == 0 ? piece.from : piece.to;
        out.ends[e][0] = scaled(end.x());
        out.ends[e][1] = scaled(end.y());
        const bool measured = !free[e] && !profile.pieces[e == 0 ? i - 1 : i + 1].isArc;
        if (!measured) out.endsCount |= 1 << e;
    }
    return out;
}

bool faces(const ProfilePiece& piece, const Vec2& p) {
    if (!piece.isArc) {
        const Vec2 d = piece.to - piece.from;
        const double along = (p - piece.from).dot(d);
        return along > 0.0 && along < d.squaredNorm();
    }
    const Vec2 v = p - piece.centre;
    return v.norm() > 1e-12 && instrument::isOnArc(piece, piece.centre + piece.radiusMm * v.normalized());
}

double distanceTo(const ProfilePiece& piece, const Vec2& p) {
    if (faces(piece, p)) {
        const Vec2 w = p - (piece.isArc ? piece.centre : piece.from);
        if (piece.isArc) return std::abs(w.norm() - piece.radiusMm);
        const Vec2 d = (piece.to - piece.from).normalized();
        return std::abs(d.x() * w.y() - d.y() * w.x());
    }
    const double ends = std::min((p - piece.from).norm(), (p - piece.to).norm());
    return piece.isArc && (p - piece.centre).norm() <= 1e-12 ? std::min(ends, piece.radiusMm) : ends;
}

/// Signed distance to the whole line or circle.
double distanceToWhole(const ProfilePiece& piece, const Vec2& p) {
    if (piece.isArc) return ((p - piece.centre).norm() - piece.radiusMm) * (piece.convex ? 1.0 : -1.0);
    const Vec2 d = (piece.to - piece.from).normalized(), w = p - piece.from;
    return w.x() * d.y() - w.y() * d.x();
}

/// True when all of a square faces the piece.
bool allFaces(const ProfilePiece& piece, const Vec2& middle, double half) {
    for (const double r : {-half, half})
        for (const double z : {-half, half})
            if (!faces(piece, middle + Vec2(r, z))) return false;
    // Corners tell of an arc when its centre is not near and the part that is missing is no sliver.
    return !piece.isArc || ((piece.centre - middle).norm() > 4.0 * half && faces(piece, middle) &&
                            std::abs(instrument::arcSweepRad(piece)) < 5.0);
}

}  // namespace

OutlineTable::OutlineTable(const instrument::Profile& profile, double unitMm, double bandMm, double bandOutMm,
                           double marginMm, double cellMm) {
    const std::size_t count = profile.pieces.size();
    for (std::size_t i = 0; i < count; ++i)
        pieces_.push_back(sweepPiece(profile, i, unitMm));
    groupSize_ = static_cast<std::uint32_t>((count + kGroups - 1) / kGroups);
    realPieces_ = count;
    std::vector<std::size_t> tips;  // of the capsules
    for (std::size_t i = 0; i + 1 < count && count + tips.size() < kGroups; ++i) {
        const SweepPiece &tip = pieces_[i], &side = pieces_[i + 1];
        if (tip.radius == 0.0f || tip.r0 != 0.0f || tip.bulge < 0.0f || side.radius != 0.0f) continue;
        if (side.ur != 0.0f || side.uz != 1.0f || side.r0 != tip.radius) continue;
        tips.push_back(i);
        pieces_.push_back(SweepPiece(tip));
    }

    const double reach = bandMm + marginMm, half = 0.5 * cellMm, round = half * std::sqrt(2.0);
    columns_ = static_cast<std::int32_t>(std::ceil((profile.maxRadiusMm() + reach) / cellMm)) + 1;
    rows_ = static_cast<std::int32_t>(std::ceil((profile.lengthMm() + 2.0 * reach) / cellMm)) + 1;
    perCell_ = static_cast<float>(1.0 / cellMm);
    zLow_ = static_cast<float>(-reach);
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::int32_t row = 0; row < rows_; ++row)
        for (std::int32_t column = 0; column < columns_; ++column) {
            const Vec2 middle((column + 0.5) * cellMm, -reach + (row + 0.5) * cellMm);
            const double d = instrument::signedDistanceMm(profile, middle.x(), middle.y());
            Region& cell = cells_[static_cast<std::size_t>(row * columns_ + column)];
            cell.lowMm = static_cast<float>(d - round - kSlackMm);
            cell.highMm = static_cast<float>(d + round + kSlackMm);
            int candidates = 0;
            for (std::size_t i = 0; i < count; ++i)
                if (distanceTo(profile.pieces[i], middle) <= std::abs(d) + 2.0 * round + kSlackMm) {
                    cell.groups |= std::uint64_t{1} << (i / groupSize_);
                    ++candidates;
                }
            if (groupSize_ > 1) continue;
            for (std::size_t i = 0; i < count; ++i) {
                const ProfilePiece& piece = profile.pieces[i];
                if (piece.isArc && pieces_[i].r0 != 0.0f) continue;  // no form of its own
                const double whole = distanceToWhole(piece, middle);
                const bool isOnlyOne = candidates == 1 && (cell.groups >> i & 1) != 0 && allFaces(piece, middle, half);
                if (isOnlyOne || whole + round + kSlackMm <= -bandOutMm || whole - round - kSlackMm >= bandMm) {
                    const bool saysTheSame =
                        isOnlyOne || (whole < 0.0 ? cell.highMm <= -bandOutMm : cell.lowMm >= bandMm);
                    if (saysTheSame) cell.alone |= std::uint64_t{1} << i;
                }
            }
            for (std::size_t k = 0; k < tips.size(); ++k) {
                const ProfilePiece &tip = profile.pieces[tips[k]], &side = profile.pieces[tips[k] + 1];
                const double whole = core::hypot(middle.x(), std::min(middle.y() - tip.centre.y(), 0.0)) - tip.radiusMm;
                const std::uint64_t both = std::uint64_t{3} << tips[k];
                bool isOnlyThese = (cell.groups & ~both) == 0;
                for (const double r : {-half, half})
                    for (const double z : {-half, half}) {
                        const Vec2 corner = middle + Vec2(r, z);
                        isOnlyThese = isOnlyThese && (faces(tip, corner) || faces(side, corner));
                    }
                if (isOnlyThese || (whole + round + kSlackMm <= -bandOutMm && cell.highMm <= -bandOutMm) ||
                    (whole - round - kSlackMm >= bandMm && cell.lowMm >= bandMm))
                    cell.alone |= std::uint64_t{1} << (count + k);
            }
        }
}

OutlineTable::Region OutlineTable::region(const Rectangle& rectangle) const noexcept {
    const auto clampTo = [](float x, std::int32_t count) {
        return x < 0.0f ? 0 : x >= static_cast<float>(count) ? count - 1 : static_cast<std::int32_t>(x);
    };
    const std::int32_t left = clampTo(rectangle.rhoLow * perCell_, columns_),
                       right = clampTo(rectangle.rhoHigh * perCell_, columns_),
                       bottom = clampTo((rectangle.zLow - zLow_) * perCell_, rows_),
                       top = clampTo((rectangle.zHigh - zLow_) * perCell_, rows_);
    Region all{3e38f, -3e38f, 0, ~std::uint64_t{0}};
    for (std::int32_t row = bottom; row <= top; ++row) {
        const Region* cell = &cells_[static_cast<std::size_t>(row * columns_)];
        for (std::int32_t column = left; column <= right; ++column) {
            all.lowMm = std::min(all.lowMm, cell[column].lowMm);
            all.highMm = std::max(all.highMm, cell[column].highMm);
            all.groups |= cell[column].groups;
            all.alone &= cell[column].alone;
        }
    }
    return all;
}

std::int32_t OutlineTable::list(std::uint64_t groups, std::uint16_t* out) const noexcept {
    std::int32_t count = 0;
    const auto pieces = static_cast<std::uint32_t>(realPieces_);
    for (; groups != 0; groups &= groups - 1) {
        const auto first = static_cast<std::uint32_t>(std::countr_zero(groups)) * groupSize_;
        for (std::uint32_t i = first; i < std::min(first + groupSize_, pieces); ++i)
            out[count++] = static_cast<std::uint16_t>(i);
    }
    return count;
}

instrument::Profile simpleOutline(const instrument::Profile& profile) {
    constexpr std::size_t kSteps = 8;
    if (profile.pieces.size() <= kSteps) return profile;
    // The largest radius of each stretch of height, and of the stretches on both sides where they meet.
    const double length = profile.lengthMm(), stretch = length / kSteps;
    double widest[kSteps] = {};
    for (const ProfilePiece& piece : profile.pieces) {
        const int samples = piece.isArc ? 64 : 1;
        // Between samples an arc sticks out of its chord by less than this.
        const double bulge =
            piece.isArc ? piece.radiusMm * (1.0 - core::cos(0.5 * instrument::arcSweepRad(piece) / samples)) : 0.0;
        for (int k = 0; k < samples; ++k) {
            const Vec2 a = instrument::pointAt(piece, static_cast<double>(k) / samples),
                       b = instrument::pointAt(piece, (k + 1.0) / samples);
            const double low = std::min(a.y(), b.y()) - bulge, high = std::max(a.y(), b.y()) + bulge;
            for (std::size_t s = 0; s < kSteps; ++s)
                if (high >= static_cast<double>(s) * stretch - 1e-9 &&
                    low <= static_cast<double>(s + 1) * stretch + 1e-9)
                    widest[s] = std::max({widest[s], a.x() + bulge, b.x() + bulge});
        }
    }
    instrument::Profile simple;
    Vec2 at = Vec2::Zero();
    const auto walkTo = [&](const Vec2& to) {
        if ((to - at).norm() > 1e-9) simple.pieces.push_back({.from = at, .to = to});
        at = to;
    };
    for (std::size_t s = 0; s <= kSteps; ++s)
        walkTo({std::max(widest[s == 0 ? 0 : s - 1], widest[s == kSteps ? kSteps - 1 : s]),
                static_cast<double>(s) * stretch});
    walkTo({0.0, length});
    return simple;
}

}  // namespace handpiece::cutting
