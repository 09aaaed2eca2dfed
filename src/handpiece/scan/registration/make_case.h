// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A case out of surfaces.

#include <string>
#include <vector>

#include "handpiece/model/case/case.h"
#include "handpiece/scan/registration/registration.h"

namespace handpiece::registration {

struct CaseText {
    std::string name = "scanned tooth";  ///< chosen by a person, never taken from the scan
    std::string kind;
    int fdiNumber = 0;
    int buccalSign = 0;
    std::string tissuesToml;  ///< what the case changes about its tissues
};
/// Throws core::Error unless `fdi` is 0 or the number of a tooth there is.
void requireFdi(int fdi);
/// In the tooth's frame; `scenery` (neighbours, gum, bone) is in the scanner's frame like the surfaces. Authored
/// lesions are named "caries (authored)".
[[nodiscard]] cases::Case makeCase(const surfacing::Surfaces& surfaces, const Placed& placed, const CaseText& text,
                                   const std::vector<cases::Part>& scenery = {});

}  // namespace handpiece::registration
