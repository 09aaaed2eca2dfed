// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The rubric as a table: a criterion a row, what the linter finds at its row.

#include <map>
#include <vector>

#include "desktop/features/editor/editor_page.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QPushButton;
class QSpinBox;
class QTableWidget;

namespace handpiece::desktop {

/// [editorJudgement]
class RubricPage : public EditorPage {
    Q_OBJECT
  public:
    explicit RubricPage(Change change);
    void show(const draft::Content& content) override;
    void setProblems(const std::vector<draft::Problem>& problems);

  private:
    enum Column {
        kId,
        kMeasure,
        kOf,
        kUnit,
        kKnots,
        kBands,
        kWeight,
        kCritical,
        kTitleEn,
        kTitleJa,
        kFinding,
        kColumns
    };
    void addTable();
    void showRow(int row, const rubric::Criterion& criterion);
    void setCell(int row, Column column, const QString& text, bool isFixed = false);
    /// What a person typed: into the rubric, or told at its row.
    void takeCell(int row, int column);
    void read(rubric::Criterion& criterion, Column column, const QString& text) const;
    void showFindings();
    void move(int by);

    QComboBox* shipped_;
    QTableWidget* table_;
    QCheckBox* hasMark_;
    QSpinBox* mark_;
    QLabel *sum_, *whole_;
    QPushButton *add_, *remove_, *up_, *down_, *none_;
    std::vector<draft::Problem> problems_;
    std::vector<std::string> ids_;  ///< by row
    /// Cells that say nothing the rubric can hold: what was typed, and why not.
    struct Unread {
        QString text, why;
    };
    std::map<std::pair<int, int>, Unread> unread_;
};

}  // namespace handpiece::desktop
