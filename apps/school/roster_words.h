// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a list of people changes, in the program's language.

#include <string>

#include "handpiece/school/store/books_roster.h"

namespace handpiece::school_server {

/// One line.
[[nodiscard]] std::string inWords(const school::RosterChange& change);
/// "2026-11-27", UTC.
[[nodiscard]] std::string today(school::Milliseconds now);
/// Of a person who comes with another system's id: six letters and digits by chance, which can be typed.
[[nodiscard]] std::string newPersonCode();

}  // namespace handpiece::school_server
