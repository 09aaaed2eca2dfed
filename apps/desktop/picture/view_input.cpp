// SPDX-License-Identifier: Apache-2.0
#include <QApplication>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "desktop/picture/view_state.h"

namespace handpiece::desktop {

namespace {

constexpr double kOrbitRadPerPixel = 0.008, kZoomPerNotch = 1.15, kRollRad = 0.0524, kFineRollRad = 0.0105;
constexpr double kLoadStepN = 0.1, kSectionStepMm = 0.1, kFineSectionStepMm = 0.02, kMirrorStepMm = 0.5;
constexpr double kMinStopMm = input::kStopStepMm, kMaxStopMm = 10.0;
constexpr double kHandleReach = 14.0;  // pixels around the section's handle
// Pixels by which an arrow key moves what a held key has taken, or the cross; and fine ones.
constexpr double kArrowPixels = 20.0, kFineArrowPixels = 4.0, kPivotArrowPixels = 10.0, kFinePivotArrowPixels = 2.0;
constexpr double kCrossPixels = 8.0, kFineCrossPixels = 1.0, kFineZoomNotch = 0.2;
constexpr std::size_t kMaxMeasurements = 12;

QPointF difference(const QPointF& to, const QPointF& from) {
    return to - from;
}

/// The way of an arrow key on the screen; none of another's.
std::optional<QPointF> wayOf(Action action) {
    switch (action) {
        case Action::moveLeft:
            return QPointF(-1, 0);
        case Action::moveRight:
            return QPointF(1, 0);
        case Action::moveUp:
            return QPointF(0, -1);
        case Action::moveDown:
            return QPointF(0, 1);
        default:
            return std::nullopt;
    }
}

}  // namespace

void ViewWidget::State::begin(Drag what, const Binding& by) {
    end();
    drag = what;
    dragKind = by.kind;
    dragCode = by.code;
    if (hand && (what == Drag::orbit || what == Drag::pan)) hand->freeze(true);
    updateCursor();
}

void ViewWidget::State::end() {
    const Drag was = std::exchange(drag, Drag::none);
    if (was == Drag::none) return;
    dragKind = Binding::Kind::none;
    if (was == Drag::press && hand) {
        hand->release();
        render->pointerMoved();
        emit widget->pressedChanged(false);
    }
    if (hand && (was == Drag::orbit || was == Drag::pan)) {
        hand->freeze(tool != Tool::drill);
        hoverAgain();
    }
    if (was == Drag::landmark) emit widget->landmarkDropped();
    updateCursor();
    widget->update();
}

void ViewWidget::State::updateCursor() {
    Qt::CursorShape shape = Qt::CrossCursor;
    if (drag == Drag::orbit)
        shape = Qt::ClosedHandCursor;
    else if (drag == Drag::pan)
        shape = Qt::SizeAllCursor;
    else if (tool == Tool::section)
        shape = Qt::SizeHorCursor;
    else if (tool == Tool::mirror || tool == Tool::landmarks)
        shape = drag == Drag::landmark ? Qt::ClosedHandCursor : Qt::OpenHandCursor;
    widget->setCursor(shape);
}

void ViewWidget::State::moveSection(double byMm) {
    if (!section) return;
    SectionPlace place = *section;
    place.offsetMm = std::round((place.offsetMm + byMm) * 100.0) / 100.0;
    widget->setSection(place);
}

void ViewWidget::State::dragSection(const QPointF& from, const QPointF& to) {
    if (!section) return;
    // As far as the plane's normal, seen on the screen, goes with the pointer.
    core::Vec3 axis = core::Vec3::Zero();
    axis[axisAcross(section->direction)] = 1.0;
    const view::Viewport port = viewport();
    core::Vec3 middle = bounds.centre();
    middle[axisAcross(section->direction)] = section->offsetMm;
    const auto a = view::pixelOf(camera, port, middle), b = view::pixelOf(camera, port, middle + axis);
    if (!a || !b) return;
    const core::Vec2 perMm = *b - *a;
    const QPointF d = difference(to, from);
    const core::Vec2 moved(d.x(), d.y());
    const double least = 0.15 / view::mmPerPixel(camera, port, middle);  // seen along its normal: slow, up is away
    SectionPlace place = *section;
    if (perMm.norm() > least)
        place.offsetMm += moved.dot(perMm) / perMm.squaredNorm();
    else
        place.offsetMm -=
            moved.y() * view::mmPerPixel(camera, port, middle) * (camera.forward().dot(axis) > 0 ? 1 : -1);
    widget->setSection(place);
}

void ViewWidget::State::dragMirror(const QPointF& from, const QPointF& to) {
    if (!mirrorCentreMm) return;
    const double mm = view::mmPerPixel(camera, viewport(), *mirrorCentreMm);
    const QPointF d = difference(to, from);
    *mirrorCentreMm += camera.right() * (d.x() * mm) - camera.upward() * (d.y() * mm);
    wish();
}

void ViewWidget::State::read(const QPointF& position) {
    pointerMm.reset();
    reading.reset();
    if (tool != Tool::calliper && tool != Tool::depth && tool != Tool::pulp) return;
    widget->update();
    const auto hit = hitAt(position);
    if (!hit) return;
    pointerMm = hit->pointMm;
    if (tool == Tool::calliper) return;
    Measurement now;
    now.fromMm = now.toMm = hit->pointMm;
    if (tool == Tool::depth) {
        now.kind = Measurement::Kind::depth;
        const core::Vec3 axis = burAxis();
        tooth->withProbe([&](const measure::ToothProbe& p) {
            now.valueMm = std::max(0.0, p.depthBelowUncutMm(hit->pointMm));
            now.alongAxisMm = p.depthAlongMm(hit->pointMm, axis);
        });
    } else {
        now.kind = Measurement::Kind::pulp;
        const auto left =
            tooth->withProbe([&](const measure::ToothProbe& p) { return p.leftOverPulpMm(hit->pointMm); });
        if (!left) return;
        now.valueMm = *left;
    }
    reading = now;
}

void ViewWidget::State::pressTool(const QPointF& position) {
    read(position);
    const auto keep = [&](const Measurement& one) {
        measurements.push_back(one);
        if (measurements.size() > kMaxMeasurements) measurements.erase(measurements.begin());
        widget->update();
        emit widget->measured(one);
    };
    if (tool == Tool::calliper && pointerMm) {
        if (!calliperStartMm) {
            calliperStartMm = pointerMm;
        } else {
            Measurement one;
            one.fromMm = *calliperStartMm;
            one.toMm = *pointerMm;
            one.valueMm = (one.toMm - one.fromMm).norm();
            calliperStartMm.reset();
            keep(one);
        }
    }
    if ((tool == Tool::depth || tool == Tool::pulp) && reading) keep(*reading);
    widget->update();
}

void ViewWidget::State::moveTo(const QPointF& position, Qt::KeyboardModifiers modifiers) {
    const QPointF from = std::exchange(last, position);
    pointer = position;
    const QPointF d = difference(position, from);
    cross.reset();
    switch (drag) {
        case Drag::orbit:
        case Drag::pan:
        case Drag::pivot:
            dragBy(d);
            return;
        case Drag::section:
            dragSection(from, position);
            return;
        case Drag::mirror:
            dragMirror(from, position);
            return;
        case Drag::landmark:
            dragLandmark(position);
            return;
        case Drag::press:
            if (dragKind == Binding::Kind::key) return;  // pressed from the keyboard: the mouse does not push it
            break;
        case Drag::none:
            break;
    }
    if (tool != Tool::drill) {
        read(position);
        return;
    }
    if (!hand) return;
    followHand();
    const bool wasAway = hand->isAway();
    hand->move(pixel(position), bindings.isSlow(modifiers));
    byMouse = true;
    render->pointerMoved();
    if (wasAway) widget->update();
}

/// The eye, or the bur's handle, as far as the pointer went or the arrows say.
void ViewWidget::State::dragBy(const QPointF& pixels) {
    if (drag == Drag::orbit) {
        camera = view::orbited(camera, pixels.x() * kOrbitRadPerPixel, -pixels.y() * kOrbitRadPerPixel);
        everTurned = true;
        eyeMoved();
    } else if (drag == Drag::pan) {
        camera = view::panned(camera, viewport(), {pixels.x(), pixels.y()});
        eyeMoved();
    } else if (drag == Drag::pivot && hand) {
        followHand();
        hand->pivot({pixels.x(), pixels.y()});
        render->pointerMoved();
    }
}

/// With a key held that turns, shifts or tilts, the arrows do what the pointer would.
bool ViewWidget::State::arrowsDrag(Action action, bool slow) {
    if (dragKind != Binding::Kind::key || (drag != Drag::orbit && drag != Drag::pan && drag != Drag::pivot))
        return false;
    const std::optional<QPointF> way = wayOf(action);
    if (!way) return false;
    // A held key with Shift in it does not mean fine steps.
    const Action by = drag == Drag::orbit ? Action::orbitHold : drag == Drag::pan ? Action::panHold : Action::pivot;
    for (const Binding& one : bindings.of(by))
        if (one.code == dragCode && bindings.isSlow(one.modifiers)) slow = false;
    const double step = drag == Drag::pivot ? (slow ? kFinePivotArrowPixels : kPivotArrowPixels)
                                            : (slow ? kFineArrowPixels : kArrowPixels);
    // Up on the screen is up of the handle.
    dragBy(drag == Drag::pivot ? QPointF(way->x(), -way->y()) * step : *way * step);
    return true;
}

bool ViewWidget::State::measures() const {
    return tool == Tool::calliper || tool == Tool::depth || tool == Tool::pulp;
}

void ViewWidget::State::putCross(const QPointF& at) {
    cross = QPointF(std::clamp(at.x(), 0.0, widget->width() - 1.0), std::clamp(at.y(), 0.0, widget->height() - 1.0));
    pointer = cross;
    read(*cross);
}

/// Points of the tooth without a mouse: a cross goes with the arrows, the key that cuts picks.
bool ViewWidget::State::pickByKeys(Action action, bool slow, bool repeated) {
    if (!measures()) return false;
    const QPointF from = cross ? *cross : pointer.value_or(QPointF(viewport().width / 2.0, viewport().height / 2.0));
    if (const std::optional<QPointF> way = wayOf(action)) {
        putCross(from + *way * (slow ? kFineCrossPixels : kCrossPixels));
        return true;
    }
    if (action != Action::cutKey) return false;
    if (repeated) return true;
    putCross(from);
    pressTool(from);
    return true;
}

void ViewWidget::mousePressEvent(QMouseEvent* event) {
    State& s = *state_;
    s.last = event->position();
    s.pointer = event->position();
    s.cross.reset();
    if (s.drag != Drag::none || !(s.tooth || s.isSketch)) return;
    const Binding binding{Binding::Kind::button, static_cast<int>(event->button()),
                          event->modifiers() & (Qt::ShiftModifier | Qt::ControlModifier)};
    const auto action = s.bindings.actionFor(binding);
    if (!action) return;
    if (*action == Action::orbit || *action == Action::pan) {
        s.begin(*action == Action::orbit ? Drag::orbit : Drag::pan, binding);
        return;
    }
    if (!s.tooth || (*action != Action::cut && *action != Action::touch)) return;
    if (const auto handle = sectionHandle(s.overlay(), s.viewport())) {
        const core::Vec2 at = s.pixel(event->position());
        if (std::hypot(at.x() - handle->x(), at.y() - handle->y()) < kHandleReach) {
            s.begin(Drag::section, binding);
            return;
        }
    }
    if (s.tool == Tool::section || s.tool == Tool::mirror) {
        s.begin(s.tool == Tool::section ? Drag::section : Drag::mirror, binding);
        return;
    }
    if (s.tool == Tool::landmarks) {
        s.grabbed = s.landmarkAt(event->position());
        update();
        if (!s.grabbed) return;
        s.begin(Drag::landmark, binding);
        emit landmarkGrabbed(s.grabbed->landmark);
        return;
    }
    if (s.tool != Tool::drill) {
        s.pressTool(event->position());
        return;
    }
    if (!s.hand) return;
    s.begin(Drag::press, binding);
    s.everPressed = true;
    s.followHand();
    s.hand->press(s.pixel(event->position()), *action == Action::cut);
    s.render->pointerMoved();
    update();
    emit pressedChanged(true);
}

void ViewWidget::mouseDoubleClickEvent(QMouseEvent* event) {
    mousePressEvent(event);
}

void ViewWidget::mouseMoveEvent(QMouseEvent* event) {
    // It comes in unseen where a strip over the picture was closed under it.
    if (!hasFocus() && isActiveWindow() && !isAncestorOf(QApplication::focusWidget())) setFocus(Qt::OtherFocusReason);
    state_->moveTo(event->position(), event->modifiers());
}

void ViewWidget::mouseReleaseEvent(QMouseEvent* event) {
    State& s = *state_;
    if (s.dragKind == Binding::Kind::button && s.dragCode == static_cast<int>(event->button())) s.end();
}

void ViewWidget::enterEvent(QEnterEvent* event) {
    // The keys are the hand's as soon as the pointer is over the tooth: a click, to take them from a panel, would cut.
    if (isActiveWindow()) setFocus(Qt::OtherFocusReason);
    QWidget::enterEvent(event);
}

void ViewWidget::leaveEvent(QEvent*) {
    State& s = *state_;
    // Over the panels nobody leads it: it is lifted, not left behind the tooth at whose edge the pointer went off.
    if (s.hand && s.byMouse && s.drag == Drag::none && s.tool == Tool::drill && !s.hand->pedalLatched())
        s.hand->escape();
    if (s.cross) return;
    s.pointer.reset();
    s.reading.reset();
    s.pointerMm.reset();
    update();
}

void ViewWidget::State::turnWheel(const QWheelEvent& event) {
    const double turned = (event.angleDelta().y() != 0 ? event.angleDelta().y() : event.angleDelta().x()) / 120.0;
    const auto action =
        bindings.actionFor({Binding::Kind::wheel, 0, event.modifiers() & (Qt::ShiftModifier | Qt::ControlModifier)});
    if (!action || !(tooth || isSketch) || turned == 0.0) return;
    if (*action == Action::zoom && tool != Tool::section && tool != Tool::mirror) {
        zoomBy(turned, event.position());
        return;
    }
    wheelRest += turned;
    const double notches = std::trunc(wheelRest + (wheelRest > 0 ? 1e-9 : -1e-9));
    if (notches == 0.0) return;
    wheelRest -= notches;
    if (*action == Action::zoom && tool == Tool::section) moveSection(notches * kSectionStepMm);
    if (*action == Action::zoom && tool == Tool::mirror && mirrorCentreMm) {
        *mirrorCentreMm -= camera.forward() * (notches * kMirrorStepMm);
        wish();
    }
    if (*action == Action::load) stepLoad(notches);
    if (*action == Action::stop) stepStop(notches);
    if (*action == Action::pass) stepPerPass(notches);
}

void ViewWidget::State::zoomBy(double notches, const QPointF& at) {
    std::optional<core::Vec3> under;
    if (const auto hit = hitAt(at)) under = hit->pointMm;
    camera = view::zoomed(camera, viewport(), pixel(at), std::pow(kZoomPerNotch, notches), under);
    eyeMoved();
}

void ViewWidget::State::stepLoad(double notches) {
    if (hand) widget->setLoad(hand->loadN() + notches * kLoadStepN);
}

void ViewWidget::State::stepStop(double notches) {
    if (!hand) return;
    if (!hand->stopMm()) {
        if (notches > 0) widget->setStop(lastStopMm);
        return;
    }
    const double next = std::round((*hand->stopMm() + notches * input::kStopStepMm) * 10.0) / 10.0;
    if (next < kMinStopMm - 1e-9)
        widget->setStop(std::nullopt);
    else
        widget->setStop(std::min(next, kMaxStopMm));
}

void ViewWidget::State::stepPerPass(double notches) {
    if (!hand) return;
    if (!hand->perPassMm()) {
        if (notches < 0) widget->setPerPass(lastPerPassMm);
        return;
    }
    const double next = std::round((*hand->perPassMm() + notches * input::kStopStepMm) * 10.0) / 10.0;
    // Beyond the deepest a pass is as deep as the load takes it.
    if (next > input::kMaxPerPassMm + 1e-9)
        widget->setPerPass(std::nullopt);
    else
        widget->setPerPass(std::max(next, input::kMinPerPassMm));
}

void ViewWidget::wheelEvent(QWheelEvent* event) {
    state_->turnWheel(*event);
    event->accept();
}

bool ViewWidget::State::stepTool(Action action, bool slow) {
    if (stepLandmark(action, slow)) return true;
    const double step = slow ? kFineSectionStepMm : kSectionStepMm;
    if (tool == Tool::section) {
        if (action == Action::moveRight || action == Action::moveUp) return moveSection(step), true;
        if (action == Action::moveLeft || action == Action::moveDown) return moveSection(-step), true;
    }
    if (tool == Tool::mirror && mirrorCentreMm) {
        core::Vec3 by = core::Vec3::Zero();
        if (action == Action::moveRight) by = camera.right();
        if (action == Action::moveLeft) by = -camera.right();
        if (action == Action::moveUp) by = camera.upward();
        if (action == Action::moveDown) by = -camera.upward();
        if (action == Action::advance) by = camera.forward();
        if (action == Action::retreat) by = -camera.forward();
        if (by.isZero()) return false;
        *mirrorCentreMm += by * (slow ? 0.1 : kMirrorStepMm);
        wish();
        return true;
    }
    return false;
}

/// Calliper, depth, pulp and the drill again; what is not allowed is passed over.
void ViewWidget::State::nextMeasure() {
    constexpr std::pair<Tool, exercise::Operation> kOrder[] = {{Tool::calliper, exercise::Operation::calliper},
                                                               {Tool::depth, exercise::Operation::depthTool},
                                                               {Tool::pulp, exercise::Operation::pulpTool}};
    const auto now =
        std::find_if(std::begin(kOrder), std::end(kOrder), [this](const auto& o) { return o.first == tool; });
    const auto from = now == std::end(kOrder) ? std::begin(kOrder) : now + 1;
    const auto next = std::find_if(from, std::end(kOrder), [this](const auto& o) { return allows(o.second); });
    // None at all: the first one says why.
    widget->setTool(next != std::end(kOrder) ? next->first : now == std::end(kOrder) ? Tool::calliper : Tool::drill);
}

bool ViewWidget::State::keyAction(Action action, bool slow, bool repeated, const Binding& by) {
    const auto toggleTool = [&](Tool wanted) { widget->setTool(tool == wanted ? Tool::drill : wanted); };
    if (arrowsDrag(action, slow) || pickByKeys(action, slow, repeated)) return true;
    switch (action) {
        case Action::viewOcclusal:
        case Action::viewBuccal:
        case Action::viewLingual:
        case Action::viewMesial:
        case Action::viewDistal:
        case Action::viewOblique: {
            const auto index = static_cast<std::size_t>(action) - static_cast<std::size_t>(Action::viewOcclusal);
            widget->showStandardView(view::standardViews()[index].first);
            return true;
        }
        case Action::fit:
            widget->fitTooth();
            return true;
        case Action::nearer:
        case Action::farther:
            if (tooth)
                zoomBy((action == Action::nearer ? 1.0 : -1.0) * (slow ? kFineZoomNotch : 1.0),
                       cross.value_or(QPointF(viewport().width / 2.0, viewport().height / 2.0)));
            return true;
        case Action::moreLoad:
        case Action::lessLoad:
            stepLoad(action == Action::moreLoad ? 1.0 : -1.0);
            return hand != nullptr;
        case Action::deeperStop:
        case Action::shallowerStop:
            stepStop(action == Action::deeperStop ? 1.0 : -1.0);
            return hand != nullptr;
        case Action::deeperPass:
        case Action::shallowerPass:
            stepPerPass(action == Action::deeperPass ? 1.0 : -1.0);
            return hand != nullptr;
        case Action::goToBur:
            widget->goToBur();
            return true;
        case Action::orbitHold:
        case Action::panHold:
            if (!repeated && drag == Drag::none) begin(action == Action::orbitHold ? Drag::orbit : Drag::pan, by);
            return true;
        case Action::pivot:
            if (!repeated && drag == Drag::none && hand && tool == Tool::drill) begin(Drag::pivot, by);
            return true;
        case Action::measure:
            if (!repeated) nextMeasure();
            return true;
        case Action::section:
            if (repeated) return true;
            if (section)
                widget->setSection(std::nullopt);
            else
                widget->setTool(Tool::section);
            return true;
        case Action::mirror:
            if (repeated) return true;
            if (mirrorCentreMm)
                widget->setMirrorShown(false);
            else
                toggleTool(Tool::mirror);
            return true;
        case Action::compare:
            if (!repeated) widget->setCompare(!compare);
            return true;
        case Action::help:
            if (!repeated) emit widget->helpRequested();
            return true;
        case Action::escape:
            widget->escape();
            widget->setTool(Tool::drill);
            return true;
        case Action::faster:
            emit widget->speedStepRequested(1);
            return true;
        case Action::slower:
            emit widget->speedStepRequested(-1);
            return true;
        case Action::nextBur:
            emit widget->burStepRequested(1);
            return true;
        case Action::previousBur:
            emit widget->burStepRequested(-1);
            return true;
        default:
            break;
    }
    if (stepTool(action, slow)) return true;
    if (!hand || tool != Tool::drill) return false;
    byMouse = byMouse && !(action >= Action::moveLeft && action <= Action::retreat);
    const double step = slow ? input::kFineNudgeMm : input::kNudgeMm, roll = slow ? kFineRollRad : kRollRad;
    followHand();
    switch (action) {
        case Action::moveLeft:
            hand->nudge(-step, 0, 0);
            break;
        case Action::moveRight:
            hand->nudge(step, 0, 0);
            break;
        case Action::moveUp:
            hand->nudge(0, step, 0);
            break;
        case Action::moveDown:
            hand->nudge(0, -step, 0);
            break;
        case Action::advance:
            hand->nudge(0, 0, step);
            break;
        case Action::retreat:
            hand->nudge(0, 0, -step);
            break;
        case Action::rollLeft:
            hand->roll(roll);
            break;
        case Action::rollRight:
            hand->roll(-roll);
            break;
        case Action::alignNormal:
            hand->alignToNormal();
            break;
        case Action::alignTooth:
            hand->alignToTooth();
            break;
        case Action::latchPedal:
            if (!repeated) widget->latchPedal(!hand->pedalLatched());
            break;
        case Action::cutKey:
        case Action::touchKey: {
            if (repeated || drag != Drag::none) return true;
            begin(Drag::press, by);
            everPressed = true;
            const auto at = view::pixelOf(camera, viewport(), proxyPose(render->sample()).positionMm);
            hand->press(at.value_or(core::Vec2(viewport().width / 2.0, viewport().height / 2.0)),
                        action == Action::cutKey);
            emit widget->pressedChanged(true);
            break;
        }
        default:
            return false;
    }
    render->pointerMoved();
    widget->update();
    return true;
}

/// With Alt it is a menu's letter, and with the Windows key the desktop's.
static bool isOthers(const QKeyEvent& key) {
    return key.key() != Qt::Key_Alt && (key.modifiers() & (Qt::AltModifier | Qt::MetaModifier)) != 0;
}

void ViewWidget::keyPressEvent(QKeyEvent* event) {
    State& s = *state_;
    if (isOthers(*event)) {
        QWidget::keyPressEvent(event);
        return;
    }
    const Binding binding = bindingOf(*event);
    const auto action = s.bindings.actionFor(binding);
    const bool slow = s.bindings.isSlow(event->modifiers());
    if (action && s.keyAction(*action, slow, event->isAutoRepeat(), binding))
        event->accept();
    else
        QWidget::keyPressEvent(event);
}

void ViewWidget::keyReleaseEvent(QKeyEvent* event) {
    State& s = *state_;
    if (!event->isAutoRepeat() && s.dragKind == Binding::Kind::key && s.dragCode == event->key())
        s.end();
    else
        QWidget::keyReleaseEvent(event);
}

void ViewWidget::focusOutEvent(QFocusEvent* event) {
    escape();
    QWidget::focusOutEvent(event);
}

bool ViewWidget::event(QEvent* event) {
    // Keys bound here are not a menu's while one works in the picture.
    if (event->type() == QEvent::ShortcutOverride) {
        const auto* key = static_cast<QKeyEvent*>(event);
        if (!isOthers(*key) && state_->bindings.actionFor(bindingOf(*key))) {
            event->accept();
            return true;
        }
    }
    if (event->type() == QEvent::WindowDeactivate) escape();
    return QWidget::event(event);
}

}  // namespace handpiece::desktop
