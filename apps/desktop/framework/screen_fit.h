// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Windows on small screens.

#include <QObject>
#include <QRect>

class QScreen;
class QWidget;

namespace handpiece::desktop {

/// A window's title, which is outside of what its size counts.
inline constexpr int kTitlePixels = 38;

/// Where a window's inside may lie: the screen without the desktop's bars, and room for its own title above it.
[[nodiscard]] QRect roomOn(const QScreen& screen);
/// No larger than its screen, and wholly on it. What is in it must be able to shrink (widgets/scrolled.h).
void fitToScreen(QWidget& window);

/// Fits every window and dialog of the program before it is first seen.
class ScreenFit : public QObject {
    Q_OBJECT
  public:
    using QObject::QObject;

  protected:
    bool eventFilter(QObject* of, QEvent* event) override;
};

}  // namespace handpiece::desktop
