// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/sound/sound_control.h"

#include <QComboBox>
#include <QGridLayout>
#include <QPainter>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <QVBoxLayout>
#include <cmath>

#include "desktop/widgets/icon_factory.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/theme.h"

namespace handpiece::desktop {

/// A microphone's level: green, amber near full scale, red at it.
class LevelMeter : public QWidget {
  public:
    using QWidget::QWidget;
    void setPeak(double peak) {
        peak_ = std::clamp(peak, 0.0, 1.0);
        setAccessibleDescription(peak_ >= 0.99 ? SoundControl::tr("Too loud")
                                               : SoundControl::tr("Level %1 %").arg(qRound(100 * peak_)));
        update();
    }
    [[nodiscard]] QSize sizeHint() const override { return {120, 20}; }

  protected:
    void paintEvent(QPaintEvent*) override {
        QPainter painter(this);
        painter.setRenderHint(QPainter::Antialiasing);
        const Tones tones = tonesOf(palette());
        const QString words = peak_ >= 0.99   ? SoundControl::tr("Too loud")
                              : peak_ >= 0.03 ? SoundControl::tr("Good")
                                              : SoundControl::tr("Quiet");
        const double textWidth = QFontMetricsF(font()).horizontalAdvance(SoundControl::tr("Too loud")) + 8;
        const QRectF bar(0, height() / 2.0 - 4, std::max(10.0, width() - textWidth), 8);
        painter.setPen(Qt::NoPen);
        painter.setBrush(tones.line);
        painter.drawRoundedRect(bar, 4, 4);
        // In decibels from -48 to 0: loudness as one hears it.
        const double share = peak_ > 0.004 ? 1.0 + std::log10(peak_) * 20 / 48 : 0.0;
        painter.setBrush(peak_ >= 0.99 ? tones.bad : peak_ >= 0.7 ? tones.caution : tones.good);
        if (share > 0) painter.drawRoundedRect(QRectF(bar.left(), bar.top(), bar.width() * share, 8), 4, 4);
        painter.setPen(palette().color(QPalette::WindowText));
        painter.drawText(QRectF(bar.right() + 8, 0, textWidth, height()), Qt::AlignLeft | Qt::AlignVCenter, words);
    }

  private:
    double peak_ = 0.0;
};

namespace {

constexpr int kSteps = 100;

QSlider* shareSlider(QWidget* parent, const char* object, const QString& name, const QString& tip) {
    auto* slider = named(new QSlider(Qt::Horizontal, parent), object, name, tip);
    slider->setRange(0, kSteps);
    slider->setPageStep(10);
    slider->setSingleStep(5);
    return slider;
}
QString percent(int value) {
    return SoundControl::tr("%1 %").arg(value);
}

}  // namespace

SoundControl::SoundControl(QWidget* parent) : QWidget(parent) {
    setObjectName("soundControl");
    setAccessibleName(tr("Sound"));
    auto* column = new QVBoxLayout(this);
    column->setSpacing(6);
    auto* top = new QHBoxLayout;
    heading_ = heading(tr("Sound"), this);
    top->addWidget(heading_);
    top->addStretch(1);
    mute_ = iconButton("sound", "mute", tr("Mute"), this, tr("Sound off"));
    mute_->setCheckable(true);
    mute_->setText(tr("Mute"));
    top->addWidget(mute_);
    column->addLayout(top);
    silent_ = note({}, this, "soundSilent");
    silent_->hide();
    column->addWidget(silent_);

    auto* grid = new QGridLayout;
    grid->setColumnStretch(1, 1);
    const auto volume = [&](int row, const QString& text, const char* object, const QString& name, QSlider*& slider,
                            QLabel*& value) {
        auto* label = new QLabel(text, this);
        slider = shareSlider(this, object, name, name);
        slider->setValue(80);
        value = new QLabel(percent(80), this);
        value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
        value->setMinimumWidth(fontMetrics().horizontalAdvance(percent(100)) + 4);
        label->setBuddy(slider);
        grid->addWidget(label, row, 0);
        grid->addWidget(slider, row, 1);
        grid->addWidget(value, row, 2);
    };
    volume(0, tr("Motor"), "motorVolume", tr("Loudness of the motor"), motor_, motorValue_);
    volume(1, tr("Cutting"), "cuttingVolume", tr("Loudness of the cutting"), cutting_, cuttingValue_);
    mixCaption_ = new QLabel(tr("Mixture"), this);
    auto* mixRow = new QHBoxLayout;
    mixLeft_ = note(tr("motor"), this);
    mixRight_ = note(tr("cutting"), this);
    mixLeft_->setWordWrap(false);
    mixRight_->setWordWrap(false);
    mix_ = shareSlider(this, "soundMix", tr("Mixture of motor and cutting"),
                       tr("Mixture: left the motor alone, right the cutting alone"));
    mix_->setTickPosition(QSlider::TicksBelow);
    mix_->setTickInterval(50);
    mix_->setValue(50);
    mixCaption_->setBuddy(mix_);
    mixRow->addWidget(mixLeft_);
    mixRow->addWidget(mix_, 1);
    mixRow->addWidget(mixRight_);
    grid->addWidget(mixCaption_, 2, 0);
    grid->addLayout(mixRow, 2, 1, 1, 2);
    column->addLayout(grid);

    sources_ = new QWidget(this);
    sources_->setObjectName("soundSources");
    auto* sourceColumn = new QVBoxLayout(sources_);
    sourceColumn->setContentsMargins(0, 4, 0, 0);
    sourceColumn->addWidget(heading(tr("Where the sound comes from"), sources_));
    auto* sourceGrid = new QGridLayout;
    sourceGrid->setColumnStretch(1, 1);
    addSourceRow(Channel::motor, sourceGrid, 0);
    addSourceRow(Channel::cutting, sourceGrid, 2);
    sourceColumn->addLayout(sourceGrid);
    level_ = named(new LevelMeter(sources_), "microphoneLevel", tr("Level of the microphone"));
    level_->hide();
    sourceColumn->addWidget(level_);
    column->addWidget(sources_);
    column->addStretch(1);

    connect(mute_, &QToolButton::toggled, this, [this](bool muted) {
        mute_->setIcon(icon(muted ? "mute" : "sound"));
        mute_->setToolTip(muted ? tr("Sound on") : tr("Sound off"));
        emit mutedChanged(muted);
    });
    connect(motor_, &QSlider::valueChanged, this, [this](int value) {
        motorValue_->setText(percent(value));
        emit motorVolumeChanged(double(value) / kSteps);
    });
    connect(cutting_, &QSlider::valueChanged, this, [this](int value) {
        cuttingValue_->setText(percent(value));
        emit cuttingVolumeChanged(double(value) / kSteps);
    });
    connect(mix_, &QSlider::valueChanged, this, [this](int value) { emit mixChanged(double(value) / kSteps); });
    setDetail(Detail::practice);
}

void SoundControl::addSourceRow(Channel channel, QGridLayout* grid, int row) {
    const bool motor = channel == Channel::motor;
    Row& r = rowOf(channel);
    r.name = new QLabel(motor ? tr("Motor") : tr("Cutting"), sources_);
    r.source = named(new QComboBox(sources_), motor ? "motorSource" : "cuttingSource",
                     motor ? tr("Source of the motor's sound") : tr("Source of the cutting's sound"));
    r.source->addItem(icon("sound"), tr("Computed"));
    r.source->addItem(icon("file"), tr("Recording from a file…"));
    r.source->addItem(icon("microphone"), tr("Record with the microphone"));
    r.file = note({}, sources_, motor ? "motorRecording" : "cuttingRecording");
    r.record = named(new QPushButton(sources_), motor ? "motorRecord" : "cuttingRecord",
                     motor ? tr("Record the motor") : tr("Record the cutting"),
                     tr("Record what the microphone hears; click again to end"));
    r.record->setIcon(icon("record"));
    r.name->setBuddy(r.source);
    grid->addWidget(r.name, row, 0);
    grid->addWidget(r.source, row, 1, 1, 2);
    grid->addWidget(r.file, row + 1, 1);
    grid->addWidget(r.record, row + 1, 2);
    connect(r.source, &QComboBox::activated, this, [this, channel](int choice) {
        Row& chosen = rowOf(channel);
        if (choice == static_cast<int>(Source::synthesis)) {
            setSource(channel, Source::synthesis);
            emit synthesisChosen(channel);
        } else if (choice == static_cast<int>(Source::file)) {
            // Until there is a file the source is what it was.
            showRow(channel);
            emit recordingFileRequested(channel);
        } else {
            source_[channel == Channel::motor ? 0 : 1] = Source::microphone;
            chosen.file->clear();
            showRow(channel);
        }
    });
    connect(r.record, &QPushButton::clicked, this,
            [this, channel] { emit microphoneToggled(channel, !recording_[channel == Channel::motor ? 0 : 1]); });
    showRow(channel);
}

void SoundControl::showRow(Channel channel) {
    const int i = channel == Channel::motor ? 0 : 1;
    const Row& r = rows_[i];
    const QSignalBlocker quiet(r.source);
    r.source->setCurrentIndex(static_cast<int>(source_[i]));
    r.source->setEnabled(!recording_[i]);
    r.record->setVisible(source_[i] == Source::microphone);
    r.record->setEnabled(!recording_[1 - i]);
    r.record->setText(recording_[i] ? tr("End recording") : tr("Record"));
    r.record->setIcon(icon(recording_[i] ? "stop" : "record"));
    r.file->setVisible(!r.file->text().isEmpty() || source_[i] == Source::microphone);
}

void SoundControl::setVolumes(double motor, double cutting) {
    const QSignalBlocker quietMotor(motor_), quietCutting(cutting_);
    motor_->setValue(qRound(motor * kSteps));
    cutting_->setValue(qRound(cutting * kSteps));
    motorValue_->setText(percent(motor_->value()));
    cuttingValue_->setText(percent(cutting_->value()));
}

void SoundControl::setMix(double mix) {
    const QSignalBlocker quiet(mix_);
    mix_->setValue(qRound(mix * kSteps));
}

void SoundControl::setMuted(bool muted) {
    const QSignalBlocker quiet(mute_);
    mute_->setChecked(muted);
    mute_->setIcon(icon(muted ? "mute" : "sound"));
    mute_->setToolTip(muted ? tr("Sound on") : tr("Sound off"));
}

void SoundControl::setSource(Channel channel, Source source, const QString& name) {
    source_[channel == Channel::motor ? 0 : 1] = source;
    rowOf(channel).file->setText(name);
    showRow(channel);
}

void SoundControl::setMicrophoneLevel(double peak) {
    level_->setPeak(peak);
}

void SoundControl::setRecording(Channel channel, bool recording) {
    recording_[channel == Channel::motor ? 0 : 1] = recording;
    level_->setPeak(0);
    level_->setVisible(recording_[0] || recording_[1]);
    showRow(Channel::motor);
    showRow(Channel::cutting);
}

void SoundControl::setSilent(bool silent, const QString& reason) {
    silent_->setText(reason.isEmpty() ? tr("No sound card was found: everything else works.") : reason);
    silent_->setVisible(silent);
}

void SoundControl::setHeadingShown(bool shown) {
    heading_->setVisible(shown);
    mute_->setToolButtonStyle(shown ? Qt::ToolButtonIconOnly : Qt::ToolButtonTextBesideIcon);
}

void SoundControl::setDetail(Detail detail) {
    for (QWidget* w : std::initializer_list<QWidget*>{mixCaption_, mixLeft_, mix_, mixRight_})
        w->setVisible(detail != Detail::practice);
    sources_->setVisible(detail != Detail::practice);
}

}  // namespace handpiece::desktop
