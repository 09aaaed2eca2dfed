// SPDX-License-Identifier: Apache-2.0
// Any bytes at all must be read as a picture, as a sound, or give one core::Error.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "handpiece/base/core/error.h"
#include "handpiece/senses/sound/player.h"
#include "handpiece/senses/view/image.h"

namespace {

/// In memory, where the system has such a place.
std::filesystem::path place(const char* ending) {
    const std::filesystem::path memory = "/dev/shm";
    const auto folder = std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    const auto salt = std::filesystem::file_time_type::clock::now().time_since_epoch().count();
    return folder / ("handpiece-fuzz-" + std::to_string(salt) + ending);
}

template <class Read>
void read(const std::filesystem::path& path, const std::uint8_t* data, std::size_t size, Read&& reader) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        reader(path);
    } catch (const handpiece::core::Error&) {
    }
    std::filesystem::remove(path);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::filesystem::path png = place(".png"), wav = place(".wav");
    read(png, data, size, [](const auto& path) {
        const handpiece::view::Image image = handpiece::view::readPng(path);
        if (image.rgba.size() != std::size_t{4} * static_cast<std::size_t>(image.width * image.height)) std::abort();
    });
    read(wav, data, size, [](const auto& path) { (void)handpiece::sound::readWav(path); });
    return 0;
}
