// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Vectors, poses and boxes. Millimetres and radians; double precision.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>

namespace handpiece::core {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

/// Messages between threads and files hold plain arrays.
[[nodiscard]] inline Vec3 toVec(const std::array<double, 3>& a) noexcept {
    return {a[0], a[1], a[2]};
}
[[nodiscard]] inline std::array<double, 3> toArray(const Vec3& v) noexcept {
    return {v.x(), v.y(), v.z()};
}

/// A rigid placement of one frame in another, named after both: `burInTooth` maps bur coordinates to tooth coordinates.
struct Pose {
    Vec3 positionMm = Vec3::Zero();
    Quat orientation = Quat::Identity();  ///< Unit quaternion.

    [[nodiscard]] Vec3 apply(const Vec3& p) const { return orientation * p + positionMm; }
    [[nodiscard]] Vec3 applyInverse(const Vec3& p) const { return orientation.conjugate() * (p - positionMm); }
    [[nodiscard]] Pose inverse() const { return {orientation.conjugate() * -positionMm, orientation.conjugate()}; }
    /// To the bit.
    [[nodiscard]] bool isIdentity() const {
        return positionMm == Vec3::Zero() && orientation.coeffs() == Quat::Identity().coeffs();
    }
    [[nodiscard]] Pose normalised() const { return {positionMm, orientation.normalized()}; }
    /// `inner` in the frame that this pose stands in; the product of long chains needs normalised().
    [[nodiscard]] Pose operator*(const Pose& inner) const {
        return {apply(inner.positionMm), orientation * inner.orientation};
    }
    /// True when every number is finite and the quaternion is of unit length within 1e-6.
    [[nodiscard]] bool isValid() const {
        return positionMm.allFinite() && orientation.coeffs().allFinite() &&
               std::abs(orientation.squaredNorm() - 1.0) < 1e-6;
    }
};

/// An axis-aligned box [mm]; empty until extended.
struct Box {
    Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 max = Vec3::Constant(-std::numeric_limits<double>::infinity());

    void extend(const Vec3& p) {
        min = min.cwiseMin(p);
        max = max.cwiseMax(p);
    }
    [[nodiscard]] bool isEmpty() const { return (min.array() > max.array()).any(); }
    [[nodiscard]] Vec3 size() const { return max - min; }
    [[nodiscard]] Vec3 centre() const { return 0.5 * (min + max); }
    [[nodiscard]] Box grown(double byMm) const { return {min - Vec3::Constant(byMm), max + Vec3::Constant(byMm)}; }
};

}  // namespace handpiece::core
