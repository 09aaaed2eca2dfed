// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the editor speaks of in the person's language: preparations, their numbers, measures, what is wrong.

#include <QString>
#include <string_view>

#include "handpiece/assess/draft/draft.h"

namespace handpiece::desktop {

/// "class-one" -> "Class I cavity"; a template without words: its id.
[[nodiscard]] QString templateWords(std::string_view id);
/// "depth_mm" -> "Depth"; a number without words: its name.
[[nodiscard]] QString parameterWords(std::string_view name);
/// Of a number's name: "mm", "deg" -> "°".
[[nodiscard]] QString parameterUnit(std::string_view name);

/// "floor-depth" -> "depth of the floor"
[[nodiscard]] QString measureWords(std::string_view id);
[[nodiscard]] QString statusWords(rubric::Status status);
/// "critical error of depth"
[[nodiscard]] QString textPlaceWords(const draft::TextPlace& place);
/// What is wrong and what to do; of a rubric also with what it is about.
[[nodiscard]] QString problemWords(const draft::Problem& problem, bool withAbout = true);

}  // namespace handpiece::desktop
