// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/rt/realtime_thread.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>
#include <future>
#include <system_error>

#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "handpiece/base/core/error.h"

namespace handpiece::rt {
namespace {

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

/// Under a limit only what there is now is locked: locking the future as well would make later allocations fail.
int lockFlags() {
    rlimit limit{};
    const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
    return unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT;
}

}  // namespace

SchedulingGrant requestRealtime(int priority) {
    SchedulingGrant grant;
    sched_param parameters{};
    parameters.sched_priority = priority;
    const int code = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
    grant.realTime = code == 0;
    if (grant.realTime) {
        grant.line = fmt::format("real-time scheduling: SCHED_FIFO priority {}", priority);
    } else {
        grant.line =
            fmt::format("real-time scheduling: not permitted ({}): running under the normal scheduler", refusal(code));
    }
    grant.memoryLocked = mlockall(lockFlags()) == 0;
    grant.line += grant.memoryLocked ? "; memory locked" : "; memory not locked";
#ifdef __linux__
    grant.timerSlack = prctl(PR_SET_TIMERSLACK, 1UL) == 0;
#endif
    return grant;
}

RealtimeThread::RealtimeThread(std::function<void()> body, int priority) {
    std::promise<SchedulingGrant> granted;
    std::future<SchedulingGrant> grant = granted.get_future();
    try {
        thread_ = std::thread([body = std::move(body), priority, granted = std::move(granted)]() mutable {
            granted.set_value(requestRealtime(priority));
            body();
        });
    } catch (const std::system_error& e) {
        throw core::Error(fmt::format("no thread can be started: {}", e.what()), "real-time thread",
                          "close other programs or raise ulimit -u");
    }
    grant_ = grant.get();
}

}  // namespace handpiece::rt
