// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/prepared/packed_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::prepared {
namespace {

constexpr std::size_t kPiece = 1 << 20;
constexpr int kLevel = 9;  // packed once, when the program is built

template <class T>
void append(std::vector<std::byte>& out, const T& value) {
    const auto bytes = std::as_bytes(std::span(&value, 1));
    out.insert(out.end(), bytes.begin(), bytes.end());
}

template <class T>
bool take(std::span<const std::byte>& from, T& value) {
    if (from.size() < sizeof value) return false;
    std::memcpy(&value, from.data(), sizeof value);
    from = from.subspan(sizeof value);
    return true;
}

std::size_t piecesOf(std::uint64_t bytes) {
    return static_cast<std::size_t>((bytes + kPiece - 1) / kPiece);
}

}  // namespace

void pack(std::span<const std::byte> data, std::vector<std::byte>& out) {
    std::vector<std::vector<unsigned char>> pieces(piecesOf(data.size()));
    core::parallelFor(pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto raw = data.subspan(i * kPiece, std::min(kPiece, data.size() - i * kPiece));
            uLongf size = compressBound(static_cast<uLong>(raw.size()));
            pieces[i].resize(size);
            if (compress2(pieces[i].data(), &size, reinterpret_cast<const Bytef*>(raw.data()),
                          static_cast<uLong>(raw.size()), kLevel) != Z_OK)
                throw core::Error("what is prepared cannot be packed: out of memory");
            pieces[i].resize(size);
        }
    });
    append(out, std::uint64_t{data.size()});
    for (const auto& piece : pieces)
        append(out, static_cast<std::uint32_t>(piece.size()));
    for (const auto& piece : pieces) {
        const auto bytes = std::as_bytes(std::span(piece));
        out.insert(out.end(), bytes.begin(), bytes.end());
    }
}

std::optional<std::vector<std::byte>> unpack(std::span<const std::byte>& packed, std::uint64_t mostBytes) {
    std::uint64_t bytes = 0;
    if (!take(packed, bytes) || bytes > mostBytes) return std::nullopt;
    std::vector<std::size_t> start(piecesOf(bytes) + 1, 0);
    if (packed.size() / sizeof(std::uint32_t) < start.size() - 1) return std::nullopt;
    for (std::size_t i = 0; i + 1 < start.size(); ++i) {
        std::uint32_t size = 0;
        if (!take(packed, size)) return std::nullopt;
        start[i + 1] = start[i] + size;
    }
    if (packed.size() < start.back()) return std::nullopt;
    std::vector<std::byte> data(static_cast<std::size_t>(bytes));
    std::atomic<bool> isWhole{true};
    core::parallelFor(start.size() - 1, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t wanted = std::min(kPiece, data.size() - i * kPiece);
            auto size = static_cast<uLongf>(wanted);
            if (uncompress(reinterpret_cast<Bytef*>(data.data() + i * kPiece), &size,
                           reinterpret_cast<const Bytef*>(packed.data() + start[i]),
                           static_cast<uLong>(start[i + 1] - start[i])) != Z_OK ||
                size != wanted)
                isWhole = false;
        }
    });
    if (!isWhole) return std::nullopt;
    packed = packed.subspan(start.back());
    return data;
}

std::vector<std::byte> inPlanes(std::span<const std::byte> data, std::size_t width) {
    const std::size_t count = data.size() / width;
    std::vector<std::byte> planes(count * width);
    for (std::size_t k = 0; k < width; ++k)
        for (std::size_t i = 0; i < count; ++i)
            planes[k * count + i] = data[i * width + k];
    return planes;
}

std::vector<std::byte> fromPlanes(std::span<const std::byte> planes, std::size_t width) {
    const std::size_t count = planes.size() / width;
    std::vector<std::byte> data(count * width);
    for (std::size_t k = 0; k < width; ++k)
        for (std::size_t i = 0; i < count; ++i)
            data[i * width + k] = planes[k * count + i];
    return data;
}

}  // namespace handpiece::prepared
