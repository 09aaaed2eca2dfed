// SPDX-License-Identifier: Apache-2.0
// outline-extent, proximal-clearance; the cavosurface margin that both are taken of
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr double kNearVoxels = 0.3,
                 kFarVoxels = 2.0;  // under the uncut surface a place of the wall leads to its margin
constexpr double kBendVoxels = 0.03, kRoughVoxels = 0.5;
constexpr double kTipMm = 0.1;
constexpr double kLeastSin = 0.2;     // between both surfaces: flatter, there is no edge
constexpr double kProximalCos = 0.5;  // the uncut surface faces the tooth beside within 60 degrees

/// Whether more than a twentieth is gone of where the uncut tooth comes nearest to the one beside it. A cavity that
/// leaves all of that has its margin on the marginal ridge, and how far that is from the other tooth says nothing of
/// the contact.
bool isContactOpened(const CutTooth& tooth, const Preparation::Other& other, const Vec3& towards) {
    constexpr double kRaysMm = 0.25, kContactMm = 0.1;
    const geometry::TriangleTree& whole = tooth.whole().tree;
    const Vec3 across = towards.unitOrthogonal(), along = towards.cross(across), middle = whole.bounds().centre();
    const double reach = 0.5 * whole.bounds().size().norm();
    std::vector<std::pair<double, Vec3>> faces;
    double least = std::numeric_limits<double>::infinity();
    for (double a = -reach; a <= reach; a += kRaysMm)
        for (double b = -reach; b <= reach; b += kRaysMm) {
            const Vec3 from = middle + a * across + b * along + reach * towards;
            const geometry::RayMeeting meeting = whole.firstMeeting(from, -towards, 2.0 * reach);
            if (meeting.triangle == geometry::kNoTriangle) continue;
            const Vec3 p = from - meeting.distanceMm * towards;
            const double off = other.whole->tree.signedDistance(other.inTooth.applyInverse(p));
            least = std::min(least, off);
            faces.emplace_back(off, p);
        }
    CutTooth::Look look(tooth);
    std::size_t contact = 0, gone = 0;
    for (const auto& [off, p] : faces) {
        if (off > least + kContactMm) continue;
        ++contact;
        gone += look.now(p) - look.before(p) > 0.5 * tooth.voxelMm();
    }
    return gone > contact / 20;  // an edge that the voxels round off is none
}

}  // namespace

const std::vector<MarginPlace>& CutTooth::margin() {
    if (margin_) return *margin_;
    const std::vector<SurfacePoint>& points = cutPoints();
    std::vector<std::optional<MarginPlace>> found(points.size());
    const double low = kNearVoxels * voxelMm(), high = kFarVoxels * voxelMm();
    core::parallelFor(points.size(), 64, [&](std::size_t begin, std::size_t end) {
        Look look(*this);
        for (std::size_t i = begin; i < end; ++i) {
            // The node's own field rules out nearly all others.
            if (!(look.before(points[i].p) > -high - 0.5 * voxelMm())) continue;
            geometry::NearestPoint nearest;
            double deep = -whole().tree.signedDistance(points[i].p, &nearest);
            if (!(deep > low && deep < high)) continue;
            // On along the wall, straight, until the uncut triangles are met.
            Vec3 outer = look.normalBefore(nearest.pointMm);
            const Vec3& wall = points[i].n;
            const Vec3 up = outer - outer.dot(wall) * wall;
            if (!(up.norm() > kLeastSin)) continue;
            const Vec3 along = up.normalized();
            Vec3 p = points[i].p;
            for (int step = 0; step < 4 && std::abs(deep) > 1e-6; ++step) {
                p += deep / std::max(kLeastSin, along.dot(outer)) * along;
                deep = -whole().tree.signedDistance(p, &nearest);
                outer = look.normalBefore(nearest.pointMm);
            }
            if (std::abs(deep) > 1e-4 || (p - points[i].p).norm() > high / kLeastSin) continue;
            // Anew without the wall's normal, which near an edge is not good: from where the wall lies a half, a whole
            // and one and a half voxels under the surface. Where these do not lie in line three surfaces meet, or a bur
            // has left steps.
            const Vec3 across = (wall - wall.dot(outer) * outer).normalized();
            double off[3];
            bool isMet = true;
            for (int k = 0; k < 3; ++k) {
                const Vec3 from = p - (k + 1) * 0.5 * voxelMm() * outer + voxelMm() * across;
                const auto on = look.now(from) > 0.0 ? look.cast(from, -across, 3.0 * voxelMm()) : std::nullopt;
                isMet = isMet && on.has_value();
                off[k] = voxelMm() - on.value_or(0.0);
            }
            const double bend = std::abs(off[0] - 2.0 * off[1] + off[2]);
            if (!isMet || bend > kRoughVoxels * voxelMm()) continue;
            p += (2.0 * off[0] - off[1]) * across;
            found[i] = MarginPlace{p, outer, points[i].areaMm2 * up.norm() / (high - low),
                                   bend > kBendVoxels * voxelMm() ? bend : 0.0};
        }
    });
    margin_.emplace();
    for (const auto& place : found)
        if (place) margin_->push_back(*place);
    return *margin_;
}

Taken takeOutlineExtent(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    if (tooth.form() == Form::crown) return none("a crown preparation has no outline");
    if (of.side.empty()) return none("an extent has a direction: name the side");
    const auto towards = axisOf(tooth.preparation().axes, of.side);
    if (!towards) return none("nobody says which way " + of.side + " is");
    if (tooth.margin().empty()) return none("no edge between cut and uncut surface was found");
    // From both ends, but for a tenth of a millimetre of margin: a coarse field has bumps where two walls and the
    // surface meet. There only places count whose wall is even, unless those with steps go half a voxel farther out.
    std::vector<std::pair<double, const MarginPlace*>> even, all;
    for (const MarginPlace& place : tooth.margin()) {
        all.emplace_back(place.p.dot(*towards), &place);
        if (place.roughMm == 0.0) even.push_back(all.back());
    }
    double extent[2] = {0.0, 0.0};
    std::array<const MarginPlace*, 2> ends{};
    Taken taken;
    for (const bool isHigh : {false, true}) {
        const auto endOf = [&](std::vector<std::pair<double, const MarginPlace*>>& places) {
            std::sort(places.begin(), places.end(),
                      [&](const auto& a, const auto& b) { return isHigh ? a > b : a < b; });
            std::size_t i = 0;
            for (double length = 0.0; i + 1 < places.size() && (length += places[i].second->lengthMm) < kTipMm;)
                ++i;
            return places[i];
        };
        auto end = endOf(even.empty() ? all : even);
        if (const auto farther = endOf(all); std::abs(farther.first - end.first) > 0.5 * tooth.voxelMm()) end = farther;
        extent[isHigh ? 1 : 0] = end.first;
        ends[isHigh ? 1 : 0] = end.second;
        taken.offMm += end.second->roughMm;
    }
    taken.value = extent[1] - extent[0];
    // Too long it is where it goes farthest past the target, too short where it falls farthest behind it.
    const auto pastMm = [&](const MarginPlace* end, bool isHigh) {
        const zones::Zones* zones = tooth.preparation().zones;
        return zones == nullptr ? (isHigh ? 1.0 : 0.0) : zones->targetMm(end->p);
    };
    const bool isHighFarther = pastMm(ends[1], true) >= pastMm(ends[0], false);
    taken.evidence.push_back({{}, ends[isHighFarther ? 1 : 0]->p, {}, kMostHere});
    taken.evidence.push_back({{}, ends[isHighFarther ? 0 : 1]->p, {}, kLeastHere});
    return taken;
}

Taken takeProximalClearance(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    if (tooth.form() == Form::crown) return none("it is taken of cavities; a crown has no margin at the contact");
    if (!of.side.empty() && of.side != "mesial" && of.side != "distal")
        return none("a tooth stands beside it on the mesial or the distal side: name one of these");
    const Preparation& p = tooth.preparation();
    if (p.others.empty()) return none("the case has no tooth beside it that can be cut");
    const Vec3 middle = tooth.whole().tree.bounds().centre();
    Places even, all;
    double roughMm = 0.0;
    bool isBeside = false, isOpened = false;
    for (const std::string_view side : {"mesial", "distal"}) {
        if (!of.side.empty() && of.side != side) continue;
        const auto towards = axisOf(p.axes, side);
        if (!towards) continue;
        for (const Preparation::Other& other : p.others) {
            const geometry::TriangleTree& tree = other.whole->tree;
            if (!((other.inTooth.apply(tree.bounds().centre()) - middle).dot(*towards) > 0.0)) continue;
            isBeside = true;
            if (!isContactOpened(tooth, other, *towards)) continue;
            isOpened = true;
            for (const MarginPlace& place : tooth.margin())
                if (place.outer.dot(*towards) > kProximalCos) {
                    const double off = std::max(0.0, tree.signedDistance(other.inTooth.applyInverse(place.p)));
                    all.add(off, place.p);
                    if (place.roughMm == 0.0) even.add(off, place.p);
                    roughMm = std::max(roughMm, place.roughMm);
                }
        }
    }
    if (!isBeside) return none("no tooth stands there");
    if (!isOpened) return none("the contact with the tooth beside it has not been opened");
    if (all.values.empty()) return none("no margin of the cavity lies on the side of the tooth beside it");
    const char* const text = "margin nearest to the tooth beside it";
    Taken taken = all.taken(of, "least", text);
    taken.offMm = roughMm;
    if (even.values.empty()) return taken;
    // As of the outline: places with steps count where they make a difference of half a voxel.
    Taken ofEven = even.taken(of, "least", text);
    return std::abs(*ofEven.value - *taken.value) > 0.5 * tooth.voxelMm() ? taken : ofEven;
}

}  // namespace handpiece::measures
