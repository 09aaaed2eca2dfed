// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/landmarks/relief.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/height_raster.h"

namespace handpiece::landmarks {
namespace {
using core::Vec2;
using core::Vec3;

constexpr int kMarginNodes = 4;
constexpr double kNothing = -std::numeric_limits<double>::infinity();
/// No tooth is as wide: a mesh that is, is seen in part.
constexpr double kWidestMm = 60.0;
}  // namespace

Relief::Relief(const geometry::TriangleMesh& mesh, double blurMm) {
    raster(mesh);
    blur(blurMm);
}

void Relief::raster(const geometry::TriangleMesh& mesh) {
    const core::Box box = mesh.bounds();
    const Vec2 size = box.size().head<2>().cwiseMin(kWidestMm);
    // On whole steps of the mesh's own frame, so that what lies around a tooth does not move its nodes.
    from_ = kStepMm * (box.min.head<2>() / kStepMm).array().floor().matrix() - Vec2::Constant(kMarginNodes * kStepMm);
    columns_ = static_cast<int>(size.x() / kStepMm) + 2 * kMarginNodes + 2;
    rows_ = static_cast<int>(size.y() / kStepMm) + 2 * kMarginNodes + 2;
    height_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kNothing);
    const auto inNodes = [&](std::uint32_t vertex) {
        const Vec3& p = mesh.vertices[vertex];
        return Vec3((p.x() - from_.x()) / kStepMm, (p.y() - from_.y()) / kStepMm, p.z());
    };
    for (const geometry::Triangle& t : mesh.triangles)
        geometry::heightsUnder(inNodes(t[0]), inNodes(t[1]), inNodes(t[2]), columns_, rows_,
                               [&](int i, int j, double height) {
                                   double& z = height_[at(i, j)];
                                   z = std::max(z, height);
                               });
}

/// A normalised Gaussian, along columns and then along rows: nodes where nothing is seen have no weight.
void Relief::blur(double blurMm) {
    const int reach = std::max(1, static_cast<int>(std::ceil(3.0 * blurMm / kStepMm)));
    std::vector<double> kernel;
    for (int k = -reach; k <= reach; ++k)
        kernel.push_back(core::exp(-0.5 * (k * kStepMm / blurMm) * (k * kStepMm / blurMm)));
    const double sum = std::accumulate(kernel.begin(), kernel.end(), 0.0);
    for (double& k : kernel)
        k /= sum;
    const std::vector<double> before = height_;
    weight_.assign(size(), 0.0);
    for (std::size_t n = 0; n < size(); ++n) {
        if (before[n] > kNothing) weight_[n] = 1.0;
        height_[n] = weight_[n] > 0.0 ? before[n] : 0.0;
    }
    std::vector<double> values(size()), weights(size());
    for (const bool isAlongRows : {true, false}) {
        for (int j = 0; j < rows_; ++j)
            for (int i = 0; i < columns_; ++i) {
                double value = 0.0, weight = 0.0;
                for (int k = -reach; k <= reach; ++k) {
                    const int ii = isAlongRows ? i + k : i, jj = isAlongRows ? j : j + k;
                    if (ii < 0 || jj < 0 || ii >= columns_ || jj >= rows_) continue;
                    const double share = kernel[static_cast<std::size_t>(k + reach)];
                    value += share * height_[at(ii, jj)];
                    weight += share * weight_[at(ii, jj)];
                }
                values[at(i, j)] = value;
                weights[at(i, j)] = weight;
            }
        std::swap(values, height_);
        std::swap(weights, weight_);
    }
    for (std::size_t n = 0; n < size(); ++n) {
        height_[n] = before[n] > kNothing && weight_[n] > 0.5 ? height_[n] / weight_[n] : 0.0;
        if (!(before[n] > kNothing)) weight_[n] = 0.0;
    }
}

std::optional<double> Relief::heightAt(const Vec2& p) const {
    const Vec2 in = (p - from_) / kStepMm + Vec2::Constant(0.5);
    const double i = std::floor(in.x()), j = std::floor(in.y());
    if (!(i >= 0.0 && j >= 0.0 && i < columns_ && j < rows_)) return std::nullopt;
    const std::size_t node = at(static_cast<int>(i), static_cast<int>(j));
    if (!isThere(node)) return std::nullopt;
    return height_[node];
}

std::vector<Vec3> Relief::hollows(double leastProminenceMm) const {
    Relief turned = *this;
    for (double& z : turned.height_)
        z = -z;
    std::vector<Vec3> found;
    const auto isAtEdge = [&](const Vec3& p) {
        for (const double dx : {-0.2, 0.0, 0.2})
            for (const double dy : {-0.2, 0.0, 0.2})
                if (!heightAt(p.head<2>() + Vec2(dx, dy))) return true;
        return false;
    };
    for (Vec3& p : turned.peaks(leastProminenceMm)) {
        p.z() = -p.z();
        if (!isAtEdge(p)) found.push_back(p);
    }
    return found;
}

std::vector<Vec3> Relief::peaks(double leastProminenceMm) const {
    std::vector<std::size_t> order;
    for (std::size_t n = 0; n < size(); ++n)
        if (isThere(n)) order.push_back(n);
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return height_[a] != height_[b] ? height_[a] > height_[b] : a < b; });
    // From above: a node joins the hills beside it, and the lower of two that meet has its prominence.
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> parent(size(), kNone);
    const auto root = [&](std::size_t n) {
        while (parent[n] != n)
            n = parent[n] = parent[parent[n]];
        return n;
    };
    std::vector<std::pair<std::size_t, double>> tops;  // with prominence
    for (const std::size_t n : order) {
        const int i = static_cast<int>(n) % columns_, j = static_cast<int>(n) / columns_;
        parent[n] = n;
        for (int v = -1; v <= 1; ++v)
            for (int u = -1; u <= 1; ++u) {
                if ((u == 0 && v == 0) || i + u < 0 || j + v < 0 || i + u >= columns_ || j + v >= rows_) continue;
                const std::size_t other = at(i + u, j + v);
                if (parent[other] == kNone) continue;
                std::size_t a = root(n), b = root(other);
                if (a == b) continue;
                if (height_[a] < height_[b] || (height_[a] == height_[b] && a > b)) std::swap(a, b);
                if (b != n && height_[b] - height_[n] >= leastProminenceMm)
                    tops.emplace_back(b, height_[b] - height_[n]);
                parent[b] = a;
            }
    }
    for (const std::size_t n : order)
        if (root(n) == n) tops.emplace_back(n, std::numeric_limits<double>::infinity());
    std::sort(tops.begin(), tops.end(), [&](const auto& a, const auto& b) {
        return height_[a.first] != height_[b.first] ? height_[a.first] > height_[b.first] : a.first < b.first;
    });
    std::vector<Vec3> found;
    for (const auto& [n, prominence] : tops) {
        const int i = static_cast<int>(n) % columns_, j = static_cast<int>(n) / columns_;
        double off[2] = {0.0, 0.0};
        for (const int axis : {0, 1}) {
            const int u = axis == 0, v = axis == 1;
            if (i < 1 || j < 1 || i + 1 >= columns_ || j + 1 >= rows_) continue;
            if (!isThere(at(i - u, j - v)) || !isThere(at(i + u, j + v))) continue;
            const double low = height_[at(i - u, j - v)], high = height_[at(i + u, j + v)];
            const double bend = low + high - 2 * height_[n];
            if (bend < -1e-12) off[axis] = std::clamp(0.5 * (low - high) / bend, -0.5, 0.5);
        }
        found.emplace_back(from_.x() + (i + off[0]) * kStepMm, from_.y() + (j + off[1]) * kStepMm, height_[n]);
    }
    return found;
}

}  // namespace handpiece::landmarks
