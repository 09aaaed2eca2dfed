// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/look.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "support/error_of.h"

namespace handpiece::view::look_test {
namespace {

using cases::Tissue;
using core::Mat3;
using core::Vec3;
using Colour = std::array<std::uint8_t, 3>;

// sRGB, IEC 61966-2-1, to linear light.
Vec3 linearOf(const Colour& c) {
    Vec3 out;
    for (int i = 0; i < 3; ++i) {
        const double v = c[static_cast<std::size_t>(i)] / 255.0;
        out[i] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
    return out;
}

// CIE L*a*b* under D65.
Vec3 labOf(const Vec3& linear) {
    Mat3 m;
    m << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920, 0.9503041;
    const Vec3 xyz = (m * linear).cwiseQuotient(Vec3(0.95047, 1.0, 1.08883));
    const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
    return {116 * f(xyz.y()) - 16, 500 * (f(xyz.x()) - f(xyz.y())), 200 * (f(xyz.y()) - f(xyz.z()))};
}

struct Vision {
    const char* name;
    Mat3 matrix;
};

// G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A physiologically-based model for simulation of color vision
// deficiency", IEEE TVCG 15(6), 2009: the matrices of full severity, for linear light.
std::vector<Vision> visions() {
    std::vector<Vision> all{{"usual", Mat3::Identity()}, {"protanopia", {}}, {"deuteranopia", {}}, {"tritanopia", {}}};
    all[1].matrix << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998;
    all[2].matrix << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
    all[3].matrix << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900;
    return all;
}

double apart(const Colour& a, const Colour& b, const Vision& vision) {
    const auto seen = [&](const Colour& c) { return labOf((vision.matrix * linearOf(c)).cwiseMax(0.0).cwiseMin(1.0)); };
    return (seen(a) - seen(b)).norm();
}

// Tissues that may lie side by side in a tooth, in its gum or at a restoration.
const std::vector<std::pair<Tissue, Tissue>> kTouching{{Tissue::enamel, Tissue::dentine},
                                                       {Tissue::enamel, Tissue::caries},
                                                       {Tissue::enamel, Tissue::cementum},
                                                       {Tissue::enamel, Tissue::gum},
                                                       {Tissue::enamel, Tissue::neighbour},
                                                       {Tissue::enamel, Tissue::restoration},
                                                       {Tissue::enamel, Tissue::pulp},
                                                       {Tissue::dentine, Tissue::pulp},
                                                       {Tissue::dentine, Tissue::caries},
                                                       {Tissue::dentine, Tissue::cementum},
                                                       {Tissue::dentine, Tissue::gum},
                                                       {Tissue::dentine, Tissue::restoration},
                                                       {Tissue::pulp, Tissue::caries},
                                                       {Tissue::pulp, Tissue::cementum},
                                                       {Tissue::pulp, Tissue::restoration},
                                                       {Tissue::caries, Tissue::cementum},
                                                       {Tissue::caries, Tissue::gum},
                                                       {Tissue::caries, Tissue::restoration},
                                                       {Tissue::caries, Tissue::neighbour},
                                                       {Tissue::cementum, Tissue::gum},
                                                       {Tissue::cementum, Tissue::bone},
                                                       {Tissue::cementum, Tissue::neighbour},
                                                       {Tissue::cementum, Tissue::restoration},
                                                       {Tissue::gum, Tissue::bone},
                                                       {Tissue::gum, Tissue::neighbour},
                                                       {Tissue::gum, Tissue::restoration},
                                                       {Tissue::bone, Tissue::neighbour},
                                                       {Tissue::neighbour, Tissue::restoration},
                                                       {Tissue::enamel, Tissue::demineralisedEnamel},
                                                       {Tissue::demineralisedEnamel, Tissue::dentine},
                                                       {Tissue::demineralisedEnamel, Tissue::stainedEnamel},
                                                       {Tissue::demineralisedEnamel, Tissue::cariesSoft},
                                                       {Tissue::demineralisedEnamel, Tissue::cariesLeathery},
                                                       {Tissue::demineralisedEnamel, Tissue::cariesFirm},
                                                       {Tissue::demineralisedEnamel, Tissue::gum},
                                                       {Tissue::demineralisedEnamel, Tissue::cementum},
                                                       {Tissue::demineralisedEnamel, Tissue::neighbour},
                                                       {Tissue::demineralisedEnamel, Tissue::restoration},
                                                       {Tissue::enamel, Tissue::stainedEnamel},
                                                       {Tissue::dentine, Tissue::stainedEnamel},
                                                       {Tissue::enamel, Tissue::cariesSoft},
                                                       {Tissue::enamel, Tissue::cariesLeathery},
                                                       {Tissue::enamel, Tissue::cariesFirm},
                                                       {Tissue::dentine, Tissue::cariesSoft},
                                                       {Tissue::dentine, Tissue::cariesLeathery},
                                                       {Tissue::cariesLeathery, Tissue::cariesFirm},
                                                       {Tissue::pulp, Tissue::cariesSoft},
                                                       {Tissue::pulp, Tissue::cariesLeathery},
                                                       {Tissue::pulp, Tissue::cariesFirm},
                                                       {Tissue::restoration, Tissue::cariesSoft},
                                                       {Tissue::restoration, Tissue::cariesLeathery},
                                                       {Tissue::restoration, Tissue::cariesFirm},
                                                       {Tissue::cementum, Tissue::cariesSoft},
                                                       {Tissue::cementum, Tissue::cariesLeathery},
                                                       {Tissue::gum, Tissue::cariesSoft},
                                                       {Tissue::enamel, Tissue::calculus},
                                                       {Tissue::cementum, Tissue::calculus},
                                                       {Tissue::gum, Tissue::calculus}};

TEST(Look, TheVisionMatricesLeaveGreysAlone) {
    for (const Vision& vision : visions())
        for (int row = 0; row < 3; ++row)
            EXPECT_NEAR(vision.matrix.row(row).sum(), 1.0, 2e-6) << vision.name;
}

TEST(Look, SafeColoursOfTissuesThatTouchDifferForEveryColourVision) {
    double least = 1e9;
    for (const Vision& vision : visions())
        for (const auto& [a, b] : kTouching) {
            const double d = apart(colourOf(a, Palette::colourSafe), colourOf(b, Palette::colourSafe), vision);
            least = std::min(least, d);
            // 2.3 is just noticeable side by side (Mahy et al. 1994); shading moves a colour by far more than that.
            EXPECT_GE(d, 25.0) << properties(a).name << " and " << properties(b).name << ", " << vision.name;
        }
    RecordProperty("leastDifference", std::to_string(least));
    std::printf("[ least difference ] %.1f (CIE 1976)\n", least);
}

TEST(Look, EveryPaletteTellsNeighbouringTissuesApart) {
    for (const Palette palette : {Palette::natural, Palette::textbook})
        for (const auto& [a, b] : kTouching) {
            // Side by side in a mouth all teeth are the same.
            if (palette == Palette::natural && a == Tissue::enamel && b == Tissue::neighbour) continue;
            EXPECT_GE(apart(colourOf(a, palette), colourOf(b, palette), visions()[0]), 10.0)
                << properties(a).name << " and " << properties(b).name;
        }
}

TEST(Look, CariousDentineGetsDarkerLevelByLevelForEveryColourVision) {
    for (const Palette palette : {Palette::natural, Palette::textbook, Palette::colourSafe})
        for (const Vision& vision : visions()) {
            double last = 0.0;
            for (std::size_t i = 0; i <= cases::kCariousLevels.size(); ++i) {
                const Tissue level = i < cases::kCariousLevels.size() ? cases::kCariousLevels[i] : Tissue::dentine;
                const double lightness =
                    labOf((vision.matrix * linearOf(colourOf(level, palette))).cwiseMax(0.0).cwiseMin(1.0)).x();
                EXPECT_GT(lightness, last + 5.0) << properties(level).name << ", " << vision.name;
                last = lightness;
            }
        }
}

TEST(Look, RemovedDepthGetsDarkerWithEveryStepForEveryColourVision) {
    for (const Vision& vision : visions()) {
        double last = 101.0;
        for (int i = 0; i <= 30; ++i) {
            const Vec3 linear = linearOf(removedDepthColour(0.1 * i, 3.0));
            const double lightness = labOf((vision.matrix * linear).cwiseMax(0.0).cwiseMin(1.0)).x();
            EXPECT_LT(lightness, last - 0.5) << vision.name << " at " << 0.1 * i << " mm";
            EXPECT_GT(lightness, last - 12.0) << vision.name << " at " << 0.1 * i << " mm";
            last = lightness;
        }
    }
}

TEST(Look, DeviationsGoFromRedOverPaleToBlue) {
    EXPECT_EQ(deviationColour(-9.0, 0.5), deviationColour(-0.5, 0.5));
    EXPECT_EQ(deviationColour(9.0, 0.5), deviationColour(0.5, 0.5));
    EXPECT_EQ(deviationColour(0.2, 0.0), deviationColour(0.0, 0.5));
    for (int i = 1; i <= 10; ++i) {
        const auto gone = deviationColour(-0.05 * i, 0.5), left = deviationColour(0.05 * i, 0.5);
        EXPECT_GT(gone[0], gone[2]) << i;
        EXPECT_GT(left[2], left[0]) << i;
        // Each step is darker, so that the size is seen in grey too.
        const auto sum = [](const std::array<std::uint8_t, 3>& c) { return c[0] + c[1] + c[2]; };
        EXPECT_LT(sum(gone), sum(deviationColour(-0.05 * (i - 1), 0.5))) << i;
        EXPECT_LT(sum(left), sum(deviationColour(0.05 * (i - 1), 0.5))) << i;
    }
}

TEST(Look, TheDepthScaleEndsWhereItIsSaidTo) {
    EXPECT_EQ(removedDepthColour(-1.0, 3.0), removedDepthColour(0.0, 3.0));
    EXPECT_EQ(removedDepthColour(9.0, 3.0), removedDepthColour(3.0, 3.0));
    EXPECT_EQ(removedDepthColour(1.0, 2.0), removedDepthColour(2.0, 4.0));
    EXPECT_EQ(removedDepthColour(0.0, 0.0), removedDepthColour(0.0, 3.0));
    EXPECT_EQ(removedDepthColour(0.1, 0.0), removedDepthColour(3.0, 3.0));
}

TEST(Look, ALegendHoldsEachTissueOnceInItsOrder) {
    const auto legend = legendOf({Tissue::dentine, Tissue::none, Tissue::enamel, Tissue::dentine}, Palette::textbook);
    ASSERT_EQ(legend.size(), 2u);
    EXPECT_EQ(legend[0].tissue, Tissue::dentine);
    EXPECT_EQ(legend[1].tissue, Tissue::enamel);
    EXPECT_EQ(legend[1].colour, colourOf(Tissue::enamel, Palette::textbook));
}

TEST(Look, NamesAreKnownOrTold) {
    EXPECT_EQ(qualityByName("rich"), Quality::rich);
    EXPECT_EQ(paletteByName("colour-safe"), Palette::colourSafe);
    EXPECT_EQ(stereoByName("side-by-side"), Stereo::sideBySide);
    EXPECT_NE(test::errorOf([] { (void)qualityByName("best"); }).find("fast, fine, rich"), std::string::npos);
    EXPECT_NE(test::errorOf([] { (void)paletteByName(""); }).find("natural, textbook, colour-safe"), std::string::npos);
    EXPECT_NE(test::errorOf([] { (void)stereoByName("vr"); }).find("anaglyph"), std::string::npos);
}

}  // namespace
}  // namespace handpiece::view::look_test
