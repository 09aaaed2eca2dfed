// SPDX-License-Identifier: Apache-2.0
// Any text must give a table, of tables in tables no deeper than was promised, or one core::Error.
#include "fuzz_model.h"
#include "handpiece/base/config/table.h"

namespace {

using handpiece::config::Table;

void walk(const Table& table, int depth) {
    // 32 brackets, and as many names in each.
    if (depth > 32 * 34) __builtin_trap();
    for (const std::string& key : table.keys()) {
        if (table.isTable(key)) walk(*table.table(key), depth + 1);
        try {
            for (const Table& row : table.tables(key))
                walk(row, depth + 1);
        } catch (const handpiece::core::Error&) {
            continue;  // no list of tables
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) { walk(Table::parse(text, "fuzz"), 0); });
}
