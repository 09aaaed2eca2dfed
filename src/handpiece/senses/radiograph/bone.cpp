// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/radiograph/bone.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/split_mix.h"

namespace handpiece::radiograph {
namespace {

using core::Box;
using core::Vec3;

constexpr double kSpacingMm = 0.12, kMostNodes = 4e7;
constexpr double kPlateMm = 1.3, kLaminaMm = 0.35;  ///< cortical, outside and round a root
constexpr double kSocketMm = 0.8;                   ///< a wall so near to a tooth is its socket's
constexpr double kCompact = 0.95;                   ///< share of what is compact
/// Trabeculae are walls between cells of marrow: so wide, so thick as a share of that.
constexpr double kCellMm = 1.25, kHalfWall = 0.15, kBetween = 0.05;
constexpr double kStepMm = 0.2;  ///< along a ray

/// Smooth, -1 to 1, with cells of one unit.
double noise(const Vec3& p, std::uint64_t seed) {
    std::int64_t cell[3];
    double t[3];
    for (int k = 0; k < 3; ++k) {
        const double low = std::floor(p[k]);
        cell[k] = static_cast<std::int64_t>(low);
        const double u = p[k] - low;
        t[k] = u * u * (3.0 - 2.0 * u);
    }
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        std::uint64_t key = seed;
        double weight = 1.0;
        for (int k = 0; k < 3; ++k) {
            const int high = corner >> k & 1;
            key = core::splitMix(key ^ static_cast<std::uint64_t>(cell[k] + high));
            weight *= high != 0 ? t[k] : 1.0 - t[k];
        }
        sum += weight * (2.0 * core::unitOf(key) - 1.0);
    }
    return sum;
}

/// Two families of walls, where noise changes its sign; turned, or its lattice would be seen.
double trabecular(const Vec3& p) {
    static const core::Mat3 kTurned[2] = {core::Mat3{{0.36, 0.48, -0.8}, {-0.8, 0.6, 0.0}, {0.48, 0.64, 0.6}} / kCellMm,
                                          core::Mat3{{2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0},
                                                     {2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0},
                                                     {-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0}} /
                                              kCellMm};
    double wall = 0.0;
    for (std::uint64_t family = 0; family < 2; ++family)
        wall = std::max(wall, 1.0 - std::abs(noise(kTurned[family] * p, family)) / kHalfWall);
    return kBetween + (kCompact - kBetween) * wall;
}

/// What of `box` rays of the picture may meet.
Box seenOf(const Projection& p, const Box& box) {
    const Vec3 normal = p.normal();
    double farthest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 v((corner & 1) != 0 ? box.max.x() : box.min.x(), (corner & 2) != 0 ? box.max.y() : box.min.y(),
                     (corner & 4) != 0 ? box.max.z() : box.min.z());
        farthest = std::max(farthest, (v - p.centreMm).dot(normal));
    }
    Box seen;
    const Vec3 spot = p.centreMm + p.sourceMm * normal;
    const double share = std::min(1.0, farthest / p.sourceMm);
    for (int corner = 0; corner < 4; ++corner) {
        const Vec3 at = p.centreMm + ((corner & 1) != 0 ? 0.5 : -0.5) * p.width * p.pixelMm * p.right +
                        ((corner & 2) != 0 ? 0.5 : -0.5) * p.height * p.pixelMm * p.up;
        seen.extend(at);
        seen.extend(at + share * (spot - at));
    }
    seen = seen.grown(1.0);
    return {seen.min.cwiseMax(box.min), seen.max.cwiseMin(box.max)};
}

bool isApart(const Box& a, const Box& b) {
    return (a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any();
}

/// A surface of bone, and which of its triangles are walls of sockets.
struct Jaw {
    geometry::TriangleTree tree;
    std::vector<std::uint8_t> isSocket;  ///< by triangle in the tree's order
};

}  // namespace

Bone::Bone(const Scene& scene, const Projection& projection) {
    const auto& surfaces = scene.tissues().surfaces();
    Box all;
    for (std::size_t s = 0; s < surfaces.size(); ++s)
        if (surfaces[s].role == cases::RaySurface::Role::scenery && surfaces[s].tissue == cases::Tissue::bone)
            for (const Vec3& v : scene.bodies()[s].mesh->vertices)
                all.extend(v);
    if (all.isEmpty()) return;
    const Box box = seenOf(projection, all);
    if (!(box.size().minCoeff() > 0.0)) return;

    std::vector<std::pair<core::Pose, geometry::TriangleTree>> teeth;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        if (surfaces[s].role != cases::RaySurface::Role::outer) continue;
        const Scene::Body& body = scene.bodies()[s];
        Box placed;
        for (const Vec3& v : body.mesh->vertices)
            placed.extend(body.inCase.apply(v));
        if (!isApart(placed.grown(kSocketMm), box)) teeth.emplace_back(body.inCase, *body.mesh);
    }
    std::vector<Jaw> jaws;
    for (std::size_t s = 0; s < surfaces.size(); ++s) {
        const Scene::Body& body = scene.bodies()[s];
        if (surfaces[s].role != cases::RaySurface::Role::scenery || surfaces[s].tissue != cases::Tissue::bone ||
            isApart(body.mesh->bounds(), box))
            continue;
        Jaw jaw{geometry::TriangleTree(*body.mesh), {}};
        jaw.isSocket.resize(body.mesh->triangles.size());
        core::parallelFor(jaw.isSocket.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                const geometry::TreeTriangle& c = jaw.tree.triangles()[t];
                Vec3 middle;
                for (int k = 0; k < 3; ++k)
                    middle[k] = c.a[k] + (c.ab[k] + c.ac[k]) / 3.0;
                if (!isApart(Box{middle, middle}, box.grown(kPlateMm)))
                    for (const auto& [pose, tree] : teeth)
                        if (tree.nearest(pose.applyInverse(middle), kSocketMm).triangle != geometry::kNoTriangle)
                            jaw.isSocket[t] = 1;
            }
        });
        jaws.push_back(std::move(jaw));
    }

    spacingMm_ = kSpacingMm;
    while (box.size().prod() > kMostNodes * spacingMm_ * spacingMm_ * spacingMm_)
        spacingMm_ *= 1.25;
    origin_ = box.min;
    for (std::size_t k = 0; k < 3; ++k)
        nodes_[k] = 3 + 2 * static_cast<std::size_t>(box.size()[static_cast<int>(k)] / (2.0 * spacingMm_));
    shares_.resize(nodes_[0] * nodes_[1] * nodes_[2]);
    const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
        return Vec3(origin_ +
                    spacingMm_ * Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)));
    };
    // How deep under its surface, as a share of what is compact there: at every other node, between them by these.
    const std::array<std::size_t, 3> coarse{nodes_[0] / 2 + 1, nodes_[1] / 2 + 1, nodes_[2] / 2 + 1};
    constexpr float kDeep = 2.0f, kOutside = -1.0f;
    std::vector<float> depth(coarse[0] * coarse[1] * coarse[2]);
    core::parallelFor(coarse[2] * coarse[1], 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            // As far as the surface was seen to be, nothing new is to be found.
            double clearMm = 0.0;
            float* to = &depth[row * coarse[0]];
            for (std::size_t i = 0; i < coarse[0]; ++i, ++to, clearMm -= 2.0 * spacingMm_) {
                if (i > 0 && clearMm > kDeep * kPlateMm) {
                    *to = to[-1];
                    continue;
                }
                const Vec3 p = at(2 * i, 2 * (row % coarse[1]), 2 * (row / coarse[1]));
                double nearest = 1e9;
                *to = kOutside;
                for (const Jaw& jaw : jaws) {
                    geometry::NearestPoint n;
                    const double distance = jaw.tree.signedDistance(p, &n);
                    nearest = std::min(nearest, std::abs(distance));
                    const double compactMm = jaw.isSocket[n.triangle] != 0 ? kLaminaMm : kPlateMm;
                    if (distance < 0.0)
                        *to = static_cast<float>(std::min(-distance / compactMm, static_cast<double>(kDeep)));
                }
                clearMm = nearest;
            }
        }
    });
    core::parallelFor(nodes_[2] * nodes_[1], 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const std::size_t j = row % nodes_[1], k = row / nodes_[1];
            for (std::size_t i = 0; i < nodes_[0]; ++i) {
                float sum = 0.0f;
                for (std::size_t corner = 0; corner < 8; ++corner)
                    sum += depth[(((k + (corner >> 2 & 1)) / 2) * coarse[1] + (j + (corner >> 1 & 1)) / 2) * coarse[0] +
                                 (i + (corner & 1)) / 2];
                const double deep = 0.125 * static_cast<double>(sum);
                // Compact bone gives way to trabeculae over a third of its thickness.
                const double compact = std::clamp(3.5 - 3.0 * deep, 0.0, 1.0);
                double share = kCompact * compact;
                if (compact < 1.0) share += (1.0 - compact) * trabecular(at(i, j, k));
                shares_[row * nodes_[0] + i] = static_cast<std::uint8_t>(std::lround(255.0 * share));
            }
        }
    });
}

double Bone::shareAt(const Vec3& p) const {
    const Vec3 u = (p - origin_) / spacingMm_;
    std::size_t cell[3];
    double t[3];
    for (int k = 0; k < 3; ++k) {
        const double v = std::clamp(u[k], 0.0, static_cast<double>(nodes_[static_cast<std::size_t>(k)] - 2));
        cell[k] = static_cast<std::size_t>(v);
        t[k] = std::min(1.0, v - static_cast<double>(cell[k]));
    }
    const std::uint8_t* v = &shares_[(cell[2] * nodes_[1] + cell[1]) * nodes_[0] + cell[0]];
    double sum = 0.0;
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j) {
            const std::uint8_t* row =
                v + (static_cast<std::size_t>(k) * nodes_[1] + static_cast<std::size_t>(j)) * nodes_[0];
            sum +=
                (k != 0 ? t[2] : 1.0 - t[2]) * (j != 0 ? t[1] : 1.0 - t[1]) * ((1.0 - t[0]) * row[0] + t[0] * row[1]);
        }
    return sum / 255.0;
}

double Bone::meanShare(const Vec3& a, const Vec3& b) const {
    const int steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / kStepMm)));
    double sum = 0.0;
    for (int s = 0; s < steps; ++s)
        sum += shareAt(a + (s + 0.5) / steps * (b - a));
    return sum / steps;
}

}  // namespace handpiece::radiograph
