// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/report_figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "handpiece/record/session/session_writer.h"
#include "support/random.h"

namespace handpiece::report {
namespace {

TEST(ReportFigures, StayNumbersWhateverTheFileHolds) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "session.h5";
    {
        session::SessionWriter writer(file, {1000, "desk-7", "0.2.0", "{}", {}});
        session::Record r;
        const float nan = std::numeric_limits<float>::quiet_NaN(), most = std::numeric_limits<float>::max();
        for (const float force : {1.0f, nan, 3.0f, std::numeric_limits<float>::infinity(), most, -most}) {
            ++r.tick;
            r.depthMm = 0.1f;
            r.forceN = {force, 0.0f, 0.0f};
            r.speedRpm = force;
            r.flags = messages::kCutting;
            writer.append(r);
        }
        writer.close();
    }
    const SessionFigures f = figuresOf(session::SessionReader(file));
    EXPECT_EQ(f.ticks, 6u);
    for (const double figure : {f.totalS, f.contactS, f.cuttingS, f.meanForceN, f.p95ForceN, f.peakForceN,
                                f.limitedShare, f.meanCuttingRpm, f.mostRpm})
        EXPECT_TRUE(std::isfinite(figure));
    EXPECT_NEAR(f.contactS, 0.004, 1e-12);  // the ticks whose force is a number
}

}  // namespace
}  // namespace handpiece::report
