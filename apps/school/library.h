// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Exercises of a school's books.

#include <filesystem>
#include <string>

#include "handpiece/school/store/books.h"

namespace handpiece::school_server {

/// The most that an exercise's file may have [bytes]; those that come with the program have some 10 MB.
inline constexpr std::size_t kMostExercise = 64u << 20;

struct AddedExercise {
    std::string id, hash, rubric;
};
/// An exercise's folder or file into the books, with its rubric, which must be sound. Throws core::Error.
AddedExercise addExercise(school::Books& books, const std::filesystem::path& file, const school::Act& act);

}  // namespace handpiece::school_server
