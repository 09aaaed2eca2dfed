// SPDX-License-Identifier: Apache-2.0
// Files that hold more than what is read of them: glued behind one another, or with a header that counts too few.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "base/geometry/meshes.h"
#include "handpiece/base/geometry/mesh_io.h"

namespace handpiece::geometry::mesh_glued_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Read {
    TriangleMesh mesh;
    ReadNotes notes;
};

Read readText(const std::string& text, MeshFormat hint) {
    Read read;
    read.mesh = readMesh(std::as_bytes(std::span(text)), hint, "memory", &read.notes);
    return read;
}

std::string textOf(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TriangleMesh box() {
    return test::boxMesh({0, 0, 0}, {1, 2, 3});
}

std::string asciiPly(const TriangleMesh& mesh, std::size_t facesInHeader) {
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.vertices.size(), facesInHeader);
    for (const core::Vec3& v : mesh.vertices)
        text += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
    for (const Triangle& t : mesh.triangles)
        text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
    return text;
}

std::string objOf(const TriangleMesh& mesh, std::size_t verticesBefore = 0) {
    std::string text = "# exported\n";
    for (const core::Vec3& v : mesh.vertices)
        text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
    for (const Triangle& t : mesh.triangles)
        text += fmt::format("f {} {} {}\n", t[0] + 1 + verticesBefore, t[1] + 1 + verticesBefore,
                            t[2] + 1 + verticesBefore);
    return text;
}

TEST(GluedMeshes, OfSeveralPlysTheFirstIsReadAndTheRestTold) {
    for (const std::string& one : {asciiPly(box(), 12), textOf(plyBytes(box(), {}, "memory"))}) {
        const Read read = readText(one + one, MeshFormat::ply);
        EXPECT_EQ(read.mesh.triangles, box().triangles);
        EXPECT_THAT(read.notes, ElementsAre(testing::AllOf(HasSubstr("several PLY files were glued into one"),
                                                           HasSubstr(fmt::format("the {} bytes after", one.size())))));
    }
}

TEST(GluedMeshes, WhatAPlysHeaderDoesNotCountIsTold) {
    const std::string binary = textOf(plyBytes(box(), {}, "memory"));
    EXPECT_THAT(readText(binary + std::string(1000, 'x'), MeshFormat::ply).notes,
                ElementsAre(HasSubstr("1000 bytes after the 8 vertices and 12 faces that the header counts")));
    const Read half = readText(asciiPly(box(), 6), MeshFormat::ply);
    EXPECT_EQ(half.mesh.triangles.size(), 6u);
    EXPECT_THAT(half.notes, ElementsAre(HasSubstr("after the 8 vertices and 6 faces that the header counts")));
}

TEST(GluedMeshes, EndsOfLinesAndPaddingOfAPlySayNothing) {
    const std::string text = asciiPly(box(), 12), binary = textOf(plyBytes(box(), {}, "memory"));
    for (const std::string& spare : {std::string("\n"), std::string("\r\n"), std::string(512, '\0')}) {
        EXPECT_THAT(readText(text + spare, MeshFormat::ply).notes, IsEmpty());
        EXPECT_THAT(readText(binary + spare, MeshFormat::ply).notes, IsEmpty());
    }
    EXPECT_THAT(readText(text.substr(0, text.size() - 1), MeshFormat::ply).notes,
                ElementsAre(HasSubstr("the last line has no end")));
}

TEST(GluedMeshes, OfSeveralObjsTheFirstIsReadAndTheRestTold) {
    const TriangleMesh sphere = test::sphereMesh({9, 9, 9}, 2, 4);
    // The second file has as many vertices, more and fewer than the first.
    for (const auto& [first, second] : {std::pair(box(), box()), std::pair(box(), sphere), std::pair(sphere, box())}) {
        const Read read = readText(objOf(first) + objOf(second), MeshFormat::obj);
        EXPECT_EQ(read.mesh.vertices.size(), first.vertices.size());
        EXPECT_EQ(read.mesh.triangles, first.triangles);
        const std::size_t line = 3 + first.vertices.size() + first.triangles.size();
        EXPECT_THAT(read.notes, ElementsAre(HasSubstr(fmt::format(
                                    "2 files were glued into one: from line {} on the faces count their vertices from "
                                    "1 again; only the first is read, with {} faces",
                                    line, first.triangles.size()))));
    }
    EXPECT_THAT(readText(objOf(box()) + objOf(sphere) + objOf(box()), MeshFormat::obj).notes,
                ElementsAre(HasSubstr("3 files were glued into one")));
}

TEST(GluedMeshes, AnObjOfSeveralObjectsIsOneFile) {
    const TriangleMesh sphere = test::sphereMesh({9, 9, 9}, 2, 4);
    const Read both = readText(objOf(box()) + objOf(sphere, 8), MeshFormat::obj);
    EXPECT_EQ(both.mesh.triangles.size(), 12 + sphere.triangles.size());
    EXPECT_THAT(both.notes, IsEmpty());
    // Each face after the vertex that it needs, and one that names the first again.
    const Read strip =
        readText("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 1 1 0\nf 3 2 4\nv 0 0 1\nf 1 3 5\n", MeshFormat::obj);
    EXPECT_EQ(strip.mesh.triangles.size(), 3u);
    EXPECT_THAT(strip.notes, IsEmpty());
}

// 25 headers are as long as 42 facets.
TEST(GluedMeshes, TwentySixStlsAreNoWrongCount) {
    const std::vector<std::byte> one = stlBytes(box(), "memory");
    for (const std::size_t files : {25, 26, 27, 51}) {
        std::string all;
        for (std::size_t i = 0; i < files; ++i)
            all += textOf(one);
        const Read read = readText(all, MeshFormat::stl);
        EXPECT_EQ(read.mesh.triangles.size(), 12u);
        EXPECT_THAT(read.notes, ElementsAre(HasSubstr(fmt::format("the first of {} STL files in one", files))));
    }
    // A count that is wrong is no second file.
    std::string wrong = textOf(one);
    const std::uint32_t few = 3;
    std::memcpy(wrong.data() + 80, &few, 4);
    EXPECT_THAT(readText(wrong, MeshFormat::stl).notes,
                ElementsAre(HasSubstr("the header says 3 facets, the file holds 12")));
}

}  // namespace
}  // namespace handpiece::geometry::mesh_glued_test
