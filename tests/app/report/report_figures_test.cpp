// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/report_figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "handpiece/record/session/session_writer.h"
#include "support/random.h"

namespace handpiece::report::report_figures_test {
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

TEST(ReportFigures, WaysOfWorkingLastUntilTheNextOneIsTold) {
    const test::TemporaryFolder folder;
    const auto file = folder.path() / "session.h5";
    {
        session::SessionWriter writer(file, {1000, "desk-7", "0.2.0", "{}", {}});
        const std::string name(session::nameOf(session::EventName::workingWay));
        writer.append(session::Event{10, name, R"({"position": 11, "mirror_only": true, "finger_rest": false})"});
        writer.append(session::Event{40, name, R"({"position": 9, "mirror_only": false, "finger_rest": true})"});
        writer.append(session::Event{
            60, name, R"({"position": 400, "mirror_only": 1})"});  // nothing that a program of ours writes
        session::Record r;
        for (r.tick = 1; r.tick <= 90; ++r.tick) {
            if (r.tick == 31) continue;
            r.elapsedPeriods = r.tick == 32 ? 2 : 1;  // a tick left out counts for its time
            writer.append(r);
        }
        writer.close();
    }
    const SessionFigures f = figuresOf(session::SessionReader(file));
    EXPECT_NEAR(f.byMirrorS, 0.030, 1e-12);    // ticks 11 to 40
    EXPECT_NEAR(f.fingerRestS, 0.020, 1e-12);  // 41 to 60
    ASSERT_EQ(f.atHourS.size(), 2u);
    EXPECT_NEAR(f.atHourS.at(11), 0.030, 1e-12);
    EXPECT_NEAR(f.atHourS.at(9), 0.020, 1e-12);
}

}  // namespace
}  // namespace handpiece::report::report_figures_test
