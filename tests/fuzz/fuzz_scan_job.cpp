// SPDX-License-Identifier: Apache-2.0
// Any text as a scan's job must give one that comes back the same, or one core::Error.
#include "fuzz_model.h"
#include "handpiece/app/scan_case/scan_job.h"

namespace scan_case = handpiece::scan_case;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const scan_case::ScanJob job = scan_case::scanJobFromToml(text, "fuzz");
        try {
            const std::string kept = scan_case::toToml(job);
            if (scan_case::toToml(scan_case::scanJobFromToml(kept, "again")) != kept) __builtin_trap();
        } catch (const handpiece::core::Error&) {
            __builtin_trap();
        }
    });
}
