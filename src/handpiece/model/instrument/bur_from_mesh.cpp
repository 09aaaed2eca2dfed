// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/instrument/bur.h"
#include "handpiece/model/instrument/envelope.h"

namespace handpiece::instrument {

using core::Mat3;
using core::Vec3;

namespace {

// What a bur may be: the head of the smallest round bur to a whole bur with its long shank.
constexpr double kMinExtentMm = 0.35, kLargestExtentMm = 75.0;
constexpr double kMaxTiltRad = std::numbers::pi / 180.0;
constexpr double kMaxUnroundness = 1.15;
constexpr double kLargestOpening = 0.2;   // of the surface: a missing top is closed, a missing side is not
constexpr double kMinVolumeShare = 1e-2;  // of the envelope's volume
constexpr double kClearAxis = 0.25;       // spread along the axis differs this much from that across it
constexpr double kPointedShare = 0.5;     // an end this much narrower than the other is the tip

/// Area, centre, spread and openness of a surface.
struct SurfaceMoments {
    double areaMm2 = 0.0;
    Vec3 centreMm = Vec3::Zero();
    Mat3 covariance = Mat3::Zero();
    Vec3 vectorArea = Vec3::Zero();  ///< zero for a closed surface
};

SurfaceMoments momentsOf(const geometry::TriangleMesh& mesh) {
    SurfaceMoments m;
    Mat3 second = Mat3::Zero();
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const Vec3 normal = 0.5 * (b - a).cross(c - a), middle = (a + b + c) / 3.0;
        const double area = normal.norm();
        m.areaMm2 += area;
        m.vectorArea += normal;
        m.centreMm += area * middle;
        second += area / 12.0 *
                  (a * a.transpose() + b * b.transpose() + c * c.transpose() + 9.0 * middle * middle.transpose());
    }
    if (m.areaMm2 > 0.0) {
        m.centreMm /= m.areaMm2;
        m.covariance = second / m.areaMm2 - m.centreMm * m.centreMm.transpose();
    }
    return m;
}

void requireSize(const std::string& name, const geometry::TriangleMesh& mesh) {
    const double extent = mesh.bounds().size().maxCoeff();
    if (extent >= kMinExtentMm && extent <= kLargestExtentMm) return;
    struct Unit {
        const char* name;
        double inMm;
    };
    std::string guess = "scale it to millimetres";
    for (const Unit unit :
         {Unit{"metres", 1000.0}, Unit{"micrometres", 1e-3}, Unit{"inches", 25.4}, Unit{"centimetres", 10.0}})
        if (extent * unit.inMm >= 1.0 && extent * unit.inMm <= 50.0) {
            guess = fmt::format("it is probably in {}: scale it by {}", unit.name, unit.inMm);
            break;
        }
    throw core::Error(
        fmt::format("a bur is {} to {} mm long, this one is {:.4g} mm", kMinExtentMm, kLargestExtentMm, extent), name,
        guess)
        .as("bur-size", {fmt::format("{:.4g}", extent)});
}

/// Angle between z and the mesh's own axis, where the shape shows one.
void requireUpright(const std::string& name, const Mat3& covariance) {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(covariance);
    const Vec3 spread = solver.eigenvalues();  // rising
    const bool isLong = spread[2] - spread[1] > spread[1] - spread[0];
    const int axis = isLong ? 2 : 0;
    const double along = spread[axis], across = 0.5 * (spread.sum() - along);
    if (std::abs(along - across) < kClearAxis * std::max(along, across)) return;  // as round as a ball
    const Vec3 direction = solver.eigenvectors().col(axis);
    const double tilt = core::acos(std::min(1.0, std::abs(direction.z())));
    if (tilt > kMaxTiltRad)
        throw core::Error(fmt::format("the bur's axis is {:.1f} degrees off z (it runs along {:.3f}, {:.3f}, {:.3f})",
                                      tilt * 180.0 / std::numbers::pi, direction.x(), direction.y(), direction.z()),
                          name, "turn the mesh so that its axis is z, tip down")
            .as("bur-not-round");
}

void requireRound(const std::string& name, const Mat3& covariance) {
    const Eigen::Matrix2d across = covariance.topLeftCorner<2, 2>();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(across);
    const double ratio = std::sqrt(solver.eigenvalues()[1] / std::max(solver.eigenvalues()[0], 1e-300));
    if (!(ratio <= kMaxUnroundness))
        throw core::Error(
            fmt::format("the mesh is not round about z: {:.3g} times as wide one way as across it", ratio), name,
            "a bur is a solid of revolution about z")
            .as("bur-not-round");
}

/// Radius of the flat (or, at a point, zero) at the lower or upper end of an outline.
double endRadius(const Profile& profile, bool upper) {
    const ProfilePiece& piece = upper ? profile.pieces.back() : profile.pieces.front();
    return std::abs(piece.to.y() - piece.from.y()) < 1e-9 ? std::max(piece.from.x(), piece.to.x()) : 0.0;
}

}  // namespace

Bur burFromMesh(std::string name, geometry::TriangleMesh mesh) {
    if (mesh.triangles.empty())
        throw core::Error("the bur's mesh has no triangles", name, "give a closed mesh").as("bur-not-solid");
    for (const geometry::Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t)
            if (v >= mesh.vertices.size() || !mesh.vertices[v].allFinite())
                throw core::Error("the bur's mesh has a corner that is missing or not finite", name, "export it again")
                    .as("bur-not-solid");
    requireSize(name, mesh);
    const core::Vec3 size = mesh.bounds().size();
    const SurfaceMoments moments = momentsOf(mesh);
    if (!(size.minCoeff() > 1e-3 * size.maxCoeff()) || !(moments.areaMm2 > 0.0))
        throw core::Error("the bur's mesh is flat: it encloses no volume", name, "give a closed mesh of the bur's head")
            .as("bur-not-solid");
    requireUpright(name, moments.covariance);
    requireRound(name, moments.covariance);
    if (moments.vectorArea.norm() > kLargestOpening * moments.areaMm2)
        throw core::Error(fmt::format("the bur's mesh is open: {:.0f} % of its surface is missing or turned inside out",
                                      100.0 * moments.vectorArea.norm() / moments.areaMm2),
                          name, "close its holes and orient it first: handpiece mesh repair")
            .as("bur-not-solid");

    const double bottom = mesh.bounds().min.z();
    for (Vec3& v : mesh.vertices)
        v -= Vec3(moments.centreMm.x(), moments.centreMm.y(), bottom);
    Profile profile = envelopeOfRevolution(mesh);
    if (endRadius(profile, true) < kPointedShare * endRadius(profile, false)) {
        // Upside down: half a turn about x, so that it stays the same body.
        const double top = mesh.bounds().max.z();
        for (Vec3& v : mesh.vertices)
            v = Vec3(v.x(), -v.y(), top - v.z());
        profile = envelopeOfRevolution(mesh);
    }
    const double enclosed = std::abs(geometry::enclosedVolumeMm3(mesh));
    if (!(enclosed > kMinVolumeShare * volumeMm3(profile)))
        throw core::Error(fmt::format("the bur's mesh encloses no volume ({:.3g} mm3)", enclosed), name,
                          "close its holes and orient it first: handpiece mesh repair")
            .as("bur-not-solid");
    return Bur(std::move(name), std::move(profile), std::move(mesh));
}

}  // namespace handpiece::instrument
