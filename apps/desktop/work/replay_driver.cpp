// SPDX-License-Identifier: Apache-2.0
#include "desktop/work/replay_driver.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "handpiece/base/core/any_error.h"

namespace handpiece::desktop {

ReplayDriver::ReplayDriver(std::unique_ptr<simulation::SessionPlayer> player, Heard heard)
    : player_(std::move(player)),
      heard_(std::move(heard)),
      durationS_(player_->durationS()),
      rateHz_(player_->reader().info().rateHz),
      engineRevision_(player_->reader().info().engineRevision),
      tooth_(player_->tooth()),
      toothCase_(player_->toothCase()),
      events_(player_->events()),
      plot_(player_->plot()),
      settings_(player_->station().settings) {
    publish();
    thread_ = std::thread([this] { run(); });
}

ReplayDriver::~ReplayDriver() {
    {
        const std::lock_guard lock(mutex_);
        end_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

void ReplayDriver::play(bool playing) {
    {
        const std::lock_guard lock(mutex_);
        // Play at the end begins anew.
        if (playing && now_.timeS >= durationS_ - 1e-6 && !seek_) seek_ = 0.0;
        now_.playing = playing;
    }
    wake_.notify_all();
}

void ReplayDriver::setSpeed(double speed) {
    const std::lock_guard lock(mutex_);
    speed_ = std::clamp(speed, 0.05, 64.0);
}

void ReplayDriver::seek(double timeS) {
    {
        const std::lock_guard lock(mutex_);
        seek_ = std::clamp(timeS, 0.0, durationS_);
    }
    wake_.notify_all();
}

ReplayNow ReplayDriver::now() const {
    const std::lock_guard lock(mutex_);
    return now_;
}

std::optional<Problem> ReplayDriver::takeProblem() {
    const std::lock_guard lock(mutex_);
    return std::exchange(problem_, std::nullopt);
}

void ReplayDriver::publish() {
    const std::lock_guard lock(mutex_);
    now_.timeS = player_->timeS();
    now_.sample = player_->sample();
    now_.settings = player_->station().settings;
    now_.seeking = seek_.has_value();
    if (now_.timeS >= durationS_ - 1e-6 && !seek_) now_.playing = false;
}

void ReplayDriver::run() {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds kStep{10};
    // A leap shorter than this is played: jumping costs a run-up from a key frame.
    constexpr double kLongStepS = 0.25;
    const core::Progress untilEnd = [this](double) {
        const std::lock_guard lock(mutex_);
        return !end_ && !seek_;
    };
    auto last = Clock::now();
    // Time goes on where no tick was recorded, too: a machine that was busy left periods out, maybe half a second.
    double atS = player_->timeS();
    for (;;) {
        std::optional<double> target;
        double speed = 1.0;
        {
            std::unique_lock lock(mutex_);
            if (!now_.playing && !seek_) {
                wake_.wait(lock, [this] { return end_ || seek_ || now_.playing; });
                last = Clock::now();
                atS = player_->timeS();
            } else if (!seek_) {
                wake_.wait_for(lock, kStep, [this] { return end_ || seek_; });
            }
            if (end_) return;
            target = std::exchange(seek_, std::nullopt);
            now_.seeking = target.has_value();
            speed = speed_;
        }
        try {
            if (target) {
                player_->seek(*target, untilEnd);
                atS = player_->timeS();
                last = Clock::now();
            } else {
                const auto time = Clock::now();
                const double stepS = std::min(kLongStepS, std::chrono::duration<double>(time - last).count() * speed);
                last = time;
                atS = std::min(durationS_, atS + stepS);
                player_->advance(atS, untilEnd);
                if (heard_) heard_(player_->sample(), stepS, player_->station());
            }
            publish();
        } catch (const std::exception& error) {
            const std::lock_guard lock(mutex_);
            if (end_) return;
            if (seek_) continue;  // a newer wish came in between
            now_.playing = now_.seeking = false;
            problem_ = problemOf(core::asError(error));
        }
    }
}

}  // namespace handpiece::desktop
