// SPDX-License-Identifier: Apache-2.0
// Any text as marks that a teacher gave back must give such that are written, read and written again as the same bytes,
// or one core::Error.
#include <cmath>

#include "fuzz_model.h"
#include "handpiece/app/marking/returned_marks.h"

namespace marking = handpiece::marking;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const marking::ReturnedMarks read = marking::parseReturned(text, "fuzz");
        const std::string once = marking::returnedJson(read);
        const auto again = handpiece::fuzz::mustRead([&] { return marking::parseReturned(once, "fuzz"); });
        if (marking::returnedJson(again) != once) __builtin_trap();
        if (!(read.score <= read.maxScore) || read.comments.size() > 1000) __builtin_trap();
        for (const marking::Comment& c : read.comments)
            if (c.placeMm && !c.placeMm->allFinite()) __builtin_trap();
    });
}
