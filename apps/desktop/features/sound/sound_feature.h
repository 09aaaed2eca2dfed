// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The window's sound: volumes, mixture, recordings of real drills.

#include <QTimer>
#include <functional>
#include <memory>
#include <optional>

#include "desktop/features/sound/sound_control.h"
#include "desktop/framework/feature.h"
#include "handpiece/senses/sound/player.h"

class QLabel;
class QSlider;

namespace handpiece::desktop {

class SoundFeature : public Feature {
    Q_OBJECT
  public:
    enum class Command { mute, motorLouder, motorSofter, cuttingLouder, cuttingSofter };
    explicit SoundFeature(const FeatureContext& context);

  private:
    void addMixSlider();
    void connectMix();
    void connectRecordings();
    void takeRecording(SoundControl::Channel channel, const QString& file);
    void readRecordings(std::function<void(const std::optional<Problem>&)> done);
    void recallRecordings();
    void toggleMicrophone(SoundControl::Channel channel, bool start);
    void show();

    CommandSet<Command> commands_;
    SoundControl* control_;
    QSlider* mix_;
    QLabel* note_;
    QTimer microphoneTimer_;
    sound::Recording recordings_[2];
    std::unique_ptr<sound::Microphone> microphone_;
};

}  // namespace handpiece::desktop
