// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Depth from the distance field alone, as after a cut. Private to this room.

#include <span>
#include <vector>

#include "handpiece/base/core/simd.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/tick/contact/method.h"
#include "handpiece/tick/contact/sampled/known_surface.h"
#include "handpiece/tick/contact/sampled/ring_arrays.h"
#include "handpiece/tick/contact/sampled/surface_sampler.h"

namespace handpiece::contact {

/// What the field says of the depth.
struct FieldTouch {
    double depthMm = -std::numeric_limits<double>::infinity();
    core::Vec3 normal = core::Vec3::Zero();     ///< unit, out of the tooth
    core::Vec3 surfaceMm = core::Vec3::Zero();  ///< of the tooth
};

/// Deepest place, from the bur's surface inwards: along the bur's inward normal phiT + phiB never rises, so each of the
/// nearest points of the rings is climbed from beside the surface and taken inwards until it lies on the tooth's. A bur
/// that lies deeper than the field's values reach is looked for on shells inside it and on its axis.
class FieldDepth {
  public:
    FieldDepth(KnownSurface& surface, const instrument::Bur& bur, core::SimdLevel level);

    /// The depth; minus infinity when nothing lies within clearMm() of the bur. Where values only say "at least", so
    /// does the depth.
    [[nodiscard]] FieldTouch search(const core::Pose& burInTooth, SurfaceSampler& rings) noexcept;
    /// A bur at which the rings see nothing is at least this far off.
    [[nodiscard]] double clearMm() const noexcept { return clearMm_; }

  private:
    /// The outline about a ring.
    struct Spot {
        double rho, z, normalRho, normalZ;
        double curvatureBefore, curvatureAfter, curvatureAround;  ///< [1/mm], positive where the bur bulges
        double inscribedMm;              ///< how far inwards the nearest point of the bur stays this one
        double slopeBefore, slopeAfter;  ///< of that along the outline
        double roomBefore, roomAfter;    ///< along the outline to a corner [mm]
        double deeperPerMm;              ///< how fast -phiB grows inwards: less than 1 from a corner
        bool isCorner;
    };
    struct Start {
        std::size_t spot;
        double cosine, sine, inMm;
    };
    class DepthAscent;
    void climbFrom(const BurFrame& frame, std::span<const Start> starts, FieldTouch& best) noexcept;
    void addSpots();
    void measureInscribed();
    void measureRoom();
    void addShells();
    void addProbes();
    /// All points within `windowMm` of the nearest, and some others.
    void sense(const RingArrays& arrays, const BurFrame& frame, double windowMm) const noexcept;
    void searchInside(const BurFrame& frame, FieldTouch& best) noexcept;
    [[nodiscard]] double scanAxis(const BurFrame& frame, double fromZ, double step, int count,
                                  double& topZ) const noexcept;
    [[nodiscard]] double deepestOfAxis(const BurFrame& frame, double& topZ) const noexcept;
    void climbAxis(const BurFrame& frame, double top, double topZ, FieldTouch& best) noexcept;
    void takeAxis(const BurFrame& frame, double z, FieldTouch& best) noexcept;
    [[nodiscard]] core::Vec3 outward(const core::Vec3& p) const noexcept;
    [[nodiscard]] double radiusAt(double z) const noexcept;
    [[nodiscard]] double depthAt(const BurFrame& frame, const core::Vec3& p, double distanceMm) const noexcept;
    [[nodiscard]] std::size_t nearestSpot(std::size_t from, double rho, double z) const noexcept;

    KnownSurface& surface_;
    const field::DistanceField& field_;
    const instrument::Bur& bur_;
    field::FieldView view_;
    RingKernels kernels_;
    double outMm_, inMm_, clearMm_;  ///< values between -inMm_ and outMm_ are distances
    double windowMm_;                ///< from the deepest place to the nearest point of the rings, at most
    std::vector<Spot> spots_;        ///< by ring of the bur
    RingArrays inner_;               ///< shells inside the bur
    RingArrays probe_;               ///< some of the bur's points, to begin from
    std::vector<std::size_t> innerSpot_, probeSpot_;
    std::vector<float> innerIn_, innerDepth_;   ///< how far inwards from the spot, and -phiB there
    std::vector<instrument::MedialBall> axis_;  ///< at rising z
};

}  // namespace handpiece::contact
