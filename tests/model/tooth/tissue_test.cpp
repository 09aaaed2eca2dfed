// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/tooth/tissue.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "handpiece/base/core/error.h"

namespace handpiece::tooth {
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

}  // namespace
}  // namespace handpiece::tooth
