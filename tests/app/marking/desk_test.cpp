// SPDX-License-Identifier: Apache-2.0
// A marker's desk: blind order, what is hidden, overrides by hand, kill -9 in the middle of a change, two desks on one
// folder, agreement of marks that are known.
#include "handpiece/app/marking/desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <map>
#include <set>
#include <thread>

#include "handpiece/app/assessment/assessment_json.h"
#include "handpiece/app/marking/desk_agreement.h"
#include "handpiece/app/marking/desk_csv.h"
#include "handpiece/app/marking/returned_marks.h"
#include "handpiece/app/report/assessment_words.h"
#include "handpiece/assess/agreement/agreement.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::marking::desk_test {
namespace {

namespace fs = std::filesystem;
using measures::Measured;
using rubric::Rubric;
using test::errorOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const char* kText = R"(
format = 1
id = "r"
version = "1"
status = "proposal"
pass_mark = 60
[[band]]
id = "good"
[[band]]
id = "fair"
[[band]]
id = "bad"
[[criterion]]
id = "depth"
measure = "floor-depth"
unit = "mm"
weight = 50
knots = [[1, 0], [1.5, 100], [2, 100], [2.5, 0]]
bands = [{ id = "good", from = 1.5, to = 2 }, { id = "fair", from = 1.2, to = 1.5 }, { id = "bad", to = 1.2 },
    { id = "bad", from = 2 }]
critical = { above = 2.5 }
[[criterion]]
id = "width"
measure = "isthmus"
unit = "mm"
weight = 30
bands = [{ id = "good", from = 1, to = 1.5, points = 100 }, { id = "fair", from = 0.5, to = 1, points = 50 },
    { id = "bad", to = 0.5, points = 0 }, { id = "bad", from = 1.5, points = 0 }]
[[criterion]]
id = "depth-again"
measure = "floor-depth"
unit = "mm"
weight = 20
knots = [[1, 0], [2, 100]]
[[criterion]]
id = "ridge"
measure = "marginal-ridge-left"
side = "mesial"
unit = "mm"
critical = { below = 1 }
)";

Rubric rubricOf(const std::string& more = {}) {
    return rubric::parseRubric(kText + more, "r.toml");
}

std::vector<Measured> measured(double depth, std::optional<double> width, double ridge = 2.0) {
    std::vector<Measured> all(3);
    all[0].kind = "floor-depth";
    all[0].value = depth;
    all[1].kind = "isthmus";
    all[1].value = width;
    if (!width) all[1].reason = "no walls";
    all[2].kind = "marginal-ridge-left";
    all[2].of.side = "mesial";
    all[2].value = ridge;
    return all;
}

assessment::Result resultOf(double depth, std::optional<double> width, double ridge = 2.0) {
    assessment::Result result;
    result.assessment = score::evaluate(rubricOf(), measured(depth, width, ridge), {"pointer", 1.0});
    result.identity = {"e", "e1", "c1", "s1", {}, true, 7};
    return result;
}

std::vector<ReturnedWork> worksOf(std::size_t count) {
    std::vector<ReturnedWork> works;
    for (std::size_t i = 0; i < count; ++i)
        works.push_back({fmt::format("work-{:03}.h5", i), fmt::format("{:016x}", 1000 + i), {}, false, {}});
    return works;
}

DeskSetup setupIn(const fs::path& folder, bool isBlind, const std::string& marker = "Tanaka", std::uint64_t seed = 5) {
    DeskSetup setup;
    setup.folder = folder;
    setup.marker = marker;
    setup.exercise = "e";
    setup.exerciseHash = "e1";
    setup.rubric = rubricOf();
    setup.isBlind = isBlind;
    setup.seed = seed;
    return setup;
}

/// All marks of one work, given in.
void markAll(Desk& desk, const std::string& code, const std::string& depth, const std::string& width, double again,
             double total) {
    desk.setMark(code, "depth", {depth, {}, false});
    desk.setMark(code, "width", {width, {}, false});
    desk.setMark(code, "depth-again", {{}, again, false});
    desk.setMark(code, kTotal, {{}, total, false});
    desk.giveIn(code);
}

TEST(Override, PointsThatAreGivenCountWhatIsLeftOfTheWorkDoesNot) {
    const Rubric rubric = rubricOf(R"([completeness]
measure = "removed-share"
zone = "target"
unit = "%"
knots = [[0, 0], [70, 1]]
)");
    std::vector<Measured> all = measured(1.75, 0.8);
    all.push_back({"removed-share", {"target", {}, {}, {}, {}}, 7.0, 0.5, {}, {}});
    const score::Assessment machine = score::evaluate(rubric, all, {"pointer", 1.0});
    EXPECT_NEAR(machine.score, 0.1 * (50 + 15 + 15), 1e-9);
    Sheet sheet;
    EXPECT_EQ(withOverrides(rubric, machine, sheet).score, machine.score);
    // Points are given as they are; a band gives its own, times the factor; so does what stays.
    sheet.overrides["depth"] = {"", 30.0, {}, "seen"};
    sheet.overrides["width"] = {"good", {}, {}, "seen"};
    sheet.overrides["depth-again"] = {"", {}, true, "seen"};
    const score::Assessment now = withOverrides(rubric, machine, sheet);
    EXPECT_NEAR(*now.criteria[0].points, 30.0, 1e-9);
    EXPECT_NEAR(*now.criteria[1].points, 3.0, 1e-9);
    EXPECT_NEAR(*now.criteria[2].points, 1.5, 1e-9);
    EXPECT_NEAR(now.score, 34.5, 1e-9);
    EXPECT_EQ(now.completeness->value, 7.0);
}

TEST(Override, PutsTheMarkersWordInPlaceOfTheMachinesAndKeepsThat) {
    const score::Assessment machine = resultOf(1.75, 0.8).assessment;
    ASSERT_DOUBLE_EQ(machine.score, 50 + 15 + 15);
    Sheet sheet;
    EXPECT_EQ(assessment::resultJson(withOverrides(rubricOf(), machine, sheet), {}),
              assessment::resultJson(machine, {}))
        << "nothing said, nothing changed";

    sheet.overrides["depth"] = {"", 20.0, {}, "too steep"};
    score::Assessment now = withOverrides(rubricOf(), machine, sheet);
    EXPECT_DOUBLE_EQ(now.score, 20 + 15 + 15) << "the other criterion on the same measure stands";
    EXPECT_EQ(now.passed, score::Passed::no);
    EXPECT_EQ(now.criteria[0].band, "good");
    EXPECT_EQ(*now.criteria[0].value, 1.75);
    EXPECT_EQ(now.criteria[0].measure, "floor-depth");
    EXPECT_EQ(now.rubricHash, machine.rubricHash);

    // A band without points of its own gives those of its place that is nearest to what was measured.
    sheet.overrides["depth"] = {"fair", {}, {}, "rough"};
    now = withOverrides(rubricOf(), machine, sheet);
    EXPECT_EQ(now.criteria[0].band, "fair");
    EXPECT_DOUBLE_EQ(*now.criteria[0].points, 50.0) << "at 1.5 mm the curve gives all";
    sheet.overrides["depth"] = {"bad", {}, {}, "rough"};
    EXPECT_DOUBLE_EQ(*withOverrides(rubricOf(), machine, sheet).criteria[0].points, 50.0) << "at 2 mm as well";
    sheet.overrides["depth"] = {"bad", 0.0, {}, "rough"};
    EXPECT_DOUBLE_EQ(*withOverrides(rubricOf(), machine, sheet).criteria[0].points, 0.0);
    sheet.overrides = {{"width", {"good", {}, {}, "wide enough"}}};
    EXPECT_DOUBLE_EQ(withOverrides(rubricOf(), machine, sheet).score, 50 + 30 + 15);
}

TEST(Override, MakesAndUnmakesACriticalError) {
    const score::Assessment deep = resultOf(2.6, 1.2).assessment;
    ASSERT_EQ(deep.critical.size(), 1u);
    Sheet sheet;
    sheet.overrides["depth"] = {"bad", 10.0, false, "the probe stood on calculus"};
    EXPECT_THAT(withOverrides(rubricOf(), deep, sheet).critical, IsEmpty());
    sheet.overrides["depth"] = {"", 10.0, {}, "not so bad"};
    EXPECT_EQ(withOverrides(rubricOf(), deep, sheet).critical.size(), 1u) << "points alone do not excuse it";
    const score::Assessment good = resultOf(1.75, 1.2).assessment;
    ASSERT_EQ(good.passed, score::Passed::yes);
    sheet.overrides = {{"ridge", {"", {}, true, "cracked"}}};
    const score::Assessment now = withOverrides(rubricOf(), good, sheet);
    ASSERT_EQ(now.critical.size(), 1u);
    EXPECT_EQ(now.critical[0].criterion, "ridge");
    EXPECT_EQ(now.passed, score::Passed::no);
    EXPECT_DOUBLE_EQ(now.score, good.score);
}

TEST(Override, OfWhatWasNotMeasuredNeedsPointsAndABand) {
    const score::Assessment machine = resultOf(1.75, {}).assessment;
    ASSERT_EQ(machine.passed, score::Passed::teacher);
    ASSERT_DOUBLE_EQ(machine.maxScore, 70);
    Sheet sheet;
    sheet.overrides["width"] = {"", 20.0, {}, "seen"};
    EXPECT_THAT(errorOf([&] { static_cast<void>(withOverrides(rubricOf(), machine, sheet)); }), HasSubstr("band"));
    sheet.overrides["width"] = {"fair", {}, {}, "seen"};
    const score::Assessment now = withOverrides(rubricOf(), machine, sheet);
    EXPECT_DOUBLE_EQ(now.score, 50 + 15 + 15);
    EXPECT_DOUBLE_EQ(now.maxScore, 100);
    EXPECT_EQ(now.passed, score::Passed::yes);
}

TEST(Override, RandomOnesAddUp) {
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 2000; ++i) {
        const double depth = test::uniform(random, 0.5, 3.0), width = test::uniform(random, 0.2, 2.0);
        const score::Assessment machine = resultOf(depth, width).assessment;
        Sheet sheet;
        std::map<std::string, double> points;
        for (const score::CriterionScore& c : machine.criteria) {
            if (!c.points) continue;
            points[c.id] = *c.points;
            if (random() % 2 == 0) continue;
            points[c.id] = test::uniform(random, 0.0, c.maxPoints);
            sheet.overrides[c.id] = {"", points[c.id], {}, "x"};
        }
        double sum = 0.0;
        for (const auto& [id, one] : points)
            sum += one;
        EXPECT_NEAR(withOverrides(rubricOf(), machine, sheet).score, sum, 1e-9);
    }
}

TEST(Result, IsReadAsItWasWritten) {
    for (const double depth : {0.7, 1.75, 2.55})
        for (const std::optional<double> width : {std::optional<double>(), std::optional<double>(1.1)}) {
            const assessment::Result result = resultOf(depth, width, 0.99);
            const std::string json = assessment::resultJson(result.assessment, result.identity);
            const assessment::Result read = assessment::parseResult(json, "result.json");
            EXPECT_EQ(assessment::resultJson(read.assessment, read.identity), json);
        }
    for (const char* bad : {"", "{}", "[1]", "{\"schema\":\"handpiece-result-1\"}", "{\"schema\":3}"})
        EXPECT_THAT(errorOf([&] { static_cast<void>(assessment::parseResult(bad, "r.json")); }), HasSubstr("no result"))
            << bad;
}

TEST(Blind, OrderIsARandomPermutationAndATenthComesAgain) {
    DeskState state;
    state.isBlind = true;
    constexpr std::size_t kWorks = 12, kSeeds = 6000;
    state.batches.emplace_back();
    for (std::size_t i = 0; i < kWorks; ++i)
        state.batches[0].push_back(fmt::format("{:016x}", i));
    // Where each work stands first among the works, and how often it is the one that comes twice.
    std::array<std::array<double, kWorks>, kWorks> at{};
    std::array<double, kWorks> twice{};
    for (std::size_t seed = 0; seed < kSeeds; ++seed) {
        state.seed = seed;
        const std::vector<DeskItem> items = itemsOf(state);
        ASSERT_EQ(items.size(), kWorks + 1);
        std::set<std::string> codes;
        std::map<std::string, int> often;
        std::size_t place = 0;
        for (const DeskItem& item : items) {
            codes.insert(item.code);
            const std::size_t work = std::stoul(item.workId, nullptr, 16);
            EXPECT_EQ(item.isRepeat, often[item.workId] == 1);
            if (++often[item.workId] == 2)
                twice[work] += 1.0;
            else
                at[place++][work] += 1.0;
        }
        ASSERT_EQ(codes.size(), items.size());
        ASSERT_EQ(often.size(), kWorks) << "a permutation";
    }
    // Chi squared over places by works, (12 - 1)^2 degrees: 99.9999 % lie under 121 + 4.75 sqrt(242) + 15.
    const double each = static_cast<double>(kSeeds) / kWorks;
    double chi = 0.0, chiTwice = 0.0;
    for (const auto& row : at)
        for (const double count : row)
            chi += (count - each) * (count - each) / each;
    for (const double count : twice)
        chiTwice += (count - each) * (count - each) / each;
    EXPECT_LT(chi, 210.0);
    EXPECT_LT(chiTwice, 47.0) << "11 degrees";
    // How many, and the same again from the same seed.
    for (const auto& [works, again] : std::map<std::size_t, std::size_t>{{1, 1}, {9, 1}, {14, 1}, {15, 2}, {200, 20}}) {
        state.batches[0].clear();
        for (std::size_t i = 0; i < works; ++i)
            state.batches[0].push_back(std::to_string(i));
        EXPECT_EQ(itemsOf(state).size(), works + again) << works;
        EXPECT_EQ(heldBack(state).size(), std::min(works, 2 * again));
    }
    const auto codesNow = itemsOf(state);
    state.batches.push_back({"later"});
    const auto codesThen = itemsOf(state);
    ASSERT_EQ(codesThen.size(), codesNow.size() + 1);
    for (std::size_t i = 0; i < codesNow.size(); ++i)
        EXPECT_EQ(codesThen[i].code, codesNow[i].code) << "what comes later moves nothing";
}

TEST(Blind, NothingOfTheMachinesIsThereBeforeTheMarkIsIn) {
    const test::TemporaryFolder folder;
    Desk desk(setupIn(folder.path(), true), worksOf(12));
    for (std::size_t i = 0; i < 12; ++i)
        desk.take(i, Scored::of(resultOf(2.6, 1.2345)));
    const auto isHidden = [&desk](const std::string& code) {
        EXPECT_TRUE(desk.isScored(code)) << "that it is there is no secret";
        EXPECT_EQ(desk.machine(code), nullptr);
        EXPECT_FALSE(desk.finalScore(code));
        EXPECT_FALSE(desk.passed(code));
        EXPECT_FALSE(desk.isRepeat(code));
        EXPECT_THAT(errorOf([&] { desk.override(code, "depth", {"good", {}, {}, "x"}); }), HasSubstr("hidden"));
        EXPECT_THAT(errorOf([&] { desk.decide(code, Decision{true, "x"}); }), HasSubstr("hidden"));
    };
    for (const std::string& code : desk.codes())
        isHidden(code);
    for (const std::string& text : {resultsCsv(desk, Naming::withFiles), marksCsv(desk, desk.othersOfFolder().desks)}) {
        EXPECT_THAT(text, Not(HasSubstr("1.2345")));
        EXPECT_THAT(text, Not(HasSubstr("2.6")));
        EXPECT_THAT(text, Not(HasSubstr("work-0"))) << "nor whose a code is";
    }
    const std::string bytes = [&] {
        const auto read = core::readFile(desk.file());
        return std::string(reinterpret_cast<const char*>(read.data()), read.size());
    }();
    EXPECT_THAT(bytes, Not(HasSubstr("1.2345")));
    // One after the other: those held back to the end, the rest at once.
    const std::vector<std::string> held = heldBack(desk.state());
    EXPECT_EQ(held.size(), 2u);
    for (const std::string& code : desk.codes()) {
        isHidden(code);
        EXPECT_THAT(errorOf([&] { desk.giveIn(code); }), HasSubstr("not marked yet"));
        markAll(desk, code, "good", "fair", 10, 60);
        EXPECT_THAT(errorOf([&] { desk.setMark(code, "depth", {"bad", {}, false}); }), HasSubstr("is in"));
        if (desk.areAllIn()) break;
        EXPECT_EQ(desk.machine(code) != nullptr, std::find(held.begin(), held.end(), desk.work(code).id) == held.end());
    }
    std::size_t repeats = 0;
    for (const std::string& code : desk.codes()) {
        EXPECT_NE(desk.machine(code), nullptr);
        repeats += desk.isRepeat(code) ? 1 : 0;
    }
    EXPECT_EQ(repeats, 1u);
    EXPECT_THAT(resultsCsv(desk, Naming::withFiles), HasSubstr("1.2345"));
    EXPECT_THAT(resultsCsv(desk, Naming::codesOnly), Not(HasSubstr("work-0")));
}

TEST(Desk, RefusesWhatSaysNothingOrTooMuch) {
    const test::TemporaryFolder folder;
    Desk desk(setupIn(folder.path(), false), worksOf(2));
    desk.take(0, Scored::of(resultOf(1.75, 1.2)));
    const std::string code = desk.codes()[0];
    for (const char* blank : {"", " ", "\t\n"})
        EXPECT_THAT(errorOf([&] { desk.override(code, "depth", {"good", {}, {}, blank}); }), HasSubstr("reason"));
    EXPECT_THAT(errorOf([&] { desk.override(code, "depth", {"", {}, {}, "x"}); }), HasSubstr("nothing is said"));
    EXPECT_THAT(errorOf([&] { desk.override(code, "depth", {"", 50.5, {}, "x"}); }), HasSubstr("0 to 50"));
    EXPECT_THAT(errorOf([&] { desk.override(code, "depth", {"", std::nan(""), {}, "x"}); }), HasSubstr("0 to 50"));
    EXPECT_THAT(errorOf([&] { desk.override(code, "ridge", {"", 1.0, {}, "x"}); }), HasSubstr("no points"));
    EXPECT_THAT(errorOf([&] { desk.override(code, "width", {"", {}, true, "x"}); }), HasSubstr("no critical error"));
    EXPECT_THAT(errorOf([&] { desk.override(code, "depth", {"superb", {}, {}, "x"}); }), HasSubstr("no band"));
    EXPECT_THAT(errorOf([&] { desk.override(code, "none", {"good", {}, {}, "x"}); }), HasSubstr("no criterion"));
    EXPECT_THAT(errorOf([&] {
                    desk.override(desk.codes()[1], "depth", {"good", {}, {}, "x"});
                }),
                HasSubstr("no score"));
    EXPECT_THAT(errorOf([&] { desk.override("zzzzz", "depth", {"good", {}, {}, "x"}); }), HasSubstr("no work"));
    EXPECT_THAT(errorOf([&] { desk.comment(code, {0, "", " ", {}, {}}); }), HasSubstr("empty"));
    EXPECT_THAT(errorOf([&] { desk.setMark(code, "depth", {"good", {}, false}); }), HasSubstr("shows"));
    EXPECT_THAT(errorOf([&] { static_cast<void>(marksCsv(desk, {})); }), HasSubstr("independent"));
    EXPECT_THAT(desk.sheet(code).overrides, IsEmpty());
    for (const char* name : {"", "  ", "a/b", "a\nb", "machine", "Tanaka again", " x"})
        EXPECT_NE(errorOf([&] { Desk(setupIn(folder.path(), false, name), {}); }), "") << name;
}

TEST(Desk, GoesOnWhereItWas) {
    const test::TemporaryFolder folder;
    std::string code;
    {
        Desk desk(setupIn(folder.path(), false, "田中"), worksOf(3));
        code = desk.codes()[1];
        desk.take(1, Scored::of(resultOf(1.75, 0.8)));
        desk.override(code, "width", {"good", {}, {}, "\"wide\", enough"});
        desk.comment(code, {0, "depth", "here", core::Vec3(1, 2.5, -3), 12.25});
        desk.removeComment(code, desk.comment(code, {0, "", "gone", {}, {}}));
        desk.decide(code, Decision{false, "she was helped"});
        EXPECT_EQ(desk.passed(code), score::Passed::no);
    }
    auto works = worksOf(4);
    works.erase(works.begin());
    Desk desk(setupIn(folder.path(), false, "田中", 99), works);
    EXPECT_EQ(desk.codes().size(), 4u) << "one is gone from the folder and keeps its row, one is new";
    EXPECT_EQ(desk.codes()[1], code);
    EXPECT_THAT(desk.problem(desk.codes()[0]), HasSubstr("no longer"));
    const Sheet& sheet = desk.sheet(code);
    EXPECT_EQ(sheet.overrides.at("width"), (Override{"good", {}, {}, "\"wide\", enough"}));
    ASSERT_EQ(sheet.comments.size(), 1u);
    EXPECT_EQ(*sheet.comments[0].placeMm, core::Vec3(1, 2.5, -3));
    EXPECT_EQ(*sheet.comments[0].timeS, 12.25);
    EXPECT_EQ(sheet.comments[0].criterion, "depth");
    EXPECT_FALSE(sheet.decision->passed);
    desk.take(0, Scored::of(resultOf(1.75, 0.8)));
    EXPECT_DOUBLE_EQ(desk.finalScore(code)->score, 50 + 30 + 15);
    EXPECT_DOUBLE_EQ(desk.machine(code)->assessment.score, 50 + 15 + 15);
    EXPECT_THAT(resultsCsv(desk, Naming::withFiles), HasSubstr("work-001.h5,95,100,no,80,100,yes"));
    EXPECT_THAT(resultsCsv(desk, Naming::codesOnly), HasSubstr("\"\"\"wide\"\", enough\""));
    desk.withdraw(code, "width");
    EXPECT_DOUBLE_EQ(desk.finalScore(code)->score, 80);

    DeskSetup other = setupIn(folder.path(), false, "田中");
    other.exerciseHash = "e2";
    EXPECT_THAT(errorOf([&] { Desk(other, works); }), HasSubstr("another exercise"));
    EXPECT_THAT(errorOf([&] { Desk(setupIn(folder.path(), true, "田中"), works); }), HasSubstr("shows"));
    // An override that no longer fits is told, and what was said stays.
    desk.override(code, "depth", {"", 45.0, {}, "x"});
    DeskSetup lighter = setupIn(folder.path(), false, "田中");
    lighter.rubric.criteria[0].weight = 40.0;
    Desk light(lighter, works);
    light.take(0, Scored::of(resultOf(1.75, 0.8)));
    EXPECT_FALSE(light.finalScore(code));
    EXPECT_THAT(light.problem(code), HasSubstr("no longer fits"));
    EXPECT_EQ(light.sheet(code).overrides.at("depth").points, 45.0);
    EXPECT_EQ(light.state().rubricHash, rubric::hashText(rubric::hashOf(lighter.rubric)))
        << "seen desks go on under it";
    core::writeFile(desk.file(), std::string_view("{\"handpiece\":\"marking\",\"format\":2}"));
    EXPECT_THAT(errorOf([&] { Desk(setupIn(folder.path(), false, "田中"), works); }), HasSubstr("newer"));
    core::writeFile(desk.file(), std::string_view("{"));
    EXPECT_THAT(errorOf([&] { Desk(setupIn(folder.path(), false, "田中"), works); }), HasSubstr("no marking desk"));
}

TEST(Desk, NothingChangesWhereItCannotBeWritten) {
    const test::TemporaryFolder folder;
    const fs::path place = folder.path() / "works";
    fs::create_directory(place);
    Desk desk(setupIn(place, true), worksOf(2));
    const std::string code = desk.codes()[0];
    fs::remove_all(place);
    EXPECT_NE(errorOf([&] { desk.setMark(code, "depth", {"good", {}, false}); }), "");
    EXPECT_THAT(desk.sheet(code).marks, IsEmpty());
}

TEST(Desk, TwoMarkersInOneFolderAndOneMarkerTwice) {
    const test::TemporaryFolder folder;
    Desk first(setupIn(folder.path(), true, "Tanaka", 1), worksOf(5));
    Desk second(setupIn(folder.path(), true, "Sato", 2), worksOf(5));
    EXPECT_NE(first.codes(), second.codes());
    for (int i = 0; i < 5; ++i) {
        first.setMark(first.codes()[static_cast<std::size_t>(i)], "depth", {"good", {}, false});
        second.setMark(second.codes()[static_cast<std::size_t>(i)], "depth", {"bad", {}, false});
    }
    EXPECT_EQ(Desk(setupIn(folder.path(), true, "Tanaka"), worksOf(5)).sheet(first.codes()[4]).marks.at("depth").band,
              "good");
    EXPECT_EQ(Desk(setupIn(folder.path(), true, "Sato"), worksOf(5)).sheet(second.codes()[4]).marks.at("depth").band,
              "bad");
    // The same desk open twice: who comes second is told, and what stands in the file stays.
    Desk again(setupIn(folder.path(), true, "Tanaka"), worksOf(5));
    again.setMark(again.codes()[0], "width", {"fair", {}, false});
    EXPECT_THAT(errorOf([&] {
                    first.setMark(first.codes()[1], "width", {"bad", {}, false});
                }),
                HasSubstr("somebody else"));
    EXPECT_FALSE(first.sheet(first.codes()[1]).marks.contains("width"));
    EXPECT_EQ(Desk(setupIn(folder.path(), true, "Tanaka"), worksOf(5)).sheet(again.codes()[0]).marks.at("width").band,
              "fair");
}

TEST(Desk, KilledInTheMiddleOfAChangeLosesNothing) {
    std::mt19937_64 random(test::seed());
    int killedInTheMiddle = 0;
    for (int round = 0; round < 40; ++round) {
        const test::TemporaryFolder folder;
        int pipe[2];
        ASSERT_EQ(::pipe(pipe), 0);
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            // Comments without end; each is told once the call has returned.
            Desk desk(setupIn(folder.path(), false), worksOf(30));
            for (std::uint32_t i = 0;; ++i) {
                desk.comment(desk.codes()[i % 30],
                             {0, "", fmt::format("comment {} {}", i, std::string(500, 'x')), {}, {}});
                if (::write(pipe[1], &i, sizeof i) != sizeof i) ::_exit(1);
            }
        }
        ::close(pipe[1]);
        std::uint32_t told = 0, count = 0;
        const std::uint32_t enough = 1 + static_cast<std::uint32_t>(random() % 12);
        while (count < enough && ::read(pipe[0], &told, sizeof told) == sizeof told)
            ++count;
        std::this_thread::sleep_for(std::chrono::microseconds(random() % 3000));
        ASSERT_EQ(::kill(child, SIGKILL), 0);
        int status = 0;
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status));
        while (::read(pipe[0], &told, sizeof told) == sizeof told)
            ++count;
        ::close(pipe[0]);
        Desk desk(setupIn(folder.path(), false), worksOf(30));
        std::set<int> numbers;
        for (const std::string& code : desk.codes())
            for (const Comment& comment : desk.sheet(code).comments) {
                EXPECT_TRUE(comment.text.ends_with(std::string(500, 'x')));
                numbers.insert(comment.number);
            }
        EXPECT_GE(numbers.size(), count) << "all that was told";
        EXPECT_LE(numbers.size(), count + 1) << "and at most the one under way";
        EXPECT_EQ(*numbers.rbegin(), static_cast<int>(numbers.size()));
        killedInTheMiddle += std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) > 1 ? 1 : 0;
        desk.comment(desk.codes()[0], {0, "", "goes on", {}, {}});
    }
    std::printf("killed with a file half written: %d of 40\n", killedInTheMiddle);
}

TEST(Returned, HoldsWhatTheMarkerSaidAndOfWhichWork) {
    const test::TemporaryFolder folder;
    DeskSetup setup = setupIn(folder.path(), false);
    Desk desk(setup, worksOf(2));
    const std::string code = desk.codes()[0], unscored = desk.codes()[1];
    EXPECT_THAT(errorOf([&] { static_cast<void>(returnedMarks(desk, unscored)); }), HasSubstr("no score"));
    assessment::Result result = resultOf(2.6, 0.8);
    result.identity = {
        "e", "00000000000000e1", "00000000000000c1", "00000000000000a1", {"0000000000000001", "0000000000000002"}, true,
        7};
    desk.take(0, Scored::of(result));
    desk.override(code, "depth", {"fair", 30.0, false, "calculus under the probe"});
    desk.comment(code, {0, "depth", "look \"here\" <b>", core::Vec3(1.5, -2.0, 0.25), 12.5, 0});
    desk.comment(code, {0, "", "\xe8\x89\xaf\xe3\x81\x84", {}, {}, {}});
    desk.decide(code, Decision{true, "even walls"});
    const ReturnedMarks given = returnedMarks(desk, code);
    const std::string json = returnedJson(given);
    const ReturnedMarks read = parseReturned(json, "r.json");
    EXPECT_EQ(returnedJson(read), json);
    EXPECT_EQ(read.marker, "Tanaka");
    EXPECT_EQ(read.score, desk.finalScore(code)->score);
    EXPECT_EQ(read.maxScore, 100.0);
    EXPECT_EQ(read.passed, score::Passed::yes);
    EXPECT_EQ(read.decision, "even walls");
    ASSERT_EQ(read.changes.size(), 1u) << "what stands as the machine has it is not in it";
    EXPECT_EQ(read.changes[0].criterion, "depth");
    EXPECT_EQ(read.changes[0].band, "fair");
    EXPECT_EQ(read.changes[0].points, 30.0);
    EXPECT_EQ(read.changes[0].maxPoints, 50.0);
    EXPECT_FALSE(read.changes[0].isCritical);
    EXPECT_EQ(read.changes[0].reason, "calculus under the probe");
    ASSERT_EQ(read.comments.size(), 2u);
    EXPECT_EQ(*read.comments[0].placeMm, core::Vec3(1.5, -2.0, 0.25));
    EXPECT_EQ(read.comments[0].timeS, 12.5);
    EXPECT_EQ(read.comments[0].session, 0u);
    EXPECT_FALSE(read.comments[1].placeMm || read.comments[1].timeS || read.comments[1].session);
    // Of this work and of no other.
    EXPECT_TRUE(areOf(read, result.identity));
    for (const int other : {0, 1, 2}) {
        score::Identity of = result.identity;
        if (other == 0) of.exerciseHash[0] = 'f';
        if (other == 1) of.stateHash[0] = 'f';
        if (other == 2) of.sessionHashes.pop_back();
        EXPECT_FALSE(areOf(read, of)) << other;
    }
    // The desk keeps which of a chain a comment's time is of.
    const Desk again(setup, worksOf(2));
    EXPECT_EQ(again.sheet(code).comments[0].session, 0u);
    EXPECT_FALSE(again.sheet(code).comments[1].session);
}

TEST(Returned, OfWhatIsHiddenNothingIsWritten) {
    const test::TemporaryFolder folder;
    Desk desk(setupIn(folder.path(), true), worksOf(3));
    for (std::size_t i = 0; i < 3; ++i)
        desk.take(i, Scored::of(resultOf(1.75, 1.2)));
    EXPECT_THAT(errorOf([&] { static_cast<void>(returnedMarks(desk, desk.codes()[0])); }), HasSubstr("hidden yet"));
}

TEST(Returned, WhatIsDamagedOrHostileIsOneError) {
    const std::string sound =
        R"({"handpiece":"returned","format":1,"marker":"a","exercise":"b","exercise_hash":"0123456789abcdef",)"
        R"("state_hash":"0123456789abcdef","session_hash":[],"rubric":"r","rubric_hash":"0123456789abcdef","score":5,)"
        R"("max_score":10,"passed":"no","changes":[{"criterion":"d","max_points":4,"points":1,"reason":"x"}],)"
        R"("comments":[{"text":"t","xyz_mm":[0,0,0],"t_s":1}]})";
    EXPECT_EQ(parseReturned(sound, "r").changes.size(), 1u);
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = sound;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    for (const std::string& bad : {std::string(),
                                   std::string("{}"),
                                   std::string("[1]"),
                                   sound.substr(0, sound.size() / 2),
                                   with("returned", "marking"),
                                   with(":1,\"marker", ":0,\"marker"),
                                   with("\"state_hash", "\"state"),
                                   with("0123456789abcdef", "0123456789ABCDEF"),
                                   with("0123456789abcdef", "0123"),
                                   with("\"score\":5", "\"score\":11"),
                                   with("\"score\":5", "\"score\":1e999"),
                                   with("\"no\"", "\"perhaps\""),
                                   with("\"points\":1", "\"points\":-1"),
                                   with("\"points\":1", "\"points\":5"),
                                   with("[0,0,0]", "[0,0]"),
                                   with("[0,0,0]", "[0,0,0,0]"),
                                   with("[0,0,0]", "[0,0,1e300]"),
                                   with("[0,0,0]", "\"xyz\""),
                                   with("\"t_s\":1", "\"t_s\":-1"),
                                   with("\"t_s\":1", "\"session\":-1"),
                                   with("\"t_s\":1", "\"session\":1000000000000"),
                                   with("\"text\":\"t\"", "\"text\":\"" + std::string(4001, 't') + "\""),
                                   with("\"session_hash\":[]", "\"session_hash\":{\"a\":1}"),
                                   with(
                                       "\"session_hash\":[]", "\"session_hash\":[" +
                                                                  [] {
                                                                      std::string all = "\"0123456789abcdef\"";
                                                                      for (int i = 0; i < 1000; ++i)
                                                                          all += ",\"0123456789abcdef\"";
                                                                      return all;
                                                                  }() +
                                                                  "]"),
                                   std::string(kMaxReturnedBytes + 1, ' '),
                                   std::string(100000, '[')})
        EXPECT_THAT(errorOf([&] { static_cast<void>(parseReturned(bad, "r.json")); }), HasSubstr("no marks"))
            << bad.substr(0, 400);
    EXPECT_THAT(errorOf([&] { static_cast<void>(parseReturned(with(":1,\"marker", ":2,\"marker"), "r.json")); }),
                HasSubstr("format 2"));
    // Bytes of it changed, taken away, doubled: one error, or marks that come back as they are written.
    std::mt19937_64 random(test::seed());
    int isRead = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string text = sound;
        for (std::uint64_t changes = 1 + random() % 3; changes > 0; --changes) {
            const std::size_t at = random() % text.size();
            if (random() % 3 == 0)
                text.erase(at, 1 + random() % 4);
            else if (random() % 2 == 0)
                text.insert(at, text.substr(random() % text.size(), 1 + random() % 12));
            else
                text[at] = static_cast<char>(random() % 256);
        }
        try {
            const std::string once = returnedJson(parseReturned(text, "r.json"));
            ASSERT_EQ(returnedJson(parseReturned(once, "r.json")), once) << text;
            ++isRead;
        } catch (const core::Error&) {
            continue;
        }
    }
    EXPECT_GT(isRead, 200) << "else nothing but the library was tried";
}

TEST(Agreement, OfMarkersMachineAndSelf) {
    const test::TemporaryFolder folder;
    constexpr std::size_t kWorks = 20;
    Desk first(setupIn(folder.path(), true, "Tanaka", 1), worksOf(kWorks));
    Desk second(setupIn(folder.path(), true, "Sato", 2), worksOf(kWorks));
    // The machine's truth by work, and markers that differ from it in a known way.
    const auto depthOf = [](const std::string& id) {
        const std::size_t i = std::stoul(id, nullptr, 16) - 1000;
        return i % 3 == 0 ? 1.75 : i % 3 == 1 ? 1.3 : 1.05;
    };
    const auto bandOf = [&](const std::string& id) {
        const double depth = depthOf(id);
        return depth > 1.5 ? "good" : depth > 1.2 ? "fair" : "bad";
    };
    for (Desk* desk : {&first, &second})
        for (std::size_t i = 0; i < kWorks; ++i)
            desk->take(i, Scored::of(resultOf(depthOf(desk->works()[i].id), 1.2)));
    for (const std::string& code : first.codes())
        markAll(first, code, bandOf(first.work(code).id), "good", 10,
                resultOf(depthOf(first.work(code).id), 1.2).assessment.score);
    // Before the second has marked all, marks that are in are there.
    EXPECT_EQ(agreementOfDesk(first, first.othersOfFolder().desks, 50).raters,
              (std::vector<std::string>{"Tanaka", "Tanaka again", "machine"}));
    for (const std::string& code : second.codes()) {
        const std::string band = bandOf(second.work(code).id);
        markAll(second, code, band == "good" ? "fair" : band, "good", 10,
                resultOf(depthOf(second.work(code).id), 1.2).assessment.score - 5.0);
    }
    const Desk::Others others = first.othersOfFolder();
    EXPECT_THAT(others.problems, IsEmpty());
    const DeskAgreement agreement = agreementOfDesk(first, others.desks, 200);
    EXPECT_EQ(agreement.raters, (std::vector<std::string>{"Sato", "Sato again", "Tanaka", "Tanaka again", "machine"}));
    const auto pair = [&](const std::string& criterion, const std::string& a,
                          const std::string& b) -> const assessment::RaterPair& {
        for (const assessment::CriterionAgreement& c : agreement.criteria)
            if (c.criterion == criterion)
                for (const assessment::RaterPair& p : c.pairs)
                    if ((p.first == a && p.second == b) || (p.first == b && p.second == a)) return p;
        throw std::runtime_error("no such pair");
    };
    EXPECT_DOUBLE_EQ(*pair("depth", "Tanaka", "machine").linear->value, 1.0);
    EXPECT_EQ(pair("depth", "Tanaka", "machine").items, kWorks);
    EXPECT_EQ(pair("depth", "Tanaka", "Tanaka again").items, 2u);
    // Seven good, seven fair, six bad; the second calls good fair. Linear weights 1, 1/2, 0 of three categories:
    // observed (7 / 2 + 13) / 20; expected by the margins (7, 7, 6) and (0, 14, 6).
    const double observed = (3.5 + 13.0) / 20.0;
    const double expected = (7 * (0.5 * 14) + 7 * (14 + 0.5 * 6) + 6 * (0.5 * 14 + 6)) / 400.0;
    EXPECT_NEAR(*pair("depth", "Sato", "machine").linear->value, (observed - expected) / (1.0 - expected), 1e-12);
    EXPECT_NEAR(*pair("depth", "Sato", "Tanaka").linear->value, (observed - expected) / (1.0 - expected), 1e-12);
    const assessment::RaterPair& total = pair(kTotal, "Sato", "machine");
    EXPECT_NEAR(std::abs(*total.blandAltman->bias), 5.0, 1e-12);
    EXPECT_NEAR(*total.blandAltman->spread, 0.0, 1e-12);
    EXPECT_FALSE(pair("width", "Sato", "machine").linear->value) << "no variance says nothing";
    bool hasIcc = false;
    for (const assessment::CriterionAgreement& c : agreement.criteria)
        hasIcc = hasIcc || (c.criterion == kTotal && c.icc.has_value());
    EXPECT_TRUE(hasIcc);
    ASSERT_FALSE(agreement.pictures.empty());
    for (const DeskAgreement::Picture& picture : agreement.pictures)
        EXPECT_TRUE(picture.svg.starts_with("<svg")) << picture.name;
    // In the other language: the rubric's titles, and what is not the rubric's in its words.
    config::useLanguage("ja");
    const DeskAgreement japanese = agreementOfDesk(first, others.desks, 50);
    EXPECT_EQ(japanese.criteria.back().title, "総得点");
    EXPECT_EQ(raterName("machine"), "機械");
    EXPECT_EQ(raterName("Tanaka again"), "Tanaka(2回目)");
    EXPECT_EQ(raterName("Tanaka"), "Tanaka");
    for (const DeskAgreement::Picture& picture : japanese.pictures)
        for (const char* english : {"machine", "Tanaka again", "mean of both", "difference", "by chance", "weights"})
            EXPECT_THAT(picture.name + picture.svg, Not(HasSubstr(english)));
    // And why a coefficient is undefined, whatever the reason.
    for (const assessment::CriterionAgreement& c : japanese.criteria) {
        std::vector<std::string> reasons;
        for (const assessment::RaterPair& p : c.pairs) {
            if (p.linear) reasons.push_back(p.linear->reason);
            if (p.blandAltman) reasons.push_back(p.blandAltman->reason);
        }
        if (c.icc) reasons.push_back(c.icc->two1.reason);
        for (const assessment::Alpha& a : c.alphas)
            reasons.push_back(a.estimate.reason);
        for (const std::string& reason : reasons)
            EXPECT_TRUE(reason.empty() || report::said(reason) != reason) << reason;
    }
    EXPECT_NE(report::said(agreement::icc(std::vector<double>{1.0, 2.0}, 2).two1.reason),
              agreement::icc(std::vector<double>{1.0, 2.0}, 2).two1.reason);
    config::useLanguage("en");
    EXPECT_EQ(japanese.criteria.back().criterion, kTotal) << "files keep the id";
    // What handpiece agree reads.
    EXPECT_EQ(assessment::parseMarks(marksCsv(first, others.desks), "marks.csv").size(), 4u);
    // A desk that is damaged is told of and hides no other.
    core::writeFile(folder.path() / "marking-x.json", std::string_view("{"));
    const Desk::Others told = first.othersOfFolder();
    EXPECT_EQ(told.desks.size(), 2u);
    EXPECT_EQ(told.problems.size(), 1u);
}

TEST(Readers, RefuseWhatIsDamaged) {
    const test::TemporaryFolder folder;
    Desk desk(setupIn(folder.path(), true), worksOf(4));
    markAll(desk, desk.codes()[0], "good", "fair", 10, 60);
    desk.comment(desk.codes()[1], {0, "depth", "here", core::Vec3(1, 2, 3), 4.5});
    const assessment::Result result = resultOf(1.75, {});
    const std::string texts[] = {deskJson(desk.state()), assessment::resultJson(result.assessment, result.identity)};
    EXPECT_EQ(deskJson(parseDesk(texts[0], "d")), texts[0]);
    std::mt19937_64 random(test::seed());
    std::size_t refused = 0;
    for (int i = 0; i < 6000; ++i) {
        std::string text = texts[i % 2];
        for (std::uint64_t n = 1 + random() % 4; n > 0; --n) {
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
                case 0:
                    text[at] = static_cast<char>(random());
                    break;
                case 1:
                    text.erase(at, 1 + random() % 40);
                    break;
                case 2:
                    text.insert(at, text.substr(random() % text.size(), 1 + random() % 40));
                    break;
                default:
                    text.resize(at + 1);
            }
            if (text.empty()) text = "x";
        }
        try {
            if (i % 2 == 0)
                static_cast<void>(itemsOf(parseDesk(text, "d")));
            else
                static_cast<void>(assessment::parseResult(text, "r"));
        } catch (const core::Error&) {  // anything else, or none to speak of, fails the test
            ++refused;
        }
    }
    EXPECT_GT(refused, 3000u);
}

TEST(Csv, CellsAreWhatTheyWere) {
    EXPECT_EQ(csvLine({"a", "b,c", "d\"e", "-1.5", "=cmd()", "", " x"}),
              "a,\"b,c\",\"d\"\"e\",-1.5,'=cmd(),,\" x\"\r\n");
}

}  // namespace
}  // namespace handpiece::marking::desk_test
