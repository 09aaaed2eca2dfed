// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "handpiece/base/core/error.h"

namespace handpiece::core {
namespace fs = std::filesystem;
namespace {

std::string reason() {
    return std::strerror(errno);
}

struct Descriptor {
    explicit Descriptor(int opened) : value(opened) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (value >= 0) ::close(value);
    }
    const int value;
};

constexpr std::size_t kMaxAtOnce = std::size_t{1} << 30;  // write() takes no more than 2 GB

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

fs::file_status statusOf(const fs::path& path) {
    std::error_code ec;
    const fs::file_status status = fs::status(path, ec);
    // Below a file there is nothing either.
    if (fs::status_known(status) || ec == std::errc::not_a_directory) return status;
    throw Error(fmt::format("cannot be looked at: {}", ec.message()), path.string(),
                "check the name and the permissions of the folders above it")
        .as("not-readable", {ec.message()});
}

bool isThere(const fs::path& path) {
    return fs::exists(statusOf(path));
}

bool isFolder(const fs::path& path) {
    return fs::is_directory(statusOf(path));
}

fs::path wholePath(const fs::path& path) {
    std::error_code ec;
    fs::path whole = path.empty() ? fs::current_path(ec) : fs::absolute(path, ec);
    if (ec)
        throw Error(fmt::format("the folder that one works in cannot be found: {}", ec.message()), path.string(),
                    "change to another folder, or give the whole path")
            .as("not-readable", {ec.message()});
    return whole;
}

void requireReplaceable(const fs::path& folder, const std::string& marker) {
    const fs::file_status status = statusOf(folder);
    if (!fs::exists(status)) return;
    std::error_code ec;
    if (fs::is_directory(status) && (isThere(folder / marker) || fs::is_empty(folder, ec)) && !ec) return;
    if (ec)
        throw Error(fmt::format("this folder cannot be read: {}", ec.message()), folder.string(),
                    "check its permissions, or name a new folder")
            .as("not-readable", {ec.message()});
    throw Error("this holds something else and is not replaced", folder.string(),
                fmt::format("name a new folder, or one with an old {}", marker));
}

PrivateFolder::PrivateFolder() {
    std::error_code ec;
    std::string name = (fs::temp_directory_path(ec) / "handpiece-XXXXXX").string();
    if (ec || mkdtemp(name.data()) == nullptr)
        throw Error(fmt::format("no temporary folder can be made: {}", ec ? ec.message() : reason()), name,
                    "make room there, or set TMPDIR")
            .as("not-writable", {ec ? ec.message() : reason()});
    path_ = name;
}

PrivateFolder::~PrivateFolder() {
    std::error_code left;  // what is left in the temporary folder harms nobody
    fs::remove_all(path_, left);
}

FileStream openFile(const fs::path& path) {
    const auto refuse = [&path](std::string problem, std::string remedy = {}) {
        return Error(std::move(problem), path.string(), std::move(remedy));
    };
    const auto requirePlain = [&](const struct stat& status) {
        if (S_ISDIR(status.st_mode)) throw refuse("this is a folder, not a file").as("is-a-folder");
        if (!S_ISREG(status.st_mode))
            throw refuse("this is a device or a pipe, not a plain file", "name a file").as("not-a-file");
    };
    // Looked at first, for opening some devices does something; and again when it is open, for it may be another now.
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0 && (errno == ENOENT || errno == ENOTDIR))
        throw refuse("there is no such file", "check the name").as("file-not-found");
    if (status.st_mode != 0) requirePlain(status);
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    FileStream file(descriptor < 0 ? nullptr : ::fdopen(descriptor, "rb"));
    if (!file)
        throw refuse(fmt::format("cannot be read: {}", reason()), "check its permissions")
            .as("not-readable", {reason()});
    if (::fstat(descriptor, &status) == 0) requirePlain(status);
    return file;
}

bool isOurs(const fs::path& path) {
    struct stat status {};
    return ::lstat(path.c_str(), &status) == 0 && status.st_uid == ::geteuid() && !S_ISLNK(status.st_mode);
}

FileStream openOwnFile(const fs::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY | O_NOFOLLOW);
    FileStream file(descriptor < 0 ? nullptr : ::fdopen(descriptor, "rb"));
    struct stat status {};
    const bool own = file && ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) &&
                     status.st_uid == ::geteuid() && (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
    if (!own) file.reset();
    return file;
}

FileStream createOwnFile(const fs::path& path) {
    struct stat status {};
    const bool isDevice = ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
    if (!isDevice) ::unlink(path.c_str());
    const int descriptor =
        ::open(path.c_str(), isDevice ? O_RDWR | O_CLOEXEC : O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR);
    return FileStream(descriptor < 0 ? nullptr : ::fdopen(descriptor, "w+b"));
}

std::uint64_t sizeOf(const FileStream& file) {
    struct stat status {};
    return ::fstat(::fileno(file.get()), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

std::vector<std::byte> readFile(const fs::path& path, std::uint64_t limitBytes) {
    const FileStream file = openFile(path);
    const std::uint64_t size = sizeOf(file);
    const auto tooLarge = [&](std::uint64_t bytes) {
        return Error(fmt::format("the file has {} bytes, more than the {} that are read", bytes, limitBytes),
                     path.string())
            .as("too-large");
    };
    if (size > limitBytes) throw tooLarge(size);
    std::vector<std::byte> data(size);
    data.resize(size == 0 ? 0 : std::fread(data.data(), 1, size, file.get()));
    // It may grow, and the system's own files do not tell their size: read on until the end.
    std::byte chunk[65536];
    for (std::size_t got; (got = std::fread(chunk, 1, sizeof chunk, file.get())) > 0;) {
        data.insert(data.end(), chunk, chunk + got);
        if (data.size() > limitBytes) throw tooLarge(data.size());
    }
    if (std::ferror(file.get()))
        throw Error(fmt::format("cannot be read: {}", reason()), path.string()).as("not-readable", {reason()});
    return data;
}

std::string writeErrorId(int errorNumber) {
    const bool full = errorNumber == ENOSPC || errorNumber == EDQUOT || errorNumber == EFBIG;
    return full ? "no-space" : "not-writable";
}

int replaceFile(const fs::path& made, const fs::path& path, bool lasting) {
    const Descriptor file(::open(made.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat old {};
    const bool replaces = ::stat(path.c_str(), &old) == 0;
    if (replaces && !S_ISREG(old.st_mode)) return S_ISDIR(old.st_mode) ? EISDIR : ENOTSUP;
    if (replaces && file.value >= 0) {
        // The rights of a group go to that group or to none.
        const bool sameGroup = ::fchown(file.value, static_cast<uid_t>(-1), old.st_gid) == 0;
        (void)::fchmod(file.value, old.st_mode & (sameGroup ? 0777 : 0707));
    }
    // First the bytes, then the name: a name without its bytes would be what a power cut leaves of both files.
    if (lasting && file.value >= 0 && ::fsync(file.value) != 0 && errno != EINVAL && errno != EROFS) return errno;
    if (::rename(made.c_str(), path.c_str()) != 0) return errno;
    if (lasting) {
        const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
        const Descriptor entry(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
        // Not every file system can; the file itself is whole.
        if (entry.value >= 0) (void)::fsync(entry.value);
    }
    return 0;
}

void writeFile(const fs::path& path, std::span<const std::byte> data, Writing how) {
    const fs::path temporary = temporaryBeside(path);
    std::error_code ec;
    int why = 0;
    {
        // Never through a link that lies there, and with no more rights than the file will have.
        const mode_t mode = how.ownerOnly || fs::exists(path, ec) ? 0600 : 0666;
        const Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode));
        if (file.value < 0) why = errno;
        for (std::size_t done = 0; why == 0 && done < data.size();) {
            const ssize_t now = ::write(file.value, data.data() + done, std::min(data.size() - done, kMaxAtOnce));
            if (now > 0)
                done += static_cast<std::size_t>(now);
            else if (errno != EINTR)
                why = errno;
        }
    }
    if (why == 0) why = replaceFile(temporary, path, how.lasting);
    if (why == 0) return;
    fs::remove(temporary, ec);
    throw Error(fmt::format("cannot be written: {}", std::strerror(why)), path.string(),
                "check the folder, its permissions and the free space")
        .as(writeErrorId(why), {std::strerror(why)});
}

void writeFile(const fs::path& path, std::string_view text, Writing how) {
    writeFile(path, std::as_bytes(std::span(text)), how);
}

void prepareOutputFolder(const fs::path& path, bool ownerOnly) {
    std::error_code ec;
    if (ownerOnly && path.has_parent_path()) {
        fs::create_directories(path.parent_path(), ec);
        (void)::mkdir(path.c_str(), 0700);
    }
    fs::create_directories(path, ec);
    std::error_code none;
    if (!fs::is_directory(path, none))
        throw Error(
            fmt::format("cannot be created as a folder: {}", ec ? ec.message() : "a file of that name is in the way"),
            path.string(), "name another output folder")
            .as("not-writable", {ec.message()});
    const fs::path probe = temporaryBeside(path / "probe");
    FileStream file(std::fopen(probe.string().c_str(), "wb"));
    if (!file)
        throw Error(fmt::format("nothing can be written into this folder: {}", reason()), path.string(),
                    "name another output folder")
            .as("not-writable", {reason()});
    file.reset();
    fs::remove(probe, ec);
}

}  // namespace handpiece::core
