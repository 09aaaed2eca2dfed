// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The numbers that will be judged, while one cuts: "depth of the floor   1.6 mm   asked: 1.5 to 2 mm".

#include <QWidget>
#include <vector>

#include "handpiece/app/course/live_card.h"
#include "handpiece/assess/rubric/rubric.h"

class QGridLayout;
class QLabel;

namespace handpiece::desktop {

/// [liveCard]. A sign before each number says it without its colour: right, too low, too high, not yet.
class LiveCard : public QWidget {
    Q_OBJECT
  public:
    explicit LiveCard(QWidget* parent = nullptr);
    /// Titles in the person's language; empty values: nothing is counted yet, and nothing is shown.
    void setValues(const std::vector<course::LiveValue>& values, const rubric::Rubric& rubric);

  private:
    QGridLayout* grid_;
    std::vector<QLabel*> cells_;
};

}  // namespace handpiece::desktop
