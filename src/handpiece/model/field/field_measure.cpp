// SPDX-License-Identifier: Apache-2.0
/// @file
/// Volume and area of the field, cell by cell: each cell as six tetrahedra in which the distance is taken as linear.
#include <numeric>

#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/distance_field.h"

namespace handpiece::field {
namespace {

using core::Vec3;

struct Measure {
    double volume = 0.0, area = 0.0;  // in voxels cubed and squared
};

/// Corner k of a cell is (k & 1, k >> 1 & 1, k >> 2): Kuhn's six tetrahedra about the diagonal 0-7, alike in every
/// cell, so that neighbouring cells fit together.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};

Vec3 corner(int k) {
    return {static_cast<double>(k & 1), static_cast<double>(k >> 1 & 1), static_cast<double>(k >> 2)};
}

void addTetrahedron(const int (&corners)[4], const double (&value)[8], Measure& sum) {
    int inside[4], outside[4], in = 0, out = 0;
    for (const int c : corners)
        (value[c] < 0.0 ? inside[in++] : outside[out++]) = c;
    constexpr double kWhole = 1.0 / 6.0;
    if (in == 0) return;
    if (in == 4) {
        sum.volume += kWhole;
        return;
    }
    const auto crossing = [&](int a, int b) {
        return Vec3(corner(a) + value[a] / (value[a] - value[b]) * (corner(b) - corner(a)));
    };
    const auto triangleArea = [](const Vec3& a, const Vec3& b, const Vec3& c) {
        return 0.5 * (b - a).cross(c - a).norm();
    };
    const auto tipVolume = [&](int tip, const int(&base)[3]) {
        double share = kWhole;
        for (const int b : base)
            share *= value[tip] / (value[tip] - value[b]);
        return share;
    };
    if (in == 1 || in == 3) {
        const int tip = in == 1 ? inside[0] : outside[0];
        const int* other = in == 1 ? outside : inside;
        const int base[3] = {other[0], other[1], other[2]};
        sum.volume += in == 1 ? tipVolume(tip, base) : kWhole - tipVolume(tip, base);
        sum.area += triangleArea(crossing(tip, base[0]), crossing(tip, base[1]), crossing(tip, base[2]));
        return;
    }
    // Two inside: a wedge of three tetrahedra over the quadrilateral cut.
    const Vec3 a = corner(inside[0]), b = corner(inside[1]);
    const Vec3 ac = crossing(inside[0], outside[0]), ad = crossing(inside[0], outside[1]),
               bc = crossing(inside[1], outside[0]), bd = crossing(inside[1], outside[1]);
    const auto volume = [](const Vec3& o, const Vec3& p, const Vec3& q, const Vec3& r) {
        return std::abs((p - o).dot((q - o).cross(r - o))) / 6.0;
    };
    sum.volume += volume(a, b, bc, bd) + volume(a, ac, ad, bd) + volume(a, ac, bc, bd);
    sum.area += triangleArea(ac, ad, bd) + triangleArea(ac, bd, bc);
}

Measure brickMeasure(const float* values) {
    Measure sum;
    for (int z = 0; z < kBrickCells; ++z)
        for (int y = 0; y < kBrickCells; ++y)
            for (int x = 0; x < kBrickCells; ++x) {
                double value[8];
                int inside = 0;
                for (int k = 0; k < 8; ++k) {
                    value[k] =
                        values[(x + (k & 1)) + kBrickNodes * ((y + (k >> 1 & 1)) + kBrickNodes * (z + (k >> 2)))];
                    inside += value[k] < 0.0 ? 1 : 0;
                }
                if (inside == 0) continue;
                if (inside == 8) {
                    sum.volume += 1.0;
                    continue;
                }
                for (const auto& tetrahedron : kTetrahedra)
                    addTetrahedron(tetrahedron, value, sum);
            }
    return sum;
}

Measure fieldMeasure(const FieldView& view, std::size_t stored, std::size_t dense) {
    std::vector<Measure> bricks(stored);
    core::parallelFor(stored, 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            bricks[i] = brickMeasure(view.values + i * kBrickValues);
    });
    Measure sum;
    for (const Measure& brick : bricks) {
        sum.volume += brick.volume;
        sum.area += brick.area;
    }
    constexpr double kBrickVolume = kBrickCells * kBrickCells * kBrickCells;
    for (std::size_t i = 0; i < dense; ++i)
        if (view.brickIndex[i] < 0 && view.coarse[i] < 0.0f) sum.volume += kBrickVolume;
    return sum;
}

}  // namespace

DistanceField::Extent DistanceField::extent() const {
    const Measure sum = fieldMeasure(view(), brickCount(), s_.coarse.size());
    const double h = s_.settings.voxelMm;
    return {sum.volume * h * h * h, sum.area * h * h};
}

double DistanceField::volumeMm3() const {
    return extent().volumeMm3;
}

double DistanceField::areaMm2() const {
    return extent().areaMm2;
}

}  // namespace handpiece::field
