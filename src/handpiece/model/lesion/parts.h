// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is found at a place, as functions on a grid and closed surfaces of them. Private to this room.

#include <vector>

#include "handpiece/model/lesion/place.h"

namespace handpiece::lesion {

/// Parts of one lesion, the outermost of several levels first. `number` goes into the seed.
[[nodiscard]] std::vector<cases::Part> partsOf(const Surfaces& surfaces, const cases::Tooth& tooth,
                                               const Lesion& lesion, const Options& options, std::size_t number);

/// Calculus: how thick it lies over a point of the surface near its middle [mm]; less than nothing beside it.
struct Deposit {
    core::Vec3 middle;
    double radiusMm, thickMm;
    std::uint64_t seed;
    [[nodiscard]] double thicknessMm(const core::Vec3& p) const;
};
[[nodiscard]] Deposit depositAt(const Surfaces& surfaces, const cases::Tooth& tooth, Surface surface,
                                const Options& options, std::size_t number);
[[nodiscard]] cases::Part partOf(const Surfaces& surfaces, const Deposit& deposit, std::string name,
                                 const Options& options);

}  // namespace handpiece::lesion
