// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What `handpiece make tooth` makes, for it and for other programs.

#include <span>
#include <string>

#include "handpiece/model/dentition/tooth_form.h"
#include "handpiece/model/lesion/lesion.h"
#include "handpiece/model/starter/starter.h"

namespace handpiece::studies {

struct ToothRequest {
    std::string kind = "lower-first-molar";  ///< of the starter's teeth
    int fdi = 0;                             ///< instead of a kind: a permanent tooth, without a scene
    dentition::Patient patient{};            ///< with `fdi`
    starter::ToothOptions options{};
};
/// Throws core::Error as starter::makeTooth and dentition::makeTooth do.
[[nodiscard]] cases::Case makeTooth(const ToothRequest& request, const core::Progress& progress = {});
/// In place of the lesion that a starter tooth comes with; with none given it stays. Throws core::Error as
/// lesion::addLesions does.
void replaceLesions(cases::Case& tooth, std::span<const lesion::Lesion> lesions, std::uint64_t seed,
                    const core::Progress& progress = {});

}  // namespace handpiece::studies
