// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Parts of a criterion as the short text of a table's cell, and back.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/assess/rubric/rubric.h"

namespace handpiece::draft {

/// "1: 0, 1.5: 100": value and points.
[[nodiscard]] std::string knotsCell(const rubric::Criterion& criterion);
/// "ideal 1.5..2; unacceptable 2..": where points are given, "= 60" after it.
[[nodiscard]] std::string bandsCell(const rubric::Criterion& criterion);
/// "< 0.5, > 2.5"
[[nodiscard]] std::string criticalCell(const rubric::Criterion& criterion);
/// "side mesial, statistic median": what narrows the measure down.
[[nodiscard]] std::string selectionCell(const rubric::Criterion& criterion);

/// "a, b"
[[nodiscard]] std::string namesCell(const std::vector<std::string>& names);
/// "unacceptable most 0; modify of depth, outline most 2; rule other": what a rule needs.
[[nodiscard]] std::string needsCell(const rubric::Rule& rule);

[[nodiscard]] std::vector<std::string> readNames(std::string_view text);
/// Throws core::Error with an example, and leaves the rule as it was.
void readNeeds(rubric::Rule& rule, std::string_view text);
/// An empty text: none. Throws core::Error alike.
[[nodiscard]] std::optional<double> readNumber(std::string_view text);

/// Each puts what the text says in the place of what was there; an empty text takes it away. Throws core::Error with an
/// example for a text that is no such, and leaves the criterion as it was.
void readKnots(rubric::Criterion& criterion, std::string_view text);
void readBands(rubric::Criterion& criterion, std::string_view text);
void readCritical(rubric::Criterion& criterion, std::string_view text);
void readSelection(rubric::Criterion& criterion, std::string_view text);

}  // namespace handpiece::draft
