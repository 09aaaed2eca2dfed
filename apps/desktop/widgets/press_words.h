// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The words for how hard a bur is pressed, the same for what is set and for what is felt.

#include <QCoreApplication>
#include <QString>

namespace handpiece::desktop {

/// From here on a press is firm, and hard [N]; under the first of the three nothing is pressed. Chosen about the newton
/// of a clinician's usual load (docs/physics.md).
inline constexpr double kPressedN = 0.05, kFirmN = 1.4, kHardN = 2.4;

[[nodiscard]] inline QString pressWords(double forceN) {
    const auto say = [](const char* text) { return QCoreApplication::translate("Press", text); };
    if (forceN < kPressedN) return say(QT_TRANSLATE_NOOP("Press", "Not pressed"));
    if (forceN < 0.5) return say(QT_TRANSLATE_NOOP("Press", "Very light"));
    if (forceN < 0.9) return say(QT_TRANSLATE_NOOP("Press", "Light"));
    if (forceN < kFirmN) return say(QT_TRANSLATE_NOOP("Press", "As usual"));
    return forceN < kHardN ? say(QT_TRANSLATE_NOOP("Press", "Firm")) : say(QT_TRANSLATE_NOOP("Press", "Hard"));
}

}  // namespace handpiece::desktop
