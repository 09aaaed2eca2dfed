// SPDX-License-Identifier: Apache-2.0
#include "peers/cut_peer.h"
#include "peers/libccd.h"

namespace handpiece::bench {
namespace {

class Rehull final : public CutPeer {
  public:
    Rehull(const PeerInput& input, const instrument::Bur& bur)
        : tooth_(input.tooth),
          burMesh_(input.bur),
          bur_(bur),
          radiusMm_(input.burRadiusMm),
          lengthMm_(input.burLengthMm) {}
    double cutMm(const core::Pose& pose) override {
        // The hull is made again with every tick that cuts, as the paper does.
        const double depth = makeLibccd({tooth_, burMesh_, radiusMm_, lengthMm_}, true)->depthMm(pose);
        const double reach = std::hypot(lengthMm_, radiusMm_);
        for (core::Vec3& v : tooth_.vertices) {
            if ((v - pose.positionMm).squaredNorm() > reach * reach) continue;
            const core::Vec3 p = pose.applyInverse(v);
            const double inside = -bur_.signedDistance(p);
            if (inside <= 0.0) continue;
            v = pose.apply(p - inside * core::Vec3::UnitZ());
        }
        return depth;
    }

  private:
    geometry::TriangleMesh tooth_, burMesh_;
    instrument::Bur bur_;
    double radiusMm_, lengthMm_;
};

}  // namespace

std::unique_ptr<CutPeer> makeRehullEpa(const PeerInput& input, const instrument::Bur& bur) {
    return std::make_unique<Rehull>(input, bur);
}

}  // namespace handpiece::bench
