// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/keeping/backup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <optional>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/large_package.h"
#include "handpiece/school/store/books_copy.h"

namespace handpiece::school {
namespace {

namespace fs = std::filesystem;

constexpr int kFormat = 1;
constexpr const char* kManifest = "backup.toml";
constexpr std::size_t kMostKey = 1 << 16;

/// In a folder: on the same disk, so that files are moved and linked. Goes with all that is in it.
class Workplace {
  public:
    explicit Workplace(const fs::path& in) : path_(in / fmt::format(".handpiece-{}", newId())) {
        core::prepareOutputFolder(path_, true);
    }
    ~Workplace() {
        std::error_code none;
        fs::remove_all(path_, none);
    }
    Workplace(const Workplace&) = delete;
    Workplace& operator=(const Workplace&) = delete;
    [[nodiscard]] const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

core::Error damaged(const fs::path& file, const std::string& part, const std::string& why) {
    return core::Error(fmt::format("{} in this backup {}", part, why), file.string(), "take another backup")
        .as("store-damaged", {part});
}

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

struct Manifest {
    BooksCopy copy;
    std::map<std::string, std::string> hashes;  ///< of tables' files, by their names
    std::map<std::string, std::string> keys;    ///< likewise
};

Manifest manifestOf(const cases::LargePackage& package, const fs::path& file) {
    const auto found = package.files().find(kManifest);
    if (found == package.files().end() || found->second > config::Table::kMaxBytes)
        throw core::Error("this is a zip file, and no backup of a school", file.string(),
                          "name one that handpiece school backup wrote")
            .as("not-a-package", {kManifest});
    std::string text;
    package.read(kManifest, [&](std::span<const std::byte> piece) {
        text.append(reinterpret_cast<const char*>(piece.data()), piece.size());
    });
    const config::Table toml = config::Table::parse(text, file.string() + "/" + kManifest);
    if (const auto format = toml.integer("format"); format != kFormat)
        throw core::Error(
            fmt::format("this backup is of format {}, and this program knows {}", format.value_or(0), kFormat),
            file.string(), "restore it with the newer Handpiece")
            .as("store-newer", {std::to_string(format.value_or(0)), std::to_string(kFormat)});
    Manifest manifest;
    manifest.copy.version = static_cast<int>(toml.integer("books").value_or(0));
    for (const config::Table& one : toml.tables("table")) {
        const std::string name = one.text("name").value_or("");
        const bool isPlain = !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == name.npos;
        if (!isPlain) throw damaged(file, kManifest, "names a table that is none");
        manifest.copy.tables.push_back({name, one.integer("rows").value_or(-1)});
        manifest.hashes[name] = one.text("sha256").value_or("");
    }
    for (const config::Table& one : toml.tables("key")) {
        const std::string name = one.text("name").value_or("");
        if (std::find(std::begin(kServerKeys), std::end(kServerKeys), name) == std::end(kServerKeys))
            throw damaged(file, kManifest, "names a key that is none");
        manifest.keys[name] = one.text("sha256").value_or("");
    }
    std::int64_t files = 0;
    for (const auto& [name, bytes] : package.files())
        if (name.starts_with("files/")) {
            ++files;
            manifest.copy.files.push_back(name.substr(6));
            if (!isHex(manifest.copy.files.back(), 64))
                throw damaged(file, name.substr(0, 80), "has a name that is none");
        }
    if (files != toml.integer("files"))
        throw damaged(file, kManifest, fmt::format("promises other than {} files", files));
    return manifest;
}

/// Each part with its hash; `keep` takes it.
Backup readAll(const cases::LargePackage& package, const Manifest& manifest, const fs::path& file,
               const std::optional<fs::path>& folder, const core::Progress& progress) {
    std::uint64_t all = 1, done = 0;
    for (const auto& [name, bytes] : package.files())
        all += bytes;
    Backup backup;
    const auto read = [&](const std::string& name, const std::string& expected, const fs::path& to) {
        if (package.files().count(name) == 0) throw damaged(file, name, "is missing");
        core::FileStream out;
        if (folder) {
            out = core::createOwnFile(to);
            if (!out)
                throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), to.string(), "make room")
                    .as(core::writeErrorId(errno), {std::strerror(errno)});
        }
        Sha256 hash;
        package.read(name, [&](std::span<const std::byte> piece) {
            hash.add(piece);
            if (out && std::fwrite(piece.data(), 1, piece.size(), out.get()) != piece.size())
                throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), to.string(), "make room")
                    .as(core::writeErrorId(errno), {std::strerror(errno)});
            done += piece.size();
            core::report(progress, static_cast<double>(done) / static_cast<double>(all));
        });
        if (out && std::fflush(out.get()) != 0)
            throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), to.string(), "make room")
                .as(core::writeErrorId(errno), {std::strerror(errno)});
        if (hash.text() != expected) throw damaged(file, name, "is not what was put into it");
    };
    for (const CopiedTable& table : manifest.copy.tables) {
        const std::string name = table.name + ".tsv";
        read("tables/" + name, manifest.hashes.at(table.name), folder.value_or(fs::path()) / name);
        backup.rows += table.rows;
    }
    for (const std::string& one : manifest.copy.files) {
        read("files/" + one, one, folder.value_or(fs::path()) / "files" / one);
        backup.bytes += package.files().at("files/" + one);
        ++backup.files;
    }
    for (const auto& [name, hash] : manifest.keys) {
        read("keys/" + name, hash, folder.value_or(fs::path()) / name);
        ++backup.keys;
    }
    return backup;
}

/// Into its place; what was there and is another one stays beside it.
void placeKey(const fs::path& from, const fs::path& to) {
    if (core::isThere(to)) {
        if (core::readFile(to, kMostKey) == core::readFile(from, kMostKey)) return;
        fs::path aside;
        for (int i = 1; aside.empty() || core::isThere(aside); ++i)
            aside = fmt::format("{}.before-restore-{}", to.string(), i);
        fs::rename(to, aside);
    }
    core::writeFile(to, core::readFile(from, kMostKey), {.ownerOnly = true});
}

}  // namespace

Backup backUp(const fs::path& data, const std::string& address, const fs::path& file, Milliseconds now,
              const std::string& program, bool keys, const core::Progress& progress) {
    core::prepareOutputFolder(data, true);
    const Workplace place(data);
    const BooksCopy copy = copyBooks(data, address, place.path());
    std::string toml = fmt::format("format = {}\nbooks = {}\nprogram = \"{}\"\nmade_ms = {}\nfiles = {}\n", kFormat,
                                   copy.version, program, now, copy.files.size());
    std::map<std::string, fs::path> parts;
    Backup backup;
    for (const CopiedTable& table : copy.tables) {
        const fs::path tsv = place.path() / (table.name + ".tsv");
        toml += fmt::format("\n[[table]]\nname = \"{}\"\nrows = {}\nsha256 = \"{}\"\n", table.name, table.rows,
                            sha256Of(tsv));
        parts["tables/" + table.name + ".tsv"] = tsv;
        backup.rows += table.rows;
    }
    for (const std::string& hash : copy.files) {
        parts["files/" + hash] = place.path() / "files" / hash;
        backup.bytes += fs::file_size(place.path() / "files" / hash);
        ++backup.files;
    }
    cases::PackageFiles small;
    for (const char* name : kServerKeys) {
        if (!keys || !core::isThere(data / name)) continue;
        const std::vector<std::byte> key = core::readFile(data / name, kMostKey);
        toml += fmt::format("\n[[key]]\nname = \"{}\"\nsha256 = \"{}\"\n", name, sha256Of(data / name));
        small[fmt::format("keys/{}", name)] = key;
        ++backup.keys;
    }
    small[kManifest] = bytesOf(toml);
    cases::writeLargePackage(file, small, parts, progress);
    return backup;
}

Backup checkBackup(const fs::path& file, const core::Progress& progress) {
    const cases::LargePackage package(file);
    return readAll(package, manifestOf(package, file), file, {}, progress);
}

Backup restore(const fs::path& file, const fs::path& data, const std::string& address, const core::Progress& progress) {
    const cases::LargePackage package(file);
    const Manifest manifest = manifestOf(package, file);
    core::prepareOutputFolder(data, true);
    const Workplace place(data);
    core::prepareOutputFolder(place.path() / "files", true);
    const Backup backup = readAll(package, manifest, file, place.path(), progress);
    loadBooks(manifest.copy, place.path(), data, address);
    for (const auto& [name, hash] : manifest.keys)
        placeKey(place.path() / name, data / name);
    return backup;
}

}  // namespace handpiece::school
