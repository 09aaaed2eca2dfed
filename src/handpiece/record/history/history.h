// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Undo and redo of strokes on teeth that are being cut.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "handpiece/model/tooth/tooth_mirror.h"

namespace handpiece::history {

/// Where a stroke's outcome is read from: the mirror of the cut field, or something like it.
class BrickSource {
  public:
    virtual ~BrickSource() = default;
    /// False when the brick is as before any cut.
    [[nodiscard]] virtual bool isChanged(tooth::BrickId id) const = 0;
    /// kBrickValues values of a changed brick; `scratch` has room for them.
    [[nodiscard]] virtual const float* values(tooth::BrickId id, float* scratch) const = 0;
};

/// The mirrors of a mouth as a source.
class MirrorSource final : public BrickSource {
  public:
    explicit MirrorSource(const tooth::MouthMirror& mirror) : mirror_(mirror) {}
    [[nodiscard]] bool isChanged(tooth::BrickId id) const override { return mirror_.isChanged(id); }
    [[nodiscard]] const float* values(tooth::BrickId id, float* scratch) const override {
        return mirror_.values(id, scratch);
    }

  private:
    const tooth::MouthMirror& mirror_;
};

struct HistorySettings {
    std::size_t leastSteps = 50;                       ///< that can be undone at once, whatever memory they take
    std::size_t memoryBytes = std::size_t{256} << 20;  ///< beyond the least, the oldest steps go when more is used
};

/// Steps back and forth through the strokes at the teeth of a mouth. Off the tick, one thread.
///
/// It keeps, packed, the tooth as it was after the last stroke and what each step changed. What undo() gives depends
/// on the strokes alone, never on how far the source has come, so any number of steps can be asked for at once and
/// a replay gets the same bits. A stroke ends for it when the pedal is up and the last brick cut meanwhile has been
/// handed over; a pedal that goes down before belongs to the same stroke.
class History {
  public:
    explicit History(const HistorySettings& settings = {}) : settings_(settings) {}

    /// Begins anew on a tooth in this state; nothing to undo.
    void start(const tooth::StateDelta& state);
    /// A brick was handed over: it may have changed in the stroke under way.
    void noteTouched(tooth::BrickId id) { touched_.insert(id); }
    /// Ends a stroke. True when it removed something: then there is one more step to undo and none to redo.
    bool endStroke(const BrickSource& source, const tooth::RemovedMm3& removedMm3);

    [[nodiscard]] std::size_t undoSteps() const noexcept { return done_; }
    [[nodiscard]] std::size_t redoSteps() const noexcept { return steps_.size() - done_; }
    /// What takes the tooth one stroke back: bricks at rising number and the volumes removed by then. None when there
    /// is nothing to undo. To be put into the field (in the tick, in chunks) and into the mirror.
    [[nodiscard]] std::optional<tooth::StateDelta> undo();
    [[nodiscard]] std::optional<tooth::StateDelta> redo();
    /// What makes the tooth uncut; a step that can be undone. None when it is uncut.
    [[nodiscard]] std::optional<tooth::StateDelta> reset();

    // To be kept and put together again, on a tooth in the same state.

    /// Of undoSteps() + redoSteps(), the oldest first: to where the step leads, back when done and on when not.
    [[nodiscard]] tooth::StateDelta step(std::size_t index) const;
    /// One more at the end, as step() gave it. After start(), those done first.
    void append(const tooth::StateDelta& otherSide, bool isDone);

    /// Of the tooth where the steps have led.
    [[nodiscard]] const tooth::RemovedMm3& removedMm3() const noexcept { return removedMm3_; }
    /// Of all that is kept.
    [[nodiscard]] std::size_t memoryBytes() const noexcept { return memoryBytes_; }

  private:
    /// A brick, packed; empty: as before any cut.
    using Packed = std::vector<std::byte>;
    struct Step {
        std::map<tooth::BrickId, Packed>
            bricks;  ///< the other side of the step: before it when done, after it when not
        tooth::RemovedMm3 removedMm3{};
    };
    void add(Step&& step);
    static tooth::StateDelta unpacked(const Step& step);
    tooth::StateDelta exchange(Step& step);
    static std::size_t bytesOf(const Step& step);

    HistorySettings settings_;
    std::map<tooth::BrickId, Packed> now_;  ///< bricks that differ from the uncut tooth, after the last step done
    tooth::RemovedMm3 removedMm3_{};
    std::deque<Step> steps_;  ///< done ones first
    std::size_t done_ = 0, memoryBytes_ = 0;
    std::set<tooth::BrickId> touched_;
};

}  // namespace handpiece::history
