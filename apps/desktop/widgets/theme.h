// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Light and dark, fonts, and the few colours with a meaning.

#include <QColor>
#include <QFont>
#include <QPalette>

class QApplication;
class QWidget;

namespace handpiece::desktop {

enum class Appearance { system, light, dark };

/// Sets style, palette and a font that has Japanese glyphs, for the whole program. `system` keeps the desktop's own
/// colours but the accent, which is one everywhere. May be called again at any time.
void applyTheme(QApplication& application, Appearance appearance);

/// The palette of the light or the dark appearance.
[[nodiscard]] QPalette themePalette(bool dark);
/// Whether text is lighter than its background.
[[nodiscard]] bool isDark(const QPalette& palette);

/// Colours with a meaning, each readable on the palette's window and base colours.
struct Tones {
    QColor good, caution, bad;   ///< traffic light; never without a word beside them
    QColor force, depth, speed;  ///< the three plots
    QColor quiet;                ///< labels and axes
    QColor line;                 ///< hairlines and grids
    QColor raised;               ///< cards on the window
};
[[nodiscard]] Tones tonesOf(const QPalette& palette);
/// Two colours mixed, `share` of the second.
[[nodiscard]] QColor mixed(const QColor& a, const QColor& b, double share);

/// The widget's font at `scale` times its size, for readouts.
[[nodiscard]] QFont scaledFont(const QFont& font, double scale, bool bold = false);

}  // namespace handpiece::desktop
