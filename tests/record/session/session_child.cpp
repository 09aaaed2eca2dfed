// SPDX-License-Identifier: Apache-2.0
// session_child FILE steady|fast: records until it is killed and prints how many ticks it has handed over, and for how
// many milliseconds the machine has kept threads such as the recorder's waiting.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <stop_token>
#include <thread>
#include <type_traits>

#include "handpiece/base/core/error.h"
#include "handpiece/record/session/recorder.h"
#include "record/session/made_up_hand.h"

using namespace handpiece;

namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;

/// A thread that wants to run as often as the recorder's, and counts by how much it comes too late.
class Witness {
  public:
    [[nodiscard]] long long heldUpMs() const {
        const auto waits = steady_clock::now().time_since_epoch().count() - due_.load();
        return (late_.load() + std::max(steady_clock::rep{0}, waits)) / 1'000'000;
    }

  private:
    void run(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            const auto due = steady_clock::now() + 20ms;
            due_ = due.time_since_epoch().count();
            std::this_thread::sleep_until(due);
            late_ += (steady_clock::now() - due).count();
        }
    }

    static_assert(std::is_same_v<steady_clock::period, std::nano>);
    std::atomic<steady_clock::rep> due_{steady_clock::now().time_since_epoch().count()}, late_{0};
    std::jthread thread_{[this](const std::stop_token& stop) { run(stop); }};
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    const bool fast = std::strcmp(argv[2], "fast") == 0;
    try {
        session::Recorder recorder(argv[1], {1000, "child", "test", "{}", {}});
        test::MadeUpHand hand;
        const Witness witness;
        auto due = steady_clock::now();
        for (std::uint64_t tick = 0;; ++tick) {
            const session::Record record = session::recordOf(hand.next());
            if (fast) {
                recorder.pushWaiting(record);
            } else {
                // What a machine has slept through is not made up for: nobody hands over a second at once.
                due = std::max(due + 1ms, steady_clock::now() - 20ms);
                std::this_thread::sleep_until(due);
                recorder.push(record);
            }
            if (tick % 300 == 0) recorder.event(tick, session::EventName::strokeBegin, "child");
            if (tick % 2000 == 0) recorder.keyFrame(tick, std::vector<std::byte>(300000, std::byte{3}));
            if (tick % 10 == 0) {
                std::printf("%llu %lld\n", static_cast<unsigned long long>(tick + 1), witness.heldUpMs());
                std::fflush(stdout);
            }
        }
    } catch (const core::Error& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
