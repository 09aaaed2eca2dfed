// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Many pieces of work under one rubric: old ones under a new one, or a class's.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/app/assessment/measure_store.h"
#include "handpiece/app/assessment/score_work.h"

namespace handpiece::assessment {

/// What findWork() finds and can be scored. Throws core::Error where there is none.
[[nodiscard]] std::vector<std::filesystem::path> worksIn(const std::filesystem::path& folder);

/// One piece of work: a result, or why there is none.
struct Rescored {
    std::filesystem::path work;
    std::optional<Result> result;
    std::string problem;
    bool isKept = false;  ///< all of it was measured before
};

/// Each by itself, side by side on all cores; one that cannot be scored says why and stops no other. What is in the
/// store is not measured again, and what is not goes into it. No `task`: each is held against its own case, uncut,
/// without a preparation, so that measures of zones have no value. Throws core::Error when cancelled, and for a rubric
/// that is not sound.
[[nodiscard]] std::vector<Rescored> rescore(std::span<const std::filesystem::path> works,
                                            const std::optional<tasks::Task>& task, const rubric::Rubric& rubric,
                                            const MeasureStore& store, const core::Progress& progress = {});

/// Below the folder that all lie in, with '/'.
[[nodiscard]] std::string nameOf(const std::filesystem::path& work, std::span<const Rescored> all);
/// A line each, with a head; docs/cli.md#rescore.
[[nodiscard]] std::string rescoredCsv(std::span<const Rescored> all, const rubric::Rubric& rubric);
/// A list of results as resultJson() has them, each with `work`, or `work` and `error`.
[[nodiscard]] std::string rescoredJson(std::span<const Rescored> all);

}  // namespace handpiece::assessment
