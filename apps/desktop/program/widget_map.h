// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where the named widgets are on the screen and what they say, for scripts that work the window with a real mouse.

#include <QJsonObject>
#include <QString>
#include <functional>

class QObject;

namespace handpiece::desktop {

/// Writes what is visible into a JSON file, five times a second while `parent` lives: {"places": {NAME: [x, y, width,
/// height]}, "texts": {NAME: TEXT}, "on": [NAME], "off": [NAME], "windows": [NAME], "hand": {...}}. Pixels of the
/// screen. NAME is an object's name; a row of an open menu and a bar's button have their action's (or submenu's), a
/// cell of a list is LIST/TEXT, a tab tab/TEXT, a button of a question button/Discard and its like. A text is what a
/// label, a button or an editor shows, else what the widget tells a screen reader. "on": what is checked; "off": what
/// cannot be used now; "windows": those that are open, menus too, the one without a name by its class. "hand" is what
/// `hand` says, where it is given.
void writeWidgetMap(QObject* parent, const QString& file, std::function<QJsonObject()> hand = {});

}  // namespace handpiece::desktop
