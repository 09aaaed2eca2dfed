// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Cuts of the gingiva out of what a session recorded, where it is not played again.

#include <cstdint>
#include <string>
#include <vector>

#include "handpiece/app/simulation/gingiva_cuts.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/record/session/session_reader.h"

namespace handpiece::simulation {

/// Those from the session's beginning up to a tick, in place of what `cuts` holds. Where the hand was stands for where
/// the bur is seen, which no session keeps: nearly the same, as gingiva holds nothing off.
void hearRecorded(GingivaCuts& cuts, const session::SessionReader& reader, const std::vector<session::Event>& events,
                  const SimulationSettings& first, std::uint64_t toTick, const std::string& where);

}  // namespace handpiece::simulation
