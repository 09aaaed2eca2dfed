// SPDX-License-Identifier: Apache-2.0
// What the figures are held against. Each threshold names its source; [R] marks what nobody here has checked.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "handpiece/base/rt/second.h"
#include "handpiece/devices/fidelity/recording.h"

namespace handpiece::fidelity {
namespace {

using config::phrase, config::verbatim;
using rt::kNsPerS;
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

Finding finding(const char* id, config::Phrase against) {
    Finding f;
    f.id = id;
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
config::Phrase steadier(const Recording& r) {
    return r.grant.realTime() ? phrase("fidelity.close-programs-and-power-saving") : phrase("fidelity.grant-real-time");
}

config::Phrase spreadOf(const Quantiles& q) {
    return phrase("fidelity.spread", ms(q.p50), ms(q.p99), ms(q.p999), ms(q.worst));
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
    Finding f = finding("servo-period", phrase("fidelity.servo-period-against"));
    if (periods.empty()) {
        f.value = phrase("fidelity.too-few-frames");
        f.verdict = Verdict::fail;
        f.remedy = phrase("fidelity.off-and-on");
        return f;
    }
    const Quantiles q = quantilesOf(periods);
    const double hz = q.p50 > 0.0 ? 1.0 / q.p50 : 0.0, asked = r.info.servoHz;
    f.value =
        phrase("fidelity.rate-and-spread", fmt::format("{:.0f}", hz), ms(q.p50), ms(q.p99), ms(q.p999), ms(q.worst));
    addSpread(f, q);
    f.figures.insert(f.figures.begin(), {{"rate_hz", hz}, {"nominal_hz", asked}});
    const double floorHz = r.info.pushes ? kMinHz : 0.0, goodHz = r.info.pushes ? kGoodHz : 0.0;
    f.verdict = hz < 0.99 * floorHz                   ? Verdict::fail
                : hz < 0.95 * std::max(goodHz, asked) ? Verdict::warn
                                                      : Verdict::pass;
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.no-hub-real-time");
    return f;
}

Finding servoJitter(const Recording& r, const std::vector<double>& periods) {
    const double nominal = 1.0 / std::max(r.info.servoHz, 1.0);
    Finding f = finding("servo-jitter", phrase("fidelity.servo-jitter-against"));
    const Quantiles q = quantilesOf(periods);
    std::vector<double> apart;
    for (const double p : periods)
        apart.push_back(std::abs(p - q.p50));
    const Quantiles j = quantilesOf(std::move(apart));
    f.value = spreadOf(j);
    addSpread(f, j);
    f.verdict = graded(j.p999, 0.5 * nominal, 2.0 * nominal);
    if (f.verdict != Verdict::pass) f.remedy = steadier(r);
    return f;
}

Finding servoGaps(const Recording& r, const std::vector<double>& periods) {
    Finding f =
        finding("servo-gaps", phrase("fidelity.servo-gaps-against", fmt::format("{:.1f}", 1e3 * r.gateTimeoutS)));
    const auto gaps = std::count_if(periods.begin(), periods.end(), [&](double p) { return p > r.gateTimeoutS; });
    f.value = gaps == 0 ? phrase("fidelity.none")
                        : phrase("fidelity.gaps", std::to_string(gaps), fmt::format("{:.1f}", r.settings.durationS));
    f.figures = {{"gaps", static_cast<double>(gaps)}, {"limit_ms", 1e3 * r.gateTimeoutS}};
    f.verdict = gaps == 0 ? Verdict::pass : gaps <= 2 ? Verdict::warn : Verdict::fail;
    if (gaps > 0) f.remedy = steadier(r);
    return f;
}

Finding tickLateness(const Recording& r, std::vector<double> late) {
    Finding f = finding("tick-lateness", phrase("fidelity.tick-lateness-against"));
    if (r.settings.advance || late.empty()) {
        f.value = phrase("fidelity.not-on-this-clock");
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
    f.value = phrase("fidelity.late-and-spread", fmt::format("{:.3g}", 1e2 * share),
                     fmt::format("{:.0f}", r.settings.rateHz), ms(q.p50), ms(q.p99), ms(q.p999), ms(q.worst));
    addSpread(f, q);
    f.figures.insert(f.figures.begin(), {"late_share", share});
    f.verdict = graded(share, kGoodLateShare, kMaxLateShare);
    if (f.verdict != Verdict::pass) f.remedy = steadier(r);
    return f;
}

Finding readingAge(const Recording& r) {
    const double servoS = 1.0 / std::max(r.info.servoHz, 1.0);
    Finding f = finding("reading-age", phrase("fidelity.reading-age-against"));
    std::vector<double> ages;
    for (const TickRecord& t : r.ticks)
        if (t.ageNs >= 0) ages.push_back(static_cast<double>(t.ageNs) / kNsPerS);
    if (ages.empty()) {
        f.value = phrase("fidelity.no-ticks");
        return f;
    }
    const Quantiles q = quantilesOf(std::move(ages));
    f.value = spreadOf(q);
    addSpread(f, q);
    f.verdict = graded(q.p99, 1.5 * servoS, 4.0 * servoS);
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.no-hub");
    return f;
}

Finding forceSlope(const Recording& r) {
    Finding f = finding("force-slope", phrase("fidelity.force-slope-against", fmt::format("{:.0f}", r.maxSlopeNPerS)));
    if (r.pulses.empty()) {
        f.value = r.info.pushes ? phrase("fidelity.was-not-to-push") : phrase("fidelity.cannot-push");
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
    f.value = phrase("fidelity.slope", fmt::format("{:.0f}", steepest), fmt::format("{:.2f}", r.pulses[0].toN),
                     ms(q.p50), ms(q.worst));
    f.figures = {{"steepest_n_per_s", steepest},
                 {"rise_p50_ms", 1e3 * q.p50},
                 {"rise_worst_ms", 1e3 * q.worst},
                 {"pulses", static_cast<double>(r.pulses.size())},
                 {"pulse_n", r.pulses[0].toN}};
    f.verdict = rises.size() < r.pulses.size() ? Verdict::fail : graded(q.p50, allowed, 3.0 * allowed);
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.see-the-servo");
    return f;
}

Finding roundTrip(const Recording& r) {
    Finding f = finding("round-trip-delay", phrase("fidelity.round-trip-against"));
    const Delay d = roundTripOf(r);
    if (!d.measured) {
        f.value = d.why;
        if (r.info.pushes && r.settings.push) f.remedy = phrase("fidelity.hold-loosely");
        return f;
    }
    const bool isRough = d.uncertaintyS > kGoodDelayS;
    f.value = phrase(isRough ? "fidelity.delay-too-rough" : "fidelity.delay", fmt::format("{:.1f}", 1e3 * d.seconds),
                     fmt::format("{:.1f}", 1e3 * d.uncertaintyS), fmt::format("{:.2f}", d.pathMm));
    f.figures = {{"delay_ms", 1e3 * d.seconds}, {"uncertainty_ms", 1e3 * d.uncertaintyS}, {"path_mm", d.pathMm}};
    if (isRough) {
        f.remedy = phrase("fidelity.check-longer");
        return f;
    }
    f.verdict = graded(d.seconds, kGoodDelayS, kMaxDelayS);
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.softer-or-faster");
    return f;
}

Finding encoderStep(const Recording& r, const Rest& rest) {
    const double told = r.info.capability.encoderStepMm;
    Finding f = finding("encoder-step", phrase("fidelity.encoder-step-against", fmt::format("{:.1f}", 1e3 * told)));
    if (rest.stepMm < 0.0) {
        f.value = phrase("fidelity.hardly-moved");
        return f;
    }
    f.value = verbatim(fmt::format("{:.2f} um", 1e3 * rest.stepMm));
    f.figures = {{"step_um", 1e3 * rest.stepMm}, {"record_um", 1e3 * told}};
    f.verdict = told <= 0.0 || rest.stepMm <= 1.5 * told ? Verdict::pass : Verdict::warn;
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.calibrate-and-hold-still");
    return f;
}

Finding restNoise(const Recording& r, const Rest& rest) {
    const double k = r.info.capability.maxStiffnessNPerMm, felt = rest.noiseMm * k;
    Finding f = finding("rest-noise", phrase("fidelity.rest-noise-against"));
    if (rest.moved) {
        f.value = phrase("fidelity.was-moved");
        f.remedy = phrase("fidelity.leave-alone");
        return f;
    }
    f.value = phrase("fidelity.noise", fmt::format("{:.2f}", 1e3 * rest.noiseMm), fmt::format("{:.4f}", felt),
                     fmt::format("{:.2f}", k));
    f.figures = {{"noise_um", 1e3 * rest.noiseMm}, {"noise_n", felt}};
    f.verdict = r.info.pushes ? graded(felt, 0.5 * kFeltN, 2.0 * kFeltN) : Verdict::pass;
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.firm-table");
    return f;
}

Finding limits(const Recording& r) {
    const device::Capability& c = r.info.capability;
    Finding f = finding("limits", phrase("fidelity.limits-against"));
    if (!r.info.pushes) {
        f.value = phrase("fidelity.input-only");
        return f;
    }
    f.value = phrase("fidelity.limits", fmt::format("{:.1f}", c.maxForceN), fmt::format("{:.2f}", c.continuousForceN),
                     fmt::format("{:.2f}", c.maxStiffnessNPerMm), fmt::format("{:.4f}", c.maxDampingNSPerMm),
                     fmt::format("{:.0f}", c.maxForceSlopeNPerS),
                     c.maxTorqueNmm > 0.0 ? fmt::format("{:.0f} N mm", c.maxTorqueNmm) : "0",
                     r.info.sources.empty() ? std::string() : " (" + r.info.sources + ")");
    f.figures = {{"max_force_n", c.maxForceN},
                 {"continuous_force_n", c.continuousForceN},
                 {"stiffness_n_per_mm", c.maxStiffnessNPerMm},
                 {"damping_n_s_per_mm", c.maxDampingNSPerMm},
                 {"slope_n_per_s", c.maxForceSlopeNPerS},
                 {"torque_nmm", c.maxTorqueNmm}};
    f.verdict = c.maxStiffnessNPerMm >= kHardNPerMm ? Verdict::pass : Verdict::warn;
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.crisp-contact");
    return f;
}

Finding temperature(const Recording& r) {
    Finding f = finding("temperature", phrase("fidelity.temperature-against"));
    float hottest = -1.0f;
    for (const FrameRecord& frame : r.frames)
        hottest = std::max(hottest, frame.motorTemperature);
    if (hottest < 0.0f) {
        f.value = phrase("fidelity.not-told-by-device");
        return f;
    }
    f.value = phrase("fidelity.temperature", fmt::format("{:.0f}", 1e2 * static_cast<double>(hottest)));
    f.figures = {{"temperature", static_cast<double>(hottest)}};
    f.verdict = graded(static_cast<double>(hottest), kWarm, kHot);
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.let-rest");
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
    Finding f = finding("troubles", phrase("fidelity.troubles-against"));
    f.figures = {{"kinds", static_cast<double>(kinds.size())}};
    f.verdict = kinds.empty() ? Verdict::pass : Verdict::fail;
    std::string said;
    for (const link::DeviceFault kind : kinds) {
        said += fmt::format("{}{}", said.empty() ? "" : " ", link::sentenceOf(kind));
        if (f.remedy.empty()) f.remedy = verbatim(std::string(link::remedyOf(kind)));
    }
    // A tick that stood is the machine's, and told above with figures.
    if (kinds.size() == 1 && (kinds[0] == link::DeviceFault::tickStalled || kinds[0] == link::DeviceFault::stalled))
        f.verdict = Verdict::warn;
    if (r.health.gate.vendorCode != 0)
        said += fmt::format(" (code 0x{:04x})", static_cast<std::uint32_t>(r.health.gate.vendorCode));
    f.value = kinds.empty() ? phrase("fidelity.none") : verbatim(said);
    return f;
}

Finding calibrated(const Recording& r) {
    Finding f = finding("calibration", phrase("fidelity.calibration-against"));
    f.verdict = Verdict::pass;
    switch (r.calibration) {
        case link::CalibrationState::notNeeded:
            f.value = phrase("fidelity.none-needed");
            break;
        case link::CalibrationState::good:
            f.value = phrase("fidelity.calibrated");
            break;
        case link::CalibrationState::wanted:
        case link::CalibrationState::wantedByHand:
            f.value = phrase("fidelity.calibration-wanted");
            f.verdict = Verdict::fail;
            f.remedy = verbatim(r.calibrationStep.empty() ? "handpiece device calibrate" : r.calibrationStep);
    }
    return f;
}

Finding scheduling(const Recording& r) {
    Finding f = finding("scheduling", phrase("fidelity.scheduling-against"));
    f.value = verbatim(r.grant.line());
    if (r.settings.advance) return f;
    f.verdict = r.grant.realTime() ? Verdict::pass : Verdict::warn;
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.let-ask-for-priority");
    return f;
}

Finding memory(const Recording& r) {
    Finding f = finding("memory-locked", phrase("fidelity.memory-against"));
    if (r.settings.advance) {
        f.value = phrase("fidelity.virtual-time");
        return f;
    }
    f.value = r.grant.memoryLocked ? phrase("fidelity.locked") : phrase("fidelity.not-locked");
    f.verdict = r.grant.memoryLocked ? Verdict::pass : Verdict::warn;
    if (f.verdict != Verdict::pass) f.remedy = phrase("fidelity.let-lock-memory");
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
        Finding f = finding("lost-records", phrase("fidelity.lost-records-against"));
        f.value = verbatim(std::to_string(r.lost));
        f.verdict = Verdict::warn;
        f.remedy = phrase("fidelity.close-and-check-again");
        report.findings.push_back(std::move(f));
    }
    report.passed = std::none_of(report.findings.begin(), report.findings.end(),
                                 [](const Finding& f) { return f.verdict == Verdict::fail; });
    return report;
}

}  // namespace handpiece::fidelity
