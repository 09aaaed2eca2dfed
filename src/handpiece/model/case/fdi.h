// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an FDI number (ISO 3950) says of a tooth's place, permanent or deciduous. Of 0, which is none, all is false.

namespace handpiece::cases {

[[nodiscard]] constexpr bool isUpperTooth(int fdi) noexcept {
    const int quadrant = fdi / 10;
    return quadrant == 1 || quadrant == 2 || quadrant == 5 || quadrant == 6;
}
[[nodiscard]] constexpr bool isLowerTooth(int fdi) noexcept {
    const int quadrant = fdi / 10;
    return quadrant == 3 || quadrant == 4 || quadrant == 7 || quadrant == 8;
}
/// Of the patient.
[[nodiscard]] constexpr bool isRightTooth(int fdi) noexcept {
    const int quadrant = fdi / 10;
    return quadrant == 1 || quadrant == 4 || quadrant == 5 || quadrant == 8;
}

}  // namespace handpiece::cases
