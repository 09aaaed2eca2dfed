// SPDX-License-Identifier: Apache-2.0
// The bur's shadow on enamel: soft, grey, and nothing that one would take for caries.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "handpiece/senses/view/renderer.h"
#include "support/closed_meshes.h"

namespace handpiece::view::shadow_test {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr Viewport kSize{320, 200};

struct Rgb {
    int r, g, b;
    [[nodiscard]] int bright() const { return r + g + b; }
};

enum class Shown { nothing, bur, burAndShadow };

/// A slab of one tissue, from above and a little in front, with a bur of 1.2 mm so far over it.
Image slab(Tissue tissue, double burMm, Shown shown) {
    Renderer renderer;
    geometry::TriangleMesh mesh;
    mesh.vertices = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    renderer.setMesh(mesh, tissue);
    renderer.setBur(test::sphereMesh(3, 0.6, {0.0, 0.0, 0.6}), 1.2, 0.6, BurFinish::plain);
    Camera camera;
    camera.eyeMm = {0.0, -6.0, 30.0};
    camera.targetMm = Vec3::Zero();
    camera.up = Vec3::UnitY();
    Look look;
    look.bur = shown != Shown::nothing;
    look.shadows = shown == Shown::burAndShadow;
    Moment moment;
    moment.burInTooth.positionMm = {0.0, -0.5, burMm};
    Image image;
    for (int i = 0; i < 6 && renderer.draw(camera, kSize, look, moment, image).refining; ++i) {
    }
    return image;
}

TEST(Shadow, OfTheBurOnEnamelIsGreyAndNoCaries) {
    for (const double burMm : {0.02, 0.3, 1.5}) {  // touching, near, above
        const Image bare = slab(Tissue::enamel, burMm, Shown::nothing),
                    bright = slab(Tissue::enamel, burMm, Shown::bur),
                    shaded = slab(Tissue::enamel, burMm, Shown::burAndShadow);
        Rgb darkest{255, 255, 255}, unshaded{};
        int darker = 0, brighter = 0;
        for (std::size_t i = 0; i < bright.rgba.size(); i += 4) {
            if (!std::equal(&bare.rgba[i], &bare.rgba[i] + 3, &bright.rgba[i])) continue;  // the bur itself
            const Rgb was{bright.rgba[i], bright.rgba[i + 1], bright.rgba[i + 2]},
                is{shaded.rgba[i], shaded.rgba[i + 1], shaded.rgba[i + 2]};
            brighter += is.bright() > was.bright() + 12 ? 1 : 0;
            if (is.bright() + 12 > was.bright()) continue;
            ++darker;
            if (is.bright() < darkest.bright()) darkest = is, unshaded = was;
        }
        std::printf("[ shadow ] %.2f mm over enamel: %d %d %d where it was %d %d %d, in %d pixels\n", burMm, darkest.r,
                    darkest.g, darkest.b, unshaded.r, unshaded.g, unshaded.b, darker);
        EXPECT_GT(darker, 60) << burMm;
        EXPECT_EQ(brighter, 0) << burMm;
        // It is seen, and a part of the light is left.
        EXPECT_LT(darkest.bright(), 0.85 * unshaded.bright()) << burMm;
        EXPECT_GT(darkest.bright(), 0.5 * unshaded.bright()) << burMm;
        // Bluer than enamel in the light, not browner.
        EXPECT_LT(darkest.r - darkest.b, 10) << burMm;
        EXPECT_LT(1.0 * darkest.r / darkest.b, 1.0 * unshaded.r / unshaded.b) << burMm;
    }
    // Carious dentine under the same lamp is brown at every level.
    for (const Tissue level : cases::kCariousLevels) {
        const Image carious = slab(level, 1.5, Shown::nothing);
        const std::uint8_t* p = carious.at(kSize.width * 3 / 8, kSize.height / 2);
        EXPECT_GT(p[0] - p[2], 15) << cases::properties(level).name;
    }
}

}  // namespace
}  // namespace handpiece::view::shadow_test
