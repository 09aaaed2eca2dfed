// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <set>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/case_check.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "support/closed_meshes.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::cases::case_test {
namespace {

namespace fs = std::filesystem;
using geometry::TriangleMesh;
using test::errorOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Everything below a folder, files with their content.
std::map<std::string, std::string> contents(const fs::path& folder) {
    std::map<std::string, std::string> found;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        std::ifstream in(entry.path(), std::ios::binary);
        found[fs::relative(entry.path(), folder).string()] =
            entry.is_regular_file() ? std::string(std::istreambuf_iterator<char>(in), {}) : "a folder";
    }
    return found;
}

std::vector<std::string> names(const fs::path& folder) {
    std::vector<std::string> found;
    for (const auto& [name, content] : contents(folder))
        found.push_back(name);
    return found;
}

Part part(const char* name, Tissue tissue, int priority, TriangleMesh mesh) {
    return {name, tissue, priority, std::move(mesh)};
}

/// Coordinates that a float32 holds exactly come back exactly.
Case sample() {
    Case c;
    c.name = "a \"quoted\" molar, 46\nsecond line";
    c.kind = "lower-first-molar";
    c.fdiNumber = 46;
    c.buccalSign = -1;
    c.outer = test::boxMesh({-4, -4, -8}, {4, 4, 6});
    c.parts = {part("enamel", Tissue::enamel, 10, test::boxMesh({-4, -4, 2}, {4, 4, 6})),
               part("deep caries / pit", Tissue::caries, 77, test::boxMesh({-1, -1, 3}, {1, 1, 4.5})),
               part("deep caries . pit", Tissue::caries, 78, test::boxMesh({1, 1, 3}, {2, 2, 4.5}))};
    c.scenery = {part("outer", Tissue::gum, 0, test::boxMesh({-9, -9, -9}, {9, 9, -1}))};
    return c;
}

void expectSameMesh(const TriangleMesh& a, const TriangleMesh& b) {
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    for (std::size_t t = 0; t < a.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(a.vertices[a.triangles[t][k]], b.vertices[b.triangles[t][k]]);
}

void expectSameParts(const std::vector<Part>& a, const std::vector<Part>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].name, b[i].name);
        EXPECT_EQ(a[i].tissue, b[i].tissue);
        EXPECT_EQ(a[i].priority, b[i].priority);
        expectSameMesh(a[i].mesh, b[i].mesh);
    }
}

std::string readError(const fs::path& path) {
    return errorOf([&] { (void)readCase(path); });
}
std::string writeError(const Case& c, const fs::path& path) {
    return errorOf([&] { writeCase(c, path); });
}

class CaseTest : public testing::Test {
  protected:
    [[nodiscard]] fs::path folder() const { return temporary_.path(); }
    /// A case folder with this case.toml and a box as part.stl.
    fs::path caseOf(const std::string& toml) const {
        const fs::path place = folder() / "case";
        fs::create_directories(place);
        geometry::writeStl(place / "part.stl", test::boxMesh({0, 0, 0}, {1, 1, 1}));
        core::writeFile(place / "case.toml", toml);
        return place;
    }

  private:
    test::TemporaryFolder temporary_;
};

const char* kPart = "[[part]]\nfile = \"part.stl\"\ntissue = \"dentine\"\n";

TEST_F(CaseTest, ComesBackAsItWasWritten) {
    const Case written = sample();
    writeCase(written, folder() / "new" / "molar");
    const Case read = readCase(folder() / "new" / "molar");
    EXPECT_EQ(read.name, written.name);
    EXPECT_EQ(read.kind, written.kind);
    EXPECT_EQ(read.fdiNumber, 46);
    EXPECT_EQ(read.buccalSign, -1);
    EXPECT_EQ(read.source, folder() / "new" / "molar");
    expectSameMesh(read.outer, written.outer);
    expectSameParts(read.parts, written.parts);
    expectSameParts(read.scenery, written.scenery);
    // Names that look alike as files stay apart, and nothing else is left.
    EXPECT_THAT(names(folder() / "new"),
                ElementsAre("molar", "molar/case.toml", "molar/deep-caries---pit-2.stl", "molar/deep-caries---pit.stl",
                            "molar/enamel.stl", "molar/outer.stl", "molar/scene-outer.stl"));
}

/// With a tooth beside it, turned, and gum that is felt.
Case mouth() {
    Case c = sample();
    c.landmarks = {{LandmarkKind::cuspTip, "mesiobuccal", {{2.12345, -1.5, 6.0}}, LandmarkSource::generated},
                   {LandmarkKind::fissure, "central", {{-2, 0, 5}, {0, 0.1, 4.9}, {2, 0, 5}}, LandmarkSource::set},
                   {LandmarkKind::cementoEnamelJunction, "", {{4, 0, 0}, {0, 4, 0}, {-4, 0, 0}}, LandmarkSource::found},
                   {LandmarkKind::longAxis, "", {{0, 0, -14}, {0, 0, 7}}, LandmarkSource::generated}};
    PlacedTooth other;
    other.name = "second premolar";
    other.fdiNumber = 45;
    other.buccalSign = -1;
    other.outer = test::boxMesh({-3, -3, -9}, {3, 3, 4});
    other.parts = {{"enamel", Tissue::enamel, 20, test::boxMesh({-3, -3, 0}, {3, 3, 4}), false}};
    other.landmarks = {{LandmarkKind::contact, "distal", {{-3, 0, 2}}, LandmarkSource::generated}};
    other.inCase = {{20.25, 1.0 / 3.0, -0.5}, core::Quat(Eigen::AngleAxisd(0.3, core::Vec3(1, 2, 3).normalized()))};
    c.others.push_back(other);
    other.name = "canine";
    other.fdiNumber = 43;
    other.isCuttable = false;
    other.inCase.positionMm.x() = 40.0;
    c.others.push_back(other);
    c.scenery.front().isFelt = true;
    return c;
}

void expectSameLandmarks(const std::vector<Landmark>& a, const std::vector<Landmark>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].kind, b[i].kind);
        EXPECT_EQ(a[i].name, b[i].name);
        EXPECT_EQ(a[i].source, b[i].source);
        ASSERT_EQ(a[i].pointsMm.size(), b[i].pointsMm.size());
        for (std::size_t k = 0; k < a[i].pointsMm.size(); ++k)
            EXPECT_LT((a[i].pointsMm[k] - b[i].pointsMm[k]).norm(), 1e-5);
    }
}

TEST_F(CaseTest, AMouthComesBackAsItWasWritten) {
    const Case written = mouth();
    for (const fs::path& place : {folder() / "mouth", folder() / "mouth.handpiece"}) {
        writeCase(written, place);
        const Case read = readCase(place);
        EXPECT_TRUE(read.scenery.front().isFelt);
        expectSameLandmarks(read.landmarks, written.landmarks);
        ASSERT_EQ(read.others.size(), 2u);
        for (std::size_t i = 0; i < 2; ++i) {
            const PlacedTooth &a = read.others[i], &b = written.others[i];
            EXPECT_EQ(a.name, b.name);
            EXPECT_EQ(a.fdiNumber, b.fdiNumber);
            EXPECT_EQ(a.buccalSign, -1);
            EXPECT_EQ(a.isCuttable, i == 0);
            EXPECT_EQ(a.inCase.positionMm, b.inCase.positionMm);
            EXPECT_EQ(a.inCase.orientation.coeffs(), b.inCase.orientation.coeffs());
            expectSameMesh(a.outer, b.outer);
            expectSameParts(a.parts, b.parts);
            expectSameLandmarks(a.landmarks, b.landmarks);
        }
        EXPECT_EQ(contentKey(read), contentKey(written));
        EXPECT_EQ(caseKey(read), caseKey(written));
        EXPECT_EQ(surroundings(read).size(), 3u);
    }
    // The key is that of the teeth and where they stand, to a nanometre; without others that of the tooth alone.
    Case moved = written;
    moved.others[1].inCase.positionMm.y() += 1e-10;
    EXPECT_EQ(caseKey(moved), caseKey(written));
    moved.others[1].inCase.positionMm.y() += 2e-6;
    EXPECT_NE(caseKey(moved), caseKey(written));
    EXPECT_EQ(contentKey(moved), contentKey(written));
    moved.others.clear();
    EXPECT_EQ(caseKey(moved), contentKey(written));
}

TEST_F(CaseTest, TellsWhatIsWrongWithAMouth) {
    const auto error = [&](const std::string& more) {
        const std::string what = readError(caseOf("format = 3\nfdi = 46\n" + more + "\n" + kPart));
        EXPECT_EQ(what.find('\n'), std::string::npos) << "one line: " << what;
        return what;
    };
    const std::string tooth = "[[tooth]]\nfdi = 45\nouter = \"part.stl\"\nposition_mm = [10, 0, 0]\n";
    const std::string turn = "orientation = [1, 0, 0, 0]\n";
    EXPECT_EQ(error(tooth + turn), "");
    EXPECT_THAT(error(tooth), HasSubstr("turn"));
    EXPECT_THAT(error(tooth + "orientation = [1, 1, 0, 0]\n"), HasSubstr("unit quaternion"));
    EXPECT_THAT(error(tooth + "orientation = [1, 0, 0]\n"), HasSubstr("four numbers"));
    EXPECT_THAT(error(tooth + turn + "colour = 3\n"), HasSubstr("colour"));
    EXPECT_THAT(error("[[tooth]]\nfdi = 45\nposition_mm = [10, 0, 0]\n" + turn), HasSubstr("outer"));
    EXPECT_THAT(error("[[tooth]]\nouter = \"part.stl\"\nposition_mm = [1e4, 0, 0]\n" + turn),
                HasSubstr("10000 mm off"));
    EXPECT_THAT(error("[[tooth]]\nouter = \"../part.stl\"\nposition_mm = [1, 0, 0]\n" + turn),
                HasSubstr("inside the case"));
    EXPECT_THAT(error(tooth + turn + tooth + turn), HasSubstr("45 stands in the case twice"));
    EXPECT_THAT(error("[[tooth]]\nfdi = 46\nouter = \"part.stl\"\nposition_mm = [1, 0, 0]\n" + turn),
                HasSubstr("twice"));
    EXPECT_THAT(error("[[landmark]]\nkind = \"nose\"\npoints_mm = [1, 2, 3]\n"),
                AllOf(HasSubstr("nose"), HasSubstr("cusp-tip")));
    EXPECT_THAT(error("[[landmark]]\nkind = \"cusp-tip\"\npoints_mm = [1, 2]\n"), HasSubstr("2 numbers"));
    EXPECT_THAT(error("[[landmark]]\nkind = \"fissure\"\npoints_mm = [1, 2, 3]\n"), HasSubstr("3 numbers"));
    EXPECT_THAT(error("[[landmark]]\nkind = \"cusp-tip\"\npoints_mm = [1, 2, 3e5]\n"), HasSubstr("off the tooth"));
    EXPECT_THAT(error("[[landmark]]\nkind = \"long-axis\"\npoints_mm = [1, 2, 3, 1, 2, 3]\n"),
                HasSubstr("no direction"));
    EXPECT_THAT(error("[[landmark]]\nkind = \"pit\"\nsource = \"god\"\npoints_mm = [1, 2, 3]\n"), HasSubstr("god"));
    EXPECT_THAT(error("[[part]]\nfile = \"part.stl\"\ntissue = \"enamel\"\nfelt = true\n"), HasSubstr("felt"));
    // What is new is nothing that an older format may have.
    EXPECT_THAT(readError(caseOf("format = 2\n" + tooth + turn + kPart)), HasSubstr("tooth"));
    std::string many = "format = 3\n";
    for (int i = 0; i < 70; ++i)
        many += "[[tooth]]\n";
    EXPECT_THAT(readError(caseOf(many + kPart)), HasSubstr("70 teeth"));
}

TEST_F(CaseTest, FindsTeethThatCross) {
    Case c;
    c.outer = test::sphereMesh(3, 4.0);
    PlacedTooth other;
    other.fdiNumber = 45;
    other.outer = c.outer;
    for (const double atMm : {7.95, 7.0, 60.0}) {
        c.others.assign(1, other);
        c.others[0].inCase.positionMm = {atMm, 0, 0};
        const auto findings = checkCase(c);
        const auto errors = std::count_if(findings.begin(), findings.end(), [](const auto& f) { return f.isError; });
        EXPECT_EQ(errors, atMm == 7.0 ? 1 : 0) << atMm;
    }
    c.others[0].outer.triangles.pop_back();
    EXPECT_THAT(checkCase(c).front().what, HasSubstr("open"));
    EXPECT_EQ(checkCase(c).front().part, "tooth 45");
}

TEST_F(CaseTest, WithoutAnOuterSurfaceToo) {
    Case c;
    c.name = "part only";
    c.parts = {part("outer", Tissue::dentine, 1, test::boxMesh({0, 0, 0}, {1, 1, 1}))};
    writeCase(c, folder() / "c/");
    const Case read = readCase(folder() / "c");
    EXPECT_TRUE(read.outer.triangles.empty());
    EXPECT_EQ(read.fdiNumber, 0);
    EXPECT_EQ(read.buccalSign, 0);
    expectSameParts(read.parts, c.parts);
}

TEST_F(CaseTest, ReplacesAnOldCaseWhole) {
    writeCase(sample(), folder() / "molar");
    Case next;
    next.name = "next";
    next.outer = test::boxMesh({0, 0, 0}, {2, 2, 2});
    writeCase(next, folder() / "molar");
    EXPECT_THAT(names(folder()), ElementsAre("molar", "molar/case.toml", "molar/outer.stl"));
    EXPECT_EQ(readCase(folder() / "molar").name, "next");
    fs::create_directory(folder() / "empty");
    EXPECT_EQ(writeError(next, folder() / "empty"), "") << "an empty folder is as good as none";
}

TEST_F(CaseTest, NeverReplacesWhatIsNotACase) {
    fs::create_directory(folder() / "thesis");
    core::writeFile(folder() / "thesis" / "chapter1.txt", "years of work");
    core::writeFile(folder() / "file", "a file");
    const auto before = contents(folder());
    EXPECT_THAT(writeError(sample(), folder() / "thesis"), AllOf(HasSubstr("thesis"), HasSubstr("is not replaced")));
    EXPECT_THAT(writeError(sample(), folder() / "file"), HasSubstr("file"));
    EXPECT_THAT(writeError(sample(), folder() / "file" / "below"), HasSubstr("file"));
    EXPECT_EQ(contents(folder()), before);
}

TEST_F(CaseTest, AFailureLeavesTheOldCaseAndNothingElse) {
    writeCase(sample(), folder() / "molar");
    const auto before = contents(folder());
    Case bad = sample();
    bad.scenery[0].mesh.triangles[3][1] = 99;  // found only after the other files were written
    EXPECT_NE(writeError(bad, folder() / "molar"), "");
    EXPECT_NE(writeError(bad, folder() / "other"), "");
    EXPECT_EQ(contents(folder()), before);
}

TEST_F(CaseTest, TellsOfAPlaceThatCannotBeWritten) {
    if (geteuid() == 0) {
        // Permissions do not stop root; /proc does.
        EXPECT_THAT(writeError(sample(), "/proc/handpiece/molar"), HasSubstr("/proc/handpiece"));
        return;
    }
    fs::create_directory(folder() / "locked");
    fs::permissions(folder() / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THAT(writeError(sample(), folder() / "locked" / "molar"), HasSubstr("locked"));
    fs::permissions(folder() / "locked", fs::perms::owner_all);
    EXPECT_THAT(names(folder() / "locked"), IsEmpty());
}

TEST_F(CaseTest, ASingleMeshFileIsACaseToo) {
    geometry::writeStl(folder() / "scan.stl", test::boxMesh({0, 0, 0}, {1, 2, 3}));
    const Case read = readCase(folder() / "scan.stl");
    EXPECT_EQ(read.name, "scan");
    EXPECT_EQ(read.source, folder() / "scan.stl");
    EXPECT_EQ(read.outer.triangles.size(), 12u);
    EXPECT_THAT(read.parts, IsEmpty());
    EXPECT_THAT(readError(folder() / "none.stl"), AllOf(HasSubstr("none.stl"), HasSubstr("no such file")));
}

TEST_F(CaseTest, FillsInWhatMayBeLeftOut) {
    const Case read = readCase(caseOf(std::string("format = 1\n") + kPart));
    EXPECT_EQ(read.name, "case");
    ASSERT_EQ(read.parts.size(), 1u);
    EXPECT_EQ(read.parts[0].name, "dentine");
    EXPECT_EQ(read.parts[0].priority, properties(Tissue::dentine).priority);
}

TEST_F(CaseTest, AFolderAboveACaseTellsWhichOneIs) {
    const fs::path above = folder() / "above";
    fs::create_directory(above);
    const auto put = [&](const char* name) {
        fs::create_directory(above / name);
        std::ofstream(above / name / "case.toml") << "format = 1\n" << kPart;
    };
    put("mouth");
    fs::create_directory(above / "empty");
    EXPECT_THAT(readError(above), AllOf(HasSubstr("no case.toml"), HasSubstr((above / "mouth").string() + " is one"),
                                        Not(HasSubstr("empty"))));
    for (const char* name : {"a", "z", "b"})
        put(name);
    EXPECT_THAT(readError(above), HasSubstr(fmt::format("{0}/a, {0}/b, {0}/mouth, ...", above.string())));
}

TEST_F(CaseTest, TellsWhatIsWrongAndWhere) {
    fs::create_directory(folder() / "bare");
    EXPECT_THAT(readError(folder() / "bare"),
                AllOf(HasSubstr("bare"), HasSubstr("no case.toml"), HasSubstr("make tooth")));
    const auto error = [&](const std::string& toml) {
        const std::string what = readError(caseOf(toml));
        EXPECT_THAT(what, HasSubstr("case.toml")) << "names the file";
        EXPECT_EQ(what.find('\n'), std::string::npos) << "one line: " << what;
        return what;
    };
    const std::string ok = std::string("format = 1\n") + kPart;
    EXPECT_THAT(error("format = 1\nname = \"molar\n"), HasSubstr("line 2"));
    EXPECT_THAT(error("format = 1\nformat = 1\n"), HasSubstr("line 2"));
    EXPECT_THAT(error("\n\n\xff\xfe = 3\n"), HasSubstr("utf-8"));
    EXPECT_THAT(error(kPart), AllOf(HasSubstr("format"), HasSubstr("format = 1")));
    EXPECT_THAT(error("format = 7\n"), AllOf(HasSubstr("format is 7"), HasSubstr("newer Handpiece")));
    EXPECT_THAT(error("format = \"1\"\n"), AllOf(HasSubstr("wrong type"), HasSubstr("line 1")));
    EXPECT_THAT(error("format = 1\n"), HasSubstr("neither an outer surface nor a part"));
    EXPECT_THAT(error("format = 1\npart = 3\n"), HasSubstr("not a list of tables"));
    EXPECT_THAT(error("format = 1\npart = [1, 2]\n"), HasSubstr("not a list of tables"));
    EXPECT_THAT(error("format = 1\n[[part]]\nfile = \"part.stl\"\n"), HasSubstr("without file or tissue (line 2)"));
    EXPECT_THAT(error("format = 1\nfdi = 49\n"), HasSubstr("49 is no tooth number"));
    EXPECT_THAT(error("format = 1\nfdi = 4.6\n"), HasSubstr("wrong type"));
    EXPECT_THAT(error("format = 1\nbuccal = \"left\"\n"), AllOf(HasSubstr("left"), HasSubstr("\"-y\"")));
    EXPECT_EQ(readError(caseOf(ok)), "") << "and takes what is right";
}

TEST_F(CaseTest, NamesTheTissuesThereAreAndTheFileThatIsMissing) {
    EXPECT_THAT(readError(caseOf("format = 1\n[[part]]\nfile = \"part.stl\"\ntissue = \"cheese\"\n")),
                AllOf(HasSubstr("case.toml"), HasSubstr("line 2"), HasSubstr("cheese"), HasSubstr("enamel"),
                      HasSubstr("restoration")));
    EXPECT_THAT(readError(caseOf("format = 1\n[[part]]\nfile = \"gone.stl\"\ntissue = \"pulp\"\n")),
                AllOf(HasSubstr("gone.stl"), HasSubstr("no such file")));
    EXPECT_THAT(readError(caseOf("format = 1\nouter = \"case.toml\"\n")), HasSubstr("case.toml"));
}

TEST_F(CaseTest, ReadsNothingOutsideItsFolder) {
    geometry::writeStl(folder() / "secret.stl", test::boxMesh({0, 0, 0}, {1, 1, 1}));
    for (const std::string& file :
         {std::string("../secret.stl"), std::string("a/../../secret.stl"), (folder() / "secret.stl").string()}) {
        EXPECT_THAT(readError(caseOf("format = 1\nouter = \"" + file + "\"\n")),
                    AllOf(HasSubstr(file), HasSubstr("inside the case's folder")));
        EXPECT_THAT(readError(caseOf("format = 1\n[[part]]\ntissue = \"pulp\"\nfile = \"" + file + "\"\n")),
                    HasSubstr("inside the case's folder"));
    }
}

TEST_F(CaseTest, FollowsNoLinkOutOfItsFolder) {
    geometry::writeStl(folder() / "secret.stl", test::boxMesh({0, 0, 0}, {1, 1, 1}));
    const fs::path home = caseOf("format = 1\nouter = \"outer.stl\"\n");
    fs::remove(home / "outer.stl");
    fs::create_symlink("../secret.stl", home / "outer.stl");
    EXPECT_THAT(readError(home), AllOf(HasSubstr("outer.stl"), HasSubstr("a link that leads out")));
    // By way of a folder too.
    fs::remove(home / "outer.stl");
    fs::create_symlink("..", home / "up");
    caseOf("format = 1\nouter = \"up/secret.stl\"\n");
    EXPECT_THAT(readError(home), HasSubstr("a link that leads out"));
    // One that stays inside is a file as any other, and so is a case that is itself named by a link.
    fs::copy_file(folder() / "secret.stl", home / "own.stl");
    fs::create_symlink("own.stl", home / "outer.stl");
    caseOf("format = 1\nouter = \"outer.stl\"\n");
    fs::create_directory_symlink(home, folder() / "named");
    EXPECT_EQ(readError(folder() / "named"), "");
}

}  // namespace
}  // namespace handpiece::cases::case_test
