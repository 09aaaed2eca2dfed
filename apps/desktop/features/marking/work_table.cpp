// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/marking/work_table.h"

#include <QImage>
#include <QLocale>

#include "desktop/framework/problem.h"
#include "handpiece/app/marking/desk.h"

namespace handpiece::desktop {

void WorkTable::setDesk(const marking::Desk* desk) {
    beginResetModel();
    desk_ = desk;
    pictures_.clear();
    endResetModel();
}

void WorkTable::refresh() {
    if (desk_ != nullptr && rowCount() > 0) emit dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
}

int WorkTable::rowCount(const QModelIndex& parent) const {
    return desk_ == nullptr || parent.isValid() ? 0 : static_cast<int>(desk_->codes().size());
}

int WorkTable::columnCount(const QModelIndex& parent) const {
    return parent.isValid() ? 0 : static_cast<int>(kColumns);
}

int WorkTable::flagsOf(const std::string& code) const {
    int flags = desk_->problem(code).empty() ? 0 : static_cast<int>(kProblem);
    const assessment::Result* machine = desk_->machine(code);
    const std::optional<score::Assessment> final = desk_->finalScore(code);
    if (machine == nullptr || !final) return flags;
    if (!final->critical.empty()) flags |= kCritical;
    const bool anyBorderline = std::any_of(final->criteria.begin(), final->criteria.end(),
                                           [](const score::CriterionScore& c) { return c.borderline; });
    if (final->borderline || anyBorderline) flags |= kBorderline;
    if (!machine->identity.proven) flags |= kUnproven;
    return flags;
}

QString WorkTable::flagWords(int flags) {
    QStringList words;
    if (flags & kCritical) words << tr("critical error");
    if (flags & kBorderline) words << tr("borderline");
    if (flags & kUnproven) words << tr("unproven");
    if (flags & kProblem) words << tr("not scored");
    return words.join(QStringLiteral(", "));
}

QString WorkTable::problemWords(const marking::Desk& desk, const std::string& code) {
    const std::optional<core::Error> error = desk.error(code);
    if (!error) return QString::fromStdString(desk.problem(code));
    const std::string twin = desk.isRevealed(code) ? desk.work(code).twin : std::string();
    return problemOf(*error).what + (twin.empty() ? QString() : QLatin1Char(' ') + QString::fromStdString(twin));
}

QString WorkTable::passedWord(int passed) {
    switch (static_cast<score::Passed>(passed)) {
        case score::Passed::yes:
            return tr("passed");
        case score::Passed::no:
            return tr("not passed");
        case score::Passed::teacher:
            return tr("the teacher decides");
    }
    return {};
}

QVariant WorkTable::shown(const std::string& id, int column, bool forSorting) const {
    const auto points = [forSorting](double has, double most) -> QVariant {
        if (forSorting) return most > 0.0 ? has / most : -1.0;
        return tr("%1 of %2").arg(QLocale().toString(has, 'f', 1), QLocale().toString(most, 'f', 0));
    };
    const QVariant none = forSorting ? QVariant(-2.0) : QVariant(QString());
    switch (column) {
        case kCode:
            return QString::fromStdString(id);
        case kFile:
            return desk_->isRevealed(id) ? QString::fromStdString(desk_->work(id).name) : tr("hidden");
        case kScore:
            if (const auto final = desk_->finalScore(id)) return points(final->score, final->maxScore);
            return none;
        case kMachine:
            if (const auto* result = desk_->machine(id))
                return points(result->assessment.score, result->assessment.maxScore);
            return none;
        case kPassed:
            if (const auto verdict = desk_->passed(id))
                return forSorting ? QVariant(static_cast<int>(*verdict)) : passedWord(static_cast<int>(*verdict));
            return none;
        case kFlags:
            return forSorting ? QVariant(flagsOf(id)) : QVariant(flagWords(flagsOf(id)));
        case kState: {
            const marking::Sheet& sheet = desk_->sheet(id);
            if (const QString problem = problemWords(*desk_, id); !problem.isEmpty()) return problem;
            QStringList words;
            if (desk_->isBlind())
                words << (sheet.isIn ? tr("marked") : sheet.marks.empty() ? tr("to be marked") : tr("begun"));
            else if (!desk_->isScored(id))
                words << tr("waits for its score");
            if (desk_->isBlind() && sheet.isIn && !desk_->isRevealed(id))
                words << tr("the machine's score is shown at the end");
            if (desk_->isRepeat(id)) words << tr("came a second time");
            if (!sheet.overrides.empty()) words << tr("overridden: %1").arg(sheet.overrides.size());
            if (sheet.decision) words << tr("decided");
            return words.join(QStringLiteral(", "));
        }
        case kComments: {
            const auto count = static_cast<int>(desk_->sheet(id).comments.size());
            return forSorting ? QVariant(count) : QVariant(count > 0 ? QLocale().toString(count) : QString());
        }
        default:
            return {};
    }
}

QVariant WorkTable::data(const QModelIndex& index, int role) const {
    if (desk_ == nullptr || !index.isValid()) return {};
    const std::string& id = desk_->codes()[static_cast<std::size_t>(index.row())];
    switch (role) {
        case Qt::DisplayRole:
        case Qt::ToolTipRole:
            return shown(id, index.column(), false);
        case kSortRole:
            return shown(id, index.column(), true);
        case kFlagsRole:
            return flagsOf(id);
        case kCodeRole:
            return QString::fromStdString(id);
        case Qt::DecorationRole: {
            // Two equal pictures would tell which works come twice.
            if (index.column() != kCode || (desk_->isBlind() && !desk_->areAllIn())) return {};
            const view::Image& image = desk_->picture(id);
            if (image.rgba.empty()) return {};
            QPixmap& picture = pictures_[id];
            if (picture.isNull())
                picture = QPixmap::fromImage(
                    QImage(image.rgba.data(), image.width, image.height, 4 * image.width, QImage::Format_RGBX8888)
                        .scaled(96, 72, Qt::KeepAspectRatio, Qt::SmoothTransformation));
            return picture;
        }
        default:
            return {};
    }
}

QVariant WorkTable::headerData(int section, Qt::Orientation orientation, int role) const {
    if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
    const QString names[] = {tr("Code"),   tr("File"),  tr("Score"), tr("Machine's score"),
                             tr("Passed"), tr("Flags"), tr("State"), tr("Comments")};
    return section >= 0 && section < kColumns ? names[section] : QString();
}

WorkFilter::WorkFilter(QObject* parent) : QSortFilterProxyModel(parent) {
    setSortRole(WorkTable::kSortRole);
    setSortLocaleAware(true);
}

void WorkFilter::setWanted(int flags) {
    wanted_ = flags;
    invalidateFilter();
}

bool WorkFilter::filterAcceptsRow(int row, const QModelIndex& parent) const {
    return wanted_ == 0 || (sourceModel()->index(row, 0, parent).data(WorkTable::kFlagsRole).toInt() & wanted_) != 0;
}

}  // namespace handpiece::desktop
