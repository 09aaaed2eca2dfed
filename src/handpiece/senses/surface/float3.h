// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Three floats as vertices hold them. Private to this room.

#include <array>

namespace handpiece::surface {

using Float3 = std::array<float, 3>;

[[nodiscard]] inline Float3 minus(const Float3& a, const Float3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[nodiscard]] inline Float3 cross(const Float3& a, const Float3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline float dot(const Float3& a, const Float3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace handpiece::surface
