// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/drill/welcome_strip.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QToolButton>

#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

using Step = WelcomeStrip::Step;
constexpr Step kOrder[] = {Step::hover, Step::cut, Step::orbit, Step::zoom, Step::undo};

}  // namespace

WelcomeStrip::WelcomeStrip(QWidget* parent) : QWidget(parent) {
    setObjectName("welcomeStrip");
    setAccessibleName(tr("First steps"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(16, 8, 8, 8);
    text_ = named(new QLabel(this), "welcomeText", tr("First steps"));
    text_->setToolTip({});
    text_->setFont(scaledFont(font(), 1.15, true));
    text_->setWordWrap(true);
    count_ = note({}, this, "welcomeCount");
    count_->setWordWrap(false);
    close_ = iconButton("close", "welcomeClose", tr("Show no hints"), this);
    row->addWidget(text_, 1);
    row->addWidget(count_);
    row->addWidget(close_);
    connect(close_, &QToolButton::clicked, this, [this] {
        done_.insert(std::begin(kOrder), std::end(kOrder));
        hide();
        emit doneChanged();
        emit closed();
    });
    showNext();
}

void WelcomeStrip::setDone(const std::set<Step>& done) {
    done_ = done;
    showNext();
}

void WelcomeStrip::markDone(Step step) {
    // Who cuts has also moved over the tooth.
    bool news = done_.insert(step).second;
    if (step == Step::cut) news |= done_.insert(Step::hover).second;
    if (!news) return;
    showNext();
    emit doneChanged();
}

void WelcomeStrip::setPointerIsMouse(bool mouse) {
    if (mouse == mouse_) return;
    mouse_ = mouse;
    showNext();
}

void WelcomeStrip::setAllowed(bool allowed) {
    allowed_ = allowed;
    showNext();
}

void WelcomeStrip::beginAgain() {
    done_.clear();
    showNext();
    emit doneChanged();
}

QString WelcomeStrip::text() const {
    for (const Step step : kOrder) {
        if (done_.contains(step)) continue;
        switch (step) {
            case Step::hover:
                return mouse_ ? tr("Move the mouse over the tooth. Hold the left button to cut.")
                              : tr("Move the handpiece to the tooth. Hold its upper button to cut.");
            case Step::cut:
                return mouse_ ? tr("Hold the left button and drag to cut.") : tr("Hold the upper button to cut.");
            case Step::orbit:
                return tr("Hold the right mouse button and drag to look from another side.");
            case Step::zoom:
                return tr("Turn the mouse wheel to come nearer.");
            case Step::undo:
                return tr("Something went wrong? Ctrl+Z takes the last stroke back.");
        }
    }
    return {};
}

void WelcomeStrip::showNext() {
    const QString next = text();
    text_->setText(next);
    text_->setAccessibleDescription(next);
    count_->setText(
        tr("%1 of %2").arg(std::min<std::size_t>(done_.size() + 1, std::size(kOrder))).arg(std::size(kOrder)));
    setVisible(allowed_ && !next.isEmpty());
    update();
}

void WelcomeStrip::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    QPainter painter(this);
    painter.setRenderHint(QPainter::Antialiasing);
    const QColor accent = palette().color(QPalette::Highlight);
    painter.setPen(QPen(accent, 1));
    painter.setBrush(mixed(palette().color(QPalette::Window), accent, 0.14));
    painter.drawRoundedRect(QRectF(rect()).adjusted(0.5, 0.5, -0.5, -0.5), 8, 8);
}

}  // namespace handpiece::desktop
