// SPDX-License-Identifier: Apache-2.0
#include "shell/hand.h"

#include <algorithm>

#include "handpiece/base/core/error.h"

namespace handpiece::desktop {
namespace {

constexpr int kPollMs = 33;

/// It went away, and will not come back by itself.
bool isGone(link::Trouble trouble) {
    using link::Trouble;
    return trouble == Trouble::unplugged || trouble == Trouble::vendorError || trouble == Trouble::badData ||
           trouble == Trouble::stopped;
}

/// What the window itself causes, between two sittings, is no news.
bool isOurs(link::Trouble trouble) {
    return trouble == link::Trouble::tickStalled || trouble == link::Trouble::starting;
}

}  // namespace

Hand::Hand(std::string name, station::OpenDevice opened, std::filesystem::path profiles)
    : name_(std::move(name)), opened_(std::move(opened)), profiles_(std::move(profiles)), profile_(opened_.profile) {}

bool Hand::wasSetUp() const {
    std::error_code error;
    return std::filesystem::exists(workspace::profileFile(profiles_, opened_.info), error);
}

bool Hand::setProfile(const workspace::Profile& profile) {
    workspace::writeProfile(profiles_, profile);
    const workspace::Profile before = std::exchange(profile_, profile);
    if (before.placing.scale != profile.placing.scale || before.forceShare != profile.forceShare ||
        before.stiffnessShare != profile.stiffnessShare)
        return false;
    opened_.health->shape(profile.shaping);
    opened_.health->place(station::placingFor(profile_, tooth_));
    return true;
}

void Hand::placeFor(const station::ToothPlace& tooth) {
    tooth_ = tooth;
    opened_.health->place(station::placingFor(profile_, tooth_));
}

void Hand::placeHere(const core::Vec3& handMm) {
    profile_.placing.deviceMm = handMm;
    workspace::writeProfile(profiles_, profile_);
    opened_.health->place(station::placingFor(profile_, tooth_));
}

QString problemIdOf(link::Trouble trouble) {
    const std::string_view id = link::idOf(trouble);
    return QStringLiteral("device-") + QString::fromUtf8(id.data(), static_cast<qsizetype>(id.size()));
}

Hands::Hands(Options options, QObject* parent) : QObject(parent), options_(std::move(options)) {
    if (options_.profiles.empty()) options_.profiles = workspace::profileFolder();
    timer_.setInterval(kPollMs);
    connect(&timer_, &QTimer::timeout, this, &Hands::poll);
}

Hands::~Hands() {
    looking_.reset();
    opening_.reset();
    closing_.clear();
}

void Hands::look() {
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
            rows_.push_back(std::move(row));
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

QString Hands::textOf(const QString& name) const {
    if (current_ && QString::fromStdString(current_->name()) == name && !current_->info().model.empty())
        return QString::fromStdString(current_->info().model);
    for (const DeviceRow& row : rows_)
        if (row.name == name) return row.text;
    return name;
}

station::DeviceChoice Hands::choiceOf(const QString& name) const {
    station::DeviceChoice choice;
    choice.name = name.toStdString();
    choice.profileFolder = options_.profiles;
    choice.faults = options_.inject;
    return choice;
}

void Hands::dispose(std::shared_ptr<Hand> hand) {
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

void Hands::letGo() {
    wanted_.clear();
    if (!current_) return;
    timer_.stop();
    trouble_ = link::Trouble::none;
    health_ = {};
    std::shared_ptr<Hand> old = std::move(current_);
    current_.reset();
    emit changed();
    dispose(std::move(old));
}

void Hands::choose(const QString& name) {
    if (opening_) return;
    letGo();
    if (name.isEmpty()) return;
    wanted_ = name;
    const auto hand = std::make_shared<std::shared_ptr<Hand>>();
    // The one before is closed first: it may be the same.
    std::vector<std::shared_ptr<Job>> before;
    for (auto& job : closing_) {
        Job* raw = job.release();
        raw->disconnect(this);
        before.emplace_back(raw, [](Job* j) { j->deleteLater(); });
    }
    closing_.clear();
    opening_ = std::make_unique<Job>(tr("Opening the device"), [hand, before, choice = choiceOf(name),
                                                                open = options_.desk.open](const core::Progress&) {
        for (const auto& job : before)
            job->wait();
        *hand = std::make_shared<Hand>(choice.name, open(choice), choice.profileFolder);
    });
    const auto end = [this] { opening_.release()->deleteLater(); };
    connect(opening_.get(), &Job::done, this, [this, hand, end] {
        end();
        current_ = std::move(*hand);
        trouble_ = link::Trouble::none;
        since_ = std::chrono::steady_clock::now();
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
    emit changed();
    opening_->start();
}

void Hands::poll() {
    if (!current_) return;
    health_ = current_->health().read();
    const link::Trouble now = isOurs(health_.gate.trouble) ? link::Trouble::none : health_.gate.trouble;
    if (now != trouble_) {
        trouble_ = now;
        since_ = std::chrono::steady_clock::now();
        emit troubled(now, health_.gate.vendorCode);
    }
    if (isGone(trouble_) && std::chrono::steady_clock::now() - since_ >= options_.patience) {
        const QString name = wanted_;
        const link::Trouble why = trouble_;
        letGo();
        emit lost(name, why);
        return;
    }
    emit polled();
}

}  // namespace handpiece::desktop
