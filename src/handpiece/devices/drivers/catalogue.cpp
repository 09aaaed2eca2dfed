// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/catalogue.h"

#include <fmt/format.h>

#include "handpiece/base/core/error.h"
#include "handpiece/devices/drivers/falcon.h"
#include "handpiece/devices/drivers/force_dimension.h"
#include "handpiece/devices/drivers/gamepad.h"
#include "handpiece/devices/drivers/haply.h"
#include "handpiece/devices/drivers/openhaptics.h"
#include "handpiece/devices/drivers/simulated_driver.h"
#include "handpiece/devices/drivers/spacemouse.h"

namespace handpiece::drivers {
namespace {

struct Row {
    const char* name;
    Found (*look)();
    std::unique_ptr<link::Driver> (*open)(const OpenOptions&);
    std::string (*words)(std::int32_t);  // of an error code; null: its interface has none
};

// The one list of drivers, in the order in which people are shown them.
constexpr Row kRows[] = {
    {"openhaptics", &lookOpenHaptics, &openOpenHaptics, &openHapticsErrorInWords},
    {"forcedimension", &lookForceDimension, &openForceDimension, &dhdErrorInWords},
    {"falcon", &lookFalcon, &openFalcon, &falconErrorInWords},
    {"haply", &lookHaply, &openHaply, &haplyErrorInWords},
    {"spacemouse", &lookSpaceMouse, &openSpaceMouse, nullptr},
    {"gamepad", &lookGamepad, &openGamepad, nullptr},
    {"simulated", &lookSimulated, &openSimulated, nullptr},
};

}  // namespace

std::vector<Found> look() {
    std::vector<Found> found;
    for (const Row& row : kRows)
        found.push_back(row.look());
    return found;
}

const std::vector<std::string>& names() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> list;
        for (const Row& row : kRows)
            list.emplace_back(row.name);
        return list;
    }();
    return all;
}

std::unique_ptr<link::Driver> open(std::string_view driver, const OpenOptions& options) {
    for (const Row& row : kRows)
        if (driver == row.name) return row.open(options);
    throw core::Error(fmt::format("no device driver is called \"{}\"", driver), "device",
                      fmt::format("there are {}", fmt::join(names(), ", ")))
        .as("no-such-device", {std::string(driver), fmt::format("{}", fmt::join(names(), ", "))});
}

std::string vendorErrorInWords(std::string_view driver, std::int32_t code) {
    if (code == 0) return {};
    for (const Row& row : kRows)
        if (driver == row.name && row.words != nullptr) return row.words(code);
    return fmt::format("the device's own software reports error {}", code);
}

}  // namespace handpiece::drivers
