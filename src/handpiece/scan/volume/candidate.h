// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the readers of the formats hand to readScan: a series that can be read, not read yet.

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/scan/volume/files.h"
#include "handpiece/scan/volume/read_scan.h"

namespace handpiece::volume {

using Files = std::shared_ptr<const FileSet>;

/// Where slice `k` goes; asked for in order, right before it is written: what was asked for before is whole by then.
using SlicePlace = std::function<float*(int k)>;

struct Candidate {
    Series series;  ///< without id, size, spacing and thumbnail: those come from the grid
    Grid grid;      ///< may be left-handed; slices are turned round once they are read
    /// From one slice to the next [mm], where that is not along the normal (a tilted gantry); else zero.
    core::Vec3 stepMm = core::Vec3::Zero();
    bool isResampled = false;            ///< its slices are made of those of the files
    std::string where;                   ///< file or folder, for messages
    std::string spacingProblem;          ///< why the spacing is not known
    std::string sideProblem;             ///< why nobody can tell it from its mirror image; empty: it is told
    std::optional<core::Error> problem;  ///< why it cannot be read, though it can be shown
    /// One slice, from several threads at once.
    std::function<void(int k, float* to)> slice;
    /// `count` of them from `first` on, where that is faster than one by one; may be empty.
    std::function<void(int first, int count, const SlicePlace& place, const core::Progress& progress)> load;
};

/// What is in the files; problems of files that others make up for become notes. Throws core::Error when nothing fits.
[[nodiscard]] std::vector<Candidate> findCandidates(const Files& files, const core::Progress& progress);
/// Reads it; `settings.series` is not looked at.
[[nodiscard]] Scan load(const Candidate& candidate, const ReadSettings& settings, const core::Progress& progress);

/// A file that looked right and is not.
using Failures = std::vector<core::Error>;

[[nodiscard]] std::vector<Candidate> findDicom(const Files& files, const std::vector<std::size_t>& which,
                                               Failures& failures, const core::Progress& progress);
/// Of a DICOMDIR: the files it lists; `missing` counts those that are not there.
[[nodiscard]] std::vector<std::size_t> listedFiles(const FileSet& files, std::size_t dicomdir, int& missing);
/// BMP, JPEG, PNG and TIFF.
[[nodiscard]] std::vector<Candidate> findSlices(const Files& files, const std::vector<std::size_t>& which,
                                                Failures& failures, const core::Progress& progress);
[[nodiscard]] Candidate openNrrd(const Files& files, std::size_t index);
[[nodiscard]] Candidate openMetaImage(const Files& files, std::size_t index);
[[nodiscard]] Candidate openNifti(const Files& files, std::size_t index);
/// By its description (scan.toml).
[[nodiscard]] Candidate openRaw(const Files& files, std::size_t description);

/// True for spacings a scanner can have.
[[nodiscard]] bool isSpacing(double mm);
/// Sets grid.spacingMm where all three can be, else the reason why not.
void setSpacing(Candidate& candidate, const core::Vec3& spacingMm);
/// Sets axes, spacing and step from the three vectors from a voxel to its neighbours; throws core::Error where the
/// rows and columns are not at right angles.
void setVectors(Candidate& candidate, const core::Mat3& neighboursMm);

/// What scan.toml says beside slices or about raw numbers.
struct Description {
    std::string file, type;
    std::array<int, 3> size{};
    bool isBigEndian = false;
    std::uint64_t headerBytes = 0;
    std::optional<core::Vec3> spacingMm, originMm;
    std::optional<core::Mat3> axes;
    double slope = 1, intercept = 0;
    std::string where;
};
[[nodiscard]] Description readDescription(const FileSet& files, std::size_t index);
void apply(const Description& description, Candidate& candidate);

}  // namespace handpiece::volume
