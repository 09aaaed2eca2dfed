// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/input/pointer_controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "handpiece/app/input/working_position.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/tick/contact/field_method.h"

namespace handpiece::input {
namespace {

using core::Quat;
using core::Vec2;
using core::Vec3;

constexpr double kReachMm = 10.0;  // a press goes no deeper, whatever gives way
constexpr double kNearMm = 1e-3;   // a line of sight is followed to within this of the tooth
constexpr int kMaxLooks = 200;     // on the way there
constexpr double kStepMm = 0.3;    // in which the way through the tooth is looked at
constexpr double kJumpMm = 0.5;    // nearer by so much within kJumpPixels: another surface, in front of this one
constexpr double kJumpPixels = 4.0;
constexpr double kMaxNudgeMm = 0.5;  // into the tooth
constexpr double kPivotRadPerPixel = 0.005;
constexpr double kLeastLeverMm = 1.0;  // of a rest: nearer to the tip nothing turns about it
constexpr double kStartAboveMm = 6.0;
constexpr double kThereMm = 0.2;     // as near as that a bur has come to where it was to go
constexpr int kMaxPictures = 30;     // about a second: then another way out is tried
constexpr int kPatientPictures = 9;  // about 0.3 s without anything cut

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
    /// Where a line of sight leads the bur, in millimetres along it.
    struct Sight {
        view::Ray ray{Vec3::Zero(), -Vec3::UnitZ()};
        std::optional<double> hoverAt, touchAt;
        double endAt = 0.0;   // as deep as a press may go
        bool byStop = false;  // which the stop says
        [[nodiscard]] Vec3 at(double mm) const { return ray.originMm + mm * ray.direction; }
    };

    std::shared_ptr<device::PointerMailbox> mailbox;
    Cast cast;
    Feel feel;
    view::Camera camera;
    view::Viewport viewport;
    device::PointerTarget target;

    Vec3 tipMm = Vec3::Zero();  // wanted, of a bur that does not press
    Quat orientation = Quat::Identity();
    std::optional<Vec3> proxyMm;  // as last told
    bool touching = false;

    double loadN = kFirstLoadN;
    std::optional<double> stopMm;
    bool latched = false, frozen = false, away = false;

    bool pressed = false, turning = false;
    std::optional<Sight> sight;  // what the pointer leads it along
    double endHereMm = 1e9;      // along that, as deep as it may go where it is, held back beside it
    // On its way out of a cavity, or over an edge; then, when it is pressed, to where it is to be put down.
    bool lifting = false, liftsTurning = false, crossing = false;
    Vec3 outMm = Vec3::Zero(), outWay = Vec3::UnitZ();
    int pictures = 0;

    // Whether anything goes.
    double removedMm3 = 0.0;
    int idlePictures = 0;
    bool waits = false, stalled = false;

    bool rebase = false;
    double pace = 1.0;  // of the pointer's
    std::optional<Vec3> restMm;
    std::optional<Vec2> lastPixel;  // as given
    Vec2 slowFromPixel = Vec2::Zero(), slowFromLag = Vec2::Zero();
    Vec2 lagPixels = Vec2::Zero();  // by which the bur stays behind the pointer

    [[nodiscard]] Vec3 axis() const { return orientation * Vec3::UnitZ(); }
    [[nodiscard]] Vec3 place() const { return proxyMm.value_or(tipMm); }
    [[nodiscard]] bool presses() const { return pressed && !lifting && !crossing && sight && sight->touchAt; }
    void send();
    [[nodiscard]] Vec2 slowed(const Vec2& pixel, double paceNow);
    bool swing(const Vec3& fromMm);
    [[nodiscard]] double clearMm(const Vec3& tip) const;
    [[nodiscard]] std::optional<double> meet(const Sight& sight, double fromMm, double offMm) const;
    [[nodiscard]] double wayOut(const Vec3& tip, const Vec3& direction, double offMm) const;
    void findEnd(Sight& sight) const;
    [[nodiscard]] Sight sightThrough(const Vec2& pixel) const;
    void aim(const Vec2& pixel);
    void lead(const Vec2& from, const Vec2& to);
    void lift();
    void goOn();
    void holdBack();
    void turnAxisTo(const Vec3& direction);
};

void PointerController::State::send() {
    const Vec3 way = sight ? sight->ray.direction : Vec3(Vec3::Zero());
    target.farMm = target.loadN = 0.0;
    target.isLed = lifting;
    put(target.way, way);
    if (lifting) {
        put(target.positionMm, outMm);
        put(target.way, outWay);
        target.loadN = std::max(loadN, kFirstLoadN);
    } else if (presses()) {
        put(target.positionMm, sight->at(*sight->touchAt));
        target.farMm = std::min(sight->endAt, endHereMm) - *sight->touchAt;
        target.loadN = loadN;
    } else {
        put(target.positionMm, tipMm);
    }
    target.orientation[0] = orientation.w();
    for (int k = 0; k < 3; ++k)
        target.orientation[k + 1] = orientation.vec()[k];
    const bool cutting = (pressed && turning) || (lifting && liftsTurning);
    target.pedal = !away && (latched || cutting) ? 1.0 : 0.0;
    target.frozen = frozen;
    target.away = away;
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
    orientation = normalised(core::rotationBetween(before, after) * orientation);
    return true;
}

/// Of the whole bur, from the uncut tooth; negative in it. At least.
double PointerController::State::clearMm(const Vec3& tip) const {
    if (!feel) return kReachMm;
    core::Pose pose;
    pose.positionMm = tip;
    pose.orientation = orientation;
    return -feel(pose).depthMm;
}

/// Where the bur, led along a line of sight, comes as near to the uncut tooth as `offMm`.
std::optional<double> PointerController::State::meet(const Sight& s, double fromMm, double offMm) const {
    if (!feel) return {};
    const double farMm = camera.distanceMm() + 100.0;
    double at = fromMm;
    for (int i = 0; i < kMaxLooks && at < farMm; ++i) {
        const double left = clearMm(s.at(at)) - offMm;
        if (left < kNearMm) return at;
        at += left;
    }
    return {};
}

/// How far along a direction the bur must go to be so far clear of the uncut tooth.
double PointerController::State::wayOut(const Vec3& tip, const Vec3& direction, double offMm) const {
    double way = 0.0;
    for (int i = 0; i < kMaxLooks && way < 2.0 * kReachMm; ++i) {
        const double missing = offMm - clearMm(tip + way * direction);
        if (missing < kNearMm) break;
        way += std::max(missing, 5.0 * kNearMm);
    }
    return way;
}

/// As deep as the stop says. Without one no farther than to where the bur is deepest in the tooth: beyond it would come
/// out at the other side, or run down along a wall.
void PointerController::State::findEnd(Sight& s) const {
    const auto depthAt = [&](double way) { return -clearMm(s.at(*s.touchAt + way)); };
    s.byStop = stopMm.has_value();
    double end = 0.0;
    if (stopMm) {
        // Along the bur, as one measures; a bur that works with its side hardly comes out that way, and there the way
        // in counts.
        end = *stopMm;
        const double mostMm = 3.0 * *stopMm;
        for (int i = 0; i < 8 && end < mostMm && depthAt(end) > 0.0; ++i) {
            const double missing = *stopMm - wayOut(s.at(*s.touchAt + end), axis(), 0.0);
            if (missing < 5.0 * kNearMm) break;
            end = std::min(end + missing, mostMm);
        }
    } else {
        double deepest = 0.0;
        for (double way = 0.0; way <= kReachMm; way += kStepMm) {
            const double depth = depthAt(way);
            if (depth > deepest) {
                deepest = depth;
                end = way;
            } else if (depth < deepest - kStepMm) {
                break;
            }
        }
        end = std::min(end + kStepMm, kReachMm);
    }
    s.endAt = *s.touchAt + end;
}

PointerController::State::Sight PointerController::State::sightThrough(const Vec2& pixel) const {
    Sight s;
    s.ray = view::rayThrough(camera, viewport, pixel);
    s.hoverAt = meet(s, 0.0, kHoverMm);
    if (s.hoverAt) s.touchAt = meet(s, *s.hoverAt, 0.0);
    return s;
}

void PointerController::State::aim(const Vec2& pixel) {
    sight = sightThrough(pixel);
    endHereMm = 1e9;
    if (pressed && sight->touchAt) findEnd(*sight);
    if (sight->hoverAt) {
        tipMm = sight->at(*sight->hoverAt);
        return;
    }
    // Beside the tooth: in the view plane through the last place.
    const Vec3 forward = camera.forward();
    const double across = sight->ray.direction.dot(forward);
    if (across > 1e-3) tipMm = sight->at((tipMm - sight->ray.originMm).dot(forward) / across);
}

/// A pressed bur follows the pointer; over an edge it is lifted.
void PointerController::State::lead(const Vec2& from, const Vec2& to) {
    const int parts = std::clamp(static_cast<int>(std::ceil((to - from).norm() / kJumpPixels)), 1, 32);
    std::optional<double> before = sight ? sight->touchAt : std::nullopt;
    bool jumps = false;
    if (presses() && touching) {
        for (int i = 1; i <= parts && !jumps; ++i) {
            const Sight next = sightThrough(from + (static_cast<double>(i) / parts) * (to - from));
            jumps = before && next.touchAt && *next.touchAt < *before - kJumpMm;
            before = next.touchAt;
        }
    }
    if (jumps) lift();
    aim(to);
    if (jumps) crossing = true;
}

/// Out of the tooth by the shorter way, and half a millimetre off it.
void PointerController::State::lift() {
    const Vec3 from = place(), back = sight ? Vec3(-sight->ray.direction) : axis();
    const double alongBur = wayOut(from, axis(), kHoverMm), towardsEye = wayOut(from, back, kHoverMm);
    outWay = alongBur <= towardsEye ? axis() : back;
    outMm = from + std::min(alongBur, towardsEye) * outWay;
    lifting = true;
    liftsTurning = turning && clearMm(from) < 0.0;
    pictures = 0;
}

/// After a lift: where the pointer is by now.
void PointerController::State::goOn() {
    lifting = false;
    tipMm = outMm;
    pictures = 0;
    crossing = pressed;
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
    Sight here = sightThrough(*pixel);
    if (!here.touchAt) return;
    findEnd(here);
    endHereMm = (here.at(here.endAt) - sight->ray.originMm).dot(sight->ray.direction);
}

void PointerController::State::turnAxisTo(const Vec3& direction) {
    orientation = normalised(Quat::FromTwoVectors(axis(), direction) * orientation);
}

PointerController::PointerController(std::shared_ptr<device::PointerMailbox> mailbox, const core::Pose& start,
                                     Cast cast)
    : state_(std::make_shared<State>()) {
    if (mailbox == nullptr || !cast || !start.isValid())
        throw core::Error("a pointer's hand needs a mailbox, a tooth and a place to begin", "pointer hand");
    state_->mailbox = std::move(mailbox);
    state_->cast = std::move(cast);
    state_->tipMm = start.positionMm;
    state_->orientation = start.orientation;
    state_->send();
}

void PointerController::setFeel(Feel feel) {
    state_->feel = std::move(feel);
}

void PointerController::setEye(const view::Camera& camera, const view::Viewport& viewport) {
    State& s = *state_;
    const bool same = camera.eyeMm == s.camera.eyeMm && camera.targetMm == s.camera.targetMm &&
                      camera.up == s.camera.up && camera.fieldOfViewRad == s.camera.fieldOfViewRad &&
                      viewport.width == s.viewport.width && viewport.height == s.viewport.height;
    if (same) return;
    s.camera = camera;
    s.viewport = viewport;
    s.rebase = s.pressed;
}

void PointerController::follow(const messages::HapticSample& sample) {
    const Vec3 p(sample.proxyPositionMm[0], sample.proxyPositionMm[1], sample.proxyPositionMm[2]);
    if (!p.allFinite() || sample.tick == 0) return;  // nothing told yet
    State& s = *state_;
    s.proxyMm = p;
    s.touching = sample.depthMm > 0.0;
    s.stalled = (sample.flags & messages::kStalled) != 0;
    s.waits = (sample.flags & (messages::kWaiting | messages::kRestoring)) != 0;
    double removed = 0.0;
    for (const double v : sample.removedMm3)
        removed += v;
    const bool cuts = removed > std::exchange(s.removedMm3, removed);
    s.idlePictures = s.pressed && !cuts ? s.idlePictures + 1 : 0;
    if (s.frozen || s.away) return;
    // A tooth that was put back holds no bur that stands in it: out first.
    if (s.waits && s.pressed && !s.lifting) s.lift();
    if (s.lifting) {
        ++s.pictures;
        if ((p - s.outMm).norm() < kThereMm) {
            s.goOn();
        } else if (s.pictures == kMaxPictures && s.sight) {
            s.outWay = -s.sight->ray.direction;
            s.outMm = p + s.wayOut(p, s.outWay, kHoverMm) * s.outWay;
        } else if (s.pictures > 2 * kMaxPictures) {
            s.goOn();
        }
    } else if (s.crossing) {
        if (!s.pressed || ++s.pictures > kMaxPictures || (p - s.tipMm).norm() < kThereMm) s.crossing = false;
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
        s.idlePictures = 0;
        s.pressed = true;
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
            s.aim(at);
            s.crossing = s.proxyMm && (*s.proxyMm - s.tipMm).norm() > kHoverMm + kThereMm;
            s.pictures = 0;
        }
        if (pixel.allFinite()) s.lastPixel = pixel;
    }
    s.send();
}

void PointerController::release() {
    State& s = *state_;
    if (!s.pressed) return;
    const bool wasDown = s.presses();
    s.pressed = s.crossing = false;
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
    s.lifting = false;
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
    if (angle > 1e-9) s.orientation = normalised(core::rotationAbout(turn / angle, angle) * s.orientation);
    s.send();
}

void PointerController::roll(double radians) {
    State& s = *state_;
    if (!std::isfinite(radians)) return;
    s.orientation = normalised(s.orientation * core::rotationAbout(Vec3::UnitZ(), radians));
    s.send();
}

void PointerController::alignToNormal() {
    State& s = *state_;
    std::optional<measure::Hit> surface;
    if (s.sight && s.sight->hoverAt) surface = s.cast(s.sight->ray);
    if (!surface) surface = s.cast({s.place() + kHoverMm * s.axis(), -s.axis()});
    if (!surface) return;
    s.turnAxisTo(surface->normal);
    s.send();
}

void PointerController::alignToTooth() {
    state_->turnAxisTo(Vec3::UnitZ());
    state_->send();
}

void PointerController::turnHandle(const Vec3& toHand) {
    State& s = *state_;
    if (!toHand.allFinite()) return;
    s.orientation = handleTowards(s.orientation, toHand);
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
    s.stopMm = depthMm ? std::optional(std::clamp(*depthMm, 0.0, kReachMm)) : depthMm;
    if (s.sight && s.sight->touchAt) s.findEnd(*s.sight);
    s.holdBack();
    s.send();
}

void PointerController::freeze(bool frozen) {
    state_->frozen = frozen;
    state_->rebase = state_->pressed;
    state_->send();
}

void PointerController::escape() {
    State& s = *state_;
    s.pressed = s.lifting = s.crossing = false;
    s.latched = s.turning = s.frozen = s.rebase = false;
    s.away = true;
    s.tipMm = s.place();
    s.sight.reset();
    s.send();
}

PointerController::Idle PointerController::idle() const noexcept {
    const State& s = *state_;
    if (!s.pressed || !s.turning || s.frozen || s.away) return Idle::no;
    if (s.lifting || s.crossing) return Idle::onItsWay;
    if (!s.sight || !s.sight->touchAt) return Idle::offTooth;
    if (s.idlePictures >= kPatientPictures) {
        if (s.stalled) return Idle::stalled;
        const double end = std::min(s.sight->endAt, s.endHereMm);
        if ((s.place() - s.sight->ray.originMm).dot(s.sight->ray.direction) > end - kThereMm)
            return s.sight->byStop ? Idle::atStop : Idle::through;
        if (s.touching) return Idle::held;
    }
    return s.touching ? Idle::no : Idle::onItsWay;
}
bool PointerController::isIdleForLong() const noexcept {
    return idle() != Idle::no && state_->idlePictures >= kPatientPictures;
}
double PointerController::loadN() const noexcept {
    return state_->loadN;
}
std::optional<double> PointerController::stopMm() const noexcept {
    return state_->stopMm;
}
bool PointerController::isPressed() const noexcept {
    return state_->pressed;
}
bool PointerController::pedalLatched() const noexcept {
    return state_->latched;
}
bool PointerController::isAway() const noexcept {
    return state_->away;
}
std::optional<Vec3> PointerController::rest() const noexcept {
    return state_->restMm;
}
const device::PointerTarget& PointerController::target() const noexcept {
    return state_->target;
}

PointerController::Feel feelUncut(std::shared_ptr<const tooth::ToothModel> tooth,
                                  std::shared_ptr<const instrument::Bur> bur) {
    if (tooth == nullptr || bur == nullptr) return {};
    const std::shared_ptr<contact::Method> method = contact::makeFieldMethod(std::move(tooth), std::move(bur));
    return [method](const core::Pose& pose) { return method->depth(pose); };
}

}  // namespace handpiece::input
