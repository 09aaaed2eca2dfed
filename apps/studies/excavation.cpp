// SPDX-License-Identifier: Apache-2.0
#include "studies/excavation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/base/geometry/mesh_edges.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::studies {
namespace {

using core::Quat;
using core::Vec3;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSpinUpS = 0.8;  // above the tooth, before each cut
constexpr double kLayerMm = 0.3;
constexpr double kPlungeFeed = 1.0 / 3.0;
constexpr double kAirMmS = 10.0;
constexpr double kEnough = 0.97;     // of the decay that can be reached at all: the rest would cost much sound tissue
constexpr double kDecayWorth = 3.0;  // decay left counts so many times sound tissue lost, between two directions
constexpr double kRowShare = 0.6;    // of the radius between two strokes: ridges of a twentieth of it stay
constexpr double kSpeckCells = 4;    // smaller lesions are artefacts of the surface
// Of a hand that waits for the bur.
constexpr double kBeyondMm = 0.5;        // the most that it intends below the floor, where no pulp is near
constexpr double kForeseen = 1.5;        // of the rate under the middle of the bur: it cuts on the way there too
constexpr double kMaxWaitS = 20.0;       // at one place: what cannot be cut is left
constexpr double kMaxWaitByPulpS = 2.0;  // where the hand goes no lower than the bur may
constexpr double kLowerStepMm = 0.02;
constexpr double kClearOfLayerMm = 0.2;  // there the bur comes down slowly

/// Whether nearly all of `inner` lies in `outer`: a softer level of the same lesion.
bool isWithin(const geometry::TriangleMesh& inner, const geometry::TriangleMesh& outer) {
    constexpr double kTouchMm = 0.05, kNearlyAll = 0.95;
    const core::Box box = outer.bounds().grown(kTouchMm), in = inner.bounds();
    if ((in.min.array() < box.min.array()).any() || (in.max.array() > box.max.array()).any()) return false;
    const geometry::TriangleTree tree(outer);
    const auto count = std::count_if(inner.vertices.begin(), inner.vertices.end(),
                                     [&](const Vec3& v) { return tree.signedDistance(v) < kTouchMm; });
    return static_cast<double>(count) > kNearlyAll * static_cast<double>(inner.vertices.size());
}

/// The connected parts of closed surfaces, without those that lie in another.
std::vector<geometry::TriangleMesh> lesionsOf(const std::vector<geometry::TriangleMesh>& decay) {
    std::vector<geometry::TriangleMesh> lesions;
    for (const geometry::TriangleMesh& mesh : decay) {
        const geometry::Shells shells = geometry::shellsOf(mesh, geometry::MeshEdges(mesh));
        std::vector<geometry::TriangleMesh> parts(shells.count);
        std::vector<std::uint32_t> number(mesh.vertices.size(), 0xffffffffu);
        for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
            geometry::TriangleMesh& part = parts[shells.ofFace[f]];
            geometry::Triangle t = mesh.triangles[f];
            for (std::uint32_t& v : t) {
                if (number[v] == 0xffffffffu) {  // a vertex belongs to one shell of a manifold surface
                    number[v] = static_cast<std::uint32_t>(part.vertices.size());
                    part.vertices.push_back(mesh.vertices[v]);
                }
                v = number[v];
            }
            part.triangles.push_back(t);
        }
        for (geometry::TriangleMesh& part : parts)
            if (geometry::enclosedVolumeMm3(part) > 0.0) lesions.push_back(std::move(part));
    }
    std::vector<geometry::TriangleMesh> outermost;
    for (const geometry::TriangleMesh& lesion : lesions)
        if (std::none_of(lesions.begin(), lesions.end(), [&](const auto& other) {
                return geometry::enclosedVolumeMm3(other) > geometry::enclosedVolumeMm3(lesion) &&
                       isWithin(lesion, other);
            }))
            outermost.push_back(lesion);
    return outermost;
}

/// One lesion seen along one axis: columns of cells, and how low the bur's tip may go in each.
class Approach {
  public:
    Approach(const CuttingScene& scene, const CuttingOptions& options, const geometry::TriangleTree& lesion,
             const Vec3& axis, double cellMm)
        : scene_(scene), options_(options), cellMm_(cellMm), axis_(axis) {
        turn_ = Quat::FromTwoVectors(Vec3::UnitZ(), axis);
        core::Box box;
        const core::Box& b = lesion.bounds();
        for (int i = 0; i < 8; ++i)
            box.extend(turn_.inverse() * Vec3(i & 1 ? b.max.x() : b.min.x(), i & 2 ? b.max.y() : b.min.y(),
                                              i & 4 ? b.max.z() : b.min.z()));
        double top = -kInfinity;
        for (int i = 0; i < 8; ++i) {
            const core::Box& t = scene.toothBounds;
            top = std::max(top, axis.dot(Vec3(i & 1 ? t.max.x() : t.min.x(), i & 2 ? t.max.y() : t.min.y(),
                                              i & 4 ? t.max.z() : t.min.z())));
        }
        const double side = 2.0 * scene.burRadiusMm + 2.0 * cellMm;
        low_ = box.min - Vec3(side, side, scene.burRadiusMm + options.pulpGuardMm + cellMm);
        columns_ = {countOf(box.max.x() + side - low_.x()), countOf(box.max.y() + side - low_.y())};
        layers_ = countOf(top - low_.z()) + 1;
        sample(lesion);
        bottoms_ = bottomsOf();
    }

    /// The path with the least loss of sound tissue that takes nearly all that can be taken.
    void plan() {
        const int widest = static_cast<int>(std::ceil(scene_.burRadiusMm / cellMm_)) + 1;
        setFloor(widest);
        const double best = reached_;
        for (int margin = 0; margin <= widest; ++margin) {
            setFloor(margin);
            if (reached_ >= kEnough * best) break;
        }
        chooseRows();
    }

    [[nodiscard]] double cost() const { return soundMm3() + kDecayWorth * (decayMm3() - reachedMm3()); }
    [[nodiscard]] double decayMm3() const { return volume(decay_); }
    [[nodiscard]] double reachedMm3() const { return volume(reached_); }
    [[nodiscard]] double soundMm3() const { return volume(sound_); }
    [[nodiscard]] double guardedMm3() const { return volume(guarded_); }
    [[nodiscard]] double nearestPulpMm() const { return nearestPulpMm_; }
    [[nodiscard]] const Vec3& axis() const { return axis_; }
    [[nodiscard]] const Quat& turn() const { return turn_; }

    /// Where the tip is to come, where the hand goes for that, and how long it takes at least.
    struct Place {
        Vec3 tipMm, handMm, aboveMm;  ///< above what is there yet
        double waitS = 0.0;
    };
    /// A stroke at one depth, in the tooth frame.
    using Stroke = std::vector<Place>;
    [[nodiscard]] std::vector<Stroke> strokes() const {
        std::vector<Stroke> strokes;
        double top = -kInfinity, bottom = kInfinity;
        forEachColumn([&](int i, int j) {
            if (!isOnPath(i, j)) return;
            bottom = std::min(bottom, floor_[at(i, j)]);
            for (const Bottom& b : bottoms_)
                top = std::max(top, surface_[at(i + b.di, j + b.dj)] - b.heightMm);
        });
        if (!(bottom < top)) return strokes;
        const int layers = static_cast<int>(std::ceil((top - bottom) / kLayerMm));
        std::vector<double> left = surface_;
        bool back = false;
        for (int layer = 1; layer <= layers; ++layer) {
            const double above = top - (top - bottom) * (layer - 1) / layers, z = top - (top - bottom) * layer / layers;
            for (int j = 0; j < columns_[1]; ++j) {
                bool open = false, any = false;
                for (int n = 0; n < columns_[0]; ++n) {
                    const int i = back ? columns_[0] - 1 - n : n;
                    const bool goes = isOnPath(i, j) && floor_[at(i, j)] < above;
                    if (goes && !open) strokes.emplace_back();
                    if (goes) strokes.back().push_back(lower(i, j, std::max(z, floor_[at(i, j)]), left));
                    open = goes;
                    any = any || goes;
                }
                if (any) back = !back;
            }
        }
        return strokes;
    }
    /// True when the tip may go straight from one place to another without cutting what is to stay.
    [[nodiscard]] bool mayGo(const Vec3& from, const Vec3& to) const {
        const Vec3 a = turn_.inverse() * from, b = turn_.inverse() * to;
        const int steps = static_cast<int>(std::ceil((b - a).norm() / (0.5 * cellMm_)));
        for (int s = 0; s <= steps; ++s) {
            const Vec3 p = (a + (b - a) * (steps > 0 ? static_cast<double>(s) / steps : 0.0) - low_) / cellMm_;
            const int i = static_cast<int>(p.x()), j = static_cast<int>(p.y());
            if (!(p.x() >= 0.0 && p.y() >= 0.0) || i >= columns_[0] || j >= columns_[1]) return false;
            // Floors are those of middles of columns: between two of them the line may pass a little under one.
            if (!(floor_[at(i, j)] <= low_.z() + p.z() * cellMm_ + 0.5 * cellMm_)) return false;
        }
        return true;
    }
    /// Over the tooth's surface everywhere near the path, along the axis.
    [[nodiscard]] Vec3 above(const Vec3& tip, double clearanceMm) const {
        const double top = *std::max_element(surface_.begin(), surface_.end());
        const double height = axis_.dot(tip);
        return tip + std::max(0.0, (std::isfinite(top) ? top : height) + clearanceMm - height) * axis_;
    }

  private:
    using Cell = cases::Tissue;  // carious cells are this lesion's alone
    static constexpr Cell outside = Cell::none;
    static bool isDecayed(Cell cell) { return cases::isCarious(cell); }
    struct Bottom {
        int di, dj;
        double heightMm;     ///< of the bur's underside over its tip, there
        double resistingMm;  ///< what this column adds to sum(A cos2(theta) / rho)
    };

    /// Lets the bur sink to a height of the tip in a column, into the heights that are `left`, and counts the seconds.
    [[nodiscard]] Place lower(int i, int j, double target, std::vector<double>& left) const {
        Place there{place(i, j, target), place(i, j, target), place(i, j, target)};
        if (!scene_.rates) return there;
        const CuttingRates& rates = *scene_.rates;
        double tip = target;
        for (const Bottom& b : bottoms_)
            tip = std::max(tip, left[at(i + b.di, j + b.dj)] - b.heightMm);
        there.aboveMm = place(i, j, tip + kClearOfLayerMm);
        double hand = target;
        // Over the pulp the hand itself stays where the bur may go: nothing that was foreseen wrongly opens it.
        const double beyond = std::min(kBeyondMm, floor_[at(i, j)] - lowestByPulp_[at(i, j)]);
        const bool isHeld = beyond < kBeyondMm && target < floor_[at(i, j)] + 1e-9;
        const double mostS = isHeld ? kMaxWaitByPulpS : kMaxWaitS;
        for (bool first = true; tip > target && there.waitS < mostS; first = false) {
            double resistance = 0.0, stiffness = 0.0, bearing = 0.0;
            for (const Bottom& b : bottoms_) {
                const std::size_t column = at(i + b.di, j + b.dj);
                if (!(left[column] > tip - kLowerStepMm + b.heightMm)) continue;
                const int k = static_cast<int>(std::floor((left[column] - low_.z()) / cellMm_ - 0.01));
                const Cell cell = cells_[column * static_cast<std::size_t>(layers_) +
                                         static_cast<std::size_t>(std::clamp(k, 0, layers_ - 1))];
                if (cell == outside) continue;
                const auto tissue = static_cast<std::size_t>(cell);
                resistance += b.resistingMm / std::max(rates.cuttingMm2PerN[tissue], 1e-12);
                stiffness += rates.stiffnessNPerMm[tissue];
                ++bearing;
            }
            const double step = std::min(kLowerStepMm, tip - target);
            if (bearing > 0.0) {
                stiffness /= bearing;
                if (first)
                    hand = std::min(target,
                                    std::max(tip - rates.loadN / std::max(stiffness, 1e-6), floor_[at(i, j)] - beyond));
                const double load = std::min(stiffness * (tip - 0.5 * step - hand), rates.loadCapN);
                there.waitS += step / (kForeseen * std::min(load * rates.speedRadS / resistance, rates.maxFeedMmS));
            }
            tip -= step;
            for (const Bottom& b : bottoms_) {
                double& height = left[at(i + b.di, j + b.dj)];
                height = std::min(height, tip + b.heightMm);
            }
        }
        there.handMm = place(i, j, hand);
        there.waitS = std::min(there.waitS, mostS);
        return there;
    }

    [[nodiscard]] int countOf(double mm) const { return std::max(1, static_cast<int>(std::ceil(mm / cellMm_))); }
    [[nodiscard]] std::size_t at(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_[0]) + static_cast<std::size_t>(i);
    }
    [[nodiscard]] std::size_t at(int i, int j, int k) const {
        return at(i, j) * static_cast<std::size_t>(layers_) + static_cast<std::size_t>(k);
    }
    [[nodiscard]] double heightOf(int k) const { return low_.z() + (k + 0.5) * cellMm_; }
    [[nodiscard]] Vec3 place(int i, int j, double height) const {
        return turn_ * Vec3(low_.x() + (i + 0.5) * cellMm_, low_.y() + (j + 0.5) * cellMm_, height);
    }
    [[nodiscard]] double volume(double cells) const { return cells * cellMm_ * cellMm_ * cellMm_; }
    template <class Visit>
    void forEachColumn(Visit visit) const {
        for (int j = 0; j < columns_[1]; ++j)
            for (int i = 0; i < columns_[0]; ++i)
                visit(i, j);
    }
    [[nodiscard]] bool isIn(int i, int j) const { return i >= 0 && j >= 0 && i < columns_[0] && j < columns_[1]; }
    [[nodiscard]] bool isOnPath(int i, int j) const {
        return row_[static_cast<std::size_t>(j)] != 0 && std::isfinite(floor_[at(i, j)]);
    }

    void sample(const geometry::TriangleTree& lesion) {
        const std::size_t columns = static_cast<std::size_t>(columns_[0]) * static_cast<std::size_t>(columns_[1]);
        cells_.assign(columns * static_cast<std::size_t>(layers_), outside);
        lowestDecay_.assign(columns, kInfinity);
        guarded_ = 0.0;
        surface_.assign(columns, -kInfinity);
        guard_.assign(columns, -kInfinity);
        row_.assign(static_cast<std::size_t>(columns_[1]), 1);
        const core::Box& box = lesion.bounds();
        forEachColumn([&](int i, int j) {
            for (int k = 0; k < layers_; ++k) {
                const Vec3 p = place(i, j, heightOf(k));
                if (scene_.outerMm(p) >= 0.0) continue;
                surface_[at(i, j)] = heightOf(k) + 0.5 * cellMm_;
                Cell& cell = cells_[at(i, j, k)];
                cell = scene_.tissueAt ? scene_.tissueAt(p) : Cell::dentine;
                const Cell found = cell;
                if (cell == outside || isDecayed(cell)) cell = Cell::dentine;  // the surface, and other lesions
                if ((p.array() >= box.min.array()).all() && (p.array() <= box.max.array()).all() &&
                    lesion.signedDistance(p) < 0.0) {
                    cell = isDecayed(found) ? found : Cell::caries;
                    ++decay_;
                    lowestDecay_[at(i, j)] = std::min(lowestDecay_[at(i, j)], heightOf(k) - 0.5 * cellMm_);
                }
                // Half a cell's diagonal more: between the middles of cells nothing may be nearer.
                if (scene_.pulpMm && options_.pulpGuardMm > 0.0 &&
                    scene_.pulpMm(p) < options_.pulpGuardMm + 0.87 * cellMm_)
                    guard_[at(i, j)] = heightOf(k) + 0.5 * cellMm_;
            }
        });
    }

    [[nodiscard]] std::vector<Bottom> bottomsOf() const {
        std::vector<Bottom> bottoms;
        const double radius = scene_.burRadiusMm;
        const double leastRho = radius * (scene_.rates ? scene_.rates->centreRadius : 1.0);
        const int reach = static_cast<int>(std::ceil(radius / cellMm_));
        const auto heightAt = [&](double rho) {
            return scene_.burBottomMm ? scene_.burBottomMm(rho) : radius - std::sqrt(radius * radius - rho * rho);
        };
        for (int dj = -reach; dj <= reach; ++dj)
            for (int di = -reach; di <= reach; ++di) {
                const double rho = cellMm_ * core::hypot(di, dj);
                if (rho > radius) continue;
                const double in = std::max(0.0, rho - 0.5 * cellMm_), out = std::min(radius, rho + 0.5 * cellMm_);
                const double slope = (heightAt(out) - heightAt(in)) / (out - in);
                bottoms.push_back(
                    {di, dj, heightAt(rho), cellMm_ * cellMm_ / core::hypot(1.0, slope) / std::max(rho, leastRho)});
            }
        return bottoms;
    }

    // How low the tip may go in each column when the bur may cut `margin` cells beside the decay and half of that
    // under it; then what that takes.
    void setFloor(int margin) {
        const double under = 0.5 * margin * cellMm_;
        std::vector<double> allowed(lowestDecay_.size(), kInfinity);  // lowest place that may be cut, by column
        forEachColumn([&](int i, int j) {
            double nearest = kInfinity;
            for (int dj = -margin; dj <= margin; ++dj)
                for (int di = -margin; di <= margin; ++di) {
                    const double distance = core::hypot(di, dj);
                    if (distance > margin || distance >= nearest || !isIn(i + di, j + dj)) continue;
                    if (!std::isfinite(lowestDecay_[at(i + di, j + dj)])) continue;
                    nearest = distance;
                    allowed[at(i, j)] = lowestDecay_[at(i + di, j + dj)] - under;
                }
        });
        const auto floorOver = [&](const std::vector<double>& heights, int i, int j) {
            double floor = -kInfinity;
            for (const Bottom& b : bottoms_) {
                if (!isIn(i + b.di, j + b.dj)) return kInfinity;
                floor = std::max(floor, heights[at(i + b.di, j + b.dj)] - b.heightMm);
            }
            return floor;
        };
        floor_.assign(allowed.size(), kInfinity);
        lowestByPulp_.assign(allowed.size(), -kInfinity);
        std::vector<double> unguarded(allowed.size(), kInfinity);
        forEachColumn([&](int i, int j) {
            double& floor = unguarded[at(i, j)];
            floor = floorOver(allowed, i, j);
            if (options_.depthMm > 0.0 && std::isfinite(floor))
                floor = std::max(floor, surface_[at(i, j)] - options_.depthMm);
            lowestByPulp_[at(i, j)] = floorOver(guard_, i, j);
            if (std::isfinite(floor)) floor_[at(i, j)] = std::max(floor, lowestByPulp_[at(i, j)]);
        });
        // A place from which the bur meets no decay is left out.
        forEachColumn([&](int i, int j) {
            for (std::vector<double>* floors : {&floor_, &unguarded}) {
                double& floor = (*floors)[at(i, j)];
                if (std::isfinite(floor) && !meetsDecay(i, j, floor)) floor = kInfinity;
            }
        });
        std::fill(row_.begin(), row_.end(), std::uint8_t{1});
        const double withoutGuard = takenFrom(unguarded).decay;
        take();
        guarded_ = std::max(0.0, withoutGuard - reached_);
    }

    [[nodiscard]] bool meetsDecay(int i, int j, double floor) const {
        for (const Bottom& b : bottoms_) {
            const int k = std::max(0, static_cast<int>(std::floor((floor + b.heightMm - low_.z()) / cellMm_ + 0.5)));
            for (int l = k; l < layers_; ++l)
                if (isDecayed(cells_[at(i + b.di, j + b.dj, l)])) return true;
        }
        return false;
    }

    struct Taken {
        double decay = 0.0, sound = 0.0, pulpMm = kInfinity;
    };
    // What the bur takes with its tip on the rows of these floors.
    [[nodiscard]] Taken takenFrom(const std::vector<double>& floors) const {
        std::vector<double> lowest(floors.size(), kInfinity);
        forEachColumn([&](int i, int j) {
            if (!row_[static_cast<std::size_t>(j)] || !std::isfinite(floors[at(i, j)])) return;
            for (const Bottom& b : bottoms_) {
                double& l = lowest[at(i + b.di, j + b.dj)];
                l = std::min(l, floors[at(i, j)] + b.heightMm);
            }
        });
        Taken taken;
        forEachColumn([&](int i, int j) {
            if (!std::isfinite(lowest[at(i, j)])) return;
            bool first = true;
            for (int k = 0; k < layers_; ++k) {
                if (heightOf(k) < lowest[at(i, j)]) continue;
                const Cell cell = cells_[at(i, j, k)];
                taken.decay += isDecayed(cell);
                taken.sound += !isDecayed(cell) && cell != outside;
                if (cell == outside || !scene_.pulpMm || !std::exchange(first, false)) continue;
                taken.pulpMm = std::min(taken.pulpMm, scene_.pulpMm(place(i, j, lowest[at(i, j)])));
            }
        });
        return taken;
    }
    void take() {
        const Taken taken = takenFrom(floor_);
        reached_ = taken.decay;
        sound_ = taken.sound;
        nearestPulpMm_ = taken.pulpMm;
    }

    // Rows as far apart as ridges between them do not matter, and those without which decay would stay.
    void chooseRows() {
        const double all = reached_;
        const int step = std::max(1, static_cast<int>(kRowShare * scene_.burRadiusMm / cellMm_));
        int first = columns_[1], last = -1;
        forEachColumn([&](int i, int j) {
            if (!std::isfinite(floor_[at(i, j)])) return;
            first = std::min(first, j);
            last = std::max(last, j);
        });
        for (int j = 0; j < columns_[1]; ++j)
            row_[static_cast<std::size_t>(j)] = j == last || (j >= first && (j - first) % step == 0);
        take();
        for (int j = first; j <= last && reached_ < 0.99 * all; ++j) {
            if (row_[static_cast<std::size_t>(j)]) continue;
            const double before = reached_;
            row_[static_cast<std::size_t>(j)] = 1;
            take();
            if (reached_ < before + 0.005 * all) row_[static_cast<std::size_t>(j)] = 0;
        }
        take();
    }

    const CuttingScene& scene_;
    const CuttingOptions& options_;
    double cellMm_;
    Vec3 axis_;
    Quat turn_;  ///< from the lesion's frame, its z along the axis, to the tooth's
    Vec3 low_;   ///< corner of the grid, in the lesion's frame
    std::array<int, 2> columns_{};
    int layers_ = 0;
    std::vector<std::uint8_t> row_;  ///< 1: the bur goes along it
    std::vector<Bottom> bottoms_;
    std::vector<Cell> cells_;
    std::vector<double> lowestDecay_, surface_, guard_, floor_, lowestByPulp_;  ///< heights by column
    double decay_ = 0.0, reached_ = 0.0, sound_ = 0.0, guarded_ = 0.0, nearestPulpMm_ = kInfinity;
};

/// Out of the tooth where the lesion lies nearest to its surface.
Vec3 outwardsFrom(const CuttingScene& scene, const geometry::TriangleMesh& lesion) {
    const auto normalAt = [&](const Vec3& p) {
        constexpr double kStep = 0.02;
        Vec3 n = Vec3::Zero();
        for (int a = 0; a < 3; ++a) {
            const Vec3 d = kStep * Vec3::Unit(a);
            n[a] = scene.outerMm(p + d) - scene.outerMm(p - d);
        }
        return n;
    };
    double shallowest = -kInfinity;
    std::vector<double> depth;
    for (const Vec3& v : lesion.vertices) {
        depth.push_back(scene.outerMm(v));
        shallowest = std::max(shallowest, depth.back());
    }
    constexpr double kNear = 0.2;  // mm farther in than the nearest
    Vec3 sum = Vec3::Zero();
    for (std::size_t v = 0; v < depth.size(); ++v)
        if (depth[v] > shallowest - kNear) sum += normalAt(lesion.vertices[v]).normalized();
    const double length = sum.norm();
    Vec3 out = length > 1e-6 ? (sum / length).eval() : Vec3::UnitZ().eval();
    // Not from under the tooth, where no hand is.
    if (out.z() < 0.0) out.z() = 0.0;
    return out.norm() > 1e-3 ? out.normalized() : Vec3::UnitZ();
}

/// Poses one after the other; the pedal goes down and up in place.
class Path {
  public:
    explicit Path(double pedal) : down_(pedal) {}
    void begin(const Vec3& at, const Quat& turn) { poses_.push_back({0.0, {at, turn}, 0.0}); }
    [[nodiscard]] bool isEmpty() const { return poses_.empty(); }
    [[nodiscard]] const core::Pose& last() const { return poses_.back().burInTooth; }
    void stay(double seconds) {
        if (seconds > kLeastS) poses_.push_back({poses_.back().timeS + seconds, last(), pedal_});
    }
    void pedal(bool down) {
        pedal_ = down ? down_ : 0.0;
        stay(0.001);
    }
    void go(const Vec3& to, double speedMmS, double leastS = 0.0) {
        turnTo({to, last().orientation}, speedMmS, leastS);
    }
    void turnTo(const core::Pose& to, double speedMmS, double leastS = 0.0) {
        const double way =
            (to.positionMm - last().positionMm).norm() + core::angleBetween(last().orientation, to.orientation);
        const double seconds = std::max(way / speedMmS, leastS);
        if (seconds > kLeastS) poses_.push_back({poses_.back().timeS + seconds, to, pedal_});
    }
    [[nodiscard]] device::Motion finish() {
        stay(0.2);
        return device::Motion(std::move(poses_));
    }

  private:
    static constexpr double kLeastS = 1e-9;  // less may not show in a time of many minutes
    double down_, pedal_ = 0.0;
    std::vector<device::TimedPose> poses_;
};

// Outwards along the axis until the whole bur is out of the ball round the tooth.
Vec3 parkOver(const CuttingScene& scene, const Vec3& tip, const Vec3& axis, double clearanceMm) {
    const Vec3 middle = scene.toothBounds.centre(), from = tip - middle;
    const double radius = 0.5 * scene.toothBounds.size().norm() + scene.burRadiusMm + scene.burLengthMm + clearanceMm;
    const double along = from.dot(axis), rest = radius * radius - from.squaredNorm() + along * along;
    return tip + std::max(0.0, std::sqrt(std::max(0.0, rest)) - along) * axis;
}

// From one parking place to another, always outside that ball.
void goRound(Path& path, const Vec3& middle, const Vec3& to, const Quat& turn) {
    const core::Pose from = path.last();
    const Vec3 a = from.positionMm - middle, b = to - middle;
    const Quat arc = Quat::FromTwoVectors(a, b);
    constexpr int kSteps = 12;
    for (int s = 1; s <= kSteps; ++s) {
        const double share = static_cast<double>(s) / kSteps;
        const Vec3 direction = core::interpolated(Quat::Identity(), share, arc) * a.normalized();
        path.turnTo({middle + (a.norm() + (b.norm() - a.norm()) * share) * direction,
                     core::interpolated(from.orientation, share, turn)},
                    2.0 * kAirMmS);
    }
    path.turnTo({to, turn}, kAirMmS);
}

/// The bur's lowest point at a distance from its axis.
double bottomOf(const instrument::Bur& bur, double rhoMm) {
    double low = 0.0, high = bur.lengthMm();
    constexpr double kStepMm = 0.01;
    while (low < high && instrument::signedDistanceMm(bur.profile(), rhoMm, low) > 1e-6)
        low += kStepMm;
    return low;
}

}  // namespace

Excavation planExcavation(const CuttingScene& scene, const CuttingOptions& o) {
    validate(o);
    if (!o.offsetMm.isZero()) throw core::Error("excavation goes where the carious tissue is", "--at", "leave it out");
    if (scene.decay.empty())
        throw core::Error("this tooth has no carious tissue", "excavate",
                          "take a case with a caries part, or another motion");
    Path path(o.pedal);
    std::vector<LesionPlan> lesions;
    for (const geometry::TriangleMesh& lesion : lesionsOf(scene.decay)) {
        const geometry::TriangleTree tree(lesion);
        const core::Vec3 size = lesion.bounds().size();
        // A third of the bur, coarser only for lesions as large as a crown.
        const double cellMm = std::max({std::min(scene.burRadiusMm / 3.0, 0.15), size.maxCoeff() / 60.0, 0.03});
        if (geometry::enclosedVolumeMm3(lesion) < kSpeckCells * cellMm * cellMm * cellMm) continue;
        const Vec3 nearest = outwardsFrom(scene, lesion);
        std::optional<Approach> best;
        for (const Vec3& axis : {nearest, (nearest + Vec3::UnitZ()).normalized().eval(), Vec3::UnitZ().eval()}) {
            if (best && axis.dot(best->axis()) > 0.999) continue;
            Approach approach(scene, o, tree, axis, cellMm);
            approach.plan();
            if (!best || approach.cost() < best->cost()) best.emplace(std::move(approach));
        }
        lesions.push_back({lesion, lesion.bounds().centre(), best->axis(), best->decayMm3(), best->reachedMm3(),
                           best->soundMm3(), best->guardedMm3(), best->nearestPulpMm()});
        const std::vector<Approach::Stroke> strokes = best->strokes();
        if (strokes.empty()) continue;
        const Vec3 first = strokes.front().front().tipMm;
        const Vec3 park = parkOver(scene, first, best->axis(), o.clearanceMm);
        if (path.isEmpty())
            path.begin(park, best->turn());
        else
            goRound(path, scene.toothBounds.centre(), park, best->turn());
        path.pedal(true);
        path.stay(kSpinUpS);
        const auto over = [&](const Vec3& tip) { return best->above(tip, o.clearanceMm); };
        std::optional<Vec3> tip;
        for (const Approach::Stroke& stroke : strokes) {
            const Approach::Place& start = stroke.front();
            if (!tip || !best->mayGo(*tip, start.tipMm)) {
                if (tip) path.go(over(*tip), kAirMmS);
                path.go(over(start.tipMm), kAirMmS);
                if (scene.rates) path.go(start.aboveMm, kAirMmS);
            }
            path.go(start.handMm, kPlungeFeed * o.feedMmS);
            path.stay(start.waitS);
            for (const Approach::Place& place : stroke)
                if (&place != &start) path.go(place.handMm, o.feedMmS, place.waitS);
            tip = stroke.back().tipMm;
        }
        if (!scene.rates) path.stay(o.dwellS);
        const Vec3 end = path.last().positionMm;
        path.go(over(end), kAirMmS);
        path.go(parkOver(scene, path.last().positionMm, best->axis(), o.clearanceMm), kAirMmS);
        path.pedal(false);
    }
    if (path.isEmpty())
        throw core::Error("the bur cannot come to any of the carious tissue", "excavate",
                          "take a smaller bur, or a smaller --pulp-guard");
    return {path.finish(), std::move(lesions)};
}

CuttingScene excavationScene(const simulation::SimulationSetup& station, const cases::Case& toothCase) {
    CuttingScene scene;
    scene.toothBounds = station.tooth->outer.bounds();
    scene.burRadiusMm = station.settings.bur->maxRadiusMm();
    scene.burLengthMm = station.settings.bur->lengthMm();
    scene.burBottomMm = [&](double rhoMm) { return bottomOf(*station.settings.bur, rhoMm); };
    scene.outerMm = [&](const core::Vec3& p) { return station.tooth->tree.signedDistance(p); };
    const auto pulp = std::make_shared<std::vector<geometry::TriangleTree>>();
    for (const cases::Part& part : toothCase.parts) {
        if (cases::isCarious(part.tissue)) scene.decay.push_back(part.mesh);
        if (part.tissue == cases::Tissue::pulp) pulp->emplace_back(part.mesh);
    }
    if (!pulp->empty())
        scene.pulpMm = [pulp](const core::Vec3& p) {
            double nearest = kInfinity;
            for (const geometry::TriangleTree& tree : *pulp)
                nearest = std::min(nearest, tree.signedDistance(p));
            return nearest;
        };
    scene.tissueAt = [&](const core::Vec3& p) { return station.tooth->tissues.at(p); };
    return scene;
}

std::vector<LesionOutcome> lesionOutcomes(const std::vector<LesionPlan>& lesions, const core::Box& toothBounds,
                                          const std::function<double(const core::Vec3&)>& beforeMm,
                                          const std::function<double(const core::Vec3&)>& afterMm) {
    constexpr double kCell = 0.1, kVolume = kCell * kCell * kCell;
    std::vector<geometry::TriangleTree> trees;
    for (const LesionPlan& l : lesions)
        trees.emplace_back(l.mesh);
    std::vector<LesionOutcome> outcomes(lesions.size());
    core::Vec3 p;
    for (p.z() = toothBounds.min.z() + 0.5 * kCell; p.z() < toothBounds.max.z(); p.z() += kCell)
        for (p.y() = toothBounds.min.y() + 0.5 * kCell; p.y() < toothBounds.max.y(); p.y() += kCell)
            for (p.x() = toothBounds.min.x() + 0.5 * kCell; p.x() < toothBounds.max.x(); p.x() += kCell) {
                if (!(beforeMm(p) < 0.0)) continue;
                const bool isGone = afterMm(p) > 0.0;
                double nearestMm = kInfinity;
                std::size_t nearest = 0;
                for (std::size_t l = 0; l < trees.size(); ++l) {
                    const core::Box& box = trees[l].bounds();
                    if (!isGone && ((p.array() < box.min.array()).any() || (p.array() > box.max.array()).any()))
                        continue;
                    const double mm = trees[l].signedDistance(p);
                    if (mm < nearestMm) nearestMm = mm, nearest = l;
                }
                if (nearestMm < 0.0) outcomes[nearest].decayMm3 += kVolume;
                if (isGone && nearestMm < kInfinity)
                    (nearestMm < 0.0 ? outcomes[nearest].takenMm3 : outcomes[nearest].soundMm3) += kVolume;
            }
    return outcomes;
}

}  // namespace handpiece::studies
