// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/rotation.h"

namespace handpiece::core {

Quat rotationBetween(const Vec3& from, const Vec3& to) {
    // Eigen's takes the singular values of a matrix for opposite directions, and with them a second of compiling.
    return Quat::FromTwoVectors(from, to);
}

}  // namespace handpiece::core
