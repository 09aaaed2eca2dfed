// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/scan/reading_fields.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include "desktop/features/scan/choose_page.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"

namespace handpiece::desktop {

using segmentation::LabelNumbers;

ReadingFields::ReadingFields(ScanModel& model, ScanQuestions& questions, QWidget* parent)
    : QWidget(parent), model_(model), questions_(questions) {
    auto* column = new QVBoxLayout(this);
    column->setContentsMargins(0, 0, 0, 0);
    part_ = named(new QCheckBox(tr("Read only a part of it"), this), "scanPart", tr("Read only a part of the scan"),
                  tr("A box around the tooth: what lies in it is read in full detail, however large the scan is"));
    column->addWidget(part_);
    column->addWidget(corners_ = regionFields());
    labels_ = named(new QCheckBox(tr("These are tissues already, not grey values"), this), "scanIsLabels",
                    tr("This is a label volume"),
                    tr("A label volume from another program: teeth by FDI numbers, or 0 nothing, 1 caries, 2 enamel, 3 "
                       "dentine, 4 pulp, 5 filling"));
    column->addWidget(labels_);
    column->addWidget(meaning_ = labelFields());
    connect(labels_, &QCheckBox::toggled, this,
            [this](bool on) { decide([on](scan_case::ScanJob& job) { job.isLabels = on; }); });
    connect(part_, &QCheckBox::toggled, this, [this](bool on) {
        decide([&](scan_case::ScanJob& job) {
            job.regionMm.reset();
            if (!on) return;
            // At first all of it; until it is read nobody knows where it lies.
            std::array<core::Vec3, 2> corners{core::Vec3::Zero(), core::Vec3::Constant(20.0)};
            if (const auto scan = model_.scan()) {
                const volume::Grid& grid = scan->scan->volume.grid;
                core::Box box;
                for (int n = 0; n < 8; ++n)
                    box.extend(grid.toMm(core::Vec3(n & 1 ? grid.size[0] - 1 : 0, n & 2 ? grid.size[1] - 1 : 0,
                                                    n & 4 ? grid.size[2] - 1 : 0)));
                corners = {box.min, box.max};
            }
            job.regionMm = corners;
        });
    });
}

QWidget* ReadingFields::regionFields() {
    auto* fields = new QWidget(this);
    auto* grid = new QGridLayout(fields);
    grid->setContentsMargins(22, 0, 0, 0);
    const std::array<const char*, 6> names{"scanPartFromX", "scanPartFromY", "scanPartFromZ",
                                           "scanPartToX",   "scanPartToY",   "scanPartToZ"};
    grid->addWidget(new QLabel(tr("From"), fields), 0, 0);
    grid->addWidget(new QLabel(tr("To"), fields), 1, 0);
    for (std::size_t n = 0; n < 6; ++n) {
        const QString axis = QStringLiteral("xyz").mid(static_cast<int>(n % 3), 1);
        auto* box = named(new DecimalField(fields), names[n], (n < 3 ? tr("From, %1") : tr("To, %1")).arg(axis));
        box->setDecimals(1);
        box->setRange(-2000.0, 2000.0);
        box->setPrefix(axis + QLatin1Char(' '));
        box->setSuffix(tr(" mm"));
        connect(box, &DecimalField::valueChanged, this, [this] { takeRegion(); });
        grid->addWidget(corner_[n] = box, static_cast<int>(n / 3), 1 + static_cast<int>(n % 3));
    }
    grid->setColumnStretch(4, 1);
    return fields;
}

QWidget* ReadingFields::labelFields() {
    auto* fields = new QWidget(this);
    auto* form = new QFormLayout(fields);
    form->setContentsMargins(22, 0, 0, 0);
    numbers_ = named(new QComboBox(fields), "scanNumbers", tr("What the numbers mean"));
    numbers_->addItem(tr("As the file says"), -1);
    numbers_->addItem(tr("Teeth, FDI (11 to 48)"), static_cast<int>(LabelNumbers::fdi));
    numbers_->addItem(tr("Teeth, universal (1 to 32)"), static_cast<int>(LabelNumbers::universal));
    numbers_->addItem(tr("Teeth, one after the other"), static_cast<int>(LabelNumbers::consecutive));
    numbers_->addItem(tr("Tissues of one tooth"), static_cast<int>(LabelNumbers::tissues));
    form->addRow(tr("What the numbers mean"), numbers_);
    auto* row = new QHBoxLayout;
    grey_ = named(new QPushButton(icon(QStringLiteral("open")), tr("Choose..."), fields), "scanGrey",
                  tr("Choose the scan that the labels were made from"),
                  tr("It shows enamel, dentine and pulp in each tooth, where the labels know only teeth"));
    noGrey_ = named(new QPushButton(icon(QStringLiteral("close")), tr("Without"), fields), "scanGreyRemove",
                    tr("Without the scan that the labels were made from"));
    greyFile_ = new QLabel(fields);
    greyFile_->setObjectName(QStringLiteral("scanGreyFile"));
    row->addWidget(greyFile_);
    row->addWidget(grey_);
    row->addWidget(noGrey_);
    row->addStretch(1);
    form->addRow(tr("Scan that they were made from"), row);
    connect(numbers_, &QComboBox::activated, this, [this] {
        const int value = numbers_->currentData().toInt();
        decide([value](scan_case::ScanJob& job) {
            job.labelNumbers.reset();
            if (value >= 0) job.labelNumbers = static_cast<LabelNumbers>(value);
        });
    });
    connect(grey_, &QPushButton::clicked, this, [this] {
        const QString file = questions_.fileToOpen(
            tr("The scan that the labels were made from"),
            tr("Scans (*.nrrd *.nhdr *.nii *.nii.gz *.mha *.mhd *.zip *.dcm *.tif *.tiff *.toml DICOMDIR);;All files "
               "(*)"));
        if (!file.isEmpty()) decide([&](scan_case::ScanJob& job) { job.grey = toPath(file); });
    });
    connect(noGrey_, &QPushButton::clicked, this,
            [this] { decide([](scan_case::ScanJob& job) { job.grey.clear(); }); });
    return fields;
}

void ReadingFields::decide(const std::function<void(scan_case::ScanJob&)>& change) {
    if (showing_) return;
    scan_case::ScanJob job = model_.job();
    change(job);
    model_.decide(job);
}

void ReadingFields::takeRegion() {
    if (!part_->isChecked()) return;
    decide([this](scan_case::ScanJob& job) {
        std::array<core::Vec3, 2> corners;
        for (std::size_t n = 0; n < 6; ++n)
            corners[n / 3][static_cast<int>(n % 3)] = corner_[n]->value();
        job.regionMm = corners;
    });
}

void ReadingFields::showJob() {
    showing_ = true;
    const scan_case::ScanJob& job = model_.job();
    part_->setChecked(job.regionMm.has_value());
    corners_->setVisible(job.regionMm.has_value());
    if (job.regionMm)
        for (std::size_t n = 0; n < 6; ++n)
            corner_[n]->setValue((*job.regionMm)[n / 3][static_cast<int>(n % 3)]);
    labels_->setChecked(model_.isLabels());
    meaning_->setVisible(model_.isLabels());
    numbers_->setCurrentIndex(numbers_->findData(job.labelNumbers ? static_cast<int>(*job.labelNumbers) : -1));
    greyFile_->setText(job.grey.empty() ? tr("None") : toQString(job.grey.filename()));
    noGrey_->setVisible(!job.grey.empty());
    showing_ = false;
}

}  // namespace handpiece::desktop
