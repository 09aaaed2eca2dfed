// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Words in the pixels themselves, which no program loses. Private to this room.

#include <string_view>

#include "handpiece/senses/radiograph/radiograph.h"

namespace handpiece::radiograph {

/// White capitals on black in the lower left corner; what does not fit is left out from the end.
void burn(Picture& picture, std::string_view text);

}  // namespace handpiece::radiograph
