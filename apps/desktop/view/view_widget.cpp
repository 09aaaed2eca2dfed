// SPDX-License-Identifier: Apache-2.0
#include "desktop/view/view_widget.h"

#include <QPaintEvent>
#include <QPainter>
#include <algorithm>
#include <utility>

#include "desktop/view/view_state.h"
#include "handpiece/base/core/error.h"

namespace handpiece::desktop {

namespace {

constexpr double kBurViewMm = 14.0;                       // the eye's distance when it goes to the bur
constexpr double kMirrorAcross = 0.3, kMirrorDown = 0.2;  // of the picture: where the mirror comes out
constexpr int kUnderWriting = 46;                         // pixels: the row in which the hand's state is written
// A point of the surface lies within the first of what is met along its line of sight; two in one place.
constexpr double kHiddenMm = 0.2, kSamePlaceMm = 0.05;
constexpr double kCrownShare = 0.42;  // of a tooth's height, as far as one sees it over the gum

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

std::vector<cases::Tissue> tissuesOf(const cases::Case& toothCase) {
    std::array<bool, cases::kTissueCount> there{};
    for (const cases::Part& part : toothCase.parts)
        there[static_cast<std::size_t>(part.tissue)] = true;
    for (const cases::Part& part : toothCase.scenery)
        there[static_cast<std::size_t>(part.tissue)] = true;
    if (toothCase.parts.empty()) there[static_cast<std::size_t>(cases::Tissue::enamel)] = true;
    std::vector<cases::Tissue> tissues;
    for (std::size_t i = 1; i < cases::kTissueCount; ++i)
        if (there[i]) tissues.push_back(static_cast<cases::Tissue>(i));
    return tissues;
}

}  // namespace

// ---- State ------------------------------------------------------------------------------------------------------

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
    if (hand) hand->setEye(camera, viewport());
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

void ViewWidget::State::feelUncut() {
    if (hand) hand->setFeel(tooth ? input::feelUncut(tooth->base().tooth, bur) : input::PointerController::Feel());
}

void ViewWidget::State::followHand() {
    if (hand) hand->follow(render->sample());
}

void ViewWidget::State::takeFrame() {
    framePosted = false;
    std::optional<Frame> next = render->takeFrame();
    if (!next) return;
    frame = std::move(next);
    if (hand) hand->follow(frame->sample);
    widget->update();
    emit widget->frameDrawn(frame->report);
}

/// Of the tooth that is looked at from now on.
void ViewWidget::State::take(const cases::Case& toothCase, const core::Box& of) {
    bounds = eyeBounds = of;
    const bool inGum = std::any_of(toothCase.scenery.begin(), toothCase.scenery.end(),
                                   [](const cases::Part& part) { return part.tissue == cases::Tissue::gum; });
    if (inGum) eyeBounds.min.z() = bounds.max.z() - kCrownShare * bounds.size().z();
    buccalSign = toothCase.buccalSign;
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
        case Idle::through:
            return ViewWidget::tr("No deeper here: the bur would come out of the tooth");
        case Idle::onItsWay:
            return ViewWidget::tr("The bur is on its way");
        case Idle::stalled:
            return ViewWidget::tr("The bur is stalled: press less");
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
            return ViewWidget::tr("Point at the cavity's floor; a click or %1 keeps what is left over the pulp")
                .arg(bindings.text(Action::cutKey));
        case Tool::section:
            return ViewWidget::tr("Drag, turn the wheel or use the arrow keys to move the section");
        case Tool::mirror:
            return ViewWidget::tr("Drag the mirror; the wheel moves it nearer or farther");
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
    state.compare = compare;
    state.tool = tool;
    if (legendShown && allows(Operation::tissueColours)) {
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
    state.cross = cross;
    if (thinnest && !isHidden(thinnest->fromMm)) state.thinnest = thinnest;
    state.pulpLimits = pulpLimits;
    state.section = section;
    state.bounds = bounds;
    state.hint = hint();
    return state;
}

// ---- The widget -------------------------------------------------------------------------------------------------

ViewWidget::ViewWidget(QWidget* parent) : QWidget(parent), state_(std::make_unique<State>(this)) {
    setObjectName("view");
    setAccessibleName(tr("Picture of the tooth"));
    setAccessibleDescription(tr("Mouse and keys move the bur; F1 shows them."));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setAttribute(Qt::WA_OpaquePaintEvent);
    state_->sectionBar = new SectionBar(this);
    state_->sectionBar->hide();
    state_->strips = new StripStack(this);
    state_->layOut();
    connect(state_->sectionBar, &SectionBar::placeChanged, this,
            [this](const SectionPlace& place) { setSection(place); });
    connect(state_->sectionBar, &SectionBar::closed, this, [this] { setSection(std::nullopt); });
    state_->updateCursor();
}

ViewWidget::~ViewWidget() = default;

void ViewWidget::setTooth(std::shared_ptr<simulation::LiveTooth> liveTooth, const cases::Case& toothCase,
                          std::shared_ptr<simulation::SampleFeed> feed) {
    clearTooth();
    State& s = *state_;
    s.tooth = std::move(liveTooth);
    s.take(toothCase, s.tooth->base().tooth->outer.bounds());
    s.tissues = tissuesOf(toothCase);
    s.render->setTooth(s.tooth, toothCase.parts, toothCase.scenery, std::move(feed));
    s.probe->setTooth(s.tooth);
    showStandardView(view::StandardView::oblique);
    s.layOut();
}

void ViewWidget::showSketch(const cases::Case& sketch) {
    clearTooth();
    State& s = *state_;
    core::Box bounds;
    std::vector<cases::Part> shown;
    for (const cases::Part& part : sketch.parts) {
        for (const core::Vec3& v : part.mesh.vertices)
            bounds.extend(v);
        // What lies within is not seen.
        if (part.tissue == cases::Tissue::enamel || part.tissue == cases::Tissue::dentine ||
            part.tissue == cases::Tissue::cementum || part.tissue == cases::Tissue::restoration)
            shown.push_back(part);
    }
    if (!sketch.outer.triangles.empty()) bounds = sketch.outer.bounds();
    if (shown.empty()) shown = {{"tooth", cases::Tissue::enamel, 0, sketch.outer}};
    if (shown.front().mesh.triangles.empty()) return;
    shown.insert(shown.end(), sketch.scenery.begin(), sketch.scenery.end());
    s.isSketch = true;
    s.take(sketch, bounds);
    s.render->setTooth(nullptr, {}, std::move(shown), nullptr);
    showStandardView(view::StandardView::oblique);
    s.layOut();
}

bool ViewWidget::hasSketch() const {
    return state_->isSketch;
}

void ViewWidget::setWaiting(const QString& forWhat) {
    state_->waiting = forWhat;
    update();
}

void ViewWidget::clearTooth() {
    State& s = *state_;
    s.isSketch = false;
    setPointer(nullptr, {});
    setSection(std::nullopt);
    setMirrorShown(false);
    setCompare(false);
    setTool(Tool::drill);
    clearMeasurements();
    s.thinnest.reset();
    s.sectionPlaced = false;
    s.frame.reset();
    s.tooth.reset();
    s.probe->setTooth(nullptr);
    s.render->setTooth(nullptr, {}, {}, nullptr);
    update();
}

bool ViewWidget::hasTooth() const {
    return state_->tooth != nullptr;
}

void ViewWidget::setPointer(std::shared_ptr<device::PointerMailbox> mailbox, const core::Pose& start) {
    State& s = *state_;
    s.end();
    if (!mailbox) {
        s.hand.reset();
        update();
        return;
    }
    const std::shared_ptr<simulation::LiveTooth> tooth = s.tooth;
    s.hand = std::make_unique<input::PointerController>(
        std::move(mailbox), start, [tooth](const view::Ray& ray) -> std::optional<measure::Hit> {
            if (!tooth) return std::nullopt;
            return tooth->withProbe(
                [&](const measure::ToothProbe& probe) { return probe.cast(ray.originMm, ray.direction); });
        });
    s.hand->setEye(s.camera, s.viewport());
    s.feelUncut();
    if (s.tool != Tool::drill) s.hand->freeze(true);
    update();
}

input::PointerController* ViewWidget::hand() const {
    return state_->hand.get();
}

void ViewWidget::setSample(const messages::HapticSample& sample) {
    state_->render->setSample(sample);
}
messages::HapticSample ViewWidget::sample() const {
    return state_->render->sample();
}

void ViewWidget::setBur(std::shared_ptr<const instrument::Bur> bur) {
    State& s = *state_;
    s.bur = bur;
    s.feelUncut();
    s.render->setBur(std::move(bur));
}

void ViewWidget::setTurbine(const geometry::TriangleMesh& mesh) {
    state_->render->setTurbine(mesh);
}

void ViewWidget::setLook(const view::Look& look) {
    if (look == state_->look) return;
    state_->look = look;
    state_->wish();
    update();
    emit lookChanged();
}
const view::Look& ViewWidget::look() const {
    return state_->look;
}

void ViewWidget::setCamera(const view::Camera& camera) {
    state_->camera = camera;
    state_->eyeMoved();
}
const view::Camera& ViewWidget::camera() const {
    return state_->camera;
}

void ViewWidget::showStandardView(view::StandardView standardView) {
    const view::Viewport port = state_->viewport();
    setCamera(clearOfWriting(view::standardView(standardView, state_->eyeBounds, state_->buccalSign, port), port));
}

void ViewWidget::fitTooth() {
    setCamera(clearOfWriting(view::fitted(state_->camera, state_->eyeBounds, state_->viewport()), state_->viewport()));
}

void ViewWidget::goToBur() {
    view::Camera camera = state_->camera;
    const core::Vec3 forward = camera.forward();
    camera.targetMm = proxyPose(sample()).positionMm;
    camera.eyeMm = camera.targetMm - forward * kBurViewMm;
    state_->byMouse = false;  // it stays where one looks, until the pointer moves
    setCamera(camera);
}

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
        s.lastSection = *place;
    }
    if (place == s.section) return;
    s.section = place;
    s.probe->setPlane(place ? std::optional(planeOf(*place)) : std::nullopt);
    s.layOut();
    s.wish();
    update();
    if (!place && s.tool == Tool::section) setTool(Tool::drill);
    emit sectionChanged(place.has_value());
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
        const view::Ray ray = view::rayThrough(s.camera, port, {kMirrorAcross * port.width, kMirrorDown * port.height});
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

void ViewWidget::setPulpLimits(const measure::PulpLimits& limits) {
    state_->pulpLimits = limits;
    update();
}

OverlayState ViewWidget::written() const {
    return state_->overlay();
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

void ViewWidget::setLegendShown(bool shown) {
    state_->legendShown = shown;
    update();
}
void ViewWidget::setSectionBarShown(bool shown) {
    state_->sectionBarShown = shown;
    state_->layOut();
}

void ViewWidget::addStrip(QWidget* strip) {
    state_->strips->add(strip);
}

void ViewWidget::setLoad(double loadN) {
    if (!hand()) return;
    const double before = hand()->loadN();
    hand()->setLoad(loadN);
    update();
    if (hand()->loadN() != before) emit loadChanged(hand()->loadN());
}

void ViewWidget::setStop(std::optional<double> depthMm) {
    if (!hand()) return;
    const std::optional<double> before = hand()->stopMm();
    if (depthMm && !state_->may(Operation::depthStop)) depthMm.reset();
    hand()->setStop(depthMm);
    if (hand()->stopMm()) state_->lastStopMm = *hand()->stopMm();
    update();
    if (hand()->stopMm() != before) emit stopChanged(hand()->stopMm());
}

void ViewWidget::latchPedal(bool down) {
    if (!hand() || hand()->pedalLatched() == down) return;
    hand()->latchPedal(down);
    update();
    emit pedalLatched(down);
}

void ViewWidget::setBindings(const KeyBindings& bindings) {
    state_->bindings = bindings;
    if (state_->card) state_->card->setBindings(bindings);
    update();
}
const KeyBindings& ViewWidget::bindings() const {
    return state_->bindings;
}

void ViewWidget::escape() {
    State& s = *state_;
    s.end();
    if (!s.hand) return;
    const bool latched = s.hand->pedalLatched();
    s.hand->escape();
    update();
    if (latched) emit pedalLatched(false);
}

void ViewWidget::setHelpCommands(const HelpCard::Commands& commands) {
    state_->commands = commands;
}

void ViewWidget::toggleHelpCard() {
    State& s = *state_;
    if (s.card && s.card->isVisible()) {
        s.card->close();
        return;
    }
    // Over the whole window: it needs more room than the picture has beside many panels.
    s.card = new HelpCard(window(), this);
    s.card->setBindings(s.bindings);
    s.card->setCommands(s.commands);
    s.card->show();
    s.card->raise();
    s.card->setFocus();
}

QImage ViewWidget::snapshot() {
    const double ratio = devicePixelRatioF();
    QImage image(size() * ratio, QImage::Format_RGB32);
    image.setDevicePixelRatio(ratio);
    image.fill(Qt::black);
    QPainter painter(&image);
    painter.setFont(font());
    if (state_->frame) painter.drawImage(rect(), state_->frame->image);
    paintOverlay(painter, rect(), state_->overlay());
    return image;
}

LatencyReport ViewWidget::latency() const {
    return state_->render->latency();
}
void ViewWidget::resetLatency() {
    state_->render->resetLatency();
}
view::Look ViewWidget::shownLook() const {
    return state_->effectiveLook();
}
QString ViewWidget::rendererDescription() const {
    return state_->render->description();
}

QSize ViewWidget::sizeHint() const {
    return {960, 640};
}
QSize ViewWidget::minimumSizeHint() const {
    return {320, 240};
}

void ViewWidget::paintEvent(QPaintEvent*) {
    QPainter painter(this);
    const State& s = *state_;
    if (s.frame && s.problem.isEmpty() && (s.tooth || s.isSketch)) {
        painter.drawImage(rect(), s.frame->image);
    } else {
        const auto& top = s.look.backgroundTop;
        const auto& bottom = s.look.backgroundBottom;
        QLinearGradient ground(0, 0, 0, height());
        ground.setColorAt(0, QColor(top[0], top[1], top[2]));
        ground.setColorAt(1, QColor(bottom[0], bottom[1], bottom[2]));
        painter.fillRect(rect(), ground);
    }
    paintOverlay(painter, rect(), s.overlay());
    painter.end();
    if (s.frame) s.render->presented(s.frame->sample);
}

void ViewWidget::resizeEvent(QResizeEvent*) {
    State& s = *state_;
    if (s.hand) s.hand->setEye(s.camera, s.viewport());
    s.layOut();
    s.wish();
}

void ViewWidget::showEvent(QShowEvent*) {
    state_->wish();
}

void ViewWidget::hideEvent(QHideEvent*) {
    escape();
    state_->wish();
}

}  // namespace handpiece::desktop
