// SPDX-License-Identifier: Apache-2.0
// Any text must give abilities in range and burs that can be made, or one core::Error.
#include "fuzz_model.h"
#include "handpiece/model/instrument/catalogue.h"

namespace instrument = handpiece::instrument;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return handpiece::fuzz::readText(data, size, [](std::string_view text) {
        const instrument::BurFile file = instrument::parseAbilities(text, "fuzz", "/nowhere");
        try {
            for (const instrument::BurFile::NamedCuttingParameters& a : file.abilities)
                instrument::validate(a.cuttingParameters);
            for (const instrument::CatalogueEntry& e : file.burs)
                if (e.stl.empty()) instrument::validate(instrument::makeProfile(e.shape, e.diameterMm, e.lengthMm));
        } catch (const handpiece::core::Error&) {
            __builtin_trap();  // the reader let something pass
        }
    });
}
