// SPDX-License-Identifier: Apache-2.0
// The walls of a cavity, as a probe finds them that is led up along the path of draw.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::measures {
namespace {
using core::Vec3;

constexpr double kWallLevelMm = 0.025;
constexpr double kInsideMm = 0.1;     // of the floor's edge the probe stands
constexpr double kReachMm = 1.5;      // beyond that edge a wall is looked for
constexpr double kMostJumpMm = 0.3;   // from level to level
constexpr double kWallEndMm = 0.002;  // nearer under the uncut surface a wall has ended
constexpr double kLeastHeightMm = 0.15;
constexpr int kGapPlaces = 6;
constexpr int kBesideRows = 4;
constexpr double kStraightCos = 0.9659258;  // 15 degrees
constexpr double kRoundMm = 0.8;            // of floor about a wall's foot
constexpr double kMarksTimes = 0.5;         // of what marks leave open of that mean
// A wall's middle begins at one of these shares of its height, above the corner with the floor, and ends below the
// margin.
constexpr std::array kShares{0.30, 0.40, 0.50, 0.60};
constexpr double kMiddleTo = 0.85;
constexpr int kBins = 11;  // of its height, from the first share to the last

Line lineFrom(const WallStation& wall, double share) {
    std::vector<core::Vec2> points;
    for (const WallStation::Sample& s : wall.samples)
        if (s.w >= wall.floorW + share * wall.heightMm() && s.w <= wall.floorW + kMiddleTo * wall.heightMm())
            points.emplace_back(s.w, s.r);
    return robustLine(points);
}

/// How far the mean profile of a wall's places lies off their lines from this share of the height on (rms), and how
/// far each of them lies off its own, both [mm].
struct Bend {
    double meanMm = 0.0, eachMm = 0.0;
};
Bend bendFrom(std::span<WallStation* const> places, double share) {
    std::array<double, kBins> sum{}, count{};
    double squares = 0.0, all = 0.0;
    for (const WallStation* wall : places) {
        const Line line = lineFrom(*wall, share);
        if (!line.isFound) continue;
        for (const WallStation::Sample& s : wall->samples) {
            const double at = (s.w - wall->floorW) / wall->heightMm();
            if (at < share || at > kMiddleTo) continue;
            const double off = s.r - line.of(s.w);
            const auto bin = std::min<std::size_t>(
                kBins - 1, static_cast<std::size_t>((at - kShares.front()) / (kMiddleTo - kShares.front()) * kBins));
            sum[bin] += off;
            count[bin] += 1.0;
            squares += off * off;
            all += 1.0;
        }
    }
    double means = 0.0, bins = 0.0;
    for (std::size_t i = 0; i < kBins; ++i)
        if (count[i] > 0.0) {
            means += sum[i] / count[i] * (sum[i] / count[i]);
            ++bins;
        }
    return {std::sqrt(means / std::max(1.0, bins)), std::sqrt(squares / std::max(1.0, all))};
}

/// Where the middle of a wall begins: the corner's radius bends all its places alike, marks and roughness do not.
void layMiddle(std::span<WallStation* const> places) {
    std::vector<WallStation*> straight;
    for (WallStation* wall : places)
        if (!wall->isCorner) straight.push_back(wall);
    const std::span<WallStation* const> looked = straight.empty() ? places : std::span<WallStation* const>(straight);
    const double pieces = std::max(1.0, static_cast<double>(looked.size()) * kProbeMm / kPieceMm);
    const Bend upper = bendFrom(looked, kShares.back());
    double from = kShares.back();
    const double straightMm = 1.2 * upper.meanMm + 0.0005 + kMarksTimes * upper.eachMm / std::sqrt(pieces);
    for (std::size_t i = 0; i + 1 < kShares.size() && from == kShares.back(); ++i)
        if (bendFrom(looked, kShares[i]).meanMm <= straightMm) from = kShares[i];
    for (WallStation* wall : places) {
        if (const Line line = lineFrom(*wall, from); line.isFound) wall->middle = line;
        wall->middleFromW = wall->floorW + from * wall->heightMm();
        wall->middleToW = wall->floorW + kMiddleTo * wall->heightMm();
    }
}

}  // namespace

double CutTooth::floorAt(const Floor& floor, const Vec3& q) const {
    if (!floor.plane.isFound) return q.z();
    if (floor.plane.rms < 0.01) return floor.plane.of(q.x(), q.y());
    const HeightMap& map = *heights_;
    std::vector<Vec3> near;
    for (const int node : floor.flat) {
        const Vec3 p = map.drawOf(node);
        const double du = p.x() - q.x(), dv = p.y() - q.y();
        if (du * du + dv * dv < kRoundMm * kRoundMm) near.push_back(p);
    }
    if (near.size() < 12) return floor.plane.of(q.x(), q.y());
    const Plane plane = planeThrough(near);
    return plane.isFound ? plane.of(q.x(), q.y()) : floor.plane.of(q.x(), q.y());
}

bool CutTooth::probeWall(Look& look, WallStation& wall, double topW, double farMm, const Floor& floor) const {
    const Vec3 start = frame_.from(wall.start);
    const auto placeAt = [&](double w) { return Vec3(start + (w - wall.start.z()) * frame_.w); };
    double last = -1.0;  // of the level below; none yet
    bool endsUncut = false;
    /// Where the wall is at a level; none above its end.
    const auto meets = [&](double w) -> std::optional<double> {
        const Vec3 from = placeAt(w);
        const auto r = look.cast(from, wall.h, farMm);
        if (!r || (last >= 0.0 && std::abs(*r - last) > kMostJumpMm)) {
            endsUncut = !r;
            return {};
        }
        if (look.before(from + *r * wall.h) > -kWallEndMm) {
            endsUncut = true;
            return {};
        }
        return r;
    };
    const Vec3 aim = wall.h;
    for (int pass = 0; pass < 2; ++pass) {
        wall.samples.clear();
        last = -1.0;
        double w = wall.start.z() + 0.02;
        for (; w < topW; w += kWallLevelMm) {
            const auto r = meets(w);
            if (!r) break;
            last = *r;
            wall.samples.push_back({w, *r, look.normalNow(placeAt(w) + *r * wall.h)});
        }
        if (wall.samples.size() < 5) return false;
        if (pass == 1) {
            double low = wall.samples.back().w, high = std::min(w, topW);
            for (int i = 0; i < 14; ++i) {
                const double middle = 0.5 * (low + high);
                (meets(middle) ? low : high) = middle;
            }
            (void)meets(high);
            wall.marginW = low;
            wall.isCavosurface = endsUncut;
            break;
        }
        // Square to the wall, then, by its middle.
        Vec3 normal = Vec3::Zero();
        for (std::size_t i = wall.samples.size() * 2 / 5; i < (wall.samples.size() * 4 + 4) / 5; ++i)
            normal += wall.samples[i].n;
        normal -= normal.dot(frame_.w) * frame_.w;
        if (!(normal.norm() > 1e-9)) return false;
        wall.h = -normal.normalized();
        if (wall.h.dot(aim) < kSin45) return false;
    }
    const Vec3 margin = placeAt(wall.marginW);
    wall.marginMm = margin + wall.samples.back().r * wall.h;
    // The floor's own height under it, where the wall's line comes down to it.
    const auto standOn = [&](double r) {
        wall.floorW = floorAt(floor, frame_.to(start + r * wall.h));
        return wall.heightMm() > kLeastHeightMm;
    };
    if (!standOn(wall.samples[wall.samples.size() / 2].r)) return false;
    wall.middle = lineFrom(wall, kShares.back());
    return wall.middle.isFound && standOn(wall.middle.of(wall.floorW));
}

void CutTooth::findWalls() {
    const HeightMap& map = heights();
    const std::vector<Floor>& all = floors();
    std::vector<int> floorOf(map.nodes.size(), -1);
    for (std::size_t f = 0; f < all.size(); ++f)
        for (const int node : all[f].nodes)
            floorOf[static_cast<std::size_t>(node)] = static_cast<int>(f);
    // Every end of every run of a floor along the rows and columns of the map.
    struct Plan {
        WallStation station;
        double topW, farMm;
    };
    std::vector<Plan> plans;
    for (int direction = 0; direction < 4; ++direction) {
        const bool alongU = direction < 2;
        const Vec3 h = (direction % 2 == 0 ? 1.0 : -1.0) * (alongU ? frame_.u : frame_.v);
        const std::string_view side = sideOf(p_.axes, h);
        const int rows = alongU ? map.height : map.width, length = alongU ? map.width : map.height;
        for (int row = 0; row < rows; ++row) {
            const auto nodeAt = [&](int k) { return alongU ? map.at(k, row) : map.at(row, k); };
            int run = 0;
            for (int begin = 0; begin < length;) {
                const int floor = floorOf[static_cast<std::size_t>(nodeAt(begin))];
                int end = begin + 1, next = end;
                // A gap of some places is a mark of the bur, not a wall.
                for (; floor >= 0 && next < length && next - end < kGapPlaces; ++next)
                    if (floorOf[static_cast<std::size_t>(nodeAt(next))] == floor) end = next + 1;
                if (floor >= 0) {
                    const int inside = std::min(static_cast<int>(std::lround(kInsideMm / kProbeMm)), (end - begin) / 2);
                    const int from = direction % 2 == 0 ? end - 1 - inside : begin + inside;
                    Plan plan;
                    plan.station.side = side;
                    plan.station.floor = floor;
                    plan.station.row = row;
                    plan.station.run = run++;
                    plan.station.h = h;
                    plan.station.start = map.drawOf(nodeAt(from));
                    plan.topW = map.nodes[static_cast<std::size_t>(nodeAt(from))].before + 2.0;
                    plan.farMm = kReachMm + kProbeMm * inside;
                    plans.push_back(plan);
                }
                begin = end;
            }
        }
    }
    std::vector<char> isWall(plans.size(), 0);
    core::parallelFor(plans.size(), 8, [&](std::size_t begin, std::size_t end) {
        Look look(*this);
        for (std::size_t i = begin; i < end; ++i) {
            Plan& plan = plans[i];
            const Vec3 aim = plan.station.h;
            isWall[i] =
                probeWall(look, plan.station, plan.topW, plan.farMm, all[static_cast<std::size_t>(plan.station.floor)]);
            // Aslant a place of the row stands for more of the wall.
            if (isWall[i] != 0) plan.station.spacingMm = kProbeMm / plan.station.h.dot(aim);
        }
    });
    std::vector<WallStation> walls;
    for (std::size_t i = 0; i < plans.size(); ++i)
        if (isWall[i] != 0) walls.push_back(std::move(plans[i].station));
    // A wall goes on straight on both sides of a place that is not in a corner.
    std::map<std::tuple<int, int, std::string_view, int>, const WallStation*> byRow;
    for (const WallStation& wall : walls)
        byRow[{wall.floor, wall.run, wall.side, wall.row}] = &wall;
    for (WallStation& wall : walls)
        for (const int rows : {-kBesideRows, kBesideRows}) {
            const auto other = byRow.find({wall.floor, wall.run, wall.side, wall.row + rows});
            wall.isCorner = wall.isCorner || other == byRow.end() || other->second->h.dot(wall.h) < kStraightCos;
        }
    std::map<std::tuple<int, int, std::string_view>, std::vector<WallStation*>> whole;
    for (WallStation& wall : walls)
        whole[{wall.floor, wall.run, wall.side}].push_back(&wall);
    for (const auto& [of, places] : whole)
        layMiddle(places);
    walls_ = std::move(walls);
}

}  // namespace handpiece::measures
