// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/prepared/prepared_files.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <system_error>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::prepared {
namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t kMostBytes = 256ull << 20;

struct Used {
    fs::path folder;
    std::span<const Believed> believed;
    std::function<void(const std::string&)> tell;
    std::atomic<bool> isTold{false};
    fs::path collectedIn;
};
Used& used() {
    static Used all;
    return all;
}

const Believed* find(std::string_view name) {
    for (const Believed& one : used().believed)
        if (one.name == name) return &one;
    return nullptr;
}

void tellOnce(const std::string& problem) {
    Used& all = used();
    if (!all.isTold.exchange(true) && all.tell) all.tell(problem);
}

}  // namespace

std::string sha256Of(std::span<const std::byte> data) {
    std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
    crypto_hash_sha256(hash.data(), reinterpret_cast<const unsigned char*>(data.data()), data.size());
    std::string text;
    for (const unsigned char byte : hash)
        text += fmt::format("{:02x}", byte);
    return text;
}

fs::path installedFolder() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    for (const fs::path& folder :
         {program.parent_path().parent_path() / "share/handpiece/prepared", fs::path("/usr/share/handpiece/prepared")})
        if (fs::is_directory(folder, error)) return folder;
    return {};
}

void use(fs::path folder, std::span<const Believed> believed, std::function<void(const std::string&)> tell) {
    Used& all = used();
    all.folder = std::move(folder);
    all.believed = believed;
    all.tell = std::move(tell);
    all.isTold = false;
}

bool isKnown(std::string_view name) {
    return find(name) != nullptr;
}

std::optional<std::vector<std::byte>> read(std::string_view name) {
    const Believed* one = find(name);
    if (one == nullptr) return std::nullopt;
    const fs::path place = used().folder / name;
    try {
        if (used().folder.empty())
            throw core::Error("the folder of prepared teeth is not there", "share/handpiece/prepared");
        std::vector<std::byte> data = core::readFile(place, kMostBytes);
        if (sha256Of(data) == one->sha256) return data;
        refuse(name);
    } catch (const core::Error& why) {
        tellOnce(fmt::format("{}: {}; it is made anew. Install the package again.", why.where(), why.problem()));
    }
    return std::nullopt;
}

void refuse(std::string_view name) {
    tellOnce(
        fmt::format("{}: it is not the file that came with this program; it is made anew. Install the package again.",
                    (used().folder / name).string()));
}

void collectIn(fs::path folder) {
    used().collectedIn = std::move(folder);
}

bool isCollecting() {
    return !used().collectedIn.empty();
}

void keep(std::string_view name, std::span<const std::byte> data) {
    core::writeFile(used().collectedIn / name, data, {.ownerOnly = false, .lasting = false});
}

std::string listSource(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    std::string text =
        "// Made by handpiece-prepare.\n#include \"handpiece/base/prepared/prepared_files.h\"\n\n"
        "namespace handpiece::prepared {\nstd::span<const Believed> list();\nstd::span<const Believed> list() {\n"
        "    static constexpr Believed kAll[] = {\n";
    for (const fs::path& file : files)
        text += fmt::format("        {{\"{}\",\n         \"{}\"}},\n", file.filename().string(),
                            sha256Of(core::readFile(file, kMostBytes)));
    return text + "    };\n    return kAll;\n}\n}  // namespace handpiece::prepared\n";
}

}  // namespace handpiece::prepared
