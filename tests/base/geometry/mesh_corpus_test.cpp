// SPDX-License-Identifier: Apache-2.0
// Meshes as other programs write them: a prism over a random star-shaped polygon, whose area and volume are known, in
// STL, PLY and OBJ with every oddity that public reports tell of, drawn at random. It comes in right; a damaged one
// comes in right or says so.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "support/dice.h"
#include "support/random.h"

namespace handpiece::geometry::mesh_corpus_test {
namespace {

using core::Vec2;
using core::Vec3;
using Polygon = std::vector<std::uint32_t>;

struct Prism {
    std::vector<Vec3> vertices;  ///< the lower polygon, the upper one, the two middles
    std::vector<Polygon> polygons, triangles;
    double areaMm2 = 0.0, volumeMm3 = 0.0;
};

/// Coordinates are eighths: text and float32 hold them exactly.
Prism prism(test::Dice& dice) {
    const auto eighths = [](double v) { return std::round(8.0 * v) / 8.0; };
    const auto corners = static_cast<std::uint32_t>(5 + dice.upTo(9));
    const Vec3 middle(eighths(dice.between(-30, 30)), eighths(dice.between(-30, 30)), eighths(dice.between(-30, 30)));
    const double height = eighths(dice.between(3, 9));
    Prism p;
    std::vector<Vec2> ring;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / corners, radius = dice.between(3, 9);
        ring.emplace_back(eighths(radius * std::cos(angle)), eighths(radius * std::sin(angle)));
    }
    for (const double z : {0.0, height})
        for (const Vec2& v : ring)
            p.vertices.push_back(middle + Vec3(v.x(), v.y(), z));
    p.vertices.push_back(middle);
    p.vertices.push_back(middle + Vec3(0, 0, height));
    Polygon below, above;
    for (std::uint32_t i = 0; i < corners; ++i) {
        const std::uint32_t next = (i + 1) % corners;
        const Vec2 &a = ring[i], &b = ring[next];
        const double twice = a.x() * b.y() - a.y() * b.x();
        p.areaMm2 += twice + (b - a).norm() * height;
        p.volumeMm3 += 0.5 * twice * height;
        below.push_back(corners - 1 - i);
        above.push_back(corners + i);
        p.polygons.push_back({i, next, corners + next, corners + i});
        p.triangles.push_back({i, next, corners + next});
        p.triangles.push_back({i, corners + next, corners + i});
        p.triangles.push_back({next, i, 2 * corners});
        p.triangles.push_back({corners + i, corners + next, 2 * corners + 1});
    }
    p.polygons.push_back(below);
    p.polygons.push_back(above);
    return p;
}

struct File {
    std::string bytes, how;
    bool isSaid = false;  ///< something in it is left out
};

template <class T>
void append(std::string& out, T value, bool isBig = false) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (isBig) std::reverse(raw, raw + sizeof value);
    out.append(raw, sizeof value);
}

std::string withEnds(const std::string& text, const std::string& end) {
    std::string out;
    for (const char c : text)
        out += c == '\n' ? end : std::string(1, c);
    return out;
}

File binaryStl(const Prism& p, test::Dice& dice) {
    File f{"", "binary STL", false};
    std::string header(80, dice.once(2) ? ' ' : '\0');
    const std::string says =
        dice.oneOf<std::string>({"", "solid from somewhere", "COLOR=\xff\xff\xff\xff,MATERIAL=", "solid\n", "facet"});
    header.replace(0, says.size(), says);
    f.how += " '" + says + "'";
    f.bytes = header;
    const auto count = static_cast<std::uint32_t>(p.triangles.size());
    const std::uint32_t told = dice.once(4) ? dice.oneOf<std::uint32_t>({0u, count + 7, 0xffffffffu}) : count;
    f.isSaid = told != count;
    append(f.bytes, told);
    for (const Polygon& t : p.triangles) {
        for (int n = 0; n < 3; ++n)
            append(f.bytes, dice.once(40) ? std::numeric_limits<float>::quiet_NaN() : 0.5f);  // a senseless normal
        for (const std::uint32_t v : t)
            for (const double x : p.vertices[v])
                append(f.bytes, static_cast<float>(x));
        append(f.bytes, static_cast<std::uint16_t>(dice.upTo(65536)));
    }
    f.how += fmt::format(" says {} of {}", told, count);
    return f;
}

File textStl(const Prism& p, test::Dice& dice) {
    File f{"", "ASCII STL", false};
    const bool isLoud = dice.once(3);
    const std::string indent = dice.oneOf<std::string>({"  ", "\t", "", "      "});
    const int digits = dice.upTo(3);
    const auto number = [&](double v) {
        return digits == 0 ? fmt::format("{}", v) : digits == 1 ? fmt::format("{:.6e}", v) : fmt::format("{:+.3f}", v);
    };
    const auto word = [&](std::string w) {
        if (isLoud) std::transform(w.begin(), w.end(), w.begin(), [](unsigned char c) { return std::toupper(c); });
        return w;
    };
    const int pieces = dice.once(3) ? 2 : 1;
    std::string text = dice.once(5) ? "\xef\xbb\xbf" : "";
    const auto half = p.triangles.size() / 2;
    for (int piece = 0; piece < pieces; ++piece) {
        text += word("solid") + dice.oneOf<std::string>({"", " tooth 46", " facet normal", " \xe6\xad\xaf"}) + "\n";
        for (std::size_t i = 0; i < p.triangles.size(); ++i) {
            if (pieces == 2 && (i < half) != (piece == 0)) continue;
            text += indent + word("facet normal") + " 0 0 " + dice.oneOf<std::string>({"1", "-0", "1e0"}) + "\n";
            text += indent + indent + word("outer loop") + "\n";
            for (const std::uint32_t v : p.triangles[i])
                text += fmt::format("{}{} {} {} {}\n", indent, word("vertex"), number(p.vertices[v].x()),
                                    number(p.vertices[v].y()), number(p.vertices[v].z()));
            text += indent + word("endloop") + "\n" + indent + word("endfacet") + "\n";
            if (dice.once(20)) text += "\n";
        }
        text += word("endsolid") + "\n";
    }
    f.bytes = withEnds(text, dice.oneOf<std::string>({"\n", "\r\n"}));
    f.how += fmt::format(" digits {} pieces {}", digits, pieces);
    return f;
}

File ply(const Prism& p, test::Dice& dice) {
    const int form = dice.upTo(3);  // text, little, big
    const bool isBig = form == 2, isPolygons = dice.once(2), isDouble = dice.once(2);
    const std::vector<Polygon>& faces = isPolygons ? p.polygons : p.triangles;
    std::vector<std::string> properties{"x", "y", "z"};
    for (const char* more : {"nx", "red", "alpha", "confidence"})
        if (dice.once(2)) properties.emplace_back(more);
    if (dice.once(3)) dice.shuffle(properties);
    const std::string count = dice.oneOf<std::string>({"uchar", "uint8", "ushort", "int"});
    const std::string index = dice.oneOf<std::string>({"int", "uint", "int32", "uint32"});
    const std::string coordinate =
        isDouble ? dice.oneOf<std::string>({"double", "float64"}) : dice.oneOf<std::string>({"float", "float32"});
    const auto isColour = [](const std::string& name) { return name == "red" || name == "alpha"; };
    std::string head = fmt::format("ply\nformat {} 1.0\ncomment made by hand\n", form == 0 ? "ascii"
                                                                                 : isBig   ? "binary_big_endian"
                                                                                           : "binary_little_endian");
    if (dice.once(3)) head += "obj_info a line of somebody's\n";
    head += fmt::format("element vertex {}\n", p.vertices.size());
    for (const std::string& name : properties)
        head += "property " + (isColour(name) ? std::string("uchar") : coordinate) + " " + name + "\n";
    head += fmt::format("element face {}\nproperty list {} {} {}\n", faces.size(), count, index,
                        dice.oneOf<std::string>({"vertex_indices", "vertex_index"}));
    const bool hasFlags = dice.once(3), hasEdges = dice.once(4);
    if (hasFlags) head += "property uchar flags\n";
    if (hasEdges) head += "element edge 2\nproperty int vertex1\nproperty int vertex2\n";
    head += "end_header\n";
    std::string body;
    const auto put = [&](double v, int bytes, bool isWhole) {
        if (form == 0)
            body += fmt::format("{} ", v);
        else if (isWhole && bytes == 1)
            append(body, static_cast<std::uint8_t>(v));
        else if (isWhole && bytes == 2)
            append(body, static_cast<std::uint16_t>(v), isBig);
        else if (isWhole)
            append(body, static_cast<std::uint32_t>(v), isBig);
        else if (bytes == 8)
            append(body, v, isBig);
        else
            append(body, static_cast<float>(v), isBig);
    };
    const auto ends = [&] { body += form == 0 ? "\n" : ""; };
    for (const Vec3& v : p.vertices) {
        for (const std::string& name : properties)
            if (name == "x" || name == "y" || name == "z")
                put(v[name[0] - 'x'], isDouble ? 8 : 4, false);
            else
                put(isColour(name) ? 200 : 0.5, isColour(name) ? 1 : isDouble ? 8 : 4, isColour(name));
        ends();
    }
    for (const Polygon& face : faces) {
        put(static_cast<double>(face.size()), count == "int" ? 4 : count == "ushort" ? 2 : 1, true);
        for (const std::uint32_t v : face)
            put(v, 4, true);
        if (hasFlags) put(3, 1, true);
        ends();
    }
    for (int i = 0; hasEdges && i < 4; ++i)
        put(i, 4, true);
    const bool isDos = form == 0 && dice.once(2);
    return {isDos ? withEnds(head + body, "\r\n") : head + body,
            fmt::format("PLY form {} {} {} polygons {}", form, count, index, isPolygons), false};
}

File obj(const Prism& p, test::Dice& dice) {
    const bool isPolygons = dice.once(2), isNegative = dice.once(3), hasColours = dice.once(3);
    const int form = dice.upTo(4);
    const std::vector<Polygon>& faces = isPolygons ? p.polygons : p.triangles;
    std::string text = "# by hand\nmtllib missing.mtl\no tooth\n";
    for (const Vec3& v : p.vertices)
        text += fmt::format("v {} {} {}{}\n", v.x(), v.y(), v.z(), hasColours ? " 0.5 0.25 1" : "");
    if (form == 1 || form == 3) text += "vt 0.5 0.5\n";
    if (form >= 2) text += "vn 0 0 1\n";
    text += dice.oneOf<std::string>({"", "g crown\n", "usemtl enamel\ns off\n", "s 1\n", "l 1 2\n"});
    for (const Polygon& face : faces) {
        text += "f";
        for (std::size_t n = 0; n < face.size(); ++n) {
            const long long number =
                isNegative ? static_cast<long long>(face[n]) - static_cast<long long>(p.vertices.size()) : face[n] + 1;
            text += fmt::format(" {}{}", number, form == 0 ? "" : form == 1 ? "/1" : form == 2 ? "//1" : "/1/1");
            if (n == 2 && face.size() > 4 && dice.once(3)) text += " \\\n";
        }
        text += dice.once(8) ? " # a face\n" : "\n";
    }
    return {dice.once(3) ? withEnds(text, "\r\n") : text,
            fmt::format("OBJ form {} polygons {} negative {} colours {}", form, isPolygons, isNegative, hasColours),
            false};
}

/// Area and volume are those of the prism, and nothing else is in it.
bool isRight(const TriangleMesh& mesh, const Prism& p) {
    const MeshReport r = inspect(mesh);
    return std::abs(r.areaMm2 - p.areaMm2) < 1e-6 * p.areaMm2 &&
           std::abs(r.volumeMm3 - p.volumeMm3) < 1e-6 * p.volumeMm3;
}

TEST(MeshCorpus, AsOtherProgramsWriteThem) {
    const std::uint64_t seed = test::seed();
    const int count = test::corpusSize(180);
    int refused = 0, said = 0;
    for (int i = 0; i < count; ++i) {
        test::Dice dice(seed + static_cast<std::uint64_t>(i));
        const Prism p = prism(dice);
        File (*const writers[])(const Prism&, test::Dice&) = {binaryStl, textStl, ply, obj};
        File f = writers[i % 4](p, dice);
        const std::string which = fmt::format("file {} of seed {}: {}", i, seed, f.how);
        const auto hint = i % 4 < 2 ? MeshFormat::stl : i % 4 == 2 ? MeshFormat::ply : MeshFormat::obj;
        const auto read = [&](ReadNotes& notes) {
            return readMesh(std::as_bytes(std::span(f.bytes)), hint, "it", &notes);
        };
        ReadNotes notes;
        ASSERT_NO_THROW({
            const TriangleMesh mesh = read(notes);
            EXPECT_TRUE(isRight(mesh, p)) << which;
            EXPECT_TRUE(!f.isSaid || !notes.empty()) << which;
        }) << which;
        // The same file, broken off: never wrong without a word.
        f.bytes.resize(f.bytes.size() * static_cast<std::size_t>(5 + dice.upTo(94)) / 100);
        notes.clear();
        try {
            const TriangleMesh mesh = read(notes);
            said += !notes.empty();
            // Lines of text that end early are a file of their own: one that every command calls open.
            EXPECT_TRUE(!notes.empty() || isRight(mesh, p) || inspect(mesh).openEdges > 0)
                << which << ", broken off at " << f.bytes.size();
        } catch (const core::Error& e) {
            ++refused;
            EXPECT_NE(std::string(e.what()).find("it"), std::string::npos) << which;
        }
    }
    std::cout << fmt::format("{} files right; broken off: {} refused, {} with a note\n", count, refused, said);
}

}  // namespace
}  // namespace handpiece::geometry::mesh_corpus_test
