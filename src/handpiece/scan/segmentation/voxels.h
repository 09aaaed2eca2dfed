// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What every stage does to a block of voxels: blur, damp, distances, connected parts. Private to this room.

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "handpiece/base/core/progress.h"
#include "handpiece/base/core/vec.h"

namespace handpiece::segmentation {

/// A block's extent; i fastest.
struct Shape {
    std::array<int, 3> size{};

    [[nodiscard]] std::size_t rowStride() const { return static_cast<std::size_t>(size[0]); }
    [[nodiscard]] std::size_t sliceStride() const { return rowStride() * static_cast<std::size_t>(size[1]); }
    [[nodiscard]] std::size_t count() const { return sliceStride() * static_cast<std::size_t>(size[2]); }
    [[nodiscard]] std::size_t index(int i, int j, int k) const {
        return static_cast<std::size_t>(k) * sliceStride() + static_cast<std::size_t>(j) * rowStride() +
               static_cast<std::size_t>(i);
    }
    [[nodiscard]] std::array<int, 3> at(std::size_t index) const {
        const std::size_t slice = index / sliceStride(), rest = index % sliceStride();
        return {static_cast<int>(rest % rowStride()), static_cast<int>(rest / rowStride()), static_cast<int>(slice)};
    }
};

using Field = std::vector<float>;
using Mask = std::vector<std::uint8_t>;

/// body(j, k) for every row, in parallel.
void forRows(const Shape& shape, const std::function<void(int, int)>& body);

/// How many voxels away blur() looks.
[[nodiscard]] int blurReach(double sigma);
/// Gaussian of `sigma` voxels, edges repeated. `in` and `out` may be the same; `scratch` is given its size.
void blur(const Shape& shape, const Field& in, Field& out, Field& scratch, double sigma);

/// Standard deviation, from what a voxel differs from the mean of its neighbours along i; edges are the exception.
[[nodiscard]] float noiseOf(const Shape& shape, const Field& values);

/// Diffusion that stops at steps above `kappa` (Perona and Malik 1990), 6 neighbours.
void dampKeepingEdges(const Shape& shape, Field& values, Field& scratch, float kappa, int rounds);

/// Linear between voxel centres, edges repeated.
[[nodiscard]] float sample(const Shape& shape, const Field& values, const core::Vec3& at);
/// Central differences; one-sided at the edges.
[[nodiscard]] core::Vec3 gradient(const Shape& shape, const Field& values, int i, int j, int k);

/// Squared distance in voxels to the nearest set voxel (Felzenszwalb and Huttenlocher 2012); 1e12 where none is set.
[[nodiscard]] Field squaredDistance(const Shape& shape, const Mask& mask);

/// Connected parts (6 neighbours) of what is set: 0 nothing, 1.. in the order of their first voxel.
struct Parts {
    std::vector<std::uint32_t> of;    ///< a voxel
    std::vector<std::size_t> counts;  ///< a part; [0] is nothing
    [[nodiscard]] std::uint32_t largest() const;
};
[[nodiscard]] Parts connectedParts(const Shape& shape, const Mask& mask);

/// One erosion or dilation by the 6 neighbours; beyond the edge counts as the edge.
[[nodiscard]] Mask eroded(const Shape& shape, const Mask& mask);
[[nodiscard]] Mask dilated(const Shape& shape, const Mask& mask);

/// Calls visit(neighbour's index) for the 6 neighbours inside.
template <class Visit>
void forNeighbours(const Shape& shape, std::size_t index, const Visit& visit) {
    const auto [i, j, k] = shape.at(index);
    if (i > 0) visit(index - 1);
    if (i + 1 < shape.size[0]) visit(index + 1);
    if (j > 0) visit(index - shape.rowStride());
    if (j + 1 < shape.size[1]) visit(index + shape.rowStride());
    if (k > 0) visit(index - shape.sliceStride());
    if (k + 1 < shape.size[2]) visit(index + shape.sliceStride());
}

/// Makes a function with the right zero into a distance in voxels near it, clamped to +-band.
void redistance(const Shape& shape, Field& values, float band);

/// The share of a voxel that a solid fills, by its distance in voxels at the centre.
[[nodiscard]] inline float coverage(float inside) {
    const float c = inside + 0.5f;
    return c < 0 ? 0.0f : (c > 1 ? 1.0f : c);
}

}  // namespace handpiece::segmentation
