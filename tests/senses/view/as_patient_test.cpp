// SPDX-License-Identifier: Apache-2.0
// What an operator sees of a mouth: which way up it stands, and whether light leaves detail everywhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "handpiece/model/case/fdi.h"
#include "handpiece/senses/view/renderer.h"
#include "model/dentition/mouths.h"
#include "support/random.h"

namespace handpiece::view::as_patient_test {
namespace {

using core::Vec3;

/// Coarse outer surfaces in their arches, 40 mm open; made once.
struct Mouth {
    std::vector<cases::Tooth> teeth = dentition::coarseTeeth({}, 0.45);
    std::vector<core::Pose> inMouth{dentition::kToothCount};

    Mouth() {
        const dentition::Arrangement arches = dentition::arrange(teeth);
        const core::Pose mandible = dentition::opened(arches, 40.0);
        for (std::size_t i = 0; i < dentition::kToothCount; ++i)
            inMouth[i] =
                dentition::isUpper(i) ? arches.toothInMouth[i] : (mandible * arches.toothInMouth[i]).normalised();
    }
    [[nodiscard]] cases::Case workedOn(int fdi) const {
        const std::size_t own = dentition::indexOf(fdi);
        cases::Case made;
        static_cast<cases::Tooth&>(made) = teeth[own];
        for (std::size_t i = 0; i < dentition::kToothCount; ++i) {
            if (i == own) continue;
            cases::PlacedTooth other;
            static_cast<cases::Tooth&>(other) = teeth[i];
            other.inCase = (inMouth[own].inverse() * inMouth[i]).normalised();
            made.others.push_back(std::move(other));
        }
        return made;
    }
};
const Mouth& mouth() {
    static const Mouth made;
    return made;
}

Vec3 middleOf(const cases::Case& toothCase, bool isUpper) {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    const auto add = [&](const cases::Tooth& tooth, const core::Pose& inCase) {
        if (cases::isUpperTooth(tooth.fdiNumber) != isUpper) return;
        sum += inCase.apply(tooth.surface().bounds().centre());
        ++count;
    };
    add(toothCase, {});
    for (const cases::PlacedTooth& other : toothCase.others)
        add(other, other.inCase);
    EXPECT_GE(count, 15);
    return sum / count;
}

TEST(AsPatient, UpperTeethStandAboveTheLowerOnes) {
    for (int fdi = 11; fdi <= 48; ++fdi) {
        if (!cases::isPermanentTooth(fdi)) continue;
        const cases::Case worked = mouth().workedOn(fdi);
        const Standing standing = standingOf(fdi, worked.buccalSign);
        EXPECT_EQ(standing.isUpper, fdi < 30);
        const core::Box box = worked.surface().bounds();
        const Vec3 upper = middleOf(worked, true), lower = middleOf(worked, false);
        // Its own frame is as it was: the crown at +z, towards the other arch.
        EXPECT_GT(((fdi < 30 ? lower : upper) - (fdi < 30 ? upper : lower)).z(), 5.0) << fdi;
        for (const auto& [view, name] : standardViews()) {
            const Camera camera = standardView(view, box, standing, {640, 400});
            if (view == StandardView::occlusal) {
                EXPECT_GT(-camera.forward().z(), 0.999) << fdi << ": onto the chewing surface";
                const double buccal = worked.buccalSign < 0 ? -1.0 : 1.0;
                EXPECT_GT(camera.upward().y() * buccal * (fdi < 30 ? 1.0 : -1.0), 0.99)
                    << fdi << ": as in a chart, the lips' side of the upper arch above, of the lower one below";
                continue;
            }
            EXPECT_GT((upper - lower).dot(camera.upward()), 10.0) << fdi << " " << name;
            // Nothing is mirrored.
            EXPECT_FALSE(camera.mirrored);
            EXPECT_GT(camera.right().cross(camera.upward()).dot(-camera.forward()), 0.999);
            if (view != StandardView::buccal) continue;
            // Seen from before the patient, the midline is on the right of the patient's right teeth.
            EXPECT_GT(camera.right().x() * (cases::isRightTooth(fdi) ? 1.0 : -1.0), 0.99) << fdi;
        }
        // From the oblique view over the crown to the occlusal one nothing turns round.
        EXPECT_GT(standardView(StandardView::oblique, box, standing, {640, 400})
                      .upward()
                      .dot(standardView(StandardView::occlusal, box, standing, {640, 400}).upward()),
                  0.0)
            << fdi;
    }
}

/// Of what is neither background nor red as gingiva is: shares at white, at black, and how bright the middle is.
struct Exposure {
    double white = 0.0, black = 0.0, p5 = 0.0, p95 = 0.0;
    int pixels = 0;
};

Exposure exposureOf(const Image& image, const Image& onOther) {
    std::vector<int> bright;
    int white = 0, black = 0;
    for (std::size_t i = 0; i + 3 < image.rgba.size(); i += 4) {
        const auto* c = &image.rgba[i];
        const auto* other = &onOther.rgba[i];
        if (std::abs(c[0] - other[0]) + std::abs(c[1] - other[1]) + std::abs(c[2] - other[2]) > 24) continue;
        if (c[0] > 1.35 * c[1] + 8) continue;
        const int most = std::max({c[0], c[1], c[2]});
        bright.push_back(static_cast<int>(std::lround(0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2])));
        white += bright.back() > 242 || most >= 254 ? 1 : 0;  // 0.95 of full
        black += most < 26 ? 1 : 0;                           // 0.1
    }
    Exposure e;
    e.pixels = static_cast<int>(bright.size());
    if (bright.empty()) return e;
    std::sort(bright.begin(), bright.end());
    const auto at = [&](double share) {
        return bright[static_cast<std::size_t>(share * static_cast<double>(bright.size() - 1))] / 255.0;
    };
    e.p5 = at(0.05), e.p95 = at(0.95);
    e.white = static_cast<double>(white) / e.pixels;
    e.black = static_cast<double>(black) / e.pixels;
    return e;
}

/// With HANDPIECE_ALL_VIEWS all of the hundred, else every fifth; HANDPIECE_KEEP_VIEWS=FOLDER keeps the pictures.
TEST(AsPatient, NoViewIsBurntOutOrBlack) {
    const int step = std::getenv("HANDPIECE_ALL_VIEWS") != nullptr ? 1 : 5;
    const char* const keep = std::getenv("HANDPIECE_KEEP_VIEWS");
    std::mt19937_64 random(test::seed());
    constexpr int kTeeth[] = {11, 46, 13, 24, 16, 33, 45, 37, 41, 27};
    constexpr Viewport kSize{240, 180};
    Renderer renderer;
    Look look;
    look.bur = look.turbine = false;
    Moment moment;
    moment.burShown = false;
    int bad = 0, seen = 0;
    for (int t = 0; t < 10; ++t) {
        const int fdi = kTeeth[t];
        const cases::Case worked = mouth().workedOn(fdi);
        const core::Box whole = worked.surface().bounds();
        const bool isInMouth = t % 2 == 0;
        renderer.setTooth(whole);
        std::vector<cases::Part> shown = dentition::makeSketch(fdi, {}).parts;
        renderer.setParts(shown);
        if (isInMouth)
            for (cases::Part& part : cases::surroundings(worked))
                shown.push_back(std::move(part));
        renderer.setScenery(shown);
        core::Box crown = whole;
        if (isInMouth || t % 4 == 1) crown.min.z() = crown.max.z() - 0.5 * crown.size().z();
        for (int v = 0; v < 10; ++v) {
            Camera camera =
                standardView(v < 6 ? standardViews()[static_cast<std::size_t>(v)].first : StandardView::oblique, crown,
                             standingOf(fdi, worked.buccalSign), kSize);
            if (v >= 6) {
                // Anywhere from over the chewing surface down to a little under the neck.
                Vec3 from = test::randomDirection(random);
                from.z() = 1.2 * std::abs(from.z()) - 0.2;
                camera.eyeMm = camera.targetMm + from.normalized() * camera.distanceMm();
                camera = fitted(camera, crown, kSize);
            }
            look.quality = static_cast<Quality>((t + v) % 3);
            look.palette = v == 3 ? Palette::textbook : Palette::natural;
            look.wet = v % 4 != 1;
            if ((10 * t + v) % step != t % step) continue;
            Image image, other;
            const auto draw = [&](const std::array<std::uint8_t, 3>& background, Image& out) {
                look.backgroundTop = look.backgroundBottom = background;
                for (int i = 0; i < 8 && (renderer.draw(camera, kSize, look, moment, out).refining || i < 2); ++i) {
                }
            };
            draw({40, 90, 40}, other);
            draw({52, 58, 66}, image);
            const Exposure e = exposureOf(image, other);
            ++seen;
            if (keep != nullptr) writePng(image, std::string(keep) + "/" + std::to_string(10 * t + v) + ".png");
            EXPECT_GT(e.pixels, 1500) << fdi << " view " << v;
            const bool isBad = e.white > 0.02 || e.black > 0.02;
            bad += isBad ? 1 : 0;
            EXPECT_FALSE(isBad) << fdi << " view " << v << " quality " << (t + v) % 3 << ": white " << e.white
                                << ", black " << e.black << ", from " << e.p5 << " to " << e.p95;
            // Not grey either: enamel under a lamp is bright, and its form is to be read.
            EXPECT_GT(e.p95, 0.60) << fdi << " view " << v;
            EXPECT_GT(e.p95 - e.p5, 0.14) << fdi << " view " << v;
        }
    }
    EXPECT_EQ(seen, 100 / step);
    RecordProperty("views", seen);
    RecordProperty("burnt_or_black", bad);
}

}  // namespace
}  // namespace handpiece::view::as_patient_test
