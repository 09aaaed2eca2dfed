// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/work_on.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "base/geometry/meshes.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::cases::work_on_test {
namespace {

using core::Pose;
using core::Vec3;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

Pose randomPose(std::mt19937_64& random) {
    return {test::uniform(random, 1, 20) * test::randomDirection(random), test::randomRotation(random)};
}

/// Blocks 1 mm apart in two rows, 47 to 45 below 17 to 14 with other gaps above each, every one in a frame of its own;
/// the lower row then moved away.
struct Blocks {
    std::map<int, Pose> inMouth;  ///< opened
    Pose mandible;
    Case toothCase;  ///< of 46

    explicit Blocks(std::uint64_t seed) {
        std::mt19937_64 random(seed);
        mandible = randomPose(random);
        const std::map<int, double> gapsAbove{{47, 0.5}, {46, 0.25}, {45, 0.35}};
        std::map<int, Tooth> teeth;
        const auto add = [&](int fdi, const Vec3& least) {
            const Pose closed = randomPose(random);
            Tooth tooth;
            tooth.name = std::to_string(fdi);
            tooth.fdiNumber = fdi;
            tooth.outer = geometry::transformed(test::boxMesh(least, least + Vec3(7, 8, 8)), closed.inverse());
            tooth.landmarks = {{LandmarkKind::pit, "middle", {Vec3(0.5, 0, fdi)}, LandmarkSource::set}};
            inMouth[fdi] = fdi > 30 ? mandible * closed : closed;
            teeth[fdi] = tooth;
        };
        for (const int place : {7, 6, 5}) {
            const double x = 8.0 * place;
            add(40 + place, {x, 0, 0});
            add(10 + place, {x, 0, 8.0 + gapsAbove.at(40 + place)});
        }
        add(14, {32, 0, 12});
        static_cast<Tooth&>(toothCase) = teeth[46];
        for (const auto& [fdi, tooth] : teeth) {
            if (fdi == 46) continue;
            PlacedTooth other;
            static_cast<Tooth&>(other) = tooth;
            other.inCase = inMouth[46].inverse() * inMouth[fdi];
            toothCase.others.push_back(other);
        }
        toothCase.scenery = {{"gum", Tissue::gum, 5, test::boxMesh({-9, -9, -9}, {9, 9, -1}), true}};
        toothCase.opening = inMouth[46].inverse() * mandible * inMouth[46];
        toothCase.exercise.emplace();
        chooseCuttable(toothCase);
    }
};

std::vector<int> cuttable(const Case& c) {
    std::vector<int> found;
    for (const PlacedTooth& other : c.others)
        if (other.isCuttable) found.push_back(other.fdiNumber);
    return found;
}

double apart(const Pose& a, const Pose& b) {
    double most = 0.0;
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(50, 0, 0), Vec3(0, 50, 0), Vec3(0, 0, 50)})
        most = std::max(most, (a.apply(p) - b.apply(p)).norm());
    return most;
}

TEST(WorkOn, ThereAndBackMovesNothing) {
    const std::uint64_t seed = test::seed();
    SCOPED_TRACE(seed);
    const Blocks blocks(seed);
    const Case& before = blocks.toothCase;
    Case c = before;
    for (const int fdi : {16, 45, 14, 47, 46}) {
        c = workOn(std::move(c), fdi);
        EXPECT_EQ(c.fdiNumber, fdi);
        EXPECT_EQ(c.landmarks[0].pointsMm[0].z(), fdi);
        const Pose& own = blocks.inMouth.at(fdi);
        for (const PlacedTooth& other : c.others)
            EXPECT_LT(apart(own * other.inCase, blocks.inMouth.at(other.fdiNumber)), 1e-9) << other.fdiNumber;
        EXPECT_LT(apart(own * c.opening * own.inverse(), blocks.mandible), 1e-9);
    }
    ASSERT_EQ(c.others.size(), before.others.size());
    for (std::size_t i = 0; i < c.others.size(); ++i) {
        EXPECT_EQ(c.others[i].fdiNumber, before.others[i].fdiNumber) << "in the same order";
        EXPECT_EQ(c.others[i].outer.vertices, before.others[i].outer.vertices);
    }
    for (std::size_t v = 0; v < c.scenery[0].mesh.vertices.size(); ++v)
        EXPECT_LT((c.scenery[0].mesh.vertices[v] - before.scenery[0].mesh.vertices[v]).norm(), 1e-9);
    EXPECT_EQ(caseKey(c), caseKey(before)) << "an attempt at it is still one";
}

TEST(WorkOn, NeighboursAndAntagonistsAreCuttable) {
    const std::uint64_t seed = test::seed();
    SCOPED_TRACE(seed);
    const Blocks blocks(seed);
    EXPECT_THAT(cuttable(blocks.toothCase), ElementsAre(16, 45, 47));
    EXPECT_THAT(cuttable(workOn(blocks.toothCase, 16)), ElementsAre(15, 17, 46));
    EXPECT_THAT(cuttable(workOn(blocks.toothCase, 45)), ElementsAre(46)) << "0.35 mm are too far";
    EXPECT_THAT(cuttable(workOn(blocks.toothCase, 14)), ElementsAre(15));
    EXPECT_FALSE(workOn(blocks.toothCase, 45).exercise);
    EXPECT_TRUE(workOn(blocks.toothCase, 46).exercise) << "it is that one already";
    Case asOpened = blocks.toothCase;
    asOpened.opening = {};
    EXPECT_THAT(cuttable(workOn(asOpened, 16)), ElementsAre(15, 17)) << "the jaws are apart";
}

TEST(WorkOn, TheJawsCloseAgain) {
    const std::uint64_t seed = test::seed();
    SCOPED_TRACE(seed);
    const Blocks blocks(seed);
    const auto closed = [&](int fdi) {
        return fdi > 30 ? blocks.mandible.inverse() * blocks.inMouth.at(fdi) : blocks.inMouth.at(fdi);
    };
    for (const int fdi : {46, 16}) {
        const Case c = inOcclusion(workOn(blocks.toothCase, fdi));
        for (const PlacedTooth& other : c.others)
            EXPECT_LT(apart(closed(fdi) * other.inCase, closed(other.fdiNumber)), 1e-9) << other.fdiNumber;
        EXPECT_LT(apart(c.opening, {}), 1e-12);
    }
    // What stands around goes with its arch.
    Case two;
    two.fdiNumber = 46;
    two.opening = {{0, 3, -40}, core::Quat(0.9, 0.1, 0.2, 0).normalized()};
    two.others.resize(1);
    two.others[0].fdiNumber = 16;
    two.others[0].inCase = two.opening.inverse() * Pose{{0, 0, 15}, core::Quat::Identity()};
    const geometry::TriangleMesh below = test::boxMesh({-9, -9, -9}, {9, 9, -1}),
                                 above = test::boxMesh({-9, -9, 16}, {9, 9, 24});
    two.scenery = {{"lower", Tissue::gum, 5, below},
                   {"upper", Tissue::gum, 5, geometry::transformed(above, two.opening.inverse())}};
    const Case shut = inOcclusion(two);
    EXPECT_EQ(shut.scenery[0].mesh.vertices, below.vertices);
    for (std::size_t v = 0; v < above.vertices.size(); ++v)
        EXPECT_LT((shut.scenery[1].mesh.vertices[v] - above.vertices[v]).norm(), 1e-9);
}

TEST(WorkOn, SaysWhichTeethThereAre) {
    Case c = Blocks(1).toothCase;
    c.source = "some/mouth";
    EXPECT_THAT(test::errorOf([&] { (void)workOn(c, 36); }),
                AllOf(HasSubstr("no tooth 36"), HasSubstr("some/mouth"), HasSubstr("14, 15, 16, 17, 45, 47")));
    EXPECT_THAT(test::errorOf([&] { (void)workOn(c, 0); }), HasSubstr("no tooth 0"));
    c.others.clear();
    EXPECT_THAT(test::errorOf([&] { (void)workOn(c, 45); }), HasSubstr("no other tooth"));
}

TEST(WorkOn, TheOpeningIsKeptInFiles) {
    const Case c = Blocks(2).toothCase;
    const test::TemporaryFolder folder;
    writeCase(c, folder.path() / "mouth");
    const Case read = readCase(folder.path() / "mouth");
    EXPECT_LT(apart(read.opening, c.opening), 1e-9);
    EXPECT_THAT(cuttable(workOn(read, 16)), ElementsAre(15, 17, 46));
}

}  // namespace
}  // namespace handpiece::cases::work_on_test
