// SPDX-License-Identifier: Apache-2.0
// A case that was scanned in colour: what is written, what older programs find, what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/case/case_bytes.h"
#include "handpiece/model/case/work_on.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::cases::case_colours_test {
namespace {

namespace fs = std::filesystem;
using geometry::TriangleMesh;
using geometry::VertexColours;
using testing::HasSubstr;
using testing::IsEmpty;

VertexColours halves(const TriangleMesh& mesh) {
    VertexColours colours;
    for (const core::Vec3& v : mesh.vertices)
        colours.push_back(v.x() < 0.0 ? geometry::Colour{200, 30, 40} : geometry::Colour{20, 190, 60});
    return colours;
}

/// A tooth and its gingiva in colour, beside a tooth in colour and one without.
Case sample() {
    Case c;
    c.name = "scanned";
    c.fdiNumber = 46;
    c.outer = test::sphereMesh({0.1, 0.2, 0.3}, 4, 8);  // not to be held by an STL's short numbers
    c.outerColours = halves(c.outer);
    Part gum{"gingiva", Tissue::gum, 5, test::boxMesh({-9, -9, -8}, {9, 9, -5})};
    gum.colours = halves(gum.mesh);
    Part bone{"bone", Tissue::bone, 4, test::boxMesh({-9, -9, -12}, {9, 9, -9})};
    c.scenery = {gum, bone};
    return c;
}

std::string textOf(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

void expectSame(const Case& read, const Case& c) {
    EXPECT_EQ(read.outerColours, c.outerColours);
    EXPECT_EQ(read.outer.vertices, c.outer.vertices);
    EXPECT_EQ(read.outer.triangles, c.outer.triangles);
    ASSERT_EQ(read.scenery.size(), c.scenery.size());
    for (std::size_t i = 0; i < c.scenery.size(); ++i)
        EXPECT_EQ(read.scenery[i].colours, c.scenery[i].colours);
    EXPECT_EQ(caseKey(read), caseKey(c));
}

TEST(CaseColours, comeBackFromAFolderAndFromOneFile) {
    const test::TemporaryFolder folder;
    const Case c = sample();
    for (const char* name : {"molar", "molar.handpiece"}) {
        writeCase(c, folder.path() / name);
        expectSame(readCase(folder.path() / name), c);
    }
    EXPECT_TRUE(fs::exists(folder.path() / "molar" / "outer.ply"));
    EXPECT_TRUE(fs::exists(folder.path() / "molar" / "scene-gingiva.ply"));
    EXPECT_TRUE(fs::exists(folder.path() / "molar" / "scene-bone.stl"));
}

TEST(CaseColours, needNoNewerFormatAndProgramsBeforeThemReadTheSurface) {
    const test::TemporaryFolder folder;
    Case c = sample();
    writeCase(c, folder.path() / "molar");
    EXPECT_THAT(textOf(folder.path() / "molar" / "case.toml"), HasSubstr("format = 1\n"));
    // As they did: the mesh that a file holds, whatever its name and whatever else it has.
    EXPECT_EQ(geometry::readMesh(folder.path() / "molar" / "outer.ply").vertices, c.outer.vertices);
    const std::uint64_t key = caseKey(c);
    c.outerColours.clear();
    EXPECT_EQ(caseKey(c), key) << "the same tooth: attempts at it go on";
}

TEST(CaseColours, ofACaseWithoutThemThereAreNone) {
    const test::TemporaryFolder folder;
    Case c = sample();
    c.outerColours.clear();
    for (Part& part : c.scenery)
        part.colours.clear();
    EXPECT_FALSE(isScannedInColour(c));
    writeCase(c, folder.path() / "molar");
    const Case read = readCase(folder.path() / "molar");
    EXPECT_FALSE(isScannedInColour(read));
    EXPECT_TRUE(fs::exists(folder.path() / "molar" / "outer.stl"));
    EXPECT_TRUE(isScannedInColour(sample()));
}

TEST(CaseColours, stayWithTheirToothWhereAnotherIsWorkedOn) {
    const test::TemporaryFolder folder;
    Case c = sample();
    PlacedTooth other;
    other.fdiNumber = 45;
    other.outer = test::boxMesh({-2, -2, -6}, {2, 2, 4});
    other.outerColours = halves(other.outer);
    other.inCase.positionMm = {12, 0, 0};
    c.others.push_back(other);
    writeCase(c, folder.path() / "mouth.handpiece");
    const Case turned = workOn(readCase(folder.path() / "mouth.handpiece"), 45);
    EXPECT_EQ(turned.outerColours, other.outerColours);
    ASSERT_EQ(turned.others.size(), 1u);
    EXPECT_EQ(turned.others[0].outerColours, c.outerColours);
    EXPECT_EQ(turned.scenery[0].colours, c.scenery[0].colours);
    EXPECT_EQ(surroundings(turned)[0].colours, c.outerColours);
}

TEST(CaseColours, ofAMeshFileAreThoseOfTheTooth) {
    const test::TemporaryFolder folder;
    const Case c = sample();
    geometry::writePly(folder.path() / "scan.ply", c.outer, c.outerColours);
    const Case read = readCase(folder.path() / "scan.ply");
    EXPECT_EQ(read.surfaceColours(), c.outerColours);
    EXPECT_TRUE(isScannedInColour(read));
}

TEST(CaseColours, fewerThanVerticesAreOneError) {
    const test::TemporaryFolder folder;
    Case c = sample();
    c.outerColours.pop_back();
    EXPECT_THAT(test::errorOf([&] { writeCase(c, folder.path() / "molar"); }), HasSubstr("colours for"));
    EXPECT_FALSE(fs::exists(folder.path() / "molar"));

    writeCase(sample(), folder.path() / "molar");
    const fs::path file = folder.path() / "molar" / "outer.ply";
    fs::resize_file(file, fs::file_size(file) / 2);
    EXPECT_THAT(test::errorOf([&] { (void)readCase(folder.path() / "molar"); }), HasSubstr("outer.ply"));
}

TEST(CaseColours, aSessionHoldsTheToothWithoutThem) {
    const Case c = sample();
    const Case read = decodeCase(encodeCase(c), "session");
    EXPECT_EQ(read.outer.vertices, c.outer.vertices);
    EXPECT_FALSE(isScannedInColour(read));
}

}  // namespace
}  // namespace handpiece::cases::case_colours_test
