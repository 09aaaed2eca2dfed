// SPDX-License-Identifier: Apache-2.0
// A mouth's jaws, opened and closed.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/model/case/fdi.h"
#include "handpiece/model/case/work_on.h"

namespace handpiece::cases {
namespace {

using core::Pose;
using core::Vec3;

constexpr double kWidestDegrees = 60.0;
/// How far behind the incisal edges the first to eighth tooth's cusps lie, about [R]: where the front teeth are
/// missing.
constexpr std::array<double, 8> kBehindMm{0.0, 1.5, 5.0, 11.0, 17.0, 25.0, 35.0, 44.0};
constexpr double kTopMm = 0.5;  ///< under a tooth's highest point all counts as its edge

bool isOfOtherArch(int fdi, const Case& c) {
    return fdi != 0 && isLowerTooth(fdi) != isLowerTooth(c.fdiNumber);
}

/// Moves the arch that the own tooth does not stand in; what stands around goes with the arch whose teeth it is nearer
/// to. False where there is no other arch.
bool moveOtherArch(Case& c, const Pose& moved) {
    Vec3 middle[2] = {Vec3::Zero(), Vec3::Zero()};  // of this arch's teeth, of the other's
    double count[2] = {1.0, 0.0};
    for (const PlacedTooth& other : c.others) {
        const int arch = isOfOtherArch(other.fdiNumber, c) ? 1 : 0;
        middle[arch] += other.inCase.positionMm;
        count[arch] += 1.0;
    }
    if (count[1] == 0.0) return false;
    const auto distance = [&](const Vec3& p, int arch) { return (p - middle[arch] / count[arch]).norm(); };
    for (Part& part : c.scenery)
        if (const Vec3 at = part.mesh.bounds().centre(); distance(at, 1) < distance(at, 0))
            part.mesh = geometry::transformed(std::move(part.mesh), moved);
    for (PlacedTooth& other : c.others)
        if (isOfOtherArch(other.fdiNumber, c)) other.inCase = (moved * other.inCase).normalised();
    return true;
}

/// Middle of a tooth's edge or cusps, in its own frame.
Vec3 edgeOf(const Tooth& tooth) {
    const geometry::TriangleMesh& mesh = tooth.surface();
    const double top = mesh.bounds().max.z();
    Vec3 sum = Vec3::Zero();
    double count = 0.0;
    for (const Vec3& v : mesh.vertices)
        if (v.z() > top - kTopMm) {
            sum += v;
            count += 1.0;
        }
    return sum / std::max(1.0, count);
}

/// Both jaws as they stand in the case: which way is up and forward, and where their incisal edges are.
struct Jaws {
    Vec3 left, forward, up;
    std::array<Vec3, 2> incisalMm;  ///< upper, lower; in the plane between left and right alone
};

std::optional<Jaws> jawsOf(const Case& c) {
    struct Stands {
        int fdi;
        Vec3 edgeMm;
    };
    std::vector<Stands> teeth;
    Vec3 up = Vec3::Zero(), forward = Vec3::Zero();
    const auto take = [&](const Tooth& tooth, const Pose& pose) {
        const int place = tooth.fdiNumber % 10;
        if (tooth.fdiNumber == 0 || place < 1 || place > 8) return;
        const core::Mat3 axes = pose.orientation.toRotationMatrix();
        up += isLowerTooth(tooth.fdiNumber) ? axes.col(2) : Vec3(-axes.col(2));
        // Premolars and molars have mesial in front, the front teeth their labial side.
        if (place >= 4)
            forward += axes.col(0);
        else if (tooth.buccalSign != 0)
            forward += tooth.buccalSign * axes.col(1);
        teeth.push_back({tooth.fdiNumber, pose.apply(edgeOf(tooth))});
    };
    take(c, {});
    for (const PlacedTooth& other : c.others)
        take(other, other.inCase);
    Jaws jaws;
    jaws.up = up.normalized();
    jaws.forward = (forward - forward.dot(jaws.up) * jaws.up).normalized();
    jaws.left = jaws.up.cross(jaws.forward);
    std::array<double, 2> foremost;
    foremost.fill(-std::numeric_limits<double>::infinity());
    for (const Stands& tooth : teeth) {
        const std::size_t jaw = isLowerTooth(tooth.fdi) ? 1 : 0;
        const double behind = kBehindMm[static_cast<std::size_t>(tooth.fdi % 10 - 1)];
        const double at = tooth.edgeMm.dot(jaws.forward);
        if (at <= foremost[jaw]) continue;
        foremost[jaw] = at;
        jaws.incisalMm[jaw] = (at + behind) * jaws.forward + tooth.edgeMm.dot(jaws.up) * jaws.up;
    }
    const bool isWhole = std::isfinite(foremost[0]) && std::isfinite(foremost[1]) && jaws.forward.allFinite();
    return isWhole && jaws.up.allFinite() ? std::optional(jaws) : std::nullopt;
}

}  // namespace

Case inOcclusion(Case c) {
    // Of the other arch than the own tooth's; its own stays where it is.
    if (moveOtherArch(c, isLowerTooth(c.fdiNumber) ? c.opening : c.opening.inverse())) c.opening = {};
    return c;
}

Pose openedAbout(const Vec3& hingeMm, const Vec3& left, const Vec3& upperIncisalMm, const Vec3& lowerIncisalMm,
                 double openingMm) {
    const auto mandible = [&](double rad) {
        const core::Quat turn = core::rotationAbout(left, rad);
        return Pose{hingeMm - turn * hingeMm, turn};
    };
    double least = 0.0, most = kWidestDegrees * (std::numbers::pi / 180.0);
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (least + most);
        const bool isWide = (mandible(middle).apply(lowerIncisalMm) - upperIncisalMm).norm() > openingMm;
        (isWide ? most : least) = middle;
    }
    return mandible(least);
}

bool openJaws(Case& c, double incisalOpeningMm) {
    const std::optional<Jaws> jaws = jawsOf(c);
    if (!jaws) return false;
    const auto& [upper, lower] = jaws->incisalMm;
    if ((lower - upper).norm() > incisalOpeningMm) return false;
    const Vec3 hinge = lower - kBonwillHeightMm * core::cos(kBalkwillRad) * jaws->forward +
                       kBonwillHeightMm * core::sin(kBalkwillRad) * jaws->up;
    const Pose opening = openedAbout(hinge, jaws->left, upper, lower, incisalOpeningMm);
    if (!moveOtherArch(c, isLowerTooth(c.fdiNumber) ? opening.inverse() : opening)) return false;
    c.opening = (opening * c.opening).normalised();
    return true;
}

}  // namespace handpiece::cases
