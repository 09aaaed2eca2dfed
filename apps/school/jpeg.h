// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Whether bytes from outside are a JPEG picture, by its header: nothing is decoded here.

#include <optional>
#include <string_view>

namespace handpiece::school_server {

struct PictureSize {
    int width = 0, height = 0;
};
/// Of one whole JPEG file (ISO/IEC 10918-1: baseline, extended or progressive; 8 bits; grey or three colours) whose
/// segments follow each other from its first byte to its scan, and which ends as one. None: it is no such file.
[[nodiscard]] std::optional<PictureSize> jpegSize(std::string_view bytes);

}  // namespace handpiece::school_server
