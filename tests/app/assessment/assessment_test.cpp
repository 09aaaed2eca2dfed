// SPDX-License-Identifier: Apache-2.0
// Results as other programs read them, and marks from a file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/assessment/marks_agreement.h"
#include "handpiece/base/core/error.h"
#include "support/error_of.h"

namespace handpiece::assessment::assessment_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Result, HasTheNamesThatOthersRelyOn) {
    const rubric::Rubric r = rubric::shippedRubric("block-channel");
    std::vector<measures::Measured> measured(2);
    measured[0].kind = "floor-depth";
    measured[0].value = 1.75;
    measured[0].uncertainty = 0.02;
    measured[0].evidence = {{12.5, core::Vec3(1, -2, 0.25), 0.8, "deepest"}, {{}, {}, {}, "no place"}};
    measured[1].kind = "isthmus";
    measured[1].reason = "the cavity has no walls";
    const std::string json = resultJson(score::evaluate(r, measured, {"pointer", 2}),
                                        {"block-channel", "e1", "c1", "s1", {"h1", "h2"}, true, 7});
    for (const char* part : {"\"schema\": \"handpiece-result-1\"",
                             "\"engine\": 7",
                             "\"exercise\": \"block-channel\"",
                             "\"exercise_hash\": \"e1\"",
                             "\"case_key\": \"c1\"",
                             "\"session_hash\": [\n    \"h1\",\n    \"h2\"\n  ]",
                             "\"proven\": true",
                             "\"score\": ",
                             "\"max_score\": 30.0",
                             "\"whole_score\": 100.0",
                             "\"passed\": \"teacher\"",
                             "\"borderline\": false",
                             "\"critical\": []",
                             "\"state_hash\": \"s1\"",
                             "\"device\": \"pointer\"",
                             "\"motion_scale\": 2.0",
                             "\"criteria\": [",
                             "\"measure\": \"floor-depth\"",
                             "\"value\": 1.75",
                             "\"unit\": \"mm\"",
                             "\"uncertainty\": 0.02",
                             "\"band\": \"modify\"",
                             "\"max_points\": 30.0",
                             "\"evidence\": [",
                             "\"t_s\": 12.5",
                             "\"force_n\": 0.8",
                             "\"text\": \"deepest\"",
                             "\"t_s\": null",
                             "\"standing\": \"not-measured\"",
                             "\"reason\": \"the cavity has no walls\"",
                             "\"points\": null"})
        EXPECT_THAT(json, HasSubstr(part));
    EXPECT_THAT(json, HasSubstr("\"rubric_hash\": \"" + rubric::hashText(rubric::hashOf(r)) + "\""));
    EXPECT_THAT(json, HasSubstr("\"xyz_mm\": [\n            1.0,\n            -2.0,\n            0.25\n          ]"));
}

TEST(Result, ComesBackFromItsJsonAndNothingElseDoes) {
    const rubric::Rubric r = rubric::shippedRubric("46-class-i");
    std::vector<measures::Measured> measured;
    for (const rubric::Criterion& c : r.criteria) {
        measures::Measured m{c.measure, c.of, 2.05, 0.1, {}, {{12.5, core::Vec3(1, -2, 0.25), 0.8, "deepest", 1}}};
        if (c.id == "time") m = {c.measure, c.of, {}, 0.0, "no samples", {}};
        measured.push_back(m);
    }
    score::Identity of{"one", "e1", "c1", "s1", {"h1", "h2"}, true, 7, score::ScanFit{0.03, 140, 0.01, 20, 0.1}};
    const std::string json = resultJson(score::evaluate(r, measured, {"pointer", 2}), of);
    const score::Result back = parseResult(json, "result.json");
    EXPECT_EQ(resultJson(back.assessment, back.identity), json);
    of.scan.reset();
    const std::string plain = resultJson(score::evaluate(r, measured, {"pointer", 2}), of);
    EXPECT_FALSE(parseResult(plain, "result.json").identity.scan);
    // Any member that is missing, or of another type, is named with the file; no file makes it crash.
    for (const char* member :
         {"engine", "proven", "score_range", "passed", "criteria", "rubric_hash", "motion_scale"}) {
        std::string broken = json;
        broken.replace(broken.find(std::string("\"") + member + "\""), 2, "\"_");
        EXPECT_THAT(test::errorOf([&] { (void)parseResult(broken, "a.json"); }),
                    testing::AllOf(HasSubstr("a.json"), HasSubstr(member)));
    }
    for (const char* bad : {"", "[]", "null", "{", "{\"schema\": 3}", "{\"schema\": \"handpiece-result-9\"}"})
        EXPECT_THAT(test::errorOf([&] { (void)parseResult(bad, "a.json"); }), HasSubstr("a.json")) << bad;
    for (std::size_t cut = 1; cut < json.size(); cut += 97)
        EXPECT_THAT(test::errorOf([&] { (void)parseResult(json.substr(0, json.size() - 1 - cut), "a.json"); }),
                    HasSubstr("a.json"));
}

TEST(Marks, AreATableOfItemsAndRaters) {
    const std::vector<MarkTable> tables = parseMarks(
        "\xEF\xBB\xBFmark,rater,item,criterion\r\n3, A ,\"x, \"\"1\"\"\",depth\r\n\r\n,B,\"x, "
        "\"\"1\"\"\",depth\r\n4,B,y,depth\r\n5,A,y,width",
        "m");
    ASSERT_EQ(tables.size(), 2u);
    EXPECT_THAT(tables[0].items, ElementsAre("x, \"1\"", "y"));
    EXPECT_THAT(tables[0].raters, ElementsAre("A", "B"));
    EXPECT_THAT(tables[0].marks, ElementsAre("3", std::nullopt, std::nullopt, "4"));
    EXPECT_EQ(tables[1].criterion, "width");
    EXPECT_THAT(tables[1].marks, ElementsAre("5"));
    EXPECT_THAT(test::errorOf([] { (void)parseMarks("item,item,rater,mark\n1,1,a,2\n", "m"); }),
                HasSubstr("two columns"));
}

TEST(Marks, NumbersAndLabelsAreToldApart) {
    const auto of = [](const std::string& marks, const MarkScale& scale = {}) {
        std::string text = "item,rater,mark\n";
        std::size_t n = 0;
        for (const char mark : marks) {
            text += fmt::format("{},{},{}\n", n / 2, n % 2 == 0 ? "a" : "b", mark);
            ++n;
        }
        return agreementOf(parseMarks(text, "m").front(), scale, 100);
    };
    const CriterionAgreement numbers = of("12233142");
    EXPECT_TRUE(numbers.areNumbers);
    EXPECT_TRUE(numbers.icc && numbers.pairs[0].blandAltman && !numbers.pairs[0].kappa);
    const CriterionAgreement labels = of("xyyxxxyy");
    EXPECT_FALSE(labels.areNumbers || labels.isOrdered);
    EXPECT_THAT(labels.categories, ElementsAre("x", "y"));
    EXPECT_TRUE(labels.pairs[0].kappa && !labels.pairs[0].linear);
    EXPECT_DOUBLE_EQ(*labels.pairs[0].kappa->value, 0.0);
    // Numbers may be categories, and empty ones count.
    const CriterionAgreement ordered = of("12233142", {{"1", "2", "3", "4", "5"}});
    EXPECT_TRUE(ordered.isOrdered && !ordered.areNumbers && ordered.pairs[0].linear);
    EXPECT_NE(*ordered.pairs[0].linear->value, *of("12233142", {{"1", "2", "3", "4"}}).pairs[0].linear->value);
    EXPECT_THAT(test::errorOf([&] {
                    (void)of("12233142", {{"1", "2", "3"}});
                }),
                HasSubstr("\"4\" is not on the scale"));
    EXPECT_THAT(blandAltmanSvg(numbers, numbers.pairs[0]), HasSubstr("<svg"));
}

}  // namespace
}  // namespace handpiece::assessment::assessment_test
