// SPDX-License-Identifier: Apache-2.0
// Gingiva that was cut, in the picture: where it is red, when, and until when.
#include <gtest/gtest.h>

#include "handpiece/senses/view/renderer.h"
#include "support/closed_meshes.h"

namespace handpiece::view::bleeding_test {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr Viewport kSize{320, 200};

struct Rgb {
    int r, g, b;
};
int brightness(const Rgb& c) {
    return c.r + c.g + c.b;
}
bool isSame(const Image& a, const Image& b) {
    return compareImages(a, b, 0).largest == 0.0;
}

/// A bur 1 mm thick that has been pushed straight down to `tip`.
messages::GingivaCut cutAt(const Vec3& tip, double timeS) {
    messages::GingivaCut cut;
    cut.timeS = timeS;
    cut.tipMm = core::toArray(tip);
    cut.lengthMm = 2.0;
    cut.stationRadiusMm.fill(0.5);
    return cut;
}

class BleedingGingiva : public testing::Test {
  protected:
    BleedingGingiva() {
        renderer_.setTooth({Vec3(-1, -1, -1), Vec3(1, 1, 1)});
        look_.shadows = look_.wet = false;  // no sparks
        camera_.eyeMm = {0.0, -6.0, 30.0};
        camera_.targetMm = Vec3::Zero();
        camera_.up = Vec3::UnitY();
        renderer_.setScenery(
            std::vector<cases::Part>{{"gingiva", Tissue::gum, 0, test::boxMesh({-6, -4, -2}, {0, 4, 0})},
                                     {"other", Tissue::neighbour, 0, test::boxMesh({0, -4, -2}, {6, 4, 0})}});
    }
    Image at(double timeS, bool* isBleeding = nullptr) {
        Moment moment;
        moment.burShown = false;
        moment.timeS = timeS;
        Image image;
        FrameReport report;
        // Until nothing is refined any more.
        for (int i = 0; i < 6 && (report = renderer_.draw(camera_, kSize, look_, moment, image)).refining; ++i) {
        }
        if (isBleeding != nullptr) *isBleeding = report.bleeding;
        return image;
    }
    /// Blood takes green and blue away, and most of the light.
    static bool isRed(const Rgb& c) { return c.r > 2 * c.g && c.g + c.b < 160; }
    [[nodiscard]] Rgb colour(const Image& image, const Vec3& p) const {
        const auto pixel = pixelOf(camera_, kSize, p);
        if (!pixel) {
            ADD_FAILURE() << "the point is not in the picture";
            return {};
        }
        const std::uint8_t* c = image.at(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()));
        return {c[0], c[1], c[2]};
    }

    Renderer renderer_;
    Camera camera_;
    Look look_;
    const Vec3 wound_{-2.0, 2.0, -0.4}, open_{-2.0, 2.0, 0.0};
    const Vec3 down_ = Vec3(0.0, -1.0, -0.2).normalized();
};

TEST_F(BleedingGingiva, WhereItWasCutAndNowhereElse) {
    const Image before = at(1.0);
    // One of them in the tooth beside, which does not bleed.
    renderer_.setGingivaCuts({cutAt(wound_, 1.0), cutAt({2.0, 2.0, -0.4}, 1.0)}, down_);
    const Image cut = at(1.1);
    EXPECT_FALSE(isRed(colour(before, open_)));
    const Rgb dry = colour(before, open_), wet = colour(cut, open_);
    EXPECT_TRUE(isRed(wet)) << wet.r << ' ' << wet.g << ' ' << wet.b << ", dry " << dry.r << ' ' << dry.g << ' '
                            << dry.b;
    for (const Vec3& p : {Vec3(-5.0, 2.0, 0.0), Vec3(-2.0, 3.5, 0.0), Vec3(-2.0, -1.0, 0.0), Vec3(2.0, 2.0, 0.0)})
        EXPECT_EQ(brightness(colour(cut, p)), brightness(colour(before, p)));
}

TEST_F(BleedingGingiva, BloodRunsDownFromThereAndLiesUntilTheGingivaIsWholeAgain) {
    const Image before = at(1.0);
    renderer_.setGingivaCuts({cutAt(wound_, 1.0), cutAt(wound_ + Vec3(0.4, 0.0, 0.0), 1.1)}, down_);
    const Vec3 below(-1.8, 1.0, 0.0), over(-1.8, 3.0, 0.0);
    bool isBleeding = false;
    EXPECT_FALSE(isRed(colour(at(1.2, &isBleeding), below)));
    EXPECT_TRUE(isBleeding);
    const Image later = at(9.0);
    const Rgb run = colour(later, below);
    EXPECT_TRUE(isRed(run)) << run.r << ' ' << run.g << ' ' << run.b;
    EXPECT_FALSE(isRed(colour(later, over))) << "it does not run up";
    const Image end = at(60.0, &isBleeding);
    EXPECT_FALSE(isBleeding) << "it stops";
    EXPECT_TRUE(isRed(colour(end, below)));
    EXPECT_PRED2(isSame, at(600.0), end);
    renderer_.setGingivaCuts({}, down_);
    EXPECT_PRED2(isSame, at(600.0), before);
}

TEST_F(BleedingGingiva, LooksTheSameWhateverWasDrawnBefore) {
    const std::vector<messages::GingivaCut> cuts{cutAt(wound_, 1.0), cutAt({-2.4, 1.6, -0.3}, 2.0),
                                                 cutAt({-4.0, 0.0, -0.5}, 2.01)};
    renderer_.setGingivaCuts(cuts, down_);
    const Image once = at(4.0);
    // Back, where there was less of it, and on in small steps, with cuts that come one by one.
    for (double timeS = 0.9; timeS < 4.0; timeS += 0.11) {
        std::vector<messages::GingivaCut> soFar;
        for (const messages::GingivaCut& cut : cuts)
            if (cut.timeS <= timeS) soFar.push_back(cut);
        renderer_.setGingivaCuts(soFar, down_);
        (void)at(timeS);
    }
    EXPECT_PRED2(isSame, at(4.0), once);
}

}  // namespace
}  // namespace handpiece::view::bleeding_test
