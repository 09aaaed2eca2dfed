// SPDX-License-Identifier: Apache-2.0
#include "desktop/program/host.h"

#include <QApplication>
#include <QPixmap>
#include <QTimer>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "desktop/features/features.h"
#include "desktop/framework/feature.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::desktop {
namespace {

/// Below what the person has chosen: the school's defaults; above it: the command line.
Simulator::Options asAsked(Simulator::Options options, const CommandLine& line,
                           const exercise::SchoolDefaults& school) {
    if (!line.inject.isEmpty()) options.hands.inject = line.inject.toStdString();
    options.hands.leftHanded = school.leftHanded;
    options.hands.scale = school.scale;
    if (school.sessionsFolder) options.folders.sessions = *school.sessionsFolder;
    if (school.casesFolder) options.casesFolder = *school.casesFolder;
    if (school.record) options.record = *school.record;
    if (school.voxelUm) options.voxelUm = static_cast<int>(std::lround(*school.voxelUm));
    // One of the two alone must not turn them round.
    measure::PulpLimits& limits = options.pulpLimits;
    if (school.pulpGoodMm) limits.goodMm = *school.pulpGoodMm;
    if (school.pulpLeastMm) limits.leastMm = *school.pulpLeastMm;
    if (!school.pulpLeastMm) limits.leastMm = std::min(limits.leastMm, limits.goodMm);
    if (!school.pulpGoodMm) limits.goodMm = std::max(limits.leastMm, limits.goodMm);
    return options;
}

/// What a person has not set yet is as the school has it.
void fillIn(Settings& settings, const exercise::SchoolDefaults& school) {
    const auto fill = [&settings](const char* key, const QVariant& value) {
        if (!settings.value(QLatin1String(key)).isValid()) settings.set(QLatin1String(key), value);
    };
    if (school.language) fill("window/language", QString::fromStdString(*school.language));
    if (school.layout) fill("window/layout", QString::fromStdString(*school.layout));
    if (school.casesFolder) fill("files/folder", toQString(*school.casesFolder));
    if (school.sound) fill("sound/muted", !*school.sound);
    if (school.volume) {
        fill("sound/motor", *school.volume);
        fill("sound/cutting", *school.volume);
    }
    if (school.crisp) {
        fill("work/crispContact", *school.crisp);
        fill("work/cuttingVibration", *school.crisp);
    }
}

}  // namespace

Host::Host(QApplication& application, const CommandLine& line, const Simulator::Options& options)
    : application_(application),
      line_(line),
      realTime_(options.realTime),
      school_(exercise::schoolDefaults()),
      settings_(options.folders.settingsFile),
      simulator_(asAsked(options, line, school_)) {
    fillIn(settings_, school_);
    // What goes over from a window to the next of another language, and no further.
    settings_.remove(QStringLiteral("passing"));
    const QString theme = settings_.value(QStringLiteral("window/theme"), QStringLiteral("system")).toString();
    chooseAppearance(theme == QLatin1String("dark")    ? Appearance::dark
                     : theme == QLatin1String("light") ? Appearance::light
                                                       : Appearance::system);
    if (!line.layout.isEmpty()) settings_.set(QStringLiteral("window/layout"), line.layout);
    const QString code = line.language.isEmpty()
                             ? settings_.value(QStringLiteral("window/language"), QStringLiteral("system")).toString()
                             : line.language;
    const bool speaks = language_.use(code);
    // What was in the hand last time.
    const auto kept = [this](const char* key, double otherwise, double most) {
        return settings_.number(QStringLiteral("work/") + QLatin1String(key), otherwise, 0.0, most);
    };
    simulator_.setBur(settings_.value(QStringLiteral("work/bur"), QStringLiteral("330")).toString());
    simulator_.setDrive(settings_.value(QStringLiteral("work/drive"), QStringLiteral("turbine")).toString());
    if (const double rpm = kept("speedRpm", 0.0, 1e6); rpm > 0.0) simulator_.setSpeed(rpm);
    simulator_.setVoxel(
        static_cast<int>(settings_.number(QStringLiteral("work/voxelUm"), options.voxelUm, 20.0, 400.0)));
    simulator_.setCode(settings_.value(QStringLiteral("work/code")).toString());
    simulator_.setMultipliers(kept("stiffness", 1.0, 3.0), kept("damping", 1.0, 3.0), kept("friction", 1.0, 3.0));
    simulator_.setEventBasedForce(settings_.value(QStringLiteral("work/crispContact")).toBool(),
                                  settings_.value(QStringLiteral("work/cuttingVibration")).toBool());
    makeWindow();
    if (!speaks) window_->notices().tell(Notice::translationMissing);
}

Host::~Host() = default;

void Host::makeWindow() {
    window_ = std::make_unique<MainWindow>(settings_);
    installFeatures({*window_, simulator_, settings_, realTime_});
    connect(window_.get(), &MainWindow::languageChosen, this, &Host::chooseLanguage, Qt::QueuedConnection);
    connect(window_.get(), &MainWindow::appearanceChosen, this, &Host::chooseAppearance);
    connect(window_.get(), &MainWindow::firstPicture, this, [this] {
        if (firstPictureMs_ > 0.0) return;
        firstPictureMs_ = sinceProgramStartMs();
        if (line_.timing) {
            std::printf("first picture after %.0f ms\n", firstPictureMs_);
            std::fflush(stdout);
        }
    });
    connect(window_->view(), &ViewWidget::frameDrawn, this,
            [this](const view::FrameReport& report) { picture_.take(report); });
}

void Host::start() {
    window_->show();
    if (line_.timing) {
        std::printf("window after %.0f ms\n", sinceProgramStartMs());
        std::fflush(stdout);
    }
    window_->greet();
    for (const std::string& problem : school_.problems)
        window_->notices().tell(Notice::schoolSettings, {QString::fromStdString(problem)});
    if (line_.file.isEmpty()) {
        simulator_.openFirst();
    } else {
        // A file that cannot be opened is told of, and there is a tooth all the same.
        connect(
            &simulator_, &Simulator::failed, this,
            [this] {
                if (simulator_.mode() == Simulator::Mode::empty && !simulator_.isBusy()) simulator_.openFirst();
            },
            static_cast<Qt::ConnectionType>(Qt::QueuedConnection | Qt::SingleShotConnection));
        window_->openFile(line_.file);
    }
    // Last: what is told of a device that is not there stands beside the tooth.
    if (const QString device = firstDevice(); !device.isEmpty()) simulator_.hands().choose(device);
    if (const QString pedal = settings_.value(QStringLiteral("work/pedal")).toString(); !pedal.isEmpty())
        simulator_.foot().choose(pedal);
    if (line_.runForS)
        QTimer::singleShot(static_cast<int>(1e3 * *line_.runForS), this, [this] { endWithoutAsking(0); });
    if (!line_.stats.isEmpty()) connect(&application_, &QApplication::aboutToQuit, this, &Host::writeStats);
    if (!line_.screenshot.isEmpty())
        QTimer::singleShot(static_cast<int>(1e3 * line_.afterS), this, &Host::takeScreenshot);
}

QString Host::firstDevice() const {
    QString device = line_.device;
    if (device.isEmpty()) device = settings_.value(QStringLiteral("work/device")).toString();
    if (device.isEmpty() && school_.device) device = QString::fromStdString(*school_.device);
    return device == QLatin1String("mouse") ? QString() : device;
}

void Host::takeScreenshot() {
    const bool written = window_->grab().save(line_.screenshot, "PNG");
    if (!written) std::fprintf(stderr, "%s: the picture cannot be written\n", qPrintable(line_.screenshot));
    endWithoutAsking(written ? 0 : 1);
}

void Host::endWithoutAsking(int code) {
    window_->rememberAll();
    picture_.latency = window_->view()->latency();
    simulator_.close();
    QApplication::exit(code);
}

void Host::writeStats() {
    if (picture_.latency.count == 0) picture_.latency = window_->view()->latency();
    try {
        core::writeFile(toPath(line_.stats),
                        runStatistics(simulator_.status(), simulator_.soundStatus(), picture_, firstPictureMs_));
    } catch (const core::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
}

void Host::chooseLanguage(const QString& code) {
    settings_.set(QStringLiteral("window/language"), code);
    window_->rememberAll();
    const bool speaks = language_.use(code);
    // The old window goes first: the picture's feed has one reader.
    window_.reset();
    makeWindow();
    window_->show();
    if (!speaks) window_->notices().tell(Notice::translationMissing);
}

void Host::chooseAppearance(Appearance appearance) {
    applyTheme(application_, appearance);
}

}  // namespace handpiece::desktop
