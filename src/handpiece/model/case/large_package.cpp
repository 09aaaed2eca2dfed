// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/large_package.h"

#include <fmt/format.h>
#include <zip.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::cases {
namespace {

namespace fs = std::filesystem;

/// Taken back, with what was written of it, unless it was closed.
struct Discard {
    void operator()(zip_t* archive) const noexcept { zip_discard(archive); }
};
using Archive = std::unique_ptr<zip_t, Discard>;

Archive opened(const fs::path& file, int how) {
    int code = 0;
    Archive archive(zip_open(file.c_str(), how, &code));
    if (archive) return archive;
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string why = zip_error_strerror(&error);
    zip_error_fini(&error);
    throw core::Error("this is no zip file, or a damaged one: " + why, file.string(), "copy the file again")
        .as("not-a-package", {why});
}

core::Error failed(zip_t* archive, const fs::path& file) {
    const zip_error_t& error = *zip_get_error(archive);
    const int system = zip_error_system_type(&error) == ZIP_ET_SYS ? error.sys_err : 0;
    const std::string why = system != 0 ? std::strerror(system) : zip_strerror(archive);
    return core::Error("cannot be packed: " + why, file.string(), "make room, or check the folder's permissions")
        .as(core::writeErrorId(system), {why});
}

}  // namespace

void writeLargePackage(const fs::path& file, const PackageFiles& small, const std::map<std::string, fs::path>& onDisk,
                       const core::Progress& progress) {
    const fs::path part = file.string() + ".part";
    // What is packed into it takes its mode.
    if (!core::createOwnFile(part))
        throw core::Error(fmt::format("cannot be written: {}", std::strerror(errno)), part.string(),
                          "make room, or check the folder's permissions")
            .as(core::writeErrorId(errno), {std::strerror(errno)});
    std::error_code none;
    try {
        Archive archive = opened(part, ZIP_CREATE | ZIP_TRUNCATE);
        const auto add = [&](const std::string& name, zip_source_t* source, bool isPacked) {
            if (!source) throw failed(archive.get(), file);
            const zip_int64_t index = zip_file_add(archive.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8);
            if (index < 0) {
                zip_source_free(source);
                throw failed(archive.get(), file);
            }
            const auto at = static_cast<zip_uint64_t>(index);
            zip_set_file_compression(archive.get(), at, isPacked ? ZIP_CM_DEFLATE : ZIP_CM_STORE, isPacked ? 1 : 0);
            constexpr zip_uint32_t kOwnersFile = 0100600;
            zip_file_set_external_attributes(archive.get(), at, 0, ZIP_OPSYS_UNIX, kOwnersFile << 16);
        };
        for (const auto& [name, bytes] : small)
            add(name, zip_source_buffer(archive.get(), bytes.data(), bytes.size(), 0), true);
        for (const auto& [name, path] : onDisk)
            add(name, zip_source_file(archive.get(), path.c_str(), 0, -1),
                !name.starts_with("files/") && !name.ends_with(".h5"));
        struct Told {
            const core::Progress& progress;
            bool isCancelled = false;
        } told{progress};
        if (progress) {
            zip_register_progress_callback_with_state(
                archive.get(), 0.001,
                [](zip_t*, double done, void* to) {
                    auto& state = *static_cast<Told*>(to);
                    if (!state.progress(done)) state.isCancelled = true;
                },
                nullptr, &told);
            zip_register_cancel_callback_with_state(
                archive.get(), [](zip_t*, void* to) { return static_cast<Told*>(to)->isCancelled ? 1 : 0; }, nullptr,
                &told);
        }
        if (zip_close(archive.get()) != 0) {
            if (told.isCancelled) throw core::Error("cancelled", file.string());
            throw failed(archive.get(), file);
        }
        (void)archive.release();
        if (const int why = core::replaceFile(part, file, true); why != 0)
            throw core::Error(fmt::format("cannot be written: {}", std::strerror(why)), file.string(),
                              "make room, or check the folder's permissions")
                .as(core::writeErrorId(why), {std::strerror(why)});
    } catch (...) {
        fs::remove(part, none);
        throw;
    }
}

struct LargePackage::State {
    Archive archive;
};

LargePackage::LargePackage(const fs::path& file) : where_(file.string()) {
    // Says what is wrong where there is none, or a folder.
    (void)core::openFile(file);
    state_ = std::make_unique<State>(State{opened(file, ZIP_RDONLY)});
    const zip_int64_t count = zip_get_num_entries(state_->archive.get(), 0);
    for (zip_uint64_t i = 0; i < static_cast<zip_uint64_t>(count); ++i) {
        zip_stat_t stat;
        if (zip_stat_index(state_->archive.get(), i, 0, &stat) != 0 || (stat.valid & ZIP_STAT_NAME) == 0 ||
            (stat.valid & ZIP_STAT_SIZE) == 0)
            throw core::Error(fmt::format("its file {} is damaged", i + 1), where_, "copy the file again")
                .as("not-a-package", {where_});
        if (!files_.try_emplace(stat.name, stat.size).second)
            throw core::Error(fmt::format("it names \"{}\" twice", stat.name), where_, "get it from where it was made")
                .as("not-a-package", {stat.name});
    }
}
LargePackage::~LargePackage() = default;

void LargePackage::read(const std::string& name, const std::function<void(std::span<const std::byte>)>& piece) const {
    const auto damaged = [&] {
        return core::Error(fmt::format("\"{}\" in it is damaged", name), where_, "copy the file again, or take another")
            .as("not-a-package", {name});
    };
    const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> entry(zip_fopen(state_->archive.get(), name.c_str(), 0),
                                                                   &zip_fclose);
    if (!entry) throw damaged();
    std::vector<std::byte> bytes(1 << 18);
    std::uint64_t all = 0;
    for (;;) {
        // The end comes with the comparison of the checksum.
        const zip_int64_t got = zip_fread(entry.get(), bytes.data(), bytes.size());
        if (got < 0) throw damaged();
        if (got == 0) break;
        all += static_cast<std::uint64_t>(got);
        piece(std::span(bytes.data(), static_cast<std::size_t>(got)));
    }
    const auto found = files_.find(name);
    if (found == files_.end() || found->second != all) throw damaged();
}

}  // namespace handpiece::cases
