// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/exercise/live_card.h"

#include <QGridLayout>
#include <QLabel>

#include "desktop/features/exercise/assessment_words.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {

LiveCard::LiveCard(QWidget* parent) : QWidget(parent), grid_(new QGridLayout(this)) {
    setObjectName(QStringLiteral("liveCard"));
    setAccessibleName(tr("What will be judged, as it is now"));
    grid_->setContentsMargins(0, 0, 0, 0);
    grid_->setHorizontalSpacing(6);
    grid_->setVerticalSpacing(2);
    grid_->setColumnStretch(1, 1);
    hide();
}

void LiveCard::setValues(const std::vector<course::LiveValue>& values, const rubric::Rubric& rubric) {
    constexpr std::size_t kColumns = 2;
    while (cells_.size() < kColumns * values.size()) {
        auto* cell = new QLabel(this);
        cell->setTextFormat(Qt::PlainText);
        const int at = static_cast<int>(cells_.size());
        const bool isSign = at % static_cast<int>(kColumns) == 0;
        cell->setWordWrap(!isSign);
        if (!isSign) cell->setMinimumWidth(60);
        grid_->addWidget(cell, at / static_cast<int>(kColumns), isSign ? 0 : 1, Qt::AlignTop);
        cells_.push_back(cell);
    }
    for (QLabel* cell : cells_)
        cell->hide();
    QStringList said;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const course::LiveValue& v = values[i];
        const QString sign = !v.value                       ? QStringLiteral("·")
                             : v.off == report::Off::no     ? QStringLiteral("✓")
                             : v.off == report::Off::tooLow ? QStringLiteral("▼")
                                                            : QStringLiteral("▲");
        const QString tip = !v.value                       ? tr("not to be measured yet")
                            : v.off == report::Off::no     ? tr("as it was asked")
                            : v.off == report::Off::tooLow ? tr("less than was asked")
                                                           : tr("more than was asked");
        const QString title = titleOf(rubric, v.criterion);
        const QString asked = QString::fromStdString(report::wantedText(v.wanted, v.unit));
        const QString is = v.value ? QString::fromStdString(report::amountText(*v.value, v.unit)) : tr("-");
        const QString words[kColumns] = {sign, tr("%1: %2 (asked: %3)").arg(title, is, asked)};
        for (std::size_t k = 0; k < kColumns; ++k) {
            QLabel* cell = cells_[kColumns * i + k];
            cell->setText(words[k]);
            cell->setToolTip(tip);
            cell->show();
        }
        said << words[1] + QStringLiteral(", ") + tip;
    }
    setAccessibleDescription(said.join(QLatin1Char('\n')));
    setVisible(!values.empty());
}

}  // namespace handpiece::desktop
