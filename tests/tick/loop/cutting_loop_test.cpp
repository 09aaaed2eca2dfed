// SPDX-License-Identifier: Apache-2.0
// The whole tick on teeth in closed form: a hand that presses, a rotor that turns, a field that gives way.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "support/closed_meshes.h"
#include "support/realtime_trap.h"

namespace handpiece::loop::cutting_loop_test {
namespace {

using cases::Tissue;
using core::Pose;
using core::Quat;
using core::Vec3;
using messages::HapticSample;

constexpr double kEdge = 4.0;  // of the block; its top is at z = 0

std::shared_ptr<const tooth::ToothModel> block(const std::vector<field::TissueMap::PartFunction>& parts,
                                               double voxelMm = 0.05) {
    cases::Case made;
    made.name = "block";
    made.outer = test::boxMesh(Vec3(-kEdge / 2, -kEdge / 2, -kEdge / 2), Vec3(kEdge / 2, kEdge / 2, 0.0));
    tooth::LoadSettings settings;
    settings.useCache = false;
    settings.field.voxelMm = voxelMm;
    auto uncut = tooth::loadModel(made, settings);
    field::TissueMap tissues = field::TissueMap::fromFunctions(uncut->field, parts, Tissue::enamel);
    return tooth::withTissues(*uncut, std::move(tissues));
}

Pose at(double x, double y, double z) {
    return {Vec3(x, y, z), Quat::Identity()};
}

struct Bench {
    explicit Bench(std::shared_ptr<const tooth::ToothModel> base, const char* burName = "cylinder-flat:1.0x3.0",
                   bool fullRemoval = false)
        : field(std::make_shared<tooth::ToothState>(std::move(base))), full(fullRemoval) {
        bur = std::make_shared<const instrument::Bur>(instrument::makeBur(burName));
    }
    [[nodiscard]] Work work() const {
        return {contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
                std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{}, cases::builtInTissues(),
                                                  cutting::Cutter::Settings{full})};
    }
    [[nodiscard]] std::unique_ptr<HapticLoop> loop(std::vector<device::TimedPose> poses, bool rigid = true,
                                                   double rateHz = 1000, const instrument::Drive& drive = {}) const {
        device::SimulatedDeviceSettings settings;
        settings.rigidHand = rigid;
        LoopSettings loopSettings;
        loopSettings.rateHz = rateHz;
        return std::make_unique<HapticLoop>(
            loopSettings, std::make_unique<device::SimulatedDevice>(settings, device::Motion(std::move(poses))), work(),
            force::defaultParameters(), drive);
    }
    std::shared_ptr<tooth::ToothState> field;
    std::shared_ptr<const instrument::Bur> bur;
    bool full;
};

/// Down at 2 mm/s to `depth` below the top, `dwell` seconds there, up again; the pedal is let go at the end.
std::vector<device::TimedPose> plungeTo(double depth, double dwell, double pedal, double x = 0.0) {
    const double spin = 1.0, down = (depth + 0.2) / 2.0;
    return {{0.0, at(x, 0, 0.2), pedal},
            {spin, at(x, 0, 0.2), pedal},
            {spin + down, at(x, 0, -depth), pedal},
            {spin + down + dwell, at(x, 0, -depth), pedal},
            {spin + 2 * down + dwell, at(x, 0, 0.2), pedal},
            {spin + 2 * down + dwell + 0.001, at(x, 0, 0.2), 0.0},
            {spin + 2 * down + dwell + 0.5, at(x, 0, 0.2), 0.0}};
}

double seconds(const std::vector<device::TimedPose>& poses) {
    return poses.back().timeS;
}

TEST(CuttingLoop, aTurningBurSinksInAndTheTurbineFeelsIt) {
    const Bench bench(block({}));
    const auto poses = plungeTo(1.0, 12.0, 1.0);
    auto loop = bench.loop(poses);
    double worstDroop = 0, largestTorque = 0, deepestProxy = 0, peakN = 0;
    HapticSample last;
    (void)runSimulated(*loop, seconds(poses), [&](const HapticSample& s) {
        // Slow against the rotor's 0.35 s: its speed is that of the load's torque on the line from stall to free.
        if (s.timeS > 4.0 && (s.flags & messages::kCutting) != 0)
            worstDroop = std::max(worstDroop, std::abs(s.speedRpm - 400000.0 * (1.0 - s.loadTorqueNmm / 1.2)));
        largestTorque = std::max(largestTorque, s.loadTorqueNmm);
        deepestProxy = std::min(deepestProxy, s.proxyPositionMm[2]);
        peakN = std::max(peakN, std::abs(s.forceN[2]));
        last = s;
    });
    std::printf("  sinks %.4f mm, torque up to %.4f N mm, peak %.3f N\n", -deepestProxy, largestTorque, peakN);
    EXPECT_GT(largestTorque, 0.01);
    EXPECT_LT(worstDroop, 0.005 * 400000);
    // What is left of 1 mm after 12 s at 0.5 N/mm: the load falls with it.
    EXPECT_GT(-deepestProxy, 0.9);
    EXPECT_LT(-deepestProxy, 1.0 + 0.01);
    const double volume = 0.25 * M_PI * -deepestProxy;
    EXPECT_NEAR(last.removedMm3[static_cast<std::size_t>(Tissue::enamel)], volume, 0.02 * volume);
}

TEST(CuttingLoop, aStillBurCutsNothing) {
    const Bench bench(block({}));
    const auto poses = plungeTo(1.0, 0.5, 0.0);
    auto loop = bench.loop(poses);
    const std::uint64_t before = bench.field->stateHash();
    (void)runSimulated(*loop, seconds(poses), [&](const HapticSample& s) {
        ASSERT_EQ(s.flags & messages::kCutting, 0u);
        ASSERT_EQ(s.speedRpm, 0.0);
    });
    EXPECT_EQ(bench.field->stateHash(), before);
}

TEST(CuttingLoop, counterAndFieldBalanceByTissue) {
    const double floor = -0.4;
    const auto base = block({{[floor](const Vec3& p) { return p.z() - floor; }, Tissue::dentine, 20}});
    const Bench bench(base, "cylinder-round:1.0x3.0");
    const auto poses = plungeTo(1.0, 4.0, 1.0);
    auto loop = bench.loop(poses);
    HapticSample last;
    (void)runSimulated(*loop, seconds(poses), [&](const HapticSample& s) { last = s; });
    const tooth::TissueVolumes left = bench.field->volumesMm3();
    for (const Tissue t : {Tissue::enamel, Tissue::dentine}) {
        const auto i = static_cast<std::size_t>(t);
        EXPECT_GT(last.removedMm3[i], 0.05);
        EXPECT_NEAR(last.removedMm3[i], base->volumesMm3[i] - left[i], 1e-9 * base->volumesMm3[i]);
    }
}

TEST(CuttingLoop, removalIsTheSameAtEveryRateAndVoxel) {
    double reference = 0.0;
    for (const double voxel : {0.05, 0.1, 0.025}) {
        const auto base = block({}, voxel);
        for (const double rate : {1000.0, 8000.0}) {
            if (voxel != 0.05 && rate != 1000.0) continue;
            const Bench bench(base, "cylinder-round:1.0x3.0");
            const auto poses = plungeTo(0.8, 1.5, 1.0);
            auto loop = bench.loop(poses, true, rate);
            HapticSample last;
            (void)runSimulated(*loop, seconds(poses), [&](const HapticSample& s) { last = s; });
            const double removed = last.removedMm3[static_cast<std::size_t>(Tissue::enamel)];
            if (reference == 0.0) reference = removed;
            std::printf("  %3.0f um, %.0f Hz: %.5f mm3\n", 1e3 * voxel, rate, removed);
            EXPECT_NEAR(removed, reference, 0.05 * reference);
        }
    }
}

TEST(CuttingLoop, aboveTwoKilohertzTheCutTakesItsTurn) {
    const auto base = block({});
    for (const int every : {1, 2, 4}) {
        const Bench bench(base, "cylinder-round:1.0x3.0");
        const auto poses = plungeTo(0.5, 0.1, 1.0);
        auto loop = bench.loop(poses, true, 2000.0 * every);
        std::uint64_t last = 0, cuts = 0, apart = 0, told = 0;
        double before = 0.0;
        (void)runSimulated(*loop, seconds(poses), [&](const HapticSample& s) {
            told += (s.flags & messages::kCutting) != 0;
            const double removed = s.removedMm3[static_cast<std::size_t>(Tissue::enamel)];
            if (removed == before) return;
            before = removed;
            apart += cuts++ > 0 && (s.tick - last) % static_cast<std::uint64_t>(every) != 0;
            last = s.tick;
        });
        EXPECT_GT(cuts, 200u) << every;
        EXPECT_EQ(apart, 0u) << every;
        EXPECT_GE(told, cuts * static_cast<std::uint64_t>(every)) << "it is cutting in the ticks between as well";
    }
}

TEST(CuttingLoop, undoPutsTheToothBackAndNoForceRoundTheBur) {
    const Bench bench(block({}));
    const tooth::StateDelta uncut = bench.field->state();
    const std::uint64_t uncutHash = bench.field->stateHash();
    // In, cut, and stay in the hole with the pedal up while the hole is filled again.
    const std::vector<device::TimedPose> poses{{0.0, at(0, 0, 0.2), 1.0},    {0.8, at(0, 0, 0.2), 1.0},
                                               {1.6, at(0, 0, -1.0), 1.0},   {6.0, at(0, 0, -1.0), 1.0},
                                               {6.001, at(0, 0, -1.0), 0.0}, {7.0, at(0, 0, -1.0), 0.0},
                                               {7.5, at(0, 0, 0.5), 0.0},    {8.0, at(0, 0, 0.5), 0.0},
                                               {8.5, at(0, 0, -0.6), 0.0},   {9.5, at(0, 0, -0.6), 0.0}};
    auto loop = bench.loop(poses);
    (void)runSimulated(*loop, 6.5);
    const tooth::StateDelta cut = bench.field->state();
    ASSERT_FALSE(cut.bricks.empty());
    EXPECT_NE(bench.field->stateHash(), uncutHash);
    tooth::StateDelta change;
    for (tooth::StateDelta::Brick brick : cut.bricks) {
        brick.uncut = true;
        change.bricks.push_back(brick);
    }
    const std::uint64_t number = loop->restore(std::move(change));
    EXPECT_THROW((void)loop->restore(tooth::StateDelta{}), core::Error);
    bool waited = false, felt = false;
    double worstWaiting = 0.0, last = 0.0;
    int restoring = 0;
    (void)runSimulated(*loop, 3.0, [&](const HapticSample& s) {
        EXPECT_EQ(s.lastCommand, number);
        restoring += (s.flags & messages::kRestoring) != 0;
        if ((s.flags & messages::kWaiting) != 0) {
            waited = true;
            if (s.timeS > 6.6) worstWaiting = std::max(worstWaiting, std::abs(s.forceN[2]));
        }
        felt = felt || (s.timeS > 8.0 && s.forceN[2] > 0.1);
        last = s.forceN[2];
    });
    EXPECT_GT(restoring, 0);
    EXPECT_TRUE(waited);
    EXPECT_EQ(worstWaiting, 0.0);
    EXPECT_TRUE(felt);
    EXPECT_NEAR(last, 0.5 * 0.6, 0.01);  // the whole surface, felt again
    EXPECT_EQ(bench.field->stateHash(), uncutHash);
    EXPECT_EQ(bench.field->removedMm3(), uncut.removedMm3.own);
}

TEST(CuttingLoop, theForceIsSmoothWhileCutting) {
    // On the path exactly: in, along at 1 mm/s, back deeper at 2 mm/s, and skimming at 5 mm/s.
    const std::vector<device::TimedPose> poses{
        {0.0, at(-1.2, 0, 0.2), 1.0},    {0.8, at(-1.2, 0, 0.2), 1.0},     {2.8, at(-1.2, 0, -0.4), 1.0},
        {5.2, at(1.2, 0, -0.4), 1.0},    {5.4, at(1.2, 0, -0.5), 1.0},     {6.6, at(-1.2, 0.05, -0.5), 1.0},
        {6.9, at(-1.2, 0.6, 0.05), 1.0}, {7.0, at(-1.2, 0.6, -0.15), 1.0}, {7.48, at(1.2, 0.6, -0.15), 1.0}};
    const auto base = block({});
    for (const char* bur : {"cylinder-round:1.0x3.0", "330"}) {
        const Bench bench(base, bur);
        auto loop = bench.loop(poses);
        Vec3 last = Vec3::Zero();
        double worst = 0.0, when = 0.0;
        (void)runSimulated(*loop, seconds(poses), [&](const HapticSample& s) {
            const Vec3 f(s.forceN[0], s.forceN[1], s.forceN[2]);
            if ((f - last).norm() > worst) {
                worst = (f - last).norm();
                when = s.timeS;
            }
            last = f;
        });
        std::printf("  %s: the force changes by %.4f N from tick to tick at worst, at %.3f s\n", bur, worst, when);
        EXPECT_LE(worst, 0.005) << bur;
    }
}

/// Largest deviation of the force from a cubic in time, as a share of its mean, in the last `spanS` of a path.
double cogging(HapticLoop& loop, double endS, double spanS) {
    std::vector<Eigen::Vector4d> powers;
    std::vector<double> forceN;
    (void)runSimulated(loop, endS, [&](const HapticSample& s) {
        const double t = (s.timeS - (endS - spanS)) / spanS;
        if (t < 0.0) return;
        powers.push_back({1.0, t, t * t, t * t * t});
        forceN.push_back(Vec3(s.forceN[0], s.forceN[1], s.forceN[2]).norm());
    });
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double sum = 0.0;
    for (std::size_t i = 0; i < powers.size(); ++i) {
        normal += powers[i] * powers[i].transpose();
        right += forceN[i] * powers[i];
        sum += forceN[i];
    }
    const Eigen::Vector4d fit = normal.ldlt().solve(right);
    double worst = 0.0;
    for (std::size_t i = 0; i < powers.size(); ++i)
        worst = std::max(worst, std::abs(forceN[i] - fit.dot(powers[i])));
    return worst / (sum / static_cast<double>(powers.size()));
}

TEST(CuttingLoop, theForceDoesNotCogWithTheVoxels) {
    // Ten voxels deep at 0.3 mm/s, and forty along at 1 mm/s, once the force is steady.
    const std::vector<device::TimedPose> plunge{
        {0.0, at(0.013, 0.007, 0.02), 1.0}, {1.5, at(0.013, 0.007, 0.02), 1.0}, {5.5, at(0.013, 0.007, -1.18), 1.0}};
    const std::vector<device::TimedPose> groove{{0.0, at(-1.75, 0.007, 0.02), 1.0},
                                                {1.5, at(-1.75, 0.007, 0.02), 1.0},
                                                {2.5, at(-1.75, 0.007, -0.2), 1.0},
                                                {3.5, at(-1.75, 0.007, -0.2), 1.0},
                                                {6.7, at(1.45, 0.007, -0.2), 1.0}};  // not to the block's end
    const auto enamel = block({});
    const auto dentine = block({{[](const Vec3&) { return -1.0; }, Tissue::dentine, 20}});
    for (const auto& [name, base] : {std::pair{"enamel", enamel}, std::pair{"dentine", dentine}})
        for (const char* bur : {"round-4", "cylinder-flat:1.0x3.0", "330"}) {
            const Bench down(base, bur), along(base, bur);
            const double deeper = cogging(*down.loop(plunge), seconds(plunge), 0.5 / 0.3);
            const double farther = cogging(*along.loop(groove), seconds(groove), 1.7);
            std::printf("  %s in %s: %.2f %% going in, %.2f %% along\n", bur, name, 100 * deeper, 100 * farther);
            EXPECT_LE(deeper, 0.01) << bur << " in " << name;
            EXPECT_LE(farther, 0.01) << bur << " in " << name;
        }
}

TEST(CuttingLoop, aFlatEndSinksOnWhileItCutsSideways) {
    // Between the floor and the wall ahead a rim is held by each as it stands, not by one between them: that lifts it.
    const auto dentine = block({{[](const Vec3&) { return -1.0; }, Tissue::dentine, 20}});
    const std::vector<device::TimedPose> groove{{0.0, at(-1.75, 0.007, 0.02), 1.0},
                                                {1.5, at(-1.75, 0.007, 0.02), 1.0},
                                                {2.5, at(-1.75, 0.007, -0.2), 1.0},
                                                {5.7, at(1.45, 0.007, -0.2), 1.0}};
    const Bench bench(dentine, "cylinder-flat:1.0x3.0");
    auto loop = bench.loop(groove);
    double lowest = 0.0, highestAbove = 0.0;
    (void)runSimulated(*loop, seconds(groove), [&](const HapticSample& s) {
        if (s.timeS < 2.6) return;
        lowest = std::min(lowest, s.proxyPositionMm[2]);
        highestAbove = std::max(highestAbove, s.proxyPositionMm[2] - lowest);
    });
    std::printf("  floor at %.4f mm, never more than %.2f um above what it had reached\n", lowest, 1e3 * highestAbove);
    EXPECT_LT(lowest, -0.1995);
    EXPECT_LT(highestAbove, 0.006);
}

TEST(CuttingLoop, aSharpRimBearsAndCutsOnASlope) {
    // Flat ends tilted against the block: the rim alone touches.
    const auto base = block({});
    for (const char* bur : {"cylinder-flat:1.0x3.0", "inverted-cone:1.0x1.0", "taper-flat:1.0x3.0"}) {
        const Bench bench(base, bur);
        const Quat tilt(Eigen::AngleAxisd(0.3, Vec3::UnitY()));
        const auto pose = [&](double z) { return Pose{Vec3(0.1, 0.0, z), tilt}; };
        const std::vector<device::TimedPose> poses{
            {0.0, pose(0.6), 1.0}, {1.0, pose(0.6), 1.0}, {2.0, pose(-0.1), 1.0}, {4.0, pose(-0.1), 1.0}};
        auto loop = bench.loop(poses);
        HapticSample last;
        double largestArea = 0.0;
        (void)runSimulated(*loop, 4.0, [&](const HapticSample& s) {
            largestArea = std::max(largestArea, s.contactAreaMm2);
            last = s;
        });
        EXPECT_GT(largestArea, 0.0) << bur;
        EXPECT_GT(last.removedMm3[static_cast<std::size_t>(Tissue::enamel)], 0.01) << bur;
    }
}

TEST(CuttingLoop, aWeakTurbineStallsAndRecovers) {
    instrument::Drive weak;
    weak.stallTorqueNmm = 0.02;
    const Bench bench(block({}), "cylinder-flat:1.0x3.0");
    const auto poses = plungeTo(1.5, 1.0, 1.0);
    auto loop = bench.loop(poses, true, 1000, weak);
    bool stalled = false;
    double after = 0.0;
    (void)runSimulated(*loop, seconds(poses) + 2.0, [&](const HapticSample& s) {
        stalled = stalled || (s.flags & messages::kStalled) != 0;
        if (stalled && s.pedal > 0.0 && s.proxyPositionMm[2] > 0.1) after = std::max(after, s.speedRpm);
    });
    EXPECT_TRUE(stalled);
    EXPECT_GT(after, 0.0);
}

TEST(CuttingLoop, theTickNeitherAllocatesNorLocksNorWaitsWhileItCuts) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    const Bench bench(block({}));
    auto loop = bench.loop(plungeTo(1.0, 0.2, 1.0));
    loop->tick({});
    const test::RealtimeTrap trap;
    for (int i = 0; i < 2000; ++i)
        loop->tick({});
    EXPECT_EQ(trap.total(), 0u);
    EXPECT_GT(bench.field->removedMm3()[static_cast<std::size_t>(Tissue::enamel)], 0.0);
}

TEST(CuttingLoop, sameInputsSameTooth) {
    const auto base = block({{[](const Vec3& p) { return p.z() + 0.3; }, Tissue::dentine, 20}});
    std::uint64_t first = 0;
    for (int run = 0; run < 2; ++run) {
        const Bench bench(base, "330");
        const auto poses = plungeTo(0.8, 1.0, 1.0, 0.013);
        auto loop = bench.loop(poses, false);
        tooth::ToothMirror mirror(base);
        HapticSample last;
        (void)runSimulated(
            *loop, seconds(poses), [&](const HapticSample& s) { last = s; },
            [&](const tooth::BrickSnapshot& b) { mirror.apply(b); });
        if (run == 0) first = bench.field->stateHash();
        EXPECT_EQ(bench.field->stateHash(), first);
        // Those who only hear of bricks know the same tooth.
        EXPECT_EQ(last.waitingBricks, 0u);
        EXPECT_EQ(tooth::stateHash(mirror.state(last.removedMm3)), first);
    }
}

}  // namespace
}  // namespace handpiece::loop::cutting_loop_test
