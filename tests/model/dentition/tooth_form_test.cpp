// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/tooth_form.h"

#include <gtest/gtest.h>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/self_intersection.h"

namespace handpiece::dentition {
namespace {
using core::Vec3;

std::vector<int> allTeeth() {
    std::vector<int> teeth;
    for (int quadrant = 1; quadrant <= 4; ++quadrant)
        for (int place = 1; place <= 8; ++place)
            teeth.push_back(10 * quadrant + place);
    return teeth;
}

TEST(ToothForm, KnowsWhatIsNoTooth) {
    for (const int fdi : {0, 9, 10, 19, 40, 49, 51, 85, -11, 111})
        EXPECT_THROW(ToothForm(fdi, {}), core::Error) << fdi;
    EXPECT_THROW(ToothForm(46, {1, 3.0}), core::Error);
    EXPECT_THROW(makeTooth(46, {}, {100, 0}), core::Error);
}

TEST(ToothForm, LeftIsRightInTheMirror) {
    for (const int fdi : allTeeth()) {
        if (fdi / 10 == 2 || fdi / 10 == 3) continue;
        const int other = fdi / 10 == 1 ? fdi + 10 : fdi - 10;
        const ToothForm right(fdi, {}), left(other, {});
        EXPECT_EQ(right.buccalSign(), -left.buccalSign());
        for (const Vec3& p : {Vec3(1.0, 2.0, 3.0), Vec3(-2.0, 1.0, -4.0), Vec3(0.3, -0.7, 6.0)})
            EXPECT_EQ(right.outer(p), left.outer({p.x(), -p.y(), p.z()})) << fdi;
    }
}

TEST(ToothForm, EveryToothIsOneClosedSurface) {
    for (const int fdi : allTeeth()) {
        if (fdi / 10 == 2 || fdi / 10 == 3) continue;  // the mirror of another
        SCOPED_TRACE(fdi);
        const ToothForm form(fdi, {});
        geometry::IsosurfaceSettings settings;
        settings.spacingMm = 0.1;
        settings.lipschitz = ToothForm::kLipschitz;
        const geometry::TriangleMesh mesh = geometry::isosurface(
            form.bounds(), [&](const Vec3& p) { return form.outer(p); }, settings);
        const geometry::MeshReport report = geometry::inspect(mesh);
        EXPECT_TRUE(report.closed());
        EXPECT_TRUE(report.oriented());
        EXPECT_EQ(report.shells, 1u);
        EXPECT_EQ(report.genus, 0);
        EXPECT_TRUE(geometry::selfIntersections(mesh, 1).empty());
    }
}

}  // namespace
}  // namespace handpiece::dentition
