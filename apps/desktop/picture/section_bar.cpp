// SPDX-License-Identifier: Apache-2.0
#include "desktop/picture/section_bar.h"

#include <QButtonGroup>
#include <QHBoxLayout>
#include <QToolButton>

namespace handpiece::desktop {

int axisAcross(SectionPlace::Direction direction) {
    switch (direction) {
        case SectionPlace::Direction::buccoLingual:
            return 0;
        case SectionPlace::Direction::mesioDistal:
            return 1;
        case SectionPlace::Direction::horizontal:
            break;
    }
    return 2;
}

SectionBar::SectionBar(QWidget* parent) : QFrame(parent) {
    setObjectName("sectionBar");
    setFrameShape(QFrame::StyledPanel);
    setAutoFillBackground(true);
    setCursor(Qt::ArrowCursor);
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(6, 4, 6, 4);
    row->setSpacing(4);
    directions_ = new QButtonGroup(this);
    using Direction = SectionPlace::Direction;
    const std::pair<Direction, const char*> all[] = {{Direction::buccoLingual, "sectionBuccoLingual"},
                                                     {Direction::mesioDistal, "sectionMesioDistal"},
                                                     {Direction::horizontal, "sectionHorizontal"}};
    for (const auto& [direction, name] : all) {
        auto* button = new QToolButton(this);
        button->setObjectName(name);
        button->setText(directionName(direction));
        button->setAccessibleName(directionName(direction));
        button->setToolTip(tr("Cut the tooth open in this direction"));
        button->setCheckable(true);
        button->setAutoRaise(true);
        button->setFocusPolicy(Qt::TabFocus);
        directions_->addButton(button, static_cast<int>(direction));
        row->addWidget(button);
    }
    offset_ = new DecimalField(this);
    offset_->setObjectName("sectionBarOffset");
    offset_->setAccessibleName(tr("Place of the section"));
    offset_->setToolTip(tr("Where the section lies, from the middle of the tooth's frame"));
    offset_->setDecimals(1);
    offset_->setSingleStep(0.1);
    offset_->setSuffix(tr(" mm"));
    row->addWidget(offset_);
    flip_ = new QToolButton(this);
    flip_->setObjectName("sectionFlip");
    flip_->setText(tr("Other side"));
    flip_->setAccessibleName(flip_->text());
    flip_->setToolTip(tr("Take the other side away"));
    flip_->setCheckable(true);
    flip_->setAutoRaise(true);
    flip_->setFocusPolicy(Qt::TabFocus);
    row->addWidget(flip_);
    auto* close = new QToolButton(this);
    close->setObjectName("sectionClose");
    close->setText(QString(QChar(0x00D7)));
    close->setAccessibleName(tr("Close the section"));
    close->setToolTip(tr("Show the whole tooth again"));
    close->setAutoRaise(true);
    close->setFocusPolicy(Qt::TabFocus);
    row->addWidget(close);

    connect(directions_, &QButtonGroup::idClicked, this, [this](int id) {
        place_.direction = static_cast<SectionPlace::Direction>(id);
        const int axis = axisAcross(place_.direction);
        place_.offsetMm = bounds_.isEmpty() ? 0.0 : bounds_.centre()[axis];
        setPlace(place_, bounds_);
        emit placeChanged(place_);
    });
    connect(offset_, &DecimalField::valueChanged, this, [this](double value) {
        place_.offsetMm = value;
        emit placeChanged(place_);
    });
    connect(flip_, &QToolButton::toggled, this, [this](bool on) {
        place_.flipped = on;
        emit placeChanged(place_);
    });
    connect(close, &QToolButton::clicked, this, &SectionBar::closed);
}

void SectionBar::setPlace(const SectionPlace& place, const core::Box& bounds) {
    place_ = place;
    bounds_ = bounds;
    const QSignalBlocker quietOffset(offset_), quietFlip(flip_);
    if (!bounds.isEmpty()) {
        const int axis = axisAcross(place.direction);
        offset_->setRange(bounds.min[axis], bounds.max[axis]);
    }
    directions_->button(static_cast<int>(place.direction))->setChecked(true);
    offset_->setValue(place.offsetMm);
    flip_->setChecked(place.flipped);
}

}  // namespace handpiece::desktop
