// SPDX-License-Identifier: Apache-2.0
// What tells the tissues apart in the hand: the force at the same feed, and the volume under the same load.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "support/closed_meshes.h"

namespace handpiece::loop {
namespace {

using cases::Tissue;
using core::Quat;
using core::Vec3;

struct Plunge {
    double meanForceN = 0, removedMm3 = 0, feedMmS = 0;
};

/// Straight down at `speed` mm/s for 7 mm of a bur 1 mm wide; means over the last 0.4 mm of the hand's way.
Plunge plunge(const std::shared_ptr<const tooth::ToothModel>& base, double speed, const char* burName,
              double loadCapN) {
    const auto field = std::make_shared<tooth::ToothState>(base);
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur(burName));
    instrument::CuttingParameters cuttingParameters;
    cuttingParameters.loadCapN = loadCapN;
    Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
              std::make_unique<cutting::Cutter>(field, bur, cuttingParameters, cases::builtInTissues(),
                                                cutting::Cutter::Settings{})};
    device::SimulatedDeviceSettings rigid;
    rigid.rigidHand = true;
    const double way = 7.0, spin = 1.5;
    const auto at = [](double z) { return core::Pose{Vec3(0.01, 0.02, z), Quat::Identity()}; };
    device::Motion motion({{0.0, at(0.05), 1.0}, {spin, at(0.05), 1.0}, {spin + (way + 0.05) / speed, at(-way), 1.0}});
    const double end = motion.durationS();
    HapticLoop loop({}, std::make_unique<device::SimulatedDevice>(rigid, std::move(motion)), std::move(work),
                    force::defaultParameters());
    Plunge result;
    int count = 0;
    (void)runSimulated(loop, end, [&](const messages::HapticSample& s) {
        result.removedMm3 = 0;
        for (const double v : s.removedMm3)
            result.removedMm3 += v;
        if (s.timeS < end - 0.4 / speed) return;
        result.meanForceN += Vec3(s.forceN[0], s.forceN[1], s.forceN[2]).norm();
        result.feedMmS += static_cast<double>(s.feedMmS);
        ++count;
    });
    result.meanForceN /= count;
    result.feedMmS /= count;
    return result;
}

TEST(CuttingTissue, enamelResistsDentineLessAndDecayGivesWay) {
    cases::Case made;
    made.name = "block";
    made.outer = test::boxMesh(Vec3(-1.2, -1.2, -8.0), Vec3(1.2, 1.2, 0.0));
    tooth::LoadSettings settings;
    settings.useCache = false;
    const auto uncut = tooth::loadModel(made, settings);
    constexpr std::array tissues{Tissue::enamel, Tissue::dentine, Tissue::caries};
    std::array<std::shared_ptr<const tooth::ToothModel>, 3> blocks;
    for (std::size_t i = 0; i < tissues.size(); ++i)
        blocks[i] = tooth::withTissues(*uncut, field::TissueMap::uniform(uncut->field, tissues[i]));
    for (const char* bur : {"round:1.0x1.0", "cylinder-round:1.0x4.0"})
        for (const double cap : {1.5, 3.0}) {
            std::array<Plunge, 3> fast;
            for (std::size_t i = 0; i < tissues.size(); ++i)
                fast[i] = plunge(blocks[i], 1.0, bur, cap);
            std::printf("  %s, cap %.1f N, 1 mm/s: enamel %.3f N, dentine %.3f N, caries %.3f N: %.2f, %.2f\n", bur,
                        cap, fast[0].meanForceN, fast[1].meanForceN, fast[2].meanForceN,
                        fast[0].meanForceN / fast[1].meanForceN, fast[1].meanForceN / fast[2].meanForceN);
            EXPECT_GE(fast[0].meanForceN, 2.5 * fast[1].meanForceN);
            EXPECT_GE(fast[1].meanForceN, 3.0 * fast[2].meanForceN);
            EXPECT_LE(fast[0].meanForceN, 3.3);
        }
}

}  // namespace
}  // namespace handpiece::loop
