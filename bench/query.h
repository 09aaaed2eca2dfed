// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the benchmark times: one question a tick, asked the same way of ours and of every peer.

#include <limits>
#include <memory>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::bench {

/// Told by a method that says only that there is no contact, not how far it is.
inline constexpr double kNoContact = -std::numeric_limits<double>::infinity();

class Query {
  public:
    virtual ~Query() = default;
    /// Depth as the method defines it [mm]: positive when penetrating, minus the distance when apart, or kNoContact.
    virtual double depthMm(const core::Pose& burInTooth) = 0;
};

/// What a peer is built from. The bur is the polyhedral one; radius and length are for peers with a capsule.
struct PeerInput {
    const geometry::TriangleMesh& tooth;
    const geometry::TriangleMesh& bur;
    double burRadiusMm, burLengthMm;
};

}  // namespace handpiece::bench
