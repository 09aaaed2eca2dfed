// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Which way a place of a preparation lies, as a dentist says it.

#include <string>
#include <string_view>

#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::report {

/// What places are told against.
struct Bearings {
    core::Box asked;                        ///< about what was to be cut, tooth frame; empty: not known
    core::Vec3 draw = core::Vec3::UnitZ();  ///< from where one works: nothing is said of along it
    int fdi = 0;                            ///< 0: no tooth, which has no sides
    int buccalSign = 0;
};
/// Of an exercise whose preparation lies on its tooth; else of the tooth as a whole. Lays it on: some tens of
/// milliseconds.
[[nodiscard]] Bearings bearingsOf(const tasks::Task& task);
/// Of measures::kSides, towards which the place lies; empty: about the middle, or it cannot be said.
[[nodiscard]] std::string_view sideOf(const Bearings& bearings, const core::Vec3& placeMm);
/// "mesially", "at the mesiobuccal cusp", "palatally" of an upper tooth; empty for what has no word.
[[nodiscard]] std::string sideWord(const Bearings& bearings, std::string_view side);
/// "mesial", "palatal": as it stands at the edge of a picture.
[[nodiscard]] std::string sideNoun(const Bearings& bearings, std::string_view side);
/// Of an extent along the axis of that side: "mesiodistally".
[[nodiscard]] std::string axisWord(const Bearings& bearings, std::string_view side);

}  // namespace handpiece::report
