// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What was pressed and stands: a stroke that is taken back takes with it what it pressed. Private to this room.

#include <cstddef>
#include <map>
#include <vector>

#include "handpiece/assess/hand/impulse.h"

namespace handpiece::hand {

/// Goes through undo, redo and reset as the history of the tooth does: a stroke that removed something is a step; what
/// was pressed after it, in strokes that removed nothing, goes back with it. Memory grows with strokes that pressed on
/// something.
class StandingImpulse {
  public:
    /// On this tissue, by its number; -1: on all that must be kept.
    void take(int on, double forceN, double lastsS, const measures::Evidence& now) {
        if (forceN > 0.0) since_[on].take(forceN, lastsS, now);
    }
    void endStroke(bool hasRemoved);
    void undo();
    void redo();
    void reset();
    [[nodiscard]] Impulse on(int tissue) const;

  private:
    using Pressed = std::map<int, Impulse>;
    struct Step {
        Pressed pressed;
        bool isReset = false;  ///< nothing before it stands
    };
    void settle();

    std::vector<Step> steps_{1};  ///< the first is what came before any stroke
    std::size_t done_ = 1;        ///< so many of them stand
    Pressed since_;               ///< the last stroke ended
};

}  // namespace handpiece::hand
