// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/replay/timeline.h"

#include <QHelpEvent>
#include <QKeyEvent>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

constexpr double kInset = 9;

}  // namespace

QString timeText(double timeS) {
    const auto tenths = static_cast<qlonglong>(std::floor(std::max(0.0, timeS) * 10 + 1e-6));
    return QStringLiteral("%1:%2%3%4")
        .arg(tenths / 600)
        .arg(tenths / 10 % 60, 2, 10, QLatin1Char('0'))
        .arg(QLocale().decimalPoint())
        .arg(tenths % 10);
}

Timeline::Timeline(QWidget* parent) : QWidget(parent) {
    setObjectName("replayTimeline");
    setAccessibleName(Timeline::tr("Time of the replay"));
    setFocusPolicy(Qt::StrongFocus);
    setMouseTracking(true);
    setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

QSize Timeline::sizeHint() const {
    return {360, 34};
}
QSize Timeline::minimumSizeHint() const {
    return {120, 34};
}

void Timeline::setDuration(double durationS) {
    durationS_ = std::isfinite(durationS) ? std::max(0.0, durationS) : 0.0;
    setTime(timeS_);
}

void Timeline::setMarks(const std::vector<ReplayMark>& marks) {
    marks_ = marks;
    std::stable_sort(marks_.begin(), marks_.end(), [](const auto& a, const auto& b) { return a.timeS < b.timeS; });
    update();
}

void Timeline::setTime(double timeS) {
    timeS_ = std::clamp(std::isfinite(timeS) ? timeS : 0.0, 0.0, durationS_);
    setAccessibleDescription(tr("%1 of %2").arg(timeText(timeS_), timeText(durationS_)));
    update();
}

double Timeline::xOf(double timeS) const {
    return kInset + (durationS_ > 0 ? timeS / durationS_ : 0.0) * (width() - 2 * kInset);
}

double Timeline::timeAt(double x) const {
    return std::clamp((x - kInset) / std::max(1.0, width() - 2 * kInset), 0.0, 1.0) * durationS_;
}

void Timeline::moveTo(double timeS, bool dragging) {
    setTime(timeS);
    emit moved(timeS_, dragging);
}

void Timeline::mousePressEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || durationS_ <= 0) return;
    dragging_ = true;
    moveTo(timeAt(event->position().x()), true);
}

void Timeline::mouseMoveEvent(QMouseEvent* event) {
    if (dragging_) moveTo(timeAt(event->position().x()), true);
}

void Timeline::mouseReleaseEvent(QMouseEvent* event) {
    if (event->button() != Qt::LeftButton || !dragging_) return;
    dragging_ = false;
    moveTo(timeAt(event->position().x()), false);
}

void Timeline::keyPressEvent(QKeyEvent* event) {
    const double step = event->modifiers().testFlag(Qt::ShiftModifier) ? 0.1 : 1.0;
    switch (event->key()) {
        case Qt::Key_Left:
            return moveTo(timeS_ - step, false);
        case Qt::Key_Right:
            return moveTo(timeS_ + step, false);
        case Qt::Key_PageUp:
            return moveTo(timeS_ - 10, false);
        case Qt::Key_PageDown:
            return moveTo(timeS_ + 10, false);
        case Qt::Key_Home:
            return moveTo(0, false);
        case Qt::Key_End:
            return moveTo(durationS_, false);
        default:
            return QWidget::keyPressEvent(event);
    }
}

bool Timeline::event(QEvent* event) {
    if (event->type() == QEvent::ToolTip) {
        auto* help = static_cast<QHelpEvent*>(event);
        QStringList lines{timeText(timeAt(help->pos().x()))};
        for (const auto& mark : marks_)
            if (std::abs(xOf(mark.timeS) - help->pos().x()) <= 5 && !mark.text.isEmpty())
                lines << timeText(mark.timeS) + "  " + mark.text;
        if (lines.size() > 1) lines.removeFirst();
        if (lines.size() > 6) lines = lines.mid(0, 6) << tr("and %n more", nullptr, static_cast<int>(lines.size()) - 6);
        QToolTip::showText(help->globalPos(), lines.join('\n'));
        return true;
    }
    return QWidget::event(event);
}

void Timeline::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const Tones tones = tonesOf(palette());
    const QColor accent = isEnabled() ? palette().color(QPalette::Highlight) : tones.quiet;
    const double middle = height() / 2.0 + 3;
    const QRectF groove(kInset, middle - 3, width() - 2 * kInset, 6);
    painter.setPen(Qt::NoPen);
    painter.setBrush(tones.line);
    painter.drawRoundedRect(groove, 3, 3);
    // Where the bur was at work.
    QColor stroke = mixed(palette().color(QPalette::Window), accent, isDark(palette()) ? 0.8 : 0.55);
    painter.setBrush(stroke);
    double begin = -1;
    for (const auto& mark : marks_) {
        if (mark.kind == ReplayMark::Kind::strokeBegin) begin = mark.timeS;
        if (mark.kind == ReplayMark::Kind::strokeEnd && begin >= 0) {
            painter.drawRect(QRectF(QPointF(xOf(begin), groove.top()),
                                    QPointF(std::max(xOf(mark.timeS), xOf(begin) + 1), groove.bottom())));
            begin = -1;
        }
    }
    if (begin >= 0)
        painter.drawRect(QRectF(QPointF(xOf(begin), groove.top()), QPointF(xOf(durationS_), groove.bottom())));
    for (const auto& mark : marks_) {
        if (mark.kind == ReplayMark::Kind::strokeBegin || mark.kind == ReplayMark::Kind::strokeEnd) continue;
        const double x = xOf(mark.timeS);
        const QColor colour = mark.kind == ReplayMark::Kind::warning ? tones.bad
                              : mark.kind == ReplayMark::Kind::undo  ? tones.caution
                                                                     : tones.quiet;
        if (mark.kind == ReplayMark::Kind::warning) {
            painter.setBrush(colour);
            painter.setPen(Qt::NoPen);
            painter.drawPolygon(QPolygonF{QPointF(x - 4.5, groove.top() - 9), QPointF(x + 4.5, groove.top() - 9),
                                          QPointF(x, groove.top() - 2)});
        } else {
            painter.setPen(QPen(colour, 2));
            painter.drawLine(QPointF(x, groove.top() - 8), QPointF(x, groove.top() - 2));
        }
    }
    const QPointF knob(xOf(timeS_), middle);
    painter.setPen(QPen(palette().color(QPalette::Window), 2));
    painter.setBrush(accent);
    painter.drawEllipse(knob, 8, 8);
    if (hasFocus()) {
        painter.setPen(QPen(palette().color(QPalette::WindowText), 1));
        painter.setBrush(Qt::NoBrush);
        painter.drawEllipse(knob, 8.5, 8.5);
    }
}

}  // namespace handpiece::desktop
