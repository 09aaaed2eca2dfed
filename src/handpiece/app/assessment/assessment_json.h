// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A result and a rubric as JSON, for other programs. docs/formats/rubric.md#the-result.

#include <string>

#include "handpiece/assess/score/score.h"

namespace handpiece::assessment {

/// The schema's name, in `schema` of a result.
inline constexpr const char* kResultSchema = "handpiece-result-1";

[[nodiscard]] std::string resultJson(const score::Assessment& assessment, const score::Identity& of);
[[nodiscard]] std::string rubricJson(const rubric::Rubric& rubric);

}  // namespace handpiece::assessment
