// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What an exercise withholds, in the person's language.

#include <QString>
#include <string_view>

#include "station/permissions.h"

namespace handpiece::desktop {

/// What a lock of tooth::kHelps takes away, for a list.
[[nodiscard]] QString lockWords(std::string_view help);
/// What was asked for and is locked, for one sentence.
[[nodiscard]] QString operationWords(station::Operation operation);

}  // namespace handpiece::desktop
