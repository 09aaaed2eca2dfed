// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/csv_cell.h"

#include <gtest/gtest.h>

namespace handpiece::core::csv_cell_test {
namespace {

TEST(CsvCell, IsNoFormula) {
    for (const char* formula : {"=1+1", "+cmd", "-cmd|' /C calc'!A0", "@SUM", "=", "-a"})
        EXPECT_EQ(csvCell(formula), std::string("'") + formula);
    EXPECT_EQ(csvCell("\tx"), "'\tx");
    EXPECT_EQ(csvCell("\rx"), "\"'\rx\"");
    EXPECT_EQ(csvCell("=HYPERLINK(\"http://x\",\"y\")"), "\"'=HYPERLINK(\"\"http://x\"\",\"\"y\"\")\"");
    for (const char* as : {"", "x", "-1.5e-3", "+7", "a=b", "1-2", "Ida"})
        EXPECT_EQ(csvCell(as), as);
}

TEST(CsvCell, IsOneCell) {
    EXPECT_EQ(csvCell("a,b"), "\"a,b\"");
    EXPECT_EQ(csvCell("a;b"), "\"a;b\"");
    EXPECT_EQ(csvCell("a\nb"), "\"a\nb\"");
    EXPECT_EQ(csvCell("say \"b\""), "\"say \"\"b\"\"\"");
    EXPECT_EQ(csvCell(" b"), "\" b\"");
}

}  // namespace
}  // namespace handpiece::core::csv_cell_test
