// SPDX-License-Identifier: Apache-2.0
// Pictures of a starter tooth against the ones kept beside this test. They are drawn by whatever OpenGL there is, and
// two releases of Mesa do not round alike, so they are held to a tolerance, not to the bit: root mean square of at most
// kMaxRms of 255, and at most kMaxShare of the pixels off by more than 24 in a channel (edges may fall on the next
// pixel). HANDPIECE_RENEW_PICTURES=1 writes them anew; look at them before they are kept.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::view::picture_test {
namespace {

constexpr double kMaxRms = 4.0, kMaxShare = 0.01;
constexpr Viewport kSize{480, 300};

struct Scene {
    cases::Case toothCase;
    std::unique_ptr<Renderer> renderer;
    core::Box bounds;

    Scene() {
        starter::ToothOptions options;
        options.faces = 12000;
        options.scene = true;
        toothCase = starter::makeTooth(starter::ToothKind::lowerFirstMolar, options);
        bounds = toothCase.outer.bounds();
        renderer = std::make_unique<Renderer>();
        renderer->setTooth(bounds);
        renderer->setMesh(toothCase.outer, cases::Tissue::enamel);
        renderer->setScenery(toothCase.scenery);
        renderer->setParts(toothCase.parts);
        setBur("330");
        renderer->setTurbine(instrument::turbineMesh());
    }
    void setBur(const std::string& name) const {
        const auto instrument = instrument::makeInstrument(name);
        renderer->setBur(instrument.bur->mesh(), instrument.bur->lengthMm(), instrument.bur->maxRadiusMm(),
                         finishOf(*instrument.bur));
    }
    [[nodiscard]] Image draw(const Camera& camera, const Look& look, const Moment& moment) const {
        Image image;
        // Twice: the first picture of a new eye is the quick one.
        for (int i = 0; i < 8 && (renderer->draw(camera, kSize, look, moment, image).refining || i < 2); ++i) {
        }
        return image;
    }
};

Scene& scene() {
    static Scene made;
    return made;
}

void expectAsKept(const Image& image, const std::string& name) {
    const std::filesystem::path kept =
        std::filesystem::path(HANDPIECE_SOURCE_DIR) / "tests/golden/pictures" / (name + ".png");
    if (std::getenv("HANDPIECE_RENEW_PICTURES") != nullptr) {
        std::filesystem::create_directories(kept.parent_path());
        writePng(image, kept);
        return;
    }
    const ImageDifference d = compareImages(image, readPng(kept), 24);
    if (d.rms > kMaxRms || d.differingShare > kMaxShare) writePng(image, name + "-drawn.png");
    EXPECT_LE(d.rms, kMaxRms) << name << "-drawn.png beside the test program shows it";
    EXPECT_LE(d.differingShare, kMaxShare);
}

Moment burAbove(const core::Box& bounds) {
    Moment moment;
    moment.burInTooth.positionMm = {bounds.centre().x(), bounds.centre().y(), bounds.max.z() - 1.2};
    return moment;
}

Camera crown(StandardView view) {
    core::Box box = scene().bounds;
    box.min.z() = box.max.z() - 9.0;
    return standardView(view, box, 1, kSize);
}

TEST(Picture, occlusalFast) {
    Look look;
    Moment moment;
    moment.burShown = false;
    expectAsKept(scene().draw(crown(StandardView::occlusal), look, moment), "occlusal-fast");
}

// Looked at along the bur, the handpiece is glass: the tooth at the tip is to be seen.
TEST(Picture, alongTheBurFast) {
    expectAsKept(scene().draw(crown(StandardView::occlusal), {}, burAbove(scene().bounds)), "along-bur");
}

TEST(Picture, mouthMirrorFine) {
    Look look;
    look.quality = Quality::fine;
    Moment moment = burAbove(scene().bounds);
    // On the lingual side, half way between the eye and the crown.
    const core::Box& tooth = scene().bounds;
    core::Vec3 middle = tooth.centre();
    middle.z() = tooth.max.z() - 5.0;
    moment.mirror = MirrorPose{};
    moment.mirror->centreMm = middle + core::Vec3(0.0, -15.0, 0.0);
    moment.mirror->normal = core::Vec3(0.0, 1.0, 1.0).normalized();
    core::Box seen = tooth;
    seen.min.z() = tooth.max.z() - 9.0;
    seen.extend(moment.mirror->centreMm - core::Vec3(8.0, 9.0, 0.0));
    expectAsKept(scene().draw(standardView(StandardView::occlusal, seen, 1, kSize), look, moment), "mirror");
}

// Beside the bur, the handpiece is metal.
TEST(Picture, handpieceFast) {
    core::Box seen = scene().bounds;
    seen.min.z() = seen.max.z() - 4.0;
    seen.max.z() += 22.0;
    expectAsKept(scene().draw(standardView(StandardView::buccal, seen, 1, kSize), {}, burAbove(scene().bounds)),
                 "handpiece");
}

// From near, standing: grains, blades, and a bur of one's own as its shape has it.
TEST(Picture, whatBursAreOf) {
    Look look;
    look.quality = Quality::fine;
    Camera camera = crown(StandardView::oblique);
    const Moment moment = burAbove(scene().bounds);
    camera.targetMm = moment.burInTooth.positionMm + core::Vec3(0.0, 0.0, 2.5);
    camera.eyeMm = camera.targetMm + 17.0 * core::Vec3(0.3, 0.9, 0.35).normalized();
    for (const char* name : {"round-4", "856-016"}) {
        scene().setBur(name);
        expectAsKept(scene().draw(camera, look, moment), std::string("bur-") + name);
    }
    const auto shape = instrument::makeInstrument("856-016");
    scene().renderer->setBur(shape.bur->mesh(), shape.bur->lengthMm(), shape.bur->maxRadiusMm(), BurFinish::plain);
    expectAsKept(scene().draw(camera, look, moment), "bur-plain");
    scene().setBur("330");
}

TEST(Picture, obliqueWithBurFine) {
    Look look;
    look.quality = Quality::fine;
    expectAsKept(scene().draw(crown(StandardView::oblique), look, burAbove(scene().bounds)), "oblique-fine");
}

TEST(Picture, buccalTextbookRich) {
    Look look;
    look.quality = Quality::rich;
    look.palette = Palette::textbook;
    look.scaleBar = true;
    expectAsKept(scene().draw(crown(StandardView::buccal), look, burAbove(scene().bounds)), "buccal-rich");
}

TEST(Picture, withoutEnamel) {
    Look look;
    look.visible[static_cast<std::size_t>(cases::Tissue::enamel)] = false;
    look.visible[static_cast<std::size_t>(cases::Tissue::neighbour)] = false;
    look.visible[static_cast<std::size_t>(cases::Tissue::gum)] = false;
    look.visible[static_cast<std::size_t>(cases::Tissue::bone)] = false;
    Moment moment;
    moment.burShown = false;
    expectAsKept(scene().draw(standardView(StandardView::oblique, scene().bounds, 1, kSize), look, moment),
                 "without-enamel");
}

// The tolerance is not so wide that anything passes: without the bur the picture is another.
TEST(Picture, aMissingBurIsNoticed) {
    if (std::getenv("HANDPIECE_RENEW_PICTURES") != nullptr) GTEST_SKIP() << "the pictures are being renewed";
    Look look;
    look.quality = Quality::fine;
    look.bur = look.turbine = false;
    const Image image = scene().draw(crown(StandardView::oblique), look, burAbove(scene().bounds));
    const Image kept = readPng(std::filesystem::path(HANDPIECE_SOURCE_DIR) / "tests/golden/pictures/oblique-fine.png");
    const ImageDifference d = compareImages(image, kept, 24);
    EXPECT_TRUE(d.rms > kMaxRms && d.differingShare > kMaxShare) << d.rms << ' ' << d.differingShare;
}

}  // namespace
}  // namespace handpiece::view::picture_test
