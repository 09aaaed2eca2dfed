// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the window was built with, as packaging/prepare.cpp writes it.

#include "handpiece/base/prepared/prepared_files.h"

namespace handpiece::prepared {

/// The files that this program believes; none where it was built without (HANDPIECE_PREPARED).
[[nodiscard]] std::span<const Believed> list();

}  // namespace handpiece::prepared
