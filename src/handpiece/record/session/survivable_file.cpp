// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/survivable_file.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::session {
namespace fs = std::filesystem;
namespace {

// Superblock of version 2 and 3, by the HDF5 file format specification, with 8-byte offsets.
constexpr std::size_t kSuperblockBytes = 48, kFlagsAt = 11, kEndAt = 28, kChecksumAt = 44;
// The file grows by this much at a time, so that the end noted in the superblock never lies before the data.
constexpr std::uint64_t kGrowthBytes = 1u << 18;
// Metadata is kept from crossing pages of the system's cache, in which a write is done or not done.
constexpr std::uint64_t kPageBytes = 4096;
// Of a file that is not yet sound.
constexpr const char* kBegunSuffix = ".begun";
// Metadata and data each take the file's space in stretches of this much.
constexpr std::uint64_t kMetadataStretch = 1u << 15, kDataStretch = 1u << 17;

/// Jenkins' lookup3 (public domain), as HDF5 takes it over its metadata. `bytes` a multiple of 4 and none of 12.
std::uint32_t checksum(const unsigned char* data, std::uint32_t bytes) {
    std::uint32_t a = 0xdeadbeef + bytes, b = a, c = a;
    const auto word = [&](std::size_t i) {
        std::uint32_t w;
        std::memcpy(&w, data + i, 4);
        return w;
    };
    std::uint32_t at = 0;
    for (; bytes - at > 12; at += 12) {
        a += word(at), b += word(at + 4), c += word(at + 8);
        a -= c, a ^= std::rotl(c, 4), c += b;
        b -= a, b ^= std::rotl(a, 6), a += c;
        c -= b, c ^= std::rotl(b, 8), b += a;
        a -= c, a ^= std::rotl(c, 16), c += b;
        b -= a, b ^= std::rotl(a, 19), a += c;
        c -= b, c ^= std::rotl(b, 4), b += a;
    }
    a += word(at);
    if (bytes - at > 4) b += word(at + 4);
    c ^= b, c -= std::rotl(b, 14);
    a ^= c, a -= std::rotl(c, 11);
    b ^= a, b -= std::rotl(a, 25);
    c ^= b, c -= std::rotl(b, 16);
    a ^= c, a -= std::rotl(c, 4);
    b ^= a, b -= std::rotl(a, 14);
    c ^= b, c -= std::rotl(b, 24);
    return c;
}

struct DriverInfo {
    FileState* state;
    bool isThere;  ///< to go on in, not to be made
};

struct File {
    H5FD_t base;  // first: HDF5 knows this part only
    std::FILE* stream;
    FileState* state;
    haddr_t allocatedEnd, writtenEnd, promisedEnd;
    struct Stretch {
        haddr_t next, end;
    };
    Stretch metadata, numbers;
    bool hasSuperblock;
    std::array<unsigned char, kSuperblockBytes> superblock;  // as HDF5 means it

    void fail(const char* doing) {
        if (state->failure.empty()) {
            state->errorNumber = errno;
            state->failure = fmt::format("{}: {} failed: {}", state->place.string(), doing, std::strerror(errno));
        }
    }
    [[nodiscard]] bool failed() const { return !state->failure.empty(); }

    // Unbuffered: one call of write(2). A process that is killed has done all of it or nothing, but where it crosses
    // a page; allocate() sees to it that metadata does not.
    bool put(haddr_t at, const void* data, std::size_t bytes) {
        if (std::fseek(stream, static_cast<long>(at), SEEK_SET) != 0 || std::fwrite(data, 1, bytes, stream) != bytes) {
            fail("writing");
            return false;
        }
        if (state->observer) state->observer(at, {static_cast<const unsigned char*>(data), bytes});
        return true;
    }
    bool resize(haddr_t bytes) {
        std::error_code ec;
        fs::resize_file(state->begun, bytes, ec);
        if (ec) {
            errno = ec.value();
            fail("growing the file");
            return false;
        }
        if (state->observer) state->observer(bytes, {});
        return true;
    }
    bool putSuperblock(haddr_t end) {
        std::array<unsigned char, kSuperblockBytes> shown = superblock;
        shown[kFlagsAt] = 0;
        const std::uint64_t end64 = end;
        std::memcpy(&shown[kEndAt], &end64, 8);
        const std::uint32_t sum = checksum(shown.data(), kChecksumAt);
        std::memcpy(&shown[kChecksumAt], &sum, 4);
        return put(0, shown.data(), shown.size());
    }
    /// A file that is there: what comes is put behind what it holds.
    bool takeUp() {
        std::error_code ec;
        const std::uintmax_t bytes = fs::file_size(state->begun, ec);
        if (ec || bytes < kSuperblockBytes ||
            std::fread(superblock.data(), 1, kSuperblockBytes, stream) != kSuperblockBytes)
            return false;
        hasSuperblock = true;
        allocatedEnd = writtenEnd = promisedEnd = bytes;
        state->sizeBytes = bytes;
        return true;
    }
    haddr_t allocate(bool isData, hsize_t bytes) {
        Stretch& stretch = isData ? numbers : metadata;
        const auto place = [&] {
            const bool crosses = !isData && stretch.next / kPageBytes != (stretch.next + bytes - 1) / kPageBytes;
            return crosses ? (stretch.next + kPageBytes - 1) / kPageBytes * kPageBytes : stretch.next;
        };
        if (place() + bytes > stretch.end) {
            stretch.next = (allocatedEnd + kPageBytes - 1) / kPageBytes * kPageBytes;
            stretch.end = stretch.next + std::max<haddr_t>(bytes, isData ? kDataStretch : kMetadataStretch);
            allocatedEnd = stretch.end;
        }
        const haddr_t at = place();
        stretch.next = at + bytes;
        return at;
    }
    bool reserve(haddr_t end) {
        if (end <= promisedEnd) return true;
        const haddr_t promised = (end + kGrowthBytes - 1) / kGrowthBytes * kGrowthBytes;
        if (!resize(promised)) return false;
        promisedEnd = promised;
        return !hasSuperblock || putSuperblock(promisedEnd);
    }
};
static_assert(std::is_standard_layout_v<H5FD_t>);

File& fileOf(H5FD_t* f) {
    return *reinterpret_cast<File*>(f);
}
const File& fileOf(const H5FD_t* f) {
    return *reinterpret_cast<const File*>(f);
}

H5FD_t* openFile(const char* name, unsigned flags, hid_t fapl, haddr_t) {
    const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(fapl));
    // Before it makes a file HDF5 asks whether it is there already; what was there is replaced.
    const bool makes = (flags & H5F_ACC_CREAT) != 0;
    if (!info || makes == info->isThere) return nullptr;
    auto file = std::make_unique<File>();
    file->state = info->state;
    file->stream = makes ? core::createOwnFile(name).release() : std::fopen(name, "r+b");
    if (!file->stream) {
        file->fail("opening");
        return nullptr;
    }
    std::setvbuf(file->stream, nullptr, _IONBF, 0);
    if (!makes && !file->takeUp()) {
        std::fclose(file->stream);
        return nullptr;
    }
    return &file.release()->base;
}

herr_t closeFile(H5FD_t* f) {
    const std::unique_ptr<File> file(&fileOf(f));
    // Superblock first: a file longer than it says is sound, a shorter one is not.
    if (!file->failed() && file->hasSuperblock && file->putSuperblock(file->writtenEnd)) {
        file->resize(file->writtenEnd);
    }
    if (std::fclose(file->stream) != 0) file->fail("closing");
    return 0;
}

herr_t queryFile(const H5FD_t*, unsigned long* flags) {
    if (flags) *flags = H5FD_FEAT_SUPPORTS_SWMR_IO | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
}

herr_t readFile(H5FD_t* f, H5FD_mem_t, hid_t, haddr_t at, std::size_t bytes, void* out) {
    File& file = fileOf(f);
    std::memset(out, 0, bytes);
    if (std::fseek(file.stream, static_cast<long>(at), SEEK_SET) != 0) return -1;
    const std::size_t got = std::fread(out, 1, bytes, file.stream);
    if (got != bytes && std::ferror(file.stream)) return -1;
    if (file.hasSuperblock && at < kSuperblockBytes) {
        std::memcpy(out, &file.superblock[at], std::min<std::size_t>(bytes, kSuperblockBytes - at));
    }
    return 0;
}

herr_t writeFile(H5FD_t* f, H5FD_mem_t, hid_t, haddr_t at, std::size_t bytes, const void* data) {
    File& file = fileOf(f);
    // After a failure the disk keeps the last sound state: HDF5 may go on, nothing of it arrives.
    if (file.failed()) return 0;
    file.writtenEnd = std::max(file.writtenEnd, at + bytes);
    file.state->sizeBytes = file.writtenEnd;
    const auto* source = static_cast<const unsigned char*>(data);
    if (!file.reserve(at + bytes)) return 0;
    if (at == 0 && bytes >= kSuperblockBytes) {
        std::memcpy(file.superblock.data(), source, kSuperblockBytes);
        file.hasSuperblock = true;
        if (!file.putSuperblock(file.promisedEnd)) return 0;
        at += kSuperblockBytes, source += kSuperblockBytes, bytes -= kSuperblockBytes;
    }
    if (bytes > 0) file.put(at, source, bytes);
    return 0;
}

const H5FD_class_t& driverClass() {
    static const H5FD_class_t driver = [] {
        H5FD_class_t d{};
        d.name = "handpiece_session";
        d.maxaddr = (haddr_t{1} << 62) - 1;
        d.fc_degree = H5F_CLOSE_STRONG;
        d.fapl_size = sizeof(DriverInfo);
        d.open = openFile;
        d.close = closeFile;
        d.query = queryFile;
        d.alloc = [](H5FD_t* f, H5FD_mem_t type, hid_t, hsize_t bytes) {
            return fileOf(f).allocate(type == H5FD_MEM_DRAW, bytes);
        };
        // Nothing is used again: an older state of the file may still refer to it.
        d.free = [](H5FD_t*, H5FD_mem_t, hid_t, haddr_t, hsize_t) { return herr_t{0}; };
        d.get_eoa = [](const H5FD_t* f, H5FD_mem_t) { return fileOf(f).allocatedEnd; };
        d.set_eoa = [](H5FD_t* f, H5FD_mem_t, haddr_t address) {
            fileOf(f).allocatedEnd = address;
            return herr_t{0};
        };
        d.get_eof = [](const H5FD_t* f, H5FD_mem_t) { return fileOf(f).writtenEnd; };
        d.read = readFile;
        d.write = writeFile;
        // The length is put right on closing; until then it only grows.
        d.truncate = [](H5FD_t*, hid_t, hbool_t) { return herr_t{0}; };
        // No locks: readers are welcome while it is written.
        d.lock = [](H5FD_t*, hbool_t) { return herr_t{0}; };
        d.unlock = [](H5FD_t*) { return herr_t{0}; };
        const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
        std::copy(std::begin(map), std::end(map), d.fl_map);
        return d;
    }();
    return driver;
}

hid_t accessTo(FileState& state, bool isThere) {
    static const hid_t driver = H5FDregister(&driverClass());
    const DriverInfo info{&state, isThere};
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_driver(access, driver, &info);
    H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    return access;
}

}  // namespace

std::int64_t createSurvivableFile(const fs::path& path, FileState& state) {
    state.place = state.begun = path;
    std::error_code ec;
    // A device (/dev/full) is no file to be replaced.
    const fs::file_status there = fs::status(path, ec);
    if (!fs::exists(there) || fs::is_regular_file(there)) state.begun += kBegunSuffix;
    const hid_t access = accessTo(state, false);
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_file_space_strategy(creation, H5F_FSPACE_STRATEGY_NONE, false, 1);
    const hid_t file = H5Fcreate(state.begun.string().c_str(), H5F_ACC_TRUNC, creation, access);
    H5Pclose(creation);
    H5Pclose(access);
    if (file < 0) {
        throw core::Error(state.failure.empty() ? "the session file cannot be made" : state.failure, path.string(),
                          "choose another place")
            .as(core::writeErrorId(state.errorNumber), {std::strerror(state.errorNumber)});
    }
    return file;
}

std::int64_t reopenSurvivableFile(const fs::path& path, FileState& state) {
    state.place = state.begun = path;
    const hid_t access = accessTo(state, true);
    const hid_t file = H5Fopen(path.string().c_str(), H5F_ACC_RDWR, access);
    H5Pclose(access);
    if (file < 0) {
        throw core::Error(state.failure.empty() ? "the session cannot be opened to go on in it" : state.failure,
                          path.string(), "begin a new one")
            .as(core::writeErrorId(state.errorNumber), {std::strerror(state.errorNumber)});
    }
    return file;
}

void putInPlace(FileState& state) {
    if (state.begun == state.place) return;
    if (const int why = core::replaceFile(state.begun, state.place, true); why != 0) {
        throw core::Error(fmt::format("{}: renaming failed: {}", state.place.string(), std::strerror(why)),
                          state.place.string(), "choose another place")
            .as(core::writeErrorId(why), {std::strerror(why)});
    }
    state.begun = state.place;
}

FileState::~FileState() {
    std::error_code ignored;
    if (begun != place) fs::remove(begun, ignored);
}

}  // namespace handpiece::session
