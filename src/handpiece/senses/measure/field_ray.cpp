// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/measure/field_ray.h"

#include <algorithm>
#include <cmath>

namespace handpiece::measure {
namespace {

using core::Vec3;
using field::kBrickCells;
using field::kBrickNodes;

constexpr int kY = kBrickNodes, kZ = kBrickNodes * kBrickNodes;

double mix(double a, double b, double t) {
    return a + t * (b - a);
}

double trilinear(const float* v, const double (&t)[3]) {
    const double low = mix(mix(v[0], v[1], t[0]), mix(v[kY], v[kY + 1], t[0]), t[1]);
    const double high = mix(mix(v[kZ], v[kZ + 1], t[0]), mix(v[kZ + kY], v[kZ + kY + 1], t[0]), t[1]);
    return mix(low, high, t[2]);
}

bool mayBeZero(const float* v) {
    const float all[8] = {v[0], v[1], v[kY], v[kY + 1], v[kZ], v[kZ + 1], v[kZ + kY], v[kZ + kY + 1]};
    const auto [low, high] = std::minmax_element(all, all + 8);
    return *low < 0.0f && *high >= 0.0f;
}

/// The trilinear field of a cell along a line is a cubic of the way along it.
struct Cubic {
    double c[4];
    [[nodiscard]] double at(double s) const { return c[0] + s * (c[1] + s * (c[2] + s * c[3])); }
};

Cubic alongLine(const float* v, const double (&from)[3], const double (&d)[3]) {
    const double n[8] = {v[0], v[1], v[kY], v[kY + 1], v[kZ], v[kZ + 1], v[kZ + kY], v[kZ + kY + 1]};
    // f = k0 + kx x + ky y + kz z + kxy xy + kyz yz + kxz xz + kxyz xyz
    const double k0 = n[0], kx = n[1] - n[0], ky = n[2] - n[0], kz = n[4] - n[0];
    const double kxy = n[3] - n[1] - n[2] + n[0], kxz = n[5] - n[1] - n[4] + n[0], kyz = n[6] - n[2] - n[4] + n[0];
    const double kxyz = n[7] - n[6] - n[5] - n[3] + n[1] + n[2] + n[4] - n[0];
    const double x = from[0], y = from[1], z = from[2], dx = d[0], dy = d[1], dz = d[2];
    return {{k0 + kx * x + ky * y + kz * z + kxy * x * y + kyz * y * z + kxz * x * z + kxyz * x * y * z,
             kx * dx + ky * dy + kz * dz + kxy * (x * dy + y * dx) + kyz * (y * dz + z * dy) + kxz * (x * dz + z * dx) +
                 kxyz * (x * y * dz + x * z * dy + y * z * dx),
             kxy * dx * dy + kyz * dy * dz + kxz * dx * dz + kxyz * (x * dy * dz + y * dx * dz + z * dx * dy),
             kxyz * dx * dy * dz}};
}

/// Where in [0, length] the cubic first is inside (negative) or outside, whichever `inside` is not.
std::optional<double> firstChange(const Cubic& f, double length, bool inside) {
    const auto changed = [&](double s) { return (f.at(s) < 0.0) != inside; };
    if (changed(0.0)) return 0.0;
    // Between its turns the cubic runs one way.
    double stops[3] = {length, length, length};
    const double a = 3.0 * f.c[3], b = 2.0 * f.c[2], c = f.c[1], inner = b * b - 4.0 * a * c;
    if (inner > 0.0) {
        const double q = -0.5 * (b + std::copysign(std::sqrt(inner), b));
        const double roots[2] = {a != 0.0 ? q / a : length, q != 0.0 ? c / q : length};
        for (int i = 0; i < 2; ++i)
            if (roots[i] > 0.0 && roots[i] < length) stops[i] = roots[i];
        if (stops[0] > stops[1]) std::swap(stops[0], stops[1]);
    }
    double low = 0.0;
    for (const double stop : stops) {
        if (!changed(stop)) {
            low = stop;
            continue;
        }
        double high = stop;
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (low + high);
            (changed(middle) ? high : low) = middle;
        }
        return 0.5 * (low + high);
    }
    return {};
}

}  // namespace

FieldRay::FieldRay(const tooth::ToothMirror& mirror)
    : mirror_(mirror),
      uncut_(mirror.model().field),
      view_(uncut_.view()),
      originMm_(view_.originMm[0], view_.originMm[1], view_.originMm[2]),
      bandMm_(std::min(mirror.model().settings.bandMm, uncut_.settings().bandInMm)) {}

const float* FieldRay::nodes(std::uint32_t dense) const {
    if (mirror_.isChanged(dense)) return mirror_.values(dense, nullptr);
    const std::int32_t stored = view_.brickIndex[dense];
    return stored >= 0 ? view_.values + static_cast<std::size_t>(stored) * field::kBrickValues : nullptr;
}

bool FieldRay::isInGrid(const Vec3& u) const {
    for (int k = 0; k < 3; ++k)
        if (!(u[k] >= 0.0 && u[k] <= kBrickCells * view_.bricks[k])) return false;
    return true;
}

FieldRay::Place FieldRay::placeOf(const Vec3& u) const {
    Place place{};
    std::int32_t brick[3];
    for (int k = 0; k < 3; ++k) {
        const int cell = std::clamp(static_cast<int>(u[k]), 0, kBrickCells * view_.bricks[k] - 1);
        brick[k] = cell / kBrickCells;
        place.cell[k] = cell % kBrickCells;
        place.fraction[k] = u[k] - cell;
    }
    place.dense = static_cast<std::uint32_t>(brick[0] + view_.bricks[0] * (brick[1] + view_.bricks[1] * brick[2]));
    return place;
}

std::optional<double> FieldRay::valueAt(const Vec3& u) const {
    if (!isInGrid(u)) return {};
    const Place at = placeOf(u);
    const float* v = nodes(at.dense);
    if (v == nullptr) return {};
    return trilinear(v + at.cell[0] + kY * at.cell[1] + kZ * at.cell[2], at.fraction);
}

double FieldRay::signedDistanceMm(const Vec3& p) const {
    const Vec3 u = (p - originMm_) * view_.inverseVoxelMm;
    if (const std::optional<double> value = valueAt(u)) return std::max(*value, -bandMm_);
    if (!isInGrid(u)) return uncut_.distance(p);
    // What is far from the surface stays so until its brick is cut; then it has nodes.
    if (isDeep(placeOf(u).dense)) return -bandMm_;
    return std::max(uncut_.settings().bandOutMm, uncut_.distance(p));
}

Vec3 FieldRay::normal(const Vec3& p) const {
    const Vec3 u = (p - originMm_) * view_.inverseVoxelMm;
    // Differences over a whole voxel are continuous from cell to cell, the trilinear gradient is not.
    Vec3 gradient;
    for (int k = 0; k < 3; ++k) {
        Vec3 low = u, high = u;
        low[k] -= 0.5;
        high[k] += 0.5;
        const std::optional<double> here = valueAt(u), below = valueAt(low), above = valueAt(high);
        if (below && above) {
            gradient[k] = *above - *below;
        } else if (here && (below || above)) {
            gradient[k] = 2.0 * (above ? *above - *here : *here - *below);
        } else {
            gradient[k] = 0.0;
        }
    }
    const double length = gradient.norm();
    return length > 0.0 ? Vec3(gradient / length) : Vec3(Vec3::Zero());
}

std::optional<double> FieldRay::firstZeroMm(const Vec3& originMm, const Vec3& direction, double farMm) const {
    // All in voxels from the grid's origin; the way along the ray too.
    const Vec3 o = (originMm - originMm_) * view_.inverseVoxelMm;
    double begin = 0.0, end = farMm * view_.inverseVoxelMm;
    int cells[3];
    for (int k = 0; k < 3; ++k) {
        cells[k] = kBrickCells * view_.bricks[k];
        if (direction[k] == 0.0) {
            if (!(o[k] >= 0.0 && o[k] <= cells[k])) return {};
            continue;
        }
        const double a = (0.0 - o[k]) / direction[k], b = (cells[k] - o[k]) / direction[k];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    if (!(begin < end)) return {};

    int cell[3];
    const auto enterAt = [&](double t) {
        for (int k = 0; k < 3; ++k)
            cell[k] = std::clamp(static_cast<int>(o[k] + t * direction[k]), 0, cells[k] - 1);
    };
    /// Out of the box [low, high) of cells: the way along, and through which side.
    const auto leaves = [&](const int(&low)[3], const int(&high)[3], int& axis) {
        double t = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            if (direction[k] == 0.0) continue;
            const double at = ((direction[k] > 0.0 ? high[k] : low[k]) - o[k]) / direction[k];
            if (at < t) {
                t = at;
                axis = k;
            }
        }
        return t;
    };
    enterAt(begin);
    double t = begin;
    std::optional<bool> inside;
    while (t < end) {
        const int brick[3] = {cell[0] / kBrickCells, cell[1] / kBrickCells, cell[2] / kBrickCells};
        const auto dense =
            static_cast<std::uint32_t>(brick[0] + view_.bricks[0] * (brick[1] + view_.bricks[1] * brick[2]));
        const float* v = nodes(dense);
        int axis = 0;
        if (v == nullptr) {
            const bool deep = isDeep(dense);
            if (!inside) inside = deep;
            if (deep != *inside) return t * view_.voxelMm;
            int low[3], high[3];
            for (int k = 0; k < 3; ++k) {
                low[k] = kBrickCells * brick[k];
                high[k] = low[k] + kBrickCells;
            }
            t = std::max(t, leaves(low, high, axis));
            const int next = direction[axis] > 0.0 ? high[axis] : low[axis] - 1;
            if (next < 0 || next >= cells[axis]) return {};
            enterAt(t);
            for (int k = 0; k < 3; ++k)
                cell[k] = std::clamp(cell[k], low[k], high[k] - 1);
            cell[axis] = next;
            continue;
        }
        const int high[3] = {cell[0] + 1, cell[1] + 1, cell[2] + 1};
        const double out = std::max(t, leaves(cell, high, axis));
        const float* corner = v + (cell[0] - kBrickCells * brick[0]) + kY * (cell[1] - kBrickCells * brick[1]) +
                              kZ * (cell[2] - kBrickCells * brick[2]);
        if (!inside || mayBeZero(corner) || (corner[0] < 0.0f) != *inside) {
            double from[3], d[3];
            for (int k = 0; k < 3; ++k) {
                from[k] = std::clamp(o[k] + t * direction[k] - cell[k], 0.0, 1.0);
                d[k] = direction[k];
            }
            const Cubic f = alongLine(corner, from, d);
            if (!inside) inside = f.at(0.0) < 0.0;
            if (const std::optional<double> s = firstChange(f, std::min(out, end) - t, *inside))
                return (t + *s) * view_.voxelMm;
        }
        t = out;
        cell[axis] += direction[axis] > 0.0 ? 1 : -1;
        if (cell[axis] < 0 || cell[axis] >= cells[axis]) return {};
    }
    return {};
}

}  // namespace handpiece::measure
