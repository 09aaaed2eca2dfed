// SPDX-License-Identifier: Apache-2.0
#include "handpiece/scan/registration/place_arches.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/model/case/fdi.h"
#include "handpiece/scan/registration/moments.h"

namespace handpiece::registration {
namespace {

using core::Mat3;
using core::Vec3;

/// A tooth whose volume is no longer than this along its axis has none [ratio of spreads].
constexpr double kLong = 1.5;
/// An own axis that lies so far off the arch's is not the tooth's.
constexpr double kLeastCos = 0.7;
constexpr double kCrownShare = 0.4;
constexpr double kNeighbour = 0.5;  ///< what the other jaw's place says counts if it is so plain (cosine)
constexpr double kPlainMajority = 0.7;

struct Looked {
    int fdi = 0;
    const geometry::TriangleMesh* outer = nullptr;
    Vec3 mean, axis;  ///< towards the thick end
    double weight = 0.0;
    Vec3 occlusal = Vec3::UnitZ(), crown = Vec3::Zero();
    double low = 0.0, high = 0.0;  ///< along occlusal
};

Looked look(const ToothOfArch& tooth) {
    Looked l{tooth.fdi, tooth.outer, {}, {}};
    const Moments m = volumeMoments(*tooth.outer);
    const Axes axes = principalAxes(m.covariance);
    l.mean = m.mean;
    l.axis = axes.vectors.col(0);
    if (volumeSkew(*tooth.outer, m.mean, l.axis) > 0.0) l.axis = -l.axis;
    l.weight = axes.spread[0] > kLong * axes.spread[1] ? 1.0 : 0.2;
    return l;
}

Vec3 across(const Vec3& v, const Vec3& to) {
    return v - v.dot(to) * to;
}

/// The way most long axes go, towards the thick ends.
Vec3 commonAxis(const std::vector<Looked*>& jaw) {
    Mat3 sum = Mat3::Zero();
    for (const Looked* l : jaw)
        sum += l->weight * l->axis * l->axis.transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(sum);
    Vec3 axis = solver.eigenvectors().col(2);
    double ways = 0.0;
    for (const Looked* l : jaw)
        ways += l->weight * l->axis.dot(axis);
    return ways < 0.0 ? Vec3(-axis) : axis;
}

Vec3 meanOf(const std::vector<Looked*>& jaw) {
    Vec3 sum = Vec3::Zero();
    for (const Looked* l : jaw)
        sum += l->mean;
    return sum / static_cast<double>(std::max<std::size_t>(1, jaw.size()));
}

void findCrown(Looked& l, const Vec3& occlusal) {
    const double cosine = l.axis.dot(occlusal);
    l.occlusal = l.weight == 1.0 && std::abs(cosine) > kLeastCos ? Vec3(cosine < 0.0 ? -l.axis : l.axis) : occlusal;
    l.low = 1e300;
    l.high = -1e300;
    for (const Vec3& v : l.outer->vertices) {
        l.low = std::min(l.low, v.dot(l.occlusal));
        l.high = std::max(l.high, v.dot(l.occlusal));
    }
    Vec3 sum = Vec3::Zero();
    double count = 0.0;
    for (const Vec3& v : l.outer->vertices)
        if (v.dot(l.occlusal) > l.high - kCrownShare * (l.high - l.low)) {
            sum += v;
            count += 1.0;
        }
    l.crown = sum / count;
}

/// Towards the midline along the arch; zero where no other tooth of the jaw stands.
Vec3 mesialOf(const Looked& own, const std::vector<Looked*>& jaw) {
    const int at = cases::placeAlongArch(own.fdi), midline = cases::isRightTooth(own.fdi) ? 1 : -1;
    const auto nearest = [&](int way) {
        const Looked* found = nullptr;
        for (const Looked* l : jaw) {
            const int off = way * (cases::placeAlongArch(l->fdi) - at);
            if (off <= 0) continue;
            if (!found || off < way * (cases::placeAlongArch(found->fdi) - at)) found = l;
        }
        return found;
    };
    const Looked *mesial = nearest(midline), *distal = nearest(-midline);
    if (!mesial && !distal) return Vec3::Zero();
    return (mesial ? mesial->crown : own.crown) - (distal ? distal->crown : own.crown);
}

}  // namespace

PlacedArches placeArches(std::span<const ToothOfArch> teeth) {
    std::vector<Looked> looked;
    for (const ToothOfArch& tooth : teeth)
        looked.push_back(look(tooth));
    std::array<std::vector<Looked*>, 2> jaws;  // upper, lower
    for (Looked& l : looked)
        jaws[cases::isLowerTooth(l.fdi) ? 1 : 0].push_back(&l);
    std::array<Vec3, 2> occlusal{Vec3::Zero(), Vec3::Zero()};
    for (std::size_t j = 0; j < 2; ++j)
        if (!jaws[j].empty()) occlusal[j] = commonAxis(jaws[j]);
    if (!jaws[0].empty() && !jaws[1].empty()) {
        const Vec3 down = (meanOf(jaws[1]) - meanOf(jaws[0])).normalized();
        // Where the other jaw is tells more surely than which end is thin.
        if (std::abs(occlusal[0].dot(down)) > kNeighbour) occlusal[0] *= occlusal[0].dot(down) < 0.0 ? -1.0 : 1.0;
        if (std::abs(occlusal[1].dot(down)) > kNeighbour) occlusal[1] *= occlusal[1].dot(down) > 0.0 ? -1.0 : 1.0;
    }
    PlacedArches made;
    made.upInScan = (occlusal[1] - occlusal[0]).normalized();
    double asNumbered = 0.0, mirrored = 0.0;
    Vec3 front = Vec3::Zero();
    for (std::size_t j = 0; j < 2; ++j) {
        Vec3 middle = Vec3::Zero(), incisors = Vec3::Zero(), molars = Vec3::Zero();
        double incisorCount = 0.0, molarCount = 0.0;
        for (Looked* l : jaws[j]) {
            findCrown(*l, occlusal[j]);
            middle += l->crown / static_cast<double>(jaws[j].size());
            const int place = l->fdi % 10;
            if (place <= 2) incisors += l->crown, incisorCount += 1.0;
            if (place >= 5) molars += l->crown, molarCount += 1.0;
        }
        if (incisorCount > 0.0 && molarCount > 0.0)
            front += across(incisors / incisorCount - molars / molarCount, made.upInScan).normalized();
        if (jaws[j].size() < 3) continue;
        for (const Looked* l : jaws[j]) {
            const Vec3 mesial = across(mesialOf(*l, jaws[j]), l->occlusal);
            const Vec3 outwards = across(l->crown - middle, l->occlusal);
            // +y is buccal on the upper right and the lower left.
            const double y = l->occlusal.cross(mesial.normalized()).dot(outwards);
            const bool isRight = (l->fdi / 10 % 2 == 1) == (y > 0.0);
            (isRight ? asNumbered : mirrored) += std::abs(y);
        }
    }
    made.isMirrored = mirrored > kPlainMajority * (asNumbered + mirrored) && mirrored > 0.0;
    if (front.norm() > 1e-6) made.frontInScan = front.normalized();
    for (const Looked& l : looked) {
        const std::vector<Looked*>& jaw = jaws[cases::isLowerTooth(l.fdi) ? 1 : 0];
        Placed placed;
        Vec3 mesial = across(mesialOf(l, jaw), l.occlusal);
        placed.isMesialGuessed = !(mesial.norm() > 1e-6);
        mesial = placed.isMesialGuessed ? l.occlusal.unitOrthogonal() : Vec3(mesial.normalized());
        placed.confidence = placed.isMesialGuessed ? 0.4 : 0.7;
        Mat3 toTooth;
        toTooth.row(0) = mesial;
        toTooth.row(1) = l.occlusal.cross(mesial);
        toTooth.row(2) = l.occlusal;
        placed.scanInTooth.orientation = core::Quat(toTooth).normalized();
        const Vec3 origin = across(l.crown, l.occlusal) + (l.high - kCrownShare * (l.high - l.low)) * l.occlusal;
        placed.scanInTooth.positionMm = -(placed.scanInTooth.orientation * origin);
        made.teeth.push_back(std::move(placed));
    }
    return made;
}

}  // namespace handpiece::registration
