// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "handpiece/base/geometry/mesh_io_formats.h"

static_assert(std::endian::native == std::endian::little, "the mesh readers copy little-endian numbers as they are");

namespace handpiece::geometry::formats {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kFacetBytes = 50;

std::uint32_t countInHeader(std::span<const std::byte> data) {
    std::uint32_t count = 0;
    std::memcpy(&count, data.data() + 80, 4);
    return count;
}

/// Whole binary STLs one after another, to the end of the file or to what is none.
struct Glued {
    std::uint64_t files = 0, facets = 0;
    std::size_t bytesAfter = 0;
};

Glued gluedIn(std::span<const std::byte> at) {
    Glued glued;
    while (at.size() > kHeaderBytes && (at.size() - kHeaderBytes) / kFacetBytes >= countInHeader(at) &&
           countInHeader(at) > 0) {
        ++glued.files;
        glued.facets += countInHeader(at);
        at = at.subspan(kHeaderBytes + countInHeader(at) * std::size_t{kFacetBytes});
    }
    glued.bytesAfter = at.size();
    return glued;
}

// What follows the facets that are read.
std::string afterTheLast(std::span<const std::byte> rest, std::uint64_t facets) {
    const Glued after = gluedIn(rest);
    if (after.files > 0 && after.bytesAfter == 0)
        return fmt::format(
            "only the first of {} STL files in one is read, with {} facets: the {} facets after it are "
            "left out; save each as a file of its own",
            after.files + 1, facets, after.facets);
    return fmt::format("{} bytes after the last facet are left out", rest.size());
}

// How many facets to read: the file's length decides, the header is only compared with it.
std::uint64_t facetsOf(const Source& source) {
    const std::span<const std::byte> data = source.data;
    if (data.size() < kHeaderBytes)
        source.fail(
            fmt::format("the file ends inside the header of a binary STL ({} of {} bytes)", data.size(), kHeaderBytes),
            "export or copy the mesh again");
    const std::uint64_t said = countInHeader(data);
    const std::uint64_t whole = (data.size() - kHeaderBytes) / kFacetBytes;
    const std::uint64_t rest = (data.size() - kHeaderBytes) % kFacetBytes;
    // 25 headers are as long as 42 facets: the length alone does not tell 26 files from a count that is wrong.
    const auto isGlued = [&] {
        const Glued glued = gluedIn(data);
        return glued.files > 1 && glued.bytesAfter == 0;
    };
    if (whole == said || (whole > said && said > 0 && (rest != 0 || isGlued()))) {
        const std::uint64_t end = kHeaderBytes + said * kFacetBytes;
        if (end < data.size()) source.note(afterTheLast(data.subspan(end), said));
        return said;
    }
    if (rest != 0)
        source.fail(fmt::format("the file ends in the middle of facet {} of {}", whole + 1, said),
                    "export or copy the mesh again");
    source.note(fmt::format("the header says {} facets, the file holds {}", said, whole));
    return whole;
}

bool isWord(std::string_view word, std::string_view lower) {
    if (word.size() != lower.size()) return false;
    for (std::size_t i = 0; i < word.size(); ++i)
        if ((word[i] | 0x20) != lower[i]) return false;
    return true;
}

}  // namespace

bool isExactBinaryStl(std::span<const std::byte> data) {
    return data.size() > kHeaderBytes && data.size() == kHeaderBytes + kFacetBytes * std::uint64_t{countInHeader(data)};
}

TriangleMesh readBinaryStl(const Source& source) {
    const std::uint64_t facets = facetsOf(source);
    if (facets > kMaxFaces) source.fail(fmt::format("{} facets are more than the {} that are read", facets, kMaxFaces));
    TriangleMesh mesh;
    mesh.triangles.resize(facets);
    VertexMerger<float> merger(facets / 2 + 2);  // a closed surface has half as many vertices as faces
    BadCoordinates bad;
    const std::byte* at = source.data.data() + kHeaderBytes;
    for (std::uint64_t f = 0; f < facets; ++f, at += kFacetBytes) {
        float v[9];
        std::memcpy(v, at + 12, sizeof v);
        bool good = true;
        for (const float x : v)
            good &= std::abs(x) <= static_cast<float>(kMaxCoordinate);
        if (!good) {
            bad.add(f);
            continue;
        }
        mesh.triangles[f] = {merger.add(v[0], v[1], v[2]), merger.add(v[3], v[4], v[5]), merger.add(v[6], v[7], v[8])};
    }
    bad.check(source, "facets", "facet");
    mesh.vertices = merger.vertices();
    return mesh;
}

TriangleMesh readAsciiStl(const Source& source) {
    TriangleMesh mesh;
    VertexMerger<double> merger(source.data.size() / 512 + 16);
    BadCoordinates bad;
    Words words(source.text());
    std::string_view word = words.next();
    const auto is = [&](std::string_view lower) { return isWord(word, lower); };
    // "end facet" is written for "endfacet" too; what belongs to the end is taken with it.
    const auto isEnd = [&](std::string_view of) {
        if (word.size() == 3 + of.size()) return isWord(word.substr(0, 3), "end") && isWord(word.substr(3), of);
        if (!is("end")) return false;
        Words ahead = words;
        if (!isWord(ahead.next(), of)) return false;
        words = ahead;
        return true;
    };
    // "solid" may stand several times, each with a name up to the end of its line; a name may hold any word.
    const auto facet = [&] { return static_cast<std::uint64_t>(mesh.triangles.size()) + bad.count + 1; };
    bool isOpen = false;  // a solid that has not ended
    for (; !word.empty(); word = words.next()) {
        if (is("solid") || isEnd("solid")) {
            isOpen = is("solid");
            words.skipLine();
        } else if (is("facet")) {
            std::uint32_t corner[3] = {0, 0, 0};
            int corners = 0;
            bool good = true;
            std::string_view odd;  // stands where "endfacet" should
            for (word = words.next(); !isEnd("facet"); word = words.next()) {
                if (word.empty())
                    source.fail(fmt::format("the file ends in the middle of facet {}", facet()),
                                "export or copy the mesh again");
                if (is("facet") || isEnd("solid"))
                    source.fail(fmt::format("facet {} has no \"endfacet\"{}", facet(),
                                            odd.empty() ? "" : ": " + quoted(odd) + " stands there"),
                                "export the mesh again");
                if (isEnd("loop")) continue;
                if (!is("vertex")) {  // normal, outer, loop
                    if (corners == 3 && odd.empty()) odd = word;
                    continue;
                }
                if (corners == 3)
                    source.fail(fmt::format("facet {} has more than three vertices", facet()),
                                "export it as triangles");
                double v[3];
                for (double& x : v) {
                    word = words.next();
                    if (word.empty())
                        source.fail(fmt::format("the file ends in the middle of facet {}", facet()),
                                    "export or copy the mesh again");
                    if (!parseNumber(word, x))
                        source.fail(fmt::format("{} in facet {} is not a number", quoted(word), facet()),
                                    "export the mesh again");
                    good = good && isCoordinate(x);
                }
                if (good) corner[corners] = merger.add(v[0], v[1], v[2]);
                ++corners;
            }
            if (corners != 3)
                source.fail(fmt::format("facet {} has {} vertices, not three", facet(), corners),
                            "export the mesh again");
            if (good)
                mesh.triangles.push_back({corner[0], corner[1], corner[2]});
            else
                bad.add(facet() - 1);
        } else {
            source.fail(fmt::format("{} stands where facet {} should begin", quoted(word), facet()),
                        "export the mesh again");
        }
        if (mesh.triangles.size() > kMaxFaces)
            source.fail(fmt::format("more than the {} facets that are read", kMaxFaces));
    }
    bad.check(source, "facets", "facet");
    if (isOpen && !mesh.triangles.empty())
        source.fail(fmt::format("the file ends after facet {}, without \"endsolid\"", mesh.triangles.size()),
                    "export or copy the mesh again");
    mesh.vertices = merger.vertices();
    return mesh;
}

}  // namespace handpiece::geometry::formats
