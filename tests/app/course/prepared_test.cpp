// SPDX-License-Identifier: Apache-2.0
// A tooth that came with the program is the one that it would make, without the making; a changed one is made.
#include <gtest/gtest.h>

#include <cstdlib>

#include "handpiece/app/course/kept_cases.h"
#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/file.h"
#include "handpiece/base/prepared/prepared_files.h"
#include "support/random.h"

namespace handpiece::course::prepared_test {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kFaces = 2000;

/// What opening it comes to.
struct Opened {
    cases::Case tooth;
    simulation::SimulationSetup station;
    bool wasMade = false;
};

Opened open(const fs::path& cache) {
    ::setenv("XDG_CACHE_HOME", cache.c_str(), 1);
    Opened opened;
    opened.tooth = keptTooth(46, {}, kFaces, cache / "starter", {}, {[&] { opened.wasMade = true; }, {}, {}});
    simulation::SimulationSettings settings;
    settings.field = simulation::fieldSettingsAt(0.2);
    opened.station = simulation::makeSimulation(opened.tooth, std::move(settings), true);
    return opened;
}

class Prepared : public testing::Test {
  protected:
    void SetUp() override {
        fs::create_directories(folder());
        prepared::collectIn(folder());
        const test::TemporaryFolder cache;
        first_ = open(cache.path());
        prepared::collectIn({});
        for (const auto& entry : fs::directory_iterator(folder()))
            names_.push_back(entry.path().filename().string());
        for (const std::string& name : names_)
            hashes_.push_back(prepared::sha256Of(core::readFile(folder() / name)));
        for (std::size_t i = 0; i < names_.size(); ++i)
            believed_.push_back({names_[i], hashes_[i]});
        prepared::use(folder(), believed_, [this](const std::string& problem) { told_.push_back(problem); });
    }
    void TearDown() override { prepared::use({}, {}, {}); }
    [[nodiscard]] fs::path folder() const { return work_.path() / "prepared"; }

    const test::TemporaryFolder work_;
    Opened first_;
    std::vector<std::string> names_, hashes_, told_;
    std::vector<prepared::Believed> believed_;
};

TEST_F(Prepared, IsTheSameToothWithoutTheMaking) {
    ASSERT_TRUE(first_.wasMade);
    ASSERT_EQ(names_.size(), 3u) << "case, field, tissues";
    const test::TemporaryFolder cache;
    const Opened again = open(cache.path());
    EXPECT_FALSE(again.wasMade);
    EXPECT_TRUE(again.station.tooth->fromCache);
    EXPECT_EQ(cases::contentKey(again.tooth), cases::contentKey(first_.tooth));
    EXPECT_EQ(again.tooth.outer.triangles, first_.tooth.outer.triangles);
    EXPECT_EQ(again.station.identity(), first_.station.identity());
    EXPECT_EQ(again.station.tooth->fieldHash, first_.station.tooth->fieldHash);
    EXPECT_TRUE(told_.empty()) << told_[0];
    EXPECT_TRUE(fs::is_empty(cache.path())) << "what lies in the system's folder is not kept once more";
}

TEST_F(Prepared, AChangedByteIsToldAndItIsMadeAgain) {
    for (const std::string& name : names_) {
        std::vector<std::byte> bytes = core::readFile(folder() / name);
        bytes[bytes.size() / 2] ^= std::byte{1};
        core::writeFile(folder() / name, bytes);
    }
    const test::TemporaryFolder cache;
    const Opened again = open(cache.path());
    EXPECT_TRUE(again.wasMade);
    EXPECT_FALSE(again.station.tooth->fromCache);
    EXPECT_EQ(again.station.identity(), first_.station.identity());
    EXPECT_EQ(told_.size(), 1u);
}

TEST_F(Prepared, TheUsersOwnCacheIsAsBefore) {
    // Of other settings than those prepared: made, and kept for the next time.
    const test::TemporaryFolder cache;
    const Opened opened = open(cache.path());
    simulation::SimulationSettings settings;
    settings.field = simulation::fieldSettingsAt(0.25);
    EXPECT_FALSE(simulation::makeSimulation(opened.tooth, settings, true).tooth->fromCache);
    EXPECT_TRUE(simulation::makeSimulation(opened.tooth, settings, true).tooth->fromCache);
    EXPECT_TRUE(told_.empty());
}

}  // namespace
}  // namespace handpiece::course::prepared_test
