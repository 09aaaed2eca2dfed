// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What the cutting benchmark times of a peer: where the bur is, how deep, and then it is cut away.

#include <memory>

#include "handpiece/model/instrument/bur.h"
#include "query.h"

namespace handpiece::bench {

class CutPeer {
  public:
    virtual ~CutPeer() = default;
    /// Depth at the pose, and the bur's volume there is gone.
    virtual double cutMm(const core::Pose& burInTooth) = 0;
    /// Volume of what is left; 0 where the peer knows none.
    virtual double volumeMm3() const { return 0.0; }
};

/// OpenVDB, a level set looked up at the bur's vertices, then raised in place through an accessor over the bur's box.
[[nodiscard]] std::unique_ptr<CutPeer> makeOpenvdbInPlace(const PeerInput& input, const instrument::Bur& bur,
                                                          double voxelMm, double bandOutMm, double bandMm);
/// OpenVDB, the bur's mesh made a level set at its pose and subtracted (csgDifference).
[[nodiscard]] std::unique_ptr<CutPeer> makeOpenvdbCsg(const PeerInput& input, double voxelMm, double bandOutMm,
                                                      double bandMm);
/// The paper's way: vertices inside the bur are pushed out of it, the hull of all is made again by Qhull, and its depth
/// asked of libccd (GJK and EPA).
[[nodiscard]] std::unique_ptr<CutPeer> makeRehullEpa(const PeerInput& input, const instrument::Bur& bur);

}  // namespace handpiece::bench
