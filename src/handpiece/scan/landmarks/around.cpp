// SPDX-License-Identifier: Apache-2.0
// What goes around the tooth: height of contour, cemento-enamel junction, contacts.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/scan/landmarks/finder.h"

namespace handpiece::landmarks {
namespace {
using core::Vec3;

constexpr int kDirections = 48;
constexpr double kStepMm = 0.1;
constexpr double kFarMm = 40.0;
/// A side that is within so much of its widest over more than so high has no height of contour to be told.
constexpr double kAlikeMm = 0.015, kStraightMm = 2.2;
/// Where it stands out farthest is the middle of the heights at which it does so by nearly as much; the line is evened
/// over so many directions to either side. As the average tooth's is (model/dentition/landmarks.cpp).
constexpr double kNearlyMm = 0.05;
constexpr int kEvenedOver = 4;
/// Enamel thinner than this is the noise of two surfaces.
constexpr double kThinMm = 0.06;
/// Share of the directions that a ring needs.
constexpr double kRingShare = 0.75;
constexpr double kNearMm = 0.3;  ///< an adjacent tooth as near touches

double angleOf(int direction) {
    return 2.0 * std::numbers::pi * direction / kDirections;
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Without those that lie apart from their neighbours on the ring.
std::vector<Vec3> ringOf(const std::vector<std::optional<Vec3>>& found) {
    const int count = static_cast<int>(found.size());
    std::vector<Vec3> ring;
    for (int d = 0; d < count; ++d) {
        if (!found[static_cast<std::size_t>(d)]) continue;
        std::vector<double> beside;
        for (int k = -3; k <= 3; ++k)
            if (const auto& p = found[static_cast<std::size_t>((d + k + count) % count)]) beside.push_back(p->z());
        if (beside.size() >= 3 && std::abs(found[static_cast<std::size_t>(d)]->z() - median(beside)) < 0.7)
            ring.push_back(*found[static_cast<std::size_t>(d)]);
    }
    if (static_cast<double>(ring.size()) < kRingShare * count) ring.clear();
    return ring;
}

}  // namespace

std::optional<Vec3> Around::side(double rad, double z) const {
    const Vec3 out(core::cos(rad), core::sin(rad), 0.0), from = Vec3(axis_.x(), axis_.y(), z) + kFarMm * out;
    const geometry::RayMeeting met = tree_.firstMeeting(from, -out, kFarMm);
    if (met.triangle == geometry::kNoTriangle) return std::nullopt;
    return Vec3(from - met.distanceMm * out);
}

std::vector<Vec3> heightOfContour(const Around& around, double lowZ, double highZ) {
    const int count = static_cast<int>((highZ - lowZ) / kStepMm) + 1;
    if (count < 5) return {};
    // How far it stands out, by direction and height; blurred over what noise and fine grooves are.
    const auto at = [&](int d, int k) {
        return static_cast<std::size_t>((d + kDirections) % kDirections) * static_cast<std::size_t>(count) +
               static_cast<std::size_t>(k);
    };
    std::vector<double> wide(static_cast<std::size_t>(kDirections) * static_cast<std::size_t>(count), 0.0);
    for (int d = 0; d < kDirections; ++d)
        for (int k = 0; k < count; ++k)
            if (const auto p = around.side(angleOf(d), lowZ + k * kStepMm))
                wide[at(d, k)] = (p->head<2>() - around.axis()).norm();
    std::vector<std::optional<Vec3>> found(kDirections);
    for (int d = 0; d < kDirections; ++d) {
        std::vector<double> smooth;
        for (int k = 0; k < count; ++k) {
            double sum = 0.0, weights = 0.0;
            for (int u = -3; u <= 3; ++u) {
                if (k + u < 0 || k + u >= count) continue;
                const double weight = 1.0 - 0.25 * std::abs(u);
                sum += weight * wide[at(d, k + u)];
                weights += weight;
            }
            smooth.push_back(sum / weights);
        }
        const auto best = std::max_element(smooth.begin(), smooth.end());
        const auto isAlike = [&](double w) { return w > *best - kAlikeMm; };
        const auto alike = std::count_if(smooth.begin(), smooth.end(), isAlike);
        // At an end it is no bulge, but goes on beyond.
        if (best - smooth.begin() < 2 || smooth.end() - best < 3 || static_cast<double>(alike) * kStepMm > kStraightMm)
            continue;
        // The middle of what is as wide, which noise moves less than the widest place.
        double sum = 0.0, weights = 0.0;
        for (int k = 0; k < count; ++k)
            if (const double over = smooth[static_cast<std::size_t>(k)] - (*best - kNearlyMm); over > 0.0) {
                sum += over * k;
                weights += over;
            }
        found[static_cast<std::size_t>(d)] = around.side(angleOf(d), lowZ + kStepMm * sum / weights);
    }
    std::vector<std::optional<Vec3>> even(kDirections);
    for (int d = 0; d < kDirections; ++d) {
        if (!found[static_cast<std::size_t>(d)]) continue;
        double sum = 0.0, weights = 0.0;
        for (int k = -kEvenedOver; k <= kEvenedOver; ++k)
            if (const auto& p = found[static_cast<std::size_t>((d + k + kDirections) % kDirections)]) {
                const double share = static_cast<double>(k) / (kEvenedOver + 1), weight = 1.0 - share * share;
                sum += weight * p->z();
                weights += weight;
            }
        even[static_cast<std::size_t>(d)] = around.side(angleOf(d), sum / weights);
    }
    return ringOf(even);
}

std::vector<Vec3> cementoEnamelJunction(const Around& around, const geometry::TriangleTree& dentine, double highZ) {
    constexpr double kLowMm = -5.0;
    std::vector<std::optional<Vec3>> found(kDirections);
    for (int d = 0; d < kDirections; ++d) {
        // From the crown down to where the enamel has become nothing: below that is root.
        std::optional<Vec3> last;
        double above = 0.0;
        for (double z = highZ; z > kLowMm; z -= kStepMm) {
            const auto p = around.side(angleOf(d), z);
            if (!p) break;
            const double thick = dentine.signedDistance(*p);
            if (thick < kThinMm) {
                if (last) {
                    // Between the two heights, by how the thickness goes.
                    const double share = std::clamp((above - kThinMm) / std::max(above - thick, 1e-9), 0.0, 1.0);
                    found[static_cast<std::size_t>(d)] = around.side(angleOf(d), z + (1.0 - share) * kStepMm);
                }
                break;
            }
            last = p;
            above = thick;
        }
    }
    return ringOf(found);
}

std::optional<Vec3> contactOn(const geometry::TriangleMesh& outer, const Vec3& out, double lowZ, double highZ,
                              const std::vector<geometry::TriangleTree>& adjacent) {
    double most = -1e300;
    for (const Vec3& v : outer.vertices)
        if (v.z() > lowZ && v.z() < highZ) most = std::max(most, v.dot(out));
    double nearest = kNearMm;
    std::optional<Vec3> touching;
    for (const geometry::TriangleTree& other : adjacent)
        for (const Vec3& v : outer.vertices) {
            if (v.z() < lowZ || v.z() > highZ || v.dot(out) < most - 2.0) continue;
            const geometry::NearestPoint n = other.nearest(v, nearest);
            if (n.triangle == geometry::kNoTriangle || !(n.distanceMm < nearest)) continue;
            nearest = n.distanceMm;
            touching = v;
        }
    if (touching) return touching;
    // The middle of the cap that stands out most, by area: noise of single vertices does not move it.
    constexpr double kCapMm = 0.05;
    Vec3 sum = Vec3::Zero();
    double weights = 0.0;
    for (const geometry::Triangle& t : outer.triangles) {
        const Vec3 &a = outer.vertices[t[0]], &b = outer.vertices[t[1]], &c = outer.vertices[t[2]];
        const Vec3 middle = (a + b + c) / 3.0;
        const double over = middle.dot(out) - (most - kCapMm);
        if (over <= 0.0 || middle.z() < lowZ || middle.z() > highZ) continue;
        const double weight = over * (b - a).cross(c - a).norm();
        sum += weight * middle;
        weights += weight;
    }
    if (!(weights > 0.0)) return std::nullopt;
    const Vec3 middle = sum / weights;
    // Where it is widest at an end of the crown there is no contact area to be seen.
    if (middle.z() < lowZ + 0.2 || middle.z() > highZ - 0.2) return std::nullopt;
    return middle;
}

}  // namespace handpiece::landmarks
