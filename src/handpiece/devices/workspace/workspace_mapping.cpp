// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/workspace/workspace_mapping.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"

namespace handpiece::workspace {

using core::Quat;
using core::Vec3;

namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kFarMm = 1e4;  // farther than any arm reaches

[[noreturn]] void refuse(const std::string& what, const char* where, const std::string& remedy) {
    throw core::Error(what, where, remedy).as("bad-placing", {what});
}

void requirePlace(const Vec3& place, const char* name) {
    if (!place.allFinite() || place.cwiseAbs().maxCoeff() > kFarMm)
        refuse(fmt::format("the place {:.6g}, {:.6g}, {:.6g} mm is out of any reach", place[0], place[1], place[2]),
               name, "give millimetres");
}

/// Where the bur's axes lie in the stylus frame. The handle runs along the bur's +x and rises (turbine.h), so bur and
/// handle share the plane x = 0 of the stylus, and the bur's +y is the stylus' +x.
Quat headOnHandle(const WorkspaceMapping& p) {
    const double angle = p.burAlongStylus ? 180.0 : p.headAngleDeg;
    const double rise = (angle - 90.0) * kRadPerDeg;  // of the handle over the plane across the bur
    core::Mat3 burAxes;                               // its columns, in the stylus frame
    burAxes.col(0) = Vec3(0.0, -core::sin(rise), core::cos(rise));
    burAxes.col(1) = Vec3::UnitX();
    burAxes.col(2) = Vec3(0.0, core::cos(rise), core::sin(rise));
    // The bur points down from the handle, so a turn about +z (to the tail) brings its tip to the right. Mirroring the
    // instrument (x to -x) turns the roll round; bur and handpiece are themselves symmetric left to right.
    const double roll = p.burAlongStylus ? 0.0 : (p.leftHanded ? -1.0 : 1.0) * p.headRollDeg * kRadPerDeg;
    return (core::rotationAbout(Vec3::UnitZ(), roll) * Quat(burAxes)).normalized();
}

Vec3 vectorOf(const std::array<double, 3>& a) noexcept {
    return {a[0], a[1], a[2]};
}

}  // namespace

void validate(const WorkspaceMapping& p) {
    requirePlace(p.deviceMm, "device_mm");
    requirePlace(p.toothMm, "tooth_mm");
    requirePlace(p.tipFromStylusMm, "tip_from_stylus_mm");
    if (!p.toothInDevice.coeffs().allFinite() || std::abs(p.toothInDevice.norm() - 1.0) > 1e-6)
        refuse("the tooth's turn in the device is no rotation", "tooth_in_device", "give a unit quaternion w, x, y, z");
    if (p.scale != 1.0 && p.scale != 2.0 && p.scale != 3.0)
        refuse(fmt::format("a scale of {:.6g}", p.scale), "scale", "give 1, 2 or 3");
    if (!(p.headAngleDeg >= 60.0 && p.headAngleDeg <= 180.0))
        refuse(fmt::format("a head at {:.6g} degrees to its handle", p.headAngleDeg), "head_angle_deg",
               "give 60 to 180");
    if (!(p.headRollDeg >= -180.0 && p.headRollDeg <= 180.0))
        refuse(fmt::format("a head turned by {:.6g} degrees on its handle", p.headRollDeg), "head_roll_deg",
               "give -180 to 180");
}

WorkspaceTransform::WorkspaceTransform(const WorkspaceMapping& placing) noexcept
    : placing_(placing),
      burInStylus_(headOnHandle(placing)),
      leverMm_(placing.tipFromStylusMm.cwiseProduct(Vec3(placing.leftHanded ? -1.0 : 1.0, 1.0, 1.0))) {}

namespace {

Quat stylusInDevice(const link::DriverReading& r) noexcept {
    return {r.orientation[0], r.orientation[1], r.orientation[2], r.orientation[3]};
}

}  // namespace

core::Pose WorkspaceTransform::burInTooth(const link::DriverReading& reading) const noexcept {
    const Quat stylus = stylusInDevice(reading), deviceInTooth = placing_.toothInDevice.conjugate();
    const Vec3 tip = vectorOf(reading.positionMm) + stylus * leverMm_;
    core::Pose pose;
    pose.positionMm = placing_.toothMm + deviceInTooth * (tip - placing_.deviceMm) / placing_.scale;
    pose.orientation = (deviceInTooth * stylus * burInStylus_).normalized();
    return pose;
}

Vec3 WorkspaceTransform::inDevice(const Vec3& inTooth) const noexcept {
    return placing_.toothInDevice * inTooth;
}

Vec3 WorkspaceTransform::inTooth(const Vec3& inDevice) const noexcept {
    return placing_.toothInDevice.conjugate() * inDevice;
}

Vec3 WorkspaceTransform::torqueInDevice(const Vec3& inToothNmm) const noexcept {
    return placing_.scale * (placing_.toothInDevice * inToothNmm);
}

Vec3 WorkspaceTransform::gripInBurMm() const noexcept {
    return burInStylus_.conjugate() * -leverMm_ / placing_.scale;
}

void WorkspaceTransform::regrip(const link::DriverReading& reading, const Vec3& burMm) noexcept {
    placing_.deviceMm = vectorOf(reading.positionMm) + stylusInDevice(reading) * leverMm_;
    placing_.toothMm = burMm;
}

device::Capability atTheBur(const device::Capability& atTheHand, const WorkspaceMapping& placing) {
    device::Capability c = atTheHand;
    c.maxStiffnessNPerMm *= placing.scale;
    c.maxDampingNSPerMm *= placing.scale;
    c.maxTorqueNmm /= placing.scale;
    c.encoderStepMm /= placing.scale;
    c.workspaceMm /= placing.scale;
    return c;
}

}  // namespace handpiece::workspace
