// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The task: its title, what to do, what is withheld; of an attempt that is looked at, who handed it in and what was
/// recorded.

#include <QStringList>
#include <QWidget>
#include <optional>
#include <vector>

#include "desktop/work/live_zones.h"

class QLabel;
class QProgressBar;
class QPushButton;
class QVBoxLayout;

namespace handpiece::desktop {

class LiveCard;

/// Plain data for the panel, in the words of the case.
struct ExerciseText {
    QString title, instructions;
    QStringList locked;      ///< what is withheld, in words
    bool canFinish = false;  ///< it is judged, and at work
    bool hasLiveBar = false;
    bool saysWhatUndoDoes = false;  ///< it is judged, and may be undone
    struct Review {
        bool isOn = false;
        QString student;  ///< may be empty
        struct Recording {
            QString name;
            bool packed = false;  ///< came along, and can be watched
        };
        std::vector<Recording> recordings;
    } review;
};

/// [exercisePanel]. Texts of a file are shown as plain text, whatever is in them.
class ExercisePanel : public QWidget {
    Q_OBJECT
  public:
    explicit ExercisePanel(QWidget* parent = nullptr);
    void setText(const ExerciseText& text);
    /// Worked so far, and what the exercise gives; none: no clock.
    void setClock(std::optional<double> workedS, double limitS = 0.0);
    /// What is gone of the zones; null: nothing is counted yet.
    void setShares(const LiveShares* shares);
    /// The numbers that will be judged; empty: none is shown.
    void setValues(const std::vector<course::LiveValue>& values, const rubric::Rubric& rubric);

  signals:
    /// By its place in ExerciseText::Review::recordings.
    void watchRequested(int recording);
    void goOnRequested();
    void finishRequested();

  private:
    void showReview(const ExerciseText::Review& review);

    QLabel *title_, *instructions_, *locked_, *clock_, *beyond_, *undo_, *student_, *missing_;
    QProgressBar* target_;
    LiveCard* card_;
    QWidget* live_;
    int shownS_ = -2;
    QPushButton* finish_;
    QWidget* review_;
    QVBoxLayout* recordings_;
    std::vector<QPushButton*> watch_;
};

}  // namespace handpiece::desktop
