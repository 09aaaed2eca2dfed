// SPDX-License-Identifier: Apache-2.0
// An intraoral scan in a picture: its colours where they belong, and everything as before where there are none.
#include <gtest/gtest.h>

#include <cmath>

#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/senses/surface/scan_colours.h"
#include "handpiece/senses/surface/surface.h"
#include "handpiece/senses/view/renderer.h"
#include "support/closed_meshes.h"

namespace handpiece::view::scan_colours_test {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr Viewport kSize{240, 240};
constexpr geometry::Colour kRed{190, 30, 30}, kGreen{30, 170, 40};

geometry::VertexColours halves(const geometry::TriangleMesh& mesh) {
    geometry::VertexColours colours;
    for (const Vec3& v : mesh.vertices)
        colours.push_back(v.x() < 0.0 ? kRed : kGreen);
    return colours;
}

Camera above() {
    Camera camera;
    camera.eyeMm = {0.0, -4.0, 26.0};
    camera.targetMm = Vec3::Zero();
    camera.up = Vec3::UnitY();
    return camera;
}

Image picture(Renderer& renderer, const Look& look) {
    Image image;
    Moment moment;
    moment.burShown = false;
    for (int i = 0; i < 6 && renderer.draw(above(), kSize, look, moment, image).refining; ++i) {
    }
    return image;
}

struct Rgb {
    int r, g, b;
};
Rgb at(const Image& image, const Vec3& point) {
    const auto pixel = pixelOf(above(), kSize, point);
    if (!pixel) {
        ADD_FAILURE() << "the point is not in the picture";
        return {};
    }
    const std::uint8_t* p = image.at(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()));
    return {p[0], p[1], p[2]};
}

void expectRed(const Rgb& c) {
    EXPECT_GT(c.r, 2 * c.g) << c.r << " " << c.g << " " << c.b;
    EXPECT_GT(c.r, 2 * c.b) << c.r << " " << c.g << " " << c.b;
    EXPECT_GT(c.r, 60);
}
void expectGreen(const Rgb& c) {
    EXPECT_GT(c.g, 3 * c.r / 2) << c.r << " " << c.g << " " << c.b;
    EXPECT_GT(c.g, 3 * c.b / 2) << c.r << " " << c.g << " " << c.b;
    EXPECT_GT(c.g, 60);
}
void expectTooth(const Rgb& c) {
    EXPECT_LT(std::abs(c.r - c.g), 40) << c.r << " " << c.g << " " << c.b;
    EXPECT_GT(c.g, 90);
}

/// Beside the lamp's spark, on either half.
const Vec3 kLeft(-3.0, -1.5, 2.2), kRight(3.0, -1.5, 2.2);

void expectSame(const Image& a, const Image& b) {
    const ImageDifference difference = compareImages(a, b, 0);
    EXPECT_EQ(difference.largest, 0.0) << "share of pixels that differ: " << difference.differingShare;
}

/// A ball of enamel scanned half red, half green.
std::shared_ptr<const tooth::ToothModel> ball(bool inColour) {
    cases::Case c;
    c.name = "ball";
    c.outer = test::sphereMesh(4, 4.0);
    if (inColour) c.outerColours = halves(c.outer);
    tooth::LoadSettings settings;
    settings.field.voxelMm = 0.1;
    settings.useCache = false;
    return tooth::loadModel(c, settings);
}

std::vector<surface::BrickUpdate> bricksOf(const tooth::ToothModel& model) {
    const surface::FieldSource source(model.field);
    surface::Surface fine(source, &model.tissues), coarse(source, &model.tissues);
    for (std::uint32_t dense = 0; dense < source.grid().count(); ++dense)
        coarse.setLevel(dense, surface::kMaxLevel);
    fine.build();
    coarse.build();
    std::vector<surface::BrickUpdate> bricks;
    for (std::uint32_t dense = 0; dense < source.grid().count(); ++dense) {
        const auto mesh = fine.mesh(dense), less = coarse.mesh(dense);
        if (mesh != nullptr || less != nullptr)
            bricks.push_back({dense, true, mesh, less, nullptr, surface::scanColours(model, mesh.get()),
                              surface::scanColours(model, less.get())});
    }
    return bricks;
}

TEST(ScanColours, AMeshIsSeenAsItWasScanned) {
    const geometry::TriangleMesh sphere = test::sphereMesh(4, 4.0);
    Renderer renderer;
    for (const Quality quality : {Quality::fast, Quality::fine, Quality::rich}) {
        Look look;
        look.quality = quality;
        renderer.setMesh(sphere, Tissue::enamel, halves(sphere));
        const Image scanned = picture(renderer, look);
        expectRed(at(scanned, kLeft));
        expectGreen(at(scanned, kRight));
        look.scanColours = false;
        const Image off = picture(renderer, look);
        expectTooth(at(off, kLeft));
        renderer.setMesh(sphere, Tissue::enamel);
        expectSame(picture(renderer, look), off);
        look.scanColours = true;
        expectSame(picture(renderer, look), off);
    }
}

TEST(ScanColours, OtherPalettesShowTissues) {
    const geometry::TriangleMesh sphere = test::sphereMesh(4, 4.0);
    Renderer renderer;
    Look look;
    look.palette = Palette::textbook;
    renderer.setMesh(sphere, Tissue::enamel, halves(sphere));
    const Image scanned = picture(renderer, look);
    renderer.setMesh(sphere, Tissue::enamel);
    expectSame(scanned, picture(renderer, look));
}

TEST(ScanColours, AToothInBricksIsSeenAsItWasScanned) {
    const auto model = ball(true);
    Renderer renderer;
    renderer.setTooth(model->outer.bounds());
    renderer.updateBricks(bricksOf(*model), true);
    Look look;
    const Image scanned = picture(renderer, look);
    expectRed(at(scanned, kLeft));
    expectGreen(at(scanned, kRight));
    look.scanColours = false;
    const Image off = picture(renderer, look);
    const auto plain = ball(false);
    renderer.setTooth(plain->outer.bounds());
    renderer.updateBricks(bricksOf(*plain), true);
    expectSame(picture(renderer, look), off);
}

TEST(ScanColours, AMovingEyeSeesThemToo) {
    const auto model = ball(true);
    Renderer renderer;
    renderer.setResponsive(true);
    renderer.setTooth(model->outer.bounds());
    renderer.updateBricks(bricksOf(*model), true);
    Image image;
    Moment moment;
    moment.burShown = false;
    Camera camera = above();
    for (int i = 0; i < 4; ++i) {  // never twice from one place
        camera.eyeMm.x() = 0.05 * (3 - i);
        renderer.draw(camera, kSize, {}, moment, image);
    }
    expectRed(at(image, kLeft));
    expectGreen(at(image, kRight));
}

TEST(ScanColours, GingivaAndTeethAroundAreSeenAsTheyWereScanned) {
    Renderer renderer;
    renderer.setTooth({Vec3(11.0, -1.0, -1.0), Vec3(13.0, 1.0, 1.0)});  // not behind what is looked at
    for (const Tissue tissue : {Tissue::gum, Tissue::neighbour}) {
        cases::Part part{"around", tissue, 5, test::sphereMesh(4, 4.0)};
        renderer.setScenery({&part, 1});
        const Image plain = picture(renderer, {});
        part.colours = halves(part.mesh);
        renderer.setScenery({&part, 1});
        const Image scanned = picture(renderer, {});
        expectRed(at(scanned, kLeft));
        expectGreen(at(scanned, kRight));
        part.colours.clear();
        renderer.setScenery({&part, 1});
        expectSame(picture(renderer, {}), plain);
    }
}

TEST(ScanColours, CutSurfacesAndWhatWasPutInLaterHaveNone) {
    const auto model = ball(true);
    surface::BrickMesh mesh;
    const auto add = [&](const Vec3& p, Tissue tissue) {
        mesh.vertices.push_back(
            {{static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())}, {0, 0, 1}, tissue});
    };
    const double nearMm = surface::nearScanMm(*model, 0);
    ASSERT_GE(nearMm, 0.02);
    ASSERT_LT(nearMm, 0.1);
    const Vec3 onIt = model->outer.vertices[100];
    add(onIt, Tissue::enamel);
    add(onIt * (1.0 - 0.8 * nearMm / 4.0), Tissue::enamel);
    add(onIt * (1.0 - 1.5 * nearMm / 4.0), Tissue::enamel);
    add(onIt, Tissue::caries);
    add(onIt, Tissue::calculus);
    add(onIt, Tissue::restoration);
    add(Vec3::Zero(), Tissue::dentine);
    const auto colours = surface::scanColours(*model, &mesh);
    ASSERT_TRUE(colours);
    const geometry::Colour seen = model->colours[100];
    EXPECT_EQ((*colours)[0], (surface::ScanColour{seen[0], seen[1], seen[2], 255}));
    EXPECT_EQ((*colours)[1], (*colours)[0]);
    for (std::size_t v = 2; v < colours->size(); ++v)
        EXPECT_EQ((*colours)[v], surface::ScanColour{}) << v;
    EXPECT_FALSE(surface::scanColours(*ball(false), &mesh));
    EXPECT_FALSE(surface::scanColours(*model, nullptr));
}

TEST(ScanColours, AllOfAnUncutToothHasThem) {
    const auto model = ball(true);
    std::size_t all = 0, without = 0;
    for (const surface::BrickUpdate& brick : bricksOf(*model))
        for (const auto& colours : {brick.colours, brick.coarseColours}) {
            if (!colours) continue;
            for (const surface::ScanColour& colour : *colours)
                ++all, without += colour[3] == 0 ? 1 : 0;
        }
    EXPECT_GT(all, 5000u);
    EXPECT_EQ(without, 0u);
}

}  // namespace
}  // namespace handpiece::view::scan_colours_test
