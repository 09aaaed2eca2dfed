// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/device_opening.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "handpiece/app/input/pointer_controller.h"
#include "handpiece/devices/drivers/simulated_driver.h"
#include "handpiece/devices/safety/input_device.h"
#include "handpiece/tick/device/capability.h"

namespace handpiece::input {
namespace {

using core::Quat;
using core::Vec3;

constexpr double kHeldAboveMm = 30.0;  // of a tooth, the simulated arm that is to be measured

/// A hand that holds a pen over a desk comes from the right and the front alike; a left one from the left.
Vec3 handComesFrom(bool leftHanded) {
    return Vec3(leftHanded ? -1.0 : 1.0, 0.0, 1.0).normalized();
}

Calibration calibrationOf(safety::GuardedDevice& device) {
    return {[&device] { return device.calibration(); }, [&device] { return device.calibrationStep(); },
            [&device] { return device.calibrate(); }};
}

}  // namespace

std::vector<drivers::Found> lookForDevices() {
    return drivers::look();
}

const std::vector<std::string>& deviceNames() {
    return drivers::names();
}

Quat toothTurnFor(const ToothPlace& tooth, bool leftHanded) {
    // Where the handle goes when nobody turns it, along the occlusal plane of the tooth.
    Vec3 handle = startPose(tooth.box, tooth.fdiNumber, tooth.buccalSign).orientation * Vec3::UnitX();
    handle = Vec3(handle.x(), handle.y(), 0.0).normalized();
    const Vec3 from = handComesFrom(leftHanded);
    // Tooth axes as columns in the device frame: +z up, `handle` to where the hand comes from.
    core::Mat3 inTooth, inDevice;
    inTooth << handle, Vec3::UnitZ().cross(handle), Vec3::UnitZ();
    inDevice << from, Vec3::UnitY().cross(from), Vec3::UnitY();
    return Quat(core::Mat3(inDevice * inTooth.transpose())).normalized();
}

workspace::WorkspaceMapping placingFor(const workspace::Profile& profile, const ToothPlace& tooth) {
    workspace::WorkspaceMapping placing = profile.placing;
    if (tooth.box.isEmpty()) return placing;
    placing.toothMm = {tooth.box.centre().x(), tooth.box.centre().y(), tooth.box.max.z()};
    placing.toothInDevice = placing.toothInDevice * toothTurnFor(tooth, placing.leftHanded);
    return placing;
}

std::unique_ptr<link::Driver> openDriver(const DeviceChoice& choice) {
    if (choice.name != "simulated") return drivers::open(choice.name, {choice.which, choice.servoHz});
    drivers::SimulatedSettings settings;
    if (!choice.which.empty() && choice.which != settings.model) {
        settings.arm.capability = device::capabilityByName(choice.which);
        settings.model = choice.which;
    }
    if (choice.servoHz > 0.0) settings.servoHz = choice.servoHz;
    const core::Pose held{Vec3(0.0, 0.0, kHeldAboveMm), Quat::Identity()};
    settings.motion = device::Motion({{0.0, held, 0.0}, {1.0, held, 0.0}});
    return std::make_unique<drivers::SimulatedDriver>(std::move(settings));
}

workspace::Profile profileOf(const DeviceChoice& choice, const link::DriverInfo& info) {
    const std::filesystem::path folder =
        choice.profileFolder.empty() ? workspace::profileFolder() : choice.profileFolder;
    workspace::Profile p = !choice.profile.empty() ? workspace::readProfile(choice.profile, info)
                           : choice.keptProfile    ? workspace::profileFor(info, folder)
                                                   : workspace::defaultProfile(info);
    if (choice.placing) p.placing = *choice.placing;
    if (choice.scale) p.placing.scale = *choice.scale;
    if (choice.leftHanded) p.placing.leftHanded = *choice.leftHanded;
    if (choice.forceScale) p.shaping.forceScale = *choice.forceScale;
    if (choice.passivityController) p.shaping.passivityController = *choice.passivityController;
    if (choice.frictionCompensation) p.shaping.frictionCompensation = *choice.frictionCompensation;
    workspace::validate(p.placing);
    stability::validate(p.shaping);
    return p;
}

OpenDevice openDevice(const DeviceChoice& choice) {
    return openDevice(drivers::open(choice.name, {choice.which, choice.servoHz}), choice);
}

OpenDevice openDevice(std::unique_ptr<link::Driver> driver, const DeviceChoice& choice) {
    OpenDevice open;
    open.info = driver->info();
    open.profile = profileOf(choice, open.info);
    // The simulated arm's own motion is told in the tooth's frame.
    const bool fit = !choice.placing && open.info.driver != "simulated";
    open.placing = fit ? placingFor(open.profile, choice.tooth) : open.profile.placing;
    if (!choice.faults.empty()) {
        open.faults = safety::parseFaults(choice.faults);
        open.faultLog = std::make_shared<safety::FaultLog>();
        driver = safety::withFaults(std::move(driver), open.faults, open.faultLog);
    }
    if (choice.pedal) open.pedal = std::make_shared<drivers::FootPedal>(drivers::PedalSettings{});
    const std::shared_ptr<const link::PedalValue> foot = open.pedal ? open.pedal->value() : choice.foot;
    if (!open.info.pushes) {
        safety::InputSettings input;
        input.placing = open.placing;
        input.hand = choice.hand;
        input.clutchButton = open.profile.clutchButton;
        input.nowNs = choice.nowNs;
        auto steered = std::make_unique<safety::InputDevice>(std::move(driver), input);
        if (foot) steered->usePedal(foot);
        open.health = steered->health();
        open.capability = steered->capability();
        open.calibration = {[] { return link::CalibrationState::notNeeded; }, [] { return std::string(); },
                            [] { return true; }};
        open.device = std::move(steered);
        return open;
    }
    safety::GuardSettings guard;
    guard.atTheHand = workspace::withinShares(open.info.capability, open.profile);
    guard.gate = safety::gateSettingsFor(*guard.atTheHand);
    guard.placing = open.placing;
    guard.shaping = open.profile.shaping;
    guard.clutchButton = open.profile.clutchButton;
    guard.nowNs = choice.nowNs;
    guard.advance = choice.advance;
    auto guarded = std::make_unique<safety::GuardedDevice>(std::move(driver), guard);
    open.health = guarded->health();
    open.calibration = calibrationOf(*guarded);
    open.capability = guarded->capability();
    open.device = std::move(guarded);
    if (foot) open.device = safety::withPedal(std::move(open.device), foot);
    return open;
}

force::Parameters fittedTo(const OpenDevice& device, force::Parameters parameters) {
    if (device.capability.maxTorqueNmm > 0.0)
        parameters.gripMm = workspace::WorkspaceTransform(device.placing).gripInBurMm();
    return parameters;
}

std::optional<core::Error> troubleOf(const safety::GateStatus& status, const link::DriverInfo& device) {
    const link::DeviceFault trouble = status.trouble;
    if (trouble == link::DeviceFault::none || trouble == link::DeviceFault::starting) return std::nullopt;
    const auto withoutStop = [](std::string_view text) {
        return std::string(!text.empty() && text.back() == '.' ? text.substr(0, text.size() - 1) : text);
    };
    const std::string words = drivers::vendorErrorInWords(device.driver, status.vendorCode);
    std::string what = withoutStop(link::sentenceOf(trouble));
    if (!words.empty()) what += ": " + withoutStop(words);
    // The words of a code say what to do about it themselves.
    return core::Error(what, device.model, words.empty() ? withoutStop(link::remedyOf(trouble)) : std::string())
        .as(std::string(link::idOf(trouble)), {device.model, words});
}

}  // namespace handpiece::input
