// SPDX-License-Identifier: Apache-2.0
// A few of measures_study's random preparations: each measure within what is asked of it, each fault found.
#include <gtest/gtest.h>

#include "assess/measures/trials.h"

namespace handpiece::measures::trials_test {
namespace {

TEST(Trials, everyMeasureWithinItsBound) {
    std::mt19937_64 random(handpiece::test::seed() + 11);
    test::Lab lab(0.1, random);
    test::Table table;
    for (int kind = 0; kind < 6; ++kind)
        for (int i = 0; i < 2; ++i)
            lab.make(static_cast<test::Kind>(kind)).judge(table);
    test::print(table);
    // As asked, by unit; a share of volume apart.
    const std::pair<const char*, double> bounds[] = {
        {"isthmus mm", 0.05}, {"isthmus-share %", 1.2}, {"outline-extent mm", 0.05},
        {"removed %", 0.5},   {"removed-share %", 0.1}, {"margin-continuity", 0.0},
        {"proximal", 0.05},   {"margin-width", 0.05},   {"ridge", 0.05}};
    for (const auto& [name, errors] : table) {
        EXPECT_TRUE(errors.missing.empty()) << name << ": " << errors.missing.front();
        // Of marked walls and of an uneven margin the angle and the height are only known to what is stated.
        const bool isOpen = name.find("angle") != std::string::npos || name.find("convergence") != std::string::npos ||
                            name.find("molar") != std::string::npos;
        double bound = name.find(" um") != std::string::npos    ? 3.0
                       : name.find(" deg") != std::string::npos ? 0.5
                                                                : 0.03;
        for (const auto& [part, value] : bounds)
            if (name.find(part) != std::string::npos) bound = value;
        for (std::size_t i = 0; i < errors.error.size(); ++i)
            EXPECT_LE(std::abs(errors.error[i]), isOpen ? bound + 2.0 * errors.stated[i] : bound) << name;
    }
}

TEST(Trials, eachFaultIsFoundAndNothingElse) {
    std::mt19937_64 random(handpiece::test::seed() + 12);
    test::Lab lab(0.1, random);
    for (const test::Kind kind : {test::Kind::classOne, test::Kind::classTwo})
        for (int fault = 0; fault < test::kFaults; ++fault) {
            const auto found = findings(lab.makeRight(kind, static_cast<test::Fault>(fault)));
            for (int other = 1; other < test::kFaults; ++other)
                EXPECT_EQ(found[static_cast<std::size_t>(other)].isFound, other == fault)
                    << test::kKindNames[static_cast<int>(kind)] << ", made: " << test::kFaultNames[fault]
                    << ", asked: " << test::kFaultNames[other];
        }
}

}  // namespace
}  // namespace handpiece::measures::trials_test
