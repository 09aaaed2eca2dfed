// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a person has done goes to a learning record store (xAPI 1.0.3), now or a month later: from where it was, each
/// statement once by its id. docs/formats/statements.md.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "handpiece/app/statements/statements.h"

namespace handpiece::school_station {

struct RecordStore {
    std::string address{};           ///< of its xAPI: https://lrs.example/xapi
    std::string user{}, password{};  ///< HTTP Basic; empty: none
};
struct PushedStatements {
    std::size_t sent = 0;   ///< that it took
    std::size_t there = 0;  ///< that it had already
};
/// All that waits in the outbox, oldest first. `progress`: a file that says how far each record store has it, written
/// after each piece that one has. Throws core::Error: "platform-silent", "platform-address", "statements-refused" (what
/// it answers); what went before then is there.
PushedStatements pushStatements(const school::Store& store, const statements::Actor& actor, const RecordStore& to,
                                const std::filesystem::path& progress);

}  // namespace handpiece::school_station
