// SPDX-License-Identifier: Apache-2.0
// handpiece device: which devices there are, how good this station feels, the first three steps with a new one.
#include "cli/device_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "handpiece/app/exercise/school_defaults.h"
#include "handpiece/app/report/fidelity_report.h"
#include "handpiece/base/config/words.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "studies/progress_bar.h"

namespace handpiece::cli {
namespace {

using config::words;

using Json = nlohmann::ordered_json;

void list(bool json) {
    const std::vector<drivers::Found> found = input::lookForDevices();
    if (json) {
        Json all = Json::array();
        for (const drivers::Found& f : found)
            all.push_back({{"driver", f.driver},
                           {"makes", f.makes},
                           {"pushes", f.pushes},
                           {"available", f.available},
                           {"models", f.models},
                           {"why", f.why},
                           {"remedy", f.remedy},
                           {"tried_on_hardware", f.triedOnHardware}});
        fmt::print("{}\n", all.dump(2, ' ', false, Json::error_handler_t::replace));
        return;
    }
    for (const drivers::Found& f : found) {
        fmt::print("{:<16}{}\n", f.driver, f.makes);
        std::string state = f.available ? "there" : "not there";
        if (!f.models.empty()) state += fmt::format(": {}", fmt::join(f.models, ", "));
        if (!f.why.empty()) state += fmt::format("; {}", f.why);
        fmt::print("{:<16}{}\n", "", state);
        if (!f.available && !f.remedy.empty()) fmt::print("{:<16}to do: {}\n", "", f.remedy);
        if (!f.pushes) fmt::print("{:<16}cannot push: it steers a simulated hand\n", "");
        if (f.driver != "simulated" && !f.triedOnHardware)
            fmt::print("{:<16}never tried on the hardware itself, only against a double of its interface\n", "");
    }
}

struct CheckOptions {
    DeviceOptions device;
    double durationS = 10.0, rateHz = 1000.0;
    bool json = false, noPush = false;
    std::string report;
};

void check(const CheckOptions& o) {
    validate(o.device);
    input::DeviceChoice choice = choiceOf(o.device);
    std::unique_ptr<link::Driver> driver = input::openDriver(choice);
    fidelity::CheckSettings settings;
    settings.durationS = o.durationS;
    settings.rateHz = o.rateHz;
    settings.push = !o.noPush;
    settings.announce = [](const std::string& sentence) { fmt::print(stderr, "handpiece: {}\n", sentence); };
    const fidelity::Report report =
        fidelity::check(std::move(driver), settings, [](double) { return !studies::cancelled(); });
    if (!o.report.empty()) core::writeFile(o.report, report::fidelityReport(report));
    if (o.json) {
        fmt::print("{}", fidelity::asJson(report));
        return;
    }
    fmt::print("{} ({}), {:.1f} s\n  {}\n", report.device.model, report.device.driver, report.durationS,
               report.machine);
    for (const fidelity::Finding& f : report.findings) {
        fmt::print("  {:<13}{:<26}{}\n", words()(fmt::format("fidelity.verdict.{}", idOf(f.verdict))),
                   nameOf(f, words()), words()(f.value));
        const bool mind = f.verdict == fidelity::Verdict::warn || f.verdict == fidelity::Verdict::fail;
        if (mind) fmt::print("  {:<39}{}: {}\n", "", words()("fidelity.held-against"), words()(f.against));
        if (mind && !f.remedy.empty()) fmt::print("  {:<39}{}: {}\n", "", words()("fidelity.to-do"), words()(f.remedy));
    }
    fmt::print("{}\n", report.passed ? words()("fidelity.fit") : words()("fidelity.not-fit"));
    if (!o.report.empty()) fmt::print("{}\n", o.report);
}

}  // namespace

std::string deviceMeant() {
    const exercise::SchoolDefaults school = exercise::schoolDefaults();
    if (school.device) return *school.device;
    for (const drivers::Found& f : input::lookForDevices())
        if (f.available && f.pushes && !f.models.empty()) return f.driver;
    return "simulated";
}

void addDeviceCommand(Command& app) {
    Command device = app.subcommand("device", "Haptic devices: which there are, how good they feel, first steps");
    device.requireSubcommand();

    Command listing = device.subcommand("list", "Devices that can be used, and whether they are there");
    const auto json = std::make_shared<bool>(false);
    listing.flag("--json", *json, "as JSON");
    listing.footer("Nothing is opened and nothing moves.\nExample:\n  handpiece device list");
    listing.callback([json] { list(*json); });

    Command checking = device.subcommand("check", "How good this station feels: the fidelity report");
    const auto options = std::make_shared<CheckOptions>();
    CheckOptions& o = *options;
    checking.option("--device", o.device.name, "name from the list; else the one that is there, else simulated");
    checking.option("--which", o.device.which, "device's name or serial, where there are several");
    checking.option("--duration", o.durationS, "seconds").showDefault();
    checking.option("--rate", o.rateHz, "ticks a second").showDefault();
    checking.flag("--no-push", o.noPush, "send no force: slope and round trip are not measured");
    checking.flag("--json", o.json, "the report as JSON on the output");
    checking.option("--report", o.report, "the report as a page to print (.html)");
    checking.footer(
        "It pushes upwards, 0.8 N at most, some times for 60 ms, and says so before.\n"
        "Example:\n  handpiece device check --device openhaptics --report station.html");
    checking.callback([options, checking] {
        if (!checking.isGiven("--device")) options->device.name = deviceMeant();
        check(*options);
    });

    addDeviceCalibrateCommand(device);
}

}  // namespace handpiece::cli
