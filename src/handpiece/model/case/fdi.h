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

[[nodiscard]] constexpr bool isPermanentTooth(int fdi) noexcept {
    return fdi >= 11 && fdi <= 48 && fdi % 10 >= 1 && fdi % 10 <= 8;
}
[[nodiscard]] constexpr bool isDeciduousTooth(int fdi) noexcept {
    return fdi >= 51 && fdi <= 85 && fdi % 10 >= 1 && fdi % 10 <= 5;
}
/// From the patient's right to the left: 18 to 11 are -8 to -1, 21 to 28 are 0 to 7.
[[nodiscard]] constexpr int placeAlongArch(int fdi) noexcept {
    return isRightTooth(fdi) ? -(fdi % 10) : fdi % 10 - 1;
}
/// Beside each other in one arch, both permanent or both deciduous; the central incisors are.
[[nodiscard]] constexpr bool areAdjacentTeeth(int a, int b) noexcept {
    const int apart = placeAlongArch(a) - placeAlongArch(b);
    return a != 0 && b != 0 && isLowerTooth(a) == isLowerTooth(b) && (a < 50) == (b < 50) &&
           (apart == 1 || apart == -1);
}

}  // namespace handpiece::cases
