// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <limits>

#include "devices/drivers/conformance.h"
#include "devices/drivers/spacemouse_daemon.h"
#include "handpiece/devices/drivers/rate_hand.h"
#include "handpiece/devices/drivers/spacemouse.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::drivers::spacemouse_test {
namespace {

using core::Quat;
using core::Vec3;
using link::DeviceFault;
using test::errorOf;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(RateHand, aDeflectionIsASpeedAndSmallOnesAreNone) {
    RateHandSettings settings;
    RateHand hand(settings);
    for (int i = 0; i < 250; ++i)
        hand.step({0.5 * settings.deadZone, 0, -0.9 * settings.deadZone}, Vec3::Zero(), false, 0.004);
    EXPECT_TRUE(hand.positionMm().isZero(0.0));
    for (int i = 0; i < 125; ++i)
        hand.step({0, -1, 0}, {0, 0, 1}, false, 0.004);
    EXPECT_NEAR(hand.positionMm().y(), -0.5 * settings.speedMmS, 1e-9);
    EXPECT_NEAR(hand.orientation().angularDistance(Quat(Eigen::AngleAxisd(0.5 * settings.turnRadS, Vec3::UnitZ()))), 0,
                1e-9);
    // Half a deflection is less than half the speed: fine work is done near the middle.
    RateHand slow(settings);
    slow.step({0.5, 0, 0}, Vec3::Zero(), false, 0.01);
    EXPECT_GT(slow.positionMm().x(), 0.0);
    EXPECT_LT(slow.positionMm().x(), 0.3 * settings.speedMmS * 0.01);
}

TEST(RateHand, staysWithinItsLimitsAndComesHomeGently) {
    std::mt19937_64 random(test::seed());
    RateHandSettings settings;
    RateHand hand(settings);
    Vec3 before = Vec3::Zero();
    for (int i = 0; i < 20'000; ++i) {
        Vec3 move = 3.0 * test::randomDirection(random), turn = 2.0 * test::randomDirection(random);
        if (i % 7 == 0) move.x() = kNan;
        if (i % 11 == 0) turn.y() = std::numeric_limits<double>::infinity();
        const bool home = (i / 500) % 4 == 3;
        const double dt = i % 13 == 0 ? test::uniform(random, -1, 10) : 0.004;
        hand.step(move, turn, home, i % 17 == 0 ? kNan : dt);
        ASSERT_TRUE(hand.positionMm().allFinite());
        ASSERT_TRUE((hand.positionMm().cwiseAbs().array() <= settings.reachMm.array() + 1e-12).all());
        ASSERT_NEAR(hand.orientation().norm(), 1.0, 1e-9);
        ASSERT_LE(hand.orientation().angularDistance(Quat::Identity()), settings.mostTurnRad + 1e-6);
        ASSERT_LE((hand.positionMm() - before).norm(), settings.speedMmS * 0.05 * std::sqrt(3.0) + 1e-9) << "no leap";
        before = hand.positionMm();
    }
    for (int i = 0; i < 250 * 6; ++i)
        hand.step({1, 1, 1}, {1, 1, 1}, true, 0.004);
    EXPECT_TRUE(hand.positionMm().isZero(0.0));
    EXPECT_NEAR(hand.orientation().angularDistance(Quat::Identity()), 0.0, 1e-9);
}

class SpaceMouse : public testing::Test {
  protected:
    SpaceMouse() { ::setenv("HANDPIECE_SPNAV_SOCKET", path().c_str(), 1); }
    ~SpaceMouse() override { ::unsetenv("HANDPIECE_SPNAV_SOCKET"); }
    [[nodiscard]] std::string path() const { return (folder_.path() / "s").string(); }
    [[nodiscard]] static std::unique_ptr<link::Driver> streaming(Probe& probe) {
        auto driver = openSpaceMouse({});
        driver->start(probe);
        EXPECT_TRUE(await([&] { return probe.count() > 2 && probe.last().trouble == DeviceFault::none; }));
        return driver;
    }

  private:
    test::TemporaryFolder folder_;
};

TEST_F(SpaceMouse, whatIsMissingIsToldWithItsRemedy) {
    EXPECT_THAT(errorOf([] { (void)openSpaceMouse({}); }), HasSubstr("systemctl start spacenavd"));
    EXPECT_FALSE(lookSpaceMouse().available);
    EXPECT_THAT(lookSpaceMouse().remedy, HasSubstr("spacenavd"));
    test::SpaceMouseDaemon daemon(path());
    const Found found = lookSpaceMouse();
    EXPECT_TRUE(found.available) << found.why;
    EXPECT_THAT(found.models, testing::ElementsAre("3Dconnexion SpaceMouse Compact")) << "a name in two packets";
    EXPECT_FALSE(found.pushes);
    EXPECT_THAT(errorOf([] { (void)openSpaceMouse({"", 1e5}); }), HasSubstr("rate"));
    daemon.plug(false);
    EXPECT_THAT(errorOf([] { (void)openSpaceMouse({}); }), HasSubstr("no SpaceMouse is connected"));
    EXPECT_FALSE(lookSpaceMouse().available);
    ::setenv("HANDPIECE_SPNAV_SOCKET", std::string(300, 'x').c_str(), 1);
    EXPECT_THAT(errorOf([] { (void)openSpaceMouse({}); }), HasSubstr("too long"));
}

TEST_F(SpaceMouse, anOldDaemonThatAnswersNothingWillDo) {
    test::SpaceMouseDaemon daemon(path(), 0);
    Probe probe;
    auto driver = streaming(probe);
    EXPECT_THAT(driver->info().version, HasSubstr("protocol 0"));
    daemon.motion({350, 0, 0, 0, 0, 0});
    EXPECT_TRUE(await([&] { return probe.last().positionMm[0] > 1.0; }));
    EXPECT_EQ(probe.trouble(), DeviceFault::none);
    driver->stop();
}

TEST_F(SpaceMouse, turnsGoTheWayTheCapIsTurned) {
    test::SpaceMouseDaemon daemon(path());
    for (const auto& [counts, axis] : {std::pair{std::array{0, 0, 0, 350, 0, 0}, Vec3(1, 0, 0)},
                                       std::pair{std::array{0, 0, 0, 0, -350, 0}, Vec3(0, -1, 0)},
                                       std::pair{std::array{0, 0, 0, 0, 0, 350}, Vec3(0, 0, -1)}}) {
        Probe probe;
        auto driver = streaming(probe);
        daemon.motion(counts);
        EXPECT_TRUE(await([&] { return probe.last().orientation[0] < 0.99; }));
        const auto q = probe.last().orientation;
        EXPECT_GT(Vec3(q[1], q[2], q[3]).normalized().dot(axis), 0.999);
        driver->stop();
        daemon.motion({0, 0, 0, 0, 0, 0});
    }
}

TEST_F(SpaceMouse, aDeflectionThatNobodyTellsAgainEnds) {
    test::SpaceMouseDaemon daemon(path());
    Probe probe;
    auto driver = streaming(probe);
    daemon.motion({0, 60, 0, 0, 0, 0});  // slow: it does not come to the limit
    EXPECT_TRUE(await([&] { return probe.last().positionMm[1] > 0.1; }));
    double at = -1.0;
    EXPECT_TRUE(await([&] {  // stands for 200 ms
        const double now = probe.last().positionMm[1];
        const bool stands = now == at;
        at = now;
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        return stands;
    }));
    EXPECT_LT(at, 59.0);
}

TEST_F(SpaceMouse, whatIsNoPacketHarmsNothing) {
    test::SpaceMouseDaemon daemon(path());
    Probe probe;
    auto driver = streaming(probe);
    std::mt19937_64 random(test::seed());
    for (int i = 0; i < 300; ++i) {
        std::array<std::int32_t, 8> packet{};
        for (std::int32_t& word : packet)
            word = static_cast<std::int32_t>(random());
        if (i % 2 == 0) packet[0] = static_cast<std::int32_t>(random() % 8);
        if (packet[0] == 0x7faa2002) continue;
        daemon.send(packet.data(), sizeof packet);
    }
    ASSERT_TRUE(daemon.settle());
    const link::DriverReading last = probe.last();
    EXPECT_EQ(last.trouble, DeviceFault::none);
    for (const double p : last.positionMm)
        EXPECT_LE(std::abs(p), 60.0);
    EXPECT_EQ(probe.faultsOfOrder(), 0u);
    driver->stop();
    EXPECT_EQ(daemon.breaches(), 0u) << daemon.lastBreach();
}

TEST_F(SpaceMouse, aDaemonThatIsStartedAgainIsTakenUpAgainWithNothingPressed) {
    auto daemon = std::make_unique<test::SpaceMouseDaemon>(path());
    Probe probe;
    auto driver = streaming(probe);
    daemon->button(0, true);
    EXPECT_TRUE(await([&] { return probe.last().buttons == 1; }));
    daemon.reset();
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::unplugged; }));
    EXPECT_EQ(probe.last().buttons, 0u);
    daemon = std::make_unique<test::SpaceMouseDaemon>(path());
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }));
    EXPECT_EQ(probe.last().buttons, 0u);
    // Unplugged at the daemon and plugged in again.
    daemon->plug(false);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::unplugged; }));
    daemon->plug(true);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }));
}

}  // namespace
}  // namespace handpiece::drivers::spacemouse_test
