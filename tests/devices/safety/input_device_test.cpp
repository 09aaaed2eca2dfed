// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/safety/input_device.h"

#include <atomic>
#include <limits>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "support/error_of.h"
#include "support/random.h"
#include "support/realtime_trap.h"

namespace handpiece::safety::input_device_test {
namespace {

using core::Quat;
using core::Vec3;
using link::DeviceFault;
using test::errorOf;
using testing::HasSubstr;

constexpr double kPeriodS = 0.001;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// An input whose frames come when the test says so, in the test's own time: nothing here depends on the machine's.
struct Bench {
    std::int64_t nowNs = 1'000'000'000;
    link::Servo* servo = nullptr;
    link::DriverReading reading;
    link::DriverCommand answered;
    bool stopped = false, refuses = false;
    double sinceFrameS = 0.0;
    bool frames = true;
};

class BenchDriver final : public link::Driver {
  public:
    explicit BenchDriver(Bench& bench, bool pushes = false) : bench_(bench) {
        info_.driver = "bench";
        info_.model = "Bench";
        info_.pushes = pushes;
    }
    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }
    void start(link::Servo& servo) override {
        if (bench_.refuses) throw core::Error("the bench is taken", "bench", "wait");
        bench_.servo = &servo;
    }
    void stop() noexcept override {
        bench_.servo = nullptr;
        bench_.stopped = true;
    }

  private:
    Bench& bench_;
    link::DriverInfo info_;
};

class InputDeviceTest : public testing::Test {
  protected:
    void open(InputSettings settings = {}) {
        device.reset();
        settings.nowNs = [this] { return bench.nowNs; };
        device = std::make_unique<InputDevice>(std::make_unique<BenchDriver>(bench), settings);
        board = device->health();
    }
    void frame() {
        bench.reading.timeNs = bench.nowNs;
        ++bench.reading.frame;
        bench.answered = bench.servo->exchange(bench.reading);
        bench.sinceFrameS = 0.0;
    }
    /// Ticks for so long, with a frame every four of them; the reading of the last.
    device::Reading run(double seconds, const Vec3& forceN = Vec3::Zero()) {
        device::Reading last;
        for (double t = 0.0; t < seconds - 1e-9; t += kPeriodS) {
            bench.nowNs += 1'000'000;
            bench.sinceFrameS += kPeriodS;
            if (bench.frames && bench.sinceFrameS >= 0.004 - 1e-9) frame();
            last = device->read(kPeriodS);
            device->command(forceN, Vec3::Zero());
        }
        return last;
    }
    Bench bench;
    std::unique_ptr<InputDevice> device;
    std::shared_ptr<HealthBoard> board;
};

TEST_F(InputDeviceTest, refusesWhatIsNoInput) {
    EXPECT_THAT(errorOf([&] { InputDevice(std::make_unique<BenchDriver>(bench, true), {}); }), HasSubstr("pushes"));
    EXPECT_NE(errorOf([&] { InputDevice(nullptr, {}); }), "");
    for (const double bad : {0.0, -1.0, kNan, 2.0}) {
        InputSettings settings;
        settings.readingTimeoutS = bad;
        EXPECT_NE(errorOf([&] { open(settings); }), "") << bad;
    }
    InputSettings settings;
    settings.clutchButton = 32;
    EXPECT_NE(errorOf([&] { open(settings); }), "");
    settings = {};
    settings.shakesFullyN = 0.0;
    EXPECT_NE(errorOf([&] { open(settings); }), "");
    settings = {};
    settings.placing.scale = -1.0;
    EXPECT_NE(errorOf([&] { open(settings); }), "");
    bench.refuses = true;
    EXPECT_THAT(errorOf([&] { open(); }), HasSubstr("the bench is taken"));
    EXPECT_TRUE(bench.stopped);
}

TEST_F(InputDeviceTest, theHandGoesWhereTheInputIs) {
    InputSettings settings;
    settings.placing.toothMm = {1, 2, 3};
    open(settings);
    EXPECT_EQ(device->info().model, "Bench");
    const device::Reading start = run(0.02);
    bench.reading.positionMm = {5, -4, 3};
    const device::Reading there = run(0.5);
    EXPECT_LT((there.burInTooth.positionMm - start.burInTooth.positionMm - Vec3(5, -4, 3)).norm(), 0.01);
    const Quat turn(Eigen::AngleAxisd(0.5, Vec3::UnitY()));
    bench.reading.orientation = {turn.w(), turn.x(), turn.y(), turn.z()};
    const device::Reading turned = run(0.5);
    EXPECT_NEAR(turned.burInTooth.orientation.angularDistance(there.burInTooth.orientation), 0.5, 1e-3);
    EXPECT_EQ(turned.status, device::ReadStatus::ok);
    const Health health = board->read();
    EXPECT_EQ(health.gate.trouble, DeviceFault::none);
    EXPECT_EQ(health.positionMm, bench.reading.positionMm);
    EXPECT_GT(health.frames, 100u);
}

TEST_F(InputDeviceTest, theUpperButtonIsThePedalWhereThereIsNone) {
    open();
    (void)run(0.02);
    bench.reading.buttons = 1;
    EXPECT_EQ(run(0.02).pedal, 1.0);
    EXPECT_EQ(run(0.02).buttons, 1u);
    bench.reading.buttons = 3;
    EXPECT_EQ(run(0.02).pedal, 0.0) << "both: the hand goes home";
    bench.reading.buttons = 1;
    bench.reading.pedal = 0.25f;
    EXPECT_NEAR(run(0.02).pedal, 0.25, 1e-6) << "it has a pedal of its own";
    bench.reading.pedal = -1.0f;
    InputSettings settings;
    settings.upperButtonCuts = false;
    bench.reading.buttons = 0;
    open(settings);
    (void)run(0.02);
    bench.reading.buttons = 1;
    EXPECT_EQ(run(0.02).pedal, 0.0);
}

TEST_F(InputDeviceTest, alostInputIsADeadMan) {
    for (const int kind : {0, 1, 2, 3}) {
        SCOPED_TRACE(kind);
        bench = Bench{};
        open();
        (void)run(0.02);
        bench.reading.pedal = 1.0f;
        const device::Reading cutting = run(0.2);
        EXPECT_EQ(cutting.pedal, 1.0);
        const link::DriverReading good = bench.reading;
        switch (kind) {
            case 0:
                bench.reading.trouble = DeviceFault::unplugged;
                break;
            case 1:
                bench.frames = false;
                break;  // its thread stands
            case 2:
                bench.reading.positionMm[1] = kNan;
                break;
            default:
                bench.reading.positionMm[0] = 4000.0;
                break;  // no hand moves so fast
        }
        double firstS = -1.0;
        for (int ms = 1; ms <= 150 && firstS < 0.0; ++ms)
            if (run(kPeriodS).pedal == 0.0) firstS = ms * 1e-3;
        EXPECT_GT(firstS, 0.0) << "the pedal is up";
        EXPECT_LE(firstS, kind == 1 ? 0.105 : 0.006);
        const device::Reading away = run(0.4);
        EXPECT_EQ(away.pedal, 0.0);
        EXPECT_EQ(away.buttons, 0u);
        if (kind != 3) {  // there it has come to rest far away, which is a place like any other
            const Vec3 axis = cutting.burInTooth.orientation * Vec3::UnitZ();
            EXPECT_NEAR((away.burInTooth.positionMm - cutting.burInTooth.positionMm).dot(axis), 5.0, 0.1) << "lifted";
            EXPECT_NE(board->read().gate.trouble, DeviceFault::none);
        }
        // It comes back with the pedal still pressed, which counts once it has been let go.
        const std::uint64_t frames = bench.reading.frame;
        bench.reading = good;
        bench.reading.frame = frames;
        bench.frames = true;
        EXPECT_EQ(run(0.5).pedal, 0.0);
        bench.reading.pedal = 0.0f;
        (void)run(0.02);
        bench.reading.pedal = 1.0f;
        EXPECT_EQ(run(0.02).pedal, 1.0);
        EXPECT_EQ(board->read().gate.trouble, DeviceFault::none);
    }
}

TEST_F(InputDeviceTest, aPedalHeldFromTheBeginningIsNotMeant) {
    open();
    bench.reading.pedal = 1.0f;
    EXPECT_EQ(run(0.5).pedal, 0.0);
}

TEST_F(InputDeviceTest, aTickThatStoodIsNoTroubleOfTheInput) {
    open();
    (void)run(0.02);
    for (int i = 0; i < 500; ++i) {  // two seconds between two sittings
        bench.nowNs += 4'000'000;
        frame();
    }
    EXPECT_EQ(bench.answered.vibration, 0.0f);
    EXPECT_EQ(board->read().gate.trouble, DeviceFault::none);
    bench.reading.pedal = 1.0f;
    EXPECT_EQ(run(0.1).pedal, 1.0);
}

TEST_F(InputDeviceTest, theForceShakesAndSoDoesTheBur) {
    open();
    (void)run(0.2);
    EXPECT_EQ(bench.answered.vibration, 0.0f);
    (void)run(0.2, {0, 0, 1.0});
    EXPECT_NEAR(bench.answered.vibration, 0.5, 1e-6);
    EXPECT_EQ(bench.answered.forceN, (std::array<double, 3>{})) << "it cannot push";
    device->vibrate(0.5);
    (void)run(0.02, {0, 0, 0.1});
    EXPECT_EQ(bench.answered.vibration, 1.0f);
    device->vibrate(kNan);
    (void)run(0.02, {0, 0, 1e9});
    EXPECT_EQ(bench.answered.vibration, 1.0f);
    (void)run(0.02, {0, kNan, 0});
    EXPECT_EQ(bench.answered.vibration, 0.0f);
    EXPECT_TRUE(run(0.02).burInTooth.positionMm.allFinite());
    // The tooth's force moves the hand: it gives way.
    const Vec3 before = device->truePositionMm();
    (void)run(0.3, {1.0, 0, 0});
    EXPECT_GT((device->truePositionMm() - before).x(), 0.1);
    EXPECT_EQ(device->appliedForceN(), Vec3(1.0, 0, 0));
}

TEST_F(InputDeviceTest, theClutchKeepsTheBurWhileTheInputGoesElsewhere) {
    open();
    (void)run(0.1);
    const Vec3 at = run(0.1).burInTooth.positionMm;
    bench.reading.buttons = 4;
    (void)run(0.02);
    EXPECT_TRUE(board->read().clutched);
    bench.reading.positionMm = {20, 0, 0};
    bench.reading.pedal = 1.0f;
    const device::Reading held = run(0.5);
    EXPECT_LT((held.burInTooth.positionMm - at).norm(), 1e-6);
    EXPECT_EQ(held.pedal, 0.0);
    bench.reading.buttons = 0;
    EXPECT_LT((run(0.5).burInTooth.positionMm - at).norm(), 1e-6) << "it goes on from where it is";
    EXPECT_EQ(run(0.02).pedal, 0.0) << "the pedal was pressed meanwhile";
    bench.reading.pedal = 0.0f;
    bench.reading.positionMm = {23, 0, 0};
    EXPECT_NEAR((run(0.5).burInTooth.positionMm - at).x(), 3.0, 0.01);
}

TEST_F(InputDeviceTest, anotherPlacingTakesEffectWithThePedalUp) {
    open();
    (void)run(0.02);
    bench.reading.pedal = 1.0f;
    const Vec3 at = run(0.1).burInTooth.positionMm;
    workspace::WorkspaceMapping placing;
    placing.toothMm = {7, 0, 0};
    board->place(placing);
    EXPECT_EQ(run(kPeriodS).pedal, 0.0);
    const device::Reading moved = run(0.5);
    EXPECT_NEAR((moved.burInTooth.positionMm - at).x(), 7.0, 0.01);
    EXPECT_EQ(moved.pedal, 0.0) << "not let go yet";
    placing.scale = 0.0;
    EXPECT_NE(errorOf([&] { board->place(placing); }), "");
}

TEST_F(InputDeviceTest, aFootPedalCountsBesideAnyDevice) {
    const auto foot = std::make_shared<link::PedalValue>();
    const auto press = [&](float value) { foot->write(value, bench.nowNs + 200'000'000); };
    EXPECT_NE(errorOf([&] { (void)withPedal(nullptr, foot); }), "");
    open();
    auto* const input = device.get();
    std::unique_ptr<device::Device> both = withPedal(std::move(device), foot);
    EXPECT_EQ(both.get(), input) << "under the input's own dead man";
    device.reset(static_cast<InputDevice*>(both.release()));
    (void)run(0.02);
    press(0.7f);
    EXPECT_NEAR(run(0.02).pedal, 0.7, 1e-6);
    bench.reading.pedal = 0.9f;
    EXPECT_NEAR(run(0.02).pedal, 0.9, 1e-6) << "the larger of both";
    bench.reading.trouble = DeviceFault::unplugged;
    press(1.0f);
    EXPECT_EQ(run(0.02).pedal, 0.0) << "no hand, no cutting";
    bench.reading.trouble = DeviceFault::none;
    press(1.0f);
    EXPECT_EQ(run(0.2).pedal, 0.0) << "still held down";

    // Beside another device, in the machine's own time.
    const auto mailbox = std::make_shared<device::PointerMailbox>();
    EXPECT_NE(errorOf([&] {
                  (void)withPedal(
                      std::make_unique<device::PointerDevice>(device::PointerHandSettings{}, mailbox, core::Pose{}),
                      nullptr);
              }),
              "");
    std::unique_ptr<device::Device> pointer =
        withPedal(std::make_unique<device::PointerDevice>(device::PointerHandSettings{}, mailbox, core::Pose{}), foot);
    foot->write(0.4f, rt::monotonicNs() + 3'600'000'000'000);
    EXPECT_NEAR(pointer->read(kPeriodS).pedal, 0.4, 1e-6);
    foot->write(0.4f, rt::monotonicNs() - link::PedalValue::kKeepsNs);
    EXPECT_EQ(pointer->read(kPeriodS).pedal, 0.0) << "a lost pedal is up";
    EXPECT_EQ(pointer->capability().name, "pointer");
}

TEST_F(InputDeviceTest, neitherTickNorServoTakesMemoryLocksOrWaits) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc";
    open();
    (void)run(0.05);
    workspace::WorkspaceMapping placing;
    placing.toothMm = {1, 0, 0};
    board->place(placing);
    std::mt19937_64 random(test::seed());
    const test::RealtimeTrap trap;
    for (int i = 0; i < 400; ++i) {
        bench.reading.buttons = static_cast<std::uint32_t>(random() % 8);
        bench.reading.pedal = static_cast<float>(i % 3) * 0.5f;
        bench.reading.trouble = i % 50 == 49 ? DeviceFault::badData : DeviceFault::none;
        bench.reading.positionMm[0] = i % 70 == 69 ? kNan : 0.01 * i;
        bench.frames = i % 90 < 60;
        (void)run(0.003, {0.1 * (i % 9), i % 40 == 0 ? kNan : 0.0, 0});
        device->vibrate(0.01 * i);
        (void)board->read();
    }
    EXPECT_EQ(trap.total(), 0u);
}

}  // namespace
}  // namespace handpiece::safety::input_device_test
