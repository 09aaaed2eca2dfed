// SPDX-License-Identifier: Apache-2.0
// wall-height, wall-angle, undercut-area, undercut-depth, cavosurface-angle
#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

// Less is none: nor is what the wall's own roughness makes from valley to peak (two crossed waves: four times its rms,
// waves in three directions five), or four tenths of a voxel, by which a coarse field may make a mark too deep.
constexpr double kLeastUndercutMm = 0.03, kLeastUndercutVoxels = 0.4, kRoughnessTimes = 5.0;
// A wall's form is its mean over the roughness's cut-off, 0.8 mm along it.
constexpr int kFormPlaces = 17;
constexpr double kFormCos = 0.7071068;   // 45 degrees: deep marks turn the aim by 20 to either side
constexpr double kTopMm = 0.3;           // of wall and of uncut surface at a margin
constexpr std::size_t kPiecePlaces = 6;  // kPieceMm along a wall
constexpr std::size_t kScanReach = 2;    // stations to either side that bear a scanned one out
constexpr double kEdgeMm = 0.04;         // right at it nothing is taken
// What is open about a height, from measures_study's seeds 902 to 904: a crown's wall ends in a round edge, known to so
// much and so much of a voxel; along a molar's wall the margin runs up and down, of which so much stays open.
constexpr double kRoundEdgeMm = 0.006, kRoundEdge = 0.06, kOfSpread = 0.02;

bool isOn(const Selection& of, std::string_view side) {
    return of.side.empty() || of.side == side;
}

/// Walls of the floor, corners between two of them left out where there is anything else.
std::vector<const WallStation*> straightWalls(CutTooth& tooth, const Selection& of) {
    std::vector<const WallStation*> all, straight;
    for (const WallStation& wall : tooth.walls()) {
        if (!isOn(of, wall.side) || wall.floor != 0) continue;
        all.push_back(&wall);
        if (!wall.isCorner) straight.push_back(&wall);
    }
    return straight.empty() ? all : straight;
}

std::string noWall(const Selection& of) {
    return of.side.empty() ? "no wall rises from the floor" : "no " + of.side + " wall rises from the floor";
}

/// How deep a wall's profile lies behind what is above it, at worst, and how much of it does.
struct Undercut {
    double depthMm = 0.0, lengthMm = 0.0;
    std::size_t deepest = 0, above = 0;  ///< samples; the one that it lies behind
};
Undercut undercutOf(std::span<const WallStation::Sample> samples, double outwards) {
    Undercut found;
    if (samples.size() < 2) return found;
    double least = outwards * samples.back().r;
    std::size_t above = samples.size() - 1;
    for (std::size_t i = samples.size(); i-- > 0;) {
        const double r = outwards * samples[i].r;
        if (r < least) {
            least = r;
            above = i;
        }
        const double behind = r - least;
        if (behind > found.depthMm) {
            found.depthMm = behind;
            found.deepest = i;
            found.above = above;
        }
        if (behind > 0.001 && i + 1 < samples.size())
            found.lengthMm += core::hypot(samples[i + 1].w - samples[i].w, samples[i + 1].r - samples[i].r);
    }
    return found;
}

/// How far a wall lies behind at one height what it is at another, on the mean of the places beside it.
double formBehind(CutTooth& tooth, const WallStation& wall, double deepW, double aboveW) {
    const auto at = [](const WallStation& of, double w) -> std::optional<double> {
        const auto next = std::lower_bound(of.samples.begin(), of.samples.end(), w,
                                           [](const WallStation::Sample& s, double height) { return s.w < height; });
        if (next == of.samples.end()) return {};
        if (next == of.samples.begin()) return next->w - w < 1e-9 ? std::optional(next->r) : std::nullopt;
        const WallStation::Sample &low = *(next - 1), &high = *next;
        return low.r + (high.r - low.r) * (w - low.w) / (high.w - low.w);
    };
    // Walls come row by row. At a wall's end the nearest places all lie to one side.
    const std::vector<WallStation>& walls = tooth.walls();
    const std::ptrdiff_t here = &wall - walls.data();
    constexpr std::ptrdiff_t kSearch = 4 * kFormPlaces;
    std::vector<std::pair<int, double>> beside;  // rows off; how far behind
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, here - kSearch);
         i < std::min(static_cast<std::ptrdiff_t>(walls.size()), here + kSearch + 1); ++i) {
        const WallStation& other = walls[static_cast<std::size_t>(i)];
        if (other.floor != wall.floor || other.run != wall.run || other.side != wall.side ||
            std::abs(other.row - wall.row) >= kFormPlaces || other.h.dot(wall.h) < kFormCos)
            continue;
        const auto deep = at(other, deepW), above = at(other, aboveW);
        if (deep && above) beside.emplace_back(std::abs(other.row - wall.row), *deep - *above);
    }
    std::sort(beside.begin(), beside.end());
    if (beside.size() > kFormPlaces) beside.resize(kFormPlaces);
    double sum = 0.0;
    for (const auto& [rows, behind] : beside)
        sum += behind;
    return beside.empty() ? 0.0 : sum / static_cast<double>(beside.size());
}

struct AllUndercuts {
    double areaMm2 = 0.0, depthMm = 0.0;
    Vec3 deepest = Vec3::Zero();
    std::size_t asked = 0;
};
AllUndercuts undercuts(CutTooth& tooth, const Selection& of) {
    AllUndercuts all;
    const DrawFrame& frame = tooth.frame();
    const double leastMm = std::max(kLeastUndercutMm, kLeastUndercutVoxels * tooth.voxelMm());
    const auto add = [&](const Undercut& one, bool isCorner, double roughMm, double spacingMm, const Vec3& place) {
        ++all.asked;
        // Aslant in a corner marks look twice as deep.
        if (one.depthMm <= (isCorner ? 2.0 : 1.0) * std::max(leastMm, roughMm)) return;
        all.areaMm2 += one.lengthMm * spacingMm;
        if (one.depthMm > all.depthMm) {
            all.depthMm = one.depthMm;
            all.deepest = place;
        }
    };
    if (tooth.form() == Form::cavity) {
        // Of all places of a side together: one line may run along a mark.
        std::map<std::pair<int, std::string_view>, std::pair<double, double>> squares;
        for (const WallStation& wall : tooth.walls())
            if (!wall.isCorner) {
                auto& [sum, count] = squares[{wall.floor, wall.side}];
                sum += wall.middle.rms * wall.middle.rms;
                ++count;
            }
        const auto roughOf = [&](const WallStation& wall) {
            // In a corner of either wall's.
            double most = wall.isCorner ? 0.0 : wall.middle.rms;
            for (const auto& [at, of_] : squares)
                if (at.first == wall.floor && (wall.isCorner || at.second == wall.side))
                    most = std::max(most, std::sqrt(of_.first / of_.second));
            return kRoughnessTimes * most;
        };
        for (const WallStation& wall : tooth.walls()) {
            if (!isOn(of, wall.side)) continue;
            // Right at the margin's edge a coarse field rounds it off by some hundredths.
            std::span<const WallStation::Sample> below = wall.samples;
            while (!below.empty() && below.back().w > wall.marginW - std::max(kEdgeMm, tooth.voxelMm()))
                below = below.first(below.size() - 1);
            if (below.empty()) continue;
            Undercut one = undercutOf(below, 1.0);
            // Of the wall's form, too: else it is a mark.
            if (one.depthMm > leastMm) {
                const double behind = formBehind(tooth, wall, below[one.deepest].w, below[one.above].w);
                if (behind <= leastMm) one.depthMm = 0.0;
            }
            const WallStation::Sample& s = below[one.deepest];
            add(one, wall.isCorner, roughOf(wall), wall.spacingMm,
                frame.from(wall.start) + (s.w - wall.start.z()) * frame.w + s.r * wall.h);
        }
        return all;
    }
    const std::vector<AxialStation>& stations = tooth.axialWalls();
    // Of a scan only what the station beside it has too: one alone is a flaw of the scan.
    const auto depthAt = [&](std::size_t i) {
        const AxialStation& wall = stations[i % stations.size()];
        std::vector<WallStation::Sample> steep;
        for (const WallStation::Sample& s : wall.samples)
            if (s.n.dot(frame.w) < kSin45) steep.push_back(s);
        return wall.middle.isFound ? undercutOf(steep, -1.0).depthMm : 0.0;
    };
    for (std::size_t i = 0; i < stations.size(); ++i) {
        const AxialStation& wall = stations[i];
        if (!wall.middle.isFound || !isOn(of, wall.side)) continue;
        // The margin's own ledge stands out, and is seen.
        std::vector<WallStation::Sample> steep;
        for (const WallStation::Sample& s : wall.samples)
            if (s.n.dot(frame.w) < kSin45) steep.push_back(s);
        Undercut one = undercutOf(steep, -1.0);
        if (steep.empty()) continue;
        if (tooth.preparation().noiseMm > 0.0 && one.depthMm > leastMm)
            one.depthMm = std::min(one.depthMm, std::max(depthAt(i + 1), depthAt(i + stations.size() - 1)));
        const double spacing = wall.middle.at * 6.283185307179586 / CutTooth::kAzimuths;
        add(one, false, kRoughnessTimes * wall.middle.rms, spacing,
            wall.marginMm + (steep[one.deepest].w - wall.marginW) * frame.w);
    }
    return all;
}

}  // namespace

Taken takeWallHeight(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    Places places;
    double residual = 0.0;
    if (tooth.form() == Form::cavity) {
        for (const WallStation* wall : straightWalls(tooth, of))
            places.add(wall->heightMm(), wall->marginMm);
        if (!tooth.floors().empty()) residual = tooth.floors().front().unevenMm;
        if (places.values.empty()) return none(noWall(of));
    } else {
        for (const AxialStation& wall : tooth.axialWalls())
            if (wall.middle.isFound && wall.hasMargin && isOn(of, wall.side))
                places.add(wall.topW - wall.marginW, wall.marginMm);
        if (places.values.empty()) return none("no axial wall stands over a margin there");
    }
    const bool isExtreme = of.statistic == "least" || of.statistic == "greatest";
    if (isExtreme) places = places.evened(tooth.preparation().noiseMm, kScanReach, tooth.form() == Form::crown);
    Taken taken = places.taken(of, "median", "margin over this wall's foot");
    taken.residual = meanOf(residual, static_cast<double>(places.values.size()) * kProbeMm / kPieceMm);
    if (tooth.form() == Form::crown) taken.offMm = kRoundEdgeMm + kRoundEdge * tooth.voxelMm();
    if (const std::size_t n = places.values.size(); n > 4 && tooth.form() == Form::cavity) {
        // Where a corner begins is known to two places or so: that tells where the margin runs up and down.
        for (const auto& [from, to] : {std::pair<std::size_t, std::size_t>{2, n}, {0, n - 2}, {1, n - 1}}) {
            const std::span<const double> part(places.values.data() + from, to - from);
            taken.offMm = std::max(
                taken.offMm,
                std::abs(statisticOf(part, of.statistic.empty() ? "median" : of.statistic, nullptr) - *taken.value));
        }
        // A short wall's middle may lie on the fissure or beside it.
        const auto [least, most] = std::minmax_element(places.values.begin(), places.values.end());
        taken.offMm = std::max(taken.offMm, kOfSpread * (*most - *least));
    }
    return taken;
}

Taken takeWallAngle(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    Places places;
    std::vector<double> scatter;  // of one station's slope
    const auto degrees = [](double slope) { return kDegrees * core::atan(slope); };
    if (tooth.form() == Form::cavity) {
        for (const WallStation* wall : straightWalls(tooth, of)) {
            places.add(degrees(wall->middle.slope), wall->marginMm);
            const double way = wall->middleToW - wall->middleFromW;
            scatter.push_back(3.46 / way * meanOf(wall->middle.rms, way / kPieceMm));
        }
        if (places.values.empty()) return none(noWall(of));
    } else {
        for (const AxialStation& wall : tooth.axialWalls())
            if (wall.middle.isFound && isOn(of, wall.side)) places.add(degrees(-wall.middle.slope), wall.marginMm);
        if (places.values.empty()) return none("no axial wall stands there");
    }
    Taken taken = places.taken(of, "mean", "wall against the path of draw");
    const double way = static_cast<double>(places.values.size()) * kProbeMm;
    // What differs from place to place, and what is left of each line's own unevenness.
    const bool isCavity = tooth.form() == Form::cavity;
    const double differs = isCavity
                               ? 0.4 * meanOf(localScatter(places.values, kPiecePlaces), way / kPieceMm)
                               : localScatter(places.values, 1) / std::sqrt(static_cast<double>(places.values.size()));
    taken.residual = core::hypot(differs, kDegrees * meanOf(medianOf(std::move(scatter)), way / kPieceMm));
    return taken;
}

Taken takeUndercutArea(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    const AllUndercuts all = undercuts(tooth, of);
    if (all.asked == 0) return none(noWall(of));
    if (all.areaMm2 == 0.0) return {0.0, {}};
    return at(all.areaMm2, all.deepest, "deepest undercut");
}

Taken takeUndercutDepth(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    const AllUndercuts all = undercuts(tooth, of);
    if (all.asked == 0) return none(noWall(of));
    if (all.depthMm == 0.0) return {0.0, {}};
    return at(all.depthMm, all.deepest, "deepest undercut");
}

Taken takeCavosurfaceAngle(CutTooth& tooth, const Selection& of) {
    if (tooth.cutPoints().empty()) return none(kNothing);
    if (tooth.form() == Form::crown) return none("it is taken of cavities; a crown has a finish line");
    const std::vector<WallStation>& walls = tooth.walls();
    const DrawFrame& frame = tooth.frame();
    std::vector<double> angles(walls.size(), -1.0);
    core::parallelFor(walls.size(), 16, [&](std::size_t begin, std::size_t end) {
        CutTooth::Look look(tooth);
        for (std::size_t i = begin; i < end; ++i) {
            const WallStation& wall = walls[i];
            if (!wall.isCavosurface || wall.isCorner || !isOn(of, wall.side)) continue;
            // The wall under its margin, and the uncut surface beyond, each by its mean normal.
            Vec3 wallN = Vec3::Zero(), outerN = Vec3::Zero();
            for (const WallStation::Sample& s : wall.samples)
                if (s.w > wall.marginW - kTopMm && s.w < wall.marginW - kEdgeMm) wallN += s.n;
            const Vec3 out = frame.from(wall.start) - wall.start.z() * frame.w;
            const double r = wall.samples.back().r;
            for (double beyond = kEdgeMm; beyond < kTopMm; beyond += kEdgeMm) {
                const Vec3 from = out + (r + beyond) * wall.h + (wall.marginW + 1.0) * frame.w;
                const geometry::RayMeeting met = tooth.whole().tree.firstMeeting(from, -frame.w, 2.0);
                if (met.triangle == geometry::kNoTriangle) continue;
                const Vec3 p = from - met.distanceMm * frame.w;
                if (look.now(p) < tooth.cutMm()) outerN += look.normalBefore(p);
            }
            if (!(wallN.norm() > 0.5) || !(outerN.norm() > 0.5)) continue;
            const double cosine = std::clamp(wallN.normalized().dot(outerN.normalized()), -1.0, 1.0);
            angles[i] = 180.0 - kDegrees * core::acos(cosine);
        }
    });
    Places places;
    for (std::size_t i = 0; i < walls.size(); ++i)
        if (angles[i] >= 0.0) places.add(angles[i], walls[i].marginMm);
    if (places.values.empty()) return none("no wall there ends at the uncut surface");
    Taken taken = places.taken(of, "median", "cavosurface margin");
    std::vector<double> rms;
    for (const WallStation& wall : walls)
        if (isOn(of, wall.side)) rms.push_back(wall.middle.rms);
    const double way = static_cast<double>(places.values.size()) * kProbeMm;
    taken.residual = kDegrees * 3.46 / kTopMm * meanOf(medianOf(std::move(rms)), way / kPieceMm);
    return taken;
}

}  // namespace handpiece::measures
