// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Depth and margins after a cut against brute force on the tooth minus the exact sweep.

#include <memory>
#include <string>

#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::bench {

struct CutAccuracy {
    std::string bur, cut;
    double voxelMm = 0.0;
    std::size_t poses = 0;
    double errorMedianUm = 0.0, errorP99Um = 0.0, errorWorstUm = 0.0, timeUs = 0.0, timeP99Us = 0.0;
};

inline constexpr const char* kCuts[] = {"groove", "plunge", "crossing", "undercut", "fissure"};

/// Cuts the molar in one of the ways above, then asks the depth of the same bur at `count` random poses about the cut
/// (seeded).
[[nodiscard]] CutAccuracy measureCut(const std::shared_ptr<const tooth::ToothModel>& tooth,
                                     const std::shared_ptr<const instrument::Bur>& bur, const std::string& cut,
                                     std::size_t count, unsigned seed);

/// How far places of the true margin, where what was swept passes through the uncut tooth's triangles, lie from the
/// surface as files have it.
struct MarginAccuracy {
    std::size_t places = 0;
    double medianUm = 0.0, p95Um = 0.0, worstUm = 0.0;
};
[[nodiscard]] MarginAccuracy measureMargin(const std::shared_ptr<const tooth::ToothModel>& tooth,
                                           const std::shared_ptr<const instrument::Bur>& bur, const std::string& cut,
                                           unsigned seed);

}  // namespace handpiece::bench
