// SPDX-License-Identifier: Apache-2.0
#include "desktop/widgets/notice_bar.h"

#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QPainter>
#include <QPushButton>
#include <QToolButton>
#include <algorithm>

#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

NoticeBar::NoticeBar(QWidget* parent) : QFrame(parent) {
    setObjectName("noticeBar");
    setAccessibleName(tr("Message"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(14, 6, 6, 6);
    symbol_ = new QLabel(this);
    text_ = named(new QLabel(this), "noticeText", tr("Message"));
    text_->setToolTip({});
    text_->setWordWrap(true);
    text_->setTextInteractionFlags(Qt::TextSelectableByMouse);
    more_ = note({}, this, "noticeMore");
    more_->setWordWrap(false);
    remedy_ = named(new QPushButton(this), "noticeRemedy", tr("Remedy"));
    later_ = named(new QPushButton(this), "noticeLater", tr("Not now"));
    close_ = iconButton("close", "noticeClose", tr("Close the message"), this);
    row->addWidget(symbol_);
    row->addWidget(text_, 1);
    row->addWidget(more_);
    row->addWidget(remedy_);
    row->addWidget(later_);
    row->addWidget(close_);
    connect(later_, &QPushButton::clicked, this, [this] { dismiss(); });
    connect(remedy_, &QPushButton::clicked, this, [this] {
        if (waiting_.empty()) return;
        const QString id = waiting_.front().id;
        remove(id);
        emit remedyChosen(id);
    });
    connect(close_, &QToolButton::clicked, this, [this] { dismiss(); });
    hide();
}

void NoticeBar::add(const Notice& notice) {
    remove(notice.id);
    // The gravest first; among equals the newest.
    const auto place = std::find_if(waiting_.begin(), waiting_.end(),
                                    [&notice](const Notice& other) { return other.kind <= notice.kind; });
    waiting_.insert(place, notice);
    showFirst();
}

void NoticeBar::remove(const QString& id) {
    if (std::erase_if(waiting_, [&id](const Notice& notice) { return notice.id == id; }) > 0) showFirst();
}

void NoticeBar::clear() {
    waiting_.clear();
    showFirst();
}

QString NoticeBar::current() const {
    return waiting_.empty() ? QString() : waiting_.front().id;
}

void NoticeBar::dismiss() {
    if (waiting_.empty()) return;
    const QString id = waiting_.front().id;
    remove(id);
    emit dismissed(id);
}

void NoticeBar::showFirst() {
    if (waiting_.empty()) return hide();
    const Notice& first = waiting_.front();
    showSymbol();
    text_->setText(first.text);
    text_->setAccessibleDescription(first.text);
    remedy_->setText(first.remedy);
    remedy_->setVisible(!first.remedy.isEmpty());
    later_->setText(first.later);
    later_->setVisible(!first.later.isEmpty());
    more_->setText(tr("%n more", nullptr, static_cast<int>(waiting_.size()) - 1));
    more_->setVisible(waiting_.size() > 1);
    show();
    update();
}

void NoticeBar::showSymbol() {
    if (waiting_.empty()) return;
    const char* const icons[] = {"info", "warning", "error"};
    symbol_->setPixmap(icon(icons[static_cast<int>(waiting_.front().kind)]).pixmap(QSize(22, 22), devicePixelRatioF()));
}

void NoticeBar::changeEvent(QEvent* event) {
    if (event->type() == QEvent::PaletteChange) showSymbol();
    QFrame::changeEvent(event);
}

void NoticeBar::keyPressEvent(QKeyEvent* event) {
    if (event->key() == Qt::Key_Escape) return dismiss();
    QFrame::keyPressEvent(event);
}

void NoticeBar::paintEvent(QPaintEvent* event) {
    Q_UNUSED(event);
    if (waiting_.empty()) return;
    QPainter painter(this);
    const Tones tones = tonesOf(palette());
    const QColor colours[] = {palette().color(QPalette::Highlight), tones.caution, tones.bad};
    const QColor colour = colours[static_cast<int>(waiting_.front().kind)];
    painter.fillRect(rect(), mixed(palette().color(QPalette::Window), colour, 0.16));
    painter.fillRect(QRect(0, 0, 5, height()), colour);
    painter.fillRect(QRect(0, height() - 1, width(), 1), tones.line);
}

}  // namespace handpiece::desktop
