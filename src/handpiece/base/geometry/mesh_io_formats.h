// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the mesh readers share. Only mesh_io*.cpp include it.

#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/base/geometry/polygons.h"

namespace handpiece::geometry::formats {

struct Source {
    std::span<const std::byte> data;
    const std::string& where;
    ReadNotes* notes;
    std::filesystem::path folder{};  ///< where what the file names is looked for; empty: nowhere

    [[nodiscard]] std::string_view text() const { return {reinterpret_cast<const char*>(data.data()), data.size()}; }
    void note(std::string sentence) const {
        if (notes) notes->push_back(std::move(sentence));
    }
    [[noreturn]] void fail(std::string problem, std::string remedy = {}) const {
        throw core::Error(problem, where, std::move(remedy)).as("bad-mesh", {problem});
    }
};

/// Throws core::Error, with what it is, for a file of another kind that is often saved under a mesh's name.
void refuseForeign(const Source& source);

/// True when a binary STL's length agrees with the count in its header.
[[nodiscard]] bool isExactBinaryStl(std::span<const std::byte> data);
[[nodiscard]] TriangleMesh readBinaryStl(const Source& source);
[[nodiscard]] TriangleMesh readAsciiStl(const Source& source);
/// `colours`: what the file says of them is taken too; null: passed over.
[[nodiscard]] TriangleMesh readPly(const Source& source, VertexColours* colours);
[[nodiscard]] TriangleMesh readObj(const Source& source, VertexColours* colours);

/// Faces a mesh may have: their corners must be countable in 31 bits.
inline constexpr std::uint64_t kMaxFaces = (std::uint64_t{1} << 31) / 3;
/// Larger numbers are no coordinates in any unit, and their cubes would overflow.
inline constexpr double kMaxCoordinate = 1e30;

[[nodiscard]] inline bool isCoordinate(double v) {
    return std::abs(v) <= kMaxCoordinate;
}  // false for NaN

/// Counts what is no coordinate, so that one error tells how many and where the first is.
struct BadCoordinates {
    std::uint64_t count = 0, first = 0;
    void add(std::uint64_t index) {
        if (count++ == 0) first = index;
    }
    void check(const Source& source, std::string_view things, std::string_view thing) const {
        if (count > 0)
            source.fail(fmt::format("{} {} {} not finite (or beyond 1e30), the first is {} {}", count,
                                    count == 1 ? thing : things, count == 1 ? "is" : "are", thing, first + 1),
                        "export the mesh again");
    }
};

/// Colours as a file has them, by vertex: numbers on a scale that only all of them together tell.
class FoundColours {
  public:
    void add(double red, double green, double blue) {
        found_.push_back({static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)});
    }
    /// On a scale to 1, 255 or 65535, whichever is the first that none is beyond, from `leastScale` to `mostScale`; a
    /// rounding error beyond 1 is 1. Empty, and the reason noted, where they cannot be believed.
    [[nodiscard]] VertexColours settle(const Source& source, std::size_t vertices, double leastScale,
                                       double mostScale = 65535.0) const;

  private:
    std::vector<std::array<float, 3>> found_;
};

/// Whitespace-separated words of a text, one after another, never beyond its end.
class Words {
  public:
    explicit Words(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

    /// The next word; empty at the end of the text.
    std::string_view next() {
        while (at_ != end_ && isSpace(*at_))
            ++at_;
        const char* begin = at_;
        while (at_ != end_ && !isSpace(*at_))
            ++at_;
        return {begin, static_cast<std::size_t>(at_ - begin)};
    }
    [[nodiscard]] std::string_view rest() const { return {at_, static_cast<std::size_t>(end_ - at_)}; }
    void skipLine() {
        while (at_ != end_ && *at_ != '\n' && *at_ != '\r')
            ++at_;
    }

    static bool isSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  private:
    const char* at_;
    const char* end_;
};

/// A whole word as a number; also nan and inf, which the callers count. False for anything else.
[[nodiscard]] inline bool parseNumber(std::string_view word, double& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc::result_out_of_range && end == word.data() + word.size()) {
        // Beyond double: tiny ones are zero, large ones are caught as no coordinate.
        const std::size_t e = word.find_first_of("eE");
        const bool tiny = e != std::string_view::npos ? word.substr(e + 1).starts_with('-') : word.find('.') <= 2;
        value = tiny ? 0.0 : HUGE_VAL;
        return true;
    }
    return error == std::errc() && end == word.data() + word.size();
}

template <class Integer>
[[nodiscard]] bool parseInteger(std::string_view word, Integer& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

/// A word of a foreign file as it may stand in a message.
[[nodiscard]] std::string quoted(std::string_view word);

/// Numbers equal points (same bits, -0 = +0) by first appearance. Open addressing; nothing depends on addresses.
template <class Scalar>
class VertexMerger {
    using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
    using Key = std::array<Bits, 3>;
    struct Slot {
        std::uint32_t tag, vertex;
    };
    static constexpr std::uint32_t kEmpty = 0xffffffffu;

  public:
    explicit VertexMerger(std::size_t expected) {
        resize(std::bit_ceil(expected * 2 + 16));
        keys_.reserve(expected);
    }

    /// The number of the point, a new one where it was not seen before.
    std::uint32_t add(Scalar x, Scalar y, Scalar z) {
        // + 0 turns -0 into +0 and leaves every other value as it is.
        const Key key{std::bit_cast<Bits>(x + Scalar(0)), std::bit_cast<Bits>(y + Scalar(0)),
                      std::bit_cast<Bits>(z + Scalar(0))};
        const std::uint32_t tag = hash(key);
        for (std::size_t i = tag & mask_;; i = (i + 1) & mask_) {
            Slot& slot = slots_[i];
            if (slot.vertex == kEmpty) {
                slot = {tag, static_cast<std::uint32_t>(keys_.size())};
                keys_.push_back(key);
                if (keys_.size() * 2 > slots_.size()) resize(slots_.size() * 2);
                return static_cast<std::uint32_t>(keys_.size() - 1);
            }
            if (slot.tag == tag && keys_[slot.vertex] == key) return slot.vertex;
        }
    }

    [[nodiscard]] std::size_t size() const { return keys_.size(); }
    [[nodiscard]] std::vector<core::Vec3> vertices() const {
        std::vector<core::Vec3> result;
        result.reserve(keys_.size());
        for (const Key& k : keys_)
            result.emplace_back(std::bit_cast<Scalar>(k[0]), std::bit_cast<Scalar>(k[1]), std::bit_cast<Scalar>(k[2]));
        return result;
    }

  private:
    static std::uint32_t hash(const Key& k) {
        std::uint64_t h = k[0] * 0x9E3779B97F4A7C15ull;
        h = (h ^ (h >> 32) ^ k[1]) * 0xD6E8FEB86659FD93ull;
        h = (h ^ (h >> 32) ^ k[2]) * 0xC2B2AE3D27D4EB4Full;
        return static_cast<std::uint32_t>(h >> 32);
    }
    void resize(std::size_t slots) {
        std::vector<Slot> old(slots, Slot{0, kEmpty});
        old.swap(slots_);
        mask_ = slots - 1;
        for (const Slot& s : old) {
            if (s.vertex == kEmpty) continue;
            std::size_t i = s.tag & mask_;
            while (slots_[i].vertex != kEmpty)
                i = (i + 1) & mask_;
            slots_[i] = s;
        }
    }

    std::vector<Slot> slots_;
    std::vector<Key> keys_;
    std::size_t mask_ = 0;
};

/// Cuts what is concave, and says what could not be.
inline void settle(const Polygons& polygons, TriangleMesh& mesh, const Source& source) {
    const Polygons::Left left = polygons.settle(mesh);
    const auto tell = [&](std::size_t count, std::string_view one, std::string_view many) {
        if (count > 0)
            source.note(fmt::format("{} {}, which leaves {} outline", count, count == 1 ? one : many,
                                    count == 1 ? "its" : "their"));
    };
    tell(left.crossing, "polygon crosses itself: it is cut as a fan",
         "polygons cross themselves: they are cut as fans");
    tell(left.tangled, "polygon is too intricate to be cut along its edges (export triangles): it is cut as a fan",
         "polygons are too intricate to be cut along their edges (export triangles): they are cut as fans");
}

}  // namespace handpiece::geometry::formats
