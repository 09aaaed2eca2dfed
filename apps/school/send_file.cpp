// SPDX-License-Identifier: Apache-2.0
#include "school/send_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace handpiece::school_station {
namespace {

constexpr std::uint64_t kLeastPiece = 64 << 10;

std::string pieceOf(const std::filesystem::path& file, std::uint64_t offset, std::size_t bytes) {
    std::ifstream in(file, std::ios::binary);
    std::string piece(bytes, '\0');
    in.seekg(static_cast<std::streamoff>(offset));
    if (!in.read(piece.data(), static_cast<std::streamsize>(bytes)))
        throw core::Error("the recording cannot be read", file.string(), "see whether the disk is all right");
    return piece;
}

}  // namespace

std::uint64_t sendFile(Line& line, const std::filesystem::path& file, const std::string& hash) {
    const std::uint64_t bytes = std::filesystem::file_size(file);
    school_wire::Received there =
        school_wire::receivedFrom(line.get(fmt::format("/api/v1/files/{}?bytes={}", hash, bytes)));
    std::uint64_t sent = 0, most = school_wire::kMostPiece;
    while (!there.isWhole) {
        if (there.bytes > bytes) throw core::Error("it has more of a file than there is", file.string());
        const std::uint64_t next = std::min(bytes - there.bytes, most);
        const std::string piece = pieceOf(file, there.bytes, static_cast<std::size_t>(next));
        try {
            there = school_wire::receivedFrom(
                line.put(fmt::format("/api/v1/files/{}?bytes={}&offset={}", hash, bytes, there.bytes), piece));
        } catch (const core::Error& e) {
            // A network that never holds for a whole piece still gets ahead, by smaller ones.
            if (e.id() != "server-silent" || most <= kLeastPiece) throw;
            most = std::max(most / 4, kLeastPiece);
            there = school_wire::receivedFrom(line.get(fmt::format("/api/v1/files/{}?bytes={}", hash, bytes)));
            continue;
        }
        most = std::min<std::uint64_t>(2 * most, school_wire::kMostPiece);
        sent += piece.size();
        if (there.bytes >= bytes) break;
    }
    return sent;
}

}  // namespace handpiece::school_station
