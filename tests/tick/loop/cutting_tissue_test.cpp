// SPDX-License-Identifier: Apache-2.0
// What tells the tissues apart in the hand: the force at the same feed, and the volume under the same load.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "support/closed_meshes.h"

namespace handpiece::loop::cutting_tissue_test {
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

/// Soft to hard: the levels of carious dentine and what is sound.
constexpr std::array kGradient{
    Tissue::cariesSoft, Tissue::cariesSoftToLeathery, Tissue::cariesLeathery, Tissue::cariesLeatheryToFirm,
    Tissue::cariesFirm, Tissue::cariesFirmToHard,     Tissue::dentine};

std::shared_ptr<const tooth::ToothModel> blockOfGradient() {
    cases::Case made;
    made.name = "block";
    made.outer = test::boxMesh(Vec3(-3.0, -1.5, -5.0), Vec3(3.0, 1.5, 0.0));
    tooth::LoadSettings settings;
    settings.useCache = false;
    return tooth::loadModel(made, settings);
}

/// A hand that presses with a set force whatever gives way: its spring is long and weak.
constexpr double kSpringNPerMm = 0.01;
device::SimulatedDeviceSettings pressingHand() {
    device::SimulatedDeviceSettings settings;
    settings.frictionN = 0.0;
    settings.hand = {"pressing", 0.05, 0.003, kSpringNPerMm};
    return settings;
}

/// A still round bur that is pressed with `pressN`: how far it gives way.
double indentMm(const std::shared_ptr<const tooth::ToothModel>& block, double pressN) {
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("round:1.0x1.0"));
    const auto at = [](double z) { return core::Pose{Vec3(0.01, 0.02, z), Quat::Identity()}; };
    const double below = pressN / kSpringNPerMm;
    device::Motion motion({{0.0, at(0.3), 0.0}, {0.3, at(-below), 0.0}, {2.0, at(-below), 0.0}});
    HapticLoop loop({}, std::make_unique<device::SimulatedDevice>(pressingHand(), std::move(motion)),
                    Work{contact::makeFieldMethod(block, bur), nullptr}, force::defaultParameters());
    double sum = 0.0;
    int count = 0;
    (void)runSimulated(loop, 2.0, [&](const messages::HapticSample& s) {
        if (s.timeS < 1.5) return;
        sum -= s.truePositionMm[2];
        ++count;
    });
    return sum / count;
}

/// The same, drawn along the surface by a steady hand, as a spoon is: drag over press.
double dragOf(const std::shared_ptr<const tooth::ToothModel>& block) {
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("round:1.0x1.0"));
    device::SimulatedDeviceSettings rigid;
    rigid.rigidHand = true;
    const auto at = [](double x, double z) { return core::Pose{Vec3(x, 0.02, z), Quat::Identity()}; };
    device::Motion motion({{0.0, at(-1.5, 0.1), 0.0}, {0.2, at(-1.5, -0.1), 0.0}, {1.7, at(1.5, -0.1), 0.0}});
    HapticLoop loop({}, std::make_unique<device::SimulatedDevice>(rigid, std::move(motion)),
                    Work{contact::makeFieldMethod(block, bur), nullptr}, force::defaultParameters());
    double drag = 0.0, press = 0.0;
    (void)runSimulated(loop, 1.6, [&](const messages::HapticSample& s) {
        if (s.timeS < 0.7) return;
        drag -= s.forceN[0];
        press += s.forceN[2];
    });
    return drag / press;
}

/// mm3/s that a steel round bur at low speed takes under a set force, once it is in.
double removalRate(const std::shared_ptr<const tooth::ToothModel>& block, double pressN) {
    const instrument::Instrument round = instrument::makeInstrument("steel-round-2");
    const auto field = std::make_shared<tooth::ToothState>(block);
    Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), round.bur),
              std::make_unique<cutting::Cutter>(field, round.bur, instrument::abilityByName("steel"),
                                                cases::builtInTissues(), cutting::Cutter::Settings{})};
    const double below = pressN / kSpringNPerMm, spin = 1.0;
    const auto at = [&](double z) { return core::Pose{Vec3(0.01, 0.02, z), Quat::Identity()}; };
    device::Motion motion(
        {{0.0, at(0.3), 1.0}, {spin, at(0.3), 1.0}, {spin + 0.3, at(-below), 1.0}, {12.0, at(-below), 1.0}});
    HapticLoop loop({}, std::make_unique<device::SimulatedDevice>(pressingHand(), std::move(motion)), std::move(work),
                    force::defaultParameters(), instrument::driveByName("low-speed"));
    const double from = 0.2, to = 0.5;  // mm deep, of the bur's tip
    double fromS = 0.0, fromMm3 = 0.0, rate = 0.0;
    (void)runSimulated(loop, 12.0, [&](const messages::HapticSample& s) {
        double removed = 0.0;
        for (const double v : s.removedMm3)
            removed += v;
        const double deep = -s.proxyPositionMm[2];
        if (fromS == 0.0 && deep > from) fromS = s.timeS, fromMm3 = removed;
        if (rate == 0.0 && deep > to) rate = (removed - fromMm3) / (s.timeS - fromS);
    });
    return rate;
}

TEST(CariousGradient, aSpoonFeelsItLevelByLevel) {
    const auto uncut = blockOfGradient();
    constexpr double kPressN = 0.05;  // so light that no bur goes in by more than itself where it is softest
    std::array<double, kGradient.size()> indent, drag, rate;
    for (std::size_t i = 0; i < kGradient.size(); ++i) {
        const auto block = tooth::withTissues(*uncut, field::TissueMap::uniform(uncut->field, kGradient[i]));
        indent[i] = indentMm(block, kPressN);
        drag[i] = dragOf(block);
        rate[i] = removalRate(block, 1.0);
        std::printf(
            "  %-24s still bur at 0.05 N: %.3f mm in, drag %.3f of the press; round steel bur at 1 N: %.4f mm3/s\n",
            std::string(cases::properties(kGradient[i]).name).c_str(), indent[i], drag[i], rate[i]);
    }
    for (std::size_t i = 1; i < kGradient.size(); ++i) {
        const std::string_view name = cases::properties(kGradient[i]).name;
        // Above the Weber fractions of stiffness; drag and rate in the same order.
        EXPECT_GT(indent[i - 1], 1.12 * indent[i]) << name;
        EXPECT_GT(drag[i - 1], drag[i] + 0.005) << name;
        EXPECT_GT(rate[i - 1], 1.12 * rate[i]) << name;
        EXPECT_GT(rate[i], 0.0) << name;
    }
}

TEST(CariousGradient, theBurSlowsDownLayerByLayerAndNothingClicks) {
    const auto uncut = blockOfGradient();
    // Layers of half a millimetre, softest on top, then sound dentine.
    constexpr double kLayerMm = 0.5, kPressN = 0.8, kEndS = 40.0;
    std::vector<field::TissueMap::PartFunction> layers;
    for (std::size_t i = 0; i + 1 < kGradient.size(); ++i)
        layers.push_back({[low = -kLayerMm * static_cast<double>(i + 1)](const Vec3& p) { return low - p.z(); },
                          kGradient[i], cases::properties(kGradient[i]).priority});
    const auto block =
        tooth::withTissues(*uncut, field::TissueMap::fromFunctions(uncut->field, layers, Tissue::dentine));
    const instrument::Instrument round = instrument::makeInstrument("steel-round-2");
    const auto field = std::make_shared<tooth::ToothState>(block);
    Work work{contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), round.bur),
              std::make_unique<cutting::Cutter>(field, round.bur, instrument::abilityByName("steel"),
                                                cases::builtInTissues(), cutting::Cutter::Settings{})};
    const double below = kPressN / kSpringNPerMm;
    const auto at = [](double z) { return core::Pose{Vec3(0.01, 0.02, z), Quat::Identity()}; };
    device::Motion motion({{0.0, at(0.3), 1.0}, {1.0, at(0.3), 1.0}, {1.3, at(-below), 1.0}, {kEndS, at(-below), 1.0}});
    HapticLoop loop({}, std::make_unique<device::SimulatedDevice>(pressingHand(), std::move(motion)), std::move(work),
                    force::defaultParameters(), instrument::driveByName("low-speed"));
    std::array<double, kGradient.size()> enteredS{}, leftS{};
    double steepestN = 0.0, lastN = 0.0;
    (void)runSimulated(loop, kEndS, [&](const messages::HapticSample& s) {
        const double deep = -s.proxyPositionMm[2], newtons = Vec3(s.forceN[0], s.forceN[1], s.forceN[2]).norm();
        // From the quick first millimetre on, and while there is a layer below.
        const double last = kLayerMm * static_cast<double>(kGradient.size());
        if (deep > 0.25 && deep < last) steepestN = std::max(steepestN, std::abs(newtons - lastN));
        lastN = newtons;
        for (std::size_t i = 0; i < kGradient.size(); ++i) {
            // The lower half of a layer: the bur's tip is through with the one above.
            const double middle = kLayerMm * (static_cast<double>(i) + 0.5);
            if (enteredS[i] == 0.0 && deep > middle) enteredS[i] = s.timeS;
            if (leftS[i] == 0.0 && deep > middle + 0.45 * kLayerMm) leftS[i] = s.timeS;
        }
    });
    double before = 1e9;
    for (std::size_t i = 0; i < kGradient.size(); ++i) {
        ASSERT_GT(leftS[i], enteredS[i]) << i;
        const double mmS = 0.45 * kLayerMm / (leftS[i] - enteredS[i]);
        std::printf("  %-24s %.3f mm/s\n", std::string(cases::properties(kGradient[i]).name).c_str(), mmS);
        EXPECT_LT(mmS, 0.95 * before) << cases::properties(kGradient[i]).name;
        before = mmS;
    }
    std::printf("  steepest tick %.4f N of %.1f N\n", steepestN, kPressN);
    EXPECT_LT(steepestN, 0.06 * kPressN);
}

}  // namespace
}  // namespace handpiece::loop::cutting_tissue_test
