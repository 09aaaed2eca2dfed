// SPDX-License-Identifier: Apache-2.0
// isthmus, isthmus-share
#include <algorithm>
#include <cmath>
#include <map>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr double kFacingCos = 0.9781476;  // 12 degrees: walls that face one another

struct Isthmus {
    Places widths{};
    std::string reason{};
    double residual = 0.0;
};

/// The cavity's width at half the height of its lower wall, square to the walls, wherever a buccal and a lingual wall
/// face one another.
Isthmus isthmusOf(CutTooth& tooth) {
    Isthmus found;
    if (tooth.cutPoints().empty()) return {.reason = kNothing};
    if (tooth.form() == Form::crown) return {.reason = "a crown preparation has no isthmus"};
    if (!sideDirection(tooth.preparation().axes, "buccal")) return {.reason = "nobody says which side is buccal"};
    std::map<std::pair<int, int>, const WallStation*> buccal;
    for (const WallStation& wall : tooth.walls())
        if (wall.floor == 0 && wall.side == "buccal") buccal[{wall.row, wall.run}] = &wall;
    CutTooth::Look look(tooth);
    std::vector<double> rms;
    const DrawFrame& frame = tooth.frame();
    for (const WallStation& wall : tooth.walls()) {
        if (wall.floor != 0 || wall.side != "lingual") continue;
        const auto across = buccal.find({wall.row, wall.run});
        if (across == buccal.end()) continue;
        const WallStation& other = *across->second;
        if (wall.h.dot(other.h) > -kFacingCos) continue;
        const Vec3 along = (wall.h - other.h).normalized();
        const double w = 0.5 * (std::max(wall.floorW, other.floorW) + std::min(wall.marginW, other.marginW));
        Vec3 from = 0.5 * (wall.start + other.start);
        from.z() = w;
        const Vec3 p = frame.from(from);
        const auto there = look.cast(p, along, 5.0), here = look.cast(p, -along, 5.0);
        if (!there || !here || !(*there > 0.0 && *here > 0.0)) continue;
        found.widths.add(*there + *here, p);
        rms.push_back(core::hypot(wall.middle.rms, other.middle.rms));
    }
    if (found.widths.values.empty()) found.reason = "no buccal and lingual walls face one another";
    found.residual =
        meanOf(medianOf(std::move(rms)), static_cast<double>(found.widths.values.size()) * kProbeMm / kPieceMm);
    return found;
}

}  // namespace

Taken takeIsthmus(CutTooth& tooth, const Selection& of) {
    const Isthmus isthmus = isthmusOf(tooth);
    if (!isthmus.reason.empty()) return none(isthmus.reason);
    Taken taken = isthmus.widths.taken(of, "least", "middle of the isthmus");
    taken.residual = isthmus.residual;
    return taken;
}

Taken takeIsthmusShare(CutTooth& tooth, const Selection&) {
    const Isthmus isthmus = isthmusOf(tooth);
    if (!isthmus.reason.empty()) return none(isthmus.reason);
    const Taken narrowest = isthmus.widths.taken({}, "least", "narrowest isthmus");
    const Vec3 place = *narrowest.evidence.front().placeMm;
    const Vec3 towards = *sideDirection(tooth.preparation().axes, "buccal");
    // Of the pairs of a buccal and a lingual cusp the one beside the isthmus.
    const Vec3& draw = tooth.frame().w;
    const Vec3 mesial = towards.cross(draw);
    double best = 1e300, between = 0.0;
    const std::span<const cases::Landmark> marks = tooth.preparation().landmarks;
    for (const cases::Landmark& a : marks)
        for (const cases::Landmark& b : marks) {
            if (a.kind != cases::LandmarkKind::cuspTip || b.kind != cases::LandmarkKind::cuspTip) continue;
            const Vec3 offA = a.pointsMm.front() - place, offB = b.pointsMm.front() - place;
            if (!(offA.dot(towards) > 0.0 && offB.dot(towards) < 0.0)) continue;
            const double off = std::abs(offA.dot(mesial)) + std::abs(offB.dot(mesial));
            if (off >= best) continue;
            best = off;
            Vec3 apart = offA - offB;
            apart -= apart.dot(draw) * draw;
            between = apart.norm();
        }
    if (!(between > 0.0)) return none("the case names no cusp tips on both sides of the isthmus");
    Taken share = narrowest;
    share.value = 100.0 * *narrowest.value / between;
    return share;
}

}  // namespace handpiece::measures
