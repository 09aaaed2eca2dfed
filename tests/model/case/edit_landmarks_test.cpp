// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/edit_landmarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "handpiece/base/core/file.h"
#include "handpiece/model/case/case.h"
#include "support/closed_meshes.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::cases::edit_landmarks_test {
namespace {

using core::Vec3;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kRadiusMm = 5.0;

const geometry::TriangleTree& ball() {
    static const geometry::TriangleTree tree(test::icosphere(4, [](const Vec3& v) -> Vec3 { return kRadiusMm * v; }));
    return tree;
}

/// A parallel of the ball at this height, or a part of it.
std::vector<Vec3> parallel(double heightMm, int count, double turns) {
    std::vector<Vec3> points;
    const double r = std::sqrt(kRadiusMm * kRadiusMm - heightMm * heightMm);
    for (int i = 0; i < count; ++i) {
        const double angle = 2.0 * M_PI * turns * i / count;
        points.push_back(ball().nearest({r * std::cos(angle), r * std::sin(angle), heightMm}).pointMm);
    }
    return points;
}

TEST(MovedLandmark, StaysOnTheSurfaceAndBecomesSet) {
    const Landmark tip{LandmarkKind::cuspTip, "mesiobuccal", {{0, 0, kRadiusMm}}, LandmarkSource::generated};
    const Landmark there = moved(tip, 0, {4.0, 3.0, 6.0}, ball());
    EXPECT_EQ(there.source, LandmarkSource::set);
    EXPECT_EQ(there.name, tip.name);
    // Of a ball the nearest point lies towards its middle.
    const Vec3 wanted = kRadiusMm * Vec3(4.0, 3.0, 6.0).normalized();
    EXPECT_LT((there.pointsMm[0] - wanted).norm(), 0.05);
    EXPECT_LT(ball().nearest(there.pointsMm[0]).distanceMm, 1e-12);
    // What lies inside goes where it is put.
    const Landmark horn{LandmarkKind::pulpHorn, "mesial", {{0, 0, 2}}, LandmarkSource::generated};
    EXPECT_EQ(moved(horn, 0, {1, 1, 1}, ball()).pointsMm[0], Vec3(1, 1, 1));
}

TEST(MovedLandmark, TakesALineAlongLessTheFarther) {
    const Landmark line{LandmarkKind::fissure, "central", parallel(3.0, 40, 0.5), LandmarkSource::found};
    const std::size_t which = 20;
    const Landmark there = moved(line, which, line.pointsMm[which] + Vec3(0, 0, 0.6), ball());
    ASSERT_EQ(there.pointsMm.size(), line.pointsMm.size());
    double last = 1e9, along = 0.0;
    for (std::size_t i = which; i < line.pointsMm.size(); ++i) {
        if (i > which) along += (line.pointsMm[i] - line.pointsMm[i - 1]).norm();
        const double went = (there.pointsMm[i] - line.pointsMm[i]).norm();
        EXPECT_LE(went, last + 1e-3) << i;
        EXPECT_EQ(went > 0.0, along < kLandmarkReachMm) << i;
        EXPECT_LT(ball().nearest(there.pointsMm[i]).distanceMm, 1e-12) << i;
        last = went;
    }
    // A line ends; a ring goes on.
    const Landmark ring{LandmarkKind::heightOfContour, "", parallel(0.0, 60, 1.0), LandmarkSource::found};
    EXPECT_GT(
        (moved(ring, 0, ring.pointsMm[0] + Vec3(0, 0, 0.5), ball()).pointsMm.back() - ring.pointsMm.back()).norm(),
        0.1);
    EXPECT_EQ(moved(line, 0, line.pointsMm[0] + Vec3(0, 0, 0.5), ball()).pointsMm.back(), line.pointsMm.back());
}

class WrittenLandmarks : public testing::Test {
  protected:
    Case made() const {
        Case c;
        c.name = "ball";
        c.fdiNumber = 46;
        c.outer = test::icosphere(2, [](const Vec3& v) -> Vec3 { return kRadiusMm * v; });
        c.landmarks = {{LandmarkKind::cuspTip, "mesiobuccal", {{0, 0, 5}}, LandmarkSource::generated}};
        PlacedTooth other;
        other.name = "other";
        other.fdiNumber = 45;
        other.outer = c.outer;
        other.inCase.positionMm = {11, 0, 0};
        other.landmarks = c.landmarks;
        c.others.push_back(other);
        return c;
    }
    test::TemporaryFolder folder_;
};

TEST_F(WrittenLandmarks, AreReadAgainAndAllElseStays) {
    const std::vector<Landmark> marks{{LandmarkKind::cuspTip, "mesiobuccal", {{1, 0, 4.9}}, LandmarkSource::set},
                                      {LandmarkKind::pit, "central", {{0, 1, 4.9}}, LandmarkSource::set}};
    for (const char* name : {"case", "case.handpiece"}) {
        const fs::path place = folder_.path() / name;
        writeCase(made(), place);
        if (fs::is_directory(place)) {
            std::ofstream(place / "notes.txt") << "a teacher's own";
            std::ofstream(place / "case.toml", std::ios::app) << "# by hand\n[exercise]\nbur = \"330\"\n";
        }
        writeLandmarks(place, marks);
        const Case back = readCase(place);
        ASSERT_EQ(back.landmarks.size(), 2u) << name;
        EXPECT_EQ(back.landmarks[0].source, LandmarkSource::set);
        EXPECT_EQ(back.landmarks[1].name, "central");
        EXPECT_EQ(contentKey(back), contentKey(made()));
        ASSERT_EQ(back.others.size(), 1u);
        EXPECT_EQ(back.others[0].landmarks.size(), 1u);
        EXPECT_EQ(back.exercise.has_value(), fs::is_directory(place));
        writeLandmarks(place, {});
        EXPECT_TRUE(readCase(place).landmarks.empty());
        EXPECT_EQ(readCase(place).others.at(0).landmarks.size(), 1u);
    }
    EXPECT_TRUE(fs::exists(folder_.path() / "case/notes.txt"));
}

TEST_F(WrittenLandmarks, AreRefusedWhereTheyCannotBeKept) {
    const fs::path surface = folder_.path() / "tooth.stl";
    std::ofstream(surface) << "solid";
    EXPECT_THAT(test::errorOf([&] { writeLandmarks(surface, {}); }), HasSubstr("holds no landmarks"));
    EXPECT_THAT(test::errorOf([&] { writeLandmarks(folder_.path(), {}); }), HasSubstr("no case"));
    // One that would not be read again leaves the file as it is.
    writeCase(made(), folder_.path() / "case");
    const auto before = core::readFile(folder_.path() / "case/case.toml");
    const std::vector<Landmark> far{{LandmarkKind::pit, "", {{0, 0, 900}}, LandmarkSource::set}};
    EXPECT_THAT(test::errorOf([&] { writeLandmarks(folder_.path() / "case", far); }), HasSubstr("mm off"));
    EXPECT_EQ(core::readFile(folder_.path() / "case/case.toml"), before);
}

}  // namespace
}  // namespace handpiece::cases::edit_landmarks_test
