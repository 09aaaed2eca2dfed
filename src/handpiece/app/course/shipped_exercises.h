// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The exercises that come with the program: made by it, from its own teeth, blocks and rubrics. And what a folder
/// holds.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/assess/task/task.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::course {

/// A figure in a block: "line", "cross", ...; the higher the level (1 to 3), the less may go beside it. `layers`: of
/// starter::kBlockLayers. The leeway is a judgement of the project. Throws core::Error for a kind that is none.
[[nodiscard]] tasks::Task blockTask(const std::string& kind, int level, const std::string& layers = "hard");

struct Shipped {
    std::string id;
    cases::Texts title;
};
/// Blocks first, then teeth, in the order in which they are to be done.
[[nodiscard]] const std::vector<Shipped>& shippedExercises();
/// In its own folder below `folder`, where it is made the first time: a tooth takes seconds. Throws core::Error.
[[nodiscard]] std::filesystem::path shippedExercise(const std::string& id, const std::filesystem::path& folder,
                                                    const core::Progress& progress = {});

/// One of a folder, or what is wrong with it.
struct Found {
    std::filesystem::path path;
    std::optional<tasks::Task> task;
    std::optional<core::Error> error;
};
/// Folders and .handpiece files that are exercises, by name; one bad file hides no other. Throws core::Error where
/// there is no such folder.
[[nodiscard]] std::vector<Found> exercisesIn(const std::filesystem::path& folder, const core::Progress& progress = {});

}  // namespace handpiece::course
