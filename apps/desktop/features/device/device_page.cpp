// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/device_page.h"

#include <QDialogButtonBox>
#include <QLabel>
#include <QScrollArea>
#include <QTabWidget>
#include <QVBoxLayout>

#include "desktop/features/device/fidelity_box.h"
#include "desktop/features/device/live_box.h"
#include "desktop/features/device/profile_box.h"
#include "desktop/widgets/parts.h"
#include "handpiece/app/report/fidelity_report.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::desktop {

DevicePage::DevicePage(Simulator& simulator, Settings& settings, AskFile ask, QWidget* parent)
    : QDialog(parent), simulator_(simulator), settings_(settings), ask_(std::move(ask)) {
    setObjectName(QStringLiteral("devicePage"));
    setWindowTitle(tr("Device"));
    auto* column = new QVBoxLayout(this);
    note_ = named(new QLabel(this), "devicePageNote", tr("What holds the handpiece"));
    note_->setWordWrap(true);
    column->addWidget(note_);
    tabs_ = named(new QTabWidget(this), "deviceTabs", tr("Parts of the page"));
    live_ = new LiveBox;
    profile_ = new ProfileBox(ProfileBox::Extent::all);
    fidelity_ = new FidelityBox;
    const auto add = [this](QWidget* part, const QString& name) {
        auto* scroll = new QScrollArea;
        scroll->setWidgetResizable(true);
        scroll->setFrameShape(QFrame::NoFrame);
        scroll->setWidget(part);
        tabs_->addTab(scroll, name);
    };
    add(live_, tr("Now"));
    add(profile_, tr("Settings"));
    tabs_->addTab(fidelity_, tr("Fidelity"));
    column->addWidget(tabs_, 1);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    column->addWidget(buttons);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);

    DeviceManager& hands = simulator_.hands();
    connect(&hands, &DeviceManager::polled, this, &DevicePage::showState);
    connect(&hands, &DeviceManager::changed, this, &DevicePage::showDevice);
    connect(&simulator_, &Simulator::settingsChanged, this, [this] {
        const force::Parameters& p = simulator_.parameters();
        profile_->setEventBasedForce(p.transients.on, p.vibration.on);
    });
    connect(profile_, &ProfileBox::changed, this, &DevicePage::takeProfile);
    connect(profile_, &ProfileBox::crispChanged, this,
            [this] { simulator_.setEventBasedForce(profile_->crispContact(), profile_->cuttingVibration()); });
    connect(profile_, &ProfileBox::placeHereRequested, this, [this, &hands] {
        if (!hands.current()) return;
        const auto& at = hands.health().positionMm;
        try {
            hands.current()->placeHere({at[0], at[1], at[2]});
        } catch (const core::Error& error) {
            emit simulator_.failed(problemOf(error));
        }
    });
    connect(fidelity_, &FidelityBox::startRequested, this, &DevicePage::startCheck);
    connect(fidelity_, &FidelityBox::cancelRequested, this, [this] {
        if (checking_) checking_->cancel();
    });
    connect(fidelity_, &FidelityBox::saveRequested, this, &DevicePage::save);
    resize(820, 640);
    showDevice();
}

DevicePage::~DevicePage() {
    simulator_.hands().disconnect(this);
    simulator_.disconnect(this);
    const bool had = checking_ != nullptr;
    checking_.reset();
    if (had) simulator_.hands().choose(checked_);
}

void DevicePage::showDevice() {
    const DeviceManager& hands = simulator_.hands();
    const std::shared_ptr<Hand>& hand = hands.current();
    fidelity_->setAvailable(hand != nullptr);
    profile_->setEnabled(hand != nullptr);
    if (hand) {
        note_->setText(QString::fromStdString(hand->info().sources));
        live_->setDevice(hand->info());
        profile_->setProfile(hand->profile());
    } else {
        note_->setText(checking_           ? tr("The check has the device; the mouse holds the handpiece meanwhile.")
                       : hands.isOpening() ? tr("The device is being opened...")
                                           : tr("The mouse holds the handpiece: choose a device in the menu Device."));
        live_->clear();
    }
    const force::Parameters& p = simulator_.parameters();
    profile_->setEventBasedForce(p.transients.on, p.vibration.on);
}

void DevicePage::showState() {
    const DeviceManager& hands = simulator_.hands();
    QString trouble;
    if (hands.trouble() != link::DeviceFault::none) {
        const Problem problem = problemOf(hands.trouble(), hands.health().gate.vendorCode);
        trouble = problem.what + QLatin1Char(' ') + problem.remedy;
    }
    live_->setHealth(hands.health(), trouble);
    live_->setTick(simulator_.status());
}

void DevicePage::takeProfile() {
    DeviceManager& hands = simulator_.hands();
    if (!hands.current()) return;
    try {
        if (!hands.current()->setProfile(profile_->profile())) hands.choose(hands.wanted());
    } catch (const core::Error& error) {
        emit simulator_.failed(problemOf(error));
        profile_->setProfile(hands.current()->profile());
    }
}

void DevicePage::startCheck(fidelity::CheckSettings settings) {
    DeviceManager& hands = simulator_.hands();
    if (checking_ || !hands.current()) return;
    checked_ = hands.wanted();
    const auto report = std::make_shared<fidelity::Report>();
    fidelity_->begin();
    settings.announce = [box = fidelity_](const std::string& sentence) {
        QMetaObject::invokeMethod(
            box, [box, text = QString::fromStdString(sentence)] { box->say(text); }, Qt::QueuedConnection);
    };
    checking_ = std::make_unique<Job>(
        tr("Checking the device"),
        [report, settings, check = check, choice = hands.choiceOf(checked_), open = hands.options().desk.driver](
            const core::Progress& progress) { *report = check(open(choice), settings, progress); });
    connect(checking_.get(), &Job::progressed, fidelity_, &FidelityBox::setFraction);
    connect(checking_.get(), &Job::done, this, [this, report] {
        endCheck();
        fidelity_->setReport(*report);
    });
    connect(checking_.get(), &Job::failed, this, [this](const Problem& problem) {
        endCheck();
        fidelity_->end(problem.remedy.isEmpty() ? problem.what : problem.what + QLatin1Char(' ') + problem.remedy);
    });
    connect(checking_.get(), &Job::cancelled, this, [this] {
        endCheck();
        fidelity_->end(tr("The check was cancelled."));
    });
    // It begins when the device is free.
    hands.letGo([this] {
        if (checking_) checking_->start();
    });
    showDevice();
}

void DevicePage::endCheck() {
    checking_.release()->deleteLater();
    simulator_.hands().choose(checked_);
}

void DevicePage::save() {
    if (!fidelity_->report()) return;
    const QString file =
        ask_(tr("Save report"),
             settings_.value(QStringLiteral("files/folder")).toString() + QStringLiteral("/handpiece-fidelity.html"),
             tr("Page to print (*.html);;For machines (*.json)"));
    if (file.isEmpty()) return;
    try {
        core::writeFile(toPath(file), file.endsWith(QLatin1String(".json"), Qt::CaseInsensitive)
                                          ? fidelity::asJson(*fidelity_->report())
                                          : report::fidelityReport(*fidelity_->report()));
        emit simulator_.saved(file);
    } catch (const core::Error& error) {
        emit simulator_.failed(problemOf(error));
    }
}

}  // namespace handpiece::desktop
