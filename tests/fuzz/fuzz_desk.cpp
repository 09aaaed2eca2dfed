// SPDX-License-Identifier: Apache-2.0
// Any text as a marker's desk must give one that is written, read and written again as the same bytes and has an order
// of marking, or one core::Error.
#include <set>

#include "fuzz_model.h"
#include "handpiece/app/marking/desk.h"

namespace marking = handpiece::marking;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const marking::DeskState read = marking::parseDesk(text, "fuzz");
        const std::string once = marking::deskJson(read);
        const auto again = handpiece::fuzz::mustRead([&] { return marking::parseDesk(once, "fuzz"); });
        if (marking::deskJson(again) != once) __builtin_trap();
        std::set<std::string> codes;
        for (const marking::DeskItem& item : marking::itemsOf(read))
            if (!codes.insert(item.code).second || !read.names.contains(item.workId)) __builtin_trap();
        (void)marking::heldBack(read);
    });
}
