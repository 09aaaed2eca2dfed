// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/radiograph/burned_text.h"

#include <algorithm>
#include <array>

namespace handpiece::radiograph {
namespace {

constexpr int kWide = 5, kTall = 7;

struct Glyph {
    char letter;
    std::array<std::string_view, kTall> rows;
};

constexpr std::array<Glyph, 9> kGlyphs = {{
    {'S', {".####", "#....", "#....", ".###.", "....#", "....#", "####."}},
    {'I', {"#####", "..#..", "..#..", "..#..", "..#..", "..#..", "#####"}},
    {'M', {"#...#", "##.##", "#.#.#", "#.#.#", "#...#", "#...#", "#...#"}},
    {'U', {"#...#", "#...#", "#...#", "#...#", "#...#", "#...#", ".###."}},
    {'L', {"#....", "#....", "#....", "#....", "#....", "#....", "#####"}},
    {'A', {"..#..", ".#.#.", "#...#", "#...#", "#####", "#...#", "#...#"}},
    {'T', {"#####", "..#..", "..#..", "..#..", "..#..", "..#..", "..#.."}},
    {'E', {"#####", "#....", "#....", "####.", "#....", "#....", "#####"}},
    {'D', {"####.", "#...#", "#...#", "#...#", "#...#", "#...#", "####."}},
}};

}  // namespace

void burn(Picture& picture, std::string_view text) {
    const int letter = kWide + 1, count = static_cast<int>(text.size());
    // A fifth of the width, as large as whole pixels make it.
    const int scale = std::max(1, picture.width / (5 * letter * count));
    const int margin = 2 * scale, top = picture.height - margin - kTall * scale;
    const auto fill = [&](int x, int y, std::uint16_t grey) {
        if (x >= 0 && y >= 0 && x < picture.width && y < picture.height)
            picture.grey[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                         static_cast<std::size_t>(x)] = grey;
    };
    for (int y = top - scale; y < picture.height - margin + scale; ++y)
        for (int x = margin - scale; x < margin + letter * count * scale; ++x)
            fill(x, y, 0);
    for (int n = 0; n < count; ++n) {
        const auto* glyph = std::find_if(kGlyphs.begin(), kGlyphs.end(),
                                         [&](const Glyph& g) { return g.letter == text[static_cast<std::size_t>(n)]; });
        if (glyph == kGlyphs.end()) continue;
        for (int y = 0; y < kTall * scale; ++y)
            for (int x = 0; x < kWide * scale; ++x)
                if (glyph->rows[static_cast<std::size_t>(y / scale)][static_cast<std::size_t>(x / scale)] == '#')
                    fill(margin + n * letter * scale + x, top + y, 65535);
    }
}

}  // namespace handpiece::radiograph
