// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What goes with a cut besides the loop: the record, the mirror of what is left, undo and redo.

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/record/history/history.h"
#include "handpiece/record/session/event_watch.h"
#include "handpiece/record/session/recorder.h"

namespace handpiece::simulation {

/// What the end of a session says about the tooth, as JSON, and back.
[[nodiscard]] std::string hashText(std::uint64_t stateHash);

/// Listens to a loop that cuts. All on the listener's thread.
class CutSession {
  public:
    /// `recorder` may be null: a replay records nothing. `before`: strokes that led to the tooth as it is; null: none.
    CutSession(const SimulationSetup& station, session::Recorder* recorder, bool mayWait,
               const history::History* before = nullptr);

    void hear(const tooth::BrickSnapshot& brick);
    void hear(const messages::HapticSample& sample);

    enum class Step { undo, redo, reset };
    /// Hands the step to the loop; false when there is none, or a stroke or an earlier step is still under way.
    bool take(Step step, loop::HapticLoop& loop);
    /// The same for a step that was taken when this session was recorded: also when a stroke began just then.
    bool takeAgain(Step step, loop::HapticLoop& loop);
    /// Tells the event when the loop has taken the command.
    void tellWhenTaken(std::uint64_t command, session::EventName name, std::string text);
    /// True while the loop has yet to take a command that is to be told.
    [[nodiscard]] bool isWaiting() const noexcept { return !pending_.empty(); }
    /// Hears every event as it is told, on the listener's thread.
    using EventListener = std::function<void(std::uint64_t tick, session::EventName name)>;
    void setEventListener(EventListener listener) { listener_ = std::move(listener); }
    /// The tooth was put into this state from outside: what differs belongs to the stroke under way.
    void correct(const tooth::StateDelta& state);
    /// The loop has ended with the tooth in this state: what was cut since the last stroke is a stroke as well.
    void settle(const tooth::StateDelta& state);
    [[nodiscard]] const history::History& history() const noexcept { return history_; }
    [[nodiscard]] bool inStroke() const noexcept { return watch_.inStroke(); }
    [[nodiscard]] std::uint64_t strokes() const noexcept { return watch_.strokes(); }
    /// The teeth as their listeners have heard of them by now.
    [[nodiscard]] tooth::StateDelta state() const { return mirror_.state(removedMm3_); }

    /// The last key frame and the state's hash, when the loop has ended.
    void finish(const tooth::StateDelta& state, std::uint64_t tick);

  private:
    void keepKeyFrame(const messages::HapticSample& sample);
    void tell(std::uint64_t tick, session::EventName name, std::string_view text);

    session::Recorder* recorder_;
    bool mayWait_;
    std::uint64_t identity_;  ///< of the teeth
    tooth::MouthMirror mirror_;
    history::MirrorSource source_;
    history::History history_;
    session::EventWatch watch_;
    EventListener listener_;
    tooth::RemovedMm3 removedMm3_{};
    bool hasRestored_ = false;  ///< since the last key frame
    std::uint64_t strokes_ = 0;
    struct Pending {
        std::uint64_t command;
        session::EventName name;
        std::string text;
    };
    std::deque<Pending> pending_;
    double lastKeyFrameS_ = 0.0, keyFrameBytes_ = 0.0;
};

}  // namespace handpiece::simulation
