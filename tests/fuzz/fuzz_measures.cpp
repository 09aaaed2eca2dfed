// SPDX-License-Identifier: Apache-2.0
// Any bytes as kept measures must give measures that are kept again as the same bytes, or nothing. The input is the
// text behind the hash that is believed; it is tried with the hash set right, and as it is.
#include <string>

#include "fuzz_model.h"
#include "handpiece/app/assessment/measure_store.h"

namespace assessment = handpiece::assessment;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const assessment::StoreKey key{"work", "exercise"};
    (void)assessment::decodeMeasures(text, key);
    handpiece::core::Hasher hasher;
    hasher.add(text);
    const std::string sealed =
        "handpiece-measures-1 " + handpiece::rubric::hashText(hasher.value()) + "\n" + std::string(text);
    if (const auto read = assessment::decodeMeasures(sealed, key)) {
        const std::string once = assessment::encodeMeasures(key, *read);
        const auto again = assessment::decodeMeasures(once, key);
        if (!again || assessment::encodeMeasures(key, *again) != once) __builtin_trap();
    }
    return 0;
}
