// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What was typed behind handpiece-desktop.

#include <QString>
#include <QStringList>
#include <optional>

namespace handpiece::desktop {

struct CommandLine {
    QString file;      ///< case, attempt, STL or session to open; empty: a tooth in the mouth
    QString layout;    ///< "practice", "laboratory", "paper"; empty: as it was
    QString language;  ///< "en", "ja"; empty: as it was
    QString device;    ///< that holds the handpiece: a driver's name, "mouse"; empty: as it was
    QString inject;    ///< faults on purpose, for it
    bool sound = true, timing = false, realTime = true;
    double rateHz = 1000.0;  ///< of the tick
    QString screenshot;      ///< PNG to write, then quit
    double afterS = 3.0;
    QString stats;                  ///< JSON to write at the end
    std::optional<double> runForS;  ///< then it closes without asking
    bool help = false, version = false;
    QString wrong;  ///< what could not be understood; empty when all is well
};
[[nodiscard]] CommandLine parseCommandLine(const QStringList& arguments);
[[nodiscard]] QString usage();
/// Why no window can open, in one sentence with a remedy; empty when one can. Looks at the environment only.
[[nodiscard]] QString missingDisplay();

}  // namespace handpiece::desktop
