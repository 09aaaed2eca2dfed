// SPDX-License-Identifier: Apache-2.0
// What the machine itself says: kernel, cores, governor, who may open the device's bus.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <thread>

#include "handpiece/devices/fidelity/recording.h"

namespace handpiece::fidelity {
namespace {

namespace fs = std::filesystem;

std::string lineOf(const fs::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

/// The maker of a driver's devices on the USB; empty where they are reached otherwise or that is not known.
std::pair<std::string, std::string> usbIdsOf(const std::string& driver) {
    if (driver == "falcon") return {"0403", "cb48"};      // libnifalcon's udev rule
    if (driver == "forcedimension") return {"1451", ""};  // [R]
    if (driver == "spacemouse") return {"256f", ""};      // [R]: 3Dconnexion
    return {};
}

}  // namespace

std::string machineLine(const rt::SchedulingGrant& grant) {
    const fs::path kernel = "/proc/sys/kernel";
    const std::string system = lineOf(kernel / "ostype"), release = lineOf(kernel / "osrelease");
    return fmt::format("{} {}, {} cores; {}", system.empty() ? "unknown system" : system, release,
                       std::max(1u, std::thread::hardware_concurrency()), grant.line);
}

Finding governorFinding() {
    Finding f;
    f.id = "cpu-governor";
    f.name = "CPU frequency";
    f.against = "the governor \"performance\" everywhere: clocks that wake up take longer than a tick may";
    std::map<std::string, int> governors;
    std::error_code ec;
    for (const auto& cpu : fs::directory_iterator("/sys/devices/system/cpu", ec)) {
        const std::string governor = lineOf(cpu.path() / "cpufreq" / "scaling_governor");
        if (!governor.empty()) ++governors[governor];
    }
    if (governors.empty()) {
        f.value = "not told by this machine";
        return f;
    }
    for (const auto& [name, count] : governors)
        f.value += fmt::format("{}{} on {} cores", f.value.empty() ? "" : ", ", name, count);
    f.verdict = governors.size() == 1 && governors.count("performance") == 1 ? Verdict::pass : Verdict::warn;
    if (f.verdict == Verdict::warn) f.remedy = "set it while practising: cpupower frequency-set -g performance";
    return f;
}

Finding usbFinding(const std::string& driver) {
    Finding f;
    f.id = "permission";
    f.name = "Permission";
    f.against = "whoever practises may read and write the device's node under /dev/bus/usb";
    const auto [vendor, product] = usbIdsOf(driver);
    if (vendor.empty()) {
        f.value = "not asked for: this driver opens no USB device itself";
        return f;
    }
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator("/sys/bus/usb/devices", ec)) {
        if (lineOf(entry.path() / "idVendor") != vendor) continue;
        if (!product.empty() && lineOf(entry.path() / "idProduct") != product) continue;
        try {
            const fs::path node = fmt::format("/dev/bus/usb/{:03}/{:03}", std::stoi(lineOf(entry.path() / "busnum")),
                                              std::stoi(lineOf(entry.path() / "devnum")));
            const bool may = std::fstream(node, std::ios::in | std::ios::out | std::ios::binary).is_open();
            f.value = fmt::format("{} {}", node.string(), may ? "may be opened" : "may not be opened");
            f.verdict = may ? Verdict::pass : Verdict::fail;
            if (!may) f.remedy = "install the udev rules (docs/devices.md) and connect the device again";
            return f;
        } catch (const std::exception&) {
            continue;  // gone while it was looked at
        }
    }
    f.value = fmt::format("no USB device of maker {} is connected", vendor);
    return f;
}

}  // namespace handpiece::fidelity
