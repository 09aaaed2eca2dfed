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
                       std::max(1u, std::thread::hardware_concurrency()), grant.line());
}

Finding governorFinding() {
    Finding f;
    f.id = "cpu-governor";
    f.against = config::phrase("fidelity.cpu-governor-against");
    std::map<std::string, int> governors;
    std::error_code ec;
    for (const auto& cpu : fs::directory_iterator("/sys/devices/system/cpu", ec)) {
        const std::string governor = lineOf(cpu.path() / "cpufreq" / "scaling_governor");
        if (!governor.empty()) ++governors[governor];
    }
    if (governors.empty()) {
        f.value = config::phrase("fidelity.not-told-by-machine");
        return f;
    }
    std::string all;
    for (const auto& [name, count] : governors)
        all += fmt::format("{}{} ({})", all.empty() ? "" : ", ", name, count);
    f.value = config::phrase("fidelity.cpu-governor", all);
    f.verdict = governors.size() == 1 && governors.count("performance") == 1 ? Verdict::pass : Verdict::warn;
    if (f.verdict == Verdict::warn) f.remedy = config::phrase("fidelity.set-governor");
    return f;
}

Finding usbFinding(const std::string& driver) {
    Finding f;
    f.id = "permission";
    f.against = config::phrase("fidelity.permission-against");
    const auto [vendor, product] = usbIdsOf(driver);
    if (vendor.empty()) {
        f.value = config::phrase("fidelity.no-usb-itself");
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
            f.value = may ? config::phrase("fidelity.may-be-opened", node.string())
                          : config::phrase("fidelity.may-not-be-opened", node.string());
            f.verdict = may ? Verdict::pass : Verdict::fail;
            if (!may) f.remedy = config::phrase("fidelity.install-rules");
            return f;
        } catch (const std::exception&) {
            continue;  // gone while it was looked at
        }
    }
    f.value = config::phrase("fidelity.none-of-maker", vendor);
    return f;
}

}  // namespace handpiece::fidelity
