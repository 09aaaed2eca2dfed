// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How loud the drill is and where its sound comes from.

#include <QWidget>

#include "desktop/widgets/detail.h"

class QCheckBox;
class QComboBox;
class QGridLayout;
class QLabel;
class QPushButton;
class QSlider;
class QToolButton;

namespace handpiece::desktop {

class LevelMeter;

/// Volumes, mixture, mute and sources [soundControl]. Volumes and the mixture are 0 to 1.
class SoundControl : public QWidget {
    Q_OBJECT
  public:
    enum class Channel { motor, cutting };
    Q_ENUM(Channel)
    enum class Source { synthesis, file, microphone };
    Q_ENUM(Source)

    explicit SoundControl(QWidget* parent = nullptr);

    // Setters tell nobody.
    void setVolumes(double motor, double cutting);
    /// 0: motor only, 1: cutting only, 0.5: both as their volumes say.
    void setMix(double mix);
    void setMuted(bool muted);
    /// What a channel plays now; `name` of the recording where there is one.
    void setSource(Channel channel, Source source, const QString& name = {});
    /// Peak 0..1 of what the microphone hears, about 20 times a second while recording.
    void setMicrophoneLevel(double peak);
    /// The channel the microphone records for now; `recording` false: not recording.
    void setRecording(Channel channel, bool recording);
    /// No sound card: says why; everything else stays usable.
    void setSilent(bool silent, const QString& reason = {});
    void setDetail(Detail detail);
    /// Off where a dock's title says it already.
    void setHeadingShown(bool shown);

  signals:
    void motorVolumeChanged(double volume);
    void cuttingVolumeChanged(double volume);
    void mixChanged(double mix);
    void mutedChanged(bool muted);
    void synthesisChosen(SoundControl::Channel channel);
    /// The window asks for a WAV file.
    void recordingFileRequested(SoundControl::Channel channel);
    /// Start (true) or end the recording with the microphone.
    void microphoneToggled(SoundControl::Channel channel, bool start);

  private:
    struct Row {
        QLabel* name;
        QComboBox* source;
        QLabel* file;
        QPushButton* record;
    };
    void addSourceRow(Channel channel, QGridLayout* grid, int row);
    void showRow(Channel channel);
    [[nodiscard]] Row& rowOf(Channel channel) { return rows_[channel == Channel::motor ? 0 : 1]; }

    QToolButton* mute_;
    QLabel *heading_, *silent_;
    QSlider *motor_, *cutting_, *mix_;
    QLabel *motorValue_, *cuttingValue_, *mixCaption_, *mixLeft_, *mixRight_;
    QWidget* sources_;
    LevelMeter* level_;
    Row rows_[2]{};
    Source source_[2]{Source::synthesis, Source::synthesis};
    bool recording_[2]{};
};

}  // namespace handpiece::desktop
