// SPDX-License-Identifier: Apache-2.0
// Any text as marks must give agreement statistics without a number that is none, or one core::Error.
#include <cmath>

#include "fuzz_model.h"
#include "handpiece/app/assessment/marks_agreement.h"

namespace assessment = handpiece::assessment;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        for (const assessment::MarkTable& table : assessment::parseMarks(text, "fuzz")) {
            const assessment::CriterionAgreement found = assessment::agreementOf(table, {}, 20);
            for (const assessment::Alpha& alpha : found.alphas)
                if (alpha.estimate.value && !std::isfinite(*alpha.estimate.value)) __builtin_trap();
            if (found.icc)
                for (const auto* e : {&found.icc->one1, &found.icc->two1, &found.icc->three1, &found.icc->oneK,
                                      &found.icc->twoK, &found.icc->threeK})
                    if (e->value && !std::isfinite(*e->value)) __builtin_trap();
        }
    });
}
