// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The words for how hard a bur is pressed, the same for what is set and for what is felt, by the newton and the drive.

#include <QCoreApplication>
#include <QString>

#include "handpiece/model/instrument/press.h"

namespace handpiece::desktop {

/// Under it nothing is pressed [N].
inline constexpr double kPressedN = 0.05;

[[nodiscard]] inline QString pressWords(double forceN, const instrument::PressLimits& limits) {
    const auto say = [](const char* text) { return QCoreApplication::translate("Press", text); };
    if (forceN < kPressedN) return say(QT_TRANSLATE_NOOP("Press", "Not pressed"));
    if (forceN < limits.lightN) return say(QT_TRANSLATE_NOOP("Press", "Very light"));
    if (forceN < limits.usualN) return say(QT_TRANSLATE_NOOP("Press", "Light"));
    if (forceN < limits.firmN) return say(QT_TRANSLATE_NOOP("Press", "As usual"));
    return forceN < limits.hardN ? say(QT_TRANSLATE_NOOP("Press", "Firm")) : say(QT_TRANSLATE_NOOP("Press", "Hard"));
}

}  // namespace handpiece::desktop
