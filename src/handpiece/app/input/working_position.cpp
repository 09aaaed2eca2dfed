// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/working_position.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/model/case/fdi.h"

namespace handpiece::input {
namespace {

using cases::isRightTooth, cases::isUpperTooth;
using core::Mat3;
using core::Quat;
using core::Vec3;

constexpr double kRadPerDegree = std::numbers::pi / 180.0;
// [R] recalled from textbooks, unchecked. How steeply one looks down, and how far the head lies back for the upper arch
// and forward for the lower one.
constexpr double kLooksDownRad = 60.0 * kRadPerDegree;
constexpr double kBackForUpperRad = 15.0 * kRadPerDegree, kForwardForLowerRad = 20.0 * kRadPerDegree;
/// By which the mandible turns for an opening of 40 mm, as those arches have it.
constexpr double kOpenedRad = 27.5 * kRadPerDegree;
/// Of the way to the hand towards the operator; the rest goes straight out of the mouth [a judgement].
constexpr double kTowardsOperator = 0.7;

/// How the teeth of the patient's right side stand in the mouth frame, jaws closed: mesial, and the long axis towards
/// the crown. Of the arches that the program makes itself (seed 0, docs/anatomy.md#the-arches).
struct Stands {
    Vec3 mesial, crown;
};
const Stands kStands[2][8] = {{{{0.98, -0.19, 0.06}, {-0.05, -0.51, -0.86}},
                               {{0.85, -0.49, 0.18}, {-0.09, -0.49, -0.87}},
                               {{0.68, -0.68, 0.28}, {-0.05, -0.41, -0.91}},
                               {{0.51, -0.83, 0.23}, {0.00, -0.27, -0.96}},
                               {{0.38, -0.92, 0.08}, {-0.16, -0.15, -0.98}},
                               {{0.28, -0.96, 0.07}, {-0.22, -0.14, -0.97}},
                               {{0.18, -0.98, -0.07}, {-0.27, 0.02, -0.96}},
                               {{0.11, -0.98, -0.17}, {-0.23, 0.14, -0.96}}},
                              {{{0.99, -0.13, 0.02}, {-0.04, -0.22, 0.97}},
                               {{0.92, -0.39, 0.05}, {-0.14, -0.20, 0.97}},
                               {{0.76, -0.65, -0.01}, {-0.05, -0.07, 1.00}},
                               {{0.56, -0.83, 0.01}, {0.09, 0.08, 0.99}},
                               {{0.39, -0.92, -0.06}, {-0.01, -0.07, 1.00}},
                               {{0.26, -0.96, -0.06}, {0.35, 0.03, 0.94}},
                               {{0.16, -0.98, -0.16}, {0.37, -0.09, 0.92}},
                               {{0.09, -0.97, -0.24}, {0.38, -0.19, 0.90}}}};

/// A lower one with the mouth open for work.
Quat toothInMouth(int fdi) {
    const Stands& right = kStands[isUpperTooth(fdi) ? 0 : 1][fdi % 10 - 1];
    const Vec3 side(isRightTooth(fdi) ? 1.0 : -1.0, 1.0, 1.0);
    Mat3 axes;
    axes.col(2) = right.crown.cwiseProduct(side).normalized();
    const Vec3 mesial = right.mesial.cwiseProduct(side);
    axes.col(0) = (mesial - axes.col(2) * axes.col(2).dot(mesial)).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return isUpperTooth(fdi) ? Quat(axes) : core::rotationAbout(Vec3::UnitX(), kOpenedRad) * Quat(axes);
}

double tiltRad(bool isUpper) {
    return isUpper ? kBackForUpperRad : -kForwardForLowerRad;
}
/// The patient lies on the back: out of the face, in the mouth frame, turned by the head's tilt.
Vec3 offFloor(double tilt) {
    return {0.0, -core::cos(tilt), -core::sin(tilt)};
}

/// The usual places of a right-handed operator; [R], after the habits of operative dentistry's textbooks. The head is
/// not turned to the side here: what one sees where it is turned needs the mirror.
UsualPosition rightHanded(int fdi, Surface surface) {
    const bool isFront = fdi % 10 <= 3, isRight = isRightTooth(fdi);
    if (isUpperTooth(fdi)) {
        if (surface == Surface::buccal && (isFront || isRight)) return {9, false};
        if (surface == Surface::lingual && !isFront && !isRight) return {9, false};
        return {11, true};
    }
    if (isFront) return surface == Surface::lingual ? UsualPosition{12, true} : UsualPosition{8, false};
    switch (surface) {
        case Surface::occlusal:
            return {isRight ? 9 : 11, false};
        case Surface::buccal:
            return isRight ? UsualPosition{9, false} : UsualPosition{11, true};
        case Surface::lingual:
            break;
    }
    return isRight ? UsualPosition{11, true} : UsualPosition{9, false};
}

}  // namespace

bool isOperatorsHour(int hour) {
    const auto has = [hour](const auto& hours) { return std::find(hours.begin(), hours.end(), hour) != hours.end(); };
    return has(kRightHandedHours) || has(kLeftHandedHours);
}

std::optional<Quat> headInCase(const cases::Case& toothCase) {
    Eigen::Vector4d sum[2] = {Eigen::Vector4d::Zero(), Eigen::Vector4d::Zero()};
    const auto take = [&sum](int fdi, const Quat& toothInCase) {
        if (!cases::isPermanentTooth(fdi)) return;
        Eigen::Vector4d& of = sum[isUpperTooth(fdi) ? 0 : 1];
        const Eigen::Vector4d one = (toothInCase * toothInMouth(fdi).conjugate()).coeffs();
        of += of.dot(one) < 0.0 ? Eigen::Vector4d(-one) : one;
    };
    take(toothCase.fdiNumber, Quat::Identity());
    for (const cases::PlacedTooth& other : toothCase.others)
        take(other.fdiNumber, other.inCase.orientation);
    for (const Eigen::Vector4d& of : sum)
        if (of.norm() > 0.5) return Quat(of).normalized();
    return std::nullopt;
}

Vec3 downInCase(const cases::Case& toothCase) {
    const std::optional<Quat> head = headInCase(toothCase);
    if (!head) return -Vec3::UnitZ();
    const int fdi = toothCase.fdiNumber;
    return *head * -offFloor(tiltRad(!cases::isPermanentTooth(fdi) || isUpperTooth(fdi)));
}

void requireOperatorsHour(int hour, const std::string& where) {
    if (!isOperatorsHour(hour))
        throw core::Error(fmt::format("nobody works from {} o'clock", hour), where,
                          "8 to 12 (right-handed), 12 to 4 (left-handed)");
}

WorkingPosition workingPosition(const Quat& headInCase, bool isUpper, int hour) {
    requireOperatorsHour(hour);
    // 12 is where the top of the head points, turned by its tilt.
    const double tilt = tiltRad(isUpper);
    const Vec3 twelve(0.0, -core::sin(tilt), core::cos(tilt));
    const double around = hour * 30.0 * kRadPerDegree;
    const Vec3 towards = core::sin(around) * Vec3::UnitX() + core::cos(around) * twelve;
    WorkingPosition position;
    position.toEye = headInCase * (core::cos(kLooksDownRad) * towards + core::sin(kLooksDownRad) * offFloor(tilt));
    position.up = headInCase * -towards;
    position.toHand = headInCase * (kTowardsOperator * towards - Vec3::UnitY()).normalized();
    return position;
}

view::Camera seenFrom(const WorkingPosition& position, const core::Box& bounds, const view::Viewport& viewport) {
    view::Camera camera;
    camera.targetMm = bounds.isEmpty() ? Vec3(Vec3::Zero()) : bounds.centre();
    camera.eyeMm = camera.targetMm + position.toEye * camera.distanceMm();
    camera.up = position.up;
    return view::fitted(camera, bounds, viewport);
}

Quat handleTowards(const Quat& burInTooth, const Vec3& toHand) {
    // In the bur's own frame the handle goes along +x.
    const Vec3 inBur = burInTooth.conjugate() * toHand;
    const double across = core::hypot(inBur.x(), inBur.y());
    if (across < 1e-6) return burInTooth;
    Mat3 turn = Mat3::Identity();
    turn.col(0) = Vec3(inBur.x() / across, inBur.y() / across, 0.0);
    turn.col(1) = Vec3::UnitZ().cross(turn.col(0));
    return (burInTooth * Quat(turn)).normalized();
}

std::optional<Vec3> fingerRest(const cases::Case& toothCase) {
    const core::Box own = toothCase.surface().bounds();
    if (own.isEmpty()) return std::nullopt;
    std::optional<Vec3> best;
    double leastMm = 0.0;
    const auto offer = [&](const geometry::TriangleMesh& mesh, const core::Pose& inCase) {
        if (mesh.vertices.empty()) return;
        Vec3 top = inCase.apply(mesh.vertices.front());
        for (const Vec3& v : mesh.vertices)
            if (const Vec3 p = inCase.apply(v); p.z() > top.z()) top = p;
        const double awayMm = core::hypot(top.x() - own.centre().x(), top.y() - own.centre().y());
        if (best && awayMm >= leastMm) return;
        best = top;
        leastMm = awayMm;
    };
    for (const cases::PlacedTooth& other : toothCase.others)
        if (cases::isPermanentTooth(other.fdiNumber) && cases::isPermanentTooth(toothCase.fdiNumber) &&
            isUpperTooth(other.fdiNumber) == isUpperTooth(toothCase.fdiNumber))
            offer(other.surface(), other.inCase);
    for (const cases::Part& part : toothCase.scenery)
        if (part.tissue == cases::Tissue::neighbour) offer(part.mesh, {});
    return best;
}

UsualPosition usualPosition(int fdiNumber, Surface surface, bool isLeftHanded) {
    if (!cases::isPermanentTooth(fdiNumber))
        throw core::Error(fmt::format("there is no tooth {}", fdiNumber), "working position", "give 11 to 48");
    if (!isLeftHanded) return rightHanded(fdiNumber, surface);
    // As in a mirror: the other side's tooth from the other side.
    constexpr std::array<int, 5> kOtherSide = {0, 2, 1, 4, 3};
    const int fdi = 10 * kOtherSide[static_cast<std::size_t>(fdiNumber / 10)] + fdiNumber % 10;
    const UsualPosition seen = rightHanded(fdi, surface);
    return {mirroredHour(seen.hour), seen.byMirror};
}

}  // namespace handpiece::input
