// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/falcon_kinematics.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::drivers::falcon {
namespace {

using core::Mat3;
using core::Vec3;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// Of one arm: columns u, v, w in the device's frame.
struct ArmFrame {
    double cos, sin;
};
const std::array<ArmFrame, 3>& armFrames() noexcept {
    static const std::array<ArmFrame, 3> frames = [] {
        std::array<ArmFrame, 3> made{};
        for (std::size_t i = 0; i < 3; ++i)
            made[i] = {core::cos(kArmAtDeg[i] * kRadPerDeg), core::sin(kArmAtDeg[i] * kRadPerDeg)};
        return made;
    }();
    return frames;
}

/// The end of an arm from its crank's pivot, in the arm's frame.
Vec3 endOf(const ArmFrame& arm, const Vec3& grip) noexcept {
    return {arm.cos * grip.x() + arm.sin * grip.y() - kPivotOutMm + kGripOutMm,
            -arm.sin * grip.x() + arm.cos * grip.y() - kPivotAcrossMm + kGripAcrossMm, grip.z()};
}

/// How far the closing equation of an arm is from holding [mm^2], with its derivatives along the grip's place and the
/// crank. False beyond the parallelogram.
struct Closing {
    double value, byCrank;
    Vec3 byGrip;
};
bool closingOf(const ArmFrame& arm, const Vec3& grip, double crank, Closing& closing) noexcept {
    const Vec3 q = endOf(arm, grip);
    const double under = kParallelogramMm * kParallelogramMm - q.y() * q.y();
    if (!(under > 1e-6)) return false;
    const double root = std::sqrt(under), reach = 2 * kJointMm + root;
    const double c = core::cos(crank), s = core::sin(crank);
    const double du = q.x() - kCrankMm * c, dw = q.z() - kCrankMm * s;
    closing.value = du * du + dw * dw - reach * reach;
    closing.byCrank = 2 * kCrankMm * (du * s - dw * c);
    const double byU = 2 * du, byV = 2 * reach * q.y() / root;
    closing.byGrip = {byU * arm.cos - byV * arm.sin, byU * arm.sin + byV * arm.cos, 2 * dw};
    return true;
}

}  // namespace

double crankOf(int count) noexcept {
    return (kDegAtZero + kDegPerCount * count) * kRadPerDeg;
}
double countOf(double crankRad) noexcept {
    return (crankRad / kRadPerDeg - kDegAtZero) / kDegPerCount;
}

Vec3 middleMm() noexcept {
    return {0, 0, 120.0};
}

bool inverse(const Vec3& gripMm, Vec3& cranksRad) noexcept {
    if (!gripMm.allFinite()) return false;
    Vec3 found;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 q = endOf(armFrames()[i], gripMm);
        const double under = kParallelogramMm * kParallelogramMm - q.y() * q.y();
        if (!(under > 0)) return false;
        const double reach = 2 * kJointMm + std::sqrt(under);
        const double out = core::hypot(q.x(), q.z());
        const double cosine = (out * out + kCrankMm * kCrankMm - reach * reach) / (2 * kCrankMm * out);
        if (!(std::abs(cosine) <= 1)) return false;
        // Of the two the one whose knee points away from the axis.
        found[static_cast<Eigen::Index>(i)] = core::atan2(q.z(), q.x()) - core::acos(cosine);
    }
    cranksRad = found;
    return true;
}

bool forward(const Vec3& cranksRad, Vec3& gripMm) noexcept {
    if (!cranksRad.allFinite()) return false;
    Vec3 grip = gripMm;
    constexpr int kSteps = 25;
    for (int step = 0; step < kSteps; ++step) {
        Mat3 slope;
        Vec3 off;
        for (int i = 0; i < 3; ++i) {
            Closing closing{};
            if (!closingOf(armFrames()[static_cast<std::size_t>(i)], grip, cranksRad[i], closing)) return false;
            off[i] = closing.value;
            slope.row(i) = closing.byGrip.transpose();
        }
        Mat3 inverted;
        bool good = false;
        slope.computeInverseWithCheck(inverted, good, 1e-3);
        if (!good) return false;
        Vec3 move = inverted * off;
        const double length = move.norm();
        constexpr double kLongestMm = 20.0;  // from far away, not into the mirror image of the arms
        if (length > kLongestMm) move *= kLongestMm / length;
        grip -= move;
        if (length < 1e-10) {
            // The arms have a second solution, folded through: the crank tells which one this is.
            Vec3 back;
            if (!inverse(grip, back) || (back - cranksRad).cwiseAbs().maxCoeff() > 1e-6) return false;
            gripMm = grip;
            return true;
        }
    }
    return false;
}

bool torquesFor(const Vec3& gripMm, const Vec3& cranksRad, const Vec3& forceN, Vec3& torqueNmm) noexcept {
    // d crank = turn d grip, so force = turn^T torque.
    Mat3 turn;
    for (int i = 0; i < 3; ++i) {
        Closing closing{};
        if (!closingOf(armFrames()[static_cast<std::size_t>(i)], gripMm, cranksRad[i], closing)) return false;
        if (std::abs(closing.byCrank) < 1e-3) return false;
        turn.row(i) = -closing.byGrip.transpose() / closing.byCrank;
    }
    Mat3 inverted;
    bool good = false;
    turn.transpose().eval().computeInverseWithCheck(inverted, good, 1e-12);
    if (!good) return false;
    torqueNmm = inverted * forceN;
    return torqueNmm.allFinite();
}

}  // namespace handpiece::drivers::falcon
