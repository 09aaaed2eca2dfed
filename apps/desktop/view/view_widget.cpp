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
constexpr double kCrownShare = 0.42;                      // of a tooth's height, as far as one sees it over the gum

std::vector<tooth::Tissue> tissuesOf(const tooth::Case& toothCase) {
    std::array<bool, tooth::kTissueCount> there{};
    for (const tooth::Part& part : toothCase.parts)
        there[static_cast<std::size_t>(part.tissue)] = true;
    for (const tooth::Part& part : toothCase.scenery)
        there[static_cast<std::size_t>(part.tissue)] = true;
    if (toothCase.parts.empty()) there[static_cast<std::size_t>(tooth::Tissue::enamel)] = true;
    std::vector<tooth::Tissue> tissues;
    for (std::size_t i = 1; i < tooth::kTissueCount; ++i)
        if (there[i]) tissues.push_back(static_cast<tooth::Tissue>(i));
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

core::Vec3 ViewWidget::State::burAxis() const {
    const messages::HapticSample now = render->sample();
    return proxyPose(now).orientation * core::Vec3::UnitZ();
}

view::Look ViewWidget::State::effectiveLook() const {
    view::Look now = look;
    if (widget->isLocked("tissue-colours")) now.palette = view::Palette::natural;
    if (widget->isLocked("transparency")) {
        now.tooth = view::ToothShown::now;
        now.visible.fill(true);
    }
    if (widget->isLocked("depth")) now.removedDepthColours = false;
    if (widget->isLocked("cross-section")) now.cutAway.reset();
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
    Wishes wishes;
    wishes.camera = camera;
    wishes.size = widget->size().expandedTo({1, 1});
    wishes.pixelRatio = widget->devicePixelRatioF();
    wishes.look = effectiveLook();
    wishes.compare = compare;
    wishes.visible = widget->isVisible();
    wishes.mirror = mirrorPose();
    render->setWishes(wishes);
}

void ViewWidget::State::eyeMoved() {
    if (hand) hand->setEye(camera, viewport());
    if (drag == Drag::none) hoverAgain();
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

void ViewWidget::State::layOut() {
    sectionBar->setVisible(section.has_value() && sectionBarShown);
    if (section) sectionBar->setPlace(*section, bounds);
    sectionBar->adjustSize();
    sectionBar->move((widget->width() - sectionBar->width()) / 2, 44);
}

QString ViewWidget::State::hint() const {
    switch (tool) {
        case Tool::drill:
            if (!hand || everPressed) return {};
            return ViewWidget::tr("%1: cut   \u00b7   %2: turn the view   \u00b7   %3: all keys")
                .arg(bindings.text(Action::cut), bindings.text(Action::orbit), bindings.text(Action::help));
        case Tool::calliper:
            return calliperStartMm ? ViewWidget::tr("Click the second point") : ViewWidget::tr("Click the first point");
        case Tool::depth:
            return ViewWidget::tr("Point at the cavity's floor; a click keeps the reading");
        case Tool::pulp:
            return ViewWidget::tr("Point at the cavity's floor; a click keeps what is left over the pulp");
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
        state.message = ViewWidget::tr("No tooth is open");
        return state;
    }
    state.camera = frame ? frame->camera : camera;
    state.compare = compare;
    state.tool = tool;
    if (legendShown && !widget->isLocked("tissue-colours")) {
        std::vector<tooth::Tissue> shown;
        for (const tooth::Tissue tissue : tissues)
            if (look.visible[static_cast<std::size_t>(tissue)]) shown.push_back(tissue);
        state.legend = view::legendOf(shown, effectiveLook().palette);
    }
    state.scaleBar = look.scaleBar;
    if (effectiveLook().removedDepthColours) state.removedDepthMostMm = look.removedDepthMostMm;
    if (hand) {
        state.hasHand = true;
        state.loadN = hand->loadN();
        state.stopMm = hand->stopMm();
        state.pedalLatched = hand->pedalLatched();
        state.pedalDown = hand->target().pedal > 0.0;
        state.away = hand->isAway();
        state.pressed = hand->isPressed();
        if (frame) state.burTipMm = proxyPose(frame->sample).positionMm;
    }
    state.measurements = measurements;
    state.calliperStartMm = calliperStartMm;
    state.pointerMm = pointerMm;
    state.reading = reading;
    state.pointer = pointer;
    state.thinnest = thinnest;
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
    connect(state_->sectionBar, &SectionBar::placeChanged, this,
            [this](const SectionPlace& place) { setSection(place); });
    connect(state_->sectionBar, &SectionBar::closed, this, [this] { setSection(std::nullopt); });
    state_->updateCursor();
}

ViewWidget::~ViewWidget() = default;

void ViewWidget::setTooth(std::shared_ptr<station::LiveTooth> liveTooth, const tooth::Case& toothCase,
                          std::shared_ptr<station::SampleFeed> feed) {
    clearTooth();
    State& s = *state_;
    s.tooth = std::move(liveTooth);
    s.bounds = s.tooth->base().tooth->outer.bounds();
    s.eyeBounds = s.bounds;
    const bool inGum = std::any_of(toothCase.scenery.begin(), toothCase.scenery.end(),
                                   [](const tooth::Part& part) { return part.tissue == tooth::Tissue::gum; });
    if (inGum) s.eyeBounds.min.z() = s.bounds.max.z() - kCrownShare * s.bounds.size().z();
    s.buccalSign = toothCase.buccalSign;
    s.tissues = tissuesOf(toothCase);
    s.render->setTooth(s.tooth, toothCase.parts, toothCase.scenery, std::move(feed));
    s.probe->setTooth(s.tooth);
    showStandardView(view::StandardView::oblique);
    s.layOut();
}

void ViewWidget::clearTooth() {
    State& s = *state_;
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
    const std::shared_ptr<station::LiveTooth> tooth = s.tooth;
    s.hand = std::make_unique<station::PointerHand>(
        std::move(mailbox), start, [tooth](const view::Ray& ray) -> std::optional<measure::Hit> {
            if (!tooth) return std::nullopt;
            return tooth->withProbe(
                [&](const measure::ToothProbe& probe) { return probe.cast(ray.originMm, ray.direction); });
        });
    s.hand->setGoneOver([tooth](const core::Vec3& point, const core::Vec3& axis) {
        if (!tooth) return 0.0;
        return tooth->withProbe(
            [&](const measure::ToothProbe& probe) { return probe.depthAlongMm(point, axis).value_or(0.0); });
    });
    s.hand->setEye(s.camera, s.viewport());
    if (s.bur) s.hand->setBur(s.bur->lengthMm(), s.bur->maxRadiusMm());
    if (s.tool != Tool::drill) s.hand->freeze(true);
    update();
}

station::PointerHand* ViewWidget::hand() const {
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
    if (s.hand && bur) s.hand->setBur(bur->lengthMm(), bur->maxRadiusMm());
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
    const bool measures = tool == Tool::calliper || tool == Tool::depth || tool == Tool::pulp;
    if (measures && isLocked("depth")) tool = Tool::drill;
    if (tool == Tool::section && isLocked("cross-section")) tool = Tool::drill;
    if (tool != Tool::drill && !s.tooth) tool = Tool::drill;
    if (tool == s.tool) return;
    s.end();
    s.tool = tool;
    s.calliperStartMm.reset();
    s.pointerMm.reset();
    s.reading.reset();
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
    if (compare && isLocked("transparency")) compare = false;
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
    if (place && (isLocked("cross-section") || !s.tooth)) place.reset();
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

void ViewWidget::setLocked(const std::vector<std::string>& helps) {
    State& s = *state_;
    s.locked = {helps.begin(), helps.end()};
    if (isLocked("depth")) {
        clearMeasurements();
        if (s.tool == Tool::calliper || s.tool == Tool::depth || s.tool == Tool::pulp) setTool(Tool::drill);
    }
    if (isLocked("cross-section")) setSection(std::nullopt);
    if (isLocked("transparency")) setCompare(false);
    s.wish();
    update();
}
bool ViewWidget::isLocked(std::string_view help) const {
    return state_->locked.find(help) != state_->locked.end();
}

void ViewWidget::setLegendShown(bool shown) {
    state_->legendShown = shown;
    update();
}
void ViewWidget::setSectionBarShown(bool shown) {
    state_->sectionBarShown = shown;
    state_->layOut();
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
    if (s.frame && s.problem.isEmpty() && s.tooth) {
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
