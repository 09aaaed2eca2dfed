// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/scan/segmentation/work.h"

namespace handpiece::segmentation {

using core::Vec3;

namespace {
constexpr double kCloseMm = 0.5;      ///< mouths up to this radius are closed
constexpr double kMouthShare = 0.12;  ///< of a closed-off place's surface that may be mouth: else it is a groove
constexpr double kMinCavityMm3 = 0.02;
constexpr float kSlope = 2.5066f;  ///< sqrt(2 pi): steepness of a blurred step at its middle

bool isOnFace(const Shape& shape, std::size_t at) {
    const auto c = shape.at(at);
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (c[axis] == 0 || c[axis] + 1 == shape.size[axis]) return true;
    return false;
}

/// Positive on this tooth's side of its contacts [voxels of the block]; empty without neighbours.
Field ownSide(const CoarseTeeth& teeth, std::size_t chosen) {
    const Shape& shape = teeth.coarse.shape;
    const auto own = static_cast<std::uint32_t>(chosen + 1);
    Field side(shape.count(), 0.0f);
    Mask unknown(shape.count());
    bool any = false;
    for (std::size_t n = 0; n < side.size(); ++n) {
        side[n] = teeth.of[n] == 0 ? 0.0f : (teeth.of[n] == own ? 1.0f : -1.0f);
        unknown[n] = teeth.of[n] == 0;
        any = any || side[n] < 0;
    }
    if (!any) return {};
    spreadInto(shape, side, unknown);
    Field scratch;
    blur(shape, side, side, scratch, 1.2);
    return side;
}
}  // namespace

namespace {
/// Where another tooth is in a contact: how much nearer this one is than the other [voxels]; positive on its own side.
/// What lies between the two (by `side`) belongs to the one whose body is nearer through hard tissue, so that the face
/// of a neighbour, which a contact ties to this tooth, goes with the neighbour.
Field nearerThanOther(const Shape& shape, const Field& outer, const Field& side) {
    constexpr float kSure = 0.8f;
    Mask of(outer.size(), 0);  // 1 own, 2 other
    std::vector<std::uint32_t> layer, next;
    for (std::size_t n = 0; n < of.size(); ++n)
        if (outer[n] > 0 && std::abs(side[n]) > kSure) {
            of[n] = side[n] > 0 ? 1 : 2;
            layer.push_back(static_cast<std::uint32_t>(n));
        }
    while (!layer.empty()) {
        next.clear();
        for (const std::uint32_t at : layer)
            forNeighbours(shape, at, [&](std::size_t n) {
                if (of[n] != 0 || outer[n] <= 0) return;
                of[n] = of[at];
                next.push_back(static_cast<std::uint32_t>(n));
            });
        layer.swap(next);
    }
    for (std::size_t n = 0; n < of.size(); ++n)
        if (of[n] == 0 && outer[n] > 0) of[n] = side[n] > 0 ? 1 : 2;
    Mask own(of.size()), other(of.size());
    for (std::size_t n = 0; n < of.size(); ++n) {
        own[n] = of[n] == 1;
        other[n] = of[n] == 2;
    }
    Field result = squaredDistance(shape, other);
    const Field toOwn = squaredDistance(shape, own);
    for (std::size_t n = 0; n < result.size(); ++n) {
        const float a = std::min(std::sqrt(toOwn[n]), 8.0f), b = std::min(std::sqrt(result[n]), 8.0f);
        result[n] = own[n] ? b - 0.5f : (other[n] ? 0.5f - a : b - a);
    }
    Field scratch;
    blur(shape, result, result, scratch, 0.8);
    return result;
}
}  // namespace

void spreadInto(const Shape& shape, Field& values, const Mask& unknown) {
    constexpr std::size_t kGrain = 1 << 14;
    Mask open = unknown;
    // By slices, so that several threads find the same layer.
    std::vector<std::vector<std::uint32_t>> found(static_cast<std::size_t>(shape.size[2]));
    core::parallelFor(found.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
            for (std::size_t n = k * shape.sliceStride(); n < (k + 1) * shape.sliceStride(); ++n) {
                if (unknown[n] != 1) continue;
                bool isBeside = false;
                forNeighbours(shape, n, [&](std::size_t o) { isBeside = isBeside || !unknown[o]; });
                if (!isBeside) continue;
                found[k].push_back(static_cast<std::uint32_t>(n));
                open[n] = 3;
            }
    });
    std::vector<std::uint32_t> layer, next;
    for (const auto& slice : found)
        layer.insert(layer.end(), slice.begin(), slice.end());
    while (!layer.empty()) {
        const auto ofLayer = [&](const auto& body) {
            core::parallelFor(layer.size(), kGrain, [&](std::size_t from, std::size_t to) {
                for (std::size_t n = from; n < to; ++n)
                    body(layer[n]);
            });
        };
        // What is of the layer itself does not count yet.
        ofLayer([&](std::uint32_t at) {
            float sum = 0, count = 0;
            forNeighbours(shape, at, [&](std::size_t o) {
                if (open[o] == 0) sum += values[o], count += 1;
            });
            values[at] = sum / count;
        });
        ofLayer([&](std::uint32_t at) { open[at] = 0; });
        next.clear();
        for (const std::uint32_t at : layer)
            forNeighbours(shape, at, [&](std::size_t o) {
                if (open[o] == 1) {
                    open[o] = 3;
                    next.push_back(static_cast<std::uint32_t>(o));
                }
            });
        layer.swap(next);
    }
}

Mask closedCavities(const Shape& shape, const Mask& solid, double spacingMm) {
    // On blocks of about 0.1 mm: the closing needs distances, and a mouth's exact place is a matter of taste.
    const int f = std::max(1, static_cast<int>(std::lround(0.1 / spacingMm)));
    Shape coarse;
    for (std::size_t axis = 0; axis < 3; ++axis)
        coarse.size[axis] = (shape.size[axis] + f - 1) / f + 2;
    Mask mask(coarse.count(), 0);
    forRows(coarse, [&](int j, int k) {
        if (j == 0 || k == 0 || j + 1 == coarse.size[1] || k + 1 == coarse.size[2]) return;
        for (int i = 1; i + 1 < coarse.size[0]; ++i) {
            int set = 0, all = 0;
            for (int c = (k - 1) * f; c < std::min(k * f, shape.size[2]); ++c)
                for (int b = (j - 1) * f; b < std::min(j * f, shape.size[1]); ++b)
                    for (int a = (i - 1) * f; a < std::min(i * f, shape.size[0]); ++a, ++all)
                        set += solid[shape.index(a, b, c)];
            mask[coarse.index(i, j, k)] = 2 * set > all;
        }
    });
    const double r = kCloseMm / (spacingMm * f);
    const Field far = squaredDistance(coarse, mask);
    Mask open(mask.size());
    for (std::size_t n = 0; n < open.size(); ++n)
        open[n] = far[n] > r * r || isOnFace(coarse, n);
    const Parts reach = connectedParts(coarse, open);
    const std::uint32_t sky = reach.of[0];
    for (std::size_t n = 0; n < open.size(); ++n)
        open[n] = reach.of[n] == sky;
    const Field back = squaredDistance(coarse, open);
    Mask cavity(mask.size());
    for (std::size_t n = 0; n < cavity.size(); ++n)
        cavity[n] = !mask[n] && back[n] > (r + 0.5) * (r + 0.5);
    const Parts parts = connectedParts(coarse, cavity);
    std::vector<double> mouth(parts.counts.size(), 0.0), wall(parts.counts.size(), 0.0);
    for (std::size_t n = 0; n < cavity.size(); ++n)
        if (cavity[n])
            forNeighbours(coarse, n, [&](std::size_t o) {
                if (cavity[o]) return;
                (mask[o] ? wall : mouth)[parts.of[n]] += 1;
            });
    const double least = kMinCavityMm3 / core::pow(spacingMm * f, 3);
    std::vector<std::uint8_t> keep(parts.counts.size(), 0);
    for (std::size_t p = 1; p < keep.size(); ++p)
        keep[p] = mouth[p] == 0 ||
                  (mouth[p] < kMouthShare * (mouth[p] + wall[p]) && static_cast<double>(parts.counts[p]) >= least);
    // 1 cavity, 2 outside, 3 not told by the blocks: as the nearest told one.
    Mask result(solid.size(), 0);
    forRows(shape, [&](int j, int k) {
        for (int i = 0; i < shape.size[0]; ++i) {
            const std::size_t at = shape.index(i, j, k);
            if (solid[at]) continue;
            const std::size_t block = coarse.index(i / f + 1, j / f + 1, k / f + 1);
            result[at] = mask[block] ? 3 : (keep[parts.of[block]] ? 1 : 2);
        }
    });
    std::vector<std::uint32_t> layer, next;
    for (std::size_t n = 0; n < result.size(); ++n)
        if (result[n] == 3) layer.push_back(static_cast<std::uint32_t>(n));
    std::vector<std::uint8_t> told;
    while (!layer.empty()) {
        told.assign(layer.size(), 3);
        next.clear();
        for (std::size_t n = 0; n < layer.size(); ++n)
            forNeighbours(shape, layer[n], [&](std::size_t o) {
                if (result[o] == 1 || result[o] == 2) told[n] = std::min(told[n], result[o]);
            });
        for (std::size_t n = 0; n < layer.size(); ++n) {
            result[layer[n]] = told[n];
            if (told[n] == 3) next.push_back(layer[n]);
        }
        if (next.size() == layer.size()) {
            // Enclosed all around and smaller than a block: inside.
            for (const std::uint32_t at : next)
                result[at] = 1;
            break;
        }
        layer.swap(next);
    }
    for (std::uint8_t& r2 : result)
        r2 = r2 == 1;
    return result;
}

void findOuter(Work& work, const CoarseTeeth& teeth, std::size_t chosen, const volume::Grid& scan,
               const Settings& settings, const core::Progress& progress) {
    const Shape& shape = work.shape;
    const Thresholds& t = work.levels;
    Field& soft = work.scratch;
    blur(shape, work.damped, soft, work.scratch2, 0.7);
    core::report(progress, 0.2);

    // Halfway between what is outside and the tissue that lies inside, which a look along the normal tells.
    const float darkest = t.outside + 0.15f * (t.toothFrom - t.outside);
    const float ground =
        2 * t.toothFrom - t.dentine;  // the outside that toothFrom stands for: bone, where there is any
    work.groundLevel = ground;
    const bool isGroundVaried = ground > t.outside + 0.05f * (t.dentine - t.outside);
    const float brightest = t.outside + 0.85f * (t.enamel - t.outside);
    const float flat = 0.08f * (t.dentine - t.outside);
    work.outer.resize(shape.count());
    forRows(shape, [&](int j, int k) {
        if (j == 0) core::report(progress, 0.2 + 0.3 * k / shape.size[2]);
        for (int i = 0; i < shape.size[0]; ++i) {
            const std::size_t at = shape.index(i, j, k);
            const float v = work.damped[at];
            float& out = work.outer[at];
            out = v > t.toothFrom ? kBand : -kBand;
            if (v < darkest || v > brightest) continue;
            const Vec3 g = gradient(shape, soft, i, j, k);
            const double steep = g.norm();
            if (steep < flat) continue;
            const Vec3 n = g / steep, here(i, j, k);
            float inner = v, darkestNear = v;
            for (const double d : {0.8, 1.6, 2.4}) {
                inner = std::max(inner, sample(shape, work.damped, here + d * n));
                darkestNear = std::min(darkestNear, sample(shape, work.damped, here - d * n));
            }
            // A step inside the tooth (enamel beside a lesion) is none of the outline's.
            if (darkestNear > t.toothFrom - 0.3f * (t.toothFrom - t.outside)) continue;
            const float below = isGroundVaried ? std::clamp(darkestNear, t.outside, ground) : t.outside;
            inner = std::clamp(inner, t.dentine, t.enamel);
            const float f = (v - below) / (inner - below);
            out = std::clamp((f - 0.5f) * kSlope * static_cast<float>(work.sigma), -kBand, kBand);
        }
    });
    // What a neighbour or a person cuts off.
    const Field side = ownSide(teeth, chosen);
    const double perVoxel = work.spacingMm();
    work.held.assign(shape.count(), 0);
    const auto cut = [&](std::size_t at, double inside) {
        const float to =
            static_cast<float>(std::clamp(inside, -static_cast<double>(kBand), static_cast<double>(kBand)));
        if (to >= work.outer[at]) return;
        work.outer[at] = to;
        work.held[at] = kHeldCut;
    };
    if (!side.empty()) {
        Field fine(shape.count());
        forRows(shape, [&](int j, int k) {
            for (int i = 0; i < shape.size[0]; ++i)
                fine[shape.index(i, j, k)] = sample(
                    teeth.coarse.shape, side, teeth.coarse.fromVoxels(scan.toVoxels(work.grid.toMm(Vec3(i, j, k)))));
        });
        const Field nearer = nearerThanOther(shape, work.outer, fine);
        for (std::size_t n = 0; n < nearer.size(); ++n)
            cut(n, static_cast<double>(nearer[n]));
    }
    if (!settings.cutPlanes.empty())
        forRows(shape, [&](int j, int k) {
            for (int i = 0; i < shape.size[0]; ++i) {
                const Vec3 mm = work.grid.toMm(Vec3(i, j, k));
                for (const CutPlane& plane : settings.cutPlanes)
                    cut(shape.index(i, j, k), -plane.normal.normalized().dot(mm - plane.pointMm) / perVoxel);
            }
        });
    core::report(progress, 0.6);

    // The part that holds most of what the coarse look called this tooth.
    Mask mask(shape.count());
    for (std::size_t n = 0; n < mask.size(); ++n)
        mask[n] = work.outer[n] > 0;
    Parts parts = connectedParts(shape, mask);
    std::vector<std::size_t> votes(parts.counts.size(), 0);
    for (int k = 0; k < shape.size[2]; k += 2)
        for (int j = 0; j < shape.size[1]; j += 2)
            for (int i = 0; i < shape.size[0]; i += 2) {
                const std::uint32_t p = parts.of[shape.index(i, j, k)];
                if (p == 0) continue;
                const Vec3 block = teeth.coarse.fromVoxels(scan.toVoxels(work.grid.toMm(Vec3(i, j, k))));
                std::array<int, 3> b{};
                for (std::size_t axis = 0; axis < 3; ++axis)
                    b[axis] = std::clamp(static_cast<int>(std::lround(block[static_cast<int>(axis)])), 0,
                                         teeth.coarse.shape.size[axis] - 1);
                if (teeth.of[teeth.coarse.shape.index(b[0], b[1], b[2])] == chosen + 1) ++votes[p];
            }
    const auto best = static_cast<std::uint32_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
    if (best == 0) throw nothingFound("nothing of the tooth is brighter than its surroundings");
    for (std::size_t n = 0; n < mask.size(); ++n)
        mask[n] = parts.of[n] == best;
    core::report(progress, 0.7);
    const Mask cavity = closedCavities(shape, mask, work.spacingMm());
    core::report(progress, 0.9);
    for (std::size_t n = 0; n < cavity.size(); ++n)
        if (cavity[n]) work.held[n] = kHeldCavity;
    for (std::size_t n = 0; n < mask.size(); ++n) {
        float& out = work.outer[n];
        if (cavity[n])
            out = kBand;
        else if (!mask[n])
            out = std::min(out, parts.of[n] == 0 ? -0.01f : -kBand);
    }
    redistance(shape, work.outer, kBand);
}

}  // namespace handpiece::segmentation
