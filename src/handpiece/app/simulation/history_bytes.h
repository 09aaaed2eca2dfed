// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Undo and redo that outlive a sitting: handed to the next one, and kept in its session, so that a replay finds them.

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/record/history/history.h"

namespace handpiece::simulation {

/// The strokes before a sitting: as it takes them, and as its session keeps them.
struct KeptHistory {
    std::shared_ptr<const history::History> steps;  ///< null: none
    std::vector<std::byte> bytes;
};
/// Of a tooth in the state `now`. At most session::kMaxHistoryBytes: of more the oldest strokes are left out. A tenth
/// of a second: not for a thread that must not wait.
[[nodiscard]] KeptHistory keepHistory(const history::History& history, const tooth::StateDelta& now,
                                      const SimulationSetup& station);
/// From the bytes of a session that began in the state `now`. Throws core::Error, naming `where`, for what is damaged
/// or of another tooth.
[[nodiscard]] history::History decodeHistory(std::span<const std::byte> bytes, const tooth::StateDelta& now,
                                             const SimulationSetup& station, const std::string& where);

}  // namespace handpiece::simulation
