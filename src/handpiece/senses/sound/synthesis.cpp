// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/sound/synthesis.h"

namespace handpiece::sound {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Levels and colours below are ours, set by ear's proxy against the published peaks and levels: docs/sound.md.

// Of the rotor's tone and its overtones; the first is far the strongest, as in the published spectra.
constexpr std::array<double, 8> kHarmonicShare{1.0, 0.30, 0.18, 0.10, 0.07, 0.05, 0.04, 0.03};
constexpr double kRotorPeak = 0.145;  // of the first
constexpr double kCageShare = 0.385;  // turns of the bearing's cage for one of the shaft
constexpr double kBalls = 7.0;        // balls of a bearing: they pass 7 x 0.385 times a turn
constexpr double kMeshTeeth = 11.0;   // of the gear wheel on the bur's side
constexpr double kAirRms = 0.035, kSprayRms = 0.022;
// Free speeds: at and below the first a drive is gears, from the second on a turbine.
constexpr double kGearedRpm = 60000.0, kTurbineRpm = 300000.0;

double smooth(double t) noexcept {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

double finite(double value, double least, double most) noexcept {
    return std::isfinite(value) ? std::clamp(value, least, most) : least;
}

double speedHzOf(const DrillState& drill) noexcept {
    return finite(drill.speedRpm, 0.0, 1.2e6) / 60.0;
}

double freeRpmOf(const DrillState& drill) noexcept {
    return finite(drill.freeSpeedRpm, 1000.0, 1e6);
}

double gearedOf(double freeRpm) noexcept {
    return smooth(std::log(kTurbineRpm / freeRpm) / std::log(kTurbineRpm / kGearedRpm));
}

void step(double& phase, double hz) noexcept {
    phase += hz / kSampleRateHz;
    phase -= std::floor(phase);
}

// level, main band and width, bright band and width, its share; in the order of cases::Tissue.
constexpr std::array<TissueVoice, cases::kTissueCount> kTissues{{
    {-20.0, 3000.0, 1.2, 6500.0, 2.0, 0.25},  // none: what was cut last rings on, see CuttingVoice
    {0.0, 6200.0, 2.0, 11000.0, 3.0, 0.60},   // enamel
    {-6.0, 3000.0, 1.2, 6500.0, 2.0, 0.25},   // dentine
    {-20.0, 700.0, 0.8, 1500.0, 1.0, 0.05},   // pulp
    {-14.0, 1000.0, 0.8, 2500.0, 1.5, 0.10},  // caries
    {-8.0, 2500.0, 1.2, 5500.0, 2.0, 0.20},   // cementum
    {-24.0, 500.0, 0.7, 1000.0, 1.0, 0.05},   // gum
    {-8.0, 2200.0, 1.0, 5000.0, 2.0, 0.20},   // bone
    {0.0, 6200.0, 2.0, 11000.0, 3.0, 0.60},   // neighbour
    {1.0, 7500.0, 2.5, 12500.0, 3.0, 0.70},   // restoration
    {-3.0, 4500.0, 1.6, 8500.0, 2.5, 0.40},   // demineralised enamel
    {-15.0, 900.0, 0.8, 2200.0, 1.5, 0.08},   // carious dentine: soft
    {-13.5, 1200.0, 0.8, 2800.0, 1.6, 0.11},  // soft to leathery
    {-12.0, 1500.0, 0.9, 3500.0, 1.7, 0.14},  // leathery
    {-10.5, 1900.0, 1.0, 4200.0, 1.8, 0.17},  // leathery to firm
    {-9.0, 2200.0, 1.1, 5000.0, 1.9, 0.20},   // firm
    {-7.5, 2600.0, 1.1, 5700.0, 2.0, 0.22},   // firm to hard
    {0.0, 6200.0, 2.0, 11000.0, 3.0, 0.60},   // stained enamel
    {-5.0, 3600.0, 1.4, 7500.0, 2.2, 0.35},   // calculus
}};

}  // namespace

double driveLevelDb(double freeSpeedRpm) noexcept {
    return 22.0 * std::log10(finite(freeSpeedRpm, 20000.0, 400000.0) / 400000.0);
}

const TissueVoice& tissueVoice(cases::Tissue tissue) noexcept {
    const auto index = static_cast<std::size_t>(tissue);
    return kTissues[index < kTissues.size() ? index : 0];
}

double cuttingLevel(const DrillState& drill) noexcept {
    const double radius = finite(drill.burRadiusMm, 0.05, 15.0);
    constexpr double kTorquePerRadius = 0.3;  // of 1 N: the friction of the reference bur
    const double load = finite(drill.loadTorqueNmm, 0.0, 100.0) / (kTorquePerRadius * radius);
    if (load <= 0.0) return 0.0;
    const double speed = finite(drill.speedRpm, 0.0, 400000.0) / 400000.0;
    // A bur that rubs without taking anything off is duller.
    constexpr double kHalfRemovalMm3S = 0.02;
    const double removal = finite(drill.removalMm3S, 0.0, 1e6);
    const double chips = drill.cutting ? 0.4 + 0.6 * removal / (removal + kHalfRemovalMm3S) : 0.4;
    return std::min(2.0, std::pow(load, 0.6)) * std::pow(speed, 0.7) * std::pow(radius / 0.5, 0.4) * chips;
}

MotorVoice::MotorVoice(std::uint32_t seed) noexcept
    : speedHz_(3.0),
      share_(3.0),
      pedal_(12.0),
      spray_(25.0),
      geared_(20.0),
      driveLevel_(20.0),
      airNoise_(16 * seed),
      mistNoise_(16 * seed + 1),
      rattle_(16 * seed + 2, 25.0),
      flutter_(16 * seed + 3, 12.0) {
    airBand_.tune(2500.0, 0.7);
    mistHigh_.tune(6000.0, 0.8);
}

void MotorVoice::control() noexcept {
    const double hz = speedHz_.value(), share = share_.value(), geared = geared_.value();
    const double rotor = kRotorPeak * driveLevel_.value() * share * std::sqrt(share);
    for (int n = 0; n < kHarmonics; ++n) {
        const auto i = static_cast<std::size_t>(n);
        // Gears and a motor's vanes have more overtones than a rotor on air.
        const double more = n == 0 ? 1.0 : 1.0 + geared;
        harmonics_[i].aim(rotor * kHarmonicShare[i] * more * audible(hz * (n + 1)));
    }
    ball_.aim(0.06 * rotor * (1.0 - 0.5 * geared) * audible(hz * kBalls * kCageShare));
    mesh_.aim(0.8 * rotor * geared * audible(hz * (kMeshTeeth + 1.0)));
    // Air through the turbine and past its blades; a geared drive has only cooling air.
    const double pedal = pedal_.value();
    air_.aim(kAirRms * std::sqrt(driveLevel_.value()) * (1.0 - 0.6 * geared) * pedal *
             (0.35 + 0.65 * share * std::sqrt(share)));
    airBand_.aim(2500.0 + 4500.0 * share * (1.0 - 0.5 * geared), 0.7);
    mist_.aim(kSprayRms * std::sqrt(driveLevel_.value()) * spray_.value());
}

void MotorVoice::render(const DrillState& drill, std::span<float> out) noexcept {
    const double freeRpm = freeRpmOf(drill), pedal = finite(drill.pedal, 0.0, 1.0);
    speedHz_.setTarget(speedHzOf(drill));
    share_.setTarget(std::min(1.25, 60.0 * speedHzOf(drill) / freeRpm));
    pedal_.setTarget(pedal);
    spray_.setTarget(drill.water ? pedal : 0.0);
    geared_.setTarget(gearedOf(freeRpm));
    driveLevel_.setTarget(fromDecibel(driveLevelDb(freeRpm)));
    // A pitch that rises out of silence is not heard to rise: it is there.
    if (share_.value() == 0.0) {
        speedHz_.jump(speedHzOf(drill));
        if (pedal_.value() == 0.0) {
            geared_.jump(gearedOf(freeRpm));
            driveLevel_.jump(fromDecibel(driveLevelDb(freeRpm)));
        }
    }
    for (float& sample : out) {
        if (untilControl_ == 0) {
            control();
            untilControl_ = kControlSamples;
        }
        --untilControl_;
        const double hz = speedHz_.next();
        share_.next();
        pedal_.next();
        spray_.next();
        geared_.next();
        driveLevel_.next();
        step(turn_, hz);
        step(cage_, kCageShare * hz);
        const double s1 = std::sin(kTurn * turn_), c1 = std::cos(kTurn * turn_);
        double s = s1, c = c1, tones = 0.0, mesh = 0.0;
        for (int n = 1; n <= static_cast<int>(kMeshTeeth); ++n) {
            if (n <= kHarmonics) tones += harmonics_[static_cast<std::size_t>(n - 1)].next() * s;
            if (n == static_cast<int>(kMeshTeeth)) mesh = s;
            const double turned = s * c1 + c * s1;
            c = c * c1 - s * s1;
            s = turned;
        }
        tones += mesh_.next() * mesh * (1.0 + 0.35 * c1);
        // The cage carries the balls round: the load on them swells with it, and they never run quite evenly.
        const double cage = kTurn * cage_;
        tones *= 1.0 + 0.10 * std::cos(cage) + 0.03 * rattle_.next();
        tones += ball_.next() * std::sin(kBalls * cage);
        const double air = air_.next() * airBand_.band(airNoise_.next());
        const double mist = mist_.next() * mistHigh_.high(mistNoise_.next()) * (1.0 + 0.15 * flutter_.next());
        sample += static_cast<float>(tones + air + mist);
    }
}

CuttingVoice::CuttingVoice(std::uint32_t seed) noexcept
    : level_(2.0),
      chatter_(6.0),
      speedHz_(3.0),
      edges_(10.0, 6.0),
      lowHz_(5.0),
      lowQ_(5.0),
      highHz_(5.0),
      highQ_(5.0),
      tissueDb_(5.0),
      brightness_(5.0),
      lowNoise_(16 * seed),
      highNoise_(16 * seed + 1),
      gruntNoise_(16 * seed + 2),
      crumble_(16 * seed + 3, 90.0),
      stagger_(16 * seed + 4, 6.0) {
    gruntBand_.tune(420.0, 1.5);
}

void CuttingVoice::control() noexcept {
    const double hz = speedHz_.value(), toothHz = hz * edges_.value();
    const double tissue = fromDecibel(tissueDb_.value());
    // Chips and the turning tone share one power, so that a tissue's level is what its row says.
    const double bright = brightness_.value(), level = kNominalRms * level_.value() * tissue;
    constexpr double kChips = 0.93;  // beside turn tone 0.25 and tooth tone 0.3 at their most
    const double main = kChips * level / std::sqrt(1.0 + bright * bright);
    low_.aim(main);
    high_.aim(main * bright);
    turnTone_.aim(0.25 * level * std::numbers::sqrt2 * audible(hz));
    toothTone_.aim(0.30 * level * std::numbers::sqrt2 * audible(toothHz));
    toothSwell_.aim(0.5 * audible(toothHz));
    stick_.aim(0.9 * kNominalRms * chatter_.value() * std::sqrt(tissue));
    lowBand_.aim(lowHz_.value(), lowQ_.value());
    highBand_.aim(highHz_.value(), highQ_.value());
}

void CuttingVoice::render(const DrillState& drill, std::span<float> out) noexcept {
    const double hz = speedHzOf(drill), torque = finite(drill.loadTorqueNmm, 0.0, 100.0);
    level_.setTarget(cuttingLevel(drill));
    const double pedal = finite(drill.pedal, 0.0, 1.0);
    // A bur that is about to stick already grunts.
    const double slow = smooth((0.15 - 60.0 * hz / freeRpmOf(drill)) / 0.1);
    chatter_.setTarget(drill.stalled ? pedal : torque > 0.0 && drill.cutting ? pedal * slow : 0.0);
    speedHz_.setTarget(hz);
    edges_.setTarget(std::clamp(drill.edges, 1, 64));
    if (drill.tissue != cases::Tissue::none) tissue_ = drill.tissue;
    const TissueVoice& voice = tissueVoice(tissue_);
    // A larger bur cuts in a lower voice.
    const double lower = std::pow(0.5 / finite(drill.burRadiusMm, 0.05, 15.0), 0.3);
    const auto set = [&](Glide& glide, double value) {
        if (level_.value() == 0.0 && chatter_.value() == 0.0)
            glide.jump(value);
        else
            glide.setTarget(value);
    };
    set(lowHz_, voice.lowHz * lower);
    set(lowQ_, voice.lowQ);
    set(highHz_, voice.highHz * lower);
    set(highQ_, voice.highQ);
    set(tissueDb_, voice.levelDb);
    set(brightness_, voice.brightness);
    for (float& sample : out) {
        if (untilControl_ == 0) {
            control();
            untilControl_ = kControlSamples;
        }
        --untilControl_;
        const double turnHz = speedHz_.next(), edges = edges_.next();
        for (Glide* glide : {&level_, &chatter_, &lowHz_, &lowQ_, &highHz_, &highQ_, &tissueDb_, &brightness_})
            glide->next();
        step(turn_, turnHz);
        step(toothTurn_, turnHz * edges);
        const double turn = std::cos(kTurn * turn_), tooth = std::cos(kTurn * toothTurn_);
        // No bur runs quite true: one edge cuts more than the others. Each edge is a burst of chips.
        const double swell = 1.0 + 0.3 * turn + toothSwell_.next() * tooth + 0.25 * crumble_.next();
        const double chips =
            low_.next() * lowBand_.band(lowNoise_.next()) + high_.next() * highBand_.band(highNoise_.next());
        const double tones = turnTone_.next() * turn + toothTone_.next() * tooth;
        step(grunt_, 26.0 * std::max(0.2, 1.0 + 0.25 * stagger_.next()));
        const double pulse = 0.5 + 0.5 * std::cos(kTurn * grunt_);
        const double stick = stick_.next() * pulse * pulse * pulse * gruntBand_.band(gruntNoise_.next());
        sample += static_cast<float>(chips * swell + tones + stick);
    }
}

}  // namespace handpiece::sound
