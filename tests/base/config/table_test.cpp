// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/config/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "support/error_of.h"

namespace handpiece::config::table_test {
namespace {

using test::errorOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const char* kText = R"(name = "molar"
count = 3
share = 0.25
on = true
list = [1, 2.5]
words = ["a", "b"]
far = inf
[inner]
x = 1
[[row]]
y = 1
[[row]]
y = 2
)";

TEST(Table, GivesWhatIsThere) {
    const Table t = Table::parse(kText, "file.toml");
    EXPECT_EQ(t.text("name"), "molar");
    EXPECT_EQ(t.integer("count"), 3);
    EXPECT_EQ(t.number("count"), 3.0);
    EXPECT_EQ(t.number("share"), 0.25);
    EXPECT_EQ(t.flag("on"), true);
    EXPECT_THAT(t.numbers("list"), ElementsAre(1.0, 2.5));
    EXPECT_THAT(t.texts("words"), ElementsAre("a", "b"));
    EXPECT_EQ(t.table("inner")->integer("x"), 1);
    ASSERT_EQ(t.tables("row").size(), 2u);
    EXPECT_EQ(t.tables("row")[1].integer("y"), 2);
    EXPECT_FALSE(t.text("none"));
    EXPECT_FALSE(t.table("none"));
    EXPECT_TRUE(t.tables("none").empty());
    EXPECT_TRUE(t.isTable("inner"));
    EXPECT_FALSE(t.isTable("name"));
    EXPECT_THAT(Table::parse("b = 1\na = 2\n", "f").keys(), ElementsAre("a", "b"));
}

TEST(Table, GivesListsOfListsAndWhereTheyStand) {
    const Table t = Table::parse("a = 1\nknots = [[1, 2.5], [3]]\nflat = [1]\nfar = [[1], [nan]]\n", "f");
    EXPECT_THAT(t.numberRows("knots"), ElementsAre(ElementsAre(1.0, 2.5), ElementsAre(3.0)));
    EXPECT_TRUE(t.numberRows("none").empty());
    EXPECT_EQ(t.line("knots"), 2);
    EXPECT_EQ(t.line(), 1);
    EXPECT_THAT(errorOf([&] { (void)t.numberRows("flat"); }), HasSubstr("line 3"));
    EXPECT_THAT(errorOf([&] { (void)t.numberRows("a"); }), HasSubstr("list of lists"));
    EXPECT_THAT(errorOf([&] { (void)t.numberRows("far"); }), HasSubstr("finite"));
}

TEST(Table, OutlivesItsDocument) {
    std::vector<Table> rows;
    {
        const Table t = Table::parse(kText, "file.toml");
        rows = t.tables("row");
    }
    EXPECT_EQ(rows[0].integer("y"), 1);
}

TEST(Table, TellsFileLineAndKey) {
    const Table t = Table::parse(kText, "file.toml");
    EXPECT_THAT(errorOf([&] { (void)t.text("count"); }),
                AllOf(HasSubstr("file.toml"), HasSubstr("\"count\""), HasSubstr("line 2"), HasSubstr("wrong type")));
    EXPECT_THAT(errorOf([&] { (void)t.integer("share"); }), HasSubstr("line 3"));
    EXPECT_THAT(errorOf([&] { (void)t.number("far"); }), AllOf(HasSubstr("inf"), HasSubstr("line 7")));
    EXPECT_THAT(errorOf([&] { (void)t.number("name"); }), HasSubstr("number"));
    EXPECT_THAT(errorOf([&] { (void)t.flag("name"); }), HasSubstr("true or false"));
    EXPECT_THAT(errorOf([&] { (void)t.table("name"); }), HasSubstr("a table"));
    EXPECT_THAT(errorOf([&] { (void)t.tables("words"); }), HasSubstr("list of tables"));
    EXPECT_THAT(errorOf([&] { (void)t.numbers("words"); }), HasSubstr("list of numbers"));
    EXPECT_THAT(errorOf([&] { (void)t.texts("list"); }), HasSubstr("list of texts"));
    EXPECT_THAT(errorOf([&] { t.tables("row")[1].allowOnly({"z"}); }),
                AllOf(HasSubstr("no key \"y\""), HasSubstr("line 13"), HasSubstr("the keys are z")));
    EXPECT_THAT(errorOf([] { (void)Table::parse("a = \n", "g.toml"); }), AllOf(HasSubstr("g.toml"), HasSubstr("line")));
    EXPECT_THAT(errorOf([] { (void)Table::read("/nowhere/x.toml"); }), HasSubstr("no such file"));
}

/// `piece` as often as fills a text of half a megabyte.
std::string manyOf(const std::string& piece, std::size_t bytes = 500'000) {
    std::string text;
    while (text.size() < bytes)
        text += piece;
    return text;
}

TEST(Table, TablesInTablesWithoutEndAreRefused) {
    const auto parse = [](const std::string& text) { return errorOf([&] { (void)Table::parse(text, "f.toml"); }); };
    const auto isRefused = AllOf(HasSubstr("f.toml"), HasSubstr("in one another"));
    const std::string deep[] = {manyOf("a.") + "a = 1",
                                "[" + manyOf("a.") + "a]",
                                "[[" + manyOf("a . ") + "a]]",
                                manyOf(R"("a.b#" . 'c d\'.)") + "e = 1",
                                "x = { " + manyOf("a.") + "b = 1 }",
                                "x = " + manyOf("["),
                                "x = " + manyOf("[{a.b.c="),
                                "x = " + manyOf("{a=")};
    for (const std::string& text : deep)
        EXPECT_THAT(parse(text), isRefused) << text.substr(0, 30);
    // Strings hide nothing.
    for (const char* before : {R"(s = "\"")", R"(s = '\')", R"(s = "")", "s = ''", "# \"", R"(s = """\"""")",
                               R"(s = """a""""")", "s = '''\n\\'''", "s = \"\"\"\n'\n#\"\"\"", R"(s = """""")"})
        EXPECT_THAT(parse(before + ("\n" + manyOf("a.")) + "a = 1"), isRefused) << before;
    // And are no keys themselves.
    const std::string prose = manyOf("One. Two [three] {four}. ", 5000);
    EXPECT_EQ(Table::parse("s = \"" + prose + "\"\nt = '''\n" + prose + "''' # " + prose, "f").text("s"), prose);
    EXPECT_EQ(parse("a = [\n" + manyOf("[1.5, 2.5],\n") + "]\n"), "");
    EXPECT_EQ(parse("a." + manyOf("b.", 20) + "c = 1"), "");
}

TEST(Table, OnlyTextsOfDecentSizeAndPlainFilesAreRead) {
    EXPECT_THAT(errorOf([] { (void)Table::parse("#" + std::string(Table::kMaxBytes, ' '), "f.toml"); }),
                AllOf(HasSubstr("f.toml"), HasSubstr("more than")));
    EXPECT_THAT(errorOf([] { (void)Table::read("/dev/zero"); }), HasSubstr("not a plain file"));
}

}  // namespace
}  // namespace handpiece::config::table_test
