// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A bur: its outline of revolution, its medial axis and the points of its surface that feel the tooth.
/// Bur frame: tip at the origin, shank along +z [mm].

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/instrument/profile.h"

namespace handpiece::instrument {

/// A ball inscribed in the bur, centre (rho, z) in the half-plane; the bur is the union of these balls turned about its
/// axis.
struct MedialBall {
    double rhoMm = 0.0, zMm = 0.0, radiusMm = 0.0;
};
/// A polyline of medial balls, linear in between to within kMedialToleranceMm. On the axis (all rho 0) or a sheet
/// (turned about the axis it is a surface; a convex corner of the outline starts one with radius 0). Always two balls
/// or more; a curve that is one point (the centre of a sphere) has two equal balls.
struct MedialCurve {
    std::vector<MedialBall> balls;
    bool onAxis = false;
};
inline constexpr double kMedialToleranceMm = 2e-5;

/// Rows of points on the bur's surface, ring by ring from the tip, at most Bur::surfaceSpacingMm() apart along the
/// outline and around it. Areas add up to the bur's surface area. Every corner of the outline has a ring on it (its
/// normal halves the corner, its area is half of each band beside it); on the axis a ring is one point; others have a
/// multiple of 8 points.
struct SurfaceRing {
    double zMm, rhoMm;           ///< where on the outline
    double normalRho, normalZ;   ///< unit outward normal of the bur
    double areaMm2;              ///< of one point of this ring
    std::uint32_t first, count;  ///< its points: angles 2 pi (j + 0.5) / count for j in [0, count)
};
/// A large bur has its points farther apart, so that a tick knows how many there can be.
inline constexpr double kSurfaceSpacingMm = 0.06, kMaxSurfacePoints = 4500;

/// Immutable once made; safe to share between threads.
class Bur {
  public:
    /// From an outline (catalogue shapes: exact lines and arcs). Throws core::Error when it encloses no volume.
    Bur(std::string name, Profile profile);
    /// The same with a mesh of its own for the eye and the hull method, in the bur frame.
    Bur(std::string name, Profile profile, geometry::TriangleMesh mesh);

    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] const Profile& profile() const noexcept { return profile_; }
    [[nodiscard]] double lengthMm() const noexcept { return lengthMm_; }
    [[nodiscard]] double maxRadiusMm() const noexcept { return maxRadiusMm_; }
    /// Signed distance to the solid of revolution [mm], point in the bur frame. The exact definition of phiB.
    [[nodiscard]] double signedDistance(const core::Vec3& p) const noexcept {
        return signedDistanceMm(profile_, std::sqrt(p.x() * p.x() + p.y() * p.y()), p.z());
    }
    [[nodiscard]] const std::vector<MedialCurve>& medialAxis() const noexcept { return medialAxis_; }
    [[nodiscard]] const std::vector<SurfaceRing>& rings() const noexcept { return rings_; }
    /// Of the rings' points: kSurfaceSpacingMm, or what spreads kMaxSurfacePoints over the surface.
    [[nodiscard]] double surfaceSpacingMm() const noexcept { return surfaceSpacingMm_; }
    /// The polyhedral bur: what the hull method and the eye see. The STL it came from, or the turned outline.
    [[nodiscard]] const geometry::TriangleMesh& mesh() const noexcept { return mesh_; }

  private:
    std::string name_;
    Profile profile_;  // its pieces meet exactly
    double lengthMm_ = 0.0, maxRadiusMm_ = 0.0, surfaceSpacingMm_ = kSurfaceSpacingMm;
    std::vector<MedialCurve> medialAxis_;
    std::vector<SurfaceRing> rings_;
    geometry::TriangleMesh mesh_;
};

/// A bur from an STL mesh by its envelope of revolution: the largest radius at each height about its z axis, as a
/// polyline within a micrometre. mesh() is the mesh given, moved.
///
/// The mesh's own axis must be z within 1 degree and pass anywhere (it is moved so that the centre of its surface lies
/// on the axis and the tip at the origin). An end whose flat is less than half as wide as the other's is the tip; else
/// the lower end is. Flutes are swept over: width one way and across it (root mean square) may differ by 15 %. A
/// missing top is closed flat. Throws core::Error when it is empty, flat, without volume, open over more than a fifth
/// of its surface, tilted, not round, in two pieces, or not 0.35 to 75 mm long (the probable unit is named).
[[nodiscard]] Bur burFromMesh(std::string name, geometry::TriangleMesh mesh);

}  // namespace handpiece::instrument
