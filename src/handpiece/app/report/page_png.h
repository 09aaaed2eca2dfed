// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Drawn pictures as small files for a page. Private to this room.

#include <cstddef>
#include <vector>

#include "handpiece/senses/view/image.h"

namespace handpiece::report {

/// A PNG file's bytes, of six bits a channel: nobody sees the others, and without them it is half as large.
[[nodiscard]] std::vector<std::byte> pagePng(view::Image image);

}  // namespace handpiece::report
