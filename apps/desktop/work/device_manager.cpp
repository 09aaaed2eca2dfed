// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/device_manager.h"

#include <algorithm>

#include "handpiece/base/core/error.h"

namespace handpiece::desktop {
namespace {

constexpr int kPollMs = 33;
constexpr double kOverMm = 5.0;

/// It went away, and will not come back by itself.
bool isGone(link::DeviceFault trouble) {
    using link::DeviceFault;
    return trouble == DeviceFault::unplugged || trouble == DeviceFault::vendorError ||
           trouble == DeviceFault::badData || trouble == DeviceFault::stopped;
}

/// What the window itself causes, between two sittings, is no news.
bool isOurs(link::DeviceFault trouble) {
    return trouble == link::DeviceFault::tickStalled || trouble == link::DeviceFault::starting;
}

}  // namespace

Hand::Hand(std::string name, input::OpenDevice opened, std::filesystem::path profiles)
    : name_(std::move(name)), opened_(std::move(opened)), profiles_(std::move(profiles)), profile_(opened_.profile) {}

bool Hand::wasSetUp() const {
    std::error_code error;
    return std::filesystem::exists(workspace::profileFile(profiles_, opened_.info), error);
}

void Hand::suit(std::optional<bool> leftHanded, std::optional<double> scale) {
    if (wasSetUp() || (!leftHanded && !scale)) return;
    profile_.placing.leftHanded = leftHanded.value_or(profile_.placing.leftHanded);
    // A larger scale is within the limits that it was opened with.
    profile_.placing.scale = std::max(profile_.placing.scale, scale.value_or(1.0));
    opened_.health->place(placing());
}

bool Hand::setProfile(const workspace::Profile& profile) {
    workspace::writeProfile(profiles_, profile);
    const workspace::Profile before = std::exchange(profile_, profile);
    if (before.placing.scale != profile.placing.scale || before.forceShare != profile.forceShare ||
        before.stiffnessShare != profile.stiffnessShare || before.clutchButton != profile.clutchButton)
        return false;
    opened_.health->shape(profile.shaping);
    opened_.health->place(placing());
    return true;
}

workspace::WorkspaceMapping Hand::placing() const {
    if (opened_.info.driver != "simulated") return input::placingFor(profile_, tooth_);
    // The simulated arm moves in the tooth's own axes, above its top.
    workspace::WorkspaceMapping placing = profile_.placing;
    if (!tooth_.box.isEmpty()) placing.toothMm = {tooth_.box.centre().x(), tooth_.box.centre().y(), tooth_.box.max.z()};
    return placing;
}

void Hand::placeFor(const input::ToothPlace& tooth) {
    tooth_ = tooth;
    opened_.health->place(placing());
}

void Hand::placeHere(const core::Vec3& handMm) {
    const workspace::WorkspaceMapping now = placing();
    profile_.placing.deviceMm = handMm - now.scale * (now.toothInDevice * core::Vec3(0.0, 0.0, kOverMm));
    workspace::writeProfile(profiles_, profile_);
    opened_.health->place(placing());
}

QString problemIdOf(link::DeviceFault trouble) {
    const std::string_view id = link::idOf(trouble);
    return QStringLiteral("device-") + QString::fromUtf8(id.data(), static_cast<qsizetype>(id.size()));
}

Problem problemOf(link::DeviceFault trouble, std::int32_t vendorCode) {
    return problemById(problemIdOf(trouble), {QStringLiteral("0x%1").arg(vendorCode, 4, 16, QLatin1Char('0'))});
}

DeviceManager::DeviceManager(Options options, QObject* parent) : QObject(parent), options_(std::move(options)) {
    if (options_.profiles.empty()) options_.profiles = workspace::profileFolder();
    timer_.setInterval(kPollMs);
    connect(&timer_, &QTimer::timeout, this, &DeviceManager::poll);
    closeTimer_.setInterval(kPollMs);
    closeTimer_.setSingleShot(true);
    connect(&closeTimer_, &QTimer::timeout, this, &DeviceManager::goOnWhenClosed);
}

DeviceManager::~DeviceManager() {
    looking_.reset();
    opening_.reset();
    closing_.clear();
}

void DeviceManager::look() {
    if (looking_) return;
    const auto found = std::make_shared<std::vector<drivers::Found>>();
    looking_ = std::make_unique<Job>(tr("Looking for devices"),
                                     [found, look = options_.desk.look](const core::Progress&) { *found = look(); });
    const auto end = [this] { looking_.release()->deleteLater(); };
    connect(looking_.get(), &Job::done, this, [this, found, end] {
        end();
        rows_.clear();
        for (const drivers::Found& f : *found) {
            DeviceRow row{QString::fromStdString(f.driver), QString::fromStdString(f.makes), f.available, f.pushes,
                          QString::fromStdString(f.why),    QString::fromStdString(f.remedy)};
            QStringList models;
            for (const std::string& model : f.models)
                models << QString::fromStdString(model);
            if (!models.isEmpty()) row.text = models.join(QStringLiteral(", "));
            if (f.units.size() < 2) {
                rows_.push_back(std::move(row));
                continue;
            }
            for (const drivers::Found::Unit& unit : f.units) {
                DeviceRow one = row;
                one.name += QLatin1Char(':') + QString::fromStdString(unit.which);
                one.text = QString::fromStdString(unit.label);
                rows_.push_back(std::move(one));
            }
        }
        emit foundChanged();
    });
    connect(looking_.get(), &Job::failed, this, [this, end](const Problem& problem) {
        end();
        emit refused({}, problem);
        emit foundChanged();
    });
    emit foundChanged();
    looking_->start();
}

QString DeviceManager::textOf(const QString& name) const {
    const bool oneOfSeveral = name.contains(QLatin1Char(':'));
    if (current_ && !oneOfSeveral && QString::fromStdString(current_->name()) == name &&
        !current_->info().model.empty())
        return QString::fromStdString(current_->info().model);
    for (const DeviceRow& row : rows_)
        if (row.name == name) return row.text;
    return name;
}

input::DeviceChoice DeviceManager::choiceOf(const QString& name) const {
    input::DeviceChoice choice;
    choice.name = name.section(QLatin1Char(':'), 0, 0).toStdString();
    choice.which = name.section(QLatin1Char(':'), 1).toStdString();
    choice.foot = options_.foot;
    choice.profileFolder = options_.profiles;
    choice.faults = options_.inject;
    return choice;
}

void DeviceManager::dispose(std::shared_ptr<Hand> hand) {
    if (!hand) return;
    // A device that has gone may take a second to close. Whoever holds it yet, a sitting, lets go of it by itself.
    const auto held = std::make_shared<std::shared_ptr<Hand>>(std::move(hand));
    auto job = std::make_unique<Job>(QString(), [held](const core::Progress&) { held->reset(); });
    Job* raw = job.get();
    closing_.push_back(std::move(job));
    connect(raw, &Job::done, this, [this, raw] {
        const auto at = std::find_if(closing_.begin(), closing_.end(), [raw](const auto& j) { return j.get() == raw; });
        if (at == closing_.end()) return;
        at->release()->deleteLater();
        closing_.erase(at);
    });
    raw->start();
}

void DeviceManager::letGo(std::function<void()> then) {
    wanted_.clear();
    isOpening_ = false;
    whenClosed_ = std::move(then);
    if (current_) {
        timer_.stop();
        trouble_ = link::DeviceFault::none;
        health_ = {};
        std::shared_ptr<Hand> old = std::move(current_);
        current_.reset();
        before_ = old;
        emit changed();
        dispose(std::move(old));
    }
    goOnWhenClosed();
}

/// A sitting that is busy with something else gives the device back when that has ended.
void DeviceManager::goOnWhenClosed() {
    if (!whenClosed_) return;
    if (!closing_.empty() || !before_.expired()) {
        closeTimer_.start();
        return;
    }
    const std::function<void()> then = std::move(whenClosed_);
    whenClosed_ = {};
    then();
}

void DeviceManager::choose(QString name) {
    if (opening_) return;
    if (name.isEmpty()) {
        letGo();
        return;
    }
    // The one before is closed first: it may be the same.
    letGo([this, name] { open(name); });
    if (!opening_) wanted_ = name;
    isOpening_ = true;
    emit changed();
}

void DeviceManager::open(const QString& name) {
    wanted_ = name;
    isOpening_ = true;
    const auto hand = std::make_shared<std::shared_ptr<Hand>>();
    opening_ = std::make_unique<Job>(tr("Opening the device"), [hand, key = name.toStdString(), choice = choiceOf(name),
                                                                open = options_.desk.open](const core::Progress&) {
        *hand = std::make_shared<Hand>(key, open(choice), choice.profileFolder);
    });
    const auto end = [this] {
        opening_.release()->deleteLater();
        isOpening_ = false;
    };
    connect(opening_.get(), &Job::done, this, [this, name, hand, end] {
        end();
        // Somebody chose the mouse meanwhile.
        if (wanted_ != name) {
            dispose(std::move(*hand));
            return;
        }
        current_ = std::move(*hand);
        current_->suit(options_.leftHanded, options_.scale);
        trouble_ = link::DeviceFault::none;
        openedAt_ = since_ = std::chrono::steady_clock::now();
        timer_.start();
        emit opened();
        emit changed();
    });
    connect(opening_.get(), &Job::failed, this, [this, name, end](const Problem& problem) {
        end();
        wanted_.clear();
        emit refused(name, problem);
        emit changed();
    });
    opening_->start();
}

void DeviceManager::poll() {
    if (!current_) return;
    health_ = current_->health().read();
    const auto time = std::chrono::steady_clock::now();
    // One that never tells where it is waits for something: power, or to be homed.
    const bool isSilent = health_.frames == 0 && time - openedAt_ >= 2 * options_.patience;
    const link::DeviceFault now =
        isOurs(health_.gate.trouble) && !isSilent ? link::DeviceFault::none : health_.gate.trouble;
    if (now != trouble_) {
        trouble_ = now;
        since_ = time;
        emit troubled(now, health_.gate.vendorCode);
    }
    if (isGone(trouble_) && time - since_ >= options_.patience) {
        const QString name = wanted_;
        const link::DeviceFault why = trouble_;
        const int code = health_.gate.vendorCode;
        letGo();
        emit lost(name, why, code);
        return;
    }
    emit polled();
}

}  // namespace handpiece::desktop
