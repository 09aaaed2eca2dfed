// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/device/capability.h"

#include <gtest/gtest.h>

#include <limits>

#include "handpiece/base/core/error.h"

namespace handpiece::device::capability_test {
namespace {

TEST(Capability, recordsAreFoundByNameAndSane) {
    EXPECT_GE(knownDevices().size(), 4u);
    for (const Capability& c : knownDevices()) {
        EXPECT_EQ(&capabilityByName(c.name), &c);
        EXPECT_NO_THROW(validate(c));
        EXPECT_LT(c.continuousForceN, c.maxForceN);
    }
    EXPECT_EQ(capabilityByName("omni").maxForceN, 3.3);
    try {
        (void)capabilityByName("teapot");
        FAIL();
    } catch (const core::Error& e) {
        EXPECT_NE(e.remedy().find("touch-x"), std::string::npos);
    }
}

TEST(Capability, refusesLimitsThatAreNone) {
    for (double Capability::*limit :
         {&Capability::maxForceN, &Capability::maxStiffnessNPerMm, &Capability::maxForceSlopeNPerS}) {
        for (const double value :
             {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
            Capability c;
            c.*limit = value;
            EXPECT_THROW(validate(c), core::Error);
        }
    }
}

}  // namespace
}  // namespace handpiece::device::capability_test
