// SPDX-License-Identifier: Apache-2.0
// Polygons of strangers' files that are large, or made to be slow.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "handpiece/base/geometry/mesh_io.h"
#include "support/random.h"

namespace handpiece::geometry::polygons_test {
namespace {

using core::Vec3;
using testing::HasSubstr;
using testing::IsEmpty;
using Outline = std::vector<std::array<double, 2>>;

TriangleMesh cut(const Outline& outline, ReadNotes& notes) {
    std::string text, face = "f";
    for (std::size_t i = 0; i < outline.size(); ++i) {
        text += fmt::format("v {} {} 0\n", outline[i][0], outline[i][1]);
        face += fmt::format(" {}", i + 1);
    }
    text += face + "\n";
    return readMesh(std::as_bytes(std::span(text)), MeshFormat::obj, "memory", &notes);
}

double areaOf(const Outline& outline) {
    double twice = 0.0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const auto &a = outline[i], &b = outline[(i + 1) % outline.size()];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return 0.5 * twice;
}

/// Triangles that all go round as the outline does, have its area together and its edges, each inner edge once from
/// either side: they cover it, and nothing twice.
void expectCovered(const Outline& outline) {
    ReadNotes notes;
    const TriangleMesh mesh = cut(outline, notes);
    EXPECT_THAT(notes, IsEmpty());
    ASSERT_EQ(mesh.triangles.size(), outline.size() - 2);
    const double whole = areaOf(outline);
    double sum = 0.0, least = 0.0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const Triangle& t : mesh.triangles) {
        const double area = areaOf({outline[t[0]], outline[t[1]], outline[t[2]]});
        sum += area, least = std::min(least, area);
        for (std::size_t k = 0; k < 3; ++k)
            ++edges[{t[k], t[(k + 1) % 3]}];
    }
    EXPECT_NEAR(sum, whole, 1e-9 * whole);
    EXPECT_GE(least, -1e-12 * whole);
    std::size_t border = 0;
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        if (edges.count({edge.second, edge.first}) != 0) continue;
        EXPECT_EQ(edge.second, (edge.first + 1) % outline.size());
        ++border;
    }
    EXPECT_EQ(border, outline.size());
}

/// About a middle, its corners anywhere from near to far.
Outline star(std::size_t count, double least) {
    std::mt19937_64 generator(test::seed());
    Outline outline;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + test::uniform(generator, 0.0, 0.8)) /
                             static_cast<double>(count),
                     radius = test::uniform(generator, least, 1.0);
        outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return outline;
}

/// A corridor that winds inwards: nearly all corners of one wall are dents.
Outline spiral(std::size_t count) {
    Outline outline, back;
    const double turns = std::sqrt(static_cast<double>(count)) / 4.0;
    for (std::size_t i = 0; i < count / 2; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(count / 2),
                     angle = 2.0 * std::numbers::pi * turns * part;
        const double radius = 1.0 - 0.9 * part, width = 0.45 / turns;
        outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
        back.push_back({(radius - width) * std::cos(angle), (radius - width) * std::sin(angle)});
    }
    outline.insert(outline.end(), back.rbegin(), back.rend());
    return outline;
}

/// Teeth as long as the whole, side by side, along an axis or askew.
Outline comb(std::size_t teeth, double lean) {
    Outline outline{{0.0, -1.0}};
    for (std::size_t i = 0; i < teeth; ++i) {
        const double x = static_cast<double>(i) / static_cast<double>(teeth), width = 0.3 / static_cast<double>(teeth);
        outline.push_back({x, 0.0});
        outline.push_back({x + lean, 1.0});
        outline.push_back({x + lean + width, 1.0});
        outline.push_back({x + 2.0 * width, 0.0});
    }
    outline.push_back({1.0, -1.0});
    // It went round to the right.
    std::reverse(outline.begin(), outline.end());
    return outline;
}

TEST(Polygons, ThousandsOfCornersAreCoveredWithoutOverlap) {
    expectCovered(star(4000, 0.01));
    expectCovered(star(4000, 0.9));
    expectCovered(spiral(4000));
    expectCovered(comb(1000, 0.0));
    expectCovered(comb(1000, 0.7));
}

TEST(Polygons, AHundredThousandTakeNoLongerThanTheyShould) {
    expectCovered(star(100'000, 0.5));
    expectCovered(star(100'000, 0.999));
    expectCovered(spiral(100'000));
}

TEST(Polygons, WhatWouldTakeForEverIsLeftAFanAndTold) {
    const Outline outline = comb(60'000, 0.7);
    ReadNotes notes;
    EXPECT_EQ(cut(outline, notes).triangles.size(), outline.size() - 2);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_THAT(notes[0], HasSubstr("1 polygon is too intricate"));
}

TEST(Polygons, OneThatTouchesItselfHasItsArea) {
    // A frame: its hole hangs on the border by an edge that is there twice.
    const Outline frame{{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}};
    ReadNotes notes;
    const TriangleMesh mesh = cut(frame, notes);
    EXPECT_THAT(notes, IsEmpty());
    EXPECT_NEAR(surfaceAreaMm2(mesh), 72.0, 1e-12);
    // All in one place along an axis, or all but one corner.
    EXPECT_EQ(cut({{0, 0}, {1e-320, 1}, {0, 2}, {1e-321, 1}, {0, 0.5}}, notes).triangles.size(), 3u);
}

}  // namespace
}  // namespace handpiece::geometry::polygons_test
