// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How well a bur cuts: toothing or grit, as factors on the tissues' own values.

#include <array>
#include <string>

namespace handpiece::instrument {

/// A bur's cutting ability. docs/physics.md#cutting says where each figure comes from.
struct CuttingParameters {
    std::string name = "diamond-medium";
    double cutting = 1.0;          ///< on every tissue's K
    double loadCapN = 1.5;         ///< more load than this cuts no faster (Siegel & von Fraunhofer: medium grit)
    double frictionCutting = 0.3;  ///< tangential force of the turning bur over the load
    double chipMm = 2e-4;          ///< the most that one edge takes off in passing
    int edges = 6;                 ///< that pass a point in a turn
    double centreRadius = 0.3;     ///< of the largest radius: nearer to the axis the bur cuts as if it were there
};

}  // namespace handpiece::instrument
