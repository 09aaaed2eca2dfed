// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a school sets for all of its people: read by command line and window, below the user's own settings.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace handpiece::exercise {

/// What /etc/handpiece/settings.toml says. What it does not say is nothing: the program's own default holds.
/// docs/settings.md has every key.
struct SchoolDefaults {
    std::filesystem::path file;         ///< that was read; empty when there is none
    std::vector<std::string> problems;  ///< one sentence each, with file and line; what they are about is left out

    std::optional<std::string> language;  ///< "en", "ja"
    std::optional<std::string> layout;    ///< "practice", "laboratory", "paper"
    std::optional<bool> leftHanded;
    std::optional<std::string> device;                                 ///< a name of `handpiece device list`
    std::optional<double> scale;                                       ///< hand's motion to bur's: 1, 2 or 3
    std::optional<bool> crisp;                                         ///< knock and hum
    std::optional<double> voxelUm;                                     ///< 20 to 400
    std::optional<double> pulpGoodMm, pulpLeastMm;                     ///< limits of the lamp over the pulp
    std::optional<std::filesystem::path> sessionsFolder, casesFolder;  ///< absolute
    std::optional<bool> record;                                        ///< keep a session of each sitting
    std::optional<bool> sound;                                         ///< false: muted
    std::optional<double> volume;                                      ///< 0 to 1
};

/// Of the machine: /etc/handpiece/settings.toml, or what HANDPIECE_SCHOOL_SETTINGS names (empty: none). Never throws.
[[nodiscard]] SchoolDefaults schoolDefaults();
/// Of a file. No file is no problem; one that cannot be read is one. Never throws.
[[nodiscard]] SchoolDefaults readSchoolDefaults(const std::filesystem::path& file);

}  // namespace handpiece::exercise
