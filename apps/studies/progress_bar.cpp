// SPDX-License-Identifier: Apache-2.0
#include "studies/progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <mutex>

namespace handpiece::studies {
namespace {

std::atomic<bool> stopRequested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set from a signal handler");

void onInterrupt(int) {
    // A second press ends the program the hard way.
    if (stopRequested.exchange(true)) std::signal(SIGINT, SIG_DFL);
}

}  // namespace

bool cancelled() noexcept {
    return stopRequested.load(std::memory_order_relaxed);
}

void installCancel() {
    std::signal(SIGINT, onInterrupt);
}

struct ProgressBar::State {
    std::string label;
    bool draws = false;
    std::mutex mutex;
    int shown = -1;
};

ProgressBar::ProgressBar(std::string label) : state_(std::make_shared<State>()) {
    state_->label = std::move(label);
    state_->draws = isatty(STDERR_FILENO) == 1;
}

ProgressBar::~ProgressBar() {
    finish();
}

core::Progress ProgressBar::listener() {
    return [state = state_](double fraction) {
        if (state->draws) {
            const int percent = static_cast<int>(100.0 * fraction);
            const std::lock_guard lock(state->mutex);
            if (percent > state->shown) {
                state->shown = percent;
                constexpr int kWidth = 40;
                const int full = percent * kWidth / 100;
                fmt::print(stderr, "\r{} [{:#<{}}{:<{}}] {:>3} %", state->label, "", full, "", kWidth - full, percent);
                std::fflush(stderr);
            }
        }
        return !cancelled();
    };
}

void ProgressBar::finish() {
    const std::lock_guard lock(state_->mutex);
    if (state_->shown >= 0) fmt::print(stderr, "\r{:{}}\r", "", state_->label.size() + 52);
    state_->shown = -1;
}

}  // namespace handpiece::studies
