// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/position/position_panel.h"

#include <QCheckBox>
#include <QKeyEvent>
#include <QLabel>
#include <QPainter>
#include <QToolButton>
#include <QVBoxLayout>
#include <cmath>
#include <numbers>

#include "desktop/widgets/parts.h"
#include "handpiece/app/input/working_position.h"

namespace handpiece::desktop {
namespace {

constexpr int kSidePixels = 190, kButtonPixels = 30;
constexpr double kHoursShare = 0.8, kHeadShare = 0.4;  // of half the widget

}  // namespace

PositionClock::PositionClock(QWidget* parent) : QWidget(parent) {
    named(this, "positionClock", tr("Where the operator sits"),
          tr("The patient's head from above, 12 o'clock behind it: left and right arrow go from hour to hour"));
    setFocusPolicy(Qt::StrongFocus);
    for (const int hour : {8, 9, 10, 11, 12, 1, 2, 3, 4}) {
        const QString number = QString::number(hour);
        auto* button =
            named(new QToolButton(this), "", tr("%1 o'clock").arg(number), tr("Sit at %1 o'clock").arg(number));
        button->setObjectName(QStringLiteral("positionHour_") + number);
        button->setText(number);
        button->setCheckable(true);
        button->setFocusPolicy(Qt::NoFocus);
        hours_.emplace_back(hour, button);
        connect(button, &QToolButton::clicked, this, [this, hour] {
            setHour(hour_);  // until it is so
            emit chosen(hour);
        });
    }
}

void PositionClock::setHour(int hour) {
    hour_ = hour;
    for (const auto& [of, button] : hours_)
        button->setChecked(of == hour);
    update();
}

QSize PositionClock::sizeHint() const {
    return {kSidePixels, kSidePixels};
}

QPointF PositionClock::placeOf(int hour, double share) const {
    const double half = 0.5 * std::min(width(), height()), angle = hour * std::numbers::pi / 6.0;
    return rect().toRectF().center() + share * half * QPointF(std::sin(angle), -std::cos(angle));
}

void PositionClock::resizeEvent(QResizeEvent*) {
    for (const auto& [hour, button] : hours_) {
        const QPointF at = placeOf(hour, kHoursShare);
        button->setGeometry(static_cast<int>(at.x()) - kButtonPixels / 2, static_cast<int>(at.y()) - kButtonPixels / 2,
                            kButtonPixels, kButtonPixels);
    }
}

void PositionClock::keyPressEvent(QKeyEvent* event) {
    const int way = event->key() == Qt::Key_Right ? 1 : event->key() == Qt::Key_Left ? -1 : 0;
    if (way == 0) return QWidget::keyPressEvent(event);
    const auto at = std::find_if(hours_.begin(), hours_.end(), [this](const auto& one) { return one.first == hour_; });
    if (at == hours_.end()) {
        emit chosen(12);
    } else if (const auto place = at - hours_.begin() + way; place >= 0 && place < std::ssize(hours_)) {
        emit chosen(hours_[static_cast<std::size_t>(place)].first);
    }
}

void PositionClock::paintEvent(QPaintEvent*) {
    QPainter p(this);
    p.setRenderHint(QPainter::Antialiasing);
    const QPointF middle = rect().toRectF().center();
    const double r = kHeadShare * 0.5 * std::min(width(), height());
    QColor line = palette().color(QPalette::Text), fill = line;
    fill.setAlphaF(0.10F);
    p.setPen(QPen(line, 1.5));
    p.setBrush(fill);
    // From above, the top of the head at 12: ears, nose, mouth, and the shoulders below.
    p.drawEllipse(middle + QPointF(-0.86 * r, 0.0), 0.14 * r, 0.24 * r);
    p.drawEllipse(middle + QPointF(0.86 * r, 0.0), 0.14 * r, 0.24 * r);
    p.drawEllipse(middle, 0.8 * r, r);
    p.drawLine(middle + QPointF(0.0, -0.05 * r), middle + QPointF(0.0, 0.22 * r));
    p.drawArc(QRectF(middle + QPointF(-0.3 * r, 0.3 * r), QSizeF(0.6 * r, 0.3 * r)), 200 * 16, 140 * 16);
    p.setBrush(Qt::NoBrush);
    p.drawArc(QRectF(middle + QPointF(-1.7 * r, 1.15 * r), QSizeF(3.4 * r, 1.8 * r)), 15 * 16, 150 * 16);
    if (hour_ != 0) {
        p.setPen(QPen(palette().color(QPalette::Highlight), 3, Qt::SolidLine, Qt::RoundCap));
        p.drawLine(placeOf(hour_, kHoursShare - 2.0 * (0.5 * kButtonPixels) / std::min(width(), height())),
                   placeOf(hour_, kHeadShare + 0.1));
    }
    if (hasFocus()) {
        p.setPen(QPen(palette().color(QPalette::Highlight), 1, Qt::DotLine));
        p.drawRect(rect().adjusted(0, 0, -1, -1));
    }
}

PositionPanel::PositionPanel(QWidget* parent) : QWidget(parent) {
    named(this, "positionPanel", tr("Working position"));
    auto* column = new QVBoxLayout(this);
    clock_ = new PositionClock(this);
    column->addWidget(clock_);
    leftHanded_ = named(new QCheckBox(tr("Left-handed"), this), "positionLeftHanded", tr("Left-handed"),
                        tr("What is usual for a left-handed operator"));
    column->addWidget(leftHanded_);
    usual_ = note({}, this, "positionUsual");
    column->addWidget(usual_);
    column->addStretch(1);
    connect(clock_, &PositionClock::chosen, this, &PositionPanel::chosen);
    connect(leftHanded_, &QCheckBox::toggled, this, &PositionPanel::tell);
    setTooth(0, false);
}

void PositionPanel::setTooth(int fdiNumber, bool isKnown) {
    fdiNumber_ = fdiNumber;
    isKnown_ = isKnown;
    clock_->setEnabled(isKnown);
    tell();
}

void PositionPanel::tell() {
    if (!isKnown_) return usual_->setText(tr("Where the head lies is not known: the tooth has no number."));
    const auto usual = [this](input::Surface surface) {
        const input::UsualPosition at = input::usualPosition(fdiNumber_, surface, leftHanded_->isChecked());
        return (at.byMirror ? tr("%1 o'clock, by mirror") : tr("%1 o'clock, seen directly")).arg(at.hour);
    };
    usual_->setText(tr("Usual for tooth %1 (habits, no rule):\nocclusal: %2\nbuccal: %3\nlingual: %4")
                        .arg(QString::number(fdiNumber_), usual(input::Surface::occlusal),
                             usual(input::Surface::buccal), usual(input::Surface::lingual)));
}

}  // namespace handpiece::desktop
