// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/view_state.h"

#include <algorithm>
#include <utility>

#include "handpiece/app/simulation/mouth_feel.h"

namespace handpiece::desktop {
namespace {

constexpr int kWatchMs = 33;
constexpr int kUnderWriting = 46;  // pixels: the row in which the hand's state is written
// A point of the surface lies within the first of what is met along its line of sight; two in one place.
constexpr double kHiddenMm = 0.2, kSamePlaceMm = 0.05;
constexpr double kCrownShare = 0.42;  // of a tooth's height, as far as one sees it over the gum

using exercise::Operation;

}  // namespace

ViewWidget::State::State(ViewWidget* of) : widget(of) {
    look.scaleBar = true;
    const auto post = [of](auto&& call) { QMetaObject::invokeMethod(of, std::forward<decltype(call)>(call)); };
    RenderThread::Callbacks drawing;
    drawing.frameReady = [this, post] {
        if (!framePosted.exchange(true)) post([this] { takeFrame(); });
    };
    drawing.missing = [this, post](std::string what, std::string how) {
        post([this, what = QString::fromStdString(what), how = QString::fromStdString(how)] {
            problem = what;
            remedy = how;
            frame.reset();
            widget->update();
            emit widget->openGlMissing(problem, remedy);
        });
    };
    drawing.toothChanged = [this] { probe->toothChanged(); };
    ProbeThread::Callbacks measuring;
    measuring.section = [this](std::optional<view::SectionFace> face) {
        if (render) render->setSectionFace(std::move(face));
    };
    measuring.thinnest = [this, post](std::optional<measure::ToothProbe::Thinnest> found) {
        post([this, found] {
            thinnest.reset();
            if (found) {
                thinnest.emplace();
                thinnest->kind = Measurement::Kind::pulp;
                thinnest->fromMm = thinnest->toMm = found->pointMm;
                thinnest->valueMm = found->leftMm;
            }
            widget->update();
        });
    };
    probe = std::make_unique<ProbeThread>(std::move(measuring));
    watch.setInterval(kWatchMs);
    QObject::connect(&watch, &QTimer::timeout, of, [this] {
        if (hand && (hand->isPressed() || hand->isOnItsWay()) && followed.hasExpired(kWatchMs)) followHand();
    });
    followed.start();
    watch.start();
    render = std::make_unique<RenderThread>(std::move(drawing));
}

ViewWidget::State::~State() {
    probe->setTooth(nullptr);
    // The drawing thread calls the measuring one and the other way round: neither may outlive its friend's last call.
    render->finish();
    probe.reset();
}

view::Viewport ViewWidget::State::viewport() const {
    const int width = compare ? widget->width() / 2 : widget->width();
    return {std::max(1, width), std::max(1, widget->height())};
}

core::Vec2 ViewWidget::State::pixel(const QPointF& position) const {
    const double half = viewport().width;
    double x = position.x();
    if (compare && x >= half) x -= half;
    return {x, position.y()};
}

view::Camera ViewWidget::State::handsEye() const {
    view::Camera own = camera;
    own.mirrored = false;
    return own;
}

std::optional<measure::Hit> ViewWidget::State::hitAt(const QPointF& position) const {
    if (!tooth) return std::nullopt;
    const view::Ray ray = view::rayThrough(camera, viewport(), pixel(position));
    core::Vec3 from = ray.originMm;
    double farMm = 400.0;
    if (section) {  // what was cut off is not in the way
        const view::Plane plane = planeOf(*section);
        const double beyond = plane.normal.dot(from) - plane.offsetMm, closing = plane.normal.dot(ray.direction);
        if (beyond > 0.0) {
            if (closing > -1e-9) return std::nullopt;
            from += ray.direction * (beyond / -closing);
        } else if (closing > 1e-9) {
            farMm = -beyond / closing;
        }
    }
    return tooth->withProbe([&](const measure::ToothProbe& p) { return p.cast(from, ray.direction, farMm); });
}

bool ViewWidget::State::isHidden(const core::Vec3& pointMm) const {
    const auto at = view::pixelOf(camera, viewport(), pointMm);
    if (!at) return true;
    const auto hit = hitAt({at->x(), at->y()});
    return hit && (hit->pointMm - camera.eyeMm).norm() < (pointMm - camera.eyeMm).norm() - kHiddenMm;
}

/// Those that the tooth does not hide, and of two that tell the same at one place the one that is kept.
std::vector<Measurement> ViewWidget::State::measurementsSeen() const {
    std::vector<Measurement> seen;
    for (const Measurement& one : measurements) {
        const auto same = [&](const Measurement& other) {
            return other.kind == one.kind && (other.fromMm - one.fromMm).norm() < kSamePlaceMm &&
                   (other.toMm - one.toMm).norm() < kSamePlaceMm;
        };
        if (std::any_of(seen.begin(), seen.end(), same)) continue;
        if (isHidden(one.fromMm) && (one.kind != Measurement::Kind::distance || isHidden(one.toMm))) continue;
        seen.push_back(one);
    }
    return seen;
}

core::Vec3 ViewWidget::State::burAxis() const {
    const messages::HapticSample now = render->sample();
    return proxyPose(now).orientation * core::Vec3::UnitZ();
}

view::Look ViewWidget::State::effectiveLook() const {
    view::Look now = look;
    if (!allows(Operation::tissueColours)) now.palette = view::Palette::natural;
    if (!allows(Operation::transparency)) {
        now.tooth = view::ToothShown::now;
        now.visible.fill(true);
    }
    if (!allows(Operation::removedDepth)) now.removedDepthColours = false;
    if (!allows(Operation::section)) now.cutAway.reset();
    if (!allows(Operation::scaleBar)) now.scaleBar = false;
    if (section) now.sectionGrid = true;
    // Who measures has put the drill aside.
    if (tool != Tool::drill && tool != Tool::mirror) now.bur = now.turbine = false;
    return now;
}

std::optional<view::MirrorPose> ViewWidget::State::mirrorPose() const {
    if (!mirrorCentreMm || !tooth) return std::nullopt;
    view::MirrorPose pose;
    pose.centreMm = *mirrorCentreMm;
    // Held so that one sees the tooth in it: its normal halves the angle between eye and tooth.
    const core::Vec3 toEye = (camera.eyeMm - pose.centreMm).normalized();
    const core::Vec3 toTooth = (eyeBounds.centre() - pose.centreMm).normalized();
    const core::Vec3 half = toEye + toTooth;
    pose.normal = half.norm() > 1e-6 ? half.normalized() : camera.upward();
    const core::Vec3 out = pose.centreMm - eyeBounds.centre();
    core::Vec3 handle = out - pose.normal * pose.normal.dot(out);
    if (handle.norm() < 1e-6) handle = pose.normal.unitOrthogonal();
    pose.handle = handle.normalized();
    return pose;
}

void ViewWidget::State::wish() {
    RenderRequest renderRequest;
    renderRequest.camera = camera;
    renderRequest.size = widget->size().expandedTo({1, 1});
    renderRequest.pixelRatio = widget->devicePixelRatioF();
    renderRequest.look = effectiveLook();
    renderRequest.compare = compare;
    renderRequest.visible = widget->isVisible();
    renderRequest.mirror = mirrorPose();
    render->setRequest(renderRequest);
}

void ViewWidget::State::eyeMoved() {
    camera.mirrored = mirrorView;
    hideLandmarks();
    if (hand) hand->setEye(handsEye(), viewport());
    if (drag == Drag::press && hand && !hand->isPressed()) end();
    if (drag == Drag::none) hoverAgain();
    if (cross) read(*cross);
    wish();
    widget->update();
    emit widget->cameraChanged();
}

void ViewWidget::State::turnHalf() {
    if (compare) {
        wholeEye = camera;
        halfEye = camera = clearOfWriting(view::fitted(camera, eyeBounds, viewport()), viewport());
        return;
    }
    if (!wholeEye) return;
    // Untouched it goes back; else it looks as it does now, from as much nearer as it went away.
    if (camera.eyeMm == halfEye->eyeMm && camera.targetMm == halfEye->targetMm && camera.up == halfEye->up) {
        camera = *wholeEye;
    } else {
        const double nearer = wholeEye->distanceMm() / halfEye->distanceMm();
        camera.eyeMm = camera.targetMm - camera.forward() * (camera.distanceMm() * nearer);
    }
    wholeEye.reset();
}

void ViewWidget::State::hoverAgain() {
    if (!hand || !byMouse || !pointer || tool != Tool::drill || hand->isAway() || hand->isPressed()) return;
    followHand();
    hand->move(pixel(*pointer));
}

void ViewWidget::State::feelMouth() {
    if (hand) hand->setFeel(simulation::feelMouth(tooth, bur));
}

void ViewWidget::State::followHand() {
    followSample(render->sample());
}

void ViewWidget::State::followSample(const messages::HapticSample& sample) {
    if (!hand) return;
    hand->follow(sample);
    followed.restart();
}

void ViewWidget::State::takeFrame() {
    framePosted = false;
    std::optional<Frame> next = render->takeFrame();
    if (!next) return;
    frame = std::move(next);
    followSample(frame->sample);
    widget->update();
    emit widget->frameDrawn(frame->report);
}

/// Of the tooth that is looked at from now on.
void ViewWidget::State::take(const cases::Case& toothCase, const core::Box& of) {
    bounds = eyeBounds = of;
    const bool inGum = std::any_of(toothCase.scenery.begin(), toothCase.scenery.end(),
                                   [](const cases::Part& part) { return part.tissue == cases::Tissue::gum; });
    if (inGum) eyeBounds.min.z() = bounds.max.z() - kCrownShare * bounds.size().z();
    standing = view::standingOf(toothCase.fdiNumber, toothCase.buccalSign);
}

void ViewWidget::State::layOut() {
    sectionBar->setVisible(section.has_value() && sectionBarShown);
    if (section) sectionBar->setPlace(*section, bounds);
    sectionBar->adjustSize();
    sectionBar->move((widget->width() - sectionBar->width()) / 2, kUnderWriting);
    strips->setTop(sectionBar->isHidden() ? kUnderWriting : sectionBar->geometry().bottom() + 6);
}

/// Why a pressed bur does not cut.
static QString idleText(input::PointerController::Idle idle) {
    using Idle = input::PointerController::Idle;
    switch (idle) {
        case Idle::no:
            break;
        case Idle::offTooth:
            return ViewWidget::tr("No tooth under the pointer");
        case Idle::atStop:
            return ViewWidget::tr("At the depth stop");
        case Idle::passDone:
            return ViewWidget::tr("As deep as one pass goes: let go and press again to go deeper");
        case Idle::offStroke:
            return ViewWidget::tr("Off what this stroke began on: let go, and press here to work here");
        case Idle::noReach:
            return ViewWidget::tr("The handpiece cannot get there: turn the view, tilt it or take another bur");
        case Idle::through:
            return ViewWidget::tr("No deeper here: the bur would come out of the tooth");
        case Idle::onItsWay:
            return ViewWidget::tr("The bur is on its way");
        case Idle::stalled:
            return ViewWidget::tr("The bur is stalled: press less");
        case Idle::hurries:
            return ViewWidget::tr("So quickly it cuts next to nothing: go slower, or press more");
        case Idle::held:
            return ViewWidget::tr("The bur does not cut here: press more, or take another bur");
    }
    return {};
}

QString ViewWidget::State::hint() const {
    if (!allows(Operation::guidance)) return {};
    switch (tool) {
        case Tool::drill:
            if (hand && hand->isIdleForLong()) return idleText(hand->idle());
            if (!hand || everPressed) return {};
            return ViewWidget::tr("%1: cut   \u00b7   %2: turn the view   \u00b7   %3: all keys")
                .arg(bindings.text(Action::cut), bindings.text(Action::orbit), bindings.text(Action::help));
        case Tool::calliper:
            return (calliperStartMm ? ViewWidget::tr("Second point: click, or arrows and %1")
                                    : ViewWidget::tr("First point: click, or arrows and %1"))
                .arg(bindings.text(Action::cutKey));
        case Tool::depth:
            return ViewWidget::tr("Point at the cavity's floor; a click or %1 keeps the reading")
                .arg(bindings.text(Action::cutKey));
        case Tool::pulp:
            return ViewWidget::tr("Point at the cavity's floor; a click or %1 keeps the remaining dentine thickness")
                .arg(bindings.text(Action::cutKey));
        case Tool::section:
            return ViewWidget::tr("Drag, turn the wheel or use the arrow keys to move the section");
        case Tool::mirror:
            return ViewWidget::tr("Drag the mirror; the wheel moves it nearer or farther");
        case Tool::landmarks:
            return ViewWidget::tr("Drag a landmark over the tooth, or move the one chosen with the arrow keys");
    }
    return {};
}

OverlayState ViewWidget::State::overlay() const {
    OverlayState state;
    if (!problem.isEmpty()) {
        state.message = ViewWidget::tr("The picture cannot be drawn: %1").arg(problem);
        state.remedy = remedy;
        return state;
    }
    if (!tooth) {
        if (!isSketch) state.message = waiting.isEmpty() ? ViewWidget::tr("No tooth is open") : waiting;
        return state;
    }
    state.camera = frame ? frame->camera : camera;
    // What is written goes with the picture, which comes a while after it was asked for.
    state.compare = frame ? frame->compare : compare;
    state.tool = tool;
    state.covered = strips->covered();
    if (allows(Operation::tissueColours)) {
        std::vector<cases::Tissue> shown;
        for (const cases::Tissue tissue : tissues)
            if (look.visible[static_cast<std::size_t>(tissue)]) shown.push_back(tissue);
        state.legend = view::legendOf(shown, effectiveLook().palette);
    }
    state.scaleBar = effectiveLook().scaleBar;
    if (effectiveLook().removedDepthColours) state.removedDepthMostMm = look.removedDepthMostMm;
    if (hand) {
        state.hasHand = true;
        state.loadN = hand->loadN();
        state.stopMm = hand->stopMm();
        state.perPassMm = hand->perPassMm();
        state.pedalLatched = hand->pedalLatched();
        // The foot's, not the bur's: that comes out of its cavity turning after the button is up.
        state.pedalDown = hand->target().pedal > 0.0 && (hand->isPressed() || hand->pedalLatched());
        state.away = hand->isAway();
        state.pressed = hand->isPressed();
        if (frame) state.burTipMm = proxyPose(frame->sample).positionMm;
    }
    if (!state.pressed) state.measurements = measurementsSeen();
    state.calliperStartMm = calliperStartMm;
    state.pointerMm = pointerMm;
    const bool kept =
        reading && std::any_of(state.measurements.begin(), state.measurements.end(), [&](const auto& one) {
            return one.kind == reading->kind && (one.fromMm - reading->fromMm).norm() < kSamePlaceMm;
        });
    if (!kept) state.reading = reading;
    state.pointer = pointer;
    // Where the hand is on its way to is seen there.
    if (pointer && mirrorView && !compare && tool == Tool::drill) state.pointer->setX(viewport().width - pointer->x());
    state.restMm = hand ? hand->rest() : std::nullopt;
    state.mirrorView = mirrorView;
    state.cross = cross;
    if (thinnest && !isHidden(thinnest->fromMm)) state.thinnest = thinnest;
    state.pulpLimits = pulpLimits;
    if (!state.pressed) {
        state.landmarks = landmarks;
        state.markMm = markMm;
        state.markWords = markWords;
        // In a replay the tooth grows and goes about it.
        state.isMarkHidden = markMm && isHidden(*markMm);
    }
    if (tool == Tool::landmarks) state.grabbed = grabbed;
    state.section = section;
    state.bounds = bounds;
    state.hint = hint();
    return state;
}

}  // namespace handpiece::desktop
