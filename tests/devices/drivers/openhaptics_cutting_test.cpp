// SPDX-License-Identifier: Apache-2.0
// From end to end: a scripted hand in the double of the HD library, driver, gate, placing, tick, a bur and a molar of
// the product; what reaches the motors is read in the double.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "devices/drivers/conformance.h"
#include "devices/drivers/openhaptics_double.h"
#include "handpiece/devices/drivers/openhaptics.h"
#include "handpiece/devices/safety/guarded_device.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/loop/loop_run.h"
#include "support/random.h"
#include "support/small_molar.h"

namespace handpiece::drivers::openhaptics_cutting_test {
namespace {

using core::Quat;
using core::Vec3;

struct Row {
    double t = 0, y = 0;
    Vec3 forceN = Vec3::Zero();
    unsigned buttons = 0;
};
std::vector<Row> readLog(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::vector<Row> rows;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#' || line[0] == 't') continue;
        std::vector<double> v;
        std::stringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');)
            v.push_back(std::stod(cell));
        rows.push_back({v.at(0), v.at(2), {v.at(4), v.at(5), v.at(6)}, static_cast<unsigned>(v.at(7))});
    }
    return rows;
}

TEST(OpenHapticsEndToEnd, aHandCutsACavityAndFeelsIt) {
    const test::TemporaryFolder temporary;
    const std::filesystem::path& folder = temporary.path();
    {
        // Device frame: +y up, the top of the crown at y = 0. First it only touches, then the upper button is down.
        std::ofstream script(folder / "hand.csv");
        script << "t_s,x_mm,y_mm,z_mm,buttons\n0,0,6,0,0\n0.3,0,6,0,0\n0.6,0,-4,0,0\n1.2,0,-4,0,0\n1.3,0,-5,0,1\n";
        for (int i = 0; i < 60; ++i)
            script << 1.8 + 2 * i << ",1.2,-6,0,1\n"
                   << 2.3 + 2 * i << ",-1.2,-6,0.3,1\n"
                   << 2.4 + 2 * i << ",0,-4,0,0\n"  // and only touches again: not every second is a machine's own
                   << 3.4 + 2 * i << ",0,-4,0,0\n";
    }
    const HdDouble& hd = hdDouble();
    hd.reset(1, "Touch");
    setenv("HANDPIECE_HD_DOUBLE_SCRIPT", (folder / "hand.csv").c_str(), 1);
    setenv("HANDPIECE_HD_DOUBLE_LOG", (folder / "motors.csv").c_str(), 1);

    const auto base = test::smallMolar(0.2);
    const core::Box box = base->outer.bounds();
    const auto field = std::make_shared<tooth::ToothState>(base);
    const auto bur = std::make_shared<const instrument::Bur>(instrument::makeBur("round:1.4x1.4"));
    double removedMm3 = 0.0, removedBeforeMm3 = 0.0;
    std::uint64_t troubles = 0;
    bool pressed = false;
    {
        auto driver = openOpenHaptics({});
        safety::GuardSettings guard;
        guard.gate = safety::gateSettingsFor(driver->info().capability);
        guard.placing.toothMm = {box.centre().x(), box.centre().y(), box.max.z()};
        guard.placing.toothInDevice = Quat(Eigen::AngleAxisd(-EIGEN_PI / 2, Vec3::UnitX()));  // occlusal is up
        auto device = std::make_unique<safety::GuardedDevice>(std::move(driver), guard);
        const auto health = device->health();
        loop::HapticLoop haptic(
            {}, std::move(device),
            {contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(field), bur),
             std::make_unique<cutting::Cutter>(field, bur, instrument::CuttingParameters{}, cases::builtInTissues(),
                                               cutting::Cutter::Settings{})},
            force::defaultParameters());
        const auto then = std::chrono::steady_clock::now();
        runAttended(haptic, true, [&](const rt::SchedulingGrant&) {
            haptic.fetch(
                [&](const messages::HapticSample& s) {
                    removedMm3 = 0.0;
                    for (const double v : s.removedMm3)
                        removedMm3 += v;
                    pressed = pressed || s.pedal > 0.0;
                    if (!pressed) removedBeforeMm3 = removedMm3;
                },
                {});
            const double ranS = std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
            if ((removedMm3 > 0.5 && ranS > 6.0) || ranS > 60.0) haptic.requestStop();
        });
        troubles = health->read().gate.troubles;
    }
    unsetenv("HANDPIECE_HD_DOUBLE_SCRIPT");
    unsetenv("HANDPIECE_HD_DOUBLE_LOG");

    EXPECT_GT(removedMm3, 0.5) << "a cavity";
    EXPECT_EQ(removedBeforeMm3, 0.0) << "nothing before the button";
    double largest = 0.0, up = 0.0, pushedS = 0.0, touched = 0.0;
    const std::vector<Row> rows = readLog(folder / "motors.csv");
    ASSERT_GT(rows.size(), 1000u);
    for (const Row& row : rows) {
        largest = std::max(largest, row.forceN.norm());
        if (row.y > 1.0 && !row.forceN.isZero()) ADD_FAILURE() << "pushed in the air, at " << row.t << " s";
        if (row.buttons == 0) touched = std::max(touched, row.forceN.norm());
        if (row.forceN.norm() > 0.05) pushedS += 0.001;
        up += row.forceN.y() * 0.001;
    }
    EXPECT_LE(largest, 3.3 * (1.0 + 1e-6));
    EXPECT_GT(touched, 0.3) << "the whole tooth holds the hand back";
    EXPECT_GT(pushedS, 0.3);
    EXPECT_GT(up, 0.0) << "N s, out of the tooth";
    EXPECT_EQ(hd.breaches(), 0u) << hd.lastBreach();
    std::printf(
        "removed %.2f mm3; at the motors: largest %.2f N, touching %.2f N, pushing for %.1f s of %.1f s; "
        "troubles %llu\n",
        removedMm3, largest, touched, pushedS, rows.back().t, static_cast<unsigned long long>(troubles));
    hd.reset(1, "Touch");
}

}  // namespace
}  // namespace handpiece::drivers::openhaptics_cutting_test
