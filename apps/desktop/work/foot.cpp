// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/foot.h"

namespace handpiece::desktop {
namespace {
constexpr int kPollMs = 100;
}

Foot::Foot(PedalDesk desk, QObject* parent) : QObject(parent), desk_(std::move(desk)) {
    timer_.setInterval(kPollMs);
    connect(&timer_, &QTimer::timeout, this, &Foot::poll);
}

Foot::~Foot() {
    looking_.reset();
    opening_.reset();
}

void Foot::look() {
    if (looking_) return;
    const auto names = std::make_shared<QStringList>();
    looking_ = std::make_unique<Job>(QString(), [names, look = desk_.look](const core::Progress&) {
        for (const drivers::PedalFound& one : look())
            *names << QString::fromStdString(one.name);
    });
    connect(looking_.get(), &Job::done, this, [this, names] {
        looking_.release()->deleteLater();
        names->removeDuplicates();
        found_ = *names;
        emit changed();
    });
    // Without SDL there are none; who chooses one is told why.
    connect(looking_.get(), &Job::failed, this, [this] {
        looking_.release()->deleteLater();
        found_.clear();
        emit changed();
    });
    looking_->start();
}

void Foot::choose(const QString& name) {
    wanted_ = name;
    timer_.stop();
    pedal_ = {};  // up, from now on
    there_ = false;
    emit changed();
    if (!name.isEmpty() && !opening_) open(name);
}

void Foot::open(const QString& name) {
    const auto opened = std::make_shared<PedalDesk::Open>();
    opening_ = std::make_unique<Job>(QString(), [opened, name = name.toStdString(), value = value_, open = desk_.open](
                                                    const core::Progress&) { *opened = open(name, value); });
    // Another was chosen meanwhile.
    const auto goOn = [this, name] {
        opening_.release()->deleteLater();
        const bool other = wanted_ != name;
        if (other && !wanted_.isEmpty()) open(QString(wanted_));
        return !other;
    };
    connect(opening_.get(), &Job::done, this, [this, opened, goOn] {
        PedalDesk::Open pedal = std::move(*opened);
        if (!goOn()) return;
        pedal_ = std::move(pedal);
        there_ = true;
        timer_.start();
        emit changed();
    });
    connect(opening_.get(), &Job::failed, this, [this, name, goOn](const Problem& problem) {
        if (!goOn()) return;
        wanted_.clear();
        emit refused(name, problem);
        emit changed();
    });
    opening_->start();
}

void Foot::poll() {
    if (!pedal_.attached) return;
    const bool now = pedal_.attached();
    if (now == there_) return;
    there_ = now;
    if (now)
        emit back(wanted_);
    else
        emit unplugged(wanted_);
}

}  // namespace handpiece::desktop
