// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/file.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "handpiece/base/core/error.h"

namespace handpiece::core {
namespace fs = std::filesystem;
namespace {

struct CloseFile {
    void operator()(std::FILE* f) const noexcept { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

std::string reason() {
    return std::strerror(errno);
}

// Unique within this process and between processes: two writers never share a temporary.
fs::path temporaryBeside(const fs::path& path) {
    static std::atomic<unsigned> counter{0};
    static const auto salt = reinterpret_cast<std::uintptr_t>(&counter) ^
                             static_cast<std::uintptr_t>(fs::file_time_type::clock::now().time_since_epoch().count());
    fs::path temporary = path;
    temporary += fmt::format(".{:x}-{}.part", salt, counter++);
    return temporary;
}

}  // namespace

std::vector<std::byte> readFile(const fs::path& path, std::uint64_t limitBytes) {
    std::error_code ec;
    const fs::file_status status = fs::status(path, ec);
    if (!fs::exists(status)) throw Error("there is no such file", path.string(), "check the name").as("file-not-found");
    if (fs::is_directory(status)) throw Error("this is a folder, not a file", path.string()).as("is-a-folder");
    File file(std::fopen(path.string().c_str(), "rb"));
    if (!file)
        throw Error(fmt::format("cannot be read: {}", reason()), path.string(), "check its permissions")
            .as("not-readable", {reason()});
    std::vector<std::byte> data;
    const std::uint64_t size = fs::is_regular_file(status) ? fs::file_size(path, ec) : 0;
    if (size > limitBytes)
        throw Error(fmt::format("the file has {} bytes, more than the {} that are read", size, limitBytes),
                    path.string())
            .as("too-large");
    data.resize(size);
    std::size_t have = size == 0 ? 0 : std::fread(data.data(), 1, size, file.get());
    data.resize(have);
    // A pipe has no size, and a file may grow: read on until the end.
    std::byte chunk[65536];
    for (std::size_t got; (got = std::fread(chunk, 1, sizeof chunk, file.get())) > 0;) {
        data.insert(data.end(), chunk, chunk + got);
        if (data.size() > limitBytes)
            throw Error(fmt::format("the input has more than the {} bytes that are read", limitBytes), path.string());
    }
    if (std::ferror(file.get()))
        throw Error(fmt::format("cannot be read: {}", reason()), path.string()).as("not-readable", {reason()});
    return data;
}

std::string writeErrorId(int errorNumber) {
    const bool full = errorNumber == ENOSPC || errorNumber == EDQUOT || errorNumber == EFBIG;
    return full ? "no-space" : "not-writable";
}

void writeFile(const fs::path& path, std::span<const std::byte> data) {
    const fs::path temporary = temporaryBeside(path);
    bool written = false;
    int why = 0;
    {
        File file(std::fopen(temporary.string().c_str(), "wb"));
        if (!file) {
            why = errno;
        } else {
            written = data.empty() || std::fwrite(data.data(), 1, data.size(), file.get()) == data.size();
            written = written && std::fflush(file.get()) == 0;
            if (!written) why = errno;
            if (std::fclose(file.release()) != 0 && written) {
                written = false;
                why = errno;
            }
        }
    }
    std::error_code ec;
    if (written) {
        fs::rename(temporary, path, ec);
        if (!ec) return;
        why = ec.value();
    }
    fs::remove(temporary, ec);
    throw Error(fmt::format("cannot be written: {}", std::strerror(why)), path.string(),
                "check the folder, its permissions and the free space")
        .as(writeErrorId(why), {std::strerror(why)});
}

void writeFile(const fs::path& path, std::string_view text) {
    writeFile(path, std::as_bytes(std::span(text)));
}

void prepareOutputFolder(const fs::path& path) {
    std::error_code ec;
    fs::create_directories(path, ec);
    if (!fs::is_directory(path))
        throw Error(
            fmt::format("cannot be created as a folder: {}", ec ? ec.message() : "a file of that name is in the way"),
            path.string(), "name another output folder")
            .as("not-writable", {ec.message()});
    const fs::path probe = temporaryBeside(path / "probe");
    File file(std::fopen(probe.string().c_str(), "wb"));
    if (!file)
        throw Error(fmt::format("nothing can be written into this folder: {}", reason()), path.string(),
                    "name another output folder")
            .as("not-writable", {reason()});
    file.reset();
    fs::remove(probe, ec);
}

}  // namespace handpiece::core
