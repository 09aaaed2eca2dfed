// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/parallel.h"

#include "handpiece/base/core/alone.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <memory>
#include <mutex>
#include <thread>

namespace handpiece::core {
namespace {
std::mutex controlMutex;
std::unique_ptr<tbb::global_control> control;
thread_local bool isAlone = false;
}  // namespace

void parallelFor(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
    if (count == 0) return;
    if (isAlone) return body(0, count);
#if defined(__SANITIZE_THREAD__)
    // TBB itself is not instrumented: each hand-over of its tasks would be told as a race.
    if (count < 2) return body(0, count);
    std::thread other([&] { body(count / 2, count); });
    body(0, count / 2);
    other.join();
#else
    // Isolated: else one that is called within another ends early and without a word when a body of the other throws,
    // and who called it goes on with what is half done.
    tbb::task_group_context own(tbb::task_group_context::isolated);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain == 0 ? 1 : grain),
        [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); }, own);
#endif
}

Alone::Alone() : wasAlone_(isAlone) {
    isAlone = true;
}

Alone::~Alone() {
    isAlone = wasAlone_;
}

std::size_t threadCount() {
    return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
}

void setThreadCount(std::size_t threads) {
    const std::lock_guard lock(controlMutex);
    control.reset();
    if (threads > 0)
        control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, threads);
}

}  // namespace handpiece::core
