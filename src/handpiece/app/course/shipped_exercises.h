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

/// What can be told of an exercise that comes along without making it.
struct Shipped {
    std::string id;
    int number = 0;                  ///< 1 to 10 of the ten first exercises; 0: a further block
    int fdi = 0;                     ///< 0: a block
    bool hasNeighbours = false;      ///< stands in its arch, with gingiva
    std::string level, preparation;  ///< of tasks::kLevels; of preparation::templates()
    double minutes = 0.0;
    std::string drive;         ///< in hand at the beginning
    cases::Exercise exercise;  ///< title, instructions, burs, locks
};
/// The ten first exercises in their order, then further blocks.
[[nodiscard]] const std::vector<Shipped>& shippedExercises();
/// Throws core::Error for an id that none has.
[[nodiscard]] const Shipped& shippedExercise(const std::string& id);

/// Faces of a tooth that is worked on.
inline constexpr std::size_t kExerciseFaces = 40656;
struct Made {
    std::filesystem::path path;
    tasks::Task task;  ///< as its files hold it
};
/// In a folder of its own below `folder`, with the teeth that it is of; what is there and whole is used. A tooth takes
/// seconds, the mouth of some (once for all of them) a minute or two. Whole or not at all: cancelled, it leaves nothing
/// but finished teeth. The same bytes everywhere. Throws core::Error.
[[nodiscard]] Made makeShipped(const std::string& id, const std::filesystem::path& folder,
                               const core::Progress& progress = {}, std::size_t faces = kExerciseFaces);

/// What is named: an exercise's folder or .handpiece file, or the id of one that comes along, which is made in the
/// user's cache folder. Throws core::Error.
[[nodiscard]] Made openExercise(const std::string& pathOrId, const core::Progress& progress = {});

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
