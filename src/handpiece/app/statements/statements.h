// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a person has done, as statements for a learning record store: xAPI 1.0.3 (IEEE 9274.1.1).
/// docs/formats/statements.md.

#include <span>
#include <string>
#include <vector>

#include "handpiece/school/store/store.h"

namespace handpiece::statements {

/// Whose statements these are, and by whose names.
struct Actor {
    std::string homePage;  ///< http(s) address of who gives out the codes; activities are named under it
    std::string code;      ///< of the person there: a code, never a name or an e-mail address
};

/// One attempt, with the exercise's title where it is known, and what was given back of it.
struct Work {
    school::Attempt attempt;
    std::string title{};
    std::vector<school::Returned> returned{};
    bool tellsMarkers = true;  ///< who gave it back
};

/// A JSON array, UTF-8: of each attempt one statement "completed", and one "scored" of each marker who gave it back.
/// The same input, the same bytes; an attempt's statement has its own id for ever, that of marks changes with them.
/// `success` is told where the score passed; that somebody failed is a teacher's to tell.
/// Throws core::Error for a home page or code that cannot be one, and for an attempt or marks that are damaged.
[[nodiscard]] std::string statementsOf(std::span<const Work> works, const Actor& actor);

/// "2026-11-26T15:08:18.123Z"
[[nodiscard]] std::string timestamp(school::Milliseconds since1970);

}  // namespace handpiece::statements
