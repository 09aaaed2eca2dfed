// SPDX-License-Identifier: Apache-2.0
// The whole tick on a real tooth: nothing allocated, nothing sunk, nothing left to chance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "handpiece/base/core/hash.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/device/simulated_device.h"
#include "handpiece/tick/loop/loop_run.h"
#include "studies/built_in_motion.h"
#include "support/realtime_trap.h"

namespace handpiece::loop::tooth_loop_test {
namespace {

using core::Vec3;
using messages::HapticSample;

class ToothLoop : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        cases::Case molar;
        molar.name = "molar";
        molar.outer = starter::makeOuter(starter::ToothKind::lowerFirstMolar, 10000);
        molar.parts.push_back({"enamel", cases::Tissue::enamel, 0, molar.outer});
        tooth::LoadSettings settings;
        settings.useCache = false;
        tooth_ = tooth::loadModel(molar, settings);
    }
    static void TearDownTestSuite() { tooth_.reset(); }

    static std::unique_ptr<contact::Method> method(const char* bur = "cylinder-round:1.0x4.0") {
        return contact::makeFieldMethod(tooth_, std::make_shared<const instrument::Bur>(instrument::makeBur(bur)));
    }
    static std::unique_ptr<HapticLoop> loopOf(const char* motion, const char* bur, double rateHz = 1000) {
        auto contact = method(bur);
        device::Motion path = studies::motionByName(motion, *contact, tooth_->outer.bounds());
        durationS_ = path.durationS();
        LoopSettings settings;
        settings.rateHz = rateHz;
        device::SimulatedDeviceSettings device;
        device.frictionN = 0.05;
        return std::make_unique<HapticLoop>(settings,
                                            std::make_unique<device::SimulatedDevice>(device, std::move(path)),
                                            std::move(contact), force::defaultParameters());
    }

    static inline std::shared_ptr<const tooth::ToothModel> tooth_;
    static inline double durationS_ = 0.0;
};

TEST_F(ToothLoop, theProxyNeverSinksAndTheHandIsNeverPulled) {
    for (const char* bur : {"cylinder-round:1.0x4.0", "round:1.0x1.0"}) {
        for (const char* motion : {"press", "slide", "drag", "loop"}) {
            SCOPED_TRACE(std::string(bur) + ", " + motion);
            const auto loop = loopOf(motion, bur);
            const auto probe = method(bur);
            double worst = -10.0, peak = 0.0, pull = 0.0;
            (void)runSimulated(*loop, durationS_, [&](const HapticSample& s) {
                core::Pose proxy;
                proxy.positionMm = Vec3(s.proxyPositionMm.data());
                const auto& q = s.proxyOrientation;
                proxy.orientation = core::Quat(q[0], q[1], q[2], q[3]);
                worst = std::max(worst, probe->depth(proxy).depthMm);
                const Vec3 force(s.forceN.data()), spring = proxy.positionMm - Vec3(s.positionMm.data());
                peak = std::max(peak, force.norm());
                if (!(s.flags & messages::kSlopeLimited)) pull = std::min(pull, force.dot(spring));
            });
            std::printf("  %s, %s: the proxy sinks %.2f um at worst, peak %.2f N\n", bur, motion, 1e3 * worst, peak);
            EXPECT_LE(worst, 0.002);
            EXPECT_GE(pull, -1e-9);
            EXPECT_GT(peak, 0.3);
        }
    }
}

TEST_F(ToothLoop, theTickNeitherAllocatesNorLocksNorWaits) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc: the trap is off";
    const auto loop = loopOf("drag", "cylinder-round:1.0x4.0");
    const test::RealtimeTrap trap;
    for (double t = 0.0; t < durationS_; t += loop->periodS())
        loop->tick({});
    EXPECT_EQ(trap.total(), 0u);
}

TEST_F(ToothLoop, repeatsItselfBitForBit) {
    const auto run = [&] {
        const auto loop = loopOf("drag", "cylinder-round:1.0x4.0", 2000);
        core::Hasher all;
        (void)runSimulated(*loop, durationS_, [&](const HapticSample& s) {
            for (int i = 0; i < 3; ++i) {
                all.add(s.forceN[i]);
                all.add(s.torqueNmm[i]);
                all.add(s.truePositionMm[i]);
                all.add(s.proxyPositionMm[i]);
            }
            all.add(s.contactAreaMm2);
        });
        return all.value();
    };
    EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace handpiece::loop::tooth_loop_test
