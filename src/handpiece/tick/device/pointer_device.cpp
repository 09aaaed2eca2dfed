// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/pointer_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/tick/device/capability.h"
#include "handpiece/tick/device/units.h"

namespace handpiece::device {
namespace {

using core::Quat;
using core::Vec3;

constexpr double kMaxPeriodS = 0.05;    // a machine that slept longer costs no more steps than this
constexpr double kMaxLoadShare = 0.95;  // of the device's largest force: the tooth must be able to hold the hand
constexpr double kMaxPlaceMm = 1e4;     // farther away nobody points
constexpr double kTurnS = 0.01;         // with which the hand turns to where it is asked to
constexpr double kOutFirstMm = 0.5;     // deeper along the way than where it is to be it does not go across yet
constexpr double kMinN = 1e-9;          // a load that has a direction
// The tip is held under the pointer as by a spring so many times stiffer than what lies between hand and tip, through a
// low pass; what is then left goes slowly, or a bur that cuts would swing round its place.
constexpr double kTipGain = 20.0, kTipS = 0.025, kSettleS = 0.4;
constexpr double kMaxShare = 0.8;  // of an error, in one tick
// In a fissure and over a ridge the tip goes farther than the hand: its spring is softer by as much, and for so long.
constexpr double kSteepS = 0.2, kLatelyS = 0.01, kLeastSwingMm = 2e-3, kSofter = 4.0, kSteepest = 12.0;
// The load falls to none on the last of the way, some hundredths of a millimetre, or a stroke would end far above it.
constexpr double kEndStiffer = 4.0;
constexpr double kLeastTravelMmS = 75.0, kTravelMmSPerN = 150.0, kMetMmSPerN = 20.0;
constexpr double kTissueDampingNSPerMm = 0.002;  // of teeth (data/tissues.toml)
// What bears too much goes so much sooner than what is missing comes; a larger share of it in one tick would swing.
constexpr double kGiveGain = 4.0, kGiveShare = 0.5;
constexpr double kOverLoad = 0.05;  // of the load, more: then it only gives way
// What a tick's step may add to the force, as a share of the load: it is known only in the next tick.
constexpr double kStepShare = 0.08, kUsualPeriodS = 1e-3;
// A tip that is left so far behind the pointer begins to come up, and so much farther it is over it [judgements].
constexpr double kBehindMm = 0.1, kUpMm = 0.4, kOverMm = 0.1;
// A stroke's speed is the mean of so long; a shorter stroke than that has no second pass.
constexpr double kSpeedS = 0.1, kLeastStrokeMm = 0.3;

/// What the hand is asked to do, once it has been found to make sense.
struct Wish {
    Vec3 positionMm = Vec3::Zero();
    Quat orientation = Quat::Identity();
    double pedal = 0.0, loadN = 0.0, mostN = 0.0, farMm = 0.0, passMm = 0.0;
    bool isLed = false, regrips = false, frozen = false, away = false;
    Vec3 way = Vec3::Zero();

    [[nodiscard]] bool presses() const noexcept { return loadN > 0.0 && !way.isZero() && !frozen && !away; }
};

bool isPlace(const double (&v)[3]) noexcept {
    return std::abs(v[0]) < kMaxPlaceMm && std::abs(v[1]) < kMaxPlaceMm && std::abs(v[2]) < kMaxPlaceMm;
}

/// False for what is not finite or no rotation; `wish` then stays as it is.
bool understand(const PointerTarget& target, double mostLoadN, Wish& wish) noexcept {
    const double(&q)[4] = target.orientation;
    const double size2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!isPlace(target.positionMm) || !(size2 > 0.25 && size2 < 4.0)) return false;
    if (!std::isfinite(target.pedal) || !std::isfinite(target.loadN)) return false;
    const Vec3 way(target.way[0], target.way[1], target.way[2]);
    const double way2 = way.squaredNorm();
    if (way2 != 0.0 && !(std::abs(way2 - 1.0) < 1e-6)) return false;
    if (!(std::abs(target.farMm) < kMaxPlaceMm) || !std::isfinite(target.passMm) || !std::isfinite(target.mostN))
        return false;
    wish.positionMm = Vec3(target.positionMm[0], target.positionMm[1], target.positionMm[2]);
    wish.orientation = Quat(q[0], q[1], q[2], q[3]).normalized();
    wish.pedal = std::clamp(target.pedal, 0.0, 1.0);
    wish.loadN = std::clamp(target.loadN, 0.0, mostLoadN);
    wish.way = way;
    wish.mostN = std::max(target.mostN, 0.0);
    wish.farMm = target.farMm;
    wish.passMm = target.passMm;
    wish.isLed = target.isLed;
    wish.regrips = target.regrips;
    wish.frozen = target.frozen;
    wish.away = target.away;
    return true;
}

Vec3 heldTo(const Vec3& v, double most) noexcept {
    const double size = v.norm();
    return size > most ? Vec3(v * (most / size)) : v;
}

}  // namespace

const Capability& pointerCapability() {
    static const Capability pointer = [] {
        Capability c = capabilityByName("simulated");
        c.name = "pointer";
        c.maxStiffnessNPerMm *= 4.0;
        c.encoderStepMm = 0.0;
        return c;
    }();
    return pointer;
}

struct PointerDevice::State {
    PointerHandSettings settings;
    Capability capability;
    std::shared_ptr<PointerMailbox> mailbox;
    Wish wish;
    bool started = false, wasAway = false, wasPressing = false;
    bool watches = false;  // has been told of its tip since the last reading
    Vec3 tipMm = Vec3::Zero(), pressN = Vec3::Zero();
    Vec3 wasTipMm = Vec3::Zero(), steppedMm = Vec3::Zero();  // the tip before, and the hand's step since
    Vec3 tipWentMm = Vec3::Zero();  // of late, across the way: as it went, all of it, and the hand's
    double tipWayMm = 0.0, handWayMm = 0.0, steep = 1.0;
    Vec3 strokeFromMm = Vec3::Zero();                // across the way, where it began
    double strokeMm = 0.0, pathMm = 0.0, mmS = 0.0;  // how far from there, its path, how fast it goes
    double farMm = 0.0;                              // along the way, of the place that it wanted without a load
    Vec3 settledMm = Vec3::Zero();  // by which the hand stays beside a tip that is in its place, on a slope
    Vec3 liftedMm = Vec3::Zero();   // where an away hand goes
    Vec3 wantedMm = Vec3::Zero(), wantedMmS = Vec3::Zero();      // where the hand wants to be
    Vec3 wantedMmS2 = Vec3::Zero();                              // its acceleration, while nothing holds it
    Vec3 positionMm = Vec3::Zero(), velocityMmS = Vec3::Zero();  // of the mass
    Quat orientation = Quat::Identity();
    Vec3 forceN = Vec3::Zero();  // of the tooth

    [[nodiscard]] Vec3 across(const Vec3& v) const noexcept { return v - wish.way * wish.way.dot(v); }
    void turn(double periodS) noexcept;
    void begin(bool pressing) noexcept;
    [[nodiscard]] double travelMmS() const noexcept;
    void follow(const Vec3& place, bool still, double h) noexcept;
    void move(double h) noexcept;
    void press(const Vec3& wasWantedMm, double periodS) noexcept;
    [[nodiscard]] double paintsToMm(const Vec3& moved, double periodS) noexcept;
};

PointerDevice::PointerDevice(PointerHandSettings settings, std::shared_ptr<PointerMailbox> mailbox,
                             const core::Pose& start)
    : state_(std::make_unique<State>()) {
    const auto require = [](bool good, const char* what, double value) {
        if (!good) throw core::Error(fmt::format("{} of {}", what, value), "pointer device");
    };
    require(settings.massKg >= 1e-3 && settings.massKg <= 10, "a hand's mass [kg]", settings.massKg);
    require(settings.stiffnessNPerMm > 0 && settings.stiffnessNPerMm <= 100, "a hand's stiffness [N/mm]",
            settings.stiffnessNPerMm);
    require(settings.dampingNSPerMm > 0 && settings.dampingNSPerMm <= 1, "a hand's damping [N s/mm]",
            settings.dampingNSPerMm);
    require(settings.mostPullN > 0 && settings.mostPullN <= 100, "a hand's pull [N]", settings.mostPullN);
    require(settings.followS >= 1e-3 && settings.followS <= 1, "a hand's delay [s]", settings.followS);
    require(settings.approachMmS > 0 && settings.approachMmS <= 1000, "an approach [mm/s]", settings.approachMmS);
    require(settings.travelMmS > 0 && settings.travelMmS <= 2000, "a travel [mm/s]", settings.travelMmS);
    require(settings.farthestMm >= 0.1 && settings.farthestMm <= 100, "a hand that is [mm] from the bur",
            settings.farthestMm);
    require(settings.turnRadS > 0 && settings.turnRadS <= 100, "a turn [rad/s]", settings.turnRadS);
    require(settings.liftMm >= 0 && settings.liftMm <= 100, "a lift [mm]", settings.liftMm);
    require(settings.subStepS >= 1e-6 && settings.subStepS <= 1e-3, "a sub-step [s]", settings.subStepS);
    if (mailbox == nullptr) throw core::Error("a pointer device without a mailbox", "pointer device");
    if (!start.isValid() || start.positionMm.cwiseAbs().maxCoeff() >= kMaxPlaceMm)
        throw core::Error("a start that is no pose", "pointer device");
    state_->settings = settings;
    state_->capability = pointerCapability();
    state_->mailbox = std::move(mailbox);
    state_->wish.positionMm = state_->wantedMm = state_->positionMm = start.positionMm;
    state_->wish.orientation = state_->orientation = start.orientation;
}

PointerDevice::~PointerDevice() = default;

const Capability& PointerDevice::capability() const noexcept {
    return state_->capability;
}
core::Vec3 PointerDevice::truePositionMm() const noexcept {
    return state_->positionMm;
}
core::Vec3 PointerDevice::appliedForceN() const noexcept {
    return state_->forceN;
}

Reading PointerDevice::read(double periodS) noexcept {
    State& s = *state_;
    // A pointer that never said anything leaves the hand where it began.
    if (s.mailbox->hasNews()) (void)understand(s.mailbox->read(), kMaxLoadShare * s.capability.maxForceN, s.wish);
    if (s.wish.away && !s.wasAway) s.liftedMm = s.positionMm + s.settings.liftMm * (s.orientation * Vec3::UnitZ());
    s.wasAway = s.wish.away;
    if (s.started && periodS > 0.0) {
        const double passed = std::min(periodS, kMaxPeriodS);
        if (!s.wish.frozen && !s.wish.away) s.turn(passed);
        s.begin(s.wish.presses());
        const int steps = std::max(1, static_cast<int>(std::ceil(passed / s.settings.subStepS - 1e-9)));
        const double h = passed / steps;
        const Vec3 way = s.wasPressing ? Vec3(Vec3::Zero()) : Vec3(s.wish.farMm * s.wish.way);
        const Vec3 place = s.wish.away ? s.liftedMm : Vec3(s.wish.positionMm + way), wasWanted = s.wantedMm;
        for (int i = 0; i < steps; ++i) {
            s.follow(place, s.wish.frozen && !s.wish.away, h);
            if (!s.wasPressing) s.move(h);
        }
        if (s.wasPressing) s.press(wasWanted, passed);
    }
    s.watches = false;
    s.started = true;
    Reading reading;
    reading.burInTooth = {s.positionMm, s.orientation};
    reading.pedal = s.wish.away || s.wish.regrips ? 0.0 : s.wish.pedal;
    if (s.wish.regrips) reading.buttons |= kRegripsButton;
    return reading;
}

void PointerDevice::command(const Vec3& forceN, const Vec3& /*torqueNmm: no torque axes*/) noexcept {
    state_->forceN = forceN.allFinite() ? forceN : Vec3(Vec3::Zero());
}

void PointerDevice::watch(const Vec3& tipMm, const Vec3& bearingN) noexcept {
    State& s = *state_;
    s.watches = tipMm.allFinite() && bearingN.allFinite();
    if (!s.watches) return;
    s.tipMm = tipMm;
    s.pressN = bearingN;
}

/// Between the two ways nothing jumps.
void PointerDevice::State::begin(bool pressing) noexcept {
    if (pressing && !wasPressing) {
        wantedMm -= farMm * wish.way;
        settledMm.setZero();
        steppedMm.setZero();
        wasTipMm = tipMm;
        tipWentMm.setZero();
        tipWayMm = handWayMm = 0.0;
        steep = 1.0;
        strokeFromMm = wantedMm;
        strokeMm = pathMm = mmS = 0.0;
    }
    if (!pressing && wasPressing) {
        wantedMm = positionMm;
        wantedMmS.setZero();
        velocityMmS.setZero();
    }
    wasPressing = pressing;
    farMm = pressing ? 0.0 : wish.farMm;
}

void PointerDevice::State::turn(double periodS) noexcept {
    const double angle = core::angleBetween(orientation, wish.orientation);
    if (!(angle > 0.0)) return;
    const double wanted = angle * (1.0 - core::exp(-periodS / kTurnS));
    const double share = std::min(wanted, settings.turnRadS * periodS) / angle;
    orientation = core::interpolated(orientation, share, wish.orientation).normalized();
}

/// A light hand is a slow one: what it might meet on its way, beside what was looked at, stops it at little more than
/// its load.
double PointerDevice::State::travelMmS() const noexcept {
    if (!(wish.mostN > 0.0) || wish.regrips) return settings.travelMmS;
    return std::min(settings.travelMmS, std::max(kLeastTravelMmS, kTravelMmSPerN * wish.mostN));
}

void PointerDevice::State::follow(const Vec3& place, bool still, double h) noexcept {
    // Critically damped; an error that is held to twice the travel's share ends in that speed, without overshoot.
    const double w = 2.0 / settings.followS;
    Vec3 error = still ? Vec3(Vec3::Zero()) : Vec3(place - wantedMm);
    const double deeper = -error.dot(wish.way);
    if (!wasPressing && deeper > 0.0) {
        const double across = std::clamp(1.0 - deeper / kOutFirstMm, 0.0, 1.0);
        error = across * error - (1.0 - across) * deeper * wish.way;
    }
    error = heldTo(error, 2.0 * travelMmS() / w);
    const Vec3 before = wantedMmS;
    wantedMmS = (wantedMmS + h * w * w * error) / (1.0 + h * 2.0 * w + h * h * w * w);
    wantedMm += h * wantedMmS;
    wantedMmS2 = (wantedMmS - before) / h;
    if (wasPressing) return;
    // It cannot want what the tooth keeps it from by more than it can pull; held like that it does not go on wanting.
    const Vec3 stretch = wantedMm - positionMm;
    const double mostN = wish.mostN > 0.0 ? std::min(wish.mostN, settings.mostPullN) : settings.mostPullN;
    const double length = stretch.norm(), most = mostN / settings.stiffnessNPerMm;
    if (length <= most) return;
    const Vec3 outward = stretch / length;
    wantedMm = positionMm + most * outward;
    wantedMmS -= std::max(0.0, wantedMmS.dot(outward)) * outward;
    wantedMmS2.setZero();
}

void PointerDevice::State::move(double h) noexcept {
    const double mass = settings.massKg / kKgPerUnit, k = settings.stiffnessNPerMm, b = settings.dampingNSPerMm;
    // The hand's spring and damper act at the end of the step: stable whatever their size. What speeds the mass up with
    // what the hand wants is the hand's own: in free air it follows without delay.
    const Vec3 pullN = mass * wantedMmS2 + b * wantedMmS + k * (wantedMm - positionMm);
    // What meets something has no way to go on: a person's hand stops, it does not swing.
    const bool meets = wish.mostN > 0.0 && forceN.squaredNorm() > 0.0;
    Vec3 going = meets ? heldTo(velocityMmS, kMetMmSPerN * wish.mostN) : velocityMmS;
    if (meets) {
        // Slower the more of its pull is used up: its mass does not swing on into soft tissue.
        const double bearN = forceN.norm(), most = kMetMmSPerN * std::max(0.0, wish.mostN - bearN);
        const Vec3 against = forceN / bearN;
        going += std::max(0.0, -going.dot(against) - most) * against;
    }
    velocityMmS =
        (h / (mass + h * b + h * h * k)) * (mass / h * going + (meets ? heldTo(pullN, wish.mostN) : pullN) + forceN);
    positionMm += h * velocityMmS;
}

/// Along the way, as deep as a stroke goes at its speed, and each time again that it passes.
double PointerDevice::State::paintsToMm(const Vec3& moved, double periodS) noexcept {
    const double went = across(moved).norm();
    mmS += (went / periodS - mmS) * (1.0 - core::exp(-periodS / kSpeedS));
    pathMm += went;
    strokeMm = std::max(strokeMm, across(wantedMm - strokeFromMm).norm());
    const double passes = std::max(1.0, pathMm / std::max(strokeMm, kLeastStrokeMm));
    const double deepMm = passes * kPaintMm2SPerN * wish.loadN / std::max(mmS, 1e-3);
    return std::min(wish.farMm, wish.passMm + deepMm);
}

void PointerDevice::State::press(const Vec3& wasWantedMm, double periodS) noexcept {
    // Shares of what is left, so that no period is too long: of the way to a place, of a force that is missing.
    const double k = capability.maxStiffnessNPerMm, b = settings.dampingNSPerMm;
    const double back = 1.0 - core::exp(-periodS * kEndStiffer * settings.stiffnessNPerMm / b);
    const double part = 1.0 - core::exp(-periodS * k / b), mmPerN = part / k;
    const Vec3& way = wish.way;
    if (!watches) {  // before the first tick has told it of its tip
        tipMm = positionMm;
        pressN.setZero();
    }
    const Vec3 left = wantedMm - tipMm, moved = wantedMm - wasWantedMm, beside = across(left);
    // Left behind it comes up, as far as the surface was when the stroke began: no wall holds it there.
    const double up = wish.isLed ? 0.0 : std::clamp((beside.norm() - kBehindMm) / kUpMm, 0.0, 1.0);
    const double deepMm = wish.isLed ? wish.farMm : paintsToMm(moved, periodS);
    const double endMm = deepMm + up * (std::min(wish.passMm - kOverMm, deepMm) - deepMm);
    // What meets it at that speed, spring and damper, adds no more to the load than a step may.
    const double meets = kStepShare * wish.loadN / (k * std::min(periodS, kUsualPeriodS) + kTissueDampingNSPerMm);
    const double most = std::min(settings.approachMmS, meets) * periodS, ahead = left.dot(way) + endMm,
                 allN = pressN.norm();
    // Millimetres of it; what is too much goes sooner, as far as a force that is known a tick later lets it.
    const double lacksN = wish.loadN - allN;
    const double missing = lacksN < 0.0 ? lacksN * std::min(kGiveShare, kGiveGain * part) / k : lacksN * mmPerN;
    const double in = std::min({most, missing, ahead * back - pressN.dot(way) * mmPerN});
    // What of the tip's way goes to and fro.
    const double lately = core::exp(-periodS / kLatelyS);
    const Vec3 went = across(tipMm - wasTipMm);
    tipWentMm = lately * tipWentMm + went;
    tipWayMm = lately * tipWayMm + went.norm();
    handWayMm = lately * handWayMm + across(steppedMm).norm();
    const double swings = tipWayMm - tipWentMm.norm();
    steep = 1.0 + (steep - 1.0) * core::exp(-periodS / kSteepS);
    // A bur that turns cuts itself free, and must hold its place the better for it.
    const double softer = wish.pedal > 0.0 ? 1.0 : kSofter;
    if (swings > kLeastSwingMm)
        steep = std::clamp(softer * swings / std::max(handWayMm, kLeastSwingMm), steep, kSteepest);
    const double share = 1.0 - core::exp(-periodS / kTipS), gain = std::min(kTipGain, kMaxShare / share / steep);
    settledMm = heldTo(across(settledMm) + gain * (1.0 - core::exp(-periodS / kSettleS)) * beside, wish.loadN / k);
    // With the pointer, as the uncut tooth rises and falls under it; and on until the tip is under it.
    const Vec3 over = across(tipMm - positionMm);
    Vec3 step = (std::min(way.dot(moved), most) + in) * way +
                (wish.isLed ? Vec3(back * over) : Vec3(across(moved) + share * (over + gain * beside + settledMm)));
    // Against the tooth no farther than the load goes, whichever way.
    if (allN > kMinN) {
        const Vec3 against = pressN / allN;
        step -= std::max(0.0, step.dot(against) - missing) * against;
        // Between two walls a step along one presses on the other: with more than the load it only gives way, or comes
        // out.
        const double free = std::clamp((1.0 + 2.0 * kOverLoad - allN / wish.loadN) / kOverLoad, 0.0, 1.0);
        const Vec3 along = step.dot(against) * against, beyond = step - along;
        Vec3 out = std::min(0.0, beyond.dot(way)) * way;
        out -= std::max(0.0, out.dot(against)) * against;  // where the head stands in the way out
        step = along + out + free * (beyond - out);
    }
    step = heldTo(step, std::min(settings.travelMmS * periodS,
                                 kStepShare * wish.loadN / k * std::max(1.0, periodS / kUsualPeriodS)));
    // Whatever held the bur off without being told of: the hand is near it.
    step = tipMm + heldTo(positionMm + step - tipMm, settings.farthestMm) - positionMm;
    positionMm += step;
    velocityMmS = step / periodS;
    wasTipMm = tipMm;
    steppedMm = step;
}

}  // namespace handpiece::device
