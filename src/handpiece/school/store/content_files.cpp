// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/store/content_files.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::school {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kHashDigits = 64, kStationDigits = 32;

std::string hexOf(const std::array<unsigned char, crypto_hash_sha256_BYTES>& hash) {
    std::string text;
    for (const unsigned char byte : hash)
        text += fmt::format("{:02x}", byte);
    return text;
}

core::Error notWritable(const fs::path& path, int why) {
    return core::Error(fmt::format("cannot be written: {}", std::strerror(why)), path.string(),
                       "make room, or check the folder's permissions")
        .as(core::writeErrorId(why), {std::strerror(why)});
}

std::int64_t millisecondsOf(fs::file_time_type time) {
    return std::chrono::duration_cast<std::chrono::milliseconds>(
               std::chrono::file_clock::to_sys(time).time_since_epoch())
        .count();
}

}  // namespace

struct Sha256::State {
    crypto_hash_sha256_state hashed;
};
Sha256::Sha256() : state_(std::make_unique<State>()) {
    crypto_hash_sha256_init(&state_->hashed);
}
Sha256::~Sha256() = default;
void Sha256::add(std::span<const std::byte> piece) {
    crypto_hash_sha256_update(&state_->hashed, reinterpret_cast<const unsigned char*>(piece.data()), piece.size());
}
std::string Sha256::text() {
    std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
    crypto_hash_sha256_final(&state_->hashed, hash.data());
    return hexOf(hash);
}

std::string sha256(std::string_view bytes) {
    Sha256 hash;
    hash.add(std::as_bytes(std::span(bytes)));
    return hash.text();
}

std::string sha256Of(const fs::path& path) {
    const core::FileStream file = core::openFile(path);
    Sha256 hash;
    std::vector<std::byte> piece(1 << 18);
    for (std::size_t got; (got = std::fread(piece.data(), 1, piece.size(), file.get())) > 0;)
        hash.add(std::span(piece).first(got));
    if (std::ferror(file.get()))
        throw core::Error(fmt::format("cannot be read: {}", std::strerror(errno)), path.string(), "check the disk")
            .as("not-readable", {std::strerror(errno)});
    return hash.text();
}

bool isHex(std::string_view text, std::size_t length) {
    return text.size() == length && std::all_of(text.begin(), text.end(), [](char c) {
               return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
           });
}

ContentFiles::ContentFiles(fs::path folder) : folder_(std::move(folder)) {
    core::prepareOutputFolder(folder_ / "files", true);
    core::prepareOutputFolder(folder_ / "uploads", true);
}

fs::path ContentFiles::path(const std::string& hash) const {
    if (!isHex(hash, kHashDigits))
        throw core::Error("this is no hash of a file", hash.substr(0, kHashDigits), "send its SHA-256, 64 digits")
            .as("books-invalid", {"hash"});
    return folder_ / "files" / hash;
}

fs::path ContentFiles::pieces(const Upload& upload) const {
    static_cast<void>(path(upload.hash));
    if (!isHex(upload.station, kStationDigits))
        throw core::Error("this is no id of a station", upload.station.substr(0, kStationDigits), "enrol the station")
            .as("books-invalid", {"station"});
    if (upload.bytes == 0)
        throw core::Error("an empty file is no session", upload.hash, "send how many bytes it has")
            .as("books-invalid", {"bytes"});
    return folder_ / "uploads" / (upload.station + "-" + upload.hash);
}

bool ContentFiles::has(const std::string& hash) const {
    return core::isThere(path(hash));
}

std::uint64_t ContentFiles::received(const Upload& upload) const {
    const fs::path part = pieces(upload), whole = path(upload.hash);
    std::error_code none;
    if (const std::uintmax_t size = fs::file_size(whole, none); !none && size != upload.bytes)
        throw core::Error(fmt::format("{} bytes are promised, and this file has {}", upload.bytes, size), upload.hash,
                          "send its own size")
            .as("books-invalid", {"bytes"});
    const std::uintmax_t size = fs::file_size(part, none);
    return none ? 0 : size;
}

bool ContentFiles::append(const Upload& upload, std::uint64_t offset, std::span<const std::byte> piece) {
    const fs::path part = pieces(upload), whole = path(upload.hash);
    const std::uint64_t there = received(upload);
    std::error_code none;
    if (offset != there || piece.size() > upload.bytes - there)
        throw core::Error(fmt::format("{} of {} bytes are there, and {} came for place {}", there, upload.bytes,
                                      piece.size(), offset),
                          upload.hash, fmt::format("go on from {}", there))
            .as("upload-offset", {std::to_string(there)});
    {
        const core::FileStream file =
            there == 0 ? core::createOwnFile(part) : core::FileStream(std::fopen(part.c_str(), "r+b"));
        if (!file) throw notWritable(part, errno);
        std::setvbuf(file.get(), nullptr, _IONBF, 0);
        if (std::fseek(file.get(), static_cast<long>(there), SEEK_SET) != 0 ||
            std::fwrite(piece.data(), 1, piece.size(), file.get()) != piece.size())
            throw notWritable(part, errno);
    }
    if (there + piece.size() < upload.bytes) return false;
    if (const std::string is = sha256Of(part); is != upload.hash) {
        fs::remove(part, none);
        throw core::Error("what came is not what was promised: its SHA-256 is " + is, upload.hash,
                          "send it again from the beginning")
            .as("upload-mismatch", {is});
    }
    // Another station, or the same one twice, may have brought it before: this one has shown that it has it, too.
    if (has(upload.hash)) {
        fs::remove(part, none);
        return true;
    }
    if (const int why = core::replaceFile(part, whole, true); why != 0 && !has(upload.hash))
        throw notWritable(whole, why);
    return true;
}

void ContentFiles::remove(const std::string& hash) {
    std::error_code why;
    fs::remove(path(hash), why);
    if (why) throw notWritable(path(hash), why.value());
}

std::vector<std::string> ContentFiles::all() const {
    std::vector<std::string> hashes;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder_ / "files", none))
        if (entry.is_regular_file(none) && isHex(entry.path().filename().string(), kHashDigits))
            hashes.push_back(entry.path().filename().string());
    std::sort(hashes.begin(), hashes.end());
    return hashes;
}

void ContentFiles::removeUploadsBefore(std::int64_t time) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder_ / "uploads", none))
        if (const auto last = entry.last_write_time(none); !none && millisecondsOf(last) < time)
            fs::remove(entry.path(), none);
}

std::int64_t ContentFiles::madeAt(const std::string& hash) const {
    std::error_code why;
    const auto last = fs::last_write_time(path(hash), why);
    return why ? 0 : millisecondsOf(last);
}

}  // namespace handpiece::school
