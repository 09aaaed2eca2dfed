// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The burs there are: data/burs.toml as shipped, and files of one's own.

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/instrument/cutting_parameters.h"
#include "handpiece/model/instrument/shapes.h"

namespace handpiece::instrument {

/// A bur of a catalogue: made of a shape and a size, or of a mesh (then the size is nothing).
struct CatalogueEntry {
    std::string name;       ///< as typed: "round-4", "330", "856-016"
    std::string usName;     ///< "1/4", "33 1/2"; may be empty
    std::string isoNumber;  ///< 15 digits, "500314001001014"; empty when a group is unknown
    Shape shape = Shape::round;
    double diameterMm = 0.0, lengthMm = 0.0;
    std::filesystem::path stl;      ///< empty for a shape
    std::string cuttingParameters;  ///< its name
    std::string description;
    std::string unchecked;  ///< what of it is recalled and not yet held against a standard
};

/// Abilities and burs of one file.
struct BurFile {
    struct NamedCuttingParameters {
        CuttingParameters cuttingParameters;
        std::string description, source;
    };
    std::vector<NamedCuttingParameters> abilities;
    std::vector<CatalogueEntry> burs;
};

/// data/burs.toml as shipped.
[[nodiscard]] const BurFile& builtInBurs();
/// Its burs, in the order of the file.
[[nodiscard]] const std::vector<CatalogueEntry>& catalogue();
/// By its name, its US name ("33 1/2") or its ISO number (spaces count for nothing); null when there is none.
[[nodiscard]] const CatalogueEntry* findBur(std::string_view name);
/// Throws core::Error naming the abilities there are.
[[nodiscard]] const CuttingParameters& abilityByName(std::string_view name);
/// Throws core::Error naming the value that is not finite or out of range.
void validate(const CuttingParameters& cuttingParameters);

/// Abilities and burs of one's own; `stl` is relative to the file. Throws core::Error with file and line for what is
/// unknown, negative or infinite, for a name given twice, a shape that its size cannot make, an ability that is
/// neither in the file nor shipped.
[[nodiscard]] BurFile readAbilities(const std::filesystem::path& file);
/// The same from text; `where` names it in messages, `folder` is what `stl` is relative to.
[[nodiscard]] BurFile parseAbilities(std::string_view text, const std::string& where,
                                     const std::filesystem::path& folder = {});

/// A bur and how well it cuts.
struct Instrument {
    std::shared_ptr<const Bur> bur;
    CuttingParameters cuttingParameters;
};
/// By a name of the file of one's own (first) or of the catalogue, "paper", SHAPE:DIAMETERxLENGTH, or a mesh file. What
/// names no ability has `ability`, and that wins where it is given; without either it is a medium diamond.
/// A mesh file's coordinates are multiplied by `mmPerUnit`. Throws core::Error.
[[nodiscard]] Instrument makeInstrument(std::string_view nameOrFile, const std::filesystem::path& abilitiesFile = {},
                                        std::string_view cuttingParameters = {}, double mmPerUnit = 1.0);

}  // namespace handpiece::instrument
