// SPDX-License-Identifier: Apache-2.0
// How fast the bur advances under load, and what it tells of torque and force, with a bearing in closed form.
#include "handpiece/tick/cutting/cutter.h"

#include <gtest/gtest.h>

#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/shapes.h"
#include "support/realtime_trap.h"
#include "tick/cutting/phantom.h"

namespace handpiece::cutting::cutter_test {
namespace {

using cases::Tissue;
using core::Vec3;
using test::poseAt;
using test::sumOf;

constexpr double kPi = std::numbers::pi, kRadius = 0.5, kSpeed = 40000.0;

/// A flat-ended cylinder standing upright on a plane: the bearing of its end, known exactly. The plane lies where the
/// field says it does under the middle of the end, so that the proxy can be put on it.
class FlatOnPlane final : public contact::Method {
  public:
    explicit FlatOnPlane(std::array<double, cases::kTissueCount> shares) : shares_(shares) {}
    [[nodiscard]] const char* name() const noexcept override { return "flat on plane"; }
    [[nodiscard]] contact::Depth depth(const core::Pose&) noexcept override { return {}; }
    void bearing(const core::Pose&, const Vec3&, double, double leastRadiusMm,
                 contact::Bearing& out) noexcept override {
        out = {};
        // Sum of a / rho over a disc with a least radius: 2 pi (R - c) + pi c.
        const double area = kPi * kRadius * kRadius,
                     resistance = 2.0 * kPi * (kRadius - leastRadiusMm) + kPi * leastRadiusMm;
        for (std::size_t t = 0; t < cases::kTissueCount; ++t) {
            out.areaMm2[t] = shares_[t] * area;
            out.resistanceMm[t] = shares_[t] * resistance;
            out.tangentMm[t] = shares_[t] * Vec3(0.1, 0.0, 0.0);
        }
        out.status = contact::Status::ok;
    }

  private:
    std::array<double, cases::kTissueCount> shares_;
};
FlatOnPlane allOf(Tissue tissue) {
    std::array<double, cases::kTissueCount> shares{};
    shares[static_cast<std::size_t>(tissue)] = 1.0;
    return FlatOnPlane(shares);
}

instrument::CuttingParameters plain() {
    instrument::CuttingParameters cuttingParameters;
    cuttingParameters.cutting = 1.0;
    cuttingParameters.loadCapN = 1.5;
    cuttingParameters.chipMm = 1.0;  // no cap unless a test wants one
    return cuttingParameters;
}
/// What V' = K F omega r gives for the end of a flat cylinder: p = v / (K omega rho) summed up is the load.
double expectedFeed(const instrument::CuttingParameters& cuttingParameters, double cutting, double loadN,
                    double speed) {
    const double least = cuttingParameters.centreRadius * kRadius,
                 resistance = 2.0 * kPi * (kRadius - least) + kPi * least;
    return std::min(loadN, cuttingParameters.loadCapN) * speed * cutting * cuttingParameters.cutting / resistance;
}

struct Bench {
    std::shared_ptr<tooth::ToothState> field;
    std::shared_ptr<const instrument::Bur> bur =
        std::make_shared<const instrument::Bur>(instrument::makeBur("cylinder-flat:1.0x4.0"));
    cases::TissueTable table = cases::builtInTissues();
    std::unique_ptr<Cutter> cutter;
    double proxyZ = 0.0;

    Bench(Tissue tissue, double voxelMm, const instrument::CuttingParameters& cuttingParameters,
          const Cutter::Settings& settings = {}) {
        const core::Box box{Vec3(-1.2, -1.2, -1.6), Vec3(1.2, 1.2, 0)};
        const auto uncut = test::phantom(box, voxelMm, test::boxDistance(box));
        field = std::make_shared<tooth::ToothState>(
            tooth::withTissues(*uncut, field::TissueMap::uniform(uncut->field, tissue)));
        cutter = std::make_unique<Cutter>(field, bur, cuttingParameters, table, settings);
    }
    double cuttingOf(Tissue tissue) const { return table.of(tissue).cuttingMm2PerN; }
    /// One tick: the proxy rests on what the field has under it.
    const CutResult& tick(contact::Method& method, double loadN, double speed, double periodS) {
        while (field->field().distance(Vec3(0.013, 0.007, proxyZ)) > 0.0 && proxyZ > -1.4)
            proxyZ -= 1e-5;
        CutInput input;
        input.proxyInTooth = poseAt(Vec3(0.013, 0.007, proxyZ));
        input.deviceInTooth = input.proxyInTooth;
        input.loadN = Vec3(0, 0, -loadN);
        input.speedRadS = speed;
        input.periodS = periodS;
        return cutter->cut(method, input);
    }
    double plunge(Tissue tissue, double loadN, double speed, double periodS, double seconds) {
        FlatOnPlane method = allOf(tissue);
        const double before = sumOf(field->removedMm3());
        for (int i = 0, count = static_cast<int>(std::lround(seconds / periodS)); i < count; ++i)
            tick(method, loadN, speed, periodS);
        return sumOf(field->removedMm3()) - before;
    }
};

TEST(Cutter, removesWhatTheLawSaysAtEveryRateAndVoxel) {
    const double seconds = 0.5, loadN = 0.8;
    for (const double voxel : {0.025, 0.05, 0.1})
        for (const double rate : {1000.0, 3000.0, 8000.0}) {
            Bench bench(Tissue::enamel, voxel, plain());
            bench.plunge(Tissue::enamel, loadN, kSpeed, 1.0 / rate, 0.2);
            const double removed = bench.plunge(Tissue::enamel, loadN, kSpeed, 1.0 / rate, seconds),
                         expected = kPi * kRadius * kRadius * seconds *
                                    expectedFeed(plain(), bench.cuttingOf(Tissue::enamel), loadN, kSpeed);
            EXPECT_NEAR(removed, expected, 0.05 * expected) << voxel << " mm, " << rate << " Hz";
        }
}

TEST(Cutter, tissuesGiveWayAsTheirValuesSay) {
    const auto removedOf = [](Tissue tissue) {
        Bench bench(tissue, 0.05, plain());
        bench.plunge(tissue, 0.3, kSpeed, 0.001, 0.05);
        return bench.plunge(tissue, 0.3, kSpeed, 0.001, 0.2);
    };
    const cases::TissueTable& table = cases::builtInTissues();
    const double enamel = removedOf(Tissue::enamel), dentine = removedOf(Tissue::dentine),
                 caries = removedOf(Tissue::caries);
    const double toDentine = table.of(Tissue::dentine).cuttingMm2PerN / table.of(Tissue::enamel).cuttingMm2PerN,
                 toCaries = table.of(Tissue::caries).cuttingMm2PerN / table.of(Tissue::dentine).cuttingMm2PerN;
    EXPECT_NEAR(dentine / enamel, toDentine, 0.07 * toDentine);
    EXPECT_NEAR(caries / dentine, toCaries, 0.07 * toCaries);
}

TEST(Cutter, resistancesOfSeveralTissuesAddUp) {
    std::array<double, cases::kTissueCount> shares{};
    shares[static_cast<std::size_t>(Tissue::enamel)] = 0.4;
    shares[static_cast<std::size_t>(Tissue::dentine)] = 0.6;
    FlatOnPlane method(shares);
    Bench bench(Tissue::enamel, 0.05, plain());
    const double feed = bench.tick(method, 1.0, kSpeed, 0.001).feedMmS,
                 enamel = expectedFeed(plain(), bench.cuttingOf(Tissue::enamel), 1.0, kSpeed),
                 dentine = expectedFeed(plain(), bench.cuttingOf(Tissue::dentine), 1.0, kSpeed);
    EXPECT_NEAR(feed, 1.0 / (0.4 / enamel + 0.6 / dentine), 1e-9);
}

TEST(Cutter, loadAndChipAreCapped) {
    FlatOnPlane method = allOf(Tissue::enamel);
    Bench bench(Tissue::enamel, 0.05, plain());
    const double atCap = bench.tick(method, 1.5, kSpeed, 1e-4).feedMmS;
    EXPECT_NEAR(bench.tick(method, 3.0, kSpeed, 1e-4).feedMmS, atCap, 1e-12);
    EXPECT_LT(bench.tick(method, 1.0, kSpeed, 1e-4).feedMmS, 0.7 * atCap);
    instrument::CuttingParameters fine = plain();
    fine.chipMm = 1e-6;
    fine.edges = 6;
    Bench slow(Tissue::enamel, 0.05, fine);
    EXPECT_NEAR(slow.tick(method, 1.0, kSpeed, 1e-4).feedMmS, 6e-6 * kSpeed / (2.0 * kPi), 1e-12);
}

TEST(Cutter, theAbilityIsAFactor) {
    FlatOnPlane method = allOf(Tissue::enamel);
    instrument::CuttingParameters coarse = plain();
    coarse.cutting = 1.7;
    Bench a(Tissue::enamel, 0.05, plain()), b(Tissue::enamel, 0.05, coarse);
    EXPECT_NEAR(b.tick(method, 1.0, kSpeed, 0.001).feedMmS, 1.7 * a.tick(method, 1.0, kSpeed, 0.001).feedMmS, 1e-9);
}

TEST(Cutter, aStillBurCutsNothingButIsHeld) {
    FlatOnPlane method = allOf(Tissue::enamel);
    Bench bench(Tissue::enamel, 0.05, plain());
    const std::uint64_t before = bench.field->stateHash();
    for (int i = 0; i < 50; ++i) {
        const CutResult& result = bench.tick(method, 2.0, 0.0, 0.001);
        EXPECT_EQ(sumOf(result.removedMm3), 0.0);
        EXPECT_EQ(result.feedMmS, 0.0);
        EXPECT_EQ(result.tangentialN.norm(), 0.0);
        EXPECT_GT(result.loadTorqueNmm, 0.0) << "a stalled bur stays stalled under its load";
    }
    EXPECT_EQ(bench.field->stateHash(), before);
    EXPECT_EQ(sumOf(bench.field->removedMm3()), 0.0);
}

TEST(Cutter, withoutLoadNothingIsCut) {
    FlatOnPlane method = allOf(Tissue::enamel);
    Bench bench(Tissue::enamel, 0.05, plain());
    const CutResult& result = bench.tick(method, 0.0, kSpeed, 0.001);
    EXPECT_EQ(sumOf(result.removedMm3), 0.0);
    EXPECT_EQ(result.loadTorqueNmm, 0.0);
    EXPECT_EQ(result.changedBricks, 0u);
}

TEST(Cutter, whatCannotBeCutHoldsTheBur) {
    FlatOnPlane whole = allOf(Tissue::enamel);
    std::array<double, cases::kTissueCount> shares{};
    shares[static_cast<std::size_t>(Tissue::enamel)] = 0.9;
    shares[static_cast<std::size_t>(Tissue::none)] = 0.1;
    FlatOnPlane mixed(shares);
    Bench bench(Tissue::enamel, 0.05, plain());
    ASSERT_EQ(bench.cuttingOf(Tissue::none), 0.0);
    EXPECT_GT(bench.tick(whole, 1.0, kSpeed, 0.001).feedMmS, 0.0);
    EXPECT_EQ(bench.tick(mixed, 1.0, kSpeed, 0.001).feedMmS, 0.0);
}

TEST(Cutter, torqueAndTangentialForceFollowTheLoad) {
    const instrument::CuttingParameters cuttingParameters = plain();
    FlatOnPlane method = allOf(Tissue::dentine);
    Bench bench(Tissue::dentine, 0.05, cuttingParameters);
    const CutResult& result = bench.tick(method, 0.9, kSpeed, 0.001);
    const double least = cuttingParameters.centreRadius * kRadius,
                 resistance = 2.0 * kPi * (kRadius - least) + kPi * least;
    const double meanRadius = kPi * kRadius * kRadius / resistance;
    EXPECT_NEAR(result.loadTorqueNmm, cuttingParameters.frictionCutting * 0.9 * meanRadius, 1e-12);
    EXPECT_GT(meanRadius, 0.4 * kRadius);
    EXPECT_LT(meanRadius, kRadius);
    EXPECT_NEAR(result.tangentialN.x(), -cuttingParameters.frictionCutting * 0.9 * 0.1 / resistance, 1e-12);
}

TEST(Cutter, fullRemovalTakesAllThatTheDeviceSweeps) {
    Cutter::Settings settings;
    settings.fullRemoval = true;
    Bench bench(Tissue::enamel, 0.05, plain(), settings);
    FlatOnPlane method = allOf(Tissue::enamel);
    CutInput input;
    input.speedRadS = kSpeed;
    for (double z = 0.1; z > -1.0; z -= 0.05) {
        input.deviceInTooth = poseAt(Vec3(0.01, 0.02, z));
        bench.cutter->cut(method, input);
    }
    input.deviceInTooth = poseAt(Vec3(0.01, 0.02, -1.0));
    bench.cutter->cut(method, input);
    bench.cutter->rest();
    const double closed = kPi * kRadius * kRadius;
    EXPECT_NEAR(sumOf(bench.field->removedMm3()), closed, 0.003 * closed);
}

TEST(Cutter, nothingIsSweptOverARest) {
    Cutter::Settings settings;
    settings.fullRemoval = true;
    Bench bench(Tissue::enamel, 0.05, plain(), settings);
    FlatOnPlane method = allOf(Tissue::enamel);
    CutInput input;
    input.speedRadS = kSpeed;
    input.deviceInTooth = poseAt(Vec3(-0.6, 0.0, 0.4));
    bench.cutter->cut(method, input);
    bench.cutter->rest();
    input.deviceInTooth = poseAt(Vec3(0.6, 0.0, 0.4));  // by way of the tooth? no: it was lifted over it
    bench.cutter->cut(method, input);
    EXPECT_EQ(sumOf(bench.field->removedMm3()), 0.0);
    input.deviceInTooth = poseAt(Vec3(-0.4, 0.0, -0.2));
    bench.cutter->rest();
    const double once = sumOf(bench.cutter->cut(method, input).removedMm3);
    EXPECT_NEAR(once, kPi * kRadius * kRadius * 0.2, 0.02);
}

TEST(Cutter, takesNoMemoryInTheTick) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc";
    FlatOnPlane method = allOf(Tissue::caries);
    Bench bench(Tissue::caries, 0.05, plain());
    const test::RealtimeTrap trap;
    for (int i = 0; i < 60; ++i)
        bench.tick(method, 1.0, kSpeed, 0.001);
    bench.cutter->rest();
    EXPECT_EQ(trap.total(), 0u);
}

TEST(Cutter, refusesAnAbilityThatIsNone) {
    instrument::CuttingParameters bad = plain();
    bad.cutting = -1.0;
    EXPECT_THROW(Bench(Tissue::enamel, 0.1, bad), core::Error);
    bad = plain();
    bad.chipMm = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(Bench(Tissue::enamel, 0.1, bad), core::Error);
}

}  // namespace
}  // namespace handpiece::cutting::cutter_test
