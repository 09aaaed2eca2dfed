// SPDX-License-Identifier: Apache-2.0
// What the sweep takes away, against closed forms, against every node computed alone, and against itself.
#include "handpiece/tick/cutting/sweeper.h"

#include <gtest/gtest.h>

#include <cstring>
#include <numbers>
#include <string_view>
#include <vector>

#include "handpiece/model/instrument/piece.h"
#include "handpiece/model/instrument/shapes.h"
#include "support/realtime_trap.h"
#include "tick/cutting/phantom.h"

namespace handpiece::cutting::sweeper_test {
namespace {

using cases::Tissue;
using core::Pose;
using core::Vec2;
using core::Vec3;
using field::kBrickCells;
using field::kBrickNodes;
using field::kBrickValues;
using test::poseAt;
using test::sumOf;

constexpr double kPi = std::numbers::pi;

instrument::Bur burOf(const char* name) {
    return instrument::makeBur(name);
}

/// A straight way with poses no farther apart than `stepMm`.
void sweepAlong(Sweeper& sweeper, const Pose& from, const Pose& to, double stepMm) {
    const double length = (to.positionMm - from.positionMm).norm();
    const int steps = std::max(1, static_cast<int>(std::ceil(length / stepMm - 1e-9)));
    for (int i = 0; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        sweeper.sweepTo(
            {from.positionMm + t * (to.positionMm - from.positionMm), from.orientation.slerp(t, to.orientation)});
    }
}

/// The wall of the hole that an upright bur plunged by `depthMm` leaves, in the half-plane: points no farther apart
/// than 15 um, with the normal into the hole; z from the bottom up.
struct WallPoint {
    Vec2 at, normal;
    double toRimMm;  ///< distance to the nearest sharp edge of the hole
};
std::vector<WallPoint> wallOf(const instrument::Bur& bur, double depthMm, bool plunged) {
    std::vector<WallPoint> wall;
    std::vector<Vec2> rims;
    const auto& pieces = bur.profile().pieces;
    double top = 0.0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const int count = std::max(2, static_cast<int>(instrument::lengthMm(pieces[i]) / 0.015));
        bool risen = true;
        for (int k = 0; k < count && risen; ++k) {
            const double t = (k + 0.5) / count;
            const Vec2 p = instrument::pointAt(pieces[i], t), n = instrument::inwardNormalAt(pieces[i], t);
            risen = p.y() < depthMm && (!plunged || (n.x() <= 1e-9 && n.y() >= -1e-9));  // widens on the way up
            if (risen) wall.push_back({p, n, 0.0});
        }
        if (!risen) break;
        top = pieces[i].to.y();
        if (i + 1 < pieces.size() && instrument::jointBetween(pieces[i], pieces[i + 1]) == instrument::Joint::convex)
            rims.push_back(pieces[i].to);
    }
    for (double z = std::max(top, wall.back().at.y()) + 0.0075; plunged && z < depthMm; z += 0.015)
        wall.push_back({Vec2(bur.maxRadiusMm(), z), Vec2(-1.0, 0.0), 0.0});
    rims.push_back({wall.back().at.x(), depthMm});
    for (WallPoint& w : wall) {
        w.toRimMm = std::numeric_limits<double>::infinity();
        for (const Vec2& rim : rims)
            w.toRimMm = std::min(w.toRimMm, (w.at - rim).norm());
    }
    return wall;
}
/// Volume of the hole: of a plunge (each height as wide as the widest part that has passed it), or of a level way of
/// `lengthMm` of the axis.
double holeVolume(const instrument::Bur& bur, double depthMm, double lengthMm) {
    constexpr int kSlices = 2000;
    double volume = 0.0, widest = 0.0;
    const auto& pieces = bur.profile().pieces;
    std::vector<double> radius(kSlices, 0.0);
    for (const auto& piece : pieces)
        for (int k = 0; k <= 20000; ++k) {
            const Vec2 p = instrument::pointAt(piece, k / 20000.0);
            const int slice = static_cast<int>(p.y() / depthMm * kSlices);
            if (slice >= 0 && slice < kSlices)
                radius[static_cast<std::size_t>(slice)] = std::max(radius[static_cast<std::size_t>(slice)], p.x());
        }
    for (const double r : radius) {
        widest = lengthMm > 0.0 ? r : std::max(widest, r);
        volume += (kPi * widest * widest + 2.0 * widest * lengthMm) * depthMm / kSlices;
    }
    return volume;
}

struct Errors {
    std::vector<double> clear, rim;  // [mm]
    void add(const field::DistanceField& field, const Vec3& p, const Vec3& normal, double toRimMm) {
        const double voxel = field.settings().voxelMm, e = test::zeroAlong(field, p, normal, 2.0 * voxel);
        // Along the normal of one side of an edge there may be nothing of it left.
        if (std::isnan(e) && toRimMm <= voxel) return;
        (toRimMm > voxel ? clear : rim).push_back(std::isnan(e) ? 2.0 * voxel : std::abs(e));
    }
    void expectSmall(double voxelMm, const std::string& what) {
        std::sort(clear.begin(), clear.end());
        ASSERT_GT(clear.size(), 500u);
        const double p99 = clear[clear.size() * 99 / 100];
        const double rimMost = rim.empty() ? 0.0 : *std::max_element(rim.begin(), rim.end());
        std::printf("  %s: surface error p99 %.2f um, most %.2f um, within a voxel of a rim %.3f voxels (%zu points)\n",
                    what.c_str(), 1e3 * p99, 1e3 * clear.back(), rimMost / voxelMm, clear.size());
        EXPECT_LE(p99, 0.005) << what;
        EXPECT_LE(rimMost, voxelMm) << what;  // a field rounds edges off within its voxel
    }
};

constexpr const char* kBurs[] = {"cylinder-flat:1.0x4.0", "cylinder-round:1.0x4.0", "round:1.4x1.4", "wheel:2.0x0.8",
                                 "inverted-cone:1.2x1.0"};
constexpr double kVoxel = 0.05;

TEST(Sweeper, aPlungeIsTheHoleOfItsClosedForm) {
    for (const char* name : kBurs) {
        const instrument::Bur bur = burOf(name);
        const double depth = 1.23;
        const Vec3 tip(0.013, -0.021, -depth);
        tooth::ToothState field(test::enamelBlock(Vec3(-1.6, -1.6, -2.2), Vec3(1.6, 1.6, 0), kVoxel));
        Sweeper sweeper(field, bur, core::simdLevel());
        double removed = 0.0;
        for (double z = 0.2; z > -depth; z -= 0.01)
            removed += sumOf(sweeper.sweepTo(poseAt(Vec3(tip.x(), tip.y(), std::max(z - 0.01, -depth)))).removedMm3);
        sweeper.settle();
        const double closed = holeVolume(bur, depth, 0.0);
        // A bur that narrows behind its rim is nowhere as deep in the air of its hole as the hole is: there the larger
        // of its distances at all poses is only a bound, and the zero between the nodes lies up to 4 um off.
        const bool narrows = std::string_view(name).starts_with("inverted");
        EXPECT_NEAR(removed, closed, (narrows ? 0.008 : 0.003) * closed) << name;
        std::printf("  %s: volume %+.3f %%\n", name, 100.0 * (removed / closed - 1.0));
        Errors errors;
        for (const WallPoint& w : wallOf(bur, depth, true))
            for (int k = 0; k < 24; ++k) {
                const double a = (k + 0.37) * kPi / 12.0;
                const Vec3 radial(std::cos(a), std::sin(a), 0.0);
                errors.add(field.field(), tip + w.at.x() * radial + w.at.y() * Vec3::UnitZ(),
                           w.normal.x() * radial + w.normal.y() * Vec3::UnitZ(), w.toRimMm);
            }
        errors.expectSmall(kVoxel, name);
    }
}

TEST(Sweeper, aGrooveIsThatOfItsClosedForm) {
    for (const char* name : kBurs) {
        const instrument::Bur bur = burOf(name);
        const double depth = 0.61, length = 1.5, turn = 0.3;  // askew in the grid
        const core::Quat askew(Eigen::AngleAxisd(turn, Vec3::UnitZ()));
        const Vec3 along = askew * Vec3::UnitX(), across = askew * Vec3::UnitY(),
                   from = -0.5 * length * along - depth * Vec3::UnitZ();
        tooth::ToothState field(test::enamelBlock(Vec3(-2.2, -2.2, -1.4), Vec3(2.2, 2.2, 0), kVoxel));
        Sweeper sweeper(field, bur, core::simdLevel());
        sweepAlong(sweeper, poseAt(from), poseAt(from + length * along), 0.01);
        sweeper.settle();
        const double closed = holeVolume(bur, depth, length);
        EXPECT_NEAR(sumOf(field.removedMm3()), closed, 0.003 * closed) << name;
        Errors errors;
        for (const WallPoint& w : wallOf(bur, depth, false))
            for (int k = 0; k < 20; ++k)
                for (const double side : {-1.0, 1.0})
                    errors.add(
                        field.field(),
                        from + (k + 0.5) / 20.0 * length * along + side * w.at.x() * across + w.at.y() * Vec3::UnitZ(),
                        side * w.normal.x() * across + w.normal.y() * Vec3::UnitZ(), w.toRimMm);
        errors.expectSmall(kVoxel, name);
    }
}

TEST(Sweeper, anArcIsThatOfItsClosedForm) {
    for (const char* name : {"cylinder-flat:1.0x4.0", "cylinder-round:1.0x4.0"}) {
        const instrument::Bur bur = burOf(name);
        const double depth = 0.83, radius = 1.1, angle = 2.0;
        tooth::ToothState field(test::enamelBlock(Vec3(-2.0, -2.0, -1.6), Vec3(2.0, 2.0, 0), kVoxel));
        Sweeper sweeper(field, bur, core::simdLevel());
        const int steps = 400;
        const auto centre = [&](double a) { return Vec3(radius * std::cos(a), radius * std::sin(a), -depth); };
        for (int i = 0; i <= steps; ++i)
            sweeper.sweepTo(poseAt(centre(angle * i / steps)));
        sweeper.settle();
        const double closed = holeVolume(bur, depth, angle * radius);
        EXPECT_NEAR(sumOf(field.removedMm3()), closed, 0.003 * closed) << name;
        Errors errors;
        for (const WallPoint& w : wallOf(bur, depth, false))
            for (int k = 0; k < 20; ++k)
                for (const double side : {-1.0, 1.0}) {
                    const double a = (k + 0.5) / 20.0 * angle;
                    const Vec3 radial(std::cos(a), std::sin(a), 0.0);
                    errors.add(field.field(), centre(a) + side * w.at.x() * radial + w.at.y() * Vec3::UnitZ(),
                               side * w.normal.x() * radial + w.normal.y() * Vec3::UnitZ(), w.toRimMm);
                }
        errors.expectSmall(kVoxel, name);
    }
}

/// A random walk of a bur through a block, with jumps and turns.
std::vector<Pose> walk(std::mt19937_64& g, int count) {
    std::vector<Pose> poses;
    Pose pose = poseAt(Vec3(0, 0, -0.2), core::Quat(Eigen::AngleAxisd(0.4, test::randomDirection(g))));
    for (int i = 0; i < count; ++i) {
        const double step = i % 17 == 0 ? 0.3 : i % 5 == 0 ? 0.02 : 0.002;
        pose.positionMm += step * test::randomDirection(g);
        pose.positionMm = pose.positionMm.cwiseMax(Vec3(-0.8, -0.8, -0.9)).cwiseMin(Vec3(0.8, 0.8, 0.1));
        pose.orientation =
            (pose.orientation * core::Quat(Eigen::AngleAxisd(0.1 * step, test::randomDirection(g)))).normalized();
        poses.push_back(pose);
    }
    return poses;
}
constexpr const char* kManyBurs[] = {
    "cylinder-flat:1.0x3.0", "cylinder-round:0.8x3.0", "round:1.2x1.2", "wheel:1.6x0.7",
    "inverted-cone:1.2x1.0", "flame:1.0x3.0",          "pear:0.8x1.5",  "torpedo:1.0x3.0",
    "taper-flat:1.0x3.0",    "cylinder-round:0.6x1.2", "paper"};

/// Calls f(dense, brick's first node) for every stored brick.
template <class F>
void forStored(const field::FieldView& view, F&& f) {
    for (std::int32_t bz = 0, dense = 0; bz < view.bricks[2]; ++bz)
        for (std::int32_t by = 0; by < view.bricks[1]; ++by)
            for (std::int32_t bx = 0; bx < view.bricks[0]; ++bx, ++dense)
                if (view.brickIndex[dense] >= 0) f(dense, bx, by, bz);
}

TEST(Sweeper, everyNodeIsWhatItIsAlone) {
    std::mt19937_64 g(test::seed());
    const auto base = test::enamelBlock(Vec3(-1.5, -1.5, -1.6), Vec3(1.5, 1.5, 1.6), 0.06);
    for (const char* name : kManyBurs) {
        const instrument::Bur bur = burOf(name);
        tooth::ToothState field(base);
        Sweeper sweeper(field, bur, core::simdLevel());
        // From the middle of the block, so that all of a short head is buried at times. Each pose alone: nothing
        // between them, so that the truth is a maximum over the poses.
        const std::vector<Pose> poses = walk(g, 40);
        for (const Pose& pose : poses) {
            if (sweeper.hasPose() && (pose.positionMm - sweeper.pose().positionMm).norm() > 0.005) sweeper.settle();
            ASSERT_EQ(sweeper.sweepTo(pose).poses, 1u) << name;
        }
        const field::FieldView view = field.field().view(), before = base->field.view();
        const double band = base->settings.bandMm, bandOut = base->bandOutMm;
        std::array<float, kBrickValues> uncut;
        double worst = 0.0;
        std::size_t changed = 0;
        std::int32_t dense = -1;
        for (std::int32_t bz = 0; bz < view.bricks[2]; ++bz)
            for (std::int32_t by = 0; by < view.bricks[1]; ++by)
                for (std::int32_t bx = 0; bx < view.bricks[0]; ++bx) {
                    ++dense;
                    if (before.brickIndex[dense] < 0 && before.coarse[dense] >= 0.0f) continue;  // outside
                    base->uncutBrick(static_cast<std::uint32_t>(dense), uncut.data());
                    // Not stored yet: then nothing may have risen in it.
                    const float* values =
                        view.brickIndex[dense] < 0
                            ? uncut.data()
                            : view.values + static_cast<std::size_t>(view.brickIndex[dense]) * kBrickValues;
                    for (int i = 0; i < kBrickValues; ++i) {
                        const Vec3 p(
                            view.originMm[0] + view.voxelMm * (kBrickCells * bx + i % kBrickNodes),
                            view.originMm[1] + view.voxelMm * (kBrickCells * by + i / kBrickNodes % kBrickNodes),
                            view.originMm[2] + view.voxelMm * (kBrickCells * bz + i / (kBrickNodes * kBrickNodes)));
                        const auto was = static_cast<double>(uncut[static_cast<std::size_t>(i)]);
                        double expected = was;
                        for (const Pose& pose : poses)
                            expected = std::max(expected,
                                                std::clamp(-bur.signedDistance(pose.applyInverse(p)), -band, bandOut));
                        changed += expected != was;
                        worst = std::max(worst, std::abs(expected - static_cast<double>(values[i])));
                    }
                }
        EXPECT_GT(changed, 1000u) << name;
        EXPECT_LT(worst, 2e-6) << name;  // float32 at some millimetres
    }
}

TEST(Sweeper, nodesThatBricksShareAreEqualToTheBitAtEveryInstructionSet) {
    std::mt19937_64 g(test::seed());
    const auto base = test::enamelBlock(Vec3(-1.5, -1.5, -1.6), Vec3(1.5, 1.5, 0), 0.05);
    for (const char* name : kManyBurs) {
        const instrument::Bur bur = burOf(name);
        const std::vector<Pose> poses = walk(g, 120);
        std::uint64_t hash = 0;
        tooth::TissueVolumes removed{};
        for (const core::SimdLevel level : {core::SimdLevel::base, core::SimdLevel::avx2, core::SimdLevel::avx512}) {
            if (level > core::simdLevel()) continue;
            tooth::ToothState field(base);
            Sweeper sweeper(field, bur, level);
            for (const Pose& pose : poses)
                sweeper.sweepTo(pose);
            sweeper.settle();
            if (level == core::SimdLevel::base) {
                hash = field.stateHash();
                removed = field.removedMm3();
                const field::FieldView view = field.field().view();
                std::size_t shared = 0, torn = 0;
                forStored(view, [&](std::int32_t dense, std::int32_t bx, std::int32_t by, std::int32_t bz) {
                    const float* mine = view.values + static_cast<std::size_t>(view.brickIndex[dense]) * kBrickValues;
                    for (int corner = 1; corner < 8; ++corner) {
                        const int step[3] = {corner & 1, corner >> 1 & 1, corner >> 2 & 1};
                        if (bx + step[0] >= view.bricks[0] || by + step[1] >= view.bricks[1] ||
                            bz + step[2] >= view.bricks[2])
                            continue;
                        const std::int32_t other =
                            view.brickIndex[dense + step[0] + view.bricks[0] * (step[1] + view.bricks[1] * step[2])];
                        if (other < 0) continue;
                        const float* theirs = view.values + static_cast<std::size_t>(other) * kBrickValues;
                        for (int i = 0; i < kBrickValues; ++i) {
                            const int n[3] = {i % kBrickNodes, i / kBrickNodes % kBrickNodes,
                                              i / (kBrickNodes * kBrickNodes)};
                            bool onFace = true;
                            int there = 0, stride = 1;
                            for (int k = 0; k < 3; ++k, stride *= kBrickNodes) {
                                onFace = onFace && (step[k] == 0 || n[k] == kBrickCells);
                                there += (step[k] == 0 ? n[k] : 0) * stride;
                            }
                            if (!onFace) continue;
                            ++shared;
                            torn += std::memcmp(&mine[i], &theirs[there], sizeof(float)) != 0;
                        }
                    }
                });
                EXPECT_GT(shared, 10000u);
                EXPECT_EQ(torn, 0u) << name;
            } else {
                EXPECT_EQ(field.stateHash(), hash) << name << " at level " << static_cast<int>(level);
                EXPECT_EQ(field.removedMm3(), removed) << name;
            }
        }
    }
}

TEST(Sweeper, whatIsCountedIsWhatTheFieldLostTissueByTissue) {
    std::mt19937_64 g(test::seed());
    const core::Box box{Vec3(-1.5, -1.5, -1.6), Vec3(1.5, 1.5, 0)};
    const auto uncut = test::phantom(box, 0.05, test::boxDistance(box));
    const field::TissueMap::PartFunction parts[] = {
        {[](const Vec3& p) { return (p - Vec3(0.2, 0.1, -0.3)).norm() - 0.6; }, Tissue::caries, 2},
        {[](const Vec3& p) { return p.z() + 0.5 + 0.2 * p.x(); }, Tissue::dentine, 1}};
    const auto base = tooth::withTissues(*uncut, field::TissueMap::fromFunctions(uncut->field, parts, Tissue::enamel));
    for (const char* name : {"cylinder-round:1.0x4.0", "inverted-cone:1.2x1.0"}) {
        tooth::ToothState field(base);
        Sweeper sweeper(field, burOf(name), core::simdLevel());
        tooth::TissueVolumes told{};
        std::vector<Pose> poses = walk(g, 200);
        for (int i = 0; i < 60; ++i)  // through all three, whatever the walk does
            poses.push_back(poseAt(Vec3(0.02 * i - 0.6, 0.05, -0.8)));
        for (const Pose& pose : poses) {
            const auto outcome = sweeper.sweepTo(pose);
            for (std::size_t t = 0; t < cases::kTissueCount; ++t)
                told[t] += outcome.removedMm3[t];
        }
        const tooth::TissueVolumes left = field.volumesMm3();
        for (const Tissue tissue : {Tissue::enamel, Tissue::dentine, Tissue::caries}) {
            const auto t = static_cast<std::size_t>(tissue);
            const double lost = base->volumesMm3[t] - left[t];
            EXPECT_GT(lost, 1e-3);
            EXPECT_NEAR(told[t], lost, 1e-9 * sumOf(told)) << name << " tissue " << t;
            EXPECT_DOUBLE_EQ(field.removedMm3()[t], told[t]);
        }
    }
}

TEST(Sweeper, aMetreASecondIsTheSameAsASlowHand) {
    const auto base = test::enamelBlock(Vec3(-2.2, -1.6, -1.6), Vec3(2.2, 1.6, 0), kVoxel);
    for (const char* name : {"cylinder-round:1.0x4.0", "cylinder-flat:1.0x4.0", "inverted-cone:1.2x1.0"}) {
        const instrument::Bur bur = burOf(name);
        const Pose from = poseAt(Vec3(-1.5, -0.3, -0.2)),
                   to = poseAt(Vec3(1.5, 0.3, -0.9), core::Quat(Eigen::AngleAxisd(0.35, Vec3(0.3, 1, 0).normalized())));
        tooth::ToothState fast(base), slow(base);
        Sweeper a(fast, bur, core::simdLevel()), b(slow, bur, core::simdLevel());
        sweepAlong(a, from, to, 1.05);
        sweepAlong(b, from, to, 0.002);
        const double fastMm3 = sumOf(fast.removedMm3()), slowMm3 = sumOf(slow.removedMm3());
        EXPECT_NEAR(fastMm3, slowMm3, 0.003 * slowMm3) << name;
        // Compared where the slow surface is.
        const field::FieldView view = slow.field().view();
        std::vector<double> errors;
        forStored(view, [&](std::int32_t dense, std::int32_t bx, std::int32_t by, std::int32_t bz) {
            const float* values = view.values + static_cast<std::size_t>(view.brickIndex[dense]) * kBrickValues;
            for (int i = 0; i < kBrickValues; ++i) {
                if (std::abs(values[i]) > 0.5f * static_cast<float>(kVoxel)) continue;
                const Vec3 p(view.originMm[0] + kVoxel * (kBrickCells * bx + i % kBrickNodes),
                             view.originMm[1] + kVoxel * (kBrickCells * by + i / kBrickNodes % kBrickNodes),
                             view.originMm[2] + kVoxel * (kBrickCells * bz + i / (kBrickNodes * kBrickNodes)));
                errors.push_back(std::abs(fast.field().distance(p) - static_cast<double>(values[i])));
            }
        });
        std::sort(errors.begin(), errors.end());
        ASSERT_GT(errors.size(), 1000u);
        std::printf("  %s: 1 mm against 2 um steps: p99 %.2f um, most %.2f um, volume %.3f %%\n", name,
                    1e3 * errors[errors.size() * 99 / 100], 1e3 * errors.back(), 100.0 * (fastMm3 / slowMm3 - 1.0));
        EXPECT_LE(errors[errors.size() * 99 / 100], 0.005) << name;
        EXPECT_LE(errors.back(), 0.2 * kVoxel) << name;
    }
}

TEST(Sweeper, alongItsAxisAStraightSideIsCutAtOnce) {
    const auto base = test::enamelBlock(Vec3(-1.6, -1.6, -2.2), Vec3(1.6, 1.6, 0), kVoxel);
    struct Way {
        const char* bur;
        double fromZ, toZ;
        std::uint32_t most;
    };
    // A wheel as thin as its way still leaves no ring standing.
    for (const Way& way : {Way{"cylinder-flat:1.0x4.0", -0.2, -1.2, 2}, Way{"cylinder-flat:1.0x4.0", -1.2, -0.7, 1},
                           Way{"wheel:2.0x0.8", 0.3, -1.3, 8}}) {
        const instrument::Bur bur = burOf(way.bur);
        tooth::ToothState once(base), slow(base);
        Sweeper a(once, bur, core::simdLevel()), b(slow, bur, core::simdLevel());
        const Pose from = poseAt(Vec3(0.01, 0.02, way.fromZ)), to = poseAt(Vec3(0.01, 0.02, way.toZ));
        a.sweepTo(from);
        const Sweeper::Outcome outcome = a.sweepTo(to);
        EXPECT_LE(outcome.poses, way.most) << way.bur;
        sweepAlong(b, from, to, 0.01);
        a.settle();
        b.settle();
        const double slowMm3 = sumOf(slow.removedMm3());
        EXPECT_NEAR(sumOf(once.removedMm3()), slowMm3, 1e-3 * slowMm3) << way.bur;
    }
}

TEST(Sweeper, hardlyAnyDepthIsLeftWhereTheBurHasBeen) {
    const auto base = test::enamelBlock(Vec3(-2.0, -1.6, -1.8), Vec3(2.0, 1.6, 0), kVoxel);
    for (const char* name : {"round:1.4x1.4", "cylinder-round:1.0x4.0", "pear:0.8x1.5", "cylinder-flat:1.0x4.0",
                             "wheel:2.0x0.8", "inverted-cone:1.2x1.0"}) {
        const instrument::Bur bur = burOf(name);
        tooth::ToothState field(base);
        Sweeper sweeper(field, bur, core::simdLevel());
        const core::Quat tilt(Eigen::AngleAxisd(0.26, Vec3(1, 0.3, 0).normalized()));
        double clear = 0.0, rim = 0.0;
        const auto& pieces = bur.profile().pieces;
        std::vector<Vec2> corners;
        if (instrument::inwardNormalAt(pieces[0], 0.0).x() < -1e-3) corners.push_back(pieces[0].from);  // a pointed tip
        for (std::size_t i = 0; i + 1 < pieces.size(); ++i)
            if (instrument::jointBetween(pieces[i], pieces[i + 1]) == instrument::Joint::convex)
                corners.push_back(pieces[i].to);
        for (int i = 0; i < 60; ++i) {
            const Pose pose = poseAt(Vec3(-0.6 + 0.02 * i, 0.01 * i - 0.3, -0.6), tilt);
            sweeper.sweepTo(pose);
            for (const instrument::SurfaceRing& ring : bur.rings()) {
                double toCorner = std::numeric_limits<double>::infinity();
                for (const Vec2& c : corners)
                    toCorner = std::min(toCorner, (c - Vec2(ring.rhoMm, ring.zMm)).norm());
                for (std::uint32_t j = 0; j < ring.count; ++j) {
                    const double a = 2.0 * kPi * (j + 0.5) / ring.count;
                    const double left = -field.field().distance(
                        pose.apply(Vec3(ring.rhoMm * std::cos(a), ring.rhoMm * std::sin(a), ring.zMm)));
                    (toCorner <= kVoxel ? rim : clear) = std::max(toCorner <= kVoxel ? rim : clear, left);
                }
            }
        }
        std::printf("  %s: depth left %.2f um, within a voxel of a rim %.3f voxels\n", name, 1e3 * clear, rim / kVoxel);
        const bool acute = std::string_view(name).starts_with("inverted");  // a rim of 70 degrees
        EXPECT_LE(clear, acute ? 0.003 : 0.002) << name;
        EXPECT_LE(rim, (acute ? 0.4 : 0.35) * kVoxel) << name;
    }
}

TEST(Sweeper, theInsideOfACutIsAsDeepAsTheCutSolid) {
    const auto base = test::enamelBlock(Vec3(-1.6, -1.6, -2.2), Vec3(1.6, 1.6, 0), kVoxel);
    const instrument::Bur bur = burOf("round:1.4x1.4");
    tooth::ToothState field(base);
    Sweeper sweeper(field, bur, core::simdLevel());
    const double depth = 1.2, radius = 0.7;
    sweepAlong(sweeper, poseAt(Vec3(0, 0, 0.3)), poseAt(Vec3(0, 0, -depth)), 0.005);
    sweeper.settle();
    std::mt19937_64 g(test::seed());
    const double band = base->settings.bandMm;
    std::vector<double> errors;
    int deep = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3 p(test::uniform(g, -1.5, 1.5), test::uniform(g, -1.5, 1.5), test::uniform(g, -2.1, -0.1));
        // Distance to the hole (a capsule up to the top) and to the block's own faces.
        const double toAxis = (p - Vec3(0, 0, std::max(p.z(), -depth + radius))).norm() - radius;
        const double toFaces = std::min({1.6 - std::abs(p.x()), 1.6 - std::abs(p.y()), -p.z(), p.z() + 2.2});
        const double inside = std::min(toAxis, toFaces), told = -field.field().distance(p);
        if (inside > 0.0 && inside < band - 2.0 * kVoxel) {
            errors.push_back(std::abs(told - inside));
        } else if (inside > band) {
            EXPECT_GT(told, 0.0);
            EXPECT_LE(told, inside + 0.5 * kBrickCells * kVoxel + 1e-3) << "a bound";
            ++deep;
        }
    }
    std::sort(errors.begin(), errors.end());
    ASSERT_GT(errors.size(), 500u);
    EXPECT_LE(errors[errors.size() * 9 / 10], 0.002);
    EXPECT_LE(errors.back(), 0.25 * kVoxel);  // as near to the hole as to a face, where the field has a kink
    EXPECT_GT(deep, 500);
}

TEST(Sweeper, takesNoMemoryInTheTick) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc";
    tooth::ToothState field(test::enamelBlock(Vec3(-1.5, -1.5, -1.6), Vec3(1.5, 1.5, 0), kVoxel));
    Sweeper sweeper(field, burOf("cylinder-flat:1.0x4.0"), core::simdLevel());
    std::mt19937_64 g(test::seed());
    const std::vector<Pose> poses = walk(g, 50);
    const test::RealtimeTrap trap;
    for (const Pose& pose : poses)
        sweeper.sweepTo(pose);
    sweeper.settle();
    EXPECT_EQ(trap.total(), 0u);
}

}  // namespace
}  // namespace handpiece::cutting::sweeper_test
