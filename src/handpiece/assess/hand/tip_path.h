// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The way of a tip, evenly timed. Private to this room.

#include <cstdint>
#include <functional>
#include <optional>

#include "handpiece/base/core/vec.h"

namespace handpiece::hand {

/// The mean place in each stretch of time of one length: what an encoder's steps and a tick's noise add to a way goes.
class TipPath {
  public:
    /// Told each stretch that is over, in order: where, and which (counted from the session's time 0). One in which
    /// there was no sample lies on the line between those around it.
    using Listener = std::function<void(const core::Vec3& placeMm, std::int64_t stretch)>;
    TipPath(double stretchS, Listener listener) : stretchS_(stretchS), tell_(std::move(listener)) {}

    void take(double timeS, const core::Vec3& placeMm);
    /// Tells the stretch under way and forgets where it was.
    void end();

  private:
    void finishStretch();

    double stretchS_;
    Listener tell_;
    std::int64_t stretch_ = 0;
    std::size_t count_ = 0;
    core::Vec3 sum_ = core::Vec3::Zero();
    std::optional<core::Vec3> before_;
    std::int64_t beforeStretch_ = 0;
};

}  // namespace handpiece::hand
