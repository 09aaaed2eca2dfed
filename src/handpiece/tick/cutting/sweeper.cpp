// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/cutting/sweeper.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/rotation.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::cutting {

using contact::BurFrame;
using core::Vec3;
using field::kBrickCells;
using field::kBrickNodes;
using field::kBrickValues;

namespace {

constexpr double kCoarseReachMm{tooth::kCoarseDepthMm};
/// A brick's pieces are those of a region so much larger, and looked up again when the bur has moved as far.
constexpr double kPiecesVoxels = 1.0;
/// Between two poses that are cut on a way: what is left standing on a round bur's wall, and what a corner of the
/// outline leaves in voxels; more on a way longer than kFastMm.
constexpr double kScallopMm = 1e-3, kNotchVoxels = 0.04, kFastNotchVoxels = 0.2, kFastMm = 0.1;
/// A way of metres is no way of a hand: it is cut at so many poses.
constexpr double kMaxSteps = 512.0;
/// Of angles round the bur, where a corner's way is looked at.
constexpr double kCosines[] = {1.0, 0.9238795325112867,  0.7071067811865476,  0.3826834323650898,
                               0.0, -0.3826834323650898, -0.7071067811865476, -0.9238795325112867,
                               -1.0};

/// One kernel unit: all that is asked about lies within 2^30 of them.
double unitFor(const instrument::Bur& bur, double voxelMm) {
    const double extent = 2.0 * (bur.lengthMm() + bur.maxRadiusMm() + kCoarseReachMm + 4.0 * kBrickCells * voxelMm);
    return 2.0 * extent / static_cast<double>(1 << 30);
}

/// How far apart two poses may be cut for the sake of what is round with this radius.
double stepFor(double radiusMm) {
    return std::sqrt(8.0 * radiusMm * kScallopMm);
}

/// The same for what moves along the axis: there straight sides slide in their own envelope, as far as they overlap.
double alongStepFor(const instrument::Bur& bur) {
    double round = std::numeric_limits<double>::infinity(), side = round;
    for (const instrument::ProfilePiece& piece : bur.profile().pieces) {
        if (piece.isArc && piece.convex) round = std::min({round, piece.radiusMm, bur.maxRadiusMm()});
        const double height = std::abs(piece.to.y() - piece.from.y());
        if (height > 1e-9) side = std::min(side, height);
    }
    return std::min(stepFor(round), std::max(stepFor(bur.maxRadiusMm()), 0.5 * side));
}

}  // namespace

/// Places are of the bur's frame in kernel units.
struct Sweeper::GridInBur {
    std::int64_t anchor[3];                       // a node near the bur
    std::int32_t origin[3];                       // its place
    std::int32_t axes[3][3];                      // one node farther along x, y, z
    float halfAxes[3][3], half[3], halfZ, round;  // half a brick: along x, y, z; their sum; its reach [mm]
    void placeOf(const std::int64_t (&node)[3], std::int32_t (&out)[3]) const noexcept {
        for (int k = 0; k < 3; ++k) {
            std::int64_t sum = origin[k];
            for (int a = 0; a < 3; ++a)
                sum += (node[a] - anchor[a]) * axes[a][k];
            out[k] = static_cast<std::int32_t>(sum);
        }
    }
};

Sweeper::Sweeper(tooth::ToothState& field, const instrument::Bur& bur, core::SimdLevel level)
    : field_(field),
      kernels_(HANDPIECE_AT_SIMD_LEVEL(level, sweepKernels)()),
      voxelMm_(field.field().settings().voxelMm),
      bandMm_(field.model().settings.bandMm),
      bandOutMm_(field.model().bandOutMm),
      lengthMm_(bur.lengthMm()),
      radiusMm_(bur.maxRadiusMm()),
      unitMm_(unitFor(bur, voxelMm_)),
      sidewaysStepMm_(stepFor(radiusMm_)),
      alongStepMm_(alongStepFor(bur)),
      outline_(bur.profile(), unitMm_, bandMm_, bandOutMm_, 2.0 * kBrickCells * voxelMm_, 2.0 * voxelMm_),
      simple_(simpleOutline(bur.profile()), unitMm_, bandMm_, bandOutMm_, 0.0, 0.5 * radiusMm_),
      nodes_(std::make_unique<Nodes>()),
      list_(outline_.realPieces()),
      simpleList_(simple_.realPieces()) {
    for (int i = 0; i < kBrickValues; ++i) {
        const bool own = i % kBrickNodes < kBrickCells && i / kBrickNodes % kBrickNodes < kBrickCells &&
                         i / (kBrickNodes * kBrickNodes) < kBrickCells;
        nodes_->owned[i] = own ? -1 : 0;
    }
    simple_.list(~std::uint64_t{0} >> (64 - std::min<std::size_t>(64, simpleList_.size())), simpleList_.data());
    const auto& pieces = bur.profile().pieces;
    for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
        if (instrument::jointBetween(pieces[i], pieces[i + 1]) != instrument::Joint::convex) continue;
        const core::Vec2 before = -instrument::inwardNormalAt(pieces[i], 1.0),
                         after = -instrument::inwardNormalAt(pieces[i + 1], 0.0);
        corners_.push_back({before, after, std::abs(before.x() * after.y() - before.y() * after.x()),
                            i + 2 == pieces.size() && after.y() > 0.999});
    }
    visits_.resize(field.field().storage().coarse.size());
    memory_.resize(visits_.size());
    Dues never{};
    std::fill_n(never.steps, kSweepDues, kSweepMostWay);
    dues_.assign(field.field().brickCount(), never);
    for (std::size_t k = 0; k < 3; ++k)
        pass_.offset[k] = nodes_->offset[k];
    pass_.owned = nodes_->owned;
    pass_.pieces = outline_.pieces().data();
    pass_.unitMm = static_cast<float>(unitMm_);
    pass_.bandOutMm = static_cast<float>(bandOutMm_);
    // As tooth::occupancy has it, to the bit.
    const auto quanta = static_cast<float>(kSweepQuanta);
    pass_.half = 0.5f * quanta;
    pass_.perMm = static_cast<float>(1.0 / voxelMm_) * (0.5f / tooth::kOccupancyHalfWidth) * quanta;
    pass_.showsMm = static_cast<float>(1.8 * voxelMm_);
    simplePass_ = pass_;
    simplePass_.pieces = simple_.pieces().data();
}

Sweeper::GridInBur Sweeper::gridIn(const BurFrame& bur) const noexcept {
    const field::FieldView view = field_.field().view();
    GridInBur grid;
    Vec3 away;
    for (int k = 0; k < 3; ++k) {
        const double node = std::round((bur.tip[k] - view.originMm[k]) * view.inverseVoxelMm);
        grid.anchor[k] = static_cast<std::int64_t>(node);
        away[k] = view.originMm[k] + node * voxelMm_ - bur.tip[k];
    }
    const Vec3 inBur(bur.x.dot(away), bur.y.dot(away), bur.z.dot(away));
    for (int k = 0; k < 3; ++k) {
        grid.origin[k] = static_cast<std::int32_t>(std::lround(inBur[k] / unitMm_));
        for (int a = 0; a < 3; ++a)
            grid.axes[a][k] = static_cast<std::int32_t>(std::lround(bur.toBur(k, a) * voxelMm_ / unitMm_));
    }
    constexpr float kHalf = 0.5f * kBrickCells;
    grid.round = kHalf * std::sqrt(3.0f) * static_cast<float>(voxelMm_);
    grid.halfZ = 0.0f;
    for (int k = 0; k < 3; ++k) {
        grid.half[k] = 0.0f;
        for (int a = 0; a < 3; ++a) {
            grid.halfAxes[a][k] = kHalf * static_cast<float>(grid.axes[a][k]) * pass_.unitMm;
            grid.half[k] += grid.halfAxes[a][k];
        }
    }
    for (int a = 0; a < 3; ++a)
        grid.halfZ += std::abs(grid.halfAxes[a][2]);
    return grid;
}

bool Sweeper::rangeNear(const BurFrame& bur, double reachMm, std::int32_t (&low)[3],
                        std::int32_t (&high)[3]) const noexcept {
    const field::FieldView view = field_.field().view();
    const core::Box box = bur.boxAround(lengthMm_, radiusMm_, reachMm);
    const double perBrick = view.inverseVoxelMm / kBrickCells;
    for (int k = 0; k < 3; ++k) {
        const double first = std::floor((box.min[k] - view.originMm[k]) * perBrick),
                     last = std::floor((box.max[k] - view.originMm[k]) * perBrick);
        if (!(last >= 0.0 && first < view.bricks[k])) return false;
        low[k] = static_cast<std::int32_t>(std::max(first, 0.0));
        high[k] = static_cast<std::int32_t>(std::min(last, view.bricks[k] - 1.0));
    }
    return true;
}

/// The way at which the bur may have come `mm` nearer.
std::int32_t Sweeper::wayAfter(double mm) const noexcept {
    const double quanta = std::max(0.0, mm / static_cast<double>(kSweepWayMm) - 2.0);
    return quanta < static_cast<double>(kSweepMostWay - way_) ? way_ + static_cast<std::int32_t>(quanta)
                                                              : kSweepMostWay;
}

/// What holds in a brick until the bur has moved kPiecesVoxels.
OutlineTable::Region Sweeper::regionOf(const GridInBur& grid, const std::int32_t (&base)[3]) const noexcept {
    const float x = static_cast<float>(base[0]) * pass_.unitMm + grid.half[0],
                y = static_cast<float>(base[1]) * pass_.unitMm + grid.half[1],
                z = static_cast<float>(base[2]) * pass_.unitMm + grid.half[2];
    const float rho = std::sqrt(x * x + y * y), inverse = rho > 0.0f ? 1.0f / rho : 0.0f;
    float along = 0.0f, across = 0.0f;
    for (int a = 0; a < 3; ++a) {
        along += std::abs(grid.halfAxes[a][0] * x + grid.halfAxes[a][1] * y);
        across += std::abs(grid.halfAxes[a][1] * x - grid.halfAxes[a][0] * y);
    }
    const auto grown = static_cast<float>(kPiecesVoxels * voxelMm_);
    along = grown + (rho > 0.0f ? along * inverse : grid.round);
    across = grown + (rho > 0.0f ? across * inverse : grid.round);
    const float farthest = rho + along, high = grid.halfZ + grown;
    return outline_.region(
        {std::max(rho - along, 0.0f), std::sqrt(farthest * farthest + across * across), z - high, z + high});
}

void Sweeper::visit(const GridInBur& grid, std::uint32_t dense, const std::int32_t (&base)[3],
                    Outcome& outcome) noexcept {
    Visit& next = visits_[dense];
    Memory& memory = memory_[dense];
    std::int32_t stored = field_.field().storage().brickIndex[dense];
    if (next.epoch != epoch_) {
        next = {kSweepMostWay, epoch_};
        memory = {way_, 0, 0};
        if (stored < 0 && field_.coarse()[dense] >= 0.0f) return;  // outside the tooth
    }
    if (memory.piecesDue <= way_) {
        const OutlineTable::Region region = regionOf(grid, base);
        if (region.lowMm >= bandMm_) {
            next.due = wayAfter(static_cast<double>(region.lowMm) - bandMm_);
            // Its steps are not looked at meanwhile, and may be due when it comes back.
            return;
        }
        memory.piecesDue = wayAfter(kPiecesVoxels * voxelMm_);
        memory.groups = region.groups;
        memory.alone = region.alone;
    }
    SweepBrick brick;
    for (int k = 0; k < 3; ++k)
        brick.base[k] = base[k];
    brick.form = SweepForm::general;
    if (memory.alone != 0) {
        list_[0] = static_cast<std::uint16_t>(__builtin_ctzll(memory.alone));
        brick.count = 1;
        brick.form = outline_.formOf(list_[0]);
    } else {
        brick.count = outline_.list(memory.groups, list_.data());
        const auto isLine = [this](std::uint16_t piece) { return outline_.pieces()[piece].radius == 0.0f; };
        if (brick.count == 2 && isLine(list_[0]) && isLine(list_[1])) brick.form = SweepForm::lines;
    }
    brick.list = list_.data();

    if (stored < 0) {
        const double spare = -bandMm_ - static_cast<double>(kernels_.highest(pass_, brick));
        if (spare >= 0.0) {
            next.due = wayAfter(spare);
            return;
        }
        stored = field_.storeBrick(dense);
        if (stored < 0) return;
    }
    Dues& dues = dues_[static_cast<std::size_t>(stored)];
    if (dues.epoch != epoch_) {
        dues.epoch = epoch_;
        std::fill_n(dues.steps, kSweepSteps, way_);
    }
    const field::BrickTissues& tissues = *field_.field().storage().tissues;
    brick.uniform = *tissues.of(dense);
    brick.tissue = tissues.isMixed(dense) ? tissues.of(dense) : nullptr;
    brick.way = way_;
    brick.due = dues.steps;
    const SweepOutcome raised = kernels_.raise(pass_, brick, field_.values(stored), quanta_.data());
    next.due = raised.due;
    if (!raised.rose) return;
    field_.noteChanged(dense, raised.shows);
    ++outcome.changedBricks;
}

void Sweeper::cutAt(const core::Pose& pose, Outcome& outcome) noexcept {
    ++outcome.poses;
    std::int32_t low[3], high[3];
    const BurFrame bur(pose);
    if (!rangeNear(bur, bandMm_, low, high)) return;
    const GridInBur grid = gridIn(bur);
    std::int32_t* const offsets[3] = {nodes_->offset[0], nodes_->offset[1], nodes_->offset[2]};
    kernels_.makeOffsets(grid.axes, offsets);
    const field::FieldView view = field_.field().view();
    for (std::int32_t bz = low[2]; bz <= high[2]; ++bz)
        for (std::int32_t by = low[1]; by <= high[1]; ++by) {
            const std::int64_t node[3] = {std::int64_t{kBrickCells} * low[0], std::int64_t{kBrickCells} * by,
                                          std::int64_t{kBrickCells} * bz};
            std::int32_t row[3];
            grid.placeOf(node, row);
            std::uint32_t dense = static_cast<std::uint32_t>(
                low[0] + view.bricks[0] * (by + static_cast<std::int64_t>(view.bricks[1]) * bz));
            for (std::int32_t bx = low[0]; bx <= high[0]; ++bx, ++dense) {
                if (visits_[dense].epoch == epoch_ && visits_[dense].due > way_) continue;
                std::int32_t base[3];
                for (int k = 0; k < 3; ++k)
                    base[k] = row[k] + (bx - low[0]) * kBrickCells * grid.axes[0][k];
                visit(grid, dense, base, outcome);
            }
        }
}

void Sweeper::raiseCoarse(const core::Pose& pose, bool all) noexcept {
    const BurFrame bur(pose);
    // The whole box once in half a brick's way, in even portions.
    const double cycleMm = 0.5 * kBrickCells * voxelMm_;
    if (all || coarseRow_ >= coarseRows_) {
        if (!rangeNear(bur, kCoarseReachMm, coarseLow_, coarseHigh_)) return;
        coarseRow_ = 0;
        coarseRows_ = (std::int64_t{coarseHigh_[1]} - coarseLow_[1] + 1) * (coarseHigh_[2] - coarseLow_[2] + 1);
        coarseTravelMm_ = travelMm_;
    }
    const double share = all ? 1.0 : std::min(1.0, (travelMm_ - coarseTravelMm_) / cycleMm);
    const auto until = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(coarseRows_)));
    if (coarseRow_ >= until) return;
    std::int32_t low[3], high[3];
    if (!rangeNear(bur, kCoarseReachMm, low, high)) return;
    const GridInBur grid = gridIn(bur);
    const field::FieldView view = field_.field().view();
    for (; coarseRow_ < until; ++coarseRow_) {
        const std::int64_t height = std::int64_t{coarseHigh_[1]} - coarseLow_[1] + 1;
        const std::int64_t by = coarseLow_[1] + coarseRow_ % height, bz = coarseLow_[2] + coarseRow_ / height;
        if (by < low[1] || by > high[1] || bz < low[2] || bz > high[2]) continue;
        const std::int64_t node[3] = {std::int64_t{kBrickCells} * low[0] + kBrickCells / 2,
                                      kBrickCells * by + kBrickCells / 2, kBrickCells * bz + kBrickCells / 2};
        SweepRow row;
        grid.placeOf(node, row.base);
        for (int k = 0; k < 3; ++k)
            row.step[k] = kBrickCells * grid.axes[0][k];
        row.count = high[0] - low[0] + 1;
        const std::int64_t dense = low[0] + view.bricks[0] * (by + view.bricks[1] * bz);
        kernels_.raiseRow(simplePass_, row, simpleList_.data(), static_cast<std::int32_t>(simpleList_.size()),
                          view.brickIndex + dense, field_.coarse() + dense);
    }
}

/// How deep a notch, over the way between two poses, is left standing where a corner is the outermost part of the bur
/// seen along the way; `direction` (unit) in the bur's grid.
double Sweeper::notchOf(const Vec3& direction) const noexcept {
    const double sideways = core::hypot(direction.x(), direction.y());
    double most = 0.0;
    for (const Corner& corner : corners_) {
        const double share = corner.atTop ? kNotchVoxels / kFastNotchVoxels : 1.0;
        for (const double cosine : kCosines) {
            const core::Vec2 v(sideways * cosine, direction.z());
            const double before = corner.before.dot(v), after = corner.after.dot(v);
            if (before * after < 0.0)
                most = std::max(most, -share * before * after / (corner.sine * std::max(v.norm(), 1e-9)));
        }
    }
    return most;
}

double Sweeper::stepsBetween(const core::Pose& from, const core::Pose& to, double& movedMm) const noexcept {
    // No point of the bur moves farther than this.
    const double reach = std::sqrt(lengthMm_ * lengthMm_ + radiusMm_ * radiusMm_);
    const Vec3 way = to.positionMm - from.positionMm;
    const double shifted = way.norm(), turned = reach * core::angleBetween(from.orientation, to.orientation);
    movedMm = shifted + turned;
    const Vec3 axis = from.orientation * Vec3::UnitZ();
    const double sideways = (way - way.dot(axis) * axis).norm() + turned;
    const double steps = std::max(std::ceil(sideways / sidewaysStepMm_), std::ceil(movedMm / alongStepMm_));
    if (corners_.empty()) return std::min(steps, kMaxSteps);
    const double notch = (movedMm > kFastMm ? kFastNotchVoxels : kNotchVoxels) * voxelMm_;
    // A turn moves points in all directions: as bad as it gets at a right angle.
    const bool onlyTop = corners_.size() == 1 && corners_[0].atTop;
    double left = 0.5 * turned * (onlyTop ? kNotchVoxels / kFastNotchVoxels : 1.0);
    if (shifted > 0.0) left += shifted * notchOf(from.orientation.conjugate() * (way / shifted));
    return std::min(std::max(steps, std::ceil(left / notch)), kMaxSteps);
}

void Sweeper::setTravel(double mm) noexcept {
    travelMm_ = mm;
    way_ = static_cast<std::int32_t>(std::min(mm / static_cast<double>(kSweepWayMm) + 1.0, 1.0 * kSweepMostWay - 1.0));
}

void Sweeper::forget() noexcept {
    ++epoch_;
    coarseRow_ = coarseRows_ = 0;
    setTravel(0.0);
}

Sweeper::Outcome Sweeper::sweepTo(const core::Pose& to) noexcept {
    Outcome outcome;
    quanta_.fill(0);
    constexpr double kMaxMm = 0.5 * static_cast<double>(kSweepMostWay) * static_cast<double>(kSweepWayMm);
    if (travelMm_ > kMaxMm) forget();
    const double before = travelMm_;
    double moved = 0.0;
    const double steps = hasPose_ ? stepsBetween(pose_, to, moved) : 1.0;
    for (double i = 1.0; i < steps; i += 1.0) {
        const double t = i / steps;
        core::Pose between;
        between.positionMm = pose_.positionMm + t * (to.positionMm - pose_.positionMm);
        between.orientation = core::interpolated(pose_.orientation, t, to.orientation);
        setTravel(before + t * moved);
        cutAt(between, outcome);
    }
    setTravel(before + moved);
    cutAt(to, outcome);
    raiseCoarse(to, false);
    pose_ = to;
    hasPose_ = true;
    const double quantumMm3 = voxelMm_ * voxelMm_ * voxelMm_ / kSweepQuanta;
    for (std::size_t t = 0; t < cases::kTissueCount; ++t)
        outcome.removedMm3[t] = static_cast<double>(quanta_[t]) * quantumMm3;
    field_.addRemoved(outcome.removedMm3);
    return outcome;
}

void Sweeper::settle() noexcept {
    if (!hasPose_) return;
    raiseCoarse(pose_, true);
    hasPose_ = false;
    forget();
}

}  // namespace handpiece::cutting
