// SPDX-License-Identifier: Apache-2.0
// One tooth out of the labels of a mouth.
#include <algorithm>
#include <cmath>

#include "handpiece/scan/segmentation/label_key.h"
#include "handpiece/scan/segmentation/voxels.h"

namespace handpiece::segmentation {
namespace {

using What = LabelMeaning::What;
using core::Vec3;

constexpr std::uint8_t kHard = 2, kPulp = 4;
/// Slices so much farther apart than pixels leave steps that smoothing by voxels does not take away.
constexpr double kFarApart = 1.2;
constexpr double kAlike = 1.05;

/// The axis along which voxels are longer, if they are alike along the other two.
int longAxisOf(const Vec3& spacingMm) {
    int longest = 0;
    spacingMm.maxCoeff(&longest);
    const double a = spacingMm[(longest + 1) % 3], b = spacingMm[(longest + 2) % 3];
    const bool isFar = spacingMm[longest] > kFarApart * std::max(a, b);
    return isFar && std::max(a, b) < kAlike * std::min(a, b) ? longest : -1;
}

/// Distances to the outline in each slice, in its pixels, negative inside; and which slices are empty.
struct Outlines {
    std::vector<Field> distance;
    std::vector<std::uint8_t> isEmpty;
};

Outlines outlinesOf(const Shape& shape, const Mask& mask, std::size_t axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Shape slice{{shape.size[u], shape.size[v], 1}};
    Outlines outlines;
    for (int k = 0; k < shape.size[axis]; ++k) {
        Mask in(slice.count()), out(slice.count());
        bool any = false;
        for (int b = 0; b < slice.size[1]; ++b)
            for (int a = 0; a < slice.size[0]; ++a) {
                std::array<int, 3> at{};
                at[axis] = k;
                at[u] = a;
                at[v] = b;
                const std::size_t n = slice.index(a, b, 0);
                in[n] = mask[shape.index(at[0], at[1], at[2])];
                out[n] = !in[n];
                any = any || in[n];
            }
        Field to = squaredDistance(slice, in);
        const Field from = squaredDistance(slice, out);
        for (std::size_t n = 0; n < to.size(); ++n)
            to[n] = in[n] ? 0.5f - std::sqrt(from[n]) : std::sqrt(to[n]) - 0.5f;
        outlines.distance.push_back(std::move(to));
        outlines.isEmpty.push_back(any ? 0 : 1);
    }
    return outlines;
}

/// Outlines that turn into one another from slice to slice, `ratio` new slices to an old one.
Mask filledIn(const Shape& shape, const Mask& mask, std::size_t axis, double ratio, const Shape& to) {
    const Outlines outlines = outlinesOf(shape, mask, axis);
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Shape slice{{shape.size[u], shape.size[v], 1}};
    const auto end = static_cast<float>(ratio);
    Mask made(to.count());
    for (int k = 0; k < to.size[axis]; ++k) {
        const double place = k / ratio;
        const int low = std::min(static_cast<int>(place), shape.size[axis] - 1);
        const int high = std::min(low + 1, shape.size[axis] - 1);
        const auto f = static_cast<float>(place - low);
        const auto l = static_cast<std::size_t>(low), h = static_cast<std::size_t>(high);
        for (int b = 0; b < slice.size[1]; ++b)
            for (int a = 0; a < slice.size[0]; ++a) {
                const std::size_t n = slice.index(a, b, 0);
                float first = outlines.distance[l][n], second = outlines.distance[h][n];
                // Where it ends, it does so about half-way to the next slice, its middle farther on than its rim.
                if (outlines.isEmpty[l] || outlines.isEmpty[h]) {
                    first = outlines.isEmpty[l] ? end : std::max(first, -2.0f * end);
                    second = outlines.isEmpty[h] ? end : std::max(second, -2.0f * end);
                }
                std::array<int, 3> at{};
                at[axis] = k;
                at[u] = a;
                at[v] = b;
                made[to.index(at[0], at[1], at[2])] = (1 - f) * first + f * second < 0.0f;
            }
    }
    return made;
}

}  // namespace

ToothAlone alone(const volume::Labels& labels, const LabelKey& key, const LabelledTooth& tooth) {
    const volume::Grid& grid = labels.grid;
    ToothAlone made;
    made.fdi = tooth.fdi;
    volume::Grid& own = made.labels.grid;
    own = grid;
    // A layer of nothing around it: where the tooth ends, its slices do.
    constexpr int kMargin = 1;
    for (std::size_t a = 0; a < 3; ++a)
        own.size[a] = tooth.high[a] - tooth.low[a] + 1 + 2 * kMargin;
    const Vec3 first(tooth.low[0] - kMargin, tooth.low[1] - kMargin, tooth.low[2] - kMargin);
    own.originMm = grid.toMm(first);
    Shape shape{own.size};
    Mask solid(shape.count(), 0), pulp;
    if (tooth.hasPulp) pulp.assign(shape.count(), 0);
    for (int k = tooth.low[2]; k <= tooth.high[2]; ++k)
        for (int j = tooth.low[1]; j <= tooth.high[1]; ++j)
            for (int i = tooth.low[0]; i <= tooth.high[0]; ++i) {
                const LabelMeaning meaning = key.of[labels.values[grid.index(i, j, k)]];
                if (meaning.number != tooth.fdi || (meaning.what != What::tooth && meaning.what != What::pulp))
                    continue;
                const std::size_t at =
                    shape.index(i - tooth.low[0] + kMargin, j - tooth.low[1] + kMargin, k - tooth.low[2] + kMargin);
                solid[at] = 1;
                if (meaning.what == What::pulp) pulp[at] = 1;
            }
    const Parts parts = connectedParts(shape, solid);
    const std::uint32_t largest = parts.largest();
    made.pieces = parts.counts.size() - 1;
    for (std::size_t n = 0; n < solid.size(); ++n)
        if (solid[n] && parts.of[n] != largest) {
            solid[n] = 0;
            if (!pulp.empty()) pulp[n] = 0;
            made.leftOutMm3 += grid.voxelMm3();
        }
    if (const int axis = longAxisOf(own.spacingMm); axis >= 0) {
        const auto along = static_cast<std::size_t>(axis);
        const double ratio = own.spacingMm[axis] / own.spacingMm.minCoeff();
        Shape finer = shape;
        finer.size[along] = static_cast<int>((shape.size[along] - 1) * ratio) + 1;
        solid = filledIn(shape, solid, along, ratio, finer);
        if (!pulp.empty()) pulp = filledIn(shape, pulp, along, ratio, finer);
        shape = finer;
        own.size = finer.size;
        own.spacingMm[axis] = own.spacingMm.minCoeff();
        made.isFilledIn = true;
    }
    made.labels.values.resize(shape.count());
    for (std::size_t n = 0; n < solid.size(); ++n)
        made.labels.values[n] = !solid[n] ? 0 : !pulp.empty() && pulp[n] ? kPulp : kHard;
    return made;
}

}  // namespace handpiece::segmentation
