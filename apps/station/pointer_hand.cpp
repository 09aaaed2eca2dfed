// SPDX-License-Identifier: Apache-2.0
#include "station/pointer_hand.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "handpiece/base/core/error.h"

namespace handpiece::station {
namespace {

using core::Quat;
using core::Vec2;
using core::Vec3;

constexpr double kEdgeOn = 0.2;       // sine of the angle below which a plane is seen edge on
constexpr double kUnderTipMm = 3.0;   // a press lets the bur down to tooth within this under it, or to what was cut
constexpr double kStepDownMm = 1.0;   // and dragged on, to what was not cut
constexpr double kFallMm = 0.3;       // farther down than where the tooth held it, in free air
constexpr double kRestsMm = 0.2;      // nearer tooth under a bur that touches is what it rests on
constexpr double kHeldShare = 0.35;   // of the tooth's force: along the axis, more than friction of a wall beside it
constexpr double kOverTipMm = 0.3;    // a look down begins this far over the tip
constexpr double kReachMm = 10.0;     // a press goes no deeper, whatever gives way
constexpr double kMostDragMm = 30.0;  // a plane seen at a slant ends here
constexpr double kWallClearMm = 0.1;  // of the head from walls beside it
constexpr double kSteep = 0.35;       // cosine of normal and axis below which a surface is a wall
constexpr double kBelieveMm = 5.0;    // a proxy farther from the target than this is still on its way
constexpr double kMostNudgeMm = 0.5;  // into the tooth
constexpr double kPivotRadPerPixel = 0.005;
constexpr double kStartAboveMm = 6.0;
constexpr double kOutMm = 0.2;        // a withdrawn bur is as near to where it shall be
constexpr int kMostWithdrawing = 45;  // pictures, about 1.5 s: then it stays where it hangs

Quat normalised(const Quat& q) {
    return q.norm() > 1e-9 ? q.normalized() : Quat::Identity();
}

}  // namespace

core::Pose startPose(const core::Box& tooth, int fdiNumber, int buccalSign) {
    const bool front = fdiNumber > 0 && fdiNumber % 10 <= 3;
    const double buccal = buccalSign < 0 ? -1.0 : 1.0;
    // About the long axis, from mesial (+x, where the lips are for a back tooth) towards the cheek.
    const double turn = buccal * (front ? 0.5 : 1.0 / 9.0) * std::numbers::pi;
    core::Pose pose;
    pose.positionMm = {tooth.centre().x(), tooth.centre().y(), tooth.max.z() + kStartAboveMm};
    pose.orientation = Quat(Eigen::AngleAxisd(turn, Vec3::UnitZ()));
    return pose;
}

struct PointerHand::State {
    enum class Press { none, axial, wall, air };

    std::shared_ptr<device::PointerMailbox> mailbox;
    Cast cast;
    GoneOver goneOver;
    double pressMmPerN = 1.0;  // by which a target lies in a wall that it presses on
    view::Camera camera;
    view::Viewport viewport;
    device::PointerTarget target;

    Vec3 tipMm = Vec3::Zero();  // wanted
    Quat orientation = Quat::Identity();
    double headLengthMm = 4.0, headRadiusMm = 0.5;
    std::optional<Vec3> proxyMm;  // as last told
    bool touching = false;

    double loadN = kFirstLoadN;
    std::optional<double> stopMm;
    bool latched = false, frozen = false, away = false;
    std::optional<measure::Hit> hover;  // the surface it hovers over

    Press press = Press::none;
    bool turning = false, anchored = false;
    int withdrawing = 0;  // pictures that the bur may still take to come out of its cavity, turning
    Vec3 planeNormal = Vec3::UnitZ(), planePointMm = Vec3::Zero();  // frozen at the press
    Vec3 anchorMm = Vec3::Zero(), anchorTipMm = Vec3::Zero();       // what was under the pointer, where the tip was
    Vec3 surfaceMm = Vec3::Zero();                                  // once, over the tip at the press
    Vec3 intoWallMm = Vec3::Zero();                                 // by which the target lies in a wall
    // While it presses along the axis: whether there is tooth to press on; how far down that may be; at which height
    // the tooth last held the tip, beside where it is now.
    bool overTooth = true, wasHeld = false;
    std::optional<Vec3> floorMm;
    Vec3 restMm = Vec3::Zero();

    bool slow = false;
    std::optional<Vec2> lastPixel;  // as given
    Vec2 slowFromPixel = Vec2::Zero(), slowFromLag = Vec2::Zero();
    Vec2 lagPixels = Vec2::Zero();  // by which the bur stays behind the pointer

    [[nodiscard]] Vec3 axis() const { return orientation * Vec3::UnitZ(); }
    [[nodiscard]] bool pressed() const { return press != Press::none; }
    void send();
    [[nodiscard]] Vec2 slowed(const Vec2& pixel, bool slowNow);
    [[nodiscard]] std::optional<Vec3> onPlane(const Vec2& pixel, const Vec3& point, const Vec3& normal) const;
    void hoverAt(const Vec2& pixel);
    struct Push {
        Vec3 byMm;
        double mostMm;  ///< that any one wall asks for
    };
    [[nodiscard]] std::optional<Push> pushOfWalls(const Vec3& tip) const;
    void clearWalls();
    void drag(const Vec2& pixel);
    void anchor(const Vec2& pixel);
    [[nodiscard]] std::optional<measure::Hit> underTip(const Vec3& tip, double reachMm) const;
    [[nodiscard]] std::optional<double> wayDown(const Vec3& tip, double reachMm) const;
    void settle();
    [[nodiscard]] Vec3 place() const;
    void turnAxisTo(const Vec3& direction);
    void comeBack() { away = false; }
};

void PointerHand::State::send() {
    for (int k = 0; k < 3; ++k)
        target.positionMm[k] = tipMm[k];
    target.orientation[0] = orientation.w();
    for (int k = 0; k < 3; ++k)
        target.orientation[k + 1] = orientation.vec()[k];
    const bool cutting = (pressed() && turning) || withdrawing > 0;
    target.pedal = !away && (latched || cutting) ? 1.0 : 0.0;
    target.loadN = press == Press::axial && overTooth ? loadN : 0.0;
    target.hasStop = press == Press::axial;
    const Vec3 stop = surfaceMm - std::min(stopMm.value_or(kReachMm), kReachMm) * axis();
    for (int k = 0; k < 3; ++k)
        target.stopMm[k] = target.hasStop ? stop[k] : 0.0;
    target.fallMm = kFallMm;
    target.hasFloor = floorMm.has_value();
    for (int k = 0; k < 3; ++k)
        target.floorMm[k] = floorMm ? (*floorMm)[k] : 0.0;
    target.frozen = frozen;
    target.away = away;
    mailbox->write(target);
}

Vec2 PointerHand::State::slowed(const Vec2& pixel, bool slowNow) {
    if (slowNow && !slow) {
        slowFromPixel = lastPixel.value_or(pixel);
        slowFromLag = lagPixels;
    }
    slow = slowNow;
    lastPixel = pixel;
    if (slow) lagPixels = slowFromLag + (1.0 - kSlowFactor) * (pixel - slowFromPixel);
    return pixel - lagPixels;
}

/// Where the line of sight through a pixel meets a plane; none beside or behind the eye.
std::optional<Vec3> PointerHand::State::onPlane(const Vec2& pixel, const Vec3& point, const Vec3& normal) const {
    const view::Ray ray = view::rayThrough(camera, viewport, pixel);
    const double across = ray.direction.dot(normal);
    if (std::abs(across) < 1e-3) return {};
    const double at = (point - ray.originMm).dot(normal) / across;
    if (!(at > 0.0) || !std::isfinite(at)) return {};
    return Vec3(ray.originMm + at * ray.direction);
}

/// Tooth within reach under the tip, or round it: then the hit is met from within.
std::optional<measure::Hit> PointerHand::State::underTip(const Vec3& tip, double reachMm) const {
    const Vec3 down = -axis();
    std::optional<measure::Hit> hit = cast({tip - kOverTipMm * down, down});
    const bool fromWithin = hit && hit->normal.dot(down) > 0.0;
    if (hit && !fromWithin && hit->distanceMm > kOverTipMm + reachMm) hit.reset();
    return hit;
}

/// How far a bur with its tip at `tip` goes down along its axis until its round end meets tooth: within reach, or what
/// was cut before within kUnderTipMm. None over walls, nor where less than half of its end has tooth under it: pressed
/// on an edge it would slip off.
std::optional<double> PointerHand::State::wayDown(const Vec3& tip, double reachMm) const {
    struct Ring {
        double radius;  // share of the head's
        int around;
    };
    const Vec3 a = axis(), first = orientation * Vec3::UnitX(), second = orientation * Vec3::UnitY();
    std::optional<double> least;
    int looks = 0, met = 0;
    for (const Ring& ring : {Ring{0.0, 1}, Ring{0.5, 8}, Ring{0.85, 8}}) {
        const double r = ring.radius * headRadiusMm;
        const double rise = headRadiusMm - std::sqrt(headRadiusMm * headRadiusMm - r * r);
        for (int i = 0; i < ring.around; ++i) {
            ++looks;
            const double angle = 2.0 * std::numbers::pi * i / ring.around;
            const Vec3 end = tip + r * (std::cos(angle) * first + std::sin(angle) * second) + rise * a;
            const std::optional<measure::Hit> hit = cast({end + kOverTipMm * a, -a});
            if (!hit) continue;
            const double level = hit->normal.dot(a);
            // The picture's tooth is behind the felt one while that is cut: then the tip is within it.
            if (level < 0.0 && i == 0 && r == 0.0) return 0.0;
            const double way = hit->distanceMm - kOverTipMm;
            if (level < kSteep || way > (hit->cut ? std::max(reachMm, kUnderTipMm) : reachMm)) continue;
            least = std::min(way, least.value_or(way));
            ++met;
        }
    }
    if (2 * met < looks) least.reset();
    return least;
}

/// Whether the load acts, and how far down: only on tooth under the bur, where it is and where it is dragged to. Off
/// the edge the bur goes back to the height at which the tooth held it, instead of falling beside the tooth.
void PointerHand::State::settle() {
    if (press != Press::axial || frozen || away) return;
    const Vec3 a = axis();
    const auto levelled = [&](const Vec3& p) { return Vec3(p + a * a.dot(restMm - p)); };
    const Vec3 here = levelled(place());
    tipMm = levelled(tipMm);
    if (anchored) anchorTipMm = levelled(anchorTipMm);
    restMm = tipMm;
    const double reach = wasHeld ? kStepDownMm : kUnderTipMm;
    const std::optional<double> way = wayDown(here, reach);
    floorMm.reset();
    if (way) floorMm = here - (*way + kFallMm) * a;
    overTooth = way && wayDown(tipMm, reach);
}

/// Where the bur is, as far as that is known: its tip where it rests.
Vec3 PointerHand::State::place() const {
    return proxyMm && (*proxyMm - tipMm).norm() < kBelieveMm ? *proxyMm : tipMm;
}

void PointerHand::State::hoverAt(const Vec2& pixel) {
    const view::Ray ray = view::rayThrough(camera, viewport, pixel);
    hover = cast(ray);
    if (hover && hover->normal.dot(ray.direction) > 0.0) hover.reset();  // met from within
    if (!hover) {
        if (const std::optional<Vec3> p = onPlane(pixel, tipMm, camera.forward())) {
            tipMm = *p;
            clearWalls();
        }
        return;
    }
    // As far off as brings the head of a bur at this slant clear: its round end, or its upper end where the surface
    // looks away from the shank.
    const double slant = hover->normal.dot(axis());
    const double off = kHoverMm + headRadiusMm * (1.0 - std::max(0.0, slant)) + headLengthMm * std::max(0.0, -slant);
    tipMm = hover->pointMm + off * hover->normal;
    clearWalls();
}

/// How walls beside the head that are nearer than it is wide push a bur with its tip at `tip`; nothing when part of the
/// head is within the tooth.
std::optional<PointerHand::State::Push> PointerHand::State::pushOfWalls(const Vec3& tip) const {
    constexpr int kAround = 8;
    const double wanted = headRadiusMm + kWallClearMm;
    const Vec3 first = orientation * Vec3::UnitX(), second = orientation * Vec3::UnitY();
    const double top = headLengthMm - headRadiusMm;
    const std::array<double, 3> heights{headRadiusMm, 0.5 * headLengthMm, top};
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    double most = 0.0;
    for (std::size_t level = 0; level < (top > 1.5 * headRadiusMm ? heights.size() : 1); ++level) {
        const Vec3 centre = tip + heights[level] * axis();
        for (int i = 0; i < kAround; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / kAround;
            const Vec3 out = std::cos(angle) * first + std::sin(angle) * second;
            const std::optional<measure::Hit> wall = cast({centre, out});
            if (!wall) continue;
            if (wall->normal.dot(out) > 0.0) return {};
            if (wall->distanceMm >= wanted) continue;
            const Vec3 back = (wall->distanceMm - wanted) * out;
            // The strongest push each way along each axis: neighbours see the same wall.
            low = low.cwiseMin(back);
            high = high.cwiseMax(back);
            most = std::max(most, wanted - wall->distanceMm);
        }
    }
    return Push{low + high, most};
}

/// Clear of the walls beside it: in its own cavity the bur stands over the floor, over a fissure that is too narrow for
/// it higher up.
void PointerHand::State::clearWalls() {
    for (const double lift : {0.0, 0.3, 0.6, 1.2, 2.4, 4.8}) {
        Vec3 tip = tipMm + lift * axis();
        for (int pass = 0; pass < 3; ++pass) {
            const std::optional<Push> push = pushOfWalls(tip);
            if (!push) break;
            if (push->mostMm < kWallClearMm) {
                tipMm = tip;
                return;
            }
            tip += push->byMm;
        }
    }
}

void PointerHand::State::anchor(const Vec2& pixel) {
    anchored = true;
    anchorTipMm = tipMm;
    planeNormal = axis();
    if (std::abs(planeNormal.dot(camera.forward())) < kEdgeOn) planeNormal = -camera.forward();
    planePointMm = tipMm;
    const std::optional<Vec3> there = onPlane(pixel, planePointMm, planeNormal);
    anchorMm = there.value_or(tipMm);
}

void PointerHand::State::drag(const Vec2& pixel) {
    if (!anchored) anchor(pixel);
    const std::optional<Vec3> there = onPlane(pixel, planePointMm, planeNormal);
    if (!there) return;
    Vec3 way = *there - anchorMm;
    if (way.norm() > kMostDragMm) way *= kMostDragMm / way.norm();
    tipMm = anchorTipMm + way;
}

void PointerHand::State::turnAxisTo(const Vec3& direction) {
    orientation = normalised(Quat::FromTwoVectors(axis(), direction) * orientation);
}

PointerHand::PointerHand(std::shared_ptr<device::PointerMailbox> mailbox, const core::Pose& start, Cast cast,
                         const device::PointerHandSettings& settings)
    : state_(std::make_shared<State>()) {
    if (mailbox == nullptr || !cast || !start.isValid())
        throw core::Error("a pointer's hand needs a mailbox, a tooth and a place to begin", "pointer hand");
    state_->mailbox = std::move(mailbox);
    state_->cast = std::move(cast);
    // The hand's spring and the hardest tooth's one after the other.
    state_->pressMmPerN = 1.0 / settings.stiffnessNPerMm + 1.0 / device::pointerCapability().maxStiffnessNPerMm;
    state_->tipMm = start.positionMm;
    state_->orientation = start.orientation;
    state_->send();
}

void PointerHand::setGoneOver(GoneOver goneOver) {
    state_->goneOver = std::move(goneOver);
}

void PointerHand::setEye(const view::Camera& camera, const view::Viewport& viewport) {
    State& s = *state_;
    const bool same = camera.eyeMm == s.camera.eyeMm && camera.targetMm == s.camera.targetMm &&
                      camera.up == s.camera.up && camera.fieldOfViewRad == s.camera.fieldOfViewRad &&
                      viewport.width == s.viewport.width && viewport.height == s.viewport.height;
    if (same) return;
    s.camera = camera;
    s.viewport = viewport;
    s.anchored = false;
}

void PointerHand::follow(const messages::HapticSample& sample) {
    const Vec3 p(sample.proxyPositionMm[0], sample.proxyPositionMm[1], sample.proxyPositionMm[2]);
    if (!p.allFinite()) return;
    State& s = *state_;
    s.proxyMm = p;
    s.touching = sample.depthMm > 0.0;
    if (s.withdrawing > 0) {
        if ((p - s.tipMm).norm() < kOutMm)
            s.withdrawing = 0;
        else
            --s.withdrawing;
        s.send();
    }
    if (s.press != State::Press::axial || s.frozen || s.away) return;
    const Vec3 forceN(sample.forceN[0], sample.forceN[1], sample.forceN[2]);
    const bool isHeld = forceN.dot(s.axis()) > std::max(kHeldShare * forceN.norm(), 0.25 * s.loadN);
    if (s.touching && s.overTooth) {
        const std::optional<double> way = s.wayDown(p, kRestsMm);
        if ((way && *way < kRestsMm) || isHeld) {
            s.restMm = p;
            s.wasHeld = true;
        }
    }
    s.settle();
    s.send();
}

void PointerHand::setBur(double headLengthMm, double headRadiusMm) {
    if (headLengthMm > 0.0 && std::isfinite(headLengthMm)) state_->headLengthMm = headLengthMm;
    if (headRadiusMm > 0.0 && std::isfinite(headRadiusMm)) state_->headRadiusMm = headRadiusMm;
}

void PointerHand::move(const Vec2& pixel, bool slow) {
    State& s = *state_;
    if (!pixel.allFinite()) return;
    s.comeBack();
    if (!s.pressed() && !slow) s.lagPixels.setZero();
    const Vec2 at = s.slowed(pixel, slow);
    if (s.frozen) {
        s.anchored = false;
    } else if (s.withdrawing > 0) {
        // First out, the way it came in; the next move takes it along.
    } else if (!s.pressed()) {
        s.hoverAt(at);
    } else {
        s.drag(at);
        s.settle();
    }
    s.send();
}

void PointerHand::press(const Vec2& pixel, bool turning) {
    State& s = *state_;
    if (s.away) {
        s.comeBack();
        if (pixel.allFinite()) s.hoverAt(pixel);
    }
    if (s.pressed()) {
        s.turning = turning;
        s.send();
        return;
    }
    // It begins where the bur is, or where it is on its way to: nothing jumps.
    if (s.touching) s.tipMm = s.place();
    s.turning = turning;
    s.overTooth = true;
    s.wasHeld = s.touching;
    s.floorMm.reset();
    s.intoWallMm.setZero();
    const Vec3 a = s.axis();
    const std::optional<measure::Hit> under = s.underTip(s.tipMm, kUnderTipMm);
    const Vec3 level = s.hover ? Vec3(s.hover->normal - a * a.dot(s.hover->normal)) : Vec3(Vec3::Zero());
    if (s.hover && s.hover->normal.dot(a) < kSteep && level.norm() > kSteep) {
        s.press = State::Press::wall;
        s.intoWallMm = -(kHoverMm + s.loadN * s.pressMmPerN) * level.normalized();
    } else if (under || s.hover || s.touching) {
        s.press = State::Press::axial;
        const bool fromOutside = under && under->normal.dot(-a) < 0.0;
        s.surfaceMm = fromOutside ? under->pointMm : s.tipMm;
        if (s.goneOver) s.surfaceMm += s.goneOver(s.surfaceMm, s.axis()) * s.axis();
    } else {
        s.press = State::Press::air;
    }
    if (pixel.allFinite()) s.anchor(s.slowed(pixel, s.slow));
    s.tipMm += s.intoWallMm;
    s.restMm = s.anchorTipMm = s.tipMm;
    s.settle();
    s.send();
}

void PointerHand::release() {
    State& s = *state_;
    if (!s.pressed()) return;
    if (s.press != State::Press::air) {
        s.tipMm = s.place();
        if (s.press == State::Press::axial) {
            // A bur that stands still would hang in a cavity that is narrower above its widest place: as in a mouth it
            // is withdrawn turning.
            const double buriedMm = std::max(0.0, s.axis().dot(s.surfaceMm - s.tipMm));
            s.tipMm += (buriedMm + kHoverMm) * s.axis();
            if (s.turning && buriedMm > kHoverMm) s.withdrawing = kMostWithdrawing;
        } else if (s.hover) {
            s.tipMm += kHoverMm * s.hover->normal;
        }
    }
    s.press = State::Press::none;
    s.anchored = false;
    s.send();
}

void PointerHand::latchPedal(bool down) {
    state_->latched = down;
    state_->send();
}

void PointerHand::nudge(double rightMm, double upMm, double advanceMm) {
    State& s = *state_;
    if (!std::isfinite(rightMm + upMm + advanceMm)) return;
    s.comeBack();
    const Vec3 step = rightMm * s.camera.right() + upMm * s.camera.upward() - advanceMm * s.axis();
    s.hover.reset();
    s.tipMm += step;
    if (s.pressed()) {
        s.anchorTipMm += step;
        if (!s.overTooth) s.restMm += step;
        s.settle();
    } else if (s.touching && s.proxyMm && (*s.proxyMm - s.tipMm).norm() < kBelieveMm) {
        // Into the tooth no farther than a light touch, or the way back would be long.
        const Vec3 ahead = s.tipMm - *s.proxyMm;
        if (ahead.norm() > kMostNudgeMm) s.tipMm = *s.proxyMm + kMostNudgeMm * ahead.normalized();
    }
    s.send();
}

void PointerHand::pivot(const Vec2& pixels) {
    State& s = *state_;
    if (!pixels.allFinite() || pixels.isZero()) return;
    s.comeBack();
    const Vec3 towards = pixels.x() * s.camera.right() + pixels.y() * s.camera.upward();
    const Vec3 turn = s.axis().cross(towards) * kPivotRadPerPixel;
    const double angle = turn.norm();
    if (angle > 1e-9) s.orientation = normalised(Quat(Eigen::AngleAxisd(angle, turn / angle)) * s.orientation);
    s.send();
}

void PointerHand::roll(double radians) {
    State& s = *state_;
    if (!std::isfinite(radians)) return;
    s.orientation = normalised(s.orientation * Quat(Eigen::AngleAxisd(radians, Vec3::UnitZ())));
    s.send();
}

void PointerHand::alignToNormal() {
    State& s = *state_;
    std::optional<measure::Hit> surface = s.hover;
    if (!surface) surface = s.underTip(s.place(), kReachMm);
    if (!surface) return;
    s.turnAxisTo(surface->normal);
    s.send();
}

void PointerHand::alignToTooth() {
    state_->turnAxisTo(Vec3::UnitZ());
    state_->send();
}

void PointerHand::setLoad(double loadN) {
    State& s = *state_;
    if (!std::isfinite(loadN)) return;
    s.loadN = std::clamp(loadN, kLeastLoadN, kMostLoadN);
    if (s.press == State::Press::wall) {
        const Vec3 before = s.intoWallMm;
        s.intoWallMm = before.normalized() * (kHoverMm + s.loadN * s.pressMmPerN);
        s.tipMm += s.intoWallMm - before;
        s.anchorTipMm += s.intoWallMm - before;
    }
    s.send();
}

void PointerHand::setStop(std::optional<double> depthMm) {
    if (depthMm && !std::isfinite(*depthMm)) return;
    state_->stopMm = depthMm ? std::optional(std::clamp(*depthMm, 0.0, kReachMm)) : depthMm;
    state_->send();
}

void PointerHand::freeze(bool frozen) {
    state_->frozen = frozen;
    state_->anchored = false;
    state_->send();
}

void PointerHand::escape() {
    State& s = *state_;
    s.press = State::Press::none;
    s.withdrawing = 0;
    s.latched = s.turning = s.frozen = s.anchored = false;
    s.away = true;
    s.tipMm = s.place();
    s.hover.reset();
    s.send();
}

double PointerHand::loadN() const noexcept {
    return state_->loadN;
}
std::optional<double> PointerHand::stopMm() const noexcept {
    return state_->stopMm;
}
bool PointerHand::isPressed() const noexcept {
    return state_->pressed();
}
bool PointerHand::pedalLatched() const noexcept {
    return state_->latched;
}
bool PointerHand::isAway() const noexcept {
    return state_->away;
}
const device::PointerTarget& PointerHand::target() const noexcept {
    return state_->target;
}

}  // namespace handpiece::station
