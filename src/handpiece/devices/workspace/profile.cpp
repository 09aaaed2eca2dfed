// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/workspace/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::workspace {
namespace {

namespace fs = std::filesystem;
using config::Table;

constexpr double kDefaultDelayPeriods = 2.0;  // a frame of the servo to read in, one to answer in

/// A name that any file system takes.
std::string plain(const std::string& text) {
    std::string out;
    for (const char c : text) {
        const bool keep = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (keep)
            out += c;
        else if (c >= 'A' && c <= 'Z')
            out += static_cast<char>(c - 'A' + 'a');
        else if (!out.empty() && out.back() != '-')
            out += '-';
    }
    while (!out.empty() && out.back() == '-')
        out.pop_back();
    return out.empty() ? "device" : out.substr(0, 64);
}

/// A basic TOML string.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            out += std::string("\\") + c;
        else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            out += c;
    }
    return out + '"';
}

void take(const Table& t, const char* key, double& value, double least, double most) {
    const auto number = t.number(key);
    if (!number) return;
    if (!(*number >= least && *number <= most))
        t.fail(fmt::format("\"{}\" is {:.6g}", key, *number), fmt::format("give {:.6g} to {:.6g}", least, most), key);
    value = *number;
}

void take(const Table& t, const char* key, bool& value) {
    if (const auto flag = t.flag(key)) value = *flag;
}

void take(const Table& t, const char* key, core::Vec3& value) {
    if (!t.has(key)) return;
    const std::vector<double> n = t.numbers(key);
    if (n.size() != 3) t.fail(fmt::format("\"{}\" has {} numbers", key, n.size()), "give three: x, y, z", key);
    value = {n[0], n[1], n[2]};
}

void readPlacing(const Table& t, WorkspaceMapping& p) {
    t.allowOnly({"device_mm", "tooth_in_device", "scale", "hand", "bur_along_stylus", "head_angle_deg", "head_roll_deg",
                 "tip_from_stylus_mm"});
    take(t, "device_mm", p.deviceMm);
    take(t, "tip_from_stylus_mm", p.tipFromStylusMm);
    take(t, "scale", p.scale, 1.0, 3.0);
    take(t, "bur_along_stylus", p.burAlongStylus);
    take(t, "head_angle_deg", p.headAngleDeg, 60.0, 180.0);
    take(t, "head_roll_deg", p.headRollDeg, -180.0, 180.0);
    if (t.has("tooth_in_device")) {
        const std::vector<double> q = t.numbers("tooth_in_device");
        if (q.size() != 4)
            t.fail(fmt::format("\"tooth_in_device\" has {} numbers", q.size()), "give four: w, x, y, z",
                   "tooth_in_device");
        p.toothInDevice = core::Quat(q[0], q[1], q[2], q[3]);
        // A hand writes 0.7071: near enough to say what is meant.
        if (std::abs(p.toothInDevice.norm() - 1.0) < 1e-3) p.toothInDevice.normalize();
    }
    if (const auto hand = t.text("hand")) {
        if (*hand != "right" && *hand != "left")
            t.fail(fmt::format("the hand is \"{}\"", *hand), "give right or left", "hand");
        p.leftHanded = *hand == "left";
    }
    try {
        validate(p);
    } catch (const core::Error& e) {
        t.fail(e.problem(), e.remedy(), e.where());
    }
}

void readShaping(const Table& t, stability::ShaperSettings& s) {
    t.allowOnly({"passivity_controller", "friction_compensation", "thermal_budget", "force_scale", "friction_n",
                 "friction_share", "thermal_tau_s", "delay_ms"});
    take(t, "passivity_controller", s.passivityController);
    take(t, "friction_compensation", s.frictionCompensation);
    take(t, "thermal_budget", s.thermalBudget);
    take(t, "force_scale", s.forceScale, 0.0, 2.0);
    take(t, "friction_n", s.frictionN, 0.0, 5.0);
    take(t, "friction_share", s.frictionShare, 0.0, 1.0);
    take(t, "thermal_tau_s", s.thermalTauS, 1.0, 3600.0);
    double delayMs = 1e3 * s.delayS;
    take(t, "delay_ms", delayMs, 0.0, 100.0);
    s.delayS = 1e-3 * delayMs;
}

/// Limits come from the device each time, so that no file can raise them.
void applyLimits(const device::Capability& hand, Profile& profile) {
    stability::limitTo(withinShares(hand, profile), profile.shaping);
}

std::string said(const std::string& text) {
    return text.empty() ? "(not told)" : text;
}

}  // namespace

device::Capability withinShares(const device::Capability& atTheHand, const Profile& profile) {
    device::Capability c = atTheHand;
    c.maxForceN *= profile.forceShare;
    c.continuousForceN *= profile.forceShare;
    c.maxTorqueNmm *= profile.forceShare;
    c.maxStiffnessNPerMm *= profile.stiffnessShare;
    c.maxDampingNSPerMm *= profile.stiffnessShare;
    return c;
}

Profile defaultProfile(const link::DriverInfo& info) {
    Profile p;
    p.driver = info.driver;
    p.model = info.model;
    p.serial = info.serial;
    p.shaping.frictionN = info.frictionN;
    if (info.massKg > 0.0) p.shaping.massKg = info.massKg;
    p.shaping.delayS = kDefaultDelayPeriods / std::max(info.servoHz, 1.0);
    applyLimits(info.capability, p);
    return p;
}

fs::path profileFolder() {
    const auto variable = [](const char* name) {
        const char* value = std::getenv(name);
        return fs::path(value ? value : "");
    };
    const fs::path config = variable("XDG_CONFIG_HOME");
    // The XDG base directory specification has relative ones passed over.
    return (config.is_absolute() ? config : variable("HOME") / ".config") / "handpiece" / "devices";
}

fs::path profileFile(const fs::path& folder, const link::DriverInfo& info) {
    return folder / (plain(info.driver) + "-" + plain(info.serial.empty() ? info.model : info.serial) + ".toml");
}

Profile readProfile(const fs::path& file, const link::DriverInfo& info) {
    const Table root = Table::read(file);
    root.allowOnly({"format", "device", "placing", "shaping", "limits", "buttons"});
    if (root.integer("format").value_or(0) != 1)
        root.fail("this is no device profile of format 1", "calibrate the device: handpiece device calibrate");
    Profile p = defaultProfile(info);
    const auto of = root.table("device");
    if (!of) root.fail("the profile does not say whose it is", "calibrate the device: handpiece device calibrate");
    of->allowOnly({"driver", "model", "serial"});
    const auto same = [&](const char* key, const std::string& now) {
        const std::string then = of->text(key).value_or("");
        if (then == now) return;
        throw core::Error(
            fmt::format("the profile is of another device: its {} is {}, not {}", key, said(then), said(now)),
            file.string(),
            fmt::format("name another profile, or calibrate this device: handpiece device calibrate --device {}",
                        info.driver))
            .as("profile-of-another-device", {said(then), said(now)});
    };
    same("driver", info.driver);
    same("model", info.model);
    same("serial", info.serial);
    if (const auto t = root.table("placing")) readPlacing(*t, p.placing);
    if (const auto t = root.table("shaping")) readShaping(*t, p.shaping);
    if (const auto t = root.table("limits")) {
        t->allowOnly({"force_share", "stiffness_share"});
        take(*t, "force_share", p.forceShare, 0.05, 1.0);
        take(*t, "stiffness_share", p.stiffnessShare, 0.05, 1.0);
    }
    if (const auto t = root.table("buttons")) {
        t->allowOnly({"clutch"});
        const auto bit = t->integer("clutch").value_or(p.clutchButton);
        if (bit < -1 || bit > 31)
            t->fail(fmt::format("\"clutch\" is {}", bit), "give a button from 0 to 31, or -1 for none", "clutch");
        p.clutchButton = static_cast<int>(bit);
    }
    applyLimits(info.capability, p);
    return p;
}

Profile profileFor(const link::DriverInfo& info, const fs::path& folder) {
    const fs::path file = profileFile(folder, info);
    std::error_code ec;
    return fs::exists(file, ec) ? readProfile(file, info) : defaultProfile(info);
}

void writeProfile(const fs::path& folder, const Profile& p) {
    validate(p.placing);
    stability::validate(p.shaping);
    const auto share = [](double value, const char* name) {
        if (!(value >= 0.05 && value <= 1.0))
            throw core::Error(fmt::format("a share of {:.6g}", value), name, "give 0.05 to 1");
    };
    share(p.forceShare, "force_share");
    share(p.stiffnessShare, "stiffness_share");
    if (p.clutchButton < -1 || p.clutchButton > 31)
        throw core::Error(fmt::format("no button {}", p.clutchButton), "clutch", "give 0 to 31, or -1 for none");
    const auto yes = [](bool b) { return b ? "true" : "false"; };
    const WorkspaceMapping& at = p.placing;
    const stability::ShaperSettings& s = p.shaping;
    // Numbers in full: read again they are the same bits.
    const auto point = [](const core::Vec3& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); };
    std::string text = "# Of one device; described in docs/formats/device-profile.md.\nformat = 1\n\n";
    text += fmt::format("[device]\ndriver = {}\nmodel = {}\nserial = {}\n\n", quoted(p.driver), quoted(p.model),
                        quoted(p.serial));
    text += fmt::format(
        "[placing]\ndevice_mm = {}\ntooth_in_device = [{}, {}, {}, {}]\nscale = {}\nhand = \"{}\"\n"
        "bur_along_stylus = {}\nhead_angle_deg = {}\nhead_roll_deg = {}\ntip_from_stylus_mm = {}\n\n",
        point(at.deviceMm), at.toothInDevice.w(), at.toothInDevice.x(), at.toothInDevice.y(), at.toothInDevice.z(),
        at.scale, at.leftHanded ? "left" : "right", yes(at.burAlongStylus), at.headAngleDeg, at.headRollDeg,
        point(at.tipFromStylusMm));
    text += fmt::format(
        "[shaping]\npassivity_controller = {}\nfriction_compensation = {}\nthermal_budget = {}\nforce_scale = {}\n"
        "friction_n = {}\nfriction_share = {}\nthermal_tau_s = {}\ndelay_ms = {}\n\n",
        yes(s.passivityController), yes(s.frictionCompensation), yes(s.thermalBudget), s.forceScale, s.frictionN,
        s.frictionShare, s.thermalTauS, 1e3 * s.delayS);
    text += fmt::format("[limits]\nforce_share = {}\nstiffness_share = {}\n\n[buttons]\nclutch = {}\n", p.forceShare,
                        p.stiffnessShare, p.clutchButton);
    link::DriverInfo info;
    info.driver = p.driver;
    info.model = p.model;
    info.serial = p.serial;
    core::prepareOutputFolder(folder);
    core::writeFile(profileFile(folder, info), text);
}

}  // namespace handpiece::workspace
