// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "desktop/framework/application.h"
#include "desktop/program/hand_map.h"
#include "desktop/program/host.h"
#include "desktop/program/prepared_list.h"
#include "desktop/program/widget_map.h"
#include "handpiece/base/core/any_error.h"
#include "handpiece/senses/sound/player.h"

int main(int argc, char** argv) {
    using namespace handpiece;
    QStringList arguments;
    for (int i = 0; i < argc; ++i)
        arguments << QString::fromLocal8Bit(argv[i]);
    const desktop::CommandLine line = desktop::parseCommandLine(arguments);
    if (!line.wrong.isEmpty()) {
        std::fprintf(stderr, "handpiece-desktop: %s\n\n%s", qPrintable(line.wrong), qPrintable(desktop::usage()));
        return 2;
    }
    if (line.help || line.version) {
        std::printf("%s", line.help ? qPrintable(desktop::usage()) : "handpiece-desktop " HANDPIECE_VERSION "\n");
        return 0;
    }
    prepared::use(prepared::installedFolder(), prepared::list(),
                  [](const std::string& problem) { std::fprintf(stderr, "handpiece-desktop: %s\n", problem.c_str()); });
    // It sets the environment for a moment: before any thread.
    if (line.sound) sound::preferLowLatency();
    // Qt would abort, with a core dump.
    if (const QString missing = desktop::missingDisplay(); !missing.isEmpty()) {
        std::fprintf(stderr, "handpiece-desktop: %s\n", qPrintable(missing));
        return 1;
    }
    QApplication::setApplicationName(QStringLiteral("handpiece"));
    QApplication::setApplicationVersion(QStringLiteral(HANDPIECE_VERSION));
    QApplication::setApplicationDisplayName(QStringLiteral("Handpiece"));
    QApplication::setDesktopFileName(QStringLiteral("handpiece-desktop"));
    desktop::Application application(argc, argv);
    try {
        desktop::Simulator::Options options;
        options.sound = line.sound;
        options.rateHz = line.rateHz;
        options.realTime = line.realTime;
        desktop::Host host(application, line, options);
        application.whenThrown = [&host](const core::Error& error) {
            std::fprintf(stderr, "handpiece-desktop: %s\n", error.what());
            host.window().showProblem(desktop::problemOf(error));
        };
        host.start();
        if (const QString map = qEnvironmentVariable("HANDPIECE_WIDGET_MAP"); !map.isEmpty())
            desktop::writeWidgetMap(&application, map,
                                    [hand = std::make_shared<desktop::HandMap>(host)] { return hand->now(); });
        return QApplication::exec();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "handpiece-desktop: %s\n", core::asError(error).what());
        return 1;
    }
}
