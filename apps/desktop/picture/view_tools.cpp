// SPDX-License-Identifier: Apache-2.0
// The tools on the picture, and what of them is allowed.
#include <algorithm>
#include <cmath>
#include <utility>

#include "desktop/picture/view_state.h"

namespace handpiece::desktop {
namespace {

constexpr double kMirrorAcross = 0.3, kMirrorDown = 0.2;  // of the picture: where the mirror comes out

using exercise::Operation;

std::optional<Operation> operationOf(Tool tool) {
    switch (tool) {
        case Tool::calliper:
            return Operation::calliper;
        case Tool::depth:
            return Operation::depthTool;
        case Tool::pulp:
            return Operation::pulpTool;
        case Tool::section:
            return Operation::section;
        case Tool::mirror:
            return Operation::mirror;
        default:
            return std::nullopt;
    }
}

Operation operationOf(Measurement::Kind kind) {
    return kind == Measurement::Kind::distance ? Operation::calliper
           : kind == Measurement::Kind::depth  ? Operation::depthTool
                                               : Operation::pulpTool;
}

}  // namespace

void ViewWidget::setTool(Tool tool) {
    State& s = *state_;
    if (const auto needs = operationOf(tool); needs && s.tooth && !s.may(*needs)) tool = Tool::drill;
    if (tool != Tool::drill && !s.tooth) tool = Tool::drill;
    if (tool == s.tool) return;
    s.end();
    s.tool = tool;
    s.calliperStartMm.reset();
    s.pointerMm.reset();
    s.reading.reset();
    if (s.cross) s.pointer = s.cross = std::nullopt;
    // Where no mouse points, the keys do.
    if (s.measures() && !s.pointer) s.putCross({s.viewport().width / 2.0, s.viewport().height / 2.0});
    if (s.hand) s.hand->freeze(tool != Tool::drill);
    s.probe->wantThinnest(tool == Tool::pulp);
    if (tool == Tool::section && !s.section) setSection(s.lastSection);
    if (tool == Tool::mirror && !s.mirrorCentreMm) setMirrorShown(true);
    s.updateCursor();
    s.wish();
    update();
    emit toolChanged(tool);
}
Tool ViewWidget::tool() const {
    return state_->tool;
}

void ViewWidget::setCompare(bool compare) {
    State& s = *state_;
    if (compare && !s.may(Operation::compare)) compare = false;
    if (compare == s.compare) return;
    s.end();
    s.compare = compare;
    if (s.tooth) s.turnHalf();
    s.eyeMoved();
    emit compareChanged(compare);
}
bool ViewWidget::isComparing() const {
    return state_->compare;
}

void ViewWidget::setSection(std::optional<SectionPlace> place) {
    State& s = *state_;
    if (place && (!s.tooth || !s.may(Operation::section))) place.reset();
    if (place) {
        if (!std::exchange(s.sectionPlaced, true)) place->offsetMm = s.bounds.centre()[axisAcross(place->direction)];
        const int axis = axisAcross(place->direction);
        place->offsetMm = std::clamp(place->offsetMm, s.bounds.min[axis], s.bounds.max[axis]);
        if (!s.section || s.section->direction != place->direction) s.faceSection(*place);
        s.lastSection = *place;
    }
    if (place == s.section) return;
    s.section = place;
    if (!place) s.turnFromSection();
    s.probe->setPlane(place ? std::optional(planeOf(*place)) : std::nullopt);
    s.layOut();
    s.wish();
    update();
    if (!place && s.tool == Tool::section) setTool(Tool::drill);
    emit sectionChanged(place.has_value());
}
void ViewWidget::State::faceSection(SectionPlace& place) {
    constexpr double kSeen = 0.25, kTurned = 0.64;  // cosines of line of sight and the section's normal
    const core::Vec3 towards = -camera.forward();
    if (towards.dot(planeOf(place).normal) < 0.0) place.flipped = !place.flipped;
    const core::Vec3 normal = planeOf(place).normal;
    if (towards.dot(normal) > kSeen) return;
    if (!beforeSection) beforeSection = camera;
    const core::Vec3 along = (towards - normal * towards.dot(normal)).normalized();
    const double distanceMm = camera.distanceMm();
    camera.eyeMm = camera.targetMm + distanceMm * (kTurned * normal + std::sqrt(1.0 - kTurned * kTurned) * along);
    camera.up = standing.up();
    facingSection = camera;
    eyeMoved();
}

void ViewWidget::State::turnFromSection() {
    const auto before = std::exchange(beforeSection, std::nullopt), facing = std::exchange(facingSection, std::nullopt);
    if (!before || !facing || facing->eyeMm != camera.eyeMm || facing->targetMm != camera.targetMm) return;
    camera = *before;
    eyeMoved();
}

std::optional<SectionPlace> ViewWidget::section() const {
    return state_->section;
}

void ViewWidget::setMirrorShown(bool shown) {
    State& s = *state_;
    if (shown == s.mirrorCentreMm.has_value() || (shown && !s.tooth)) return;
    if (shown && !s.may(Operation::mirror)) {
        emit mirrorChanged(false);
        return;
    }
    s.mirrorCentreMm.reset();
    if (shown) {
        // Over the tooth's far side in the picture, where the handpiece is not: there it shows what one cannot see.
        const view::Viewport port = s.viewport();
        const bool hangs = s.camera.upward().z() < -0.1;  // the crown: what one cannot see of it is below
        const double down = hangs ? 1.0 - kMirrorDown : kMirrorDown;
        const view::Ray ray = view::rayThrough(s.camera, port, {kMirrorAcross * port.width, down * port.height});
        const core::Vec3 forward = s.camera.forward(), centre = s.eyeBounds.centre();
        const double behind = 0.25 * s.eyeBounds.size().dot(forward.cwiseAbs());
        const double depth = forward.dot(centre - s.camera.eyeMm) + behind;
        s.mirrorCentreMm = s.camera.eyeMm + ray.direction * (depth / ray.direction.dot(forward));
    }
    s.wish();
    update();
    if (!shown && s.tool == Tool::mirror) setTool(Tool::drill);
    emit mirrorChanged(shown);
}
bool ViewWidget::isMirrorShown() const {
    return state_->mirrorCentreMm.has_value();
}

void ViewWidget::clearMeasurements() {
    state_->measurements.clear();
    state_->calliperStartMm.reset();
    state_->reading.reset();
    update();
}

void ViewWidget::setLandmarks(std::vector<ShownLandmark> landmarks) {
    State& s = *state_;
    s.landmarks = std::move(landmarks);
    if (s.grabbed && (s.grabbed->landmark >= s.landmarks.size() ||
                      s.grabbed->point >= s.landmarks[s.grabbed->landmark].pointsMm.size()))
        s.grabbed.reset();
    s.hideLandmarks();
    update();
}
const std::vector<ShownLandmark>& ViewWidget::landmarks() const {
    return state_->landmarks;
}

void ViewWidget::setMark(std::optional<core::Vec3> placeMm, const QString& words) {
    state_->markMm = placeMm;
    state_->markWords = words;
    update();
}

void ViewWidget::grabLandmark(std::optional<LandmarkPoint> at) {
    state_->grabbed = at;
    update();
}

std::optional<LandmarkPoint> ViewWidget::grabbedLandmark() const {
    return state_->grabbed;
}

void ViewWidget::State::hideLandmarks() {
    for (ShownLandmark& one : landmarks) {
        one.hidden.assign(one.pointsMm.size(), false);
        if (one.isInside) continue;
        // A long line's points stand in for those beside them: each asks the tooth.
        constexpr std::size_t kMostAsked = 24;
        const std::size_t step = 1 + one.pointsMm.size() / kMostAsked;
        for (std::size_t i = 0; i < one.pointsMm.size(); i += step) {
            const bool isGone = isHidden(one.pointsMm[i]);
            for (std::size_t k = i; k < std::min(i + step, one.pointsMm.size()); ++k)
                one.hidden[k] = isGone;
        }
    }
}

std::optional<LandmarkPoint> ViewWidget::State::landmarkAt(const QPointF& position) const {
    constexpr double kReachPixels = 14.0;
    std::optional<LandmarkPoint> found;
    double least = kReachPixels;
    const core::Vec2 at = pixel(position);
    for (std::size_t i = 0; i < landmarks.size(); ++i)
        for (std::size_t k = 0; k < landmarks[i].pointsMm.size(); ++k) {
            if (k < landmarks[i].hidden.size() && landmarks[i].hidden[k]) continue;
            const auto seen = view::pixelOf(camera, viewport(), landmarks[i].pointsMm[k]);
            if (!seen || !((*seen - at).norm() < least)) continue;
            least = (*seen - at).norm();
            found = {i, k};
        }
    return found;
}

void ViewWidget::State::dragLandmark(const QPointF& to) {
    if (!grabbed || grabbed->landmark >= landmarks.size()) return;
    const ShownLandmark& one = landmarks[grabbed->landmark];
    if (!one.isInside) {
        if (const auto hit = hitAt(to)) emit widget->landmarkDragged(*grabbed, hit->pointMm);
        return;
    }
    const view::Ray ray = view::rayThrough(camera, viewport(), pixel(to));
    const double along = ray.direction.dot(camera.forward());
    const double depth = (one.pointsMm[grabbed->point] - ray.originMm).dot(camera.forward());
    if (along > 1e-6) emit widget->landmarkDragged(*grabbed, ray.originMm + ray.direction * (depth / along));
}

/// The one that is chosen, by the arrow keys.
bool ViewWidget::State::stepLandmark(Action action, bool slow) {
    constexpr double kPixels = 6.0, kFinePixels = 1.0;
    if (tool != Tool::landmarks || !grabbed || grabbed->landmark >= landmarks.size()) return false;
    const double step = slow ? kFinePixels : kPixels;
    QPointF by;
    if (action == Action::moveLeft) by = {-step, 0};
    if (action == Action::moveRight) by = {step, 0};
    if (action == Action::moveUp) by = {0, -step};
    if (action == Action::moveDown) by = {0, step};
    const auto at = view::pixelOf(camera, viewport(), landmarks[grabbed->landmark].pointsMm[grabbed->point]);
    if (by.isNull() || !at) return false;
    dragLandmark(QPointF(at->x(), at->y()) + by);
    emit widget->landmarkDropped();
    return true;
}

void ViewWidget::setPulpLimits(const measure::PulpLimits& limits) {
    state_->pulpLimits = limits;
    update();
}

void ViewWidget::setPermissions(const exercise::Permissions& permissions) {
    State& s = *state_;
    s.permissions = permissions;
    std::erase_if(s.measurements, [&s](const Measurement& one) { return !s.allows(operationOf(one.kind)); });
    if (const auto needs = operationOf(s.tool); needs && !s.allows(*needs)) setTool(Tool::drill);
    if (!s.allows(Operation::section)) setSection(std::nullopt);
    if (!s.allows(Operation::compare)) setCompare(false);
    if (!s.allows(Operation::mirror)) setMirrorShown(false);
    if (!s.allows(Operation::depthStop)) setStop(std::nullopt);
    s.wish();
    update();
}
const exercise::Permissions& ViewWidget::permissions() const {
    return state_->permissions;
}

bool ViewWidget::State::may(Operation operation) {
    if (permissions.locks(operation)) emit widget->refused(operation);
    return allows(operation);
}

}  // namespace handpiece::desktop
