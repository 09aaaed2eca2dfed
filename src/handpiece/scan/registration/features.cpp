// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/registration/features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::registration {
namespace {

using core::Vec3;

/// Cells along each axis are counted in 21 bits: enough for any scan at any spacing that makes sense.
std::uint64_t cellOf(const Vec3& p, const Vec3& from, double edge) {
    const auto at = [&](int axis) {
        return static_cast<std::uint64_t>(std::clamp(std::floor((p[axis] - from[axis]) / edge) + 1.0, 0.0, 2097151.0));
    };
    return at(2) << 42 | at(1) << 21 | at(0);
}

/// The points of a set sorted by cells, to find those around a place.
class Cells {
  public:
    Cells(const std::vector<Vec3>& points, double edge) : points_(points), edge_(edge) {
        core::Box box;
        for (const Vec3& p : points)
            box.extend(p);
        from_ = box.min;
        for (std::uint32_t i = 0; i < points.size(); ++i)
            order_.emplace_back(cellOf(points[i], from_, edge), i);
        std::sort(order_.begin(), order_.end());
    }
    /// Calls each(index, squared distance) for all within one edge, nearest cells in a fixed order.
    template <class Each>
    void around(const Vec3& p, const Each& each) const {
        const double reach2 = edge_ * edge_;
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y) {
                // Three cells side by side are neighbours in the order.
                const std::uint64_t low = cellOf(p + edge_ * Vec3(-1, y, z), from_, edge_);
                const std::uint64_t high = cellOf(p + edge_ * Vec3(1, y, z), from_, edge_);
                auto it = std::lower_bound(order_.begin(), order_.end(), std::pair(low, 0u));
                for (; it != order_.end() && it->first <= high; ++it) {
                    const double d2 = (points_[it->second] - p).squaredNorm();
                    if (d2 < reach2) each(it->second, d2);
                }
            }
    }

  private:
    const std::vector<Vec3>& points_;
    double edge_;
    Vec3 from_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
};

constexpr int kBins = 11;

int binOf(double value, double low, double high) {
    return std::clamp(static_cast<int>(kBins * (value - low) / (high - low)), 0, kBins - 1);
}

/// Darboux angles of a pair, into three histograms.
void addPair(Feature& f, const Vec3& p, const Vec3& n, const Vec3& q, const Vec3& m, float weight) {
    const Vec3 line = q - p;
    const double length = line.norm();
    if (!(length > 1e-9)) return;
    const Vec3 towards = line / length;
    const Vec3 v = towards.cross(n);
    const double across = v.norm();
    if (!(across > 1e-6)) return;
    const Vec3 unitV = v / across, w = n.cross(unitV);
    const double alpha = unitV.dot(m), phi = n.dot(towards), theta = core::atan2(w.dot(m), n.dot(m));
    f[static_cast<std::size_t>(binOf(alpha, -1.0, 1.0))] += weight;
    f[static_cast<std::size_t>(kBins + binOf(phi, -1.0, 1.0))] += weight;
    f[static_cast<std::size_t>(2 * kBins + binOf(theta, -std::numbers::pi, std::numbers::pi))] += weight;
}

void normalise(Feature& f) {
    for (std::size_t h = 0; h < 3; ++h) {
        float sum = 0.0f;
        for (std::size_t b = 0; b < kBins; ++b)
            sum += f[h * kBins + b];
        if (!(sum > 0.0f)) continue;
        for (std::size_t b = 0; b < kBins; ++b)
            f[h * kBins + b] *= 100.0f / sum;
    }
}

}  // namespace

Points spread(const geometry::TriangleMesh& mesh, double spacingMm) {
    struct Sample {
        std::uint64_t cell;
        Vec3 at, areaNormal;
    };
    const Vec3 from = mesh.bounds().min;
    std::vector<Sample> samples;
    for (const geometry::Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
        const int n = std::clamp(static_cast<int>(std::ceil(2.0 * longest / spacingMm)), 1, 1000);
        const Vec3 areaNormal = 0.5 * (b - a).cross(c - a) / (n * n);
        // The middles of n * n equal triangles.
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j)
                for (int turned = 0; turned < (i + j < n - 1 ? 2 : 1); ++turned) {
                    const double u = (i + (turned ? 2.0 : 1.0) / 3.0) / n, v = (j + (turned ? 2.0 : 1.0) / 3.0) / n;
                    const Vec3 p = a + u * (b - a) + v * (c - a);
                    samples.push_back({cellOf(p, from, spacingMm), p, areaNormal});
                }
    }
    std::stable_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.cell < b.cell; });
    Points points;
    for (std::size_t i = 0; i < samples.size();) {
        Vec3 at = Vec3::Zero(), normal = Vec3::Zero();
        double weight = 0.0;
        std::size_t j = i;
        for (; j < samples.size() && samples[j].cell == samples[i].cell; ++j) {
            const double area = samples[j].areaNormal.norm();
            at += area * samples[j].at;
            normal += samples[j].areaNormal;
            weight += area;
        }
        // Both walls of a thin fissure in one cell: neither is meant.
        if (weight > 0.0 && normal.norm() > 0.5 * weight) {
            points.at.push_back(at / weight);
            points.normal.push_back(normal.normalized());
        }
        i = j;
    }
    return points;
}

std::vector<Feature> featuresOf(const Points& points, double radiusMm, const core::Progress& progress) {
    const Cells cells(points.at, radiusMm);
    std::vector<Feature> simple(points.size(), Feature{}), full(points.size());
    core::parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            cells.around(points.at[i], [&](std::uint32_t j, double) {
                if (j != i) addPair(simple[i], points.at[i], points.normal[i], points.at[j], points.normal[j], 1.0f);
            });
            normalise(simple[i]);
        }
        core::report(progress, 0.25);
    });
    core::parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Feature sum = simple[i];
            Feature around{};
            float count = 0.0f;
            cells.around(points.at[i], [&](std::uint32_t j, double d2) {
                if (j == i || !(d2 > 0.0)) return;
                const auto weight = static_cast<float>(radiusMm / std::sqrt(d2));
                for (std::size_t b = 0; b < sum.size(); ++b)
                    around[b] += weight * simple[j][b];
                count += 1.0f;
            });
            for (std::size_t b = 0; b < sum.size(); ++b)
                sum[b] += count > 0.0f ? around[b] / count : 0.0f;
            normalise(sum);
            full[i] = sum;
        }
        core::report(progress, 0.75);
    });
    return full;
}

}  // namespace handpiece::registration
