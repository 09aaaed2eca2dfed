// SPDX-License-Identifier: Apache-2.0
#include "cli/run_device.h"
#include "cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "handpiece/app/exercise/school_defaults.h"
#include "handpiece/base/core/error.h"
#include "handpiece/devices/drivers/simulated_driver.h"

namespace handpiece::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kInTimeS = 0.010;  // from a fault to no force
constexpr std::size_t kShown = 12;  // faults in the table for people; all are in the JSON

std::optional<bool> switchOf(const std::string& text, const char* option) {
    if (text.empty()) return std::nullopt;
    if (text == "on") return true;
    if (text == "off") return false;
    throw core::Error(fmt::format("\"{}\" is neither on nor off", text), option, "give on or off");
}

/// A fault that passed without force needed none to be taken away.
bool inTime(const safety::FaultOutcome& o) {
    return o.toZeroS >= 0.0 && o.toZeroS <= kInTimeS;
}

}  // namespace

void addDeviceOptions(Command& command, DeviceOptions& o) {
    std::string names;
    for (const std::string& name : input::deviceNames())
        names += (names.empty() ? "" : ", ") + name;
    const auto add = [&](const char* name, auto& value, std::string help) {
        return command.option(name, value, std::move(help)).group("Device");
    };
    add("--device", o.name, names).showDefault();
    add("--which", o.which, "device's name or serial, where there are several");
    add("--profile", o.profile, "TOML file instead of the device's own profile (docs/formats/device-profile.md)");
    add("--scale", o.scale, "millimetres of the hand for one of the bur: 1, 2 or 3").check(nonNegative());
    command.flag("--left-handed", o.leftHanded, "the hand comes from the left; the instrument is mirrored")
        .group("Device");
    add("--controller", o.controller, "on or off: lets no more energy out to the hand than is passive");
}

void applySchoolDefaults(const Command& command, DeviceOptions& o) {
    const exercise::SchoolDefaults school = exercise::schoolDefaults();
    for (const std::string& problem : school.problems)
        fmt::print(stderr, "handpiece: {}\n", problem);
    const auto given = [&](const char* name) { return command.isGiven(name); };
    // Of a real device only: what a simulated run comes to is the same everywhere.
    if (!isReal(o)) return;
    if (!given("--scale") && school.scale) o.scale = *school.scale;
    if (!given("--left-handed") && school.leftHanded) o.leftHanded = *school.leftHanded;
    if (!given("--crisp") && school.crisp) o.crisp = *school.crisp ? "on" : "off";
}

void validate(const DeviceOptions& o) {
    const std::vector<std::string>& names = input::deviceNames();
    if (std::find(names.begin(), names.end(), o.name) == names.end())
        throw core::Error(fmt::format("there is no device called \"{}\"", o.name), "--device",
                          fmt::format("there are: {}", fmt::join(names, ", ")));
    if (o.scale != 0.0 && o.scale != 1.0 && o.scale != 2.0 && o.scale != 3.0)
        throw core::Error(fmt::format("a scale of {:.6g}", o.scale), "--scale", "give 1, 2 or 3");
    (void)switchOf(o.controller, "--controller");
    (void)switchOf(o.crisp, "--crisp");
    if (!o.inject.empty()) (void)safety::parseFaults(o.inject);
}

input::DeviceChoice choiceOf(const DeviceOptions& o) {
    input::DeviceChoice c;
    c.name = o.name;
    c.which = o.which;
    c.profile = o.profile;
    c.faults = o.inject;
    c.pedal = o.pedal;
    if (o.scale > 0.0) c.scale = o.scale;
    if (o.leftHanded) c.leftHanded = true;
    c.passivityController = switchOf(o.controller, "--controller");
    return c;
}

bool isGuarded(const DeviceOptions& o) {
    return isReal(o) || !o.inject.empty() || !o.profile.empty() || o.scale > 0.0 || o.leftHanded || o.pedal;
}

struct RunDevice::State {
    DeviceOptions options;
    input::DeviceChoice choice;
    std::unique_ptr<link::Driver> driver;  // until it is opened
    std::shared_ptr<input::OpenDevice> opened;
    link::DeviceFault told = link::DeviceFault::none;
};

RunDevice::RunDevice(const DeviceOptions& options) : state_(std::make_unique<State>()) {
    state_->options = options;
    state_->choice = choiceOf(options);
    if (!isReal(options)) return;  // made when its motion is known
    state_->driver = input::openDriver(state_->choice);
    (void)input::profileOf(state_->choice, state_->driver->info());  // a bad one is told now
}

RunDevice::~RunDevice() = default;

void RunDevice::open(studies::RunSettings& settings, const device::Motion* motion, const input::ToothPlace& tooth) {
    State& s = *state_;
    s.choice.tooth = tooth;
    if (!isReal(s.options)) {
        drivers::SimulatedSettings arm;
        arm.arm = settings.device;
        arm.motion = *motion;
        arm.servoHz = settings.rateHz;
        arm.stepped = !settings.realTime;
        link::DriverInfo info;
        info.driver = "simulated";
        info.model = arm.model;
        info.capability = settings.device.capability;
        // The motion is told in the tooth's frame; whatever the profile says of the hand, it arrives there.
        s.choice.keptProfile = false;  // the same command gives the same run everywhere
        s.choice.placing = input::profileOf(s.choice, info).placing;
        arm.placing = *s.choice.placing;
        auto driver = std::make_unique<drivers::SimulatedDriver>(std::move(arm));
        if (!settings.realTime) {
            drivers::SimulatedDriver* servo = driver.get();
            s.choice.nowNs = [servo] { return servo->nowNs(); };
            s.choice.advance = [servo](double periodS) { servo->step(periodS); };
        }
        s.driver = std::move(driver);
    } else {
        settings.realTime = true;
        if (settings.durationS <= 0.0) settings.durationS = kHandS;
    }
    s.opened = std::make_shared<input::OpenDevice>(input::openDevice(std::move(s.driver), s.choice));
    settings.device.capability = s.opened->capability;
    settings.parameters = input::fittedTo(*s.opened, settings.parameters);
    settings.takeDevice = [opened = s.opened] { return std::move(opened->device); };
}

void RunDevice::watch() {
    State& s = *state_;
    if (!s.options.inject.empty()) return;  // asked for, and told at the end
    const safety::Health health = s.opened->health->read();
    if (health.gate.trouble == s.told) return;
    const auto trouble = input::troubleOf(health.gate, s.opened->info);
    if (trouble)
        fmt::print(stderr, "handpiece: {}. No force until it is well again.\n", trouble->what());
    else if (s.told != link::DeviceFault::none && s.told != link::DeviceFault::starting &&
             health.gate.trouble == link::DeviceFault::none)
        fmt::print(stderr, "handpiece: {} is well again.\n", s.opened->info.model);
    s.told = health.gate.trouble;
}

void RunDevice::add(Json& summary) const {
    const State& s = *state_;
    const input::OpenDevice& o = *s.opened;
    const safety::Health health = o.health->read();
    summary["driver"] = {{"name", o.info.driver},
                         {"model", o.info.model},
                         {"version", o.info.version},
                         {"scale", o.placing.scale},
                         {"left_handed", o.placing.leftHanded},
                         {"passivity_controller", o.profile.shaping.passivityController},
                         {"frames", health.frames},
                         {"troubles", health.gate.troubles},
                         {"last_trouble", link::idOf(health.gate.last)},
                         {"controller_engaged", health.shaping.engaged}};
    if (!o.faultLog) return;
    const safety::GateOutput& out = o.faultLog->output();
    Json list = Json::array();
    std::size_t late = 0;
    double largest = 0.0, slowest = 0.0;
    for (const safety::FaultOutcome& f : o.faultLog->outcomes()) {
        late += !inTime(f);
        largest = std::max(largest, f.largestN);
        slowest = std::max(slowest, f.toZeroS);
        list.push_back({{"kind", safety::nameOf(f.fault.kind)},
                        {"at_s", f.fault.atS},
                        {"lasts_s", f.fault.lastsS},
                        {"force_before_n", f.forceBeforeN},
                        {"largest_n", f.largestN},
                        {"to_zero_s", f.toZeroS >= 0.0 ? Json(f.toZeroS) : Json()},
                        {"in_time", inTime(f)},
                        {"told", f.told},
                        {"trouble", link::idOf(f.trouble)}});
    }
    summary["faults"] = {
        {"planned", o.faults.size()},
        {"happened", list.size()},
        {"not_in_time", late},
        {"largest_n", largest},
        {"slowest_to_zero_s", slowest},
        {"gate",
         {{"samples", out.samples}, {"largest_n", out.largestN}, {"largest_slope_n_per_s", out.largestSlopeNPerS}}},
        {"outcomes", list}};
}

void RunDevice::print() const {
    const State& s = *state_;
    const input::OpenDevice& o = *s.opened;
    const safety::Health health = o.health->read();
    fmt::print("  {:<14}{}{}, {:.0f} mm of the hand for one of the bur{}, {} frames\n", "device", o.info.model,
               o.info.version.empty() ? "" : " (" + o.info.version + ")", o.placing.scale,
               o.placing.leftHanded ? ", left-handed" : "", health.frames);
    if (!o.faultLog) {
        if (health.gate.troubles > 0)
            fmt::print("  {:<14}{}, the last one: {}\n", "troubles", health.gate.troubles,
                       link::sentenceOf(health.gate.last));
        return;
    }
    const std::vector<safety::FaultOutcome> all = o.faultLog->outcomes();
    const auto late = std::count_if(all.begin(), all.end(), [](const auto& f) { return !inTime(f); });
    const safety::GateOutput& out = o.faultLog->output();
    fmt::print("  {:<14}{} of {}; {} not down to zero within {:.0f} ms; never more than {:.3f} N let through\n",
               "faults", all.size(), o.faults.size(), late, 1e3 * kInTimeS, out.largestN);
    for (std::size_t i = 0; i < std::min(all.size(), kShown); ++i) {
        const safety::FaultOutcome& f = all[i];
        fmt::print("  {:<14}{:<8} at {:8.3f} s: {:.3f} N before, {:.3f} N at most, {}, {}\n", "",
                   safety::nameOf(f.fault.kind), f.fault.atS, f.forceBeforeN, f.largestN,
                   f.toZeroS >= 0.0 ? fmt::format("zero after {:.1f} ms", 1e3 * f.toZeroS) : "never zero",
                   f.told ? fmt::format("told: {}", link::idOf(f.trouble)) : "not told");
    }
    if (all.size() > kShown) fmt::print("  {:<14}{} more in summary.json\n", "", all.size() - kShown);
}

const device::Capability& RunDevice::capability() const {
    return state_->opened->capability;
}

const link::DriverInfo& RunDevice::info() const {
    return state_->opened->info;
}

double RunDevice::scale() const {
    return state_->opened->placing.scale;
}

bool RunDevice::leftHanded() const {
    return state_->opened->placing.leftHanded;
}

}  // namespace handpiece::cli
