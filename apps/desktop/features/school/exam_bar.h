// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is always seen while an exam runs: how much time is left, a pause, and the way to hand over.

#include <QWidget>

class QLabel;
class QPushButton;

namespace handpiece::desktop {

class ExamBar : public QWidget {
    Q_OBJECT
  public:
    explicit ExamBar(QWidget* parent = nullptr);
    void setTitle(const QString& title);
    /// What is in the time: "25 % more time".
    void setAllowance(const QString& words);
    void setHasPause(bool has);
    void setPaused(bool isPaused);
    /// Below 0: over by so much.
    void setLeft(qint64 leftMs);
    /// What a person should know now; empty: nothing.
    void setTrouble(const QString& words);
    /// Nothing of it can be worked on: it can be opened again.
    void setNeedsTooth(bool needs);
    void setBusy(bool isBusy);

    /// Above a minute as "12:05", above an hour as "1:02:05"; of what is over without a sign.
    [[nodiscard]] static QString timeText(qint64 ms);
    static constexpr qint64 kSoonMs = 5 * 60'000;

  signals:
    void pauseToggled(bool isPaused);
    void openRequested();
    void handOverRequested();

  private:
    QLabel *title_, *allowance_, *trouble_, *left_;
    QPushButton *pause_, *open_, *handOver_;
};

}  // namespace handpiece::desktop
