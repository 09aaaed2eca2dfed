// SPDX-License-Identifier: Apache-2.0
// The window's sound: volumes, mixture, recordings of real drills.
#include <QLabel>
#include <QSlider>

#include "panels/sound_control.h"
#include "shell/job_strip.h"
#include "shell/main_window.h"

namespace handpiece::desktop {
namespace {

constexpr double kVolumeStep = 0.1;
constexpr int kMicrophoneMs = 50;
constexpr const char *kFileKeys[] = {"sound/motorFile", "sound/cuttingFile"},
                     *kRpmKeys[] = {"sound/motorFileRpm", "sound/cuttingFileRpm"};

}  // namespace

void MainWindow::connectSound() {
    const Actions& a = *actions_;
    sound::Mix mix = simulator_.mix();
    mix.motor = settings_.number(QStringLiteral("sound/motor"), mix.motor, 0.0, 1.0);
    mix.cutting = settings_.number(QStringLiteral("sound/cutting"), mix.cutting, 0.0, 1.0);
    mix.balance = settings_.number(QStringLiteral("sound/balance"), mix.balance, 0.0, 1.0);
    mix.muted = settings_.value(QStringLiteral("sound/muted"), false).toBool();
    simulator_.setMix(mix);
    const auto change = [this](auto set) {
        return [this, set](auto value) {
            sound::Mix next = simulator_.mix();
            set(next, value);
            simulator_.setMix(next);
            settings_.set(QStringLiteral("sound/motor"), next.motor);
            settings_.set(QStringLiteral("sound/cutting"), next.cutting);
            settings_.set(QStringLiteral("sound/balance"), next.balance);
            settings_.set(QStringLiteral("sound/muted"), next.muted);
            showSound();
        };
    };
    connect(sound_, &SoundControl::motorVolumeChanged, this, change([](sound::Mix& m, double v) { m.motor = v; }));
    connect(sound_, &SoundControl::cuttingVolumeChanged, this, change([](sound::Mix& m, double v) { m.cutting = v; }));
    connect(sound_, &SoundControl::mixChanged, this, change([](sound::Mix& m, double v) { m.balance = v; }));
    connect(sound_, &SoundControl::mutedChanged, this, change([](sound::Mix& m, bool v) { m.muted = v; }));
    connect(mix_, &QSlider::valueChanged, this, change([](sound::Mix& m, int v) { m.balance = 0.01 * v; }));
    connect(a["actionMute"], &QAction::triggered, this, change([](sound::Mix& m, bool v) { m.muted = v; }));
    const auto step = [&](const char* name, double sound::Mix::*which, double by) {
        connect(a[name], &QAction::triggered, this,
                change([which, by](sound::Mix& m, bool) { m.*which = std::clamp(m.*which + by, 0.0, 1.0); }));
    };
    step("actionMotorLouder", &sound::Mix::motor, kVolumeStep);
    step("actionMotorSofter", &sound::Mix::motor, -kVolumeStep);
    step("actionCuttingLouder", &sound::Mix::cutting, kVolumeStep);
    step("actionCuttingSofter", &sound::Mix::cutting, -kVolumeStep);
    connect(sound_, &SoundControl::synthesisChosen, this,
            [this](SoundControl::Channel channel) { takeRecording(channel, {}); });
    connect(sound_, &SoundControl::recordingFileRequested, this, [this](SoundControl::Channel channel) {
        const QString file = questions.fileToOpen(tr("Sound of a real drill"), startFolder(), tr("Sound (*.wav)"));
        file.isEmpty() ? showSound() : takeRecording(channel, file);
    });
    connect(sound_, &SoundControl::microphoneToggled, this, &MainWindow::toggleMicrophone);
    microphoneTimer_.setInterval(kMicrophoneMs);
    connect(&microphoneTimer_, &QTimer::timeout, this, [this] {
        if (microphone_) sound_->setMicrophoneLevel(microphone_->poll());
    });
}

void MainWindow::takeRecording(SoundControl::Channel channel, const QString& file) {
    if (simulator_.isReadingSound()) {
        showSound();
        return;
    }
    const int which = static_cast<int>(channel);
    const sound::Recording before = recordings_[which];
    recordings_[which] = {toPath(file), file.isEmpty() ? 0.0 : simulator_.setSpeedRpm()};
    readRecordings([this, which, before](const std::optional<Problem>& problem) {
        if (problem) {
            recordings_[which] = before;
            showProblem(*problem);
        }
        for (const int k : {0, 1}) {
            settings_.set(QLatin1String(kFileKeys[k]), toQString(recordings_[k].file));
            settings_.set(QLatin1String(kRpmKeys[k]), recordings_[k].recordedAtRpm);
        }
    });
}

/// Long files take seconds: beside the window, with the strip that says so.
void MainWindow::readRecordings(std::function<void(const std::optional<Problem>&)> done) {
    if (simulator_.isReadingSound()) return;
    const bool strip = !simulator_.isBusy();
    if (strip) job_->begin(tr("Reading the sound"));
    simulator_.setRecordings(
        recordings_[0], recordings_[1],
        [self = QPointer<MainWindow>(this), strip, done = std::move(done)](const std::optional<Problem>& problem) {
            if (!self) return;
            if (strip && !self->simulator_.isBusy()) self->job_->end();
            done(problem);
            self->showSound();
        });
    showSound();
}

/// What was chosen before; a file that is gone is not worth a word at the start.
void MainWindow::recallRecordings() {
    std::error_code error;
    for (const int k : {0, 1}) {
        const std::filesystem::path file = toPath(settings_.value(QLatin1String(kFileKeys[k])).toString());
        if (!file.empty() && std::filesystem::exists(file, error))
            recordings_[k] = {file, settings_.number(QLatin1String(kRpmKeys[k]), 0.0, 0.0, 1e6)};
    }
    if (recordings_[0].file.empty() && recordings_[1].file.empty()) return;
    readRecordings([this](const std::optional<Problem>& problem) {
        if (!problem) return;
        recordings_[0] = recordings_[1] = {};
        for (const char* key : kFileKeys)
            settings_.remove(QLatin1String(key));
        showProblem(*problem);
    });
}

void MainWindow::toggleMicrophone(SoundControl::Channel channel, bool start) {
    try {
        if (start) {
            microphone_ = std::make_unique<sound::Microphone>();
            microphoneTimer_.start();
            sound_->setRecording(channel, true);
            return;
        }
        microphoneTimer_.stop();
        sound_->setRecording(channel, false);
        if (!microphone_) return;
        const sound::Wav wav = microphone_->finish();
        microphone_.reset();
        const std::filesystem::path file = Folders::standard().sessions.parent_path() /
                                           (channel == SoundControl::Channel::motor ? "motor.wav" : "cutting.wav");
        sound::writeWav(wav, file);
        takeRecording(channel, toQString(file));
    } catch (const core::Error& error) {
        microphone_.reset();
        microphoneTimer_.stop();
        sound_->setRecording(channel, false);
        showProblem(problemOf(error));
    }
}

void MainWindow::showSound() {
    const sound::Mix mix = simulator_.mix();
    sound_->setVolumes(mix.motor, mix.cutting);
    sound_->setMix(mix.balance);
    sound_->setMuted(mix.muted);
    for (const auto channel : {SoundControl::Channel::motor, SoundControl::Channel::cutting}) {
        const std::filesystem::path& file = recordings_[static_cast<int>(channel)].file;
        sound_->setSource(channel, file.empty() ? SoundControl::Source::synthesis : SoundControl::Source::file,
                          toQString(file.filename()));
    }
    const QSignalBlocker quiet(mix_);
    mix_->setValue(static_cast<int>(std::lround(100.0 * mix.balance)));
    (*actions_)["actionMute"]->setChecked(mix.muted);
    const sound::PlayerStatus status = simulator_.soundStatus();
    // The library's sentence, in the person's language; a name of a device has no translation.
    const QString device = status.silent && status.device == "there is no sound card"
                               ? tr("There is no sound card.")
                               : QString::fromStdString(status.device);
    sound_->setSilent(status.silent, device);
    soundNote_->setText(status.silent ? tr("No sound") : mix.muted ? tr("Muted") : QString());
    soundNote_->setToolTip(status.silent ? tr("Nothing is played: %1").arg(device) : device);
    soundNote_->setVisible(!soundNote_->text().isEmpty());
}

}  // namespace handpiece::desktop
