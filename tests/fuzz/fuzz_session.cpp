// SPDX-License-Identifier: Apache-2.0
// Any bytes at all must be read as a session or give one core::Error. What HDF5 itself does with hostile files is not
// ours to mend: a find whose stack lies inside libhdf5 alone is a find in that library.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "handpiece/base/core/error.h"
#include "handpiece/record/session/session_reader.h"

using handpiece::session::SessionReader;

namespace {

/// In memory, where the system has such a place.
std::filesystem::path place() {
    const std::filesystem::path memory = "/dev/shm";
    const auto folder = std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    const auto salt = std::filesystem::file_time_type::clock::now().time_since_epoch().count();
    return folder / ("handpiece-fuzz-" + std::to_string(salt) + ".h5");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::filesystem::path path = place();
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        const SessionReader reader(path);
        const auto first = reader.records(0, 1000);
        if (first.size() > reader.size()) std::abort();
        if (reader.size() > 1000) (void)reader.records(reader.size() - 10, 1000);
        (void)reader.indexOfTick(100);
        (void)reader.events();
        if (!reader.keyFrameTicks().empty()) (void)reader.keyFrameBefore(reader.keyFrameTicks().back());
    } catch (const handpiece::core::Error&) {
    }
    std::filesystem::remove(path);
    return 0;
}
