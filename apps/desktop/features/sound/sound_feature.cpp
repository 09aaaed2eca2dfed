// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/sound/sound_feature.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPointer>
#include <QSlider>
#include <QStatusBar>
#include <QToolBar>
#include <algorithm>
#include <cmath>

#include "desktop/framework/job_strip.h"
#include "desktop/work/simulator.h"

namespace handpiece::desktop {
namespace {

constexpr double kVolumeStep = 0.1;
constexpr int kMicrophoneMs = 50;
constexpr const char *kFileKeys[] = {"sound/motorFile", "sound/cuttingFile"},
                     *kRpmKeys[] = {"sound/motorFileRpm", "sound/cuttingFileRpm"};

using Command = SoundFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::mute, "actionMute", QT_TRANSLATE_NOOP("Commands", "Mute"), QT_TRANSLATE_NOOP("Commands", "No sound"),
     "mute", "Ctrl+Shift+M", in(Shelf::sound, 0), kCheckable},
    {Command::motorLouder, "actionMotorLouder", QT_TRANSLATE_NOOP("Commands", "Motor louder"),
     QT_TRANSLATE_NOOP("Commands", "Motor sound louder"), "sound", "Ctrl+Up", in(Shelf::sound, 10)},
    {Command::motorSofter, "actionMotorSofter", QT_TRANSLATE_NOOP("Commands", "Motor softer"),
     QT_TRANSLATE_NOOP("Commands", "Motor sound softer"), "sound", "Ctrl+Down", in(Shelf::sound, 11)},
    {Command::cuttingLouder, "actionCuttingLouder", QT_TRANSLATE_NOOP("Commands", "Cutting louder"),
     QT_TRANSLATE_NOOP("Commands", "Cutting sound louder"), "sound", "Ctrl+Shift+Up", in(Shelf::sound, 12)},
    {Command::cuttingSofter, "actionCuttingSofter", QT_TRANSLATE_NOOP("Commands", "Cutting softer"),
     QT_TRANSLATE_NOOP("Commands", "Cutting sound softer"), "sound", "Ctrl+Shift+Down", in(Shelf::sound, 13)},
};

}  // namespace

SoundFeature::SoundFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), control_(new SoundControl), note_(new QLabel) {
    window_.docks().add({"soundDock",
                         tr("Sound"),
                         70,
                         {{Detail::practice, Qt::RightDockWidgetArea, 60, 260},
                          {Detail::laboratory, Qt::RightDockWidgetArea, 60, 480, "parameterDock"},
                          {Detail::paper, Qt::RightDockWidgetArea, 30, 240}}},
                        control_);
    control_->setHeadingShown(false);  // the dock's title says it
    note_->setObjectName(QStringLiteral("soundNote"));
    window_.statusBar()->addPermanentWidget(note_);
    addMixSlider();
    connectMix();
    connectRecordings();
    recallRecordings();
    show();
}

void SoundFeature::addMixSlider() {
    auto* box = new QWidget;
    auto* row = new QHBoxLayout(box);
    row->setContentsMargins(10, 0, 10, 0);
    mix_ = new QSlider(Qt::Horizontal);
    mix_->setObjectName(QStringLiteral("mixSlider"));
    mix_->setAccessibleName(tr("Mixing ratio of motor and cutting sound"));
    mix_->setToolTip(tr("Mixing ratio: left the motor alone, right the cutting alone"));
    mix_->setRange(0, 100);
    mix_->setFixedWidth(90);
    row->addWidget(new QLabel(tr("Motor")));
    row->addWidget(mix_);
    row->addWidget(new QLabel(tr("Cutting")));
    QAction* action = window_.commands().placeWidget({Shelf::toolBar, 43}, box);
    action->setObjectName(QStringLiteral("mixAction"));
    connect(&window_.docks(), &Docks::detailChanged, action,
            [action](Detail detail) { action->setVisible(detail == Detail::paper); });
}

void SoundFeature::connectMix() {
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
            show();
        };
    };
    connect(control_, &SoundControl::motorVolumeChanged, this, change([](sound::Mix& m, double v) { m.motor = v; }));
    connect(control_, &SoundControl::cuttingVolumeChanged, this,
            change([](sound::Mix& m, double v) { m.cutting = v; }));
    connect(control_, &SoundControl::mixChanged, this, change([](sound::Mix& m, double v) { m.balance = v; }));
    connect(control_, &SoundControl::mutedChanged, this, change([](sound::Mix& m, bool v) { m.muted = v; }));
    connect(mix_, &QSlider::valueChanged, this, change([](sound::Mix& m, int v) { m.balance = 0.01 * v; }));
    on(commands_[Command::mute], change([](sound::Mix& m, bool v) { m.muted = v; }));
    const auto step = [&](Command command, double sound::Mix::*which, double by) {
        on(commands_[command],
           change([which, by](sound::Mix& m, bool) { m.*which = std::clamp(m.*which + by, 0.0, 1.0); }));
    };
    step(Command::motorLouder, &sound::Mix::motor, kVolumeStep);
    step(Command::motorSofter, &sound::Mix::motor, -kVolumeStep);
    step(Command::cuttingLouder, &sound::Mix::cutting, kVolumeStep);
    step(Command::cuttingSofter, &sound::Mix::cutting, -kVolumeStep);
}

void SoundFeature::connectRecordings() {
    connect(control_, &SoundControl::synthesisChosen, this,
            [this](SoundControl::Channel channel) { takeRecording(channel, {}); });
    connect(control_, &SoundControl::recordingFileRequested, this, [this](SoundControl::Channel channel) {
        const QString file = window_.questions.open(tr("Sound of a real handpiece"), tr("Sound (*.wav)"));
        file.isEmpty() ? show() : takeRecording(channel, file);
    });
    connect(control_, &SoundControl::microphoneToggled, this, &SoundFeature::toggleMicrophone);
    microphoneTimer_.setInterval(kMicrophoneMs);
    connect(&microphoneTimer_, &QTimer::timeout, this, [this] {
        if (microphone_) control_->setMicrophoneLevel(microphone_->poll());
    });
}

void SoundFeature::takeRecording(SoundControl::Channel channel, const QString& file) {
    if (simulator_.isReadingSound()) {
        show();
        return;
    }
    const int which = static_cast<int>(channel);
    const sound::Recording before = recordings_[which];
    recordings_[which] = {toPath(file), file.isEmpty() ? 0.0 : simulator_.setSpeedRpm()};
    readRecordings([this, which, before](const std::optional<Problem>& problem) {
        if (problem) {
            recordings_[which] = before;
            window_.showProblem(*problem);
        }
        for (const int k : {0, 1}) {
            settings_.set(QLatin1String(kFileKeys[k]), toQString(recordings_[k].file));
            settings_.set(QLatin1String(kRpmKeys[k]), recordings_[k].recordedAtRpm);
        }
    });
}

/// Long files take seconds: beside the window, with the strip that says so.
void SoundFeature::readRecordings(std::function<void(const std::optional<Problem>&)> done) {
    if (simulator_.isReadingSound()) return;
    const bool strip = !simulator_.isBusy();
    if (strip) window_.job().begin(tr("Reading the sound"));
    simulator_.setRecordings(
        recordings_[0], recordings_[1],
        [self = QPointer<SoundFeature>(this), strip, done = std::move(done)](const std::optional<Problem>& problem) {
            if (!self) return;
            if (strip && !self->simulator_.isBusy()) self->window_.job().end();
            done(problem);
            self->show();
        });
    show();
}

/// What was chosen before; a file that is gone is not worth a word at the start.
void SoundFeature::recallRecordings() {
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
        window_.showProblem(*problem);
    });
}

void SoundFeature::toggleMicrophone(SoundControl::Channel channel, bool start) {
    try {
        if (start) {
            microphone_ = std::make_unique<sound::Microphone>();
            microphoneTimer_.start();
            control_->setRecording(channel, true);
            return;
        }
        microphoneTimer_.stop();
        control_->setRecording(channel, false);
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
        control_->setRecording(channel, false);
        window_.showProblem(problemOf(error));
    }
}

void SoundFeature::show() {
    const sound::Mix mix = simulator_.mix();
    control_->setVolumes(mix.motor, mix.cutting);
    control_->setMix(mix.balance);
    control_->setMuted(mix.muted);
    for (const auto channel : {SoundControl::Channel::motor, SoundControl::Channel::cutting}) {
        const std::filesystem::path& file = recordings_[static_cast<int>(channel)].file;
        control_->setSource(channel, file.empty() ? SoundControl::Source::synthesis : SoundControl::Source::file,
                            toQString(file.filename()));
    }
    const QSignalBlocker quiet(mix_);
    mix_->setValue(static_cast<int>(std::lround(100.0 * mix.balance)));
    commands_[Command::mute]->setChecked(mix.muted);
    const sound::PlayerStatus status = simulator_.soundStatus();
    // The library's sentence, in the person's language; a name of a device has no translation.
    const QString device = status.silent && status.device == "there is no sound card"
                               ? tr("There is no sound card.")
                               : QString::fromStdString(status.device);
    control_->setSilent(status.silent, device);
    note_->setText(status.silent ? tr("No sound") : mix.muted ? tr("Muted") : QString());
    note_->setToolTip(status.silent ? tr("Nothing is played: %1").arg(device) : device);
    note_->setVisible(!note_->text().isEmpty());
}

}  // namespace handpiece::desktop
