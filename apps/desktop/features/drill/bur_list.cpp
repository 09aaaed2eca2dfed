// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/drill/bur_list.h"

#include <QApplication>
#include <QPainter>

#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

QString diameterText(double mm) {
    return BurModel::tr("%1 mm").arg(QLocale().toString(mm, 'g', 3));
}

}  // namespace

BurModel::BurModel(QObject* parent) : QAbstractListModel(parent) {}

void BurModel::setBurs(const std::vector<instrument::CatalogueEntry>& burs) {
    beginResetModel();
    rows_.clear();
    rows_.reserve(burs.size());
    for (const auto& entry : burs)
        rows_.push_back({entry, burFace(entry), !entry.stl.empty()});
    endResetModel();
}

void BurModel::setAllowed(const QStringList& names) {
    allowed_ = names;
    if (!rows_.empty()) emit dataChanged(index(0), index(rowCount() - 1));
}

void BurModel::addOwn(const instrument::CatalogueEntry& entry, const BurFace& face) {
    const int row = rowOf(QString::fromStdString(entry.name));
    if (row >= 0) {
        rows_[static_cast<std::size_t>(row)] = {entry, face, true};
        emit dataChanged(index(row), index(row));
        return;
    }
    beginInsertRows({}, 0, 0);
    rows_.insert(rows_.begin(), {entry, face, true});
    endInsertRows();
}

int BurModel::rowCount(const QModelIndex& parent) const {
    return parent.isValid() ? 0 : static_cast<int>(rows_.size());
}

int BurModel::rowOf(const QString& name) const {
    for (std::size_t i = 0; i < rows_.size(); ++i)
        if (QString::fromStdString(rows_[i].entry.name) == name) return static_cast<int>(i);
    // A recording names an own bur by its file alone: what is brought back has the same bur, not another.
    const auto isPlain = [](const QString& of) { return !of.contains(QLatin1Char('/')); };
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const QString own = QString::fromStdString(rows_[i].entry.name);
        if (rows_[i].own && isPlain(own) != isPlain(name) && burTitle(own) == burTitle(name))
            return static_cast<int>(i);
    }
    return -1;
}

bool BurModel::allowed(int row) const {
    return allowed_.isEmpty() || allowed_.contains(QString::fromStdString(entry(row).name));
}

int BurModel::shapeOf(int row) const {
    const Row& bur = rows_[static_cast<std::size_t>(row)];
    return bur.own ? -1 : static_cast<int>(bur.entry.shape);
}

QVariant BurModel::data(const QModelIndex& index, int role) const {
    if (!index.isValid() || index.row() >= rowCount()) return {};
    const Row& row = rows_[static_cast<std::size_t>(index.row())];
    const QString name = QString::fromStdString(row.entry.name), us = QString::fromStdString(row.entry.usName);
    const QString iso = groupedIso(row.entry.isoNumber);
    const QString kind = row.own ? tr("Own bur") : shapeName(row.entry.shape);
    const QString size = diameterText(row.face.diameterMm);
    switch (role) {
        case nameRole:
            return name;
        case titleRole:
            return burTitle(name);
        case sizeRole:
            return us.isEmpty() || us == name ? size : tr("US %1 · %2").arg(us, size);
        case isoRole:
            return iso;
        case shapeRole:
            return shapeOf(index.row());
        case allowedRole:
            return allowed(index.row());
        case searchRole:
            return QStringList{name,
                               burTitle(name),
                               us,
                               iso,
                               QString::fromStdString(row.entry.isoNumber),
                               size,
                               kind,
                               abilityName(row.entry.cuttingParameters),
                               row.face.ringName}
                .join(QLatin1Char('\n'));
        case Qt::DisplayRole:
        case Qt::AccessibleTextRole:
            return tr("%1, %2, diameter %3").arg(burTitle(name), kind, size);
        case Qt::ToolTipRole: {
            QStringList lines{burTitle(name), tr("%1, %2").arg(kind, abilityName(row.entry.cuttingParameters)),
                              tr("Diameter %1, length %2").arg(size, diameterText(row.face.lengthMm))};
            if (!us.isEmpty()) lines << tr("US number %1").arg(us);
            if (!iso.isEmpty()) lines << tr("ISO number %1").arg(iso);
            if (!row.face.ringName.isEmpty()) lines << tr("Ring: %1").arg(row.face.ringName);
            if (!allowed(index.row())) lines << tr("Not part of this exercise.");
            return lines.join(QLatin1Char('\n'));
        }
        default:
            return {};
    }
}

Qt::ItemFlags BurModel::flags(const QModelIndex& index) const {
    if (!index.isValid()) return Qt::NoItemFlags;
    return allowed(index.row()) ? Qt::ItemIsEnabled | Qt::ItemIsSelectable : Qt::NoItemFlags;
}

void BurFilter::setWords(const QString& words) {
    words_ = words.split(QLatin1Char(' '), Qt::SkipEmptyParts);
    invalidateFilter();
}

void BurFilter::setShape(int shape) {
    shape_ = shape;
    invalidateFilter();
}

bool BurFilter::filterAcceptsRow(int row, const QModelIndex& parent) const {
    const QModelIndex index = sourceModel()->index(row, 0, parent);
    if (shape_ >= 0 && index.data(BurModel::shapeRole).toInt() != shape_) return false;
    const QString text = index.data(BurModel::searchRole).toString();
    return std::all_of(words_.begin(), words_.end(),
                       [&text](const QString& word) { return text.contains(word, Qt::CaseInsensitive); });
}

QSize BurDelegate::sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const {
    Q_UNUSED(index);
    const QFontMetrics metrics(option.font), small(scaledFont(option.font, 0.78));
    const int width = std::max(small.horizontalAdvance("000 000 000 000 000") + 10, 84);
    return {width, 96 + metrics.height() + 2 * small.height() + 8};
}

void BurDelegate::paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const {
    const auto* proxy = qobject_cast<const QSortFilterProxyModel*>(index.model());
    const auto* model = qobject_cast<const BurModel*>(proxy ? proxy->sourceModel() : index.model());
    if (!model) return;
    const int row = proxy ? proxy->mapToSource(index).row() : index.row();
    const bool enabled = model->allowed(row), inHand = index.data(BurModel::nameRole).toString() == inHand_;
    const QPalette& palette = option.palette;
    const auto group = enabled ? QPalette::Active : QPalette::Disabled;
    const QColor accent = palette.color(QPalette::Active, QPalette::Highlight);
    const QRectF cell = QRectF(option.rect).adjusted(2, 2, -2, -2);

    painter->save();
    painter->setRenderHint(QPainter::Antialiasing);
    const bool hover = enabled && option.state.testFlag(QStyle::State_MouseOver);
    if (inHand || hover) {
        QColor fill = accent;
        fill.setAlphaF(inHand ? 0.22f : 0.1f);
        painter->setPen(inHand ? QPen(accent, 1.6) : QPen(Qt::NoPen));
        painter->setBrush(fill);
        painter->drawRoundedRect(cell, 6, 6);
    }
    if (option.state.testFlag(QStyle::State_HasFocus)) {
        painter->setPen(QPen(palette.color(QPalette::Active, QPalette::Text), 1.0, Qt::DotLine));
        painter->setBrush(Qt::NoBrush);
        painter->drawRoundedRect(cell.adjusted(1.5, 1.5, -1.5, -1.5), 5, 5);
    }
    const QFont small = scaledFont(option.font, 0.78);
    const double titleHeight = QFontMetricsF(option.font).height(), lineHeight = QFontMetricsF(small).height();
    const double textTop = cell.bottom() - titleHeight - 2 * lineHeight - 3;
    // All burs whole at one scale, so that sizes compare; beside it the head as large as it is told apart by, small
    // ones at one scale too.
    const QRectF picture(cell.left(), cell.top() + 3, cell.width(), textTop - cell.top() - 6);
    const BurFace& face = model->face(row);
    QRectF whole = picture, head = picture;
    whole.setRight(picture.left() + 0.38 * picture.width());
    head.setLeft(whole.right());
    paintBur(*painter, whole, face, palette, 6.4, enabled);
    const double most = std::min(0.82 * head.height() / std::max(0.1, face.lengthMm),
                                 0.9 * head.width() / std::max(0.1, face.diameterMm));
    paintBur(*painter, head, face, palette, std::min(24.0, most), enabled);
    painter->setPen(palette.color(group, QPalette::Text));
    painter->setFont(scaledFont(option.font, 1.0, true));
    const auto line = [&](double top, double height, const QString& text) {
        const QFontMetrics metrics(painter->font());
        painter->drawText(QRectF(cell.left(), top, cell.width(), height), Qt::AlignCenter,
                          metrics.elidedText(text, Qt::ElideRight, static_cast<int>(cell.width()) - 2));
    };
    line(textTop, titleHeight, index.data(BurModel::titleRole).toString());
    painter->setFont(small);
    line(textTop + titleHeight, lineHeight, index.data(BurModel::sizeRole).toString());
    if (enabled) painter->setPen(tonesOf(palette).quiet);
    line(textTop + titleHeight + lineHeight, lineHeight, index.data(BurModel::isoRole).toString());
    painter->restore();
}

}  // namespace handpiece::desktop
