// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A window's line to the service that holds this station's exams: lines of JSON in and out. docs/school-exams.md has
/// them.

#include <filesystem>

namespace handpiece::school_cli {

struct ExamLineSettings {
    std::filesystem::path socket;
    double everyS = 30.0;  ///< between two words of how far the recordings are
};
/// Until the input ends, and with it this program.
[[noreturn]] void runExamLine(const ExamLineSettings& settings);

}  // namespace handpiece::school_cli
