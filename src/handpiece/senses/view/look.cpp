// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/look.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "handpiece/base/core/error.h"

namespace handpiece::view {

namespace {

using Colour = std::array<std::uint8_t, 3>;
using Colours = std::array<Colour, cases::kTissueCount>;

// In the order of cases::Tissue: none, enamel, dentine, pulp, caries, cementum, gum, bone, neighbour, restoration,
// demineralised enamel, carious dentine from soft to nearly hard (each second one halfway between its neighbours),
// stained enamel, calculus.
constexpr Colours kNatural{{{128, 128, 128},
                            {233, 227, 211},
                            {214, 181, 122},
                            {176, 52, 50},
                            {82, 50, 27},
                            {188, 150, 108},
                            {206, 116, 112},
                            {210, 190, 150},
                            {233, 227, 211},
                            {132, 140, 148},
                            {252, 251, 246},
                            {70, 42, 24},
                            {98, 62, 33},
                            {126, 82, 42},
                            {152, 109, 62},
                            {178, 136, 82},
                            {196, 158, 102},
                            {58, 44, 36},
                            {192, 178, 128}}};
constexpr Colours kTextbook{{{128, 128, 128},
                             {238, 244, 250},
                             {246, 205, 92},
                             {216, 48, 48},
                             {92, 58, 33},
                             {190, 134, 70},
                             {240, 150, 156},
                             {206, 192, 150},
                             {186, 200, 212},
                             {78, 122, 176},
                             {255, 236, 206},
                             {74, 42, 26},
                             {110, 63, 32},
                             {146, 84, 38},
                             {174, 115, 50},
                             {202, 146, 62},
                             {224, 175, 77},
                             {60, 60, 66},
                             {150, 150, 96}}};
// After Okabe & Ito, "Color Universal Design", 2008 (yellow, vermillion, black, orange, reddish purple, bluish green,
// sky blue, blue; enamel is the white between them), each moved within its hue until all tissues that may touch are at
// least 25 apart in CIELAB for every colour vision: look_test computes it.
constexpr Colours kColourSafe{{{128, 128, 128},
                               {234, 243, 246},
                               {255, 223, 24},
                               {175, 70, 0},
                               {26, 23, 24},
                               {213, 147, 0},
                               {174, 125, 168},
                               {0, 145, 98},
                               {65, 212, 255},
                               {0, 105, 188},
                               {146, 190, 161},
                               {88, 8, 22},
                               {86, 49, 60},
                               {85, 90, 98},
                               {121, 119, 93},
                               {158, 149, 89},
                               {206, 186, 56},
                               {164, 54, 65},
                               {149, 67, 255}}};

// From the untouched tooth's pale to dark, each step as much darker: the order is read without the hue (after viridis,
// S. van der Walt and N. Smith, CC0, from its light end).
constexpr std::array<Colour, 8> kDepthScale{{{244, 240, 222},
                                             {213, 226, 118},
                                             {122, 209, 81},
                                             {34, 168, 132},
                                             {42, 120, 142},
                                             {60, 86, 140},
                                             {72, 44, 116},
                                             {52, 2, 62}}};

// Red to blue over white (ColorBrewer's RdBu of seven, C. Brewer, Apache-2.0), safe for any colour vision.
constexpr std::array<Colour, 7> kDeviationScale{{{178, 24, 43},
                                                 {239, 138, 98},
                                                 {253, 219, 199},
                                                 {247, 247, 247},
                                                 {209, 229, 240},
                                                 {103, 169, 207},
                                                 {33, 102, 172}}};

template <std::size_t N>
Colour between(const std::array<Colour, N>& scale, double share) {
    const double place = std::clamp(share, 0.0, 1.0) * (N - 1);
    const auto i = std::min(static_cast<std::size_t>(place), N - 2);
    const double t = place - static_cast<double>(i);
    Colour out{};
    for (std::size_t c = 0; c < 3; ++c)
        out[c] = static_cast<std::uint8_t>(std::lround((1.0 - t) * scale[i][c] + t * scale[i + 1][c]));
    return out;
}

template <class E, std::size_t N>
E byName(std::string_view name, const std::array<std::pair<E, std::string_view>, N>& known, const char* what) {
    std::string names;
    for (const auto& [value, knownName] : known) {
        if (name == knownName) return value;
        names += (names.empty() ? "" : ", ") + std::string(knownName);
    }
    throw core::Error(std::string("there is no ") + what + " of this name", std::string(name), "there are: " + names);
}

}  // namespace

std::array<std::uint8_t, 3> colourOf(cases::Tissue tissue, Palette palette) {
    const auto i = static_cast<std::size_t>(tissue);
    const Colours& colours =
        palette == Palette::natural ? kNatural : (palette == Palette::textbook ? kTextbook : kColourSafe);
    return colours[i < colours.size() ? i : 0];
}

Quality qualityByName(std::string_view name) {
    static constexpr std::array<std::pair<Quality, std::string_view>, 3> kNames{
        {{Quality::fast, "fast"}, {Quality::fine, "fine"}, {Quality::rich, "rich"}}};
    return byName(name, kNames, "quality");
}

Palette paletteByName(std::string_view name) {
    static constexpr std::array<std::pair<Palette, std::string_view>, 3> kNames{
        {{Palette::natural, "natural"}, {Palette::textbook, "textbook"}, {Palette::colourSafe, "colour-safe"}}};
    return byName(name, kNames, "palette");
}

Stereo stereoByName(std::string_view name) {
    static constexpr std::array<std::pair<Stereo, std::string_view>, 3> kNames{
        {{Stereo::none, "none"}, {Stereo::sideBySide, "side-by-side"}, {Stereo::anaglyph, "anaglyph"}}};
    return byName(name, kNames, "stereo");
}

std::vector<LegendEntry> legendOf(const std::vector<cases::Tissue>& tissues, Palette palette) {
    std::vector<LegendEntry> legend;
    for (const cases::Tissue tissue : tissues) {
        const bool known =
            std::any_of(legend.begin(), legend.end(), [&](const LegendEntry& entry) { return entry.tissue == tissue; });
        if (tissue != cases::Tissue::none && !known) legend.push_back({tissue, colourOf(tissue, palette)});
    }
    return legend;
}

std::array<std::uint8_t, 3> removedDepthColour(double depthMm, double mostMm) {
    return between(kDepthScale, mostMm > 0.0 ? depthMm / mostMm : (depthMm > 0.0 ? 1.0 : 0.0));
}

std::array<std::uint8_t, 3> deviationColour(double deviationMm, double mostMm) {
    return between(kDeviationScale, mostMm > 0.0 ? 0.5 + 0.5 * deviationMm / mostMm : 0.5);
}

}  // namespace handpiece::view
