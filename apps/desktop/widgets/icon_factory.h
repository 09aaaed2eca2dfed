// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The program's own icons, drawn in the colour of the text around them.

#include <QIcon>
#include <QString>
#include <QStringList>

namespace handpiece::desktop {

/// An icon by name ("touch", "cut", "undo", ...), as sharp as the screen. It follows the application's palette: light
/// or dark, disabled, selected. An unknown name gives an empty icon.
[[nodiscard]] QIcon icon(const QString& name);
/// The names there are.
[[nodiscard]] QStringList iconNames();
/// The program's icon, in colours of its own.
[[nodiscard]] QIcon applicationIcon();

}  // namespace handpiece::desktop
