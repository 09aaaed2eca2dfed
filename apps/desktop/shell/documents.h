// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// From a file's name, or a starter tooth's, to a tooth ready to be cut. No widgets, any thread.

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/model/tooth/attempt.h"
#include "handpiece/model/tooth/tooth.h"
#include "station/history_bytes.h"
#include "station/live_tooth.h"
#include "station/station.h"

namespace handpiece::desktop {

/// A starter tooth at one of the five resolutions of the paper's Table II.
struct Starter {
    starter::ToothKind kind = starter::ToothKind::lowerFirstMolar;
    std::size_t faces = 68151;
    friend bool operator==(const Starter&, const Starter&) = default;
};
struct Resolution {
    int percent;
    std::size_t faces;
};
inline constexpr std::array<Resolution, 5> kResolutions{
    {{6, 9760}, {12, 19516}, {25, 40656}, {50, 68151}, {100, 325312}}};

/// What a file is, told by its name and content.
enum class FileKind { unknown, toothCase, attempt, mesh, session };
[[nodiscard]] FileKind fileKindOf(const std::filesystem::path& path);

/// What is open.
struct Document {
    std::filesystem::path caseFile;     ///< of the tooth; of a starter tooth its place in the cache
    std::filesystem::path attemptFile;  ///< where it was saved or read; empty: nowhere yet
    std::optional<Starter> starter;
    std::string name;  ///< for the title: the file's, or the tooth's
};

/// What to open, and with what in hand.
struct LoadRequest {
    std::filesystem::path path;  ///< case, attempt or mesh; a session to be recovered from
    std::optional<Starter> starter;
    bool recover = false;
    Document recovered;  ///< with `recover`: what its marker says
    std::filesystem::path starterFolder;
    std::string bur = "330", drive = "turbine";
    double speedRpm = 0.0;  ///< 0: the drive's own
    station::StationSettings settings;
    bool useCache = true;
};
struct LoadedTooth {
    Document document;
    std::shared_ptr<const tooth::Case> toothCase;
    station::Station station;
    std::shared_ptr<station::LiveTooth> liveTooth;
    tooth::CutState state;  ///< that it was resumed with
    station::KeptHistory history;
    double elapsedS = 0.0;
    std::string bur, drive, code;
    double speedRpm = 0.0;
    std::string missingBur;  ///< the bur an attempt was cut with, when it cannot be had: another is in hand
};
/// Seconds, the first time; a tooth whose cache stands within one. Throws core::Error.
[[nodiscard]] LoadedTooth loadTooth(const LoadRequest& request, const core::Progress& progress);

/// The case of a starter tooth, out of its folder in the cache; made and put there the first time.
[[nodiscard]] tooth::Case starterCase(const Starter& starter, const std::filesystem::path& folder,
                                      const core::Progress& progress);

/// The drive by name, its free speed set to `speedRpm` (0: its own; never more than that).
[[nodiscard]] instrument::Drive driveAt(const std::string& name, double speedRpm);

/// What is left of the tooth as one closed STL.
void exportStl(const std::shared_ptr<const tooth::CuttableTooth>& base, const tooth::CutState& state,
               const std::filesystem::path& file, const core::Progress& progress);

}  // namespace handpiece::desktop
