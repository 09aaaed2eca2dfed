// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the numbers of a label volume mean: the tissues of one tooth, or the teeth of a mouth; and one tooth out of it.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/scan/segmentation/segment.h"
#include "handpiece/scan/volume/read_scan.h"
#include "handpiece/scan/volume/volume.h"

namespace handpiece::segmentation {

/// How numbers are to be read. `fdi`: 11 to 48 and 51 to 85 are teeth, 100 more their pulp, and below 11 the jaws and
/// what ToothFairy's data sets have there; `universal`: 1 to 32 from the upper right third molar to the lower right
/// one; `consecutive`: as TotalSegmentator's task "teeth" writes them, 11 to 42 without gaps.
enum class LabelNumbers { tissues, fdi, universal, consecutive };
inline constexpr std::array<std::string_view, 4> kLabelNumbers{"tissues", "fdi", "universal", "consecutive"};
/// Throws core::Error naming those there are.
[[nodiscard]] LabelNumbers labelNumbersByName(std::string_view name);

struct LabelMeaning {
    enum class What : std::uint8_t { unknown, tissue, tooth, pulp, upperBone, lowerBone, gum, prosthesis, notShown };
    What what = What::unknown;
    int number = 0;  ///< of a tissue as volume::Labels has them, of a tooth or pulp by FDI
};

struct LabelKey {
    bool isMouth = false;  ///< some are teeth by their numbers; else all are tissues
    std::array<LabelMeaning, 256> of{};
    std::vector<std::string> notes;  ///< how it was told, and what is left out
};
/// By the names in the file, else by the numbers. Throws core::Error where neither decides, or where teeth are in it
/// that are not told apart. `asked` wins over both.
[[nodiscard]] LabelKey labelKeyOf(const volume::Labels& labels, const std::vector<volume::LabelName>& names,
                                  std::optional<LabelNumbers> asked, const std::string& where);
/// Whether grey values are none, but labels with teeth by their numbers or names: a scan has all numbers between.
[[nodiscard]] bool looksLikeMouth(const volume::Volume& volume, const std::vector<volume::LabelName>& names);
/// How many whole numbers a volume holds that can hardly be grey values: labels of which nobody said that they are
/// some; with names of labels beside them they are never grey values. 0: they can be.
[[nodiscard]] int unsaidLabels(const volume::Volume& volume, const std::vector<volume::LabelName>& names);

/// A tooth that labels tell.
struct LabelledTooth {
    int fdi = 0;
    std::array<int, 3> low{}, high{};  ///< voxels
    std::size_t voxels = 0;
    double volumeMm3 = 0;
    bool hasPulp = false;
    bool isCutOff = false;  ///< by the volume's border
};
/// By FDI number. What is no more than a speck is in it too.
[[nodiscard]] std::vector<LabelledTooth> teethOf(const volume::Labels& labels, const LabelKey& key);
inline constexpr double kLeastToothMm3 = 10.0;
inline constexpr std::size_t kLeastToothVoxels = 60;
[[nodiscard]] inline bool isSpeck(const LabelledTooth& tooth) {
    return tooth.volumeMm3 < kLeastToothMm3 || tooth.voxels < kLeastToothVoxels;
}

/// The tissue numbers of one tooth, for segmentLabels(): 2 its hard tissues as one, 4 its pulp. The largest piece.
struct ToothAlone {
    int fdi = 0;
    volume::Labels labels;    ///< around it; slices that lie far apart are filled in between
    std::size_t pieces = 1;   ///< that there were
    double leftOutMm3 = 0.0;  ///< of the smaller ones
    bool isFilledIn = false;  ///< between slices
};
[[nodiscard]] ToothAlone alone(const volume::Labels& labels, const LabelKey& key, const LabelledTooth& tooth);

/// The tissues of one of these teeth in the scan that the labels are of, as segment() finds them, within the tooth's
/// label: where it ends and what it touches the label says, and grey values only move that surface by a part of a
/// voxel. The two need the same frame, not the same grid. `levels`: as findThresholds() gives for the scan.
[[nodiscard]] Region segmentWithin(const volume::Volume& scan, const Thresholds& levels, const volume::Labels& labels,
                                   const LabelKey& key, const ToothAlone& own, const Settings& settings = {},
                                   const core::Progress& progress = {});

}  // namespace handpiece::segmentation
