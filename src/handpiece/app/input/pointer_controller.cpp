// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/pointer_controller.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "handpiece/app/input/holding.h"
#include "handpiece/app/input/line_of_sight.h"
#include "handpiece/app/input/way_over.h"
#include "handpiece/app/input/working_position.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"

namespace handpiece::input {
namespace {

using core::Quat;
using core::Vec2;
using core::Vec3;

constexpr double kJumpMm = 0.5;  // nearer by so much within kJumpPixels: another surface, in front of this one
constexpr double kDropMm = 1.0;  // or farther: over an edge, with a wall below it
constexpr double kJumpPixels = 4.0;
constexpr double kMaxNudgeMm = 0.5;  // into the tooth
constexpr double kPivotRadPerPixel = 0.005;
constexpr double kLeastLeverMm = 1.0;  // of a rest: nearer to the tip nothing turns about it
constexpr double kStartAboveMm = 6.0;
constexpr double kThereMm = 0.2;     // as near as that a bur has come to where it was to go
constexpr double kStraightMm = 3.0;  // from so far away, at most, a press goes straight to its place
constexpr double kWayOutS = 1.0;     // then another way out is tried
constexpr double kPatientS = 0.3;    // without anything cut
constexpr double kEyeJumpPixels = 12.0;
constexpr double kLittleMm = 0.05, kHurryS = 1.0, kSpeedS = 0.3;  // a stroke so shallow, for so long; its speed's mean
constexpr double kSameTurnRad = 1e-6;
constexpr double kSameSight = 0.01;     // of two lines' directions: some six pixels
constexpr double kLittleTurnRad = 0.3;  // turned by more a handpiece is taken out
constexpr double kTouchedMm = 0.1;      // so deep in tissue a handpiece is not turned
constexpr double kTurnedRad = 0.05;     // nearer to its orientation than that a handpiece is held as it is to be
constexpr double kSeenFromSide = 0.8;   // cosine of the eye's way and buccolingual: one looks at a side

Quat normalised(const Quat& q) {
    return q.norm() > 1e-9 ? q.normalized() : Quat::Identity();
}

void put(double (&out)[3], const Vec3& v) {
    for (int k = 0; k < 3; ++k)
        out[k] = v[k];
}

}  // namespace

core::Pose startPose(const core::Box& tooth, int fdiNumber, int buccalSign) {
    const bool front = fdiNumber > 0 && fdiNumber % 10 <= 3;
    const double buccal = buccalSign < 0 ? -1.0 : 1.0;
    // About the long axis, from mesial (+x, where the lips are for a back tooth) towards the cheek.
    const double turn = buccal * (front ? 0.5 : 1.0 / 9.0) * std::numbers::pi;
    core::Pose pose;
    pose.positionMm = {tooth.centre().x(), tooth.centre().y(), tooth.max.z() + kStartAboveMm};
    pose.orientation = core::rotationAbout(Vec3::UnitZ(), turn);
    return pose;
}

struct PointerController::State {
    std::shared_ptr<device::PointerMailbox> mailbox;
    Cast cast;
    std::shared_ptr<HandFeel> feel;
    view::Camera camera;
    view::Viewport viewport;
    device::PointerTarget target;

    Vec3 tipMm = Vec3::Zero();    // wanted, of a bur that does not press
    Quat own = Quat::Identity();  // the student's tilt
    bool isOwn = false;           // and whether they have tilted it
    Quat orientation = own;       // as it is to be held, where it is going
    Quat onWay = own;             // as it is held on the way there
    std::optional<Vec3> proxyMm;  // as last told
    Vec3 sentMm = Vec3::Zero();   // as long as nothing was told: where the hand was sent
    bool touching = false;

    double loadN = kFirstLoadN;
    DepthLimits limits;
    bool latched = false, frozen = false, away = false;

    bool pressed = false, turning = false;
    std::optional<LineOfSight> sight;     // what the pointer leads it along
    std::optional<std::uint16_t> stroke;  // on what it began
    double endHereMm = 1e9;               // along the sight, as deep as it may go where it is, held back beside it
    bool noReach = false;                 // however the handpiece is held
    std::optional<view::Ray> unreached;   // by which that was found
    // On its way out of a cavity, or over an edge; travelling, to where it is to be.
    bool lifting = false, liftsTurning = false, travelling = false, regrips = false;
    Vec3 outMm = Vec3::Zero(), outWay = Vec3::UnitZ(), onWayMm = Vec3::Zero();
    Quat heldNow = own;  // as last told, or sent
    double liftedS = 0.0;
    bool triesAgain = false;  // to come out, another way

    // Whether anything goes.
    double removedMm3 = 0.0;
    double nowS = 0.0, idleFromS = 0.0, hurriesFromS = 0.0;  // as told
    double mmS = 0.0;
    bool waits = false, stalled = false;

    bool rebase = false;
    double pace = 1.0;  // of the pointer's
    std::optional<Vec3> restMm;
    std::optional<Vec2> lastPixel;  // as given
    Vec2 slowFromPixel = Vec2::Zero(), slowFromLag = Vec2::Zero();
    Vec2 lagPixels = Vec2::Zero();  // by which the bur stays behind the pointer

    [[nodiscard]] Vec3 axis() const { return orientation * Vec3::UnitZ(); }
    [[nodiscard]] Vec3 place() const { return proxyMm.value_or(sentMm); }
    [[nodiscard]] Leading leading() const { return {*feel, orientation}; }
    [[nodiscard]] double farMm() const { return camera.distanceMm() + 100.0; }
    [[nodiscard]] bool isPatienceOver() const { return nowS - idleFromS >= kPatientS; }
    [[nodiscard]] bool hurries() const { return nowS - hurriesFromS >= kHurryS; }
    [[nodiscard]] bool isOnStroke() const { return !stroke || !sight || !sight->touchAt || sight->what == *stroke; }
    [[nodiscard]] bool presses() const {
        return pressed && !lifting && !travelling && !noReach && sight && sight->touchAt && isOnStroke();
    }
    void send();
    [[nodiscard]] Vec2 slowed(const Vec2& pixel, double paceNow);
    bool swing(const Vec3& fromMm);
    [[nodiscard]] double clearMm(const Vec3& tip) const { return feel ? leading().clearMm(tip) : kReachMm; }
    [[nodiscard]] LineOfSight sightThrough(const Vec2& pixel) const;
    bool hold(const view::Ray& ray);
    void aim(const Vec2& pixel);
    void travel();
    void lead(const Vec2& from, const Vec2& to);
    void lift();
    void goOn();
    void holdBack();
    void turnAxisTo(const Vec3& direction);
    void turnTo(const Quat& to);
    void aimAgain();
    void limitsChanged();
};

void PointerController::State::send() {
    const Vec3 way = sight ? sight->ray.direction : Vec3(Vec3::Zero());
    target.farMm = target.loadN = 0.0;
    target.passMm = device::PointerTarget{}.passMm;
    target.mostN = loadN;
    target.isLed = lifting;
    put(target.way, way);
    if (lifting) {
        put(target.positionMm, outMm);
        put(target.way, outWay);
        target.loadN = loadN;
    } else if (presses()) {
        put(target.positionMm, sight->at(*sight->touchAt));
        target.farMm = std::min(sight->endAt, endHereMm) - *sight->touchAt;
        if (limits.perPassMm) target.passMm = sight->passAt - *sight->touchAt;
        target.loadN = loadN;
    } else if (noReach) {
        put(target.way, Vec3::Zero());  // it stays where it is
    } else {
        put(target.positionMm, travelling ? onWayMm : tipMm);
    }
    const Quat turn = noReach && !lifting ? heldNow : travelling ? onWay : orientation;
    target.orientation[0] = turn.w();
    for (int k = 0; k < 3; ++k)
        target.orientation[k + 1] = turn.vec()[k];
    // A bur that travels, or hovers over what the stroke does not cut, meets nothing with the pedal down.
    const bool works = !lifting && !travelling && !noReach && isOnStroke();
    const bool cutting = (pressed && turning && works) || (lifting && liftsTurning);
    target.pedal = !away && ((latched && !travelling) || cutting) ? 1.0 : 0.0;
    target.frozen = frozen;
    target.away = away;
    target.regrips = travelling && regrips && !lifting && !frozen && !away;
    if (!proxyMm) {
        sentMm = Vec3(target.positionMm);
        heldNow = turn;
    }
    mailbox->write(target);
}

Vec2 PointerController::State::slowed(const Vec2& pixel, double paceNow) {
    if (paceNow != pace) {
        slowFromPixel = lastPixel.value_or(pixel);
        slowFromLag = lagPixels;
    }
    pace = paceNow;
    lastPixel = pixel;
    if (pace < 1.0) lagPixels = slowFromLag + (1.0 - pace) * (pixel - slowFromPixel);
    return pixel - lagPixels;
}

/// As the tip has gone, the handpiece turns about the finger's rest.
bool PointerController::State::swing(const Vec3& fromMm) {
    if (!restMm) return false;
    const Vec3 before = fromMm - *restMm, after = tipMm - *restMm;
    if (before.norm() < kLeastLeverMm || after.norm() < kLeastLeverMm) return false;
    const Quat turn = core::rotationBetween(before, after);
    own = normalised(turn * own);
    orientation = normalised(turn * orientation);
    return true;
}

LineOfSight PointerController::State::sightThrough(const Vec2& pixel) const {
    const view::Ray ray = view::rayThrough(camera, viewport, pixel);
    if (feel) return leading().alongRay(ray, kHoverMm, farMm());
    LineOfSight nothing;
    nothing.ray = ray;
    return nothing;
}

/// Takes the handpiece so that it is clear where that line leads; true when that is another way than before.
bool PointerController::State::hold(const view::Ray& ray) {
    // What was looked for in vain is not looked for again until the pointer has gone on.
    if (unreached && (unreached->originMm - ray.originMm).norm() < kNearMm &&
        (unreached->direction - ray.direction).norm() < kSameSight) {
        noReach = true;
        return false;
    }
    unreached.reset();
    noReach = false;
    if (!feel) return false;
    const std::optional<Quat> found = holdAt(*feel, ray, {own, orientation, isOwn, kHoverMm, farMm()});
    noReach = !found;
    if (noReach) unreached = ray;
    if (!found || core::angleBetween(*found, orientation) < kSameTurnRad) return false;
    if (!presses() || !touching) orientation = *found;  // else out first
    return true;
}

void PointerController::State::aim(const Vec2& pixel) {
    const bool isInside = presses() && touching;
    const bool turns = hold(view::rayThrough(camera, viewport, pixel));
    if (isInside && (turns || noReach)) return lift();  // afterwards it is aimed again
    sight = sightThrough(pixel);
    endHereMm = 1e9;
    if (pressed && sight->touchAt) {
        if (!stroke) stroke = sight->what;
        leading().findEnd(*sight, limits);
    }
    if (sight->hoverAt) {
        tipMm = sight->at(*sight->hoverAt);
    } else {
        // Beside the teeth: in the view plane through the last place.
        const Vec3 forward = camera.forward();
        const double across = sight->ray.direction.dot(forward);
        if (across > 1e-3) tipMm = sight->at((tipMm - sight->ray.originMm).dot(forward) / across);
    }
    if (!lifting && !(presses() && touching)) travel();
}

/// Whether the instrument has to be lifted over something on its way, and where it goes next. Lifted it is taken out of
/// the mouth and brought in again: it meets nothing.
void PointerController::State::travel() {
    const bool lifted = std::exchange(travelling, false) && regrips;
    if (!feel || noReach) return;
    const core::Pose here{place(), heldNow}, there{tipMm, orientation};
    const bool isNear =
        (here.positionMm - tipMm).norm() < kThereMm && core::angleBetween(heldNow, orientation) < kTurnedRad;
    // Once taken out it comes in where it is to be, turned as it is to be.
    const bool turnsLittle = core::angleBetween(heldNow, orientation) < kLittleTurnRad;
    if (isNear || (!lifted && turnsLittle && isWayFree(*feel, here, there))) {
        travelling = pressed && (here.positionMm - tipMm).norm() > kStraightMm;
        onWayMm = tipMm;
        onWay = orientation;
        regrips = false;
        return;
    }
    const core::Pose next = nextOnWayOver(*feel, here, there, -camera.forward());
    onWayMm = next.positionMm;
    onWay = next.orientation;
    travelling = regrips = true;
}

/// A pressed bur follows the pointer; over an edge, and off what the stroke is on, it is lifted.
void PointerController::State::lead(const Vec2& from, const Vec2& to) {
    const int parts = std::clamp(static_cast<int>(std::ceil((to - from).norm() / kJumpPixels)), 1, 32);
    // Not a number where nothing has been met: no place is nearer than that, and none farther.
    constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
    double before = sight ? sight->touchAt.value_or(kNowhere) : kNowhere;
    bool leaves = false;
    if (presses() && touching) {
        for (int i = 1; i <= parts && !leaves; ++i) {
            const LineOfSight next = sightThrough(from + (static_cast<double>(i) / parts) * (to - from));
            leaves = !next.touchAt || (stroke && next.what != *stroke) || *next.touchAt < before - kJumpMm ||
                     *next.touchAt > before + kDropMm;
            before = next.touchAt.value_or(kNowhere);
        }
    }
    if (leaves) return lift();
    aim(to);
}

/// Out of the tooth by the shorter way, and half a millimetre off it.
void PointerController::State::lift() {
    const Vec3 from = place(), back = sight ? Vec3(-sight->ray.direction) : axis();
    const double alongBur = feel ? leading().wayOutMm(from, axis(), kHoverMm) : 0.0;
    const double towardsEye = feel ? leading().wayOutMm(from, back, kHoverMm) : 0.0;
    outWay = alongBur <= towardsEye ? axis() : back;
    outMm = from + std::min(alongBur, towardsEye) * outWay;
    lifting = true;
    liftsTurning = turning && clearMm(from) < 0.0;
    liftedS = nowS;
    triesAgain = false;
}

/// After a lift: where the pointer is by now.
void PointerController::State::goOn() {
    lifting = false;
    tipMm = outMm;
    if (lastPixel && (pressed || sight)) aim(*lastPixel - lagPixels);
}

/// A bur that tissue holds back beside the pointer's line of sight is no deeper than it may be where it is.
void PointerController::State::holdBack() {
    endHereMm = 1e9;
    if (!presses()) return;
    const Vec3 from = place() - sight->ray.originMm;
    if ((from - sight->ray.direction * sight->ray.direction.dot(from)).norm() < 0.5 * kThereMm) return;
    const std::optional<Vec2> pixel = view::pixelOf(camera, viewport, place());
    if (!pixel) return;
    LineOfSight here = sightThrough(*pixel);
    if (!here.touchAt) return;
    leading().findEnd(here, limits);
    endHereMm = (here.at(here.endAt) - sight->ray.originMm).dot(sight->ray.direction);
}

void PointerController::State::turnAxisTo(const Vec3& direction) {
    turnTo(normalised(core::rotationBetween(axis(), direction) * orientation));
}

/// By the student; not into teeth or gingiva with the handpiece, where there is a place to look from.
void PointerController::State::turnTo(const Quat& to) {
    unreached.reset();
    own = to;
    if (feel && feel->ofBodyMm({place(), to}) < std::min(-kTouchedMm, feel->ofBodyMm({place(), orientation}))) return;
    orientation = onWay = to;
}

/// With another tilt, where the pointer is.
void PointerController::State::aimAgain() {
    if (lastPixel && sight && !lifting && !pressed) aim(*lastPixel - lagPixels);
    send();
}

void PointerController::State::limitsChanged() {
    if (feel && sight && sight->touchAt) leading().findEnd(*sight, limits);
    holdBack();
    send();
}

PointerController::PointerController(std::shared_ptr<device::PointerMailbox> mailbox, const core::Pose& start,
                                     Cast cast)
    : state_(std::make_shared<State>()) {
    if (mailbox == nullptr || !cast || !start.isValid())
        throw core::Error("a pointer's hand needs a mailbox, a tooth and a place to begin", "pointer hand");
    state_->mailbox = std::move(mailbox);
    state_->cast = std::move(cast);
    state_->tipMm = state_->sentMm = start.positionMm;
    state_->heldNow = start.orientation;
    state_->own = state_->orientation = start.orientation;
    state_->send();
}

void PointerController::setFeel(std::shared_ptr<HandFeel> feel) {
    state_->feel = std::move(feel);
}

void PointerController::setEye(const view::Camera& camera, const view::Viewport& viewport) {
    State& s = *state_;
    const bool same = camera.eyeMm == s.camera.eyeMm && camera.targetMm == s.camera.targetMm &&
                      camera.up == s.camera.up && camera.fieldOfViewRad == s.camera.fieldOfViewRad &&
                      viewport.width == s.viewport.width && viewport.height == s.viewport.height;
    if (same) return;
    if (s.pressed && !s.frozen) {
        // The pointer is over something else by then: the stroke is over.
        const auto before = view::pixelOf(s.camera, s.viewport, s.place()),
                   now = view::pixelOf(camera, viewport, s.place());
        if (!before || !now || (*now - *before).norm() > kEyeJumpPixels) release();
    }
    s.camera = camera;
    s.viewport = viewport;
    s.rebase = s.pressed;
    s.unreached.reset();
}

void PointerController::follow(const messages::HapticSample& sample) {
    const Vec3 p(sample.proxyPositionMm[0], sample.proxyPositionMm[1], sample.proxyPositionMm[2]);
    if (!p.allFinite() || sample.tick == 0) return;  // nothing told yet
    State& s = *state_;
    const auto& q = sample.proxyOrientation;
    const Quat turn(q[0], q[1], q[2], q[3]);
    if (std::abs(turn.squaredNorm() - 1.0) < 0.1) s.heldNow = turn.normalized();
    s.touching = sample.depthMm > 0.0;
    s.stalled = (sample.flags & messages::kStalled) != 0;
    const bool regripped = (sample.buttons & device::kRegripsButton) != 0;
    s.waits = (sample.flags & (messages::kWaiting | messages::kRestoring)) != 0 && !regripped && !s.travelling;
    double removed = 0.0;
    for (const double v : sample.removedMm3)
        removed += v;
    const bool cuts = removed > std::exchange(s.removedMm3, removed);
    if (const double dtS = sample.timeS - s.nowS; dtS > 0.0)
        s.mmS += ((p - s.place()).norm() / dtS - s.mmS) * (1.0 - core::exp(-dtS / kSpeedS));
    s.proxyMm = p;
    s.nowS = sample.timeS;
    const bool isLittle = device::kPaintMm2SPerN * s.loadN < kLittleMm * s.mmS;
    if (!isLittle || !s.presses() || s.hurriesFromS > s.nowS) s.hurriesFromS = s.nowS;
    if (!s.pressed || cuts || s.idleFromS > s.nowS) s.idleFromS = s.nowS;
    if (s.frozen || s.away) return;
    // A tooth that was put back holds no bur that stands in it: out first.
    if (s.waits && s.pressed && !s.lifting) s.lift();
    if (s.lifting) {
        const double sinceS = s.nowS - s.liftedS;
        if ((p - s.outMm).norm() < kThereMm) {
            s.goOn();
        } else if (sinceS > 2.0 * kWayOutS) {
            s.goOn();
        } else if (sinceS > kWayOutS && s.sight && s.feel && !std::exchange(s.triesAgain, true)) {
            s.outWay = -s.sight->ray.direction;
            s.outMm = p + s.leading().wayOutMm(p, s.outWay, kHoverMm) * s.outWay;
        }
    } else if (s.travelling) {
        if (s.lastPixel && s.sight)
            s.aim(*s.lastPixel - s.lagPixels);
        else
            s.travel();
    }
    s.holdBack();
    s.send();
}

void PointerController::move(const Vec2& pixel, bool slow) {
    State& s = *state_;
    if (!pixel.allFinite()) return;
    s.away = false;
    if (s.frozen) {
        s.lastPixel = pixel;
        s.rebase = s.pressed;
        s.send();
        return;
    }
    if (!s.pressed && !slow && !s.restMm) s.lagPixels.setZero();
    const Vec2 from = s.lastPixel.value_or(pixel) - s.lagPixels;
    const Vec3 tipBefore = s.tipMm;
    Vec2 at = s.slowed(pixel, slow ? kSlowFactor : s.restMm ? kRestFactor : 1.0);
    if (std::exchange(s.rebase, false)) {
        // The eye has moved: from where the bur is now.
        if (const std::optional<Vec2> there = view::pixelOf(s.camera, s.viewport, s.place())) {
            s.lagPixels += at - *there;
            s.slowFromPixel = pixel;
            s.slowFromLag = s.lagPixels;
            at = *there;
        }
        s.aim(at);
    } else if (!s.lifting) {
        if (s.pressed)
            s.lead(from, at);
        else
            s.aim(at);
    } else if (!s.sight) {
        s.sight.emplace();
    }
    if (s.swing(tipBefore) && !s.lifting) s.aim(at);
    s.send();
}

void PointerController::press(const Vec2& pixel, bool turning) {
    State& s = *state_;
    s.turning = turning;
    if (!s.pressed) {
        s.idleFromS = s.nowS;
        s.pressed = true;
        s.stroke.reset();
        if (s.feel) s.feel->beginStroke();
        if (std::exchange(s.away, false)) {
            if (pixel.allFinite()) s.aim(pixel);
        } else if (pixel.allFinite() && !s.lifting) {
            // Where the bur is, or is on its way to: nothing jumps.
            Vec2 at = s.slowed(pixel, s.pace);
            if (const std::optional<Vec2> there = view::pixelOf(s.camera, s.viewport, s.tipMm))
                if ((*there - at).norm() > 0.5) {
                    s.lagPixels += at - *there;
                    at = *there;
                }
            s.travelling = s.proxyMm && (*s.proxyMm - s.tipMm).norm() > kStraightMm;
            s.aim(at);
        }
        if (pixel.allFinite()) s.lastPixel = pixel;
    }
    s.send();
}

void PointerController::release() {
    State& s = *state_;
    if (!s.pressed) return;
    const bool wasDown = s.presses();
    s.pressed = false;
    s.stroke.reset();
    if (wasDown) {
        s.lift();
        if (s.clearMm(s.place()) > -kHoverMm && !s.liftsTurning) {
            s.tipMm = s.outMm;
            s.lifting = false;
        }
    }
    s.send();
}

void PointerController::latchPedal(bool down) {
    state_->latched = down;
    state_->send();
}

void PointerController::nudge(double rightMm, double upMm, double advanceMm) {
    State& s = *state_;
    if (!std::isfinite(rightMm + upMm + advanceMm)) return;
    s.away = false;
    if (s.pressed) {
        if (s.lastPixel) {
            // How deep it is the load decides.
            const double perPixel = view::mmPerPixel(s.camera, s.viewport, s.place());
            const Vec2 from = *s.lastPixel - s.lagPixels;
            s.lagPixels -= Vec2(rightMm, -upMm) / perPixel;
            if (!s.lifting) s.lead(from, *s.lastPixel - s.lagPixels);
        }
        s.send();
        return;
    }
    s.lifting = s.travelling = false;
    s.sight.reset();
    s.tipMm += rightMm * s.camera.right() + upMm * s.camera.upward() - advanceMm * s.axis();
    if (s.touching && s.proxyMm) {
        // Into the tooth no farther than a light touch, or the way back would be long.
        const Vec3 ahead = s.tipMm - *s.proxyMm;
        if (ahead.norm() > kMaxNudgeMm) s.tipMm = *s.proxyMm + kMaxNudgeMm * ahead.normalized();
    }
    s.send();
}

void PointerController::pivot(const Vec2& pixels) {
    State& s = *state_;
    if (!pixels.allFinite() || pixels.isZero()) return;
    s.away = false;
    const Vec3 towards = pixels.x() * s.camera.right() + pixels.y() * s.camera.upward();
    const Vec3 turn = s.axis().cross(towards) * kPivotRadPerPixel;
    const double angle = turn.norm();
    if (angle > 1e-9) s.turnTo(normalised(core::rotationAbout(turn / angle, angle) * s.orientation));
    s.isOwn = true;
    s.send();
}

void PointerController::roll(double radians) {
    State& s = *state_;
    if (!std::isfinite(radians)) return;
    s.turnTo(normalised(s.orientation * core::rotationAbout(Vec3::UnitZ(), radians)));
    s.send();
}

void PointerController::alignToNormal() {
    State& s = *state_;
    std::optional<measure::Hit> surface;
    if (s.sight && s.sight->hoverAt) surface = s.cast(s.sight->ray);
    if (!surface) surface = s.cast({s.place() + kHoverMm * s.axis(), -s.axis()});
    if (!surface) return;
    s.turnAxisTo(surface->normal);
    s.isOwn = true;
    s.send();
}

void PointerController::alignToTooth() {
    state_->turnAxisTo(Vec3::UnitZ());
    state_->isOwn = false;
    state_->send();
}

void PointerController::faceEye() {
    State& s = *state_;
    const Vec3 towards = -s.camera.forward();
    const Vec3 to = std::abs(towards.y()) > kSeenFromSide ? towards : Vec3(Vec3::UnitZ());
    s.own = normalised(core::rotationBetween(s.own * Vec3::UnitZ(), to) * s.own);
    s.unreached.reset();
    s.isOwn = false;
    if (!s.feel) s.orientation = s.own;
    s.aimAgain();
}

void PointerController::turnHandle(const Vec3& toHand) {
    State& s = *state_;
    if (!toHand.allFinite()) return;
    s.turnTo(handleTowards(s.orientation, toHand));
    s.send();
}

void PointerController::setRest(std::optional<Vec3> pointMm) {
    if (pointMm && !pointMm->allFinite()) return;
    state_->restMm = pointMm;
}

void PointerController::setLoad(double loadN) {
    if (!std::isfinite(loadN)) return;
    state_->loadN = std::clamp(loadN, kMinLoadN, kMaxLoadN);
    state_->send();
}

void PointerController::setStop(std::optional<double> depthMm) {
    if (depthMm && !std::isfinite(*depthMm)) return;
    State& s = *state_;
    s.limits.stopMm = depthMm ? std::optional(std::clamp(*depthMm, 0.0, kReachMm)) : depthMm;
    s.limitsChanged();
}

void PointerController::setPerPass(std::optional<double> depthMm) {
    if (depthMm && !std::isfinite(*depthMm)) return;
    State& s = *state_;
    s.limits.perPassMm = depthMm ? std::optional(std::clamp(*depthMm, kMinPerPassMm, kMaxPerPassMm)) : depthMm;
    s.limitsChanged();
}

void PointerController::freeze(bool frozen) {
    state_->frozen = frozen;
    state_->rebase = state_->pressed;
    state_->send();
}

void PointerController::escape() {
    State& s = *state_;
    s.pressed = s.lifting = s.travelling = s.noReach = false;
    s.stroke.reset();
    s.latched = s.turning = s.frozen = s.rebase = false;
    s.away = true;
    s.tipMm = s.place();
    s.sight.reset();
    s.send();
}

PointerController::Idle PointerController::idle() const noexcept {
    const State& s = *state_;
    if (!s.pressed || !s.turning || s.frozen || s.away) return Idle::no;
    if (s.noReach) return Idle::noReach;
    if (s.lifting || s.travelling) return Idle::onItsWay;
    if (!s.sight || !s.sight->touchAt) return Idle::offTooth;
    if (!s.isOnStroke()) return Idle::offStroke;
    if (s.isPatienceOver()) {
        if (s.stalled) return Idle::stalled;
        const double end = std::min(s.sight->endAt, s.endHereMm);
        if ((s.place() - s.sight->ray.originMm).dot(s.sight->ray.direction) > end - kThereMm)
            return s.sight->end == LineOfSight::End::atStop     ? Idle::atStop
                   : s.sight->end == LineOfSight::End::passDone ? Idle::passDone
                                                                : Idle::through;
        if (s.touching && !s.hurries()) return Idle::held;
    }
    if (s.hurries()) return Idle::hurries;
    return s.touching ? Idle::no : Idle::onItsWay;
}
bool PointerController::isIdleForLong() const noexcept {
    const Idle why = idle();
    return why == Idle::hurries || (why != Idle::no && state_->isPatienceOver());
}
double PointerController::loadN() const noexcept {
    return state_->loadN;
}
std::optional<double> PointerController::stopMm() const noexcept {
    return state_->limits.stopMm;
}
std::optional<double> PointerController::perPassMm() const noexcept {
    return state_->limits.perPassMm;
}
bool PointerController::isPressed() const noexcept {
    return state_->pressed;
}
bool PointerController::pedalLatched() const noexcept {
    return state_->latched;
}
bool PointerController::isOnItsWay() const noexcept {
    return state_->lifting || state_->travelling;
}
bool PointerController::isAway() const noexcept {
    return state_->away;
}
Quat PointerController::tilt() const noexcept {
    return state_->own;
}
std::optional<Vec3> PointerController::rest() const noexcept {
    return state_->restMm;
}
const device::PointerTarget& PointerController::target() const noexcept {
    return state_->target;
}

}  // namespace handpiece::input
