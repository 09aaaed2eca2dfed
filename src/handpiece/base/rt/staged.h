// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A command in three stages: prepared by one thread, swapped in by the tick, disposed of by the thread that prepared
/// it.

#include <atomic>
#include <memory>
#include <utility>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/rt/spsc_queue.h"

namespace handpiece::rt {

/// Owns what the tick works with (a tooth, a bur, parameters) and lets another thread replace it.
///
/// One owner thread calls stage() and collect(); one tick thread calls swap() and current(). The tick never allocates
/// or frees. Destroy it when the tick no longer runs.
template <class T>
class Staged {
  public:
    explicit Staged(std::unique_ptr<T> initial) { current_ = initial.release(); }
    ~Staged() {
        collect();
        delete pending_.load(std::memory_order_acquire);
        delete unretired_;
        delete current_;
    }
    Staged(const Staged&) = delete;
    Staged& operator=(const Staged&) = delete;

    /// Hands over the next value; one staged before and not yet taken is dropped. Owner's thread.
    void stage(std::unique_ptr<T> next) {
        collect();
        delete pending_.exchange(next.release(), std::memory_order_acq_rel);
    }

    /// Frees what the tick has put aside. Owner's thread; call now and then.
    void collect() {
        T* old = nullptr;
        while (retired_.tryPop(old))
            delete old;
    }

    /// Takes a staged value if there is one; true when current() changed. Tick's thread.
    /// With no room to put the old one aside it waits for a later tick.
    bool swap() noexcept HANDPIECE_REALTIME {
        if (unretired_ && retired_.tryPush(unretired_)) unretired_ = nullptr;
        if (unretired_ || pending_.load(std::memory_order_relaxed) == nullptr) return false;
        T* next = pending_.exchange(nullptr, std::memory_order_acq_rel);
        if (next == nullptr) return false;
        unretired_ = std::exchange(current_, next);
        if (unretired_ && retired_.tryPush(unretired_)) unretired_ = nullptr;
        return true;
    }

    /// The value in use; null only when constructed so. Tick's thread (or any while no tick runs).
    [[nodiscard]] T* current() const noexcept { return current_; }

  private:
    std::atomic<T*> pending_{nullptr};
    T* current_ = nullptr;
    T* unretired_ = nullptr;
    SpscQueue<T*> retired_{16};
};

}  // namespace handpiece::rt
