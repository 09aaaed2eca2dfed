// SPDX-License-Identifier: Apache-2.0
// To be loaded before a program (LD_PRELOAD): its clock of the day is HANDPIECE_CLOCK_AHEAD_S ahead. Clocks that only
// measure how long something takes stay as they are.
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>

namespace {
time_t aheadS() {
    const char* const text = std::getenv("HANDPIECE_CLOCK_AHEAD_S");
    return text ? std::atoll(text) : 0;
}
}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* at) noexcept {
    const int result = static_cast<int>(syscall(SYS_clock_gettime, clock, at));
    if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) at->tv_sec += aheadS();
    return result;
}

int gettimeofday(timeval* at, void*) noexcept {
    timespec now{};
    const int result = clock_gettime(CLOCK_REALTIME, &now);
    *at = {now.tv_sec, now.tv_nsec / 1000};
    return result;
}

time_t time(time_t* into) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    if (into != nullptr) *into = now.tv_sec;
    return now.tv_sec;
}
}
