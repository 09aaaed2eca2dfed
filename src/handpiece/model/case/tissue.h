// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The tissues of a tooth and its surroundings: what they feel like and how they resist a bur.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace handpiece::cases {

enum class Tissue : std::uint8_t {
    none,
    enamel,
    dentine,
    pulp,
    caries,  ///< as one tissue: of cases that know no layers
    cementum,
    gum,
    bone,
    neighbour,
    restoration,
    demineralisedEnamel,
    cariesSoft,  ///< from here to cariesFirmToHard: carious dentine, from soft to what is nearly sound
    cariesSoftToLeathery,
    cariesLeathery,
    cariesLeatheryToFirm,
    cariesFirm,
    cariesFirmToHard,
    stainedEnamel,  ///< sound, dark and rough: fissures and cracks in which an instrument sticks
    calculus
};
inline constexpr std::size_t kTissueCount = 19;
/// Tissues that the first formats of sessions and cut states know.
inline constexpr std::size_t kFirstTissueCount = 10;

/// Carious dentine from soft to nearly sound, in the words of the ICCC (2016) and halfway between them.
inline constexpr std::array<Tissue, 6> kCariousLevels = {Tissue::cariesSoft,     Tissue::cariesSoftToLeathery,
                                                         Tissue::cariesLeathery, Tissue::cariesLeatheryToFirm,
                                                         Tissue::cariesFirm,     Tissue::cariesFirmToHard};
/// Caries of the dentine, whatever its level: what excavation is about.
[[nodiscard]] constexpr bool isCarious(Tissue tissue) noexcept {
    return tissue == Tissue::caries || (tissue >= Tissue::cariesSoft && tissue <= Tissue::cariesFirmToHard);
}

/// What a tissue feels like through a device. Stiffness is a fraction of what the device can render stably (its
/// capability record), because enamel is orders of magnitude stiffer than any desktop arm.
struct TissueProperties {
    std::string_view name;
    double stiffnessFraction;  ///< of the device's stiffness limit, 0..1
    double dampingNSPerMm;     ///< Kelvin-Voigt b on the approach [N s/mm]
    double friction;           ///< Coulomb, of a still bur sliding on it
    double cuttingMm2PerN;     ///< K of V' = K F omega r: volume a second for load, speed and radius; 0: cannot be cut
    std::array<std::uint8_t, 3> colour;  ///< sRGB
    int priority;                        ///< where parts overlap the higher one wins
};

/// One row a tissue, in the order of Tissue. Levels of caries that no file gives lie halfway between their neighbours.
struct TissueTable {
    std::array<TissueProperties, kTissueCount> rows;
    [[nodiscard]] const TissueProperties& of(Tissue tissue) const noexcept {
        const auto index = static_cast<std::size_t>(tissue);
        return rows[index < kTissueCount ? index : 0];
    }
};
/// data/tissues.toml as shipped; docs/physics.md#tissues says where each figure comes from.
[[nodiscard]] const TissueTable& builtInTissues();
/// A table of one's own: what the file leaves out is as shipped. Throws core::Error naming file, tissue and value for
/// an unknown tissue or key, a negative or infinite value, a fraction above one.
[[nodiscard]] TissueTable readTissues(const std::filesystem::path& file);

/// The same from text; `where` names it in messages.
[[nodiscard]] TissueTable parseTissues(std::string_view text, const std::string& where);

/// Throws core::Error for a row that no such file could have given.
void validate(const TissueTable& table);

/// Row of the built-in table.
[[nodiscard]] const TissueProperties& properties(Tissue tissue);
/// By name ("enamel"); throws core::Error naming the tissues there are.
[[nodiscard]] Tissue tissueByName(std::string_view name);

}  // namespace handpiece::cases
