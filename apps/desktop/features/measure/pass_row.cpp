// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/measure/pass_row.h"

#include <QCheckBox>
#include <QHBoxLayout>
#include <QSignalBlocker>

#include "desktop/widgets/parts.h"
#include "handpiece/app/input/pointer_controller.h"

namespace handpiece::desktop {

PassRow::PassRow(QWidget* parent) : QWidget(parent) {
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    on_ = named(new QCheckBox(tr("One pass goes"), this), "perPassOn", tr("Depth of one pass"),
                tr("How deep one stroke cuts: press again to go deeper (Ctrl, Shift and the wheel)"));
    depth_ = named(new DecimalField(this), "perPass", tr("Depth of one pass in millimetres"));
    depth_->setRange(input::kMinPerPassMm, input::kMaxPerPassMm);
    depth_->setSingleStep(0.1);
    depth_->setDecimals(1);
    depth_->setSuffix(tr(" mm"));
    depth_->setValue(input::kFirstPerPassMm);
    on_->setChecked(true);
    row->addWidget(on_, 1);
    row->addWidget(depth_);
    connect(on_, &QCheckBox::toggled, this, [this](bool on) {
        depth_->setEnabled(on);
        emit changed(depthMm());
    });
    connect(depth_, &DecimalField::valueChanged, this, [this] { emit changed(depthMm()); });
}

std::optional<double> PassRow::depthMm() const {
    return on_->isChecked() ? std::optional(depth_->value()) : std::nullopt;
}

void PassRow::setDepth(std::optional<double> depthMm) {
    const QSignalBlocker quietOn(on_), quietDepth(depth_);
    on_->setChecked(depthMm.has_value());
    depth_->setEnabled(depthMm.has_value());
    if (depthMm) depth_->setValue(*depthMm);
}

}  // namespace handpiece::desktop
