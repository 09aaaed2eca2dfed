// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/tooth_form.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/hash.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "support/random.h"

namespace handpiece::dentition::tooth_form_test {
namespace {
using cases::Landmark;
using cases::LandmarkKind;
using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;

/// Means of docs/anatomy.md [mm, recalled after Wheeler, Ash and Nelson; 14, 15, 43, 44 across and 42 in depth after
/// people measured], kept here apart from the product's own.
struct Published {
    int fdi;
    double crown, root, mesiodistal, mesiodistalCervix, buccolingual, buccolingualCervix, curveMesial, curveDistal;
    int roots, cusps;
};
constexpr Published kPublished[] = {
    {11, 10.5, 13.0, 8.5, 7.0, 7.0, 6.0, 3.5, 2.5, 1, 0},  {12, 9.0, 13.0, 6.5, 5.0, 6.0, 5.0, 3.0, 2.0, 1, 0},
    {13, 10.0, 17.0, 7.5, 5.5, 8.0, 7.0, 2.5, 1.5, 1, 1},  {14, 8.5, 14.0, 6.7, 4.8, 9.0, 8.0, 1.0, 0.0, 2, 2},
    {15, 8.5, 14.0, 6.5, 4.65, 9.0, 8.0, 1.0, 0.0, 1, 2},  {16, 7.5, 13.0, 10.0, 8.0, 11.0, 10.0, 1.0, 0.0, 3, 4},
    {17, 7.0, 12.0, 9.0, 7.0, 11.0, 10.0, 1.0, 0.0, 3, 4}, {18, 6.5, 11.0, 8.5, 6.5, 10.0, 9.5, 1.0, 0.0, 3, 4},
    {41, 9.0, 12.5, 5.0, 3.5, 6.0, 5.3, 3.0, 2.0, 1, 0},   {42, 9.5, 14.0, 5.5, 4.0, 6.2, 5.8, 3.0, 2.0, 1, 0},
    {43, 11.0, 16.0, 6.7, 5.5, 7.5, 7.0, 2.5, 1.0, 1, 1},  {44, 8.5, 14.0, 6.7, 4.8, 7.5, 6.5, 1.0, 0.0, 1, 2},
    {45, 8.0, 14.5, 7.0, 5.0, 8.0, 7.0, 1.0, 0.0, 1, 3},   {46, 7.5, 14.0, 11.0, 9.0, 10.5, 9.0, 1.0, 0.0, 2, 5},
    {47, 7.0, 13.0, 10.5, 8.0, 10.0, 9.0, 1.0, 0.0, 2, 4}, {48, 7.0, 11.0, 10.0, 7.5, 9.5, 9.0, 1.0, 0.0, 2, 4}};
/// Spreads [recalled, about]: shares of the mean for crowns and roots, and millimetres of the junction's curve.
constexpr double kSpreadCrown = 0.08, kSpreadRoot = 0.10, kSpreadAcross = 0.06, kSpreadCurveMm = 0.5;

const Patient kAverage{0, 20.0};

TriangleMesh surfaceOf(const ToothForm& form, double (ToothForm::*f)(const Vec3&) const, double spacingMm = 0.1) {
    geometry::IsosurfaceSettings settings;
    settings.spacingMm = spacingMm;
    settings.lipschitz = ToothForm::kLipschitz;
    settings.usualSlope = 1.0;
    settings.keepGradients = true;
    return geometry::isosurface(
        form.bounds(), [&](const Vec3& p) { return (form.*f)(p); }, settings);
}

/// The average patient's teeth of the right side, each made once.
const TriangleMesh& outerOf(int fdi) {
    static std::map<int, TriangleMesh> made;
    const auto [at, isNew] = made.try_emplace(fdi);
    if (isNew) at->second = surfaceOf(ToothForm(fdi, kAverage), &ToothForm::outer);
    return at->second;
}

std::vector<Landmark> of(LandmarkKind kind, const std::vector<Landmark>& marks) {
    std::vector<Landmark> found;
    for (const Landmark& m : marks)
        if (m.kind == kind) found.push_back(m);
    return found;
}
Vec3 named(LandmarkKind kind, std::string_view name, const std::vector<Landmark>& marks) {
    for (const Landmark& m : marks)
        if (m.kind == kind && m.name == name) return m.pointsMm.front();
    ADD_FAILURE() << "no " << name;
    return Vec3::Zero();
}

TEST(ToothForm, KnowsWhatIsNoTooth) {
    for (const int fdi : {0, 9, 10, 19, 40, 49, 51, 85, -11, 111})
        EXPECT_THROW(ToothForm(fdi, {}), core::Error) << fdi;
    EXPECT_THROW(ToothForm(46, {1, 3.0}), core::Error);
    EXPECT_THROW(ToothForm(46, {1, NAN}), core::Error);
    EXPECT_THROW(makeTooth(46, {}, {100, 0}), core::Error);
}

TEST(ToothForm, LeftIsRightInTheMirror) {
    std::mt19937_64 generator(test::seed());
    for (const Published& t : kPublished) {
        const int other = t.fdi / 10 == 1 ? t.fdi + 10 : t.fdi - 10;
        const ToothForm right(t.fdi, {}), left(other, {});
        EXPECT_EQ(right.buccalSign(), -left.buccalSign());
        for (int i = 0; i < 20; ++i) {
            const Vec3 p(test::uniform(generator, -5, 5), test::uniform(generator, -5, 5),
                         test::uniform(generator, -12, 9)),
                q(p.x(), -p.y(), p.z());
            EXPECT_EQ(right.outer(p), left.outer(q)) << t.fdi;
            EXPECT_EQ(right.pulp(p), left.pulp(q)) << t.fdi;
        }
    }
    EXPECT_EQ(ToothForm(46, {}).buccalSign(), -1);
    EXPECT_EQ(ToothForm(16, {}).buccalSign(), 1);
}

/// No steeper than it says, where the isosurface relies on it: between near points.
TEST(ToothForm, IsNoSteeperThanItSays) {
    std::mt19937_64 generator(test::seed());
    for (const int fdi : {11, 13, 14, 16, 34, 46, 48}) {
        const ToothForm form(fdi, {});
        double steepest = 0.0;
        for (int i = 0; i < 4000; ++i) {
            const Vec3 p(test::uniform(generator, -6, 6), test::uniform(generator, -6, 6),
                         test::uniform(generator, -14, 9));
            const Vec3 q = p + 0.01 * test::randomDirection(generator);
            if (std::abs(form.outer(p)) < 1.0)
                steepest = std::max(steepest, std::abs(form.outer(p) - form.outer(q)) / 0.01);
        }
        EXPECT_LT(steepest, ToothForm::kLipschitz) << fdi;
    }
}

/// Sizes measured on the mesh against the table; `--gtest_filter=*Table*` prints what docs/anatomy.md shows.
TEST(ToothForm, TableOfSizes) {
    fmt::print(
        "| tooth | crown | root | mesiodistal crown / cervix | buccolingual crown / cervix | curve mesial / distal | "
        "volume mm3 |\n|---|---|---|---|---|---|---|\n");
    for (const Published& t : kPublished) {
        SCOPED_TRACE(t.fdi);
        const ToothForm form(t.fdi, kAverage);
        const TriangleMesh& mesh = outerOf(t.fdi);
        const geometry::MeshReport report = geometry::inspect(mesh);
        EXPECT_TRUE(report.closed());
        EXPECT_TRUE(report.oriented());
        EXPECT_EQ(report.shells, 1u);
        EXPECT_EQ(report.genus, 0);
        EXPECT_TRUE(geometry::selfIntersections(mesh, 1).empty());

        const std::vector<Landmark> marks = form.landmarks();
        core::Box crown, cervix;
        const Landmark ring = of(LandmarkKind::cementoEnamelJunction, marks).at(0);
        const auto middle = [&](const Vec3& side) {
            return *std::max_element(ring.pointsMm.begin(), ring.pointsMm.end(), [&](const Vec3& a, const Vec3& b) {
                return a.head<2>().normalized().dot(side.head<2>()) < b.head<2>().normalized().dot(side.head<2>());
            });
        };
        for (const Vec3& p : ring.pointsMm)
            cervix.extend(p);
        const double buccalZ = middle({0.0, 1.0 * form.buccalSign(), 0.0}).z(), mesialZ = middle(Vec3::UnitX()).z(),
                     distalZ = middle(-Vec3::UnitX()).z();
        for (const Vec3& p : mesh.vertices)
            if (form.aboveCervix(p) > 0.3) crown.extend(p);
        const double height = crown.max.z() - buccalZ, root = buccalZ - mesh.bounds().min.z();
        const Vec3 c = crown.size(), n = cervix.size();
        EXPECT_NEAR(height, t.crown, kSpreadCrown * t.crown);
        EXPECT_NEAR(root, t.root, kSpreadRoot * t.root);
        EXPECT_NEAR(c.x(), t.mesiodistal, kSpreadAcross * t.mesiodistal);
        EXPECT_NEAR(c.y(), t.buccolingual, kSpreadAcross * t.buccolingual);
        EXPECT_NEAR(n.x(), t.mesiodistalCervix, 2 * kSpreadAcross * t.mesiodistalCervix);
        EXPECT_NEAR(n.y(), t.buccolingualCervix, 2 * kSpreadAcross * t.buccolingualCervix);
        EXPECT_NEAR(mesialZ - buccalZ, t.curveMesial, kSpreadCurveMm);
        EXPECT_NEAR(distalZ - buccalZ, t.curveDistal, kSpreadCurveMm);
        // What the form says of itself is what the mesh has.
        EXPECT_NEAR(form.mesiodistalMm(), c.x(), 0.03);
        EXPECT_NEAR(form.buccolingualMm(), c.y(), 0.03);
        EXPECT_NEAR(form.rootLengthMm(), root, 0.05);
        EXPECT_NEAR(form.crownHeightMm(), height, 0.05);
        EXPECT_EQ(of(LandmarkKind::apex, marks).size(), static_cast<std::size_t>(t.roots));
        EXPECT_EQ(of(LandmarkKind::cuspTip, marks).size(), static_cast<std::size_t>(t.cusps));
        fmt::print(
            "| {} | {:.1f} ({:.1f}) | {:.1f} ({:.1f}) | {:.1f} ({:.1f}) / {:.1f} ({:.1f}) | {:.1f} ({:.1f}) / {:.1f} "
            "({:.1f}) | "
            "{:.1f} ({:.1f}) / {:.1f} ({:.1f}) | {:.0f} |\n",
            t.fdi, height, t.crown, root, t.root, c.x(), t.mesiodistal, n.x(), t.mesiodistalCervix, c.y(),
            t.buccolingual, n.y(), t.buccolingualCervix, mesialZ - buccalZ, t.curveMesial, distalZ - buccalZ,
            t.curveDistal, report.volumeMm3);
    }
}

TEST(ToothForm, LandmarksLieOnTheSurfaces) {
    for (const Published& t : kPublished) {
        SCOPED_TRACE(t.fdi);
        const ToothForm form(t.fdi, {});
        const std::vector<Landmark> marks = form.landmarks();
        std::map<LandmarkKind, int> count;
        for (const Landmark& m : marks) {
            ++count[m.kind];
            EXPECT_EQ(m.source, cases::LandmarkSource::generated);
            EXPECT_GE(m.pointsMm.size(), cases::shapeOf(m.kind).least);
            EXPECT_LE(m.pointsMm.size(), cases::shapeOf(m.kind).most);
            for (const Vec3& p : m.pointsMm) {
                if (m.kind == LandmarkKind::longAxis || m.kind == LandmarkKind::pathOfInsertion) continue;
                if (m.kind == LandmarkKind::pulpHorn)
                    EXPECT_NEAR(form.pulp(p), 0.0, 1e-6) << m.name;
                else if (m.kind == LandmarkKind::orifice)
                    EXPECT_LT(form.pulp(p), 0.0) << m.name;
                else
                    EXPECT_NEAR(form.outer(p), 0.0, 1e-5)
                        << cases::kLandmarkKinds[static_cast<std::size_t>(m.kind)] << " " << m.name;
                if (m.kind == LandmarkKind::cementoEnamelJunction) {
                    EXPECT_NEAR(form.aboveCervix(p), 0.0, 1e-4);
                }
            }
        }
        EXPECT_EQ(count[LandmarkKind::contact], 2);
        EXPECT_EQ(count[LandmarkKind::heightOfContour], 1);
        EXPECT_GE(count[LandmarkKind::pulpHorn], 1);
        if (t.fdi % 10 > 3) {
            EXPECT_EQ(count[LandmarkKind::marginalRidge], 2);
            EXPECT_GE(count[LandmarkKind::fissure], t.fdi == 15 ? 1 : 2);
            EXPECT_GE(count[LandmarkKind::pit], 2);
        }
        EXPECT_EQ(count[LandmarkKind::furcation], t.roots == 1 ? 0 : t.roots == 3 ? 3 : 2);
    }
}

TEST(ToothForm, CuspsStandInTheirOrder) {
    using testing::ElementsAre;
    for (const std::uint64_t seed : {0, 1, 2, 3}) {
        // Landmarks are dear: asked once a tooth.
        std::map<int, std::vector<Landmark>> tips;
        for (const int fdi : {46, 47, 16, 17, 45, 14, 15, 44})
            tips[fdi] = of(LandmarkKind::cuspTip, ToothForm(fdi, {seed, 25.0}).landmarks());
        const auto height = [&](int fdi, const char* name) {
            return named(LandmarkKind::cuspTip, name, tips[fdi]).z();
        };
        EXPECT_NEAR(height(14, "buccal") - height(14, "palatal"), 1.0, 0.35);
        EXPECT_NEAR(height(15, "buccal") - height(15, "palatal"), 0.1, 0.3);
        EXPECT_LT(height(44, "lingual"), 0.75 * height(44, "buccal"));
        const auto order = [&](int fdi) {
            std::sort(tips[fdi].begin(), tips[fdi].end(),
                      [](const Landmark& a, const Landmark& b) { return a.pointsMm[0].z() > b.pointsMm[0].z(); });
            std::vector<std::string> names;
            for (const Landmark& m : tips[fdi])
                names.push_back(m.name);
            return names;
        };
        EXPECT_THAT(order(46), ElementsAre("mesiolingual", "distolingual", "mesiobuccal", "distobuccal", "distal"));
        EXPECT_THAT(order(47), ElementsAre("mesiolingual", "distolingual", "mesiobuccal", "distobuccal"));
        EXPECT_THAT(order(16), ElementsAre("mesiopalatal", "mesiobuccal", "distobuccal", "distopalatal"));
        EXPECT_THAT(order(17), ElementsAre("mesiopalatal", "mesiobuccal", "distobuccal", "distopalatal"));
        EXPECT_THAT(order(45), ElementsAre("buccal", "mesiolingual", "distolingual"));
    }
}

/// What each kind has, from its landmarks; docs/anatomy.md shows what this prints. Left teeth are these in the mirror.
TEST(ToothForm, TableOfFeatures) {
    struct Asked {
        int fdi;
        std::vector<std::string> cusps, grooves;  ///< cusps from the highest down
        double trunk, trunkSpread;                ///< mean of the furcations; 0: no figure asked
    };
    const std::vector<std::string> lowerFour{"mesiolingual", "distolingual", "mesiobuccal", "distobuccal"},
        upperFour{"mesiopalatal", "mesiobuccal", "distobuccal", "distopalatal"}, plus{"buccal", "central", "lingual"},
        oblique{"buccal", "central", "distopalatal", "transverse"};
    const Asked kAsked[] = {{11, {}, {}, 0, 0},
                            {12, {}, {}, 0, 0},
                            {13, {"cusp"}, {}, 0, 0},
                            {14, {"buccal", "palatal"}, {"central", "mesial marginal"}, 6.7, 1.0},
                            {15, {"buccal", "palatal"}, {"central"}, 0, 0},
                            {16, upperFour, oblique, 4.2, 0.8},
                            {17, upperFour, oblique, 0, 0},
                            {18, upperFour, oblique, 0, 0},
                            {41, {}, {}, 0, 0},
                            {42, {}, {}, 0, 0},
                            {43, {"cusp"}, {}, 0, 0},
                            {44, {"buccal", "lingual"}, {"distal", "mesial", "mesiolingual"}, 0, 0},
                            {45, {"buccal", "mesiolingual", "distolingual"}, {"distal", "lingual", "mesial"}, 0, 0},
                            {46,
                             {"mesiolingual", "distolingual", "mesiobuccal", "distobuccal", "distal"},
                             {"central", "distobuccal", "lingual", "mesiobuccal"},
                             3.3,
                             0.8},
                            {47, lowerFour, plus, 0, 0},
                            {48, lowerFour, plus, 0, 0}};
    fmt::print("| tooth | cusps, over the highest contact [mm] | grooves | ridges | highest horn | trunk [mm] |\n");
    for (const Asked& asked : kAsked) {
        SCOPED_TRACE(asked.fdi);
        const ToothForm form(asked.fdi, kAverage);
        const std::vector<Landmark> marks = form.landmarks();
        std::string cusps, grooves;
        std::vector<std::string> order, lines;
        std::vector<Landmark> tips = of(LandmarkKind::cuspTip, marks);
        std::sort(tips.begin(), tips.end(),
                  [](const Landmark& a, const Landmark& b) { return a.pointsMm[0].z() > b.pointsMm[0].z(); });
        const double contact = std::max(form.mesialContactMm().z(), form.distalContactMm().z());
        for (const Landmark& m : tips) {
            order.push_back(m.name);
            cusps += fmt::format("{}{} {:.1f}", cusps.empty() ? "" : ", ", m.name, m.pointsMm[0].z() - contact);
        }
        for (const Landmark& m : of(LandmarkKind::fissure, marks))
            lines.push_back(m.name);
        std::sort(lines.begin(), lines.end());
        for (const std::string& name : lines)
            grooves += (grooves.empty() ? "" : ", ") + name;
        EXPECT_EQ(order, asked.cusps);
        EXPECT_EQ(lines, asked.grooves);
        Landmark horn = of(LandmarkKind::pulpHorn, marks).at(0);
        for (const Landmark& m : of(LandmarkKind::pulpHorn, marks))
            if (m.pointsMm[0].z() > horn.pointsMm[0].z()) horn = m;
        if (asked.fdi % 10 >= 6) {
            EXPECT_EQ(horn.name, "mesiobuccal");
        }
        double trunk = 0.0;
        const std::vector<Landmark> furcations = of(LandmarkKind::furcation, marks);
        if (asked.fdi == 46) {
            const double buccal = named(LandmarkKind::furcation, "buccal", marks).z(),
                         lingual = named(LandmarkKind::furcation, "lingual", marks).z();
            fmt::print("46: trunk buccal {:.2f}, lingual {:.2f}\n", -0.25 - buccal, -0.25 - lingual);
            EXPECT_LT(lingual, buccal - 0.2);
        }
        for (const Landmark& m : furcations)
            trunk += (-0.25 - m.pointsMm[0].z()) / static_cast<double>(furcations.size());
        if (asked.trunk > 0.0) {
            EXPECT_NEAR(trunk, asked.trunk, asked.trunkSpread);
        }
        const auto start = [&](const char* name) { return named(LandmarkKind::fissure, name, marks).x(); };
        if (asked.fdi == 46) {  // a Y: the lingual groove begins between the two buccal ones
            EXPECT_LT(start("lingual"), start("mesiobuccal") - 0.3);
            EXPECT_GT(start("lingual"), start("distobuccal") + 0.3);
        } else if (asked.fdi == 47) {  // a +: one goes on as the other
            EXPECT_NEAR(start("lingual"), start("buccal"), 0.3);
        }
        fmt::print("| {} | {} | {} | {} | {} | {} |\n", asked.fdi, cusps, grooves,
                   of(LandmarkKind::ridge, marks).size() + of(LandmarkKind::marginalRidge, marks).size(), horn.name,
                   trunk > 0.0 ? fmt::format("{:.1f}", trunk) : "");
    }
}

/// Where a side's height of contour lies, as a share of the crown from the junction below it.
double contourShare(const ToothForm& form, double side) {
    const std::vector<Landmark> marks = form.landmarks();
    Vec3 outermost = Vec3::Zero(), neck = Vec3::Zero();
    const auto farther = [side](const Vec3& a, const Vec3& b) { return side * a.y() > side * b.y(); };
    for (const Vec3& p : of(LandmarkKind::heightOfContour, marks).at(0).pointsMm)
        if (outermost.isZero() || farther(p, outermost)) outermost = p;
    for (const Vec3& p : of(LandmarkKind::cementoEnamelJunction, marks).at(0).pointsMm)
        if (neck.isZero() || farther(p, neck)) neck = p;
    return (outermost.z() - neck.z()) / form.crownHeightMm();
}

/// The figures of docs/anatomy.md: heights of contour in the third where textbooks have them [R], pits and grooves.
TEST(ToothForm, TableOfFigures) {
    fmt::print(
        "| tooth | height of contour, buccal and lingual, share of the crown | pits under the cusps [mm] | "
        "between mesial and distal pit, share of the width | deepest groove under the cusps [mm] |\n");
    for (const Published& t : kPublished) {
        SCOPED_TRACE(t.fdi);
        const ToothForm form(t.fdi, kAverage);
        const std::vector<Landmark> marks = form.landmarks();
        const double buccal = contourShare(form, form.buccalSign()), lingual = contourShare(form, -form.buccalSign());
        const bool isPosterior = t.fdi % 10 >= 4;
        // Cervical third all round, of premolars and molars lingually the middle one.
        EXPECT_GT(buccal, 0.05);
        EXPECT_LT(buccal, 0.42);
        EXPECT_GT(lingual, isPosterior ? 0.30 : 0.05);
        EXPECT_LT(lingual, isPosterior ? 0.67 : 0.42);
        double tips = 0.0, deepest = 0.0;
        const std::vector<Landmark> cusps = of(LandmarkKind::cuspTip, marks);
        for (const Landmark& m : cusps)
            tips += m.pointsMm[0].z() / static_cast<double>(cusps.size());
        std::string pits;
        for (const Landmark& m : of(LandmarkKind::pit, marks))
            if (isPosterior)
                pits += fmt::format("{}{} {:.1f}", pits.empty() ? "" : ", ", m.name, tips - m.pointsMm[0].z());
        for (const Landmark& m : of(LandmarkKind::fissure, marks))
            for (const Vec3& p : m.pointsMm)
                if (m.name == "central" || t.fdi == 44 || t.fdi == 45) deepest = std::max(deepest, tips - p.z());
        const auto place = [&](const char* name) -> const Landmark* {
            for (const Landmark& m : marks)
                if (m.kind == LandmarkKind::pit && m.name == name) return &m;
            return nullptr;
        };
        const Landmark *mesial = place("mesial"), *distal = place("distal");
        std::string apart;
        if (isPosterior && mesial && distal) {
            const double share = (mesial->pointsMm[0].x() - distal->pointsMm[0].x()) / form.mesiodistalMm();
            apart = fmt::format("{:.2f}", share);
            EXPECT_GT(share, 0.2);
            EXPECT_LT(share, 0.75);
        }
        if (isPosterior) {
            EXPECT_GT(deepest, 1.0);
            EXPECT_LT(deepest, 3.5);
        }
        fmt::print("| {} | {:.2f}, {:.2f} | {} | {} | {} |\n", t.fdi, buccal, lingual, pits, apart,
                   isPosterior ? fmt::format("{:.1f}", deepest) : "");
    }
}

TEST(ToothForm, FeaturesOfTheReference) {
    // The first lower molar's mesiobuccal groove ends in a pit in the middle third.
    const ToothForm molar(46, kAverage);
    const std::vector<Landmark> marks = molar.landmarks();
    const double share = (named(LandmarkKind::pit, "buccal", marks).z() + 0.25) / molar.crownHeightMm();
    EXPECT_GT(share, 0.33);
    EXPECT_LT(share, 0.67);
    // Heights of contour: buccal in the cervical third, lingual in the middle one. The crown leans lingually.
    const Landmark contour = of(LandmarkKind::heightOfContour, marks).at(0);
    for (const Vec3& p : contour.pointsMm)
        if (std::abs(p.x()) < 0.5) {
            const double height = (p.z() + 0.25) / molar.crownHeightMm();
            if (p.y() < 0.0)
                EXPECT_LT(height, 0.42);
            else {
                EXPECT_GT(height, 0.38);
                EXPECT_LT(height, 0.67);
            }
        }
    // Contacts of molars lie in the middle to occlusal third, those of the incisor in the incisal third.
    EXPECT_GT(named(LandmarkKind::contact, "mesial", marks).z(), 0.45 * molar.crownHeightMm());
    const ToothForm incisor(11, kAverage);
    const double mesial = incisor.mesialContactMm().z(), distal = incisor.distalContactMm().z();
    EXPECT_GT(mesial + 1.5, 0.67 * incisor.crownHeightMm());
    EXPECT_GT(mesial, distal);
    // The canine's mesial slope is the shorter: its tip stands mesial of the middle.
    const ToothForm canine(13, kAverage);
    EXPECT_GT(named(LandmarkKind::cuspTip, "cusp", canine.landmarks()).x(), 0.1);
    // The oblique ridge is higher all along than the fossae on its two sides.
    const ToothForm upper(16, kAverage);
    double lowest = 1e9;
    for (const Landmark& m : of(LandmarkKind::ridge, upper.landmarks()))
        if (m.name.starts_with("oblique"))
            for (const Vec3& p : m.pointsMm)
                lowest = std::min(lowest, p.z());
    EXPECT_GT(lowest, named(LandmarkKind::pit, "central", upper.landmarks()).z() + 0.4);
    EXPECT_GT(lowest, named(LandmarkKind::pit, "distal", upper.landmarks()).z() + 0.4);
    // Roots bend to distal at their apices.
    for (const int fdi : {11, 13, 15, 44, 45})
        EXPECT_LT(of(LandmarkKind::apex, ToothForm(fdi, kAverage).landmarks()).at(0).pointsMm[0].x(), 0.0) << fdi;
}

TEST(ToothForm, EnamelAndPulpAreWhereTheyAre) {
    for (const int fdi : {46, 16, 14, 44, 11}) {
        SCOPED_TRACE(fdi);
        const ToothForm form(fdi, kAverage);
        const std::vector<Landmark> marks = form.landmarks();
        const TriangleMesh dentine = surfaceOf(form, &ToothForm::dentine, 0.12),
                           pulp = surfaceOf(form, &ToothForm::pulp, 0.12);
        const TriangleTree core(dentine), cavity(pulp);
        const auto enamel = [&](const Vec3& p) { return core.signedDistance(p); };
        double cusp = 0.0, fissure = 0.0, tips = 0.0, floors = 0.0, least = 1e9;
        for (const Landmark& m : of(LandmarkKind::cuspTip, marks))
            cusp += enamel(m.pointsMm[0]), tips += 1.0;
        for (const Landmark& m : of(LandmarkKind::pit, marks))
            fissure += enamel(m.pointsMm[0]), floors += 1.0, least = std::min(least, enamel(m.pointsMm[0]));
        const double contact = enamel(form.mesialContactMm());
        double cervical = 0.0;
        const Landmark ring = of(LandmarkKind::cementoEnamelJunction, marks).at(0);
        for (const Vec3& p : ring.pointsMm)
            cervical += enamel(p) / static_cast<double>(ring.pointsMm.size());
        if (fdi == 11) {
            Vec3 edge(0.5, 0, 0);
            for (const Landmark& m : of(LandmarkKind::ridge, marks))
                if (m.name == "incisal edge") edge = m.pointsMm[3];
            cusp = enamel(edge), tips = 1.0;
        } else {
            EXPECT_GT(fissure / floors, 0.0);
            EXPECT_LT(fissure / floors, 0.95);
        }
        EXPECT_NEAR(cusp / tips, fdi == 11 ? 1.9 : 2.25, 0.5);
        EXPECT_NEAR(contact, 1.25, fdi == 11 ? 0.75 : 0.4);
        EXPECT_LT(cervical, 0.3);
        EXPECT_GE(cervical, 0.0);
        fmt::print("{}: enamel at cusps {:.2f}, pits {:.2f}, contact {:.2f}, cervix {:.2f}", fdi, cusp / tips,
                   floors > 0 ? fissure / floors : 0.0, contact, cervical);
        // The pulp lies in the dentine, whole, and opens nowhere.
        const geometry::MeshReport report = geometry::inspect(pulp);
        EXPECT_TRUE(report.closed());
        EXPECT_EQ(report.shells, 1u);
        double thinnest = 1e9;
        for (const Vec3& p : pulp.vertices)
            thinnest = std::min(thinnest, -core.signedDistance(p));
        EXPECT_GT(thinnest, 0.1);
        // Between the tip of the buccal cusp and the roof, roof and floor (Deutsch and Musikant 2004).
        if (fdi == 46 || fdi == 16) {
            const Vec3 tip = named(LandmarkKind::cuspTip, "mesiobuccal", marks);
            double horn = -1e9;
            std::string highest;
            for (const Landmark& m : of(LandmarkKind::pulpHorn, marks))
                if (m.pointsMm[0].z() > horn) horn = m.pointsMm[0].z(), highest = m.name;
            EXPECT_EQ(highest, "mesiobuccal");
            const auto up = cavity.firstMeeting(Vec3(0, 0, -0.3), Vec3::UnitZ()),
                       down = cavity.firstMeeting(Vec3(0, 0, -0.3), -Vec3::UnitZ());
            const double roof = -0.3 + up.distanceMm, floor = -0.3 - down.distanceMm;
            EXPECT_NEAR(tip.z() - roof, fdi == 46 ? 6.36 : 6.24, 0.6);
            EXPECT_NEAR(roof - floor, fdi == 46 ? 1.57 : 1.88, 0.5);
            EXPECT_GT(horn - roof, 1.0);
            EXPECT_LT(horn - roof, 2.0);
            EXPECT_EQ(of(LandmarkKind::orifice, marks).size(), fdi == 46 ? 3u : 4u);
            fmt::print("; cusp to roof {:.2f}, to floor {:.2f}, horn over roof {:.2f}", tip.z() - roof, tip.z() - floor,
                       horn - roof);
        }
        fmt::print(", dentine over the pulp at least {:.2f} mm\n", thinnest);
    }
}

/// The highest of the pulp at a place seen from above, and the lowest from there down to where the pulp ends.
struct Heights {
    double roof, floor;
};
Heights pulpAt(const ToothForm& form, double x, double y) {
    constexpr double kStepMm = 0.01;
    double z = 8.0;
    while (z > -3.0 && form.pulp(Vec3(x, y, z)) > 0.0)
        z -= kStepMm;
    const double roof = z;
    while (z > -20.0 && form.pulp(Vec3(x, y, z)) < 0.0)
        z -= kStepMm;
    return {roof, z};
}
/// How wide the pulp is in a plane across the tooth: along x, along y, and its area.
struct Across {
    double x = 0.0, y = 0.0, areaMm2 = 0.0;
};
Across pulpAcross(const ToothForm& form, double z) {
    constexpr double kStepMm = 0.05;
    core::Box box;
    Across across;
    for (double x = -5.0; x < 5.0; x += kStepMm)
        for (double y = -6.0; y < 6.0; y += kStepMm)
            if (form.pulp(Vec3(x, y, z)) < 0.0) box.extend(Vec3(x, y, z)), across.areaMm2 += kStepMm * kStepMm;
    across.x = box.size().x() + kStepMm, across.y = box.size().y() + kStepMm;
    return across;
}

/// A pulp has the form of its tooth, smaller: a horn under each cusp that rises towards it, a roof that sags between
/// horns, of molars the mesiobuccal one the highest; with the years all of them recede.
TEST(ToothForm, PulpsRiseIntoHornsUnderTheCusps) {
    for (const Published& t : kPublished)
        for (const std::uint64_t seed : {0, 1, 3}) {
            SCOPED_TRACE(testing::Message() << t.fdi << ", seed " << seed);
            double before = 1e9;
            for (const double age : {20.0, 46.0, 67.0}) {
                if (age > 20.0 && seed != static_cast<std::uint64_t>(t.fdi % 2)) continue;
                const ToothForm form(t.fdi, {seed, age});
                const std::vector<Landmark> marks = form.landmarks(), horns = of(LandmarkKind::pulpHorn, marks);
                ASSERT_EQ(horns.size(), t.cusps > 0 ? static_cast<std::size_t>(t.cusps) : 2u);
                double highest = -1e9;
                for (const Landmark& horn : horns)
                    highest = std::max(highest, horn.pointsMm[0].z());
                EXPECT_LT(highest, before) << age;
                before = highest;
                if (t.fdi % 10 >= 6) {
                    EXPECT_EQ(named(LandmarkKind::pulpHorn, "mesiobuccal", marks).z(), highest);
                }
                for (std::size_t i = 0; i < horns.size(); ++i) {
                    const Vec3& tip = horns[i].pointsMm[0];
                    if (t.cusps > 1) {
                        const Vec3 cusp = named(LandmarkKind::cuspTip, horns[i].name, marks);
                        EXPECT_GT(tip.head<2>().normalized().dot(cusp.head<2>().normalized()), 0.8) << horns[i].name;
                        EXPECT_GT(tip.z(), pulpAt(form, 0.0, 0.0).roof + 0.2) << horns[i].name;
                    }
                    for (std::size_t j = 0; j < i; ++j) {
                        const Vec3 &other = horns[j].pointsMm[0], middle = 0.5 * (tip + other);
                        EXPECT_LT(pulpAt(form, middle.x(), middle.y()).roof, std::min(tip.z(), other.z()) - 0.03)
                            << horns[i].name << " " << horns[j].name << " " << age;
                    }
                }
            }
        }
}

/// The chamber of a molar follows the outline of the cervix (law of concentricity, Krasner and Rankow 2004 [recalled]:
/// walls as thick all round), has a floor that bulges up between the orifices, and canals that open into it like
/// funnels.
TEST(ToothForm, ChambersFollowTheCervixAndOpenIntoCanals) {
    for (const int fdi : {16, 17, 46, 47})
        for (const std::uint64_t seed : {0, 1, 2, 3}) {
            SCOPED_TRACE(testing::Message() << fdi << ", seed " << seed);
            const ToothForm form(fdi, {seed, 20.0});
            const Heights middle = pulpAt(form, 0.0, 0.0);
            const double z = 0.5 * (middle.roof + middle.floor);
            std::vector<double> walls;
            for (int i = 0; i < 24; ++i) {
                const double rad = 2.0 * std::numbers::pi * i / 24;
                double inner = 0.0, outer = 0.0;
                const auto at = [&](double r) { return Vec3(r * std::cos(rad), r * std::sin(rad), z); };
                while (form.pulp(at(inner)) < 0.0)
                    inner += 0.02;
                while (form.outer(at(outer)) < 0.0)
                    outer += 0.02;
                walls.push_back(outer - inner);
            }
            const auto [thinnest, thickest] = std::minmax_element(walls.begin(), walls.end());
            EXPECT_LT(*thickest, (fdi < 30 ? 1.6 : 1.3) * *thinnest);
            Vec3 orifices = Vec3::Zero();
            const std::vector<Landmark> marks = of(LandmarkKind::orifice, form.landmarks());
            for (const Landmark& m : marks) {
                orifices += m.pointsMm[0] / static_cast<double>(marks.size());
                const Vec3 near = 0.6 * m.pointsMm[0];
                EXPECT_LT(pulpAt(form, near.x(), near.y()).floor, middle.floor - 0.05) << m.name;
            }
            const double wide = pulpAcross(form, orifices.z() - 0.8).areaMm2,
                         narrow = pulpAcross(form, orifices.z() - 3.0).areaMm2;
            EXPECT_GT(wide, 1.45 * narrow);
            fmt::print(
                "{} seed {}: walls of the chamber {:.2f} to {:.2f} mm, canals {:.2f} mm2, 2.2 mm deeper {:.2f}\n", fdi,
                seed, *thinnest, *thickest, wide, narrow);
        }
}

/// Pulps of incisors widen towards the edge as they grow thin; of canines they end in one horn.
TEST(ToothForm, PulpsOfIncisorsWidenTowardsTheEdge) {
    for (const int fdi : {11, 12, 41, 42})
        for (const double age : {20.0, 46.0, 67.0}) {
            SCOPED_TRACE(testing::Message() << fdi << ", " << age);
            const ToothForm form(fdi, {0, age});
            const std::vector<Landmark> horns = of(LandmarkKind::pulpHorn, form.landmarks());
            ASSERT_EQ(horns.size(), 2u);
            const Vec3 middle = 0.5 * (horns[0].pointsMm[0] + horns[1].pointsMm[0]);
            const double roof = pulpAt(form, middle.x(), middle.y()).roof;
            const Across edge = pulpAcross(form, roof - 0.3), cervix = pulpAcross(form, 0.0);
            EXPECT_GT(edge.x, 1.1 * cervix.x);
            EXPECT_LT(edge.y, 0.7 * cervix.y);
            fmt::print("{} at {}: pulp under the horns {:.2f} x {:.2f}, at the cervix {:.2f} x {:.2f} mm\n", fdi, age,
                       edge.x, edge.y, cervix.x, cervix.y);
        }
}

/// No tissue has a hole, whatever the seed and the age: where canals met again pulps had one.
TEST(ToothForm, NoTissueHasAHole) {
    for (const int fdi : {16, 17, 18, 46, 47})
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            SCOPED_TRACE(testing::Message() << fdi << ", seed " << seed);
            const ToothForm form(fdi, {seed, 5.0 + 15.0 * static_cast<double>(seed)});
            const auto expectBall = [&](double (ToothForm::*surface)(const Vec3&) const, double spacingMm) {
                const geometry::MeshReport report = geometry::inspect(surfaceOf(form, surface, spacingMm));
                EXPECT_TRUE(report.closed());
                EXPECT_EQ(report.genus, 0);
            };
            expectBall(&ToothForm::pulp, 0.15);
            // The others are dearer: each seed has its tooth.
            if (seed != static_cast<std::uint64_t>(fdi % 4 + 1)) continue;
            expectBall(&ToothForm::outer, 0.3);
            expectBall(&ToothForm::dentine, 0.25);
            if (fdi == 16 || fdi == 47) expectBall(&ToothForm::enamel, 0.1);
        }
}

/// Every point of the tooth is in one of its tissues.
TEST(ToothForm, TissuesCoverTheTooth) {
    std::mt19937_64 generator(test::seed());
    for (const int fdi : {46, 16, 13, 44}) {
        const ToothForm form(fdi, {});
        for (int i = 0; i < 20000; ++i) {
            const Vec3 p(test::uniform(generator, -6, 6), test::uniform(generator, -6, 6),
                         test::uniform(generator, -14, 9));
            const double outer = form.outer(p), inside = std::min({form.enamel(p), form.dentine(p), form.pulp(p)});
            if (outer < -0.12) {
                EXPECT_LT(inside, 0.01) << fdi << " " << p.transpose();
            }
            if (outer > 0.12) {
                EXPECT_GT(inside, -0.01) << fdi << " " << p.transpose();
            }
        }
    }
}

TEST(ToothForm, SeedsDifferWithinTheSpreads) {
    for (const int fdi : {46, 16, 11, 34}) {
        const ToothForm mean(fdi, kAverage);
        std::vector<double> widths;
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            const ToothForm form(fdi, {seed, 20.0});
            widths.push_back(form.mesiodistalMm());
            EXPECT_NEAR(form.mesiodistalMm(), mean.mesiodistalMm(), 2.5 * kSpreadAcross * mean.mesiodistalMm())
                << fdi << " " << seed;
            EXPECT_NEAR(form.buccolingualMm(), mean.buccolingualMm(), 2.5 * kSpreadAcross * mean.buccolingualMm());
            // No more than a fifth; wear takes the same from all.
            EXPECT_NEAR(form.crownHeightMm(), mean.crownHeightMm(), 0.2 * mean.crownHeightMm() + 0.1);
            EXPECT_NEAR(form.rootLengthMm(), mean.rootLengthMm(), 2.5 * kSpreadRoot * mean.rootLengthMm());
        }
        std::sort(widths.begin(), widths.end());
        for (std::size_t i = 0; i + 1 < widths.size(); ++i)
            EXPECT_GT(widths[i + 1] - widths[i], 0.0) << fdi;
        EXPECT_GT(widths.back() - widths.front(), 0.05 * mean.mesiodistalMm()) << fdi;
    }
}

TEST(ToothForm, AgeWearsCuspsAndNarrowsThePulp) {
    for (const int fdi : {46, 11}) {
        double height = 1e9, volume = 1e9;
        for (const double age : {15.0, 40.0, 70.0}) {
            const ToothForm form(fdi, {0, age});
            const double now = geometry::enclosedVolumeMm3(surfaceOf(form, &ToothForm::pulp, 0.15));
            EXPECT_LT(form.crownHeightMm(), height - 0.1 + (height > 1e8 ? 1e9 : 0.0)) << fdi << " " << age;
            EXPECT_LT(now, 0.9 * volume) << fdi << " " << age;
            height = form.crownHeightMm(), volume = now;
        }
    }
}

TEST(MakeTooth, GivesTheSameSolidsAtAnyThreadCount) {
    const auto hash = [](const cases::Tooth& t) {
        core::Hasher h;
        const auto add = [&](const TriangleMesh& mesh) {
            for (const Vec3& v : mesh.vertices)
                for (int axis = 0; axis < 3; ++axis)
                    h.add(v[axis]);
        };
        add(t.outer);
        for (const cases::Part& p : t.parts)
            add(p.mesh);
        for (const Landmark& m : t.landmarks)
            for (const Vec3& v : m.pointsMm)
                h.add(v.x()), h.add(v.y()), h.add(v.z());
        return h.value();
    };
    const cases::Tooth tooth = makeTooth(44, {3, 40.0}, {6001, 4000});
    EXPECT_EQ(tooth.outer.triangles.size(), 6002u);
    EXPECT_EQ(tooth.name, "lower right first premolar (44)");
    EXPECT_EQ(tooth.kind, "lower-first-premolar");
    ASSERT_EQ(tooth.parts.size(), 3u);
    for (const cases::Part& part : tooth.parts) {
        SCOPED_TRACE(part.name);
        const geometry::MeshReport report = geometry::inspect(part.mesh);
        EXPECT_TRUE(report.closed() && report.oriented());
        EXPECT_EQ(report.genus, 0);
        EXPECT_TRUE(geometry::selfIntersections(part.mesh, 1).empty());
    }
    core::setThreadCount(1);
    const cases::Tooth again = makeTooth(44, {3, 40.0}, {6001, 4000});
    core::setThreadCount(0);
    EXPECT_EQ(hash(tooth), hash(again));
}

TEST(MakeTooth, CanBeStopped) {
    EXPECT_ANY_THROW((void)makeTooth(44, {}, {6000, 4000}, [](double fraction) { return fraction < 0.2; }));
}

}  // namespace
}  // namespace handpiece::dentition::tooth_form_test
