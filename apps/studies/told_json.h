// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What commands tell as JSON, under the same names wherever it is told: docs/cli.md.

#include <nlohmann/json_fwd.hpp>

#include "handpiece/app/simulation/session_player.h"
#include "handpiece/base/geometry/repair.h"

namespace handpiece::studies {

/// `mesh info --json`, `mesh repair --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const geometry::MeshReport& report);
[[nodiscard]] nlohmann::ordered_json toJson(const geometry::RepairReport& report);
/// `replay --json`, of a player that has come to the end.
[[nodiscard]] nlohmann::ordered_json toJson(const simulation::Verdict& verdict,
                                            const simulation::SessionPlayer& player);

}  // namespace handpiece::studies
