// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/exercise/school_defaults.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <regex>

#include "app/simulation/live_session_fixture.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/error.h"
#include "support/random.h"

namespace handpiece::exercise::school_defaults_test {
namespace {

namespace fs = std::filesystem;

class SchoolDefaultsFile : public testing::Test {
  protected:
    SchoolDefaults of(const std::string& text) {
        std::ofstream(file()) << text;
        return readSchoolDefaults(file());
    }
    [[nodiscard]] fs::path file() const { return folder_.path() / "settings.toml"; }
    test::TemporaryFolder folder_;
};

TEST_F(SchoolDefaultsFile, saysWhatItSaysAndNothingElse) {
    const SchoolDefaults d = of(R"([window]
language = "ja"
layout = "laboratory"
[hand]
device = "openhaptics"
left_handed = true
scale = 2
crisp = true
[tooth]
voxel_um = 60
[measure]
pulp_good_mm = 1
pulp_least_mm = 0.5
[folders]
sessions = "/srv/sessions"
cases = "~/cases"
[sessions]
record = false
[sound]
on = false
volume = 0.25
)");
    EXPECT_TRUE(d.problems.empty()) << d.problems.front();
    EXPECT_EQ(d.file, file());
    EXPECT_EQ(d.language, "ja");
    EXPECT_EQ(d.layout, "laboratory");
    EXPECT_EQ(d.device, "openhaptics");
    EXPECT_EQ(d.leftHanded, true);
    EXPECT_EQ(d.scale, 2.0);
    EXPECT_EQ(d.crisp, true);
    EXPECT_EQ(d.voxelUm, 60.0);
    EXPECT_EQ(d.pulpGoodMm, 1.0);
    EXPECT_EQ(d.pulpLeastMm, 0.5);
    EXPECT_EQ(d.sessionsFolder, fs::path("/srv/sessions"));
    EXPECT_EQ(d.casesFolder, fs::path(std::getenv("HOME")) / "cases");
    EXPECT_EQ(d.record, false);
    EXPECT_EQ(d.sound, false);
    EXPECT_EQ(d.volume, 0.25);

    const SchoolDefaults little = of("[sound]\nvolume = 1\n");
    EXPECT_EQ(little.volume, 1.0);
    EXPECT_FALSE(little.language || little.device || little.scale || little.record || little.sound || little.voxelUm);
    EXPECT_TRUE(of("# nothing\n").problems.empty());
    const SchoolDefaults wrongWayRound = of("[measure]\npulp_good_mm = 0.5\npulp_least_mm = 1\n");
    EXPECT_EQ(wrongWayRound.problems.size(), 1u);
    EXPECT_FALSE(wrongWayRound.pulpGoodMm || wrongWayRound.pulpLeastMm);
}

TEST_F(SchoolDefaultsFile, whatIsWrongIsToldWithItsLineAndTheRestHolds) {
    const SchoolDefaults d = of(R"([window]
language = "klingon"
layout = "laboratory"
[hand]
scale = 2.5
left_handed = "yes"
devize = "falcon"
device = "falcon"
[tooth]
voxel_um = 5000
[folders]
sessions = "here"
[colour]
)");
    EXPECT_EQ(d.layout, "laboratory");
    EXPECT_EQ(d.device, "falcon");
    EXPECT_FALSE(d.language || d.scale || d.leftHanded || d.voxelUm || d.sessionsFolder);
    ASSERT_EQ(d.problems.size(), 7u);
    const auto tells = [&](const char* word, const char* line) {
        return std::any_of(d.problems.begin(), d.problems.end(), [&](const std::string& p) {
            return p.find(word) != std::string::npos && p.find(line) != std::string::npos &&
                   p.find("settings.toml") != std::string::npos;
        });
    };
    EXPECT_TRUE(tells("klingon", "2"));
    EXPECT_TRUE(tells("scale", "5"));
    EXPECT_TRUE(tells("left_handed", "6"));
    EXPECT_TRUE(tells("devize", "7"));
    EXPECT_TRUE(tells("voxel_um", "10"));
    EXPECT_TRUE(tells("sessions", "12"));
    EXPECT_TRUE(tells("colour", "13"));
}

TEST_F(SchoolDefaultsFile, noFileIsNoProblemAndAnUnreadableOneIsOne) {
    EXPECT_TRUE(readSchoolDefaults(file()).problems.empty());
    EXPECT_TRUE(readSchoolDefaults({}).problems.empty());
    const SchoolDefaults broken = of("[window\nlanguage = ");
    ASSERT_EQ(broken.problems.size(), 1u);
    EXPECT_NE(broken.problems[0].find("settings.toml"), std::string::npos);
    fs::remove(file());
    fs::create_directory(file());
    EXPECT_EQ(readSchoolDefaults(file()).problems.size(), 1u);
    fs::remove(file());

    (void)of("[hand]\nscale = 3\n");
    setenv("HANDPIECE_SCHOOL_SETTINGS", file().c_str(), 1);
    EXPECT_EQ(schoolDefaults().scale, 3.0);
    setenv("HANDPIECE_SCHOOL_SETTINGS", "", 1);
    EXPECT_TRUE(schoolDefaults().file.empty());
    unsetenv("HANDPIECE_SCHOOL_SETTINGS");
}

TEST_F(SchoolDefaultsFile, theOneThatIsInstalledSaysNothingAndEachOfItsLinesIsGood) {
    const SchoolDefaults asInstalled = readSchoolDefaults(HANDPIECE_SETTINGS_SAMPLE);
    EXPECT_TRUE(asInstalled.problems.empty());
    EXPECT_FALSE(asInstalled.file.empty());
    EXPECT_FALSE(asInstalled.language || asInstalled.device || asInstalled.scale || asInstalled.record);
    std::ifstream sample(HANDPIECE_SETTINGS_SAMPLE);
    std::string all, line;
    while (std::getline(sample, line))
        all += (line.rfind("# ", 0) == 0 && line.find(" = ") != std::string::npos ? line.substr(2) : line) + "\n";
    const SchoolDefaults d = of(all);
    EXPECT_TRUE(d.problems.empty()) << d.problems.front();
    EXPECT_TRUE(d.language && d.layout && d.device && d.leftHanded && d.scale && d.crisp && d.voxelUm &&
                d.sessionsFolder && d.casesFolder && d.record && d.sound && d.volume);
}

TEST(SimulationSettings, keepKnockAndHumAndReadSessionsFromBeforeThem) {
    simulation::SimulationSettings settings = simulation::blockSettings();
    settings.parameters.transients = {true, 1.5};
    settings.parameters.vibration = {true, 0.25};
    const simulation::SimulationSettings back =
        simulation::settingsFromJson(simulation::settingsJson(settings), "here");
    EXPECT_TRUE(back.parameters.transients.on);
    EXPECT_EQ(back.parameters.transients.gain, 1.5);
    EXPECT_TRUE(back.parameters.vibration.on);
    EXPECT_EQ(back.parameters.vibration.gain, 0.25);

    const std::string now = simulation::settingsJson(settings);
    const std::regex both(R"(,\s*"transients": \{[^}]*\},\s*"vibration": \{[^}]*\})");
    ASSERT_TRUE(std::regex_search(now, both)) << now;
    const simulation::SimulationSettings before =
        simulation::settingsFromJson(std::regex_replace(now, both, ""), "here");
    EXPECT_FALSE(before.parameters.transients.on);
    EXPECT_FALSE(before.parameters.vibration.on);
    EXPECT_EQ(before.parameters.vibration.gain, 1.0);

    const std::string wrong = std::regex_replace(now, std::regex(R"("gain": 0\.25)"), "\"gain\": 99.0");
    ASSERT_NE(wrong, now);
    EXPECT_THROW((void)simulation::settingsFromJson(wrong, "here"), core::Error);
}

}  // namespace
}  // namespace handpiece::exercise::school_defaults_test
