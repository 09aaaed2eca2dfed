// SPDX-License-Identifier: Apache-2.0
// What a user without privileges is granted, as realtime_kit_test looks at it: gives up root, asks, tells.
#include <grp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>

#include "handpiece/base/rt/realtime_thread.h"

int main() {
    using namespace handpiece;
    constexpr unsigned kNobody = 65534;
    if (geteuid() == 0) {
        rlimit none{};
        if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setgroups(0, nullptr) != 0 || setgid(kNobody) != 0 ||
            setuid(kNobody) != 0)
            return 1;
        // The kernel hides who changed its user from RealtimeKit otherwise; a program of a user's own is not hidden.
        (void)prctl(PR_SET_DUMPABLE, 1);
    }
    for (int i = 0; i < 3; ++i) {
        int policy = 0, nice = 0;
        sched_param parameters{};
        rt::RealtimeThread thread([&] {
            policy = sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
            (void)sched_getparam(0, &parameters);
            nice = getpriority(PRIO_PROCESS, 0);
        });
        thread.join();
        if (i == 0)
            std::printf("%s\npolicy %d priority %d nice %d\n%s\n", rt::nameOf(thread.grant().scheduling), policy,
                        parameters.sched_priority, nice, thread.grant().line().c_str());
    }
}
