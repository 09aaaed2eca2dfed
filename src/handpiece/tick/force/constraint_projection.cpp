// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/constraint_projection.h"

namespace handpiece::force {
namespace {

using Vec4 = Eigen::Vector4d;

constexpr double kViolatedMm = 1e-9;
constexpr double kDependent = 1e-12;  // squared sine below which two normals count as one

/// The active normals as an orthonormal basis times a triangle, rebuilt at every change: at most four columns.
struct ActiveSet {
    std::array<Vec4, 4> normal, basis;
    std::array<std::array<double, 4>, 4> triangle{};
    std::array<double, 4> multiplier{};
    std::array<std::uint8_t, 4> index{};
    int count = 0;

    void factorise() noexcept {
        for (int j = 0; j < count; ++j) {
            Vec4 v = normal[j];
            for (int i = 0; i < j; ++i) {
                triangle[i][j] = basis[i].dot(v);
                v -= triangle[i][j] * basis[i];
            }
            triangle[j][j] = v.norm();
            basis[j] = v / triangle[j][j];
        }
    }
    /// Splits `a` into what the active normals make of it (coefficients r) and the rest z, orthogonal to them.
    void split(const Vec4& a, std::array<double, 4>& r, Vec4& z) const noexcept {
        z = a;
        std::array<double, 4> q{};
        for (int pass = 0; pass < 2; ++pass) {
            for (int i = 0; i < count; ++i) {
                const double d = basis[i].dot(z);
                q[i] += d;
                z -= d * basis[i];
            }
        }
        for (int i = count - 1; i >= 0; --i) {
            double s = q[i];
            for (int j = i + 1; j < count; ++j)
                s -= triangle[i][j] * r[j];
            r[i] = s / triangle[i][i];
        }
    }
    void add(const Vec4& a, double u, std::uint8_t i) noexcept {
        normal[count] = a;
        multiplier[count] = u;
        index[count] = i;
        ++count;
        factorise();
    }
    void drop(int k) noexcept {
        for (int j = k; j + 1 < count; ++j) {
            normal[j] = normal[j + 1];
            multiplier[j] = multiplier[j + 1];
            index[j] = index[j + 1];
        }
        --count;
        factorise();
    }
    [[nodiscard]] bool holds(std::size_t i) const noexcept {
        for (int j = 0; j < count; ++j) {
            if (index[j] == i) return true;
        }
        return false;
    }
};

}  // namespace

Projection project(const contact::ConstraintSet& constraints, const core::Vec3& wantedMm, double e) noexcept {
    const auto normalOf = [&](std::size_t i) {
        const core::Vec3& n = constraints[i].normal;
        return Vec4(n.x(), n.y(), n.z(), e);
    };
    Vec4 x(wantedMm.x(), wantedMm.y(), wantedMm.z(), 0.0);
    ActiveSet active;
    Projection result;
    while (result.iterations < kMaxProjectionIterations) {
        std::size_t worst = 0;
        double violation = -kViolatedMm;
        for (std::size_t i = 0; i < constraints.size(); ++i) {
            const double v = normalOf(i).dot(x) + constraints[i].gapMm;
            if (v < violation && !active.holds(i)) {
                violation = v;
                worst = i;
            }
        }
        if (violation == -kViolatedMm) break;
        // Raise this constraint's multiplier until it is met, letting go of those that would have to pull.
        const Vec4 a = normalOf(worst);
        double u = 0.0;
        for (; result.iterations < kMaxProjectionIterations; ++result.iterations) {
            std::array<double, 4> r{};
            Vec4 z;
            active.split(a, r, z);
            const double rest = active.count < 4 ? z.squaredNorm() : 0.0;
            const double full = rest > kDependent ? -(a.dot(x) + constraints[worst].gapMm) / rest
                                                  : std::numeric_limits<double>::infinity();
            double partial = std::numeric_limits<double>::infinity();
            int leaving = -1;
            for (int j = 0; j < active.count; ++j) {
                if (r[j] > 0.0 && active.multiplier[j] < partial * r[j]) {
                    partial = active.multiplier[j] / r[j];
                    leaving = j;
                }
            }
            const double t = std::min(full, partial);
            if (t == std::numeric_limits<double>::infinity()) break;  // not reached: every normal shares the slack
            if (full != std::numeric_limits<double>::infinity()) x += t * z;
            for (int j = 0; j < active.count; ++j)
                active.multiplier[j] -= t * r[j];
            u += t;
            if (t == full) {
                active.add(a, u, static_cast<std::uint8_t>(worst));
                break;
            }
            active.drop(leaving);
        }
        ++result.iterations;
    }
    result.stepMm = x.head<3>();
    result.slackMm = e * x[3];
    result.activeCount = active.count;
    result.active = active.index;
    result.multiplierMm = active.multiplier;
    return result;
}

}  // namespace handpiece::force
