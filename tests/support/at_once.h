// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The same work by several threads that begin in one moment.

#include <barrier>
#include <thread>
#include <vector>

namespace handpiece::test {

/// Ends when all have.
template <class Work>
void atOnce(int count, const Work& work) {
    std::barrier start(count);
    std::vector<std::jthread> threads;
    for (int t = 0; t < count; ++t)
        threads.emplace_back([&] {
            start.arrive_and_wait();
            work();
        });
}

}  // namespace handpiece::test
