// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How the scene is to look: quality, colours, what is shown, sections, helps. Plain data, compared by value.

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/tissue.h"

namespace handpiece::view {

/// From what a software renderer on two cores draws at 60 a second to what needs a GPU.
enum class Quality { fast, fine, rich };
enum class Palette {
    natural,     ///< as in a mouth
    textbook,    ///< as drawn in textbooks: tissues told apart at a glance
    colourSafe,  ///< told apart with any colour vision (after Okabe & Ito 2008)
};
enum class Stereo { none, sideBySide, anaglyph };
enum class ToothShown { now, before, ghost /**< now, with what was cut away as glass */ };

/// sRGB of a tissue.
[[nodiscard]] std::array<std::uint8_t, 3> colourOf(cases::Tissue tissue, Palette palette);
/// By name ("fast"; "natural", "textbook", "colour-safe"; "side-by-side"); throw core::Error naming those there are.
[[nodiscard]] Quality qualityByName(std::string_view name);
[[nodiscard]] Palette paletteByName(std::string_view name);
[[nodiscard]] Stereo stereoByName(std::string_view name);

/// Points with normal . p > offsetMm are cut off.
struct Plane {
    core::Vec3 normal = core::Vec3::UnitY();
    double offsetMm = 0.0;
    friend bool operator==(const Plane&, const Plane&) = default;
};

/// One entry of a legend.
struct LegendEntry {
    cases::Tissue tissue;
    std::array<std::uint8_t, 3> colour;
};
/// In the order given, each tissue once, without none.
[[nodiscard]] std::vector<LegendEntry> legendOf(const std::vector<cases::Tissue>& tissues, Palette palette);
/// Colour for a removed depth on the scale from 0 to `mostMm`, that of the renderer's removed-depth colours: from pale
/// to dark, so that the order is seen in grey too.
[[nodiscard]] std::array<std::uint8_t, 3> removedDepthColour(double depthMm, double mostMm);
/// Colour for a signed deviation on the scale from -mostMm (red: too much is gone) over 0 (pale) to mostMm (blue: too
/// little); told apart with any colour vision.
[[nodiscard]] std::array<std::uint8_t, 3> deviationColour(double deviationMm, double mostMm);

/// Every tissue is to be seen.
constexpr std::array<bool, cases::kTissueCount> allVisible() {
    std::array<bool, cases::kTissueCount> all{};
    all.fill(true);
    return all;
}

inline constexpr std::size_t kMostBleeding = 24;

struct Look {
    Quality quality = Quality::fast;
    Palette palette = Palette::natural;
    Stereo stereo = Stereo::none;
    double eyeSeparationMm = 3.0;  ///< at tooth scale: about a twentieth of the distance
    ToothShown tooth = ToothShown::now;
    std::array<bool, cases::kTissueCount> visible = allVisible();
    bool removedDepthColours = false;
    double removedDepthMostMm = 3.0;  ///< the end of that scale
    /// Instead of removed depths, with removedDepthColours: BrickUpdate::removedDepthMm holds a deviation plus this,
    /// and the colours are those of deviationColour(). 0: removed depths.
    double deviationMostMm = 0.0;
    std::optional<Plane> cutAway;  ///< applies to tooth and scenery, not to bur and turbine
    bool sectionGrid = false;      ///< millimetre lines on the cut-away's face
    bool bur = true, turbine = true;
    bool cheeks = false;      ///< lips and cheeks: else they are held aside
    bool scanColours = true;  ///< those of an intraoral scan where there are any; with Palette::natural alone
    bool wet = true, debris = true, spray = true, shadows = true;
    bool contactArrow = false, forceArrow = false;
    /// Where gingiva bleeds: it is red about these places. The first kMostBleeding count.
    std::vector<core::Vec3> bleedingMm;
    bool scaleBar = false;  ///< 5 mm in steps of 1 mm, at the target's depth, lower left
    std::array<std::uint8_t, 3> backgroundTop{52, 58, 66}, backgroundBottom{20, 22, 26};

    friend bool operator==(const Look&, const Look&) = default;
};

}  // namespace handpiece::view
