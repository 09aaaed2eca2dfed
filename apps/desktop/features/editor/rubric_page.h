// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The rubric as tables: criteria with what the linter finds at their rows; bands, steps and rules; all its texts by
/// language. Every key of the file has its field.

#include <QStringList>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "desktop/features/editor/editor_page.h"
#include "desktop/widgets/number_field.h"

class QCheckBox;
class QComboBox;
class QLabel;
class QLineEdit;
class QPushButton;
class QTabWidget;
class QTableWidget;

namespace handpiece::desktop {

class CurveView;
class ListTable;

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
    QWidget* criteriaTab();
    QWidget* wholeTab();
    QWidget* textsTab();
    /// Of the criterion in the row that is chosen: what has no column.
    QWidget* details();
    void showDetails();
    void showWhole();
    void changeCriterion(const char* step, const std::function<void(rubric::Criterion&)>& how);
    void changeRubric(const std::function<void(rubric::Rubric&)>& how);
    [[nodiscard]] QStringList languages() const;
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
    DecimalField* mark_;
    QTabWidget* tabs_;
    CurveView* curve_;
    QLabel* of_;
    QLineEdit *devices_, *excludes_, *source_;
    QComboBox *status_, *wholeStatus_;
    QLineEdit *id_, *version_, *wholeSource_, *total_, *done_;
    ListTable *bands_, *steps_, *rules_, *texts_;
    QLineEdit* language_;
    QStringList added_;  ///< languages of this person's, beside those that the texts have
    std::optional<rubric::Rubric> now_;
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
