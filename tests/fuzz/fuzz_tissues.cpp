// SPDX-License-Identifier: Apache-2.0
// Any text must give a table whose values are in range, or one core::Error.
#include <cmath>

#include "fuzz_model.h"
#include "handpiece/model/case/tissue.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const handpiece::cases::TissueTable table = handpiece::cases::parseTissues(text, "fuzz");
        for (const handpiece::cases::TissueProperties& p : table.rows)
            if (!(p.stiffnessFraction >= 0.0 && p.stiffnessFraction <= 1.0) || !(p.dampingNSPerMm >= 0.0) ||
                !(p.friction >= 0.0) || !(p.cuttingMm2PerN >= 0.0) || !std::isfinite(p.cuttingMm2PerN))
                __builtin_trap();
    });
}
