// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A student at work: the loop on its own thread, and one listener's thread that records, keeps undo and the surface
/// up, and tells everybody else. What the window is a window onto.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/app/simulation/history_bytes.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/app/simulation/plot_points.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/app/simulation/working_way.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/triple_buffer.h"
#include "handpiece/model/case/attempt.h"
#include "handpiece/record/session/recorder.h"
#include "handpiece/tick/loop/loop_run.h"

namespace handpiece::simulation {

/// The latest sample, for one reader, who can be woken by it.
class SampleFeed {
  public:
    /// The writer's thread, which may not be the tick's.
    void write(const messages::HapticSample& sample) {
        latest_.write(sample);
        const std::lock_guard lock(mutex_);
        if (wake_) wake_(sample);
    }
    // The reader's.
    const messages::HapticSample& read() noexcept { return latest_.read(); }
    [[nodiscard]] bool hasNews() const noexcept { return latest_.hasNews(); }
    /// Called by the writer after each sample from now on; must not wait. Empty: nobody is. When this returns, whoever
    /// was called before is called no more.
    using Wake = std::function<void(const messages::HapticSample& sample)>;
    void setWake(Wake wake) {
        const std::lock_guard lock(mutex_);
        wake_ = std::move(wake);
    }

  private:
    rt::TripleBuffer<messages::HapticSample> latest_;
    std::mutex mutex_;
    Wake wake_;
};

struct LiveSessionSettings {
    std::filesystem::path sessionFile;  ///< empty: nothing is recorded
    /// A new file, or one that goes on: where this program paused, or with what recover() found in it.
    enum class Session { anew, continued, recovered };
    Session session = Session::anew;
    std::string code;       ///< of the student, may be empty
    double elapsedS = 0.0;  ///< before, of an attempt that goes on
    KeptHistory history;    ///< strokes before, that led to the station's tooth as it is
    bool realTime = true;   ///< asks for real-time scheduling
    double spinUs = 0.0;
    bool lowerButtonUndoes = true;  ///< of a device's stylus: held half a second with the bur clear (HeldButton)
};

/// How it stands, for the status bar.
struct LiveSessionStatus {
    rt::SchedulingGrant scheduling;  ///< of the tick
    double timeS = 0.0;              ///< of the latest sample
    std::uint64_t ticks = 0, lateTicks = 0, missedPeriods = 0, queueOverflow = 0;
    loop::Spread workUs, latenessUs;        ///< over the last ten seconds
    loop::Spread allWorkUs, allLatenessUs;  ///< since the beginning, to within 1.1 %, the largest exact; once it ended
    double load = 0.0;                      ///< mean share of a period that a tick works, the last second
    std::size_t undoSteps = 0, redoSteps = 0;
    std::uint64_t strokes = 0;
    bool inStroke = false, restoring = false, cut = false;  ///< cut: something is missing of the tooth
    session::RecorderStatus recording;
    std::string fault;  ///< why the listener's thread ended; empty while all is well
    bool hull = false;  ///< the paper's hulls are felt: nothing is cut
    /// Of one core that the listener's thread used, the last second; and its longest absence since the last second
    /// [ms].
    double listenerLoad = 0.0, listenerAbsentMs = 0.0;
};

/// What changed, in words and numbers that a window can translate: an id and its arguments.
///
/// Of the record: "recording-stopped" (why), "recording-incomplete" (ticks lost). Of the work: "pulp-exposed",
/// "neighbour-touched", "neighbour-cut", "gingiva-cut", "head-touched", "stalled", "force-limited", "device-fault",
/// "out-of-bricks". Of requests that were refused: "nothing-to-undo", "nothing-to-redo", "nothing-to-reset",
/// "not-while-cutting", "hull-needs-whole-tooth", "hull-only-touches", "refused" (why). "samples-lost" (how many): the
/// listener's thread was too slow.
struct Notice {
    std::string id;
    std::vector<std::string> arguments;
    std::optional<core::Error> cause{};  ///< of "recording-stopped" and "refused": the why, to be told in other words
};

class LiveSession {
  public:
    /// Starts at once. `device` belongs to it. Throws core::Error for a session file that cannot be begun.
    LiveSession(SimulationSetup station, const cases::Case& toothCase, std::unique_ptr<device::Device> device,
                const LiveSessionSettings& settings, std::shared_ptr<LiveTooth> liveTooth);
    /// stop()
    ~LiveSession();
    LiveSession(const LiveSession&) = delete;
    LiveSession& operator=(const LiveSession&) = delete;

    /// Pedal or not: ends the loop, writes the last key frame and closes the session. Idempotent.
    void stop();

    // Requests: given to the listener's thread, take effect within milliseconds and in their order, are recorded and
    // replayed. Of several of a kind that wait in a row the last counts (but for undo and redo). Throw core::Error for
    // values out of range; what cannot be done now ends in a Notice.

    void undo();
    void redo();
    void reset();
    void setBur(std::shared_ptr<const instrument::Bur> bur, const instrument::CuttingParameters& cuttingParameters);
    void setDrive(const instrument::Drive& drive);
    void setParameters(const force::Parameters& parameters);
    /// Writes into the record from where and how one works from now on. A replay only tells it.
    void noteWorkingWay(const WorkingWay& way);
    /// The paper's hulls instead of the field: touching only. Refused (a Notice "hull-needs-whole-tooth") once cut.
    /// The bur's is that of its outline, which is what sessions keep.
    void setHullMethod(bool hull);

    // Listeners. A feed is made before it is used and lives as long as the sitting; one reader each.

    [[nodiscard]] std::shared_ptr<SampleFeed> subscribe();
    /// Called on the listener's thread for every sample from now on, in order; must not wait, nor call state(),
    /// attempt() or stop(). What it throws ends the sitting with LiveSessionStatus::fault.
    using SampleListener = std::function<void(const messages::HapticSample& sample)>;
    void setListener(SampleListener listener);
    /// Points since the last call, of the last ten minutes at most; one reader.
    [[nodiscard]] std::vector<PlotPoint> takePlot();
    [[nodiscard]] std::vector<Notice> takeNotices();
    [[nodiscard]] LiveSessionStatus status() const;

    [[nodiscard]] const std::shared_ptr<LiveTooth>& tooth() const noexcept;
    /// Tooth and field, and the settings it began with. Its field belongs to the tick until stop() has returned.
    [[nodiscard]] const SimulationSetup& station() const noexcept;
    /// As asked for by now: the latest bur, drive and parameters.
    [[nodiscard]] SimulationSettings settings() const;
    /// The tooth as it is now with all that an attempt keeps; whenever, also after stop(). `caseFile` is what it
    /// names.
    [[nodiscard]] cases::Attempt attempt(const std::filesystem::path& caseFile) const;
    /// What can be undone and redone, for the next sitting at the same tooth. Once stop() has returned.
    [[nodiscard]] const history::History& history() const;
    /// State of the tooth and volumes now: as the listener's thread has heard of it, some milliseconds ago.
    [[nodiscard]] tooth::StateDelta state() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::simulation
