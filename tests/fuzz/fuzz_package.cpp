// SPDX-License-Identifier: Apache-2.0
// Any bytes must give files with decent names, or one core::Error, within the limits.
#include <string>

#include "fuzz_model.h"
#include "handpiece/model/case/package.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    handpiece::cases::PackageLimits limits;
    limits.bytes = 1 << 20;
    limits.files = 64;
    try {
        std::size_t total = 0;
        for (const auto& [name, content] :
             handpiece::cases::readPackage(std::as_bytes(std::span(data, size)), "fuzz", limits)) {
            total += content.size();
            const std::string path = "/" + name + "/";
            if (name.empty() || path.find("//") != std::string::npos || path.find("/../") != std::string::npos)
                __builtin_trap();
        }
        if (total > limits.bytes) __builtin_trap();
    } catch (const handpiece::core::Error& e) {
        if (e.problem().empty()) __builtin_trap();
    }
    return 0;
}
