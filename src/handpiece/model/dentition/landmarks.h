// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The landmarks of a tooth, looked for on its surfaces. Private to this room.

#include <vector>

#include "handpiece/model/case/landmark.h"
#include "handpiece/model/dentition/surfaces.h"

namespace handpiece::dentition {

/// In the frame of anatomy.h.
[[nodiscard]] std::vector<cases::Landmark> landmarksOf(const Anatomy& anatomy);

}  // namespace handpiece::dentition
