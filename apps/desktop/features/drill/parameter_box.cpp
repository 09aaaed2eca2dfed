// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/drill/parameter_box.h"

#include <QComboBox>
#include <QCoreApplication>
#include <QGridLayout>
#include <QHeaderView>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/notation.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

constexpr int kStepsPerOne = 100;
constexpr int kVoxelsUm[] = {25, 50, 100};
enum Column { tissueColumn, springColumn, damperColumn, frictionColumn, cuttingColumn, columnCount };

QString withMark(double given, bool clipped) {
    const QString number = QLocale().toString(given, 'g', 3);
    return clipped ? number + QStringLiteral(" ▲") : number;
}

}  // namespace

ParameterBox::ParameterBox(QWidget* parent) : QWidget(parent) {
    setObjectName("parameterBox");
    setAccessibleName(tr("What the tooth feels like"));
    auto* column = new QVBoxLayout(this);
    column->setSpacing(6);
    heading_ = heading(tr("What the tooth feels like"), this);
    column->addWidget(heading_);
    auto* top = new QHBoxLayout;
    top->addWidget(note(tr("Multiplies every tissue's own value; 1 is the tissue's own."), this), 1);
    reset_ = named(new QPushButton(icon("reset"), tr("Reset"), this), "parametersReset",
                   tr("Reset spring, damper and friction"), tr("Back to the tissues' own values (all at 1)"));
    top->addWidget(reset_);
    column->addLayout(top);
    auto* grid = new QGridLayout;
    grid->setColumnStretch(1, 1);
    rows_[0] = addRow(grid, 0, "spring", &Multipliers::stiffness);
    rows_[1] = addRow(grid, 1, "damper", &Multipliers::damping);
    rows_[2] = addRow(grid, 2, "friction", &Multipliers::friction);
    column->addLayout(grid);

    tableCaption_ = heading(tr("Each tissue as the hand feels it"), this);
    column->addWidget(tableCaption_);
    table_ = named(new QTableWidget(0, columnCount, this), "tissueTable", tr("Each tissue as the hand feels it"));
    table_->setToolTip({});
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->setSelectionMode(QAbstractItemView::SingleSelection);
    table_->setSelectionBehavior(QAbstractItemView::SelectRows);
    table_->setAlternatingRowColors(true);
    table_->verticalHeader()->hide();
    table_->setHorizontalHeaderLabels(
        {tr("Tissue"), tr("Spring\n[N/mm]"), tr("Damper\n[N s/mm]"), tr("Friction"), tr("Cutting\n[µm²/N]")});
    const QStringList tips{tr("Tissue"),
                           tr("Stiffness: the tissue's fraction times the multiplier times the device's limit"),
                           tr("Damping on the approach"), tr("Coulomb friction of the still bur"),
                           tr("Volume a second for load, angular speed and radius; 0: cannot be cut")};
    for (int i = 0; i < columnCount; ++i)
        table_->horizontalHeaderItem(i)->setToolTip(tips[i]);
    table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
    // Every column as wide as what stands in it, in a narrow window too: what does not fit is scrolled to.
    table_->horizontalHeader()->setMinimumSectionSize(20);
    table_->horizontalHeader()->setFont(scaledFont(font(), 0.82));
    table_->setFont(scaledFont(font(), 0.92));
    table_->setVerticalScrollBarPolicy(Qt::ScrollBarAsNeeded);
    table_->setWordWrap(false);
    column->addWidget(table_, 100);
    clipNote_ = note({}, this, "clipNote");
    column->addWidget(clipNote_);
    limitsNote_ = note({}, this, "deviceLimits");
    column->addWidget(limitsNote_);

    auto* choices = new QGridLayout;
    choices->setColumnStretch(1, 1);
    forceName_ = new QLabel(tr("Force by"), this);
    force_ = named(new QComboBox(this), "forceMode", tr("Force model"));
    force_->addItem(tr("Proxy on the surface"), static_cast<int>(force::LawId::proxy));
    force_->addItem(tr("Penalty, as in the paper"), static_cast<int>(force::LawId::penalty));
    forceNote_ = note({}, this, "forceModeNote");
    forceName_->setBuddy(force_);
    force_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    methodName_ = new QLabel(tr("Contact by"), this);
    method_ = named(new QComboBox(this), "contactMethod", tr("Contact method"));
    method_->addItem(tr("Distance field (cuts)"), false);
    method_->addItem(tr("Convex hull, as in the paper (touch only)"), true);
    methodNote_ = note({}, this, "contactMethodNote");
    voxelName_ = new QLabel(tr("Voxel size"), this);
    voxel_ = named(new QComboBox(this), "voxelSize", tr("Voxel size"));
    for (const int um : kVoxelsUm)
        voxel_->addItem(tr("%1 µm").arg(um), um);
    voxelNote_ = note({}, this, "voxelSizeNote");
    methodName_->setBuddy(method_);
    voxelName_->setBuddy(voxel_);
    method_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    choices->addWidget(forceName_, 0, 0);
    choices->addWidget(force_, 0, 1);
    choices->addWidget(forceNote_, 1, 0, 1, 2);
    choices->addWidget(methodName_, 2, 0);
    choices->addWidget(method_, 2, 1);
    choices->addWidget(methodNote_, 3, 0, 1, 2);
    choices->addWidget(voxelName_, 4, 0);
    choices->addWidget(voxel_, 4, 1);
    choices->addWidget(voxelNote_, 5, 0, 1, 2);
    column->addLayout(choices);
    column->addStretch(1);  // takes the room when the table is hidden

    connect(reset_, &QPushButton::clicked, this, [this] {
        if (!(multipliers_ == Multipliers{})) {
            setMultipliers({});
            emit multipliersChanged(1.0, 1.0, 1.0);
        }
        emit resetRequested();
    });
    connect(force_, &QComboBox::activated, this, [this] {
        const auto mode = static_cast<force::LawId>(force_->currentData().toInt());
        setForceMode(mode);
        emit forceModeChosen(mode);
    });
    connect(method_, &QComboBox::activated, this, [this] {
        const bool hull = method_->currentData().toBool();
        if (hull == hull_) return;
        hull_ = hull;
        showCutting();
        emit hullMethodChosen(hull);
    });
    connect(voxel_, &QComboBox::activated, this, [this] {
        const int um = voxel_->currentData().toInt();
        if (um == voxelUm_) return;
        voxelUm_ = um;
        emit voxelChosen(um);
    });
    setLimits({}, {});
    setForceMode(force::LawId::proxy);
    setVoxelUm(50);
    showMultipliers();
    showCutting();
    setDetail(Detail::laboratory);
}

ParameterBox::Row ParameterBox::addRow(QGridLayout* grid, int row, const QString& object, double Multipliers::*value) {
    Row r;
    r.name = new QLabel(this);
    r.slider = new QSlider(Qt::Horizontal, this);
    r.slider->setObjectName(object + "Slider");
    r.slider->setRange(0, qRound(kLargest * kStepsPerOne));
    r.slider->setSingleStep(5);
    r.slider->setPageStep(25);
    r.slider->setTickPosition(QSlider::TicksBelow);
    r.slider->setTickInterval(kStepsPerOne);
    r.spin = new DecimalField(this);
    r.spin->setObjectName(object + "Spin");
    r.spin->setRange(0.0, kLargest);
    r.spin->setSingleStep(0.05);
    r.spin->setDecimals(2);
    r.spin->setPrefix(QStringLiteral("× "));
    r.name->setBuddy(r.slider);
    grid->addWidget(r.name, row, 0);
    grid->addWidget(r.slider, row, 1);
    grid->addWidget(r.spin, row, 2);
    const auto take = [this, value](double wanted) {
        if (multipliers_.*value == wanted) return;
        multipliers_.*value = wanted;
        showMultipliers();
        emit multipliersChanged(multipliers_.stiffness, multipliers_.damping, multipliers_.friction);
    };
    connect(r.slider, &QSlider::valueChanged, this, [take](int position) { take(double(position) / kStepsPerOne); });
    connect(r.spin, &DecimalField::valueChanged, this, take);
    return r;
}

void ParameterBox::setTissues(const cases::TissueTable& tissues) {
    tissues_ = tissues;
    showTable();
}

void ParameterBox::setPresent(const std::vector<cases::Tissue>& tissues) {
    present_ = tissues;
    showTable();
}

void ParameterBox::setLimits(const force::Limits& limits, const QString& device) {
    limits_ = limits;
    device_ = device;
    limitsNote_->setText(tr("%1 gives at most %2, %3 and %4.")
                             .arg(device_.isEmpty() ? tr("The device") : device_,
                                  quantity(limits.maxForceN, 2, tr("N")),
                                  quantity(limits.maxStiffnessNPerMm, 2, tr("N/mm")),
                                  quantity(limits.maxDampingNSPerMm, 4, tr("N s/mm"))));
    showTable();
}

void ParameterBox::setMultipliers(const Multipliers& multipliers) {
    const auto held = [](double value) { return std::isfinite(value) ? std::clamp(value, 0.0, kLargest) : 1.0; };
    multipliers_ = {held(multipliers.stiffness), held(multipliers.damping), held(multipliers.friction)};
    showMultipliers();
}

void ParameterBox::showMultipliers() {
    const double values[] = {multipliers_.stiffness, multipliers_.damping, multipliers_.friction};
    for (int i = 0; i < 3; ++i) {
        const QSignalBlocker quietSlider(rows_[i].slider), quietSpin(rows_[i].spin);
        rows_[i].slider->setValue(qRound(values[i] * kStepsPerOne));
        rows_[i].spin->setValue(values[i]);
    }
    showTable();
}

ParameterBox::Spring ParameterBox::springOf(cases::Tissue tissue) const {
    const double wanted = tissues_.of(tissue).stiffnessFraction * multipliers_.stiffness * limits_.maxStiffnessNPerMm;
    return {wanted, std::min(wanted, limits_.maxStiffnessNPerMm)};
}

ParameterBox::Spring ParameterBox::damperOf(cases::Tissue tissue) const {
    const double wanted = tissues_.of(tissue).dampingNSPerMm * multipliers_.damping;
    return {wanted, std::min(wanted, limits_.maxDampingNSPerMm)};
}

void ParameterBox::showTable() {
    std::vector<cases::Tissue> shown = present_;
    if (shown.empty())
        for (std::size_t i = 1; i < cases::kTissueCount; ++i)
            shown.push_back(static_cast<cases::Tissue>(i));
    table_->setRowCount(static_cast<int>(shown.size()));
    const QColor bad = tonesOf(palette()).bad;
    bool anyClipped = false;
    for (int row = 0; row < table_->rowCount(); ++row) {
        const cases::Tissue tissue = shown[static_cast<std::size_t>(row)];
        const auto& own = tissues_.of(tissue);
        const auto put = [&](int column, const QString& text, bool clipped = false, double wanted = 0) {
            auto* item = table_->item(row, column);
            if (!item) table_->setItem(row, column, item = new QTableWidgetItem);
            item->setText(text);
            item->setTextAlignment((column == tissueColumn ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
            item->setData(Qt::ForegroundRole, clipped ? QVariant(QBrush(bad)) : QVariant());
            item->setToolTip(
                clipped ? tr("Held by the device's limit: %1 was asked for.").arg(QLocale().toString(wanted, 'g', 3))
                        : QString());
            anyClipped |= clipped;
        };
        const Spring spring = springOf(tissue), damper = damperOf(tissue);
        put(tissueColumn, tissueName(tissue));
        put(springColumn, withMark(spring.givenNPerMm, spring.clipped()), spring.clipped(), spring.wantedNPerMm);
        put(damperColumn, withMark(damper.givenNPerMm, damper.clipped()), damper.clipped(), damper.wantedNPerMm);
        put(frictionColumn, QLocale().toString(own.friction * multipliers_.friction, 'g', 3));
        const double cuttingUm2PerN = 1e6 * own.cuttingMm2PerN;
        put(cuttingColumn, cuttingUm2PerN > 0 ? QLocale().toString(cuttingUm2PerN, cuttingUm2PerN < 100 ? 'g' : 'f',
                                                                   cuttingUm2PerN < 100 ? 3 : 0)
                                              : tr("none"));
    }
    table_->resizeRowsToContents();
    clipNote_->setText(anyClipped ? tr("▲ Held by the device's limit: the hand feels no more than that.")
                                  : tr("All values lie within what the device can give."));
}

void ParameterBox::setHullMethod(bool hull) {
    hull_ = hull;
    const QSignalBlocker quiet(method_);
    method_->setCurrentIndex(hull ? 1 : 0);
    showCutting();
}

void ParameterBox::setForceMode(force::LawId mode) {
    const QSignalBlocker quiet(force_);
    force_->setCurrentIndex(force_->findData(static_cast<int>(mode)));
    forceNote_->setText(mode == force::LawId::penalty
                            ? tr("Spring and damper by the depth alone, without friction; the bur sinks in.")
                            : tr("The bur stays on the surface; spring, damper and friction hold the hand to it."));
}

void ParameterBox::setVoxelUm(int um) {
    voxelUm_ = um;
    const QSignalBlocker quiet(voxel_);
    int index = voxel_->findData(um);
    if (index < 0) {  // a case opened with a size of its own
        voxel_->addItem(tr("%1 µm").arg(um), um);
        index = voxel_->count() - 1;
    }
    voxel_->setCurrentIndex(index);
}

void ParameterBox::setCutting(Cutting cutting) {
    cutting_ = cutting;
    showCutting();
}

void ParameterBox::showCutting() {
    const bool stroke = cutting_ == Cutting::stroke;
    method_->setEnabled(cutting_ == Cutting::none || (hull_ && !stroke));
    voxel_->setEnabled(!stroke);
    methodNote_->setText(stroke ? tr("Lift the bur first.")
                         : cutting_ == Cutting::begun
                             ? tr("The hull knows only whole teeth: reset the tooth to choose it.")
                         : hull_ ? tr("The hull touches but does not cut.")
                                 : tr("Changes at once."));
    voxelNote_->setText(
        stroke ? tr("Lift the bur first.")
        : cutting_ == Cutting::begun
            ? tr("What you cut will be cut again at the new size; this takes a while and can be cancelled.")
            : tr("The tooth is made anew at that size; smaller is finer and slower."));
}

void ParameterBox::setHeadingShown(bool shown) {
    heading_->setVisible(shown);
}

void ParameterBox::setDetail(Detail detail) {
    detail_ = detail;
    const bool practice = detail == Detail::practice;
    for (QWidget* w :
         std::initializer_list<QWidget*>{table_, tableCaption_, limitsNote_, clipNote_, forceName_, force_, forceNote_,
                                         methodName_, method_, methodNote_, voxelName_, voxel_, voxelNote_})
        w->setVisible(!practice);
    const QString names[][3] = {
        {tr("Hardness"), tr("How hard the tooth feels"), tr("How hard the tooth feels")},
        {tr("Cushion"), tr("How much the touch is cushioned"), tr("How much the touch is cushioned")},
        {tr("Roughness"), tr("How rough the surface feels"), tr("How rough the surface feels")},
        {tr("Spring"), tr("Multiplier of every tissue's stiffness"), tr("Spring multiplier")},
        {tr("Damper"), tr("Multiplier of every tissue's damping"), tr("Damper multiplier")},
        {tr("Friction"), tr("Multiplier of every tissue's friction"), tr("Friction multiplier")}};
    for (int i = 0; i < 3; ++i) {
        const auto& words = names[practice ? i : i + 3];
        rows_[i].name->setText(words[0]);
        for (QWidget* w : {static_cast<QWidget*>(rows_[i].slider), static_cast<QWidget*>(rows_[i].spin)}) {
            w->setToolTip(words[1]);
            w->setAccessibleName(words[2]);
        }
    }
}

}  // namespace handpiece::desktop
