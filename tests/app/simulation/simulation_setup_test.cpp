// SPDX-License-Identifier: Apache-2.0
// What a session says of its station: believed where it can be meant, refused where it cannot.
#include "handpiece/app/simulation/simulation_setup.h"

#include <gtest/gtest.h>

#include <regex>

#include "handpiece/base/core/error.h"
#include "live_session_fixture.h"

namespace handpiece::simulation::simulation_setup_test {
namespace {

/// The settings of a session in which the first `"key": VALUE` after `within` has another value.
std::string with(const std::string& key, const std::string& value, const std::string& within = "") {
    const std::string text = settingsJson(blockSettings());
    const std::size_t from = within.empty() ? 0 : text.find("\"" + within + "\"");
    const std::size_t at = text.find("\"" + key + "\": ", from), begin = at + key.size() + 4;
    EXPECT_NE(from, std::string::npos) << within;
    EXPECT_NE(at, std::string::npos) << key;
    std::size_t end = text.find_first_of(",}\n", begin);
    if (text[begin] == '[') end = text.find(']', begin) + 1;
    return text.substr(0, begin) + value + text.substr(end);
}

std::string problemOf(const std::string& text) {
    try {
        (void)settingsFromJson(text, "a session");
    } catch (const core::Error& e) {
        return e.what();
    }
    return {};
}

TEST(StationSettingsOfAStranger, AsTheyWereTheyAreRead) {
    const std::string text = settingsJson(blockSettings());
    EXPECT_EQ(problemOf(text), "");
    EXPECT_EQ(settingsJson(settingsFromJson(text, "a session")), text);
}

TEST(StationSettingsOfAStranger, TissuesThatCameAfterItAreAsShipped) {
    std::string text = settingsJson(blockSettings());
    const std::string whole = text;
    // Before the layers of caries: ten rows, in each of the two tables.
    const std::regex laterRow(",\\s*\"(demineralised-enamel|caries-[a-z-]+|stained-enamel|calculus)\": \\{[^}]*\\}");
    text = std::regex_replace(text, laterRow, "");
    const std::size_t feels = text.rfind("\"tissues\": [");
    ASSERT_NE(feels, std::string::npos);
    std::size_t end = feels;
    for (std::size_t row = 0; row <= cases::kFirstTissueCount; ++row)
        end = text.find(']', end + 1);
    const std::size_t tenth = text.rfind(']', end - 1);
    std::size_t close = end;
    for (std::size_t row = cases::kFirstTissueCount; row < cases::kTissueCount; ++row)
        close = text.find(']', close + 1);
    text.erase(tenth + 1, close - tenth - 1);
    EXPECT_EQ(text.find("calculus"), std::string::npos);
    EXPECT_LT(text.size(), whole.size());
    EXPECT_EQ(problemOf(text), "");
    EXPECT_EQ(settingsJson(settingsFromJson(text, "an old session")), whole);
    EXPECT_NE(problemOf(std::regex_replace(text, std::regex("\"restoration\": "), "\"filling\": ")), "");
}

TEST(StationSettingsOfAStranger, NoFigureIsUsedThatCannotBeMeant) {
    struct Bad {
        const char *key, *value, *within;
    };
    for (const auto& [key, value, within] : {
             Bad{"rate_hz", "0.0", ""},
             Bad{"rate_hz", "-1000.0", ""},
             Bad{"rate_hz", "1e300", ""},
             Bad{"voxel_mm", "0.0", "field"},
             Bad{"voxel_mm", "1e-9", "field"},
             Bad{"voxel_mm", "1e9", "field"},
             Bad{"voxel_mm", "null", "field"},
             Bad{"band_out_mm", "-1.0", "field"},
             Bad{"band_out_mm", "1e6", "field"},
             Bad{"band_in_mm", "1e6", "field"},
             Bad{"band_mm", "-0.1", "cut"},
             Bad{"reserve_bricks", "1e300", "cut"},
             Bad{"reserve_bricks", "-1", "cut"},
             Bad{"reserve_bricks", "18446744073709551615", "cut"},
             Bad{"edges", "99999999999", "ability"},
             Bad{"edges", "1e99", "ability"},
             Bad{"load_cap_n", "-1.0", "ability"},
             Bad{"free_speed_rpm", "-1.0", "drive"},
             Bad{"inertia_nmms2", "0.0", "drive"},
             Bad{"stiffness", "1.5", "tissues"},
             Bad{"stiffness", "-0.5", "tissues"},
             Bad{"damping", "1e9", "tissues"},
             Bad{"friction", "-1.0", "tissues"},
             Bad{"cutting", "1e9", "tissues"},
             Bad{"priority", "1e40", "tissues"},
             Bad{"priority", "2000000000", "tissues"},
             Bad{"colour", "[300, 0, 0]", "tissues"},
             Bad{"colour", "[-1, 0, 0]", "tissues"},
             Bad{"max_force_n", "-3.0", "device"},
             Bad{"max_force_n", "1e12", "device"},
             Bad{"max_stiffness_n_per_mm", "0.0", "device"},
             Bad{"max_force_slope_n_per_s", "0.0", "device"},
             Bad{"encoder_step_mm", "-1.0", "device"},
             Bad{"workspace_mm", "[1e30, 1.0, 1.0]", "device"},
             Bad{"driven_axes", "1000", "device"},
             Bad{"penalty_stiffness_n_per_mm", "1e9", "force"},
             Bad{"proxy_iterations", "1e12", "force"},
         })
        EXPECT_NE(problemOf(with(key, value, within)), "") << key << " = " << value;
    std::string outline = "[[0.0, 0.0, 0.5, 0.0]";
    for (int i = 0; i < 2000; ++i)
        outline += ", [0.5, 0.0, 0.5, 1.0]";
    const std::string text = settingsJson(blockSettings());
    const std::size_t at = text.find("\"outline_mm\": ") + 14, end = text.find("\"ability\"");
    EXPECT_NE(problemOf(text.substr(0, at) + outline + "], " + text.substr(end)).find("2001 pieces"),
              std::string::npos);
}

}  // namespace
}  // namespace handpiece::simulation::simulation_setup_test
