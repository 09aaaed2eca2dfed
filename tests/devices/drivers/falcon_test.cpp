// SPDX-License-Identifier: Apache-2.0
// What is the Falcon's own: its letters, its three arms, its firmware, and which way to it is taken.
#include "handpiece/devices/drivers/falcon.h"

#include <dlfcn.h>

#include <cstdlib>

#include "devices/drivers/conformance.h"
#include "devices/drivers/double_dhd.h"
#include "devices/drivers/double_usb.h"
#include "devices/drivers/falcon_arm.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/devices/drivers/falcon_kinematics.h"
#include "handpiece/devices/drivers/falcon_usb.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::drivers::falcon_test {
namespace {

using core::Vec3;
using doubles::FalconMade;
using doubles::UsbDouble;
using link::CalibrationState;
using link::DeviceFault;
using test::errorOf;

std::string textOf(const falcon::Frame& frame) {
    return {frame.begin(), frame.end()};
}

TEST(FalconLetters, aFrameIsSixteenLetters) {
    EXPECT_EQ(textOf(falcon::encode({0, 0, 0}, 0, false)), "<AAAAAAAAAAAAAA>");
    // 1447 = 0x05a7 and -1 = 0xffff, the lowest four bits first.
    EXPECT_EQ(textOf(falcon::encode({1447, -1, 16}, falcon::kRed, true)), "<HKFAPPPPABAAJA>");
    EXPECT_EQ(textOf(falcon::encode({99999, -99999, 0}, falcon::kGreen, false)), "<AAABAAAPAAAACA>") << "ends at 4096";
}

TEST(FalconLetters, framesAreFoundHoweverTheyAreCut) {
    std::mt19937_64 generator(test::seed());
    std::vector<std::uint8_t> stream;
    std::vector<std::array<int, 3>> told;
    for (int i = 0; i < 400; ++i) {
        std::array<int, 3> counts{};
        for (int& count : counts)
            count = static_cast<int>(test::uniform(generator, -4096, 4096));
        const falcon::Frame frame = falcon::encode(counts, 6, i % 2 == 0);
        if (i % 7 == 3) {  // one that lost its end
            stream.insert(stream.end(), frame.begin(), frame.begin() + 11);
        }
        stream.insert(stream.end(), frame.begin(), frame.end());
        told.push_back(counts);
        for (int noise = i % 5; noise > 0; --noise)
            stream.push_back(static_cast<std::uint8_t>(test::uniform(generator, 'A', 'P')));
    }
    falcon::FrameReader reader;
    std::vector<std::array<int, 3>> read;
    for (std::size_t at = 0; at < stream.size();) {
        const std::size_t piece = std::min<std::size_t>(stream.size() - at, at % 17 + 1);
        falcon::Report report;
        // A piece of up to 17 letters ends at most one frame.
        if (reader.take({stream.data() + at, piece}, report)) read.push_back(report.counts);
        at += piece;
    }
    EXPECT_EQ(read, told);
    EXPECT_GT(reader.spoilt(), 0u);
    falcon::Report report;
    EXPECT_FALSE(falcon::decode(falcon::Frame{}, report));
    falcon::Frame bad = falcon::encode({1, 2, 3}, 0, false);
    bad[4] = 'Q';
    EXPECT_FALSE(falcon::decode(bad, report));
}

TEST(FalconKinematics, forwardUndoesInverseAllOverTheWorkspace) {
    std::mt19937_64 generator(test::seed());
    double worst = 0, worstFromMiddle = 0, worstArm = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3 from = 40.0 * std::cbrt(test::uniform(generator, 0, 1)) * test::randomDirection(generator);
        const Vec3 grip = falcon::middleMm() + from;
        Vec3 cranks, back = grip + test::randomDirection(generator), middle = falcon::middleMm();
        ASSERT_TRUE(falcon::inverse(grip, cranks)) << grip.transpose();
        ASSERT_TRUE(falcon::forward(cranks, back)) << grip.transpose();
        ASSERT_TRUE(falcon::forward(cranks, middle)) << grip.transpose();
        worst = std::max(worst, (back - grip).norm());
        worstFromMiddle = std::max(worstFromMiddle, (middle - grip).norm());
        if (i % 20 == 0)
            for (int arm = 0; arm < 3; ++arm)
                worstArm = std::max(worstArm, std::abs(cranks[arm] - test::crankAt(arm, grip)));
    }
    EXPECT_LT(worst, 1e-6);
    EXPECT_LT(worstFromMiddle, 1e-6);
    EXPECT_LT(worstArm, 1e-9) << "against the arm put together from its parts";
    RecordProperty("worst_mm", std::to_string(worst));
}

TEST(FalconKinematics, whatTheArmsDoNotReachIsRefused) {
    Vec3 cranks, grip = falcon::middleMm();
    EXPECT_FALSE(falcon::inverse({0, 0, 190}, cranks));
    EXPECT_FALSE(falcon::inverse({0, 0, 10}, cranks));
    EXPECT_FALSE(falcon::inverse({200, 0, 120}, cranks));
    EXPECT_FALSE(falcon::inverse({NAN, 0, 120}, cranks));
    EXPECT_FALSE(falcon::forward({3.0, -1.0, 0.5}, grip));
    EXPECT_FALSE(falcon::forward({NAN, 0, 0}, grip));
    EXPECT_EQ(grip, falcon::middleMm());
    for (const int count : {-1000, 0, 1447})
        EXPECT_NEAR(falcon::countOf(falcon::crankOf(count)), count, 1e-9);
    EXPECT_NEAR(test::countAt(falcon::crankOf(1447)), 1447, 1e-9);
}

TEST(FalconKinematics, motorsDoTheWorkOfTheForce) {
    std::mt19937_64 generator(test::seed());
    double most = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 grip =
            falcon::middleMm() + 40.0 * std::cbrt(test::uniform(generator, 0, 1)) * test::randomDirection(generator);
        const Vec3 force = test::uniform(generator, 0.1, 8) * test::randomDirection(generator);
        const Vec3 way = test::randomDirection(generator);
        Vec3 cranks, torque;
        ASSERT_TRUE(falcon::inverse(grip, cranks));
        ASSERT_TRUE(falcon::torquesFor(grip, cranks, force, torque));
        // Along any little way the motors' work is the force's; the turns come from the other arm.
        const double h = 1e-3;
        double work = 0, size = 0;
        for (int arm = 0; arm < 3; ++arm) {
            const double turn = (test::crankAt(arm, grip + h * way) - test::crankAt(arm, grip - h * way)) / (2 * h);
            work += torque[arm] * turn;
            size += std::abs(torque[arm] * turn);
        }
        EXPECT_NEAR(work, force.dot(way), 1e-6 * (size + force.norm())) << grip.transpose();
        most = std::max(most, torque.cwiseAbs().maxCoeff() / force.norm());
    }
    // What the record promises can be had in every direction: ten units a newton millimetre, 4096 at most.
    EXPECT_LT(10.0 * most * 4.8, falcon::kMaxMotor);
}

class FalconUsb : public testing::Test {
  protected:
    FalconUsb() {
        void* file = dlopen(HANDPIECE_DOUBLE_USB, RTLD_LAZY | RTLD_GLOBAL);
        if (!file) throw std::runtime_error(dlerror());
        usb = reinterpret_cast<UsbDouble* (*)()>(dlsym(file, "doubleUsb"))();
    }
    void SetUp() override { use({{"F1"}, {"F2"}}); }
    void TearDown() override { unsetenv("HANDPIECE_FALCON_FIRMWARE"); }
    void use(const std::vector<FalconMade>& falcons) {
        setenv("HANDPIECE_LIBUSB_LIBRARY", HANDPIECE_DOUBLE_USB, 1);
        setenv("HANDPIECE_DHD_LIBRARY", "there-is-none", 1);
        unsetenv("HANDPIECE_FALCON_FIRMWARE");
        ASSERT_TRUE(usb->reset(falcons));
    }
    static std::string idOf(const std::function<void()>& work) {
        try {
            work();
        } catch (const core::Error& e) {
            return e.id();
        }
        return {};
    }
    UsbDouble* usb = nullptr;
};

TEST_F(FalconUsb, itsFirmwareIsTheUsers) {
    use({{"F1", false, 2}});
    const std::string said = errorOf([] { (void)openFalcon({}); });
    EXPECT_NE(said.find("firmware is not loaded"), std::string::npos) << said;
    EXPECT_NE(said.find("Force Dimension SDK"), std::string::npos) << said;
    EXPECT_NE(said.find("HANDPIECE_FALCON_FIRMWARE"), std::string::npos) << said;
    EXPECT_EQ(idOf([] { (void)openFalcon({}); }), "firmware-missing");
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "firmware.bin";
    std::string bytes;
    std::mt19937_64 generator(test::seed());
    for (int i = 0; i < 1000; ++i)
        bytes.push_back(static_cast<char>(generator()));
    core::writeFile(path, std::string_view(bytes));
    setenv("HANDPIECE_FALCON_FIRMWARE", path.c_str(), 1);
    Probe probe;
    auto driver = openFalcon({});  // it refuses twice, as real ones do
    driver->start(probe);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none && probe.count() > 5; }));
    driver->stop();
    const std::vector<std::uint8_t> got = usb->uploaded(0);
    EXPECT_TRUE(std::equal(got.begin(), got.end(), bytes.begin(), bytes.end(),
                           [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); }));
    EXPECT_EQ(usb->breaches(), 0u) << usb->lastBreach();
    driver.reset();
    use({{"F1", false, 1000}});
    setenv("HANDPIECE_FALCON_FIRMWARE", path.c_str(), 1);
    EXPECT_EQ(idOf([] { (void)openFalcon({}); }), "firmware-wrong");
    setenv("HANDPIECE_FALCON_FIRMWARE", (folder.path() / "none.bin").c_str(), 1);
    EXPECT_EQ(idOf([] { (void)openFalcon({}); }), "file-not-found");
}

TEST_F(FalconUsb, whatTheCableRefusesIsToldWithARemedy) {
    usb->openFails(0, -3);
    usb->openFails(1, -3);
    const std::string said = errorOf([] { (void)openFalcon({}); });
    EXPECT_NE(said.find("udev"), std::string::npos) << said;
    EXPECT_EQ(idOf([] { (void)openFalcon({}); }), "device-permission");
    usb->openFails(1, 0);
    EXPECT_EQ(openFalcon({})->info().serial, "F2") << "the first that can be had";
    usb->openFails(0, 0);
    usb->claimFails(0, -6);
    usb->claimFails(1, -6);
    EXPECT_EQ(idOf([] { (void)openFalcon({}); }), "device-busy");
    OpenOptions third;
    third.which = "F3";
    usb->claimFails(0, 0);
    usb->claimFails(1, 0);
    EXPECT_EQ(idOf([&] { (void)openFalcon(third); }), "device-missing");
    EXPECT_TRUE(lookFalcon().available);
    EXPECT_EQ(lookFalcon().models.size(), 2u);
    use({});
    EXPECT_EQ(idOf([] { (void)openFalcon({}); }), "device-missing");
    EXPECT_FALSE(lookFalcon().available);
    setenv("HANDPIECE_LIBUSB_LIBRARY", "there-is-none", 1);
    EXPECT_EQ(idOf([] { (void)openFalcon({}); }), "library-missing");
    EXPECT_FALSE(lookFalcon().available);
    EXPECT_EQ(usb->breaches(), 0u) << usb->lastBreach();
}

TEST_F(FalconUsb, itIsHomedByHandAndShowsIt) {
    usb->home(0, 0);
    Probe probe;
    auto driver = openFalcon({});
    driver->start(probe);
    probe.push({0, 0, 1});
    EXPECT_TRUE(await([&] { return usb->sent(0).count > 5 && usb->sent(0).homing; }));
    EXPECT_EQ(usb->sent(0).lights, falcon::kRed);
    EXPECT_EQ(probe.last().trouble, DeviceFault::notCalibrated);
    EXPECT_EQ(driver->calibration(), CalibrationState::wantedByHand);
    EXPECT_FALSE(driver->calibrate());
    EXPECT_EQ(usb->sent(0).motors, (std::array<int, 3>{}));
    usb->home(0, 7);
    EXPECT_TRUE(await([&] { return driver->calibrate() && usb->sent(0).lights == falcon::kGreen; }));
    EXPECT_FALSE(usb->sent(0).homing);
    usb->home(0, 0);  // told only while it homes
    const std::uint64_t count = probe.count();
    EXPECT_TRUE(await([&] { return probe.count() > count + 5; }));
    EXPECT_EQ(probe.last().trouble, DeviceFault::none);
    EXPECT_TRUE(await([&] { return usb->sent(0).motors != std::array<int, 3>{}; }));
}

TEST_F(FalconUsb, aForceBeyondTheMotorsKeepsItsDirection) {
    const Vec3 grip = falcon::middleMm() + Vec3(15, -10, 20);
    std::array<int, 3> counts{};
    for (int arm = 0; arm < 3; ++arm)
        counts[static_cast<std::size_t>(arm)] = static_cast<int>(std::lround(test::countAt(test::crankAt(arm, grip))));
    usb->encoders(0, counts);
    Probe probe;
    auto driver = openFalcon({});
    EXPECT_LT(driver->info().capability.maxForceN, 5.0);
    EXPECT_NE(driver->info().sources.find("unchecked"), std::string::npos);
    driver->start(probe);
    const Vec3 push(60, 30, -20);
    probe.push(push);
    const auto largest = [&] {
        int most = 0;
        for (const int motor : usb->sent(0).motors)
            most = std::max(most, std::abs(motor));
        return most;
    };
    EXPECT_TRUE(await([&] { return largest() == falcon::kMaxMotor; }));
    Vec3 felt = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis)
        for (int arm = 0; arm < 3; ++arm)
            felt[axis] += -0.1 * usb->sent(0).motors[static_cast<std::size_t>(arm)] *
                          (test::crankAt(arm, grip + 1e-3 * Vec3::Unit(axis)) -
                           test::crankAt(arm, grip - 1e-3 * Vec3::Unit(axis))) /
                          2e-3;
    EXPECT_GT(felt.dot(push) / (felt.norm() * push.norm()), 0.99999);
    driver->stop();
    EXPECT_EQ(usb->breaches(), 0u) << usb->lastBreach();
}

TEST_F(FalconUsb, theLibraryComesFirstWhereItSeesAFalcon) {
    void* file = dlopen(HANDPIECE_DOUBLE_DHD, RTLD_LAZY | RTLD_GLOBAL);
    ASSERT_NE(file, nullptr);
    doubles::DhdDouble& dhd = *reinterpret_cast<doubles::DhdDouble* (*)()>(dlsym(file, "doubleDhd"))();
    setenv("HANDPIECE_DHD_LIBRARY", HANDPIECE_DOUBLE_DHD, 1);
    ASSERT_TRUE(dhd.reset({{33, "omega.3", 1, false, false, false}, {60, "Falcon", 65535, false, false, false}}));
    {
        const auto driver = openFalcon({});
        EXPECT_EQ(driver->info().driver, "falcon");
        EXPECT_NE(driver->info().version.find("libdrd"), std::string::npos);
        EXPECT_EQ(driver->info().capability.maxForceN, 8.0);
        EXPECT_NE(driver->calibrationStep().find("all the way out"), std::string::npos);
    }
    ASSERT_TRUE(dhd.reset({{33, "omega.3", 1, false, false, false}}));
    EXPECT_NE(openFalcon({})->info().version.find("libusb"), std::string::npos);
    EXPECT_EQ(dhd.breaches(), 0u) << dhd.lastBreach();
}

TEST(FalconWords, everyCodeHasThem) {
    EXPECT_NE(falconErrorInWords(-4).find("unplugged"), std::string::npos);
    EXPECT_NE(falconErrorInWords(-3).find("udev"), std::string::npos);
    EXPECT_NE(falconErrorInWords(2).find("does not answer"), std::string::npos);
    EXPECT_NE(falconErrorInWords(-99).find("-99"), std::string::npos);
}

}  // namespace
}  // namespace handpiece::drivers::falcon_test
