// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Lesions and what else is found on teeth, put into a tooth as parts. docs/lesions.md says what rests on what.

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/case.h"

namespace handpiece::lesion {

enum class Surface : std::uint8_t { occlusal, mesial, distal, buccal, lingual, cervical, root };
inline constexpr std::array<std::string_view, 7> kSurfaces = {"occlusal", "mesial",   "distal", "buccal",
                                                              "lingual",  "cervical", "root"};

/// Caries by its radiographic depth (outer and inner half of the enamel; outer, middle, inner third of the dentine), or
/// something else that is found there.
enum class Finding : std::uint8_t { e1, e2, d1, d2, d3, filling, stain, crack, calculus };
inline constexpr std::array<std::string_view, 9> kFindings = {"E1",      "E2",    "D1",    "D2",      "D3",
                                                              "filling", "stain", "crack", "calculus"};

struct Lesion {
    Surface surface = Surface::occlusal;
    Finding finding = Finding::d2;
};
/// "occlusal:D2,mesial:E2"; throws core::Error naming what there is.
[[nodiscard]] std::vector<Lesion> lesionsByName(std::string_view text);

/// What is found on the teeth of a mouth, by their FDI numbers.
using MouthLesions = std::map<int, std::vector<Lesion>>;
/// "46:mesial:D2,36:occlusal:D3"; throws core::Error likewise.
[[nodiscard]] MouthLesions mouthLesionsByName(std::string_view text);

/// How deep caries reaches: shares of the enamel's thickness at the place (0 outside, 1 at the dentine), or of the
/// dentine's (0 at the enamel or the root's surface, 1 at the pulp).
struct DepthClass {
    bool inDentine = false;
    double from = 0.0, to = 0.0;
};
/// Of caries; {} of anything else.
[[nodiscard]] DepthClass depthClassOf(Finding finding) noexcept;

struct Options {
    std::uint64_t seed = 1;   ///< moves places, sizes and outlines
    double spacingMm = 0.06;  ///< of the grid that surfaces are made on
};

/// Adds the parts of all that is asked for, and thickens the outer surface by calculus. Caries of the dentine is one
/// closed part a level, each within the next harder one. Places come from the tooth's landmarks (contacts, fissures,
/// pits), else from its shape. The same parts for the same tooth and options at any thread count.
///
/// Needs the outer surface and parts of enamel, dentine and pulp; throws core::Error naming what is missing, and where
/// a tooth has no such place (a fissure of an incisor).
void addLesions(cases::Tooth& tooth, std::span<const Lesion> lesions, const Options& options = {},
                const core::Progress& progress = {});
/// The same for the teeth of a mouth, each with a seed of its own. Throws core::Error for a tooth that it lacks.
void addLesions(cases::Case& mouth, const MouthLesions& lesions, const Options& options = {},
                const core::Progress& progress = {});

}  // namespace handpiece::lesion
