// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/work_on.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/case/fdi.h"

namespace handpiece::cases {
namespace {

using core::Pose;
using core::Vec3;

/// Teeth that come nearer than this with the jaws closed are antagonists (or adjacent, whatever their numbers say).
constexpr double kAntagonistMm = 0.3;

/// Whether a point of `other`, or the middle of one of its edges, comes near the surface.
bool comesNear(const geometry::TriangleTree& tree, const geometry::TriangleMesh& other, const Pose& otherInTree) {
    const core::Mat3 turn = otherInTree.orientation.toRotationMatrix();
    const core::Box box = tree.bounds().grown(kAntagonistMm);
    const auto isNear = [&](const Vec3& p) {
        const Vec3 q = turn * p + otherInTree.positionMm;
        return ((q - box.max).array() <= 0.0).all() && ((box.min - q).array() <= 0.0).all() &&
               tree.nearest(q, kAntagonistMm).triangle != geometry::kNoTriangle;
    };
    return std::any_of(other.vertices.begin(), other.vertices.end(), isNear) ||
           std::any_of(other.triangles.begin(), other.triangles.end(), [&](const geometry::Triangle& t) {
               for (std::size_t e = 0; e < 3; ++e)
                   if (isNear(0.5 * (other.vertices[t[e]] + other.vertices[t[(e + 1) % 3]]))) return true;
               return false;
           });
}

}  // namespace

void chooseCuttable(Case& c) {
    if (c.others.empty() || c.surface().triangles.empty()) return;
    const geometry::TriangleTree own(c.surface());
    const Pose closing = c.opening.inverse();
    const auto closed = [&](int fdi, const Pose& inCase) { return isLowerTooth(fdi) ? closing * inCase : inCase; };
    const Pose toOwn = closed(c.fdiNumber, {}).inverse();
    for (PlacedTooth& other : c.others)
        other.isCuttable = areAdjacentTeeth(c.fdiNumber, other.fdiNumber) ||
                           comesNear(own, other.surface(), toOwn * closed(other.fdiNumber, other.inCase));
}

Case workOn(Case c, int fdi) {
    if (fdi != 0 && fdi == c.fdiNumber) return c;
    const auto found =
        std::find_if(c.others.begin(), c.others.end(), [&](const PlacedTooth& o) { return o.fdiNumber == fdi; });
    if (fdi == 0 || found == c.others.end()) {
        std::vector<int> there;
        for (const PlacedTooth& other : c.others)
            if (other.fdiNumber != 0) there.push_back(other.fdiNumber);
        throw core::Error(fmt::format("the case has no tooth {}", fdi), c.source.string(),
                          there.empty() ? "it has no other tooth with a number"
                                        : fmt::format("its others are {}", fmt::join(there, ", ")))
            .as("no-such-tooth", {std::to_string(fdi)});
    }
    PlacedTooth chosen = std::move(*found);
    c.others.erase(found);
    const Pose newInOld = chosen.inCase, oldInNew = newInOld.inverse();
    PlacedTooth former;
    static_cast<Tooth&>(former) = std::move(static_cast<Tooth&>(c));
    static_cast<Tooth&>(c) = std::move(static_cast<Tooth&>(chosen));
    for (PlacedTooth& other : c.others)
        other.inCase = (oldInNew * other.inCase).normalised();
    former.inCase = oldInNew;
    // Teeth in the order of their numbers stay so.
    const auto after = std::find_if(c.others.begin(), c.others.end(),
                                    [&](const PlacedTooth& o) { return o.fdiNumber > former.fdiNumber; });
    c.others.insert(after, std::move(former));
    for (Part& part : c.scenery)
        part.mesh = geometry::transformed(std::move(part.mesh), oldInNew);
    c.opening = (oldInNew * c.opening * newInOld).normalised();
    c.exercise.reset();
    chooseCuttable(c);
    return c;
}

}  // namespace handpiece::cases
