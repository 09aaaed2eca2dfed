// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the Haply service says of its devices, read out of its JSON by a scanner of our own: no allocation, nothing
/// thrown, whatever comes in. Facts: docs.haply.co, Inverse SDK 3.1 to 3.5.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace handpiece::drivers {

/// What a service says or does not.
enum class Said : std::int8_t { no, yes, nothing = -1 };

/// An arm as the service tells it, in the service's frame: +x right, +y away from the user, +z up; metres.
struct HaplyArm {
    std::array<char, 64> id{};
    std::array<char, 32> type{};   ///< "inverse3", "inverse3x", "minverse"; empty after the first message
    std::array<char, 16> basis{};  ///< "XYZ" unless somebody asked for other axes
    std::array<char, 64> firmware{};
    bool hasPosition = false;
    std::array<double, 3> positionM{};
    bool scaled = false;  ///< the service multiplies positions by something (mount, transform)
    Said calibrated = Said::nothing, inUse = Said::nothing, powered = Said::nothing, ready = Said::nothing;
};

struct HaplyGrip {
    std::array<char, 64> id{};
    bool wireless = false, hasOrientation = false;
    std::array<double, 4> orientation{1, 0, 0, 0};  ///< w x y z, as sent: perhaps not of unit length
    std::uint32_t buttons = 0;                      ///< a, b, c: bits 0, 1, 2
};

struct HaplyState {
    static constexpr std::size_t kMost = 8;
    std::array<HaplyArm, kMost> arms{};
    std::array<HaplyGrip, kMost> grips{};
    std::size_t armCount = 0, gripCount = 0;
    bool hasSession = false;  ///< "session_id": a service of 3.5 or later

    [[nodiscard]] const HaplyArm* arm(std::string_view id) const noexcept;
    [[nodiscard]] const HaplyGrip* grip(std::string_view id) const noexcept;
};

[[nodiscard]] std::string_view textOf(const char* text, std::size_t most) noexcept;
template <std::size_t n>
[[nodiscard]] std::string_view textOf(const std::array<char, n>& text) noexcept {
    return textOf(text.data(), n);
}

/// False when `json` is no whole JSON object, is nested deeper than 32, or holds a number where it must not; `state`
/// is then of no use. Devices beyond kMost are left out.
[[nodiscard]] bool readHaplyState(std::string_view json, HaplyState& state) noexcept;

/// The message that makes an arm push and the service answer with its state. `newer`: of a service of 3.5 or later.
/// Returns its size; 0 when it does not fit or the force is no number.
[[nodiscard]] std::size_t writeHaplyForce(std::string_view id, const std::array<double, 3>& forceN, bool newer,
                                          char* out, std::size_t room) noexcept;

}  // namespace handpiece::drivers
