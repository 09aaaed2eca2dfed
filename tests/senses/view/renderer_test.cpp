// SPDX-License-Identifier: Apache-2.0
// Pictures against what is known of the scene: where a point must appear and in which colour, what hides what, and that
// a picture does not depend on those before it.
#include "handpiece/senses/view/renderer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/tooth/state_delta.h"
#include "support/closed_meshes.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::view::renderer_test {
namespace {

using cases::Tissue;
using core::Vec3;
using surface::BrickMesh;
using surface::BrickUpdate;

constexpr Viewport kSize{320, 200};

/// A square of n x n cells in the plane z = height, facing up.
std::shared_ptr<BrickMesh> square(double x, double y, double sideMm, double zMm, Tissue tissue, int n = 8) {
    auto mesh = std::make_shared<BrickMesh>();
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            mesh->vertices.push_back({{static_cast<float>(x + sideMm * i / n), static_cast<float>(y + sideMm * j / n),
                                       static_cast<float>(zMm)},
                                      {0.0f, 0.0f, 1.0f},
                                      tissue});
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto a = static_cast<std::uint16_t>(j * (n + 1) + i), b = static_cast<std::uint16_t>(a + n + 1);
            mesh->triangles.push_back({a, static_cast<std::uint16_t>(a + 1), static_cast<std::uint16_t>(b + 1)});
            mesh->triangles.push_back({a, static_cast<std::uint16_t>(b + 1), b});
        }
    return mesh;
}

BrickUpdate brick(std::uint32_t dense, std::shared_ptr<const BrickMesh> mesh) {
    return {dense, false, std::move(mesh), nullptr, nullptr};
}

/// A table of 8 x 8 squares of 1 mm: enamel for x < 0, dentine beyond, one of caries at (1..2, 1..2).
std::vector<BrickUpdate> table() {
    std::vector<BrickUpdate> bricks;
    for (int j = -4; j < 4; ++j)
        for (int i = -4; i < 4; ++i) {
            const Tissue tissue = i == 1 && j == 1 ? Tissue::caries : i < 0 ? Tissue::enamel : Tissue::dentine;
            bricks.push_back(brick(static_cast<std::uint32_t>((j + 4) * 8 + i + 4), square(i, j, 1.0, 0.0, tissue)));
        }
    return bricks;
}

core::Box box(double half, double low, double high) {
    return {Vec3(-half, -half, low), Vec3(half, half, high)};
}

Camera above() {
    Camera camera;
    camera.eyeMm = {0.0, -6.0, 30.0};
    camera.targetMm = Vec3::Zero();
    camera.up = Vec3::UnitY();
    return camera;
}

geometry::TriangleMesh rod(double radiusMm, double lengthMm) {
    geometry::TriangleMesh mesh;
    constexpr int kSides = 24;
    for (const double z : {0.0, lengthMm})
        for (int k = 0; k < kSides; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / kSides;
            mesh.vertices.emplace_back(radiusMm * std::cos(angle), radiusMm * std::sin(angle), z);
        }
    for (std::uint32_t k = 0; k < kSides; ++k) {
        const std::uint32_t next = (k + 1) % kSides;
        mesh.triangles.push_back({k, next, next + kSides});
        mesh.triangles.push_back({k, next + kSides, k + kSides});
        if (k > 1) mesh.triangles.push_back({0, k, k - 1});
    }
    return mesh;
}

struct Rgb {
    int r, g, b;
};
Rgb at(const Image& image, const Camera& camera, const Vec3& point, const Viewport& size = kSize) {
    const auto pixel = pixelOf(camera, size, point);
    if (!pixel) {
        ADD_FAILURE() << "the point is not in the picture";
        return {};
    }
    const std::uint8_t* p = image.at(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()));
    return {p[0], p[1], p[2]};
}
int brightness(const Rgb& c) {
    return c.r + c.g + c.b;
}

Look plainLook() {
    Look look;
    look.shadows = false;
    return look;
}

Image picture(Renderer& renderer, const Camera& camera, const Look& look, const Moment& moment,
              const Viewport& size = kSize) {
    Image image;
    // Until nothing is refined any more.
    for (int i = 0; i < 6 && renderer.draw(camera, size, look, moment, image).refining; ++i) {
    }
    return image;
}

Moment withoutBur() {
    Moment moment;
    moment.burShown = false;
    return moment;
}

void expectSame(const Image& a, const Image& b) {
    const ImageDifference difference = compareImages(a, b, 0);
    EXPECT_EQ(difference.largest, 0.0) << "share of pixels that differ: " << difference.differingShare;
}

TEST(Renderer, TellsWhatItDrawsWith) {
    const Renderer renderer;
    EXPECT_NE(renderer.description().find("OpenGL"), std::string::npos);
}

TEST(Renderer, AnEmptySceneIsItsBackground) {
    Renderer renderer;
    Look look;
    look.backgroundTop = look.backgroundBottom = {40, 80, 120};
    const Image image = picture(renderer, above(), look, withoutBur());
    ASSERT_EQ(image.width, kSize.width);
    for (const int x : {0, 319})
        for (const int y : {0, 199}) {
            EXPECT_NEAR(image.at(x, y)[0], 40, 10);
            EXPECT_NEAR(image.at(x, y)[2], 120, 27);
        }
}

TEST(Renderer, KnownPointsHaveTheirTissuesColour) {
    for (const Palette palette : {Palette::natural, Palette::textbook}) {
        Renderer renderer;
        renderer.setTooth(box(4.0, -1.0, 1.0));
        renderer.updateBricks(table(), true);
        Look look = plainLook();
        look.palette = palette;
        const Camera camera = above();
        const Image image = picture(renderer, camera, look, withoutBur());
        const Rgb enamel = at(image, camera, {-2.5, 0.5, 0.0}), dentine = at(image, camera, {2.5, -1.5, 0.0}),
                  caries = at(image, camera, {1.5, 1.5, 0.0});
        EXPECT_GT(brightness(enamel), brightness(dentine));
        EXPECT_GT(brightness(dentine), brightness(caries) + 150);
        // Dentine is yellow, enamel nearly white.
        EXPECT_GT(dentine.r - dentine.b, enamel.r - enamel.b + 20);
        // Beside the table there is none.
        EXPECT_LT(brightness(at(image, camera, {-5.0, 0.5, 0.0})), 260);
    }
}

TEST(Renderer, TheTopOfThePictureIsItsFirstRow) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    const std::vector<BrickUpdate> one = {brick(0, square(-1.0, 2.0, 2.0, 0.0, Tissue::enamel))};
    renderer.updateBricks(one, true);
    const Image image = picture(renderer, above(), plainLook(), withoutBur());
    int upper = 0, lower = 0;
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x)
            (y < kSize.height / 2 ? upper : lower) += image.at(x, y)[0] > 120 ? 1 : 0;
    EXPECT_GT(upper, 100);
    EXPECT_EQ(lower, 0);
}

TEST(Renderer, AMirroredPictureIsThePlainOneTurnedOver) {
    Renderer renderer;
    renderer.setTooth(box(4, -1, 1));
    renderer.updateBricks(table(), true);
    renderer.setBur(rod(0.4, 5.0), 1.0, 0.4);
    Moment moment;
    moment.burInTooth.positionMm = {2.0, 0.5, 0.2};
    Camera camera = above();
    Image plain, mirrored;
    renderer.draw(camera, kSize, plainLook(), moment, plain);
    camera.mirrored = true;
    renderer.draw(camera, kSize, plainLook(), moment, mirrored);
    int differ = 0;
    double apart = 0.0;
    for (int y = 0; y < kSize.height; ++y)
        for (int x = 0; x < kSize.width; ++x) {
            const std::uint8_t *a = plain.at(x, y), *b = mirrored.at(kSize.width - 1 - x, y), *c = mirrored.at(x, y);
            differ += std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) > 12 ? 1 : 0;
            apart += std::abs(a[0] - c[0]);
        }
    EXPECT_LT(differ, kSize.width * kSize.height / 100);
    EXPECT_GT(apart / (kSize.width * kSize.height), 2.0) << "and another than that";
}

TEST(Renderer, TheNearerSurfaceHides) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 3.0));
    auto bricks = table();
    bricks.push_back(brick(100, square(-3.0, -1.0, 2.0, 2.0, Tissue::caries)));
    bricks.push_back(brick(101, square(1.0, -1.0, 2.0, -2.0, Tissue::caries)));
    renderer.updateBricks(bricks, true);
    const Camera camera = above();
    const Image image = picture(renderer, camera, plainLook(), withoutBur());
    EXPECT_LT(brightness(at(image, camera, {-2.0, 0.0, 2.0})) + 150, brightness(at(image, camera, {2.0, 0.0, 0.0})));
}

TEST(Renderer, TheBurIsBeforeTheToothAndBehindIt) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.updateBricks(table(), true);
    renderer.setBur(rod(0.8, 4.0), 4.0, 0.8);
    const Camera camera = above();
    Moment moment;
    moment.burInTooth.positionMm = {-2.0, 0.0, 1.0};
    const Image without = picture(renderer, camera, plainLook(), withoutBur());
    const Image over = picture(renderer, camera, plainLook(), moment);
    moment.burInTooth.positionMm.z() = -20.0;
    const Image under = picture(renderer, camera, plainLook(), moment);
    EXPECT_GT(compareImages(without, over).differingShare, 0.004);
    expectSame(without, under);
}

/// Half of a handpiece's head, as wide as it, over the bur's tip.
geometry::TriangleMesh head() {
    geometry::TriangleMesh mesh = rod(5.2, 12.0);
    const auto low = static_cast<std::uint32_t>(mesh.vertices.size() / 2);
    for (std::uint32_t k = 2; k < low; ++k)
        mesh.triangles.push_back({low, low + k - 1, low + k});
    for (Vec3& v : mesh.vertices)
        v.z() += 9.0;
    return mesh;
}

TEST(Renderer, TheToothIsSeenThroughWhatLiesOverTheBursTip) {
    for (const Quality quality : {Quality::fast, Quality::fine, Quality::rich}) {
        Renderer renderer;
        renderer.setTooth(box(4.0, -1.0, 1.0));
        renderer.updateBricks(table(), true);
        renderer.setBur(rod(0.5, 1.6), 1.6, 0.5, BurFinish::plain);
        renderer.setTurbine(head());
        Camera camera = above();
        camera.eyeMm = {0.5, -1.0, 45.0};
        Look look = plainLook();
        look.quality = quality;
        Moment moment;
        moment.burInTooth.positionMm = {0.0, 0.0, 0.2};
        const Image without = picture(renderer, camera, look, withoutBur());
        const Image over = picture(renderer, camera, look, moment);
        // Enamel is enamel and dentine dentine, beside the tip and farther; caries is still the darkest.
        const Vec3 caries(1.5, 1.5, 0.0);
        for (const Vec3& p : {Vec3(-1.5, 0.5, 0.0), Vec3(-2.5, -1.5, 0.0), Vec3(2.5, -1.5, 0.0), caries})
            EXPECT_NEAR(brightness(at(over, camera, p)), brightness(at(without, camera, p)), 75) << p.transpose();
        EXPECT_LT(brightness(at(over, camera, caries)) + 150, brightness(at(over, camera, {2.5, -1.5, 0.0})));
        // No rim and no veil of the handpiece lies over it; the bur is there, as an outline.
        look.turbine = false;
        const Image bare = picture(renderer, camera, look, moment);
        // (A fine picture is smoothed where instruments may be: a hundredth of it, by a step or two.)
        EXPECT_LT(compareImages(bare, over, 0).differingShare, 0.02);
        EXPECT_GT(compareImages(without, over, 4).differingShare, 0.0005);
    }
}

TEST(Renderer, AHandpieceBesideTheSightIsMetal) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.updateBricks(table(), true);
    renderer.setBur(rod(0.5, 1.6), 1.6, 0.5, BurFinish::plain);
    Camera camera = above();
    camera.targetMm = {0.0, 0.0, 7.0};
    camera.eyeMm = {0.0, -40.0, 14.0};
    Moment moment;
    moment.burInTooth.positionMm = {0.0, 0.0, 0.2};
    Look look = plainLook();
    look.backgroundTop = look.backgroundBottom = {0, 0, 0};
    renderer.setTurbine(head());
    const Image dark = picture(renderer, camera, look, moment);
    look.backgroundTop = look.backgroundBottom = {255, 255, 255};
    const Image bright = picture(renderer, camera, look, moment);
    for (const double z : {3.0, 6.0, 8.0, 11.0})
        EXPECT_EQ(brightness(at(dark, camera, {0.0, 0.0, z})), brightness(at(bright, camera, {0.0, 0.0, z}))) << z;
}

// From beside to along the bur in small steps: no picture jumps.
TEST(Renderer, TheHandpieceTurnsToGlassSmoothly) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.setBur(rod(0.5, 1.6), 1.6, 0.5, BurFinish::plain);
    renderer.setTurbine(head());
    Look look = plainLook();
    look.quality = Quality::rich;  // no other picture while the eye moves
    look.backgroundTop = look.backgroundBottom = {255, 255, 255};
    Moment moment;
    Camera camera;
    camera.targetMm = {0.0, 0.0, 6.0};
    Image last, image;
    double most = 0.0, all = 0.0;
    constexpr int kSteps = 300;
    for (int i = 0; i <= kSteps; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / kSteps;
        camera.eyeMm = camera.targetMm + 45.0 * Vec3(0.02, -std::cos(angle), std::sin(angle));
        camera.up = Vec3(0.0, std::sin(angle), std::cos(angle));
        renderer.draw(camera, kSize, look, moment, image);
        if (i > 0) {
            const double step = compareImages(last, image, 0).rms;
            most = std::max(most, step);
            all += step;
        }
        last = image;
    }
    EXPECT_GT(all, 20.0);
    EXPECT_LT(most, 12.0);
}

TEST(Renderer, ABurOfOnesOwnIsPlainSteelUnlessItsAbilitySaysMore) {
    const instrument::Bur own("mine.STL", instrument::makeBur("330").profile());
    EXPECT_EQ(finishOf(own), BurFinish::plain);
    EXPECT_EQ(finishOf(own, instrument::CuttingParameters{}.name), BurFinish::plain);
    EXPECT_EQ(finishOf(own, "carbide-cross-cut"), BurFinish::carbide);
    EXPECT_EQ(finishOf(own, "diamond-coarse"), BurFinish::diamond);
    EXPECT_EQ(finishOf(instrument::makeBur("pear:0.8x1.6")), BurFinish::diamond) << "a shape of no catalogue";
    for (const auto& entry : instrument::catalogue()) {
        const instrument::Bur bur = *instrument::makeInstrument(entry.name).bur;
        const BurFinish expected = entry.cuttingParameters.starts_with("carbide") ? BurFinish::carbide
                                   : entry.cuttingParameters == "steel"           ? BurFinish::steel
                                                                                  : BurFinish::diamond;
        EXPECT_EQ(finishOf(bur), expected) << entry.name;
    }
}

TEST(Renderer, TheBurThrowsAShadow) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.updateBricks(table(), true);
    renderer.setBur(rod(0.6, 4.0), 4.0, 0.6);
    const Camera camera = above();
    Moment moment;
    moment.burInTooth.positionMm = {-2.0, 0.0, 1.2};
    Look look = plainLook();
    const Image bright = picture(renderer, camera, look, moment);
    look.shadows = true;
    const Image shaded = picture(renderer, camera, look, moment);
    int darker = 0, brighter = 0;
    for (std::size_t i = 0; i < bright.rgba.size(); i += 4) {
        darker += shaded.rgba[i] + 12 < bright.rgba[i] ? 1 : 0;
        brighter += shaded.rgba[i] > bright.rgba[i] + 12 ? 1 : 0;
    }
    EXPECT_GT(darker, 100);
    EXPECT_EQ(brighter, 0);
}

TEST(Renderer, APictureDoesNotDependOnThoseBefore) {
    for (const Quality quality : {Quality::fast, Quality::fine, Quality::rich}) {
        Look look;
        look.quality = quality;
        Moment moment;
        moment.speedRpm = 0.0;
        const Camera camera = above();
        const auto cut = [] {
            std::vector<BrickUpdate> changed = {brick(27, square(-1.0, -1.0, 1.0, -0.6, Tissue::dentine)),
                                                brick(28, nullptr),
                                                brick(90, square(0.0, -1.0, 1.0, -0.8, Tissue::pulp))};
            return changed;
        };
        const auto prepare = [&](Renderer& renderer) {
            renderer.setTooth(box(4.0, -1.0, 1.0));
            renderer.updateBricks(table(), true);
            renderer.setBur(rod(0.5, 3.0), 3.0, 0.5);
        };
        moment.burInTooth.positionMm = {0.4, -0.3, 0.2};
        Renderer fresh;
        prepare(fresh);
        fresh.updateBricks(cut());
        Image expected;
        fresh.draw(camera, kSize, look, moment, expected);

        Renderer used;
        prepare(used);
        Image image;
        Moment elsewhere = moment;
        for (int i = 0; i < 5; ++i) {
            elsewhere.burInTooth.positionMm = {0.5 * i - 2.0, 0.2 * i, 0.4};
            used.draw(camera, kSize, look, elsewhere, image);
        }
        used.draw(orbited(camera, 0.3, 0.1), kSize, look, elsewhere, image);
        used.draw(camera, {200, 150}, look, elsewhere, image);
        for (int i = 0; i < 5; ++i)
            used.draw(camera, kSize, look, elsewhere, image);
        const auto half = cut();
        used.updateBricks(std::span(half).first(1));
        EXPECT_EQ(used.draw(camera, kSize, look, elsewhere, image).toothRedrawn, quality == Quality::rich);
        used.updateBricks(std::span(half).subspan(1));
        used.draw(camera, kSize, look, moment, image);
        expectSame(expected, image);
    }
}

TEST(Renderer, ImagesUsedByTurnsHoldWhatAFreshOneWould) {
    std::mt19937_64 random(test::seed());
    const auto chance = [&](double share) { return test::uniform(random, 0.0, 1.0) < share; };
    Look look;
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.updateBricks(table(), true);
    renderer.setBur(rod(0.5, 3.0), 3.0, 0.5);
    Camera camera = above();
    std::array<Image, 3> images;
    images[1].blueFirst = images[2].blueFirst = true;
    int compared = 0;
    Moment moment;
    for (int i = 0; i < 60; ++i) {
        moment.timeS += 1.0 / 60.0;
        moment.speedRpm = 300000.0;
        moment.water = i / 20 == 1;
        if (chance(0.8))
            moment.burInTooth.positionMm = {test::uniform(random, -3.0, 3.0), test::uniform(random, -3.0, 3.0), 0.4};
        if (chance(0.1)) camera = orbited(camera, 0.1, 0.05);
        look.quality = chance(0.1) ? Quality::rich : Quality::fast;
        // One of them lies unused for longer than is remembered.
        Image& image = images[i < 40 ? static_cast<std::size_t>(i % 2) : 2 - static_cast<std::size_t>(i % 2)];
        const Viewport size = i % 29 == 28 ? Viewport{200, 150} : kSize;
        // The picture after one in motion is smoothed otherwise.
        if (renderer.draw(camera, size, look, moment, image).refining) continue;
        ++compared;
        Image whole;
        whole.blueFirst = image.blueFirst;
        renderer.draw(camera, size, look, moment, whole);
        ASSERT_EQ(image.rgba, whole.rgba) << "picture " << i;
        if (!image.blueFirst) continue;
        Image redFirst;
        renderer.draw(camera, size, look, moment, redFirst);
        for (std::size_t k = 0; k < whole.rgba.size(); k += 4) {
            ASSERT_EQ(redFirst.rgba[k], whole.rgba[k + 2]);
            ASSERT_EQ(redFirst.rgba[k + 1], whole.rgba[k + 1]);
            ASSERT_EQ(redFirst.rgba[k + 2], whole.rgba[k]);
        }
    }
    EXPECT_GT(compared, 20);
}

TEST(Renderer, BeforeAndGhostShowWhatWasCutAway) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.updateBricks(table(), true);
    const Camera camera = above();
    Look look = plainLook();
    const Image uncut = picture(renderer, camera, look, withoutBur());
    const std::vector<BrickUpdate> gone = {brick(27, nullptr), brick(28, nullptr), brick(35, nullptr),
                                           brick(36, nullptr)};
    renderer.updateBricks(gone);
    const Image cut = picture(renderer, camera, look, withoutBur());
    const Vec3 hole(0.0, 0.0, 0.0);
    EXPECT_GT(brightness(at(uncut, camera, hole)), brightness(at(cut, camera, hole)) + 150);
    look.tooth = ToothShown::before;
    expectSame(uncut, picture(renderer, camera, look, withoutBur()));
    look.tooth = ToothShown::ghost;
    const Image ghost = picture(renderer, camera, look, withoutBur());
    EXPECT_GT(brightness(at(ghost, camera, hole)), brightness(at(cut, camera, hole)) + 20);
    EXPECT_LT(brightness(at(ghost, camera, hole)), brightness(at(uncut, camera, hole)) - 20);
}

TEST(Renderer, LipsAndCheeksAreHeldAsideUnlessAskedFor) {
    Renderer renderer;
    renderer.setTooth(box(4, -1, 1));
    renderer.updateBricks(table(), true);
    const Vec3 middle(1.5, 1.5, 0.0);
    Image without, held, seen;
    renderer.draw(above(), kSize, plainLook(), {}, without);
    renderer.setScenery(
        std::vector<cases::Part>{{"left-cheek", Tissue::gum, 0, test::boxMesh({-4, -4, 4}, {4, 4, 5}), true}});
    renderer.draw(above(), kSize, plainLook(), {}, held);
    EXPECT_EQ(brightness(at(held, above(), middle)), brightness(at(without, above(), middle)));
    Look look = plainLook();
    look.cheeks = true;
    renderer.draw(above(), kSize, look, {}, seen);
    EXPECT_NE(brightness(at(seen, above(), middle)), brightness(at(without, above(), middle)));
}

/// A tooth in bone and gingiva that is higher mesial of it than its crown's middle, with an adjacent tooth mesial.
std::vector<cases::Part> mouthAround() {
    return {{"other", Tissue::neighbour, 0, test::boxMesh({4.2, -3, -8}, {10, 3, 2})},
            {"bone", Tissue::bone, 0, test::boxMesh({-20, -5, -12}, {20, 5, -4})},
            {"gingiva", Tissue::gum, 0, test::boxMesh({-20, -6, -14}, {20, 6, -2})},
            {"papilla", Tissue::gum, 0, test::boxMesh({6, -5, -3}, {12, 5, 1.5})}};
}
Camera fromMesial() {
    Camera camera;
    camera.eyeMm = {30.0, 0.0, 1.0};
    camera.targetMm = {0.0, 0.0, -4.0};
    return camera;
}
bool isRed(const Rgb& c) {
    return c.r > c.g + 30 && c.r > c.b + 30;
}

TEST(Renderer, FromMesialWhatSurroundsAToothEndsBeforeItsProximalSide) {
    Renderer renderer;
    renderer.setMesh(test::boxMesh({-4, -4, -8}, {4, 4, 2}), Tissue::enamel);
    renderer.setScenery(mouthAround());
    renderer.setBur(rod(0.8, 4.0), 4.0, 0.8);
    const Vec3 crown(4.0, 0.0, 0.0), gum(4.05, 5.5, -6.0), deeper(4.05, -5.5, -9.0), bone(4.05, 4.5, -6.0);
    for (const Quality quality : {Quality::fast, Quality::fine, Quality::rich})
        for (const bool mirrored : {false, true}) {
            SCOPED_TRACE(static_cast<int>(quality) * 2 + (mirrored ? 1 : 0));
            Look look;
            look.quality = quality;
            Camera camera = fromMesial();
            camera.mirrored = mirrored;
            const Image image = picture(renderer, camera, look, withoutBur());
            const Rgb tooth = at(image, camera, crown), cut = at(image, camera, gum), cutBone = at(image, camera, bone);
            std::printf("[ section ] tooth %d %d %d, gingiva %d %d %d, bone %d %d %d\n", tooth.r, tooth.g, tooth.b,
                        cut.r, cut.g, cut.b, cutBone.r, cutBone.g, cutBone.b);
            EXPECT_FALSE(isRed(tooth));
            EXPECT_GT(brightness(tooth), 250);  // nothing that is left out throws a shadow on it
            // One colour all over, whatever lies behind.
            EXPECT_TRUE(isRed(cut));
            const Rgb lower = at(image, camera, deeper);
            EXPECT_EQ(brightness(cut), brightness(lower));
            EXPECT_GT(cutBone.g, cut.g + 20);
            // What is held before it stays.
            Moment moment;
            moment.burInTooth.positionMm = {9.0, 0.0, -2.0};
            EXPECT_NE(brightness(at(picture(renderer, camera, look, moment), camera, {9.8, 0.0, 0.0})),
                      brightness(at(image, camera, {9.8, 0.0, 0.0})));
        }
}

TEST(Renderer, OnlyAnAdjacentToothInTheWayEndsWhatSurroundsATooth) {
    Renderer renderer;
    renderer.setMesh(test::boxMesh({-4, -4, -8}, {4, 4, 2}), Tissue::enamel);
    renderer.setScenery(mouthAround());
    const Look look = plainLook();
    Camera distal = fromMesial(), buccal = fromMesial();
    distal.eyeMm.x() = -30.0;
    buccal.eyeMm = {0.0, -30.0, 8.0};
    const Rgb papilla = at(picture(renderer, buccal, look, withoutBur()), buccal, {8.0, -5.0, 0.0});
    EXPECT_TRUE(isRed(papilla));
    // Distal there is none: the gingiva's end, lit as a surface is.
    const Image whole = picture(renderer, distal, look, withoutBur());
    std::vector<cases::Part> noOther = mouthAround();
    noOther.erase(noOther.begin());
    renderer.setScenery(noOther);
    expectSame(picture(renderer, distal, look, withoutBur()), whole);
    // Without the tooth, mesial gingiva hides the crown again.
    EXPECT_TRUE(isRed(at(picture(renderer, fromMesial(), look, withoutBur()), fromMesial(), {4.0, 0.0, 0.0})));
}

TEST(Renderer, FromOcclusalTheOtherJawIsLeftOutWhereTheJawsAreClosed) {
    Renderer renderer;
    renderer.setMesh(test::boxMesh({-4, -4, -8}, {4, 4, 2}), Tissue::enamel);
    std::vector<cases::Part> closed = mouthAround();
    for (const double x : {0.0, 9.0})  // antagonists, of which one is in the way, and what they stand in
        closed.push_back({"antagonist", Tissue::neighbour, 0, test::boxMesh({x - 4, -4, 1.5}, {x + 4, 4, 12})});
    closed.push_back({"upper gingiva", Tissue::gum, 0, test::boxMesh({-20, -6, 9}, {20, 6, 20})});
    renderer.setScenery(closed);
    const Look look = plainLook();
    Camera over = above(), buccal = fromMesial();
    over.eyeMm = {0.0, -3.0, 60.0};
    buccal.eyeMm = {0.0, -60.0, 4.0};
    buccal.targetMm = {0.0, 0.0, 4.0};
    const Image image = picture(renderer, over, look, withoutBur());
    EXPECT_FALSE(isRed(at(image, over, {1.0, 1.0, 2.0})));
    EXPECT_GT(brightness(at(image, over, {1.0, 1.0, 2.0})), 250);
    // Its own jaw is there, as without the other one.
    renderer.setScenery(mouthAround());
    expectSame(picture(renderer, over, look, withoutBur()), image);
    // From buccal both jaws are seen.
    renderer.setScenery(closed);
    EXPECT_TRUE(isRed(at(picture(renderer, buccal, look, withoutBur()), buccal, {0.0, -6.0, 10.0})));
}

TEST(Renderer, AnAdjacentToothThatWasCutIsLeftOutToo) {
    Renderer renderer;
    renderer.setTooth({{-4, -4, -8}, {4, 4, 2}});
    std::vector<BrickUpdate> bricks = table();  // the crown's top at 0
    renderer.updateBricks(bricks, true);
    renderer.setScenery(mouthAround());
    Camera camera = fromMesial();
    camera.eyeMm.z() = 5.0;
    const Look look = plainLook();
    const Vec3 place(3.5, 0.0, 0.0);
    const Image before = picture(renderer, camera, look, withoutBur());
    EXPECT_FALSE(isRed(at(before, camera, place)));
    EXPECT_GT(brightness(at(before, camera, place)), 300);
    // From now on in bricks: a wall before the tooth.
    BrickUpdate wall = brick((1u << tooth::kDenseBits) | 5u, square(4.5, -3.0, 6.0, 1.9, Tissue::enamel));
    wall.isUncut = true;
    BrickUpdate foot = brick((1u << tooth::kDenseBits) | 6u, square(4.5, -3.0, 6.0, -7.0, Tissue::enamel));
    foot.isUncut = true;
    renderer.updateBricks(std::vector<BrickUpdate>{wall, foot});
    expectSame(picture(renderer, camera, look, withoutBur()), before);
}

TEST(Renderer, ATissueThatIsNotVisibleIsNotDrawn) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.updateBricks(table(), true);
    const Camera camera = above();
    Look look = plainLook();
    look.visible[static_cast<std::size_t>(Tissue::enamel)] = false;
    const Image image = picture(renderer, camera, look, withoutBur());
    EXPECT_LT(brightness(at(image, camera, {-2.5, 0.5, 0.0})), 260);
    EXPECT_GT(brightness(at(image, camera, {2.5, 0.5, 0.0})), 330);
}

TEST(Renderer, ACutAwayEndsAtItsPlaneAndShowsTheSectionsFace) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -3.0, 1.0));
    renderer.updateBricks(table(), true);
    Camera camera;
    camera.eyeMm = {0.0, -20.0, 20.0};
    Look look = plainLook();
    look.cutAway = Plane{-Vec3::UnitY(), 1.0};  // what is nearer than y = -1 goes
    Image image = picture(renderer, camera, look, withoutBur());
    EXPECT_LT(brightness(at(image, camera, {2.5, -2.5, 0.0})), 260);
    EXPECT_GT(brightness(at(image, camera, {2.5, 1.0, 0.0})), 330);
    SectionFace face;
    face.plane = *look.cutAway;
    face.originMm = {-3.0, -1.0, -3.0};
    face.uAxis = Vec3::UnitX();
    face.vAxis = Vec3::UnitZ();
    face.mmPerPixel = 0.1;
    face.width = 61;
    face.height = 31;
    face.tissue.assign(61 * 31, static_cast<std::uint8_t>(Tissue::pulp));
    renderer.setSectionFace(face);
    image = picture(renderer, camera, look, withoutBur());
    const Rgb pulp = at(image, camera, {0.4, -1.0, -1.4});
    EXPECT_GT(pulp.r, pulp.g + 40);
    EXPECT_NE(test::errorOf([&] {
                  face.tissue.pop_back();
                  renderer.setSectionFace(face);
              }),
              "");
}

TEST(Renderer, ASectionsOutlinesAreSmoothAndUnbroken) {
    // Dentine in enamel, both round: 20 pixels a millimetre of the picture, as many of the face.
    constexpr double kOuterMm = 4.03, kInnerMm = 2.47, kPixelMm = 0.05;
    constexpr double kLine = 400.0;  // darker than dentine's face
    SectionFace face;
    face.plane = {Vec3::UnitZ(), 0.0};
    face.originMm = {-5.0, -5.0, 0.0};
    face.uAxis = Vec3::UnitX();
    face.vAxis = Vec3::UnitY();
    face.mmPerPixel = kPixelMm;
    face.width = face.height = 201;
    for (int j = 0; j < face.height; ++j)
        for (int i = 0; i < face.width; ++i) {
            const double r = std::hypot(kPixelMm * i - 5.0, kPixelMm * j - 5.0), out = std::abs(r - kOuterMm);
            const auto steps = [&](double mm) {
                return static_cast<std::uint8_t>(std::clamp(std::lround(32.0 * mm / kPixelMm), 1L, 255L));
            };
            const Tissue tissue = r > kOuterMm ? Tissue::none : r > kInnerMm ? Tissue::enamel : Tissue::dentine;
            face.tissue.push_back(static_cast<std::uint8_t>(tissue));
            face.away.push_back({steps(std::min(out, std::abs(r - kInnerMm))), steps(out)});
        }
    Renderer renderer;
    renderer.setTooth(box(6.0, -3.0, 1.0));
    renderer.setSectionFace(face);
    constexpr Viewport kLarge{240, 240};
    Camera camera;
    camera.eyeMm = {0.0, 0.0, 6.0 / std::tan(0.5 * camera.fieldOfViewRad)};
    camera.up = Vec3::UnitY();
    Look look = plainLook();
    look.cutAway = face.plane;
    const Image image = picture(renderer, camera, look, withoutBur(), kLarge);
    for (const double radius : {kOuterMm, kInnerMm}) {
        std::vector<double> found;
        for (int i = 0; i < 720; ++i) {
            // Where the line is darkest, weighted: its middle.
            const double angle = std::numbers::pi * i / 360.0;
            double darkest = 765.0, weights = 0.0, sum = 0.0;
            for (double off = -0.2; off <= 0.2; off += 0.005) {
                const double r = radius + off;
                if (radius == kOuterMm && off > -0.025) break;  // the background is dark too
                const int here = brightness(at(image, camera, {r * std::cos(angle), r * std::sin(angle), 0.0}, kLarge));
                darkest = std::min(darkest, 1.0 * here);
                const double weight = std::max(0.0, kLine - here);
                sum += weight * off;
                weights += weight;
            }
            EXPECT_LT(darkest, kLine) << "at " << i / 2 << " degrees";
            if (weights > 0.0) found.push_back(std::abs(sum / weights - (radius == kOuterMm ? -0.035 : 0.0)));
        }
        std::sort(found.begin(), found.end());
        ASSERT_GT(found.size(), 700u);
        EXPECT_LT(found[found.size() * 95 / 100], 0.7 * kPixelMm);
    }
}

TEST(Renderer, RemovedDepthsAreColoured) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    auto bricks = table();
    renderer.updateBricks(bricks, true);
    auto deep = square(-1.0, -1.0, 1.0, 0.0, Tissue::dentine);
    BrickUpdate update = brick(27, deep);
    update.removedDepthMm = std::make_shared<const std::vector<float>>(deep->vertices.size(), 2.9f);
    renderer.updateBricks(std::span(&update, 1));
    Look look = plainLook();
    look.removedDepthColours = true;
    const Camera camera = above();
    const Image image = picture(renderer, camera, look, withoutBur());
    const Rgb none = at(image, camera, {-2.5, 0.5, 0.0}), removed = at(image, camera, {-0.5, -0.5, 0.0});
    EXPECT_GT(brightness(none), brightness(removed) + 200);
}

TEST(Renderer, AnEyeInMotionSeesTheCoarseMeshesAndComesToRest) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    auto bricks = table();
    std::size_t fine = 0, coarse = 0;
    for (BrickUpdate& b : bricks) {
        auto mesh = square(b.mesh->vertices[0].positionMm[0], b.mesh->vertices[0].positionMm[1], 1.0, 0.0,
                           b.mesh->vertices[0].tissue, 1);
        fine += b.mesh->triangles.size();
        coarse += mesh->triangles.size();
        b.coarse = mesh;
    }
    renderer.updateBricks(bricks, true);
    Image image;
    const Moment moment = withoutBur();
    EXPECT_EQ(renderer.draw(above(), kSize, plainLook(), moment, image).triangles, fine);
    const Camera camera = orbited(above(), 0.1, 0.0);
    FrameReport report = renderer.draw(camera, kSize, plainLook(), moment, image);
    EXPECT_EQ(report.triangles, coarse);
    EXPECT_TRUE(report.refining);
    std::size_t drawn = 0;
    for (int i = 0; i < 5 && report.refining; ++i) {
        report = renderer.draw(camera, kSize, plainLook(), moment, image);
        drawn += report.triangles;
    }
    EXPECT_FALSE(report.refining);
    EXPECT_EQ(drawn, fine);
    EXPECT_EQ(renderer.draw(camera, kSize, plainLook(), moment, image).triangles, 0u);

    // The same for the tooth as it was, where it has been cut: coarse in motion, whole again at rest.
    BrickUpdate cut = bricks[27];
    cut.mesh = cut.coarse = square(-1.0, -1.0, 1.0, -0.6, Tissue::dentine, 1);
    renderer.updateBricks(std::span(&cut, 1));
    Look before = plainLook();
    before.tooth = ToothShown::before;
    const Camera back = orbited(camera, -0.1, 0.0);
    EXPECT_EQ(renderer.draw(back, kSize, before, moment, image).triangles, coarse);
    do
        report = renderer.draw(back, kSize, before, moment, image);
    while (report.refining);
    EXPECT_EQ(report.triangles, fine);
}

/// A dome of 3 mm, 4 mm x 4 mm of it in bricks of 0.5 mm with steps of 50 um.
std::vector<BrickUpdate> dome() {
    std::vector<BrickUpdate> bricks;
    for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i) {
            auto mesh = square(0.5 * i - 2.0, 0.5 * j - 2.0, 0.5, 0.0, Tissue::enamel, 10);
            for (surface::SurfaceVertex& v : mesh->vertices) {
                auto& [x, y, z] = v.positionMm;
                z = std::sqrt(9.0f - x * x - y * y) - 3.0f;
                v.normal = {x / 3.0f, y / 3.0f, (z + 3.0f) / 3.0f};
            }
            bricks.push_back(brick(static_cast<std::uint32_t>(8 * j + i), std::move(mesh)));
        }
    return bricks;
}

TEST(Renderer, AnEyeInMotionSeesAllDetailToHalfAPixelWithFewerTriangles) {
    constexpr Viewport kLarge{640, 480};
    const core::Box bounds{Vec3(-2.0, -2.0, -2.0), Vec3(2.0, 2.0, 0.0)};
    Renderer window, whole, empty;
    if (!window.isSoftware()) GTEST_SKIP() << "a GPU draws every triangle";
    window.setResponsive(true);
    for (Renderer* renderer : {&window, &whole, &empty})
        renderer->setTooth(bounds);
    window.updateBricks(dome(), true);
    whole.updateBricks(dome(), true);
    // From the side, the dome's top against the background; 4 um are just below half a pixel.
    Camera camera;
    camera.eyeMm = {0.0, -12.3, 0.6};
    camera.targetMm = {0.0, 0.0, -0.6};
    Look look = plainLook();
    look.quality = Quality::fine;
    Image image;
    for (int i = 0; i < 500 && window.draw(camera, kLarge, look, withoutBur(), image).preparing; ++i) {
    }
    for (const double turn : {0.02, 0.03, 0.04}) {
        camera = orbited(camera, turn, 0.0);
        const FrameReport report = window.draw(camera, kLarge, look, withoutBur(), image);
        EXPECT_TRUE(report.refining);
        Image expected;
        const FrameReport all = whole.draw(camera, kLarge, look, withoutBur(), expected);
        EXPECT_GT(report.triangles, 0u);
        EXPECT_LT(report.triangles, all.triangles / 3);
        EXPECT_LT(compareImages(image, expected, 24).differingShare, 0.002);
        Image background;
        empty.draw(camera, kLarge, look, withoutBur(), background);
        const auto isTooth = [&](const Image& of, int x, int y) {
            int apart = 0;
            for (int c = 0; c < 3; ++c)
                apart = std::max(apart, std::abs(of.at(x, y)[c] - background.at(x, y)[c]));
            return apart > 24;
        };
        int edge = 0, off = 0;
        for (int y = 1; y + 1 < kLarge.height; ++y)
            for (int x = 1; x + 1 < kLarge.width; ++x) {
                const bool tooth = isTooth(expected, x, y);
                const bool onEdge = isTooth(expected, x - 1, y) != tooth || isTooth(expected, x + 1, y) != tooth ||
                                    isTooth(expected, x, y - 1) != tooth || isTooth(expected, x, y + 1) != tooth;
                edge += onEdge ? 1 : 0;
                if (isTooth(image, x, y) == tooth) continue;
                ++off;
                ASSERT_TRUE(onEdge) << x << " " << y << ": farther off than a pixel";
            }
        EXPECT_GT(edge, 300);
        EXPECT_LT(off, edge / 2) << "of the outline's pixels";
    }
    // From near by, what was left out would be seen.
    camera.eyeMm *= 0.5;
    const std::size_t drawn = window.draw(camera, kLarge, look, withoutBur(), image).triangles;
    EXPECT_EQ(drawn, whole.draw(camera, kLarge, look, withoutBur(), image).triangles);
}

TEST(Renderer, ComesToRestStripByStripToTheSamePicture) {
    auto bricks = table();
    for (BrickUpdate& b : bricks)
        b.coarse = square(b.mesh->vertices[0].positionMm[0], b.mesh->vertices[0].positionMm[1], 1.0, 0.0,
                          b.mesh->vertices[0].tissue, 1);
    const std::vector<BrickUpdate> cut = {brick(27, square(-1.0, -1.0, 1.0, -0.6, Tissue::dentine)),
                                          brick(44, square(0.0, 1.0, 1.0, -0.8, Tissue::pulp))};
    // Large quick pictures move with fewer pixels and are refined unseen; the others are refined as they stand.
    for (const auto& [quality, size] :
         {std::pair{Quality::fast, Viewport{960, 640}}, std::pair{Quality::fast, Viewport{480, 400}},
          std::pair{Quality::fine, Viewport{960, 640}}}) {
        SCOPED_TRACE(testing::Message() << static_cast<int>(quality) << ' ' << size.width);
        Look look;
        look.quality = quality;
        Moment moment;
        moment.speedRpm = 0.0;
        moment.burInTooth.positionMm = {0.4, -0.3, 0.2};
        const auto prepare = [&](Renderer& renderer) {
            renderer.setTooth(box(4.0, -1.0, 1.0));
            renderer.updateBricks(bricks, true);
            renderer.setBur(rod(0.5, 3.0), 3.0, 0.5);
        };
        Renderer fresh;
        prepare(fresh);
        fresh.updateBricks(cut);
        Image expected;
        fresh.draw(above(), size, look, moment, expected);

        Renderer patient;
        prepare(patient);
        patient.setResponsive(true);
        Image image;
        patient.draw(orbited(above(), 0.2, 0.1), size, look, moment, image);
        patient.draw(above(), size, look, moment, image);
        FrameReport report;
        int pictures = 0;
        Moment elsewhere = moment;
        do {
            // The hand goes on meanwhile, and cuts.
            elsewhere.burInTooth.positionMm = {0.1 * pictures - 2.0, 0.2, 0.4};
            if (pictures == 2) patient.updateBricks(std::span(cut).first(1));
            if (pictures == 3) patient.updateBricks(std::span(cut).subspan(1));
            report = patient.draw(above(), size, look, elsewhere, image);
        } while (report.refining && ++pictures < 30);
        EXPECT_FALSE(report.refining);
        EXPECT_GT(pictures, 3);
        patient.draw(above(), size, look, moment, image);
        expectSame(expected, image);

        // A new look of the tooth counts as motion, and ends in the same picture too.
        look.palette = Palette::textbook;
        EXPECT_TRUE(patient.draw(above(), size, look, moment, image).refining);
        for (pictures = 0; patient.draw(above(), size, look, moment, image).refining && pictures < 30;)
            ++pictures;
        fresh.draw(above(), size, look, moment, expected);
        expectSame(expected, image);
    }
}

TEST(Renderer, WhatAChangeOccludesFartherOffIsLitWhenNothingElseChanges) {
    constexpr Viewport kLarge{960, 640};
    const std::vector<BrickUpdate> heap = {brick(27, square(-1.0, -1.0, 1.0, 0.6, Tissue::dentine))};
    const auto prepare = [](Renderer& renderer) {
        renderer.setTooth(box(4.0, -1.0, 1.0));
        renderer.updateBricks(table(), true);
    };
    Renderer fresh;
    prepare(fresh);
    fresh.updateBricks(heap);
    Image expected, image;
    fresh.draw(above(), kLarge, {}, withoutBur(), expected);

    Renderer patient;
    prepare(patient);
    patient.setResponsive(true);
    while (patient.draw(above(), kLarge, {}, withoutBur(), image).refining) {
    }
    patient.updateBricks(heap);
    FrameReport report = patient.draw(above(), kLarge, {}, withoutBur(), image);
    EXPECT_TRUE(report.preparing);
    EXPECT_NE(image.rgba, expected.rgba) << "nothing was put off";
    const ImageDifference d = compareImages(image, expected, 24);
    EXPECT_LT(d.rms, 2.0);
    for (int pictures = 0; report.preparing && pictures < 30; ++pictures)
        report = patient.draw(above(), kLarge, {}, withoutBur(), image);
    EXPECT_FALSE(report.preparing);
    expectSame(expected, image);
}

TEST(Renderer, GlassIsSeenThroughWhatIsSolidAndGoesWithoutATrace) {
    Renderer renderer;
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.updateBricks(table());
    Image before, with, after;
    const auto settle = [&](Image& out) {
        while (renderer.draw(above(), kSize, plainLook(), withoutBur(), out).refining) {
        }
    };
    settle(before);
    // Green, from 3 mm under the table to its top, left of the middle.
    const auto mesh =
        std::make_shared<const geometry::TriangleMesh>(test::boxMesh(Vec3(-2.0, -1.0, -3.0), Vec3(-1.0, 0.0, 0.0)));
    renderer.setGlass({{mesh, {0.0f, 0.62f, 0.45f}, 0.34f}});
    settle(with);
    const Rgb was = at(before, above(), Vec3(-1.5, -0.5, 0.0)), is = at(with, above(), Vec3(-1.5, -0.5, 0.0));
    EXPECT_GT(is.g - is.r, was.g - was.r + 30);
    const Rgb asideWas = at(before, above(), Vec3(1.5, -2.5, 0.0)), asideIs = at(with, above(), Vec3(1.5, -2.5, 0.0));
    EXPECT_EQ(brightness(asideIs), brightness(asideWas));
    // All of it under the table: paler, and seen.
    const auto hidden =
        std::make_shared<const geometry::TriangleMesh>(test::boxMesh(Vec3(-2.0, -1.0, -3.0), Vec3(-1.0, 0.0, -1.0)));
    renderer.setGlass({{hidden, {0.0f, 0.62f, 0.45f}, 0.34f}});
    settle(after);
    const Rgb under = at(after, above(), Vec3(-1.5, -0.5, -1.0));
    const Rgb underWas = at(before, above(), Vec3(-1.5, -0.5, -1.0));
    EXPECT_GT(under.g - under.r, underWas.g - underWas.r + 10);
    renderer.setGlass({});
    settle(after);
    EXPECT_EQ(after.rgba, before.rgba);
    renderer.setGlass({{mesh, {0.0f, 0.62f, 0.45f}, 0.34f}});
    renderer.setTooth(box(4.0, -1.0, 1.0));
    renderer.updateBricks(table());
    settle(after);
    EXPECT_EQ(after.rgba, before.rgba) << "another tooth has none of it";
}

TEST(Renderer, SizesThatNoPictureHasAreRefused) {
    Renderer renderer;
    Image image;
    EXPECT_NE(test::errorOf([&] { renderer.draw(above(), {0, 100}, {}, withoutBur(), image); }), "");
    EXPECT_NE(test::errorOf([&] { renderer.draw(above(), {100, 100000}, {}, withoutBur(), image); }), "");
}

TEST(RendererDeathTest, WithoutOpenGlThereIsOneClearError) {
    // In a process of its own: EGL reads its environment once.
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_EXIT(
        {
            setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere/none.json", 1);
            const std::string error = test::errorOf([] { const Renderer renderer; });
            const bool clear =
                error.find("OpenGL 3.3") != std::string::npos && error.find("install") != std::string::npos;
            _exit(clear ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace handpiece::view::renderer_test
