// SPDX-License-Identifier: Apache-2.0
// caries-left, caries-left-periphery, caries-left-pulpal, unsupported-enamel
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/brick_index.h"

namespace handpiece::measures {
namespace {
using cases::Tissue;
using core::Vec3;

constexpr double kPeripheryMm = 1.0;
constexpr double kBeneathMm = 0.1;  // beneath the junction dentine has to be there
constexpr double kLongestPrismMm = 3.0;

bool isEnamel(Tissue tissue) {
    return tissue == Tissue::enamel || tissue == Tissue::demineralisedEnamel || tissue == Tissue::stainedEnamel;
}
bool isDentine(Tissue tissue) {
    return tissue == Tissue::dentine || cases::isCarious(tissue);
}
bool isSoft(Tissue tissue) {
    return tissue == Tissue::cariesSoft || tissue == Tissue::cariesSoftToLeathery || tissue == Tissue::caries;
}

/// Places of the enamel-dentine junction as it was, near what was asked for: where grid edges pass from one to the
/// other.
class Junction {
  public:
    struct Place {
        Vec3 p;
        Vec3 inwards;  ///< unit, into the dentine, along the grid's edge
    };
    explicit Junction(const tooth::ToothModel& whole) {
        const field::FieldView view = whole.field.view();
        const auto& nodes = *whole.tissues.nodes();
        const auto dense = static_cast<std::uint32_t>(whole.field.storage().coarse.size());
        std::vector<std::vector<Place>> found(dense);
        core::parallelFor(dense, 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (!nodes.isMixed(i)) continue;
                const std::uint8_t* tissue = nodes.of(i);
                const auto brick = field::brickAt(view.bricks, static_cast<std::uint32_t>(i));
                const auto placeOf = [&](int x, int y, int z) {
                    return Vec3(view.originMm[0] + view.voxelMm * (8.0 * brick[0] + x),
                                view.originMm[1] + view.voxelMm * (8.0 * brick[1] + y),
                                view.originMm[2] + view.voxelMm * (8.0 * brick[2] + z));
                };
                for (int z = 0; z < 8; ++z)
                    for (int y = 0; y < 8; ++y)
                        for (int x = 0; x < 8; ++x)
                            for (int axis = 0; axis < 3; ++axis) {
                                const int here = x + 9 * y + 81 * z, there = here + (axis == 0   ? 1
                                                                                     : axis == 1 ? 9
                                                                                                 : 81);
                                const auto a = static_cast<Tissue>(tissue[here]),
                                           b = static_cast<Tissue>(tissue[there]);
                                if (!((isEnamel(a) && isDentine(b)) || (isDentine(a) && isEnamel(b)))) continue;
                                Vec3 from = placeOf(x, y, z), to = from;
                                to[axis] += view.voxelMm;
                                if (isDentine(a)) std::swap(from, to);
                                Vec3 in = (to - from).normalized();
                                for (int step = 0; step < 5; ++step) {
                                    const Vec3 middle = 0.5 * (from + to);
                                    (isEnamel(whole.tissues.at(middle)) ? from : to) = middle;
                                }
                                found[i].push_back({0.5 * (from + to), in});
                            }
            }
        });
        for (const auto& some : found)
            places_.insert(places_.end(), some.begin(), some.end());
        for (std::size_t i = 0; i < places_.size(); ++i)
            cells_[cellOf(places_[i].p)].push_back(i);
    }
    [[nodiscard]] const std::vector<Place>& places() const { return places_; }
    /// Square to the junction, into the dentine: edges along an axis cross it as often as its normal says.
    [[nodiscard]] Vec3 normalAt(std::size_t place) const {
        constexpr double kRoundMm = 0.5;
        const Vec3& p = places_[place].p;
        const Cell middle = cellOf(p);
        Vec3 sum = Vec3::Zero();
        for (int dz = -1; dz <= 1; ++dz)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const auto cell = cells_.find({middle[0] + dx, middle[1] + dy, middle[2] + dz});
                    if (cell == cells_.end()) continue;
                    for (const std::size_t i : cell->second)
                        if ((places_[i].p - p).squaredNorm() < kRoundMm * kRoundMm) sum += places_[i].inwards;
                }
        return sum.norm() > 0.0 ? Vec3(sum.normalized()) : places_[place].inwards;
    }
    /// The nearest within a bound; none farther.
    [[nodiscard]] std::optional<std::size_t> nearest(const Vec3& p, double boundMm) const {
        std::optional<std::size_t> best;
        double best2 = boundMm * boundMm;
        const Cell middle = cellOf(p);
        const int rings = static_cast<int>(std::ceil(boundMm / kCellMm));
        for (int ring = 0; ring <= rings; ++ring) {
            // Cells of a ring are at least so far away.
            const double least = std::max(0, ring - 1) * kCellMm;
            if (best2 < least * least) break;
            for (int dz = -ring; dz <= ring; ++dz)
                for (int dy = -ring; dy <= ring; ++dy)
                    for (int dx = -ring; dx <= ring; ++dx) {
                        if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) != ring) continue;
                        const Cell at{middle[0] + dx, middle[1] + dy, middle[2] + dz};
                        if (best2 < kNotNearer * leastSquared(p, at)) continue;
                        const auto cell = cells_.find(at);
                        if (cell == cells_.end()) continue;
                        for (const std::size_t i : cell->second)
                            if (const double d2 = (places_[i].p - p).squaredNorm(); d2 < best2) {
                                best2 = d2;
                                best = i;
                            }
                    }
        }
        return best;
    }

  private:
    using Cell = std::array<int, 3>;
    static constexpr double kCellMm = 0.5;
    static Cell cellOf(const Vec3& p) {
        return {static_cast<int>(std::floor(p.x() / kCellMm)), static_cast<int>(std::floor(p.y() / kCellMm)),
                static_cast<int>(std::floor(p.z() / kCellMm))};
    }
    /// Square of the way to a cell, which saves most cells; rounding must not make it longer.
    static constexpr double kNotNearer = 1.0 - 1e-9;
    static double leastSquared(const Vec3& p, const Cell& cell) {
        double sum = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double from = kCellMm * cell[static_cast<std::size_t>(k)];
            const double off = std::max({from - p[k], p[k] - from - kCellMm, 0.0});
            sum += off * off;
        }
        return sum;
    }
    struct CellHash {
        std::size_t operator()(const Cell& c) const {
            const auto u = [&](int k) { return static_cast<std::uint32_t>(c[static_cast<std::size_t>(k)]); };
            return u(0) * 73856093u ^ u(1) * 19349663u ^ u(2) * 83492791u;
        }
    };
    std::vector<Place> places_;
    std::unordered_map<Cell, std::vector<std::size_t>, CellHash> cells_;
};

bool hasCaries(const tooth::ToothModel& whole) {
    for (std::size_t i = 0; i < cases::kTissueCount; ++i)
        if (cases::isCarious(static_cast<Tissue>(i)) && whole.volumesMm3[i] > 0.0) return true;
    return false;
}

/// By where it lies: at the periphery (1), towards the pulp (-1), anywhere (0).
Taken cariesLeft(CutTooth& tooth, const Selection& of, int where) {
    const Preparation& p = tooth.preparation();
    if (!hasCaries(*p.whole)) return none("the case has no carious dentine");
    if (!of.tissue.empty() && !cases::isCarious(cases::tissueByName(of.tissue)))
        return none(of.tissue + " is no carious dentine");
    if (!of.zone.empty() && (p.zones == nullptr || !p.zones->distanceMm(of.zone, Vec3::Zero())))
        return none("the task has no zone \"" + of.zone + "\"");
    std::optional<Junction> junction;
    if (where != 0) {
        junction.emplace(*p.whole);
        if (junction->places().empty()) return none("the tooth has no enamel-dentine junction");
    }
    const double voxel = tooth.voxelMm();
    const auto weight = [&](const Vec3& place, Tissue tissue) {
        if (!cases::isCarious(tissue) || !isAsked(of, tissue)) return 0.0;
        if (where != 0 && junction->nearest(place, kPeripheryMm).has_value() != (where > 0)) return 0.0;
        return of.zone.empty() ? 1.0 : std::clamp(0.5 - *p.zones->distanceMm(of.zone, place) / voxel, 0.0, 1.0);
    };
    return {volumeOf(*p.whole, *p.cut, false, weight), {}};
}

}  // namespace

Taken takeCariesLeft(CutTooth& tooth, const Selection& of) {
    return cariesLeft(tooth, of, 0);
}
Taken takeCariesLeftPeriphery(CutTooth& tooth, const Selection& of) {
    return cariesLeft(tooth, of, 1);
}
Taken takeCariesLeftPulpal(CutTooth& tooth, const Selection& of) {
    return cariesLeft(tooth, of, -1);
}

Taken takeUnsupportedEnamel(CutTooth& tooth, const Selection&) {
    const Preparation& p = tooth.preparation();
    const Junction junction(*p.whole);
    if (junction.places().empty()) return none("the tooth has no enamel-dentine junction");
    if (tooth.cutPoints().empty()) return none("nothing was cut");
    // Where the junction has lost its dentine: cut away, or soft.
    std::vector<char> isLost(junction.places().size(), 0);
    core::parallelFor(isLost.size(), 256, [&](std::size_t begin, std::size_t end) {
        CutTooth::Look look(tooth);
        for (std::size_t i = begin; i < end; ++i) {
            const Junction::Place& place = junction.places()[i];
            const Vec3 under = place.p + kBeneathMm * place.inwards;
            isLost[i] = look.now(under) >= 0.0 || isSoft(p.whole->tissues.at(under));
        }
    });
    core::Box near;
    for (std::size_t i = 0; i < isLost.size(); ++i)
        if (isLost[i] != 0) near.extend(junction.places()[i].p);
    if (near.isEmpty()) return {0.0, {}};
    std::vector<Vec3> normals(isLost.size(), Vec3::Zero());
    core::parallelFor(isLost.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& at = junction.places()[i].p;
            const Vec3 off = (near.min - at).cwiseMax(at - near.max);
            if (off.maxCoeff() < 2.0 * tooth.voxelMm()) normals[i] = junction.normalAt(i);
        }
    });
    const double slack = 0.1 * tooth.voxelMm();
    // A prism runs from a place in the enamel square to the junction: there dentine has to follow.
    const auto weight = [&](const Vec3& place, Tissue tissue) {
        if (!isEnamel(tissue) || tooth.nearlyNow(place) >= 0.0) return 0.0;
        const Vec3 off = (near.min - place).cwiseMax(place - near.max).cwiseMax(Vec3::Zero());
        if (off.norm() > kLongestPrismMm) return 0.0;
        const auto foot = junction.nearest(place, kLongestPrismMm);
        if (!foot || normals[*foot].isZero()) return 0.0;
        const Vec3& n = normals[*foot];
        const Vec3 under = place + (n.dot(junction.places()[*foot].p - place) + kBeneathMm) * n;
        return tooth.nearlyNow(under) >= slack || isSoft(p.whole->tissues.at(under)) ? 1.0 : 0.0;
    };
    return {volumeOf(*p.whole, *p.cut, false, weight), {}};
}

}  // namespace handpiece::measures
