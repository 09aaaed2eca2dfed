// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The works of a marking desk as a table that can be sorted and filtered.

#include <QAbstractTableModel>
#include <QPixmap>
#include <QSortFilterProxyModel>
#include <map>
#include <string>

namespace handpiece::marking {
class Desk;
}

namespace handpiece::desktop {

class WorkTable : public QAbstractTableModel {
    Q_OBJECT
  public:
    enum Column { kCode, kFile, kScore, kMachine, kPassed, kFlags, kState, kComments, kColumns };
    /// For sorting: numbers as numbers.
    static constexpr int kSortRole = Qt::UserRole, kFlagsRole = Qt::UserRole + 1, kCodeRole = Qt::UserRole + 2;
    enum Flag { kCritical = 1, kBorderline = 2, kUnproven = 4, kProblem = 8 };

    explicit WorkTable(QObject* parent = nullptr) : QAbstractTableModel(parent) {}
    /// Null: no desk. The desk outlives the table, or is taken away first.
    void setDesk(const marking::Desk* desk);
    /// All of it may be another now.
    void refresh();

    [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] int columnCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    [[nodiscard]] QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
    /// What a flag is called, all of those that are set.
    [[nodiscard]] static QString flagWords(int flags);
    /// Why it has no score, in the window's language; empty where it has one.
    [[nodiscard]] static QString problemWords(const marking::Desk& desk, const std::string& code);
    [[nodiscard]] static QString passedWord(int passed);

  private:
    [[nodiscard]] int flagsOf(const std::string& code) const;
    [[nodiscard]] QVariant shown(const std::string& code, int column, bool forSorting) const;

    const marking::Desk* desk_ = nullptr;
    mutable std::map<std::string, QPixmap> pictures_;  ///< by code
};

/// Rows that have any of the wanted flags; all where none is wanted.
class WorkFilter : public QSortFilterProxyModel {
    Q_OBJECT
  public:
    explicit WorkFilter(QObject* parent = nullptr);
    void setWanted(int flags);

  protected:
    [[nodiscard]] bool filterAcceptsRow(int row, const QModelIndex& parent) const override;

  private:
    int wanted_ = 0;
};

}  // namespace handpiece::desktop
