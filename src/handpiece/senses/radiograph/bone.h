// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What lies in a jaw's bone: plates and sockets' walls of cortical bone, trabeculae and marrow. Private to this room.

#include <array>
#include <cstdint>
#include <vector>

#include "handpiece/senses/radiograph/projection.h"

namespace handpiece::radiograph {

/// Share of cortical bone by volume in the bone that a picture shows, on a grid. Trabeculae are made by rule from the
/// place alone: another view of the same case shows the same ones.
class Bone {
  public:
    Bone(const Scene& scene, const Projection& projection);
    /// The mean from a to b, points of a case.
    [[nodiscard]] double meanShare(const core::Vec3& a, const core::Vec3& b) const;

  private:
    [[nodiscard]] double shareAt(const core::Vec3& p) const;

    core::Vec3 origin_ = core::Vec3::Zero();
    double spacingMm_ = 1.0;
    std::array<std::size_t, 3> nodes_{};  ///< none: there is no bone
    std::vector<std::uint8_t> shares_;    ///< of 255
};

}  // namespace handpiece::radiograph
