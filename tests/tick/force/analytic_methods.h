// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Contact in closed form: a round-ended bur against solids whose distance is a formula.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "handpiece/tick/contact/method.h"

namespace handpiece::test {

/// Signed distance to a solid [mm], negative inside; exact on both sides.
using Distance = std::function<double(const core::Vec3&)>;

/// The solid below z = 0.
inline Distance plane() {
    return [](const core::Vec3& p) { return p.z(); };
}

/// The solid below z = 0 with a slot along y, `width` wide and `depth` deep.
inline Distance slot(double width, double depth) {
    return [=](const core::Vec3& p) {
        const double x = std::abs(p.x()), half = 0.5 * width;
        const bool outside = p.z() > 0.0 || (x < half && p.z() > -depth);
        if (outside) {
            const double toBlock = std::hypot(std::max(0.0, half - x), std::max(0.0, p.z()));
            return std::min(toBlock, p.z() + depth);
        }
        const double toSlot = std::hypot(std::max(0.0, x - half), std::max(0.0, -depth - p.z()));
        return -std::min(-p.z(), toSlot);
    };
}

/// The solid below a V along y that opens by `angle` with its root at the origin.
inline Distance groove(double angle) {
    const double s = std::sin(0.5 * angle), c = std::cos(0.5 * angle);
    return [=](const core::Vec3& p) {
        const double x = std::abs(p.x());
        const double toWall = s * p.z() - c * x;  // the wall on this side; the other is farther
        if (toWall >= 0.0) return toWall;
        const double along = c * p.z() + s * x;
        return along > 0.0 ? toWall : -std::hypot(x, p.z());
    };
}

/// A wall across x, `thickness` thick, centred on x = 0, up to z = 0.
inline Distance wall(double thickness) {
    return [=](const core::Vec3& p) {
        const double dx = std::abs(p.x()) - 0.5 * thickness, dz = p.z();
        if (dx > 0.0 || dz > 0.0) return std::hypot(std::max(dx, 0.0), std::max(dz, 0.0));
        return std::max(dx, dz);
    };
}

/// The inside of a ball-shaped bowl of radius `radius` about the origin is free, all else solid.
inline Distance bowl(double radius) {
    return [=](const core::Vec3& p) { return radius - p.norm(); };
}

/// A solid ball of radius `radius` about the origin.
inline Distance ball(double radius) {
    return [=](const core::Vec3& p) { return p.norm() - radius; };
}

/// A capsule, tip at the origin, against a solid given by its distance: depth exactly on the axis, half-spaces from
/// points of the surface 60 um apart and from the ball that decides the depth.
class AnalyticMethod final : public contact::Method {
  public:
    AnalyticMethod(Distance distance, double radiusMm, double lengthMm, cases::Tissue tissue = cases::Tissue::enamel)
        : distance_(std::move(distance)), radius_(radiusMm), length_(lengthMm), tissue_(tissue) {
        const auto ring = [&](double z, double rho) {
            const int count = std::max(1, static_cast<int>(std::ceil(2 * std::numbers::pi * rho / kSpacingMm)));
            for (int j = 0; j < count; ++j) {
                const double a = 2 * std::numbers::pi * (j + 0.5) / count;
                points_.emplace_back(rho * std::cos(a), rho * std::sin(a), z);
            }
        };
        const int arc = static_cast<int>(std::ceil(0.5 * std::numbers::pi * radius_ / kSpacingMm));
        for (int i = 0; i < arc; ++i) {
            const double a = 0.5 * std::numbers::pi * i / arc;
            ring(radius_ * (1 - std::cos(a)), radius_ * std::sin(a));
        }
        for (double z = radius_; z < length_ - radius_ + 1e-9; z += kSpacingMm)
            ring(z, radius_);
        for (int i = 1; i <= arc; ++i) {
            const double a = 0.5 * std::numbers::pi * i / arc;
            ring(length_ - radius_ + radius_ * std::sin(a), radius_ * std::cos(a));
        }
    }
    [[nodiscard]] const char* name() const noexcept override { return "analytic"; }

    [[nodiscard]] contact::Depth depth(const core::Pose& pose) noexcept override {
        contact::Depth d;
        if (!pose.isValid()) {
            d.status = contact::Status::invalidPose;
            return d;
        }
        const core::Vec3 c = decidingCentre(pose);
        const double phi = distance_(c);
        d.depthMm = radius_ - phi;
        d.normal = gradient(c);
        d.toothPointMm = c - phi * d.normal;
        d.tissue = tissue_;
        d.status = contact::Status::ok;
        return d;
    }

    void patches(const core::Pose& pose, contact::PatchSet& out) noexcept override {
        out = contact::PatchSet{};
        contact::Patch patch;
        double pressure = 0.0;
        for (const core::Vec3& local : points_) {
            const core::Vec3 p = pose.apply(local);
            const double s = contact::kContactMarginMm - distance_(p);
            if (s <= 0.0) continue;
            patch.areaMm2 += kSpacingMm * kSpacingMm;
            patch.centreMm += s * p;
            patch.normal += s * gradient(p);
            patch.maxDepthMm = std::max(patch.maxDepthMm, s - contact::kContactMarginMm);
            pressure += s;
        }
        if (pressure <= 0.0) return;
        patch.centreMm /= pressure;
        patch.normal.normalize();
        patch.pressureShare = 1.0;
        patch.tissue = tissue_;
        out.patches.pushBack(patch);
        out.areaMm2 = patch.areaMm2;
        out.tissueShare[static_cast<std::size_t>(tissue_)] = 1.0;
    }

    contact::Status constraints(const core::Pose& pose, double reachMm, contact::ConstraintSet& out) noexcept override {
        out.clear();
        const contact::Depth d = depth(pose);
        if (d.status != contact::Status::ok) return d.status;
        if (-d.depthMm > reachMm) return contact::Status::ok;
        // When too many points are near, the nearest matter: look at ever smaller reaches first.
        for (double inner = 0.0, outer = reachMm / 16; inner < reachMm; inner = outer, outer *= 2) {
            for (const core::Vec3& local : points_) {
                const core::Vec3 p = pose.apply(local);
                const double gap = distance_(p);
                if (gap > outer || (inner > 0.0 && gap <= inner)) continue;
                if (!out.pushBack({gradient(p), gap, p, tissue_})) return contact::Status::truncated;
            }
        }
        return contact::Status::ok;
    }

  private:
    static constexpr double kSpacingMm = 0.06;

    [[nodiscard]] core::Vec3 gradient(const core::Vec3& p) const {
        constexpr double h = 1e-6;
        core::Vec3 g;
        for (int i = 0; i < 3; ++i) {
            core::Vec3 a = p, b = p;
            a[i] -= h;
            b[i] += h;
            g[i] = distance_(b) - distance_(a);
        }
        return g.normalized();
    }
    [[nodiscard]] core::Vec3 decidingCentre(const core::Pose& pose) const {
        const auto at = [&](double z) { return pose.apply({0, 0, z}); };
        const double low = radius_, high = length_ - radius_;
        constexpr int kSamples = 64;
        int best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (int i = 0; i <= kSamples; ++i) {
            const double phi = distance_(at(low + (high - low) * i / kSamples));
            if (phi < least - 1e-12) {
                least = phi;
                best = i;
            }
        }
        double a = low + (high - low) * std::max(0, best - 1) / kSamples;
        double b = low + (high - low) * std::min(kSamples, best + 1) / kSamples;
        for (int i = 0; i < 60; ++i) {
            const double m = a + (b - a) / 3, n = b - (b - a) / 3;
            if (distance_(at(m)) <= distance_(at(n))) {
                b = n;
            } else {
                a = m;
            }
        }
        const core::Vec3 refined = at(0.5 * (a + b));
        return distance_(refined) < least ? refined : at(low + (high - low) * best / kSamples);
    }

    Distance distance_;
    double radius_, length_;
    cases::Tissue tissue_;
    std::vector<core::Vec3> points_;
};

}  // namespace handpiece::test
