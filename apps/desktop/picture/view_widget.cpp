// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/view_widget.h"

#include <QPaintEvent>
#include <QPainter>
#include <algorithm>
#include <utility>

#include "desktop/picture/view_state.h"
#include "handpiece/app/input/working_position.h"
#include "handpiece/base/core/error.h"

namespace handpiece::desktop {

namespace {

constexpr double kBurViewMm = 14.0;  // the eye's distance when it goes to the bur

std::vector<cases::Tissue> tissuesOf(const cases::Case& toothCase) {
    std::array<bool, cases::kTissueCount> there{};
    for (const cases::Part& part : toothCase.parts)
        there[static_cast<std::size_t>(part.tissue)] = true;
    for (const cases::Part& part : toothCase.scenery)
        there[static_cast<std::size_t>(part.tissue)] = true;
    if (!toothCase.others.empty()) there[static_cast<std::size_t>(cases::Tissue::neighbour)] = true;
    if (toothCase.parts.empty()) there[static_cast<std::size_t>(cases::Tissue::enamel)] = true;
    std::vector<cases::Tissue> tissues;
    for (std::size_t i = 1; i < cases::kTissueCount; ++i)
        if (there[i]) tissues.push_back(static_cast<cases::Tissue>(i));
    return tissues;
}

}  // namespace

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

void ViewWidget::setTooth(std::shared_ptr<simulation::LiveTooth> liveTooth,
                          std::shared_ptr<const cases::Case> toothCase, std::shared_ptr<simulation::SampleFeed> feed) {
    clearTooth();
    State& s = *state_;
    s.tooth = std::move(liveTooth);
    s.take(*toothCase, s.tooth->model().outer.bounds());
    s.tissues = tissuesOf(*toothCase);
    s.render->setTooth(s.tooth, std::move(toothCase), std::move(feed));
    s.probe->setTooth(s.tooth);
    showStandardView(view::StandardView::oblique);
    s.firstEye = s.camera;
    s.takeKeptEye();
    s.layOut();
}

void ViewWidget::setStanding(const view::Standing& standing) {
    state_->standing = standing;
}
const view::Standing& ViewWidget::standing() const {
    return state_->standing;
}

void ViewWidget::showSketch(const cases::Case& sketch) {
    State& s = *state_;
    if (!s.isSketch) s.movedEye.reset();  // of another tooth
    clearTooth();
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
    if (shown.empty()) shown = {{"tooth", cases::Tissue::enamel, 0, sketch.outer, false, sketch.outerColours}};
    if (shown.front().mesh.triangles.empty()) return;
    for (cases::Part& part : cases::surroundings(sketch))
        shown.push_back(std::move(part));
    s.isSketch = true;
    s.take(sketch, bounds);
    s.render->setSketch(std::move(shown));
    showStandardView(view::StandardView::oblique);
    s.firstEye = s.camera;
    s.takeKeptEye();
    s.layOut();
}

void ViewWidget::keepEye() {
    State& s = *state_;
    if (s.camera.eyeMm != s.firstEye.eyeMm || s.camera.targetMm != s.firstEye.targetMm) s.movedEye = s.camera;
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
    if (s.isSketch) keepEye();
    s.isSketch = false;
    setPointer(nullptr, {});
    setSection(std::nullopt);
    setMirrorShown(false);
    setRest(std::nullopt);
    setCompare(false);
    setTool(Tool::drill);
    clearMeasurements();
    setLandmarks({});
    s.markMm.reset();
    s.thinnest.reset();
    s.sectionPlaced = false;
    s.frame.reset();
    s.tooth.reset();
    s.probe->setTooth(nullptr);
    s.render->setSketch({});
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
    s.hand->setEye(s.handsEye(), s.viewport());
    s.hand->setRest(s.restMm);
    s.feelMouth();
    if (s.tool != Tool::drill) s.hand->freeze(true);
    update();
}

input::PointerController* ViewWidget::hand() const {
    return state_->hand.get();
}

void ViewWidget::setSample(const messages::HapticSample& sample) {
    state_->render->setSample(sample);
}
void ViewWidget::setGlass(std::vector<view::GlassSurface> surfaces) {
    state_->render->setGlass(std::move(surfaces));
}
void ViewWidget::clearBlood() {
    if (state_->tooth) state_->tooth->gingiva().clear();
}
bool ViewWidget::isBleeding() const {
    return state_->tooth && !state_->tooth->gingiva().isEmpty();
}
messages::HapticSample ViewWidget::sample() const {
    return state_->render->sample();
}

void ViewWidget::setBur(std::shared_ptr<const instrument::Bur> bur) {
    State& s = *state_;
    s.bur = bur;
    s.feelMouth();
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
    setCamera(clearOfWriting(view::standardView(standardView, state_->eyeBounds, state_->standing, port), port));
    if (state_->hand) state_->hand->faceEye();
}

void ViewWidget::sitAt(const input::WorkingPosition& position) {
    const view::Viewport port = state_->viewport();
    if (state_->hand) state_->hand->turnHandle(position.toHand);
    setCamera(clearOfWriting(input::seenFrom(position, state_->eyeBounds, port), port));
}

void ViewWidget::setMirrorView(bool on) {
    State& s = *state_;
    if (on == s.mirrorView) return;
    s.end();
    s.mirrorView = on;
    s.eyeMoved();
    emit mirrorViewChanged(on);
}
bool ViewWidget::isMirrorView() const {
    return state_->mirrorView;
}

void ViewWidget::setRest(std::optional<core::Vec3> pointMm) {
    State& s = *state_;
    if (pointMm.has_value() == s.restMm.has_value() && pointMm == s.restMm) return;
    s.restMm = pointMm;
    if (s.hand) s.hand->setRest(pointMm);
    update();
    emit restChanged(pointMm.has_value());
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

OverlayState ViewWidget::written() const {
    return state_->overlay();
}

void ViewWidget::setSectionBarShown(bool shown) {
    state_->sectionBarShown = shown;
    state_->layOut();
}

void ViewWidget::addStrip(QWidget* strip, StripStack::Where where) {
    state_->strips->add(strip, where);
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
    if (depthMm && !state_->may(exercise::Operation::depthStop)) depthMm.reset();
    hand()->setStop(depthMm);
    if (hand()->stopMm()) state_->lastStopMm = *hand()->stopMm();
    update();
    if (hand()->stopMm() != before) emit stopChanged(hand()->stopMm());
}

void ViewWidget::setPerPass(std::optional<double> depthMm) {
    if (!hand()) return;
    const std::optional<double> before = hand()->perPassMm();
    hand()->setPerPass(depthMm);
    if (hand()->perPassMm()) state_->lastPerPassMm = *hand()->perPassMm();
    update();
    if (hand()->perPassMm() != before) emit perPassChanged(hand()->perPassMm());
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

QImage ViewWidget::picture() const {
    return state_->frame && state_->tooth ? state_->frame->image : QImage();
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
    return {200, 120};
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
    if (s.frame) s.render->presented(*s.frame);
}

void ViewWidget::resizeEvent(QResizeEvent*) {
    State& s = *state_;
    if (s.hand) s.hand->setEye(s.handsEye(), s.viewport());
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
