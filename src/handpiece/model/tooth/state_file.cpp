// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/state_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_cache.h"

namespace handpiece::tooth {
namespace {

constexpr std::uint32_t kVersion = 3;
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr char kMagic[8] = {'H', 'P', 'S', 'T', 'A', 'T', 'E', '\n'};
constexpr std::size_t kPieceBricks = 64;  ///< compressed together, beside the other pieces

template <std::size_t Tissues>
struct HeaderOf {
    char magic[8];
    std::uint32_t version, byteOrder;
    std::uint64_t key;
    std::uint64_t bricks, payloadBytes;
    double removedMm3[Tissues];
    std::uint64_t payloadHash, headerHash;
};
using Header = HeaderOf<cases::kTissueCount>;
using FirstHeader = HeaderOf<cases::kFirstTissueCount>;  // of version 1
static_assert(sizeof(Header) == 208 && std::is_trivially_copyable_v<Header>);
static_assert(sizeof(FirstHeader) == 136 && offsetof(FirstHeader, removedMm3) == offsetof(Header, removedMm3));

template <class AnyHeader>
std::uint64_t headerHashOf(const AnyHeader& header) {
    core::Hasher hasher;
    hasher.add(std::as_bytes(std::span(&header, 1)).first(offsetof(AnyHeader, headerHash)));
    return hasher.value();
}

/// What a version 1 header says, in today's; its checksum holds or is made not to.
Header todaysOf(const FirstHeader& first) {
    Header header{};
    std::memcpy(&header, &first, offsetof(Header, removedMm3));
    std::copy(std::begin(first.removedMm3), std::end(first.removedMm3), header.removedMm3);
    header.payloadHash = first.payloadHash;
    header.headerHash = headerHashOf(header) ^ headerHashOf(first) ^ first.headerHash;
    return header;
}

std::size_t piecesOf(std::size_t bricks) {
    return (bricks + kPieceBricks - 1) / kPieceBricks;
}

/// Floats as integers in the same order, so that near values have near numbers.
std::uint32_t ordered(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}
float unordered(std::uint32_t number) {
    return std::bit_cast<float>((number & 0x80000000u) != 0 ? number & 0x7fffffffu : ~number);
}
std::uint32_t folded(std::uint32_t difference) {  // small differences of either sign become small numbers
    return (difference << 1) ^ ((difference & 0x80000000u) != 0 ? 0xffffffffu : 0u);
}
std::uint32_t unfolded(std::uint32_t number) {
    return (number >> 1) ^ ((number & 1u) != 0 ? 0xffffffffu : 0u);
}

/// What a node's value would be if the field had no third mixed difference. In differences first: where all is held to
/// the band it is exact.
float predicted(const float* v, int x, int y, int z) {
    constexpr int kX = 1, kY = field::kBrickNodes, kZ = field::kBrickNodes * field::kBrickNodes;
    if (x > 0 && y > 0 && z > 0)
        return ((v[-kX] - v[-kX - kY]) + (v[-kY] - v[-kY - kZ]) + (v[-kZ] - v[-kX - kZ])) + v[-kX - kY - kZ];
    if (x > 0 && y > 0) return (v[-kX] - v[-kX - kY]) + v[-kY];
    if (x > 0 && z > 0) return (v[-kX] - v[-kX - kZ]) + v[-kZ];
    if (y > 0 && z > 0) return (v[-kY] - v[-kY - kZ]) + v[-kZ];
    if (x > 0) return v[-kX];
    if (y > 0) return v[-kY];
    return z > 0 ? v[-kZ] : 0.0f;
}

template <class F>
void forEachNode(F&& visit) {
    int at = 0;
    for (int z = 0; z < field::kBrickNodes; ++z)
        for (int y = 0; y < field::kBrickNodes; ++y)
            for (int x = 0; x < field::kBrickNodes; ++x)
                visit(at++, x, y, z);
}

/// A piece before compression: indices, flags, then the numbers of the bricks that are not uncut, byte by byte: all
/// lowest bytes first, all highest last.
std::vector<std::uint8_t> packed(std::span<const StateDelta::Brick> bricks) {
    std::size_t cut = 0;
    for (const StateDelta::Brick& brick : bricks)
        cut += !brick.uncut;
    const std::size_t plane = cut * field::kBrickValues;
    std::vector<std::uint8_t> raw(bricks.size() * 5 + plane * 4);
    for (std::size_t i = 0; i < bricks.size(); ++i) {
        std::memcpy(&raw[4 * i], &bricks[i].id, 4);
        raw[4 * bricks.size() + i] = bricks[i].uncut;
    }
    std::uint8_t* out = raw.data() + bricks.size() * 5;
    for (const StateDelta::Brick& brick : bricks) {
        if (brick.uncut) continue;
        const float* values = brick.values.data();
        forEachNode([&](int at, int x, int y, int z) {
            const std::uint32_t number = folded(ordered(values[at]) - ordered(predicted(values + at, x, y, z)));
            for (std::size_t byte = 0; byte < 4; ++byte)
                out[byte * plane + static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(number >> (8 * byte));
        });
        out += field::kBrickValues;
    }
    return raw;
}

/// False when `raw` cannot be what packed() gives for so many bricks.
bool unpack(std::span<const std::uint8_t> raw, std::span<StateDelta::Brick> bricks) {
    std::size_t cut = 0;
    if (raw.size() < bricks.size() * 5) return false;
    for (std::size_t i = 0; i < bricks.size(); ++i) {
        std::memcpy(&bricks[i].id, &raw[4 * i], 4);
        const std::uint8_t uncut = raw[4 * bricks.size() + i];
        if (uncut > 1) return false;
        bricks[i].uncut = uncut != 0;
        cut += !bricks[i].uncut;
    }
    const std::size_t plane = cut * field::kBrickValues;
    if (raw.size() != bricks.size() * 5 + plane * 4) return false;
    const std::uint8_t* in = raw.data() + bricks.size() * 5;
    for (StateDelta::Brick& brick : bricks) {
        brick.values.fill(0.0f);
        if (brick.uncut) continue;
        float* values = brick.values.data();
        forEachNode([&](int at, int x, int y, int z) {
            std::uint32_t number = 0;
            for (std::size_t byte = 0; byte < 4; ++byte)
                number |= std::uint32_t{in[byte * plane + static_cast<std::size_t>(at)]} << (8 * byte);
            values[at] = unordered(unfolded(number) + ordered(predicted(values + at, x, y, z)));
        });
        in += field::kBrickValues;
    }
    return true;
}

std::vector<std::uint8_t> compressed(const std::vector<std::uint8_t>& raw) {
    uLongf size = compressBound(static_cast<uLong>(raw.size()));
    std::vector<std::uint8_t> out(size);
    if (compress2(out.data(), &size, raw.data(), static_cast<uLong>(raw.size()), 1) != Z_OK)
        throw core::Error("a cut state cannot be compressed: out of memory");
    out.resize(size);
    return out;
}

/// Everything that the fields could not hold. True when all is well.
bool fits(const StateDelta& state, const Teeth& teeth) {
    const auto isThere = [&](std::size_t tooth) { return tooth < teeth.size() && teeth[tooth] != nullptr; };
    for (std::size_t i = 0; i < state.bricks.size(); ++i) {
        const StateDelta::Brick& brick = state.bricks[i];
        if (!isThere(toothOf(brick.id)) || (i > 0 && brick.id <= state.bricks[i - 1].id)) return false;
        const ToothModel& model = *teeth[toothOf(brick.id)];
        const field::FieldStorage& field = model.field.storage();
        const std::uint32_t dense = denseOf(brick.id);
        if (dense >= field.coarse.size()) return false;
        if (field.brickIndex[dense] < 0 && field.coarse[dense] >= 0.0f) return false;
        if (brick.uncut) continue;
        const auto low = static_cast<float>(-model.settings.bandMm), high = static_cast<float>(model.bandOutMm);
        for (const float value : brick.values)
            if (!(value >= low && value <= high)) return false;
    }
    for (std::uint16_t tooth = 0; tooth <= state.removedMm3.others.size(); ++tooth)
        for (const double mm3 : state.removedMm3.of(tooth))
            if (!std::isfinite(mm3) || (mm3 != 0.0 && !isThere(tooth))) return false;
    return true;
}

}  // namespace

std::vector<std::byte> encodeState(const StateDelta& state, std::uint64_t identity) {
    const std::size_t count = state.bricks.size();
    std::vector<std::vector<std::uint8_t>> pieces(piecesOf(count));
    core::parallelFor(pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t first = i * kPieceBricks;
            pieces[i] =
                compressed(packed(std::span(state.bricks).subspan(first, std::min(kPieceBricks, count - first))));
        }
    });
    std::vector<std::byte> data(sizeof(Header));
    const auto append = [&](const void* from, std::size_t bytes) {
        const std::size_t at = data.size();
        data.resize(at + bytes);
        std::copy_n(static_cast<const std::byte*>(from), bytes, data.data() + at);
    };
    const auto others = static_cast<std::uint32_t>(state.removedMm3.others.size());
    append(&others, sizeof others);
    append(state.removedMm3.others.data(), others * sizeof(TissueVolumes));
    for (const std::vector<std::uint8_t>& piece : pieces) {
        const auto size = static_cast<std::uint32_t>(piece.size());
        append(&size, sizeof size);
    }
    for (const std::vector<std::uint8_t>& piece : pieces)
        append(piece.data(), piece.size());
    Header header{};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    header.version = kVersion;
    header.byteOrder = kByteOrder;
    header.key = identity;
    header.bricks = count;
    header.payloadBytes = data.size() - sizeof header;
    std::copy(state.removedMm3.own.begin(), state.removedMm3.own.end(), header.removedMm3);
    header.payloadHash = field::hashOf(std::span(data).subspan(sizeof header));
    header.headerHash = headerHashOf(header);
    std::memcpy(data.data(), &header, sizeof header);
    return data;
}

StateDelta decodeState(std::span<const std::byte> data, const Teeth& teeth, const std::string& where) {
    Header header;
    const auto cutShort = [&] { return core::Error("the cut state is cut short", where, "take an older copy"); };
    const auto damaged = [&] { return core::Error("the cut state is damaged", where, "take an older copy"); };
    if (data.size() < sizeof kMagic || std::memcmp(data.data(), kMagic, sizeof kMagic) != 0)
        throw core::Error("these bytes are no cut state", where);
    if (data.size() < sizeof(FirstHeader)) throw cutShort();
    std::memcpy(&header, data.data(), sizeof(FirstHeader));
    const bool isFirst = header.byteOrder == kByteOrder && header.version == 1;
    const std::size_t headerBytes = isFirst ? sizeof(FirstHeader) : sizeof header;
    if (isFirst) {
        FirstHeader first;
        std::memcpy(&first, data.data(), sizeof first);
        header = todaysOf(first);
    } else if (data.size() >= sizeof header) {
        std::memcpy(&header, data.data(), sizeof header);
    }
    if (header.byteOrder != kByteOrder)
        throw core::Error("the cut state was written by a machine of another byte order, or is damaged", where);
    if (header.version > kVersion)
        throw core::Error(
            fmt::format("the cut state is of version {}, this program knows {}", header.version, kVersion), where,
            "use a newer Handpiece");
    if (data.size() < headerBytes) throw cutShort();
    if (header.version == 0 || header.headerHash != headerHashOf(header)) throw damaged();
    if (header.key != identityOf(teeth))
        throw core::Error(
            "the cut state belongs to another tooth or mouth, another voxel or band, or an earlier Handpiece", where,
            "open it with the case and the settings that it was saved with");
    std::span<const std::byte> payload = data.subspan(headerBytes);
    if (payload.size() < header.payloadBytes) throw cutShort();
    if (payload.size() > header.payloadBytes || field::hashOf(payload) != header.payloadHash) throw damaged();

    std::size_t most = 0;
    for (const auto& tooth : teeth)
        if (tooth) most += tooth->field.storage().coarse.size();
    if (header.bricks > most) throw damaged();
    StateDelta state;
    if (header.version >= 3) {
        std::uint32_t others = 0;
        if (payload.size() < sizeof others) throw damaged();
        std::memcpy(&others, payload.data(), sizeof others);
        payload = payload.subspan(sizeof others);
        if (others >= kMaxTeeth || payload.size() < others * sizeof(TissueVolumes)) throw damaged();
        state.removedMm3.others.resize(others);
        // Of no others there is no place to copy to.
        if (others > 0) std::memcpy(state.removedMm3.others.data(), payload.data(), others * sizeof(TissueVolumes));
        payload = payload.subspan(others * sizeof(TissueVolumes));
    }
    const std::size_t count = header.bricks, pieces = piecesOf(count);
    if (payload.size() < pieces * sizeof(std::uint32_t)) throw damaged();
    std::vector<std::size_t> start(pieces + 1, pieces * sizeof(std::uint32_t));
    for (std::size_t i = 0; i < pieces; ++i) {
        std::uint32_t size;
        std::memcpy(&size, payload.data() + i * sizeof size, sizeof size);
        start[i + 1] = start[i] + size;
    }
    if (start[pieces] != payload.size()) throw damaged();

    std::copy(std::begin(header.removedMm3), std::end(header.removedMm3), state.removedMm3.own.begin());
    state.bricks.resize(count);
    core::parallelFor(pieces, 1, [&](std::size_t begin, std::size_t end) {
        // No piece is larger than this, whatever it says: nothing swells beyond it.
        std::vector<std::uint8_t> raw(kPieceBricks * (5 + 4 * field::kBrickValues));
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t first = i * kPieceBricks;
            uLongf size = static_cast<uLongf>(raw.size());
            const auto* from = reinterpret_cast<const Bytef*>(payload.data() + start[i]);
            if (uncompress(raw.data(), &size, from, static_cast<uLong>(start[i + 1] - start[i])) != Z_OK ||
                !unpack(std::span(raw).first(size),
                        std::span(state.bricks).subspan(first, std::min(kPieceBricks, count - first))))
                throw damaged();
        }
    });
    if (!fits(state, teeth)) throw damaged();
    return state;
}

}  // namespace handpiece::tooth
