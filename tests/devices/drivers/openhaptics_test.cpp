// SPDX-License-Identifier: Apache-2.0
// What is OpenHaptics' own: names, models, calibration styles, switches, rates, and what its library refuses.
#include "handpiece/devices/drivers/openhaptics.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "devices/drivers/conformance.h"
#include "devices/drivers/openhaptics_double.h"
#include "handpiece/base/core/error.h"
#include "support/error_of.h"

namespace handpiece::drivers::openhaptics_test {
namespace {

using core::Vec3;
using link::CalibrationState;
using link::DeviceFault;
using test::errorOf;

class OpenHaptics : public testing::Test {
  protected:
    void SetUp() override { hd.reset(2, "Touch"); }
    [[nodiscard]] std::unique_ptr<link::Driver> started(Probe& probe, const OpenOptions& options = {}) {
        auto driver = openOpenHaptics(options);
        driver->start(probe);
        EXPECT_TRUE(await([&] { return probe.count() > 2; }));
        return driver;
    }
    const HdDouble& hd = hdDouble();
};

TEST_F(OpenHaptics, asksTheLibraryAndFillsTheRestFromATable) {
    const auto touch = openOpenHaptics({});
    EXPECT_EQ(touch->info().model, "Touch");
    EXPECT_EQ(touch->info().serial, "DOUBLE-0001");
    EXPECT_EQ(touch->info().version, "HD 3.50.0, driver 2023.1.4, firmware 1.25");
    EXPECT_EQ(touch->info().capability.maxForceN, 3.3);
    EXPECT_EQ(touch->info().capability.continuousForceN, 0.825);
    EXPECT_EQ(touch->info().capability.workspaceMm, Vec3(160, 120, 70));
    EXPECT_EQ(touch->info().capability.drivenAxes, 3);
    EXPECT_NE(touch->info().sources.find("unchecked"), std::string::npos);
    touch->stop();
    for (const auto& [name, force, stiffness] : {std::tuple{"Touch X", 7.9, 1.0},
                                                 {"PHANTOM Omni", 3.3, 0.7},
                                                 {"Phantom Premium 1.5 6DOF", 8.5, 0.8},
                                                 {"PHANTOM Premium 3.0", 22.0, 1.0},
                                                 {"PHANTOM Desktop", 7.9, 1.0},
                                                 {"something new", 3.3, 0.4}}) {
        EXPECT_EQ(openHapticsCapability(name).maxForceN, force) << name;
        EXPECT_EQ(openHapticsCapability(name).maxStiffnessNPerMm, stiffness) << name;
    }
}

TEST_F(OpenHaptics, everyCodeHasASentenceAndARemedyOfItsOwn) {
    std::set<std::string> sentences;
    for (const int code : {0x0100, 0x0101, 0x0102, 0x0103, 0x0104, 0x0200, 0x0201, 0x0202, 0x0203, 0x0204, 0x0300,
                           0x0301, 0x0302, 0x0303, 0x0304, 0x0400, 0x0401, 0x0402, 0x0500, 0x0501, 0x0600, 0x7777}) {
        const std::string words = openHapticsErrorInWords(code);
        EXPECT_GT(words.size(), 40u) << words;
        EXPECT_EQ(vendorErrorInWords("openhaptics", code), words);
        sentences.insert(words.substr(0, words.find('(')));
    }
    EXPECT_EQ(sentences.size(), 22u);
    EXPECT_EQ(vendorErrorInWords("openhaptics", 0), "");
}

TEST_F(OpenHaptics, whatTheLibraryRefusesHasItsRemedy) {
    for (const auto& [code, id, word] : {std::tuple{0x0600u, "no-licence", "licence"},
                                         {0x0301u, "device-busy", "close other programs"},
                                         {0x0302u, "device-missing", "cable"},
                                         {0x0303u, "device-error", "set-up program"},
                                         {0x0300u, "device-error", "switch the device off"}}) {
        hd.initError(code);
        try {
            (void)openOpenHaptics({});
            FAIL() << id;
        } catch (const core::Error& e) {
            EXPECT_EQ(e.id(), id);
            EXPECT_NE(e.remedy().find(word), std::string::npos) << e.what();
        }
        const Found found = lookOpenHaptics();
        EXPECT_FALSE(found.available);
        EXPECT_FALSE(found.why.empty());
        EXPECT_FALSE(found.remedy.empty());
    }
    hd.initError(0);
    EXPECT_NE(errorOf([] { (void)openOpenHaptics({"Third Arm", 0.0}); }).find("Third Arm"), std::string::npos);
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, aLookLeavesNothingOpenAndDisturbsNobody) {
    Found found = lookOpenHaptics();
    EXPECT_TRUE(found.available) << found.why;
    EXPECT_EQ(found.models, std::vector<std::string>{"Touch"});
    EXPECT_FALSE(found.triedOnHardware);
    Probe probe;
    const auto driver = started(probe);
    found = lookOpenHaptics();
    EXPECT_TRUE(found.available);
    EXPECT_EQ(found.models, std::vector<std::string>{"in use here"});
    EXPECT_EQ(probe.faultsOfOrder(), 0u);
    driver->stop();
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, oneServoRateForAllArms) {
    Probe a, b;
    {
        const auto driver = started(a, {"", 1600.0});
        EXPECT_EQ(driver->info().servoHz, 1600.0);
        auto second = openOpenHaptics({"Second Device", 500.0});
        EXPECT_NE(errorOf([&] { second->start(b); }).find("share one servo"), std::string::npos);
    }
    auto odd = openOpenHaptics({"", 777.0});
    EXPECT_NE(errorOf([&] { odd->start(b); }).find("777"), std::string::npos);
    odd->stop();
    EXPECT_NE(errorOf([] { (void)openOpenHaptics({"", -1.0}); }), "");
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, encoderResetIsByHandAndAutomaticByItself) {
    hd.calibration(0, 1, 0x5002);
    Probe probe;
    auto driver = started(probe);
    EXPECT_TRUE(await([&] { return driver->calibration() == CalibrationState::wantedByHand; }));
    EXPECT_NE(driver->calibrationStep().find("right angles"), std::string::npos);
    EXPECT_TRUE(driver->calibrate());
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }));
    driver->stop();

    hd.reset(1, "Touch X");
    hd.calibration(0, 2, 0x5001);
    Probe second;
    driver = started(second);
    EXPECT_TRUE(await([&] { return second.last().trouble == DeviceFault::none; }));
    EXPECT_EQ(second.trouble(), DeviceFault::notCalibrated) << "the frame in which the pose may jump pushes nothing";
    EXPECT_EQ(driver->calibration(), CalibrationState::good);
    driver->stop();
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, aCalibrationNotDoneIsNotBelieved) {
    hd.calibration(0, 4, 0x5002);
    Probe probe;
    auto driver = started(probe);
    EXPECT_FALSE(driver->calibrate()) << "the stylus is not in its inkwell";
    EXPECT_EQ(probe.last().trouble, DeviceFault::notCalibrated);
    driver->stop();
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, nobodyHoldsItInItsInkwell) {
    hd.switches(0, 1, 0);
    Probe probe;
    auto driver = started(probe);
    EXPECT_EQ(probe.last().trouble, DeviceFault::none) << "switches that never said otherwise may not be there";
    hd.switches(0, 0, 0);
    const std::uint64_t count = probe.count();
    EXPECT_TRUE(await([&] { return probe.count() > count + 2; }));
    EXPECT_EQ(probe.last().trouble, DeviceFault::none);
    hd.switches(0, 1, 0);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::inputLost; }));
    hd.switches(0, 0, 1);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }));
    hd.switches(0, 0, 0);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::inputLost; })) << "its safety switch";
    driver->stop();
    hd.reset(1, "Touch");
    hd.switches(0, -1, -1);
    hd.temperature(0, -1.0);
    Probe bare;
    driver = started(bare);
    EXPECT_EQ(bare.last().trouble, DeviceFault::none);
    EXPECT_EQ(bare.code(), 0) << "what a model has not is no error";
    EXPECT_LT(bare.last().motorTemperature, 0.0f);
    driver->stop();
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, theHottestMotorIsTold) {
    Probe probe;
    auto driver = started(probe);
    hd.temperature(0, 0.93);
    EXPECT_TRUE(await([&] { return std::abs(probe.last().motorTemperature - 0.93f) < 1e-6f; }));
    driver->stop();
}

TEST_F(OpenHaptics, fatalErrorsLastAndOthersPass) {
    Probe probe;
    auto driver = started(probe);
    hd.error(0, 0x0402, 0, 1);
    EXPECT_TRUE(await([&] { return probe.trouble() == DeviceFault::vendorError; }));
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; })) << "one lost frame";
    probe.push({0, 1, 0});
    EXPECT_TRUE(await([&] { return hd.newton(0).norm() > 0.9; }));
    hd.error(0, 0x0300, 1, 1);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::vendorError; }));
    const std::uint64_t count = probe.count();
    EXPECT_TRUE(await([&] { return probe.count() > count + 20; }));
    EXPECT_EQ(probe.last().trouble, DeviceFault::vendorError) << "until it is opened anew";
    EXPECT_EQ(probe.last().vendorCode, 0x0300);
    EXPECT_EQ(hd.newton(0), Vec3::Zero());
    driver->stop();
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, aDeadSchedulerHoldsNobodyUp) {
    Probe probe;
    auto driver = started(probe);
    probe.push({1, 0, 0});
    hd.kill();
    EXPECT_TRUE(await([&] { return hd.newton(0).isZero(); }));
    const auto then = std::chrono::steady_clock::now();
    driver->stop();
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count(), 2.0);
    hd.reset(1, "Touch");
    Probe again;
    started(again)->stop();
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, motorsGoOffWhileTheServoHangsAndOnAgain) {
    Probe probe;
    auto driver = started(probe);
    probe.push({0, 1, 0});
    EXPECT_TRUE(await([&] { return hd.newton(0).norm() > 0.99; }));
    hd.stall(0, 60.0);
    std::uint64_t count = 0;
    EXPECT_TRUE(await([&] {
        count = probe.count();
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        return probe.count() == count;
    }));
    EXPECT_TRUE(await([&] {
        driver->relax();
        return hd.newton(0).isZero();
    }));
    EXPECT_EQ(probe.count(), count) << "the servo still hangs";
    hd.wake();
    EXPECT_TRUE(await([&] { return hd.newton(0).norm() > 0.99; }));
    driver->stop();
    driver->relax();
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
}

TEST_F(OpenHaptics, aHandOnASpringGivesWay) {
    hd.sprung(0, 1);
    Probe probe;
    auto driver = started(probe);
    probe.push({0, 1.0, 0});
    // 1 N against 0.5 N/mm.
    EXPECT_TRUE(await([&] { return std::abs(probe.last().positionMm[1] - 2.0) < 0.01; })) << probe.last().positionMm[1];
    driver->stop();
}

// ---- Libraries. Each in a process of its own, which has loaded none yet. ----------------------------------------

/// Prints what a look says, for a parent to read.
[[noreturn]] void lookAndExit(const char* library) {
    setenv("HANDPIECE_HD_LIBRARY", library, 1);
    const Found found = lookOpenHaptics();
    std::fprintf(stderr, "%s: %s; %s\n", found.available ? "there" : "not there", found.why.c_str(),
                 found.remedy.c_str());
    std::exit(found.available ? 0 : 3);
}

TEST(OpenHapticsLibraryDeathTest, missingWrongAndTwice) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(lookAndExit("/no/such/libHD.so"), testing::ExitedWithCode(3),
                "not there: .*not installed or cannot be loaded.*no/such.*install OpenHaptics");
    EXPECT_EXIT(lookAndExit("libm.so.6"), testing::ExitedWithCode(3), "no function hdInitDevice.*version");
    EXPECT_EXIT(lookAndExit("/etc/passwd"), testing::ExitedWithCode(3), "invalid ELF header");
    EXPECT_EXIT(lookAndExit(HANDPIECE_DOUBLE_HD), testing::ExitedWithCode(0), "there");
    const auto folder = std::filesystem::temp_directory_path() / ("handpiece_hd_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const auto other = folder / "libHD.so";
    std::filesystem::copy_file(HANDPIECE_DOUBLE_HD, other, std::filesystem::copy_options::overwrite_existing);
    EXPECT_EXIT(
        {
            if (dlopen(HANDPIECE_DOUBLE_HD, RTLD_LAZY | RTLD_GLOBAL) == nullptr) std::exit(9);
            lookAndExit(other.c_str());
        },
        testing::ExitedWithCode(3), "two HD libraries.*HANDPIECE_HD_LIBRARY");
    // And with one in use, another one asked for.
    (void)hdDouble();
    EXPECT_TRUE(lookOpenHaptics().available);
    setenv("HANDPIECE_HD_LIBRARY", other.c_str(), 1);
    EXPECT_NE(lookOpenHaptics().why.find("two HD libraries"), std::string::npos) << lookOpenHaptics().why;
    setenv("HANDPIECE_HD_LIBRARY", "/no/such/libHD.so", 1);
    EXPECT_NE(lookOpenHaptics().why.find("not installed"), std::string::npos) << lookOpenHaptics().why;
    setenv("HANDPIECE_HD_LIBRARY", HANDPIECE_DOUBLE_HD, 1);
    std::filesystem::remove_all(folder);
}

TEST(Catalogue, namesWhatThereIs) {
    try {
        (void)open("teapot");
        FAIL();
    } catch (const core::Error& e) {
        EXPECT_EQ(e.id(), "no-such-device");
        for (const std::string& name : names())
            EXPECT_NE(e.remedy().find(name), std::string::npos) << name;
    }
    const std::vector<Found> found = look();
    ASSERT_EQ(found.size(), names().size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].driver, names()[i]);
        EXPECT_FALSE(found[i].makes.empty());
        EXPECT_FALSE(found[i].triedOnHardware) << "none was, yet";
        if (!found[i].available) {
            EXPECT_FALSE(found[i].why.empty()) << found[i].driver;
            EXPECT_FALSE(found[i].remedy.empty()) << found[i].driver;
        }
    }
}

}  // namespace
}  // namespace handpiece::drivers::openhaptics_test
