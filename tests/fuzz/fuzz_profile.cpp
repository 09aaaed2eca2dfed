// SPDX-License-Identifier: Apache-2.0
// Any text as a device's profile must give one that can be written and comes back the same, or one core::Error.
#include <cmath>
#include <filesystem>
#include <string>

#include "fuzz_model.h"
#include "handpiece/base/core/file.h"
#include "handpiece/devices/workspace/profile.h"

namespace workspace = handpiece::workspace;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::filesystem::path folder = [] {
        const std::filesystem::path memory = "/dev/shm";
        return (std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path()) /
               ("handpiece-fuzz-" +
                std::to_string(std::filesystem::file_time_type::clock::now().time_since_epoch().count()));
    }();
    handpiece::link::DriverInfo info;
    info.driver = "simulated";
    info.model = "Touch";
    info.serial = "1";
    return handpiece::fuzz::readText(data, size, [&](std::string_view text) {
        std::filesystem::create_directory(folder);
        const std::filesystem::path file = workspace::profileFile(folder, info);
        handpiece::core::writeFile(file, text, {.lasting = false});
        const workspace::Profile read = workspace::readProfile(file, info);
        try {
            workspace::writeProfile(folder, read);
            const workspace::Profile again = workspace::readProfile(file, info);
            if (again.placing.scale != read.placing.scale || again.clutchButton != read.clutchButton) __builtin_trap();
        } catch (const handpiece::core::Error&) {
            __builtin_trap();
        }
    });
}
