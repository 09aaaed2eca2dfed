// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How far somebody came at an exercise, as the list of exercises tells it.

#include <QString>
#include <optional>
#include <vector>

#include "handpiece/school/store/store.h"

namespace handpiece::desktop {

/// At one exercise, of the attempts that can be compared with the latest.
struct Reached {
    std::optional<double> bestPercent;  ///< none: of none could all be measured
    bool isPassed = false;              ///< by any of them
    int attempts = 0;
};
/// In the order in which they were made; none: it was never finished.
[[nodiscard]] std::optional<Reached> reachedIn(const std::vector<school::Attempt>& attempts);

/// In the list: "✓ Exercise 4: 46, class I (82 %)".
[[nodiscard]] QString entryWords(const QString& title, const std::optional<Reached>& reached, bool isDue);
/// "Best so far: 82 % in 3 attempts".
[[nodiscard]] QString bestWords(const Reached& reached);

}  // namespace handpiece::desktop
