// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/volume/files.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/leads_out.h"

namespace handpiece::volume {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWindowBytes = 16384, kMaxFiles = 200000, kChunkBytes = 1 << 20;
/// Deflate cannot do better than 1032 to 1: an entry that claims more lies.
constexpr std::uint64_t kMaxRatio = 1100, kSmallBytes = 1 << 20;

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}

struct CloseEntry {
    void operator()(zip_file_t* entry) const noexcept { zip_fclose(entry); }
};

}  // namespace

Input::Input(const fs::path& path) : file_(core::openFile(path)), where_(path.string()) {
    std::setvbuf(file_.get(), nullptr, _IONBF, 0);  // the window below does that
    size_ = core::sizeOf(file_);
}

Input::Input(std::shared_ptr<const std::vector<std::byte>> data, std::string where)
    : memory_(std::move(data)), where_(std::move(where)), size_(memory_->size()) {}

std::size_t Input::readAt(std::uint64_t at, void* to, std::size_t count) {
    if (at >= size_ || count == 0) return 0;
    count = static_cast<std::size_t>(std::min<std::uint64_t>(count, size_ - at));
    if (memory_) {
        std::memcpy(to, memory_->data() + at, count);
        return count;
    }
    const auto fromDisk = [&](std::uint64_t place, void* into, std::size_t bytes) {
        if (std::fseek(file_.get(), static_cast<long>(place), SEEK_SET) != 0) return std::size_t{0};
        return std::fread(into, 1, bytes, file_.get());
    };
    if (count >= kWindowBytes) return fromDisk(at, to, count);
    if (at < windowAt_ || at + count > windowAt_ + window_.size()) {
        window_.resize(kWindowBytes);
        window_.resize(fromDisk(at, window_.data(), kWindowBytes));
        windowAt_ = at;
        count = std::min(count, window_.size());
    }
    std::memcpy(to, window_.data() + (at - windowAt_), count);
    return count;
}

/// An open ZIP; its library knows no threads.
struct FileSet::Archive {
    std::vector<std::byte> memory;  ///< where it is no file
    zip_t* zip = nullptr;
    std::string why;  ///< it cannot be opened
    std::map<std::string, zip_uint64_t> byName;
    std::mutex mutex;
    explicit Archive(const fs::path& file) {
        int code = 0;
        zip = zip_open(file.string().c_str(), ZIP_RDONLY, &code);
        zip_error_t error;
        zip_error_init_with_code(&error, code);
        if (!zip) why = zip_error_strerror(&error);
        zip_error_fini(&error);
    }
    explicit Archive(std::vector<std::byte> bytes) : memory(std::move(bytes)) {
        zip_error_t error;
        zip_error_init(&error);
        zip_source_t* source = zip_source_buffer_create(memory.data(), memory.size(), 0, &error);
        zip = source ? zip_open_from_source(source, ZIP_RDONLY, &error) : nullptr;
        if (!zip) {
            why = zip_error_strerror(&error);
            zip_source_free(source);
        }
        zip_error_fini(&error);
    }
    Archive(const Archive&) = delete;
    Archive& operator=(const Archive&) = delete;
    ~Archive() {
        if (zip) zip_discard(zip);
    }
};

FileSet::FileSet() = default;
FileSet::~FileSet() = default;

std::shared_ptr<const FileSet> FileSet::inMemory(std::vector<InMemory> files) {
    const std::shared_ptr<FileSet> set(new FileSet);
    if (!files.empty()) set->where_ = files[0].name;
    for (InMemory& file : files) {
        set->entries_.push_back({file.name, file.data.size()});
        set->memory_[file.name] = std::make_shared<const std::vector<std::byte>>(std::move(file.data));
    }
    set->sort();
    for (std::size_t i = 0; i < set->entries_.size(); ++i)
        if (set->entries_[i].name == set->where_) set->named_ = i;
    return set;
}

std::shared_ptr<const FileSet> FileSet::inArchive(std::vector<std::byte> zip, std::string where,
                                                  const ArchiveLimits& limits) {
    const std::shared_ptr<FileSet> set(new FileSet);
    set->where_ = std::move(where);
    set->storedBytes_ = zip.size();
    set->addArchive(std::make_unique<Archive>(std::move(zip)), limits);
    set->sort();
    return set;
}

std::shared_ptr<const FileSet> FileSet::open(const fs::path& path, const ArchiveLimits& limits) {
    const std::shared_ptr<FileSet> set(new FileSet);
    set->where_ = path.string();
    std::error_code ec;
    const fs::file_status status = core::statusOf(path);
    if (!fs::exists(status))
        throw core::Error("there is no such file or folder", path.string(), "check the name").as("file-not-found");
    if (fs::is_directory(status)) {
        set->addFolder(path);
        set->sort();
        return set;
    }
    if (!fs::is_regular_file(status))
        throw core::Error("this is neither a file nor a folder", path.string(), "name a file or a folder");
    Input input(path);
    char magic[4] = {};
    (void)input.readAt(0, magic, sizeof magic);
    if (std::memcmp(magic, "PK\3\4", 4) == 0 || std::memcmp(magic, "PK\5\6", 4) == 0) {
        set->storedBytes_ = input.size();
        set->addArchive(std::make_unique<Archive>(path), limits);
        set->sort();
        return set;
    }
    // Files beside it belong to it: a header's data, a description, the files of a DICOMDIR.
    const std::string name = path.filename().string();
    set->root_ = path.parent_path().empty() ? fs::path(".") : path.parent_path();
    std::string upper = name;
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
    if (upper == "DICOMDIR") {
        set->addFolder(set->root_);
    } else {
        set->entries_.push_back({name, input.size()});
        const std::string stem = fs::path(name).stem().string();
        for (const std::string& beside : {std::string("scan.toml"), stem + ".toml", name + ".toml"})
            if (beside != name && fs::is_regular_file(set->root_ / beside, ec))
                set->entries_.push_back({beside, fs::file_size(set->root_ / beside, ec)});
        const std::string extension = extensionOf(name);
        if (extension == ".toml" || extension == ".nhdr" || extension == ".mhd" || extension == ".hdr" ||
            extension == ".nrrd" || extension == ".mha" || upper.ends_with(".HDR.GZ")) {
            std::size_t count = 0;
            for (const fs::directory_entry& e : fs::directory_iterator(set->root_, ec)) {
                const std::string other = e.path().filename().string();
                if (++count > kMaxFiles) break;
                const bool isThere = std::any_of(set->entries_.begin(), set->entries_.end(),
                                                 [&](const Entry& entry) { return entry.name == other; });
                if (!isThere && e.is_regular_file(ec)) set->entries_.push_back({other, e.file_size(ec)});
            }
        }
    }
    set->sort();
    for (std::size_t i = 0; i < set->entries_.size(); ++i)
        if (set->entries_[i].name == name) set->named_ = i;
    return set;
}

void FileSet::addFolder(const fs::path& folder) {
    root_ = folder;
    std::error_code ec;
    fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, ec);
    if (ec)
        throw core::Error(fmt::format("this folder cannot be read: {}", ec.message()), folder.string(),
                          "check its permissions")
            .as("not-readable", {ec.message()});
    for (; it != fs::recursive_directory_iterator(); it.increment(ec)) {
        if (ec) break;
        const std::string name = it->path().filename().string();
        const bool isFolder = it->is_directory(ec);
        if (name.empty() || name[0] == '.' || name == "__MACOSX") {  // what systems and programs hide
            if (isFolder) it.disable_recursion_pending();
            continue;
        }
        if (isFolder) {
            ++folders_;
            if (it.depth() >= 16) it.disable_recursion_pending();
            continue;
        }
        if (!it->is_regular_file(ec)) continue;
        entries_.push_back({it->path().lexically_relative(folder).generic_string(), it->file_size(ec)});
        if (entries_.size() > kMaxFiles)
            throw core::Error(fmt::format("this folder holds more than {} files", kMaxFiles), folder.string(),
                              "name the folder of the scan itself");
    }
}

void FileSet::addArchive(std::unique_ptr<Archive> archive, const ArchiveLimits& limits) {
    const auto damaged = [&](std::string_view why) {
        return core::Error(fmt::format("this ZIP is damaged: {}", why), where_, "copy or pack it again");
    };
    archive_ = std::move(archive);
    if (!archive_->zip) throw damaged(archive_->why);
    const zip_int64_t count = zip_get_num_entries(archive_->zip, 0);
    if (count > static_cast<zip_int64_t>(kMaxFiles))
        throw core::Error(fmt::format("this ZIP holds more than {} files", kMaxFiles), where_, "pack the scan alone");
    std::uint64_t packed = 0, unpacked = 0;
    for (zip_int64_t i = 0; i < count; ++i) {
        zip_stat_t stat;
        if (zip_stat_index(archive_->zip, static_cast<zip_uint64_t>(i), 0, &stat) != 0 ||
            (stat.valid & (ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE)) !=
                (ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE))
            throw damaged(fmt::format("its entry {} cannot be read", i + 1));
        const std::string name = stat.name;
        if (name.empty()) continue;
        if (name.back() == '/') {
            ++folders_;
            continue;
        }
        const std::string last = name.substr(folderOf(name).size());
        if (last[0] == '.' || name.rfind("__MACOSX", 0) == 0) continue;
        if ((stat.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && stat.encryption_method != ZIP_EM_NONE)
            throw core::Error("this ZIP is encrypted", where_, "unpack it with its password, name the folder");
        if (stat.size > kSmallBytes && stat.size / kMaxRatio > stat.comp_size)
            throw damaged("an entry claims to unpack to more than is possible");
        // Entries that share their packed bytes are made to unpack without an end.
        if (stat.comp_size > storedBytes_ - packed) throw damaged("its entries lie over each other");
        packed += stat.comp_size;
        const bool isFileTooLarge = stat.size > limits.fileBytes;
        if (isFileTooLarge || stat.size > limits.totalBytes - unpacked)
            throw core::Error(
                fmt::format("{} of this ZIP unpack{} to more than {} MB", isFileTooLarge ? "one file" : "the files",
                            isFileTooLarge ? "s" : "", (isFileTooLarge ? limits.fileBytes : limits.totalBytes) >> 20),
                where_, "unpack it and name the folder of the scan")
                .as("scan-too-large");
        unpacked += stat.size;
        if (archive_->byName.try_emplace(name, static_cast<zip_uint64_t>(i)).second)
            entries_.push_back({name, stat.size});
    }
}

void FileSet::sort() {
    if (!archive_)
        for (const Entry& entry : entries_)
            storedBytes_ += entry.bytes;
    std::sort(entries_.begin(), entries_.end(),
              [](const Entry& a, const Entry& b) { return naturalLess(a.name, b.name); });
}

std::string FileSet::where(std::size_t index) const {
    if (!memory_.empty()) return entries_[index].name;
    if (archive_) return where_ + ": " + entries_[index].name;
    return (root_ / entries_[index].name).string();
}

Input FileSet::open(std::size_t index) const {
    if (!memory_.empty()) return Input(memory_.at(entries_[index].name), entries_[index].name);
    if (!archive_) return Input(root_ / entries_[index].name);
    const Entry& entry = entries_[index];
    const auto damaged = [&] {
        return core::Error(fmt::format("\"{}\" in this ZIP is damaged", entry.name), where_, "copy or pack it again");
    };
    // The memory grows with what really comes out: the size is only what the archive claims.
    auto data = std::make_shared<std::vector<std::byte>>();
    const std::lock_guard lock(archive_->mutex);
    const std::unique_ptr<zip_file_t, CloseEntry> open(
        zip_fopen_index(archive_->zip, archive_->byName.at(entry.name), 0));
    if (!open) throw damaged();
    for (std::size_t have = 0; have < entry.bytes;) {
        if (have == data->size())
            data->resize(
                static_cast<std::size_t>(std::min<std::uint64_t>(entry.bytes, std::max(2 * have, kChunkBytes))));
        const zip_int64_t got = zip_fread(open.get(), data->data() + have, data->size() - have);
        if (got <= 0) throw damaged();
        have += static_cast<std::size_t>(got);
    }
    std::byte more;
    if (zip_fread(open.get(), &more, 1) != 0) throw damaged();  // also checks the sum
    return Input(std::move(data), where(index));
}

std::size_t FileSet::head(std::size_t index, void* to, std::size_t count) const {
    if (!archive_) return open(index).readAt(0, to, count);
    const std::lock_guard lock(archive_->mutex);
    const std::unique_ptr<zip_file_t, CloseEntry> open(
        zip_fopen_index(archive_->zip, archive_->byName.at(entries_[index].name), 0));
    const zip_int64_t got = open ? zip_fread(open.get(), to, count) : 0;
    return got > 0 ? static_cast<std::size_t>(got) : 0;
}

std::vector<std::byte> FileSet::bytes(std::size_t index, std::uint64_t limitBytes) const {
    const auto tooLarge = [&] {
        return core::Error(fmt::format("the file has {} MB, more than the {} MB that are read",
                                       entries_[index].bytes >> 20, limitBytes >> 20),
                           where(index), "name the right file")
            .as("scan-too-large");
    };
    if (entries_[index].bytes > limitBytes) throw tooLarge();
    Input input = open(index);
    if (input.size() > limitBytes) throw tooLarge();
    std::vector<std::byte> data(input.size());
    data.resize(input.readAt(0, data.data(), data.size()));
    return data;
}

std::optional<std::size_t> FileSet::find(std::string_view beside, std::string_view name) const {
    const std::string full = std::string(folderOf(beside)) + std::string(name);
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        if (entries_[i].name != full) continue;
        if (!archive_ && memory_.empty() && core::leadsOut(root_, root_ / full))
            throw core::Error("this is a link that leads out of the scan's folder", where(i),
                              "put the file itself there");
        return i;
    }
    return {};
}

bool naturalLess(std::string_view a, std::string_view b) {
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (isDigit(a[i]) && isDigit(b[j])) {
            const std::size_t startA = i, startB = j;
            while (i < a.size() && isDigit(a[i]))
                ++i;
            while (j < b.size() && isDigit(b[j]))
                ++j;
            std::string_view runA = a.substr(startA, i - startA), runB = b.substr(startB, j - startB);
            runA.remove_prefix(std::min(runA.find_first_not_of('0'), runA.size()));
            runB.remove_prefix(std::min(runB.find_first_not_of('0'), runB.size()));
            if (runA.size() != runB.size()) return runA.size() < runB.size();
            if (runA != runB) return runA < runB;
            continue;
        }
        if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
        ++i;
        ++j;
    }
    if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
    return a < b;  // "1" and "01": some order, always the same
}

std::string extensionOf(std::string_view name) {
    const std::string_view last = name.substr(folderOf(name).size());
    const std::size_t dot = last.rfind('.');
    if (dot == std::string_view::npos || dot == 0) return {};
    std::string extension(last.substr(dot));
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return extension;
}

std::string_view folderOf(std::string_view name) {
    const std::size_t slash = name.rfind('/');
    return slash == std::string_view::npos ? std::string_view() : name.substr(0, slash + 1);
}

}  // namespace handpiece::volume
