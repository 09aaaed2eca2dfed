// SPDX-License-Identifier: Apache-2.0
// Teeth around the one that is worked on, cut by a plane: nested balls against their circles, and what one sees.
#include "handpiece/senses/view/slice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "handpiece/base/core/rotation.h"
#include "support/closed_meshes.h"

namespace handpiece::view::slice_test {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr double kEnamelMm = 4.0, kDentineMm = 3.0, kPulpMm = 1.0, kPixelMm = 0.05;
constexpr int kLevel = 5;  // of the balls' meshes: within 3 um of round

/// Balls in each other, somewhere and turned somehow.
cases::PlacedTooth ball() {
    cases::PlacedTooth tooth;
    tooth.outer = test::sphereMesh(kLevel, kEnamelMm);
    tooth.parts = {{"enamel", Tissue::enamel, 0, test::sphereMesh(kLevel, kEnamelMm)},
                   {"dentine", Tissue::dentine, 1, test::sphereMesh(kLevel, kDentineMm)},
                   {"pulp", Tissue::pulp, 2, test::sphereMesh(kLevel, kPulpMm)}};
    tooth.inCase.positionMm = {12.0, -1.0, 0.5};
    tooth.inCase.orientation = core::rotationBetween(Vec3::UnitZ(), Vec3(0.3, -0.5, 0.8).normalized());
    return tooth;
}

TEST(Slice, TissuesLieWhereTheirCirclesAre) {
    const cases::PlacedTooth tooth = ball();
    for (const double off : {0.0, 0.7, 3.5}) {
        const Vec3 normal = Vec3(0.2, 1.0, -0.4).normalized();
        const Plane plane{normal, normal.dot(tooth.inCase.positionMm) + off};
        const auto face = sliceOf(tooth, plane, kPixelMm);
        ASSERT_TRUE(face.has_value());
        ASSERT_EQ(face->tissue.size(), static_cast<std::size_t>(face->width) * static_cast<std::size_t>(face->height));
        const auto radius = [&](double of) { return of > off ? std::sqrt(of * of - off * off) : 0.0; };
        const double enamel = radius(kEnamelMm), dentine = radius(kDentineMm), pulp = radius(kPulpMm);
        int counted = 0;
        double farthest = 0.0;
        for (int y = 0; y < face->height; ++y)
            for (int x = 0; x < face->width; ++x) {
                const Vec3 p = face->originMm + kPixelMm * (x * face->uAxis + y * face->vAxis);
                ASSERT_NEAR(normal.dot(p), plane.offsetMm, 1e-9);
                const double r = (p - tooth.inCase.positionMm - off * normal).norm();
                const auto at =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(face->width) + static_cast<std::size_t>(x);
                double toOther = 1e9;
                for (const double each : {enamel, dentine, pulp})
                    if (each > 0.0) toOther = std::min(toOther, std::abs(r - each));
                const double toSurface = std::abs(r - enamel);
                const Tissue expected = r < pulp      ? Tissue::pulp
                                        : r < dentine ? Tissue::dentine
                                        : r < enamel  ? Tissue::enamel
                                                      : Tissue::none;
                counted += face->tissue[at] != 0 ? 1 : 0;
                if (toOther > 0.01) {
                    ASSERT_EQ(face->tissue[at], static_cast<std::uint8_t>(expected)) << r;
                }
                // Told in 32nds of a pixel, up to three.
                if (toOther < 2.5 * kPixelMm) {
                    farthest = std::max(farthest, std::abs(face->away[at][0] / 32.0 * kPixelMm - toOther));
                }
                if (toSurface < 2.5 * kPixelMm)
                    farthest = std::max(farthest, std::abs(face->away[at][1] / 32.0 * kPixelMm - toSurface));
            }
        EXPECT_NEAR(counted * kPixelMm * kPixelMm, std::numbers::pi * enamel * enamel, 0.01 * enamel * enamel);
        std::printf("[ slice ] %.1f mm off the middle: distances to boundaries within %.1f um\n", off, 1e3 * farthest);
        EXPECT_LT(farthest, 0.01);
    }
}

TEST(Slice, APlaneBesideAToothAndATissueThatNobodyKnowsGiveNone) {
    cases::PlacedTooth tooth = ball();
    EXPECT_FALSE(sliceOf(tooth, {Vec3::UnitX(), 12.0 + kEnamelMm + 0.01}, kPixelMm).has_value());
    EXPECT_TRUE(sliceOf(tooth, {Vec3::UnitX(), 12.0}, kPixelMm).has_value());
    tooth.parts.clear();
    EXPECT_FALSE(sliceOf(tooth, {Vec3::UnitX(), 12.0}, kPixelMm).has_value());
}

struct Rgb {
    int r, g, b;
};

class CutThrough : public testing::Test {
  protected:
    void show(const cases::PlacedTooth& tooth) {
        renderer_.setMesh(test::sphereMesh(4, kEnamelMm), Tissue::enamel);
        renderer_.setOthers(std::make_shared<const std::vector<cases::PlacedTooth>>(1, tooth));
        renderer_.setScenery(std::vector<cases::Part>{
            {"other", Tissue::neighbour, 0, geometry::transformed(tooth.outer, tooth.inCase), true}});
        look_.bur = look_.turbine = look_.shadows = false;
        moment_.burShown = false;
        camera_.eyeMm = {6.0, -50.0, 0.0};
        camera_.targetMm = {6.0, 0.0, 0.0};
        for (int i = 0; i < 6 && renderer_.draw(camera_, kSize, look_, moment_, image_).refining; ++i) {
        }
    }
    [[nodiscard]] Rgb at(const Vec3& point) const {
        const auto pixel = pixelOf(camera_, kSize, point);
        const std::uint8_t* p = image_.at(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()));
        return {p[0], p[1], p[2]};
    }

    static constexpr Viewport kSize{480, 240};
    Renderer renderer_;
    Look look_;
    Moment moment_;
    Camera camera_;
    Image image_;
};

TEST_F(CutThrough, AnotherToothShowsItsTissuesAndOneOfWhichNoneAreKnownItsOwnColour) {
    cases::PlacedTooth tooth = ball();
    const Vec3 middle = tooth.inCase.positionMm;
    look_.cutAway = Plane{-Vec3::UnitY(), 1.0};  // through the middle of the other one
    show(tooth);
    const Rgb pulp = at(middle), dentine = at(middle + Vec3(0.0, 0.0, 2.0)), enamel = at(middle + Vec3(0.0, 0.0, 3.5));
    std::printf("[ section ] pulp %d %d %d, dentine %d %d %d, enamel %d %d %d\n", pulp.r, pulp.g, pulp.b, dentine.r,
                dentine.g, dentine.b, enamel.r, enamel.g, enamel.b);
    EXPECT_GT(pulp.r, pulp.g + 60);
    EXPECT_GT(dentine.r, dentine.b + 60);
    EXPECT_GT(enamel.g, dentine.g + 20);
    EXPECT_LT(enamel.r - enamel.b, 30);

    tooth.parts.clear();
    show(tooth);
    // As enamel's face, not as plaster in the shade: that was 178.
    for (const double z : {0.0, 2.0, 3.5}) {
        const Rgb surface = at(middle + Vec3(0.0, 0.0, z));
        EXPECT_NEAR(surface.r, enamel.r, 3) << z;
        EXPECT_NEAR(surface.b, enamel.b, 3) << z;
    }
}

}  // namespace
}  // namespace handpiece::view::slice_test
