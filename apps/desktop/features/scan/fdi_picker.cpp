// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/fdi_picker.h"

#include <QCheckBox>
#include <QDialog>
#include <QDialogButtonBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <set>

#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/tooth_chart.h"

namespace handpiece::desktop {

FdiPicker::FdiPicker(const QString& name, QWidget* parent) : QWidget(parent) {
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    number_ = named(new QLineEdit(this), "", tr("FDI number of the tooth"),
                    tr("Two digits: quadrant and place, 46 for the lower right first molar"));
    number_->setObjectName(name + QStringLiteral("Number"));
    number_->setMaxLength(2);
    number_->setPlaceholderText(QStringLiteral("46"));
    number_->setFixedWidth(fontMetrics().horizontalAdvance(QStringLiteral("0000")) + 22);
    auto* chart = named(new QPushButton(icon(QStringLiteral("chart")), tr("Chart..."), this), "",
                        tr("Choose the tooth on the chart of the mouth"));
    chart->setObjectName(name + QStringLiteral("Chart"));
    name_ = note({}, this);
    name_->setObjectName(name + QStringLiteral("Name"));
    row->addWidget(number_);
    row->addWidget(chart);
    row->addWidget(name_, 1);
    connect(number_, &QLineEdit::textEdited, this, &FdiPicker::typed);
    connect(chart, &QPushButton::clicked, this, &FdiPicker::chart);
    setTooth(0);
}

void FdiPicker::setTooth(int fdi) {
    fdi_ = fdi;
    const QString text = fdi > 0 ? QString::number(fdi) : QString();
    // What is being typed stays as it is.
    if (!number_->hasFocus() || number_->text().size() != 1) number_->setText(text);
    name_->setText(fdi > 0 ? toothName(fdi) : tr("not said yet"));
}

void FdiPicker::typed(const QString& text) {
    if (text.isEmpty()) {
        emit toothChosen(0);
        return;
    }
    const auto fdi = toothOf(text, Notation::fdi);
    if (fdi)
        emit toothChosen(*fdi);
    else
        name_->setText(text.size() < 2 ? QString() : tr("There is no tooth %1").arg(text));
}

void FdiPicker::chart() {
    auto* dialog = new QDialog(this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setObjectName(QStringLiteral("scanToothDialog"));
    dialog->setWindowTitle(tr("Which tooth is it?"));
    auto* column = new QVBoxLayout(dialog);
    auto* teeth = new ToothChart(dialog);
    teeth->setObjectName(QStringLiteral("scanToothChart"));
    std::set<int> all;
    for (const bool primary : {false, true})
        for (const auto& arch : {upperArch(primary), lowerArch(primary)})
            all.insert(arch.begin(), arch.end());
    teeth->setAvailable(all);
    teeth->setChosen(fdi_);
    teeth->setPrimaryShown(fdi_ > 50);
    column->addWidget(teeth, 1);
    auto* milk = named(new QCheckBox(tr("Primary teeth too"), dialog), "scanPrimaryTeeth",
                       tr("Show the primary teeth inside the arches"));
    milk->setChecked(fdi_ > 50);
    column->addWidget(milk);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Cancel, dialog);
    column->addWidget(buttons);
    connect(milk, &QCheckBox::toggled, teeth, &ToothChart::setPrimaryShown);
    connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    connect(teeth, &ToothChart::toothChosen, this, [this, dialog](int fdi) {
        dialog->accept();
        emit toothChosen(fdi);
    });
    dialog->resize(480, 560);
    dialog->open();
}

}  // namespace handpiece::desktop
