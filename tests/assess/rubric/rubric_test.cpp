// SPDX-License-Identifier: Apache-2.0
// Rubrics as data: what the linter finds, what the hash means, and those that are shipped.
#include "handpiece/assess/rubric/rubric.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::rubric::rubric_test {
namespace {

using test::errorOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kHead =
    "format = 1\nid = \"r\"\nversion = \"1\"\nstatus = \"proposal\"\ntitle = { en = \"a rubric\" }\npass_mark = 60\n"
    "[[band]]\nid = \"good\"\n[[band]]\nid = \"fair\"\n[[band]]\nid = \"bad\"\n";
const std::string kDepth =
    "[[criterion]]\nid = \"depth\"\ntitle = { en = \"depth\" }\nmeasure = \"floor-depth\"\nunit = \"mm\"\nweight = 60\n"
    "knots = [[1, 0], [1.5, 100], [2, 100], [2.5, 0]]\n";
const std::string kWidth =
    "[[criterion]]\nid = \"width\"\ntitle = { en = \"width\" }\nmeasure = \"isthmus\"\nunit = \"mm\"\nweight = 40\n"
    "bands = [{ id = \"good\", from = 1, to = 1.5, points = 100 }, { id = \"fair\", from = 0.5, to = 1, points = 60 "
    "},\n"
    "  { id = \"bad\", to = 0.5, points = 0 }, { id = \"bad\", from = 1.5, points = 0 }]\n";

Rubric parsed(const std::string& text) {
    return parseRubric(text, "r.toml");
}
/// Errors and warnings, "where: problem".
std::vector<std::string> wrongWith(const std::string& text) {
    std::vector<std::string> all;
    for (const Finding& f : check(parsed(text)))
        if (f.severity != Severity::remark) all.push_back(f.where + ": " + f.problem);
    return all;
}
std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(Rubric, IsRead) {
    const Rubric r = parsed(kHead + kDepth + kWidth);
    EXPECT_THAT(wrongWith(kHead + kDepth + kWidth), IsEmpty());
    ASSERT_EQ(r.criteria.size(), 2u);
    EXPECT_EQ(r.criteria[0].weight, 60);
    EXPECT_EQ(r.criteria[0].knots.size(), 4u);
    EXPECT_EQ(pointsOf(r.criteria[0], 1.25), 50);
    EXPECT_EQ(pointsOf(r.criteria[0], 0.2), 0);
    EXPECT_EQ(pointsOf(r.criteria[0], 1.7), 100);
    EXPECT_EQ(bandOf(r.criteria[1], 1.5)->id, "good") << "of two that touch the first listed";
    EXPECT_EQ(bandOf(r.criteria[1], 1.0)->id, "good");
    EXPECT_EQ(bandOf(r.criteria[1], 0.5)->id, "fair");
    EXPECT_EQ(pointsOf(r.criteria[1], 9), 0);
}

TEST(Rubric, WhatIsNoneIsToldWithItsLine) {
    const std::string whole = kHead + kDepth + kWidth;
    const std::pair<std::string, const char*> wrong[] = {
        {"", "\"format\" is missing"},
        {replaced(whole, "format = 1", "format = 2"), "format 2 is not known (line 1)"},
        {replaced(whole, "weight = 60", "weight = 0"), "the weight is 0 (line"},
        {replaced(whole, "weight = 60", "weight = -5"), "the weight is -5 (line 18)"},
        {replaced(whole, "weight = 60", "weight = nan"), "\"weight\" is nan"},
        {replaced(whole, "weight = 60", "wieght = 60"), "there is no key \"wieght\""},
        {replaced(whole, "[1.5, 100]", "[1.5]"), "a knot is not [value, points]"},
        {replaced(whole, "[1.5, 100]", "[1e300, 100]"), "a knot is not"},
        {replaced(whole, "\"proposal\"", "\"official\""), "there is no status \"official\""},
        {replaced(whole, "id = \"depth\"", "id = \"Dépth\""), "is no name"},
        {replaced(whole, "measure = \"isthmus\"\n", ""), "\"measure\" is missing"},
        {whole + "[[rule]]\nid = \"x\"\nneeds = []\n", "needs nothing"},
        {whole + "[[rule]]\nid = \"x\"\nneeds = [{ bands = [\"good\"] }]\n", "neither a count nor a rule"},
        {whole + "[[rule]]\nid = \"x\"\nneeds = [{ rule = \"y\", most = 1 }]\n", "neither a count nor a rule"},
        {whole + "[[rule]]\nid = \"x\"\nneeds = [{ bands = [\"good\"], most = -1 }]\n", "\"most\" is -1"},
        {std::string(kMaxBytes + 1, '#'), "bytes, more than"},
        {kHead + "x = " + std::string(2000, '[') + "\n", "tables or lists in one another"},
    };
    for (const auto& [text, told] : wrong)
        EXPECT_THAT(errorOf([&] { (void)parsed(text); }), AllOf(HasSubstr(told), HasSubstr("r.toml")))
            << text.substr(0, 400);
    std::string many = kHead;
    for (std::size_t i = 0; i <= kMaxCriteria; ++i)
        many += "[[criterion]]\nid = \"c" + std::to_string(i) + "\"\nmeasure = \"time\"\n";
    EXPECT_THAT(errorOf([&] { (void)parsed(many); }), HasSubstr("201 entries, more than 200"));
    std::string knots = kHead + "[[criterion]]\nid = \"c\"\nmeasure = \"time\"\nknots = [";
    for (std::size_t i = 0; i <= kMaxPieces; ++i)
        knots += "[1, 1],";
    EXPECT_THAT(errorOf([&] { (void)parsed(knots + "]\n"); }), HasSubstr("65 entries"));
    EXPECT_THAT(errorOf([&] { (void)parsed(replaced(whole, "a rubric", std::string(5000, 'x'))); }),
                HasSubstr("say it shorter"));
}

TEST(Linter, FindsWhatMakesNoSense) {
    const std::string whole = kHead + kDepth + kWidth;
    const auto rule = [&](const std::string& needs, const std::string& more = "required = true\n") {
        return whole + "[[rule]]\nid = \"x\"\nneeds = [" + needs + "]\n" + more;
    };
    const std::pair<std::string, const char*> wrong[] = {
        {replaced(whole, "floor-depth", "flor-depth"),
         "r.toml:13: criterion depth: there is no measure \"flor-depth\""},
        {replaced(whole, "unit = \"mm\"\nweight = 60", "weight = 60"), "the unit is missing"},
        {replaced(whole, "unit = \"mm\"\nweight = 60", "unit = \"um\"\nweight = 60"), "the unit is \"um\""},
        {replaced(whole, "pass_mark", "total_weight = 90\npass_mark"), "the weights sum to 100, not to the 90"},
        {replaced(whole, "pass_mark = 60", "pass_mark = 101"), "pass_mark is 101"},
        {replaced(whole, "pass_mark = 60", "pass_mark = 0"), "pass_mark is 0"},
        {replaced(whole, "[2, 100]", "[1.2, 100]"), "the knots do not ascend at 1.2"},
        {replaced(whole, "[2, 100]", "[1.5, 100]"), "the knots do not ascend at 1.5"},
        {replaced(whole, "[2, 100], [2.5, 0]", "[2, 50], [2.5, 80]"), "the points rise again after they fell"},
        {replaced(whole, "[2.5, 0]", "[25, 0]"), "a knot lies at 25 mm, which no measure can have: 0 to 20"},
        {replaced(whole, "[2, 100]", "[2, 101]"), "a knot gives 101 points"},
        {replaced(whole, "[[1, 0], [1.5, 100], [2, 100], [2.5, 0]]", "[[1, 100]]"), "one knot is no curve"},
        {replaced(whole, "weight = 60\n", ""), "it has knots and no weight"},
        {replaced(whole, "knots = [[1, 0], [1.5, 100], [2, 100], [2.5, 0]]\n", ""), "neither knots nor bands"},
        {replaced(whole, "from = 0.5, to = 1, points", "from = 0.6, to = 1, points"),
         "no band has the values from 0.5 to 0.6"},
        {replaced(whole, "{ id = \"bad\", to = 0.5", "{ id = \"bad\", from = 0.1, to = 0.5"),
         "no band has the values from 0 to 0.1"},
        {replaced(whole, "from = 1.5, points", "from = 1.5, to = 3, points"), "no band has the values from 3 to 20"},
        {replaced(whole, "from = 1, to = 1.5", "from = 0.9, to = 1.5"), "both have the values from 0.9 to 1"},
        {replaced(whole, "from = 1, to = 1.5", "from = 1.5, to = 1"), "goes from 1.5 to 1"},
        {replaced(whole, "{ id = \"fair\"", "{ id = \"nice\""), "there is no band \"nice\""},
        {replaced(whole, "to = 1, points = 60", "to = 1"), "band \"fair\" gives no points"},
        {replaced(whole, "points = 60", "points = 160"), "gives 160 points"},
        {replaced(whole, "weight = 40\n", ""), "gives points, and there is no weight"},
        {replaced(whole, "weight = 40\n", "weight = 40\nknots = [[0, 0], [1, 100]]\n"),
         "gives points, and the knots do too"},
        {replaced(whole, "to = 0.5, points = 0", "to = 0.5, points = 70"), "the points of the bands rise again"},
        {replaced(whole, "points = 60", "points = 0"), ""},
        {kHead + kDepth + "critical = {}\n", "no condition"},
        {kHead + kDepth + "critical = { above = 30 }\n", "critical above at 30 mm, which no measure can have"},
        {kHead + kDepth + "critical = { below = 3, above = 2 }\n", "every value is critical"},
        {kHead + kDepth + "critical = { above = 20 }\n", "no value can be critical"},
        {kHead + kWidth + "side = \"mesial\"\n", "isthmus has no side"},
        {kHead + replaced(kDepth, "floor-depth", "wall-height") + "side = \"up\"\n", "there is no side \"up\""},
        {kHead + kDepth + "statistic = \"mode\"\n", "there is no statistic \"mode\""},
        {kHead + "[[criterion]]\nid = \"c\"\ntitle = { en = \"c\" }\nmeasure = \"removed\"\nunit = \"mm3\"\nzone = "
                 "\"moon\"\nweight = 1\nknots = [[0, 100], [1, 0]]\n",
         "there is no zone \"moon\""},
        {kHead + "[[criterion]]\nid = \"c\"\ntitle = { en = \"c\" }\nmeasure = \"removed\"\nunit = \"mm3\"\ntissue = "
                 "\"cheese\"\nweight = 1\nknots = [[0, 100], [1, 0]]\n",
         "there is no tissue \"cheese\""},
        {kHead + "[[criterion]]\nid = \"c\"\ntitle = { en = \"c\" }\nmeasure = \"load-over-limit\"\nunit = "
                 "\"s\"\nweight = 1\nknots = [[0, 100], [1, 0]]\ndevices = [\"pointer\"]\n",
         "load-over-limit needs a limit"},
        {kHead + "[[criterion]]\nid = \"c\"\ntitle = { en = \"c\" }\nmeasure = \"time\"\nunit = \"s\"\nweight = "
                 "1\nknots = [[0, 100], [1, 0]]\n",
         "grades the hand on any device"},
        {kHead + kDepth + "status = \"published\"\n", "it is published, and there is no source"},
        {replaced(whole, "\"proposal\"", "\"published\"\nsource = \"x\"") + "status = \"proposal\"\n",
         "in a rubric that says published"},
        {replaced(whole, "\"proposal\"", "\"adapted\""), "it is adapted, and there is no source"},
        {kHead + kDepth + kDepth, "there are two criteria \"depth\""},
        {kHead + kDepth + "excludes = [\"depth\"]\n", "in a circle: depth -> depth"},
        {kHead + kDepth + "excludes = [\"width\"]\n" + kWidth + "excludes = [\"depth\"]\n",
         "in a circle: depth -> width -> depth"},
        {kHead + kDepth + "excludes = [\"none\"]\n", "excludes \"none\", which is no criterion"},
        {whole + "[[step]]\nid = \"s\"\ncriteria = [\"depth\", \"nothing\"]\n",
         "step s: there is no criterion \"nothing\""},
        {whole + "[[step]]\nid = \"s\"\ncriteria = [\"depth\"]\n", "it is in no step"},
        {whole +
             "[[step]]\nid = \"s\"\ncriteria = [\"depth\", \"width\"]\n[[step]]\nid = \"t\"\ncriteria = [\"depth\"]\n",
         "is in step \"s\" already"},
        {rule("{ bands = [\"none\"], most = 1 }"), "there is no band \"none\""},
        {rule("{ bands = [\"good\"], of = [\"depth\"], most = 1 }"), "criterion \"depth\" has no bands"},
        {rule("{ bands = [\"good\"], of = [\"nix\"], most = 1 }"), "there is no criterion \"nix\""},
        {rule("{ bands = [\"good\"], least = 2 }"), "at least 2 of 1 is never so"},
        {rule("{ bands = [\"good\"], least = 1, most = 0 }"), "at least 1 and at most 0 is never so"},
        {rule("{ rule = \"y\" }"), "there is no rule \"y\""},
        {rule("{ rule = \"x\" }"), "rules need each other in a circle: x -> x"},
        {rule("{ rule = \"y\" }") + "[[rule]]\nid = \"y\"\nneeds = [{ rule = \"x\" }]\n", "in a circle: x -> y -> x"},
        {rule("{ bands = [\"bad\"], most = 0 }", ""), "it has no effect"},
        {rule("{ bands = [\"bad\"], most = 0 }", "else_at_most = 100\n"), "else_at_most is 100"},
        {replaced(kHead, "title = { en = \"a rubric\" }\n", "") + kDepth, "it has no title"},
        {kHead, "there is no criterion"},
    };
    for (const auto& [text, told] : wrong) {
        if (*told == '\0') {
            EXPECT_THAT(wrongWith(text), IsEmpty());
            continue;
        }
        EXPECT_THAT(wrongWith(text), testing::Contains(HasSubstr(told))) << text;
    }
    EXPECT_THAT(errorOf([&] { requireSound(parsed(wrong[0].first)); }),
                AllOf(HasSubstr("r.toml:13"), HasSubstr("did you mean \"floor-depth\"")));
    EXPECT_NO_THROW(requireSound(parsed(whole)));
}

TEST(Linter, RemarksOnMissingLanguages) {
    const std::string text =
        replaced(kHead + kDepth + kWidth, "{ en = \"depth\" }", "{ en = \"depth\", ja = \"深さ\" }");
    bool found = false;
    for (const Finding& f : check(parsed(text)))
        if (f.problem.find("not in \"ja\"") != std::string::npos) {
            found = true;
            EXPECT_EQ(f.severity, Severity::remark);
            EXPECT_THAT(f.problem, AllOf(HasSubstr("the title"), HasSubstr("criterion width"),
                                         testing::Not(HasSubstr("criterion depth"))));
        }
    EXPECT_TRUE(found);
}

TEST(Linter, FindsWhatThePublishedTablesLeaveOpen) {
    // Class V of the public rubric ZX4CB89: inciso-gingival 2-3, > 3-3.5, 1.5-2, unacceptable > 3.5 and < 1: nothing on
    // 1 to 1.5.
    const std::string text = kHead +
                             "[[criterion]]\nid = \"ig\"\ntitle = { en = \"x\" }\nmeasure = \"outline-extent\"\nside = "
                             "\"gingival\"\nunit = \"mm\"\nweight = 1\n"
                             "bands = [{ id = \"good\", from = 2, to = 3, points = 100 }, { id = \"fair\", from = 3, "
                             "to = 3.5, points = 81 },\n"
                             "{ id = \"fair\", from = 1.5, to = 2, points = 67 }, { id = \"bad\", from = 3.5, points = "
                             "0 }, { id = \"bad\", to = 1, points = 0 }]\n";
    EXPECT_THAT(wrongWith(text), ElementsAre(HasSubstr("no band has the values from 1 to 1.5")));
}

const std::string kCompleteness = R"([completeness]
measure = "removed-share"
zone = "target"
unit = "%"
knots = [[0, 0], [50, 0.5], [70, 1]]
title = { en = "done" }
words = { en = "how far" }
source = "s"
)";

TEST(Completeness, IsReadCheckedAndWritten) {
    const std::string whole = kHead + kCompleteness + kDepth;
    const Rubric r = parsed(whole);
    EXPECT_THAT(check(r), IsEmpty());
    const Completeness& c = *r.completeness;
    EXPECT_EQ(c.of.zone, "target");
    const std::pair<double, double> factors[] = {{-5, 0}, {0, 0}, {10, 0.1}, {50, 0.5}, {60, 0.75}, {70, 1}, {100, 1}};
    for (const auto& [value, factor] : factors)
        EXPECT_NEAR(factorOf(c, value), factor, 1e-12);
    const Rubric again = parsed(rubricToml(r));
    EXPECT_THAT(differences(r, again), IsEmpty());
    EXPECT_EQ(canonicalText(r), canonicalText(again));
    EXPECT_EQ(again.completeness->source, "s");
    EXPECT_EQ(again.completeness->words, c.words);
    EXPECT_THAT(describe(r, "en"), testing::AllOf(HasSubstr("removed-share (target) [%]"), HasSubstr("50 = × 0.5")));
    const auto wrong = [&](const std::string& from, const std::string& to, const char* problem,
                           Severity severity = Severity::error) {
        const std::vector<Finding> found = check(parsed(replaced(whole, from, to)));
        ASSERT_EQ(found.size(), 1u) << to;
        EXPECT_EQ(found[0].severity, severity) << to;
        EXPECT_THAT(found[0].problem, HasSubstr(problem));
        EXPECT_THAT(found[0].where, HasSubstr("completeness"));
        EXPECT_EQ(found[0].criterion, "");
    };
    wrong("removed-share", "removed-shaer", "no measure \"removed-shaer\"");
    wrong("zone = \"target\"", "zone = \"targte\"", "no zone \"targte\"");
    wrong("measure = \"removed-share\"\nzone = \"target\"\nunit = \"%\"", "measure = \"time\"\nunit = \"s\"",
          "of the hand");
    wrong("unit = \"%\"", "unit = \"mm\"", "the unit is \"mm\"");
    wrong("[[0, 0], [50, 0.5], [70, 1]]", "[[70, 1]]", "one knot", Severity::error);
    wrong("[70, 1]", "[101, 1]", "which no measure can have");
    wrong("[70, 1]", "[50, 1]", "do not ascend at 50");
    wrong("[70, 1]", "[60, 0.4], [70, 1]", "the factor falls at 60");
    wrong("[0, 0], [50", "[0, -0.5], [50", "the factor -0.5");
    wrong("[70, 1]", "[70, 0.9]", "the last factor is 0.9");
    wrong("[0, 0], [50", "[0, 0.3], [50", "keeps 0.3", Severity::warning);
    EXPECT_THAT(errorOf([&] { (void)parsed(replaced(whole, "[50, 0.5]", "[50]")); }),
                testing::AllOf(HasSubstr("[value, factor]"), HasSubstr(":")));
    EXPECT_THAT(errorOf([&] { (void)parsed(replaced(whole, "knots = [[0", "knotz = [[0")); }), HasSubstr("knotz"));
    EXPECT_THAT(errorOf([&] { (void)parsed(kHead + "completeness = 1\n" + kDepth); }), HasSubstr("completeness"));
    // It decides, so it is hashed; a rubric without it has the hash that it had before there was such.
    std::set<std::uint64_t> hashes = {hashOf(r), hashOf(parsed(kHead + kDepth))};
    for (const auto& [from, to] :
         {std::pair{"[50, 0.5]", "[50, 0.6]"}, {"zone = \"target\"", "zone = \"leeway-side\""}})
        EXPECT_TRUE(hashes.insert(hashOf(parsed(replaced(whole, from, to)))).second);
    EXPECT_EQ(hashes.size(), 4u);
    EXPECT_EQ(hashOf(parsed(replaced(whole, "how far", "how near"))), hashOf(r));
    const Rubric without = parsed(kHead + kDepth);
    EXPECT_THAT(differences(without, r), ElementsAre("completeness: is new, factors 0 0,50 0.5,70 1"));
    EXPECT_THAT(differences(r, without), ElementsAre(HasSubstr("completeness: is gone")));
    EXPECT_THAT(differences(r, parsed(replaced(whole, "[50, 0.5]", "[50, 0.6]"))),
                ElementsAre("completeness: factors was 0 0,50 0.5,70 1, is 0 0,50 0.6,70 1"));
    EXPECT_THAT(differences(r, parsed(replaced(whole, "how far", "how near"))),
                ElementsAre(HasSubstr("no score changes")));
}

TEST(Hash, MeansWhatDecides) {
    const std::string whole = kHead + kDepth + kWidth;
    const std::uint64_t hash = hashOf(parsed(whole));
    const std::string same[] = {"# a comment\n" + whole,
                                replaced(whole, "weight = 60", "weight = 6.0e1"),
                                replaced(whole, "[1.5, 100]", "[ 1.50, 100.0 ]"),
                                replaced(whole, "a rubric", "another title"),
                                replaced(whole, "{ en = \"depth\" }", "{ en = \"deepness\", de = \"Tiefe\" }"),
                                replaced(whole, "pass_mark = 60", "pass_mark = 60\ntotal_weight = 100"),
                                replaced(whole, "weight = 60\n", "weight = 60\nsource = \"somebody\"\n")};
    for (const std::string& text : same)
        EXPECT_EQ(hashOf(parsed(text)), hash) << text;
    const std::string others[] = {
        replaced(whole, "weight = 60", "weight = 61"),
        replaced(whole, "[1.5, 100]", "[1.51, 100]"),
        replaced(whole, "version = \"1\"", "version = \"2\""),
        replaced(whole, "pass_mark = 60", "pass_mark = 61"),
        replaced(whole, "points = 60", "points = 61"),
        whole + "critical = { above = 3 }\n",
        kHead + kWidth + kDepth,
        replaced(whole, "measure = \"isthmus\"", "measure = \"isthmus\"\nstatistic = \"least\""),
        whole + "[[rule]]\nid = \"x\"\nneeds = [{ bands = [\"bad\"], most = 0 }]\nrequired = true\n",
        whole + "devices = [\"pointer\"]\n",
        whole + "excludes = [\"depth\"]\n"};
    std::map<std::uint64_t, std::string> seen = {{hash, "whole"}};
    for (const std::string& text : others)
        EXPECT_TRUE(seen.emplace(hashOf(parsed(text)), text).second) << text;
    // Stable from here on: what is stored beside scores of before.
    EXPECT_EQ(canonicalText(parsed(kHead + kDepth)),
              "handpiece rubric 1\nid=r\nversion=1\nstatus=proposal\npass_mark=60\nbands, best to worst=good,fair,bad\n"
              "[criterion depth]\nmeasure=floor-depth\nunit=mm\nzone=\ntissue=\nside=\nstatistic=\nlimit=-\nweight=60\n"
              "knots=1 0,1.5 100,2 100,2.5 0\nbands=\ncritical=none\ndevices=\nexcludes=\n");
    EXPECT_EQ(hashText(hashOf(parsed(kHead + kDepth))), "f0f71c0e941866b7");
}

TEST(Diff, SaysWhatChanges) {
    const std::string whole = kHead + kDepth + kWidth;
    const Rubric before = parsed(whole);
    EXPECT_THAT(differences(before, before), IsEmpty());
    EXPECT_THAT(differences(before, parsed(replaced(whole, "weight = 60", "weight = 50"))),
                ElementsAre("criterion depth: weight was 60, is 50"));
    EXPECT_THAT(differences(before, parsed(kHead + kWidth)), ElementsAre("criterion depth: is gone"));
    EXPECT_THAT(differences(parsed(kHead + kWidth), before), ElementsAre("criterion depth: is new"));
    EXPECT_THAT(differences(before, parsed(kHead + kWidth + kDepth)),
                ElementsAre("criterion: their order was depth,width, is width,depth"));
    EXPECT_THAT(differences(before, parsed(replaced(whole, "a rubric", "b"))),
                ElementsAre(HasSubstr("no score changes")));
    EXPECT_THAT(differences(before, parsed(whole + "critical = { above = 3 }\n")),
                ElementsAre("criterion width: critical was none, is -..3"));
    EXPECT_THAT(differences(before, parsed(replaced(whole, "points = 60", "points = 50"))),
                ElementsAre(HasSubstr("criterion width: bands was")));
    // No sentence where the hash is the same but those that say so, and at least one where it is not.
    for (const std::string& text :
         {replaced(whole, "version = \"1\"", "version = \"2\""), replaced(whole, "pass_mark = 60", "pass_mark = 70"),
          whole + "devices = [\"pointer\"]\n"})
        EXPECT_EQ(differences(before, parsed(text)).size(), 1u) << text;
}

TEST(Page, ListsEveryMeasure) {
    const std::vector<std::byte> bytes = core::readFile(HANDPIECE_RUBRIC_PAGE);
    const std::string page(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (const measures::MeasureKind& kind : measures::measureKinds())
        EXPECT_THAT(page, HasSubstr(fmt::format("| `{}` | {} |", kind.id, kind.unit)));
}

TEST(Shipped, AllAreSoundInBothLanguages) {
    const std::vector<std::string> names = shippedRubrics();
    EXPECT_EQ(names.size(), 19u);
    EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
    std::map<std::uint64_t, std::string> hashes;
    for (const std::string& name : names) {
        const Rubric r = shippedRubric(name);
        EXPECT_EQ(r.id, name);
        for (const Finding& f : check(r))
            ADD_FAILURE() << f.where << ": " << f.problem;
        EXPECT_TRUE(hashes.emplace(hashOf(r), name).second) << name;
        EXPECT_FALSE(r.source.empty()) << name;
        ASSERT_TRUE(r.completeness) << name;
        EXPECT_EQ(factorOf(*r.completeness, 0.0), 0.0) << name;
        EXPECT_LE(factorOf(*r.completeness, 10.0), 0.25) << name;
        EXPECT_EQ(factorOf(*r.completeness, 90.0), 1.0) << name;
        for (const char* language : {"en", "ja"}) {
            EXPECT_TRUE(r.title.contains(language)) << name;
            EXPECT_TRUE(r.completeness->title.contains(language)) << name;
            EXPECT_TRUE(r.completeness->words.contains(language)) << name;
            for (const Criterion& c : r.criteria)
                EXPECT_TRUE(c.title.contains(language)) << name << " " << c.id;
        }
        EXPECT_THAT(describe(r, "en"), HasSubstr("unvalidated"));
        EXPECT_THAT(describe(r, "ja"), HasSubstr("未検証"));
        // Time, path and smoothness are shown, not graded.
        for (const Criterion& c : r.criteria)
            EXPECT_FALSE(c.isGraded() && measures::findMeasureKind(c.measure)->subject == measures::Subject::hand)
                << name << " " << c.id;
    }
    EXPECT_THAT(errorOf([] { (void)shippedRubric("none"); }), HasSubstr("46-class-i"));
    EXPECT_EQ(rubricByNameOrFile("46-crown").id, "46-crown");
    EXPECT_THAT(errorOf([] { (void)rubricByNameOrFile("46-clown"); }), HasSubstr("there is no rubric"));
    EXPECT_THAT(errorOf([] { (void)rubricByNameOrFile("./46-clown.toml"); }), HasSubstr("46-clown.toml"));
}

TEST(Rubric, ComesBackFromWhatIsWritten) {
    std::vector<std::string> texts;
    for (const std::string& name : shippedRubrics())
        texts.emplace_back(shippedRubricText(name));
    texts.push_back(kHead + kDepth + kWidth +
                    "critical = { below = 0.1, title = { en = \"a \\\"quote\\\"\" } }\ndevices = [\"falcon\"]\n"
                    "excludes = [\"depth\"]\nwords = { \"pt-BR\" = \"x\\ny\" }\nleaves_out = { en = \"z\" }\n"
                    "status = \"adapted\"\nsource = \"s\"\nlimit = 0.1\n"
                    "[[step]]\nid = \"one\"\ntitle = { en = \"One\" }\ncriteria = [\"depth\"]\n"
                    "[[rule]]\nid = \"ok\"\nneeds = [{ bands = [\"bad\"], of = [\"width\"], least = 0, most = 1 }]\n"
                    "required = true\nelse_at_most = 12.5\nsource = \"q\"\n"
                    "[[rule]]\nid = \"both\"\nneeds = [{ rule = \"ok\" }]\n");
    for (const std::string& text : texts) {
        const Rubric before = parsed(text), after = parsed(rubricToml(before));
        EXPECT_EQ(canonicalText(before), canonicalText(after));
        EXPECT_THAT(differences(before, after), IsEmpty()) << before.id;
        EXPECT_EQ(describe(before, "ja"), describe(after, "ja"));
        EXPECT_EQ(rubricToml(before), rubricToml(after));
        for (std::size_t i = 0; i < before.criteria.size(); ++i) {
            const Criterion &a = before.criteria[i], &b = after.criteria[i];
            EXPECT_EQ(a.title, b.title);
            EXPECT_EQ(a.words, b.words);
            EXPECT_EQ(a.leavesOut, b.leavesOut);
            EXPECT_EQ(a.source, b.source);
            EXPECT_EQ(a.status, b.status);
            EXPECT_EQ(a.devices, b.devices);
            ASSERT_EQ(a.critical.has_value(), b.critical.has_value());
            EXPECT_EQ(a.critical ? a.critical->title : Texts{}, b.critical ? b.critical->title : Texts{});
        }
    }
}

}  // namespace
}  // namespace handpiece::rubric::rubric_test
