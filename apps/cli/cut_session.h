// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What goes with a cut besides the loop: the record, the mirror of what is left, undo and redo.

#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/station.h"
#include "handpiece/record/history/history.h"
#include "handpiece/record/session/event_watch.h"
#include "handpiece/record/session/recorder.h"

namespace handpiece::cli {

/// What the end of a session says about the tooth, as JSON, and back.
[[nodiscard]] std::string hashText(std::uint64_t stateHash);

/// Listens to a loop that cuts. All on the listener's thread.
class CutSession {
  public:
    /// `recorder` may be null: a replay records nothing.
    CutSession(const Station& station, session::Recorder* recorder, bool mayWait);

    void hear(const tooth::BrickSnapshot& brick);
    void hear(const messages::HapticSample& sample);

    enum class Step { undo, redo, reset };
    /// Hands the step to the loop; false when there is none, or a stroke or an earlier step is still under way.
    bool take(Step step, loop::HapticLoop& loop);
    [[nodiscard]] const history::History& history() const noexcept { return history_; }
    [[nodiscard]] bool inStroke() const noexcept { return watch_.inStroke(); }

    /// The last key frame and the state's hash, when the loop has ended.
    void finish(const tooth::CutState& state, std::uint64_t tick);

  private:
    void keepKeyFrame(const messages::HapticSample& sample);
    void tell(std::uint64_t tick, session::EventName name, std::string_view text);

    const Station& station_;
    session::Recorder* recorder_;
    bool mayWait_;
    tooth::CutMirror mirror_;
    history::MirrorSource source_;
    history::History history_;
    session::EventWatch watch_;
    std::uint64_t strokes_ = 0;
    struct Pending {
        std::uint64_t command;
        session::EventName name;
    };
    std::deque<Pending> pending_;
    double lastKeyFrameS_ = 0.0, keyFrameBytes_ = 0.0;
};

}  // namespace handpiece::cli
