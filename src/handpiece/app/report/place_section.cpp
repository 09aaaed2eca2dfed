// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/place_section.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/app/report/section_outlines.h"

namespace handpiece::report {
namespace {

using core::Vec2;
using core::Vec3;

constexpr double kHalfMm = 3.5;     // a cavity and a half to either side
constexpr double kOverMm = 1.2;     // above the uncut surface is air
constexpr double kDeepestMm = 5.0;  // or the place itself would not be seen
constexpr double kFloorCos = 0.8;   // of a surface's normal and the way in: a floor, of which a depth is told
constexpr double kOnMm = 0.4;       // from the surface: a place of another tooth, or of the pulp, is farther off
constexpr double kFarMm = 12.0, kStepMm = 0.02;

struct Axis {
    Vec3 along;
    std::string_view from, to;  ///< the sides that it leads from and to
};

/// The two of the tooth's axes that the way in leaves, square to it: along the arch first.
std::array<Axis, 2> axesOf(const Bearings& of, const Vec3& up) {
    const bool isFromAbove = std::abs(up.z()) >= std::abs(up.y());
    const bool isBuccalLeft = of.buccalSign < 0;
    std::array<Axis, 2> axes{
        {{Vec3::UnitX(), "distal", "mesial"},
         isFromAbove ? Axis{Vec3::UnitY(), isBuccalLeft ? "buccal" : "lingual", isBuccalLeft ? "lingual" : "buccal"}
                     : Axis{Vec3::UnitZ(), "gingival", "occlusal"}}};
    for (Axis& axis : axes) {
        axis.along = (axis.along - up * up.dot(axis.along)).normalized();
        if (of.fdi == 0) axis.from = axis.to = {};
    }
    return axes;
}

}  // namespace

double toIdealMm(const zones::Zones& zones, const geometry::TriangleTree& whole, const Vec3& p) {
    return std::max(whole.signedDistance(p), std::min(-zones.targetMm(p), zones.protectedMm(p)));
}

std::optional<PlaceSection> placeSection(const tasks::Task& task, const tooth::ToothMirror& own,
                                         const Bearings& bearings, const Vec3& placeMm) {
    const geometry::TriangleTree& whole = own.model().tree;
    const measure::ToothProbe probe(own);
    const auto ownMm = [&](const Vec3& p) { return std::max(whole.signedDistance(p), probe.signedDistanceMm(p)); };
    // Beyond the field's band a distance is only a bound.
    const double bandMm = std::min(own.model().settings.bandMm, own.model().bandOutMm);
    if (std::abs(ownMm(placeMm)) > std::min(kOnMm, 0.9 * bandMm)) return {};
    std::optional<preparation::Laid> laid;
    if (task.preparation) laid = preparation::layOn(task.toothCase, *task.preparation);

    PlaceSection section;
    section.up = bearings.draw;
    section.halfMm = kHalfMm;
    const Vec3 normal = outwardAt(probe, own.model().field.settings().voxelMm, placeMm, section.up);
    // Across a wall, so that one sees how far it stands off; along the arch where there is none.
    const std::array<Axis, 2> axes = axesOf(bearings, section.up);
    const Axis& across =
        std::abs(axes[1].along.dot(normal)) > std::abs(axes[0].along.dot(normal)) + 0.1 ? axes[1] : axes[0];
    section.right = across.along;
    section.leftSide = across.from;
    section.rightSide = across.to;

    SectionOutlines plane;
    plane.originMm = placeMm;
    plane.right = section.right;
    plane.up = section.up;
    const Vec2 corner(kHalfMm, kHalfMm);
    const std::optional<double> deepMm = probe.depthAlongMm(placeMm, section.up);
    section.highMm = std::clamp(deepMm.value_or(0.0), 0.0, kDeepestMm) + kOverMm;
    const Vec2 middle(0.0, section.highMm - kHalfMm);
    const auto linesOf = [&](const geometry::ScalarFunction& f) {
        return linesIn(plane, middle - corner, middle + corner, f);
    };
    section.before = linesOf([&](const Vec3& p) { return whole.signedDistance(p); });
    section.own = linesOf(ownMm);
    if (laid) section.ideal = linesOf([&](const Vec3& p) { return toIdealMm(*laid->zones, whole, p); });

    if (normal.dot(section.up) < kFloorCos) return section;
    section.ownDeepMm = deepMm;
    if (!laid || !section.ownDeepMm) return section;
    const Vec3 top = placeMm + *section.ownDeepMm * section.up;
    for (double deep = kStepMm; deep < kFarMm; deep += kStepMm)
        if (toIdealMm(*laid->zones, whole, top - deep * section.up) < 0.0) {
            section.idealDeepMm = deep <= kStepMm ? 0.0 : deep;
            break;
        }
    return section;
}

}  // namespace handpiece::report
