// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Catches what the tick must not do: while a trap is armed on this thread, every allocation, lock, wait and file
/// access of the thread is counted and the first one is printed with its stack.
///
/// Link handpiece_realtime_trap into the test. Under the sanitizers, which own malloc, the trap counts nothing:
/// ask isActive() and skip with a plain line.

#include <cstdint>

namespace handpiece::test {

class RealtimeTrap {
  public:
    RealtimeTrap();  ///< arms it on this thread; nests
    ~RealtimeTrap();
    RealtimeTrap(const RealtimeTrap&) = delete;
    RealtimeTrap& operator=(const RealtimeTrap&) = delete;

    /// Calls caught on this thread since the trap was armed.
    [[nodiscard]] std::uint64_t allocations() const;
    [[nodiscard]] std::uint64_t locks() const;          ///< mutexes, condition variables, semaphores
    [[nodiscard]] std::uint64_t waitsAndFiles() const;  ///< sleeps, open, read, write
    [[nodiscard]] std::uint64_t total() const { return allocations() + locks() + waitsAndFiles(); }
    /// False under sanitizers.
    [[nodiscard]] static bool isActive();

  private:
    std::uint64_t startAllocations_, startLocks_, startWaits_;
};

}  // namespace handpiece::test
