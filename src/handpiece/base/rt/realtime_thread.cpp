// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/realtime_thread.h"

#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <future>
#include <string_view>
#include <system_error>

#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/realtime_kit.h"

namespace handpiece::rt {
namespace {

constexpr int kHighest = 85;  // that any thread asks for
constexpr std::chrono::milliseconds kPatience{1000};
constexpr std::array<std::int64_t, 3> kAgainAfterS{1, 30, 330};
constexpr std::size_t kStackBytes = 256 << 10;  // deeper than any tick goes

std::string refusal(int code) {
    if (code != EPERM) return std::strerror(code);
#ifdef RLIMIT_RTPRIO
    rlimit limit{};
    if (getrlimit(RLIMIT_RTPRIO, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        return fmt::format("ulimit -r is {}", limit.rlim_cur);
    }
#endif
    return "no permission";
}

#ifdef __linux__
constexpr rlim_t kMostUs = 100'000;  // that a real-time thread runs without a pause
constexpr rlim_t kLeastUs = 40'000;  // twice what PeriodicClock runs without one

/// SIGXCPU comes before the kernel ends the program, and not before a tick that is only long has rested.
bool limitRuns(rlimit limit) noexcept {
    limit.rlim_cur = std::min(kMostUs, limit.rlim_max / 2);
    return setrlimit(RLIMIT_RTTIME, &limit) == 0;
}

bool isRealTime(int policy) noexcept {
    policy &= ~SCHED_RESET_ON_FORK;
    return policy == SCHED_FIFO || policy == SCHED_RR;
}

/// The normal scheduler for a thread (0: this one), at the nice level that it has, with the shortest slice that Linux
/// knows: from 6.12 on a thread that wakes up goes before those of longer slices; kernels before that do not look at
/// it.
void takeShortSlice(int thread) noexcept {
    struct {  // sched_attr, which glibc does not declare
        std::uint32_t size, policy;
        std::uint64_t flags;
        std::int32_t nice;
        std::uint32_t priority;
        std::uint64_t runtimeNs, deadlineNs, periodNs;
    } attributes{};
    // What RealtimeKit marked stays so: only an administrator may take the mark off.
    const int policy = sched_getscheduler(thread);
    attributes.size = sizeof attributes;
    attributes.flags = policy >= 0 && (policy & SCHED_RESET_ON_FORK) != 0 ? 1 : 0;
    attributes.nice = isRealTime(policy) ? 0 : getpriority(PRIO_PROCESS, static_cast<id_t>(thread));
    attributes.runtimeNs = 100'000;
    (void)syscall(SYS_sched_setattr, thread, &attributes, 0);
}

/// SIGXCPU comes to the thread that ran too long; what RealtimeKit demands would end the program a tenth of a second
/// later. The tick goes on, late; the gates see that, and give no force meanwhile.
void onRunaway(int /*signal*/) {
    const int saved = errno;
    rlimit limit{};
    if (isRealTime(sched_getscheduler(0))) {
        takeShortSlice(0);
        // The kernel has put the limit off by a second: back, for the other threads.
        if (getrlimit(RLIMIT_RTTIME, &limit) == 0) (void)limitRuns(limit);
    } else if (getrlimit(RLIMIT_CPU, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
        (void)signal(SIGXCPU, SIG_DFL);  // the other reason for this signal: its owner wants the program to end
        (void)raise(SIGXCPU);
    }
    errno = saved;
}

/// False when runaway threads are somebody else's affair: then nothing is asked for that needs a limit.
bool watchRunaways() {
    static const bool watched = [] {
        struct sigaction now {};
        if (sigaction(SIGXCPU, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) return false;
        now.sa_handler = onRunaway;
        now.sa_flags = SA_RESTART;
        rlimit limit{};
        if (sigaction(SIGXCPU, &now, nullptr) != 0 || getrlimit(RLIMIT_RTTIME, &limit) != 0) return false;
        return limitRuns(limit);
    }();
    return watched;
}
#endif

/// The kernel's number of it.
int thisThread() noexcept {
#ifdef __linux__
    return static_cast<int>(syscall(SYS_gettid));
#else
    return 0;
#endif
}

/// "fifo", "rtkit", "plain": nothing better than that; else all.
bool mayAsk(Scheduling scheduling) {
    const char* named = std::getenv("HANDPIECE_SCHEDULING");
    const std::string_view limit = named != nullptr ? named : "";
    if (limit == "plain") return false;
    return scheduling == Scheduling::fifo ? limit != "rtkit" : limit != "fifo";
}

/// For a thread of this process: its own number, so that another one may ask for it.
void askForPriority(SchedulingGrant& grant, int thread, int priority) {
    grant.scheduling = Scheduling::normal;
    std::string why = "HANDPIECE_SCHEDULING";
#ifdef __linux__
    const bool watched = watchRunaways();
    rlimit runs{};
    if (getrlimit(RLIMIT_RTTIME, &runs) == 0 && runs.rlim_max < 2 * kLeastUs) {  // real time would be the program's end
        grant.told = config::phrase("scheduling.normal", fmt::format("RLIMIT_RTTIME is {} us", runs.rlim_max));
        takeShortSlice(thread);
        return;
    }
#endif
    if (mayAsk(Scheduling::fifo)) {
        sched_param parameters{};
        parameters.sched_priority = priority;
        if (sched_setscheduler(thread, SCHED_FIFO, &parameters) == 0) {
            grant.scheduling = Scheduling::fifo;
            grant.told = config::phrase("scheduling.fifo", std::to_string(priority));
            return;
        }
        why = refusal(errno);
    }
#ifdef __linux__
    if (watched && mayAsk(Scheduling::realtimeKit)) {
        const KitAnswer kit = askRealtimeKit(thread, kHighest - priority, kPatience);
        if (kit.priority > 0) {
            grant.scheduling = Scheduling::realtimeKit;
            grant.told = config::phrase("scheduling.realtime-kit", std::to_string(kit.priority));
            return;
        }
        why += fmt::format("; RealtimeKit: {}", kit.refusal);
        if (kit.niceLevel < 0) {
            grant.scheduling = Scheduling::highPriority;
            grant.told = config::phrase("scheduling.high-priority", why, std::to_string(kit.niceLevel));
        }
    }
    takeShortSlice(thread);
#endif
    if (grant.scheduling == Scheduling::normal) grant.told = config::phrase("scheduling.normal", why);
}

/// Under a limit only what there is now is locked: locking the future as well would make later allocations fail.
int lockFlags() {
    rlimit limit{};
    const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
    return unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT;
}

/// Where the limit does not let all be locked: the stack that the tick will use is, and the program's code is fetched.
__attribute__((noinline)) void fetchAndLockWhatFits() {
    std::array<volatile unsigned char, kStackBytes> stack;
    for (std::size_t i = 0; i < stack.size(); i += 1024)
        stack[i] = 0;
    (void)mlock(const_cast<const unsigned char*>(stack.data()), stack.size());
#if defined(__linux__) && defined(MADV_POPULATE_READ)
    // Of the program, or of the shared library that this is part of: its own, nobody else's.
    __asm__(".hidden __ehdr_start\n.hidden etext");
    extern char codeBegin[] __asm__("__ehdr_start");
    extern char codeEnd[] __asm__("etext");
    const auto pages = ~static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE) - 1);
    const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(codeBegin) & pages;
    const auto bytes = reinterpret_cast<std::uintptr_t>(codeEnd) - begin;
    // Kernels before 5.14 do not know it.
    (void)madvise(reinterpret_cast<void*>(begin), bytes, MADV_POPULATE_READ);
#endif
}

}  // namespace

const char* nameOf(Scheduling scheduling) noexcept {
    static constexpr std::array<const char*, 5> kNames{"not-asked", "normal", "high-priority", "realtime-kit", "fifo"};
    return kNames[static_cast<std::size_t>(scheduling)];
}

std::string SchedulingGrant::text() const {
    std::string all = config::words()(told);
    if (timesTakenBack > 0) all += "; " + config::words()("scheduling.taken-back", timesTakenBack);
    return all;
}

std::string SchedulingGrant::line() const {
    std::string all = text();
    if (scheduling != Scheduling::notAsked)
        all += "; " + config::words().text(memoryLocked ? "scheduling.memory-locked" : "scheduling.memory-not-locked");
    return all;
}

SchedulingGrant requestRealtime(int priority) {
    SchedulingGrant grant;
    grant.memoryLocked = mlockall(lockFlags()) == 0;
    fetchAndLockWhatFits();
    askForPriority(grant, thisThread(), priority);
#ifdef __linux__
    grant.timerSlack = prctl(PR_SET_TIMERSLACK, 1UL) == 0;
#endif
    return grant;
}

void guardAgainstRunaways() {
#ifdef __linux__
    (void)watchRunaways();
#endif
}

void stepBack() noexcept {
#ifdef __linux__
    (void)setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 5);
#endif
}

RealtimeThread::RealtimeThread(std::function<void()> body, int priority) : priority_(priority) {
    std::promise<SchedulingGrant> granted;
    std::future<SchedulingGrant> grant = granted.get_future();
    try {
        thread_ = std::thread([this, body = std::move(body), priority, granted = std::move(granted)]() mutable {
            SchedulingGrant mine = requestRealtime(priority);
            id_.store(thisThread(), std::memory_order_release);
            granted.set_value(std::move(mine));
            body();
            id_.store(0, std::memory_order_release);
        });
    } catch (const std::system_error& e) {
        throw core::Error(fmt::format("no thread can be started: {}", e.what()), "real-time thread",
                          "close other programs or raise ulimit -u");
    }
    grant_ = grant.get();
}

const SchedulingGrant& RealtimeThread::keepRealTime() {
    if (asking_.valid()) {
        if (asking_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return grant_;
        const SchedulingGrant again = asking_.get();
        grant_.scheduling = again.scheduling;
        grant_.told = again.told;
    }
    const std::int64_t now = monotonicNs();
    if (lostRealTime()) {
        grant_.scheduling = Scheduling::normal;
        grant_.told = config::phrase("scheduling.lost");
        ++grant_.timesTakenBack;
        sinceNs_ = now;
    }
    const int id = id_.load(std::memory_order_acquire);
    if (grant_.timesTakenBack == 0 || grant_.realTime() || id == 0 || askedAgain_ == kAgainAfterS.size() ||
        now - sinceNs_ < kAgainAfterS[askedAgain_] * 1'000'000'000)
        return grant_;
    ++askedAgain_;
    sinceNs_ = now;
    try {
        asking_ = std::async(std::launch::async, [id, priority = priority_, again = grant_]() mutable {
            try {
                askForPriority(again, id, priority);
            } catch (const std::exception& e) {
                again.told = config::phrase("scheduling.normal", e.what());
            }
            return again;
        });
    } catch (const std::system_error&) {
        // No thread for it now: later.
    }
    return grant_;
}

bool RealtimeThread::lostRealTime() const noexcept {
#ifdef __linux__
    const int id = id_.load(std::memory_order_acquire);
    const int policy = id != 0 ? sched_getscheduler(id) : -1;
    return grant_.realTime() && policy >= 0 && !isRealTime(policy);
#else
    return false;
#endif
}

}  // namespace handpiece::rt
