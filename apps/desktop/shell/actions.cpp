// SPDX-License-Identifier: Apache-2.0
#include "shell/actions.h"

#include <QCoreApplication>
#include <QWidget>

#include "panels/icon_factory.h"

namespace handpiece::desktop {
namespace {

struct Row {
    const char *name, *text, *tip, *icon, *keys;
    bool checkable = false;
};
// No Alt: Linux window managers take it. F10 opens the menus.
const Row kRows[] = {
    {"actionOpenCase", QT_TRANSLATE_NOOP("Actions", "Open case..."),
     QT_TRANSLATE_NOOP("Actions", "Open a case, or an attempt that was saved"), "open", "Ctrl+O"},
    {"actionOpenStl", QT_TRANSLATE_NOOP("Actions", "Open STL..."),
     QT_TRANSLATE_NOOP("Actions", "Open one closed surface as a tooth of enamel"), "file", "Ctrl+Shift+O"},
    {"actionNewScan", QT_TRANSLATE_NOOP("Actions", "New case from scan..."),
     QT_TRANSLATE_NOOP("Actions", "Make a tooth to be cut out of a CT: slices, a DICOM folder, a volume"), "views",
     "Ctrl+N"},
    {"actionOpenSession", QT_TRANSLATE_NOOP("Actions", "Open recording..."),
     QT_TRANSLATE_NOOP("Actions", "Open a recorded session to watch it"), "replay", "Ctrl+H"},
    {"actionChooseTooth", QT_TRANSLATE_NOOP("Actions", "Choose tooth..."),
     QT_TRANSLATE_NOOP("Actions", "Choose a tooth on the chart of the mouth"), "chart", "Ctrl+T"},
    {"actionResume", QT_TRANSLATE_NOOP("Actions", "Resume last attempt"),
     QT_TRANSLATE_NOOP("Actions", "Go on with the tooth that was saved last"), "recent", "Ctrl+L"},
    {"actionRecover", QT_TRANSLATE_NOOP("Actions", "Recover..."),
     QT_TRANSLATE_NOOP("Actions", "Bring back, or give up, work that ended without saving"), "recent", "Ctrl+Shift+R"},
    {"actionCode", QT_TRANSLATE_NOOP("Actions", "Your code..."),
     QT_TRANSLATE_NOOP("Actions", "The code your teacher gave you: it goes into recordings and saved attempts"), "info",
     "Ctrl+I"},
    {"actionSave", QT_TRANSLATE_NOOP("Actions", "Save"), QT_TRANSLATE_NOOP("Actions", "Save what was cut"), "save",
     "Ctrl+S"},
    {"actionSaveAs", QT_TRANSLATE_NOOP("Actions", "Save as..."),
     QT_TRANSLATE_NOOP("Actions", "Save what was cut under another name"), "save-as", "Ctrl+Shift+S"},
    {"actionHandIn", QT_TRANSLATE_NOOP("Actions", "Hand in..."),
     QT_TRANSLATE_NOOP("Actions", "Give the attempt to your teacher: one file with the tooth and what was recorded"),
     "save-as", "Ctrl+Shift+I"},
    {"actionExportStl", QT_TRANSLATE_NOOP("Actions", "Export STL..."),
     QT_TRANSLATE_NOOP("Actions", "Write what is left of the tooth as one closed STL surface"), "file", "Ctrl+E"},
    {"actionExportTissues", QT_TRANSLATE_NOOP("Actions", "Export tissues..."),
     QT_TRANSLATE_NOOP("Actions", "Write what is left of each tissue as a closed STL surface of its own"), "file",
     "Ctrl+Shift+E"},
    {"actionPicture", QT_TRANSLATE_NOOP("Actions", "Picture..."),
     QT_TRANSLATE_NOOP("Actions", "Keep what is seen as a PNG file"), "picture", "Ctrl+P"},
    {"actionReport", QT_TRANSLATE_NOOP("Actions", "Report..."),
     QT_TRANSLATE_NOOP("Actions", "Write a page to print: before and after, volumes, times, forces"), "report",
     "Ctrl+R"},
    {"actionQuit", QT_TRANSLATE_NOOP("Actions", "Quit"), QT_TRANSLATE_NOOP("Actions", "Close the program"), "exit",
     "Ctrl+Q"},
    {"actionUndo", QT_TRANSLATE_NOOP("Actions", "Undo"),
     QT_TRANSLATE_NOOP("Actions", "Put back what the last stroke took away"), "undo", "Ctrl+Z"},
    {"actionRedo", QT_TRANSLATE_NOOP("Actions", "Redo"), QT_TRANSLATE_NOOP("Actions", "Take the stroke away again"),
     "redo", "Ctrl+Shift+Z"},
    {"actionReset", QT_TRANSLATE_NOOP("Actions", "Reset the tooth"),
     QT_TRANSLATE_NOOP("Actions", "Put back all that was cut"), "reset", "Ctrl+Backspace"},
    {"actionViewOcclusal", QT_TRANSLATE_NOOP("Actions", "Occlusal"),
     QT_TRANSLATE_NOOP("Actions", "Look onto the chewing surface (key 1)"), "view-occlusal", "Ctrl+1"},
    {"actionViewBuccal", QT_TRANSLATE_NOOP("Actions", "Buccal"),
     QT_TRANSLATE_NOOP("Actions", "Look from the cheek (key 2)"), "view-buccal", "Ctrl+2"},
    {"actionViewLingual", QT_TRANSLATE_NOOP("Actions", "Lingual"),
     QT_TRANSLATE_NOOP("Actions", "Look from the tongue (key 3)"), "view-lingual", "Ctrl+3"},
    {"actionViewMesial", QT_TRANSLATE_NOOP("Actions", "Mesial"),
     QT_TRANSLATE_NOOP("Actions", "Look from the front of the arch (key 4)"), "view-mesial", "Ctrl+4"},
    {"actionViewDistal", QT_TRANSLATE_NOOP("Actions", "Distal"),
     QT_TRANSLATE_NOOP("Actions", "Look from the back of the arch (key 5)"), "view-distal", "Ctrl+5"},
    {"actionViewOblique", QT_TRANSLATE_NOOP("Actions", "Oblique"),
     QT_TRANSLATE_NOOP("Actions", "Look from above and the cheek (key 6)"), "view-oblique", "Ctrl+6"},
    {"actionFit", QT_TRANSLATE_NOOP("Actions", "Whole tooth"),
     QT_TRANSLATE_NOOP("Actions", "Show the whole tooth (key Home)"), "fit", "Ctrl+Home"},
    {"actionGoToBur", QT_TRANSLATE_NOOP("Actions", "Go to the bur"),
     QT_TRANSLATE_NOOP("Actions", "Look closely at the bur (key F)"), "bur", "Ctrl+F"},
    {"actionLayoutPractice", QT_TRANSLATE_NOOP("Actions", "Practice"),
     QT_TRANSLATE_NOOP("Actions", "A large picture and what one needs to cut"), "layouts", "F5", true},
    {"actionLayoutLaboratory", QT_TRANSLATE_NOOP("Actions", "Laboratory"), QT_TRANSLATE_NOOP("Actions", "Every figure"),
     "layouts", "F6", true},
    {"actionLayoutPaper", QT_TRANSLATE_NOOP("Actions", "As in the paper"),
     QT_TRANSLATE_NOOP("Actions", "The blocks of the paper's Figure 5"), "layouts", "F7", true},
    {"actionExercise", QT_TRANSLATE_NOOP("Actions", "Exercise"),
     QT_TRANSLATE_NOOP("Actions", "Show the exercise: its title and what to do"), "info", "F9"},
    {"actionResetLayout", QT_TRANSLATE_NOOP("Actions", "Panels to their places"),
     QT_TRANSLATE_NOOP("Actions", "Undo all moving of panels in this layout"), "layouts", "Shift+F5"},
    {"actionFullScreen", QT_TRANSLATE_NOOP("Actions", "Full screen"),
     QT_TRANSLATE_NOOP("Actions", "Fill the whole screen"), "fullscreen", "F11", true},
    {"actionThemeSystem", QT_TRANSLATE_NOOP("Actions", "As the desktop"),
     QT_TRANSLATE_NOOP("Actions", "Light or dark as the desktop is"), "eye", "Ctrl+Shift+F9", true},
    {"actionThemeLight", QT_TRANSLATE_NOOP("Actions", "Light"),
     QT_TRANSLATE_NOOP("Actions", "Dark text on light ground"), "eye", "Ctrl+F9", true},
    {"actionThemeDark", QT_TRANSLATE_NOOP("Actions", "Dark"), QT_TRANSLATE_NOOP("Actions", "Light text on dark ground"),
     "eye", "Shift+F9", true},
    {"actionTouch", QT_TRANSLATE_NOOP("Actions", "Touch"),
     QT_TRANSLATE_NOOP("Actions", "The left button touches with the bur still"), "touch", "F2", true},
    {"actionCut", QT_TRANSLATE_NOOP("Actions", "Cut"), QT_TRANSLATE_NOOP("Actions", "The left button presses and cuts"),
     "cut", "F3", true},
    {"actionPedal", QT_TRANSLATE_NOOP("Actions", "Hold the pedal down"),
     QT_TRANSLATE_NOOP("Actions", "The turbine keeps turning (key P)"), "speed", "F4", true},
    {"actionMeasure", QT_TRANSLATE_NOOP("Actions", "Measure a distance"),
     QT_TRANSLATE_NOOP("Actions", "Calliper: click two points of the tooth"), "calliper", "Ctrl+D", true},
    {"actionDepth", QT_TRANSLATE_NOOP("Actions", "Measure a depth"),
     QT_TRANSLATE_NOOP("Actions", "Click a cut place: how far it lies below the uncut surface"), "depth",
     "Ctrl+Shift+D", true},
    {"actionPulp", QT_TRANSLATE_NOOP("Actions", "Measure to the pulp"),
     QT_TRANSLATE_NOOP("Actions", "Click a cut place: how much dentine is left over the pulp"), "measure", "Ctrl+U",
     true},
    {"actionSection", QT_TRANSLATE_NOOP("Actions", "Section"),
     QT_TRANSLATE_NOOP("Actions", "Cut the picture open to look inside"), "section", "Ctrl+X", true},
    {"actionMirror", QT_TRANSLATE_NOOP("Actions", "Mouth mirror"), QT_TRANSLATE_NOOP("Actions", "Hold a mouth mirror"),
     "mirror", "Ctrl+M", true},
    {"actionCompare", QT_TRANSLATE_NOOP("Actions", "Before and after"),
     QT_TRANSLATE_NOOP("Actions", "The uncut tooth beside the cut one"), "compare", "Ctrl+B", true},
    {"actionClearMeasurements", QT_TRANSLATE_NOOP("Actions", "Clear measurements"),
     QT_TRANSLATE_NOOP("Actions", "Take all measurements away"), "close", "Ctrl+Shift+X"},
    {"actionKeepRecording", QT_TRANSLATE_NOOP("Actions", "Keep recording..."),
     QT_TRANSLATE_NOOP("Actions", "Every session is recorded; keep a copy of this one"), "record", "Ctrl+K"},
    {"actionReplay", QT_TRANSLATE_NOOP("Actions", "Replay"),
     QT_TRANSLATE_NOOP("Actions", "Watch what you have done so far; closing the replay brings the tooth back"),
     "replay", "Ctrl+Y"},
    {"actionBindings", QT_TRANSLATE_NOOP("Actions", "Keys and mouse..."),
     QT_TRANSLATE_NOOP("Actions", "Choose which key or button does what"), "keyboard", "Ctrl+Shift+K"},
    {"actionMute", QT_TRANSLATE_NOOP("Actions", "Mute"), QT_TRANSLATE_NOOP("Actions", "No sound"), "mute",
     "Ctrl+Shift+M", true},
    {"actionMotorLouder", QT_TRANSLATE_NOOP("Actions", "Motor louder"),
     QT_TRANSLATE_NOOP("Actions", "Motor sound louder"), "sound", "Ctrl+Up"},
    {"actionMotorSofter", QT_TRANSLATE_NOOP("Actions", "Motor softer"),
     QT_TRANSLATE_NOOP("Actions", "Motor sound softer"), "sound", "Ctrl+Down"},
    {"actionCuttingLouder", QT_TRANSLATE_NOOP("Actions", "Cutting louder"),
     QT_TRANSLATE_NOOP("Actions", "Cutting sound louder"), "sound", "Ctrl+Shift+Up"},
    {"actionCuttingSofter", QT_TRANSLATE_NOOP("Actions", "Cutting softer"),
     QT_TRANSLATE_NOOP("Actions", "Cutting sound softer"), "sound", "Ctrl+Shift+Down"},
    {"actionDevicePage", QT_TRANSLATE_NOOP("Actions", "Device page..."),
     QT_TRANSLATE_NOOP("Actions", "How the device is doing, its settings, and a check of how good it feels"),
     "settings", "F8"},
    {"actionDeviceSetUp", QT_TRANSLATE_NOOP("Actions", "Set up..."),
     QT_TRANSLATE_NOOP("Actions", "Connect, calibrate, feel a block"), "check", "Shift+F8"},
    {"actionDeviceNamed", QT_TRANSLATE_NOOP("Actions", "Device by name or serial..."),
     QT_TRANSLATE_NOOP("Actions", "Choose one of several equal devices"), "search", "Ctrl+Shift+F8"},
    {"actionDeviceSearch", QT_TRANSLATE_NOOP("Actions", "Look for devices"),
     QT_TRANSLATE_NOOP("Actions", "Look again which devices are connected"), "search", "Ctrl+F8"},
    {"actionHelp", QT_TRANSLATE_NOOP("Actions", "Keys and mouse at a glance"),
     QT_TRANSLATE_NOOP("Actions", "Show which key does what"), "help", "F1"},
    {"actionAbout", QT_TRANSLATE_NOOP("Actions", "About Handpiece"), QT_TRANSLATE_NOOP("Actions", "Version, licences"),
     "info", "Shift+F1"},
};

}  // namespace

namespace {
/// What stands under the icons of the bars, where the menu's text is too long.
constexpr std::pair<const char*, const char*> kBrief[] = {
    {"actionOpenCase", QT_TRANSLATE_NOOP("Actions", "Open")},
    {"actionChooseTooth", QT_TRANSLATE_NOOP("Actions", "Teeth")},
    {"actionResume", QT_TRANSLATE_NOOP("Actions", "Resume")},
    {"actionReset", QT_TRANSLATE_NOOP("Actions", "Reset")},
    {"actionMirror", QT_TRANSLATE_NOOP("Actions", "Mirror")},
    {"actionMeasure", QT_TRANSLATE_NOOP("Actions", "Distance")},
    {"actionDepth", QT_TRANSLATE_NOOP("Actions", "Depth")},
    {"actionPulp", QT_TRANSLATE_NOOP("Actions", "To pulp")},
    {"actionCompare", QT_TRANSLATE_NOOP("Actions", "Compare")},
    {"actionKeepRecording", QT_TRANSLATE_NOOP("Actions", "Record")},
};
}  // namespace

namespace {
QString tipOf(const QAction& action) {
    return QStringLiteral("%1 (%2)").arg(action.statusTip(), action.shortcut().toString(QKeySequence::NativeText));
}
}  // namespace

void Actions::setLocked(const char* name, bool locked) const {
    QAction* action = (*this)[name];
    action->setToolTip(locked ? QCoreApplication::translate("Actions", "Locked by this exercise.") : tipOf(*action));
}

Actions::Actions(QWidget* window) : QObject(window) {
    for (const Row& row : kRows) {
        auto* action = new QAction(QCoreApplication::translate("Actions", row.text), window);
        const QKeySequence keys(QLatin1String(row.keys));
        action->setObjectName(QLatin1String(row.name));
        action->setShortcut(keys);
        action->setIcon(icon(QLatin1String(row.icon)));
        action->setCheckable(row.checkable);
        action->setStatusTip(QCoreApplication::translate("Actions", row.tip));
        action->setToolTip(tipOf(*action));
        window->addAction(action);
        byName_.insert(row.name, action);
        ordered_ << action;
    }
    for (const auto& [name, text] : kBrief)
        byName_[name]->setIconText(QCoreApplication::translate("Actions", text));
}

QAction* Actions::operator[](const char* name) const {
    QAction* action = byName_.value(name);
    if (!action) qFatal("there is no action %s", name);
    return action;
}

}  // namespace handpiece::desktop
