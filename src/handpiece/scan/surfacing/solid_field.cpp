// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/surfacing/solid_field.h"

#include <algorithm>
#include <cmath>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/isosurface.h"

namespace handpiece::surfacing {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr double kMaxStandOutMm = 0.04;
constexpr double kStandOutVoxels = 0.35;  // less than half a voxel, so that enamel of one voxel is not swallowed
constexpr double kPulpGapVoxels = 0.25;   // in the field; the mesh is held to the least gap afterwards
constexpr std::size_t kGrain = std::size_t{1} << 16;

/// Where the cubic through values at -1, 0, 1, 2 crosses zero between 0 and 1, about the line's own crossing.
double cubicCrossing(const double (&v)[4]) {
    const double line = v[1] / (v[1] - v[2]);
    const double c3 = (v[3] - 3.0 * v[2] + 3.0 * v[1] - v[0]) / 6.0, c2 = 0.5 * (v[0] + v[2]) - v[1],
                 c1 = v[2] - v[0] / 3.0 - 0.5 * v[1] - v[3] / 6.0, c0 = v[1];
    double low = 0.0, high = 1.0, t = line;
    for (int i = 0; i < 6; ++i) {
        const double value = ((c3 * t + c2) * t + c1) * t + c0, slope = (3.0 * c3 * t + 2.0 * c2) * t + c1;
        // The sign at 0 is that of c0: keep the crossing between low and high whatever the slope says.
        ((value < 0.0) == (c0 < 0.0) ? low : high) = t;
        const double next = t - value / slope;
        t = next > low && next < high ? next : 0.5 * (low + high);
    }
    // A field with a crease or clamped beside the edge has no cubic: stay near the line.
    return std::clamp(t, line - 0.15, line + 0.15);
}

}  // namespace

double standOutMm(double voxelMm) {
    return std::min(kMaxStandOutMm, kStandOutVoxels * voxelMm);
}

std::vector<float> fieldOf(const segmentation::Region& region, std::size_t index, const std::vector<float>& outer) {
    const segmentation::Solid& solid = region.solids[index];
    const std::vector<float>& distance = solid.distanceMm;
    const double voxelMm = region.grid.spacingMm.x();
    const auto standOut = static_cast<float>(standOutMm(voxelMm));
    const auto gap = static_cast<float>(kPulpGapVoxels * voxelMm);
    const std::vector<float>* dentine = nullptr;
    for (const segmentation::Solid& other : region.solids)
        if (other.tissue == Tissue::dentine) dentine = &other.distanceMm;
    std::vector<float> field(outer.size());
    core::parallelFor(field.size(), kGrain, [&](std::size_t b, std::size_t e) {
        for (std::size_t i = b; i < e; ++i) {
            if (solid.tissue == Tissue::pulp) {
                const float around = dentine ? std::max(outer[i], (*dentine)[i]) : outer[i];
                field[i] = std::max(distance[i], around + gap);
            } else {
                // What covers it here is as thick as the two distances differ: where that is nothing it stands out.
                const float cover = (distance[i] - outer[i]) / (2.0f * standOut);
                field[i] = std::max(distance[i] - standOut * std::clamp(1.0f - cover, 0.0f, 1.0f), outer[i] - standOut);
            }
        }
    });
    return field;
}

void keepInTooth(std::vector<float>& field, const std::vector<float>& outer, double voxelMm) {
    const auto standOut = static_cast<float>(standOutMm(voxelMm));
    core::parallelFor(field.size(), kGrain, [&](std::size_t b, std::size_t e) {
        for (std::size_t i = b; i < e; ++i)
            field[i] = std::max(field[i], outer[i] - standOut);
    });
}

void evenOut(std::vector<float>& field, const std::array<int, 3>& size, double voxelMm) {
    const auto h = static_cast<float>(voxelMm);
    const std::size_t nx = static_cast<std::size_t>(size[0]), ny = static_cast<std::size_t>(size[1]),
                      nz = static_cast<std::size_t>(size[2]), layer = nx * ny;
    // What the level can change: values within a voxel and a half of the surface, by layers, and so the same sum at any
    // thread count.
    std::vector<std::vector<float>> near(nz);
    std::vector<std::size_t> deep(nz);
    const auto lookFor = [&] {
        core::parallelFor(nz, 4, [&](std::size_t b, std::size_t e) {
            for (std::size_t k = b; k < e; ++k) {
                near[k].clear();
                deep[k] = 0;
                for (std::size_t i = k * layer; i < (k + 1) * layer; ++i)
                    if (std::abs(field[i]) < 1.5f * h)
                        near[k].push_back(field[i]);
                    else
                        deep[k] += field[i] < 0.0f;
            }
        });
    };
    const auto inside = [&](float level) {
        std::vector<double> sums(nz, 0.0);
        core::parallelFor(nz, 4, [&](std::size_t b, std::size_t e) {
            for (std::size_t k = b; k < e; ++k) {
                sums[k] = static_cast<double>(deep[k]);
                for (const float f : near[k])
                    sums[k] += static_cast<double>(std::clamp(0.5f - (f - level) / h, 0.0f, 1.0f));
            }
        });
        double sum = 0.0;
        for (const double s : sums)
            sum += s;
        return sum;
    };
    lookFor();
    const double wanted = inside(0.0f);
    // Deep values say nothing of the surface and would pull at it.
    const float most = 1.5f * h;
    core::parallelFor(field.size(), kGrain, [&](std::size_t b, std::size_t e) {
        for (std::size_t i = b; i < e; ++i)
            field[i] = std::clamp(field[i], -most, most);
    });
    // 1 2 1 along each axis, twice: a standard deviation of one voxel.
    const auto lines = [&](std::size_t count, std::size_t length, std::size_t stride, const auto& firstOf) {
        core::parallelFor(count, 64, [&](std::size_t b, std::size_t e) {
            for (std::size_t line = b; line < e; ++line) {
                float* at = field.data() + firstOf(line);
                for (int pass = 0; pass < 2; ++pass) {
                    float before = at[0];
                    for (std::size_t i = 0; i < length; ++i) {
                        const float now = at[i * stride], after = i + 1 < length ? at[(i + 1) * stride] : now;
                        at[i * stride] = 0.25f * (before + after) + 0.5f * now;
                        before = now;
                    }
                }
            }
        });
    };
    lines(ny * nz, nx, 1, [&](std::size_t l) { return l * nx; });
    lines(nx * nz, ny, nx, [&](std::size_t l) { return l / nx * layer + l % nx; });
    lines(layer, nz, layer, [](std::size_t l) { return l; });
    lookFor();
    float low = -h, high = h;
    for (int i = 0; i < 12; ++i) {
        const float middle = 0.5f * (low + high);
        (inside(middle) < wanted ? low : high) = middle;
    }
    const float level = 0.5f * (low + high);
    core::parallelFor(field.size(), kGrain, [&](std::size_t b, std::size_t e) {
        for (std::size_t i = b; i < e; ++i)
            field[i] = std::abs(field[i]) < most ? field[i] - level : 2.0f * field[i];  // deep stays deep
    });
}

geometry::TriangleMesh fieldSurface(const std::vector<float>& field, const std::array<int, 3>& size, double voxelMm,
                                    const core::Progress& progress) {
    geometry::ScalarGrid grid;
    grid.spacingMm = voxelMm;
    for (std::size_t a = 0; a < 3; ++a)
        grid.nodes[a] = static_cast<std::uint32_t>(size[a]);
    grid.values = field;
    geometry::TriangleMesh mesh = geometry::isosurface(grid, progress);
    const std::array<std::size_t, 3> step{1, static_cast<std::size_t>(size[0]),
                                          static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1])};
    core::parallelFor(mesh.vertices.size(), 4096, [&](std::size_t b, std::size_t e) {
        for (std::size_t v = b; v < e; ++v) {
            // A vertex lies on an edge of the grid, or it is the middle of a cell and stays.
            Vec3& p = mesh.vertices[v];
            std::array<int, 3> node{};
            int axis = -1;
            bool onEdge = true;
            for (int a = 0; a < 3; ++a) {
                const double at = p[a] / voxelMm, whole = std::round(at);
                node[static_cast<std::size_t>(a)] = static_cast<int>(whole);
                if (std::abs(at - whole) < 1e-6) continue;
                onEdge = onEdge && axis < 0;
                axis = a;
                node[static_cast<std::size_t>(a)] = static_cast<int>(std::floor(at));
            }
            if (!onEdge || axis < 0) continue;
            const auto along = static_cast<std::size_t>(axis);
            bool within = node[along] >= 1 && node[along] + 2 < size[along];
            for (std::size_t a = 0; a < 3; ++a)
                within = within && node[a] >= 0 && node[a] < size[a];
            if (!within) continue;
            const float* first =
                &field[static_cast<std::size_t>(node[0]) + step[1] * static_cast<std::size_t>(node[1]) +
                       step[2] * static_cast<std::size_t>(node[2]) - step[along]];
            const double values[4] = {first[0], first[step[along]], first[2 * step[along]], first[3 * step[along]]};
            if ((values[1] < 0.0) == (values[2] < 0.0)) continue;
            p[axis] = voxelMm * (node[along] + std::clamp(cubicCrossing(values), 0.05, 0.95));
        }
    });
    return mesh;
}

std::vector<Vec3> fieldNormals(const std::vector<float>& field, const std::array<int, 3>& size, double voxelMm,
                               const geometry::TriangleMesh& surface) {
    std::vector<Vec3> normals(surface.vertices.size());
    const auto valueAt = [&](const std::array<int, 3>& at) {
        std::size_t index = 0;
        for (std::size_t a = 3; a-- > 0;)
            index =
                index * static_cast<std::size_t>(size[a]) + static_cast<std::size_t>(std::clamp(at[a], 0, size[a] - 1));
        return static_cast<double>(field[index]);
    };
    core::parallelFor(normals.size(), 4096, [&](std::size_t b, std::size_t e) {
        for (std::size_t v = b; v < e; ++v) {
            std::array<int, 3> low{};
            Vec3 part;
            for (int a = 0; a < 3; ++a) {
                const double at = surface.vertices[v][a] / voxelMm;
                low[static_cast<std::size_t>(a)] = static_cast<int>(std::floor(at));
                part[a] = at - std::floor(at);
            }
            Vec3 gradient = Vec3::Zero();
            for (int corner = 0; corner < 8; ++corner) {
                double weight = 1.0;
                std::array<int, 3> node = low;
                for (int a = 0; a < 3; ++a) {
                    const int up = corner >> a & 1;
                    weight *= up ? part[a] : 1.0 - part[a];
                    node[static_cast<std::size_t>(a)] += up;
                }
                if (weight < 1e-9) continue;
                for (std::size_t a = 0; a < 3; ++a) {
                    std::array<int, 3> before = node, after = node;
                    --before[a], ++after[a];
                    gradient[static_cast<int>(a)] += weight * (valueAt(after) - valueAt(before));
                }
            }
            const double length = gradient.norm();
            normals[v] = length > 0.0 ? (gradient / length).eval() : gradient;
        }
    });
    return normals;
}

bool isStaircase(const geometry::TriangleMesh& surface, double voxelMm) {
    std::size_t halves = 0;
    for (const Vec3& p : surface.vertices)
        for (int a = 0; a < 3; ++a) {
            const double at = p[a] / voxelMm;
            halves += std::abs(at - std::floor(at) - 0.5) < 1e-3;
        }
    return 2 * halves > surface.vertices.size();
}

}  // namespace handpiece::surfacing
