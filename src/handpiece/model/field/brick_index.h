// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Bricks of a grid by place and by number: x fastest.

#include <array>
#include <cstdint>

namespace handpiece::field {

[[nodiscard]] inline std::array<std::int32_t, 3> brickAt(const std::int32_t (&bricks)[3],
                                                         std::uint32_t dense) noexcept {
    const auto nx = static_cast<std::uint32_t>(bricks[0]), ny = static_cast<std::uint32_t>(bricks[1]);
    return {static_cast<std::int32_t>(dense % nx), static_cast<std::int32_t>(dense / nx % ny),
            static_cast<std::int32_t>(dense / nx / ny)};
}

[[nodiscard]] inline std::uint32_t denseOf(const std::int32_t (&bricks)[3],
                                           const std::array<std::int32_t, 3>& brick) noexcept {
    return static_cast<std::uint32_t>(brick[0]) +
           static_cast<std::uint32_t>(bricks[0]) *
               (static_cast<std::uint32_t>(brick[1]) +
                static_cast<std::uint32_t>(bricks[1]) * static_cast<std::uint32_t>(brick[2]));
}

}  // namespace handpiece::field
