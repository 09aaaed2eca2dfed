// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/view/view_feature.h"

#include <QCryptographicHash>
#include <QDockWidget>
#include <QLocale>
#include <QMenu>
#include <QToolBar>
#include <QToolButton>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "desktop/features/view/guide_dialog.h"
#include "desktop/features/view/view_bar.h"
#include "desktop/framework/mnemonics.h"
#include "desktop/picture/start_view.h"
#include "desktop/widgets/icon_factory.h"
#include "desktop/work/simulator.h"
#include "handpiece/model/case/held_aside.h"

namespace handpiece::desktop {
namespace {

using exercise::Operation;

constexpr int kEyeMs = 700, kTurnMs = 1000;

using Command = ViewFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::occlusal, "actionViewOcclusal", QT_TRANSLATE_NOOP("Commands", "Occlusal"),
     QT_TRANSLATE_NOOP("Commands", "Occlusal view (key 1)"), "view-occlusal", "Ctrl+1", in(Shelf::view, 0)},
    {Command::buccal, "actionViewBuccal", QT_TRANSLATE_NOOP("Commands", "Buccal"),
     QT_TRANSLATE_NOOP("Commands", "Buccal view (key 2)"), "view-buccal", "Ctrl+2", in(Shelf::view, 1)},
    {Command::lingual, "actionViewLingual", QT_TRANSLATE_NOOP("Commands", "Lingual"),
     QT_TRANSLATE_NOOP("Commands", "Lingual view (key 3)"), "view-lingual", "Ctrl+3", in(Shelf::view, 2)},
    {Command::mesial, "actionViewMesial", QT_TRANSLATE_NOOP("Commands", "Mesial"),
     QT_TRANSLATE_NOOP("Commands", "Mesial view (key 4)"), "view-mesial", "Ctrl+4", in(Shelf::view, 3)},
    {Command::distal, "actionViewDistal", QT_TRANSLATE_NOOP("Commands", "Distal"),
     QT_TRANSLATE_NOOP("Commands", "Distal view (key 5)"), "view-distal", "Ctrl+5", in(Shelf::view, 4)},
    {Command::oblique, "actionViewOblique", QT_TRANSLATE_NOOP("Commands", "Oblique"),
     QT_TRANSLATE_NOOP("Commands", "Oblique view, occlusal and buccal (key 6)"), "view-oblique", "Ctrl+6",
     in(Shelf::view, 5)},
    {Command::fit, "actionFit", QT_TRANSLATE_NOOP("Commands", "Whole tooth"),
     QT_TRANSLATE_NOOP("Commands", "Show the whole tooth (key Home)"), "fit", "Ctrl+Home", in(Shelf::view, 10)},
    {Command::goToBur, "actionGoToBur", QT_TRANSLATE_NOOP("Commands", "Go to the bur"),
     QT_TRANSLATE_NOOP("Commands", "Look closely at the bur (key F)"), "bur", "Ctrl+F", in(Shelf::view, 11)},
    {Command::mirror, "actionMirror", QT_TRANSLATE_NOOP("Commands", "Mouth mirror"),
     QT_TRANSLATE_NOOP("Commands", "Hold a mouth mirror"), "mirror", "Ctrl+M", in(Shelf::tools, 14),
     in(Shelf::toolBar, 20), brief(QT_TRANSLATE_NOOP("Commands", "Mirror")), kCheckable, Operation::mirror},
    {Command::compare, "actionCompare", QT_TRANSLATE_NOOP("Commands", "Before and after"),
     QT_TRANSLATE_NOOP("Commands", "The uncut tooth beside the cut one"), "compare", "Ctrl+B", in(Shelf::tools, 15),
     in(Shelf::toolBar, 25), brief(QT_TRANSLATE_NOOP("Commands", "Compare")), kCheckable, Operation::compare},
    {Command::help, "actionHelp", QT_TRANSLATE_NOOP("Commands", "Keys and mouse at a glance"),
     QT_TRANSLATE_NOOP("Commands", "Show which key does what"), "help", "F1", in(Shelf::help, 0)},
    {Command::guide, "actionGuide", QT_TRANSLATE_NOOP("Commands", "User guide"),
     QT_TRANSLATE_NOOP("Commands", "Read how everything is done, chapter by chapter"), "report", "Ctrl+F1",
     in(Shelf::help, 2)},
};
constexpr std::pair<Command, view::StandardView> kViews[] = {
    {Command::occlusal, view::StandardView::occlusal}, {Command::buccal, view::StandardView::buccal},
    {Command::lingual, view::StandardView::lingual},   {Command::mesial, view::StandardView::mesial},
    {Command::distal, view::StandardView::distal},     {Command::oblique, view::StandardView::oblique}};

QString text(const core::Vec3& v) {
    return QStringLiteral("%1 %2 %3").arg(v.x()).arg(v.y()).arg(v.z());
}
std::optional<core::Vec3> vecOf(const QString& text) {
    const QStringList parts = text.split(QLatin1Char(' '));
    if (parts.size() != 3) return std::nullopt;
    core::Vec3 v;
    for (int k = 0; k < 3; ++k) {
        bool ok = false;
        v[k] = parts[k].toDouble(&ok);
        if (!ok || !std::isfinite(v[k])) return std::nullopt;
    }
    return v;
}

QString eyeKey(const std::filesystem::path& file) {
    const QByteArray hash = QCryptographicHash::hash(QByteArray::fromStdString(file.string()), QCryptographicHash::Md5);
    return QStringLiteral("eyes/%1").arg(QLatin1String(hash.toHex().left(16)));
}
/// Of an upper tooth that hangs; where it stood with its crown up is another place.
QString eyeKey(const std::filesystem::path& file, const view::Standing& standing) {
    return standing.isUpper ? eyeKey(file) + QStringLiteral("Hanging") : eyeKey(file);
}
QString turnKey(const std::filesystem::path& file) {
    return eyeKey(file) + QStringLiteral("Turn");
}
}  // namespace

ViewFeature::ViewFeature(const FeatureContext& context)
    : Feature(context), commands_(window_.commands(), kCommands), bar_(new ViewBar) {
    window_.docks().add(
        {"lookDock", tr("View"), 30, {{Detail::laboratory, Qt::LeftDockWidgetArea, 30, 700, "drillDock"}}}, bar_);
    addViewsButton();
    for (const auto& [command, standard] : kViews)
        on(commands_[command], [this, s = standard] { view_.showStandardView(s); });
    on(commands_[Command::fit], [this] { view_.fitTooth(); });
    on(commands_[Command::goToBur], [this] { view_.goToBur(); });
    connect(bar_, &ViewBar::viewChosen, &view_, &ViewWidget::showStandardView);
    connect(bar_, &ViewBar::fitRequested, &view_, &ViewWidget::fitTooth);
    connect(bar_, &ViewBar::lookChanged, this, &ViewFeature::keepLook);
    connect(&view_, &ViewWidget::lookChanged, this, [this] { bar_->setLook(view_.look()); });
    const auto toggle = [this](Command command, auto set, auto changed) {
        connect(commands_[command], &QAction::triggered, &view_, set);
        connect(&view_, changed, commands_[command], &QAction::setChecked);
    };
    toggle(Command::mirror, &ViewWidget::setMirrorShown, &ViewWidget::mirrorChanged);
    toggle(Command::compare, &ViewWidget::setCompare, &ViewWidget::compareChanged);
    const auto isOpen = [this] { return simulator_.mode() != Simulator::Mode::empty; };
    for (const Command command : {Command::fit, Command::goToBur, Command::mirror, Command::compare})
        window_.commands().enableWhile(commands_[command], isOpen);
    connect(&simulator_, &Simulator::wasReset, &view_, &ViewWidget::clearBlood);
    connect(&view_, &ViewWidget::helpRequested, &view_, &ViewWidget::toggleHelpCard);
    on(commands_[Command::help], [this] { view_.toggleHelpCard(); });
    on(commands_[Command::guide], [this] {
        auto* guide = new GuideDialog(
            QLocale().language() == QLocale::Japanese ? QStringLiteral("ja") : QStringLiteral("en"), &window_);
        guide->setAttribute(Qt::WA_DeleteOnClose);
        guide->show();
    });
    connect(&view_, &ViewWidget::openGlMissing, this,
            [this](const QString& what, const QString&) { window_.notices().tell(Notice::openGlMissing, {what}); });
    connect(&view_, &ViewWidget::frameDrawn, this, [this] {
        if (hasPicture_ || !view_.hasTooth()) return;
        hasPicture_ = true;
        emit window_.firstPicture();
    });
    connectEye();
    connect(&simulator_, &Simulator::settingsChanged, this, [this] {
        if (simulator_.bur() && view_.hasTooth()) view_.setBur(simulator_.bur());
    });
    recallLook();
}

void ViewFeature::addViewsButton() {
    auto* views = withMnemonics(new QMenu(tr("Views"), &window_));
    views->setObjectName(QStringLiteral("viewsMenu"));
    for (const auto& [command, standard] : kViews)
        views->addAction(commands_[command]);
    views->addAction(commands_[Command::fit]);
    views->addAction(commands_[Command::goToBur]);
    const QToolBar* bar = window_.shelves().bar(Shelf::toolBar);
    auto* viewsButton = new QToolButton;
    viewsButton->setObjectName(QStringLiteral("viewsButton"));
    viewsButton->setText(tr("Views"));
    viewsButton->setToolTip(tr("Standard dental views"));
    viewsButton->setAccessibleName(tr("Standard dental views"));
    viewsButton->setIcon(icon(QStringLiteral("views")));
    viewsButton->setMenu(views);
    viewsButton->setPopupMode(QToolButton::InstantPopup);
    connect(bar, &QToolBar::toolButtonStyleChanged, viewsButton, &QToolButton::setToolButtonStyle);
    connect(bar, &QToolBar::iconSizeChanged, viewsButton, &QToolButton::setIconSize);
    window_.commands().placeWidget(in(Shelf::toolBar, 30), viewsButton);
}

void ViewFeature::connectEye() {
    connect(&view_, &ViewWidget::cameraChanged, this, [this] {
        const view::Camera& eye = view_.camera();
        simulator_.setEar({eye.eyeMm, eye.forward(), eye.upward()});
        eyeTimer_.start(kEyeMs);
    });
    eyeTimer_.setSingleShot(true);
    turnTimer_.setSingleShot(true);
    connect(&eyeTimer_, &QTimer::timeout, this, &ViewFeature::rememberEye);
    connect(&window_, &MainWindow::aboutToRemember, this, &ViewFeature::rememberEye);
}

void ViewFeature::showDocument() {
    hasPicture_ = false;
    if (!simulator_.tooth() || !simulator_.toothCase()) {
        view_.clearTooth();
        return;
    }
    const cases::Case& toothCase = *simulator_.toothCase();
    view_.setTooth(simulator_.tooth(), simulator_.toothCase(), simulator_.pictureFeed());
    if (isByArm()) view_.setStanding(view::Standing(toothCase.buccalSign));
    const core::Pose held = heldPose();
    view_.setPointer(simulator_.mailbox(), held);
    // As it begins it is not noted: over what a crash has left to be brought back.
    keptTurn_ = held.orientation;
    if (simulator_.bur()) view_.setBur(simulator_.bur());
    view_.setPermissions(simulator_.permissions());
    bar_->setPermissions(simulator_.permissions());
    bar_->setPresent(presentTissues(toothCase));
    bar_->setCheeksThere(std::any_of(toothCase.scenery.begin(), toothCase.scenery.end(), cases::isHeldAside));
    bar_->setScanColoursThere(cases::isScannedInColour(toothCase));
    recallEye();
    if (simulator_.mode() == Simulator::Mode::review) view_.setSample(simulator_.sample());
    // Who marks or types beside it goes on there when a work that is looked at comes.
    const QWidget* has = window_.focusWidget();
    while (has != nullptr && qobject_cast<const QDockWidget*>(has) == nullptr)
        has = has->parentWidget();
    if (has == nullptr || simulator_.mode() == Simulator::Mode::liveSession) view_.setFocus();
}

void ViewFeature::recallLook() {
    view::Look look = view_.look();
    const auto number = [this](const char* key, int otherwise, int most) {
        return static_cast<int>(settings_.number(QStringLiteral("look/") + QLatin1String(key), otherwise, 0, most));
    };
    const auto flag = [this](const char* key, bool otherwise) {
        return settings_.value(QStringLiteral("look/") + QLatin1String(key), otherwise).toBool();
    };
    look.quality = static_cast<view::Quality>(number("quality", static_cast<int>(look.quality), 2));
    look.palette = static_cast<view::Palette>(number("palette", static_cast<int>(look.palette), 2));
    look.stereo = static_cast<view::Stereo>(number("stereo", 0, 2));
    look.wet = flag("wet", look.wet);
    look.scanColours = flag("scanColours", look.scanColours);
    look.debris = flag("debris", look.debris);
    look.spray = flag("spray", look.spray);
    look.shadows = flag("shadows", look.shadows);
    look.turbine = flag("turbine", look.turbine);
    look.scaleBar = flag("scaleBar", look.scaleBar);
    view_.setLook(look);
    bar_->setLook(look);
}

void ViewFeature::keepLook(const view::Look& look) {
    view_.setLook(look);
    const auto set = [this](const char* key, const QVariant& value) {
        settings_.set(QStringLiteral("look/") + QLatin1String(key), value);
    };
    set("quality", static_cast<int>(look.quality));
    set("palette", static_cast<int>(look.palette));
    set("stereo", static_cast<int>(look.stereo));
    set("wet", look.wet);
    set("scanColours", look.scanColours);
    set("debris", look.debris);
    set("spray", look.spray);
    set("shadows", look.shadows);
    set("turbine", look.turbine);
    set("scaleBar", look.scaleBar);
}

void ViewFeature::rememberEye() {
    if (!view_.hasTooth() || simulator_.document().caseFile.empty()) return;
    const view::Camera& eye = view_.camera();
    settings_.set(eyeKey(simulator_.document().caseFile, view_.standing()),
                  QStringList{text(eye.eyeMm), text(eye.targetMm), text(eye.up)});
}

/// Of the student's own hand, once a second at most and only when it is another.
void ViewFeature::showTick() {
    constexpr double kOtherRad = 0.01;
    if (simulator_.mode() != Simulator::Mode::liveSession || view_.hand() == nullptr || turnTimer_.isActive()) return;
    const core::Quat turn = view_.hand()->tilt();
    if (keptTurn_.angularDistance(turn) < kOtherRad) return;
    keptTurn_ = turn;
    turnTimer_.start(kTurnMs);
    settings_.set(turnKey(simulator_.document().caseFile),
                  QStringLiteral("%1 %2 %3 %4").arg(turn.w()).arg(turn.x()).arg(turn.y()).arg(turn.z()));
}

/// Where the hand begins; turned as it was where work goes on: after a crash, in a window of another language.
core::Pose ViewFeature::heldPose() const {
    core::Pose pose = simulator_.startPose();
    const messages::HapticSample& sample = simulator_.sample();
    const double removedMm3 =
        std::accumulate(sample.removedMm3.begin(), sample.removedMm3.end(), sample.removedOthersMm3);
    if (sample.tick == 0 && removedMm3 <= 0.0) return pose;
    const QStringList kept =
        settings_.value(turnKey(simulator_.document().caseFile)).toString().split(QLatin1Char(' '));
    std::array<double, 4> turn{};
    for (std::size_t k = 0; k < turn.size() && kept.size() == 4; ++k)
        turn[k] = kept[static_cast<qsizetype>(k)].toDouble();
    const core::Quat held(turn[0], turn[1], turn[2], turn[3]);
    if (std::abs(held.norm() - 1.0) < 1e-3) pose.orientation = held.normalized();
    return pose;
}

/// A real device leads the bur, in whose reach all teeth lie with their crowns up.
bool ViewFeature::isByArm() const {
    return simulator_.mode() == Simulator::Mode::liveSession && simulator_.mailbox() == nullptr;
}

void ViewFeature::recallEye() {
    const QStringList kept = settings_.value(eyeKey(simulator_.document().caseFile, view_.standing())).toStringList();
    std::optional<core::Vec3> eye, target, up;
    if (kept.size() == 3) {
        eye = vecOf(kept[0]);
        target = vecOf(kept[1]);
        up = vecOf(kept[2]);
    }
    view::Camera camera = view_.camera();
    if (eye && target && up && (*eye - *target).norm() > 1.0 && (*eye - *target).norm() < 1000.0 && up->norm() > 0.5) {
        camera.eyeMm = *eye;
        camera.targetMm = *target;
        camera.up = up->normalized();
        view_.setCamera(camera);
    } else if (const auto& exercise = simulator_.toothCase()->exercise; exercise && exercise->view) {
        camera = lookingAs(camera, *exercise->view);
        if (isByArm() && camera.up.z() < 0.0) camera.up = -camera.up;
        view_.setCamera(camera);
    } else {
        view_.showStandardView(view::StandardView::oblique);
    }
}

}  // namespace handpiece::desktop
