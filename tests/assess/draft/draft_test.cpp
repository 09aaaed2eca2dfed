// SPDX-License-Identifier: Apache-2.0
// A teacher's draft: steps back, what is proposed, what is wrong, the way to a file and back.
#include "handpiece/assess/draft/draft.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "handpiece/assess/draft/cells.h"
#include "handpiece/model/starter/block.h"
#include "support/error_of.h"

namespace handpiece::draft::draft_test {
namespace {

namespace fs = std::filesystem;

Content block() {
    Content content;
    content.tooth = std::make_shared<const cases::Case>(starter::makeBlock(starter::BlockLayers::hard));
    content.id = "cross-2";
    content.exercise.title = {{"en", "Cross"}, {"ja", "十字"}};
    content.exercise.instructions = {{"en", "Cut it."}};
    return withTemplate(content, "block-cross");
}
bool tells(const std::vector<Problem>& problems, Part part, std::string_view what) {
    return std::any_of(problems.begin(), problems.end(),
                       [&](const Problem& p) { return p.part == part && p.what.find(what) != std::string::npos; });
}

TEST(Draft, TakesStepsBackAndTypingIsOne) {
    Draft draft;
    draft.begin(block());
    EXPECT_FALSE(draft.isUnsaved());
    EXPECT_FALSE(draft.canUndo());
    for (const char* id : {"a", "ab", "abc"}) {
        Content next = draft.now();
        next.id = id;
        draft.change(next, "id");
    }
    Content next = draft.now();
    next.minutes = 5.0;
    draft.change(next, "minutes");
    EXPECT_TRUE(draft.isUnsaved());
    draft.undo();
    EXPECT_FALSE(draft.now().minutes);
    EXPECT_EQ(draft.now().id, "abc");
    draft.undo();
    EXPECT_EQ(draft.now().id, "cross-2");
    EXPECT_FALSE(draft.isUnsaved()) << "as it was";
    EXPECT_FALSE(draft.canUndo());
    draft.redo();
    draft.redo();
    EXPECT_EQ(draft.now().minutes, 5.0);
    EXPECT_FALSE(draft.canRedo());
    draft.noteSaved("x.handpiece");
    EXPECT_FALSE(draft.isUnsaved());
    draft.undo();
    EXPECT_TRUE(draft.isUnsaved()) << "the file holds the later one";
}

TEST(Draft, ATemplateBringsItsRubricUntilThatIsChanged) {
    Content content = block();
    ASSERT_TRUE(content.rubric);
    EXPECT_EQ(content.rubric->id, "dexterity-cross");
    content = withTemplate(content, "block-line");
    EXPECT_EQ(content.rubric->id, "dexterity-line");
    content.rubric->criteria[0].weight = 51.0;
    content = withTemplate(content, "block-cross");
    EXPECT_EQ(content.rubric->id, "dexterity-line");
    EXPECT_EQ(content.preparation->preparation, "block-cross");
    for (const preparation::Template& t : preparation::templates())
        EXPECT_TRUE(withTemplate(Content{}, t.id).rubric) << t.id;
    EXPECT_FALSE(withTemplate(block(), "").preparation);
}

TEST(Draft, TheRubricOfAnOnlayFollowsWhatIsAskedFor) {
    Content content = withTemplate(Content{}, "onlay");
    const auto has = [&](const char* id) { return content.rubric->criterion(id) != nullptr; };
    EXPECT_TRUE(has("cusp-mesiobuccal") && has("cusp-distobuccal") && has("shoulder-buccal") && has("wall-lingual") &&
                has("axial-depth"));
    EXPECT_FALSE(has("cusp-mesiolingual") || has("shoulder-lingual") || has("wall-buccal") || has("other-axial-depth"));
    double weights = 0.0;
    for (const rubric::Criterion& c : content.rubric->criteria)
        weights += c.weight;
    EXPECT_EQ(weights, 100.0);
    content = withNumber(std::move(content), "cap_mesiolingual_mm", 1.5);
    content = withNumber(std::move(content), "axial_mm", 0.0);
    EXPECT_TRUE(has("cusp-mesiolingual") && has("shoulder-lingual") && has("wall-lingual"));
    EXPECT_FALSE(has("axial-depth"));
    content.rubric->criteria.front().weight = 1.0;
    const auto changed = *content.rubric;
    content = withNumber(std::move(content), "axial_mm", 1.5);
    EXPECT_FALSE(has("axial-depth")) << "one that was changed stays";
    EXPECT_EQ(content.rubric->criteria.size(), changed.criteria.size());
    // The other side: boxes change over, cusps do not.
    content = withSide(withTemplate(Content{}, "onlay"), "distal");
    EXPECT_EQ(content.rubric->criterion("axial-depth")->of.side, "distal");
    EXPECT_EQ(content.rubric->criterion("cusp-mesiobuccal")->of.side, "mesiobuccal-cusp");
    EXPECT_EQ(content.rubric->criterion("cusp-mesiobuccal")->title.at("ja"), "近心頬側咬頭の削除量");
}

TEST(Draft, PaintIsStrokesThatAreStepsBack) {
    Draft draft;
    draft.begin(block());
    const core::Vec3 on(0.0, 0.0, block().tooth->outer.bounds().max.z());
    const auto paint = [&](const core::Vec3& from, bool erases) {
        draft.endStep();
        draft.change(beginStroke(draft.now(), from, 0.5, erases), "stroke");
        for (int i = 1; i <= 20; ++i)
            draft.change(extendStroke(draft.now(), from + core::Vec3(0.05 * i, 0.0, 0.0)), "stroke");
    };
    paint(on, false);
    ASSERT_EQ(draft.now().preparation->strokes.size(), 1u);
    EXPECT_EQ(draft.now().preparation->preparation, preparation::kPaintedTemplate);
    EXPECT_EQ(draft.now().preparation->strokes[0].pointsMm.size(), 7u) << "a place every 0.15 mm of the way";
    EXPECT_TRUE(problemsOnTooth(draft.now()).empty());
    paint(on, true);
    EXPECT_TRUE(draft.now().preparation->strokes[1].erases);
    const std::vector<Problem> gone = problemsOnTooth(draft.now());
    ASSERT_EQ(gone.size(), 1u);
    EXPECT_NE(gone.front().what.find("nothing is painted"), std::string::npos) << gone.front().what;
    draft.undo();
    EXPECT_EQ(draft.now().preparation->strokes.size(), 1u);
    draft.undo();
    EXPECT_NE(draft.now().preparation->preparation, preparation::kPaintedTemplate);
}

TEST(Draft, TheOtherSideHasTheRubricOfTheOtherSide) {
    const Content mesial = withTemplate(Content{}, "class-two");
    const Content distal = withSide(mesial, "distal");
    ASSERT_EQ(distal.rubric->criteria.size(), mesial.rubric->criteria.size());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < distal.rubric->criteria.size(); ++i) {
        const std::string &a = mesial.rubric->criteria[i].of.side, &b = distal.rubric->criteria[i].of.side;
        EXPECT_EQ(b, a == "mesial" ? "distal" : a == "distal" ? "mesial" : a);
        changed += a != b;
    }
    EXPECT_GE(changed, 2u);
    EXPECT_EQ(distal.rubric->id, "46-class-ii-do");
    EXPECT_FALSE(hasErrors(problems(distal)) && tells(problems(distal), Part::judgement, ""));
    EXPECT_EQ(rubric::rubricToml(*withSide(distal, "mesial").rubric), rubric::rubricToml(*mesial.rubric));
}

TEST(Draft, ComesBackFromItsFile) {
    const fs::path file = fs::temp_directory_path() / fmt::format("draft-{}.handpiece", ::getpid());
    Content content = block();
    tasks::writeTask(taskOf(content), file);
    EXPECT_EQ(tasks::readTask(file).rubric, rubric::shippedRubricText("dexterity-cross")) << "with its comments";
    content = contentOf(tasks::readTask(file));
    EXPECT_TRUE(hasProposedRubric(content));
    EXPECT_FALSE(hasErrors(problems(content)));
    EXPECT_FALSE(hasErrors(problemsOnTooth(content)));
    content.rubric->criteria[0].weight = 40.0;
    content.rubric->totalWeight = 90.0;
    content.drive = "low-speed";
    content.speedRpm = 20000.0;
    tasks::writeTask(taskOf(content), file);
    const Content again = contentOf(tasks::readTask(file));
    EXPECT_EQ(again.rubric->criteria[0].weight, 40.0);
    EXPECT_EQ(rubric::rubricToml(*again.rubric), rubric::rubricToml(*content.rubric));
    EXPECT_EQ(again.exercise.title.at("ja"), "十字");
    EXPECT_EQ(again.drive, "low-speed");
    EXPECT_EQ(again.speedRpm, 20000.0);
    content.drive.clear();
    EXPECT_FALSE(taskOf(content).speedRpm) << "a speed of no drive";
    fs::remove(file);
}

TEST(Draft, TellsWhatIsWrongAndWhere) {
    EXPECT_TRUE(tells(problems(Content{}), Part::tooth, "no tooth"));
    EXPECT_NE(test::errorOf([] { (void)taskOf(Content{}); }).find("no tooth"), std::string::npos);
    Content content = block();
    EXPECT_FALSE(hasErrors(problems(content)));
    content.preparation->numbers["depth_mm"] = 60.0;
    EXPECT_TRUE(tells(problems(content), Part::preparation, "depth_mm"));
    content = block();
    content.id = "No Id";
    content.exercise.bur = "330";
    content.exercise.allowedBurs = {"round-4", "such-a-bur"};
    content.minutes = -1.0;
    content.rubric->criteria[1].measure = "floor-depht";
    const std::vector<Problem> found = problems(content);
    EXPECT_TRUE(tells(found, Part::texts, "No Id"));
    EXPECT_TRUE(tells(found, Part::work, "such-a-bur"));
    EXPECT_TRUE(tells(found, Part::work, "330, is not allowed"));
    EXPECT_TRUE(tells(found, Part::work, "-1 minutes"));
    EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const Problem& p) {
        return p.part == Part::judgement && p.criterion == content.rubric->criteria[1].id;
    }));
    // A preparation of teeth on a block.
    EXPECT_TRUE(hasErrors(problemsOnTooth(withTemplate(block(), "class-one"))));
}

TEST(Draft, ACriterionThatGoesOrIsRenamedLeavesNothingThatRefersToIt) {
    for (const std::string& name : rubric::shippedRubrics()) {
        const rubric::Rubric before = rubric::shippedRubric(name);
        for (std::size_t i = 0; i < before.criteria.size(); ++i) {
            rubric::Rubric renamed = before, removed = before;
            renameCriterion(renamed, i, "another-name");
            removeCriterion(removed, i);
            std::vector<std::string> named;
            const auto add = [&](const std::vector<std::string>& names) {
                named.insert(named.end(), names.begin(), names.end());
            };
            for (const rubric::Rubric* of : {&renamed, &removed}) {
                for (const rubric::Criterion& c : of->criteria)
                    add(c.excludes);
                for (const rubric::Step& step : of->steps)
                    add(step.criteria);
                for (const rubric::Rule& rule : of->rules)
                    for (const rubric::Condition& need : rule.needs)
                        add(need.of);
            }
            EXPECT_EQ(std::count(named.begin(), named.end(), before.criteria[i].id), 0) << name;
            for (const rubric::Finding& f : rubric::check(renamed))
                EXPECT_NE(f.severity, rubric::Severity::error) << name << ": " << f.problem;
            for (const rubric::Finding& f : rubric::check(removed))
                EXPECT_TRUE(f.severity != rubric::Severity::error ||
                            f.problem.find("no criterion has a weight") != std::string::npos)
                    << name << ": " << f.problem;
        }
    }
}

TEST(Cells, ComeBackAndTellWhatTheyCannotRead) {
    for (const std::string& name : rubric::shippedRubrics())
        for (const rubric::Criterion& c : rubric::shippedRubric(name).criteria) {
            rubric::Criterion back;
            readKnots(back, knotsCell(c));
            readBands(back, bandsCell(c));
            readCritical(back, criticalCell(c));
            readSelection(back, selectionCell(c));
            EXPECT_EQ(back.knots, c.knots) << c.id;
            EXPECT_EQ(back.of, c.of) << c.id;
            EXPECT_EQ(bandsCell(back), bandsCell(c));
            ASSERT_EQ(back.bands.size(), c.bands.size());
            for (std::size_t i = 0; i < c.bands.size(); ++i) {
                EXPECT_EQ(back.bands[i].from, c.bands[i].from);
                EXPECT_EQ(back.bands[i].to, c.bands[i].to);
            }
            EXPECT_EQ(back.critical.has_value(), c.critical.has_value());
            EXPECT_EQ(criticalCell(back), criticalCell(c));
        }
    rubric::Criterion c;
    readBands(c, " fair -1.5 .. 2=60 ;; bad 2..");
    ASSERT_EQ(c.bands.size(), 2u);
    EXPECT_EQ(c.bands[0].from, -1.5);
    EXPECT_EQ(c.bands[0].points, 60.0);
    EXPECT_FALSE(c.bands[1].to);
    for (const char* wrong : {"fair", "fair 1..x", "1..2", "fair 1..2 = y", "fair 1.2.3"}) {
        EXPECT_NE(test::errorOf([&] { readBands(c, wrong); }).find("cannot be read"), std::string::npos) << wrong;
        EXPECT_EQ(c.bands.size(), 2u);
    }
    for (const char* wrong : {"1", "1:", "a:1", "1:nan", "1:0;2:1"})
        EXPECT_NE(test::errorOf([&] { readKnots(c, wrong); }), "") << wrong;
    for (const char* wrong : {"0.5", "<", "> x", "="})
        EXPECT_NE(test::errorOf([&] { readCritical(c, wrong); }), "") << wrong;
    for (const char* wrong : {"side", "colour red", "limit x"})
        EXPECT_NE(test::errorOf([&] { readSelection(c, wrong); }), "") << wrong;
}

TEST(Cells, CarryAllThatARubricIs) {
    for (const std::string& name : rubric::shippedRubrics()) {
        SCOPED_TRACE(name);
        const rubric::Rubric read = rubric::shippedRubric(name);
        // Every field written into its cell and read out of it again.
        rubric::Rubric again = read;
        for (rubric::Criterion& c : again.criteria) {
            const rubric::Criterion was = c;
            c.knots.clear(), c.bands.clear(), c.of = {}, c.devices.clear(), c.excludes.clear();
            readKnots(c, knotsCell(was));
            readBands(c, bandsCell(was));
            readSelection(c, selectionCell(was));
            readCritical(c, criticalCell(was));
            c.devices = readNames(namesCell(was.devices));
            c.excludes = readNames(namesCell(was.excludes));
        }
        for (rubric::Step& step : again.steps)
            step.criteria = readNames(namesCell(step.criteria));
        for (rubric::Rule& rule : again.rules) {
            const std::string cell = needsCell(rule);
            rule.needs.clear();
            readNeeds(rule, cell);
        }
        const std::string toml = rubric::rubricToml(again);
        EXPECT_EQ(toml, rubric::rubricToml(read));
        const rubric::Rubric back = rubric::parseRubric(toml, "back");
        EXPECT_EQ(rubric::hashOf(back), rubric::hashOf(read));
        // And every text has a place.
        std::size_t texts = 0, kept = 0;
        for (const TextPlace& place : textsOf(again))
            texts += place.texts->size();
        for (TextPlace& place : textsOf(again))
            place.texts->clear();
        for (std::size_t at = toml.find("ja = "); at != std::string::npos; at = toml.find("ja = ", at + 1))
            ++kept;
        EXPECT_GE(texts, 2 * kept);
        EXPECT_EQ(rubric::rubricToml(again).find("ja = "), std::string::npos) << "none has no place";
    }
}

TEST(Cells, WhatARuleNeeds) {
    rubric::Rule rule;
    readNeeds(rule, "unacceptable most 0; to-modify, fair of depth, outline least 1 most 2 ; rule other");
    ASSERT_EQ(rule.needs.size(), 3u);
    EXPECT_EQ(rule.needs[1].bands, (std::vector<std::string>{"to-modify", "fair"}));
    EXPECT_EQ(rule.needs[1].of, (std::vector<std::string>{"depth", "outline"}));
    EXPECT_EQ(rule.needs[1].least, 1);
    EXPECT_EQ(rule.needs[1].most, 2);
    EXPECT_EQ(rule.needs[2].rule, "other");
    EXPECT_EQ(needsCell(rule), "unacceptable most 0; to-modify, fair of depth, outline least 1 most 2; rule other");
    for (const char* wrong :
         {"unacceptable", "most 2", "ideal most x", "ideal most -1", "ideal most 1.5", "rule", "rule a most 1"})
        EXPECT_THROW(readNeeds(rule, wrong), core::Error) << wrong;
    EXPECT_EQ(rule.needs.size(), 3u) << "left as it was";
}

TEST(Rubrics, WhatRefersToABandOrARuleFollows) {
    rubric::Rubric r = rubric::shippedRubric("46-class-i");
    r.rules.clear();
    rubric::Rule one, two;
    one.id = "one", two.id = "two";
    readNeeds(one, r.bands.back().id + " most 0");
    readNeeds(two, "rule one");
    one.required = two.required = true;
    r.rules = {one, two};
    const std::string last = r.bands.back().id;
    renameBand(r, r.bands.size() - 1, "worst");
    renameRule(r, 0, "first");
    EXPECT_EQ(r.rules[0].needs[0].bands[0], "worst");
    EXPECT_EQ(r.rules[1].needs[0].rule, "first");
    for (const rubric::Criterion& c : r.criteria)
        for (const rubric::Band& band : c.bands)
            EXPECT_NE(band.id, last);
    removeRule(r, 0);
    EXPECT_TRUE(r.rules.empty()) << "the other needed nothing else";
    removeBand(r, r.bands.size() - 1);
    for (const rubric::Criterion& c : r.criteria)
        for (const rubric::Band& band : c.bands)
            EXPECT_NE(band.id, "worst");
}

TEST(Problems, AreSaidInEveryLanguage) {
    Content content = block();
    content.id = "No Id";
    content.voxelMm = 1.0;
    content.exercise.bur = "no-such";
    content.exercise.title.clear();
    content.rubric->criteria.front().unit = "m";
    content.rubric->criteria.front().knots = {{1.0, 50.0}};
    content.rubric->bands.push_back(content.rubric->bands.front());
    const std::vector<Problem> found = problems(content);
    ASSERT_GE(found.size(), 7u);
    for (const Problem& p : found) {
        ASSERT_FALSE(p.said.empty()) << p.what;
        const std::string english = config::Words::in("en")(p.said), japanese = config::Words::in("ja")(p.said);
        EXPECT_NE(english, japanese);
        if (p.severity != rubric::Severity::remark) {
            EXPECT_EQ(p.what, p.criterion.empty() ? english : p.criterion + ": " + english);
        }
        EXPECT_TRUE(std::any_of(japanese.begin(), japanese.end(), [](char c) { return (c & 0x80) != 0; })) << japanese;
        EXPECT_EQ(p.remedy.empty(), p.advice.empty());
    }
}

}  // namespace
}  // namespace handpiece::draft::draft_test
