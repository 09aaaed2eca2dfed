// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/rotation.h"

#include "handpiece/base/core/portable_math.h"

namespace handpiece::core {

Quat rotationBetween(const Vec3& from, const Vec3& to) {
    // Eigen's takes the singular values of a matrix for opposite directions, and with them a second of compiling.
    return Quat::FromTwoVectors(from, to);
}

Quat rotationAbout(const Vec3& axis, double rad) noexcept {
    const Vec3 v = core::sin(0.5 * rad) * axis;
    return {core::cos(0.5 * rad), v.x(), v.y(), v.z()};
}

double angleBetween(const Quat& a, const Quat& b) noexcept {
    const Quat d = a * b.conjugate();
    return 2.0 * core::atan2(d.vec().norm(), std::abs(d.w()));
}

Quat interpolated(const Quat& from, double share, const Quat& to) noexcept {
    const double cosine = from.dot(to);
    double ofFrom = 1.0 - share, ofTo = share;
    if (std::abs(cosine) < 1.0 - 1e-15) {
        const double angle = core::acos(std::abs(cosine)), sine = core::sin(angle);
        ofFrom = core::sin(ofFrom * angle) / sine;
        ofTo = core::sin(ofTo * angle) / sine;
    }
    return Quat(ofFrom * from.coeffs() + std::copysign(ofTo, cosine) * to.coeffs());
}

}  // namespace handpiece::core
