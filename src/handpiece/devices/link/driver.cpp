// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/link/driver.h"

#include "handpiece/base/core/error.h"

namespace handpiece::link {
namespace {

struct Words {
    std::string_view id, sentence, remedy;
};

constexpr std::array<Words, 13> kWords{{
    {"none", "The device is well.", ""},
    {"starting", "The device has not told its pose yet.", "Check its cable and power; some must be calibrated first."},
    {"unplugged", "The device is gone.", "Check its cable and power, then connect it again."},
    {"vendor-error", "The device's own software reports an error.", "See its code; switch the device off and on."},
    {"bad-data", "The device sent something that cannot be read.", "Start its service again, or update it."},
    {"stalled", "The device has stopped telling its pose.", "Check its cable; close other programs that use it."},
    {"tick-stalled", "The simulation stood still.", "Close other programs; the force comes back by itself."},
    {"not-finite", "A pose or a force was not a number.", "Lift the bur off the tooth; calibrate the device."},
    {"jumped", "The pose jumped farther than a hand can move.", "Lift the bur off the tooth; calibrate the device."},
    {"not-calibrated", "The device is not calibrated.", "Calibrate it: Device, Calibrate."},
    {"hot", "The device's motors are too warm.", "Let the device rest for some minutes."},
    {"input-lost", "Nobody holds the device.", "Take the stylus in the hand."},
    {"stopped", "The device was stopped.", "Connect it again."},
}};

const Words& wordsOf(DeviceFault trouble) noexcept {
    const auto at = static_cast<std::size_t>(trouble);
    return kWords[at < kWords.size() ? at : static_cast<std::size_t>(DeviceFault::vendorError)];
}

}  // namespace

std::string_view idOf(DeviceFault trouble) noexcept {
    return wordsOf(trouble).id;
}
std::string_view sentenceOf(DeviceFault trouble) noexcept {
    return wordsOf(trouble).sentence;
}
std::string_view remedyOf(DeviceFault trouble) noexcept {
    return wordsOf(trouble).remedy;
}

void requireStartable(bool runs, bool stopped, const std::string& model) {
    if (stopped) throw core::Error("the device was stopped", model, "open it again").as("device-stopped", {});
    if (runs) throw core::Error("the device runs already", model, "stop it first").as("device-started", {});
}

void requireCalibratable(bool runs, const std::string& model) {
    if (!runs)
        throw core::Error("the device cannot be calibrated before it is connected", model, "connect it first")
            .as("not-started", {model});
}

}  // namespace handpiece::link
