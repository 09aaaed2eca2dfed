// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Preparations with a closed form, carved exactly into a block or a tooth: max(field, -shape) at every node.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "handpiece/assess/measures/preparation.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/field/brick_index.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "support/random.h"

namespace handpiece::measures::test {

using core::Vec2;
using core::Vec3;
using Shape = std::function<double(const Vec3&)>;

inline constexpr double kRad = std::numbers::pi / 180.0;

/// A convex solid as half-spaces n . x <= d, its corners and edges rounded with a radius.
class RoundedSolid {
  public:
    struct Plane {
        Vec3 n;
        double d;
    };
    /// Six planes in the order of a box: -x, +x, -y, +y, -z, +z.
    RoundedSolid(const std::array<Plane, 6>& planes, double radiusMm) : radiusMm_(radiusMm) {
        geometry::TriangleMesh mesh;
        for (int corner = 0; corner < 8; ++corner) {
            core::Mat3 a;
            Vec3 b;
            for (int k = 0; k < 3; ++k) {
                const Plane& plane = planes[static_cast<std::size_t>(2 * k + (corner >> k & 1))];
                a.row(k) = plane.n.transpose();
                b[k] = plane.d - radiusMm;
            }
            mesh.vertices.push_back(a.inverse() * b);
            corners_.push_back(mesh.vertices.back());
        }
        const std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
        for (const auto& q : quads) {
            mesh.triangles.push_back({q[0], q[1], q[2]});
            mesh.triangles.push_back({q[0], q[2], q[3]});
        }
        tree_ = std::make_shared<geometry::TriangleTree>(mesh);
    }
    [[nodiscard]] double operator()(const Vec3& p) const { return tree_->signedDistance(p) - radiusMm_; }
    /// Of the solid before it is rounded: where its planes end. Corner bits: x, y, z.
    [[nodiscard]] const Vec3& corner(int i) const { return corners_[static_cast<std::size_t>(i)]; }

  private:
    std::shared_ptr<geometry::TriangleTree> tree_;
    double radiusMm_;
    std::vector<Vec3> corners_;
};

/// A cavity from above into a surface at z = 0: a box whose walls open by an angle each and whose floor is tilted.
struct BoxCavity {
    double lengthMm = 3.5, widthMm = 1.6, depthMm = 1.8;  ///< at the floor, along x and y; under the middle
    double angleDeg[4] = {6, 6, 6, 6};                    ///< of the walls at -x, +x, -y, +y
    double tiltDeg = 0.0, tiltAzimuthRad = 0.0;
    double radiusMm = 0.2;

    [[nodiscard]] Vec3 floorNormal() const {
        return {std::sin(tiltDeg * kRad) * std::cos(tiltAzimuthRad),
                std::sin(tiltDeg * kRad) * std::sin(tiltAzimuthRad), std::cos(tiltDeg * kRad)};
    }
    [[nodiscard]] RoundedSolid solid() const {
        std::array<RoundedSolid::Plane, 6> planes;
        for (int i = 0; i < 4; ++i) {
            Vec3 h = Vec3::Zero();
            h[i / 2] = i % 2 == 0 ? -1.0 : 1.0;
            const double t = angleDeg[i] * kRad;
            const Vec3 n = std::cos(t) * h - std::sin(t) * Vec3::UnitZ();
            const Vec3 on = 0.5 * (i < 2 ? lengthMm : widthMm) * h - depthMm * Vec3::UnitZ();
            planes[static_cast<std::size_t>(i)] = {n, n.dot(on)};
        }
        const Vec3 n = -floorNormal();
        planes[4] = {n, n.dot(Vec3(0, 0, -depthMm))};
        planes[5] = {Vec3::UnitZ(), 2.0};
        return {planes, radiusMm};
    }
    /// Of the floor's plane under a place.
    [[nodiscard]] double floorZ(double x, double y) const {
        const Vec3 n = floorNormal();
        return -depthMm - (n.x() * x + n.y() * y) / n.z();
    }
    /// Distance of a wall's plane from the middle at a height z.
    [[nodiscard]] double wallAt(int wall, double z) const {
        return 0.5 * (wall < 2 ? lengthMm : widthMm) + std::tan(angleDeg[wall] * kRad) * (z + depthMm);
    }
};

/// Marks of an instrument on every surface of a shape: two crossed waves.
struct Marks {
    double amplitudeMm = 0.0, waveMm = 0.45, phase[2] = {0.0, 0.0};

    [[nodiscard]] double operator()(const Vec3& p) const {
        const double k = 2.0 * std::numbers::pi / (waveMm * std::sqrt(3.0));
        return amplitudeMm / std::sqrt(2.0) *
               (std::sin(k * (p.x() + p.y() + p.z()) + phase[0]) + std::sin(k * (p.x() - p.y() + p.z()) + phase[1]));
    }
    /// Root mean square on a surface along two of the axes, waves over 0.8 mm left out by the filter of second order.
    [[nodiscard]] double rmsMm() const {
        const double onSurface = waveMm * std::sqrt(1.5), b = std::numbers::pi * std::pow(0.7309 * 0.8 / onSurface, 2);
        return amplitudeMm / std::sqrt(2.0) * (1.0 - (1.0 + b) * std::exp(-b));
    }
};

inline geometry::TriangleMesh boxMesh(const Vec3& low, const Vec3& high) {
    geometry::TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner)
        mesh.vertices.emplace_back((corner & 1) != 0 ? high.x() : low.x(), (corner & 2) != 0 ? high.y() : low.y(),
                                   (corner & 4) != 0 ? high.z() : low.z());
    const std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& q : quads) {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    return mesh;
}

/// A cylinder about z, many-sided: flat to half a micron.
inline geometry::TriangleMesh cylinderMesh(double radiusMm, double lowMm, double highMm) {
    constexpr std::uint32_t kSides = 256;
    geometry::TriangleMesh mesh;
    for (std::uint32_t i = 0; i < kSides; ++i)
        for (const double z : {lowMm, highMm}) {
            const double a = 2.0 * std::numbers::pi * i / kSides;
            mesh.vertices.emplace_back(radiusMm * std::cos(a), radiusMm * std::sin(a), z);
        }
    mesh.vertices.emplace_back(0, 0, lowMm);
    mesh.vertices.emplace_back(0, 0, highMm);
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSides);
        mesh.triangles.push_back({a, b, b + 1});
        mesh.triangles.push_back({a, b + 1, a + 1});
        mesh.triangles.push_back({b, a, 2 * kSides});
        mesh.triangles.push_back({a + 1, b + 1, 2 * kSides + 1});
    }
    return mesh;
}

/// Outside of two solids: of their common part, with a round edge between; exact beside it.
inline double bothOf(double a, double b) {
    return a > 0.0 && b > 0.0 ? std::hypot(a, b) : std::max(a, b);
}

/// A crown preparation of a cylinder: a cone of half the convergence, a finish line at z = 0 whose inner corner is
/// round, a round occlusal edge; the occlusal surface may be tilted towards +y.
struct Cone {
    double halfDeg = 8.0, widthMm = 0.7, occlusalMm = 1.5, chamferMm = 0.5, edgeMm = 0.2;
    double outerMm = 3.2, topMm = 4.0, tiltDeg = 0.0;

    [[nodiscard]] double radiusAt(double z) const {
        return outerMm - widthMm / std::cos(halfDeg * kRad) - z * std::tan(halfDeg * kRad);
    }
    /// Of the occlusal surface over a place.
    [[nodiscard]] double occlusalZ(double y) const { return topMm - occlusalMm - y * std::tan(tiltDeg * kRad); }
    /// Negative in what is cut away.
    [[nodiscard]] double operator()(const Vec3& p) const {
        const double r = std::hypot(p.x(), p.y()), t = halfDeg * kRad;
        // What stays: the cone with its rounded edge, or below the margin; between both a round inner corner.
        const double side = (r - radiusAt(0)) * std::cos(t) + p.z() * std::sin(t),
                     top = (p.z() - occlusalZ(p.y())) * std::cos(tiltDeg * kRad);
        const double a = side + edgeMm, b = top + edgeMm;
        const double cone = std::min(std::max(a, b), 0.0) + std::hypot(std::max(a, 0.0), std::max(b, 0.0)) - edgeMm;
        const double below = p.z();
        // Quarter round in the corner of the two: distances to both less than the radius.
        const double u = chamferMm - cone, v = chamferMm - below;
        const double stays = u > 0.0 && v > 0.0 ? chamferMm - std::hypot(u, v) : std::min(cone, below);
        return -stays;
    }
};

/// Inside a solid and in a box, by cells of a fiftieth of a millimetre in the solid's own frame: independent of all
/// that is measured.
inline double volumeIn(const Shape& solid, const Vec3& low, const Vec3& high) {
    constexpr double kCell = 0.02;
    double sum = 0.0;
    for (double z = high.z() - 0.5 * kCell; z > low.z(); z -= kCell)
        for (double y = low.y() + 0.5 * kCell; y < high.y(); y += kCell)
            for (double x = low.x() + 0.5 * kCell; x < high.x();) {
                const double d = solid(Vec3(x, y, z));
                // What is far from the surface is skipped in one step.
                const int cells = std::max(1, static_cast<int>((std::abs(d) - kCell) / kCell));
                const int last = std::min(cells, static_cast<int>(std::ceil((high.x() - x) / kCell)));
                sum += last * std::clamp(0.5 - d / kCell, 0.0, 1.0);
                x += last * kCell;
            }
    return sum * kCell * kCell * kCell;
}

/// A body whose own frame (z: path of draw, x: mesial, +y buccal) is turned in the grid.
struct Body {
    std::shared_ptr<const tooth::ToothModel> model;
    core::Pose inGrid;
    [[nodiscard]] Axes axes() const {
        const core::Quat& q = inGrid.orientation;
        return {q * Vec3::UnitZ(), q * Vec3::UnitZ(), q * Vec3::UnitX(), q * Vec3::UnitY()};
    }
};

inline Body bodyOf(const geometry::TriangleMesh& mesh, const core::Pose& inGrid, double voxelMm) {
    cases::Case made;
    made.name = "closed form";
    made.outer = geometry::transformed(mesh, inGrid);
    tooth::LoadSettings settings;
    settings.useCache = false;
    settings.field.voxelMm = voxelMm;
    return {tooth::loadModel(made, settings), inGrid};
}

inline core::Pose randomPose(std::mt19937_64& random) {
    return {0.3 * handpiece::test::randomDirection(random), handpiece::test::randomRotation(random)};
}

/// The body without a shape that is told in its own frame; `shape` must be 1-Lipschitz.
inline std::unique_ptr<tooth::ToothMirror> carved(const Body& body, const Shape& shape) {
    const tooth::ToothModel& model = *body.model;
    const field::FieldView view = model.field.view();
    const auto low = static_cast<float>(-model.settings.bandMm), high = static_cast<float>(model.bandOutMm);
    tooth::StateDelta delta;
    const double half = 0.5 * std::sqrt(3.0) * field::kBrickCells * view.voxelMm;
    for (std::uint32_t dense = 0; dense < model.field.storage().coarse.size(); ++dense) {
        if (view.brickIndex[dense] < 0 && view.coarse[dense] > 0.0f) continue;
        const auto brick = field::brickAt(view.bricks, dense);
        const auto node = [&](double x, double y, double z) {
            return Vec3(view.originMm[0] + view.voxelMm * (8 * brick[0] + x),
                        view.originMm[1] + view.voxelMm * (8 * brick[1] + y),
                        view.originMm[2] + view.voxelMm * (8 * brick[2] + z));
        };
        if (shape(body.inGrid.applyInverse(node(4, 4, 4))) > half + model.settings.bandMm) continue;
        tooth::StateDelta::Brick made{dense, false, {}};
        model.uncutBrick(dense, made.values.data());
        bool changes = false;
        for (int i = 0; i < field::kBrickValues; ++i) {
            const Vec3 p = body.inGrid.applyInverse(node(i % 9, i / 9 % 9, i / 81));
            const float value = std::clamp(static_cast<float>(-shape(p)), low, high);
            float& now = made.values[static_cast<std::size_t>(i)];
            changes = changes || value > now;
            now = std::max(now, value);
        }
        if (changes) delta.bricks.push_back(std::move(made));
    }
    auto mirror = std::make_unique<tooth::ToothMirror>(body.model);
    mirror->apply(delta);
    return mirror;
}

inline Selection side(const char* name, const char* statistic = "") {
    Selection of;
    of.side = name;
    of.statistic = statistic;
    return of;
}

/// Errors of one kind of measure over many preparations, and how many the stated uncertainty covered.
struct Errors {
    std::vector<double> error, stated;
    std::vector<std::string> missing;  ///< why there was no value
    void add(const Measured& got, double truth) {
        if (!got.value) {
            missing.push_back(got.kind + " " + got.of.side + ": " + got.reason);
            return;
        }
        error.push_back(*got.value - truth);
        stated.push_back(got.uncertainty);
    }
    [[nodiscard]] std::vector<double> sizes() const {
        std::vector<double> size;
        for (const double e : error)
            size.push_back(std::abs(e));
        std::sort(size.begin(), size.end());
        return size;
    }
    /// By what the stated half-widths would have to be multiplied to cover 95 %.
    [[nodiscard]] double ratio() const {
        std::vector<double> ratios;
        for (std::size_t i = 0; i < error.size(); ++i)
            ratios.push_back(stated[i] > 0.0 ? std::abs(error[i]) / stated[i] : 0.0);
        std::sort(ratios.begin(), ratios.end());
        return ratios.empty() ? 0.0 : ratios[static_cast<std::size_t>(0.95 * static_cast<double>(ratios.size() - 1))];
    }
    /// Of those that the stated half-width covers.
    [[nodiscard]] double coverage() const {
        std::size_t covered = 0;
        for (std::size_t i = 0; i < error.size(); ++i)
            covered += std::abs(error[i]) <= stated[i] ? 1 : 0;
        return error.empty() ? 0.0 : static_cast<double>(covered) / static_cast<double>(error.size());
    }
};
using Table = std::map<std::string, Errors>;

inline void print(const Table& table) {
    std::printf("  %-28s %5s %9s %9s %9s %9s %9s %9s %7s  %s\n", "measure", "n", "bias", "p50", "p95", "worst",
                "stated", "widest", "ratio", "covered");
    for (const auto& [name, errors] : table) {
        const std::vector<double> size = errors.sizes();
        const double n = static_cast<double>(size.size());
        if (size.empty()) continue;
        const auto at = [&](double share) { return size[static_cast<std::size_t>(share * (n - 1))]; };
        std::printf("  %-28s %5.0f %+9.4f %9.4f %9.4f %9.4f %9.4f %9.4f %7.2f  %.1f %%\n", name.c_str(), n,
                    std::accumulate(errors.error.begin(), errors.error.end(), 0.0) / n, at(0.5), at(0.95), size.back(),
                    std::accumulate(errors.stated.begin(), errors.stated.end(), 0.0) / n,
                    *std::max_element(errors.stated.begin(), errors.stated.end()), errors.ratio(),
                    100.0 * errors.coverage());
    }
    std::fflush(stdout);
}

}  // namespace handpiece::measures::test
