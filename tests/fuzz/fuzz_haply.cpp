// SPDX-License-Identifier: Apache-2.0
// What Haply's service sends, under libFuzzer: the scanner takes anything and gives only finite numbers and whole
// texts.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "handpiece/devices/drivers/haply_state.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace handpiece::drivers;
    static HaplyState state;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (!readHaplyState(text, state)) return 0;
    if (state.armCount > HaplyState::kMost || state.gripCount > HaplyState::kMost) std::abort();
    for (std::size_t i = 0; i < state.armCount; ++i) {
        const HaplyArm& arm = state.arms[i];
        if (arm.id.back() != '\0' || arm.type.back() != '\0' || arm.basis.back() != '\0') std::abort();
        for (const double p : arm.positionM)
            if (!std::isfinite(p)) std::abort();
        std::array<char, 256> out{};
        if (writeHaplyForce(textOf(arm.id), arm.positionM, true, out.data(), out.size()) > out.size()) std::abort();
    }
    for (std::size_t i = 0; i < state.gripCount; ++i)
        for (const double q : state.grips[i].orientation)
            if (!std::isfinite(q)) std::abort();
    return 0;
}
