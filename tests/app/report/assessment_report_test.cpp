// SPDX-License-Identifier: Apache-2.0
// A score as pages: all that they must say is there, in both languages, whatever is missing.
#include "handpiece/app/report/assessment_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <regex>

#include "handpiece/app/report/section_outlines.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report::assessment_report_test {
namespace {

using core::Vec3;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class Language {
  public:
    explicit Language(const char* language) { config::useLanguage(language); }
    ~Language() { config::useLanguage("en"); }
    Language(const Language&) = delete;
    Language& operator=(const Language&) = delete;
};

tasks::Task task() {
    tasks::Task task;
    task.id = "one";
    task.toothCase.name = "a <molar>";
    cases::Exercise exercise;
    exercise.title = {{"en", "Class I & more"}, {"ja", "1 級窩洞"}};
    task.toothCase.exercise = exercise;
    return task;
}

/// All of it as good as can be but for what is told.
score::Result resultOf(const std::map<std::string, double>& told) {
    const rubric::Rubric rubric = rubric::shippedRubric("46-class-i");
    const std::map<std::string, double> good = {{"depth", 1.75},       {"outline", 95.0},      {"isthmus", 1.25},
                                                {"ridge-mesial", 2.5}, {"ridge-distal", 2.5},  {"floor", 0.0},
                                                {"wall-buccal", -3.0}, {"wall-lingual", -3.0}, {"pulp-exposed", 0.0},
                                                {"time", 300.0},       {"path", 900.0},        {"smoothness", -4.0}};
    std::vector<measures::Measured> measured;
    for (const rubric::Criterion& c : rubric.criteria) {
        measures::Measured m{c.measure, c.of, good.at(c.id), 0.02, {}, {}};
        if (const auto at = told.find(c.id); at != told.end()) {
            m.value = at->second;
            m.evidence = {{12.5, Vec3(1.0, -2.0, 0.25), 0.8, "middle of the floor"}};
        }
        measured.push_back(m);
    }
    score::Result result;
    result.assessment = score::evaluate(rubric, measured, {"pointer", 1.0});
    result.identity = {"one", "e1", "c1", "s1", {"h1"}, true, 3, {}};
    result.proof = "cut again & the same";
    return result;
}

TEST(StudentReport, SaysAllThatItMustAndLoadsNothing) {
    const rubric::Rubric rubric = rubric::shippedRubric("46-class-i");
    const score::Result result = resultOf({{"depth", 2.6}, {"isthmus", 2.2}, {"ridge-mesial", 1.75}});
    AssessmentPictures pictures;
    pictures.views.push_back({"occlusal", Png(3, std::byte{65}), {}, Png(4, std::byte{66}), {}});
    pictures.views.push_back({"section-mesial", {}, {}, {}, "<svg></svg>"});
    pictures.places["depth"] = Png(5, std::byte{67});
    const std::string page = studentReport(result, task(), rubric, pictures);
    for (const char* part : {"<html lang=\"en\">", "Class I &amp; more", "a &lt;molar&gt;", "Not passed",
                             "Critical errors", "To work on first", "12.5 s", "0.80 N", "x 1.00, y -2.00, z 0.25 mm",
                             "What to do: ", "too deep", "data:image/png;base64,QUFB", "data:image/png;base64,Q0NDQ0M=",
                             "mm too much gone", "section across", "proven: cut again &amp; the same", "full points"})
        EXPECT_THAT(page, HasSubstr(part));
    // The three that cost most: a critical error before what costs more.
    const std::vector<std::size_t> dear = costliest(result.assessment);
    std::vector<std::string> ids;
    for (const std::size_t i : dear)
        ids.push_back(result.assessment.criteria[i].id);
    EXPECT_THAT(ids, ElementsAre("depth", "isthmus", "ridge-mesial"));
    static const std::regex loads("(src|href)=\"(?!data:)|url\\(|@import|<script");
    EXPECT_FALSE(std::regex_search(page, loads));

    const Language language("ja");
    const std::string japanese = studentReport(result, task(), rubric, pictures);
    for (const char* part :
         {"<html lang=\"ja\">", "1 級窩洞", "不合格", "重大な誤り", "まず取り組むこと", "次にすること：", "深い"})
        EXPECT_THAT(japanese, HasSubstr(part));
    for (const char* part : {"To work on", "Critical", "passed", "points lost", "What to do"})
        EXPECT_THAT(japanese, Not(HasSubstr(part)));
}

TEST(StudentReport, GoodWorkHasNoErrorsAndNoPicturesAreNoHarm) {
    const rubric::Rubric rubric = rubric::shippedRubric("46-class-i");
    const std::string page = studentReport(resultOf({}), task(), rubric);
    EXPECT_THAT(page, HasSubstr("No points were lost."));
    EXPECT_THAT(page, HasSubstr("Passed: all that the rubric asks for is met."));
    EXPECT_THAT(page, HasSubstr("No pictures were asked for."));
    EXPECT_THAT(page, Not(HasSubstr("<img")));
}

TEST(StudentReport, WhatIsNotFinishedComesBeforeAllErrors) {
    const rubric::Rubric rubric = rubric::shippedRubric("46-class-i");
    // All good but for a tenth of it that is done: the outline loses its ten points, the rest counts a tenth.
    const score::Result result = resultOf({{"outline", 10.0}});
    EXPECT_NEAR(result.assessment.score, 9.0, 1e-9);
    EXPECT_NEAR(result.assessment.lostUndone(), 81.0, 1e-9);
    AssessmentPictures pictures;
    pictures.undone = Png(3, std::byte{65});
    const std::string page = studentReport(result, task(), rubric, pictures);
    for (const char* part :
         {"Not finished: 10 % of the preparation is cut; points count 10 %.", "1. not finished (81.0 points lost)",
          "2. outline opened (10.0 points lost)", "data:image/png;base64,QUFB", "times 0.10"})
        EXPECT_THAT(page, HasSubstr(part));
    EXPECT_THAT(classReport({{"A7", "A7/1.json", {}, result}}), HasSubstr("not finished"));
    EXPECT_THAT(studentReport(resultOf({}), task(), rubric), Not(HasSubstr("inished")));
    const Language language("ja");
    const std::string japanese = studentReport(result, task(), rubric, pictures);
    EXPECT_THAT(japanese, HasSubstr("未完成：形成の 10 % を削った"));
    EXPECT_THAT(japanese, Not(HasSubstr("inished")));
}

TEST(ClassReport, PoolsOnlyWhatMayBePooled) {
    score::Result other = resultOf({});
    other.assessment.context.device = "arm";
    const std::string page = classReport({{"A7", "A7/1.json", {}, resultOf({{"depth", 2.3}})},
                                          {"A7", "A7/2.json", {}, resultOf({{"isthmus", 2.2}})},
                                          {"B2", "B2/1.json", {}, resultOf({{"depth", 2.6}})},
                                          {"B2", "B2/2.json", {}, other}});
    for (const char* part :
         {"4 results of 2 students", "3 results: mean", "1 results: mean", "Device arm", "Device pointer",
          "Learning curves", "A7", "B2", "What cost the class most", "Nobody has two attempts yet."})
        EXPECT_THAT(page, HasSubstr(part));
    EXPECT_THAT(classReport({}), HasSubstr("No results."));
}

TEST(Outlines, LieWhereTheSurfacesLie) {
    SectionOutlines o;
    o.box = {Vec3(-5, -5, -5), Vec3(5, 5, 5)};
    o.originMm = Vec3::Zero();
    o.right = Vec3::UnitX();
    o.up = Vec3::UnitZ();
    const auto ball = [](double r) { return [r](const Vec3& p) { return p.norm() - r; }; };
    o.before = ball(4.5);
    o.own = ball(4.0);
    o.ideal = ball(3.5);
    const std::string svg = outlinesSvg(o);
    // Every point of the second path lies on the ideal's circle about the picture's middle, 40 pixels a millimetre.
    const std::size_t at = svg.find("hp-c2");
    ASSERT_NE(at, std::string::npos);
    const std::string path = svg.substr(at, svg.find("/>", at) - at);
    static const std::regex point("[ML]([0-9.]+) ([0-9.]+)");
    std::size_t count = 0;
    for (std::sregex_iterator i(path.begin(), path.end(), point), end; i != end; ++i, ++count) {
        const double x = std::stod((*i)[1]) / 40.0 - 5.5, z = 5.5 - std::stod((*i)[2]) / 40.0;
        EXPECT_NEAR(std::hypot(x, z), 3.5, 0.002);
    }
    EXPECT_GT(count, 200u);
    // A circle is one line, so that dashes run along it and do not begin anew in every cell.
    EXPECT_EQ(std::count(path.begin(), path.end(), 'M'), 1);
}

}  // namespace
}  // namespace handpiece::report::assessment_report_test
