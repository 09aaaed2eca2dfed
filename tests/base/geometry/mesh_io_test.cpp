// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/mesh_io.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <random>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/read_notes.h"
#include "support/random.h"

#define TINYOBJLOADER_IMPLEMENTATION
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

namespace handpiece::geometry::mesh_io_test {
namespace {

using core::Vec3;
using test::boxMesh;
using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

std::span<const std::byte> bytesOf(std::string_view text) {
    return std::as_bytes(std::span(text));
}

TriangleMesh fromText(std::string_view text, MeshFormat hint = MeshFormat::unknown, ReadNotes* notes = nullptr) {
    return readMesh(bytesOf(text), hint, "memory", notes);
}

// The message of the error that reading gives, or an empty string.
std::string errorOf(std::span<const std::byte> data, MeshFormat hint = MeshFormat::unknown) {
    try {
        (void)readMesh(data, hint, "memory");
    } catch (const core::Error& e) {
        return e.what();
    }
    return {};
}
std::string errorOf(std::string_view text, MeshFormat hint = MeshFormat::unknown) {
    return errorOf(bytesOf(text), hint);
}

template <class T>
void put(Bytes& data, std::size_t at, T value) {
    std::memcpy(data.data() + at, &value, sizeof value);
}

template <class T>
void append(Bytes& data, T value, bool bigEndian = false) {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof value);
    if (bigEndian) std::reverse(raw.begin(), raw.end());
    data.insert(data.end(), raw.begin(), raw.end());
}

// float32 coordinates, so that nothing is lost in an STL.
TriangleMesh floatSphere() {
    TriangleMesh mesh = test::sphereMesh({1, 2, 3}, 5, 6);
    for (Vec3& v : mesh.vertices)
        for (double& x : v)
            x = static_cast<double>(static_cast<float>(x));
    return mesh;
}

Bytes binaryStl(const TriangleMesh& mesh) {
    const test::TemporaryFolder folder;
    writeStl(folder.path() / "x.stl", mesh);
    return core::readFile(folder.path() / "x.stl");
}

std::string asciiStl(const TriangleMesh& mesh) {
    std::string text = "solid a name with facet in it\n";
    for (const Triangle& t : mesh.triangles) {
        text += " facet normal 0 0 0\n  outer loop\n";
        for (const std::uint32_t v : t)
            text += fmt::format("   vertex {} {:.17e} {}\n", mesh.vertices[v].x(), mesh.vertices[v].y(),
                                mesh.vertices[v].z());
        text += "  endloop\n endfacet\n";
    }
    return text + "endsolid a name with facet in it\n";
}

// The same faces, whatever the numbering of vertices.
void expectSameFaces(const TriangleMesh& a, const TriangleMesh& b) {
    ASSERT_EQ(a.triangles.size(), b.triangles.size());
    for (std::size_t f = 0; f < a.triangles.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_EQ(a.vertices[a.triangles[f][k]], b.vertices[b.triangles[f][k]]);
}

TEST(MeshIo, StlRoundTrip) {
    const TriangleMesh mesh = floatSphere();
    const test::TemporaryFolder folder;
    writeStl(folder.path() / "x.STL", mesh);
    const TriangleMesh back = readMesh(folder.path() / "x.STL");
    EXPECT_EQ(back.vertices.size(), mesh.vertices.size());
    expectSameFaces(mesh, back);
    EXPECT_EQ(core::readFile(folder.path() / "x.STL").size(), 84 + 50 * mesh.triangles.size());
}

TEST(MeshIo, VerticesAreNumberedByFirstAppearance) {
    const TriangleMesh mesh = readMesh(binaryStl(floatSphere()), MeshFormat::stl, "memory");
    std::uint32_t next = 0;
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) {
            EXPECT_LE(v, next);
            next = std::max(next, v + 1);
        }
    EXPECT_EQ(next, mesh.vertices.size());
}

TEST(MeshIo, PlyRoundTripLosesNothing) {
    const TriangleMesh mesh = test::sphereMesh({1.0 / 3, 2, 3}, 5, 6);
    const test::TemporaryFolder folder;
    writePly(folder.path() / "x.ply", mesh);
    const TriangleMesh back = readMesh(folder.path() / "x.ply");
    EXPECT_EQ(back.vertices, mesh.vertices);
    EXPECT_EQ(back.triangles, mesh.triangles);
}

TEST(MeshIo, AsciiStlEqualsBinary) {
    const TriangleMesh mesh = floatSphere();
    std::string text = asciiStl(mesh);
    expectSameFaces(fromText(text), mesh);
    EXPECT_EQ(fromText(text).vertices.size(), mesh.vertices.size());
    std::string windows;
    for (const char c : text)
        windows += c == '\n' ? "\r\n" : std::string(1, c == 'f' ? 'F' : c == 'v' ? 'V' : c);
    expectSameFaces(fromText(windows), mesh);
}

TEST(MeshIo, MinusZeroIsZero) {
    TriangleMesh mesh = test::boxMesh({0, 0, 0}, {1, 1, 1});
    for (std::size_t f = 0; f < mesh.triangles.size(); f += 2)
        for (std::uint32_t& v : mesh.triangles[f]) {
            mesh.vertices.push_back(mesh.vertices[v].unaryExpr([](double x) { return x == 0.0 ? -0.0 : x; }));
            v = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
        }
    EXPECT_EQ(readMesh(binaryStl(mesh), MeshFormat::stl, "memory").vertices.size(), 8u);
    EXPECT_EQ(fromText(asciiStl(mesh)).vertices.size(), 8u);
}

TEST(MeshIo, BinaryThatStartsWithSolid) {
    const TriangleMesh mesh = floatSphere();
    Bytes data = binaryStl(mesh);
    std::memcpy(data.data(), "solid facet normal", 18);
    expectSameFaces(readMesh(data, MeshFormat::unknown, "memory"), mesh);
    put(data, 80, std::uint32_t{7});  // and lies
    expectSameFaces(readMesh(data, MeshFormat::stl, "memory"), mesh);
}

TEST(MeshIo, TheLengthDecidesWhatTheHeaderLiesAbout) {
    const TriangleMesh mesh = floatSphere();
    for (const std::uint32_t lie : {0u, 7u, 1000000u, 0xffffffffu}) {
        Bytes data = binaryStl(mesh);
        put(data, 80, lie);
        ReadNotes notes;
        expectSameFaces(readMesh(data, MeshFormat::stl, "memory", &notes), mesh);
        ASSERT_EQ(notes.size(), 1u);
        EXPECT_THAT(notes[0], HasSubstr(fmt::format("says {} facets, the file holds {}", lie, mesh.triangles.size())));
    }
    Bytes trailing = binaryStl(mesh);
    trailing.resize(trailing.size() + 30);
    ReadNotes notes;
    expectSameFaces(readMesh(trailing, MeshFormat::stl, "memory", &notes), mesh);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_THAT(notes[0], HasSubstr("30 bytes"));
}

TEST(MeshIo, TruncatedFilesSayWhere) {
    Bytes data = binaryStl(floatSphere());
    put(data, 80, std::uint32_t{325312});
    data.resize(84 + 16 * 50 + 20);
    EXPECT_THAT(errorOf(data, MeshFormat::stl), HasSubstr("the file ends in the middle of facet 17 of 325312"));
    data.resize(60);
    EXPECT_THAT(errorOf(data, MeshFormat::stl), HasSubstr("header"));
    const std::string text = asciiStl(floatSphere());
    EXPECT_THAT(errorOf(text.substr(0, text.size() / 2)), HasSubstr("the file ends in the middle of facet"));
    EXPECT_THAT(errorOf("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
                        "z\nend_header\n0 0 0\n1 0"),
                HasSubstr("vertex 2 of 3"));
    EXPECT_THAT(errorOf("ply\nformat ascii 1.0\nelement vertex 3\n"), HasSubstr("header has no end"));
}

TEST(MeshIo, EmptyAndForeignFiles) {
    EXPECT_THAT(errorOf(""), HasSubstr("empty"));
    EXPECT_THAT(errorOf("", MeshFormat::stl), HasSubstr("empty"));
    EXPECT_THAT(errorOf("hello, this is a letter"), HasSubstr("no STL, PLY or OBJ"));
    EXPECT_THAT(errorOf("solid nothing\nendsolid nothing\n"), HasSubstr("no faces"));
    EXPECT_THAT(errorOf("v 1 2 3\n"), HasSubstr("no faces"));
    EXPECT_THAT(errorOf("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n"),
                HasSubstr("\"zero\" in facet 1 is not a number"));
    EXPECT_THAT(errorOf(Bytes(84), MeshFormat::stl), HasSubstr("no faces"));
    EXPECT_THROW((void)readMesh(std::filesystem::path("/nowhere/x.stl")), core::Error);
}

/// A file that is often saved under a mesh's name, and what is said of it: what it is, and what to do.
struct Foreign {
    std::string bytes;
    const char *what, *remedy;
};

TEST(MeshIo, FilesOfOtherKindsAreNamed) {
    const std::string ascii = asciiStl(floatSphere());
    std::string little("\xff\xfe"), big, bare;
    for (const char c : ascii) {
        little += std::string{c, '\0'};
        big += std::string{'\0', c};
        bare += std::string{c, '\0'};
    }
    const std::string zip = std::string("PK\x03\x04\x14\0\0\0", 8) + std::string(200, '\0');
    const Foreign kinds[] = {
        {"<!DOCTYPE html>\n<html><head><title>404</title></head><body>Not found</body></html>\n", "web page (HTML)",
         "download the mesh"},
        {"\r\n  <HTML><BODY>Please log in" + std::string(400, ' '), "web page (HTML)", "download the mesh"},
        {"\xef\xbb\xbf<!doctype HTML>" + std::string(400, ' '), "web page (HTML)", "download the mesh"},
        {"<?xml version=\"1.0\"?><model unit=\"millimeter\"/>", "XML", "export STL"},
        {"{\"message\": \"Not Found\"}", "JSON", "download"},
        {little, "UTF-16", "binary STL"},
        {big, "UTF-16", "binary STL"},
        {bare, "UTF-16", "binary STL"},
        {"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 132735\n", "Git LFS", "git lfs pull"},
        {zip, "zip archive", "unpack"},
        {std::string("\x1f\x8b\x08\0", 4) + std::string(200, 'x'), "gzip", "unpack"},
        {"%PDF-1.7\n" + std::string(200, 'x'), "PDF", "mesh itself"},
        {"ISO-10303-21;\nHEADER;\n" + std::string(200, 'x'), "STEP", "export STL"},
        {std::string(128, '\0') + "DICM" + std::string(200, '\0'), "DICOM", "handpiece scan"},
        {"Dear Sir, this is the tooth that I told you of." + std::string(100, '.'), "text that begins with \"Dear\"",
         "export"},
    };
    for (const Foreign& kind : kinds) {
        SCOPED_TRACE(kind.what);
        for (const MeshFormat hint : {MeshFormat::stl, MeshFormat::unknown}) {
            if (hint == MeshFormat::unknown && kind.bytes.starts_with("Dear")) continue;
            const std::string told = errorOf(kind.bytes, hint);
            EXPECT_THAT(told, HasSubstr("memory: this is "));
            EXPECT_THAT(told, HasSubstr(kind.what));
            EXPECT_THAT(told, HasSubstr(kind.remedy));
        }
    }
    EXPECT_THAT(errorOf("", MeshFormat::stl), HasSubstr("export or download"));
    // A binary file's header may say anything.
    for (const char* header : {"solid made by some program", "PK\x03\x04", "<html>", "{", "%PDF-1.4"}) {
        Bytes data = binaryStl(floatSphere());
        std::memset(data.data(), ' ', 80);
        std::memcpy(data.data(), header, std::strlen(header));
        expectSameFaces(readMesh(data, MeshFormat::stl, "memory"), floatSphere());
    }
    // "solid", and a count that lies.
    Bytes data = binaryStl(floatSphere());
    std::memset(data.data(), ' ', 80);
    std::memcpy(data.data(), "solid x", 7);
    put(data, 80, std::uint32_t{7});
    EXPECT_EQ(errorOf(data, MeshFormat::stl), "");
}

TEST(MeshIo, WordsOfAsciiStl) {
    const TriangleMesh mesh = floatSphere();
    const std::string text = asciiStl(mesh);
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        for (std::size_t at = changed.find(from); at != std::string::npos; at = changed.find(from, at + to.size()))
            changed.replace(at, from.size(), to);
        return changed;
    };
    for (const auto& [from, to] : {std::pair{"endfacet", "end facet"},
                                   {"endfacet", "END  FACET"},
                                   {"endloop", "end loop"},
                                   {"endsolid", "end solid"}}) {
        ReadNotes notes;
        expectSameFaces(fromText(with(from, to), MeshFormat::stl, &notes), mesh);
        EXPECT_THAT(notes, testing::IsEmpty());
    }
    EXPECT_THAT(errorOf(with("endfacet", "endfcaet")), HasSubstr("facet 1 has no \"endfacet\": \"endfcaet\" stands"));
    EXPECT_THAT(errorOf(with("endfacet", "")), HasSubstr("facet 1 has no \"endfacet\""));
    const std::string split = with("endfacet", "end facet");
    EXPECT_THAT(errorOf(split.substr(0, split.find("end facet") + 3)),
                HasSubstr("the file ends in the middle of facet 1"));
}

TEST(MeshIo, WhatIsLeftOutIsTold) {
    const TriangleMesh mesh = floatSphere();
    Bytes glued = binaryStl(mesh);
    const Bytes second = binaryStl(boxMesh({0, 0, 0}, {1, 2, 3}));
    for (int files = 2; files < 4; ++files) {
        glued.insert(glued.end(), second.begin(), second.end());
        ReadNotes notes;
        expectSameFaces(readMesh(glued, MeshFormat::stl, "memory", &notes), mesh);
        ASSERT_EQ(notes.size(), 1u);
        EXPECT_THAT(notes[0],
                    HasSubstr(fmt::format("only the first of {} STL files in one is read, with {} facets: the {} "
                                          "facets after it are left out",
                                          files, mesh.triangles.size(), 12 * (files - 1))));
    }
    ReadNotes notes;
    (void)fromText("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 1 4\nl 1 2\np 3\nsurf 0 1 0 1 1 2 3 4\n",
                   MeshFormat::obj, &notes);
    EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("2 elements of points or lines are left out"),
                                            HasSubstr("1 free-form curve or surface is left out"),
                                            HasSubstr("1 of 2 faces has two corners in one place")));
    notes.clear();
    (void)fromText(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
        "3 0 1 2\n2 0 1\n",
        MeshFormat::ply, &notes);
    EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("1 face has fewer than three corners")));
}

TEST(MeshIo, WhoListensHearsWhatNobodyAskedFor) {
    Bytes trailing = binaryStl(floatSphere());
    trailing.resize(trailing.size() + 30);
    std::vector<std::string> heard;
    listenToNotes([&](const std::string& where, const std::string& note) { heard.push_back(where + ": " + note); });
    (void)readMesh(trailing, MeshFormat::stl, "memory");
    EXPECT_THAT(heard, testing::ElementsAre("memory: 30 bytes after the last facet are left out"));
    ReadNotes notes;
    (void)readMesh(trailing, MeshFormat::stl, "memory", &notes);
    EXPECT_EQ(notes.size(), 1u);
    EXPECT_EQ(heard.size(), 1u) << "told to who asked";
    listenToNotes({});
    (void)readMesh(trailing, MeshFormat::stl, "memory");
    EXPECT_EQ(heard.size(), 1u);
}

TEST(MeshIo, CoordinatesMustBeFinite) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 2e30f}) {
        Bytes data = binaryStl(floatSphere());
        put(data, 84 + 50 * 4 + 12 + 8, bad);
        put(data, 84 + 50 * 9 + 12 + 32, bad);
        EXPECT_THAT(errorOf(data), HasSubstr("2 facets are not finite (or beyond 1e30), the first is facet 5"));
    }
    EXPECT_THAT(errorOf("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\nvertex 1 0 0\nvertex 0 1 "
                        "0\nendloop\nendfacet\nendsolid\n"),
                HasSubstr("1 facet is not finite"));
    EXPECT_THAT(errorOf("v 0 0 0\nv 1 0 inf\nv 0 1 0\nf 1 2 3\n"), HasSubstr("vertex 2"));
    EXPECT_THAT(errorOf("v 0 0 0\nv 1 0 1e999\nv 0 1 0\nf 1 2 3\n"), HasSubstr("vertex 2"));
    EXPECT_EQ(fromText("v 0 0 0\nv 1 0 1e-999\nv 0 1 0\nf 1 2 3\n").vertices[1], Vec3(1, 0, 0));
}

TEST(MeshIo, PlyAsciiWithExtrasAndPolygons) {
    const TriangleMesh mesh = fromText(
        "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement camera 1\r\nproperty float fov\r\nproperty list "
        "uchar int ids\r\n"
        "element vertex 5\r\nproperty uchar red\r\nproperty double z\r\nproperty double y\r\nproperty double x\r\n"
        "element face 2\r\nproperty uchar flags\r\nproperty list uchar int vertex_indices\r\nproperty list uchar float "
        "texcoord\r\n"
        "end_header\r\n60 2 7 8\r\n255 0 0 0\r\n255 0 0 1\r\n255 0 1 1\r\n255 0 1 0\r\n9 5 .5 +.5\r\n"
        "1 4 0 1 2 3 2 0.5 0.5\r\n0 3 0 1 4 0\r\n");
    ASSERT_EQ(mesh.vertices.size(), 5u);
    EXPECT_EQ(mesh.vertices[4], Vec3(0.5, 0.5, 5));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 1, 4}}));
}

TEST(MeshIo, PlyBinaryOfBothEnds) {
    for (const bool big : {false, true}) {
        const std::string header = fmt::format(
            "ply\nformat binary_{}_endian 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty short "
            "z\nproperty uchar grey\n"
            "element face 2\nproperty list ushort uint vertex_index\nproperty int id\nend_header\n",
            big ? "big" : "little");
        Bytes data(bytesOf(header).begin(), bytesOf(header).end());
        for (int v = 0; v < 4; ++v) {
            append(data, static_cast<float>(v), big);
            append(data, v * 0.1, big);
            append(data, static_cast<std::int16_t>(-300 * v), big);
            append(data, std::uint8_t{200}, big);
        }
        for (const auto& corners : {std::vector<std::uint32_t>{0, 1, 2, 3}, std::vector<std::uint32_t>{3, 1, 0}}) {
            append(data, static_cast<std::uint16_t>(corners.size()), big);
            for (const std::uint32_t c : corners)
                append(data, c, big);
            append(data, std::int32_t{-1}, big);
        }
        const TriangleMesh mesh = readMesh(data, MeshFormat::unknown, "memory");
        EXPECT_EQ(mesh.vertices[3], Vec3(3, 0.1 * 3, -900));
        EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {3, 1, 0}}));
        for (std::size_t cut = 0; cut < data.size(); ++cut)
            EXPECT_FALSE(errorOf(std::span(data).first(cut)).empty()) << cut;
    }
}

TEST(MeshIo, PlyThatLies) {
    const std::string vertices = "property float x\nproperty float y\nproperty float z\n";
    // Counts far beyond the file must neither be allocated nor waited for.
    for (const std::string count : {"4000000000", "18446744073709551615", "99999999999999999999", "-3"})
        for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
            EXPECT_FALSE(errorOf("ply\nformat " + format + " 1.0\nelement vertex " + count + "\n" + vertices +
                                 "end_header\n0 0 0\n")
                             .empty());
            EXPECT_FALSE(errorOf("ply\nformat " + format + " 1.0\nelement ghost " + count + "\nelement vertex 0\n" +
                                 vertices + "element face " + count +
                                 "\nproperty list int int vertex_indices\nend_header\n")
                             .empty());
        }
    const std::string good = "ply\nformat ascii 1.0\nelement vertex 3\n" + vertices +
                             "element face 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_EQ(fromText(good + "3 0 1 2\n").triangles.size(), 1u);
    EXPECT_THAT(errorOf(good + "3 0 1 3\n"), HasSubstr("face 1 names vertex 4 of 3"));
    EXPECT_THAT(errorOf(good + "3 0 1 -1\n"), HasSubstr("names vertex -1"));
    EXPECT_THAT(errorOf(good + "-3 0 1 2\n"), HasSubstr("list of -3"));
    EXPECT_THAT(errorOf(good + "4000000000 0 1 2\n"), HasSubstr("face 1 of 1"));
    EXPECT_THAT(errorOf(good + "2 0 1\n"), HasSubstr("no faces"));
    EXPECT_THAT(errorOf("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
                HasSubstr("no x, y and z"));
    EXPECT_THAT(errorOf("ply\nelement vertex 1\nproperty float x\nend_header\n1\n"), HasSubstr("no format"));
    EXPECT_THAT(errorOf("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n"),
                HasSubstr("\"quad\""));
}

TEST(MeshIo, ObjEqualsTinyobjloader) {
    const std::string text =
        "# a comment\nmtllib none.mtl\no thing\nv 0 0 0 1 0 0\nv 1.5 0 0\nv 1 1e0 -.25\nv 0 +1 0 1.0\nvn 0 0 1\nvt 0 "
        "0\n"
        "usemtl red\ns off\nf 1/1/1 2/1/1 3/1/1\nf 1//1 3//1 4//1\nv 0.5 0.5 2\nf -1 -5 -4\nf 2 3 5\n";
    const TriangleMesh mesh = fromText(text);
    std::istringstream stream(text);
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::string warning, error;
    ASSERT_TRUE(tinyobj::LoadObj(&attributes, &shapes, nullptr, &warning, &error, &stream, nullptr, true)) << error;
    ASSERT_EQ(attributes.vertices.size(), 3 * mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_DOUBLE_EQ(mesh.vertices[v][static_cast<Eigen::Index>(k)],
                             static_cast<double>(attributes.vertices[3 * v + k]));
    std::vector<Triangle> triangles;
    for (const tinyobj::shape_t& shape : shapes)
        for (std::size_t i = 0; i + 2 < shape.mesh.indices.size(); i += 3)
            triangles.push_back({static_cast<std::uint32_t>(shape.mesh.indices[i].vertex_index),
                                 static_cast<std::uint32_t>(shape.mesh.indices[i + 1].vertex_index),
                                 static_cast<std::uint32_t>(shape.mesh.indices[i + 2].vertex_index)});
    EXPECT_EQ(mesh.triangles, triangles);
}

TEST(MeshIo, ObjPolygonsContinuationsAndErrors) {
    const std::string square = "v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\r";
    EXPECT_EQ(fromText(square + "f 1 2 \\\r\n 3 4\r\n").triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_THAT(errorOf(square + "f 1 2 5\n"), HasSubstr("line 5 names vertex 5 of 4"));
    EXPECT_THAT(errorOf(square + "f 1 2 -5\n"), HasSubstr("line 5 names vertex -5"));
    EXPECT_THAT(errorOf(square + "f 1 2 0\n"), HasSubstr("\"0\" in line 5"));
    EXPECT_THAT(errorOf(square + "f 1 2 x\n"), HasSubstr("\"x\" in line 5"));
    EXPECT_THAT(errorOf(square + "f 1 2 99999999999999999999\n"), HasSubstr("line 5"));
    EXPECT_THAT(errorOf("v 1 2\n", MeshFormat::obj), HasSubstr("fewer than three"));
}

/// An L of hexagonal ends, from whichever corner they begin.
std::string lBlock(std::size_t first, bool isPly) {
    const std::vector<std::pair<int, int>> outline{{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 9}, {0, 9}};
    std::vector<std::vector<int>> faces(2);
    for (std::size_t i = 0; i < 6; ++i) {
        faces[0].push_back(static_cast<int>((first + 6 - i) % 6));
        faces[1].push_back(static_cast<int>((first + i) % 6 + 6));
        const int a = static_cast<int>(i), b = static_cast<int>((i + 1) % 6);
        faces.push_back({a, b, b + 6, a + 6});
    }
    std::string text = isPly ? "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nproperty float y\nproperty "
                               "float z\nelement face 8\nproperty list uchar int vertex_indices\nend_header\n"
                             : "";
    for (const int z : {0, 3})
        for (const auto& [x, y] : outline)
            text += fmt::format("{}{} {} {}\n", isPly ? "" : "v ", x, y, z);
    for (const std::vector<int>& face : faces) {
        text += isPly ? std::to_string(face.size()) : "f";
        for (const int corner : face)
            text += fmt::format(" {}", isPly ? corner : corner + 1);
        text += "\n";
    }
    return text;
}

TEST(MeshIo, AConcavePolygonIsNoFan) {
    for (std::size_t first = 0; first < 6; ++first)
        for (const bool isPly : {false, true}) {
            const TriangleMesh mesh = fromText(lBlock(first, isPly));
            const MeshReport report = inspect(mesh);
            EXPECT_NEAR(report.areaMm2, 142.0, 1e-9) << first;
            EXPECT_NEAR(report.volumeMm3, 78.0, 1e-9) << first;
            EXPECT_EQ(report.openEdges, 0u) << first;
            EXPECT_EQ(mesh.triangles.size(), 20u);
        }
}

// Round polygons with dents of any depth: as much area as the outline has, each triangle turned as it is, each edge of
// the outline an edge of one triangle.
TEST(MeshIo, EveryOutlineIsCoveredByItsTriangles) {
    std::mt19937_64 random(test::seed());
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int round = 0; round < 300; ++round) {
        const int count = 4 + static_cast<int>(random() % 60);
        const bool isTurned = round % 2 == 1;
        std::string text;
        std::vector<Vec3> points;
        for (int i = 0; i < count; ++i) {
            const double angle = (isTurned ? -2.0 : 2.0) * M_PI * (i + 0.8 * unit(random)) / count,
                         radius = 0.05 + 4.0 * unit(random) * unit(random);
            // In a plane that stands askew.
            const double u = radius * std::cos(angle), v = radius * std::sin(angle);
            points.emplace_back(0.6 * u, v, 0.8 * u + 0.1 * v);
            text += fmt::format("v {} {} {}\n", points.back().x(), points.back().y(), points.back().z());
        }
        text += "f";
        Vec3 whole = Vec3::Zero();
        for (int i = 0; i < count; ++i) {
            text += fmt::format(" {}", i + 1);
            whole += 0.5 * points[static_cast<std::size_t>(i)].cross(points[static_cast<std::size_t>((i + 1) % count)]);
        }
        ReadNotes notes;
        const TriangleMesh mesh = fromText(text + "\n", MeshFormat::obj, &notes);
        EXPECT_THAT(notes, testing::IsEmpty());
        ASSERT_EQ(mesh.triangles.size(), static_cast<std::size_t>(count) - 2);
        double sum = 0.0;
        std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
        for (const Triangle& t : mesh.triangles) {
            const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
            const Vec3 own = 0.5 * (b - a).cross(c - a);
            EXPECT_GE(own.dot(whole), -1e-9 * whole.squaredNorm()) << round;
            sum += own.norm();
            for (std::size_t k = 0; k < 3; ++k)
                ++edges[{t[k], t[(k + 1) % 3]}];
        }
        EXPECT_NEAR(sum, whole.norm(), 1e-9 * whole.norm()) << round << ", seed " << test::seed();
        for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i)
            EXPECT_EQ((edges[{i, (i + 1) % static_cast<std::uint32_t>(count)}]), 1) << round;
    }
    // One that crosses itself is told.
    ReadNotes notes;
    (void)fromText("v 0 0 0\nv 4 0 0\nv 0 3 0\nv 4 2 0\nv 2 -2 0\nf 1 2 3 4 5\n", MeshFormat::obj, &notes);
    EXPECT_THAT(notes, testing::Contains(HasSubstr("crosses itself")));
}

TEST(MeshIo, TextCutShortIsRefusedOrTold) {
    const TriangleMesh mesh = floatSphere();
    std::string plain, slashed;
    for (const Vec3& v : mesh.vertices)
        plain += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
    slashed = plain + "vn 0 0 1\n";
    for (const Triangle& t : mesh.triangles) {
        plain += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
        slashed += fmt::format("f {}//1 {}//1 {}//1\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    const std::string ply = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
        "1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0.25\n3 0 1 2\n");
    for (const std::string& text : {plain, slashed, asciiStl(mesh), ply})
        for (std::size_t cut = 1; cut<text.size(); cut += text.size()> 1000 && cut + 200 < text.size() ? 7 : 1) {
            if (text[cut - 1] == '\n' && text[0] == 'v') continue;  // between two lines nobody can tell
            ReadNotes notes;
            try {
                const TriangleMesh read = fromText(text.substr(0, cut), MeshFormat::unknown, &notes);
                // What is whole but for its last end of line, or the name after "endsolid", may pass.
                if (notes.empty()) {
                    ASSERT_EQ(read.triangles.size(), mesh.triangles.size()) << text.substr(0, 5) << cut;
                }
            } catch (const core::Error&) {
            }
        }
    const std::size_t half = plain.find('\n', plain.find("f ") + 500);
    EXPECT_THAT(errorOf(plain.substr(0, half - 1)), HasSubstr("the file ends in the middle of line"));
    EXPECT_THAT(errorOf(plain.substr(0, half - 7)), HasSubstr("the file ends in the middle of line"));
    ReadNotes notes;
    EXPECT_NO_THROW((void)fromText(plain.substr(0, half + 1), MeshFormat::obj, &notes));
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_THAT(notes[0], HasSubstr("vertices are in no face"));
    EXPECT_THAT(errorOf("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n"),
                HasSubstr("line 5 has fewer than three corners"));
    const std::string stl = asciiStl(mesh);
    EXPECT_THAT(errorOf(stl.substr(0, stl.rfind("endsolid"))), HasSubstr("without \"endsolid\""));
}

TEST(MeshIo, ByteOrderMarksAreSkipped) {
    const std::string mark = "\xef\xbb\xbf", square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
    EXPECT_EQ(fromText(mark + square, MeshFormat::obj).vertices.size(), 3u);
    EXPECT_EQ(fromText(mark + asciiStl(floatSphere())).triangles.size(), floatSphere().triangles.size());
    EXPECT_THAT(errorOf(mark), HasSubstr("empty"));
}

TEST(MeshIo, ContentBeatsTheName) {
    const test::TemporaryFolder folder;
    const TriangleMesh mesh = floatSphere();
    writePly(folder.path() / "x.ply", mesh);
    std::filesystem::rename(folder.path() / "x.ply", folder.path() / "x.stl");
    ReadNotes notes;
    expectSameFaces(readMesh(folder.path() / "x.stl", &notes), mesh);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_EQ(notes[0], "named like STL, but its content is PLY");
}

TEST(MeshIo, WritersRefuseAndLeaveTheOldFile) {
    const test::TemporaryFolder folder;
    const TriangleMesh mesh = floatSphere();
    writeMesh(folder.path() / "x.stl", mesh);
    TriangleMesh bad = mesh;
    bad.triangles[0][0] = 1000000;
    EXPECT_THROW(writeMesh(folder.path() / "x.stl", bad), core::Error);
    bad = mesh;
    bad.vertices[3].x() = std::nan("");
    EXPECT_THROW(writeMesh(folder.path() / "x.stl", bad), core::Error);
    expectSameFaces(readMesh(folder.path() / "x.stl"), mesh);
    EXPECT_THROW(writeMesh(folder.path() / "x.obj", mesh), core::Error);
    EXPECT_THROW(writeMesh(folder.path() / "missing" / "x.stl", mesh), core::Error);
}

// What the fuzzers have found or started from, and every file cut off and bent: an error or a mesh, never anything
// else.
TEST(MeshIo, FuzzCorpusAndItsMutationsAreReadOrRefused) {
    std::mt19937_64 generator(test::seed());
    std::size_t files = 0, meshes = 0, refused = 0;
    const auto read = [&](std::span<const std::byte> data, MeshFormat hint) {
        try {
            const TriangleMesh mesh = readMesh(data, hint, "memory");
            requireValidIndices(mesh, "memory");
            EXPECT_FALSE(mesh.triangles.empty());
            ++meshes;
        } catch (const core::Error&) {
            ++refused;
        }
    };
    for (const auto& [name, hint] :
         {std::pair("stl", MeshFormat::stl), std::pair("ply", MeshFormat::ply), std::pair("obj", MeshFormat::obj)}) {
        std::vector<std::filesystem::path> paths;
        for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(HANDPIECE_SOURCE_DIR) /
                                                                     "tests/fuzz/corpus" / name))
            paths.push_back(entry.path());
        std::sort(paths.begin(), paths.end());
        for (const std::filesystem::path& path : paths) {
            ++files;
            const Bytes data = core::readFile(path);
            read(data, hint);
            read(data, MeshFormat::unknown);
            for (int i = 0; i < 60 && !data.empty(); ++i) {
                const auto at = [&] { return static_cast<std::size_t>(generator() % data.size()); };
                read(std::span(data).first(at()), hint);
                Bytes bent = data;
                for (std::uint64_t k = generator() % 4; k < 4; ++k)
                    bent[at()] = static_cast<std::byte>(generator());
                if (bent.size() > 84 && hint == MeshFormat::stl) put(bent, 80, static_cast<std::uint32_t>(generator()));
                read(bent, hint);
            }
        }
    }
    EXPECT_GT(files, 10u);
    EXPECT_GT(meshes, 10u);
    EXPECT_GT(refused, 10u);
}

TEST(MeshIo, RealToolsAreRead) {
    const std::filesystem::path data = test::realDataFolder();
    if (data.empty()) GTEST_SKIP() << "no real data beside the checkout";
    const TriangleMesh bur = readMesh(data / "tools" / "tapered_bur.stl");
    EXPECT_EQ(bur.vertices.size(), 1562u);
    EXPECT_EQ(bur.triangles.size(), 3120u);
}

}  // namespace
}  // namespace handpiece::geometry::mesh_io_test
