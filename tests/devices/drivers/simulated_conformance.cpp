// SPDX-License-Identifier: Apache-2.0
// The simulated arm is its own double. Its hand goes a way that was given before, so of the suite what asks for a hand
// to be moved is left out; tests/devices/safety has it cut, push and fail.
#include "devices/drivers/conformance.h"
#include "handpiece/devices/drivers/simulated_driver.h"

namespace handpiece::drivers {
namespace {

class SimulatedAdaptor final : public Adaptor {
  public:
    [[nodiscard]] Traits traits() const override {
        Traits t;
        t.driver = "simulated";
        t.buttons = 0;
        t.exclusive = t.tellsUnplug = t.steered = t.felt = t.stalls = false;
        return t;
    }
    void reset() override {}
    [[nodiscard]] std::unique_ptr<link::Driver> open(int /*device*/) override {
        SimulatedSettings settings;  // as openSimulated(), with a shorter way to plan
        const core::Pose held{core::Vec3(0, 0, 30), core::Quat::Identity()};
        settings.motion = device::Motion({{0.0, held, 0.0}, {1.0, held, 0.0}});
        return std::make_unique<SimulatedDriver>(std::move(settings));
    }
    void move(int /*device*/, const core::Pose& /*stylusInDevice*/) override {}
    void press(int /*device*/, std::uint32_t /*buttons*/) override {}
    [[nodiscard]] Arrived arrived(int /*device*/) override { return {}; }
    void unplug(int /*device*/) override {}
    void stall(int /*device*/, double /*seconds*/) override {}
};

std::unique_ptr<Adaptor> makeSimulated() {
    return std::make_unique<SimulatedAdaptor>();
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(Simulated, Conformance, testing::Values(&makeSimulated), nameOfAdaptor);

}  // namespace handpiece::drivers
