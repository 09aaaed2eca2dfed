// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Preparations and their numbers in the person's language.

#include <QString>
#include <string_view>

namespace handpiece::desktop {

/// "class-one" -> "Class I cavity"; a template without words: its id.
[[nodiscard]] QString templateWords(std::string_view id);
/// "depth_mm" -> "Depth"; a number without words: its name.
[[nodiscard]] QString parameterWords(std::string_view name);
/// Of a number's name: "mm", "deg" -> "°".
[[nodiscard]] QString parameterUnit(std::string_view name);

}  // namespace handpiece::desktop
