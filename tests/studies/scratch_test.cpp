// SPDX-License-Identifier: Apache-2.0
// A simulated hand that scratches with a still round bur, as with a spoon: what tells the levels of carious dentine
// apart, against the closed form of the law, on devices of several stiffnesses and at several rates.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/cut_run.h"
#include "tick/force/prism_tooth.h"

namespace handpiece::studies::scratch_test {
namespace {

using cases::Tissue;
using core::Quat;
using core::Vec3;

constexpr std::array kGradient{
    Tissue::cariesSoft, Tissue::cariesSoftToLeathery, Tissue::cariesLeathery, Tissue::cariesLeatheryToFirm,
    Tissue::cariesFirm, Tissue::cariesFirmToHard,     Tissue::dentine};

/// Mean and standard deviation of what comes one by one.
struct Spread {
    double sum = 0.0, squares = 0.0;
    int count = 0;
    void add(double v) {
        sum += v;
        squares += v * v;
        ++count;
    }
    [[nodiscard]] double mean() const { return sum / count; }
    [[nodiscard]] double deviation() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean())); }
};
/// Cohen's d.
double effect(const Spread& a, const Spread& b) {
    return std::abs(a.mean() - b.mean()) /
           std::sqrt(0.5 * (a.deviation() * a.deviation() + b.deviation() * b.deviation()));
}

struct Scratch {
    Spread inMm, pressN, dragN, dragOverPress;
};

constexpr double kHandNPerMm = 0.3, kMmS = 3.0, kWayMm = 12.0, kTremorMm = 0.02;

/// Pressed so that a hand of `pressN` comes to rest as far in as the law says, then drawn along x by a trembling hand.
Scratch scratch(const std::shared_ptr<const tooth::ToothModel>& block, double fraction, double pressN, double rateHz,
                double stiffnessNPerMm) {
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("round:1.0x1.0"));
    device::SimulatedDeviceSettings arm;
    arm.capability.maxStiffnessNPerMm = stiffnessNPerMm;
    arm.frictionN = 0.05;
    force::Parameters parameters = force::defaultParameters();
    const double below = pressN / kHandNPerMm + pressN / (fraction * stiffnessNPerMm);
    const auto at = [](double x, double z) { return core::Pose{Vec3(x, 0.02, z), Quat::Identity()}; };
    const device::Motion steady({{0.0, at(-2.0, 0.1), 0.0},
                                 {0.6, at(-2.0, -below), 0.0},
                                 {1.0, at(-2.0, -below), 0.0},
                                 {1.0 + kWayMm / kMmS, at(kWayMm - 2.0, -below), 0.0}});
    loop::LoopSettings settings;
    settings.rateHz = rateHz;
    loop::HapticLoop haptic(settings, std::make_unique<device::SimulatedDevice>(arm, withTremor(steady, kTremorMm, 7)),
                            loop::Work{contact::makeFieldMethod(block, bur), nullptr}, parameters);
    Scratch s;
    (void)runSimulated(haptic, steady.durationS(), [&](const messages::HapticSample& m) {
        // Soft tissue gives way sideways too, by up to 4 mm, before the bur slides.
        if (m.timeS < steady.durationS() - 1.2) return;
        const double press = m.forceN[2], drag = -m.forceN[0];
        s.inMm.add(m.proxyPositionMm[2] - m.truePositionMm[2]);
        s.pressN.add(press);
        s.dragN.add(drag);
        s.dragOverPress.add(drag / press);
    });
    return s;
}

std::shared_ptr<const tooth::ToothModel> of(const tooth::ToothModel& uncut, Tissue tissue) {
    return tooth::withTissues(uncut, field::TissueMap::uniform(uncut.field, tissue));
}

TEST(Scratch, theLevelsAreToldApartAsTheLawHasThem) {
    const auto uncut = test::prismTooth({{-4, -2}, {11, -2}, {11, 0}, {-4, 0}}, 1.5, 0.05);
    std::array<std::shared_ptr<const tooth::ToothModel>, kGradient.size()> blocks;
    for (std::size_t i = 0; i < kGradient.size(); ++i)
        blocks[i] = of(*uncut, kGradient[i]);
    for (const double stiffness : {0.4, 0.5, 1.0})
        for (const double rate : {1000.0, 4000.0}) {
            const double press = 0.5;
            std::array<Scratch, kGradient.size()> felt;
            for (std::size_t i = 0; i < kGradient.size(); ++i) {
                const cases::TissueProperties& tissue = cases::properties(kGradient[i]);
                felt[i] = scratch(blocks[i], tissue.stiffnessFraction, press, rate, stiffness);
                const Scratch& s = felt[i];
                std::printf(
                    "  %.1f N/mm %.0f Hz %-24s in %6.3f +- %.3f mm, press %.3f +- %.3f N, drag %.3f +- %.3f N, "
                    "ratio %.3f +- %.3f%s\n",
                    stiffness, rate, std::string(tissue.name).c_str(), s.inMm.mean(), s.inMm.deviation(),
                    s.pressN.mean(), s.pressN.deviation(), s.dragN.mean(), s.dragN.deviation(), s.dragOverPress.mean(),
                    s.dragOverPress.deviation(),
                    i == 0 ? ""
                           : (", d " + std::to_string(effect(felt[i - 1].inMm, s.inMm)) + " / " +
                              std::to_string(effect(felt[i - 1].dragOverPress, s.dragOverPress)))
                                 .c_str());
                SCOPED_TRACE(testing::Message() << tissue.name << ", " << stiffness << " N/mm, " << rate << " Hz");
                // Closed form: force over stiffness; Coulomb. The encoder's step and the arm's friction blur both.
                EXPECT_NEAR(s.inMm.mean(), s.pressN.mean() / (tissue.stiffnessFraction * stiffness),
                            0.03 + 0.02 * s.inMm.mean());
                EXPECT_NEAR(s.pressN.mean(), press, 0.06);
                EXPECT_NEAR(s.dragOverPress.mean(), tissue.friction, 0.04 * tissue.friction);
                if (i == 0) continue;
                EXPECT_GT(felt[i - 1].inMm.mean(), 1.12 * s.inMm.mean());
                EXPECT_GT(effect(felt[i - 1].inMm, s.inMm), 10.0);
                EXPECT_GT(felt[i - 1].dragOverPress.mean(), s.dragOverPress.mean());
                EXPECT_GT(effect(felt[i - 1].dragOverPress, s.dragOverPress), 1.0);
            }
        }
}

/// A still bur that is pressed into a fissure by a steady hand and drawn along it.
struct Wedged {
    double pressN = 0.0, dragOverPress = 0.0;
};
Wedged wedge(const std::shared_ptr<const tooth::ToothModel>& fissure) {
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("round:0.5x0.5"));
    device::SimulatedDeviceSettings rigid;
    rigid.rigidHand = true;
    const auto at = [](double y, double z) { return core::Pose{Vec3(0.0, y, z), Quat::Identity()}; };
    // A ball of 0.25 mm rests 0.25 mm over the root of walls that open by 60 degrees; the hand goes 0.3 mm farther.
    device::Motion motion({{0.0, at(-0.8, 1.0), 0.0}, {0.5, at(-0.8, -0.05), 0.0}, {2.1, at(0.8, -0.05), 0.0}});
    loop::HapticLoop haptic({}, std::make_unique<device::SimulatedDevice>(rigid, std::move(motion)),
                            loop::Work{contact::makeFieldMethod(fissure, bur), nullptr}, force::defaultParameters());
    Spread press, ratio;
    (void)runSimulated(haptic, 2.0, [&](const messages::HapticSample& m) {
        if (m.timeS < 1.5) return;
        press.add(m.forceN[2]);
        ratio.add(-m.forceN[1] / m.forceN[2]);
    });
    return {press.mean(), ratio.mean()};
}

TEST(Scratch, aSoundStainedFissureHoldsWithoutBeingSoft) {
    const auto uncut = test::prismTooth(test::veeOutline(), 1.5, 0.04);
    std::array<Wedged, 3> felt;
    constexpr std::array kTissues{Tissue::enamel, Tissue::stainedEnamel, Tissue::cariesSoft};
    for (std::size_t i = 0; i < kTissues.size(); ++i) {
        felt[i] = wedge(of(*uncut, kTissues[i]));
        std::printf("  %-16s press %.4f N, drag along the fissure %.3f of it\n",
                    std::string(cases::properties(kTissues[i]).name).c_str(), felt[i].pressN, felt[i].dragOverPress);
    }
    const auto& [sound, stained, soft] = felt;
    EXPECT_NEAR(stained.pressN, sound.pressN, 0.03 * sound.pressN);
    EXPECT_LT(soft.pressN, 0.15 * sound.pressN);
    EXPECT_GT(stained.dragOverPress, 3.0 * sound.dragOverPress);
    EXPECT_GT(stained.dragOverPress, 1.4 * soft.dragOverPress);
}

}  // namespace
}  // namespace handpiece::studies::scratch_test
