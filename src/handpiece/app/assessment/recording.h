// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The sessions that a piece of work is made of, and what they tell: of the hand, and of when something was cut.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "handpiece/assess/hand/hand.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/core/progress.h"

namespace handpiece::assessment {

/// A session as a file that can be read, wherever it came from.
struct Recording {
    std::filesystem::path path;
    std::string name;                                    ///< as people know it
    std::string hash;                                    ///< of the file
    std::shared_ptr<const core::PrivateFolder> keeps{};  ///< the folder that `path` lies in, where it was unpacked
    /// The last tick that belongs to the work: it was saved there, and what followed was given up. None: all of it
    /// does.
    std::optional<std::uint64_t> untilTick{};
};

/// Of a chain of sessions, in the order of the work, read once, by stretches: memory does not grow with them. Gives
/// places of the tooth their time and load, those at which the bur, cutting, lay there last, to within half a voxel (a
/// place that no bur reached keeps none), and returns what is asked of the hand. Throws core::Error for what is damaged
/// or not asked rightly.
[[nodiscard]] std::vector<measures::Measured> readRecord(std::span<const Recording> chain,
                                                         std::span<measures::Measured> ofTooth, double voxelMm,
                                                         std::span<const measures::Request> ofHand,
                                                         const hand::Against& against,
                                                         const core::Progress& progress = {});

}  // namespace handpiece::assessment
