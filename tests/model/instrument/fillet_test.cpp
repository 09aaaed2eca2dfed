// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/instrument/fillet.h"

#include <gtest/gtest.h>

#include <cmath>

#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/shapes.h"

namespace handpiece::instrument {
namespace {

TEST(Fillet, roundsTheRimOfACylinderAndNothingElse) {
    const Bur sharp = makeBur("cylinder-flat:1.0x3.0");
    const Bur round = filleted(sharp, 0.05);
    EXPECT_NO_THROW(validate(round.profile()));
    // On the rim's bisector: the corner stands (sqrt 2 - 1) R out of the fillet.
    EXPECT_NEAR(round.signedDistance({0.5, 0.0, 0.0}), (std::sqrt(2.0) - 1.0) * 0.05, 1e-6);
    for (const auto& p : {core::Vec3(0, 0, 0), core::Vec3(0.4, 0, 0), core::Vec3(0.5, 0, 0.1), core::Vec3(0.5, 0, 1.5)})
        EXPECT_NEAR(round.signedDistance(p), 0.0, 1e-9) << p.transpose();
}

TEST(Fillet, liesInTheBurAndDiffersFromItAtCornersAlone) {
    constexpr double kRadius = 0.05;
    for (const CatalogueEntry& entry : catalogue()) {
        SCOPED_TRACE(entry.name);
        const Bur sharp = makeBur(entry.name), round = filleted(sharp, kRadius);
        EXPECT_NO_THROW(validate(round.profile()));
        EXPECT_NEAR(round.lengthMm(), sharp.lengthMm(), kRadius);
        int differing = 0, all = 0;
        for (double z = -0.1; z < sharp.lengthMm() + 0.1; z += 0.013)
            for (double rho = 0.0; rho < sharp.maxRadiusMm() + 0.1; rho += 0.013) {
                const double a = sharp.signedDistance({rho, 0, z}), b = round.signedDistance({rho, 0, z});
                EXPECT_GE(b, a - 2e-5) << rho << " " << z;  // never out of the bur
                EXPECT_LE(b, a + kRadius) << rho << " " << z;
                ++all;
                differing += std::abs(b - a) > 1e-4;
            }
        EXPECT_LT(differing, 0.25 * all);
    }
    const Bur ball = makeBur("round-4");
    EXPECT_LE(filleted(ball, kRadius).profile().pieces.size(), ball.profile().pieces.size() + 1);
}

}  // namespace
}  // namespace handpiece::instrument
