// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/page_png.h"

#include <algorithm>

namespace handpiece::report {

std::vector<std::byte> pagePng(view::Image image) {
    // The upper bits again below: white stays white, black black.
    std::transform(image.rgba.begin(), image.rgba.end(), image.rgba.begin(),
                   [](std::uint8_t value) { return static_cast<std::uint8_t>((value & 0xfc) | value >> 6); });
    return view::pngOf(image);
}

}  // namespace handpiece::report
