// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A whole mouth as a case: one tooth to work on, and 31 others, gingiva and bone about it.

#include <cstddef>

#include "handpiece/base/core/progress.h"
#include "handpiece/model/case/case.h"
#include "handpiece/model/dentition/arch.h"
#include "handpiece/model/dentition/gingiva.h"
#include "handpiece/model/dentition/tooth_form.h"

namespace handpiece::dentition {

struct MouthOptions {
    int fdi = 46;                   ///< the tooth that is worked on: its frame is the case's
    std::size_t faces = 70000;      ///< of each tooth's outer surface
    double openingMm = kOpeningMm;  ///< between the incisal edges; 0: in occlusion
    bool cheeks = false;            ///< lips and cheeks too, held off the teeth as by a retractor
    PeriodontiumOptions periodontium{};
};

/// The tooth in its own frame, its adjacent teeth and antagonists to be cut, the rest to be felt, with gingiva and bone
/// of both arches. In parallel; the same bytes for the same request at any thread count. Throws core::Error for what
/// makeTooth refuses, an opening outside 0 to 60 mm, and more faces than there is memory free for.
[[nodiscard]] cases::Case makeMouth(const Patient& patient, const MouthOptions& options = {},
                                    const core::Progress& progress = {});

/// About what making it takes at most [bytes].
[[nodiscard]] double mouthBytes(const MouthOptions& options);

}  // namespace handpiece::dentition
