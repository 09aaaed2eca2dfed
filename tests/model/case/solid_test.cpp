// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/geometry/meshes.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "support/random.h"

namespace handpiece::cases::solid_test {
namespace {

using geometry::TriangleMesh;
using test::joined;
using test::sphereMesh;
using testing::AllOf;
using testing::HasSubstr;

std::string refusal(const TriangleMesh& mesh) {
    try {
        requireSolid(mesh, "molar.stl");
    } catch (const core::Error& e) {
        return e.what();
    }
    return {};
}

const TriangleMesh kBall = sphereMesh({1, 2, 3}, 5, 10);

TEST(RequireSolid, TakesWhatCanBeFelt) {
    EXPECT_EQ(refusal(kBall), "");
    EXPECT_EQ(refusal(test::torusMesh(5, 2, 20)), "");
    EXPECT_EQ(refusal(joined(kBall, test::insideOut(sphereMesh({1, 2, 3}, 2, 5)))), "") << "with a cavity";
    EXPECT_EQ(refusal(joined(test::boxMesh({0, 0, 0}, {1, 1, 1}), test::boxMesh({1, 0, 0}, {2, 1, 1}))), "")
        << "shells that touch";
}

TEST(RequireSolid, RefusesWithCountsPlaceAndCommand) {
    const auto command = HasSubstr("handpiece mesh repair molar.stl OUT");
    TriangleMesh open = kBall;
    open.triangles.erase(open.triangles.begin() + 70);
    open.triangles.erase(open.triangles.begin() + 20);
    EXPECT_THAT(refusal(open),
                AllOf(HasSubstr("molar.stl: "), HasSubstr("6 open edges around 2 holes, the first at ("), command));

    TriangleMesh forked = kBall;
    forked.vertices.emplace_back(9, 9, 9);
    forked.vertices.emplace_back(9, 9, 8);
    const auto tip = static_cast<std::uint32_t>(forked.vertices.size() - 2);
    const geometry::Triangle t = forked.triangles[5];
    for (const geometry::Triangle& face :
         {geometry::Triangle{t[1], t[0], tip}, geometry::Triangle{t[0], t[1], tip + 1},
          geometry::Triangle{t[0], tip + 1, tip}, geometry::Triangle{t[1], tip, tip + 1}})
        forked.triangles.push_back(face);
    EXPECT_THAT(refusal(forked), AllOf(HasSubstr("1 edge of more than two faces, the first at ("), command));

    TriangleMesh flipped = kBall;
    std::swap(flipped.triangles[7][0], flipped.triangles[7][1]);
    EXPECT_THAT(refusal(flipped), AllOf(HasSubstr("1 face looks the other way than its neighbours"), command));
    EXPECT_THAT(refusal(test::insideOut(kBall)), AllOf(HasSubstr("1 closed shell is inside out"), command));
    EXPECT_THAT(refusal(joined(kBall, sphereMesh({7, 2, 3}, 3, 8))),
                AllOf(HasSubstr("crosses itself: "), HasSubstr("pairs of faces, the first at (")));
    EXPECT_THAT(refusal(TriangleMesh{}), HasSubstr("no faces"));
}

TEST(RequireSolid, RefusesOtherUnits) {
    const auto scaled = [](double factor) {
        TriangleMesh mesh = kBall;
        for (core::Vec3& v : mesh.vertices)
            v *= factor;
        return mesh;
    };
    EXPECT_THAT(refusal(scaled(1000)), AllOf(HasSubstr("probably um"), HasSubstr("export it in millimetres")));
    EXPECT_THAT(refusal(scaled(0.001)), HasSubstr("probably m:"));
    EXPECT_EQ(refusal(scaled(0.1)), "");
    EXPECT_EQ(refusal(scaled(8)), "");
}

TEST(RequireSolid, RealTools) {
    const std::filesystem::path data = test::realDataFolder();
    if (data.empty()) GTEST_SKIP() << "no real data beside the checkout";
    EXPECT_EQ(refusal(geometry::readMesh(data / "tools" / "tapered_bur.stl")), "");
    EXPECT_THAT(refusal(geometry::readMesh(data / "tools" / "contra_angle_head.stl")), HasSubstr("43 open edges"));
}

}  // namespace
}  // namespace handpiece::cases::solid_test
