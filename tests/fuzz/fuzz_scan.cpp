// SPDX-License-Identifier: Apache-2.0
// Any bytes at all, as a file of each format, as a ZIP of slices or as a DICOMDIR, must give series and a volume that
// holds what its grid says, or one core::Error; never more memory than was allowed.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/volume/candidate.h"

namespace volume = handpiece::volume;

namespace {

enum class As { file, zip, dicomdir };
constexpr As kAs = As::HANDPIECE_FUZZ_AS;

/// Most formats are known by their first bytes; those of text by their name.
const char* nameFor(std::string_view bytes) {
    if (bytes.rfind("ObjectType", 0) == 0 || bytes.rfind("NDims", 0) == 0) return "scan.mha";
    if (bytes.rfind("file =", 0) == 0 || bytes.rfind("format =", 0) == 0) return "scan.toml";
    if (bytes.rfind("\x1f\x8b", 0) == 0) return "scan.nii.gz";
    return "scan.dcm";
}

volume::Files filesOf(const std::byte* bytes, std::size_t size) {
    const std::vector<std::byte> all(bytes, bytes + size);
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    if (kAs == As::zip) return volume::FileSet::inArchive(all, "scan.zip", {1 << 20, 8 << 20});
    if (kAs == As::dicomdir) {
        // The directory, then files that it may list, a length of two bytes before each.
        std::vector<volume::FileSet::InMemory> files;
        for (std::size_t at = 0; at + 2 <= size && files.size() < 9;) {
            const std::size_t length = std::min(size - at - 2, std::to_integer<std::size_t>(bytes[at]) |
                                                                   std::to_integer<std::size_t>(bytes[at + 1]) << 8);
            files.push_back({files.empty() ? "DICOMDIR" : "IM" + std::to_string(files.size()),
                             {bytes + at + 2, bytes + at + 2 + length}});
            at += 2 + length;
        }
        if (files.empty()) files.push_back({"DICOMDIR", all});
        return volume::FileSet::inMemory(std::move(files));
    }
    return volume::FileSet::inMemory({{nameFor(text), all}, {"scan.raw", std::vector<std::byte>(96, std::byte{7})}});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    handpiece::core::setThreadCount(1);
    volume::ReadSettings settings;
    settings.limitBytes = 16 << 20;
    settings.spacingMm = handpiece::core::Vec3(0.1, 0.1, 0.1);
    try {
        const volume::Files files = filesOf(reinterpret_cast<const std::byte*>(data), size);
        for (const volume::Candidate& candidate : volume::findCandidates(files, {})) {
            try {
                const volume::Scan scan = volume::load(candidate, settings, {});
                const volume::Grid& grid = scan.volume.grid;
                if (grid.count() == 0 || scan.volume.values.size() != grid.count()) __builtin_trap();
                if (!(grid.axes.determinant() > 0.99) || !grid.originMm.allFinite()) __builtin_trap();
                for (const float v : scan.volume.values)
                    if (!std::isfinite(v)) __builtin_trap();
            } catch (const handpiece::core::Error& e) {
                if (e.problem().empty()) __builtin_trap();
            }
        }
    } catch (const handpiece::core::Error& e) {
        if (e.problem().empty()) __builtin_trap();
    }
    return 0;
}
