// SPDX-License-Identifier: Apache-2.0
// The menu of devices, and what is told of the one that holds the handpiece.
#include <QActionGroup>
#include <QInputDialog>
#include <QMenu>

#include "panels/notice_bar.h"
#include "panels/status_line.h"
#include "shell/main_window.h"
#include "shell/pedal_menu.h"

namespace handpiece::desktop {

void MainWindow::connectDevice() {
    DeviceManager& hands = simulator_.hands();
    const Actions& a = *actions_;
    connect(devices_, &QMenu::aboutToShow, this, [this, &hands] {
        if (hands.rows().empty()) hands.look();
        listDevices();
    });
    connect(status_, &StatusLine::deviceClicked, this,
            [this] { devices_->popup(status_->mapToGlobal(QPoint(0, -devices_->sizeHint().height()))); });
    connect(a["actionDeviceSearch"], &QAction::triggered, &hands, &DeviceManager::look);
    connect(a["actionDevicePage"], &QAction::triggered, this, [this] {
        if (openDevicePage) openDevicePage();
    });
    connect(a["actionDeviceSetUp"], &QAction::triggered, this, [this] {
        if (setUpDevice) setUpDevice();
    });
    connect(a["actionDeviceNamed"], &QAction::triggered, this, &MainWindow::nameDevice);
    pedals_ = new PedalMenu(simulator_.foot(), settings_, this);
    connect(pedals_, &PedalMenu::noticed, this, &MainWindow::tell);
    connect(pedals_, &PedalMenu::settled, notices_, &NoticeBar::remove);
    connect(pedals_, &PedalMenu::failed, this, &MainWindow::showProblem);
    connect(&hands, &DeviceManager::foundChanged, this, &MainWindow::listDevices);
    connect(&hands, &DeviceManager::changed, this, [this] {
        listDevices();
        showSettings();
    });
    connect(&hands, &DeviceManager::opened, this, [this, &hands] {
        notices_->remove(QStringLiteral("device-lost"));
        notices_->remove(QStringLiteral("device-absent"));
        deviceAsked_ = false;
        settings_.set(QStringLiteral("work/device"), hands.wanted());
        // Its first three steps come by themselves, once.
        const QString seen = QStringLiteral("device/seen_") + hands.wanted();
        const Hand& hand = *hands.current();
        if (!setUpDevice || !hand.info().pushes || hand.wasSetUp() || settings_.value(seen).toBool()) return;
        settings_.set(seen, true);
        setUpDevice();
    });
    connect(&hands, &DeviceManager::refused, this, [this](const QString& name, const Problem& problem) {
        deviceTried_ = name;
        if (std::exchange(deviceAsked_, false)) {
            showProblem(problem);
        } else {
            tell(QStringLiteral("device-absent"), {problem.what, problem.remedy});
        }
    });
    connect(&hands, &DeviceManager::troubled, this, &MainWindow::tellDevice);
    connect(&hands, &DeviceManager::lost, this, [this](const QString& name, link::DeviceFault trouble, int vendorCode) {
        deviceTried_ = name;
        notices_->remove(QStringLiteral("device-trouble"));
        const Problem problem = problemOf(trouble, vendorCode);
        tell(QStringLiteral("device-lost"), {problem.what, problem.remedy});
    });
    connect(notices_, &NoticeBar::remedyChosen, this, [this](const QString& id) {
        if (id != QLatin1String("device-lost") && id != QLatin1String("device-absent")) return;
        notices_->remove(id);
        chooseDevice(deviceTried_);
    });
    listDevices();
}

void MainWindow::chooseDevice(const QString& name) {
    DeviceManager& hands = simulator_.hands();
    if (name.isEmpty()) {
        settings_.set(QStringLiteral("work/device"), QStringLiteral("mouse"));
        for (const char* id : {"device-lost", "device-absent", "device-trouble"})
            notices_->remove(QLatin1String(id));
        hands.letGo();
        return;
    }
    if (hands.isOpening() || (hands.current() && hands.wanted() == name)) {
        listDevices();
        return;
    }
    deviceAsked_ = true;
    hands.choose(name);
}

/// Of several equal ones: a device that the list cannot tell, by its name or serial.
void MainWindow::nameDevice() {
    auto* dialog = new QInputDialog(this);
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
        if (const QString name = text.trimmed(); !name.isEmpty()) chooseDevice(name);
    });
    dialog->open();
}

void MainWindow::tellDevice(link::DeviceFault trouble, int vendorCode) {
    notices_->remove(QStringLiteral("device-trouble"));
    if (trouble == link::DeviceFault::none) return;
    const Problem problem = problemOf(trouble, vendorCode);
    tell(QStringLiteral("device-trouble"), {problem.what, problem.remedy});
}

/// Made anew: what is connected changes.
void MainWindow::listDevices() {
    const DeviceManager& hands = simulator_.hands();
    // The actions of the list belong to the group and go with it.
    delete devices_->findChild<QActionGroup*>(QStringLiteral("deviceGroup"));
    devices_->clear();
    auto* group = new QActionGroup(devices_);
    group->setObjectName(QStringLiteral("deviceGroup"));
    const auto add = [this, group](const QString& name, const QString& text, const QString& tip, bool chosen) {
        auto* action = new QAction(text, group);
        action->setObjectName(QStringLiteral("actionDevice_") + (name.isEmpty() ? QStringLiteral("mouse") : name));
        action->setToolTip(tip);
        action->setStatusTip(tip);
        action->setCheckable(true);
        action->setChecked(chosen);
        connect(action, &QAction::triggered, this, [this, name] { chooseDevice(name); });
        devices_->addAction(action);
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
        QAction* looking = devices_->addAction(tr("Looking..."));
        looking->setObjectName(QStringLiteral("actionDevice_looking"));
        looking->setEnabled(false);
    }
    devices_->addSeparator();
    const Actions& a = *actions_;
    devices_->addAction(a["actionDeviceNamed"]);
    devices_->addMenu(pedals_->menu());
    devices_->addSeparator();
    for (const char* name : {"actionDevicePage", "actionDeviceSetUp", "actionDeviceSearch"})
        devices_->addAction(a[name]);
    // What was found since makes it longer: it stands on the status bar.
    if (risesFromStatus_ && devices_->isVisible())
        devices_->move(status_->mapToGlobal(QPoint(0, -devices_->sizeHint().height())));
    a["actionDeviceSearch"]->setEnabled(!hands.isLooking());
    a["actionDeviceSetUp"]->setEnabled(hands.current() != nullptr);
}

bool MainWindow::holdsDevice() const {
    return simulator_.hands().current() && simulator_.usedHand();
}

QString MainWindow::deviceInHand() const {
    const DeviceManager& hands = simulator_.hands();
    return holdsDevice() ? hands.textOf(hands.wanted()) : deviceText(simulator_.capability());
}

void MainWindow::showDevice(StatusFigures& figures) const {
    const DeviceManager& hands = simulator_.hands();
    figures.device = deviceInHand();
    if (hands.isOpening()) figures.deviceFault = tr("being opened");
    if (!holdsDevice()) return;
    figures.servoHz = hands.health().servoHz;
    if (hands.trouble() != link::DeviceFault::none)
        figures.deviceFault = problemOf(hands.trouble(), hands.health().gate.vendorCode).what;
}

}  // namespace handpiece::desktop
