// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/exercise_panel.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>

#include "desktop/features/exercise/live_card.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

ExercisePanel::ExercisePanel(QWidget* parent) : QWidget(parent) {
    setObjectName(QStringLiteral("exercisePanel"));
    setAccessibleName(tr("Exercise"));
    auto* column = new QVBoxLayout(this);
    column->setSpacing(6);
    const auto text = [&](const char* object, const QString& name) {
        auto* label = named(new QLabel(this), object, name);
        label->setTextFormat(Qt::PlainText);
        label->setTextInteractionFlags(Qt::TextSelectableByMouse);
        label->setWordWrap(true);
        label->setAlignment(Qt::AlignLeft | Qt::AlignTop);
        label->setMinimumWidth(80);
        column->addWidget(label);
        return label;
    };
    title_ = text("exerciseTitle", tr("Title of the exercise"));
    title_->setFont(scaledFont(font(), 1.15, true));
    // Over the instructions, which may be longer than the panel is high.
    auto* ending = new QHBoxLayout;
    clock_ = note({}, this, "exerciseClock");
    clock_->setAccessibleName(tr("Time worked"));
    ending->addWidget(clock_, 1);
    finish_ = named(new QPushButton(tr("Finish"), this), "exerciseFinish", tr("Finish"),
                    tr("Your work on this exercise is done: it is judged, and you see why"));
    ending->addWidget(finish_, 1);
    column->addLayout(ending);
    connect(finish_, &QPushButton::clicked, this, &ExercisePanel::finishRequested);
    // In sight while one cuts: the panel may be low.
    live_ = new QWidget(this);
    auto* live = new QVBoxLayout(live_);
    live->setContentsMargins(0, 0, 0, 0);
    live->setSpacing(2);
    target_ = named(new QProgressBar(live_), "exerciseTarget", tr("Removed of the target"));
    target_->setRange(0, 100);
    target_->setMinimumWidth(80);
    live->addWidget(target_);
    beyond_ = note({}, live_, "exerciseBeyond");
    live->addWidget(beyond_);
    card_ = new LiveCard(live_);
    live->addWidget(card_);
    column->addWidget(live_);
    instructions_ = text("exerciseInstructions", tr("What to do"));
    locked_ = note({}, this, "exerciseLocked");
    locked_->setTextFormat(Qt::PlainText);
    column->addWidget(locked_);
    undo_ = note(tr("Undo takes back the whole stroke, with what it did to gingiva and adjacent teeth. How often you "
                    "undo is kept with the work."),
                 this, "exerciseUndo");
    column->addWidget(undo_);
    review_ = new QWidget(this);
    recordings_ = new QVBoxLayout(review_);
    recordings_->setContentsMargins(0, 0, 0, 0);
    student_ = note({}, review_, "exerciseStudent");
    student_->setTextFormat(Qt::PlainText);
    recordings_->addWidget(student_);
    missing_ = note({}, review_, "exerciseMissing");
    recordings_->addWidget(missing_);
    auto* goOn = named(new QPushButton(tr("Go on with it"), review_), "exerciseGoOn", tr("Go on with it"),
                       tr("Cut on where it ended; what the exercise locks is locked then"));
    recordings_->addWidget(goOn);
    connect(goOn, &QPushButton::clicked, this, &ExercisePanel::goOnRequested);
    column->addWidget(review_);
    column->addStretch(1);
    setText({});
}

void ExercisePanel::setText(const ExerciseText& text) {
    const auto show = [](QLabel* label, const QString& words) {
        label->setText(words);
        label->setVisible(!words.isEmpty());
    };
    show(title_, text.title.isEmpty() && !text.review.isOn ? tr("Without a title") : text.title);
    show(instructions_, text.instructions);
    show(locked_, text.locked.isEmpty() ? QString()
                                        : tr("Not in this exercise: %1").arg(text.locked.join(QStringLiteral("; "))));
    finish_->setVisible(text.canFinish);
    live_->setVisible(text.hasLiveBar);
    undo_->setVisible(text.saysWhatUndoDoes);
    showReview(text.review);
}

void ExercisePanel::setClock(std::optional<double> workedS, double limitS) {
    const int now = workedS ? static_cast<int>(*workedS) : -1;
    if (now == shownS_) return;
    shownS_ = now;
    clock_->setVisible(workedS.has_value());
    if (!workedS) return;
    const auto minutes = [](int seconds) {
        return QStringLiteral("%1:%2").arg(seconds / 60).arg(seconds % 60, 2, 10, QLatin1Char('0'));
    };
    const int limit = static_cast<int>(limitS);
    clock_->setText(now <= limit
                        ? tr("Time: %1 of %2").arg(minutes(now), minutes(limit))
                        : tr("Time: %1 of %2, over by %3").arg(minutes(now), minutes(limit), minutes(now - limit)));
}

void ExercisePanel::setShares(const LiveShares* shares) {
    const QLocale locale;
    target_->setValue(shares ? static_cast<int>(100.0 * shares->targetRemoved) : 0);
    QStringList lines;
    const auto line = [&](const QString& words, double mm3) {
        if (mm3 >= 0.005) lines << words.arg(locale.toString(mm3, 'f', 2));
    };
    if (shares) {
        line(tr("Leeway used: %1 mm³"), shares->leewayMm3);
        line(tr("Beyond it: %1 mm³"), shares->beyondMm3);
        line(tr("Protected, and cut: %1 mm³"), shares->protectedMm3);
    }
    // A tooth's target takes a while to be laid on, and longer on a busy machine: until then nothing is known.
    target_->setFormat(shares ? tr("Target: %p %") : tr("Target: –"));
    beyond_->setText(!shares           ? tr("Being worked out")
                     : lines.isEmpty() ? tr("Nothing beside the target")
                                       : lines.join(QLatin1Char('\n')));
}

void ExercisePanel::setValues(const std::vector<course::LiveValue>& values, const rubric::Rubric& rubric) {
    card_->setValues(values, rubric);
}

void ExercisePanel::showReview(const ExerciseText::Review& review) {
    review_->setVisible(review.isOn);
    qDeleteAll(watch_);
    watch_.clear();
    student_->setText(review.student.isEmpty()
                          ? tr("Handed in without a code. You look at it: nothing is locked.")
                          : tr("Handed in by %1. You look at it: nothing is locked.").arg(review.student));
    int missing = 0;
    for (std::size_t i = 0; i < review.recordings.size(); ++i) {
        if (!review.recordings[i].packed) {
            ++missing;
            continue;
        }
        const QString number = QString::number(i + 1);
        auto* button =
            named(new QPushButton(tr("Watch recording %1").arg(number), review_), "exerciseWatch",
                  tr("Watch recording %1").arg(number), tr("Play what was done; closing it leads back here"));
        button->setObjectName(QStringLiteral("exerciseWatch_") + number);
        recordings_->insertWidget(1 + static_cast<int>(watch_.size()), button);
        connect(button, &QPushButton::clicked, this, [this, i] { emit watchRequested(static_cast<int>(i)); });
        watch_.push_back(button);
    }
    missing_->setText(tr("Recordings that did not come with it: %1").arg(missing));
    missing_->setVisible(missing > 0);
}

}  // namespace handpiece::desktop
