// SPDX-License-Identifier: Apache-2.0
// Where a server's settings come from, and which counts.
#include "school/school_settings.h"

#include <gmock/gmock.h>

#include <map>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"

namespace handpiece::school_cli::settings_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SchoolSettingsTest : public testing::Test {
  protected:
    SchoolSettings settle(SchoolSettings given = {}) const {
        return settled(
            std::move(given),
            [this](const char* name) {
                const auto found = environment_.find(name);
                return found == environment_.end() ? nullptr : found->second.c_str();
            },
            system_);
    }
    std::string errorOf(SchoolSettings given = {}) const {
        try {
            (void)settle(std::move(given));
        } catch (const core::Error& e) {
            return e.what();
        }
        return "no error";
    }
    std::string file(const std::string& name, const std::string& text) const {
        core::writeFile(folder_.path() / name, text);
        return (folder_.path() / name).string();
    }
    core::PrivateFolder folder_;
    std::map<std::string, std::string> environment_;
    std::string system_;
};

TEST_F(SchoolSettingsTest, TheCommandLineCountsBeforeTheEnvironmentBeforeTheFile) {
    EXPECT_EQ(settle().data, "school");
    EXPECT_EQ(settle().listen, "127.0.0.1:8620");
    EXPECT_EQ(settle().workers, 1u);
    EXPECT_EQ(settle().connections, 60u);
    system_ =
        file("system.toml", "data = \"/system\"\nlisten = \"0.0.0.0:1\"\nworkers = 3\ndatabase = \"postgresql://x\"\n");
    EXPECT_EQ(settle().data, "/system");
    EXPECT_EQ(settle().workers, 3u);
    environment_["HANDPIECE_SCHOOL_DATA"] = "/environment";
    environment_["HANDPIECE_SCHOOL_WORKERS"] = "0";
    environment_["HANDPIECE_SCHOOL_CONNECTIONS"] = "20";
    EXPECT_EQ(settle().connections, 20u);
    EXPECT_EQ(settle().data, "/environment");
    EXPECT_EQ(settle().workers, 0u);
    EXPECT_EQ(settle().listen, "0.0.0.0:1") << "the rest is still the file's";
    EXPECT_EQ(settle().database, "postgresql://x");
    SchoolSettings given;
    given.data = "/line", given.workers = 7;
    EXPECT_EQ(settle(given).data, "/line");
    EXPECT_EQ(settle(given).workers, 7u);
    // Another file in the place of the system's.
    environment_["HANDPIECE_SCHOOL_SETTINGS"] = file("own.toml", "listen = \"[::1]:2\"\n");
    EXPECT_EQ(settle().listen, "[::1]:2");
    EXPECT_EQ(settle().database, "");
    given.file = file("named.toml", "listen = \"h:3\"\n");
    EXPECT_EQ(settle(given).listen, "h:3");
}

TEST_F(SchoolSettingsTest, WhatIsWrongIsToldWithItsPlace) {
    SchoolSettings given;
    given.file = file("a.toml", "lisen = \"x\"\n");
    EXPECT_THAT(errorOf(given), AllOf(HasSubstr("a.toml"), HasSubstr("lisen")));
    given.file = file("a.toml", "\n\nworkers = 1000\n");
    EXPECT_THAT(errorOf(given), AllOf(HasSubstr("line 3"), HasSubstr("0 to 64")));
    given.file = file("a.toml", "connections = 0\n");
    EXPECT_THAT(errorOf(given), AllOf(HasSubstr("line 1"), HasSubstr("1 to 1000")));
    given.file = file("a.toml", "data = 3\n");
    EXPECT_THAT(errorOf(given), AllOf(HasSubstr("line 1"), HasSubstr("data")));
    given.file = file("a.toml", "data = \n");
    EXPECT_THAT(errorOf(given), HasSubstr("line 1"));
    given.file = "/nowhere/at/all.toml";
    EXPECT_THAT(errorOf(given), HasSubstr("/nowhere/at/all.toml"));
    environment_["HANDPIECE_SCHOOL_WORKERS"] = "many";
    EXPECT_THAT(errorOf(), AllOf(HasSubstr("HANDPIECE_SCHOOL_WORKERS"), HasSubstr("many")));
}

}  // namespace
}  // namespace handpiece::school_cli::settings_test
