// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/distance_field.h"

#include <array>

#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::field {

using core::Vec3;

namespace {

/// A point in the grid: its brick, its cell in that brick, its place in that cell.
struct Place {
    std::size_t dense;
    int cell[3];
    double fraction[3];
};

Place placeOf(const Vec3& gridPoint, const std::int32_t (&bricks)[3]) noexcept {
    Place place;
    std::int32_t brick[3];
    for (int k = 0; k < 3; ++k) {
        // The last face of the grid belongs to the last cell.
        const int last = kBrickCells * bricks[k] - 1;
        const int cell = std::clamp(static_cast<int>(gridPoint[k]), 0, last);
        brick[k] = cell / kBrickCells;
        place.cell[k] = cell % kBrickCells;
        place.fraction[k] = std::clamp(gridPoint[k] - cell, 0.0, 1.0);
    }
    place.dense = static_cast<std::size_t>(brick[0]) +
                  static_cast<std::size_t>(bricks[0]) *
                      (static_cast<std::size_t>(brick[1]) +
                       static_cast<std::size_t>(bricks[1]) * static_cast<std::size_t>(brick[2]));
    return place;
}

bool isInside(const Vec3& gridPoint, const std::int32_t (&bricks)[3]) noexcept {
    for (int k = 0; k < 3; ++k)
        if (!(gridPoint[k] >= 0.0 && gridPoint[k] <= kBrickCells * bricks[k])) return false;
    return true;
}

const float* cellCorner(const std::vector<float>& values, std::int32_t brick, const Place& at) noexcept {
    return &values[static_cast<std::size_t>(brick) * kBrickValues +
                   static_cast<std::size_t>(at.cell[0] + kBrickNodes * (at.cell[1] + kBrickNodes * at.cell[2]))];
}

double mix(double a, double b, double t) noexcept {
    return a + t * (b - a);
}

double trilinear(const float* v, const double (&t)[3]) noexcept {
    constexpr int kY = kBrickNodes, kZ = kBrickNodes * kBrickNodes;
    const double low = mix(mix(v[0], v[1], t[0]), mix(v[kY], v[kY + 1], t[0]), t[1]);
    const double high = mix(mix(v[kZ], v[kZ + 1], t[0]), mix(v[kZ + kY], v[kZ + kY + 1], t[0]), t[1]);
    return mix(low, high, t[2]);
}

Vec3 trilinearGradient(const float* v, const double (&t)[3]) noexcept {
    constexpr int kY = kBrickNodes, kZ = kBrickNodes * kBrickNodes;
    const auto at = [&](int x, int y, int z) { return static_cast<double>(v[x + kY * y + kZ * z]); };
    const auto across = [&](auto&& difference, double s, double u) {
        return mix(mix(difference(0, 0), difference(1, 0), s), mix(difference(0, 1), difference(1, 1), s), u);
    };
    return {across([&](int a, int b) { return at(1, a, b) - at(0, a, b); }, t[1], t[2]),
            across([&](int a, int b) { return at(a, 1, b) - at(a, 0, b); }, t[0], t[2]),
            across([&](int a, int b) { return at(a, b, 1) - at(a, b, 0); }, t[0], t[1])};
}

}  // namespace

std::vector<cases::Tissue> BrickTissues::tissues() const {
    bool seen[256] = {};
    for (const std::uint32_t first : start)
        if (first < kShared) seen[nodes[first]] = true;
    for (std::size_t i = kShared; i < nodes.size(); ++i)
        seen[nodes[i]] = true;
    std::vector<cases::Tissue> found;
    for (std::size_t i = 1; i < cases::kTissueCount; ++i)
        if (seen[i]) found.push_back(static_cast<cases::Tissue>(i));
    return found;
}

double DistanceField::distance(const Vec3& p) const noexcept {
    const double h = s_.settings.voxelMm;
    const Vec3 u = (p - s_.originMm) / h;
    if (isInside(u, s_.bricks)) return distanceInGrid(u);
    // The surface lies in the grid's box: nothing is nearer than the box. Points that are no numbers are far away.
    if (!p.allFinite()) return std::numeric_limits<double>::infinity();
    const Vec3 top(kBrickCells * s_.bricks[0], kBrickCells * s_.bricks[1], kBrickCells * s_.bricks[2]);
    const Vec3 nearest = u.cwiseMax(Vec3::Zero()).cwiseMin(top);
    const double toBox = h * (u - nearest).stableNorm();
    // A distance averaged over a cell's corners is off by less than a voxel.
    return std::max(toBox, distanceInGrid(nearest) - h - toBox);
}

double DistanceField::distanceInGrid(const Vec3& gridPoint) const noexcept {
    const Place at = placeOf(gridPoint, s_.bricks);
    const std::int32_t brick = s_.brickIndex[at.dense];
    if (brick >= 0) return trilinear(cellCorner(s_.values, brick, at), at.fraction);
    const double centre = s_.coarse[at.dense];
    Vec3 away;
    for (int k = 0; k < 3; ++k)
        away[k] = at.cell[k] + at.fraction[k] - 0.5 * kBrickCells;
    // A hair less than the triangle inequality gives, for the rounding of the centre's value to float.
    const double magnitude = std::max(0.0, std::abs(centre) * (1.0 - 1e-6) - s_.settings.voxelMm * away.norm());
    return centre < 0.0 ? -magnitude : magnitude;
}

bool DistanceField::isFine(const Vec3& p) const noexcept {
    const Vec3 u = (p - s_.originMm) / s_.settings.voxelMm;
    return isInside(u, s_.bricks) && s_.brickIndex[placeOf(u, s_.bricks).dense] >= 0;
}

Vec3 DistanceField::normal(const Vec3& p) const noexcept {
    const Vec3 u = (p - s_.originMm) / s_.settings.voxelMm;
    if (!isInside(u, s_.bricks)) return Vec3::Zero();
    const Place at = placeOf(u, s_.bricks);
    const std::int32_t brick = s_.brickIndex[at.dense];
    if (brick < 0) return Vec3::Zero();
    // Differences over a whole voxel are continuous from cell to cell, the trilinear gradient is not.
    Vec3 gradient;
    bool whole = true;
    for (int k = 0; k < 3 && whole; ++k) {
        double side[2];
        for (int s = 0; s < 2 && whole; ++s) {
            Vec3 v = u;
            v[k] += s == 0 ? -0.5 : 0.5;
            whole = isInside(v, s_.bricks);
            if (!whole) break;
            const Place there = placeOf(v, s_.bricks);
            whole = s_.brickIndex[there.dense] >= 0;
            if (whole) side[s] = trilinear(cellCorner(s_.values, s_.brickIndex[there.dense], there), there.fraction);
        }
        if (whole) gradient[k] = side[1] - side[0];
    }
    if (!whole) gradient = trilinearGradient(cellCorner(s_.values, brick, at), at.fraction);
    const double length = gradient.norm();
    return length > 0.0 ? Vec3(gradient / length) : Vec3::Zero();
}

cases::Tissue DistanceField::tissueAt(const Vec3& p) const noexcept {
    const Vec3 u = (p - s_.originMm) / s_.settings.voxelMm;
    if (!isInside(u, s_.bricks)) return cases::Tissue::none;
    const Place at = placeOf(u, s_.bricks);
    const std::int32_t brick = s_.brickIndex[at.dense];
    const std::uint8_t* tissues = s_.tissues->of(at.dense);
    if (brick < 0) return static_cast<cases::Tissue>(tissues[kCentreNode]);
    int node[3];
    for (int k = 0; k < 3; ++k)
        node[k] = at.cell[k] + (at.fraction[k] >= 0.5 ? 1 : 0);
    return static_cast<cases::Tissue>(tissues[node[0] + kBrickNodes * (node[1] + kBrickNodes * node[2])]);
}

FieldView DistanceField::view() const noexcept {
    FieldView v{};
    for (int k = 0; k < 3; ++k) {
        v.originMm[k] = s_.originMm[k];
        v.bricks[k] = s_.bricks[k];
    }
    v.voxelMm = s_.settings.voxelMm;
    v.inverseVoxelMm = 1.0 / s_.settings.voxelMm;
    v.brickIndex = s_.brickIndex.data();
    v.values = s_.values.data();
    v.coarse = s_.coarse.data();
    v.tissueStart = s_.tissues->start.data();
    v.tissue = s_.tissues->nodes.data();
    return v;
}

core::Box DistanceField::bounds() const noexcept {
    const double edge = kBrickCells * s_.settings.voxelMm;
    return {s_.originMm, s_.originMm + Vec3(edge * s_.bricks[0], edge * s_.bricks[1], edge * s_.bricks[2])};
}

std::size_t DistanceField::memoryBytes() const noexcept {
    return s_.values.size() * sizeof(float) + s_.brickIndex.size() * sizeof(std::int32_t) +
           s_.coarse.size() * sizeof(float) + s_.tissues->memoryBytes();
}

std::uint64_t DistanceField::stateHash() const {
    core::Hasher hasher;
    hasher.add(s_.settings.voxelMm);
    hasher.add(s_.settings.bandOutMm);
    hasher.add(s_.settings.bandInMm);
    for (int k = 0; k < 3; ++k) {
        hasher.add(s_.originMm[k]);
        hasher.add(s_.bricks[k]);
    }
    hasher.add(std::as_bytes(std::span(s_.brickIndex)));
    hasher.add(std::as_bytes(std::span(s_.values)));
    hasher.add(std::as_bytes(std::span(s_.coarse)));
    // Node by node of the stored bricks, and at every brick's centre inside.
    std::vector<std::uint8_t> tissues, atCentre(s_.coarse.size(), 0);
    tissues.reserve(s_.values.size());
    for (std::size_t i = 0; i < s_.coarse.size(); ++i) {
        const std::uint8_t* nodes = s_.tissues->of(i);
        if (s_.brickIndex[i] >= 0) tissues.insert(tissues.end(), nodes, nodes + kBrickValues);
        if (s_.coarse[i] < 0.0f) atCentre[i] = nodes[kCentreNode];
    }
    hasher.add(std::as_bytes(std::span(tissues)));
    hasher.add(std::as_bytes(std::span(atCentre)));
    return hasher.value();
}

}  // namespace handpiece::field
