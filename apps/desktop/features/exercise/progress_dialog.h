// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How one's results went on over the attempts at an exercise.

#include <QDialog>
#include <QWidget>
#include <vector>

#include "handpiece/school/store/store.h"

class QComboBox;
class QLabel;
class QPushButton;
class QTableWidget;

namespace handpiece::desktop {

/// [progressCurve]. Shares of all points over the attempts, in their order; those that cannot be compared (another
/// version of the exercise or its rubric, another device or motion scale) are lines of their own.
class ProgressCurve : public QWidget {
    Q_OBJECT
  public:
    explicit ProgressCurve(QWidget* parent = nullptr);
    void setAttempts(const std::vector<school::Attempt>& attempts);
    struct Line {
        std::vector<std::pair<int, double>> points;  ///< number of the attempt, from 1; share of all points [%]
        std::vector<bool> isWhole;                   ///< all of it was measured; else drawn hollow
    };
    [[nodiscard]] const std::vector<Line>& lines() const noexcept { return lines_; }

    [[nodiscard]] QSize minimumSizeHint() const override { return {260, 160}; }

  protected:
    void paintEvent(QPaintEvent* event) override;

  private:
    std::vector<Line> lines_;
    int count_ = 0;
};

/// [progressDialog]
class ProgressDialog : public QDialog {
    Q_OBJECT
  public:
    explicit ProgressDialog(QWidget* parent);
    /// All that there is; `chosen`: the exercise to show first, where there is such.
    void setResults(std::vector<school::Exercise> exercises, std::vector<school::Attempt> attempts,
                    const std::string& chosen);

  signals:
    /// One's result of before, to be seen again.
    void resultRequested(const QString& attempt);
    /// The same, to be handed in.
    void handInRequested(const QString& attempt);
    /// A teacher's marks, out of a file.
    void returnedRequested();

  private:
    void showExercise(int row);
    [[nodiscard]] QString chosen() const;
    void openChosen();

    std::vector<school::Attempt> attempts_;
    QComboBox* exercise_;
    ProgressCurve* curve_;
    QTableWidget* table_;
    QPushButton *open_, *handIn_;
    QLabel* note_;
};

/// What may be compared with it: same exercise, rubric, device and motion scale.
[[nodiscard]] bool areComparable(const school::Attempt& a, const school::Attempt& b);

}  // namespace handpiece::desktop
