// SPDX-License-Identifier: Apache-2.0
// Crown preparations with a closed form: truncated cones with a chamfer, out of a turned cylinder.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "assess/measures/analytic.h"

namespace handpiece::measures::crown_test {
namespace {

using handpiece::test::uniform;
using test::Body;
using test::Cone;
using test::Table;
using test::Vec3;

TEST(Crown, conesWithAChamferInTurnedGrids) {
    std::mt19937_64 random(handpiece::test::seed() + 5);
    const char* asked = std::getenv("HANDPIECE_MEASURES");
    const int each = asked != nullptr ? std::atoi(asked) : 1;
    for (const double voxel : {0.1, 0.05}) {
        const Body body = test::bodyOf(test::cylinderMesh(3.2, -2.0, 4.0), test::randomPose(random), voxel);
        Table table;
        for (int i = 0; i < each; ++i) {
            Cone cone;
            cone.halfDeg = uniform(random, 1.0, 14.0);
            cone.widthMm = uniform(random, 0.5, 1.1);
            cone.occlusalMm = uniform(random, 0.8, 1.6);
            cone.chamferMm = uniform(random, 0.1, 0.45);
            cone.edgeMm = uniform(random, 0.05, 0.25);
            const auto cut = test::carved(body, cone);
            Preparation p;
            p.whole = body.model;
            p.cut = cut.get();
            p.axes = body.axes();
            Selection occlusalSide, mesial;
            occlusalSide.side = "occlusal";
            mesial.side = "mesial";
            const auto got = measure(p, std::vector<Request>{{"occlusal-convergence"},
                                                             {"margin-width"},
                                                             {"reduction", occlusalSide},
                                                             {"axial-depth", mesial},
                                                             {"wall-height"},
                                                             {"wall-angle"},
                                                             {"margin-continuity"},
                                                             {"undercut-area"},
                                                             {"floor-depth"}});
            table["occlusal-convergence deg"].add(got[0], 2.0 * cone.halfDeg);
            table["margin-width mm"].add(got[1], cone.widthMm);
            table["reduction occlusal mm"].add(got[2], cone.occlusalMm);
            // Between what is gone at the margin and at the wall's top.
            ASSERT_TRUE(got[3].value) << got[3].reason;
            EXPECT_GT(*got[3].value, cone.widthMm - 0.05);
            EXPECT_LT(*got[3].value, cone.outerMm - cone.radiusAt(cone.topMm - cone.occlusalMm) + 0.2);
            table["wall-angle deg"].add(got[5], cone.halfDeg);
            EXPECT_EQ(got[6].value, 100.0);
            EXPECT_EQ(got[7].value, 0.0);
            EXPECT_FALSE(got[8].value);
            EXPECT_FALSE(got[8].reason.empty());
        }
        std::printf("voxel %.3f mm\n", voxel);
        test::print(table);
        for (const auto& [name, errors] : table)
            EXPECT_TRUE(errors.missing.empty()) << name << ": " << errors.missing.front();
        const std::pair<const char*, double> most[] = {{"occlusal-convergence deg", 0.5},
                                                       {"margin-width mm", 0.05},
                                                       {"reduction occlusal mm", 0.03},
                                                       {"wall-angle deg", 0.5}};
        for (const auto& [name, bound] : most)
            for (const double error : table.at(name).error)
                EXPECT_LE(std::abs(error), bound) << name;
    }
}

}  // namespace
}  // namespace handpiece::measures::crown_test
