// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/measure/measure_box.h"

#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QPainter>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>
#include <cmath>
#include <utility>

#include "desktop/features/measure/pass_row.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/press_words.h"
#include "desktop/widgets/pulp_words.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

namespace {

constexpr double kLoadStepN = 0.1, kOffsetStepMm = 0.1;

}  // namespace

/// Three lamps, one of them lit; its place tells as much as its colour.
class TrafficLight : public QWidget {
  public:
    explicit TrafficLight(QWidget* parent) : QWidget(parent) { setFixedSize(58, 22); }
    /// -1 none, 0 green, 1 amber, 2 red.
    void setLit(int lit) {
        lit_ = lit;
        update();
    }

  protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        painter.setRenderHint(QPainter::Antialiasing);
        const Tones tones = tonesOf(palette());
        const QColor colours[] = {tones.good, tones.caution, tones.bad};
        for (int i = 0; i < 3; ++i) {
            const QRectF lamp(3 + i * 18, 4, 14, 14);
            painter.setPen(QPen(i == lit_ ? colours[i] : tones.line, 1.5));
            painter.setBrush(i == lit_ ? QBrush(colours[i]) : QBrush(Qt::NoBrush));
            painter.drawEllipse(lamp);
        }
    }

  private:
    int lit_ = -1;
};

MeasureBox::MeasureBox(QWidget* parent) : QWidget(parent) {
    setObjectName("measureBox");
    setAccessibleName(tr("Measuring"));
    auto* column = new QVBoxLayout(this);
    column->setSpacing(6);
    auto* readouts = new QGridLayout;
    readouts->setColumnStretch(0, 1);
    readouts->setVerticalSpacing(2);
    const auto readout = [&](int row, const QString& text, const char* object, const QString& tip, QLabel*& caption,
                             QLabel*& value) {
        caption = new QLabel(text, this);
        value = named(new QLabel(this), object, text, tip);
        value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
        value->setTextInteractionFlags(Qt::TextSelectableByMouse);
        readouts->addWidget(caption, row, 0);
        readouts->addWidget(value, row, 1);
    };
    readout(0, tr("Depth below the surface"), "depthReadout", tr("How deep the tip is below the tooth's first surface"),
            depthCaption_, depth_);
    readout(1, tr("Distance measured"), "calliperReadout", tr("Between the two points of the calliper"),
            calliperCaption_, calliper_);
    readout(2, tr("Remaining dentine thickness"), "pulpReadout",
            tr("Remaining dentine thickness between the bur and the pulp"), leftCaption_, left_);
    column->addLayout(readouts);
    auto* lights = new QHBoxLayout;
    light_ = new TrafficLight(this);
    leftWords_ = named(new QLabel(this), "pulpWords", tr("Remaining dentine thickness, in words"));
    lights->addWidget(light_);
    lights->addWidget(leftWords_, 1);
    column->addLayout(lights);
    locked_ = note(tr("This exercise hides the depths."), this, "depthLocked");
    locked_->hide();
    column->addWidget(locked_);
    calliperButton_ = named(new QToolButton(this), "calliperButton", tr("Calliper"),
                            tr("Click two points on the tooth to measure between them (D)"));
    calliperButton_->setIcon(icon("calliper"));
    calliperButton_->setText(tr("Measure a distance"));
    calliperButton_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
    calliperButton_->setCheckable(true);
    calliperButton_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
    column->addWidget(calliperButton_);

    auto* loadRow = new QWidget(this);
    auto* load = new QHBoxLayout(loadRow);
    load->setContentsMargins(0, 0, 0, 0);
    loadCaption_ = new QLabel(loadRow);
    load_ = named(new QSlider(Qt::Horizontal, loadRow), "loadSlider", tr("How hard to press"),
                  tr("How hard the left button presses (Shift and the wheel)"));
    load_->setRange(qRound(kMinLoadN / kLoadStepN), qRound(kMaxLoadN / kLoadStepN));
    load_->setPageStep(5);
    loadValue_ = new QLabel(loadRow);
    loadValue_->setObjectName("loadReadout");
    loadValue_->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    loadCaption_->setBuddy(load_);
    load->addWidget(loadCaption_);
    load->addWidget(load_, 1);
    load->addWidget(loadValue_);
    column->addWidget(loadRow);

    auto* stopRow = new QHBoxLayout;
    stopOn_ = named(new QCheckBox(tr("Stop at a depth of"), this), "depthStopOn", tr("Depth stop"),
                    tr("The bur goes no deeper than this (Ctrl and the wheel)"));
    stop_ = named(new DecimalField(this), "depthStop", tr("Depth of the stop"));
    stop_->setRange(kLeastStopMm, kMaxStopMm);
    stop_->setSingleStep(0.1);
    stop_->setDecimals(1);
    stop_->setValue(kFirstStopMm);
    stop_->setSuffix(tr(" mm"));
    stopOn_->setChecked(true);
    stopRow->addWidget(stopOn_, 1);
    stopRow->addWidget(stop_);
    column->addLayout(stopRow);
    passRow_ = new PassRow(this);
    column->addWidget(passRow_);

    auto* sectionRow = new QHBoxLayout;
    sectionOn_ = named(new QCheckBox(tr("Section"), this), "sectionOn", tr("Cut the tooth open"),
                       tr("Cut the tooth open to look inside (X)"));
    orientation_ = named(new QComboBox(this), "sectionOrientation", tr("Direction of the section"));
    orientation_->addItem(tr("Bucco-lingual"), static_cast<int>(Orientation::buccolingual));
    orientation_->addItem(tr("Mesio-distal"), static_cast<int>(Orientation::mesiodistal));
    orientation_->addItem(tr("Horizontal"), static_cast<int>(Orientation::horizontal));
    sectionRow->addWidget(sectionOn_);
    sectionRow->addWidget(orientation_, 1);
    column->addLayout(sectionRow);
    auto* offsetRow = new QHBoxLayout;
    offset_ = named(new QSlider(Qt::Horizontal, this), "sectionSlider", tr("Place of the section"));
    offsetValue_ = named(new DecimalField(this), "sectionOffset", tr("Place of the section in millimetres"));
    offsetValue_->setDecimals(1);
    offsetValue_->setSingleStep(kOffsetStepMm);
    offsetValue_->setSuffix(tr(" mm"));
    offsetRow->addWidget(offset_, 1);
    offsetRow->addWidget(offsetValue_);
    column->addLayout(offsetRow);
    column->addStretch(1);

    connect(calliperButton_, &QToolButton::toggled, this, &MeasureBox::calliperToggled);
    connect(load_, &QSlider::valueChanged, this, [this](int value) {
        loadN_ = value * kLoadStepN;
        showLoad();
        emit loadChanged(loadN_);
    });
    connect(stopOn_, &QCheckBox::toggled, this, [this](bool on) {
        stop_->setEnabled(on);
        emit depthStopChanged(on ? stop_->value() : 0.0);
    });
    connect(stop_, &DecimalField::valueChanged, this, [this](double value) {
        if (stopOn_->isChecked()) emit depthStopChanged(value);
    });
    connect(sectionOn_, &QCheckBox::toggled, this, [this] { tellSection(); });
    connect(orientation_, &QComboBox::activated, this, [this] { tellSection(); });
    const auto move = [this](double offsetMm) {
        if (std::abs(offsetMm - offsetMm_) < 1e-9) return;
        offsetMm_ = offsetMm;
        const QSignalBlocker quietSlider(offset_), quietSpin(offsetValue_);
        offset_->setValue(qRound(offsetMm_ / kOffsetStepMm));
        offsetValue_->setValue(offsetMm_);
        tellSection();
    };
    connect(offset_, &QSlider::valueChanged, this, [move](int value) { move(value * kOffsetStepMm); });
    connect(offsetValue_, &DecimalField::valueChanged, this, move);

    setSectionRange(-10, 10);
    setSection(false, Orientation::buccolingual, 0);
    setDepth({});
    setCalliper({});
    setLeftOverPulp({});
    setLoad(1.0);
    setDetail(Detail::practice);
}

void MeasureBox::setDepth(const std::optional<double>& depthMm) {
    depth_->setText(depthMm ? quantity(*depthMm, detail_ == Detail::practice ? 1 : 2, tr("mm")) : QStringLiteral("–"));
}

void MeasureBox::setCalliper(const std::optional<double>& distanceMm) {
    calliper_->setText(distanceMm ? quantity(*distanceMm, 2, tr("mm")) : QStringLiteral("–"));
}

void MeasureBox::setLeftOverPulp(const std::optional<double>& leftMm, bool exposed) {
    left_->setText(exposed  ? quantity(0.0, 1, tr("mm"))
                   : leftMm ? quantity(*leftMm, 2, tr("mm"))
                            : QStringLiteral("–"));
    const measure::PulpLight light =
        exposed ? measure::PulpLight::harmed : measure::pulpLight(leftMm.value_or(0.0), pulpLimits_);
    const int lit = exposed || leftMm ? static_cast<int>(light) : -1;
    light_->setLit(lit);
    leftWords_->setText(exposed ? tr("Pulp exposed") : lit < 0 ? QString() : pulpWords(light, pulpLimits_));
    const Tones tones = tonesOf(palette());
    const QColor colours[] = {tones.good, tones.caution, tones.bad};
    QPalette colour = palette();
    if (lit >= 0) colour.setColor(QPalette::WindowText, colours[lit]);
    leftWords_->setPalette(colour);
}

void MeasureBox::setLoad(double loadN) {
    const QSignalBlocker quiet(load_);
    loadN_ = std::clamp(std::isfinite(loadN) ? loadN : 1.0, kMinLoadN, kMaxLoadN);
    load_->setValue(qRound(loadN_ / kLoadStepN));
    showLoad();
}

void MeasureBox::setPressLimits(const instrument::PressLimits& limits) {
    press_ = limits;
    showLoad();
}

void MeasureBox::showLoad() {
    const QString words = pressWords(loadN_, press_);
    loadValue_->setText(detail_ == Detail::practice ? words : quantity(loadN_, 1, tr("N")));
    load_->setAccessibleDescription(words);
}

void MeasureBox::setDepthStop(double stopMm) {
    const QSignalBlocker quietOn(stopOn_), quietStop(stop_);
    stopOn_->setChecked(stopMm > 0);
    stop_->setEnabled(stopMm > 0);
    if (stopMm > 0) stop_->setValue(stopMm);
}

void MeasureBox::keepDepthStop(bool isOn, double stopMm) {
    setDepthStop(stopMm);
    if (!isOn) setDepthStop(0.0);
}

std::optional<double> MeasureBox::depthStopMm() const {
    return stopOn_->isChecked() ? std::optional(stop_->value()) : std::nullopt;
}

void MeasureBox::setSectionRange(double leastMm, double mostMm) {
    const QSignalBlocker quietSlider(offset_), quietSpin(offsetValue_);
    offset_->setRange(qRound(leastMm / kOffsetStepMm), qRound(mostMm / kOffsetStepMm));
    offset_->setPageStep(10);
    offsetValue_->setRange(leastMm, mostMm);
    offsetMm_ = std::clamp(offsetMm_, leastMm, mostMm);
}

void MeasureBox::setSection(bool on, Orientation orientation, double offsetMm) {
    const QSignalBlocker quietOn(sectionOn_), quietOrientation(orientation_), quietSlider(offset_),
        quietSpin(offsetValue_);
    sectionOn_->setChecked(on);
    orientation_->setCurrentIndex(orientation_->findData(static_cast<int>(orientation)));
    offsetValue_->setValue(offsetMm);
    offsetMm_ = offsetValue_->value();
    offset_->setValue(qRound(offsetMm_ / kOffsetStepMm));
    for (QWidget* w : std::initializer_list<QWidget*>{orientation_, offset_, offsetValue_})
        w->setEnabled(on);
}

void MeasureBox::tellSection() {
    const bool on = sectionOn_->isChecked();
    for (QWidget* w : std::initializer_list<QWidget*>{orientation_, offset_, offsetValue_})
        w->setEnabled(on);
    emit sectionChanged(on, static_cast<Orientation>(orientation_->currentData().toInt()), offsetMm_);
}

void MeasureBox::setCalliperActive(bool active) {
    const QSignalBlocker quiet(calliperButton_);
    calliperButton_->setChecked(active);
}

void MeasureBox::setPermissions(const exercise::Permissions& permissions) {
    using exercise::Operation;
    const bool depth = permissions.allows(Operation::depthReadout), calliper = permissions.allows(Operation::calliper);
    for (QWidget* w : std::initializer_list<QWidget*>{depth_, depthCaption_, left_, leftCaption_, leftWords_, light_})
        w->setVisible(depth);
    for (QWidget* w : std::initializer_list<QWidget*>{calliper_, calliperCaption_})
        w->setVisible(calliper);
    locked_->setVisible(permissions.locks(Operation::depthReadout));
    const auto take = [&permissions](QWidget* widget, Operation operation, const QString& locked, const QString& tip) {
        widget->setEnabled(permissions.allows(operation));
        widget->setToolTip(permissions.locks(operation) ? locked : tip);
    };
    take(calliperButton_, Operation::calliper, tr("This exercise has no calliper."),
         tr("Click two points on the tooth to measure between them (D)"));
    take(stopOn_, Operation::depthStop, tr("This exercise has no depth stop."),
         tr("The bur goes no deeper than this (Ctrl and the wheel)"));
    take(sectionOn_, Operation::section, tr("This exercise has no sections."),
         tr("Cut the tooth open to look inside (X)"));
    // A stop that was on waits while it may not be, in a replay for one.
    if (!stopOn_->isEnabled())
        stopWaits_ = stopWaits_ || stopOn_->isChecked();
    else if (std::exchange(stopWaits_, false))
        stopOn_->setChecked(true);
    for (QCheckBox* box : {stopOn_, sectionOn_})
        if (!box->isEnabled() && box->isChecked()) box->setChecked(false);
}

void MeasureBox::setDetail(Detail detail) {
    detail_ = detail;
    const bool practice = detail == Detail::practice;
    for (QLabel* label : {depth_, calliper_, left_})
        label->setFont(scaledFont(font(), practice ? 1.7 : 1.25, true));
    loadCaption_->setText(practice ? tr("Press") : tr("Load"));
    loadValue_->setMinimumWidth(practice ? fontMetrics().horizontalAdvance(pressWords(0.5 * press_.lightN, press_)) + 4
                                         : fontMetrics().horizontalAdvance("0.0 N") + 4);
    showLoad();
}

}  // namespace handpiece::desktop
