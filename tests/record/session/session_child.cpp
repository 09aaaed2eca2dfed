// SPDX-License-Identifier: Apache-2.0
// session_child FILE steady|fast: records until it is killed and prints how many ticks it has handed over.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>

#include "handpiece/base/core/error.h"
#include "handpiece/record/session/recorder.h"
#include "record/session/made_up_hand.h"

using namespace handpiece;

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    const bool fast = std::strcmp(argv[2], "fast") == 0;
    try {
        session::Recorder recorder(argv[1], {1000, "child", "test", "{}", {}});
        test::MadeUpHand hand;
        const auto start = std::chrono::steady_clock::now();
        for (std::uint64_t tick = 0;; ++tick) {
            const session::Record record = session::recordOf(hand.next());
            if (fast) {
                recorder.pushWaiting(record);
            } else {
                std::this_thread::sleep_until(start + std::chrono::milliseconds(tick));
                recorder.push(record);
            }
            if (tick % 300 == 0) recorder.event(tick, session::EventName::strokeBegin, "child");
            if (tick % 2000 == 0) recorder.keyFrame(tick, std::vector<std::byte>(300000, std::byte{3}));
            if (tick % 10 == 0) {
                std::printf("%llu\n", static_cast<unsigned long long>(tick + 1));
                std::fflush(stdout);
            }
        }
    } catch (const core::Error& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
