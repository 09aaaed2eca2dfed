// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/pointer_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/device/capability.h"

namespace handpiece::device {
namespace {

using core::Quat;
using core::Vec3;

constexpr double kKgPerUnit = 1e3;       // 1 N s2/mm is 1000 kg
constexpr double kMostPeriodS = 0.05;    // a machine that slept longer costs no more steps than this
constexpr double kMostLoadShare = 0.95;  // of the device's largest force: the tooth must be able to hold the hand
constexpr double kMostPlaceMm = 1e4;     // farther away nobody points
constexpr double kTurnS = 0.01;          // with which the hand turns to where it is asked to
constexpr double kHeldN = 0.01;          // along the axis: from here on the tooth holds the hand,
constexpr double kHeldShare = 0.35;      // unless most of its force is from the side: friction of a wall holds nothing
constexpr double kFallS = 0.02;          // with which a falling hand comes to rest

/// What the hand is asked to do, once it has been found to make sense.
struct Wish {
    Vec3 positionMm = Vec3::Zero();
    Quat orientation = Quat::Identity();
    double pedal = 0.0, loadN = 0.0;
    bool hasStop = false, hasFloor = false, frozen = false, away = false;
    Vec3 stopMm = Vec3::Zero(), floorMm = Vec3::Zero();
    double fallMm = kFallFreely;
};

bool isPlace(const double (&v)[3]) noexcept {
    return std::abs(v[0]) < kMostPlaceMm && std::abs(v[1]) < kMostPlaceMm && std::abs(v[2]) < kMostPlaceMm;
}

/// False for what is not finite or no rotation; `wish` then stays as it is.
bool understand(const PointerTarget& target, double mostLoadN, Wish& wish) noexcept {
    const double(&q)[4] = target.orientation;
    const double size2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!isPlace(target.positionMm) || !(size2 > 0.25 && size2 < 4.0)) return false;
    if (!std::isfinite(target.pedal) || !std::isfinite(target.loadN)) return false;
    if (target.hasStop && !isPlace(target.stopMm)) return false;
    if (target.hasFloor && !isPlace(target.floorMm)) return false;
    if (!(target.fallMm >= 0.0)) return false;
    wish.positionMm = Vec3(target.positionMm[0], target.positionMm[1], target.positionMm[2]);
    wish.orientation = Quat(q[0], q[1], q[2], q[3]).normalized();
    wish.pedal = std::clamp(target.pedal, 0.0, 1.0);
    wish.loadN = std::clamp(target.loadN, 0.0, mostLoadN);
    wish.hasStop = target.hasStop;
    wish.stopMm = Vec3(target.stopMm[0], target.stopMm[1], target.stopMm[2]);
    wish.fallMm = std::min(target.fallMm, kFallFreely);
    wish.hasFloor = target.hasFloor;
    wish.floorMm = Vec3(target.floorMm[0], target.floorMm[1], target.floorMm[2]);
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
    double fallenMm = 0.0;         // of the hand, along the axis below where the tip was when the tooth last held it
    Vec3 liftedMm = Vec3::Zero();  // where an away hand goes
    Vec3 wantedMm = Vec3::Zero(), wantedMmS = Vec3::Zero();      // where the hand wants to be
    Vec3 wantedMmS2 = Vec3::Zero();                              // its acceleration, while nothing holds it
    Vec3 positionMm = Vec3::Zero(), velocityMmS = Vec3::Zero();  // of the mass
    Quat orientation = Quat::Identity();
    Vec3 forceN = Vec3::Zero();  // of the tooth

    void turn(double periodS) noexcept;
    void follow(const Vec3& place, bool still, double h) noexcept;
    void move(bool pressing, const Vec3& axis, double h) noexcept;
    [[nodiscard]] double pressN(const Vec3& tipFirst) const noexcept;
    [[nodiscard]] bool isHeld(const Vec3& tipFirst) const noexcept {
        return -forceN.dot(tipFirst) > std::max(kHeldN, kHeldShare * forceN.norm());
    }
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
    require(settings.turnRadS > 0 && settings.turnRadS <= 100, "a turn [rad/s]", settings.turnRadS);
    require(settings.liftMm >= 0 && settings.liftMm <= 100, "a lift [mm]", settings.liftMm);
    require(settings.stopStiffnessNPerMm > 0 && settings.stopStiffnessNPerMm <= 100, "a stop's stiffness [N/mm]",
            settings.stopStiffnessNPerMm);
    require(settings.subStepS >= 1e-6 && settings.subStepS <= 1e-3, "a sub-step [s]", settings.subStepS);
    if (mailbox == nullptr) throw core::Error("a pointer device without a mailbox", "pointer device");
    if (!start.isValid() || start.positionMm.cwiseAbs().maxCoeff() >= kMostPlaceMm)
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
    if (s.mailbox->hasNews()) (void)understand(s.mailbox->read(), kMostLoadShare * s.capability.maxForceN, s.wish);
    const Vec3 axis = s.orientation * Vec3::UnitZ();
    if (s.wish.away && !s.wasAway) s.liftedMm = s.positionMm + s.settings.liftMm * axis;
    s.wasAway = s.wish.away;
    if (s.started && periodS > 0.0) {
        const double passed = std::min(periodS, kMostPeriodS);
        if (!s.wish.frozen && !s.wish.away) s.turn(passed);
        const bool pressing = s.wish.loadN > 0.0 && !s.wish.frozen && !s.wish.away;
        if (pressing && !s.wasPressing) s.fallenMm = 0.0;
        s.wasPressing = pressing;
        const int steps = std::max(1, static_cast<int>(std::ceil(passed / s.settings.subStepS - 1e-9)));
        const double h = passed / steps;
        const Vec3& place = s.wish.away ? s.liftedMm : s.wish.positionMm;
        for (int i = 0; i < steps; ++i) {
            s.follow(place, s.wish.frozen && !s.wish.away, h);
            s.move(pressing, axis, h);
        }
    }
    s.started = true;
    Reading reading;
    reading.burInTooth = {s.positionMm, s.orientation};
    reading.pedal = s.wish.away ? 0.0 : s.wish.pedal;
    return reading;
}

void PointerDevice::command(const Vec3& forceN, const Vec3& /*torqueNmm: no torque axes*/) noexcept {
    state_->forceN = forceN.allFinite() ? forceN : Vec3(Vec3::Zero());
}

void PointerDevice::State::turn(double periodS) noexcept {
    const double angle = orientation.angularDistance(wish.orientation);
    if (!(angle > 0.0)) return;
    const double wanted = angle * (1.0 - std::exp(-periodS / kTurnS));
    const double share = std::min(wanted, settings.turnRadS * periodS) / angle;
    orientation = orientation.slerp(share, wish.orientation).normalized();
}

void PointerDevice::State::follow(const Vec3& place, bool still, double h) noexcept {
    // Critically damped; an error that is held to twice the travel's share ends in that speed, without overshoot.
    const double w = 2.0 / settings.followS;
    const Vec3 error = still ? Vec3(Vec3::Zero()) : heldTo(place - wantedMm, 2.0 * settings.travelMmS / w);
    const Vec3 before = wantedMmS;
    wantedMmS = (wantedMmS + h * w * w * error) / (1.0 + h * 2.0 * w + h * h * w * w);
    wantedMm += h * wantedMmS;
    wantedMmS2 = (wantedMmS - before) / h;
    // It cannot want what the tooth keeps it from by more than it can pull; held like that it does not go on wanting.
    const Vec3 stretch = wantedMm - positionMm;
    const double length = stretch.norm(), most = settings.mostPullN / settings.stiffnessNPerMm;
    if (length <= most) return;
    const Vec3 outward = stretch / length;
    wantedMm = positionMm + most * outward;
    wantedMmS -= std::max(0.0, wantedMmS.dot(outward)) * outward;
    wantedMmS2.setZero();
}

double PointerDevice::State::pressN(const Vec3& tipFirst) const noexcept {
    const double resistN = -forceN.dot(tipFirst);
    double load = wish.loadN;
    if (wish.hasStop) {
        // The tip stands behind the hand by what the tooth's hardest tissue gives under this force: never less.
        const double tip =
            (positionMm - wish.stopMm).dot(tipFirst) - std::max(0.0, resistN) / capability.maxStiffnessNPerMm;
        load = std::clamp(-settings.stopStiffnessNPerMm * tip, -load, load);
    }
    // In the air the hand comes no faster than its approach, and only so far.
    double speed = settings.approachMmS;
    if (!isHeld(tipFirst)) {
        double left = wish.fallMm - fallenMm;
        if (wish.hasFloor) left = std::max(left, (wish.floorMm - positionMm).dot(tipFirst));
        speed = std::clamp(left / kFallS, -speed, speed);
    }
    return std::min(load - resistN, settings.dampingNSPerMm * speed);
}

void PointerDevice::State::move(bool pressing, const Vec3& axis, double h) noexcept {
    const double mass = settings.massKg / kKgPerUnit, k = settings.stiffnessNPerMm, b = settings.dampingNSPerMm;
    // The hand's spring and damper act at the end of the step: stable whatever their size.
    const auto along = [&](const Vec3& v) { return Vec3(axis * axis.dot(v)); };
    // What speeds the mass up with what the hand wants is the hand's own: in free air it follows without delay.
    const Vec3 pullN = mass * wantedMmS2 + b * wantedMmS + k * (wantedMm - positionMm);
    Vec3 v = (h / (mass + h * b + h * h * k)) * (mass / h * velocityMmS + pullN + forceN);
    if (pressing) {
        const double speed = (mass / h * axis.dot(velocityMmS) - pressN(-axis)) * (h / (mass + h * b));
        v += axis * speed - along(v);
        // Held, the tip stands behind the hand by what the hardest tissue gives.
        fallenMm = isHeld(-axis) ? forceN.dot(axis) / capability.maxStiffnessNPerMm : fallenMm - h * speed;
    }
    velocityMmS = v;
    positionMm += h * v;
    if (pressing) {
        // Let go, it begins where it is.
        wantedMm += along(positionMm - wantedMm);
        wantedMmS += along(v - wantedMmS);
    }
}

}  // namespace handpiece::device
