// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// RealtimeKit, the desktop's own service that gives real time to programs without an administrator, over the system
/// bus.

#include <chrono>
#include <string>

namespace handpiece::rt {

/// What RealtimeKit answered.
struct KitAnswer {
    int priority = 0;     ///< of SCHED_RR now; 0: not granted
    int niceLevel = 0;    ///< below 0 now; 0: not granted
    std::string refusal;  ///< why there is no real time; one line
};

/// Asks for real time for a thread of this process (the kernel's number), else for a high priority; `below` how far
/// under the highest priority that it gives. Takes `patience` at most, whatever the bus does; after an answer that did
/// not come, later calls do not wait again. Lowers the process's RLIMIT_RTTIME to what RealtimeKit demands.
[[nodiscard]] KitAnswer askRealtimeKit(int thread, int below, std::chrono::milliseconds patience);

}  // namespace handpiece::rt
