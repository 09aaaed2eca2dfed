// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Files by what is in them (SHA-256), in a folder of a school's server: sessions and exercise packs. They come in
/// pieces, and lie there whole and proven or not at all.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::school {

/// SHA-256 of what comes piece by piece.
class Sha256 {
  public:
    Sha256();
    ~Sha256();
    Sha256(const Sha256&) = delete;
    Sha256& operator=(const Sha256&) = delete;
    void add(std::span<const std::byte> piece);
    /// 64 hexadecimal digits, small; nothing is added after it.
    [[nodiscard]] std::string text();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// 64 hexadecimal digits, small.
[[nodiscard]] std::string sha256(std::string_view bytes);
/// Of a file, read piece by piece. Throws core::Error.
[[nodiscard]] std::string sha256Of(const std::filesystem::path& file);
/// `length` digits of 0-9a-f and nothing else: such a text is safe in a file's name.
[[nodiscard]] bool isHex(std::string_view text, std::size_t length);

/// One that comes.
struct Upload {
    std::string station;      ///< 32 hexadecimal digits: two stations that send one file never write into each other's
    std::string hash;         ///< sha256
    std::uint64_t bytes = 0;  ///< of all of it
};

/// One process or several may work in one folder. Throws core::Error: "books-invalid" (a hash, station or size that is
/// none), "no-space", "not-writable", "upload-offset" (what is there already, in bytes), "upload-mismatch".
class ContentFiles {
  public:
    /// Makes `files` and `uploads` in it.
    explicit ContentFiles(std::filesystem::path folder);

    [[nodiscard]] std::filesystem::path path(const std::string& hash) const;
    [[nodiscard]] bool has(const std::string& hash) const;
    /// How much of it is there: from where to go on. All: it lies in its place.
    [[nodiscard]] std::uint64_t received(const Upload& upload) const;
    /// The next piece, which begins at `offset` == received() and may be empty. True: all of it is there, is what was
    /// promised, and lies on the disk under its name, or did so already. What is not as promised is thrown away, and
    /// comes anew from 0.
    bool append(const Upload& upload, std::uint64_t offset, std::span<const std::byte> piece);
    /// Nothing where it is not there.
    void remove(const std::string& hash);
    /// Hashes of all that lie there.
    [[nodiscard]] std::vector<std::string> all() const;
    /// Pieces of uploads that nobody went on with since then [ms since 1970].
    void removeUploadsBefore(std::int64_t time);
    /// When it came to lie there [ms since 1970].
    [[nodiscard]] std::int64_t madeAt(const std::string& hash) const;

  private:
    [[nodiscard]] std::filesystem::path pieces(const Upload& upload) const;
    std::filesystem::path folder_;
};

}  // namespace handpiece::school
