// SPDX-License-Identifier: Apache-2.0
// What is cut into a plane: faces that the lamp lights alike are told apart; a block of enamel alone has no neck.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "handpiece/senses/view/renderer.h"

namespace handpiece::view::hollows_test {
namespace {

using cases::Tissue;
using core::Vec3;

constexpr Viewport kSize{400, 320};

void addQuad(geometry::TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

/// A plane 12 mm wide with a box of 4 x 4 mm cut 0.5 mm deep into its middle.
geometry::TriangleMesh planeWithBox() {
    geometry::TriangleMesh mesh;
    constexpr double kFar = 6.0, kNear = 2.0, kDeep = -0.5;
    const auto corner = [](double half, int k, double z) {
        return Vec3(k == 0 || k == 3 ? -half : half, k < 2 ? -half : half, z);
    };
    for (int k = 0; k < 4; ++k) {
        const int next = (k + 1) % 4;
        addQuad(mesh, corner(kFar, k, 0), corner(kFar, next, 0), corner(kNear, next, 0), corner(kNear, k, 0));
        addQuad(mesh, corner(kNear, k, 0), corner(kNear, next, 0), corner(kNear, next, kDeep), corner(kNear, k, kDeep));
    }
    addQuad(mesh, corner(kNear, 0, kDeep), corner(kNear, 1, kDeep), corner(kNear, 2, kDeep), corner(kNear, 3, kDeep));
    return mesh;
}

Image picture(const geometry::TriangleMesh& mesh, const Vec3& eye, double fieldOfViewRad) {
    Renderer renderer;
    renderer.setMesh(mesh, Tissue::enamel);
    Camera camera;
    camera.eyeMm = eye;
    camera.targetMm = Vec3::Zero();
    camera.up = Vec3::UnitY();
    camera.fieldOfViewRad = fieldOfViewRad;
    Look look;
    look.bur = look.turbine = false;
    Moment moment;
    moment.burShown = false;
    Image image;
    for (int i = 0; i < 6 && renderer.draw(camera, kSize, look, moment, image).refining; ++i) {
    }
    return image;
}

double brightness(const Image& image, int x, int y) {
    const std::uint8_t* p = image.at(x, y);
    return (77.0 * p[0] + 150.0 * p[1] + 29.0 * p[2]) / 256.0;
}

TEST(Hollows, EachWallOfAShallowBoxIsToldFromThePlaneAndFromItsFloor) {
    // From straight above, walls are lines: only their edges tell that there is a box.
    const Image image = picture(planeWithBox(), {0.0, 0.0, 40.0}, 0.3);
    const int middleX = kSize.width / 2, middleY = kSize.height / 2;
    const double pixelsPerMm = 0.5 * kSize.height / (40.0 * std::tan(0.15));
    const int edge = static_cast<int>(std::lround(2.0 * pixelsPerMm));
    for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{-1, 0}, std::pair{0, 1}, std::pair{0, -1}}) {
        double least = 255.0, most = 0.0;
        for (int k = edge - 5; k <= edge + 5; ++k) {
            const double b = brightness(image, middleX + k * dx, middleY + k * dy);
            least = std::min(least, b), most = std::max(most, b);
        }
        std::printf("[ box ] wall towards %d %d: %.1f of 255\n", dx, dy, most - least);
        EXPECT_GT(most - least, 20.0) << dx << ' ' << dy;
    }
}

TEST(Hollows, ABlockOfEnamelAloneIsOfOneColourFromItsTopToItsFoot) {
    geometry::TriangleMesh wall;
    addQuad(wall, {-4, -6, -8}, {4, -6, -8}, {4, -6, 0}, {-4, -6, 0});
    Renderer renderer;
    renderer.setMesh(wall, Tissue::enamel);
    renderer.setParts(std::vector<cases::Part>{{"enamel", Tissue::enamel, 0, wall}});
    Camera camera;
    camera.eyeMm = {0.0, -40.0, -4.0};
    camera.targetMm = {0.0, 0.0, -4.0};
    Look look;
    look.bur = look.turbine = look.wet = false;
    Moment moment;
    moment.burShown = false;
    Image image;
    for (int i = 0; i < 6 && renderer.draw(camera, kSize, look, moment, image).refining; ++i) {
    }
    const auto at = [&](double z) {
        const auto pixel = pixelOf(camera, kSize, Vec3(0.0, -6.0, z));
        EXPECT_TRUE(pixel.has_value());
        return image.at(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()));
    };
    const std::uint8_t *top = at(-0.7), *foot = at(-7.3);
    // Enamel over a neck is yellow: 40 less blue against red.
    EXPECT_NEAR(top[0] - top[2], foot[0] - foot[2], 6);
}

}  // namespace
}  // namespace handpiece::view::hollows_test
