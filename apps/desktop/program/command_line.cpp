// SPDX-License-Identifier: Apache-2.0
#include "desktop/program/command_line.h"

#include <QSet>
#include <QtGlobal>

namespace handpiece::desktop {

CommandLine parseCommandLine(const QStringList& arguments) {
    CommandLine line;
    static const QSet<QString> withValue{
        QStringLiteral("--layout"), QStringLiteral("--language"), QStringLiteral("--screenshot"),
        QStringLiteral("--after"),  QStringLiteral("--stats"),    QStringLiteral("--run-for"),
        QStringLiteral("--device"), QStringLiteral("--inject"),   QStringLiteral("--rate")};
    for (qsizetype i = 1; i < arguments.size(); ++i) {
        QString option = arguments[i], value;
        if (!option.startsWith(QLatin1String("--"))) {
            if (!line.file.isEmpty()) line.wrong = QStringLiteral("one file at a time: %1").arg(option);
            line.file = option;
            continue;
        }
        if (const qsizetype equals = option.indexOf(QLatin1Char('=')); equals > 0) {
            value = option.mid(equals + 1);
            option.truncate(equals);
        } else if (withValue.contains(option)) {
            if (++i == arguments.size()) {
                line.wrong = QStringLiteral("%1 needs a value").arg(option);
                break;
            }
            value = arguments[i];
        }
        if (option == QLatin1String("--layout")) {
            line.layout = value;
            static const QSet<QString> known{QStringLiteral("practice"), QStringLiteral("laboratory"),
                                             QStringLiteral("paper")};
            if (!known.contains(value))
                line.wrong = QStringLiteral("there is no layout \"%1\": practice, laboratory, paper").arg(value);
        } else if (option == QLatin1String("--language")) {
            line.language = value;
            if (value != QLatin1String("en") && value != QLatin1String("ja"))
                line.wrong = QStringLiteral("there is no language \"%1\": en, ja").arg(value);
        } else if (option == QLatin1String("--device")) {
            line.device = value;
            if (value.isEmpty()) line.wrong = QStringLiteral("--device needs a name: handpiece device list tells them");
        } else if (option == QLatin1String("--inject")) {
            line.inject = value;
        } else if (option == QLatin1String("--screenshot")) {
            line.screenshot = value;
        } else if (option == QLatin1String("--after")) {
            bool ok = false;
            line.afterS = value.toDouble(&ok);
            if (!ok || !(line.afterS >= 0.0 && line.afterS <= 3600.0))
                line.wrong = QStringLiteral("--after takes seconds, 0 to 3600, not \"%1\"").arg(value);
        } else if (option == QLatin1String("--stats")) {
            line.stats = value;
        } else if (option == QLatin1String("--run-for")) {
            bool ok = false;
            line.runForS = value.toDouble(&ok);
            if (!ok || !(*line.runForS > 0.0 && *line.runForS <= 86400.0))
                line.wrong =
                    QStringLiteral("--run-for takes seconds, more than 0 and at most 86400, not \"%1\"").arg(value);
        } else if (option == QLatin1String("--rate")) {
            bool ok = false;
            line.rateHz = value.toDouble(&ok);
            if (!ok || !(line.rateHz >= 100.0 && line.rateHz <= 10000.0))
                line.wrong =
                    QStringLiteral("--rate takes ticks a second, 1000, 2000, 4000 or 8000, not \"%1\"").arg(value);
        } else if (option == QLatin1String("--no-realtime")) {
            line.realTime = false;
        } else if (option == QLatin1String("--no-sound")) {
            line.sound = false;
        } else if (option == QLatin1String("--timing")) {
            line.timing = true;
        } else if (option == QLatin1String("--help")) {
            line.help = true;
        } else if (option == QLatin1String("--version")) {
            line.version = true;
        } else {
            line.wrong = QStringLiteral("there is no option %1").arg(option);
        }
    }
    return line;
}

QString usage() {
    return QStringLiteral(
        "Usage: handpiece-desktop [CASE] [options]\n"
        "Opens a case, an attempt (.handpiece), an STL file or a recorded session (.h5); without one a lower "
        "first molar in the mouth.\n"
        "\n"
        "  --layout practice|laboratory|paper   which panels are shown\n"
        "  --language en|ja                     the language of this start\n"
        "  --device NAME                        what holds the handpiece: mouse, or a name of handpiece device list\n"
        "  --inject FAULTS                      faults of that device on purpose (docs/devices/safety.md#faults)\n"
        "  --rate HZ                            ticks a second: 1000, 2000, 4000 or 8000 (1000)\n"
        "  --no-realtime                        do not ask for real-time scheduling\n"
        "  --no-sound                           silent\n"
        "  --screenshot FILE.png                write the window as a picture and quit\n"
        "  --after SECONDS                      ... so long after the start (3)\n"
        "  --stats FILE.json                    write at the end how tick, picture and sound kept their time\n"
        "  --run-for SECONDS                    close so long after the start, without asking\n"
        "  --timing                             print how long the start takes\n"
        "  --version, --help\n"
        "\n"
        "Inside: F1 shows keys and mouse, F10 opens the menus.\n");
}

QString missingDisplay() {
    const QByteArray platform = qgetenv("QT_QPA_PLATFORM");
    if (platform.startsWith("offscreen") || platform.startsWith("minimal") || platform.startsWith("vnc")) return {};
#ifdef Q_OS_LINUX
    if (qEnvironmentVariableIsEmpty("DISPLAY") && qEnvironmentVariableIsEmpty("WAYLAND_DISPLAY"))
        return QStringLiteral(
            "there is no display to open a window on: neither DISPLAY nor WAYLAND_DISPLAY is set. Start it from a "
            "desktop, through ssh -X, or under xvfb-run; without a display the command line does the work: handpiece "
            "--help");
#endif
    return {};
}

}  // namespace handpiece::desktop
