// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an exercise may lock, in the person's language.

#include <QString>
#include <optional>
#include <string_view>

#include "handpiece/app/exercise/permissions.h"

namespace handpiece::desktop {

/// In the order of cases::kHelps.
enum class Help {
    undo,
    reset,
    depth,
    tissueColours,
    crossSection,
    transparency,
    guide,
    score,
    mirror,
    scaleBar,
    chart,
    calliper,
    compare,
    directView
};
static_assert(static_cast<std::size_t>(Help::directView) + 1 == cases::kHelps.size());

/// By its name in a case.
[[nodiscard]] std::optional<Help> helpOf(std::string_view name);
/// What its lock takes away, for a list.
[[nodiscard]] QString helpWords(Help help);
/// What was asked for and is locked, for one sentence.
[[nodiscard]] QString operationWords(exercise::Operation operation);

}  // namespace handpiece::desktop
