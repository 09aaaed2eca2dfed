// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A result and a rubric as JSON, for other programs. docs/formats/rubric.md#the-result.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/app/report/assessment_report.h"
#include "handpiece/assess/score/score.h"

namespace handpiece::assessment {

/// The schema's name, in `schema` of a result.
inline constexpr const char* kResultSchema = "handpiece-result-1";

[[nodiscard]] std::string resultJson(const score::Assessment& assessment, const score::Identity& of);
/// What a result.json holds; `proof` is not in it. Throws core::Error naming `where` and what is missing or of the
/// wrong type: another schema, hostile sizes.
[[nodiscard]] score::Result parseResult(std::string_view json, const std::string& where);
inline constexpr std::uint64_t kMaxResultBytes = 4u << 20;
/// The results of a class: every .json under FOLDER/CODE/, in the order of their paths (numbers by their value), is an
/// attempt of the student CODE; FOLDER/CODE.json is a single one. Throws core::Error for a folder with no result and
/// for the first file that is none.
[[nodiscard]] std::vector<report::ClassEntry> readClass(const std::filesystem::path& folder);
[[nodiscard]] std::string rubricJson(const rubric::Rubric& rubric);

}  // namespace handpiece::assessment
