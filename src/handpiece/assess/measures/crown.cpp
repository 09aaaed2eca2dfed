// SPDX-License-Identifier: Apache-2.0
// reduction, occlusal-convergence, margin-width, margin-continuity, margin-height, axial-depth
#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/assess/measures/cusps.h"
#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr double kFarMm = 10.0;
constexpr double kCuspMm = 1.0;    // about a cusp's tip, square to the path of draw, is the cusp
constexpr double kAxialSin = 0.5;  // an axial wall stands within 30 degrees of the path of draw
constexpr double kWallStepMm = 0.25, kWallShare = 0.05;
constexpr double kWallOffMm = 0.75;  // from the wall's middle, towards its side: farther off is another one
constexpr double kWallCos = 0.9848078, kSteadyCos = 0.8660254;  // 10 and 30 degrees
constexpr double kMarginWidthMm = 0.1;                          // less is no finish line
constexpr std::size_t kLeastSections = 8;
constexpr double kNone = std::numeric_limits<double>::infinity();
const char* const kNoCrown = "it is taken of crown preparations; this is a cavity";

/// Standard deviation of a mean over stations round the crown.
double scatterOf(const Places& places) {
    return localScatter(places.values, 1) / std::sqrt(static_cast<double>(places.values.size()));
}

/// At most so many of many, evenly.
std::size_t strideFor(std::size_t count) {
    return std::max<std::size_t>(1, (count + 5999) / 6000);
}

struct Cusp {
    const cases::Landmark* tip = nullptr;
    double half = 0.0;  ///< +1: what of it is mesial, -1: distal; 0: all
};
Cusp cuspOf(std::span<const cases::Landmark> landmarks, std::string_view side) {
    const auto named = [&](std::string_view name) -> const cases::Landmark* {
        for (const cases::Landmark& mark : landmarks) {
            if (mark.kind != cases::LandmarkKind::cuspTip) continue;
            std::string its = mark.name;
            if (const std::size_t at = its.find("palatal"); at != std::string::npos) its.replace(at, 7, "lingual");
            if (mark.name == name || its == name) return &mark;
        }
        return nullptr;
    };
    if (std::find(std::begin(kCusps), std::end(kCusps), side) == std::end(kCusps)) return {named(side)};
    const std::string_view name = side.substr(0, side.find('-'));
    if (const cases::Landmark* whole = named(name)) return {whole};
    constexpr std::string_view kMesio = "mesio";  // as long as "disto"
    return {named(name.substr(kMesio.size())), name.starts_with(kMesio) ? 1.0 : -1.0};
}

}  // namespace

Taken takeReduction(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    const Axes& axes = tooth.preparation().axes;
    // Cut and uncut surface both face a side; or lie about a cusp, by its name.
    std::function<bool(const Vec3& p, const Vec3& n)> isPart = [](const Vec3&, const Vec3&) { return true; };
    bool isCusp = false;
    if (of.side == "occlusal") {
        isPart = [&](const Vec3&, const Vec3& n) { return n.dot(axes.longAxis) > kSin45; };
    } else if (std::find(std::begin(kSides), std::end(kSides), of.side) != std::end(kSides)) {
        const auto towards = sideDirection(axes, of.side);
        if (!towards) return none("the path of draw runs along that side, or it is not known");
        isPart = [&axes, side = *towards](const Vec3&, const Vec3& n) {
            return n.dot(side) > kSin45 && std::abs(n.dot(axes.longAxis)) < kSin45;
        };
    } else if (!of.side.empty()) {
        const auto [cusp, half] = cuspOf(tooth.preparation().landmarks, of.side);
        if (cusp == nullptr) return none("no side and no cusp of the case is called \"" + of.side + "\"");
        isCusp = true;
        isPart = [&axes, tip = cusp->pointsMm.front(), half = half](const Vec3& p, const Vec3& n) {
            Vec3 off = p - tip;
            off -= off.dot(axes.longAxis) * axes.longAxis;
            return off.norm() < kCuspMm && half * off.dot(axes.mesial) >= 0.0 && n.dot(axes.longAxis) > 0.0;
        };
    }
    std::vector<const SurfacePoint*> part;
    for (const SurfacePoint& point : tooth.cutPoints())
        if (isPart(point.p, point.n)) part.push_back(&point);
    if (part.empty()) return none("nothing was cut there");
    const std::size_t stride = strideFor(part.size());
    std::vector<double> depth((part.size() + stride - 1) / stride, kNone);
    core::parallelFor(depth.size(), 32, [&](std::size_t begin, std::size_t end) {
        CutTooth::Look look(tooth);
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& p = part[i * stride]->p;
            // The shortest way ends square to the uncut surface.
            geometry::NearestPoint nearest;
            const double under = -tooth.whole().tree.signedDistance(p, &nearest);
            const Vec3 before = look.normalBefore(nearest.pointMm);
            // From deep under a tip the shortest way ends on its slopes, farther off.
            if (isCusp ? before.dot(axes.longAxis) > 0.0 : isPart(nearest.pointMm, before)) depth[i] = under;
        }
    });
    Places places;
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (depth[i] != kNone) places.add(depth[i], part[i * stride]->p);
    if (places.values.empty()) return none("nothing was cut there");
    return places.taken(of, "median", "reduced here");
}

Taken takeConvergence(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    if (tooth.form() != Form::crown) return none(kNoCrown);
    const std::vector<AxialStation>& walls = tooth.axialWalls();
    Places places;
    constexpr int kHalf = CutTooth::kAzimuths / 2;
    std::size_t sections = 0;
    for (int i = 0; i < kHalf; ++i) {
        const AxialStation& one = walls[static_cast<std::size_t>(i)];
        const AxialStation& other = walls[static_cast<std::size_t>(i + kHalf)];
        if (!one.middle.isFound || !other.middle.isFound) continue;
        ++sections;
        if (!of.side.empty() && one.side != of.side && other.side != of.side) continue;
        places.add(-kDegrees * (core::atan(one.middle.slope) + core::atan(other.middle.slope)),
                   one.hasMargin ? one.marginMm : tooth.cutPoints().front().p);
    }
    if (sections < kLeastSections) return none("fewer than eight sections have two axial walls");
    if (places.values.empty()) return none("no section there has two axial walls");
    Taken taken = places.taken(of, "mean", "section through here");
    taken.residual = scatterOf(places);
    return taken;
}

Taken takeMarginWidth(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    if (tooth.form() != Form::crown) return none(kNoCrown);
    Places places;
    for (const AxialStation& station : tooth.axialWalls())
        if (station.hasMargin && station.middle.isFound && (of.side.empty() || station.side == of.side))
            places.add(std::max(0.0, station.widthMm), station.marginMm);
    if (places.values.empty()) return none("no margin under an axial wall was found there");
    Taken taken = places.taken(of, "median", "finish line");
    taken.residual = scatterOf(places);
    return taken;
}

Taken takeMarginContinuity(CutTooth& tooth, const Selection&) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    if (tooth.form() != Form::crown) return none(kNoCrown);
    std::size_t wide = 0;
    Taken taken;
    for (const AxialStation& station : tooth.axialWalls()) {
        if (station.hasMargin && station.middle.isFound && station.widthMm >= kMarginWidthMm)
            ++wide;
        else if (station.hasMargin && taken.evidence.empty())
            taken.evidence.push_back({{}, station.marginMm, {}, "no finish line here"});
    }
    if (wide == 0) return none("no finish line was found");
    taken.value = 100.0 * static_cast<double>(wide) / CutTooth::kAzimuths;
    return taken;
}

Taken takeMarginHeight(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    const geometry::TriangleTree* gingiva = tooth.preparation().gingiva;
    if (gingiva == nullptr) return none("the case has no gingiva");
    if (tooth.form() != Form::crown) return none(kNoCrown);
    const Vec3 up = tooth.preparation().axes.longAxis;
    constexpr double kBesideMm = 0.1, kStepMm = 0.05, kSearchMm = 6.0;
    Places places;
    for (const AxialStation& station : tooth.axialWalls()) {
        if (!station.hasMargin || !station.middle.isFound || !(of.side.empty() || station.side == of.side)) continue;
        // The gingiva's edge: where, coming down along the uncut tooth a little beside it, one is in the gingiva.
        const auto isIn = [&](double height) {
            const Vec3 inner = station.marginMm + height * up;
            const Vec3 from = inner + kFarMm * station.h;
            const geometry::RayMeeting met = tooth.whole().tree.firstMeeting(from, -station.h, 2.0 * kFarMm);
            if (met.triangle == geometry::kNoTriangle) return false;
            return gingiva->signedDistance(from - (met.distanceMm - kBesideMm) * station.h) < 0.0;
        };
        double low = kSearchMm;
        while (low > -kSearchMm && !isIn(low))
            low -= kStepMm;
        if (!(low > -kSearchMm) || low >= kSearchMm) continue;
        double high = low + kStepMm;
        for (int i = 0; i < 12; ++i)
            (isIn(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
        places.add(-low, station.marginMm);
    }
    if (places.values.empty()) return none("no margin there stands over an edge of the gingiva");
    Taken taken = places.taken(of, "mean", "margin over the gingiva");
    taken.residual = scatterOf(places);
    return taken;
}

namespace {

struct Axial {
    Places places;
    double areaMm2 = 0.0;
};
/// Cut surface that stands along the tooth and looks out freely towards a side.
Axial axialTowards(CutTooth& tooth, const Vec3& towards) {
    // Of a cavity that is drawn out sideways the axial wall is its floor: it still stands along the long axis.
    const Axes& axes = tooth.preparation().axes;
    const Vec3& upright = std::abs(axes.draw.dot(axes.longAxis)) > kSin45 ? axes.draw : axes.longAxis;
    std::vector<const SurfacePoint*> part;
    for (const SurfacePoint& point : tooth.cutPoints())
        if (std::abs(point.n.dot(upright)) < kAxialSin && point.n.dot(towards) > kSin45) part.push_back(&point);
    const std::size_t stride = strideFor(part.size());
    std::vector<double> depth(part.empty() ? 0 : (part.size() + stride - 1) / stride, kNone);
    core::parallelFor(depth.size(), 32, [&](std::size_t begin, std::size_t end) {
        CutTooth::Look look(tooth);
        for (std::size_t i = begin; i < end; ++i) {
            const SurfacePoint& point = *part[i * stride];
            const geometry::RayMeeting met = tooth.whole().tree.firstMeeting(point.p, point.n, kFarMm);
            if (met.triangle == geometry::kNoTriangle) continue;
            // Round a scanned cavity noise makes a skin of what was not cut.
            if (tooth.preparation().noiseMm > 0.0 && met.distanceMm < kScanSeedMm) continue;
            // A wall that looks out under the occlusal margin, or at another wall, is no axial one.
            if (!(look.normalBefore(point.p + met.distanceMm * point.n).dot(towards) > kSin45)) continue;
            const double off = 2.0 * tooth.voxelMm();
            const auto wall = look.cast(point.p + off * point.n, point.n, met.distanceMm);
            if (!wall || off + *wall > met.distanceMm - off) depth[i] = met.distanceMm;
        }
    });
    // What lies farther in by a step is another wall: the distal one of an MO looks out over the pulpal floor, too.
    // Hence the outermost stretch of depths that much of the surface has.
    std::vector<double> share(static_cast<std::size_t>(kFarMm / kWallStepMm) + 1, 0.0);
    double all = 0.0;
    const auto binOf = [&](double d) { return std::min(share.size() - 1, static_cast<std::size_t>(d / kWallStepMm)); };
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (const SurfacePoint& point = *part[i * stride]; depth[i] != kNone && point.n.dot(towards) > kSteadyCos) {
            share[binOf(depth[i])] += point.areaMm2;
            all += point.areaMm2;
        }
    std::size_t from = 0;
    while (from < share.size() && !(share[from] > kWallShare * all))
        ++from;
    std::size_t to = from;
    while (to < share.size() && share[to] > kWallShare * all)
        ++to;
    const auto isInStretch = [&](std::size_t i) {
        return depth[i] != kNone &&
               (tooth.form() == Form::crown || (depth[i] > kWallStepMm * (static_cast<double>(from) - 1.0) &&
                                                depth[i] < kWallStepMm * (static_cast<double>(to) + 1.0)));
    };
    // Beside the isthmus of an MO others look out as near to the surface: the wall is where most of it stands.
    std::vector<double> stands;
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (isInStretch(i)) stands.push_back(part[i * stride]->p.dot(towards));
    const double middle = stands.empty() ? 0.0 : statisticOf(stands, "median", nullptr);
    const auto isOfWall = [&](std::size_t i) {
        return isInStretch(i) &&
               (tooth.form() == Form::crown || std::abs(part[i * stride]->p.dot(towards) - middle) < kWallOffMm);
    };
    // A cavity's corners are none of it; a crown's walls go round.
    Vec3 mean = Vec3::Zero();
    for (int round = 0; round < 3 && tooth.form() == Form::cavity; ++round) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < depth.size(); ++i)
            if (const SurfacePoint& point = *part[i * stride];
                isOfWall(i) && (round == 0 || point.n.dot(mean) > kWallCos))
                sum += point.areaMm2 * point.n;
        if (!(sum.norm() > 0.0)) break;
        mean = sum.normalized();
    }
    Axial axial;
    for (std::size_t i = 0; i < depth.size(); ++i)
        if (isOfWall(i) && (mean.isZero() || part[i * stride]->n.dot(mean) > kWallCos)) {
            axial.places.add(depth[i], part[i * stride]->p);
            axial.areaMm2 += static_cast<double>(stride) * part[i * stride]->areaMm2;
        }
    return axial;
}

}  // namespace

Taken takeAxialDepth(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    const Axes& axes = tooth.preparation().axes;
    const auto directionOf = [&](std::string_view side) {
        const auto square = sideDirection(axes, side);
        return square ? square : axisOf(axes, side);
    };
    if (of.side.empty()) {
        // A crown has it all round; which wall is the axial one else only a cavity that is drawn out sideways says.
        if (tooth.form() == Form::crown) {
            Places all;
            for (const std::string_view side : {"mesial", "distal", "buccal", "lingual"})
                if (const auto towards = directionOf(side)) {
                    const Places some = axialTowards(tooth, *towards).places;
                    for (std::size_t i = 0; i < some.values.size(); ++i)
                        all.add(some.values[i], some.mm[i]);
                }
            if (all.values.empty()) return none("no axial wall looks out of the tooth");
            return all.taken(of, "median", "axial wall");
        }
        if (std::abs(axes.draw.dot(axes.longAxis)) > kSin45) return none("axial depth is of one side: name it");
        constexpr double kLeastShare = 0.25;  // of what looks out: less is the rim of a wall
        Axial proximal, facial = axialTowards(tooth, axes.draw);
        for (const std::string_view side : {"mesial", "distal"})
            if (Axial one = axialTowards(tooth, *directionOf(side)); one.areaMm2 > proximal.areaMm2)
                proximal = std::move(one);
        const bool isProximal = proximal.areaMm2 > kLeastShare * (proximal.areaMm2 + facial.areaMm2);
        const Places& places = isProximal ? proximal.places : facial.places;
        if (places.values.empty()) return none("no axial wall looks out of the cavity");
        return places.taken(of, "median", "axial wall");
    }
    if (of.side == "occlusal" || of.side == "gingival")
        return none("an axial wall looks mesial, distal, buccal or lingual");
    const auto towards = directionOf(of.side);
    if (!towards) return none("nobody says which side is " + of.side);
    const Places places = axialTowards(tooth, *towards).places;
    if (places.values.empty()) return none("no axial wall faces that side");
    return places.taken(of, "median", "axial wall");
}

}  // namespace handpiece::measures
