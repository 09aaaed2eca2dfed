// SPDX-License-Identifier: Apache-2.0
#include <AL/alc.h>
#include <AL/alext.h>

#include <cstdlib>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/senses/sound/player.h"

namespace handpiece::sound {

// The length of a period cannot be asked for by any call: OpenAL Soft reads it from files alone, once, at the first
// call.
bool preferLowLatency() try {
    if (std::getenv("ALSOFT_CONF")) return false;
    // In a folder that nobody else may enter: what OpenAL Soft reads there it also loads.
    const core::PrivateFolder folder;
    const std::filesystem::path file = folder.path() / "alsoft.conf";
    core::writeFile(file, "[general]\nperiod_size = 128\nperiods = 3\n");
    setenv("ALSOFT_CONF", file.c_str(), 1);
    // The lightest call that reads them: it opens nothing of the machine's.
    const auto openLoopback =
        reinterpret_cast<LPALCLOOPBACKOPENDEVICESOFT>(alcGetProcAddress(nullptr, "alcLoopbackOpenDeviceSOFT"));
    ALCdevice* loopback = openLoopback ? openLoopback(nullptr) : nullptr;
    if (loopback) alcCloseDevice(loopback);
    unsetenv("ALSOFT_CONF");
    return loopback != nullptr;
} catch (const core::Error&) {
    return false;  // nowhere to put the file: the usual period then
}

}  // namespace handpiece::sound
