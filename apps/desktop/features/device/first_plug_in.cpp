// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/device/first_plug_in.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QStackedWidget>
#include <QVBoxLayout>
#include <cmath>

#include "desktop/features/device/block_view.h"
#include "desktop/features/device/live_box.h"
#include "desktop/features/device/profile_box.h"
#include "desktop/widgets/force_gauge.h"
#include "desktop/widgets/parts.h"
#include "desktop/widgets/scrolled.h"
#include "desktop/widgets/theme.h"
#include "handpiece/base/core/error.h"

namespace handpiece::desktop {
namespace {

QLabel* text(const char* name, const QString& accessible, QWidget* parent) {
    auto* label = named(new QLabel(parent), name, accessible);
    label->setWordWrap(true);
    return label;
}

QString words(const safety::Health& health) {
    const link::DeviceFault trouble = health.gate.trouble;
    // Before the first step that pushes there is no tick, and so nothing that it could be late with.
    if (trouble == link::DeviceFault::none || trouble == link::DeviceFault::tickStalled ||
        trouble == link::DeviceFault::starting)
        return {};
    return problemOf(trouble, health.gate.vendorCode).what;
}

}  // namespace

FirstPlugIn::FirstPlugIn(Simulator& simulator, bool realTime, QWidget* parent)
    : QDialog(parent), simulator_(simulator), block_(realTime) {
    setObjectName(QStringLiteral("firstPlugIn"));
    setWindowTitle(tr("Set up the device"));
    auto* column = new QVBoxLayout(this);
    heading_ = named(new QLabel(this), "firstHeading", tr("Step"));
    heading_->setFont(scaledFont(font(), 1.25, true));
    column->addWidget(heading_);
    pages_ = new QStackedWidget(this);
    pages_->setObjectName(QStringLiteral("firstPages"));
    pages_->addWidget(connectPage());
    pages_->addWidget(calibratePage());
    pages_->addWidget(feelPage());
    auto* inPages = new QVBoxLayout;
    inPages->addWidget(pages_);
    column->addWidget(new Scrolled(inPages, this), 1);
    auto* row = new QHBoxLayout;
    later_ = named(new QPushButton(tr("Later"), this), "firstLater", tr("Later"),
                   tr("Work with what fits the model; Device, Set up... comes back here"));
    row->addWidget(later_);
    row->addStretch(1);
    back_ = named(new QPushButton(tr("Back"), this), "firstBack", tr("Back"), tr("To the step before"));
    next_ = named(new QPushButton(tr("Next"), this), "firstNext", tr("Next"));
    for (QPushButton* other : {later_, back_})
        other->setAutoDefault(false);
    next_->setDefault(true);
    next_->setFocus();
    row->addWidget(back_);
    row->addWidget(next_);
    column->addLayout(row);
    connect(later_, &QPushButton::clicked, this, &QDialog::reject);
    connect(back_, &QPushButton::clicked, this, [this] { go(step_ == Step::feel ? Step::calibrate : Step::connect); });
    connect(next_, &QPushButton::clicked, this, [this] {
        if (step_ == Step::feel) {
            accept();
        } else {
            go(step_ == Step::connect ? Step::calibrate : Step::feel);
        }
    });

    DeviceManager& hands = simulator_.hands();
    if (hands.current()) profile_ = hands.current()->profile();
    choices_->setProfile(profile_);
    simulator_.lendHand(true);
    connect(&hands, &DeviceManager::polled, this, &FirstPlugIn::showState);
    connect(&hands, &DeviceManager::changed, this, [this, &hands] {
        if (hands.current() && reopening_) {
            reopening_ = false;
            if (step_ == Step::feel) startBlock();
        }
        if (!hands.current()) block_.stop();
        showState();
    });
    connect(&block_, &FeelBlock::ticked, this, [this] {
        const messages::HapticSample& sample = block_.sample();
        picture_->setSample(sample);
        gauge_->setForce(std::hypot(sample.forceN[0], sample.forceN[1], sample.forceN[2]), sample.timeS,
                         (sample.flags & messages::kForceLimited) != 0);
        live_->setTick(block_.status());
    });
    connect(&block_, &FeelBlock::failed, this, [this](const Problem& problem) { feelText_->setText(problem.what); });
    go(Step::connect);
}

FirstPlugIn::~FirstPlugIn() {
    calibrating_.reset();
    block_.stop();
    simulator_.hands().disconnect(this);
    simulator_.lendHand(false);
}

QWidget* FirstPlugIn::connectPage() {
    auto* page = new QWidget(this);
    auto* column = new QVBoxLayout(page);
    connected_ = text("firstConnected", tr("Connection"), page);
    column->addWidget(connected_);
    column->addWidget(live_ = new LiveBox(page), 1);
    return page;
}

QWidget* FirstPlugIn::calibratePage() {
    auto* page = new QWidget(this);
    auto* column = new QVBoxLayout(page);
    calibrationText_ = text("firstCalibrationText", tr("What to do"), page);
    calibrationText_->setFont(scaledFont(font(), 1.1));
    column->addWidget(calibrationText_);
    calibrationState_ = text("firstCalibrationState", tr("Calibration"), page);
    column->addWidget(calibrationState_);
    auto* row = new QHBoxLayout;
    calibrate_ = named(new QPushButton(tr("Calibrate"), page), "firstCalibrate", tr("Calibrate"),
                       tr("Asks the device to take its place anew"));
    row->addWidget(calibrate_);
    row->addStretch(1);
    column->addLayout(row);
    auto* reach = new ReachPicture(page);
    reach->setObjectName(QStringLiteral("firstReach"));
    column->addWidget(reach, 1);
    connect(&simulator_.hands(), &DeviceManager::polled, reach, [this, reach] {
        const safety::Health& health = simulator_.hands().health();
        reach->setStylus(health.positionMm, health.orientation);
        if (simulator_.hands().current()) reach->setReach(simulator_.hands().current()->info().capability.workspaceMm);
    });
    connect(calibrate_, &QPushButton::clicked, this, &FirstPlugIn::tryCalibration);
    return page;
}

QWidget* FirstPlugIn::feelPage() {
    auto* page = new QWidget(this);
    auto* column = new QVBoxLayout(page);
    feelText_ = text("firstFeelText", tr("What to do"), page);
    column->addWidget(feelText_);
    auto* row = new QHBoxLayout;
    row->addWidget(picture_ = new BlockView(FeelBlock::kHalfMm, FeelBlock::kDepthMm, page), 3);
    choices_ = new ProfileBox(ProfileBox::Extent::brief, page);
    row->addWidget(choices_, 2);
    column->addLayout(row, 1);
    gauge_ = new ForceGauge(page);
    gauge_->setObjectName(QStringLiteral("feelForce"));
    gauge_->setDetail(Detail::laboratory);
    column->addWidget(gauge_);
    connect(choices_, &ProfileBox::changed, this, &FirstPlugIn::takeProfile);
    return page;
}

void FirstPlugIn::go(Step step) {
    step_ = step;
    pages_->setCurrentIndex(static_cast<int>(step));
    const QString names[] = {tr("1 of 3: Connect"), tr("2 of 3: Calibrate"), tr("3 of 3: Feel a block")};
    heading_->setText(names[static_cast<int>(step)]);
    setAccessibleDescription(heading_->text());
    back_->setEnabled(step != Step::connect);
    next_->setText(step == Step::feel ? tr("Finish") : tr("Next"));
    next_->setToolTip(step == Step::feel ? tr("Keeps this for the device and takes it to the tooth")
                                         : tr("To the next step"));
    if (step == Step::feel) {
        startBlock();
    } else {
        block_.stop();
    }
    showState();
}

void FirstPlugIn::startBlock() {
    const std::shared_ptr<Hand>& hand = simulator_.hands().current();
    if (!hand) return;
    // A tooth that is just being opened gives the device back when it has ended.
    if (simulator_.usedHand()) {
        QTimer::singleShot(100, this, [this] {
            if (step_ == Step::feel && !block_.isRunning()) startBlock();
        });
        return;
    }
    gauge_->setLimit(hand->device().capability().maxForceN);
    feelText_->setText(
        tr("Lower the stylus onto the block: it should feel hard, and the line shows how it pushes back. Choose what "
           "suits your hand."));
    block_.start(hand);
}

void FirstPlugIn::showState() {
    const DeviceManager& hands = simulator_.hands();
    if (!hands.current()) {
        connected_->setText(hands.isOpening() ? tr("The device is being opened...")
                                              : tr("The device is not there. Connect it and choose it again in the "
                                                   "menu Device. The mouse works meanwhile."));
        live_->clear();
        calibrate_->setEnabled(false);
        return;
    }
    const Hand& hand = *hands.current();
    const safety::Health& health = hands.health();
    const QString trouble = words(health);
    const bool streams = health.frames > 0;
    connected_->setText(!streams            ? tr("Waiting for the device's first answer...")
                        : trouble.isEmpty() ? tr("The device answers. Move the stylus: the picture follows.")
                                            : trouble);
    live_->setDevice(hand.info());
    live_->setHealth(health, trouble);
    if (step_ != Step::calibrate || calibrating_) return;
    QString step = tr("This device calibrates by itself.");
    QString state = tr("Calibrated.");
    const link::CalibrationState now =
        hand.calibration().state ? hand.calibration().state() : link::CalibrationState::notNeeded;
    if (now == link::CalibrationState::wanted || now == link::CalibrationState::wantedByHand) {
        state = tr("Not calibrated yet.");
        // The maker's own words.
        step = QString::fromStdString(hand.calibration().step());
        if (step.isEmpty()) step = tr("Press Calibrate.");
    } else if (now == link::CalibrationState::good) {
        step = tr("Nothing is to be done. You may calibrate again.");
    }
    calibrationText_->setText(step);
    calibrationState_->setText(state);
    calibrate_->setEnabled(now != link::CalibrationState::notNeeded);
}

void FirstPlugIn::tryCalibration() {
    const std::shared_ptr<Hand> hand = simulator_.hands().current();
    if (!hand || calibrating_) return;
    calibrate_->setEnabled(false);
    calibrationState_->setText(tr("Calibrating..."));
    const auto good = std::make_shared<bool>(false);
    calibrating_ = std::make_unique<Job>(
        QString(), [hand, good](const core::Progress&) { *good = hand->calibration().tryOnce(); });
    connect(calibrating_.get(), &Job::done, this, [this, good] {
        calibrating_.release()->deleteLater();
        showState();
        if (!*good) calibrationState_->setText(tr("Not calibrated yet. Do as it says above, then try again."));
    });
    connect(calibrating_.get(), &Job::failed, this, [this](const Problem& problem) {
        calibrating_.release()->deleteLater();
        showState();
        calibrationState_->setText(problem.remedy.isEmpty() ? problem.what
                                                            : problem.what + QLatin1Char(' ') + problem.remedy);
    });
    calibrating_->start();
}

void FirstPlugIn::takeProfile() {
    profile_ = choices_->profile();
    DeviceManager& hands = simulator_.hands();
    if (!hands.current()) return;
    try {
        if (hands.current()->setProfile(profile_)) return;
    } catch (const core::Error& error) {
        feelText_->setText(problemOf(error).what);
        return;
    }
    // Another scale is another limit of stiffness: the device is opened with it.
    block_.stop();
    reopening_ = true;
    feelText_->setText(tr("The device is being opened..."));
    hands.choose(hands.wanted());
}

void FirstPlugIn::done(int result) {
    block_.stop();
    if (result == Accepted && simulator_.hands().current()) {
        try {
            simulator_.hands().current()->setProfile(profile_);
        } catch (const core::Error& error) {
            emit simulator_.failed(problemOf(error));
        }
    }
    simulator_.lendHand(false);
    QDialog::done(result);
}

}  // namespace handpiece::desktop
