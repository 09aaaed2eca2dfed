// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an exercise withholds, in the person's language.

#include <QString>
#include <string_view>

#include "handpiece/app/exercise/permissions.h"

namespace handpiece::desktop {

/// What a lock of cases::kHelps takes away, for a list.
[[nodiscard]] QString lockWords(std::string_view help);
/// What was asked for and is locked, for one sentence.
[[nodiscard]] QString operationWords(exercise::Operation operation);

}  // namespace handpiece::desktop
