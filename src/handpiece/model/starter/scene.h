// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What stands around a starter tooth: its neighbours, the gum and the bone. Private to this room.

#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/starter/anatomy.h"
#include "handpiece/model/starter/starter.h"

namespace handpiece::starter {

/// Two neighbours (mesial, distal), gum and bone with their sockets, tooth frame. Simplified: to be seen, not cut.
/// `isSketch`: coarser, for the first moment.
[[nodiscard]] std::vector<cases::Part> makeScene(ToothKind kind, const core::Progress& progress, bool isSketch = false);

/// The anatomy of a kind.
[[nodiscard]] Anatomy anatomyOf(ToothKind kind);

}  // namespace handpiece::starter
