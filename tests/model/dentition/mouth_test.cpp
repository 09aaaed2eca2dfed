// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/mouth.h"
#include "handpiece/model/dentition/cheeks.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/turbine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/base/geometry/triangle_tree.h"
#include "handpiece/model/dentition/cheeks.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/turbine.h"
#include "model/dentition/mouths.h"

namespace handpiece::dentition::mouth_test {
namespace {

constexpr std::uint64_t kSeeds[] = {1, 2, 3};

std::size_t mesialOf(std::size_t i) {
    constexpr std::size_t kAcross[] = {8, 0, 24, 16};
    return i % 8 > 0 ? i - 1 : kAcross[i / 8];
}

class Mouths : public testing::TestWithParam<std::uint64_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, Mouths, testing::ValuesIn(kSeeds));

TEST_P(Mouths, AdjacentCrownsTouchAtTheirContacts) {
    const Mouth& m = mouth(GetParam());
    for (std::size_t i = 0; i < kToothCount; ++i) {
        SCOPED_TRACE(fdiOf(i));
        Vec3 at = Vec3::Zero();
        const double gap = gapOf(m, i, mesialOf(i), 0.3, &at);
        EXPECT_GE(gap, 0.0);
        EXPECT_LE(gap, 0.030);
        // In the crown, not at roots that lean against each other; third molars stand as they can.
        if (i % 8 < 7) {
            EXPECT_GT(m.arches.toothInMouth[i].applyInverse(at).z(), 1.5);
        }
    }
}

TEST_P(Mouths, NoToothIsInAnother) {
    const Mouth& m = mouth(GetParam());
    for (std::size_t a = 0; a < kToothCount; ++a)
        for (std::size_t b = a + 1; b < kToothCount; ++b) {
            EXPECT_GE(gapOf(m, a, b, 0.05), -0.002) << fdiOf(a) << " and " << fdiOf(b);
        }
}

TEST_P(Mouths, TeethOccludeAsInClassOne) {
    const Mouth& m = mouth(GetParam());
    int pairs = 0;
    for (std::size_t upper = 0; upper < 16; ++upper) {
        int touching = 0;
        for (std::size_t lower = 16; lower < kToothCount; ++lower)
            touching += gapOf(m, upper, lower, 0.06) < 0.05 ? 1 : 0;
        EXPECT_GE(touching, 1) << fdiOf(upper) << " meets no antagonist";
        pairs += touching;
    }
    EXPECT_GE(pairs, 16);
    const Vec3 bite = m.arches.lowerIncisalMm - m.arches.upperIncisalMm;
    EXPECT_NEAR(bite.z(), kOverbiteMm, 1.0) << "overbite";
    EXPECT_NEAR(bite.y(), 2.5, 1.5) << "overjet";
    for (const bool right : {true, false}) {
        const int upper = right ? 16 : 26, lower = right ? 46 : 36;
        const double groove = 0.5 * (m.cusp(lower, "mesiobuccal").y() + m.cusp(lower, "distobuccal").y());
        // A class I within two millimetres: half a cusp would be class II. Widths of upper and lower teeth spread
        // apart.
        EXPECT_NEAR(m.cusp(upper, "mesiobuccal").y(), groove, 2.0) << upper << " over the buccal groove of " << lower;
        // Upper buccal cusps stand outside, palatal ones in the lower teeth.
        const double outside = std::abs(m.cusp(upper, "mesiobuccal").x()),
                     inside = std::abs(m.cusp(upper, "mesiopalatal").x()),
                     between = std::abs(m.cusp(lower, "distobuccal").x());
        EXPECT_GT(outside, between + 1.0);
        EXPECT_LT(inside, between - 1.0);
    }
}

/// Radius of the circle through points (y, z), least squares after Kasa.
double radiusOf(const std::vector<Vec3>& points) {
    Eigen::MatrixXd a(points.size(), 3);
    Eigen::VectorXd b(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        a.row(row) << points[i].y(), points[i].z(), 1.0;
        b[row] = points[i].y() * points[i].y() + points[i].z() * points[i].z();
    }
    const Eigen::Vector3d c = (a.transpose() * a).inverse() * (a.transpose() * b);
    return std::sqrt(c[2] + 0.25 * (c[0] * c[0] + c[1] * c[1]));
}

TEST_P(Mouths, LowerCuspsLieInTheCurvesOfSpeeAndWilson) {
    const Mouth& m = mouth(GetParam());
    for (const int quadrant : {30, 40}) {
        std::vector<Vec3> line{m.cusp(quadrant + 3, "cusp")};
        for (const int place : {4, 5, 6, 7}) {
            const std::vector<Vec3> buccal = m.cusps(quadrant + place, true);
            Vec3 mean = Vec3::Zero();
            for (const Vec3& p : buccal)
                mean += p / static_cast<double>(buccal.size());
            line.push_back(mean);
        }
        EXPECT_NEAR(radiusOf(line), kSpeeRadiusMm, 0.2 * kSpeeRadiusMm) << "Spee, quadrant " << quadrant;
        for (const int place : {6, 7}) {
            Vec3 buccal = Vec3::Zero(), lingual = Vec3::Zero();
            for (const Vec3& p : m.cusps(quadrant + place, true))
                buccal += p / static_cast<double>(m.cusps(quadrant + place, true).size());
            for (const Vec3& p : m.cusps(quadrant + place, false))
                lingual += p / static_cast<double>(m.cusps(quadrant + place, false).size());
            const double slope = (buccal.z() - lingual.z()) / std::abs(buccal.x() - lingual.x());
            EXPECT_NEAR(slope, std::abs(buccal.x()) / kWilsonRadiusMm, 0.08) << "Wilson, " << quadrant + place;
        }
    }
}

class Periodontia : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Arches, Periodontia, testing::Bool());

TEST_P(Periodontia, AreSolids) {
    for (const TriangleMesh* mesh : {&held(GetParam()).tissues.gingiva, &held(GetParam()).tissues.bone}) {
        const geometry::MeshReport report = geometry::inspect(*mesh);
        EXPECT_TRUE(report.closed());
        EXPECT_TRUE(report.oriented());
        EXPECT_EQ(report.shells, 1u);
        EXPECT_EQ(report.nonManifoldVertices, 0u);
        EXPECT_GT(report.volumeMm3, 8000.0);
        EXPECT_TRUE(geometry::selfIntersections(*mesh, 1).empty());
    }
    EXPECT_LE(held(GetParam()).tissues.gingiva.triangles.size(), 120000u);
    EXPECT_LE(held(GetParam()).tissues.bone.triangles.size(), 60000u);
}

TEST_P(Periodontia, LigamentIsAsWideAsItIs) {
    const Mouth& m = mouth(1);
    const TriangleTree bone(held(GetParam()).tissues.bone);
    for (const std::size_t i : held(GetParam()).order) {
        SCOPED_TRACE(fdiOf(i));
        const double apex = m.teeth[i].outer.bounds().min.z();
        std::vector<double> widths;
        for (const Vec3& own : m.teeth[i].outer.vertices) {
            if (own.z() > 0.35 * apex || own.z() < 0.8 * apex) continue;
            widths.push_back(bone.signedDistance(m.arches.toothInMouth[i].apply(own)));
            EXPECT_GT(widths.back(), 0.08) << "root in the bone";
        }
        std::sort(widths.begin(), widths.end());
        EXPECT_GT(widths[widths.size() / 20], 0.13);
        EXPECT_GT(widths[widths.size() / 2], 0.15);
        EXPECT_LT(widths[widths.size() / 2], 0.38);
    }
}

TEST_P(Periodontia, CrestLiesUnderTheJunction) {
    const Mouth& m = mouth(1);
    const Held& h = held(GetParam());
    const TriangleTree bone(h.tissues.bone);
    for (const std::size_t i : h.order) {
        // Straight out of the root at its buccal and lingual middle: where bone begins.
        const Pose& pose = m.arches.toothInMouth[i];
        for (const double side : {1.0, -1.0}) {
            double under = 0.0;
            for (const Vec3& own : m.teeth[i].outer.vertices) {
                const double over = overJunction(m.teeth[i], own);
                if (std::abs(own.x()) > 0.5 || own.y() * side < 1.0 || over > -0.5 || over < -5.0) continue;
                if (bone.nearest(pose.apply(own), 0.6).triangle != geometry::kNoTriangle)
                    under = under == 0.0 ? over : std::max(under, over);
            }
            EXPECT_LT(under, -0.9) << fdiOf(i);
            EXPECT_GT(under, -3.0) << fdiOf(i);
        }
    }
}

TEST_P(Periodontia, CrestsBetweenTeethRunLevelFromJunctionToJunction) {
    const Mouth& m = mouth(1);
    const Held& h = held(GetParam());
    const TriangleTree bone(h.tissues.bone);
    const auto ringOf = [&](std::size_t i) {
        std::vector<Vec3> ring;
        for (const cases::Landmark& mark : m.teeth[i].landmarks)
            if (mark.kind == LandmarkKind::cementoEnamelJunction)
                for (const Vec3& p : mark.pointsMm)
                    ring.push_back(m.arches.toothInMouth[i].apply(p));
        return ring;
    };
    std::vector<double> middles;
    for (std::size_t k = 1; k < h.order.size(); ++k) {
        const std::size_t a = h.order[k - 1], b = h.order[k];
        if (a % 8 == 7 || b % 8 == 7) continue;  // third molars stand as they can
        SCOPED_TRACE(testing::Message() << fdiOf(a) << " and " << fdiOf(b));
        // From the one's junction to the other's, where they are nearest to each other.
        Vec3 from = Vec3::Zero(), to = Vec3::Zero();
        double nearest = 1e9;
        for (const Vec3& p : ringOf(a))
            for (const Vec3& q : ringOf(b))
                if ((p - q).norm() < nearest) nearest = (p - q).norm(), from = p, to = q;
        const Vec3 up = ((m.arches.toothInMouth[a].orientation * Vec3::UnitZ()) +
                         (m.arches.toothInMouth[b].orientation * Vec3::UnitZ()))
                            .normalized();
        const Vec3 aside = up.cross(to - from).normalized();
        // As a beam across sees it: the highest bone within a millimetre to either side.
        const auto underMm = [&](double share) {
            for (double down = -1.5; down < 6.0; down += 0.05)
                for (double y = -1.0; y <= 1.0; y += 0.25)
                    if (bone.signedDistance(from + share * (to - from) - down * up + y * aside) < 0.0) return down;
            return 6.0;
        };
        const double middle = underMm(0.5);
        fmt::print("{} to {}: junctions {:.2f} mm apart, crest {:.2f} {:.2f} {:.2f} {:.2f} {:.2f} under their line\n",
                   fdiOf(a), fdiOf(b), nearest, underMm(0.3), underMm(0.4), middle, underMm(0.6), underMm(0.7));
        middles.push_back(middle);
        // Thinner than septa are made, at the upper central incisors, the crest is lower.
        if (nearest < 0.6) continue;
        for (const double share : {0.3, 0.4, 0.5, 0.6, 0.7}) {
            EXPECT_GT(underMm(share), 0.9);
            EXPECT_LE(underMm(share), 2.0 + 1e-9);
            EXPECT_NEAR(underMm(share), middle, 0.35 + 1e-9) << "level; told in steps of 0.05";
        }
    }
    std::sort(middles.begin(), middles.end());
    fmt::print("{}: crest under the line between junctions {:.2f} to {:.2f} mm, median {:.2f}\n",
               GetParam() ? "upper" : "lower", middles.front(), middles.back(), middles[middles.size() / 2]);
}

TEST_P(Periodontia, MarginFollowsTheJunctionAndPapillaeEndBelowTheContacts) {
    const Mouth& m = mouth(1);
    const Held& h = held(GetParam());
    const TriangleTree gingiva(h.tissues.gingiva);
    std::vector<double> margins;
    double hidden = -10.0;
    for (const std::size_t i : h.order) {
        SCOPED_TRACE(fdiOf(i));
        for (const double side : {1.0, -1.0}) {
            // Seen in the middle of either face: the highest place of the tooth that the gingiva covers.
            double margin = -10.0;
            for (const Vec3& own : m.teeth[i].outer.vertices) {
                if (std::abs(own.x()) > 0.6 || own.y() * side < 1.0 || own.z() > 5.0) continue;
                if (gingiva.signedDistance(m.arches.toothInMouth[i].apply(own)) < -0.05 ||
                    gingiva.nearest(m.arches.toothInMouth[i].apply(own), 0.1).triangle != geometry::kNoTriangle)
                    margin = std::max(margin, overJunction(m.teeth[i], own));
            }
            EXPECT_GT(margin, 0.4);
            EXPECT_LT(margin, 1.0);
            // What reaches into the tooth ends no higher than what is seen: a bur just over the margin touches none.
            for (const Vec3& p : h.tissues.gingiva.vertices) {
                const Vec3 own = m.arches.toothInMouth[i].applyInverse(p);
                if (std::abs(own.x()) > 0.6 || own.y() * side < 1.0 || m.trees[i].signedDistance(p) > -0.02) continue;
                hidden = std::max(hidden, overJunction(m.teeth[i], own) - margin);
            }
            margins.push_back(margin);
        }
        for (const Vec3& p : m.teeth[i].outer.vertices)
            if (p.z() > m.teeth[i].outer.bounds().max.z() - 1.0) {
                ASSERT_GT(gingiva.signedDistance(m.arches.toothInMouth[i].apply(p)), 0.1) << "crown covered";
            }
    }
    std::sort(margins.begin(), margins.end());
    fmt::print("margin over the junction {:.2f} to {:.2f} mm, median {:.2f}; inside a tooth {:.2f} mm higher at most\n",
               margins.front(), margins.back(), margins[margins.size() / 2], hidden);
    EXPECT_LT(hidden, 0.35);
    for (std::size_t k = 1; k < h.order.size(); ++k) {
        const std::size_t a = h.order[k - 1], b = h.order[k];
        if (a % 8 == 7 || b % 8 == 7) continue;  // third molars stand as they can
        Vec3 contact = Vec3::Zero();
        (void)gapOf(m, a, b, 0.3, &contact);
        const Vec3 axis = ((m.arches.toothInMouth[a].orientation * Vec3::UnitZ()) +
                           (m.arches.toothInMouth[b].orientation * Vec3::UnitZ()))
                              .normalized();
        double tip = -10.0;
        for (const Vec3& p : h.tissues.gingiva.vertices) {
            const Vec3 d = p - contact;
            if ((d - d.dot(axis) * axis).norm() < 1.5) tip = std::max(tip, d.dot(axis));
        }
        EXPECT_LT(tip, -0.3) << "papilla between " << fdiOf(a) << " and " << fdiOf(b);
        EXPECT_GT(tip, -3.5) << "papilla between " << fdiOf(a) << " and " << fdiOf(b);
    }
}

// Over two roots gingiva lies as over one: the distance from a tooth has a crease half way between them.
TEST_P(Periodontia, NoUprightCreaseLiesBetweenTheRootsOfMolars) {
    const Mouth& m = mouth(1);
    const Held& h = held(GetParam());
    const TriangleTree gingiva(h.tissues.gingiva);
    constexpr double kStepMm = 0.2;
    std::vector<double> turns;
    for (const std::size_t i : h.order) {
        if (i % 8 != 5 && i % 8 != 6) continue;
        const Pose& pose = m.arches.toothInMouth[i];
        const double side = m.teeth[i].buccalSign;
        for (double z = -4.0; z >= -8.0; z -= 0.5) {
            std::vector<double> outMm;
            for (double x = -2.5; x <= 2.5; x += kStepMm) {
                const auto hit = gingiva.firstMeeting(pose.apply(Vec3(x, 14.0 * side, z)),
                                                      pose.orientation * Vec3(0.0, -side, 0.0), 14.0);
                outMm.push_back(hit.triangle == geometry::kNoTriangle ? 0.0 : 14.0 - hit.distanceMm);
            }
            // By how much the surface turns within 0.8 mm.
            for (std::size_t k = 2; k + 2 < outMm.size(); ++k)
                turns.push_back((outMm[k + 2] - 2.0 * outMm[k] + outMm[k - 2]) / (2.0 * kStepMm));
        }
    }
    std::sort(turns.begin(), turns.end());
    fmt::print("{}: buccal gingiva of molars turns inwards by {:.2f} within 0.8 mm, 99 of 100 by {:.2f}\n",
               GetParam() ? "upper" : "lower", turns.back(), turns[turns.size() * 99 / 100]);
    EXPECT_LT(turns.back(), 0.30);
}

TEST_P(Periodontia, PapillaeLeaveNoWayThroughUnderTheContacts) {
    const Mouth& m = mouth(1);
    const Held& h = held(GetParam());
    const TriangleTree gingiva(h.tissues.gingiva);
    for (std::size_t k = 1; k < h.order.size(); ++k) {
        const std::size_t a = h.order[k - 1], b = h.order[k];
        if (a % 8 == 7 || b % 8 == 7) continue;  // third molars stand as they can
        SCOPED_TRACE(testing::Message() << fdiOf(a) << " and " << fdiOf(b));
        Vec3 contact = Vec3::Zero();
        (void)gapOf(m, a, b, 0.3, &contact);
        const Pose &one = m.arches.toothInMouth[a], &two = m.arches.toothInMouth[b];
        const Vec3 up = (one.orientation * Vec3::UnitZ() + two.orientation * Vec3::UnitZ()).normalized();
        const Vec3 aside = up.cross(two.positionMm - one.positionMm).normalized(), along = aside.cross(up);
        // In the middle between the two teeth, so far under their contact and so far towards lip or tongue.
        const auto isFilled = [&](double downMm, double asideMm) {
            Vec3 middle = Vec3::Zero();
            double least = 1e9;
            for (double x = -3.0; x <= 3.0; x += 0.05) {
                const Vec3 p = contact - downMm * up + asideMm * aside + x * along;
                const double apart = std::abs(m.trees[a].signedDistance(p) - m.trees[b].signedDistance(p));
                if (apart < least) least = apart, middle = p;
            }
            return gingiva.signedDistance(middle) < 0.0;
        };
        double tip = 0.0;
        while (tip < 6.0 && !isFilled(tip, 0.0))
            tip += 0.05;
        fmt::print("{} to {}: papilla {:.2f} mm under the contact\n", fdiOf(a), fdiOf(b), tip);
        EXPECT_LT(tip, 2.5);
        // 5 mm from contact to bone, at most, are closed from the tip down; a ray across meets a papilla 1 mm thick.
        for (double down = tip + 1.0; down <= 5.0; down += 0.2)
            for (const double y : {-0.5, 0.0, 0.5})
                EXPECT_TRUE(isFilled(down, y)) << down << " mm under the contact, " << y << " mm aside";
    }
}

TEST(Mouth, MandibleOpensAboutItsHinge) {
    const Arrangement& a = mouth(1).arches;
    EXPECT_TRUE(opened(a, 0.0).orientation.isApprox(core::Quat::Identity()));
    for (const double mm : {35.0, 40.0, 45.0}) {
        const Pose mandible = opened(a, mm);
        EXPECT_NEAR((mandible.apply(a.lowerIncisalMm) - a.upperIncisalMm).norm(), mm, 1e-6);
        EXPECT_LT((mandible.apply(a.hingeMm) - a.hingeMm).norm(), 1e-9);
        EXPECT_LT(mandible.apply(a.lowerIncisalMm).z(), a.lowerIncisalMm.z() - 20.0);
        const double deg = 180.0 / std::numbers::pi * core::Quat::Identity().angularDistance(mandible.orientation);
        EXPECT_GT(deg, 18.0);
        EXPECT_LT(deg, 35.0);
    }
}

/// As they stand when the mouth is opened.
std::vector<TriangleMesh> openedTeeth(const Mouth& m, double openingMm) {
    std::vector<TriangleMesh> teeth = m.placed;
    for (std::size_t i = 0; i < kToothCount; ++i)
        if (!isUpper(i)) teeth[i] = geometry::transformed(std::move(teeth[i]), opened(m.arches, openingMm));
    return teeth;
}

/// How deep head, neck and handle are in the other arch, the tip of a bur in the middle of a tooth's crown, upright,
/// the handle to mesial; negative: apart.
double handpieceInOtherArchMm(const Mouth& m, int fdi, double openingMm) {
    const std::size_t own = indexOf(fdi);
    const core::Box box = m.teeth[own].outer.bounds();
    const Pose bur{{box.centre().x(), box.centre().y(), box.max.z() - 1.5}, core::Quat::Identity()};
    const Pose jaw = isUpper(own) ? Pose{} : opened(m.arches, openingMm);
    const std::vector<TriangleMesh> teeth = openedTeeth(m, openingMm);
    double deepest = -1e9;
    for (const instrument::BodyPiece& piece : instrument::bodyPieces(*instrument::makeInstrument("330").bur)) {
        const Pose at = jaw * m.arches.toothInMouth[own] * bur * piece.inBur;
        for (std::size_t i = 0; i < kToothCount; ++i)
            if (isUpper(i) != isUpper(own))
                for (const Vec3& v : teeth[i].vertices)
                    deepest = std::max(deepest, -piece.solid->signedDistance(at.applyInverse(v)));
    }
    return deepest;
}

TEST(Mouth, AtSecondMolarsTheHandpieceHasRoomAt45MillimetresAndNoneAt25) {
    for (const int fdi : {17, 27, 37, 47}) {
        const double at25 = handpieceInOtherArchMm(mouth(1), fdi, 25.0),
                     at45 = handpieceInOtherArchMm(mouth(1), fdi, 45.0);
        std::printf("[ tooth %d ] in the other arch by %.1f mm at 25 mm, %.1f at 45\n", fdi, at25, at45);
        EXPECT_GT(at25, 0.0) << fdi;
        EXPECT_LT(at45, 0.0) << fdi;
    }
}

TEST(Mouth, LipsAndCheeksLeaveTheTeethFreeAndTheMouthOpen) {
    const Mouth& m = mouth(1);
    for (const double openingMm : {25.0, 40.0, 55.0}) {
        const std::vector<TriangleMesh> teeth = openedTeeth(m, openingMm);
        const Cheeks made = makeCheeks(teeth);
        for (const TriangleMesh* part : {&made.left, &made.right, &made.upperLip, &made.lowerLip}) {
            EXPECT_TRUE(geometry::inspect(*part).closed());
            EXPECT_GT(geometry::enclosedVolumeMm3(*part), 1000.0);
            EXPECT_LT(part->triangles.size(), 100u);
            const TriangleTree tree(*part);
            double nearest = 1e9;
            for (const TriangleMesh& tooth : teeth)
                for (const Vec3& v : tooth.vertices)
                    nearest = std::min(nearest, tree.signedDistance(v));
            EXPECT_GT(nearest, 1.0) << openingMm;
        }
        const core::Box upper = made.upperLip.bounds(), lower = made.lowerLip.bounds();
        // The lower edges go backwards too as the mouth opens.
        const double high =
            m.arches.upperIncisalMm.z() - opened(m.arches, openingMm).apply(m.arches.lowerIncisalMm).z();
        EXPECT_NEAR(upper.min.z() - lower.max.z(), high - 2.0 * kLipOverEdgeMm, 2.5) << "between the lips";
        const double width = upper.size().x();
        EXPECT_GT(width, 40.0);
        EXPECT_LT(width, 65.0);
        // Straight in between the lips one comes to the throat and meets nothing.
        for (double y = upper.min.y() - 5.0; y < 40.0; y += 1.0) {
            const Vec3 p(0.0, y, 0.5 * (upper.min.z() + lower.max.z()));
            for (const TriangleMesh* part : {&made.left, &made.right, &made.upperLip, &made.lowerLip})
                EXPECT_GT(TriangleTree(*part).signedDistance(p), 3.0);
        }
    }
    EXPECT_THROW((void)makeCheeks(std::vector<TriangleMesh>(3)), core::Error);
}

TEST(Mouth, ArchesAreTheSameAtAnyThreadCount) {
    const std::size_t before = core::threadCount();
    core::setThreadCount(before == 1 ? 2 : 1);
    std::vector<cases::Tooth> teeth = coarseTeeth({1, 25.0});
    const Arrangement again = arrange(teeth);
    grindFacets(teeth, again);
    core::setThreadCount(0);
    for (std::size_t i = 0; i < kToothCount; ++i) {
        EXPECT_EQ(again.toothInMouth[i].positionMm, mouth(1).arches.toothInMouth[i].positionMm);
        EXPECT_EQ(again.toothInMouth[i].orientation.coeffs(), mouth(1).arches.toothInMouth[i].orientation.coeffs());
        EXPECT_EQ(teeth[i].outer.vertices, mouth(1).teeth[i].outer.vertices);
    }
}

TEST(Mouth, RefusesPlainly) {
    EXPECT_THAT([] { (void)makeMouth({}, {.fdi = 19}); },
                testing::Throws<core::Error>(testing::Property(&core::Error::problem, testing::HasSubstr("19"))));
    EXPECT_THROW((void)makeMouth({}, {.fdi = 55}), core::Error);
    EXPECT_THROW((void)makeMouth({}, {.fdi = -11}), core::Error);
    EXPECT_THROW((void)makeMouth({}, {.faces = 100}), core::Error);
    EXPECT_THROW((void)makeMouth({}, {.openingMm = 90.0}), core::Error);
    EXPECT_THROW((void)makeMouth({}, {.openingMm = NAN}), core::Error);
    EXPECT_THROW((void)makeMouth({}, {.faces = 2000}, [](double) { return false; }), core::Error) << "cancelled";
    EXPECT_THROW((void)arrange(std::vector<cases::Tooth>(3)), core::Error);
    EXPECT_THAT([] { (void)makeMouth({}, {.faces = 2'000'000'000}); },
                testing::Throws<core::Error>(
                    testing::Property(&core::Error::problem, testing::HasSubstr("faces are not possible"))));
    EXPECT_GT(mouthBytes({.faces = 2000000}), mouthBytes({.faces = 70000}));
}

}  // namespace
}  // namespace handpiece::dentition::mouth_test
