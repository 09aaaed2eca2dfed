// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a teacher adds to a case: the task, and what is given and withheld.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/vec.h"

namespace handpiece::cases {

/// A text by language tag ("en", "pt-BR").
using Texts = std::map<std::string, std::string>;
/// In this language, else in its base language ("pt" for "pt-BR"), else in English, else in any; empty without texts.
[[nodiscard]] std::string_view inLanguage(const Texts& texts, std::string_view language);

/// Where one looks from, tooth frame.
struct View {
    core::Vec3 eyeMm = core::Vec3::Zero(), targetMm = core::Vec3::Zero();
    core::Vec3 up = core::Vec3::UnitZ();
};

/// Helps that a teacher can lock; what each takes away: docs/case-format.md.
inline constexpr std::array<std::string_view, 14> kHelps = {
    "undo",  "reset",  "depth",     "tissue-colours", "cross-section", "transparency", "guide",
    "score", "mirror", "scale-bar", "chart",          "calliper",      "compare",      "direct-view"};

/// `[exercise]` of case.toml.
struct Exercise {
    Texts title, instructions;
    std::string bur;                       ///< to start with; empty: the student's choice
    std::vector<std::string> allowedBurs;  ///< empty: all
    std::vector<std::string> lockedHelps;  ///< of kHelps
    std::optional<View> view;              ///< to start with
};

/// `[exercise]` of case.toml as text, and back. Throws core::Error naming `where`.
[[nodiscard]] std::string exerciseText(const Exercise& exercise);
[[nodiscard]] Exercise parseExercise(std::string_view text, const std::string& where);

}  // namespace handpiece::cases
