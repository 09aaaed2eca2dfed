// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/editor/list_table.h"

#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QTableWidget>
#include <QVBoxLayout>

#include "desktop/framework/problem.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {

ListTable::ListTable(const char* name, const QString& title, Hooks hooks, Change change, QWidget* parent)
    : QWidget(parent), hooks_(std::move(hooks)), change_(std::move(change)) {
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    auto* above = new QHBoxLayout;
    above->addWidget(heading(title, this), 1);
    table_ = named(new QTableWidget(this), name, title);
    table_->verticalHeader()->setDefaultSectionSize(26);
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    const auto button = [&](const QString& sign, const QString& words, const char* suffix,
                            const std::function<void()>& asked) {
        auto* made = named(new QPushButton(sign, this), "", title + QStringLiteral(": ") + words, words);
        made->setObjectName(QLatin1String(name) + QLatin1String(suffix));
        made->setFixedWidth(30);
        made->setAutoDefault(false);
        connect(made, &QPushButton::clicked, this, asked);
        above->addWidget(made);
        buttons_.push_back(made);
    };
    const auto changed = [this](const std::function<void(rubric::Rubric&)>& how) {
        unread_.clear();
        change_(how);
    };
    if (hooks_.add) button(QStringLiteral("+"), tr("Add"), "Add", [this, changed] { changed(hooks_.add); });
    if (hooks_.remove)
        button(QStringLiteral("\u2212"), tr("Remove"), "Remove", [this, changed] {
            const int row = table_->currentRow();
            if (row >= 0) changed([&](rubric::Rubric& r) { hooks_.remove(r, static_cast<std::size_t>(row)); });
        });
    if (hooks_.swap)
        for (const int by : {-1, 1})
            button(by < 0 ? QStringLiteral("\u2191") : QStringLiteral("\u2193"), by < 0 ? tr("Up") : tr("Down"),
                   by < 0 ? "Up" : "Down", [this, changed, by] {
                       const int row = table_->currentRow(), other = row + by;
                       if (row < 0 || other < 0 || other >= table_->rowCount()) return;
                       changed([&](rubric::Rubric& r) {
                           hooks_.swap(r, static_cast<std::size_t>(row), static_cast<std::size_t>(other));
                       });
                       table_->setCurrentCell(other, 0);
                   });
    table_->setMinimumHeight(60);
    column->addLayout(above);
    column->addWidget(table_, 1);
    connect(table_, &QTableWidget::cellChanged, this, &ListTable::takeCell);
}

void ListTable::setColumns(const QStringList& titles, const std::vector<int>& widths) {
    const QSignalBlocker quiet(table_);
    table_->setColumnCount(static_cast<int>(titles.size()));
    table_->setHorizontalHeaderLabels(titles);
    for (std::size_t i = 0; i < widths.size(); ++i)
        table_->setColumnWidth(static_cast<int>(i), widths[i]);
}

void ListTable::show(const rubric::Rubric* rubric) {
    has_ = rubric != nullptr;
    now_ = rubric ? *rubric : rubric::Rubric{};
    const auto count = has_ ? static_cast<int>(hooks_.count(now_)) : 0;
    if (count != table_->rowCount()) unread_.clear();
    const QSignalBlocker quiet(table_);
    table_->setRowCount(count);
    for (QPushButton* button : buttons_)
        button->setEnabled(has_);
    refresh();
}

void ListTable::refresh() {
    for (int row = 0; row < table_->rowCount(); ++row)
        for (int column = 0; column < table_->columnCount(); ++column) {
            QTableWidgetItem* item = table_->item(row, column);
            if (item == nullptr) {
                item = new QTableWidgetItem;
                if (column < hooks_.fixedColumns) item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsSelectable);
                table_->setItem(row, column, item);
            }
            const auto wrong = unread_.find({row, column});
            const QString text = hooks_.text(now_, static_cast<std::size_t>(row), column);
            item->setText(wrong == unread_.end() ? text : wrong->second.text);
            item->setToolTip(wrong == unread_.end() ? text : wrong->second.why);
            item->setBackground(wrong == unread_.end() ? QBrush() : QBrush(QColor(220, 60, 60, 70)));
        }
}

void ListTable::takeCell(int row, int column) {
    if (!has_) return;
    const QString text = table_->item(row, column)->text();
    try {
        // Read before it becomes a step: what is none leaves the draft alone.
        rubric::Rubric tried = now_;
        hooks_.read(tried, static_cast<std::size_t>(row), column, text.trimmed().toStdString());
        unread_.erase({row, column});
        change_([&](rubric::Rubric& r) { r = tried; });
    } catch (const core::Error& error) {
        const Problem problem = problemOf(error);
        unread_[{row, column}] = {text, problem.what + QLatin1Char(' ') + problem.remedy};
        const QSignalBlocker quiet(table_);
        refresh();
    }
}

}  // namespace handpiece::desktop
