// SPDX-License-Identifier: Apache-2.0
#include "desktop/program/hand_map.h"

#include <fmt/format.h>

#include <QJsonArray>
#include <algorithm>
#include <ctime>
#include <numeric>

#include "desktop/picture/overlay.h"
#include "desktop/program/host.h"
#include "desktop/widgets/notice_bar.h"
#include "handpiece/model/tooth/state_delta.h"

namespace handpiece::desktop {
namespace {

/// Python's time.monotonic() reads the same clock.
double monotonicS() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

QJsonArray numbers(const core::Vec3& v) {
    return {v.x(), v.y(), v.z()};
}

template <std::size_t N>
QJsonArray numbers(const std::array<double, N>& values) {
    QJsonArray out;
    for (const double value : values)
        out.append(value);
    return out;
}

QString nameOf(Simulator::Mode mode) {
    switch (mode) {
        case Simulator::Mode::liveSession:
            return QStringLiteral("live");
        case Simulator::Mode::replay:
            return QStringLiteral("replay");
        case Simulator::Mode::review:
            return QStringLiteral("review");
        case Simulator::Mode::empty:
            break;
    }
    return QStringLiteral("empty");
}

}  // namespace

QJsonObject eyeObject(const view::Camera& eye, const view::Viewport& viewport, const core::Box& toothMm) {
    const QJsonObject camera{{"eyeMm", numbers(eye.eyeMm)},
                             {"targetMm", numbers(eye.targetMm)},
                             {"up", numbers(eye.up)},
                             {"fieldOfViewRad", eye.fieldOfViewRad},
                             {"mirrored", eye.mirrored}};
    return {{"camera", camera},
            {"viewport", QJsonArray{viewport.width, viewport.height}},
            {"toothMm", QJsonArray{numbers(toothMm.min), numbers(toothMm.max)}}};
}

QJsonObject HandMap::now() {
    QJsonObject told{{"clockS", monotonicS()}, {"mode", nameOf(host_.simulator().mode())}};
    addWork(told);
    if (!host_.simulator().tooth() || !host_.simulator().toothCase()) return told;
    addHand(told);
    addEye(told);
    addHash(told);
    return told;
}

void HandMap::addWork(QJsonObject& told) {
    Simulator& work = host_.simulator();
    const messages::HapticSample& sample = work.sample();
    const simulation::LiveSessionStatus& status = work.status();
    told.insert("busy", work.isBusy());
    told.insert("unsaved", work.isUnsaved());
    told.insert("recording", toQString(work.recording()));
    told.insert("exercise", work.exercise() != nullptr);
    told.insert("fault", QString::fromStdString(status.fault));
    told.insert("tick", static_cast<qint64>(sample.tick));
    told.insert("timeS", sample.timeS);
    told.insert("undoSteps", static_cast<qint64>(status.undoSteps));
    told.insert("redoSteps", static_cast<qint64>(status.redoSteps));
    told.insert("strokes", static_cast<qint64>(status.strokes));
    told.insert("inStroke", status.inStroke);
    told.insert("samplesLost", static_cast<qint64>(status.queueOverflow));
    told.insert("lateTicks", static_cast<qint64>(status.lateTicks));
    if (const auto* bar = host_.window().findChild<NoticeBar*>(); bar != nullptr && bar->isVisible())
        told.insert("notice", bar->current());
}

void HandMap::addHand(QJsonObject& told) const {
    Simulator& work = host_.simulator();
    const messages::HapticSample& sample = work.sample();
    told.insert("bur", work.burName());
    told.insert("removedMm3", std::accumulate(sample.removedMm3.begin(), sample.removedMm3.end(), 0.0));
    told.insert("removedOthersMm3", sample.removedOthersMm3);
    told.insert("flags", static_cast<qint64>(sample.flags));
    told.insert("pedal", sample.pedal);
    told.insert("rpm", sample.speedRpm);
    told.insert("forceN", numbers(sample.forceN));
    told.insert("handMm", numbers(sample.positionMm));
    told.insert("tipMm", numbers(sample.proxyPositionMm));
    told.insert("tipOrientation", numbers(sample.proxyOrientation));
    const input::PointerController* hand = host_.window().view()->hand();
    if (hand == nullptr) return;
    const device::PointerTarget& target = hand->target();
    told.insert("loadN", hand->loadN());
    if (hand->stopMm()) told.insert("stopMm", *hand->stopMm());
    told.insert("pressed", hand->isPressed());
    told.insert("latched", hand->pedalLatched());
    told.insert("away", hand->isAway());
    told.insert("targetMm", QJsonArray{target.positionMm[0], target.positionMm[1], target.positionMm[2]});
}

void HandMap::addEye(QJsonObject& told) const {
    const ViewWidget& view = *host_.window().view();
    const OverlayState written = view.written();
    // The hand's, at once; what is written goes with the picture, which comes a while later.
    const view::Viewport viewport{std::max(1, view.isComparing() ? view.width() / 2 : view.width()),
                                  std::max(1, view.height())};
    const QJsonObject eye = eyeObject(view.camera(), viewport, host_.simulator().tooth()->model().tree.bounds());
    for (auto entry = eye.begin(); entry != eye.end(); ++entry)
        told.insert(entry.key(), entry.value());
    if (written.pointer) told.insert("pointer", QJsonArray{written.pointer->x(), written.pointer->y()});
    told.insert("compare", view.isComparing());
    told.insert("isDrill", written.tool == Tool::drill);
    told.insert("hint", written.hint);
    told.insert("message", written.message);
}

/// The state's hash takes milliseconds: once a change, and only when nothing has moved since the last asking.
void HandMap::addHash(QJsonObject& told) {
    Simulator& work = host_.simulator();
    const messages::HapticSample& sample = work.sample();
    const simulation::LiveSessionStatus& status = work.status();
    const bool isAtRest = work.mode() == Simulator::Mode::liveSession && sample.tick > 0 && !status.inStroke &&
                          !status.restoring && (sample.flags & messages::kRestoring) == 0 && sample.waitingBricks == 0;
    const Place place{isAtRest ? sample.handedBricks : 0, status.undoSteps, status.redoSteps, work.tooth().get()};
    if (isAtRest && place == seen_) {
        if (place != hashed_ || hash_.empty()) {
            hash_ = fmt::format("{:016x}", tooth::stateHash(work.state()));
            hashed_ = place;
        }
        told.insert("stateHash", QString::fromStdString(hash_));
    }
    seen_ = isAtRest ? place : Place{};
}

}  // namespace handpiece::desktop
