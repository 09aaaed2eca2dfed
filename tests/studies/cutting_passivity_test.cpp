// SPDX-License-Identifier: Apache-2.0
// The closed loop of hand, device and tooth while the bur cuts, on a flat block and wedged in a groove: the device does
// no more work on the hand than the passivity bound of the touching loop allows.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "handpiece/base/core/parallel.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "tick/force/prism_tooth.h"

namespace handpiece::studies::cutting_passivity_test {
namespace {

using cases::Tissue;
using core::Quat;
using core::Vec3;

struct Row {
    const device::Hand* hand;
    double frictionN, delayS, rateHz;
    Tissue tissue;
    bool wedged;
    double marginNmm = 0, removedMm3 = 0, rippleN = 0;
};

std::shared_ptr<const tooth::ToothModel> cuttable(const std::shared_ptr<const tooth::ToothModel>& uncut,
                                                  Tissue tissue) {
    return tooth::withTissues(*uncut, field::TissueMap::uniform(uncut->field, tissue));
}

void simulate(const std::shared_ptr<const tooth::ToothModel>& base, const std::shared_ptr<const instrument::Bur>& bur,
              Row& row) {
    const auto field = std::make_shared<tooth::ToothState>(base);
    loop::Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
                    std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{},
                                                      cases::builtInTissues(), cutting::Cutter::Settings{})};
    device::SimulatedDeviceSettings settings;
    settings.frictionN = row.frictionN;
    settings.delayS = row.delayS;
    settings.hand = *row.hand;
    force::Parameters parameters = force::defaultParameters();
    parameters.cuttingForceMultiplier = 0.0;  // the turbine's own work on the hand is no matter of stability
    const double k = 0.5 * parameters.tissues[static_cast<std::size_t>(row.tissue)].stiffnessFraction;
    const double b = parameters.tissues[static_cast<std::size_t>(row.tissue)].dampingNSPerMm;
    const double press = 1.0 / row.hand->stiffnessNPerMm + 1.0 / k;
    // The flat block's top is at 0; in the groove of 60 degrees the bur's tip comes to rest at 0.5.
    const double touch = row.wedged ? 0.5 : 0.0;
    const Vec3 above(0.0, 0.0, touch + 0.3), aim(0.15, 0.0, touch - press);
    const std::vector<device::TimedPose> poses{{0.0, {above, Quat::Identity()}, 1.0},
                                               {0.5, {above, Quat::Identity()}, 1.0},
                                               {0.5 + press / 60.0, {aim, Quat::Identity()}, 1.0},
                                               {2.0, {aim, Quat::Identity()}, 1.0}};
    auto owned = std::make_unique<device::SimulatedDevice>(settings, device::Motion(poses));
    const device::SimulatedDevice& arm = *owned;
    loop::LoopSettings loopSettings;
    loopSettings.rateHz = row.rateHz;
    loop::HapticLoop loop(loopSettings, std::move(owned), std::move(work), parameters);
    const double period = loop.periodS(), delta = settings.capability.encoderStepMm;
    const double activity = std::max(0.0, k * (0.5 * period + row.delayS) - b);
    double motionSum = 0.0, low = 1e9, high = -1e9;
    Vec3 last = Vec3::Zero();
    row.marginNmm = 1e9;
    (void)runSimulated(loop, poses.back().timeS, [&](const messages::HapticSample& s) {
        const Vec3 x(s.truePositionMm[0], s.truePositionMm[1], s.truePositionMm[2]);
        if (s.tick > 0) motionSum += (x - last).squaredNorm() / period;
        last = x;
        if (arm.forceVariationN() == 0.0) return;
        row.marginNmm =
            std::min(row.marginNmm, 0.5 * delta * arm.forceVariationN() + activity * motionSum - arm.appliedWorkNmm());
        row.removedMm3 = s.removedMm3[static_cast<std::size_t>(row.tissue)];
        if (s.timeS > 1.5) {
            low = std::min(low, s.forceN[2]);
            high = std::max(high, s.forceN[2]);
        }
    });
    row.rippleN = high - low;
}

TEST(CuttingPassivity, cuttingAndWedgedTheLoopStaysPassive) {
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("cylinder-round:1.0x3.0"));
    const auto flat = test::prismTooth({{-1.6, -1.8}, {1.6, -1.8}, {1.6, 0}, {-1.6, 0}}, 1.5, 0.05);
    const auto groove = test::prismTooth(test::veeOutline(), 1.5, 0.05);
    const bool whole = std::getenv("HANDPIECE_WHOLE_MAP") != nullptr;
    std::vector<Row> rows;
    for (const device::Hand& hand : device::hands())
        for (const double friction : {0.26, 0.05})
            for (const double delay : {0.0, 0.001, 0.003})
                for (const double rate : {1000.0, 4000.0})
                    for (const Tissue tissue : {Tissue::enamel, Tissue::dentine, Tissue::caries})
                        for (const bool wedged : {false, true}) {
                            // The whole map takes minutes; what is hardest on stability runs always.
                            const bool hardest = delay == 0.003 && (rate == 1000.0 || friction == 0.05);
                            if (!whole && !hardest) continue;
                            if (!whole && rate > 1000.0 && tissue == Tissue::dentine) continue;
                            rows.push_back({&hand, friction, delay, rate, tissue, wedged});
                        }
    std::vector<std::shared_ptr<const tooth::ToothModel>> bases;
    for (const Tissue t : {Tissue::enamel, Tissue::dentine, Tissue::caries})
        for (const auto& tooth : {flat, groove})
            bases.push_back(cuttable(tooth, t));
    core::parallelFor(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t t = rows[i].tissue == Tissue::enamel ? 0 : rows[i].tissue == Tissue::dentine ? 1 : 2;
            simulate(bases[2 * t + (rows[i].wedged ? 1 : 0)], bur, rows[i]);
        }
    });
    int holds = 0, cut = 0;
    for (const Row& r : rows) {
        const bool good = r.marginNmm >= -1e-9;
        holds += good;
        cut += r.removedMm3 > 1e-4;
        EXPECT_TRUE(good) << r.hand->name << " hand, friction " << r.frictionN << " N, delay " << r.delayS << " s, "
                          << r.rateHz << " Hz, " << cases::properties(r.tissue).name << (r.wedged ? ", wedged" : "")
                          << ": margin " << r.marginNmm << " N mm, removed " << r.removedMm3 << " mm3";
    }
    std::printf("  holds at %d of %zu, of which %d cut\n", holds, rows.size(), cut);
    EXPECT_GT(cut, static_cast<int>(rows.size()) / 2);
}

}  // namespace
}  // namespace handpiece::studies::cutting_passivity_test
