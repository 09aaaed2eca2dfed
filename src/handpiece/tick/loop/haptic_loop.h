// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tick: device -> contact -> force -> cutting.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/spsc_queue.h"
#include "handpiece/base/rt/staged.h"
#include "handpiece/model/instrument/rotor.h"
#include "handpiece/model/tooth/state_delta.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/cutting/cutter.h"
#include "handpiece/tick/device/device.h"
#include "handpiece/tick/force/event_based_force.h"
#include "handpiece/tick/force/force_model.h"

namespace handpiece::loop {

struct LoopSettings {
    double rateHz = 1000;               ///< 1, 2, 4 or 8 kHz by design; anything from 100 to 10,000 runs
    std::size_t queueCapacity = 16384;  ///< samples a slow listener may lag behind
    double spinUs = 0.0;                ///< busy waiting before each tick, on the wall clock
    std::size_t brickCapacity = 2048;   ///< changed bricks on their way to a listener; more wait in the tooth
};

/// One bur at the teeth of a mouth: how they touch, and what the bur takes off those that can be cut.
struct Work {
    std::unique_ptr<contact::Method> method;  ///< feels all teeth; its answers name the tooth
    std::unique_ptr<cutting::Cutter> cutter;  ///< on the fields that `method` feels; none: touching only
};

/// How a run went so far, by the tick's own count.
struct TickCount {
    std::uint64_t ticks = 0;          ///< done
    std::uint64_t lateTicks = 0;      ///< that sent their force more than a period after their nominal time
    std::uint64_t missedPeriods = 0;  ///< left out because a tick or the machine took longer than a period
};

/// Fetches each sample, in order; called off the tick.
using Listener = std::function<void(const messages::HapticSample&)>;
/// Fetches each brick that a cut has changed, as it then was; called off the tick.
using BrickListener = std::function<void(const tooth::BrickSnapshot&)>;

/// Owns a device, a contact method, a force model, a rotor and a cutter and composes them, tick by tick. loop_run.h
/// makes it tick.
///
/// Parameters, bur, tooth and drive can be replaced while it runs, from one other thread: they are prepared there,
/// swapped in between two ticks and disposed of there. Each such command has a number; a sample tells the newest that
/// has taken effect, so that a record can be replayed.
class HapticLoop {
  public:
    /// Throws core::Error for a rate that cannot be run, limits or parameters out of range.
    HapticLoop(const LoopSettings& settings, std::unique_ptr<device::Device> device,
               std::unique_ptr<contact::Method> method, const force::Parameters& parameters);
    HapticLoop(const LoopSettings& settings, std::unique_ptr<device::Device> device, Work work,
               const force::Parameters& parameters, const instrument::Drive& drive = {});

    /// One tick.
    void tick(const rt::Beat& beat) noexcept HANDPIECE_REALTIME;

    /// Take effect at the next tick; return the command's number. Throw core::Error for values out of range. From one
    /// thread that is not the tick's. Of two of a kind given within a tick only the later one takes effect.
    std::uint64_t setParameters(const force::Parameters& parameters);
    std::uint64_t setDrive(const instrument::Drive& drive);
    /// Another tooth or another bur: no force until the bur is clear of it, then it fades in.
    std::uint64_t setWork(Work work);
    std::uint64_t setMethod(std::unique_ptr<contact::Method> method);
    /// Undo, redo, reset: puts bricks of the teeth in place, some a tick; no force until that is done and the bur is
    /// clear. Throws core::Error while an earlier change is still being put in place, and when no tooth can be cut.
    std::uint64_t restore(tooth::StateDelta change);
    [[nodiscard]] bool restoring() const noexcept { return restoring_.load(std::memory_order_acquire); }

    /// Gives what the tick has told since the last call, in its order: each sample after the bricks that were handed
    /// over up to it, and no later ones. One consumer, who does not take from samples() or bricks() as well.
    void fetch(const Listener& listener, const BrickListener& bricks);
    /// The samples, for a listener of one's own instead of fetch(). One consumer.
    [[nodiscard]] rt::SpscQueue<messages::HapticSample>& samples() noexcept { return samples_; }
    [[nodiscard]] rt::SpscQueue<tooth::BrickSnapshot>& bricks() noexcept { return bricks_; }

    /// Before a run: nothing has been counted and nobody has asked it to stop. While none is under way.
    void beginRun() noexcept;
    /// Goes on with a bur that turns, as a record has it. Throws core::Error as Rotor::setSpeedRpm(). While none is
    /// under way.
    void setSpeedRpm(double rpm) { rotor_.setSpeedRpm(rpm); }
    /// Ends a run after the tick under way. Any thread, also a signal handler.
    void requestStop() noexcept { stop_.store(true, std::memory_order_relaxed); }
    [[nodiscard]] bool stopRequested() const noexcept { return stop_.load(std::memory_order_relaxed); }
    /// After a run: leaves the device without force.
    void release() noexcept;

    [[nodiscard]] const LoopSettings& settings() const noexcept { return settings_; }
    [[nodiscard]] const TickCount& count() const noexcept { return count_; }  ///< while no run is under way
    [[nodiscard]] const device::Device& device() const noexcept { return *device_; }
    [[nodiscard]] double periodS() const noexcept { return periodS_; }

  private:
    template <class T>
    struct Command {
        T value;
        std::uint64_t number = 0;
    };
    struct Restore {
        tooth::StateDelta change;
        std::size_t next = 0;
    };
    void takeStagedCommands() noexcept;
    void took(std::uint64_t number) noexcept;
    [[nodiscard]] device::Reading readDevice(double elapsedS) noexcept;
    void cut(const device::Reading& reading, const force::Touch& touch, const force::ForceCommand& command,
             double elapsedS) noexcept;
    void restoreSome() noexcept;
    void publish(const device::Reading& reading, const force::Touch& touch, const force::ForceCommand& command,
                 const rt::Beat& beat, std::int64_t workNs, std::int64_t cutNs) noexcept;
    void handOver() noexcept;

    LoopSettings settings_;
    double periodS_;
    std::unique_ptr<device::Device> device_;
    rt::Staged<Command<Work>> work_;
    rt::Staged<Command<force::Parameters>> parameters_;
    rt::Staged<Command<instrument::Drive>> drive_;
    rt::Staged<Command<Restore>> restore_;
    std::uint64_t commands_ = 0;          // given, by the owner's thread
    std::uint64_t lastCommand_ = 0;       // taken, by the tick
    std::atomic<bool> restoring_{false};  // from restore() to the last brick in place
    bool isRestoring_ = false;            // the tick's own: the change has been taken
    force::ForceModel force_;
    force::EventBasedForce eventForce_;
    instrument::Rotor rotor_;
    cutting::CutResult cut_;
    double uncutS_ = 0.0;  // since the last cut, while the bur turns
    force::Turning turning_;
    std::uint32_t cutFlags_ = 0;
    rt::SpscQueue<messages::HapticSample> samples_;
    rt::SpscQueue<tooth::BrickSnapshot> bricks_;
    std::uint64_t handedBricks_ = 0, fetchedBricks_ = 0;  // by the tick; by the listener
    tooth::BrickSnapshot fetched_;
    std::atomic<bool> stop_{false};
    bool started_ = false;
    std::uint64_t tick_ = 0;
    TickCount count_;
};

}  // namespace handpiece::loop
