// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/contact/exact/sheet_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tick/contact/contact_fixture.h"

namespace handpiece::contact::sheet_kernels_test {
namespace {

using core::Vec3;
constexpr int kCells = 64, kPlaces = 20;

/// Small flat cells anywhere within a few millimetres, all of them open.
struct Cells {
    std::array<std::vector<float>, 4> x, y, z, corner;
    std::vector<float> lowRadius, highRadius, upper = std::vector<float>(kCells, 1e3f);

    explicit Cells(std::mt19937_64& g) {
        for (std::vector<float>& each : corner)
            each.assign(kCells, 1e3f);
        for (int i = 0; i < kCells; ++i) {
            const Vec3 middle = test::anywhere(g), u = test::uniform(g, 0.01, 0.1) * test::randomDirection(g),
                       v = test::uniform(g, 0.01, 0.1) * test::randomDirection(g);
            for (std::size_t k = 0; k < 4; ++k) {
                const Vec3 p = middle + (k < 2 ? -1.0 : 1.0) * u + (k % 2 == 0 ? -1.0 : 1.0) * v;
                x[k].push_back(static_cast<float>(p.x()));
                y[k].push_back(static_cast<float>(p.y()));
                z[k].push_back(static_cast<float>(p.z()));
            }
            lowRadius.push_back(static_cast<float>(test::uniform(g, 0.0, 0.5)));
            highRadius.push_back(static_cast<float>(test::uniform(g, 0.0, 0.5)));
        }
    }
    SheetCells view() {
        SheetCells v{};
        for (std::size_t k = 0; k < 4; ++k) {
            v.x[k] = x[k].data();
            v.y[k] = y[k].data();
            v.z[k] = z[k].data();
            v.corner[k] = corner[k].data();
        }
        v.lowRadius = lowRadius.data();
        v.highRadius = highRadius.data();
        v.upper = upper.data();
        v.count = kCells;
        return v;
    }
    /// Between the corners.
    [[nodiscard]] Vec3 at(std::size_t i, double s, double t) const {
        const auto corner3 = [&](std::size_t k) { return Vec3(x[k][i], y[k][i], z[k][i]); };
        return (1 - s) * ((1 - t) * corner3(0) + t * corner3(1)) + s * ((1 - t) * corner3(2) + t * corner3(3));
    }
};

LowerCells kernelOf(core::SimdLevel level) {
    return HANDPIECE_AT_SIMD_LEVEL(level, lowerCells)();
}

TEST(SheetKernels, noBallOfACellIsDeeperThanItsBound) {
    std::mt19937_64 g(test::seed());
    for (int round = 0; round < 50; ++round) {
        Cells cells(g);
        struct Place {
            float at[3];
            float freeMm;
        };
        std::vector<Place> places;
        const Vec3 about = cells.at(0, 0.5, 0.5);
        HighestCell top{};
        for (int i = 0; i < kPlaces; ++i) {
            const Vec3 p = about + test::uniform(g, 0.1, 2.0) * test::randomDirection(g);
            places.push_back({{static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())},
                              i % 5 == 4 ? static_cast<float>(test::uniform(g, 0.0, 1.0)) : 0.0f});
            top = kernelOf(core::simdLevel())(cells.view(), places.back().at, places.back().freeMm, -1e3f);
        }
        EXPECT_EQ(top.upper, *std::max_element(cells.upper.begin(), cells.upper.end()));
        EXPECT_EQ(cells.upper[static_cast<std::size_t>(top.cell)], top.upper);
        for (std::size_t i = 0; i < kCells; ++i) {
            double alone = 1e3;  // the best that one place alone allows over the whole cell
            for (const Place& p : places) {
                double most = -1e3;
                for (std::size_t k = 0; k < 4; ++k)
                    most = std::max(
                        most, (k < 2 ? cells.lowRadius : cells.highRadius)[i] +
                                  (Vec3(cells.x[k][i], cells.y[k][i], cells.z[k][i]) - Vec3(p.at[0], p.at[1], p.at[2]))
                                      .norm() -
                                  p.freeMm);
                alone = std::min(alone, most);
            }
            EXPECT_LE(cells.upper[i], alone + 3e-5) << i;
            for (int n = 0; n < 20; ++n) {
                const double s = test::uniform(g, 0.0, 1.0), t = test::uniform(g, 0.0, 1.0);
                const double radius = (1 - s) * cells.lowRadius[i] + s * cells.highRadius[i];
                double depth = 1e3;
                for (const Place& p : places)
                    depth = std::min(depth, radius + (cells.at(i, s, t) - Vec3(p.at[0], p.at[1], p.at[2])).norm() -
                                                static_cast<double>(p.freeMm));
                EXPECT_LE(depth, cells.upper[i]) << i;
            }
        }
    }
}

TEST(SheetKernels, aMeanOfTwoPlacesBoundsMoreTightlyThanEither) {
    std::mt19937_64 g(test::seed());
    Cells cells(g);
    // On both sides of the cell in its own direction: each alone allows more at the far end.
    const Vec3 middle = cells.at(0, 0.5, 0.5), along = cells.at(0, 0.5, 1.0) - cells.at(0, 0.5, 0.0);
    cells.lowRadius[0] = cells.highRadius[0] = 0.1f;
    for (const double side : {-1.0, 1.0}) {
        const Vec3 p = middle + side * 0.7 * along.normalized();
        const float at[3] = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
        kernelOf(core::simdLevel())(cells.view(), at, 0.0f, -1e3f);
    }
    const double across = (cells.at(0, 1.0, 0.5) - cells.at(0, 0.0, 0.5)).norm();
    EXPECT_LE(cells.upper[0], 0.1 + 0.7 + 0.05 * along.norm() + 0.5 * across);
}

TEST(SheetKernels, everyInstructionSetGivesTheSameBits) {
    const std::vector<core::SimdLevel> levels = test::levels();
    if (levels.size() == 1) GTEST_SKIP() << "this processor has one level only";
    std::mt19937_64 g(test::seed());
    const Cells start(g);
    std::vector<Cells> all(levels.size(), start);
    for (int i = 0; i < kPlaces; ++i) {
        const Vec3 p = test::anywhere(g);
        const float at[3] = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
        const float freeMm = static_cast<float>(test::uniform(g, 0.0, 0.5)), floorMm = i < kPlaces / 2 ? -1e3f : 2.0f;
        const HighestCell first = kernelOf(levels[0])(all[0].view(), at, freeMm, floorMm);
        for (std::size_t level = 1; level < levels.size(); ++level) {
            const HighestCell other = kernelOf(levels[level])(all[level].view(), at, freeMm, floorMm);
            EXPECT_EQ(other.upper, first.upper);
            EXPECT_EQ(other.cell, first.cell);
            EXPECT_EQ(all[level].upper, all[0].upper);
            EXPECT_EQ(all[level].corner, all[0].corner);
        }
    }
}

}  // namespace
}  // namespace handpiece::contact::sheet_kernels_test
