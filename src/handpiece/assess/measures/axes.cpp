// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "handpiece/assess/measures/preparation.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr double kCos45 = 0.70710678118654752;

std::optional<Vec3> lineOf(std::span<const cases::Landmark> landmarks, cases::LandmarkKind kind) {
    for (const cases::Landmark& mark : landmarks)
        if (mark.kind == kind && mark.pointsMm.size() == 2)
            if (const Vec3 along = mark.pointsMm[1] - mark.pointsMm[0]; along.norm() > 1e-6) return along.normalized();
    return {};
}

Vec3 squareTo(const Vec3& axis, const Vec3& v) {
    return v - v.dot(axis) * axis;
}

}  // namespace

Axes axesOf(std::span<const cases::Landmark> landmarks, int buccalSign) {
    Axes axes;
    axes.longAxis = lineOf(landmarks, cases::LandmarkKind::longAxis).value_or(Vec3::UnitZ());
    axes.draw = lineOf(landmarks, cases::LandmarkKind::pathOfInsertion).value_or(axes.longAxis);
    axes.mesial = squareTo(axes.longAxis, Vec3::UnitX()).normalized();
    if (buccalSign != 0) axes.buccal = (buccalSign > 0 ? 1.0 : -1.0) * axes.longAxis.cross(axes.mesial);
    return axes;
}

std::optional<Vec3> axisOf(const Axes& axes, std::string_view side) {
    Vec3 towards = Vec3::Zero();
    if (side == "mesial" || side == "distal")
        towards = axes.mesial;
    else if (side == "buccal" || side == "lingual")
        towards = axes.buccal;
    else if (side == "occlusal" || side == "gingival")
        towards = axes.longAxis;
    if (side == "distal" || side == "lingual" || side == "gingival") towards = -towards;
    if (towards.isZero()) return {};
    return towards;
}

std::optional<Vec3> sideDirection(const Axes& axes, std::string_view side) {
    const auto towards = axisOf(axes, side);
    if (!towards) return {};
    const Vec3 square = squareTo(axes.draw, *towards);
    // Of three axes one lies along the path of draw.
    if (!(square.norm() > kCos45)) return {};
    return Vec3(square.normalized());
}

std::string_view sideOf(const Axes& axes, const Vec3& direction) {
    const Vec3 square = squareTo(axes.draw, direction);
    std::string_view best;
    double most = kCos45 * (1.0 - 1e-9) * square.norm();
    for (const std::string_view side : kSides)
        if (const auto towards = sideDirection(axes, side); towards && square.dot(*towards) > most) {
            most = square.dot(*towards);
            best = side;
        }
    return best;
}

}  // namespace handpiece::measures
