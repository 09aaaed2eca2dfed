// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/school/exam_bar.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

ExamBar::ExamBar(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("examBar"));
    setAccessibleName(tr("Exam"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(10, 6, 10, 6);
    row->setSpacing(12);
    auto* lock = new QLabel(this);
    lock->setPixmap(icon(QStringLiteral("lock")).pixmap(20, 20));
    row->addWidget(lock);
    auto* words = new QVBoxLayout;
    words->setSpacing(1);
    title_ = named(new QLabel(this), "examTitle", tr("Title of the exam"));
    title_->setTextFormat(Qt::PlainText);
    title_->setFont(scaledFont(font(), 1.1, true));
    words->addWidget(title_);
    allowance_ = note({}, this, "examAllowance");
    words->addWidget(allowance_);
    trouble_ = named(new QLabel(this), "examTrouble", tr("What you should know"));
    trouble_->setWordWrap(true);
    trouble_->hide();
    words->addWidget(trouble_);
    row->addLayout(words, 1);
    left_ = named(new QLabel(this), "examTime", tr("Time left"));
    left_->setFont(scaledFont(font(), 1.7, true));
    left_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    row->addWidget(left_);
    pause_ = named(new QPushButton(tr("Pause"), this), "examPause", tr("Pause"),
                   tr("The picture is covered and the pedal is dead until you go on. The minutes for pauses are in the "
                      "time that is left, which runs on."));
    pause_->setCheckable(true);
    row->addWidget(pause_);
    open_ = named(new QPushButton(tr("Open again"), this), "examOpen", tr("Open again"),
                  tr("The exam's tooth is not open: bring it back"));
    open_->hide();
    row->addWidget(open_);
    handOver_ = named(new QPushButton(tr("Hand over..."), this), "examHandOver", tr("Hand over"),
                      tr("Your work is done: it is handed over, and the exam ends"));
    row->addWidget(handOver_);
    connect(pause_, &QPushButton::toggled, this, &ExamBar::pauseToggled);
    connect(open_, &QPushButton::clicked, this, &ExamBar::openRequested);
    connect(handOver_, &QPushButton::clicked, this, &ExamBar::handOverRequested);
}

void ExamBar::setTitle(const QString& title) {
    title_->setText(title);
}

void ExamBar::setAllowance(const QString& words) {
    allowance_->setText(words);
    allowance_->setVisible(!words.isEmpty());
}

void ExamBar::setHasPause(bool has) {
    pause_->setVisible(has);
}

void ExamBar::setPaused(bool isPaused) {
    pause_->setText(isPaused ? tr("Go on") : tr("Pause"));
    pause_->setChecked(isPaused);
}

void ExamBar::setLeft(qint64 leftMs) {
    left_->setText(leftMs >= 0 ? timeText(leftMs) : tr("over by %1").arg(timeText(leftMs)));
    left_->setAccessibleName(leftMs >= 0 ? tr("Time left") : tr("The time is over"));
    QPalette tinted = palette();
    const Tones tones = tonesOf(tinted);
    if (leftMs < kSoonMs) tinted.setColor(QPalette::WindowText, leftMs < 0 ? tones.bad : tones.caution);
    left_->setPalette(tinted);
}

void ExamBar::setTrouble(const QString& words) {
    trouble_->setText(words);
    trouble_->setVisible(!words.isEmpty());
    QPalette tinted = palette();
    tinted.setColor(QPalette::WindowText, tonesOf(tinted).bad);
    trouble_->setPalette(tinted);
}

void ExamBar::setNeedsTooth(bool needs) {
    open_->setVisible(needs);
}

void ExamBar::setBusy(bool isBusy) {
    handOver_->setEnabled(!isBusy);
    pause_->setEnabled(!isBusy);
}

QString ExamBar::timeText(qint64 ms) {
    // What is left is told as long as there is some of it.
    const qint64 seconds = ms >= 0 ? (ms + 999) / 1000 : -ms / 1000;
    const auto two = [](qint64 n) { return QStringLiteral("%1").arg(n, 2, 10, QLatin1Char('0')); };
    const QString tail = two(seconds / 60 % 60) + QLatin1Char(':') + two(seconds % 60);
    return seconds >= 3600 ? QString::number(seconds / 3600) + QLatin1Char(':') + tail : tail;
}

}  // namespace handpiece::desktop
