// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/sampled/field_row.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "handpiece/base/core/simd.h"
#include "tick/contact/contact_fixture.h"

namespace handpiece::contact::field_row_test {
namespace {

using core::Vec3;

TEST(FieldRow, lookupsAreThoseOfTheFieldAtEveryLevel) {
    std::vector<FieldLookup> all{simd_base::fieldLookup()};
#if defined(__x86_64__)
    if (core::simdLevel() >= core::SimdLevel::avx2) all.push_back(simd_avx2::fieldLookup());
    if (core::simdLevel() >= core::SimdLevel::avx512) all.push_back(simd_avx512::fieldLookup());
#endif
    std::mt19937_64 g(test::seed());
    const field::DistanceField& field = test::grooved().field;
    const field::FieldView view = field.view();
    double cosines[8], sines[8];
    for (int j = 0; j < 8; ++j) {
        cosines[j] = std::cos(0.4 * j);
        sines[j] = std::sin(0.4 * j);
    }
    int fine = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3 d = test::randomDirection(g), centre = d * (test::grooveRadius(d) + test::uniform(g, -0.5, 0.5)),
                   x = 0.2 * test::randomDirection(g), y = 0.2 * test::randomDirection(g);
        FieldRow row;
        for (int k = 0; k < 3; ++k) {
            row.centre[k] = centre[k];
            row.x[k] = x[k];
            row.y[k] = y[k];
        }
        row.cosines = cosines;
        row.sines = sines;
        float first[8];
        for (std::size_t level = 0; level < all.size(); ++level) {
            float distances[8];
            all[level](view, row, 0, distances);
            if (level == 0) std::memcpy(first, distances, sizeof first);
            EXPECT_EQ(std::memcmp(distances, first, sizeof distances), 0);
        }
        for (int j = 0; j < 8; ++j) {
            const Vec3 p = centre + cosines[j] * x + sines[j] * y;
            if (field.isFine(p)) {
                ++fine;
                EXPECT_NEAR(first[j], field.distance(p), 1e-6);
            } else {
                EXPECT_GT(std::abs(first[j]), kBoundMm - 1.0f);
                EXPECT_EQ(first[j] < 0.0f, field.distance(p) < 0.0);
            }
        }
    }
    EXPECT_GT(fine, 1000);
}

}  // namespace
}  // namespace handpiece::contact::field_row_test
