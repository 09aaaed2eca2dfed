// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A finer tooth in its mouth, and the mouth that a first start opens.

#include <filesystem>

#include "handpiece/model/case/case.h"

namespace handpiece::course {

/// Its tooth, and the faces of that: one of the five resolutions of the paper's Table II.
inline constexpr int kFirstFdi = 46;
inline constexpr std::size_t kFirstFaces = 68151;

/// The mouth with a finer tooth in the place, and the frame, of the one that is worked on: its antagonists have ground
/// it as they had the one before.
[[nodiscard]] cases::Case standIn(cases::Tooth tooth, cases::Case mouth);

/// The tooth in the mouth of the ordinary patient, kept in `folder` as keptTooth() and keptMouth() do.
[[nodiscard]] cases::Case firstMouth(const std::filesystem::path& folder);

}  // namespace handpiece::course
