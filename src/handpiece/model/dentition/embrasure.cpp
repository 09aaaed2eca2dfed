// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/embrasure.h"

#include <algorithm>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/dentition/spline.h"
#include "handpiece/model/dentition/surfaces.h"

namespace handpiece::dentition {
namespace {

using core::Vec2;
using core::Vec3;

constexpr double kRulersMm = 0.25, kRulersOverContactMm = 1.0, kRulersUnderMarginMm = 2.0;
constexpr int kTouches = 14;              ///< places of either tooth that a ruler is held against
constexpr double kTouchesToShare = 0.75;  ///< of the way to the middle of either
constexpr double kOutsideMm = 9.0, kThroughMm = -6.0, kTouchMm = 0.01;

/// So far behind the rulers the papilla ends, over heights above the margin; negative: before them, as gingiva covers
/// roots; farther down the collars of the teeth are before it.
const Profile& papillaBehind() {
    static const Profile profile(
        {{-6.0, 0.5}, {-3.5, -0.3}, {-2.0, -0.45}, {-1.0, -0.4}, {0.0, -0.2}, {0.5, 0.06}, {1.5, 0.22}, {3.0, 0.32}});
    return profile;
}
/// And gingiva of the teeth's collars.
const Profile& collarBehind() {
    static const Profile profile(
        {{-2.0, -2.4}, {-1.0, -1.0}, {-0.5, -0.6}, {0.0, -0.25}, {0.5, 0.03}, {1.5, 0.17}, {3.0, 0.27}});
    return profile;
}
/// Between the two places where the ruler touches it goes in, so deep in the middle.
const Profile& hollow() {
    static const Profile profile({{-3.0, 0.25}, {0.0, 0.15}, {1.0, 0.2}});
    return profile;
}
constexpr double kFadesAside = 1.2;  ///< beside those places a sheet leaves the tooth free
constexpr double kWallSteep = 0.5;
constexpr double kLowestTipOverMarginMm = 0.4;  ///< where teeth touch lower than that, at their roots
/// On the faces of either tooth the papilla comes down to the margin, where the other tooth is so far away: a share of
/// the way to the tooth's middle, and a length. It stays as high as under the contact for the first share of that.
constexpr double kDownShare = 0.85, kDownMm = 0.4, kDownMostMm = 4.2, kLevelShare = 0.2;
constexpr double kRounded = 0.25, kRoofSteep = 1.5;

}  // namespace

Embrasure::Embrasure(const Stander& one, const Stander& two, const Vec3& contactMm, const Vec3& outward)
    : contact_(contactMm) {
    up_ = (one.axis() + two.axis()).normalized();
    const Vec3 across = two.pose().positionMm - one.pose().positionMm;
    along_ = (across - across.dot(up_) * up_).normalized();
    out_ = up_.cross(along_);
    if (out_.dot(outward) < 0.0) out_ = -out_;
    alongOne_ = std::min(-0.5, (one.pose().positionMm - contact_).dot(along_));
    alongTwo_ = std::max(0.5, (two.pose().positionMm - contact_).dot(along_));

    double lowestMargin = 1e9, meanMargin = 0.0;
    for (Side& side : sides_) {
        side.sign = &side == &sides_[0] ? 1.0 : -1.0;
        const auto margin = [&](const Stander& s) {
            return (s.neckTowards(side.sign * out_) - contact_).dot(up_) + kMarginOverCervixMm;
        };
        side.marginOne = margin(one), side.marginTwo = margin(two);
        lowestMargin = std::min({lowestMargin, side.marginOne, side.marginTwo});
        meanMargin += 0.25 * (side.marginOne + side.marginTwo);
    }
    tip_ = std::max(-kPapillaBelowContactMm, meanMargin + kLowestTipOverMarginMm);
    lowest_ = lowestMargin - kRulersUnderMarginMm;
    bottom_ = lowestMargin - 6.0;
    const auto count =
        std::max<std::size_t>(4, 1 + static_cast<std::size_t>((kRulersOverContactMm - lowest_) / kRulersMm));
    for (Side& side : sides_) {
        std::vector<Ruler>& rulers = side.rulers;
        rulers.resize(count);
        std::vector<bool> isLaid(count);
        for (std::size_t k = 0; k < count; ++k)
            isLaid[k] = layRuler(one, two, side, lowest_ + kRulersMm * static_cast<double>(k), rulers[k]);
        // Where one of the teeth is not there at a height, as at the next where both are.
        for (std::size_t k = count - 1; k-- > 0;)
            if (!isLaid[k] && isLaid[k + 1]) rulers[k] = rulers[k + 1], isLaid[k] = true;
        for (std::size_t k = 1; k < count; ++k)
            if (!isLaid[k]) rulers[k] = rulers[k - 1];
        for (int round = 0; round < 2; ++round) {
            const std::vector<Ruler> rough = rulers;
            for (std::size_t k = 1; k + 1 < count; ++k)
                rulers[k] = 0.25 * rough[k - 1] + 0.5 * rough[k] + 0.25 * rough[k + 1];
        }
    }
}

bool Embrasure::layRuler(const Stander& one, const Stander& two, const Side& side, double height, Ruler& ruler) const {
    const auto outermost = [&](const Stander& s, double along, double& out) {
        const Vec3 base = contact_ + along * along_ + height * up_;
        for (out = kOutsideMm; out > kThroughMm;) {
            const double distance = s.distance(base + side.sign * out * out_);
            if (distance < kTouchMm) return true;
            out -= distance;
        }
        return false;
    };
    // The upper hull of what is seen of the one's half and of the other's.
    std::vector<Vec2> hull;
    const auto hold = [&hull](const Vec2& point) {
        while (hull.size() > 1) {
            const Vec2 before = hull.back() - hull[hull.size() - 2], next = point - hull.back();
            if (before.x() * next.y() - before.y() * next.x() < 0.0) break;
            hull.pop_back();
        }
        hull.push_back(point);
    };
    for (int k = kTouches; k > 0; --k)
        if (double out = 0.0, along = kTouchesToShare * alongOne_ * k / kTouches; outermost(one, along, out))
            hold({along, out});
    const std::size_t ofOne = hull.size();
    for (int k = 1; k <= kTouches; ++k)
        if (double out = 0.0, along = kTouchesToShare * alongTwo_ * k / kTouches; outermost(two, along, out))
            hold({along, out});
    if (ofOne == 0 || hull.back().x() < 0.0) return false;
    for (std::size_t i = 0; i + 1 < hull.size(); ++i)
        if (hull[i].x() <= 0.0 && hull[i + 1].x() >= 0.0) {
            const Vec2 &a = hull[i], &b = hull[i + 1];
            ruler.slope = (b.y() - a.y()) / (b.x() - a.x());
            ruler.level = a.y() - ruler.slope * a.x();
            ruler.from = a.x(), ruler.to = b.x();
            return true;
        }
    return false;
}

Embrasure::Ruler Embrasure::rulerAt(const Side& side, double height) const {
    const std::size_t count = side.rulers.size();
    const SplineTaps taps = splineTaps((height - lowest_) / kRulersMm, count);
    return splined<Ruler>(taps, taps.value, count, [&](std::size_t i) { return side.rulers[i]; });
}

Embrasure::Values Embrasure::at(const Vec3& p, double toOne, double toTwo) const {
    const Vec3 d = p - contact_;
    const double height = d.dot(up_), along = d.dot(along_), outward = d.dot(out_);
    const double share = std::clamp((along - alongOne_) / (alongTwo_ - alongOne_), 0.0, 1.0);
    Values values{-1e9, -1e9};
    double middle = 0.0, half = 0.0, level[2];
    Ruler rulers[2];
    for (std::size_t i = 0; i < 2; ++i)
        rulers[i] = rulerAt(sides_[i], height), level[i] = sides_[i].sign * rulers[i].level;
    // From the sheet towards the tongue to that towards the lip the two places of touch go over into each other.
    const double room = std::max(0.5, level[0] - level[1]);
    const double toLip = std::clamp((outward - level[1]) / room, 0.0, 1.0);
    middle = 0.5 * (toLip * (rulers[0].from + rulers[0].to) + (1.0 - toLip) * (rulers[1].from + rulers[1].to));
    half = 0.5 * (toLip * (rulers[0].to - rulers[0].from) + (1.0 - toLip) * (rulers[1].to - rulers[1].from));
    const double wall = std::abs(along - middle) - half;
    double papilla[2], margins[2];
    for (std::size_t i = 0; i < 2; ++i) {
        const Side& side = sides_[i];
        const Ruler& r = rulers[i];
        margins[i] = side.marginOne + share * (side.marginTwo - side.marginOne);
        const double over = height - margins[i];
        const double own = 0.5 * std::max(0.3, r.to - r.from);
        const double t = std::clamp((along - 0.5 * (r.from + r.to)) / own, -1.0, 1.0), in = 1.0 - t * t;
        const double raw = (side.sign * outward - r.level - r.slope * along) / core::hypot(1.0, r.slope);
        const double dent = hollow().at(over) * in * in;
        papilla[i] = raw + papillaBehind().at(over) + dent;
        const double under = std::max(0.0, -2.0 - over);  // of the collar's sheet, on and on
        values.sheets = std::max(
            values.sheets, raw + collarBehind().at(over) - 2.0 * under + dent - kFadesAside * std::max(0.0, wall));
    }
    const double one = std::max(toOne, 0.0), two = std::max(toTwo, 0.0), gap = one + two;
    const double ofOne = two / std::max(gap, 0.01);
    const double down = std::min(kDownMostMm, kDownMm + kDownShare * (alongTwo_ - ofOne * (alongTwo_ + alongOne_)));
    const double margin = toLip * margins[0] + (1.0 - toLip) * margins[1];
    const double fallen = smoothStep(kLevelShare * down, down, gap);
    // Its edge towards lip or tongue is rounded from tooth to tooth.
    const double aside = (one - two) / std::max(gap, 0.01);
    const double high = std::max(0.0, tip_ - margin);
    const double roof =
        (height - tip_ + fallen * high + kRounded * gap * aside * aside) / core::hypot(1.0, kRoofSteep * high / down);
    values.papilla = smoothMax(smoothMax(papilla[0], papilla[1], 0.4), roof, 0.5);
    values.papilla = smoothMax(values.papilla, kWallSteep * wall, 0.6);
    values.papilla = smoothMax(values.papilla, bottom_ - height, 1.0);
    return values;
}

}  // namespace handpiece::dentition
