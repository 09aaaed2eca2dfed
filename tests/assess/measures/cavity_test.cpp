// SPDX-License-Identifier: Apache-2.0
// Cavities with a closed form, carved into turned blocks: what is measured against what was made.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "assess/measures/analytic.h"
#include "handpiece/base/core/error.h"

namespace handpiece::measures::cavity_test {
namespace {

using handpiece::test::uniform;
using test::Body;
using test::BoxCavity;
using test::Marks;
using test::Shape;
using test::side;
using test::Table;
using test::Vec3;

const Vec3 kLow(-3, -2.2, -3.2), kHigh(3, 2.2, 0);

Body block(const core::Pose& pose, double voxelMm) {
    return test::bodyOf(test::boxMesh(kLow, kHigh), pose, voxelMm);
}

struct Taker {
    const Body& body;
    const tooth::ToothMirror& cut;
    std::vector<cases::Landmark> landmarks{};
    std::vector<Measured> of(const std::vector<Request>& requests, Form form = Form::found) const {
        Preparation p;
        p.whole = body.model;
        p.cut = &cut;
        p.axes = body.axes();
        p.landmarks = landmarks;
        p.form = form;
        return measure(p, requests);
    }
    Measured of(const std::string& kind, Selection selection = {}) const {
        return of(std::vector<Request>{{kind, std::move(selection)}}).front();
    }
};

/// What is known of a box cavity in a block whose surface is z = 0.
void judge(const BoxCavity& box, const Marks& marks, const Taker& taker, Table& table, double removedMm3) {
    const auto got = taker.of({{"floor-depth", {}},
                               {"floor-depth-shortest", {}},
                               {"floor-tilt", {}},
                               {"floor-flatness", {}},
                               {"isthmus", side("", "median")},
                               {"wall-height", side("mesial")},
                               {"wall-angle", side("mesial")},
                               {"wall-angle", side("distal")},
                               {"wall-angle", side("buccal")},
                               {"wall-angle", side("lingual")},
                               {"marginal-ridge-left", side("mesial")},
                               {"cavosurface-angle", side("mesial")},
                               {"roughness", {}},
                               {"roughness", side("mesial")},
                               {"removed", {}},
                               {"wall-height", side("buccal")}});
    const std::string marked = marks.amplitudeMm > 0.0 ? ", marked" : "";
    table["floor-depth mm"].add(got[0], box.depthMm);
    table["floor-tilt deg" + marked].add(got[2], box.tiltDeg);
    if (marks.amplitudeMm == 0.0) table["floor-flatness mm"].add(got[3], 0.0);
    const double half = -0.5 * box.depthMm;
    table["isthmus mm"].add(got[4], box.wallAt(2, half) + box.wallAt(3, half));
    const double foot = box.wallAt(1, -box.depthMm);
    table["wall-height mm"].add(got[5], -box.floorZ(foot, 0));
    table["wall-height mm"].add(got[15], -box.floorZ(0, box.wallAt(3, -box.depthMm)));
    const int wallOf[4] = {1, 0, 3, 2};
    for (int i = 0; i < 4; ++i)
        table["wall-angle deg" + marked].add(got[static_cast<std::size_t>(6 + i)], box.angleDeg[wallOf[i]]);
    // The ridge's outside is upright: thinnest where the wall comes nearest, a fifth of a millimetre under the margin.
    const double top = std::max(box.wallAt(1, -0.2), box.wallAt(1, -box.depthMm + box.radiusMm));
    if (marks.amplitudeMm == 0.0) table["marginal-ridge mm"].add(got[10], kHigh.x() - top);
    table["cavosurface-angle deg" + marked].add(got[11], 90.0 + box.angleDeg[1]);
    table["roughness um"].add(got[12], 1000.0 * marks.rmsMm());
    table["roughness um"].add(got[13], 1000.0 * marks.rmsMm());
    table["removed %"].add(got[14], removedMm3);
    test::Errors& removed = table["removed %"];
    removed.error.back() *= 100.0 / removedMm3;
    removed.stated.back() *= 100.0 / removedMm3;
}

BoxCavity randomBox(std::mt19937_64& random) {
    BoxCavity box;
    box.lengthMm = uniform(random, 2.0, 3.4);
    box.widthMm = uniform(random, 1.2, 2.2);
    box.depthMm = uniform(random, 1.2, 2.2);
    for (double& angle : box.angleDeg)
        angle = uniform(random, -1.0, 12.0);
    box.tiltDeg = uniform(random, 0.0, 5.0);
    box.tiltAzimuthRad = uniform(random, 0.0, 6.28);
    box.radiusMm = uniform(random, 0.05, 0.35);
    return box;
}

/// HANDPIECE_MEASURES preparations a voxel; a few without it.
int count(int few) {
    const char* asked = std::getenv("HANDPIECE_MEASURES");
    return asked != nullptr ? std::atoi(asked) : few;
}

Table sweep(double voxelMm, int blocks, int each, std::uint64_t salt) {
    std::mt19937_64 random(handpiece::test::seed() + salt);
    Table table;
    for (int b = 0; b < blocks; ++b) {
        const Body body = block(test::randomPose(random), voxelMm);
        for (int i = 0; i < each; ++i) {
            const BoxCavity box = randomBox(random);
            Marks marks;
            marks.amplitudeMm = i % 2 == 0 ? uniform(random, 0.0, 0.008) : 0.0;
            marks.waveMm = uniform(random, 0.35, 0.5);
            for (double& phase : marks.phase)
                phase = uniform(random, 0.0, 6.28);
            const auto solid = [rounded = box.solid(), marks](const Vec3& p) { return rounded(p) + marks(p); };
            const auto cut = test::carved(body, solid);
            judge(box, marks, {body, *cut}, table,
                  test::volumeIn(solid, Vec3(kLow.x(), kLow.y(), -box.depthMm - 0.4), kHigh));
        }
    }
    return table;
}

TEST(Cavity, boxesAtThreeVoxelsInTurnedGrids) {
    for (const double voxel : {0.1, 0.05, 0.025}) {
        if (voxel < 0.05 && count(0) == 0) continue;
        const Table table = sweep(voxel, voxel < 0.05 ? 1 : 2, voxel < 0.05 ? (count(1) + 3) / 4 : count(2), 17);
        std::printf("voxel %.3f mm\n", voxel);
        test::print(table);
        for (const auto& [name, errors] : table)
            EXPECT_TRUE(errors.missing.empty()) << name << ": " << errors.missing.front();
        const std::map<std::string, double> most{{"floor-depth mm", 0.03},    {"floor-flatness mm", 0.03},
                                                 {"wall-height mm", 0.03},    {"isthmus mm", 0.05},
                                                 {"marginal-ridge mm", 0.05}, {"floor-tilt deg", 0.5},
                                                 {"wall-angle deg", 0.5},     {"cavosurface-angle deg", 0.5},
                                                 {"removed %", 0.5},          {"roughness um", 3.0}};
        for (const auto& [name, bound] : most)
            for (const double error : table.at(name).error)
                EXPECT_LE(std::abs(error), bound) << name;
    }
}

}  // namespace
}  // namespace handpiece::measures::cavity_test
