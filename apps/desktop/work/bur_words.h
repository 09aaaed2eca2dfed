// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Burs and drives by the names that people use.

#include <QString>

namespace handpiece::desktop {

/// "Round 1/4" for "round-1/4", in the window's language; names that begin with a digit stay.
[[nodiscard]] QString burTitle(const QString& name);
/// "Low speed" for "low-speed".
[[nodiscard]] QString driveTitle(const QString& name);

}  // namespace handpiece::desktop
