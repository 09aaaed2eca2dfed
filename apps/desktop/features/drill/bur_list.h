// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The list behind the bur picker: model, filter and how a cell is drawn.

#include <QAbstractListModel>
#include <QSortFilterProxyModel>
#include <QStyledItemDelegate>
#include <vector>

#include "desktop/features/drill/bur_picture.h"
#include "desktop/work/bur_words.h"

namespace handpiece::desktop {

/// One row a bur.
class BurModel : public QAbstractListModel {
    Q_OBJECT
  public:
    enum Role { nameRole = Qt::UserRole, titleRole, sizeRole, isoRole, faceRole, shapeRole, searchRole, allowedRole };

    explicit BurModel(QObject* parent = nullptr);
    void setBurs(const std::vector<instrument::CatalogueEntry>& burs);
    void setAllowed(const QStringList& names);
    void addOwn(const instrument::CatalogueEntry& entry, const BurFace& face);

    [[nodiscard]] int rowCount(const QModelIndex& parent = {}) const override;
    [[nodiscard]] QVariant data(const QModelIndex& index, int role) const override;
    [[nodiscard]] Qt::ItemFlags flags(const QModelIndex& index) const override;

    /// -1: none.
    [[nodiscard]] int rowOf(const QString& name) const;
    [[nodiscard]] bool allowed(int row) const;
    [[nodiscard]] const instrument::CatalogueEntry& entry(int row) const { return rows_[std::size_t(row)].entry; }
    [[nodiscard]] const BurFace& face(int row) const { return rows_[std::size_t(row)].face; }
    [[nodiscard]] int shapeOf(int row) const;  ///< -1 for a bur of one's own

  private:
    struct Row {
        instrument::CatalogueEntry entry;
        BurFace face;
        bool own;
    };
    std::vector<Row> rows_;
    QStringList allowed_;
};

/// By words (all must be found) and by shape.
class BurFilter : public QSortFilterProxyModel {
    Q_OBJECT
  public:
    using QSortFilterProxyModel::QSortFilterProxyModel;
    void setWords(const QString& words);
    /// -1: all.
    void setShape(int shape);

  protected:
    [[nodiscard]] bool filterAcceptsRow(int row, const QModelIndex& parent) const override;

  private:
    QStringList words_;
    int shape_ = -1;
};

/// Picture, name, size and number.
class BurDelegate : public QStyledItemDelegate {
    Q_OBJECT
  public:
    using QStyledItemDelegate::QStyledItemDelegate;
    void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override;
    [[nodiscard]] QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const override;
    void setInHand(const QString& name) { inHand_ = name; }

  private:
    QString inHand_;
};

}  // namespace handpiece::desktop
