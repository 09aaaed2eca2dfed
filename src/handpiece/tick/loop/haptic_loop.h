// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tick: device -> contact -> force, at a fixed rate, on simulated or on wall-clock time.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/spsc_queue.h"
#include "handpiece/base/rt/staged.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/device/device.h"
#include "handpiece/tick/force/force_model.h"

namespace handpiece::loop {

struct LoopSettings {
    double rateHz = 1000;               ///< 1, 2, 4 or 8 kHz by design; anything from 100 to 10,000 runs
    std::size_t queueCapacity = 16384;  ///< samples a slow listener may lag behind
    double spinUs = 0.0;                ///< busy waiting before each tick, on the wall clock
};

/// Percentiles of a quantity over a run.
struct Spread {
    double p50 = 0, p99 = 0, p999 = 0, max = 0;
};

struct RunReport {
    std::string scheduling;           ///< one line for people
    std::uint64_t ticks = 0;          ///< done
    std::uint64_t lateTicks = 0;      ///< that sent their force more than a period after their nominal time
    std::uint64_t missedPeriods = 0;  ///< left out because a tick or the machine took longer than a period
    std::uint64_t queueOverflow = 0;  ///< samples no listener fetched in time
    Spread workUs, latenessUs;        ///< over the samples fetched
};

/// Fetches each sample, in order; called off the tick.
using Listener = std::function<void(const messages::HapticSample&)>;

/// Owns a device, a contact method and a force model and composes them, tick by tick.
///
/// Parameters and method can be replaced while it runs, from one other thread: they are prepared there, swapped in
/// between two ticks and disposed of there.
class HapticLoop {
  public:
    /// Throws core::Error for a rate that cannot be run, limits or parameters out of range.
    HapticLoop(const LoopSettings& settings, std::unique_ptr<device::Device> device,
               std::unique_ptr<contact::Method> method, const force::Parameters& parameters);

    /// As fast as possible on simulated time: the same inputs give the same samples, bit for bit, but for workUs and
    /// lateUs.
    RunReport runSimulated(double durationS, const Listener& listener = {});
    /// On the wall clock, in a thread with what real-time privileges there are; this thread feeds the listener
    /// meanwhile.
    RunReport runRealTime(double durationS, const Listener& listener = {});
    /// Ends a run after the tick under way. Any thread, also a signal handler.
    void requestStop() noexcept { stop_.store(true, std::memory_order_relaxed); }

    /// Takes effect at the next tick. Throws core::Error for values out of range. Not from the tick.
    void setParameters(const force::Parameters& parameters);
    /// Another tooth or another bur; the force fades in. Not from the tick.
    void setMethod(std::unique_ptr<contact::Method> method);

    /// One tick. For run...() and for tests.
    void tick(const rt::Beat& beat) noexcept HANDPIECE_REALTIME;

    [[nodiscard]] const device::Device& device() const noexcept { return *device_; }
    [[nodiscard]] double periodS() const noexcept { return periodS_; }
    /// The samples, for a listener of one's own instead of run...()'s. One consumer.
    [[nodiscard]] rt::SpscQueue<messages::HapticSample>& samples() noexcept { return samples_; }

  private:
    class Statistics;
    void takeStagedCommands() noexcept;
    void publish(const device::Reading& reading, const force::Touch& touch, const force::ForceCommand& command,
                 std::int64_t workNs, std::int64_t lateNs) noexcept;
    std::uint64_t ticksFor(double durationS);
    RunReport finish(const Statistics& statistics, std::string scheduling) const;

    LoopSettings settings_;
    double periodS_;
    std::unique_ptr<device::Device> device_;
    rt::Staged<contact::Method> method_;
    rt::Staged<force::Parameters> parameters_;
    force::ForceModel force_;
    rt::SpscQueue<messages::HapticSample> samples_;
    std::atomic<bool> stop_{false};
    bool started_ = false;
    std::uint64_t tick_ = 0;
    std::uint64_t ticksDone_ = 0, lateTicks_ = 0, missedPeriods_ = 0;
};

}  // namespace handpiece::loop
