// SPDX-License-Identifier: Apache-2.0
#include "desktop/framework/job_strip.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QProgressBar>
#include <QToolButton>

namespace handpiece::desktop {

JobStrip::JobStrip(QWidget* parent) : QFrame(parent) {
    setObjectName(QStringLiteral("jobStrip"));
    setAccessibleName(tr("Progress"));
    setFrameShape(QFrame::StyledPanel);
    setAutoFillBackground(true);
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(12, 6, 12, 6);
    row->setSpacing(12);
    title_ = new QLabel;
    title_->setObjectName(QStringLiteral("jobTitle"));
    bar_ = new QProgressBar;
    bar_->setObjectName(QStringLiteral("jobProgress"));
    bar_->setAccessibleName(tr("Progress"));
    bar_->setToolTip(tr("How far it is"));
    bar_->setTextVisible(false);
    bar_->setFixedHeight(8);
    cancel_ = new QToolButton;
    cancel_->setObjectName(QStringLiteral("jobCancel"));
    cancel_->setText(tr("Cancel"));
    cancel_->setToolTip(tr("Stop this; what was open stays as it is"));
    row->addWidget(title_);
    row->addWidget(bar_, 1);
    row->addWidget(cancel_);
    hide();
    patience_.setSingleShot(true);
    connect(&patience_, &QTimer::timeout, this, &QWidget::show);
    connect(cancel_, &QToolButton::clicked, this, [this] {
        cancel_->setEnabled(false);
        emit cancelRequested();
    });
}

void JobStrip::begin(const QString& title) {
    job_ = title;
    step_.clear();
    bar_->setRange(0, 0);
    showText();
    cancel_->setEnabled(true);
    patience_.start(kPatienceMs);
}

void JobStrip::setStep(const QString& step) {
    step_ = step;
    showText();
}

void JobStrip::setFraction(double fraction) {
    bar_->setRange(0, 1000);
    bar_->setValue(static_cast<int>(1000.0 * fraction));
    showText();
}

void JobStrip::showText() {
    const QString what = step_.isEmpty() ? job_ : QStringLiteral("%1: %2").arg(job_, step_);
    title_->setText(bar_->maximum() == 0 ? what : QStringLiteral("%1, %2 %").arg(what).arg(bar_->value() / 10));
}

void JobStrip::end() {
    patience_.stop();
    hide();
}

}  // namespace handpiece::desktop
