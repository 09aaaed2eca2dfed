// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/packed_field.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <utility>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/prepared/packed_bytes.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/field/stored_tissues.h"

namespace handpiece::field {
namespace {

constexpr std::uint64_t kMagic = 0x3144454b43415048;  // "HPACKED1"
constexpr std::uint64_t kMostBytes = 2ull << 30;
constexpr std::size_t kGroup =
    64;  ///< bricks that begin with nothing known, so that groups are unpacked beside each other

// A node's triangle is told by where in its brick it was met before.
constexpr std::uint8_t kAsLeft = 0, kAsBelow = 1, kAsBehind = 2, kFresh = 3, kListed = 4, kOfAnother = 255;
constexpr std::size_t kMostListed = 250;

/// The triangles met in a brick, in their order.
class Met {
  public:
    void begin() { count_ = 0; }
    void add(std::uint32_t triangle) {
        if (count_ < kMostListed) list_[count_++] = triangle;
    }
    /// Place counted from the latest on; -1: not met.
    [[nodiscard]] int find(std::uint32_t triangle) const {
        for (std::size_t i = count_; i-- > 0;)
            if (list_[i] == triangle) return static_cast<int>(count_ - 1 - i);
        return -1;
    }
    [[nodiscard]] bool has(std::size_t place) const { return place < count_; }
    [[nodiscard]] std::uint32_t at(std::size_t place) const { return list_[count_ - 1 - place]; }

  private:
    std::array<std::uint32_t, kMostListed> list_{};
    std::size_t count_ = 0;
};

/// Differences of either sign, small ones small.
std::uint32_t folded(std::uint32_t now, std::uint32_t before) {
    const std::uint32_t difference = now - before;
    return difference << 1 ^ (0u - (difference >> 31));
}
std::uint32_t unfolded(std::uint32_t told, std::uint32_t before) {
    return before + (told >> 1 ^ (0u - (told & 1)));
}

/// Calls f(node, left, below, behind) in order; neighbours are -1 where the brick has none.
template <class F>
void forEachNode(F&& f) {
    for (int z = 0, at = 0; z < kBrickNodes; ++z)
        for (int y = 0; y < kBrickNodes; ++y)
            for (int x = 0; x < kBrickNodes; ++x, ++at)
                f(static_cast<std::size_t>(at), x > 0 ? at - 1 : -1, y > 0 ? at - kBrickNodes : -1,
                  z > 0 ? at - kBrickNodes * kBrickNodes : -1);
}

struct Told {
    std::vector<std::uint8_t> symbols;   ///< one a node
    std::vector<std::uint32_t> fresh;    ///< of each that is met for the first time in its brick, from the one before
    std::vector<std::uint32_t> freshOf;  ///< how many each group of bricks has
};

Told told(std::span<const std::uint32_t> nearest) {
    Told out;
    out.symbols.reserve(nearest.size());
    Met met;
    std::uint32_t before = 0;
    for (std::size_t from = 0, brick = 0; from < nearest.size(); from += kBrickValues, ++brick) {
        const std::uint32_t* of = &nearest[from];
        met.begin();
        if (brick % kGroup == 0) {
            before = 0;
            out.freshOf.push_back(0);
        }
        forEachNode([&](std::size_t node, int left, int below, int behind) {
            const std::uint32_t triangle = of[node];
            const auto symbol = [&]() -> std::uint8_t {
                if (triangle == geometry::kNoTriangle) return kOfAnother;
                if (left >= 0 && of[left] == triangle) return kAsLeft;
                if (below >= 0 && of[below] == triangle) return kAsBelow;
                if (behind >= 0 && of[behind] == triangle) return kAsBehind;
                const int place = met.find(triangle);
                return place < 0 ? kFresh : static_cast<std::uint8_t>(kListed + place);
            }();
            out.symbols.push_back(symbol);
            if (symbol != kFresh) return;
            out.fresh.push_back(folded(triangle, before));
            ++out.freshOf.back();
            before = triangle;
            met.add(triangle);
        });
    }
    return out;
}

/// The triangles of a group's nodes; false for what cannot be meant.
bool heard(std::span<const std::uint8_t> symbols, std::span<const std::uint32_t> fresh,
           std::span<std::uint32_t> nearest) {
    Met met;
    std::uint32_t before = 0;
    std::size_t used = 0;
    bool fits = true;
    for (std::size_t from = 0; from < nearest.size(); from += kBrickValues) {
        std::uint32_t* of = &nearest[from];
        met.begin();
        forEachNode([&](std::size_t node, int left, int below, int behind) {
            const std::uint8_t symbol = symbols[from + node];
            const int same = symbol == kAsLeft ? left : symbol == kAsBelow ? below : symbol == kAsBehind ? behind : -1;
            of[node] = geometry::kNoTriangle;
            if (symbol == kOfAnother) return;
            if (same >= 0) {
                of[node] = of[same];
            } else if (symbol == kFresh && used < fresh.size()) {
                of[node] = before = unfolded(fresh[used++], before);
                met.add(before);
            } else if (symbol >= kListed && met.has(std::size_t{symbol} - kListed)) {
                of[node] = met.at(std::size_t{symbol} - kListed);
            } else {
                fits = false;
            }
        });
    }
    return fits && used == fresh.size();
}

/// All groups beside each other; empty for what cannot be meant.
std::vector<std::uint32_t> nearestOf(const Told& t) {
    const std::size_t bricks = t.symbols.size() / kBrickValues;
    std::vector<std::uint32_t> nearest;
    std::vector<std::size_t> from(t.freshOf.size() + 1, 0);
    for (std::size_t i = 0; i < t.freshOf.size(); ++i)
        from[i + 1] = from[i] + t.freshOf[i];
    if (t.freshOf.size() != (bricks + kGroup - 1) / kGroup || from.back() != t.fresh.size()) return nearest;
    nearest.resize(bricks * kBrickValues);
    std::atomic<bool> fits{true};
    core::parallelFor(t.freshOf.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t first = i * kGroup * kBrickValues,
                              count = std::min(kGroup * kBrickValues, nearest.size() - first);
            if (!heard(std::span(t.symbols).subspan(first, count), std::span(t.fresh).subspan(from[i], t.freshOf[i]),
                       std::span(nearest).subspan(first, count)))
                fits = false;
        }
    });
    if (!fits) nearest.clear();
    return nearest;
}

template <class T>
void packNumbers(std::span<const T> values, std::vector<std::byte>& out) {
    prepared::pack(prepared::inPlanes(std::as_bytes(values), sizeof(T)), out);
}

template <class T>
bool takeNumbers(std::span<const std::byte>& packed, std::vector<T>& values) {
    const std::optional<std::vector<std::byte>> planes = prepared::unpack(packed, kMostBytes);
    if (!planes || planes->size() % sizeof(T) != 0) return false;
    const std::vector<std::byte> bytes = prepared::fromPlanes(*planes, sizeof(T));
    values.resize(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return true;
}

}  // namespace

std::vector<std::byte> packField(const DistanceField& field, std::span<const std::uint32_t> nearest,
                                 std::uint64_t key) {
    const FieldStorage& storage = field.storage();
    const StoredTissues tissues = StoredTissues::of(storage);
    const Told triangles = told(nearest);
    std::vector<std::byte> out;
    const std::uint64_t head[2] = {kMagic, key};
    const auto bytes = std::as_bytes(std::span(head));
    out.assign(bytes.begin(), bytes.end());
    packNumbers(std::span(std::as_const(storage.coarse)), out);
    packNumbers(std::span(tissues.coarseTissue), out);
    packNumbers(std::span(tissues.tissueOfBrick), out);
    packNumbers(std::span(tissues.mixedTissues), out);
    packNumbers(std::span(triangles.symbols), out);
    packNumbers(std::span(triangles.fresh), out);
    packNumbers(std::span(triangles.freshOf), out);
    return out;
}

std::optional<DistanceField> unpackField(std::span<const std::byte> packed, std::uint64_t key,
                                         const geometry::TriangleTree& tree, const FieldSettings& settings,
                                         const TissueSet& known) {
    std::uint64_t head[2];
    if (packed.size() < sizeof head) return std::nullopt;
    std::memcpy(head, packed.data(), sizeof head);
    packed = packed.subspan(sizeof head);
    if (head[0] != kMagic || head[1] != key) return std::nullopt;
    std::vector<float> coarse;
    StoredTissues tissues;
    Told triangles;
    if (!takeNumbers(packed, coarse) || !takeNumbers(packed, tissues.coarseTissue) ||
        !takeNumbers(packed, tissues.tissueOfBrick) || !takeNumbers(packed, tissues.mixedTissues) ||
        !takeNumbers(packed, triangles.symbols) || !takeNumbers(packed, triangles.fresh) ||
        !takeNumbers(packed, triangles.freshOf) || !packed.empty())
        return std::nullopt;
    const std::vector<std::uint32_t> nearest = nearestOf(triangles);
    std::optional<FieldStorage> field = FieldBuilder::fromNearest(tree, settings, std::move(coarse), nearest);
    if (!field || tissues.coarseTissue.size() != field->coarse.size() ||
        tissues.tissueOfBrick.size() != field->brickCount() || !tissues.putInto(*field, known))
        return std::nullopt;
    return DistanceField(std::move(*field));
}

}  // namespace handpiece::field
