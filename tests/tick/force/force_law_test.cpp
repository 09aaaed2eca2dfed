// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/force_law.h"

#include <gtest/gtest.h>

#include <limits>

#include "handpiece/base/core/error.h"
#include "handpiece/tick/force/force_model.h"
#include "support/realtime_trap.h"
#include "tick/force/analytic_methods.h"

namespace handpiece::force::force_law_test {
namespace {

using core::Vec3;

/// Pushes upwards with what it is told, whatever is touched, and counts how often contact began anew.
struct Told {
    double pushN = 1.0;
    bool usesProxy = true;
    int resets = 0;
};
Told told;

class ToldLaw final : public ForceLaw {
  public:
    [[nodiscard]] bool usesProxy() const noexcept override { return told.usesProxy; }
    [[nodiscard]] Vec3 pushN(const LawInput&) noexcept override { return {0.0, 0.0, told.pushN}; }
    void reset() noexcept override { ++told.resets; }
};

LawId toldLaw() {
    static const LawId id = addLaw("told", [] { return std::make_unique<ToldLaw>(); });
    return id;
}

/// A ball of 0.5 mm that slides in the surface of a plane.
class Slide {
  public:
    explicit Slide(LawId law) : method_(test::plane(), 0.5, 4.0), model_(Limits{}, parametersWith(law)) {}
    ForceCommand tick() {
        at_.positionMm.x() += 0.01;
        const Touch& touch = model_.feel(method_, at_, false, 1e-3);
        return model_.compute(touch, 1e-3);
    }
    ForceModel& model() { return model_; }

    static Parameters parametersWith(LawId law) {
        Parameters p = defaultParameters();
        p.law = law;
        p.fadeInS = 0.0;
        return p;
    }

  private:
    test::AnalyticMethod method_;
    ForceModel model_;
    core::Pose at_{{0.0, 0.0, -0.3}, core::Quat::Identity()};
};

TEST(ForceLaw, hasANameOfItsOwnBesideTheTwoThatAreAlwaysThere) {
    EXPECT_EQ(lawByName("proxy"), LawId::proxy);
    EXPECT_EQ(lawByName("penalty"), LawId::penalty);
    EXPECT_EQ(lawByName("told"), toldLaw());
    EXPECT_EQ(nameOf(toldLaw()), "told");
    EXPECT_EQ(nameOf(LawId::penalty), "penalty");
    EXPECT_THROW(addLaw("proxy", [] { return std::make_unique<ToldLaw>(); }), core::Error);
    Parameters unknown = defaultParameters();
    unknown.law = static_cast<LawId>(200);
    EXPECT_THROW(validate(unknown), core::Error);
}

TEST(ForceLaw, leavesLimitsFrictionAndDoubtToTheModel) {
    told = {};
    Slide slide(toldLaw());
    ForceCommand f;
    for (int i = 0; i < 200; ++i)
        f = slide.tick();
    EXPECT_NEAR(f.forceN.z(), 1.0, 1e-9);
    const double friction = defaultParameters().tissues[static_cast<std::size_t>(cases::Tissue::enamel)].friction;
    ASSERT_GT(friction, 0.0);
    EXPECT_NEAR(f.forceN.x(), -friction, 1e-6) << "of a push of 1 N, against the way";
    told.pushN = 1e9;
    for (int i = 0; i < 200; ++i)
        f = slide.tick();
    EXPECT_NEAR(f.forceN.norm(), Limits{}.maxForceN, 1e-9);
    told.pushN = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < 200; ++i)
        f = slide.tick();
    EXPECT_EQ(f.forceN, Vec3::Zero());
}

TEST(ForceLaw, knowsNoFrictionWithoutAProxy) {
    told = {.usesProxy = false};
    Slide slide(toldLaw());
    ForceCommand f;
    for (int i = 0; i < 200; ++i)
        f = slide.tick();
    EXPECT_EQ(f.forceN, Vec3(0.0, 0.0, 1.0));
}

TEST(ForceLaw, changesBetweenTwoTicksAndBeginsAnew) {
    told = {};
    Slide slide(LawId::proxy);
    for (int i = 0; i < 100; ++i)
        slide.tick();
    EXPECT_EQ(told.resets, 0);
    {
        const Parameters other = Slide::parametersWith(toldLaw());
        test::RealtimeTrap trap;
        slide.model().setParameters(other);
        EXPECT_EQ(trap.total(), 0u);
    }
    EXPECT_EQ(told.resets, 1);
    told.pushN = 2.0;
    ForceCommand f;
    for (int i = 0; i < 100; ++i)
        f = slide.tick();
    EXPECT_NEAR(f.forceN.z(), 2.0, 1e-9);
    EXPECT_EQ(told.resets, 1);
}

}  // namespace
}  // namespace handpiece::force::force_law_test
