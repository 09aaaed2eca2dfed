// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/case_check.h"
#include "handpiece/model/case/package.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::cases::case_exercise_test {
namespace {

namespace fs = std::filesystem;
using test::errorOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

Case boxes() {
    Case c;
    c.name = "boxes";
    c.outer = test::boxMesh({-4, -4, -8}, {4, 4, 6});
    c.parts = {{"enamel", Tissue::enamel, 10, test::boxMesh({-4, -4, 2}, {4, 4, 6})},
               {"dentine", Tissue::dentine, 20, test::boxMesh({-3, -3, -8}, {3, 3, 4})},
               {"root", Tissue::cementum, 5, test::boxMesh({-4, -4, -8}, {4, 4, 2})}};
    return c;
}

TEST(CaseExercise, ComesBackFromAFolderAndFromOneFile) {
    const test::TemporaryFolder temporary;
    Case c = boxes();
    c.tissuesToml = "format = 1\n[enamel]\ncutting = 1e-5\n";
    c.exercise.emplace();
    c.exercise->title = {{"en", "Class I"}, {"de", "Klasse I \xe2\x80\x94 \"zentral\""}};
    c.exercise->instructions = {{"en", "Line one\nline two\ttab\x01\x7f"}};
    c.exercise->bur = "330";
    c.exercise->allowedBurs = {"330", "round-2"};
    c.exercise->lockedHelps = {"undo", "tissue-colours"};
    c.exercise->view = View{{0, -30, 30.125}, {0, 0, 5}, {0, 0, 1}};
    for (const fs::path& place : {temporary.path() / "case", temporary.path() / "case.handpiece"}) {
        writeCase(c, place);
        const Case read = readCase(place);
        EXPECT_EQ(read.source, place);
        EXPECT_EQ(contentKey(read), contentKey(c));
        EXPECT_EQ(read.tissuesToml, c.tissuesToml);
        EXPECT_EQ(read.tissues.of(Tissue::enamel).cuttingMm2PerN, 1e-5);
        EXPECT_EQ(read.tissues.of(Tissue::dentine).cuttingMm2PerN, properties(Tissue::dentine).cuttingMm2PerN);
        ASSERT_TRUE(read.exercise);
        EXPECT_EQ(read.exercise->title, c.exercise->title);
        EXPECT_EQ(read.exercise->instructions, c.exercise->instructions);
        EXPECT_EQ(read.exercise->bur, "330");
        EXPECT_THAT(read.exercise->allowedBurs, ElementsAre("330", "round-2"));
        EXPECT_THAT(read.exercise->lockedHelps, ElementsAre("undo", "tissue-colours"));
        ASSERT_TRUE(read.exercise->view);
        EXPECT_EQ(read.exercise->view->eyeMm, core::Vec3(0, -30, 30.125));
        EXPECT_EQ(read.exercise->view->targetMm, core::Vec3(0, 0, 5));
    }
    EXPECT_THAT(errorOf([&] { (void)readCase(temporary.path() / "none.handpiece"); }), HasSubstr("no such file"));
    writePackage(temporary.path() / "other.handpiece", {{"readme", {}}});
    EXPECT_THAT(errorOf([&] { (void)readCase(temporary.path() / "other.handpiece"); }), HasSubstr("no case.toml"));
}

TEST(CaseExercise, KnowsEveryLockAndGoesIntoATextAndBack) {
    Exercise e;
    e.title = {{"en", "Class I"}};
    e.allowedBurs = {"330"};
    e.lockedHelps.assign(kHelps.begin(), kHelps.end());
    for (const char* help : {"mirror", "scale-bar", "chart", "calliper", "compare", "direct-view"})
        EXPECT_THAT(e.lockedHelps, testing::Contains(help));
    const Exercise back = parseExercise(exerciseText(e), "here");
    EXPECT_EQ(back.lockedHelps, e.lockedHelps);
    EXPECT_EQ(back.title, e.title);
    EXPECT_EQ(back.allowedBurs, e.allowedBurs);
    EXPECT_THAT(errorOf([] { (void)parseExercise("[exercise]\nlocked_helps = [\"miror\"]", "here"); }),
                AllOf(HasSubstr("here: "), HasSubstr("line 2"), HasSubstr("no help \"miror\"")));
}

TEST(CaseExercise, SpeaksTheStudentsLanguage) {
    const Texts texts{{"en", "tooth"}, {"pt", "dente"}, {"de", "Zahn"}};
    EXPECT_EQ(inLanguage(texts, "de"), "Zahn");
    EXPECT_EQ(inLanguage(texts, "pt-BR"), "dente");
    EXPECT_EQ(inLanguage(texts, "fr"), "tooth");
    EXPECT_EQ(inLanguage({{"ja", "ha"}}, "fr"), "ha");
    EXPECT_EQ(inLanguage({}, "fr"), "");
}

TEST(CaseExercise, AWrongOneIsToldWithItsLine) {
    const test::TemporaryFolder temporary;
    const auto error = [&](const std::string& text) {
        const fs::path place = temporary.path() / "case";
        fs::create_directories(place);
        geometry::writeStl(place / "part.stl", test::boxMesh({0, 0, 0}, {1, 1, 1}));
        core::writeFile(place / "t.toml", "format = 1\n[enamel]\ncutting = -1\n");
        core::writeFile(place / "case.toml", "format = 2\nouter = \"part.stl\"\n" + text);
        return errorOf([&] { (void)readCase(place); });
    };
    EXPECT_EQ(error("[exercise]\n"), "");
    EXPECT_THAT(error("[exercise]\nlocked_helps = [\"undoo\"]"), AllOf(HasSubstr("undoo"), HasSubstr("cross-section")));
    EXPECT_THAT(error("[exercise]\nhelps = []"), AllOf(HasSubstr("\"helps\""), HasSubstr("locked_helps")));
    EXPECT_THAT(error("[exercise]\nbur = \"330\"\nallowed_burs = [\"245\"]"), HasSubstr("not an allowed one"));
    EXPECT_THAT(error("[exercise]\ntitle = \"x\""), HasSubstr("wrong type"));
    EXPECT_THAT(error("[exercise.title]\n\"e n\" = \"x\""), HasSubstr("no language"));
    EXPECT_THAT(error("[exercise.view]\neye_mm = [0, 0]\ntarget_mm = [0, 0, 0]"), HasSubstr("three numbers"));
    EXPECT_THAT(error("[exercise.view]\neye_mm = [0, 0, 0]\ntarget_mm = [0, 0, 0]"), HasSubstr("looks nowhere"));
    EXPECT_THAT(error("[exercise.view]\neye_mm = [0, 0, 9]\ntarget_mm = [0, 0, 0]"), HasSubstr("upward"));
    EXPECT_THAT(error("tisues = \"t.toml\""), AllOf(HasSubstr("\"tisues\""), HasSubstr("line 3")));
    EXPECT_THAT(error("tissues = \"t.toml\""), AllOf(HasSubstr("t.toml"), HasSubstr("cutting of enamel is -1")));
    EXPECT_THAT(error("tissues = \"../t.toml\""), HasSubstr("inside the case's folder"));
    EXPECT_THAT(error("tissues = \"gone.toml\""), HasSubstr("gone.toml"));
}

std::vector<std::string> errorsOf(const Case& c) {
    std::vector<std::string> errors;
    for (const CaseFinding& f : checkCase(c))
        if (f.isError) errors.push_back(f.part + ": " + f.what);
    return errors;
}

TEST(CaseCheck, NestedAndOverlappingPartsAreRight) {
    EXPECT_THAT(errorsOf(boxes()), testing::IsEmpty());
    requireCase(boxes());
}

TEST(CaseCheck, TellsByHowMuchAPartSticksOut) {
    Case c = boxes();
    c.parts[0].mesh = test::boxMesh({-4, -4, 2}, {4, 4, 6.25});
    const auto findings = checkCase(c);
    ASSERT_FALSE(findings.empty());
    EXPECT_TRUE(findings[0].isError);
    EXPECT_EQ(findings[0].part, "enamel");
    EXPECT_NEAR(findings[0].byMm, 0.25, 1e-9);
    EXPECT_THAT(errorOf([&] { requireCase(c); }), AllOf(HasSubstr("enamel"), HasSubstr("0.250 mm")));
    c.parts[0].mesh = test::boxMesh({-4, -4, 2}, {4, 4, 6.04});
    EXPECT_THAT(errorsOf(c), testing::IsEmpty()) << "within what meshing leaves";
}

TEST(CaseCheck, TellsByHowMuchPartsOfOnePriorityCross) {
    Case c = boxes();
    c.parts[1].priority = 10;
    // Vertices of one in the other: the dentine's four top corners lie 1 mm from the enamel's sides.
    const auto findings = checkCase(c);
    ASSERT_FALSE(findings.empty());
    EXPECT_NEAR(findings[0].byMm, 1.0, 1e-9);
    EXPECT_THAT(findings[0].what, AllOf(HasSubstr("crosses \"dentine\""), HasSubstr("priority 10")));
}

TEST(CaseCheck, TellsWhatIsMissingOrNoSolid) {
    Case c = boxes();
    c.outer = {};
    EXPECT_THAT(errorsOf(c), ElementsAre(HasSubstr("no outer surface")));
    c = boxes();
    c.parts[1].mesh.triangles.pop_back();
    EXPECT_THAT(errorsOf(c), ElementsAre(AllOf(HasSubstr("dentine"), HasSubstr("open"))));
    c.parts[0].mesh.triangles.clear();
    EXPECT_EQ(errorsOf(c).size(), 2u);
    EXPECT_THAT(errorOf([&] { requireCase(c); }), HasSubstr("and 1 more"));
    c = boxes();
    c.parts.pop_back();
    bool said = false;
    for (const CaseFinding& f : checkCase(c))
        said = said || (!f.isError && f.what.find("lies in no part") != std::string::npos);
    EXPECT_TRUE(said);
    EXPECT_FALSE(errorsOf({}).empty());
}

}  // namespace
}  // namespace handpiece::cases::case_exercise_test
