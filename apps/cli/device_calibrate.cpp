// SPDX-License-Identifier: Apache-2.0
// handpiece device calibrate: connect, calibrate as the maker wants it, say where the tooth is to lie, feel a block.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "cli/command.h"
#include "cli/device_command.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/force/parameters.h"
#include "handpiece/tick/stability/limits.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

using Json = nlohmann::ordered_json;
using core::Vec3;
using namespace std::chrono_literals;

constexpr double kFirstPoseS = 5.0, kAnswerS = 120.0;  // patience with a device; with a person
constexpr int kTries = 10;                             // of the maker's calibration
constexpr double kBlockMm = 20.0, kBlockHighMm = 8.0;

struct CalibrateOptions {
    DeviceOptions device;
    bool yes = false, json = false, alongStylus = false, rightHanded = false;
    std::vector<double> at;
    double feelS = 5.0, headAngleDeg = 0.0;
    std::string profiles;
};

/// Steps are told where they do not mix with JSON.
void say(const std::string& text) {
    fmt::print(stderr, "{}\n", text);
}

void requireGoOn() {
    if (studies::cancelled()) throw core::Error("cancelled", "device calibrate", "nothing was written");
}

bool entered() {
    pollfd in{STDIN_FILENO, POLLIN, 0};
    if (::poll(&in, 1, 0) <= 0) return false;
    std::string line;
    if (std::getline(std::cin, line)) return true;
    throw core::Error("nobody answers", "device calibrate", "give --yes, and --at for the place");
}

void waitForPose(const input::OpenDevice& device) {
    for (auto waited = 0ms; waited < std::chrono::duration<double>(kFirstPoseS); waited += 20ms) {
        requireGoOn();
        if (device.health->read().frames > 0) return;
        std::this_thread::sleep_for(20ms);
    }
    throw core::Error(fmt::format("the device told no pose within {:.0f} s", kFirstPoseS), device.info.model,
                      "switch it off and on, and close other programs that use it");
}

/// The maker's way. Returns a word for what came of it.
std::string calibrateAsTheMakerWants(const input::OpenDevice& device, bool yes) {
    link::CalibrationState state = device.calibration.state();
    if (state == link::CalibrationState::notNeeded) return "not needed";
    if (state == link::CalibrationState::good) return "good";
    for (int i = 0; i < kTries; ++i) {
        requireGoOn();
        const std::string step = device.calibration.step();
        if (!step.empty()) say("  " + step);
        if (state == link::CalibrationState::wantedByHand && !yes) {
            say("  Then press Enter.");
            while (!entered()) {
                requireGoOn();
                std::this_thread::sleep_for(20ms);
            }
        }
        if (device.calibration.tryOnce()) return "done";
        std::this_thread::sleep_for(300ms);
        state = device.calibration.state();
    }
    throw core::Error("the device is still not calibrated", device.info.model,
                      "follow the steps of its maker's own program, then try again");
}

/// Where the bur's tip is held now, device frame: with the lever of the instrument.
Vec3 tipNow(const safety::Health& health, const workspace::WorkspaceMapping& placing) {
    workspace::WorkspaceMapping inDevice = placing;
    inDevice.deviceMm = inDevice.toothMm = Vec3::Zero();
    inDevice.toothInDevice = core::Quat::Identity();
    inDevice.scale = 1.0;
    link::DriverReading reading;
    reading.positionMm = health.positionMm;
    reading.orientation = health.orientation;
    return workspace::WorkspaceTransform(inDevice).burInTooth(reading).positionMm;
}

Vec3 placeOf(const CalibrateOptions& o, const input::OpenDevice& device) {
    if (!o.at.empty()) return {o.at[0], o.at[1], o.at[2]};
    if (!o.yes) {
        say("  Hold the stylus at the middle of its reach, as if on the tooth, and press its upper button (or Enter).");
        for (auto waited = 0ms;; waited += 20ms) {
            requireGoOn();
            if ((device.health->read().buttons & 1u) != 0 || entered()) break;
            if (waited > std::chrono::duration<double>(kAnswerS))
                throw core::Error("nobody pressed the button", "device calibrate", "try again, or give --at X Y Z");
            std::this_thread::sleep_for(20ms);
        }
    }
    return tipNow(device.health->read(), device.profile.placing);
}

/// How stiff a wall this arm renders stably without help, by its figures; those that are unknown as of an Omni.
stability::StableLimits stableFor(const link::DriverInfo& info, const workspace::Profile& profile) {
    stability::DeviceFigures figures;
    if (info.massKg > 0.0) figures.massKg = info.massKg;
    if (info.frictionN > 0.0) figures.frictionN = info.frictionN;
    figures.delayS = profile.shaping.delayS;
    figures.rateHz = std::clamp(info.servoHz, 100.0, 10000.0);
    figures.encoderStepMm = info.capability.encoderStepMm;
    figures.maxForceN = info.capability.maxForceN;
    return stability::limitsFor(figures, [](double) { return !studies::cancelled(); });
}

/// A block of enamel whose top is at z = 0.
cases::Case blockCase() {
    cases::Case block;
    block.name = "block";
    const double half = 0.5 * kBlockMm;
    for (int i = 0; i < 8; ++i)
        block.outer.vertices.emplace_back((i & 1) ? half : -half, (i & 2) ? half : -half,
                                          (i & 4) ? 0.0 : -kBlockHighMm);
    block.outer.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                             {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    cases::Part enamel;
    enamel.name = "enamel";
    enamel.tissue = cases::Tissue::enamel;
    enamel.mesh = block.outer;
    block.parts.push_back(std::move(enamel));
    return block;
}

studies::RunSummary feelBlock(const CalibrateOptions& o, const workspace::Profile& profile) {
    const cases::Case block = blockCase();
    tooth::LoadSettings prepare;
    prepare.field.voxelMm = 0.2;
    prepare.field.bandOutMm = std::max(prepare.field.bandOutMm, 0.4);
    prepare.field.bandInMm = std::max(prepare.field.bandInMm, 0.8);
    prepare.useCache = false;
    const auto tooth = tooth::loadModel(block, prepare);
    input::DeviceChoice choice = choiceOf(o.device);
    choice.placing = profile.placing;
    choice.placing->toothMm = Vec3::Zero();
    choice.placing->toothInDevice =
        profile.placing.toothInDevice * input::toothTurnFor({tooth->outer.bounds(), 0, 1}, profile.placing.leftHanded);
    input::OpenDevice device = input::openDevice(choice);
    studies::RunSettings settings;
    settings.durationS = o.feelS;
    settings.realTime = true;
    settings.device.capability = device.capability;
    settings.parameters = input::fittedTo(device, force::defaultParameters(block.tissues));
    settings.takeDevice = [&] { return std::move(device.device); };
    const core::Pose anywhere;
    const device::Motion none({{0.0, anywhere, 0.0}, {1.0, anywhere, 0.0}});
    return studies::runLoop(settings, none, contact::makeFieldMethod(tooth, instrument::makeInstrument("round-8").bur),
                            [](const messages::HapticSample&) {});
}

void calibrate(const CalibrateOptions& o) {
    validate(o.device);
    if (!(o.feelS >= 0.0 && o.feelS <= 600.0))
        throw core::Error(fmt::format("{:.6g} s at the block", o.feelS), "--feel", "give 0 to 600");
    const bool real = isReal(o.device);
    say("1. Connect");
    input::DeviceChoice choice = choiceOf(o.device);
    choice.profileFolder = o.profiles;
    workspace::Profile profile;
    std::string calibrated;
    std::optional<stability::StableLimits> stable;
    std::filesystem::path file;
    {
        const input::OpenDevice device = input::openDevice(choice);
        waitForPose(device);
        say(fmt::format("  {} is there{}.", device.info.model,
                        device.info.version.empty() ? "" : " (" + device.info.version + ")"));
        say("2. Calibrate");
        calibrated = calibrateAsTheMakerWants(device, o.yes);
        say("  " + calibrated + ".");
        say("3. Where the tooth lies");
        profile = device.profile;
        if (o.alongStylus) profile.placing.burAlongStylus = true;
        if (o.headAngleDeg != 0.0) profile.placing.headAngleDeg = o.headAngleDeg;
        if (o.rightHanded) profile.placing.leftHanded = false;
        profile.placing.deviceMm = placeOf(o, device);
        workspace::validate(profile.placing);
        if (device.info.pushes) {
            stable = stableFor(device.info, profile);
            // Never more than the record: an ideal arm in ideal hands is not this one.
            profile.stiffnessShare =
                std::clamp(stable->stiffnessNPerMm / device.info.capability.maxStiffnessNPerMm, 0.05, 1.0);
            say(fmt::format(
                "  stable without help up to {:.2f} N/mm; its record says {:.2f}, {:.0f} % of that are used",
                stable->stiffnessNPerMm, device.info.capability.maxStiffnessNPerMm, 1e2 * profile.stiffnessShare));
        }
        const std::filesystem::path folder =
            o.profiles.empty() ? workspace::profileFolder() : std::filesystem::path(o.profiles);
        workspace::writeProfile(folder, profile);
        file = workspace::profileFile(folder, device.info);
        const Vec3& p = profile.placing.deviceMm;
        say(fmt::format("  at {:.1f}, {:.1f}, {:.1f} mm of the device: {}", p.x(), p.y(), p.z(), file.string()));
    }  // closed: it is opened again with its new profile
    std::optional<studies::RunSummary> felt;
    if (o.feelS > 0.0) {
        say(fmt::format("Feel a block of enamel for {:.3g} s{}.", o.feelS, real ? ": touch it from above" : ""));
        felt = feelBlock(o, profile);
        say(felt->touched ? fmt::format("  touched for {:.1f} s, {:.2f} N at most", felt->contactS, felt->peakForceN)
                          : "  it was not touched");
    }
    if (!o.json) return;
    const workspace::WorkspaceMapping& at = profile.placing;
    Json out = {{"driver", profile.driver},  {"model", profile.model},
                {"serial", profile.serial},  {"profile", file.string()},
                {"calibration", calibrated}, {"device_mm", {at.deviceMm.x(), at.deviceMm.y(), at.deviceMm.z()}},
                {"scale", at.scale},         {"left_handed", at.leftHanded}};
    if (stable)
        out["stable"] = {{"stiffness_n_per_mm", stable->stiffnessNPerMm},
                         {"damping_n_s_per_mm", stable->dampingNSPerMm},
                         {"share_of_record", profile.stiffnessShare}};
    if (felt) out["block"] = {{"contact_s", felt->contactS}, {"peak_force_n", felt->peakForceN}};
    fmt::print("{}\n", out.dump(2, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

void addDeviceCalibrateCommand(Command& device) {
    Command command = device.subcommand("calibrate", "A new device: connect, calibrate, place the tooth, feel");
    const auto options = std::make_shared<CalibrateOptions>();
    CalibrateOptions& o = *options;
    command.option("--device", o.device.name, "name from the list; else the one that is there, else simulated");
    command.option("--which", o.device.which, "device's name or serial, where there are several");
    command.flag("--yes", o.yes, "ask nothing: the place is where the stylus is, or --at");
    command.option("--at", o.at, "the tooth's place in the device [mm]: x to the right, y up, z to you").expected(3);
    command.option("--scale", o.device.scale, "millimetres of the hand for one of the bur: 1, 2 or 3")
        .check(nonNegative());
    Option left = command.flag("--left-handed", o.device.leftHanded, "the hand comes from the left");
    command.flag("--right-handed", o.rightHanded, "the hand comes from the right, as when nothing is said")
        .excludes(left);
    command.flag("--along-stylus", o.alongStylus, "the bur goes on along the stylus: no angled head");
    command.option("--head-angle", o.headAngleDeg, "between handle and bur [degrees], 60 to 180; 100 when new");
    command.option("--feel", o.feelS, "seconds at a block of enamel; 0: none").showDefault();
    command.option("--profiles", o.profiles, "folder of the profiles, instead of one's own");
    command.flag("--json", o.json, "what came of it as JSON");
    command.footer(
        "Writes the device's profile: docs/formats/device-profile.md.\n"
        "Example:\n  handpiece device calibrate --device openhaptics\n"
        "  handpiece device calibrate --device simulated --yes --at 0 0 0");
    command.callback([options, command] {
        if (!command.isGiven("--device")) options->device.name = deviceMeant();
        applySchoolDefaults(command, options->device);
        if (options->rightHanded) options->device.leftHanded = false;
        calibrate(*options);
    });
}

}  // namespace handpiece::cli
