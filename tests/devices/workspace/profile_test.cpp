// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/workspace/profile.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "handpiece/base/core/error.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::workspace::profile_test {
namespace {

namespace fs = std::filesystem;

class ProfileTest : public testing::Test {
  protected:
    ProfileTest() {
        info_.driver = "openhaptics";
        info_.model = "Touch";
        info_.serial = "A 12/7";
        info_.capability.maxForceN = 3.3;
        info_.frictionN = 0.26;
    }
    fs::path file() const { return profileFile(folder_, info_); }
    void write(const std::string& text) const {
        fs::create_directories(folder_);
        std::ofstream(file()) << text;
    }
    std::string problem(const std::string& text) const {
        write(text);
        return test::errorOf([&] { (void)readProfile(file(), info_); });
    }

    link::DriverInfo info_;
    test::TemporaryFolder temporary_;
    fs::path folder_ = temporary_.path() / "devices";
};

const char* const kHead = "format = 1\n[device]\ndriver = \"openhaptics\"\nmodel = \"Touch\"\nserial = \"A 12/7\"\n";

TEST_F(ProfileTest, comesBackBitForBit) {
    Profile p = defaultProfile(info_);
    p.placing.deviceMm = {1.0 / 3.0, -20.125, 7e-5};
    p.placing.toothInDevice = core::Quat(0.1, -0.7, 0.3, 0.2).normalized();
    p.placing.scale = 3.0;
    p.placing.leftHanded = true;
    p.placing.headAngleDeg = 107.5;
    p.placing.headRollDeg = -12.0;
    p.placing.tipFromStylusMm = {0.0, -8.0, -0.1};
    p.shaping.frictionCompensation = true;
    p.shaping.passivityController = false;
    p.shaping.forceScale = 0.8;
    p.shaping.delayS = 0.0031;
    p.forceShare = 0.9;
    p.stiffnessShare = 0.7;
    p.clutchButton = -1;
    writeProfile(folder_, p);
    const Profile q = profileFor(info_, folder_);
    EXPECT_EQ(q.placing.deviceMm, p.placing.deviceMm);
    EXPECT_TRUE(q.placing.toothInDevice.coeffs().isApprox(p.placing.toothInDevice.coeffs(), 1e-15));
    EXPECT_EQ(q.placing.scale, 3.0);
    EXPECT_TRUE(q.placing.leftHanded);
    EXPECT_EQ(q.placing.headAngleDeg, 107.5);
    EXPECT_EQ(q.placing.headRollDeg, -12.0);
    EXPECT_EQ(q.placing.tipFromStylusMm, p.placing.tipFromStylusMm);
    EXPECT_TRUE(q.shaping.frictionCompensation);
    EXPECT_FALSE(q.shaping.passivityController);
    EXPECT_EQ(q.shaping.forceScale, 0.8);
    EXPECT_NEAR(q.shaping.delayS, 0.0031, 1e-15);
    EXPECT_EQ(q.forceShare, 0.9);
    EXPECT_EQ(q.stiffnessShare, 0.7);
    EXPECT_EQ(q.clutchButton, -1);
    // Limits are the device's, within the shares.
    EXPECT_NEAR(q.shaping.maxForceN, 0.9 * 3.3, 1e-12);
    EXPECT_NEAR(q.shaping.stiffnessNPerMm, 0.7 * info_.capability.maxStiffnessNPerMm, 1e-12);
}

TEST_F(ProfileTest, whereThereIsNoneWhatFitsTheModelHolds) {
    const Profile p = profileFor(info_, folder_);
    EXPECT_EQ(p.model, "Touch");
    EXPECT_EQ(p.shaping.frictionN, 0.26);
    EXPECT_FALSE(p.shaping.frictionCompensation);
    EXPECT_TRUE(p.shaping.passivityController);
    EXPECT_EQ(p.placing.scale, 1.0);
    EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(ProfileTest, oneOfAnotherDeviceIsRefusedByName) {
    writeProfile(folder_, defaultProfile(info_));
    const fs::path theirs = file();
    for (std::string link::DriverInfo::*member :
         {&link::DriverInfo::driver, &link::DriverInfo::model, &link::DriverInfo::serial}) {
        link::DriverInfo other = info_;
        other.*member = "another";
        try {
            (void)readProfile(theirs, other);
            FAIL();
        } catch (const core::Error& e) {
            EXPECT_EQ(e.id(), "profile-of-another-device");
            EXPECT_NE(e.problem().find("another"), std::string::npos);
            EXPECT_NE(e.remedy().find("calibrate"), std::string::npos);
        }
    }
}

TEST_F(ProfileTest, whatIsWrongIsToldWithItsLine) {
    const std::string head = kHead;
    EXPECT_NE(problem(head + "[placing]\nscael = 2\n").find("scael"), std::string::npos);
    EXPECT_NE(problem(head + "[placing]\nscale = 1.5\n").find("line 7"), std::string::npos);
    EXPECT_NE(problem(head + "[placing]\nhand = \"both\"\n").find("right or left"), std::string::npos);
    EXPECT_NE(problem(head + "[placing]\ndevice_mm = [1, 2]\n").find("three"), std::string::npos);
    EXPECT_NE(problem(head + "[placing]\ntooth_in_device = [1, 1, 0, 0]\n").find("quaternion"), std::string::npos);
    EXPECT_NE(problem(head + "[shaping]\nforce_scale = 3\n").find("0 to 2"), std::string::npos);
    EXPECT_NE(problem(head + "[limits]\nforce_share = 1.2\n").find("force_share"), std::string::npos);
    EXPECT_NE(problem(head + "[limits]\nmax_force_n = 9\n").find("max_force_n"), std::string::npos);
    EXPECT_NE(problem(head + "[buttons]\nclutch = 32\n").find("0 to 31"), std::string::npos);
    EXPECT_NE(problem("format = 2\n").find("format 1"), std::string::npos);
    EXPECT_NE(problem("").find("format 1"), std::string::npos);
    EXPECT_NE(problem("format = 1\n").find("whose"), std::string::npos);
    EXPECT_NE(problem("format = [").find("line 1"), std::string::npos);
    // Nothing but whose it is: the rest as by default.
    write(head);
    EXPECT_EQ(readProfile(file(), info_).placing.headAngleDeg, WorkspaceMapping{}.headAngleDeg);
}

TEST_F(ProfileTest, namesOfFilesAreTame) {
    EXPECT_EQ(profileFile("p", info_), fs::path("p") / "openhaptics-a-12-7.toml");
    info_.serial = "";
    EXPECT_EQ(profileFile("p", info_), fs::path("p") / "openhaptics-touch.toml");
    info_.model = "../../etc/passwd";
    EXPECT_EQ(profileFile("p", info_), fs::path("p") / "openhaptics-etc-passwd.toml");
    info_.model = "***";
    EXPECT_EQ(profileFile("p", info_), fs::path("p") / "openhaptics-device.toml");
}

TEST_F(ProfileTest, whatCouldNotBeReadIsNotWritten) {
    Profile p = defaultProfile(info_);
    p.placing.scale = 7.0;
    EXPECT_NE(test::errorOf([&] { writeProfile(folder_, p); }).find("scale"), std::string::npos);
    p = defaultProfile(info_);
    p.forceShare = 0.0;
    EXPECT_NE(test::errorOf([&] { writeProfile(folder_, p); }).find("force_share"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(ProfileTest, namesWithQuotesAndLineEndsComeBack) {
    info_.model = "A \"b\"\\c\n\td";
    writeProfile(folder_, defaultProfile(info_));
    EXPECT_EQ(profileFor(info_, folder_).model, info_.model);
}

TEST_F(ProfileTest, liesWhereTheDesktopKeepsSettings) {
    const char* before = std::getenv("XDG_CONFIG_HOME");
    const std::string kept = before ? before : "";
    ::setenv("XDG_CONFIG_HOME", "/somewhere", 1);
    EXPECT_EQ(profileFolder(), fs::path("/somewhere/handpiece/devices"));
    ::setenv("XDG_CONFIG_HOME", "relative", 1);
    const char* home = std::getenv("HOME");
    EXPECT_EQ(profileFolder(), fs::path(home ? home : "") / ".config/handpiece/devices");
    if (before)
        ::setenv("XDG_CONFIG_HOME", kept.c_str(), 1);
    else
        ::unsetenv("XDG_CONFIG_HOME");
}

}  // namespace
}  // namespace handpiece::workspace::profile_test
