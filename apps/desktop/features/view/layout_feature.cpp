// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/view/layout_feature.h"

#include <QActionGroup>
#include <QLabel>
#include <QMenu>
#include <QMessageBox>

#include "desktop/framework/language.h"
#include "desktop/work/simulator.h"

namespace handpiece::desktop {
namespace {

using Command = LayoutFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::practice, "actionLayoutPractice", QT_TRANSLATE_NOOP("Commands", "Practice"),
     QT_TRANSLATE_NOOP("Commands", "A large picture and what one needs to cut"), "layouts", "F5", in(Shelf::view, 20),
     kCheckable, onCard(7)},
    {Command::laboratory, "actionLayoutLaboratory", QT_TRANSLATE_NOOP("Commands", "Laboratory"),
     QT_TRANSLATE_NOOP("Commands", "Every figure"), "layouts", "F6", in(Shelf::view, 21), kCheckable, onCard(8)},
    {Command::paper, "actionLayoutPaper", QT_TRANSLATE_NOOP("Commands", "As in the paper"),
     QT_TRANSLATE_NOOP("Commands", "The blocks of the paper's Figure 5"), "layouts", "F7", in(Shelf::view, 22),
     kCheckable},
    {Command::resetLayout, "actionResetLayout", QT_TRANSLATE_NOOP("Commands", "Panels to their places"),
     QT_TRANSLATE_NOOP("Commands", "Undo all moving of panels in this layout"), "layouts", "Shift+F5",
     in(Shelf::view, 25)},
    {Command::fullScreen, "actionFullScreen", QT_TRANSLATE_NOOP("Commands", "Full screen"),
     QT_TRANSLATE_NOOP("Commands", "Fill the whole screen"), "fullscreen", "F11", in(Shelf::view, 26), kCheckable,
     onCard(9)},
    {Command::asDesktop, "actionThemeSystem", QT_TRANSLATE_NOOP("Commands", "As the desktop"),
     QT_TRANSLATE_NOOP("Commands", "Light or dark as the desktop is"), "eye", "Ctrl+Shift+F9", in(Shelf::theme, 0),
     kCheckable},
    {Command::light, "actionThemeLight", QT_TRANSLATE_NOOP("Commands", "Light"),
     QT_TRANSLATE_NOOP("Commands", "Dark text on light ground"), "eye", "Ctrl+F9", in(Shelf::theme, 1), kCheckable},
    {Command::dark, "actionThemeDark", QT_TRANSLATE_NOOP("Commands", "Dark"),
     QT_TRANSLATE_NOOP("Commands", "Light text on dark ground"), "eye", "Shift+F9", in(Shelf::theme, 2), kCheckable},
    {Command::about, "actionAbout", QT_TRANSLATE_NOOP("Commands", "About Handpiece"),
     QT_TRANSLATE_NOOP("Commands", "Version, licences"), "info", "Shift+F1", in(Shelf::help, 10)},
};

}  // namespace

LayoutFeature::LayoutFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands) {
    connectLayouts();
    connectThemes();
    listLanguages();
    on(commands_[Command::about], [this] { showAbout(); });
}

void LayoutFeature::connectLayouts() {
    auto* layouts = new QActionGroup(this);
    for (const auto& [command, detail] :
         {std::pair(Command::practice, Detail::practice), std::pair(Command::laboratory, Detail::laboratory),
          std::pair(Command::paper, Detail::paper)}) {
        QAction* action = commands_[command];
        layouts->addAction(action);
        on(action, [this, d = detail] { window_.setDetail(d); });
        connect(&window_, &MainWindow::detailChanged, action, [action, d = detail](Detail now) {
            if (now == d) action->setChecked(true);
        });
    }
    on(commands_[Command::resetLayout], [this] { window_.resetLayout(); });
    connect(commands_[Command::fullScreen], &QAction::toggled, this,
            [this](bool full) { full ? window_.showFullScreen() : window_.showNormal(); });
}

void LayoutFeature::connectThemes() {
    auto* themes = new QActionGroup(this);
    const QString theme = settings_.value(QStringLiteral("window/theme"), QStringLiteral("system")).toString();
    const auto appearance = [&](Command command, const char* key, Appearance value) {
        themes->addAction(commands_[command]);
        commands_[command]->setChecked(theme == QLatin1String(key));
        on(commands_[command], [this, key, value] {
            settings_.set(QStringLiteral("window/theme"), QLatin1String(key));
            emit window_.appearanceChosen(value);
        });
    };
    appearance(Command::asDesktop, "system", Appearance::system);
    appearance(Command::light, "light", Appearance::light);
    appearance(Command::dark, "dark", Appearance::dark);
}

void LayoutFeature::listLanguages() {
    QMenu* languages = window_.shelves().menu(Shelf::language);
    auto* group = new QActionGroup(this);
    const QString chosen = settings_.value(QStringLiteral("window/language"), QStringLiteral("system")).toString();
    for (const QString& code : QStringList{QStringLiteral("system")} + Language::codes()) {
        QAction* action =
            languages->addAction(code == QLatin1String("system") ? tr("As the desktop") : Language::nameOf(code));
        action->setObjectName(QStringLiteral("actionLanguage_") + code);
        action->setToolTip(tr("The language of the window"));
        action->setCheckable(true);
        action->setChecked(code == chosen);
        group->addAction(action);
        connect(action, &QAction::triggered, this, [this, code] { emit window_.languageChosen(code); });
    }
}

void LayoutFeature::showAbout() {
    QMessageBox box(&window_);
    box.setObjectName(QStringLiteral("aboutDialog"));
    box.setWindowTitle(tr("About Handpiece"));
    box.setIconPixmap(window_.windowIcon().pixmap(64));
    box.setTextFormat(Qt::RichText);
    box.setText(tr("<h3>Handpiece %1</h3><p>An open dental surgery simulator: touch a tooth and cut it.</p>")
                    .arg(QStringLiteral(HANDPIECE_VERSION)));
    box.setInformativeText(
        tr("<p>Licensed under the Apache License 2.0. For teaching; no medical device.</p>"
           "<p>It stands on: Qt %1 (LGPL 3), OpenAL Soft (LGPL 2), Mesa (MIT), Eigen (MPL 2), fmt (MIT), oneTBB "
           "(Apache 2.0), "
           "Qhull (Qhull licence), HDF5 (BSD), libzip (BSD), SQLite (public domain), zlib (zlib), libpng (libpng), "
           "toml++ (MIT), "
           "nlohmann-json (MIT), CLI11 (BSD).</p><p>Draws with: %2</p><p>Sound: %3</p>")
            .arg(
                QLatin1String(qVersion()),
                view_.rendererDescription().isEmpty() ? tr("nothing yet") : view_.rendererDescription().toHtmlEscaped(),
                QString::fromStdString(simulator_.soundStatus().device).toHtmlEscaped()));
    if (auto* informative = box.findChild<QLabel*>(QStringLiteral("qt_msgbox_informativelabel")))
        informative->setTextFormat(Qt::RichText);
    box.exec();
}

}  // namespace handpiece::desktop
