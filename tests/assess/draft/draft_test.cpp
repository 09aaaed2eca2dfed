// SPDX-License-Identifier: Apache-2.0
// A teacher's draft: steps back, what is proposed, what is wrong, the way to a file and back.
#include "handpiece/assess/draft/draft.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "handpiece/model/starter/block.h"
#include "support/error_of.h"

namespace handpiece::draft {
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
    tasks::writeTask(taskOf(content), file);
    const Content again = contentOf(tasks::readTask(file));
    EXPECT_EQ(again.rubric->criteria[0].weight, 40.0);
    EXPECT_EQ(rubric::rubricToml(*again.rubric), rubric::rubricToml(*content.rubric));
    EXPECT_EQ(again.exercise.title.at("ja"), "十字");
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

}  // namespace
}  // namespace handpiece::draft
