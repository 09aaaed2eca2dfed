// SPDX-License-Identifier: Apache-2.0
// One thing at a time: undercuts, exposures, caries, a nicked neighbour, a molar; and what cannot be measured.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "assess/measures/analytic.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "support/error_of.h"
#include "support/small_molar.h"

namespace handpiece::measures::features_test {
namespace {

using cases::Tissue;
using test::Body;
using test::BoxCavity;
using test::Marks;
using test::Shape;
using test::side;
using test::Vec3;

constexpr double kVoxel = 0.1;

Selection tissue(const char* name) {
    Selection of;
    of.tissue = name;
    return of;
}

/// A turned block whose top is z = 0, of enamel or of the tissues given in its own frame.
class Block : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        std::mt19937_64 random(handpiece::test::seed() + 3);
        body_ = test::bodyOf(test::boxMesh(Vec3(-3, -2.5, -3.5), Vec3(3, 2.5, 0)), test::randomPose(random), kVoxel);
    }
    static void TearDownTestSuite() { body_ = {}; }

    static Body of(std::vector<std::pair<Tissue, Shape>> parts, Tissue rest) {
        std::vector<field::TissueMap::PartFunction> functions;
        int priority = 0;
        for (auto& [tissue, shape] : parts)
            functions.push_back(
                {[shape = shape](const Vec3& p) { return shape(body_.inGrid.applyInverse(p)); }, tissue, ++priority});
        auto map = field::TissueMap::fromFunctions(body_.model->field, functions, rest);
        return {tooth::withTissues(*body_.model, std::move(map)), body_.inGrid};
    }
    static Preparation preparation(const Body& body, const tooth::ToothMirror& cut) {
        Preparation p;
        p.whole = body.model;
        p.cut = &cut;
        p.axes = body.axes();
        return p;
    }
    static Measured take(const Preparation& p, const char* kind, Selection of = {}) {
        return measure(p, std::vector<Request>{{kind, std::move(of)}}).front();
    }
    static inline Body body_;
};

/// A groove along x is asked, 1.6 mm wide and 1.8 deep. The left is done, the middle half: most is left at the right,
/// though it reaches no deeper under the surface there than in the middle. Too long it is at the left.
TEST_F(Block, whatIsLeftAndWhatIsTooMuchAreShownWhereTheyAre) {
    const auto slab = [](double fromX, double toX, double deepMm, const Vec3& p) {
        return std::max({fromX - p.x(), p.x() - toX, std::abs(p.y()) - 0.8, -deepMm - p.z()});
    };
    const auto cut =
        test::carved(body_, [&](const Vec3& p) { return std::min(slab(-2.6, -0.5, 1.8, p), slab(-0.5, 0.8, 0.9, p)); });
    Preparation p = preparation(body_, *cut);
    const zones::Zones zones(
        [&](const Vec3& q) {
            return zones::PastTarget{slab(-2.0, 2.6, 1.8, body_.inGrid.applyInverse(q)), -zones::kFarMm};
        },
        body_.model->tree.bounds().grown(1.0), {0.2, 0.2});
    p.zones = &zones;
    const auto placeOf = [&](const char* kind, const char* zone) {
        Selection of;
        of.zone = zone;
        const Measured measured = take(p, kind, of);
        return measured.evidence.empty() ? Vec3(Vec3::Constant(99.0))
                                         : body_.inGrid.applyInverse(*measured.evidence.front().placeMm);
    };
    const Vec3 left = placeOf("removed-share", "target");
    EXPECT_GT(left.x(), 0.8) << left.transpose();
    EXPECT_LT(left.x(), 2.6);
    EXPECT_NEAR(left.z(), 0.0, 1.0);
    EXPECT_NEAR(placeOf("removed", "container").x(), -2.6, 0.1);
    EXPECT_NEAR(placeOf("removed", "leeway-side").x(), -2.6, 0.1);
    EXPECT_EQ(placeOf("removed", "protected").x(), 99.0) << "nothing is protected";
}

TEST_F(Block, anUndercutIsFoundWhereItIsAndRoughnessIsNone) {
    BoxCavity box;
    box.angleDeg[1] = -8.0;
    box.radiusMm = 0.1;
    const auto cut = test::carved(body_, box.solid());
    const Preparation p = preparation(body_, *cut);
    // The rounded corner's outermost place against the wall at the top.
    const double deep = box.wallAt(1, -box.depthMm + box.radiusMm) - box.radiusMm / std::cos(8 * test::kRad) +
                        box.radiusMm - box.wallAt(1, 0.0);
    const Measured depth = take(p, "undercut-depth", side("mesial"));
    ASSERT_TRUE(depth.value);
    EXPECT_NEAR(*depth.value, deep, 0.01);
    ASSERT_FALSE(depth.evidence.empty());
    EXPECT_LT(body_.inGrid.applyInverse(*depth.evidence[0].placeMm).z(), -1.4);
    const Measured area = take(p, "undercut-area");
    const double wall = (box.depthMm - box.radiusMm) / std::cos(8 * test::kRad) *
                        (box.wallAt(2, -0.9) + box.wallAt(3, -0.9) - 2 * box.radiusMm);
    EXPECT_NEAR(*area.value, wall, 0.15 * wall);
    EXPECT_EQ(take(p, "undercut-area", side("distal")).value, 0.0);
    EXPECT_NEAR(*take(p, "wall-angle", side("mesial")).value, -8.0, 0.1);
    // Upright walls with marks of 8 um are no undercut, though the path of draw cannot see half of them.
    BoxCavity upright;
    for (double& angle : upright.angleDeg)
        angle = 0.0;
    Marks marks;
    marks.amplitudeMm = 0.008;
    const auto rough =
        test::carved(body_, [solid = upright.solid(), marks](const Vec3& q) { return solid(q) + marks(q); });
    const Preparation r = preparation(body_, *rough);
    EXPECT_EQ(take(r, "undercut-area").value, 0.0);
    EXPECT_NEAR(*take(r, "roughness").value, 1000 * marks.rmsMm(), 3.0);
}

TEST_F(Block, remainingDentineAndOpenPulp) {
    const Vec3 centre(0.2, 0, -2.6);
    const Body body = of({{Tissue::pulp, [=](const Vec3& q) { return (q - centre).norm() - 0.6; }}}, Tissue::dentine);
    BoxCavity box;
    box.depthMm = 1.6;
    const auto near = test::carved(body, box.solid());
    const Measured left = take(preparation(body, *near), "remaining-dentine");
    ASSERT_TRUE(left.value) << left.reason;
    EXPECT_NEAR(*left.value, 0.4, 0.03);
    EXPECT_LT((body.inGrid.applyInverse(*left.evidence[0].placeMm) - Vec3(0.2, 0, -1.6)).norm(), 0.25);
    EXPECT_EQ(take(preparation(body, *near), "pulp-exposed").value, 0.0);
    box.depthMm = 2.3;
    const auto open = test::carved(body, box.solid());
    const double area = std::numbers::pi * (0.36 - 0.09);
    EXPECT_NEAR(*take(preparation(body, *open), "pulp-exposed").value, area, 0.05 * area);
    EXPECT_EQ(take(preparation(body, *open), "remaining-dentine").value, 0.0);
}

TEST_F(Block, whatIsGoneAndWhatIsLeftOfEachTissue) {
    const double dej = -1.0;
    const Vec3 centre(0, 0, -1.9);
    const Body body = of({{Tissue::dentine, [=](const Vec3& q) { return q.z() - dej; }},
                          {Tissue::cariesFirm, [=](const Vec3& q) { return (q - centre).norm() - 0.6; }},
                          {Tissue::cariesSoft, [=](const Vec3& q) { return (q - centre).norm() - 0.4; }}},
                         Tissue::enamel);
    BoxCavity box;
    box.radiusMm = 0.05;
    for (double& angle : box.angleDeg)
        angle = 0.0;
    box.depthMm = 1.9;
    const auto cut = test::carved(body, box.solid());
    const Preparation p = preparation(body, *cut);
    const double half = 2.0 / 3.0 * std::numbers::pi;
    const double firm = half * (0.216 - 0.064), soft = half * 0.064;
    EXPECT_NEAR(*take(p, "caries-left").value, firm + soft, 0.02 * (firm + soft));
    EXPECT_NEAR(*take(p, "caries-left", tissue("caries-soft")).value, soft, 0.05 * soft);
    // The junction lies 0.9 mm over the floor: a layer of 0.1 mm under the floor is periphery.
    const double slice = std::numbers::pi * (0.36 * 0.1 - 0.001 / 3.0);
    EXPECT_NEAR(*take(p, "caries-left-periphery").value, slice, 0.1 * slice);
    EXPECT_NEAR(*take(p, "caries-left-pulpal").value, firm + soft - slice, 0.1 * slice);
    const double mouth = box.lengthMm * box.widthMm;
    EXPECT_NEAR(*take(p, "removed", tissue("enamel")).value, mouth, 0.01 * mouth);
    EXPECT_NEAR(*take(p, "removed-share", tissue("enamel")).value, 100 * mouth / 30.0, 0.5);
    // Upright walls undermine nothing.
    EXPECT_LT(*take(p, "unsupported-enamel").value, 0.02);
    // Half a millimetre of dentine gone all round under the enamel: it hangs free.
    BoxCavity wide = box;
    wide.lengthMm += 1.0;
    wide.widthMm += 1.0;
    const auto narrow = box.solid();
    const auto under = wide.solid();
    const auto hollow =
        test::carved(body, [&](const Vec3& q) { return std::min(narrow(q), std::max(under(q), q.z() - dej)); });
    const double free = wide.lengthMm * wide.widthMm - mouth;
    const Measured hangs = take(preparation(body, *hollow), "unsupported-enamel");
    EXPECT_NEAR(*hangs.value, free, 0.15 * free);
}

TEST_F(Block, cariesIsLeftWhereItIsAndNoneAlongACutThatFollowsIt) {
    // A round lesion, cut out exactly, 0.1 mm short, 0.1 mm too far, and 0.1 mm aside; the whole of it.
    constexpr double kRadius = 1.2;
    const auto ball = [](double r) { return 4.0 / 3.0 * std::numbers::pi * r * r * r; };
    const double lens = std::numbers::pi * (4.0 * kRadius + 0.1) * (2.0 * kRadius - 0.1) * (2.0 * kRadius - 0.1) / 12.0;
    struct Way {
        const char* name;
        double radius, aside, leftMm3;
    };
    const Way ways[] = {{"exactly", kRadius, 0.0, 0.0},
                        {"short", kRadius - 0.1, 0.0, ball(kRadius) - ball(kRadius - 0.1)},
                        {"too far", kRadius + 0.1, 0.0, 0.0},
                        {"aside", kRadius, 0.1, ball(kRadius) - lens},
                        {"half", kRadius - 0.35, 0.0, ball(kRadius) - ball(kRadius - 0.35)}};
    std::mt19937_64 random(handpiece::test::seed() + 17);
    for (const double voxel : {0.1, 0.05})
        for (int turn = 0; turn < 4; ++turn) {
            // The first one stands square in the grid, where whole layers of nodes lie on a border.
            const core::Pose pose = turn == 0 ? core::Pose{} : test::randomPose(random);
            const Body plain = test::bodyOf(test::boxMesh(Vec3(-2, -2, -3.5), Vec3(2, 2, 0)), pose, voxel);
            const Vec3 centre(0.03, -0.02, -1.7);
            const Shape lesion = [=](const Vec3& q) { return (q - centre).norm() - kRadius; };
            const Body body{
                tooth::withTissues(
                    *plain.model,
                    field::TissueMap::fromFunctions(
                        plain.model->field,
                        std::vector<field::TissueMap::PartFunction>{
                            {[&](const Vec3& p) { return lesion(pose.applyInverse(p)); }, Tissue::cariesSoft, 2},
                            {[&](const Vec3& p) { return lesion(pose.applyInverse(p)) - 0.4; }, Tissue::cariesFirm, 1}},
                        Tissue::dentine)),
                pose};
            for (const Way& way : ways) {
                const auto cut = test::carved(
                    body, [&](const Vec3& q) { return (q - centre - Vec3(way.aside, 0, 0)).norm() - way.radius; });
                const Preparation p = preparation(body, *cut);
                const Measured left = take(p, "caries-left", tissue("caries-soft"));
                ASSERT_TRUE(left.value);
                std::printf("caries left, %.2f mm, turn %d, %s: %.4f, is %.4f, stated %.4f\n", voxel, turn, way.name,
                            *left.value, way.leftMm3, left.uncertainty);
                EXPECT_LE(std::abs(*left.value - way.leftMm3), left.uncertainty) << way.name << " " << voxel;
                // A hundredth of a voxel of the lesion's surface and of the cut's, and a two-hundredth of what is left.
                EXPECT_LE(left.uncertainty,
                          0.025 * voxel * 4.0 * std::numbers::pi * kRadius * kRadius + 0.0051 * way.leftMm3);
            }
        }
}

TEST_F(Block, zonesCountersIsthmusAndANickedNeighbour) {
    BoxCavity box;
    const auto cut = test::carved(body_, box.solid());
    Preparation p = preparation(body_, *cut);
    Selection target;
    target.zone = "target";
    EXPECT_FALSE(take(p, "removed", target).value);
    EXPECT_NE(take(p, "removed", target).reason.find("target"), std::string::npos);
    // A task that asks for one half of the block.
    const zones::Zones half(
        [](const Vec3& q) {
            return zones::PastTarget{body_.inGrid.applyInverse(q).x(), -zones::kFarMm};
        },
        body_.model->tree.bounds().grown(20.0), {});
    p.zones = &half;
    const double all = *take(p, "removed").value;
    EXPECT_NEAR(*take(p, "removed", target).value, 0.5 * all, 0.01 * all);
    EXPECT_NEAR(*take(p, "removed-share", target).value, 100.0 * all / 2.0 / zones::zoneVolumes(half, *cut).targetMm3(),
                0.5);
    // Of a leeway of 0.4 mm beside it, 0.4 mm of the cavity's length.
    const zones::Zones with(
        [](const Vec3& q) {
            return zones::PastTarget{body_.inGrid.applyInverse(q).x(), -zones::kFarMm};
        },
        body_.model->tree.bounds().grown(20.0), {0.4, 0.4});
    p.zones = &with;
    target.zone = "leeway-side";
    const double beside = *take(p, "removed", target).value;
    EXPECT_NEAR(beside, 0.4 * box.depthMm * (box.widthMm + box.depthMm * std::tan(6.0 * test::kRad)), 0.02 * beside);
    EXPECT_NEAR(*take(p, "removed-share", target).value, 100.0 * beside / (0.4 * 5.0 * 3.5), 0.1);
    target.zone = "leeway-floor";
    EXPECT_NE(take(p, "removed-share", target).reason.find("none of it"), std::string::npos);
    p.zones = &half;
    target.zone = "container";
    EXPECT_NEAR(*take(p, "removed", target).value, 0.5 * all, 0.01 * all);
    EXPECT_FALSE(take(p, "removed-share", target).value);
    p.removedMm3.emplace();
    (*p.removedMm3)[1] = 7.5;
    EXPECT_EQ(take(p, "removed").value, 7.5);

    std::vector<cases::Landmark> cusps(2);
    cusps[0] = {cases::LandmarkKind::cuspTip, "mesiobuccal", {body_.inGrid.apply(Vec3(0.3, 2.5, 0))}};
    cusps[1] = {cases::LandmarkKind::cuspTip, "mesiolingual", {body_.inGrid.apply(Vec3(0.3, -2.5, 0))}};
    EXPECT_FALSE(take(p, "isthmus-share").value);
    p.landmarks = cusps;
    const double width = box.wallAt(2, -0.9) + box.wallAt(3, -0.9);
    EXPECT_NEAR(*take(p, "isthmus-share").value, 20.0 * width, 0.3);

    EXPECT_FALSE(take(p, "adjacent-depth").value);
    const auto nicked = test::carved(body_, [](const Vec3& q) { return (q - Vec3(3.5, 0, -1)).norm() - 0.65; });
    const Preparation::Other other[] = {{body_.model, nicked.get(), {}, 45}};
    p.others = other;
    EXPECT_NEAR(*take(p, "adjacent-depth").value, 0.15, 0.01);
    const double cap = std::numbers::pi * 0.0225 * (3 * 0.65 - 0.15) / 3;
    EXPECT_NEAR(*take(p, "adjacent-removed").value, cap, 0.05 * cap);
}

TEST_F(Block, orificesInAStraightLineAndAGougedChamber) {
    // A chamber of 3 by 2 mm from -2.2 up to -1.2, and a canal under either end of it that leans by 15 degrees.
    const double lean = std::tan(15.0 * test::kRad);
    const Vec3 orifice[] = {Vec3(1.0, 0, -2.2), Vec3(-1.0, 0, -2.2)};
    const auto chamber = [](const Vec3& q) {
        const Vec3 off = (q - Vec3(0, 0, -1.7)).cwiseAbs() - Vec3(1.5, 1.0, 0.5);
        return off.cwiseMax(0.0).norm() + std::min(off.maxCoeff(), 0.0);
    };
    const auto canal = [&](int i, const Vec3& q) {
        const Vec3 way = Vec3(i == 0 ? lean : -lean, 0, -1).normalized(), off = q - orifice[i];
        return std::max((off - off.dot(way) * way).norm() - 0.3, -off.dot(way));
    };
    const Body body = of({{Tissue::pulp,
                           [&](const Vec3& q) {
                               return std::min({chamber(q), canal(0, q), canal(1, q)});
                           }}},
                         Tissue::dentine);
    const auto box = [](const Vec3& middle, const Vec3& half) {
        return [=](const Vec3& q) {
            const Vec3 off = (q - middle).cwiseAbs() - half;
            return off.cwiseMax(0.0).norm() + std::min(off.maxCoeff(), 0.0);
        };
    };
    std::vector<cases::Landmark> marks(2);
    for (int i : {0, 1})
        marks[static_cast<std::size_t>(i)] = {
            cases::LandmarkKind::orifice, i == 0 ? "mesial" : "distal", {body_.inGrid.apply(orifice[i])}};
    const auto ask = [&](const Shape& shape, const char* kind) {
        const auto cut = test::carved(body, shape);
        Preparation p = preparation(body, *cut);
        p.landmarks = marks;
        return take(p, kind);
    };
    // The lines lean inwards on their way up: they come out at +-(1 - 2.2 lean) = +-0.41.
    const Shape whole = [&](const Vec3& q) { return std::min(box(Vec3(0, 0, 0), Vec3(1.5, 1, 1.2))(q), chamber(q)); };
    EXPECT_EQ(ask(whole, "orifices-reached").value, 100.0);
    const Shape half = [&](const Vec3& q) { return box(Vec3(0.9, 0, 0), Vec3(0.8, 1, 1.5))(q); };
    const Measured one = ask(half, "orifices-reached");
    EXPECT_EQ(one.value, 50.0);
    ASSERT_EQ(one.evidence.size(), 1U);
    EXPECT_NE(one.evidence[0].text.find("distal"), std::string::npos);
    // Above the mesial orifice, but not where its line comes out.
    EXPECT_EQ(ask(box(Vec3(1.2, 0, 0), Vec3(0.4, 1, 1.5)), "orifices-reached").value, 0.0);

    // Less than a voxel where floor and walls of the chamber meet.
    EXPECT_NEAR(*ask(whole, "gouge-depth").value, 0.0, 0.07);
    // 0.4 mm into the floor, 0.25 mm into a wall; a wide opening over the roof is none.
    const Shape floor = [&](const Vec3& q) {
        return std::min(whole(q), box(Vec3(0, 0, -1.5), Vec3(0.4, 0.4, 1.1))(q));
    };
    EXPECT_NEAR(*ask(floor, "gouge-depth").value, 0.4, 0.05);
    const Shape wall = [&](const Vec3& q) {
        return std::min(
            {whole(q), box(Vec3(0, 0.5, -1.7), Vec3(0.4, 0.75, 0.3))(q), box(Vec3(0, 0, 0), Vec3(2.4, 1.9, 0.9))(q)});
    };
    EXPECT_NEAR(*ask(wall, "gouge-depth").value, 0.25, 0.05);
    // What the task asks for is none, and where more was asked it counts from there: 0.05 mm less here.
    for (const double asked : {0.25, 0.2}) {
        const Shape target = [&](const Vec3& q) {
            return std::min(whole(q), box(Vec3(0, 0.5, -1.7), Vec3(0.4, 0.5 + asked, 0.3))(q));
        };
        const zones::Zones wide(
            [&](const Vec3& q) {
                return zones::PastTarget{target(body.inGrid.applyInverse(q)), -zones::kFarMm};
            },
            body.model->tree.bounds(), {});
        const auto cut = test::carved(body, wall);
        Preparation p = preparation(body, *cut);
        p.landmarks = marks;
        p.zones = &wide;
        EXPECT_NEAR(*take(p, "gouge-depth").value, 0.25 - asked, 0.03);
    }
    // What cannot be said has no value.
    EXPECT_NE(ask(box(Vec3(0, 0, 0), Vec3(1, 1, 0.8)), "gouge-depth").reason.find("roof"), std::string::npos);
    marks.clear();
    EXPECT_FALSE(ask(whole, "gouge-depth").value);
    EXPECT_FALSE(ask(whole, "orifices-reached").value);
}

TEST_F(Block, outlineAndClearanceSayWhyTheyAreNone) {
    BoxCavity box;
    const auto cut = test::carved(body_, box.solid());
    Preparation p = preparation(body_, *cut);
    EXPECT_NEAR(*take(p, "outline-extent", side("mesial")).value, box.wallAt(0, 0) + box.wallAt(1, 0), 0.01);
    EXPECT_NEAR(*take(p, "outline-extent", side("buccal")).value, box.wallAt(2, 0) + box.wallAt(3, 0), 0.01);
    EXPECT_FALSE(take(p, "outline-extent").value);
    EXPECT_FALSE(take(p, "proximal-clearance").value);
    const tooth::ToothMirror other(body_.model);
    const core::Pose beside{6.5 * (body_.inGrid.orientation * Vec3::UnitX()), core::Quat::Identity()};
    const Preparation::Other others[] = {{body_.model, &other, beside, 45}};
    p.others = others;
    // Closed on all sides: the contact stands.
    EXPECT_NE(take(p, "proximal-clearance").reason.find("not been opened"), std::string::npos)
        << take(p, "proximal-clearance").reason;
    EXPECT_NE(take(p, "proximal-clearance", side("distal")).reason.find("no tooth"), std::string::npos);
    // Open towards it, which stands half a millimetre off.
    const auto open = test::carved(body_, [solid = box.solid()](const Vec3& q) { return solid(q - Vec3(1.75, 0, 0)); });
    p.cut = open.get();
    EXPECT_NEAR(*take(p, "proximal-clearance").value, 0.5, 0.01);
    EXPECT_NEAR(*take(p, "proximal-clearance", side("mesial", "greatest")).value, 0.5, 0.01);
}

TEST_F(Block, sameBitsAtAnyThreadCount) {
    BoxCavity box;
    box.tiltDeg = 3.0;
    const auto cut = test::carved(body_, box.solid());
    const Preparation p = preparation(body_, *cut);
    std::vector<Request> all;
    for (const MeasureKind& kind : measureKinds())
        if (kind.subject == Subject::tooth) all.push_back({std::string(kind.id), {}});
    const auto bits = [&](std::size_t threads) {
        core::setThreadCount(threads);
        std::vector<double> values;
        for (const Measured& m : measure(p, all)) {
            EXPECT_EQ(m.value.has_value(), m.reason.empty()) << m.kind;
            values.push_back(m.value.value_or(-1.0));
            values.push_back(m.uncertainty);
        }
        return values;
    };
    const std::vector<double> one = bits(1), two = bits(2);
    core::setThreadCount(0);
    EXPECT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof(double)), 0);
}

TEST_F(Block, whatCannotBeMeasuredSaysWhyAndIsNeverZero) {
    const tooth::ToothMirror uncut(body_.model);
    const Preparation p = preparation(body_, uncut);
    for (const char* kind :
         {"floor-depth", "isthmus", "wall-angle", "roughness", "occlusal-convergence", "margin-width", "undercut-area",
          "cavosurface-angle", "caries-left", "remaining-dentine"}) {
        const Measured none = take(p, kind);
        EXPECT_FALSE(none.value) << kind;
        EXPECT_FALSE(none.reason.empty()) << kind;
    }
    EXPECT_EQ(take(p, "removed").value, 0.0);
    EXPECT_NE(handpiece::test::errorOf([&] { (void)take(p, "beauty"); }).find("beauty"), std::string::npos);
    EXPECT_NE(handpiece::test::errorOf([&] { (void)take(p, "removed", side("mesial")); }).find("side"),
              std::string::npos);
    EXPECT_NE(handpiece::test::errorOf([&] { (void)take(p, "stalls"); }).find("hand"), std::string::npos);
    Preparation unknown = p;
    unknown.axes.buccal = Vec3::Zero();
    EXPECT_FALSE(sideDirection(unknown.axes, "buccal"));
    EXPECT_TRUE(sideDirection(unknown.axes, "mesial"));
}

TEST(Kinds, areSortedAndFoundById) {
    const auto kinds = measureKinds();
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        EXPECT_TRUE(i == 0 || kinds[i - 1].id < kinds[i].id) << kinds[i].id;
        EXPECT_EQ(findMeasureKind(kinds[i].id), &kinds[i]);
        EXPECT_LT(kinds[i].least, kinds[i].most);
    }
    EXPECT_EQ(findMeasureKind("beauty"), nullptr);
}

TEST(Molar, aCavityInAToothIsAsItWasCut) {
    const auto model = handpiece::test::smallMolar(0.1);
    const core::Box box = model->tree.bounds();
    // The middle of its crown, seen from above; the cavity hangs from there.
    const double top =
        box.max.z() + 1.0 - model->tree.firstMeeting(Vec3(0, 0, box.max.z() + 1.0), -Vec3::UnitZ()).distanceMm;
    const Body body{model, {Vec3(0, 0, top), core::Quat::Identity()}};
    BoxCavity cavity;
    cavity.depthMm = 1.7;
    cavity.widthMm = 1.3;
    const auto cut = test::carved(body, cavity.solid());
    Preparation p;
    p.whole = model;
    p.cut = cut.get();
    p.axes = body.axes();
    const auto got = measure(p, std::vector<Request>{{"floor-depth"},
                                                     {"isthmus", side("", "median")},
                                                     {"wall-angle", side("buccal")},
                                                     {"wall-height", side("mesial")},
                                                     {"floor-tilt"},
                                                     {"marginal-ridge-left", side("distal")}});
    ASSERT_TRUE(got[0].value && got[1].value && got[2].value && got[3].value && got[4].value && got[5].value);
    // Against the uncut triangles over the place that it names.
    const Vec3 place = *got[0].evidence.at(0).placeMm;
    const Vec3 above(place.x(), place.y(), box.max.z() + 1.0);
    EXPECT_NEAR(*got[0].value,
                above.z() - model->tree.firstMeeting(above, -Vec3::UnitZ()).distanceMm - (top - cavity.depthMm), 0.03);
    EXPECT_LT(std::abs(place.x()), 1.75);
    EXPECT_LT(std::abs(place.y()), 0.65);
    // Its walls are of unlike height: between the widths of a third and two thirds of the floor's depth.
    EXPECT_GT(*got[1].value, cavity.widthMm + 2 * std::tan(6 * test::kRad) * 0.3 * cavity.depthMm);
    EXPECT_LT(*got[1].value, cavity.widthMm + 2 * std::tan(6 * test::kRad) * 0.9 * cavity.depthMm);
    EXPECT_NEAR(*got[2].value, 6.0, 0.5);
    EXPECT_NEAR(*got[4].value, 0.0, 0.3);
    EXPECT_GT(*got[5].value, 1.0);
    std::printf("molar: depth %.3f isthmus %.3f angle %.2f height %.3f ridge %.3f\n", *got[0].value, *got[1].value,
                *got[2].value, *got[3].value, *got[5].value);
}

}  // namespace
}  // namespace handpiece::measures::features_test
