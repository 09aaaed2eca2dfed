// SPDX-License-Identifier: Apache-2.0
// Any bytes at all, as a file of each format, must give series and a volume that holds what its grid says, or one
// core::Error; never more memory than was allowed.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/scan/volume/candidate.h"

namespace volume = handpiece::volume;

namespace {

/// Most formats are known by their first bytes; those of text by their name.
const char* nameFor(std::string_view bytes) {
    if (bytes.rfind("ObjectType", 0) == 0 || bytes.rfind("NDims", 0) == 0) return "scan.mha";
    if (bytes.rfind("file =", 0) == 0 || bytes.rfind("format =", 0) == 0) return "scan.toml";
    if (bytes.rfind("\x1f\x8b", 0) == 0) return "scan.nii.gz";
    return "scan.dcm";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    handpiece::core::setThreadCount(1);
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto files = volume::FileSet::inMemory(
        {{nameFor(text), {bytes, bytes + size}}, {"scan.raw", std::vector<std::byte>(96, std::byte{7})}});
    volume::ReadSettings settings;
    settings.limitBytes = 16 << 20;
    settings.spacingMm = handpiece::core::Vec3(0.1, 0.1, 0.1);
    try {
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
