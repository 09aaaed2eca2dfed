// SPDX-License-Identifier: Apache-2.0
// handpiece run: a simulated hand moves the bur, the loop feels the tooth; a trace, plots and a summary come out.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/csv.h"
#include "cli/inputs.h"
#include "cli/plot.h"
#include "cli/progress_bar.h"
#include "cli/run_job.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/tick/device/capability.h"
#include "handpiece/tick/loop/built_in_motion.h"

namespace handpiece::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using messages::HapticSample;

constexpr std::string_view kHeader =
    "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,vx_mm_s,vy_mm_s,vz_mm_s,fx_n,fy_n,fz_n,depth_mm,work_us,late_us,"
    "true_x_mm,true_y_mm,true_z_mm,proxy_x_mm,proxy_y_mm,proxy_z_mm,proxy_qw,proxy_qx,proxy_qy,proxy_qz,"
    "applied_fx_n,applied_fy_n,applied_fz_n,area_mm2,tissue,flags\n";

struct RunOptions {
    ContactInputs inputs;
    std::string motion = "drop", device = "simulated", deviceModel = "simulated", hand = "normal", force = "proxy", out;
    double rateHz = 1000.0, durationS = 0.0, stiffness = 1.0, damping = 1.0, speedMmS = 10.0;
    double loadN = 1.0, depthMm = 0.0, delayMs = 0.0, frictionN = 0.26, lengthMm = 0.0;
    std::vector<double> at{0.0, 0.0};
    bool realTime = false, json = false;
};

/// The files of one run: all of them, or none. Undoes what it wrote unless keep() was called.
class Outputs {
  public:
    explicit Outputs(const fs::path& folder) : folder_(folder) {
        std::error_code ec;
        existed_ = fs::exists(folder, ec);
        core::prepareOutputFolder(folder);
    }
    ~Outputs() {
        if (kept_) return;
        std::error_code ec;
        for (const fs::path& path : written_)
            fs::remove(path, ec);
        if (!existed_) fs::remove(folder_, ec);  // only when empty
    }
    Outputs(const Outputs&) = delete;
    Outputs& operator=(const Outputs&) = delete;

    [[nodiscard]] fs::path path(const char* name) const { return folder_ / name; }
    void wrote(const char* name) { written_.push_back(path(name)); }
    void write(const char* name, const std::string& text) {
        core::writeFile(path(name), text);
        wrote(name);
    }
    void keep() { kept_ = true; }

  private:
    fs::path folder_;
    std::vector<fs::path> written_;
    bool existed_ = false, kept_ = false;
};

/// Curves of a run of any length in bounded memory: the least and the greatest of each of many equal times.
class Curve {
  public:
    explicit Curve(double durationS) : perBucketS_(durationS / kBuckets) {}
    void take(double t, double y) {
        const auto bucket = static_cast<std::int64_t>(perBucketS_ > 0.0 ? t / perBucketS_ : 0.0);
        if (bucket != bucket_) flush();
        bucket_ = bucket;
        if (count_++ == 0) low_ = high_ = {t, y};
        if (y < low_.y) low_ = {t, y};
        if (y > high_.y) high_ = {t, y};
    }
    [[nodiscard]] Series series(std::string name) {
        flush();
        Series s;
        s.name = std::move(name);
        s.x = x_;
        s.y = y_;
        return s;
    }

  private:
    struct Point {
        double t = 0.0, y = 0.0;
    };
    static constexpr double kBuckets = 4000.0;
    void add(const Point& p) {
        x_.push_back(p.t);
        y_.push_back(p.y);
    }
    void flush() {
        if (count_ == 0) return;
        const bool lowFirst = low_.t <= high_.t;
        add(lowFirst ? low_ : high_);
        if (low_.t != high_.t) add(lowFirst ? high_ : low_);
        count_ = 0;
    }
    double perBucketS_;
    std::int64_t bucket_ = 0;
    std::size_t count_ = 0;
    Point low_, high_;
    std::vector<double> x_, y_;
};

void writeLine(TextWriter& out, fmt::memory_buffer& buffer, const HapticSample& s) {
    buffer.clear();
    const auto to = std::back_inserter(buffer);
    const auto& p = s.positionMm;
    const auto& q = s.orientation;
    const auto& v = s.velocityMmS;
    const auto& f = s.forceN;
    fmt::format_to(to, "{:.7g},{:.7f},{:.7f},{:.7f},{:.9f},{:.9f},{:.9f},{:.9f},", s.timeS, p[0], p[1], p[2], q[0],
                   q[1], q[2], q[3]);
    fmt::format_to(to, "{:.6f},{:.6f},{:.6f},{:.7f},{:.7f},{:.7f},{:.9f},{:.3f},{:.3f},", v[0], v[1], v[2], f[0], f[1],
                   f[2], s.depthMm, s.workUs, s.lateUs);
    const auto& a = s.appliedForceN;
    const auto& r = s.proxyOrientation;
    fmt::format_to(to, "{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.7f},{:.9f},{:.9f},{:.9f},{:.9f},", s.truePositionMm[0],
                   s.truePositionMm[1], s.truePositionMm[2], s.proxyPositionMm[0], s.proxyPositionMm[1],
                   s.proxyPositionMm[2], r[0], r[1], r[2], r[3]);
    fmt::format_to(to, "{:.7f},{:.7f},{:.7f},{:.6f},{},{}\n", a[0], a[1], a[2], s.contactAreaMm2,
                   tooth::properties(static_cast<tooth::Tissue>(s.tissue)).name, s.flags);
    out.write({buffer.data(), buffer.size()});
}

Json spreadJson(const loop::Spread& s) {
    return {{"p50", s.p50}, {"p99", s.p99}, {"p999", s.p999}, {"max", s.max}};
}

Json summaryJson(const RunOptions& o, const RunSummary& s, const std::string& method) {
    return {{"tooth", o.inputs.tooth},
            {"bur", o.inputs.bur},
            {"method", method},
            {"motion", o.motion},
            {"force", o.force},
            {"device", o.device},
            {"device_model", o.deviceModel},
            {"hand", o.hand},
            {"rate_hz", o.rateHz},
            {"real_time", o.realTime},
            {"stopped_early", s.stopped},
            {"duration_s", s.durationS},
            {"ticks", s.report.ticks},
            {"late_ticks", s.report.lateTicks},
            {"missed_periods", s.report.missedPeriods},
            {"queue_overflow", s.report.queueOverflow},
            {"scheduling", s.report.scheduling},
            {"work_us", spreadJson(s.report.workUs)},
            {"lateness_us", spreadJson(s.report.latenessUs)},
            {"peak_force_n", s.peakForceN},
            {"deepest_mm", s.deepestMm},
            {"contact_s", s.contactS},
            {"largest_area_mm2", s.largestAreaMm2},
            {"force_limited_ticks", s.limitedTicks},
            {"slope_limited_ticks", s.slopeLimitedTicks},
            {"fault_ticks", s.faultTicks},
            {"truncated_ticks", s.truncatedTicks}};
}

void printSummary(const RunOptions& o, const RunSummary& s, const std::string& method) {
    const auto row = [](const char* name, const std::string& value) { fmt::print("  {:<14}{}\n", name, value); };
    const loop::RunReport& r = s.report;
    fmt::print("{}{}\n", o.out, s.stopped ? " (stopped early; what there was is written)" : "");
    row("ran", fmt::format("{} on {} with {}, {}, {:.3f} s at {:.0f} Hz", o.motion, o.inputs.tooth, o.inputs.bur,
                           method, s.durationS, o.rateHz));
    row("ticks", fmt::format("{}, late {}, left out {}", r.ticks, r.lateTicks, r.missedPeriods));
    row("scheduling", r.scheduling);
    row("work", fmt::format("p50 {:.1f}, p99 {:.1f}, p99.9 {:.1f}, worst {:.1f} us a tick", r.workUs.p50, r.workUs.p99,
                            r.workUs.p999, r.workUs.max));
    row("contact", s.touched ? fmt::format("{:.3f} s, deepest {:.4f} mm, largest area {:.3f} mm2", s.contactS,
                                           s.deepestMm, s.largestAreaMm2)
                             : fmt::format("none, nearest {:.4f} mm", -s.deepestMm));
    row("peak force",
        fmt::format("{:.3f} N{}", s.peakForceN,
                    s.limitedTicks ? fmt::format(", at the device's limit in {} ticks", s.limitedTicks) : ""));
    if (s.slopeLimitedTicks) row("slope", fmt::format("limited in {} ticks", s.slopeLimitedTicks));
    if (s.faultTicks) row("fault", fmt::format("{} ticks without a believable pose: no force", s.faultTicks));
    if (s.truncatedTicks) row("truncated", fmt::format("{} ticks had more contacts than are kept", s.truncatedTicks));
    if (r.queueOverflow) row("lost", fmt::format("{} samples came too fast to be written", r.queueOverflow));
    row("files", "trace.csv depth.svg speed.svg force.svg summary.json");
}

RunSettings settingsOf(const RunOptions& o) {
    if (o.device != "simulated")
        throw core::Error(fmt::format("there is no device called \"{}\"", o.device), "--device",
                          "there is: simulated (choose what it simulates with --device-model)");
    // The loop says the same of rates out of range, but only after the tooth was read.
    if (!(o.rateHz >= 100.0 && o.rateHz <= 10000.0))
        throw core::Error(fmt::format("a rate of {} Hz cannot be run", o.rateHz), "--rate",
                          "choose 1000, 2000, 4000 or 8000");
    if (!(o.durationS >= 0.0 && o.durationS <= 86400.0))
        throw core::Error(fmt::format("a run of {} s", o.durationS), "--duration", "give up to a day; 0: the motion's");
    RunSettings s;
    s.rateHz = o.rateHz;
    s.durationS = o.durationS;
    s.realTime = o.realTime;
    s.device.capability = device::capabilityByName(o.deviceModel);
    s.device.frictionN = o.frictionN;
    s.device.delayS = 1e-3 * o.delayMs;
    s.device.rigidHand = o.hand == "rigid";
    if (!s.device.rigidHand) s.device.hand = device::handByName(o.hand);
    s.parameters.mode = force::modeByName(o.force);
    s.parameters.stiffnessMultiplier = o.stiffness;
    s.parameters.dampingMultiplier = o.damping;
    force::validate(s.parameters);
    return s;
}

device::Motion motionOf(const RunOptions& o, const RunSettings& s, contact::Method& method, const core::Box& box) {
    loop::MotionOptions m;
    m.speedMmS = o.speedMmS;
    m.lengthMm = o.lengthMm;
    m.offsetMm = {o.at[0], o.at[1]};
    constexpr double kRigidDepthMm = 0.5;  // a rigid hand goes exactly there
    // A depth that is no number goes on to be refused.
    m.depthMm = !(o.depthMm <= 0.0)  ? o.depthMm
                : s.device.rigidHand ? kRigidDepthMm
                                     : o.loadN / s.device.hand.stiffnessNPerMm;
    return loop::motionByName(o.motion, method, box, m);
}

void runCommand(const RunOptions& o, const MethodRegistry& methods) {
    const RunSettings settings = settingsOf(o);
    const bool isFile = fs::path(o.motion).has_extension() || o.motion == "-";
    std::unique_ptr<device::Motion> motion;
    if (isFile) motion = std::make_unique<device::Motion>(readMotion(o.motion, settings.device.capability, o.rateHz));
    Outputs outputs(o.out);  // before the work: a folder that cannot be written is told at once
    const auto tooth = loadTooth(o.inputs);
    auto method = makeMethod(o.inputs.method, methods, tooth, loadBur(o.inputs.bur));
    const std::string methodName = method->name();
    if (!motion) motion = std::make_unique<device::Motion>(motionOf(o, settings, *method, tooth->outer.bounds()));

    const double duration = o.durationS > 0.0 ? o.durationS : motion->durationS();
    Curve depth(duration), force(duration), applied(duration);
    Curve speed[3] = {Curve(duration), Curve(duration), Curve(duration)};
    TextWriter trace(outputs.path("trace.csv").string());
    trace.write(kHeader);
    fmt::memory_buffer buffer;
    ProgressBar bar("running");
    const core::Progress progress = bar.listener();
    std::uint64_t count = 0;
    RunSummary summary = runLoop(settings, *motion, std::move(method), [&](const HapticSample& s) {
        writeLine(trace, buffer, s);
        // A bound, not a distance, where nothing is within reach: a gap in the plot.
        const bool far = s.contactStatus == static_cast<std::uint8_t>(contact::Status::beyondReach);
        if (!far) depth.take(s.timeS, s.depthMm);
        force.take(s.timeS, forceOf(s));
        applied.take(s.timeS, std::hypot(s.appliedForceN[0], s.appliedForceN[1], s.appliedForceN[2]));
        for (std::size_t axis = 0; axis < 3; ++axis)
            speed[axis].take(s.timeS, s.velocityMmS[axis]);
        if (++count % 256 == 0) progress(s.timeS / duration);
    });
    bar.finish();

    const auto plot = [](std::string title, std::string label, std::vector<Series> series, std::vector<Limit> limits) {
        return toSvg({std::move(title), "time [s]", std::move(label), std::move(series), std::move(limits)}, true);
    };
    const double limitN = settings.device.capability.maxForceN;
    const std::string depthSvg =
        plot("Depth (above 0) and distance (below)", "depth [mm]", {depth.series("")}, {{0.0, "touch"}});
    const std::string speedSvg = plot("Speed of the bur, filtered", "speed [mm/s]",
                                      {speed[0].series("x"), speed[1].series("y"), speed[2].series("z")}, {});
    const std::string forceSvg =
        plot("Force on the hand", "force [N]", {applied.series("applied"), force.series("commanded")},
             {{limitN, fmt::format("the device's limit, {:.1f} N", limitN)}});
    const std::string json = summaryJson(o, summary, methodName).dump(2, ' ', false, Json::error_handler_t::replace);
    trace.commit();
    outputs.wrote("trace.csv");
    outputs.write("depth.svg", depthSvg);
    outputs.write("speed.svg", speedSvg);
    outputs.write("force.svg", forceSvg);
    outputs.write("summary.json", json + "\n");
    outputs.keep();
    if (o.json) {
        fmt::print("{}\n", json);
    } else {
        printSummary(o, summary, methodName);
    }
}

}  // namespace

void addRunCommand(CLI::App& app, const MethodRegistry& methods) {
    CLI::App* command = app.add_subcommand("run", "A simulated hand lowers a bur onto a tooth: trace, plots, summary");
    const auto options = std::make_shared<RunOptions>();
    RunOptions& o = *options;
    addContactOptions(*command, o.inputs, methods);
    std::string motions;
    for (const loop::BuiltInMotion& m : loop::builtInMotions())
        motions += fmt::format("{}{} ({})", motions.empty() ? "" : ", ", m.name, m.description);
    std::string models;
    for (const device::Capability& c : device::knownDevices())
        models += (models.empty() ? "" : ", ") + c.name;
    const auto add = [&](const char* name, auto& value, std::string help) {
        return command->add_option(name, value, std::move(help))->capture_default_str();
    };
    add("--motion", o.motion, motions + "; or a CSV of t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz");
    command->add_option("--out", o.out, "folder for trace.csv, the plots and summary.json")->required();
    add("--device", o.device, "simulated");
    add("--device-model", o.deviceModel, "what the simulated device is like: " + models);
    add("--rate", o.rateHz, "ticks a second: 1000, 2000, 4000 or 8000");
    add("--duration", o.durationS, "seconds; 0: as long as the motion");
    add("--force", o.force, "proxy, or penalty (the paper's)");
    add("--stiffness", o.stiffness, "multiplier on every tissue's stiffness");
    add("--damping", o.damping, "multiplier on every tissue's damping");
    add("--speed", o.speedMmS, "of the named motions [mm/s]");
    add("--load", o.loadN, "what the hand presses with, as far as it gives way [N]")->check(CLI::PositiveNumber);
    add("--depth", o.depthMm, "instead of a load: how far beyond the surface the hand intends to go [mm]")
        ->check(CLI::NonNegativeNumber);
    add("--length", o.lengthMm, "of a slide or drag [mm]; 0: 60 % of the tooth");
    add("--at", o.at, "x and y of the first touch from the tooth's middle [mm]")->expected(2);
    add("--hand", o.hand, "loose, normal, stiff, or rigid (exactly on the path)");
    add("--delay", o.delayMs, "from the command to the force [ms]");
    add("--friction", o.frictionN, "of the device [N]");
    command->add_flag("--real-time", o.realTime, "on the wall clock, with what priority the machine grants");
    command->add_flag("--json", o.json, "print summary.json instead of a table");
    command->footer(
        "Without --real-time the same command gives the same trace, but for its two columns of time.\n"
        "Examples:\n"
        "  handpiece run --tooth molar --motion drop --out drop\n"
        "  handpiece run --tooth molar --bur round-4 --motion drag --rate 4000 --real-time --out drag\n"
        "  handpiece run --tooth molar --method hull --force penalty --motion press --speed 60 --out hull");
    command->callback([options, &methods] { runCommand(*options, methods); });
}

}  // namespace handpiece::cli
