// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/status_line.h"

#include <QHBoxLayout>
#include <QLocale>
#include <QPainter>
#include <QToolButton>

#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

/// A dot whose shape tells too: filled, hollow, or a square.
class Lamp : public QWidget {
  public:
    enum class State { ready, recording, warning, busy };
    explicit Lamp(QWidget* parent) : QWidget(parent) { setFixedSize(14, 14); }
    void setState(State state) {
        state_ = state;
        update();
    }

  protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        painter.setRenderHint(QPainter::Antialiasing);
        const Tones tones = tonesOf(palette());
        const QRectF place(2.5, 2.5, 9, 9);
        const QColor colour = state_ == State::recording ? tones.bad
                              : state_ == State::warning ? tones.caution
                              : state_ == State::busy    ? tones.quiet
                                                         : tones.good;
        painter.setPen(QPen(colour, 1.6));
        painter.setBrush(state_ == State::busy ? QBrush(Qt::NoBrush) : QBrush(colour));
        if (state_ == State::warning) {
            painter.drawPolygon(QPolygonF{QPointF(7, 2), QPointF(12.5, 11.5), QPointF(1.5, 11.5)});
        } else {
            painter.drawEllipse(place);
        }
    }

  private:
    State state_ = State::ready;
};

StatusLine::StatusLine(QWidget* parent) : QWidget(parent) {
    setObjectName("statusLine");
    setAccessibleName(tr("Status"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(4, 0, 4, 0);
    row->setSpacing(6);
    lamp_ = new Lamp(this);
    row->addWidget(lamp_);
    const auto add = [&](const char* object, const QString& name, const QString& tip) {
        auto* label = named(new QLabel(this), object, name, tip);
        row->addWidget(label);
        row->addSpacing(10);
        return label;
    };
    word_ = add("statusWord", tr("Status"), tr("How the simulator is doing"));
    record_ = add("statusRecording", tr("Record of the session"), tr("Everything you do is recorded"));
    device_ = named(new QToolButton(this), "statusDevice", tr("Device"), tr("What holds the handpiece"));
    device_->setAutoRaise(true);
    device_->setFocusPolicy(Qt::TabFocus);
    connect(device_, &QToolButton::clicked, this, &StatusLine::deviceClicked);
    row->addWidget(device_);
    row->addSpacing(10);
    rate_ = add("statusRate", tr("Tick rate"), tr("Ticks of the force loop a second"));
    late_ = add("statusLate", tr("Late ticks"), tr("Ticks that began late, and periods that were missed altogether"));
    load_ = add("statusLoad", tr("Load"), tr("Share of each period that the force loop works"));
    row->addStretch(1);
    refresh();
}

void StatusLine::setFigures(const StatusFigures& figures) {
    if (figures == figures_) return;
    figures_ = figures;
    refresh();
}

void StatusLine::setDetail(Detail detail) {
    detail_ = detail;
    refresh();
}

QString StatusLine::word() const {
    if (figures_.busy) return tr("One moment");
    if (figures_.recording == StatusFigures::Recording::stopped) return tr("Not recording");
    if (figures_.late) return tr("Late");
    return figures_.recording == StatusFigures::Recording::on ? tr("Recording") : tr("Ready");
}

void StatusLine::refresh() {
    using Recording = StatusFigures::Recording;
    const bool practice = detail_ == Detail::practice;
    word_->setText(practice ? word() : figures_.busy ? tr("One moment") : figures_.late ? tr("Late") : tr("Ready"));
    word_->setToolTip(figures_.late
                          ? tr("The computer is too busy: what the hand feels may come late. Close other programs.")
                      : figures_.recording == Recording::stopped && !figures_.recordingNote.isEmpty()
                          ? figures_.recordingNote
                          : tr("How the simulator is doing"));
    const bool stopped = figures_.recording == Recording::stopped;
    lamp_->setState(figures_.busy                         ? Lamp::State::busy
                    : figures_.late || stopped            ? Lamp::State::warning
                    : figures_.recording == Recording::on ? Lamp::State::recording
                                                          : Lamp::State::ready);
    record_->setText(figures_.recording == Recording::on ? tr("Recording")
                     : stopped                           ? tr("Recording stopped")
                                                         : tr("Not recording"));
    record_->setToolTip(figures_.recordingNote.isEmpty() ? tr("Everything you do is recorded")
                                                         : figures_.recordingNote);
    const QLocale locale;
    QString device = figures_.device.isEmpty() ? tr("No device") : figures_.device;
    if (!figures_.deviceFault.isEmpty()) {
        device = tr("%1: %2").arg(device, figures_.deviceFault);
    } else if (figures_.servoHz > 0.0) {
        device = tr("%1, %2 Hz").arg(device, locale.toString(figures_.servoHz, 'f', 0));
    }
    device_->setText(device);
    device_->setToolTip(figures_.deviceFault.isEmpty()
                            ? tr("What holds the handpiece, and how often its own servo answers. Press to choose.")
                            : tr("The device gives no force: %1").arg(figures_.deviceFault));
    QPalette tinted = palette();
    if (!figures_.deviceFault.isEmpty()) tinted.setColor(QPalette::ButtonText, tonesOf(tinted).bad);
    device_->setPalette(tinted);
    rate_->setText(tr("%1 Hz").arg(locale.toString(figures_.rateHz, 'f', 0)));
    late_->setText(figures_.missedPeriods > 0 ? tr("%1 late, %2 missed")
                                                    .arg(locale.toString(qulonglong(figures_.lateTicks)),
                                                         locale.toString(qulonglong(figures_.missedPeriods)))
                                              : tr("%1 late").arg(locale.toString(qulonglong(figures_.lateTicks))));
    load_->setText(tr("load %1 %").arg(locale.toString(100 * figures_.load, 'f', 0)));
    for (QLabel* label : {record_, rate_, late_, load_})
        label->setVisible(!practice);
}

}  // namespace handpiece::desktop
