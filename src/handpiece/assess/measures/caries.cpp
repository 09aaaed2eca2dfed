// SPDX-License-Identifier: Apache-2.0
// caries-left, caries-left-periphery, caries-left-pulpal, unsupported-enamel
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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
/// By so much of a voxel a border between tissues, or the cut in one, is uncertain as a whole.
constexpr double kBorderVoxels = 0.01;

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

/// What of a tissue is left, by cells of the grid. Cut and borders of tissues lie between nodes, both by interpolated
/// distances: a cell through which one of them passes is sampled. A sample is left or it is not; so a cut that runs
/// along the border of a lesion leaves nothing there, where shares of voxels would leave an eighth of a voxel of it.
class CellsLeft {
  public:
    CellsLeft(const tooth::ToothModel& whole, const tooth::ToothMirror& cut, std::function<bool(Tissue)> isMeant)
        : whole_(whole), cut_(cut), isMeant_(std::move(isMeant)) {}

    struct Sum {
        double mm3 = 0.0;
        double borderMm2 = 0.0;    ///< of borders of the tissue to others, and of the cut in it
        std::optional<Vec3> seen;  ///< where most of it lies open
        double seenShare = 0.0;
    };
    /// `weight`: of a cell, by its middle, 0 to 1.
    [[nodiscard]] Sum sum(const std::function<double(const Vec3&)>& weight) const {
        const field::FieldView view = whole_.field.view();
        const auto dense = static_cast<std::uint32_t>(whole_.field.storage().coarse.size());
        std::vector<Sum> sums(dense);
        core::parallelFor(dense, 16, [&](std::size_t begin, std::size_t end) {
            std::array<float, field::kBrickValues> scratch;
            for (std::size_t i = begin; i < end; ++i) {
                const auto id = static_cast<std::uint32_t>(i);
                const bool isChanged = cut_.isChanged(id), isMixed = whole_.tissues.nodes()->isMixed(i);
                if (!isChanged && view.brickIndex[i] < 0 && view.coarse[i] > 0.0f) continue;
                if (!isMixed && !isMeant_(whole_.tissues.ofBrick(id))) continue;
                const float* now = isChanged ? cut_.values(id, scratch.data()) : scratch.data();
                if (!isChanged) whole_.uncutBrick(id, scratch.data());
                const field::TissueMap::Layers layers = whole_.tissues.layers(id);
                const auto brick = field::brickAt(view.bricks, id);
                for (int z = 0; z < field::kBrickCells; ++z)
                    for (int y = 0; y < field::kBrickCells; ++y)
                        for (int x = 0; x < field::kBrickCells; ++x) {
                            const int node[3] = {x, y, z};
                            Vec3 low;
                            for (int k = 0; k < 3; ++k)
                                low[k] =
                                    view.originMm[k] +
                                    view.voxelMm * (field::kBrickCells * brick[static_cast<std::size_t>(k)] + node[k]);
                            addCell(sums[i], now, layers, x + field::kBrickNodes * (y + field::kBrickNodes * z), low,
                                    view.voxelMm, isChanged, weight);
                        }
            }
        });
        Sum all;
        for (const Sum& one : sums) {
            all.mm3 += one.mm3;
            all.borderMm2 += one.borderMm2;
            if (one.seenShare > all.seenShare) all.seen = one.seen, all.seenShare = one.seenShare;
        }
        return all;
    }

  private:
    static constexpr int kSteps = 4;  // samples along each edge of a cell

    void addCell(Sum& sum, const float* now, const field::TissueMap::Layers& layers, int corner, const Vec3& low,
                 double voxelMm, bool isChanged, const std::function<double(const Vec3&)>& weight) const {
        std::array<double, 8> at;
        int inTooth = 0;
        for (int c = 0; c < 8; ++c) {
            at[static_cast<std::size_t>(c)] = static_cast<double>(now[corner + offsetOf(c)]);
            inTooth += at[static_cast<std::size_t>(c)] < 0.0;
        }
        if (inTooth == 0 && !isChanged) return;
        // Layers that pass through it; the first that holds all of it hides the others.
        bool isPassed = false;
        Tissue tissue = layers.rest;
        for (const field::TissueMap::Layer& layer : layers.layers) {
            int inside = 0;
            for (int c = 0; c < 8; ++c)
                inside += layer.values[corner + offsetOf(c)] < 0;
            if (inside == 0) continue;
            if (inside == 8) {
                tissue = layer.tissue;
                break;
            }
            isPassed = true;
        }
        if (!isPassed && !isMeant_(tissue)) return;
        const double cellMm3 = voxelMm * voxelMm * voxelMm;
        double share = inTooth == 8 && !isPassed ? 1.0 : 0.0;
        bool isBorder = false;
        if (inTooth > 0 && share == 0.0) {
            int left = 0, meant = 0;
            for (int k = 0; k < kSteps; ++k)
                for (int j = 0; j < kSteps; ++j)
                    for (int i = 0; i < kSteps; ++i) {
                        const double t[3] = {(i + 0.5) / kSteps, (j + 0.5) / kSteps, (k + 0.5) / kSteps};
                        const Tissue here =
                            isPassed ? whole_.tissues.at(low + voxelMm * Vec3(t[0], t[1], t[2])) : tissue;
                        if (!isMeant_(here)) continue;
                        ++meant;
                        double value = 0.0;
                        for (int c = 0; c < 8; ++c)
                            value += at[static_cast<std::size_t>(c)] * ((c & 1) != 0 ? t[0] : 1.0 - t[0]) *
                                     ((c >> 1 & 1) != 0 ? t[1] : 1.0 - t[1]) * ((c >> 2) != 0 ? t[2] : 1.0 - t[2]);
                        left += value < 0.0;
                    }
            share = static_cast<double>(left) / (kSteps * kSteps * kSteps);
            isBorder = meant > 0;
        }
        if (share == 0.0 && !isBorder) return;
        const double part = weight(low + Vec3::Constant(0.5 * voxelMm));
        sum.mm3 += part * share * cellMm3;
        // A surface passes through 1.5 cells for each of its faces, in the mean over directions.
        if (isBorder) sum.borderMm2 += part * voxelMm * voxelMm / 1.5;
        if (isChanged && inTooth < 8 && part * share > sum.seenShare)
            sum.seen = low + Vec3::Constant(0.5 * voxelMm), sum.seenShare = part * share;
    }
    static int offsetOf(int corner) {
        return (corner & 1) + field::kBrickNodes * ((corner >> 1 & 1) + field::kBrickNodes * (corner >> 2));
    }

    const tooth::ToothModel& whole_;
    const tooth::ToothMirror& cut_;
    std::function<bool(Tissue)> isMeant_;
};

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
    const auto shareOf = [voxel](double distanceMm) { return std::clamp(0.5 - distanceMm / voxel, 0.0, 1.0); };
    const auto weight = [&](const Vec3& middle) {
        double share = 1.0;
        if (where != 0) {
            const auto near = junction->nearest(middle, kPeripheryMm + voxel);
            const double atPeriphery =
                near ? shareOf((junction->places()[*near].p - middle).norm() - kPeripheryMm) : 0.0;
            share = where > 0 ? atPeriphery : 1.0 - atPeriphery;
        }
        return of.zone.empty() || share == 0.0 ? share : share * shareOf(*p.zones->distanceMm(of.zone, middle));
    };
    const CellsLeft cells(*p.whole, *p.cut,
                          [&](Tissue tissue) { return cases::isCarious(tissue) && isAsked(of, tissue); });
    const CellsLeft::Sum left = cells.sum(weight);
    Taken taken{left.mm3, {}};
    taken.offMm = kBorderVoxels * voxel * left.borderMm2;
    if (left.seen && left.mm3 > taken.offMm) taken.evidence.push_back({{}, *left.seen, {}, "carious tissue left"});
    return taken;
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
