// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/exercise_panel.h"

#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

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
    instructions_ = text("exerciseInstructions", tr("What to do"));
    locked_ = note({}, this, "exerciseLocked");
    locked_->setTextFormat(Qt::PlainText);
    column->addWidget(locked_);
    finish_ = named(new QPushButton(tr("Finish"), this), "exerciseFinish", tr("Finish"),
                    tr("Your work on this exercise is done: it is judged, and you see why"));
    column->addWidget(finish_);
    connect(finish_, &QPushButton::clicked, this, &ExercisePanel::finishRequested);
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
    showReview(text.review);
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
