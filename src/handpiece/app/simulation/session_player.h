// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Plays a recorded session: the tooth, the bur and the forces at any time of it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/app/simulation/live_session.h"
#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::simulation {

/// Whether a session, cut again from its beginning, leaves the same tooth.
struct Verdict {
    std::string hash;      ///< of the tooth that was cut again: at the session's end, or at its last key frame
    std::string recorded;  ///< what the session says; empty when it was cut off before it told a state
    bool matches = false, complete = false;
    /// Recorded by an engine of this revision. If it is not core::kEngineRevision, what was cut again was put right at
    /// each key frame, and nothing is proven.
    std::int32_t engineRevision = 0;
    [[nodiscard]] bool isOtherEngine() const noexcept { return engineRevision != core::kEngineRevision; }
    std::uint64_t ticks = 0, differingTicks = 0, firstDifferingTick = 0;
    /// Where the session goes on after a pause or a crash, and how often the tooth there is not what was done before.
    std::uint64_t seams = 0, brokenSeams = 0;
};
/// Who looks at the player along the way: at its first tick, at the first tick of every further `stepS`, at its last.
struct Watch {
    double stepS = 0.0;
    std::function<void()> look{};  ///< must leave the player where it is; none: nobody looks
};
/// From the beginning on it cuts the very tooth that was cut, bit for bit. After a jump, and in a session of another
/// engine revision, it goes on from the key frame before, with half a second of run-up for rotor and proxy; at each
/// further key frame the tooth is the recorded one again. Where the session goes on after a pause or a crash it does
/// what was done then: another loop, on the tooth as it was brought back. One thread.
class SessionPlayer {
  public:
    struct Settings {
        bool useCache = true;
        bool isSeen = true;  ///< false: there is no tooth(), and so no surface to keep up
        /// Cuts in another field than the session's: as good as the same hand on the same tooth, not the same bits.
        std::optional<field::FieldSettings> field;
    };
    /// Stands at the session's first tick. Throws core::Error: no session, damaged, without its tooth, nothing
    /// recorded; for another field also when the tooth had been cut before the session began.
    explicit SessionPlayer(const std::filesystem::path& path, const Settings& settings,
                           const core::Progress& progress = {});
    explicit SessionPlayer(const std::filesystem::path& path, bool useCache = true,
                           const core::Progress& progress = {});
    ~SessionPlayer();
    SessionPlayer(const SessionPlayer&) = delete;
    SessionPlayer& operator=(const SessionPlayer&) = delete;

    [[nodiscard]] const session::SessionReader& reader() const noexcept;
    [[nodiscard]] const std::vector<session::Event>& events() const noexcept;
    [[nodiscard]] const cases::Case& toothCase() const noexcept;
    /// With the settings in force now: bur and parameters change along the way.
    [[nodiscard]] const SimulationSetup& station() const noexcept;
    [[nodiscard]] const std::shared_ptr<LiveTooth>& tooth() const noexcept;
    [[nodiscard]] double durationS() const noexcept;
    [[nodiscard]] double timeS() const noexcept;

    /// To a time, clamped to the session.
    void seek(double timeS, const core::Progress& progress = {});
    /// Plays on to a later time; stops at the end. Throws core::Error where ticks are missing (the disk was too slow):
    /// a jump past them goes on.
    void advance(double toS, const core::Progress& progress = {});
    /// As the loop computed it again at timeS(): with the proxy's pose, which no session keeps.
    [[nodiscard]] const messages::HapticSample& sample() const noexcept;
    /// The whole session for plots: recorded, not computed again.
    [[nodiscard]] std::vector<PlotPoint> plot(double stepS = kPlotStepS) const;
    [[nodiscard]] tooth::StateDelta state() const;
    /// Of the tooth that the session began with (tooth::stateHash).
    [[nodiscard]] std::uint64_t startHash() const;
    /// Undo and redo of what was played since the beginning; a stroke under way counts as done, so play no further.
    [[nodiscard]] const history::History& endHistory();
    /// Undo and redo of the whole session out of its key frames, none of it played, and of what leads to the state
    /// `end`. A stroke without a key frame of its own (the session grew too large) is one with the next.
    [[nodiscard]] history::History historyByKeyFrames(const tooth::StateDelta& end) const;

    /// True from the beginning on, until a jump, in a session of this engine: what is computed is what was computed
    /// then, bit for bit.
    [[nodiscard]] bool isExact() const noexcept;
    /// Ticks that differed from the record since the beginning or the last jump, and the first of them.
    [[nodiscard]] std::uint64_t differingTicks() const noexcept;
    [[nodiscard]] std::uint64_t firstDifferingTick() const noexcept;

    /// Undo and redo that could not be repeated: after a jump, or in another field.
    [[nodiscard]] std::uint64_t skippedSteps() const noexcept;
    /// From the beginning to the end. Throws core::Error as advance(), and for what cannot be repeated.
    [[nodiscard]] Verdict compareAll(const core::Progress& progress = {}, const Watch& watch = {});

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The tooth at the end of a session, whole or cut off: what the window offers after a crash.
struct Recovered {
    tooth::StateDelta state;
    double elapsedS = 0.0;
    SimulationSettings settings;  ///< in force at the end
    std::string code;
    cases::Case toothCase;  ///< as the session holds it
    history::History history;
};
/// Its last key frame, and what was recorded after that cut again. Throws core::Error as SessionPlayer.
[[nodiscard]] Recovered recover(const std::filesystem::path& session, const core::Progress& progress = {});

/// The same hand on the same tooth with another field: what was cut, for a voxel size chosen later.
struct Recut {
    SimulationSetup station;  ///< with the settings in force at the end; its field stands at `state`
    tooth::StateDelta state;
    double elapsedS = 0.0;
    history::History history;
    std::uint64_t skippedSteps = 0;  ///< undo and redo that had nothing to work on in this field
};
/// Throws core::Error as SessionPlayer with another field.
[[nodiscard]] Recut recutAt(const std::filesystem::path& session, const field::FieldSettings& field,
                            bool useCache = true, const core::Progress& progress = {});

}  // namespace handpiece::simulation
