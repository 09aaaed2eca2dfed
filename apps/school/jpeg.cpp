// SPDX-License-Identifier: Apache-2.0
#include "school/jpeg.h"

namespace handpiece::school_server {
namespace {

constexpr std::string_view kBegin = "\xFF\xD8", kEnd = "\xFF\xD9";
constexpr unsigned kStartOfScan = 0xDA, kBaseline = 0xC0, kProgressive = 0xC2, kOtherFrames = 0xCF, kHuffman = 0xC4,
                   kArithmetic = 0xCC;

}  // namespace

std::optional<PictureSize> jpegSize(std::string_view bytes) {
    const auto at = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(bytes[i])); };
    if (!bytes.starts_with(kBegin) || !bytes.ends_with(kEnd)) return {};
    std::optional<PictureSize> size;
    for (std::size_t from = kBegin.size(); from + 4 <= bytes.size();) {
        if (at(from) != 0xFF) return {};
        const unsigned marker = at(from + 1);
        if (marker == 0xFF) {  // filling
            ++from;
            continue;
        }
        // Tables, frames, scans, applications' own and comments: the others have no length and no place here.
        if (marker < kBaseline || (marker >= 0xD0 && marker <= 0xD9)) return {};
        const std::size_t length = at(from + 2) << 8 | at(from + 3);
        if (length < 2 || from + 2 + length > bytes.size()) return {};
        if (marker == kStartOfScan) return size;
        if (marker >= kBaseline && marker <= kOtherFrames && marker != kHuffman && marker != kArithmetic) {
            if (marker > kProgressive || size || length < 8) return {};
            const std::size_t parts = at(from + 9);
            if (at(from + 4) != 8 || (parts != 1 && parts != 3) || length != 8 + 3 * parts) return {};
            size = PictureSize{static_cast<int>(at(from + 7) << 8 | at(from + 8)),
                               static_cast<int>(at(from + 5) << 8 | at(from + 6))};
            if (size->width == 0 || size->height == 0) return {};
        }
        from += 2 + length;
    }
    return {};
}

}  // namespace handpiece::school_server
