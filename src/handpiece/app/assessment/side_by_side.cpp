// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/assessment/side_by_side.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::assessment {

void eachSideBySide(std::size_t count, std::size_t most, const core::Progress& progress,
                    const std::function<void(std::size_t, const core::Progress&)>& one) {
    std::vector<double> shares(count, 0.0);  // never back
    std::mutex mutex;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> isCancelled{false};
    std::exception_ptr failure;
    const auto tell = [&](std::size_t i, double share) {
        const std::lock_guard lock(mutex);
        shares[i] = std::max(shares[i], share);
        const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
        if (!isCancelled && progress && !progress(sum / static_cast<double>(count))) isCancelled = true;
        return !isCancelled.load();
    };
    const auto workOn = [&] {
        for (std::size_t i = next++; i < count && !isCancelled; i = next++) {
            try {
                if (!tell(i, 0.0)) return;
                one(i, [&tell, i](double share) { return tell(i, share); });
                tell(i, 1.0);
            } catch (...) {
                const std::lock_guard lock(mutex);
                isCancelled = true;
                if (!failure) failure = std::current_exception();
            }
        }
    };
    {
        const std::size_t side = session::readSideBySide() ? std::min({core::threadCount(), count, most}) : 1;
        std::vector<std::jthread> others;
        for (std::size_t i = 1; i < side; ++i)
            others.emplace_back(workOn);
        workOn();
    }
    if (failure) std::rethrow_exception(failure);
    if (isCancelled) throw core::Error("cancelled");
}

}  // namespace handpiece::assessment
