// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/replay/replay_bar.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QToolButton>
#include <cmath>

#include "desktop/features/replay/timeline.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {

namespace {

constexpr double kSpeeds[] = {0.25, 0.5, 1, 2, 4, 8};

}  // namespace

ReplayBar::ReplayBar(QWidget* parent) : QWidget(parent) {
    setObjectName("replayBar");
    setAccessibleName(tr("Replay"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(8, 4, 8, 4);
    before_ = iconButton("step-back", "replayStepBack", tr("Stroke before"), this, tr("To the stroke before"));
    play_ = iconButton("play", "replayPlay", tr("Play"), this, tr("Play or pause"));
    after_ = iconButton("step-forward", "replayStepForward", tr("Next stroke"), this, tr("To the next stroke"));
    play_->setIconSize({26, 26});
    timeline_ = new Timeline(this);
    time_ = named(new QLabel(this), "replayTime", tr("Time and length"));
    speed_ = named(new QComboBox(this), "replaySpeed", tr("Speed of the replay"));
    for (const double speed : kSpeeds)
        speed_->addItem(tr("× %1").arg(QLocale().toString(speed, 'g', 3)), speed);
    speed_->setCurrentIndex(2);
    close_ = iconButton("close", "replayClose", tr("End the replay"), this);
    row->addWidget(before_);
    row->addWidget(play_);
    row->addWidget(after_);
    row->addWidget(timeline_, 1);
    row->addWidget(time_);
    row->addWidget(speed_);
    row->addWidget(close_);
    connect(play_, &QToolButton::clicked, this, [this] {
        // At the end playing begins again.
        if (!playing_ && timeline_->durationS() > 0 && timeline_->timeS() >= timeline_->durationS()) {
            timeline_->setTime(0);
            showTime();
            emit seekRequested(0, false);
        }
        setPlaying(!playing_);
        emit playRequested(playing_);
    });
    connect(before_, &QToolButton::clicked, this, [this] { stepStroke(-1); });
    connect(after_, &QToolButton::clicked, this, [this] { stepStroke(1); });
    connect(timeline_, &Timeline::moved, this, [this](double timeS, bool dragging) {
        showTime();
        emit seekRequested(timeS, dragging);
    });
    connect(speed_, &QComboBox::activated, this, [this] { emit speedChosen(speed()); });
    connect(close_, &QToolButton::clicked, this, &ReplayBar::closeRequested);
    showTime();
}

void ReplayBar::setDuration(double durationS) {
    timeline_->setDuration(durationS);
    for (QWidget* w : std::initializer_list<QWidget*>{play_, before_, after_, timeline_})
        w->setEnabled(timeline_->durationS() > 0);
    showTime();
}

void ReplayBar::setMarks(const std::vector<ReplayMark>& marks) {
    timeline_->setMarks(marks);
}

void ReplayBar::setTime(double timeS) {
    timeline_->setTime(timeS);
    showTime();
}

void ReplayBar::setPlaying(bool playing) {
    playing_ = playing;
    play_->setIcon(icon(playing ? "pause" : "play"));
    play_->setAccessibleName(playing ? tr("Pause") : tr("Play"));
}

void ReplayBar::setSpeed(double speed) {
    const QSignalBlocker quiet(speed_);
    int nearest = 0;
    for (int i = 1; i < speed_->count(); ++i)
        if (std::abs(speed_->itemData(i).toDouble() - speed) < std::abs(speed_->itemData(nearest).toDouble() - speed))
            nearest = i;
    speed_->setCurrentIndex(nearest);
}

double ReplayBar::timeS() const {
    return timeline_->timeS();
}
double ReplayBar::speed() const {
    return speed_->currentData().toDouble();
}

void ReplayBar::stepStroke(int step) {
    // To the beginning of the next stroke, or of the one before (of this one, when it has been under way for a while).
    const double now = timeline_->timeS();
    double target = step > 0 ? timeline_->durationS() : 0.0;
    for (const auto& mark : timeline_->marks()) {
        if (mark.kind != ReplayMark::Kind::strokeBegin) continue;
        if (step > 0 && mark.timeS > now + 1e-6) {
            target = mark.timeS;
            break;
        }
        if (step < 0 && mark.timeS < now - 0.3) target = mark.timeS;
    }
    timeline_->setTime(target);
    showTime();
    emit seekRequested(target, false);
}

void ReplayBar::showTime() {
    time_->setText(tr("%1 / %2").arg(timeText(timeline_->timeS()), timeText(timeline_->durationS())));
}

}  // namespace handpiece::desktop
