// SPDX-License-Identifier: Apache-2.0
// Colours of an intraoral scan: read from each format that has them, kept with their vertices, written.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/repair.h"
#include "handpiece/base/geometry/texture.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::geometry::mesh_colours_test {
namespace {

using core::Vec3;
using test::errorOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Bytes = std::vector<std::byte>;

constexpr Colour kRed{255, 0, 0}, kGreen{0, 255, 0}, kBlue{0, 0, 255}, kGrey{128, 128, 128};

ColouredMesh fromText(std::string_view text, ReadNotes* notes = nullptr) {
    return readColouredMesh(std::as_bytes(std::span(text)), MeshFormat::unknown, "memory", notes);
}

/// A tetrahedron as text, a line a vertex.
std::string ply(std::string_view properties, const std::array<std::string, 4>& vertices) {
    return fmt::format(
        "ply\nformat ascii 1.0\nelement vertex 4\n{}element face 4\nproperty list uchar int vertex_indices\n"
        "end_header\n{}\n{}\n{}\n{}\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
        properties, vertices[0], vertices[1], vertices[2], vertices[3]);
}
constexpr const char* kXyz = "property float x\nproperty float y\nproperty float z\n";

template <class T>
void append(Bytes& data, T value, bool bigEndian = false) {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof value);
    if (bigEndian) std::reverse(raw.begin(), raw.end());
    data.insert(data.end(), raw.begin(), raw.end());
}

TEST(MeshColours, PlyHasThemAsBytes) {
    const ColouredMesh read =
        fromText(ply(std::string(kXyz) + "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                     {"0 0 0 255 0 0", "1 0 0 0 255 0", "0 1 0 0 0 255", "0 0 1 128 128 128"}));
    EXPECT_THAT(read.colours, ElementsAre(kRed, kGreen, kBlue, kGrey));
    EXPECT_EQ(read.mesh.vertices[3], Vec3(0, 0, 1));
}

TEST(MeshColours, PlyHasThemInAnyOrderWithMoreAround) {
    const ColouredMesh read = fromText(
        ply("property uchar blue\nproperty float nx\nproperty float z\nproperty uchar alpha\nproperty uchar red\n"
            "property float x\nproperty uchar green\nproperty list uchar int more\nproperty float y\n",
            {"0 9 0 255 255 0 0 2 5 6 0", "0 9 0 0 0 1 255 0 0", "255 9 0 7 0 0 0 1 3 1", "128 9 1 7 128 0 128 0 0"}));
    EXPECT_THAT(read.colours, ElementsAre(kRed, kGreen, kBlue, kGrey));
    EXPECT_EQ(read.mesh.vertices[2], Vec3(0, 1, 0));
}

TEST(MeshColours, PlyHasThemAsFloatsOfOneOrOf255AndAsSixteenBits) {
    for (const char* type : {"float", "double"}) {
        const auto channels =
            fmt::format("{}property {} red\nproperty {} green\nproperty {} blue\n", kXyz, type, type, type);
        EXPECT_THAT(
            fromText(ply(channels, {"0 0 0 1 0 0", "1 0 0 0 1.0 0", "0 1 0 0 0 1", "0 0 1 0.502 0.502 0.502"})).colours,
            ElementsAre(kRed, kGreen, kBlue, kGrey));
        EXPECT_THAT(
            fromText(ply(channels, {"0 0 0 255 0 0", "1 0 0 0 255 0", "0 1 0 0 0 255", "0 0 1 128 128 128"})).colours,
            ElementsAre(kRed, kGreen, kBlue, kGrey));
    }
    const auto wide = fmt::format("{}property ushort red\nproperty ushort green\nproperty ushort blue\n", kXyz);
    EXPECT_THAT(
        fromText(ply(wide, {"0 0 0 65535 0 0", "1 0 0 0 65535 0", "0 1 0 0 0 65535", "0 0 1 32896 32896 32896"}))
            .colours,
        ElementsAre(kRed, kGreen, kBlue, kGrey));
    // A whole 1 is nearly black, not white.
    const auto bytes = fmt::format("{}property uchar red\nproperty uchar green\nproperty uchar blue\n", kXyz);
    EXPECT_EQ(fromText(ply(bytes, {"0 0 0 1 0 0", "1 0 0 0 1 0", "0 1 0 0 0 1", "0 0 1 0 0 0"})).colours[0],
              (Colour{1, 0, 0}));
}

TEST(MeshColours, BinaryPlyOfBothEnds) {
    for (const bool big : {false, true}) {
        const std::string header = fmt::format(
            "ply\nformat binary_{}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n",
            big ? "big" : "little");
        Bytes data;
        for (const char c : header)
            append(data, c);
        const std::array<Colour, 3> colours{kRed, kGreen, kGrey};
        for (int v = 0; v < 3; ++v) {
            append(data, v == 1 ? 1.0f : 0.0f, big);
            append(data, v == 2 ? 1.0f : 0.0f, big);
            append(data, 0.0f, big);
            for (const std::uint8_t channel : colours[static_cast<std::size_t>(v)])
                append(data, channel);
            append(data, std::uint8_t{255});
        }
        append(data, std::uint8_t{3});
        for (std::int32_t v = 0; v < 3; ++v)
            append(data, v, big);
        const ColouredMesh read = readColouredMesh(data, MeshFormat::ply, "memory");
        EXPECT_THAT(read.colours, ElementsAre(kRed, kGreen, kGrey));
        EXPECT_EQ(read.mesh.vertices[2], Vec3(0, 1, 0));
        // Cut short anywhere it is one clear error, whether the colours are wanted or not.
        for (std::size_t size = header.size(); size < data.size(); ++size) {
            EXPECT_THROW((void)readColouredMesh(std::span(data).first(size), MeshFormat::ply, "memory"), core::Error);
            EXPECT_THROW((void)readMesh(std::span(data).first(size), MeshFormat::ply, "memory"), core::Error);
        }
    }
}

TEST(MeshColours, ObjHasThemBehindTheCoordinates) {
    const auto tetrahedron = [](const std::array<const char*, 4>& colours) {
        return fmt::format("v 0 0 0 {}\nv 1 0 0 {}\nv 0 1 0 {}\nv 0 0 1 {}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
                           colours[0], colours[1], colours[2], colours[3]);
    };
    EXPECT_THAT(fromText(tetrahedron({"1 0 0", "0 1 0", "0 0 1", "0.502 0.502 0.502"})).colours,
                ElementsAre(kRed, kGreen, kBlue, kGrey));
    EXPECT_THAT(fromText(tetrahedron({"255 0 0", "0 255 0", "0 0 255 255", "128 128 128 # grey"})).colours,
                ElementsAre(kRed, kGreen, kBlue, kGrey));
    ReadNotes notes;
    EXPECT_THAT(fromText(tetrahedron({"1", "1", "1", "1"}), &notes).colours, IsEmpty()) << "weights";
    EXPECT_THAT(notes, IsEmpty());
}

TEST(MeshColours, WhatCannotBeBelievedIsLeftOutAndToldAndTheSurfaceIsRead) {
    const auto objOf = [](const char* last) {
        return fmt::format(
            "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0 0 1 {}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", last);
    };
    const std::pair<const char*, const char*> wrong[] = {
        {"", "3 of 4 vertices have one"},        {"red", "3 of 4 vertices have one"},
        {"-1 0 0", "negative or no numbers"},    {"nan 0 0", "negative or no numbers"},
        {"1e300 0 0", "negative or no numbers"}, {"70000 0 0", "beyond any scale"}};
    for (const auto& [last, reason] : wrong) {
        ReadNotes notes;
        const ColouredMesh read = fromText(objOf(last), &notes);
        EXPECT_THAT(read.colours, IsEmpty()) << last;
        EXPECT_EQ(read.mesh.triangles.size(), 4u) << last;
        ASSERT_EQ(notes.size(), 1u) << last;
        EXPECT_THAT(notes[0], HasSubstr(reason)) << last;
    }
    ReadNotes notes;
    EXPECT_THAT(fromText(ply(std::string(kXyz) + "property uchar red\nproperty uchar green\nproperty uchar blue\n",
                             {"0 0 0 9 9 9", "1 0 0 9 9 9", "0 1 0 9 9 9", "0 0 1 9 9 9"}),
                         &notes)
                    .colours,
                IsEmpty());
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_THAT(notes[0], HasSubstr("all vertices have the same"));
}

TEST(MeshColours, WhatIsBeyondItsTypeOrItsLineIsTold) {
    const auto of = [](const char* type) {
        return fmt::format("{}property {} red\nproperty {} green\nproperty {} blue\n", kXyz, type, type, type);
    };
    // Rounded up a little: not a scale to 255, on which all would be black.
    EXPECT_THAT(
        fromText(ply(of("float"), {"0 0 0 1.0001 0 0", "1 0 0 0 1 0", "0 1 0 0 0 1", "0 0 1 0.502 0.502 0.502"}))
            .colours,
        ElementsAre(kRed, kGreen, kBlue, kGrey));
    for (const auto& [type, reason] : {std::pair{"uchar", "beyond any scale"}, {"char", "with a sign"}}) {
        ReadNotes notes;
        EXPECT_THAT(
            fromText(ply(of(type), {"0 0 0 300 0 0", "1 0 0 0 1 0", "0 1 0 0 0 1", "0 0 1 9 9 9"}), &notes).colours,
            IsEmpty());
        ASSERT_EQ(notes.size(), 1u);
        EXPECT_THAT(notes[0], HasSubstr(reason));
    }
    // Without its blue, the next line's x would be it.
    EXPECT_THAT(test::errorOf([&] {
                    (void)fromText(ply(of("uchar"), {"0 0 0 9 0 0", "1 0 0 0 1", "0 1 0 0 0 1", "0 0 1 9 9 9"}));
                }),
                HasSubstr("the line of vertex 2 has too few values"));
}

TEST(MeshColours, TwoChannelsOrNoneOfVerticesAreNone) {
    ReadNotes notes;
    EXPECT_THAT(fromText(ply(std::string(kXyz) + "property uchar red\nproperty uchar green\n",
                             {"0 0 0 9 1", "1 0 0 9 2", "0 1 0 9 3", "0 0 1 9 4"}),
                         &notes)
                    .colours,
                IsEmpty());
    EXPECT_THAT(fromText(ply(kXyz, {"0 0 0", "1 0 0", "0 1 0", "0 0 1"}), &notes).colours, IsEmpty());
    EXPECT_THAT(notes, IsEmpty());
}

/// A folder with a tetrahedron in an OBJ, its materials and, of a sort, its pictures: this test's reader makes them.
class Textured : public testing::Test {
  protected:
    void SetUp() override {
        readPicturesWith([](const std::filesystem::path& file) {
            if (file.filename() == "damaged.jpg") throw core::Error("this picture is damaged", file.string());
            // Two by two: red and green above, blue and grey below.
            return Picture{2, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 128, 128, 128}};
        });
        write("t.obj", obj());
        write("scan.mtl", "newmtl other\nKd 1 1 1\n\nnewmtl arch\nKa 1 1 1\nmap_Kd -clamp on -s 1 1 1 upper jaw.png\n");
        write("upper jaw.png", "made by the reader");
    }
    void TearDown() override { readPicturesWith({}); }
    static std::string obj(std::string_view places = "vt 0 1\nvt 1 1\nvt 0 0\nvt 1 0\n",
                           std::string_view library = "scan.mtl", std::string_view last = "4/4/1") {
        return fmt::format(
            "mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\n{}usemtl arch\nf 1/1 3/3 2/2\n"
            "f 1/1 2/2 {}\nf 1/-4 4/4 3/3\nf 2/2 3/3 4/4\n",
            library, places, last);
    }
    void write(const std::string& name, std::string_view text) const { std::ofstream(folder_.path() / name) << text; }
    [[nodiscard]] ColouredMesh read(ReadNotes* notes = nullptr) const {
        return readColouredMesh(folder_.path() / "t.obj", notes);
    }
    /// What is told of colours that are left out; the surface is there.
    [[nodiscard]] std::string leftOut() const {
        ReadNotes notes;
        const ColouredMesh mesh = read(&notes);
        EXPECT_EQ(mesh.mesh.triangles.size(), 4u);
        EXPECT_THAT(mesh.colours, IsEmpty());
        std::string told;
        int count = 0;
        for (const std::string& note : notes)
            if (note.starts_with("the colours")) told = note, ++count;
        EXPECT_LE(count, 1) << "told once";
        return told;
    }
    const test::TemporaryFolder folder_;
};

TEST_F(Textured, AnObjHasTheColoursOfItsPicture) {
    const VertexColours colours = read().colours;
    ASSERT_EQ(colours.size(), 5u);
    EXPECT_THAT(std::vector(colours.begin(), colours.begin() + 4), ElementsAre(kRed, kGreen, kBlue, kGrey));
    // Between the pixels it is mixed, and beyond its edge is its next copy.
    write("t.obj", obj("vt 0.5 1\nvt 2.75 -0.25\nvt 0 0.5\nvt 0.5 0.5\n"));
    const VertexColours mixed = read().colours;
    ASSERT_EQ(mixed.size(), 5u);
    EXPECT_EQ(mixed[0], (Colour{128, 128, 0}));
    EXPECT_EQ(mixed[1], kGreen);
    EXPECT_EQ(mixed[2], (Colour{128, 0, 128}));
    EXPECT_EQ(mixed[3], (Colour{96, 96, 96}));
}

TEST_F(Textured, WhatIsNotThereIsToldOnceAndTheSurfaceIsRead) {
    std::filesystem::remove(folder_.path() / "upper jaw.png");
    EXPECT_THAT(leftOut(), HasSubstr("\"upper jaw.png\": it is not beside"));
    write("scan.mtl", "newmtl arch\nmap_Kd damaged.jpg\n");
    write("damaged.jpg", "");
    EXPECT_THAT(leftOut(), HasSubstr("this picture is damaged"));
    write("scan.mtl", "newmtl arch\nmap_Kd ../upper.png\n");
    EXPECT_THAT(leftOut(), HasSubstr("it is not beside"));
    write("scan.mtl", "newmtl arch\nmap_Kd /etc/passwd\n");
    EXPECT_THAT(leftOut(), HasSubstr("it is not beside"));
    write("t.obj", obj("vt 0 1\nvt 1 1\nvt 0 0\nvt 1 0\n", "../scan.mtl"));
    EXPECT_THAT(leftOut(), HasSubstr("it is not beside"));
    write("t.obj", obj("vt 0 1\nvt 1 1\nvt 0 0\nvt 1 0\n", "gone.mtl"));
    EXPECT_THAT(leftOut(), HasSubstr("gone.mtl"));
    write("scan.mtl", "newmtl arch\nKd 1 0 0\n");
    write("t.obj", obj());
    EXPECT_EQ(leftOut(), "") << "no picture, no colours, nothing to tell";
    ReadNotes notes;
    EXPECT_THAT(fromText(obj(), &notes).colours, IsEmpty());
    EXPECT_THAT(notes, testing::Contains(HasSubstr("beside the mesh"))) << "from memory there is no folder";
}

TEST_F(Textured, ALinkThatLeadsOutOfTheFolderIsNotFollowed) {
    namespace fs = std::filesystem;
    const test::TemporaryFolder elsewhere;
    for (const char* name : {"upper jaw.png", "scan.mtl"}) {
        fs::rename(folder_.path() / name, elsewhere.path() / name);
        fs::create_symlink(elsewhere.path() / name, folder_.path() / name);
        EXPECT_THAT(leftOut(),
                    testing::AllOf(HasSubstr(name), HasSubstr("a link that leads out of the mesh's folder")));
        fs::remove(folder_.path() / name);
        fs::rename(elsewhere.path() / name, folder_.path() / name);
    }
    fs::create_directory_symlink(elsewhere.path(), folder_.path() / "pictures");
    fs::rename(folder_.path() / "upper jaw.png", elsewhere.path() / "upper jaw.png");
    write("scan.mtl", "newmtl arch\nmap_Kd pictures/upper jaw.png\n");
    EXPECT_THAT(leftOut(), HasSubstr("leads out"));
    // One that stays within is a name like any other.
    fs::rename(elsewhere.path() / "upper jaw.png", folder_.path() / "of another name.png");
    fs::create_symlink("of another name.png", folder_.path() / "upper jaw.png");
    write("scan.mtl", "newmtl arch\nmap_Kd upper jaw.png\n");
    EXPECT_EQ(read().colours.size(), 5u);
}

TEST_F(Textured, PlacesThatAreNotThereAreToldAndTheSurfaceIsRead) {
    for (const char* corner : {"4/9", "4/-9", "4/x", "4/0", "4/99999999999"}) {
        write("t.obj", obj("vt 0 1\nvt 1 1\nvt 0 0\nvt 1 0\n", "scan.mtl", corner));
        EXPECT_THAT(leftOut(), HasSubstr("no place in their picture")) << corner;
    }
    write("t.obj", obj("vt 0 1\nvt nan 1\nvt 0 0\nvt 1 0\n"));
    EXPECT_THAT(leftOut(), HasSubstr("no place in their picture"));
    write("t.obj", obj("vt 0 1\nvt 1 1\nvt 0 0\nvt 1e300 0\n"));
    EXPECT_THAT(leftOut(), HasSubstr("no place in their picture"));
    write("t.obj",
          "mtllib scan.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nusemtl arch\nf 1/1 3/1 2/1\nf 1 2 4\n"
          "f 1/1 4 3/1\nf 2/1 3/1 4\n");
    EXPECT_THAT(leftOut(), HasSubstr("1 of 4 vertices have none"));
}

TEST_F(Textured, AProgramThatReadsNoPicturesSaysSo) {
    readPicturesWith({});
    EXPECT_THAT(leftOut(), HasSubstr("reads no pictures"));
}

VertexColours halves(const TriangleMesh& mesh) {
    VertexColours colours;
    for (const Vec3& v : mesh.vertices)
        colours.push_back(v.x() < 0.0 ? kRed : kGreen);
    return colours;
}

TEST(MeshColours, AreWrittenAndReadAgainToTheBit) {
    const test::TemporaryFolder folder;
    const TriangleMesh sphere = test::sphereMesh({0.1, 0.2, 0.3}, 5, 6);
    const VertexColours colours = halves(sphere);
    writeMesh(folder.path() / "a.ply", sphere, colours);
    const ColouredMesh read = readColouredMesh(folder.path() / "a.ply");
    EXPECT_EQ(read.colours, colours);
    EXPECT_EQ(read.mesh.vertices, sphere.vertices);
    EXPECT_EQ(read.mesh.triangles, sphere.triangles);
    EXPECT_EQ(readMesh(folder.path() / "a.ply").vertices, sphere.vertices);
    writeMesh(folder.path() / "a.stl", sphere, colours);
    EXPECT_THAT(readColouredMesh(folder.path() / "a.stl").colours, IsEmpty());
    VertexColours fewer = colours;
    fewer.pop_back();
    EXPECT_THAT(errorOf([&] { (void)plyBytes(sphere, fewer, "out"); }), HasSubstr("colours for"));
}

TEST(MeshColours, BetweenCornersTheyAreMixed) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    mesh.triangles = {{0, 1, 2}};
    const VertexColours colours{kRed, kGreen, kBlue};
    const TriangleTree tree(mesh);
    const auto at = [&](const Vec3& p) { return colourAt(mesh, tree, colours, tree.nearest(p)); };
    EXPECT_EQ(at({0, 0, 1}), kRed);
    EXPECT_EQ(at({9, -1, 0}), kGreen);
    EXPECT_EQ(at({2, 0, 0.5}), (Colour{128, 128, 0}));
    EXPECT_EQ(at({1, 1, 3}), (Colour{128, 64, 64}));
}

TEST(MeshColours, AMendedSurfaceKeepsThemAndAHoleGetsThoseOfItsBorder) {
    TriangleMesh open = test::sphereMesh({0, 0, 0}, 5, 12);
    std::erase_if(open.triangles, [&](const Triangle& t) {
        return (open.vertices[t[0]] + open.vertices[t[1]] + open.vertices[t[2]]).x() / 3.0 < -4.2;
    });
    const VertexColours colours = halves(open);
    // Each face with vertices of its own, as some scanners write: they are welded.
    TriangleMesh given = test::soup(open), mended = given;
    VertexColours givenColours;
    for (const Vec3& v : given.vertices)
        givenColours.push_back(v.x() < 0.0 ? kRed : kGreen);
    const RepairReport report = repair(mended);
    ASSERT_EQ(report.holes.size(), 1u);
    ASSERT_GT(report.addedFaces, 4u);
    ASSERT_LT(mended.vertices.size(), given.vertices.size());
    const VertexColours kept = coloursFrom(given, givenColours, mended);
    EXPECT_EQ(kept, halves(mended));
    EXPECT_THAT(coloursFrom(given, {}, mended), IsEmpty());
}

}  // namespace
}  // namespace handpiece::geometry::mesh_colours_test
