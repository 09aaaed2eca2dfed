// SPDX-License-Identifier: Apache-2.0
// What the figures are held against. Each threshold names its source; [R] marks what nobody here has checked.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/devices/fidelity/recording.h"

namespace handpiece::fidelity {
namespace {

constexpr double kNsPerS = 1e9;
// OpenHaptics Programmer's Guide: at least 1000 Hz for stability, as low as 500 on some devices, not recommended.
constexpr double kGoodHz = 1000.0, kMinHz = 500.0;
constexpr double kGoodLateShare = 0.001, kMaxLateShare = 0.01;
// The stability map (docs/physics.md) goes to 3 ms; what one sees and feels apart is noticed from 25 ms on [R].
constexpr double kGoodDelayS = 0.003, kMaxDelayS = 0.025;
// Force is told apart from 7 % on (Pang, Tan and Durlach 1991, for 2.5 to 10 N), here of the 1 N one presses with.
constexpr double kFeltN = 0.07;
// A surface is taken for hard from 0.8 to 1.0 N/mm on (Choi and Tan 2004).
constexpr double kHardNPerMm = 0.8;
constexpr double kWarm = 0.8, kHot = 0.98;  // as the gate has it
constexpr std::size_t kMaxBins = 10'000;    // of a microsecond

std::string ms(double seconds) {
    return fmt::format("{:.3f} ms", 1e3 * seconds);
}

Finding finding(const char* id, const char* name, std::string against) {
    Finding f;
    f.id = id;
    f.name = name;
    f.against = std::move(against);
    return f;
}

Verdict graded(double value, double good, double most) {
    return value <= good ? Verdict::pass : value <= most ? Verdict::warn : Verdict::fail;
}

std::vector<double> histogramOf(const std::vector<double>& valuesS) {
    std::vector<double> bins;
    for (const double v : valuesS) {
        const auto bin = static_cast<std::size_t>(std::clamp(1e6 * v, 0.0, static_cast<double>(kMaxBins - 1)));
        if (bin >= bins.size()) bins.resize(bin + 1, 0.0);
        ++bins[bin];
    }
    return bins;
}

/// What makes threads come in time.
std::string steadier(const Recording& r) {
    return r.grant.realTime ? "close other programs; switch power saving off in the machine's set-up"
                            : "let the machine grant real-time scheduling (docs/devices.md)";
}

std::vector<double> periodsOf(const Recording& r) {
    std::vector<double> periods;
    for (std::size_t i = 1; i < r.frames.size(); ++i)
        periods.push_back(static_cast<double>(r.frames[i].atNs - r.frames[i - 1].atNs) / kNsPerS);
    return periods;
}

void addSpread(Finding& f, const Quantiles& q) {
    f.figures = {
        {"p50_ms", 1e3 * q.p50}, {"p99_ms", 1e3 * q.p99}, {"p999_ms", 1e3 * q.p999}, {"worst_ms", 1e3 * q.worst}};
}

Finding servoPeriod(const Recording& r, const std::vector<double>& periods) {
    Finding f = finding("servo-period", "Servo period",
                        "at least 1000 Hz, 500 Hz at the very least (OpenHaptics Programmer's Guide), and the rate the "
                        "device names");
    if (periods.empty()) {
        f.value = "too few frames";
        f.verdict = Verdict::fail;
        f.remedy = "switch the device off and on";
        return f;
    }
    const Quantiles q = quantilesOf(periods);
    const double hz = q.p50 > 0.0 ? 1.0 / q.p50 : 0.0, asked = r.info.servoHz;
    f.value =
        fmt::format("{:.0f} Hz ({}), p99 {}, p99.9 {}, worst {}", hz, ms(q.p50), ms(q.p99), ms(q.p999), ms(q.worst));
    addSpread(f, q);
    f.figures.insert(f.figures.begin(), {{"rate_hz", hz}, {"nominal_hz", asked}});
    const double floorHz = r.info.pushes ? kMinHz : 0.0, goodHz = r.info.pushes ? kGoodHz : 0.0;
    f.verdict = hz < 0.99 * floorHz                   ? Verdict::fail
                : hz < 0.95 * std::max(goodHz, asked) ? Verdict::warn
                                                      : Verdict::pass;
    if (f.verdict != Verdict::pass)
        f.remedy = "connect it without a hub, close other programs, and let the machine grant real-time scheduling";
    return f;
}

Finding servoJitter(const Recording& r, const std::vector<double>& periods) {
    const double nominal = 1.0 / std::max(r.info.servoHz, 1.0);
    Finding f = finding("servo-jitter", "Servo jitter",
                        "p99.9 within half a period of the middle; vibration is felt from under 0.01 um on at 150 to "
                        "200 Hz (Brisben 1999), long before it is seen");
    const Quantiles q = quantilesOf(periods);
    double worst = 0.0;
    std::vector<double> apart;
    for (const double p : periods)
        apart.push_back(std::abs(p - q.p50));
    const Quantiles j = quantilesOf(std::move(apart));
    worst = j.worst;
    f.value = fmt::format("p50 {}, p99 {}, p99.9 {}, worst {}", ms(j.p50), ms(j.p99), ms(j.p999), ms(worst));
    addSpread(f, j);
    f.verdict = graded(j.p999, 0.5 * nominal, 2.0 * nominal);
    if (f.verdict != Verdict::pass) f.remedy = steadier(r);
    return f;
}

Finding servoGaps(const Recording& r, const std::vector<double>& periods) {
    Finding f = finding("servo-gaps", "Pauses of the servo",
                        fmt::format("none longer than {:.1f} ms: the gate takes the force away", 1e3 * r.gateTimeoutS));
    const auto gaps = std::count_if(periods.begin(), periods.end(), [&](double p) { return p > r.gateTimeoutS; });
    f.value = gaps == 0 ? "none" : fmt::format("{} in {:.1f} s", gaps, r.settings.durationS);
    f.figures = {{"gaps", static_cast<double>(gaps)}, {"limit_ms", 1e3 * r.gateTimeoutS}};
    f.verdict = gaps == 0 ? Verdict::pass : gaps <= 2 ? Verdict::warn : Verdict::fail;
    if (gaps > 0) f.remedy = steadier(r);
    return f;
}

Finding tickLateness(const Recording& r, std::vector<double> late) {
    Finding f = finding("tick-lateness", "Lateness of the tick",
                        "at most 0.1 % of the ticks later than a period; 1 % is bearable");
    if (r.settings.advance || late.empty()) {
        f.value = "not on this clock";
        return f;
    }
    const double periodS = 1.0 / r.settings.rateHz;
    double lateTicks = 0.0, due = 0.0;
    for (const TickRecord& t : r.ticks) {
        due += t.periods;
        lateTicks += static_cast<double>(t.lateNs) / kNsPerS > periodS ? 1.0 : 0.0;
        lateTicks += t.periods - 1;  // left out altogether
    }
    const double share = due > 0.0 ? lateTicks / due : 0.0;
    const Quantiles q = quantilesOf(std::move(late));
    f.value = fmt::format("{:.3g} % late at {:.0f} Hz; p50 {}, p99 {}, p99.9 {}, worst {}", 1e2 * share,
                          r.settings.rateHz, ms(q.p50), ms(q.p99), ms(q.p999), ms(q.worst));
    addSpread(f, q);
    f.figures.insert(f.figures.begin(), {"late_share", share});
    f.verdict = graded(share, kGoodLateShare, kMaxLateShare);
    if (f.verdict != Verdict::pass) f.remedy = steadier(r);
    return f;
}

Finding readingAge(const Recording& r) {
    const double servoS = 1.0 / std::max(r.info.servoHz, 1.0);
    Finding f = finding("reading-age", "Age of a pose at the tick",
                        "p99 within one and a half periods of the servo: older ones add to the delay that stability "
                        "must bear");
    std::vector<double> ages;
    for (const TickRecord& t : r.ticks)
        if (t.ageNs >= 0) ages.push_back(static_cast<double>(t.ageNs) / kNsPerS);
    if (ages.empty()) {
        f.value = "no ticks";
        return f;
    }
    const Quantiles q = quantilesOf(std::move(ages));
    f.value = fmt::format("p50 {}, p99 {}, p99.9 {}, worst {}", ms(q.p50), ms(q.p99), ms(q.p999), ms(q.worst));
    addSpread(f, q);
    f.verdict = graded(q.p99, 1.5 * servoS, 4.0 * servoS);
    if (f.verdict != Verdict::pass) f.remedy = "connect the device without a hub; close other programs";
    return f;
}

Finding forceSlope(const Recording& r) {
    Finding f = finding("force-slope", "Slope of the force",
                        fmt::format("a step of the force is sent within two frames and what the record's {:.0f} N/s "
                                    "take",
                                    r.maxSlopeNPerS));
    if (r.pulses.empty()) {
        f.value = r.info.pushes ? "it was not to push" : "it cannot push";
        return f;
    }
    double steepest = 0.0;
    std::vector<double> rises;
    for (std::size_t i = 1; i < r.frames.size(); ++i) {
        const double dt = static_cast<double>(r.frames[i].atNs - r.frames[i - 1].atNs) / kNsPerS;
        if (dt > 0.0) steepest = std::max(steepest, (r.frames[i].sentN[1] - r.frames[i - 1].sentN[1]) / dt);
    }
    for (const Pulse& p : r.pulses) {
        const double wanted = p.fromN + 0.9 * (p.toN - p.fromN);
        for (const FrameRecord& frame : r.frames)
            if (frame.atNs >= p.commandedNs && frame.sentN[1] >= wanted) {
                rises.push_back(static_cast<double>(frame.atNs - p.commandedNs) / kNsPerS);
                break;
            }
    }
    const double frameS = 1.0 / std::max(r.info.servoHz, 1.0);
    const double allowed = 2.0 * frameS + (r.pulses[0].toN - r.pulses[0].fromN) / r.maxSlopeNPerS;
    const Quantiles q = quantilesOf(rises);
    f.value = fmt::format("{:.0f} N/s; 90 % of {:.2f} N after {} (p50), {} at worst", steepest, r.pulses[0].toN,
                          ms(q.p50), ms(q.worst));
    f.figures = {{"steepest_n_per_s", steepest},
                 {"rise_p50_ms", 1e3 * q.p50},
                 {"rise_worst_ms", 1e3 * q.worst},
                 {"pulses", static_cast<double>(r.pulses.size())},
                 {"pulse_n", r.pulses[0].toN}};
    f.verdict = rises.size() < r.pulses.size() ? Verdict::fail : graded(q.p50, allowed, 3.0 * allowed);
    if (f.verdict != Verdict::pass) f.remedy = "see the servo's period and pauses above; they come first";
    return f;
}

Finding roundTrip(const Recording& r) {
    Finding f =
        finding("round-trip-delay", "Round-trip delay",
                "within 3 ms (the stability map of docs/physics.md goes so far); from 25 ms on what is seen and "
                "what is felt come apart [R]");
    const Delay d = roundTripOf(r);
    if (!d.measured) {
        f.value = "not measured: " + d.why;
        if (r.info.pushes && r.settings.push) f.remedy = "hold the stylus loosely while it pushes";
        return f;
    }
    f.value = fmt::format("{:.1f} ms, give or take {:.1f} (a pulse moved it by {:.2f} mm)", 1e3 * d.seconds,
                          1e3 * d.uncertaintyS, d.pathMm);
    f.figures = {{"delay_ms", 1e3 * d.seconds}, {"uncertainty_ms", 1e3 * d.uncertaintyS}, {"path_mm", d.pathMm}};
    if (d.uncertaintyS > kGoodDelayS) {
        f.value += ": too rough to judge";
        f.remedy = "check again for longer, with nothing else running";
        return f;
    }
    f.verdict = graded(d.seconds, kGoodDelayS, kMaxDelayS);
    if (f.verdict != Verdict::pass) f.remedy = "choose a softer stiffness, or the device's fastest servo";
    return f;
}

Finding encoderStep(const Recording& r, const Rest& rest) {
    const double told = r.info.capability.encoderStepMm;
    Finding f = finding("encoder-step", "Step of the encoders",
                        fmt::format("at most half as much again as its record, {:.1f} um", 1e3 * told));
    if (rest.stepMm < 0.0) {
        f.value = "not measured: it hardly moved";
        return f;
    }
    f.value = fmt::format("{:.2f} um", 1e3 * rest.stepMm);
    f.figures = {{"step_um", 1e3 * rest.stepMm}, {"record_um", 1e3 * told}};
    f.verdict = told <= 0.0 || rest.stepMm <= 1.5 * told ? Verdict::pass : Verdict::warn;
    if (f.verdict != Verdict::pass) f.remedy = "calibrate the device; hold it still while it is measured";
    return f;
}

Finding restNoise(const Recording& r, const Rest& rest) {
    const double k = r.info.capability.maxStiffnessNPerMm, felt = rest.noiseMm * k;
    Finding f = finding("rest-noise", "Noise at rest",
                        "at the device's largest stiffness less than 0.07 N: 7 % of the 1 N one presses with are felt "
                        "(Pang, Tan and Durlach 1991; theirs were 2.5 to 10 N)");
    if (rest.moved) {
        f.value = "not measured: it was moved";
        f.remedy = "leave the device alone for the first seconds";
        return f;
    }
    f.value = fmt::format("{:.2f} um root mean square, {:.4f} N at {:.2f} N/mm", 1e3 * rest.noiseMm, felt, k);
    f.figures = {{"noise_um", 1e3 * rest.noiseMm}, {"noise_n", felt}};
    f.verdict = r.info.pushes ? graded(felt, 0.5 * kFeltN, 2.0 * kFeltN) : Verdict::pass;
    if (f.verdict != Verdict::pass) f.remedy = "put it on a firm table; lay the stylus down while it is measured";
    return f;
}

Finding limits(const Recording& r) {
    const device::Capability& c = r.info.capability;
    Finding f = finding("limits", "What the device can do",
                        "0.8 to 1.0 N/mm are taken for a hard surface (Choi and Tan 2004); enamel is harder than any "
                        "desktop arm can show");
    if (!r.info.pushes) {
        f.value = "it cannot push: input only";
        return f;
    }
    f.value =
        fmt::format("{:.1f} N peak, {:.2f} N for long, {:.2f} N/mm, {:.4f} N s/mm, {:.0f} N/s, torque {}", c.maxForceN,
                    c.continuousForceN, c.maxStiffnessNPerMm, c.maxDampingNSPerMm, c.maxForceSlopeNPerS,
                    c.maxTorqueNmm > 0.0 ? fmt::format("{:.0f} N mm", c.maxTorqueNmm) : std::string("none"));
    if (!r.info.sources.empty()) f.value += " (" + r.info.sources + ")";
    f.figures = {{"max_force_n", c.maxForceN},
                 {"continuous_force_n", c.continuousForceN},
                 {"stiffness_n_per_mm", c.maxStiffnessNPerMm},
                 {"damping_n_s_per_mm", c.maxDampingNSPerMm},
                 {"slope_n_per_s", c.maxForceSlopeNPerS},
                 {"torque_nmm", c.maxTorqueNmm}};
    f.verdict = c.maxStiffnessNPerMm >= kHardNPerMm ? Verdict::pass : Verdict::warn;
    if (f.verdict != Verdict::pass)
        f.remedy = "contact is made crisp by short transients instead: run --crisp on, or Device, Crisp contact";
    return f;
}

Finding temperature(const Recording& r) {
    Finding f =
        finding("temperature", "Motors", "under 0.8 of what the maker allows; the force fades out from there on");
    float hottest = -1.0f;
    for (const FrameRecord& frame : r.frames)
        hottest = std::max(hottest, frame.motorTemperature);
    if (hottest < 0.0f) {
        f.value = "not told by this device";
        return f;
    }
    f.value = fmt::format("{:.0f} % of what the maker allows", 1e2 * static_cast<double>(hottest));
    f.figures = {{"temperature", static_cast<double>(hottest)}};
    f.verdict = graded(static_cast<double>(hottest), kWarm, kHot);
    if (f.verdict != Verdict::pass) f.remedy = "let the device rest for some minutes";
    return f;
}

/// What it tells before its first pose is no trouble.
std::vector<link::DeviceFault> troublesOf(const Recording& r) {
    std::vector<link::DeviceFault> kinds;
    const auto add = [&](link::DeviceFault trouble) {
        if (trouble != link::DeviceFault::none && trouble != link::DeviceFault::starting &&
            std::find(kinds.begin(), kinds.end(), trouble) == kinds.end())
            kinds.push_back(trouble);
    };
    for (const FrameRecord& frame : r.frames)
        add(frame.trouble);
    add(r.health.gate.last);
    return kinds;
}

Finding troubles(const Recording& r, const std::vector<link::DeviceFault>& kinds) {
    Finding f = finding("troubles", "Troubles", "none while it was measured");
    f.figures = {{"kinds", static_cast<double>(kinds.size())}};
    f.verdict = kinds.empty() ? Verdict::pass : Verdict::fail;
    if (kinds.empty()) f.value = "none";
    for (const link::DeviceFault kind : kinds) {
        f.value += fmt::format("{}{}", f.value.empty() ? "" : " ", link::sentenceOf(kind));
        if (f.remedy.empty()) f.remedy = std::string(link::remedyOf(kind));
    }
    // A tick that stood is the machine's, and told above with figures.
    if (kinds.size() == 1 && (kinds[0] == link::DeviceFault::tickStalled || kinds[0] == link::DeviceFault::stalled))
        f.verdict = Verdict::warn;
    if (r.health.gate.vendorCode != 0)
        f.value += fmt::format(" (code 0x{:04x})", static_cast<std::uint32_t>(r.health.gate.vendorCode));
    return f;
}

Finding calibrated(const Recording& r) {
    Finding f = finding("calibration", "Calibration", "the device knows where its axes are");
    f.verdict = Verdict::pass;
    switch (r.calibration) {
        case link::CalibrationState::notNeeded:
            f.value = "none needed";
            break;
        case link::CalibrationState::good:
            f.value = "good";
            break;
        case link::CalibrationState::wanted:
        case link::CalibrationState::wantedByHand:
            f.value = "wanted";
            f.verdict = Verdict::fail;
            f.remedy = r.calibrationStep.empty() ? "handpiece device calibrate" : r.calibrationStep;
    }
    return f;
}

Finding scheduling(const Recording& r) {
    Finding f = finding("scheduling", "Scheduling", "SCHED_FIFO for tick and servo: else anything may come in between");
    f.value = r.grant.line;
    if (r.settings.advance) return f;
    f.verdict = r.grant.realTime ? Verdict::pass : Verdict::warn;
    if (f.verdict != Verdict::pass)
        f.remedy = "let your group ask for it: rtprio in /etc/security/limits.d (docs/devices.md)";
    return f;
}

Finding memory(const Recording& r) {
    Finding f = finding("memory-locked", "Memory", "locked: a page fetched from disk takes longer than a tick may");
    if (r.settings.advance) {
        f.value = "virtual time";
        return f;
    }
    f.value = r.grant.memoryLocked ? "locked" : "not locked";
    f.verdict = r.grant.memoryLocked ? Verdict::pass : Verdict::warn;
    if (f.verdict != Verdict::pass)
        f.remedy = "let your group lock it: memlock in /etc/security/limits.d (docs/devices.md)";
    return f;
}

}  // namespace

Report judge(const Recording& r) {
    Report report;
    report.device = r.info;
    report.machine = machineLine(r.grant);
    report.durationS =
        r.frames.empty() ? 0.0 : static_cast<double>(r.frames.back().atNs - r.frames.front().atNs) / kNsPerS;
    const std::vector<double> periods = periodsOf(r);
    std::vector<double> late;
    for (const TickRecord& t : r.ticks)
        late.push_back(static_cast<double>(t.lateNs) / kNsPerS);
    report.periodHistogramUs = histogramOf(periods);
    if (!r.settings.advance) report.latenessHistogramUs = histogramOf(late);
    report.troubles = troublesOf(r);
    report.vendorCode = r.health.gate.vendorCode;
    const Rest rest = restOf(r);
    report.findings = {servoPeriod(r, periods),
                       servoJitter(r, periods),
                       servoGaps(r, periods),
                       tickLateness(r, late),
                       readingAge(r),
                       forceSlope(r),
                       roundTrip(r),
                       encoderStep(r, rest),
                       restNoise(r, rest),
                       limits(r),
                       temperature(r),
                       troubles(r, report.troubles),
                       calibrated(r),
                       scheduling(r),
                       memory(r),
                       governorFinding(),
                       usbFinding(r.info.driver)};
    if (r.lost > 0) {
        Finding f = finding("lost-records", "Records lost", "none: figures would be of a part only");
        f.value = fmt::format("{}", r.lost);
        f.verdict = Verdict::warn;
        f.remedy = "close other programs and check again";
        report.findings.push_back(std::move(f));
    }
    report.passed = std::none_of(report.findings.begin(), report.findings.end(),
                                 [](const Finding& f) { return f.verdict == Verdict::fail; });
    return report;
}

}  // namespace handpiece::fidelity
