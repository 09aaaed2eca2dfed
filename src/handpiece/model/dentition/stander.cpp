// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/stander.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/model/dentition/surfaces.h"

namespace handpiece::dentition {
namespace {

using core::Box;
using core::Vec3;

constexpr double kSeenMm = 6.0;  ///< farther inside a tooth than any place of it
/// Distances to a tooth are looked up between nodes this far apart, an error of some microns; farther off than
/// kNearMm every other node is between its neighbours.
constexpr double kNodeMm = 0.4, kNearMm = 1.0;

/// All of x and y to the fourth power together.
Stander::Terms terms(const core::Vec2& p) {
    const double x = p.x(), y = p.y(), xx = x * x, yy = y * y;
    Stander::Terms row;
    row << 1.0, x, y, xx, x * y, yy, x * xx, xx * y, x * yy, y * yy, xx * xx, xx * x * y, xx * yy, x * y * yy, yy * yy;
    return row;
}

}  // namespace

DistanceGrid::DistanceGrid(const ToothBody& body) : from_(body.box.grown(kFarMm + kNodeMm).min) {
    const Vec3 size = body.box.grown(kFarMm + kNodeMm).size();
    for (int axis = 0; axis < 3; ++axis)
        count_[axis] = 3 + 2 * static_cast<std::size_t>(0.5 * size[axis] / kNodeMm);
    values_.resize(count_[0] * count_[1] * count_[2]);
    measure(body, 2);
    measure(body, 1);
    roundCreases();
}

double DistanceGrid::at(const Vec3& p) const {
    const Vec3 u = (p - from_) / kNodeMm;
    std::size_t first[3];
    double t[3];
    for (int axis = 0; axis < 3; ++axis) {
        if (!(u[axis] >= 0.0 && u[axis] < static_cast<double>(count_[axis] - 1))) return kFarMm;
        first[axis] = static_cast<std::size_t>(u[axis]);
        t[axis] = u[axis] - static_cast<double>(first[axis]);
    }
    const float* v = &values_[(first[2] * count_[1] + first[1]) * count_[0] + first[0]];
    double sum = 0.0;
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t j = 0; j < 2; ++j) {
            const float* row = v + (k * count_[1] + j) * count_[0];
            sum += (k ? t[2] : 1.0 - t[2]) * (j ? t[1] : 1.0 - t[1]) * ((1.0 - t[0]) * row[0] + t[0] * row[1]);
        }
    return sum;
}

/// Every `stride`-th node; those of 1 that lie between nodes of 2, by these where they are far off.
void DistanceGrid::measure(const ToothBody& body, std::size_t stride) {
    core::parallelFor((count_[2] + stride - 1) / stride, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin * stride; k < end * stride; k += stride)
            for (std::size_t j = 0; j < count_[1]; j += stride) {
                std::uint32_t seed = geometry::kNoTriangle;
                for (std::size_t i = 0; i < count_[0]; i += stride) {
                    const std::size_t oddI = i % 2, oddJ = j % 2, oddK = k % 2;
                    if (stride == 1) {
                        if (oddI + oddJ + oddK == 0) continue;
                        float sum = 0.0f;
                        for (std::size_t corner = 0; corner < 8; ++corner)
                            sum += node(corner & 1 ? i + oddI : i - oddI, corner & 2 ? j + oddJ : j - oddJ,
                                        corner & 4 ? k + oddK : k - oddK);
                        if (std::abs(sum) > 8.0f * static_cast<float>(kNearMm)) {
                            node(i, j, k) = 0.125f * sum;
                            continue;
                        }
                    }
                    const Vec3 p =
                        from_ + kNodeMm * Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
                    const geometry::NearestPoint n = body.tree.nearest(p, kSeenMm, seed);
                    seed = n.triangle;
                    double distance = kFarMm;
                    if (seed != geometry::kNoTriangle)
                        distance = std::clamp(body.tree.side(p, n) * n.distanceMm, -kFarMm, kFarMm);
                    node(i, j, k) = static_cast<float>(distance);
                }
            }
    });
}

void DistanceGrid::roundCreases() {
    // Rounds of 1 2 1 along each axis: as a Gaussian of 0.7 mm. The margin of the gingiva, and what cannot be told from
    // kFarMm, stay where they are.
    constexpr int kRounds = 6;
    constexpr double kFromMm = 0.3, kWhollyMm = 1.2, kToMm = kFarMm - 0.9, kNoMoreMm = kFarMm - 0.4;
    std::vector<float> soft = values_, before;
    const std::size_t steps[3] = {1, count_[0], count_[0] * count_[1]};
    for (int round = 0; round < kRounds; ++round)
        for (int axis = 0; axis < 3; ++axis) {
            before = soft;
            for (std::size_t i = 0; i < soft.size(); ++i) {
                const std::size_t at = i / steps[axis] % count_[axis];
                if (at == 0 || at + 1 == count_[axis]) continue;
                soft[i] = 0.25f * before[i - steps[axis]] + 0.5f * before[i] + 0.25f * before[i + steps[axis]];
            }
        }
    for (std::size_t i = 0; i < values_.size(); ++i) {
        const auto mm = static_cast<double>(values_[i]);
        const double share = smoothStep(kFromMm, kWhollyMm, mm) * (1.0 - smoothStep(kToMm, kNoMoreMm, mm));
        values_[i] += static_cast<float>(share) * (soft[i] - values_[i]);
    }
}

Stander::Stander(const ArchTooth& t)
    : body_(t.tooth->outer),
      grid_(body_),
      pose_(t.inArch),
      turn_(t.inArch.orientation.toRotationMatrix()),
      axis_(turn_.col(2)) {
    const cases::Landmark* ring = nullptr;
    for (const cases::Landmark& landmark : t.tooth->landmarks)
        if (landmark.kind == cases::LandmarkKind::cementoEnamelJunction) ring = &landmark;
    if (!ring || ring->pointsMm.size() < 8)
        throw core::Error(fmt::format("tooth {} has no cemento-enamel junction", t.tooth->fdiNumber), "gingiva",
                          "add the landmark");
    ring_ = ring->pointsMm;
    Box neck;
    for (const Vec3& p : ring_)
        neck.extend(p);
    middle_ = neck.centre().head<2>();
    half_ = 0.5 * neck.size().head<2>();
    // Smooth over the whole tooth, and the junction within some hundredths of a millimetre.
    Eigen::Matrix<double, 15, 15> square = Eigen::Matrix<double, 15, 15>::Identity() * 1e-4;
    Terms right = Terms::Zero();
    for (const Vec3& p : ring_) {
        const Terms row = terms((p.head<2>() - middle_).cwiseQuotient(half_));
        square += row * row.transpose();
        right += p.z() * row;
    }
    junction_ = square.ldlt().solve(right);
    rootMm_ = -body_.box.min.z();
    Box box;
    for (int corner = 0; corner < 8; ++corner)
        box.extend(pose_.apply(Vec3(corner & 1 ? body_.box.min.x() : body_.box.max.x(),
                                    corner & 2 ? body_.box.min.y() : body_.box.max.y(),
                                    corner & 4 ? body_.box.min.z() : body_.box.max.z())));
    near_ = box.grown(kFarMm);
}

Vec3 Stander::neckTowards(const Vec3& direction) const {
    const Vec3 own = turn_.transpose() * direction;
    // The face, not the nearest corner: +y or -y.
    const double side = own.y() > 0.0 ? 1.0 : -1.0;
    const auto farther = [side](const Vec3& a, const Vec3& b) { return a.y() * side < b.y() * side; };
    return pose_.apply(*std::max_element(ring_.begin(), ring_.end(), farther));
}

Stander::Seen Stander::see(const Vec3& p) const {
    const Vec3 q = turn_.transpose() * (p - pose_.positionMm);
    const double distance = grid_.at(q);
    if (distance >= kFarMm) return {kFarMm, 0.0};
    // Beside the tooth the junction goes on as it is at its edge.
    core::Vec2 at = (q.head<2>() - middle_).cwiseQuotient(half_);
    if (const double r = core::hypot(at.x(), at.y()); r > 1.0) at /= r;
    return {distance, q.z() - junction_.dot(terms(at))};
}

}  // namespace handpiece::dentition
