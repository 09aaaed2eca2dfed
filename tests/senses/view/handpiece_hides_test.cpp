// SPDX-License-Identifier: Apache-2.0
// The handpiece never hides what is worked at: from every standard view, wherever on the crown the bur stands and
// however it is held, little of the crown lies behind the handpiece; and what is left of it is one piece.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "handpiece/base/core/rotation.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/renderer.h"
#include "support/closed_meshes.h"

namespace handpiece::view::handpiece_hides_test {
namespace {

using core::Vec3;

constexpr Viewport kSize{480, 300};
/// Of the crown; the school's walker allows a third of what is seen.
constexpr double kMostHidden = 0.10;

/// As wide and high as a molar's crown over the gingiva.
geometry::TriangleMesh crown() {
    return test::icosphere(4, [](const Vec3& v) { return Vec3(5.5 * v.x(), 5.0 * v.y(), 5.0 * v.z()); });
}

Look plain() {
    Look look;
    look.quality = Quality::fine;
    look.backgroundTop = look.backgroundBottom = {0, 0, 255};
    look.shadows = look.spray = look.debris = look.wet = look.scaleBar = false;
    return look;
}

int difference(const Image& a, const Image& b, std::size_t pixel) {
    int most = 0;
    for (std::size_t k = 0; k < 3; ++k)
        most = std::max(most, std::abs(int{a.rgba[4 * pixel + k]} - int{b.rgba[4 * pixel + k]}));
    return most;
}

struct Seen {
    double hidden = 0.0;  ///< share of the crown
    int pieces = 0;       ///< of the handpiece that float in the picture, more than specks: none goes to its edge
};

/// Groups of pixels that touch each other and not the edge, beyond which they may be one.
int piecesOf(std::vector<char>& marked, int width, int height, int speck) {
    int pieces = 0;
    std::vector<int> waiting;
    for (int start = 0; start < width * height; ++start) {
        if (!marked[static_cast<std::size_t>(start)]) continue;
        int size = 0;
        bool isAtEdge = false;
        waiting.push_back(start);
        marked[static_cast<std::size_t>(start)] = 0;
        while (!waiting.empty()) {
            const int at = waiting.back();
            waiting.pop_back();
            ++size;
            const int x = at % width, y = at / width;
            isAtEdge = isAtEdge || x == 0 || y == 0 || x == width - 1 || y == height - 1;
            for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
                const int nx = x + dx, ny = y + dy;
                if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
                const auto next = static_cast<std::size_t>(ny * width + nx);
                if (!marked[next]) continue;
                marked[next] = 0;
                waiting.push_back(static_cast<int>(next));
            }
        }
        pieces += size > speck && !isAtEdge ? 1 : 0;
    }
    return pieces;
}

class HandpieceHides : public ::testing::Test {
  protected:
    HandpieceHides() {
        const auto bur = instrument::makeInstrument("330").bur;
        renderer_.setMesh(crown(), cases::Tissue::enamel);
        renderer_.setBur(bur->mesh(), bur->lengthMm(), bur->maxRadiusMm());
        renderer_.setTurbine(instrument::turbineMesh());
    }
    Seen look(const Camera& camera, const core::Pose& bur, const char* name = nullptr) {
        Look without = plain(), with = plain();
        without.turbine = without.bur = false;
        Moment moment;
        moment.burInTooth = bur;
        moment.burShown = true;
        moment.speedRpm = 200000.0;
        Image bare, whole, nothing;
        renderer_.draw(camera, kSize, without, moment, bare);
        with.bur = false;
        renderer_.draw(camera, kSize, with, moment, whole);
        std::size_t ofCrown = 0, hidden = 0;
        const auto count = static_cast<std::size_t>(kSize.width) * static_cast<std::size_t>(kSize.height);
        std::vector<char> changed(count, 0);
        for (std::size_t i = 0; i < count; ++i) {
            const bool isCrown = bare.rgba[4 * i] > 40;  // the ground is blue alone
            const int by = difference(bare, whole, i);
            ofCrown += isCrown ? 1 : 0;
            hidden += isCrown && by > 24 ? 1 : 0;
            changed[i] = by > 60 ? 1 : 0;
        }
        if (name != nullptr)
            if (const char* folder = std::getenv("HANDPIECE_TEST_PICTURES")) {
                with.bur = true;
                renderer_.draw(camera, kSize, with, moment, whole);
                writePng(whole, std::filesystem::path(folder) / (std::string(name) + ".png"));
            }
        EXPECT_GT(ofCrown, 1000u);
        return {static_cast<double>(hidden) / static_cast<double>(ofCrown),
                piecesOf(changed, kSize.width, kSize.height, 60)};
    }

    Renderer renderer_;
};

/// Tilted by `tiltRad` towards an azimuth, the handle to `handleRad` about the axis.
core::Pose held(const Vec3& tip, double tiltRad, double towardsRad, double handleRad) {
    core::Pose pose;
    pose.positionMm = tip;
    const Vec3 about(-std::sin(towardsRad), std::cos(towardsRad), 0.0);
    pose.orientation = core::rotationAbout(about, tiltRad) * core::rotationAbout(Vec3::UnitZ(), handleRad);
    return pose;
}

TEST_F(HandpieceHides, LittleOfTheCrownFromEveryView) {
    const core::Box box = crown().bounds();
    double most = 0.0, sum = 0.0;
    int looks = 0;
    for (const int buccal : {1, -1})
        for (const auto& [standard, name] : standardViews()) {
            const Camera camera = standardView(standard, box.grown(1.5), buccal, kSize),
                         wide = standardView(standard, box.grown(14.0), buccal, kSize);
            for (const auto& [x, y] : {std::pair(0.0, 0.0), std::pair(0.6, 0.0), std::pair(-0.6, 0.0),
                                       std::pair(0.0, 0.6), std::pair(0.0, -0.6)}) {
                const Vec3 tip(5.5 * x, 5.0 * y, 5.0 * std::sqrt(1.0 - x * x - y * y));
                for (const double tilt : {0.0, 0.5})
                    for (const double towards : {0.0, 1.57, 3.14, 4.71})
                        for (const double handle : {0.35, -0.35, 1.57, -1.57}) {
                            if (tilt == 0.0 ? towards > 0.0 : std::abs(handle) > 1.0) continue;
                            const bool isFirst = x == 0.0 && y == 0.0 && tilt == 0.0 && handle == 0.35 && buccal == 1;
                            const Seen seen = look(camera, held(tip, tilt, towards, handle),
                                                   isFirst ? std::string("hides-").append(name).c_str() : nullptr);
                            if (tilt == 0.0) {
                                EXPECT_LE(look(wide, held(tip, tilt, towards, handle)).pieces, 1) << name;
                            }
                            most = std::max(most, seen.hidden);
                            sum += seen.hidden;
                            ++looks;
                            EXPECT_LE(seen.hidden, kMostHidden)
                                << name << " buccal " << buccal << " at " << x << ' ' << y << " tilt " << tilt << " to "
                                << towards << " handle " << handle;
                            EXPECT_LE(seen.pieces, 1) << name << " at " << x << ' ' << y << " tilt " << tilt << " to "
                                                      << towards << " handle " << handle;
                        }
            }
        }
    std::printf("hidden at most %.1f %%, %.2f %% in the mean of %d looks\n", 100.0 * most, 100.0 * sum / looks, looks);
}

TEST_F(HandpieceHides, OnTheSideOfTheCrownToo) {
    const core::Box box = crown().bounds();
    for (const auto& [standard, name] : standardViews()) {
        const Camera camera = standardView(standard, box.grown(1.5), 1, kSize);
        for (const double height : {0.0, 2.0}) {
            const double out = 5.0 * std::sqrt(1.0 - height * height / 25.0);
            // The bur square to the buccal surface, as for a class V.
            for (const double handle : {0.0, 1.57, 3.14, -1.57}) {
                const Seen seen = look(camera, held({0.0, out, height}, 1.45, 1.57, handle));
                EXPECT_LE(seen.hidden, kMostHidden) << name << " height " << height << " handle " << handle;
                EXPECT_LE(seen.pieces, 1) << name << " height " << height << " handle " << handle;
            }
        }
    }
}

/// A bur that is lifted, at a neighbour or on its way: the handpiece comes between the eye and the crown all the same.
TEST_F(HandpieceHides, NorWhereTheBurIsElsewhere) {
    const core::Box box = crown().bounds();
    double most = 0.0;
    for (const auto& [standard, name] : standardViews()) {
        const Camera camera = standardView(standard, box.grown(1.5), 1, kSize);
        const Vec3 towards = -camera.forward(), right = camera.right(), up = camera.upward();
        for (const double nearer : {0.0, 6.0, 14.0})
            for (const auto& [aside, above] : {std::pair(-12.0, 0.0), std::pair(12.0, 0.0), std::pair(0.0, 12.0),
                                               std::pair(0.0, -12.0), std::pair(-9.0, -9.0), std::pair(9.0, 9.0)})
                for (const double handle : {0.35, -0.35, 2.8, 3.5}) {
                    const bool isFirst = nearer == 14.0 && aside == -12.0 && handle == 0.35;
                    const Seen seen =
                        look(camera, held(nearer * towards + aside * right + above * up, 0.0, 0.0, handle),
                             isFirst ? std::string("elsewhere-").append(name).c_str() : nullptr);
                    most = std::max(most, seen.hidden);
                    EXPECT_LE(seen.hidden, kMostHidden) << name << " nearer " << nearer << " aside " << aside
                                                        << " above " << above << " handle " << handle;
                    EXPECT_LE(seen.pieces, 1) << name << " nearer " << nearer << " aside " << aside << " above "
                                              << above << " handle " << handle;
                }
    }
    std::printf("hidden at most %.1f %%\n", 100.0 * most);
}

/// Where it lies over nothing that is worked at it is there: metal, not a veil.
TEST_F(HandpieceHides, BesideTheWorkItIsThere) {
    const core::Box box = crown().bounds();
    Camera camera = standardView(StandardView::buccal, box.grown(14.0), 1, kSize);
    Look with = plain(), without = plain();
    without.turbine = false;
    Moment moment;
    moment.burInTooth.positionMm = {0.0, 0.0, 5.0};
    Image a, b;
    renderer_.draw(camera, kSize, with, moment, a);
    renderer_.draw(camera, kSize, without, moment, b);
    int changed = 0;
    for (std::size_t i = 0; i < a.rgba.size() / 4; ++i)
        changed += difference(a, b, i) > 60 ? 1 : 0;
    EXPECT_GT(changed, 4000);
}

}  // namespace
}  // namespace handpiece::view::handpiece_hides_test
