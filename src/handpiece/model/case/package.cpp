// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/package.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/taken_from.h"

namespace handpiece::cases {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxPackedBytes = 1ull << 30;
constexpr std::size_t kLongestName = 200;
constexpr unsigned kFileTypeBits = 0170000, kRegularFile = 0100000, kFolder = 0040000;

struct DiscardArchive {
    void operator()(zip_t* archive) const noexcept { zip_discard(archive); }
};
struct FreeSource {
    void operator()(zip_source_t* source) const noexcept { zip_source_free(source); }
};
struct CloseEntry {
    void operator()(zip_file_t* file) const noexcept { zip_fclose(file); }
};
using Archive = std::unique_ptr<zip_t, DiscardArchive>;
using Source = std::unique_ptr<zip_source_t, FreeSource>;
using Entry = std::unique_ptr<zip_file_t, CloseEntry>;

std::string messageOf(zip_error_t& error) {
    std::string text = zip_error_strerror(&error);
    zip_error_fini(&error);
    return text;
}

/// The name as it may be shown: no control characters.
std::string shown(std::string_view name) {
    std::string out;
    for (const char c : name.substr(0, 60))
        out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
    return out;
}

/// Why a name may not be in a package, or nothing.
std::string_view wrongWith(std::string_view name) {
    if (name.empty()) return "it is empty";
    if (name.size() > kLongestName) return "it is too long";
    if (name.front() == '/') return "it is absolute";
    for (const char c : name)
        if (c == '\\' || c == ':' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            return "it holds a character that no file here has";
    for (std::size_t at = 0; at <= name.size();) {
        const std::size_t slash = std::min(name.find('/', at), name.size());
        const std::string_view step = name.substr(at, slash - at);
        if (step == "..") return "it leads outside";
        if (step == "." || step.empty()) return "it has an empty step";
        at = slash + 1;
    }
    return {};
}

std::vector<std::byte> readEntry(zip_t* archive, zip_uint64_t index, std::uint64_t size, const std::string& where,
                                 const std::string& name) {
    const auto damaged = [&] {
        return core::Error(fmt::format("\"{}\" in it is damaged", shown(name)), where, "copy the file again")
            .as("not-a-package", {std::string(shown(name))});
    };
    const Entry entry(zip_fopen_index(archive, index, 0));
    if (!entry) throw damaged();
    std::vector<std::byte> data(size);
    std::uint64_t have = 0;
    while (have < size) {
        const zip_int64_t got = zip_fread(entry.get(), data.data() + have, size - have);
        if (got <= 0) throw damaged();
        have += static_cast<std::uint64_t>(got);
    }
    // The end must come here; asking for it also checks the sum.
    std::byte more;
    if (zip_fread(entry.get(), &more, 1) != 0) throw damaged();
    return data;
}

struct Listed {
    zip_uint64_t index;
    std::uint64_t bytes;
    std::string name;
};

/// The files of an archive, after a look at all that it promises.
std::vector<Listed> listOf(zip_t* archive, std::uint64_t packedBytes, const std::string& where,
                           const PackageLimits& limits) {
    const auto refuse = [&where](std::string problem) {
        return core::Error(std::move(problem), where, "get it from where it was made");
    };
    const auto count = static_cast<std::uint64_t>(std::max<zip_int64_t>(0, zip_get_num_entries(archive, 0)));
    if (count > limits.files) throw refuse(fmt::format("it holds {} files, more than {}", count, limits.files));
    std::vector<Listed> files;
    std::uint64_t total = 0;
    for (zip_uint64_t i = 0; i < count; ++i) {
        zip_stat_t stat;
        constexpr zip_uint64_t kNeeded =
            ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_ENCRYPTION_METHOD;
        if (zip_stat_index(archive, i, 0, &stat) != 0 || (stat.valid & kNeeded) != kNeeded)
            throw refuse(fmt::format("its file {} is damaged", i + 1));
        std::string name = stat.name;
        const bool isFolder = name.size() > 1 && name.back() == '/';
        if (isFolder) name.pop_back();
        if (const std::string_view wrong = wrongWith(name); !wrong.empty())
            throw refuse(fmt::format("the name \"{}\" in it is refused: {}", shown(name), wrong));
        if (stat.encryption_method != ZIP_EM_NONE) throw refuse(fmt::format("\"{}\" in it is encrypted", shown(name)));
        zip_uint8_t system = 0;
        zip_uint32_t attributes = 0;
        const bool isUnix =
            zip_file_get_external_attributes(archive, i, 0, &system, &attributes) == 0 && system == ZIP_OPSYS_UNIX;
        const unsigned type = isUnix ? attributes >> 16 & kFileTypeBits : 0;
        if (type != 0 && type != kRegularFile && type != kFolder)
            throw refuse(fmt::format("\"{}\" in it is a link or a device", shown(name)));
        if (stat.size > limits.bytes || total + stat.size > limits.bytes)
            throw refuse(fmt::format("unpacked it has more than {} MB", limits.bytes >> 20));
        total += stat.size;
        if (isFolder) {
            if (stat.size != 0) throw refuse(fmt::format("the folder \"{}\" in it has content", shown(name)));
            continue;
        }
        files.push_back({i, stat.size, std::move(name)});
    }
    if (total > limits.bytesOfAnyRatio && static_cast<double>(total) > limits.ratio * static_cast<double>(packedBytes))
        throw refuse(fmt::format("it unpacks to {} times its size, more than {}",
                                 total / std::max<std::uint64_t>(1, packedBytes), limits.ratio));
    return files;
}

PackageFiles unpack(std::span<const std::byte> zip, const std::string& where, const PackageLimits& limits,
                    const std::function<bool(const std::string& name)>& wanted);

}  // namespace

bool isPackageName(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return extension == ".handpiece";
}

PackageFiles readPackage(const fs::path& file, const PackageLimits& limits) {
    return readPackage(core::readFile(core::takenFrom(file), kMaxPackedBytes), file.string(), limits);
}

PackageFiles readPackage(const fs::path& file, const std::function<bool(const std::string& name)>& wanted) {
    return unpack(core::readFile(core::takenFrom(file), kMaxPackedBytes), file.string(), {}, wanted);
}

PackageFiles lookInto(const fs::path& file, const std::function<bool(const std::string& name)>& wanted) {
    return unpack(core::readFile(file, kMaxPackedBytes), file.string(), {}, wanted);
}

PackageFiles readPackage(std::span<const std::byte> zip, const std::string& where, const PackageLimits& limits) {
    return unpack(zip, where, limits, {});
}

namespace {

core::Error namesTwice(std::string_view entry, const std::string& where) {
    return core::Error(fmt::format("it names {} twice", entry), where, "get it from where it was made");
}

PackageFiles unpack(std::span<const std::byte> zip, const std::string& where, const PackageLimits& limits,
                    const std::function<bool(const std::string& name)>& wanted) {
    zip_error_t error;
    zip_error_init(&error);
    Source source(zip_source_buffer_create(zip.data(), zip.size(), 0, &error));
    if (!source) throw core::Error(messageOf(error), where);
    const Archive archive(zip_open_from_source(source.get(), ZIP_RDONLY | ZIP_CHECKCONS, &error));
    if (!archive && zip_error_code_zip(&error) == ZIP_ER_EXISTS) {
        zip_error_fini(&error);
        throw namesTwice("an entry", where);
    }
    if (!archive)
        throw core::Error(fmt::format("this is no .handpiece file or zip, or a damaged one: {}", messageOf(error)),
                          where, "copy the file again")
            .as("not-a-package", {messageOf(error)});
    (void)source.release();  // the archive's now
    PackageFiles files;
    for (const Listed& listed : listOf(archive.get(), zip.size(), where, limits)) {
        const auto [place, isNew] = files.try_emplace(listed.name);
        // libzip compares names as they were written, before it takes them from one code page to another.
        if (!isNew) throw namesTwice(fmt::format("\"{}\"", shown(listed.name)), where);
        if (!wanted || wanted(listed.name))
            place->second = readEntry(archive.get(), listed.index, listed.bytes, where, listed.name);
    }
    if (files.empty())
        throw core::Error("this .handpiece file is empty", where, "copy the file again")
            .as("not-a-package", {"0 bytes"});
    return files;
}

}  // namespace

std::vector<std::byte> packed(const PackageFiles& files) {
    const auto failed = [](std::string why) { return core::Error(fmt::format("cannot be packed: {}", why)); };
    zip_error_t error;
    zip_error_init(&error);
    const Source source(zip_source_buffer_create(nullptr, 0, 0, &error));
    if (!source) throw failed(messageOf(error));
    zip_source_keep(source.get());  // the archive takes one reference, we read the result through the other
    Archive archive(zip_open_from_source(source.get(), ZIP_TRUNCATE, &error));
    if (!archive) {
        zip_source_free(source.get());
        throw failed(messageOf(error));
    }
    for (const auto& [name, data] : files) {
        if (const std::string_view wrong = wrongWith(name); !wrong.empty())
            throw failed(fmt::format("the name \"{}\": {}", shown(name), wrong));
        Source content(zip_source_buffer(archive.get(), data.data(), data.size(), 0));
        if (!content) throw failed(zip_strerror(archive.get()));
        const zip_int64_t index = zip_file_add(archive.get(), name.c_str(), content.get(), ZIP_FL_ENC_UTF_8);
        if (index < 0) throw failed(zip_strerror(archive.get()));
        if (name.ends_with(".h5"))
            zip_set_file_compression(archive.get(), static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0);
        (void)content.release();
        // 1 January 1980, the earliest there is: the same files, the same bytes.
        zip_file_set_dostime(archive.get(), static_cast<zip_uint64_t>(index), 0, 0x21, 0);
        zip_file_set_external_attributes(archive.get(), static_cast<zip_uint64_t>(index), 0, ZIP_OPSYS_UNIX,
                                         (kRegularFile | 0644u) << 16);
    }
    if (zip_close(archive.get()) != 0) throw failed(zip_strerror(archive.get()));
    (void)archive.release();
    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_source_stat(source.get(), &stat) != 0 || (stat.valid & ZIP_STAT_SIZE) == 0 ||
        zip_source_open(source.get()) != 0)
        throw failed("the packed file is lost");
    std::vector<std::byte> bytes(stat.size);
    const zip_int64_t got = zip_source_read(source.get(), bytes.data(), bytes.size());
    zip_source_close(source.get());
    if (got < 0 || static_cast<std::uint64_t>(got) != stat.size) throw failed("the packed file is lost");
    return bytes;
}

void writePackage(const fs::path& file, const PackageFiles& files) {
    core::writeFile(file, packed(files));
}

void writeFolder(const fs::path& folder, const PackageFiles& files, const std::string& marker) {
    const fs::path target = core::wholePath(folder).lexically_normal();
    const fs::path place = target.has_filename() ? target : target.parent_path();
    core::requireReplaceable(place, marker);
    core::prepareOutputFolder(place.parent_path());
    core::Hasher salt;
    salt.add(place.string());
    salt.add(fs::file_time_type::clock::now().time_since_epoch().count());
    const fs::path beside = place.parent_path() / fmt::format("{}.{:x}.part", place.filename().string(), salt.value());
    const fs::path old = place.parent_path() / fmt::format("{}.{:x}.old", place.filename().string(), salt.value());
    std::error_code ec;
    try {
        core::prepareOutputFolder(beside);
        for (const auto& [name, data] : files) {
            if (const std::string_view wrong = wrongWith(name); !wrong.empty())
                throw core::Error(fmt::format("the name \"{}\": {}", shown(name), wrong), folder.string());
            fs::create_directories((beside / name).parent_path());
            core::writeFile(beside / name, data);
        }
        const bool replaces = core::isThere(place);
        // Whoever shares it, or keeps it to oneself, goes on doing so.
        for (const auto& [name, data] : files)
            if (core::isThere(place / name)) fs::permissions(beside / name, fs::status(place / name).permissions());
        if (replaces) fs::permissions(beside, fs::status(place).permissions());
        if (replaces) fs::rename(place, old);
        fs::rename(beside, place);
        if (replaces) fs::remove_all(old, ec);
    } catch (const fs::filesystem_error& e) {
        if (fs::exists(old, ec) && !fs::exists(place, ec)) fs::rename(old, place, ec);
        fs::remove_all(beside, ec);
        throw core::Error(fmt::format("cannot be written: {}", e.code().message()), folder.string(),
                          "check the folder, its permissions and the free space")
            .as("not-writable", {e.code().message()});
    } catch (const core::Error&) {
        fs::remove_all(beside, ec);
        throw;
    }
}

}  // namespace handpiece::cases
