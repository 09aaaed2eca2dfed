// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The underlined letters of menus.

#include <QList>
#include <QString>

class QAction;
class QMenu;

namespace handpiece::desktop {

/// Without its letter: "Save &as..." and "保存(&S)..." are "Save as..." and "保存...".
[[nodiscard]] QString withoutMnemonic(const QString& text);
/// What is a name, not a text of ours, as a menu's entry: its '&' is seen.
[[nodiscard]] QString menuText(QString name);
/// A letter for each, no two alike: the first of a word, then any of the text; where a text has none, as in Japanese,
/// the first letters of its object name, in brackets behind it.
void giveMnemonics(const QList<QAction*>& entries);
/// The entries of this menu have letters while it is open; at all other times their texts are plain, as tool bars and
/// the card of keys show them.
QMenu* withMnemonics(QMenu* menu);

}  // namespace handpiece::desktop
