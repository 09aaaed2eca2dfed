// SPDX-License-Identifier: Apache-2.0
#include <AL/alc.h>
#include <AL/alext.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

#include "handpiece/senses/sound/player.h"

namespace handpiece::sound {

// The length of a period cannot be asked for by any call: OpenAL Soft reads it from files alone, once, at the first
// call.
bool preferLowLatency() {
    if (std::getenv("ALSOFT_CONF")) return false;
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
    if (error) return false;
    const std::filesystem::path file =
        folder / ("handpiece-alsoft-" + std::to_string(std::random_device{}()) + ".conf");
    std::ofstream(file) << "[general]\nperiod_size = 128\nperiods = 3\n";
    if (!std::filesystem::exists(file, error)) return false;
    setenv("ALSOFT_CONF", file.c_str(), 1);
    // The lightest call that reads them: it opens nothing of the machine's.
    const auto openLoopback =
        reinterpret_cast<LPALCLOOPBACKOPENDEVICESOFT>(alcGetProcAddress(nullptr, "alcLoopbackOpenDeviceSOFT"));
    ALCdevice* loopback = openLoopback ? openLoopback(nullptr) : nullptr;
    if (loopback) alcCloseDevice(loopback);
    unsetenv("ALSOFT_CONF");
    std::filesystem::remove(file, error);
    return loopback != nullptr;
}

}  // namespace handpiece::sound
