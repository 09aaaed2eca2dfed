// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What belongs to a school is a program of its own.

namespace handpiece::cli {

[[nodiscard]] bool isForSchool(int argc, const char* const* argv);
/// Becomes that program; returns an exit code where it is not there.
int runSchoolProgram(int argc, const char* const* argv);

}  // namespace handpiece::cli
