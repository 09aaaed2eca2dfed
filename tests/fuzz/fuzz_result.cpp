// SPDX-License-Identifier: Apache-2.0
// Any text as a result.json must give a result that is written, read and written again as the same bytes, or one
// core::Error. A class's page takes whatever a result may be.
#include "fuzz_model.h"
#include "handpiece/app/assessment/assessment_json.h"

namespace assessment = handpiece::assessment;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const handpiece::score::Result read = assessment::parseResult(text, "fuzz");
        const std::string once = assessment::resultJson(read.assessment, read.identity);
        const auto again = handpiece::fuzz::mustRead([&] { return assessment::parseResult(once, "fuzz"); });
        if (assessment::resultJson(again.assessment, again.identity) != once) __builtin_trap();
        handpiece::report::ClassEntry entry;
        entry.student = entry.file = read.identity.exercise;
        entry.result = read;
        const std::string page = handpiece::report::classReport({entry, entry});
        if (page.find("<script") != std::string::npos || page.find("nan") != std::string::npos) __builtin_trap();
    });
}
