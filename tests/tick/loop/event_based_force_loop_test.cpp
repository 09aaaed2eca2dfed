// SPDX-License-Identifier: Apache-2.0
// The whole tick with the knock and the hum switched on: felt, and nothing else.
#include <gtest/gtest.h>

#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/passivity.h"
#include "studies/shaped_device.h"
#include "support/closed_meshes.h"
#include "support/realtime_trap.h"

namespace handpiece::loop::event_based_force_loop_test {
namespace {

using core::Pose;
using core::Quat;
using core::Vec3;
using messages::HapticSample;

std::shared_ptr<const tooth::ToothModel> block() {
    cases::Case made;
    made.name = "block";
    made.outer = test::boxMesh(Vec3(-1.5, -1.5, -1.5), Vec3(1.5, 1.5, 0.0));
    tooth::LoadSettings settings;
    settings.useCache = false;
    auto uncut = tooth::loadModel(made, settings);
    const std::vector<field::TissueMap::PartFunction> parts{
        {[](const Vec3& p) { return p.z() + 0.2; }, cases::Tissue::dentine, 20}};
    auto tissues = field::TissueMap::fromFunctions(uncut->field, parts, cases::Tissue::enamel);
    return tooth::withTissues(*uncut, std::move(tissues));
}

force::Parameters parameters(bool crisp) {
    force::Parameters p = force::defaultParameters();
    p.transients.on = p.vibration.on = crisp;
    return p;
}

/// A hand that nothing moves strikes the block, cuts into it for a second and goes.
struct Bench {
    Bench(std::shared_ptr<const tooth::ToothModel> base, bool crisp, double rateHz)
        : field(std::make_shared<tooth::ToothState>(std::move(base))) {
        const auto at = [](double z) { return Pose{Vec3(0, 0, z), Quat::Identity()}; };
        const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("cylinder-round:1.0x3.0"));
        device::SimulatedDeviceSettings hand;
        hand.rigidHand = true;
        LoopSettings settings;
        settings.rateHz = rateHz;
        std::vector<device::TimedPose> motion{{0.0, at(0.5), 1.0},  {0.5, at(0.5), 1.0}, {0.52, at(-0.5), 1.0},
                                              {1.2, at(-1.0), 1.0}, {1.3, at(1.0), 0.0}, {1.4, at(1.0), 0.0}};
        Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
                  std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{},
                                                    cases::builtInTissues(), cutting::Cutter::Settings{})};
        loop = std::make_unique<HapticLoop>(
            settings, std::make_unique<device::SimulatedDevice>(hand, device::Motion(std::move(motion))),
            std::move(work), parameters(crisp));
    }
    std::shared_ptr<tooth::ToothState> field;
    std::unique_ptr<HapticLoop> loop;
};

TEST(EventBasedForceLoop, whatIsAddedIsFeltAndCutsNothing) {
    const auto base = block();
    for (const double rate : {1000.0, 4000.0}) {
        Bench off(base, false, rate), on(base, true, rate), again(base, true, rate);
        std::vector<HapticSample> plain, crisp, twice;
        (void)runSimulated(*off.loop, 1.4, [&](const HapticSample& s) { plain.push_back(s); });
        (void)runSimulated(*on.loop, 1.4, [&](const HapticSample& s) { crisp.push_back(s); });
        (void)runSimulated(*again.loop, 1.4, [&](const HapticSample& s) { twice.push_back(s); });
        ASSERT_EQ(plain.size(), crisp.size());
        double mostAdded = 0.0, atTheEnd = 0.0;
        for (std::size_t i = 0; i < plain.size(); ++i) {
            ASSERT_EQ(plain[i].removedMm3, crisp[i].removedMm3) << i;
            ASSERT_EQ(plain[i].proxyPositionMm, crisp[i].proxyPositionMm) << i;
            ASSERT_EQ(plain[i].speedRpm, crisp[i].speedRpm) << i;
            ASSERT_EQ(plain[i].torqueNmm, crisp[i].torqueNmm) << i;
            ASSERT_EQ(crisp[i].forceN, twice[i].forceN) << i;
            ASSERT_EQ(crisp[i].forceN, crisp[i].appliedForceN) << i;  // told is what was commanded
            const Vec3 with(crisp[i].forceN.data()), without(plain[i].forceN.data());
            ASSERT_LE(with.norm(), 3.3 + 1e-9);
            mostAdded = std::max(mostAdded, (with - without).norm());
            atTheEnd = (with - without).norm();
        }
        EXPECT_EQ(off.field->stateHash(), on.field->stateHash()) << rate;
        EXPECT_GT(plain.back().removedMm3[1], 0.01);
        EXPECT_GT(mostAdded, 0.1) << rate;
        EXPECT_LT(atTheEnd, 0.01) << rate;
    }
}

TEST(EventBasedForceLoop, theTickNeitherAllocatesNorLocksNorWaitsWithIt) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    Bench bench(block(), true, 1000);
    bench.loop->tick({});
    const test::RealtimeTrap trap;
    double most = 0.0;
    for (int i = 0; i < 900; ++i) {
        bench.loop->tick({});
        most = std::max(most, bench.loop->device().appliedForceN().norm());
    }
    EXPECT_EQ(trap.total(), 0u);
    EXPECT_GT(most, 0.1);
}

class Shaken final : public device::PassingDevice {
  public:
    Shaken(std::unique_ptr<device::Device> device, double& amplitudeN)
        : PassingDevice(std::move(device)), amplitudeN_(amplitudeN) {}
    void vibrate(double amplitudeN) noexcept override { amplitudeN_ = amplitudeN; }

  private:
    double& amplitudeN_;
};

TEST(EventBasedForceLoop, theHumReachesADeviceBehindAShaper) {
    const device::SimulatedDeviceSettings hand;
    double amplitudeN = 0.0;
    auto arm = std::make_unique<device::SimulatedDevice>(hand, device::Motion({{0.0, Pose{}, 0.0}}));
    studies::ShapedDevice shaped(std::make_unique<Shaken>(std::move(arm), amplitudeN),
                                 studies::shaperSettingsFor(hand.capability));
    shaped.vibrate(0.25);
    EXPECT_EQ(amplitudeN, 0.25);
}

TEST(EventBasedForceLoop, theKnockLeavesTheLoopPassiveAndAtRest) {
    studies::PassivitySweep sweep;
    sweep.frictionN = {0.05};
    sweep.delayS = {0.0, 0.001};
    sweep.tissues = {cases::Tissue::enamel, cases::Tissue::dentine, cases::Tissue::gum};
    sweep.rateHz = {1000, 4000};
    sweep.parameters = parameters(true);
    for (const studies::PassivityRow& row : studies::passivityMap(sweep)) {
        EXPECT_TRUE(row.holds) << row.hand << " " << static_cast<int>(row.tissue) << " " << row.rateHz << " Hz, delay "
                               << row.delayS << ": " << row.marginNmm;
        EXPECT_FALSE(row.growing);
    }
}

}  // namespace
}  // namespace handpiece::loop::event_based_force_loop_test
