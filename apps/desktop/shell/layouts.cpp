// SPDX-License-Identifier: Apache-2.0
// Panels, bars and menus, and where they are in the three layouts.
#include <QComboBox>
#include <QDockWidget>
#include <QHBoxLayout>
#include <QLabel>
#include <QLocale>
#include <QMenu>
#include <QMenuBar>
#include <QScrollArea>
#include <QShortcut>
#include <QSlider>
#include <QStatusBar>
#include <QToolBar>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "exercise/exercise_feature.h"
#include "exercise/exercise_panel.h"
#include "panels/drill_bar.h"
#include "panels/force_gauge.h"
#include "panels/icon_factory.h"
#include "panels/measure_box.h"
#include "panels/notation.h"
#include "panels/notice_bar.h"
#include "panels/parameter_box.h"
#include "panels/plot_panel.h"
#include "panels/replay_bar.h"
#include "panels/sound_control.h"
#include "panels/status_line.h"
#include "panels/view_bar.h"
#include "panels/volume_bars.h"
#include "shell/job_strip.h"
#include "shell/language.h"
#include "shell/main_window.h"

namespace handpiece::desktop {
namespace {

constexpr int kStateVersion = 1;

struct Place {
    const char* name;
    Qt::DockWidgetArea area;
    int size;                ///< of its share of the area [pixels]
    const char* tabbedWith;  ///< null: beside the others
};
// From top to bottom. What is not named is closed.
constexpr Place kPractice[] = {
    {"exerciseDock", Qt::LeftDockWidgetArea, 190, nullptr}, {"drillDock", Qt::LeftDockWidgetArea, 510, nullptr},
    {"gaugeDock", Qt::RightDockWidgetArea, 84, nullptr},    {"measureDock", Qt::RightDockWidgetArea, 360, nullptr},
    {"volumesDock", Qt::RightDockWidgetArea, 160, nullptr}, {"soundDock", Qt::RightDockWidgetArea, 150, nullptr}};
constexpr Place kLaboratory[] = {{"exerciseDock", Qt::LeftDockWidgetArea, 190, nullptr},
                                 {"drillDock", Qt::LeftDockWidgetArea, 510, nullptr},
                                 {"lookDock", Qt::LeftDockWidgetArea, 700, "drillDock"},
                                 {"parameterDock", Qt::RightDockWidgetArea, 480, nullptr},
                                 {"measureDock", Qt::RightDockWidgetArea, 480, "parameterDock"},
                                 {"soundDock", Qt::RightDockWidgetArea, 480, "parameterDock"},
                                 {"gaugeDock", Qt::RightDockWidgetArea, 110, nullptr},
                                 {"plotDock", Qt::BottomDockWidgetArea, 290, nullptr},
                                 {"volumesDock", Qt::BottomDockWidgetArea, 290, nullptr}};
constexpr Place kPaper[] = {{"exerciseDock", Qt::LeftDockWidgetArea, 190, nullptr},
                            {"drillDock", Qt::LeftDockWidgetArea, 510, nullptr},
                            {"soundDock", Qt::RightDockWidgetArea, 240, nullptr},
                            {"parameterDock", Qt::RightDockWidgetArea, 460, nullptr}};

std::span<const Place> placesOf(Detail detail) {
    if (detail == Detail::practice) return kPractice;
    if (detail == Detail::laboratory) return kLaboratory;
    return kPaper;
}

}  // namespace

QDockWidget* MainWindow::dock(const char* name, const QString& title, QWidget* panel) {
    auto* scroll = new QScrollArea;
    scroll->setWidgetResizable(true);
    scroll->setFrameShape(QFrame::NoFrame);
    scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    scroll->setWidget(panel);
    scroll->setMinimumWidth(panel->minimumSizeHint().width() + 4);
    auto* widget = new QDockWidget(title, this);
    widget->setObjectName(QLatin1String(name));
    widget->setAccessibleName(title);
    widget->setWidget(scroll);
    widget->toggleViewAction()->setObjectName(QStringLiteral("actionPanel_") + QLatin1String(name));
    widget->toggleViewAction()->setToolTip(tr("Show or hide this panel"));
    docks_ << widget;
    return widget;
}

void MainWindow::makePanels() {
    auto* centre = new QWidget;
    centre->setObjectName(QStringLiteral("centre"));
    auto* column = new QVBoxLayout(centre);
    column->setContentsMargins(0, 0, 0, 0);
    column->setSpacing(0);
    job_ = new JobStrip;
    notices_ = new NoticeBar;
    welcome_ = new WelcomeStrip;
    view_ = new ViewWidget;
    if (view_->objectName().isEmpty()) view_->setObjectName(QStringLiteral("view"));
    replay_ = new ReplayBar;
    for (QWidget* strip :
         {static_cast<QWidget*>(job_), static_cast<QWidget*>(notices_), static_cast<QWidget*>(welcome_)})
        view_->addStrip(strip);
    column->addWidget(view_, 1);
    column->addWidget(replay_);
    replay_->hide();
    setCentralWidget(centre);

    auto* exercise = new ExercisePanel;
    QDockWidget* exerciseDock = dock("exerciseDock", tr("Exercise"), exercise);
    exercise_ = new ExerciseFeature(simulator_, settings_, *actions_, exercise, exerciseDock, this);
    dock("drillDock", tr("Drill"), drill_ = new DrillBar);
    dock("lookDock", tr("View"), looks_ = new ViewBar);
    dock("gaugeDock", tr("Pressure"), gauge_ = new ForceGauge);
    dock("measureDock", tr("Measure"), measure_ = new MeasureBox);
    dock("volumesDock", tr("Removed"), volumes_ = new VolumeBars);
    dock("soundDock", tr("Sound"), sound_ = new SoundControl);
    dock("parameterDock", tr("Parameters"), parameters_ = new ParameterBox);
    dock("plotDock", tr("Plots"), plots_ = new PlotPanel);
    // The docks' titles say it.
    gauge_->setHeadingShown(false);
    volumes_->setHeadingShown(false);
    sound_->setHeadingShown(false);
    parameters_->setHeadingShown(false);
    setDockOptions(AnimatedDocks | AllowTabbedDocks | AllowNestedDocks);
    setTabPosition(Qt::AllDockWidgetAreas, QTabWidget::North);
    setCorner(Qt::BottomLeftCorner, Qt::LeftDockWidgetArea);
    setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);

    code_ = new QLabel;
    code_->setObjectName(QStringLiteral("codeNote"));
    code_->setToolTip(tr("The code your teacher gave you: File, Your code..."));
    statusBar()->addPermanentWidget(code_);
    status_ = new StatusLine;
    soundNote_ = new QLabel;
    soundNote_->setObjectName(QStringLiteral("soundNote"));
    statusBar()->setObjectName(QStringLiteral("statusBar"));
    statusBar()->addPermanentWidget(soundNote_);
    statusBar()->addPermanentWidget(status_);
}

void MainWindow::makeBars() {
    const Actions& a = *actions_;
    fileBar_ = addToolBar(tr("File bar"));
    fileBar_->setObjectName(QStringLiteral("fileBar"));
    resolution_ = new QComboBox;
    resolution_->setObjectName(QStringLiteral("resolutionBox"));
    resolution_->setAccessibleName(tr("Starter tooth's resolution"));
    resolution_->setToolTip(tr("The starter tooth at one of the five resolutions of the paper's Table II"));
    resolution_->addItem(tr("Starter tooth"));
    for (const Resolution& r : kResolutions)
        resolution_->addItem(tr("%1 % · %2 faces").arg(r.percent).arg(QLocale().toString(qulonglong{r.faces})),
                             qulonglong{r.faces});
    fileBar_->addAction(a["actionOpenCase"]);
    fileBar_->addWidget(resolution_)->setObjectName(QStringLiteral("resolutionAction"));
    fileBar_->addAction(a["actionChooseTooth"]);
    fileBar_->addAction(a["actionResume"]);
    fileBar_->addAction(a["actionSave"]);
    fileBar_->addAction(a["actionSaveAs"]);

    toolBar_ = addToolBar(tr("Tool bar"));
    toolBar_->setObjectName(QStringLiteral("toolBar"));
    for (const char* name :
         {"actionTouch", "actionCut", "", "actionUndo", "actionRedo", "actionReset", "", "actionMirror",
          "actionMeasure", "actionDepth", "actionPulp", "actionSection", "actionCompare", ""}) {
        if (*name) {
            toolBar_->addAction(a[name]);
        } else {
            toolBar_->addSeparator();
        }
    }
    auto* views = new QMenu(tr("Views"), this);
    views->setObjectName(QStringLiteral("viewsMenu"));
    for (const char* name : {"actionViewOcclusal", "actionViewBuccal", "actionViewLingual", "actionViewMesial",
                             "actionViewDistal", "actionViewOblique", "actionFit", "actionGoToBur"})
        views->addAction(a[name]);
    auto* viewsButton = new QToolButton;
    viewsButton->setObjectName(QStringLiteral("viewsButton"));
    viewsButton->setText(tr("Views"));
    viewsButton->setToolTip(tr("Standard dental views"));
    viewsButton->setAccessibleName(tr("Standard dental views"));
    viewsButton->setIcon(icon(QStringLiteral("views")));
    viewsButton->setMenu(views);
    viewsButton->setPopupMode(QToolButton::InstantPopup);
    connect(toolBar_, &QToolBar::toolButtonStyleChanged, viewsButton, &QToolButton::setToolButtonStyle);
    connect(toolBar_, &QToolBar::iconSizeChanged, viewsButton, &QToolButton::setIconSize);
    toolBar_->addWidget(viewsButton);
    toolBar_->addSeparator();
    for (const char* name : {"actionKeepRecording", "actionReplay", "actionPicture"})
        toolBar_->addAction(a[name]);
    auto* mixBox = new QWidget;
    auto* row = new QHBoxLayout(mixBox);
    row->setContentsMargins(10, 0, 10, 0);
    mix_ = new QSlider(Qt::Horizontal);
    mix_->setObjectName(QStringLiteral("mixSlider"));
    mix_->setAccessibleName(tr("Mixing ratio of motor and cutting sound"));
    mix_->setToolTip(tr("Mixing ratio: left the motor alone, right the cutting alone"));
    mix_->setRange(0, 100);
    mix_->setFixedWidth(90);
    row->addWidget(new QLabel(tr("Motor")));
    row->addWidget(mix_);
    row->addWidget(new QLabel(tr("Cutting")));
    QAction* mixAction = toolBar_->addWidget(mixBox);
    mixAction->setObjectName(QStringLiteral("mixAction"));
    for (QToolBar* bar : {fileBar_, toolBar_}) {
        bar->setMovable(true);
        bar->setIconSize({22, 22});
    }
}

void MainWindow::makeMenus() {
    const Actions& a = *actions_;
    const auto menu = [this](const char* name, const QString& title) {
        QMenu* made = menuBar()->addMenu(title);
        made->setObjectName(QLatin1String(name));
        made->setToolTipsVisible(true);
        return made;
    };
    const auto fill = [&a](QMenu* into, std::initializer_list<const char*> names) {
        for (const char* name : names) {
            if (*name) {
                into->addAction(a[name]);
            } else {
                into->addSeparator();
            }
        }
    };
    const auto under = [](QMenu* in, const char* name, const QString& title) {
        QMenu* made = in->addMenu(title);
        made->setObjectName(QLatin1String(name));
        return made;
    };
    // No mnemonics: Alt belongs to the window manager, F10 opens the first menu.
    QMenu* file = menu("menuFile", tr("File"));
    fill(file, {"actionOpenCase", "actionOpenStl", "actionNewScan"});
    QMenu* starters = under(file, "menuStarter", tr("Starter tooth"));
    for (const starter::ToothKindInfo& info : starter::toothKinds()) {
        QMenu* kind = under(starters, "", toothName(info.fdiNumber));
        kind->setObjectName(QStringLiteral("menuStarter_") +
                            QLatin1String(info.name.data(), qsizetype(info.name.size())));
        for (const Resolution& r : kResolutions) {
            QAction* open =
                kind->addAction(tr("%1 % · %2 faces").arg(r.percent).arg(QLocale().toString(qulonglong{r.faces})));
            open->setObjectName(QStringLiteral("actionStarter_%1_%2")
                                    .arg(QLatin1String(info.name.data(), qsizetype(info.name.size())))
                                    .arg(r.percent));
            open->setToolTip(tr("Open this starter tooth"));
            connect(open, &QAction::triggered, this, [this, kind = info.kind, faces = r.faces] {
                openStarter({kind, faces});
            });
        }
    }
    fill(file, {"actionChooseTooth"});
    recent_ = under(file, "menuRecent", tr("Open recent"));
    fill(file, {"actionResume", "actionRecover", "actionCode", "", "actionSave", "actionSaveAs", "actionHandIn",
                "actionExportStl", "actionExportTissues", "", "actionOpenSession", "actionReplay",
                "actionKeepRecording", "", "actionPicture", "actionReport", "", "actionQuit"});
    fill(menu("menuEdit", tr("Edit")), {"actionUndo", "actionRedo", "", "actionReset"});

    QMenu* view = menu("menuView", tr("View"));
    fill(view, {"actionViewOcclusal", "actionViewBuccal", "actionViewLingual", "actionViewMesial", "actionViewDistal",
                "actionViewOblique", "", "actionFit", "actionGoToBur", "", "actionLayoutPractice",
                "actionLayoutLaboratory", "actionLayoutPaper"});
    panelsMenu_ = under(view, "menuPanels", tr("Panels"));
    for (QDockWidget* panel : docks_)
        panelsMenu_->addAction(panel->toggleViewAction());
    panelsMenu_->addSeparator();
    for (QToolBar* bar : {fileBar_, toolBar_}) {
        bar->toggleViewAction()->setObjectName(QStringLiteral("actionPanel_") + bar->objectName());
        bar->toggleViewAction()->setToolTip(tr("Show or hide this bar"));
        panelsMenu_->addAction(bar->toggleViewAction());
    }
    fill(view, {"actionExercise", "actionResetLayout", "actionFullScreen", ""});
    fill(under(view, "menuTheme", tr("Colours of the window")),
         {"actionThemeSystem", "actionThemeLight", "actionThemeDark"});
    QMenu* languages = under(view, "menuLanguage", tr("Language"));
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
        connect(action, &QAction::triggered, this, [this, code] { emit languageChosen(code); });
    }

    fill(menu("menuTools", tr("Tools")),
         {"actionTouch", "actionCut", "actionPedal", "", "actionMeasure", "actionDepth", "actionPulp", "actionSection",
          "actionMirror", "actionCompare", "actionClearMeasurements", "", "actionBindings"});
    fill(menu("menuSound", tr("Sound")),
         {"actionMute", "", "actionMotorLouder", "actionMotorSofter", "actionCuttingLouder", "actionCuttingSofter"});
    devices_ = menu("menuDevice", tr("Device"));
    fill(menu("menuHelp", tr("Help")), {"actionHelp", "", "actionAbout"});
    auto* menus = new QShortcut(Qt::Key_F10, this);
    connect(menus, &QShortcut::activated, this, [this] { menuBar()->setActiveAction(menuBar()->actions().front()); });
}

QString MainWindow::layoutKey(Detail detail) const {
    static constexpr const char* kNames[] = {"practice", "laboratory", "paper"};
    return QStringLiteral("layout/%1").arg(QLatin1String(kNames[static_cast<int>(detail)]));
}

void MainWindow::rememberLayout() {
    if (arranged_) settings_.set(layoutKey(detail_), saveState(kStateVersion));
}

void MainWindow::setDetail(Detail detail) {
    if (arranged_ && detail == detail_) return;
    rememberLayout();
    detail_ = detail;
    arrange(detail);
    arranged_ = true;
    const QByteArray state = settings_.value(layoutKey(detail)).toByteArray();
    if (!state.isEmpty()) restoreState(state, kStateVersion);
    exercise_->placeDock();
    (*actions_)[detail == Detail::practice     ? "actionLayoutPractice"
                : detail == Detail::laboratory ? "actionLayoutLaboratory"
                                               : "actionLayoutPaper"]
        ->setChecked(true);
}

void MainWindow::arrange(Detail detail) {
    setUpdatesEnabled(false);
    drill_->setDetail(detail);
    looks_->setDetail(detail);
    gauge_->setDetail(detail);
    measure_->setDetail(detail);
    // The panel has the same controls.
    view_->setSectionBarShown(detail != Detail::practice);
    volumes_->setDetail(detail);
    sound_->setDetail(detail);
    parameters_->setDetail(detail);
    plots_->setDetail(detail);
    status_->setDetail(detail);

    const auto byName = [this](const char* name) {
        for (QDockWidget* panel : docks_)
            if (panel->objectName() == QLatin1String(name)) return panel;
        return static_cast<QDockWidget*>(nullptr);
    };
    for (QDockWidget* panel : docks_) {
        panel->setFloating(false);
        removeDockWidget(panel);
    }
    QList<QDockWidget*> vertical, first;
    QList<int> sizes;
    for (const Place& place : placesOf(detail)) {
        QDockWidget* panel = byName(place.name);
        addDockWidget(place.area, panel);
        if (place.tabbedWith) {
            tabifyDockWidget(byName(place.tabbedWith), panel);
        } else {
            vertical << panel;
            // On a low screen the picture keeps its share.
            const bool below = place.area == Qt::BottomDockWidgetArea;
            sizes << (below ? std::min(place.size, height() * 3 / 10) : place.size);
            first << panel;
        }
        panel->show();
    }
    resizeDocks(vertical, sizes, Qt::Vertical);
    for (const Place& place : placesOf(detail)) {
        QDockWidget* panel = byName(place.name);
        if (place.area != Qt::BottomDockWidgetArea)
            resizeDocks({panel}, {place.area == Qt::LeftDockWidgetArea ? 262 : 304}, Qt::Horizontal);
    }
    if (detail == Detail::laboratory)
        resizeDocks({byName("plotDock"), byName("volumesDock")}, {620, 230}, Qt::Horizontal);
    for (QDockWidget* panel : first)
        panel->raise();
    exercise_->placeDock();

    const bool practice = detail == Detail::practice;
    removeToolBar(fileBar_);
    removeToolBar(toolBar_);
    addToolBar(Qt::TopToolBarArea, fileBar_);
    if (detail == Detail::paper) addToolBarBreak();
    addToolBar(Qt::TopToolBarArea, toolBar_);
    fileBar_->show();
    toolBar_->show();
    const Qt::ToolButtonStyle style = practice ? Qt::ToolButtonTextUnderIcon : Qt::ToolButtonIconOnly;
    fileBar_->setToolButtonStyle(detail == Detail::paper ? Qt::ToolButtonTextBesideIcon : style);
    toolBar_->setToolButtonStyle(detail == Detail::paper ? Qt::ToolButtonTextBesideIcon : style);
    for (QAction* action : fileBar_->actions())
        if (action->objectName() == QLatin1String("resolutionAction")) action->setVisible(!practice);
    for (QAction* action : toolBar_->actions())
        if (action->objectName() == QLatin1String("mixAction")) action->setVisible(detail == Detail::paper);
    setUpdatesEnabled(true);
}

}  // namespace handpiece::desktop
