// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/cutting/sweeper.h"

#include <algorithm>
#include <cmath>

#include "handpiece/model/instrument/piece.h"

namespace handpiece::cutting {

using core::Vec3;
using tooth::kBrickCells;
using tooth::kBrickNodes;
using tooth::kBrickValues;

namespace {

constexpr std::uint8_t kUnknown = 255, kMixed = 254;
/// Coarse values are known to this depth (see CutField).
constexpr double kCoarseReachMm = 2.0;
/// Between two poses that are cut on a way: what is left standing on a round bur's wall, and beside a sharp rim.
constexpr double kScallopMm = 1e-3, kStairVoxels = 0.4;

SweepKernels kernelsFor(core::SimdLevel level) {
#if defined(__x86_64__)
    if (level == core::SimdLevel::avx512) return simd_avx512::sweepKernels();
    if (level == core::SimdLevel::avx2) return simd_avx2::sweepKernels();
#endif
    static_cast<void>(level);
    return simd_base::sweepKernels();
}

/// One kernel unit: all that is asked about lies within 2^30 of them.
double unitFor(const instrument::Bur& bur, double voxelMm) {
    const double extent = 2.0 * (bur.lengthMm() + bur.maxRadiusMm() + kCoarseReachMm + 4.0 * kBrickCells * voxelMm);
    return 2.0 * extent / static_cast<double>(1 << 30);
}

/// How far apart two poses on a way may be cut.
double stepFor(const instrument::Bur& bur, double voxelMm) {
    double round = bur.maxRadiusMm();
    const auto& pieces = bur.profile().pieces;
    bool sharp = false;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (pieces[i].isArc && pieces[i].convex) round = std::min(round, pieces[i].radiusMm);
        if (i + 1 == pieces.size() || instrument::jointBetween(pieces[i], pieces[i + 1]) != instrument::Joint::convex)
            continue;
        const auto before = instrument::inwardNormalAt(pieces[i], 1.0),
                   after = instrument::inwardNormalAt(pieces[i + 1], 0.0);
        sharp = sharp || before.dot(after) < 0.95;
    }
    const double scallop = std::sqrt(8.0 * round * kScallopMm);
    return sharp ? std::min(scallop, kStairVoxels * voxelMm) : scallop;
}

/// Spreads the visits to deep bricks over the ticks: 0.5 .. 1, by brick.
double share(std::uint32_t dense) noexcept {
    return 0.5 + 0.5 * static_cast<double>((dense * 2654435761u) >> 16 & 0xffff) / 65536.0;
}

}  // namespace

/// Places are of the bur's frame in kernel units.
struct Sweeper::Frame {
    std::int64_t anchor[3];   // a node near the bur
    std::int32_t origin[3];   // its place
    std::int32_t axes[3][3];  // one node farther along x, y, z
    void placeOf(const std::int64_t (&node)[3], std::int32_t (&out)[3]) const noexcept {
        for (int k = 0; k < 3; ++k) {
            std::int64_t sum = origin[k];
            for (int a = 0; a < 3; ++a)
                sum += (node[a] - anchor[a]) * axes[a][k];
            out[k] = static_cast<std::int32_t>(sum);
        }
    }
};

Sweeper::Sweeper(tooth::CutField& field, const instrument::Bur& bur, core::SimdLevel level)
    : field_(field),
      kernels_(kernelsFor(level)),
      voxelMm_(field.field().settings().voxelMm),
      bandMm_(field.base().settings.bandMm),
      bandOutMm_(field.base().bandOutMm),
      lengthMm_(bur.lengthMm()),
      radiusMm_(bur.maxRadiusMm()),
      unitMm_(unitFor(bur, voxelMm_)),
      stepMm_(stepFor(bur, voxelMm_)),
      outline_(bur.profile(), unitMm_, bandMm_, bandOutMm_, 2.0 * kBrickCells * voxelMm_, 2.0 * voxelMm_),
      simple_(simpleOutline(bur.profile()), unitMm_, bandMm_, bandOutMm_, 0.0, 0.5 * radiusMm_),
      offsets_(3 * kBrickValues),
      owned_(kBrickValues),
      list_(outline_.pieces().size()),
      simpleList_(simple_.pieces().size()) {
    for (int i = 0; i < kBrickValues; ++i) {
        const bool own = i % kBrickNodes < kBrickCells && i / kBrickNodes % kBrickNodes < kBrickCells &&
                         i / (kBrickNodes * kBrickNodes) < kBrickCells;
        owned_[static_cast<std::size_t>(i)] = own ? -1 : 0;
    }
    simple_.list(~std::uint64_t{0} >> (64 - std::min<std::size_t>(64, simpleList_.size())), simpleList_.data());
    const tooth::FieldView view = field.field().view();
    const auto bricks = static_cast<std::size_t>(view.bricks[0]) * static_cast<std::size_t>(view.bricks[1]) *
                        static_cast<std::size_t>(view.bricks[2]);
    memory_.resize(bricks);
    uniform_.assign(bricks, kUnknown);
    for (std::size_t k = 0; k < 3; ++k)
        pass_.offset[k] = &offsets_[k * kBrickValues];
    pass_.owned = owned_.data();
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

Sweeper::Frame Sweeper::frameOf(const core::Pose& pose) noexcept {
    const tooth::FieldView view = field_.field().view();
    const core::Mat3 rotation = pose.orientation.toRotationMatrix();
    Frame frame;
    Vec3 away;
    for (int k = 0; k < 3; ++k) {
        const double node = std::round((pose.positionMm[k] - view.originMm[k]) * view.inverseVoxelMm);
        frame.anchor[k] = static_cast<std::int64_t>(node);
        away[k] = view.originMm[k] + node * voxelMm_ - pose.positionMm[k];
    }
    const Vec3 inBur = rotation.transpose() * away;
    for (int k = 0; k < 3; ++k) {
        frame.origin[k] = static_cast<std::int32_t>(std::lround(inBur[k] / unitMm_));
        for (int a = 0; a < 3; ++a)
            frame.axes[a][k] = static_cast<std::int32_t>(std::lround(rotation(a, k) * voxelMm_ / unitMm_));
    }
    return frame;
}

bool Sweeper::rangeNear(const core::Pose& pose, double reachMm, std::int32_t (&low)[3],
                        std::int32_t (&high)[3]) const noexcept {
    const tooth::FieldView view = field_.field().view();
    const Vec3 axis = pose.orientation * Vec3::UnitZ();
    for (int k = 0; k < 3; ++k) {
        const double side = radiusMm_ * std::sqrt(std::max(0.0, 1.0 - axis[k] * axis[k])) + reachMm;
        const double tip = pose.positionMm[k], top = tip + lengthMm_ * axis[k];
        const double perBrick = view.inverseVoxelMm / kBrickCells;
        const double first = std::floor((std::min(tip, top) - side - view.originMm[k]) * perBrick),
                     last = std::floor((std::max(tip, top) + side - view.originMm[k]) * perBrick);
        if (!(last >= 0.0 && first < view.bricks[k])) return false;
        low[k] = static_cast<std::int32_t>(std::max(first, 0.0));
        high[k] = static_cast<std::int32_t>(std::min(last, view.bricks[k] - 1.0));
    }
    return true;
}

std::uint8_t Sweeper::uniformTissue(std::uint32_t dense, std::int32_t stored) noexcept {
    std::uint8_t& known = uniform_[dense];
    if (known != kUnknown) return known;
    const std::uint8_t* tissues = field_.tissues(stored);
    known = tissues[0];
    for (int i = 1; i < kBrickValues; ++i)
        if (tissues[i] != tissues[0]) known = kMixed;
    return known;
}

void Sweeper::visit(std::uint32_t dense, const std::int32_t (&base)[3], const OutlineTable::Rectangle& rectangle,
                    bool all, Outcome& outcome) noexcept {
    const OutlineTable::Region region = outline_.region(rectangle);
    Memory& memory = memory_[dense];
    const bool known = memory.epoch == epoch_;
    if (region.lowMm >= bandMm_ || (known && -region.lowMm <= memory.least)) return;
    const bool deep = region.lowMm >= kDeepVoxels * voxelMm_;
    if (deep && known && !all && travelMm_ < memory.due) return;

    SweepBrick brick;
    for (int k = 0; k < 3; ++k)
        brick.base[k] = base[k];
    brick.form = SweepForm::general;
    if (region.alone != 0) {
        list_[0] = static_cast<std::uint16_t>(__builtin_ctzll(region.alone));
        brick.count = 1;
        brick.form = outline_.formOf(list_[0]);
    } else {
        brick.count = outline_.list(region.groups, list_.data());
    }
    brick.list = list_.data();

    std::int32_t stored = field_.field().view().brickIndex[dense];
    if (!known) memory = {0.0, -static_cast<float>(bandMm_), epoch_};
    memory.due = travelMm_ + kLagVoxels * voxelMm_ * share(dense);
    if (stored < 0) {
        if (kernels_.highest(pass_, brick) <= -static_cast<float>(bandMm_)) return;
        stored = field_.storeBrick(dense);
        if (stored < 0) return;
    }
    brick.uniform = uniformTissue(dense, stored);
    brick.tissue = brick.uniform == kMixed ? field_.tissues(stored) : nullptr;
    const SweepOutcome raised = kernels_.raise(pass_, brick, field_.values(stored), quanta_.data());
    memory.least = raised.least;
    if (!raised.rose) return;
    field_.noteChanged(dense, raised.shows);
    ++outcome.changedBricks;
}

void Sweeper::cutAt(const core::Pose& pose, bool all, Outcome& outcome) noexcept {
    ++outcome.poses;
    std::int32_t low[3], high[3];
    if (!rangeNear(pose, bandMm_, low, high)) return;
    const Frame frame = frameOf(pose);
    std::int32_t* const offsets[3] = {&offsets_[0], &offsets_[kBrickValues], &offsets_[2 * kBrickValues]};
    kernels_.makeOffsets(frame.axes, offsets);

    const tooth::FieldView view = field_.field().view();
    const auto unit = static_cast<float>(unitMm_), out = static_cast<float>(bandOutMm_);
    constexpr float kHalf = 0.5f * kBrickCells;
    float axes[3][3];  // half a brick along each of the grid's axes, in the bur's frame [mm]
    for (int a = 0; a < 3; ++a)
        for (int k = 0; k < 3; ++k)
            axes[a][k] = kHalf * static_cast<float>(frame.axes[a][k]) * unit;
    const float halfZ = std::abs(axes[0][2]) + std::abs(axes[1][2]) + std::abs(axes[2][2]);
    const float round = kHalf * std::sqrt(3.0f) * static_cast<float>(voxelMm_);
    const float band = static_cast<float>(bandMm_), rhoMost = static_cast<float>(radiusMm_) + band + round;
    const float zLow = -band - halfZ, zHigh = static_cast<float>(lengthMm_) + band + halfZ;
    for (std::int32_t bz = low[2]; bz <= high[2]; ++bz)
        for (std::int32_t by = low[1]; by <= high[1]; ++by) {
            const std::int64_t node[3] = {std::int64_t{kBrickCells} * low[0], std::int64_t{kBrickCells} * by,
                                          std::int64_t{kBrickCells} * bz};
            std::int32_t base[3];
            frame.placeOf(node, base);
            std::uint32_t dense = static_cast<std::uint32_t>(
                low[0] + view.bricks[0] * (by + static_cast<std::int64_t>(view.bricks[1]) * bz));
            for (std::int32_t bx = low[0]; bx <= high[0]; ++bx, ++dense) {
                const float x = static_cast<float>(base[0]) * unit + axes[0][0] + axes[1][0] + axes[2][0],
                            y = static_cast<float>(base[1]) * unit + axes[0][1] + axes[1][1] + axes[2][1],
                            z = static_cast<float>(base[2]) * unit + axes[0][2] + axes[1][2] + axes[2][2];
                const float rho2 = x * x + y * y;
                const bool near = rho2 < rhoMost * rhoMost && z > zLow && z < zHigh;
                if (near && (view.brickIndex[dense] >= 0 || view.coarse[dense] < 0.0f) &&
                    !(memory_[dense].epoch == epoch_ && memory_[dense].least >= out)) {
                    const float rho = std::sqrt(rho2), inverse = rho > 0.0f ? 1.0f / rho : 0.0f;
                    float along = 0.0f, across = 0.0f;
                    for (int a = 0; a < 3; ++a) {
                        along += std::abs(axes[a][0] * x + axes[a][1] * y);
                        across += std::abs(axes[a][1] * x - axes[a][0] * y);
                    }
                    along = rho > 0.0f ? along * inverse : round;
                    across = rho > 0.0f ? across * inverse : round;
                    const float farthest = rho + along;
                    const OutlineTable::Rectangle rectangle{std::max(rho - along, 0.0f),
                                                            std::sqrt(farthest * farthest + across * across), z - halfZ,
                                                            z + halfZ};
                    visit(dense, base, rectangle, all, outcome);
                }
                for (int k = 0; k < 3; ++k)
                    base[k] += kBrickCells * frame.axes[0][k];
            }
        }
}

void Sweeper::raiseCoarse(const core::Pose& pose, bool all) noexcept {
    // The whole box once in half a brick's way, in even portions.
    const double cycleMm = 0.5 * kBrickCells * voxelMm_;
    if (all || coarseRow_ >= coarseRows_) {
        if (!rangeNear(pose, kCoarseReachMm, coarseLow_, coarseHigh_)) return;
        coarseRow_ = 0;
        coarseRows_ = (std::int64_t{coarseHigh_[1]} - coarseLow_[1] + 1) * (coarseHigh_[2] - coarseLow_[2] + 1);
        coarseTravelMm_ = travelMm_;
    }
    const double share = all ? 1.0 : std::min(1.0, (travelMm_ - coarseTravelMm_) / cycleMm);
    const auto until = static_cast<std::int64_t>(std::ceil(share * static_cast<double>(coarseRows_)));
    if (coarseRow_ >= until) return;
    std::int32_t low[3], high[3];
    if (!rangeNear(pose, kCoarseReachMm, low, high)) return;
    const Frame frame = frameOf(pose);
    const tooth::FieldView view = field_.field().view();
    for (; coarseRow_ < until; ++coarseRow_) {
        const std::int64_t height = std::int64_t{coarseHigh_[1]} - coarseLow_[1] + 1;
        const std::int64_t by = coarseLow_[1] + coarseRow_ % height, bz = coarseLow_[2] + coarseRow_ / height;
        if (by < low[1] || by > high[1] || bz < low[2] || bz > high[2]) continue;
        const std::int64_t node[3] = {std::int64_t{kBrickCells} * low[0] + kBrickCells / 2,
                                      kBrickCells * by + kBrickCells / 2, kBrickCells * bz + kBrickCells / 2};
        SweepRow row;
        frame.placeOf(node, row.base);
        for (int k = 0; k < 3; ++k)
            row.step[k] = kBrickCells * frame.axes[0][k];
        row.count = high[0] - low[0] + 1;
        const std::int64_t dense = low[0] + view.bricks[0] * (by + view.bricks[1] * bz);
        kernels_.raiseRow(simplePass_, row, simpleList_.data(), static_cast<std::int32_t>(simpleList_.size()),
                          view.brickIndex + dense, field_.coarse() + dense);
    }
}

double Sweeper::stepsBetween(const core::Pose& from, const core::Pose& to, double& movedMm) const noexcept {
    // No point of the bur moves farther than this.
    const double reach = std::sqrt(lengthMm_ * lengthMm_ + radiusMm_ * radiusMm_);
    movedMm = (to.positionMm - from.positionMm).norm() + reach * from.orientation.angularDistance(to.orientation);
    return std::ceil(movedMm / stepMm_);
}

Sweeper::Outcome Sweeper::sweepTo(const core::Pose& to) noexcept {
    Outcome outcome;
    quanta_.fill(0);
    const double before = travelMm_;
    double moved = 0.0;
    const double steps = hasPose_ ? stepsBetween(pose_, to, moved) : 1.0;
    for (double i = 1.0; i < steps; i += 1.0) {
        const double t = i / steps;
        core::Pose between;
        between.positionMm = pose_.positionMm + t * (to.positionMm - pose_.positionMm);
        between.orientation = pose_.orientation.slerp(t, to.orientation);
        travelMm_ = before + t * moved;
        cutAt(between, false, outcome);
    }
    travelMm_ = before + moved;
    cutAt(to, false, outcome);
    raiseCoarse(to, false);
    pose_ = to;
    hasPose_ = true;
    const double quantumMm3 = voxelMm_ * voxelMm_ * voxelMm_ / kSweepQuanta;
    for (std::size_t t = 0; t < tooth::kTissueCount; ++t)
        outcome.removedMm3[t] = static_cast<double>(quanta_[t]) * quantumMm3;
    field_.addRemoved(outcome.removedMm3);
    return outcome;
}

Sweeper::Outcome Sweeper::settle() noexcept {
    Outcome outcome;
    if (!hasPose_) return outcome;
    cutAt(pose_, true, outcome);
    raiseCoarse(pose_, true);
    hasPose_ = false;
    coarseRow_ = coarseRows_ = 0;
    travelMm_ = 0.0;
    ++epoch_;
    return outcome;
}

}  // namespace handpiece::cutting
