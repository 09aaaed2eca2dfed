// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The timeline of a recorded session.

#include <QString>
#include <QWidget>
#include <vector>

class QComboBox;
class QLabel;
class QToolButton;

namespace handpiece::desktop {

class Timeline;

/// What stands on the timeline.
struct ReplayMark {
    enum class Kind { strokeBegin, strokeEnd, undo, change, warning, other };
    double timeS = 0.0;
    Kind kind = Kind::other;
    QString text;  ///< its tooltip
};

/// Play, pause, speed, scrub, step by stroke [replayBar]. It plays nothing itself: the window moves the time.
class ReplayBar : public QWidget {
    Q_OBJECT
  public:
    explicit ReplayBar(QWidget* parent = nullptr);

    // Setters tell nobody.
    void setDuration(double durationS);
    void setMarks(const std::vector<ReplayMark>& marks);
    void setTime(double timeS);
    void setPlaying(bool playing);
    void setSpeed(double speed);
    [[nodiscard]] double timeS() const;
    [[nodiscard]] bool playing() const { return playing_; }
    [[nodiscard]] double speed() const;

  signals:
    void playRequested(bool play);
    /// While the hand drags (`dragging`) and once more when it lets go.
    void seekRequested(double timeS, bool dragging);
    void speedChosen(double speed);
    void closeRequested();

  private:
    void stepStroke(int step);
    void showTime();

    Timeline* timeline_;
    QToolButton *play_, *before_, *after_, *close_;
    QComboBox* speed_;
    QLabel* time_;
    bool playing_ = false;
};

}  // namespace handpiece::desktop
