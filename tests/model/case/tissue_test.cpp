// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/tissue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include "handpiece/base/config/table.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "support/random.h"

namespace handpiece::cases::tissue_test {
namespace {

TEST(Tissue, EveryNameLeadsBackToItsTissue) {
    for (std::size_t i = 1; i < kTissueCount; ++i) {
        const auto tissue = static_cast<Tissue>(i);
        EXPECT_EQ(tissueByName(properties(tissue).name), tissue);
    }
}

TEST(Tissue, AnUnknownNameSaysWhichThereAre) {
    try {
        (void)tissueByName("chalk");
        FAIL();
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("chalk"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("dentine"), std::string::npos);
    }
    EXPECT_THROW((void)tissueByName("none"), core::Error);
}

TEST(Tissue, FeelsInTheOrderOfItsHardness) {
    const auto k = [](Tissue t) { return properties(t).stiffnessFraction; };
    EXPECT_EQ(k(Tissue::none), 0.0);
    EXPECT_EQ(k(Tissue::enamel), 1.0);
    EXPECT_GT(k(Tissue::enamel), k(Tissue::dentine));
    EXPECT_GT(k(Tissue::dentine), k(Tissue::caries));
    EXPECT_GT(k(Tissue::caries), k(Tissue::pulp));
    EXPECT_GT(k(Tissue::pulp), 0.0);
    for (std::size_t i = 0; i < kTissueCount; ++i)
        EXPECT_LE(k(static_cast<Tissue>(i)), 1.0);
    // A lesion, a filling and the pulp are cut out of what surrounds them.
    for (const Tissue inner : {Tissue::caries, Tissue::pulp, Tissue::restoration})
        for (const Tissue around : {Tissue::enamel, Tissue::dentine, Tissue::cementum})
            EXPECT_GT(properties(inner).priority, properties(around).priority);
}

TEST(Tissue, TheFileGivesWhatWasMeasuredOfTheRates) {
    const auto k = [](Tissue t) { return properties(t).cuttingMm2PerN; };
    EXPECT_EQ(k(Tissue::none), 0.0);
    EXPECT_EQ(k(Tissue::enamel), 2.65e-5);
    EXPECT_EQ(k(Tissue::caries), 4e-4);
    // Dentine goes two to four times as fast as enamel.
    EXPECT_GE(k(Tissue::dentine) / k(Tissue::enamel), 2.0);
    EXPECT_LE(k(Tissue::dentine) / k(Tissue::enamel), 4.0);
    EXPECT_EQ(properties(Tissue::enamel).colour, (std::array<std::uint8_t, 3>{244, 241, 230}));
    for (std::size_t i = 1; i < kTissueCount; ++i) {
        const TissueProperties& p = properties(static_cast<Tissue>(i));
        EXPECT_GT(p.cuttingMm2PerN, 0.0) << p.name;
        EXPECT_GT(p.stiffnessFraction, 0.0) << p.name;
        EXPECT_GE(p.dampingNSPerMm, 0.002) << p.name;
        // What a tick adds to the energy (K T / 2, at 1 kHz and 0.5 N/mm) and b: nowhere more than in enamel.
        EXPECT_LE(0.5 * p.stiffnessFraction * 0.0005 + p.dampingNSPerMm, 0.5 * 0.0005 + 0.002 + 1e-12) << p.name;
        EXPECT_GT(p.friction, 0.0) << p.name;
        EXPECT_GT(p.priority, 0) << p.name;
    }
}

TEST(Tissue, CariousDentineIsOneGradientFromSoftToHard) {
    const TissueTable own = parseTissues("format = 1\n[caries-leathery]\nstiffness = 0.3\n", "mine.toml");
    for (const TissueTable& table : {builtInTissues(), own})
        for (std::size_t i = 0; i < kCariousLevels.size(); ++i) {
            const TissueProperties& soft = table.of(kCariousLevels[i]);
            const TissueProperties& hard =
                table.of(i + 1 < kCariousLevels.size() ? kCariousLevels[i + 1] : Tissue::dentine);
            // A Weber fraction of an eighth at least, of stiffness; an eighth of the rate too.
            EXPECT_GT(hard.stiffnessFraction, 1.125 * soft.stiffnessFraction) << soft.name;
            EXPECT_GT(soft.cuttingMm2PerN, 1.125 * hard.cuttingMm2PerN) << soft.name;
            EXPECT_GT(soft.friction, hard.friction) << soft.name;
            EXPECT_GT(soft.dampingNSPerMm, hard.dampingNSPerMm) << soft.name;
            EXPECT_GT(soft.priority, hard.priority) << soft.name;
            EXPECT_LT(soft.colour[1], hard.colour[1]) << soft.name;
            EXPECT_TRUE(isCarious(kCariousLevels[i]));
            EXPECT_LT(soft.priority, table.of(Tissue::pulp).priority);
        }
    EXPECT_NEAR(own.of(Tissue::cariesLeatheryToFirm).stiffnessFraction, std::sqrt(0.3 * 0.42), 1e-12);
    for (const Tissue sound : {Tissue::enamel, Tissue::dentine, Tissue::demineralisedEnamel, Tissue::stainedEnamel,
                               Tissue::calculus, Tissue::pulp, Tissue::restoration})
        EXPECT_FALSE(isCarious(sound));
    EXPECT_TRUE(isCarious(Tissue::caries));
    // A lesion of enamel ends where enamel does, and stain lies on whatever enamel is there.
    const auto priority = [](Tissue t) { return properties(t).priority; };
    EXPECT_GT(priority(Tissue::demineralisedEnamel), priority(Tissue::enamel));
    EXPECT_LT(priority(Tissue::demineralisedEnamel), priority(Tissue::cementum));
    EXPECT_GT(priority(Tissue::stainedEnamel), priority(Tissue::demineralisedEnamel));
    EXPECT_LT(priority(Tissue::calculus), priority(Tissue::enamel));
}

TEST(Tissue, EveryShippedValueHasItsSource) {
    const config::Table root = config::Table::read(std::filesystem::path(HANDPIECE_DATA_FOLDER) / "tissues.toml");
    for (const std::string& name : root.keys()) {
        if (name == "format") continue;
        const config::Table row = *root.table(name);
        ASSERT_EQ(row.keys().size(), 6u) << name;
        for (const std::string& key : row.keys()) {
            const auto source = row.table(key)->text("source");
            ASSERT_TRUE(source) << name << "." << key;
            const bool recalled = source->find("recalled") != std::string::npos;
            EXPECT_TRUE(!recalled || row.table(key)->flag("unchecked").value_or(false)) << name << "." << key;
        }
    }
}

TEST(Tissue, ATableOfOnesOwnGivesOnlyWhatDiffers) {
    const TissueTable t = parseTissues(
        "format = 1\n[enamel]\ncutting = 1e-5\ncolour = \"#010aff\"\n[caries]\npriority = 99\n"
        "stiffness = { value = 0.5, source = \"mine\" }\n",
        "mine.toml");
    EXPECT_EQ(t.of(Tissue::enamel).cuttingMm2PerN, 1e-5);
    EXPECT_EQ(t.of(Tissue::enamel).colour, (std::array<std::uint8_t, 3>{1, 10, 255}));
    EXPECT_EQ(t.of(Tissue::enamel).stiffnessFraction, 1.0);
    EXPECT_EQ(t.of(Tissue::caries).priority, 99);
    EXPECT_EQ(t.of(Tissue::caries).stiffnessFraction, 0.5);
    EXPECT_EQ(t.of(Tissue::dentine).cuttingMm2PerN, properties(Tissue::dentine).cuttingMm2PerN);
    const test::TemporaryFolder folder;
    core::writeFile(folder.path() / "t.toml", "format = 1\n[pulp]\nfriction = 0\n");
    EXPECT_EQ(readTissues(folder.path() / "t.toml").of(Tissue::pulp).friction, 0.0);
}

TEST(Tissue, AWrongTableIsToldWithLineTissueAndValue) {
    const auto error = [](const std::string& text) {
        try {
            (void)parseTissues("format = 1\n" + text, "mine.toml");
        } catch (const core::Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    const struct {
        const char *text, *one, *two;
    } cases[] = {
        {"[chalk]\ncutting = 1", "chalk", "dentine"},
        {"[enamel]\nhardness = 1", "\"hardness\"", "cutting"},
        {"[enamel]\ncutting = -1e-5", "cutting of enamel is -1e-05", "line 3"},
        {"[enamel]\ncutting = inf", "inf", "line 3"},
        {"[enamel]\ncutting = nan", "nan", "line 3"},
        {"[enamel]\ncutting = 7", "cutting of enamel is 7", "line 3"},
        {"[enamel]\nfriction = { value = -2 }", "friction of enamel is -2", "line 3"},
        {"[enamel]\nstiffness = 1.01", "stiffness of enamel is 1.01", "line 3"},
        {"[enamel]\ndamping = \"much\"", "wrong type", "line 3"},
        {"[enamel]\ndamping = { source = \"x\" }", "no value", "line 3"},
        {"[enamel]\ncolour = \"white\"", "\"white\"", "#rrggbb"},
        {"[enamel]\ncolour = \"#12345g\"", "#12345g", "#rrggbb"},
        {"[enamel]\npriority = 1.5", "wrong type", "line 3"},
        {"[enamel]\npriority = 123456", "123456", "1000"},
        {"enamel = 3", "wrong type", "line 2"},
    };
    for (const auto& c : cases) {
        const std::string what = error(c.text);
        EXPECT_NE(what.find(c.one), std::string::npos) << c.text << ": " << what;
        EXPECT_NE(what.find(c.two), std::string::npos) << c.text << ": " << what;
        EXPECT_NE(what.find("mine.toml"), std::string::npos) << what;
    }
    EXPECT_THROW((void)parseTissues("[enamel]\ncutting = 1e-5\n", "x"), core::Error) << "no format";
    EXPECT_THROW((void)parseTissues("format = 2\n", "x"), core::Error);
    EXPECT_THROW((void)readTissues("/nowhere/t.toml"), core::Error);
}

}  // namespace
}  // namespace handpiece::cases::tissue_test
