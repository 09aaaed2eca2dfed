// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Teeth and mouths that the program makes, kept in a folder: made once, which takes seconds to minutes.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/dentition/tooth_form.h"

namespace handpiece::course {

/// What happens on the way, where somebody wants to hear of it.
struct KeptListener {
    /// There is none: it is made.
    std::function<void()> making;
    /// What was kept at `place` is damaged or not what its name says: it is made anew.
    std::function<void(const std::filesystem::path& place)> renewed;
    /// What was made cannot be kept at `place`: a full disk, a folder that is read only.
    std::function<void(const std::filesystem::path& place, const core::Error& why)> notKept;
};

/// Faces of each tooth around one that is worked on, which are seen and felt at arm's length.
inline constexpr std::size_t kMouthFaces = 8000;

/// Of the program and of the teeth that it makes, in the names of all that is kept.
[[nodiscard]] std::string keptRevision();
/// Where the tooth lies in `folder`. The program's version stands in the name, and the teeth's revision: a later one
/// may make other teeth of the same rules.
[[nodiscard]] std::filesystem::path keptToothPlace(int fdi, const dentition::Patient& patient, std::size_t faces,
                                                   const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path keptMouthPlace(const dentition::Patient& patient,
                                                   const std::filesystem::path& folder);
/// The tooth alone, as its files hold it, also where it cannot be kept. Whole or not at all. Throws core::Error,
/// "cancelled" too.
[[nodiscard]] cases::Case keptTooth(int fdi, const dentition::Patient& patient, std::size_t faces,
                                    const std::filesystem::path& folder, const core::Progress& progress = {},
                                    const KeptListener& listener = {});
/// The patient's mouth, teeth of kMouthFaces, worked on at `fdi`; else as keptTooth().
[[nodiscard]] cases::Case keptMouth(int fdi, const dentition::Patient& patient, const std::filesystem::path& folder,
                                    const core::Progress& progress = {}, const KeptListener& listener = {});

}  // namespace handpiece::course
