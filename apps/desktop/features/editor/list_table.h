// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A list of a rubric as a table of texts: bands, steps, rules, words.

#include <QWidget>
#include <functional>
#include <map>
#include <vector>

#include "handpiece/assess/rubric/rubric.h"

class QPushButton;
class QTableWidget;

namespace handpiece::desktop {

/// What stands in the cells, and what a person's text makes of the rubric; a text that is none is told in its cell.
class ListTable : public QWidget {
    Q_OBJECT
  public:
    struct Hooks {
        std::function<std::size_t(const rubric::Rubric&)> count;
        std::function<QString(const rubric::Rubric&, std::size_t row, int column)> text;
        /// Throws core::Error, and leaves the rubric as it was.
        std::function<void(rubric::Rubric&, std::size_t row, int column, const std::string& text)> read;
        /// None of them: rows cannot be added, taken away, moved.
        std::function<void(rubric::Rubric&)> add{};
        std::function<void(rubric::Rubric&, std::size_t row)> remove{};
        std::function<void(rubric::Rubric&, std::size_t row, std::size_t other)> swap{};
        /// Columns that nobody types in.
        int fixedColumns = 0;
    };
    using Change = std::function<void(const std::function<void(rubric::Rubric&)>& how)>;
    ListTable(const char* name, const QString& title, Hooks hooks, Change change, QWidget* parent);
    void setColumns(const QStringList& titles, const std::vector<int>& widths);
    void show(const rubric::Rubric* rubric);
    [[nodiscard]] QTableWidget* table() const noexcept { return table_; }

  private:
    struct Unread {
        QString text, why;
    };
    void takeCell(int row, int column);
    void refresh();

    Hooks hooks_;
    Change change_;
    QTableWidget* table_;
    std::vector<QPushButton*> buttons_;
    std::map<std::pair<int, int>, Unread> unread_;
    rubric::Rubric now_;
    bool has_ = false;
};

}  // namespace handpiece::desktop
