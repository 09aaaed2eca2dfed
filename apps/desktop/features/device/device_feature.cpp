// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/device_feature.h"

#include <QActionGroup>
#include <QInputDialog>
#include <QMenu>
#include <chrono>
#include <utility>

#include "desktop/features/device/pedal_menu.h"
#include "desktop/widgets/status_line.h"
#include "desktop/work/device_words.h"
#include "desktop/work/simulator.h"

namespace handpiece::desktop {
namespace {

using Command = DeviceFeature::Command;
constexpr CommandOf<Command> kCommands[] = {
    {Command::page, "actionDevicePage", QT_TRANSLATE_NOOP("Commands", "Device page..."),
     QT_TRANSLATE_NOOP("Commands", "How the device is doing, its settings, and a check of how good it feels"),
     "settings", "F8"},
    {Command::setUp, "actionDeviceSetUp", QT_TRANSLATE_NOOP("Commands", "Set up..."),
     QT_TRANSLATE_NOOP("Commands", "Connect, calibrate, feel a block"), "check", "Shift+F8"},
    {Command::byName, "actionDeviceNamed", QT_TRANSLATE_NOOP("Commands", "Device by name or serial..."),
     QT_TRANSLATE_NOOP("Commands", "Choose one of several equal devices"), "search", "Ctrl+Shift+F8"},
    {Command::search, "actionDeviceSearch", QT_TRANSLATE_NOOP("Commands", "Look for devices"),
     QT_TRANSLATE_NOOP("Commands", "Look again which devices are connected"), "search", "Ctrl+F8"},
};

template <class Dialog>
void bringForward(Dialog* dialog) {
    dialog->show();
    dialog->raise();
    dialog->activateWindow();
}

}  // namespace

DeviceFeature::DeviceFeature(const FeatureContext& context)
    : Feature(context),
      commands_(window_.commands(), kCommands),
      menu_(window_.shelves().menu(Shelf::device)),
      pedals_(new PedalMenu(simulator_.foot(), settings_, window_.notices(), &window_)),
      realTime_(context.realTime) {
    connect(pedals_, &PedalMenu::failed, &window_, &MainWindow::showProblem);
    connectMenu();
    connectDevices();
    window_.statusFields.push_back([this](StatusFigures& figures) {
        showDevice(figures);
        showRate(figures);
    });
    list();
}

void DeviceFeature::connectMenu() {
    DeviceManager& hands = simulator_.hands();
    connect(menu_, &QMenu::aboutToShow, this, [this, &hands] {
        if (hands.rows().empty()) hands.look();
        list();
    });
    StatusLine& status = window_.status();
    connect(&status, &StatusLine::deviceClicked, this,
            [this, &status] { menu_->popup(status.mapToGlobal(QPoint(0, -menu_->sizeHint().height()))); });
    connect(commands_[Command::search], &QAction::triggered, &hands, &DeviceManager::look);
    on(commands_[Command::page], [this] { openPage(); });
    on(commands_[Command::setUp], [this] { setUp(); });
    on(commands_[Command::byName], [this] { askForName(); });
}

void DeviceFeature::connectDevices() {
    DeviceManager& hands = simulator_.hands();
    Notices& notices = window_.notices();
    connect(&hands, &DeviceManager::foundChanged, this, &DeviceFeature::list);
    connect(&hands, &DeviceManager::changed, this, &DeviceFeature::list);
    connect(&hands, &DeviceManager::opened, this, [this, &hands, &notices] {
        notices.takeBack(End::deviceOpened);
        isAsked_ = false;
        settings_.set(QStringLiteral("work/device"), hands.wanted());
        // Its first three steps come by themselves, once.
        const QString seen = QStringLiteral("device/seen_") + hands.wanted();
        const Hand& hand = *hands.current();
        if (!hand.info().pushes || hand.wasSetUp() || settings_.value(seen).toBool()) return;
        settings_.set(seen, true);
        setUp();
    });
    connect(&hands, &DeviceManager::refused, this, [this, &notices](const QString& name, const Problem& problem) {
        tried_ = name;
        if (std::exchange(isAsked_, false)) {
            window_.showProblem(problem);
        } else {
            notices.tell(Notice::deviceAbsent, {problem.what, problem.remedy});
        }
    });
    connect(&hands, &DeviceManager::troubled, this, &DeviceFeature::tellTrouble);
    connect(&hands, &DeviceManager::lost, this,
            [this, &notices](const QString& name, link::DeviceFault trouble, int vendorCode) {
                tried_ = name;
                notices.takeBack(End::troubleOver);
                const Problem problem = problemOf(trouble, vendorCode);
                notices.tell(Notice::deviceLost, {problem.what, problem.remedy});
            });
    connect(&notices, &Notices::remedyChosen, this, [this, &notices](Notice notice) {
        if (notice != Notice::deviceLost && notice != Notice::deviceAbsent) return;
        notices.remove(notice);
        choose(tried_);
    });
}

void DeviceFeature::choose(const QString& name) {
    DeviceManager& hands = simulator_.hands();
    if (name.isEmpty()) {
        settings_.set(QStringLiteral("work/device"), QStringLiteral("mouse"));
        window_.notices().takeBack(End::deviceLetGo);
        hands.letGo();
        return;
    }
    if (hands.isOpening() || (hands.current() && hands.wanted() == name)) {
        list();
        return;
    }
    isAsked_ = true;
    hands.choose(name);
}

/// Of several equal ones: a device that the list cannot tell, by its name or serial.
void DeviceFeature::askForName() {
    auto* dialog = new QInputDialog(&window_);
    dialog->setObjectName(QStringLiteral("deviceNameDialog"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Device by name or serial"));
    QStringList drivers;
    for (const std::string& driver : input::deviceNames())
        drivers << QString::fromStdString(driver);
    dialog->setLabelText(tr("One of %1; a colon; then the device's name, serial or number.\nopenhaptics:Left Arm, or "
                            "forcedimension:2")
                             .arg(drivers.join(QStringLiteral(", "))));
    dialog->setTextValue(simulator_.hands().wanted());
    connect(dialog, &QInputDialog::textValueSelected, this, [this](const QString& text) {
        if (const QString name = text.trimmed(); !name.isEmpty()) choose(name);
    });
    dialog->open();
}

void DeviceFeature::tellTrouble(link::DeviceFault trouble, int vendorCode) {
    window_.notices().takeBack(End::troubleOver);
    if (trouble == link::DeviceFault::none) return;
    const Problem problem = problemOf(trouble, vendorCode);
    window_.notices().tell(Notice::deviceTrouble, {problem.what, problem.remedy});
}

/// Made anew: what is connected changes.
void DeviceFeature::list() {
    const DeviceManager& hands = simulator_.hands();
    // The actions of the list belong to the group and go with it.
    delete menu_->findChild<QActionGroup*>(QStringLiteral("deviceGroup"));
    menu_->clear();
    auto* group = new QActionGroup(menu_);
    group->setObjectName(QStringLiteral("deviceGroup"));
    const auto add = [this, group](const QString& name, const QString& text, const QString& tip, bool chosen) {
        auto* action = new QAction(text, group);
        action->setObjectName(QStringLiteral("actionDevice_") + (name.isEmpty() ? QStringLiteral("mouse") : name));
        action->setToolTip(tip);
        action->setStatusTip(tip);
        action->setCheckable(true);
        action->setChecked(chosen);
        connect(action, &QAction::triggered, this, [this, name] { choose(name); });
        menu_->addAction(action);
    };
    add({}, tr("Mouse and keyboard"), tr("Always there"), hands.wanted().isEmpty());
    bool listed = hands.wanted().isEmpty();
    for (const DeviceRow& row : hands.rows()) {
        const bool chosen = row.name == hands.wanted();
        listed = listed || chosen;
        const bool there = row.available || (chosen && hands.current());
        QString tip = row.pushes ? tr("Gives force") : tr("Moves the handpiece, gives no force");
        if (!there) tip = row.remedy.isEmpty() ? row.why : row.why + QLatin1Char(' ') + row.remedy;
        add(row.name, there ? row.text : tr("%1: not there").arg(row.text), tip, chosen);
    }
    if (!listed) add(hands.wanted(), hands.textOf(hands.wanted()), {}, true);
    if (hands.isLooking()) {
        QAction* looking = menu_->addAction(tr("Looking..."));
        looking->setObjectName(QStringLiteral("actionDevice_looking"));
        looking->setEnabled(false);
    }
    menu_->addSeparator();
    menu_->addAction(commands_[Command::byName]);
    menu_->addMenu(pedals_->menu());
    menu_->addSeparator();
    for (const Command command : {Command::page, Command::setUp, Command::search})
        menu_->addAction(commands_[command]);
    commands_[Command::search]->setEnabled(!hands.isLooking());
    commands_[Command::setUp]->setEnabled(hands.current() != nullptr);
}

void DeviceFeature::showDevice(StatusFigures& figures) const {
    const DeviceManager& hands = simulator_.hands();
    figures.device = deviceInHand(simulator_);
    if (hands.isOpening()) figures.deviceFault = tr("being opened");
    if (!holdsDevice(simulator_)) return;
    figures.servoHz = hands.health().servoHz;
    if (hands.trouble() != link::DeviceFault::none)
        figures.deviceFault = problemOf(hands.trouble(), hands.health().gate.vendorCode).what;
}

void DeviceFeature::showRate(StatusFigures& figures) {
    const simulation::LiveSessionStatus& status = simulator_.status();
    // The rate over a second of the clock, not of the loop.
    const qint64 nowNs =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
            .count();
    if (nowNs - sinceNs_ > 1000000000) {
        if (sinceNs_ > 0 && status.ticks >= ticks_)
            rateHz_ = 1e9 * static_cast<double>(status.ticks - ticks_) / static_cast<double>(nowNs - sinceNs_);
        // A word is due when one in a hundred is late.
        isLate_ = status.lateTicks + status.missedPeriods > lateTicks_ + static_cast<std::uint64_t>(0.01 * rateHz_) + 1;
        ticks_ = status.ticks;
        lateTicks_ = status.lateTicks + status.missedPeriods;
        sinceNs_ = nowNs;
    }
    figures.rateHz = rateHz_;
    figures.lateTicks = status.lateTicks;
    figures.missedPeriods = status.missedPeriods;
    figures.load = status.load;
    figures.late = isLate_;
}

void DeviceFeature::openPage() {
    if (!page_) {
        page_ = new DevicePage(
            simulator_, settings_,
            [this](const QString& title, const QString& start, const QString& filter) {
                return window_.questions.fileToSave(title, start, filter);
            },
            &window_);
        page_->setAttribute(Qt::WA_DeleteOnClose);
    }
    bringForward(page_.data());
}

void DeviceFeature::setUp() {
    if (!simulator_.hands().current()) return;
    if (!steps_) {
        steps_ = new FirstPlugIn(simulator_, realTime_, &window_);
        steps_->setAttribute(Qt::WA_DeleteOnClose);
    }
    bringForward(steps_.data());
}

}  // namespace handpiece::desktop
