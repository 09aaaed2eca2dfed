// SPDX-License-Identifier: Apache-2.0
// mouth_bench CASE [--bur NAME]: what a tick's contact and force cost among all teeth of a case (handpiece make mouth)
// and with its own tooth alone: on the crown, with the bur wedged between two teeth, with bur and head touching at
// once. Each tick's best of three runs, so that the machine's own stalls do not count.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/force/force_model.h"
#include "support/random.h"

namespace handpiece::bench {
namespace {

using contact::Method;
using core::Pose;
using core::Vec3;
using Clock = std::chrono::steady_clock;

constexpr int kTicks = 8000, kRuns = 3;
constexpr double kPeriodS = 1e-3, kPressMm = 0.1, kSwingMm = 0.25;

double microseconds(Clock::duration d) {
    return std::chrono::duration<double, std::micro>(d).count();
}

void print(const std::string& what, std::vector<double> us) {
    std::sort(us.begin(), us.end());
    const auto at = [&](double share) {
        return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
    };
    fmt::print("{:<44} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f}\n", what, at(0.5), at(0.99), at(0.999), us.back());
}

/// From above down to this depth.
std::optional<Pose> lowered(Method& method, Pose pose, double fromZ, double toZ, double depthMm) {
    double high = fromZ, low = toZ;
    const auto depthAt = [&](double z) {
        pose.positionMm.z() = z;
        return method.depth(pose).depthMm;
    };
    if (depthAt(high) > 0.0 || depthAt(low) < depthMm) return {};
    for (int i = 0; i < 40; ++i)
        (depthAt(0.5 * (low + high)) < depthMm ? high : low) = 0.5 * (low + high);
    pose.positionMm.z() = low;
    return pose;
}

/// Ticks about a pose, the hand swinging along a slow curve; by tick the best of the runs.
std::vector<double> ticks(Method& method, const Pose& about, const force::Limits& limits) {
    std::vector<double> best(kTicks, 1e9);
    for (int run = 0; run < kRuns; ++run) {
        force::ForceModel model(limits, force::defaultParameters());
        method.reset();
        for (int i = 0; i < kTicks; ++i) {
            Pose pose = about;
            const double t = kPeriodS * i;
            pose.positionMm += kSwingMm * Vec3(std::sin(7.0 * t), std::sin(11.0 * t), 0.3 * std::sin(5.0 * t));
            const auto start = Clock::now();
            const force::Touch& touch = model.feel(method, pose, false, kPeriodS);
            (void)model.compute(touch, kPeriodS);
            auto& mine = best[static_cast<std::size_t>(i)];
            mine = std::min(mine, microseconds(Clock::now() - start));
        }
    }
    return best;
}

/// How many teeth hold the bur there, and whether the head is held as well.
struct Held {
    int teeth = 0;
    bool head = false;
};
Held heldAt(Method& method, const Pose& pose) {
    contact::ConstraintSet set;
    method.constraints(pose, 0.02, set);
    std::vector<std::uint16_t> teeth;
    Held held;
    for (const contact::Constraint& c : set) {
        if (c.piece == contact::Piece::bur)
            teeth.push_back(c.tooth);
        else
            held.head = held.head || c.piece == contact::Piece::head;
    }
    std::sort(teeth.begin(), teeth.end());
    held.teeth = static_cast<int>(std::unique(teeth.begin(), teeth.end()) - teeth.begin());
    return held;
}

void pieces(const simulation::SimulationSetup& mouth, std::mt19937_64& g) {
    const core::Box box = mouth.tooth->outer.bounds();
    for (const instrument::BodyPiece& piece : instrument::bodyPieces(*mouth.settings.bur)) {
        const auto method = contact::makeFieldMethod(mouth.tooth, piece.solid);
        std::vector<double> us;
        while (us.size() < 3000) {
            // Any way round, its middle or an end near the crown, drawn out until it is 0.5 mm deep at most.
            Pose pose{Vec3::Zero(), test::randomRotation(g)};
            const Vec3 on = test::randomDirection(g) * piece.solid->maxRadiusMm() +
                            Vec3(0, 0, test::uniform(g, 0.0, piece.solid->lengthMm()));
            pose.positionMm = box.centre() + 4.0 * test::randomDirection(g) - pose.orientation * on;
            contact::Depth d = method->depth(pose);
            for (int k = 0; k < 20 && d.status == contact::Status::ok && d.depthMm > 0.5; ++k) {
                pose.positionMm += d.depthMm * d.normal;
                d = method->depth(pose);
            }
            if (d.status != contact::Status::ok || d.depthMm > 0.5 || d.depthMm < -1.0) continue;
            double best = 1e9;
            for (int run = 0; run < kRuns; ++run) {
                method->reset();
                const auto start = Clock::now();
                (void)method->depth(pose);
                best = std::min(best, microseconds(Clock::now() - start));
            }
            us.push_back(best);
        }
        constexpr const char* kNames[] = {"bur", "shank", "head", "handle"};
        print(fmt::format("{} at one tooth, 1 mm clear to 0.5 mm deep", kNames[static_cast<std::size_t>(piece.part)]),
              us);
    }
}

int run(int count, char** values) {
    if (count < 2)
        throw core::Error("no case was named", "mouth_bench", "handpiece make mouth --out mouth; mouth_bench mouth");
    cases::Case mouthCase = cases::readCase(values[1]);
    simulation::SimulationSettings settings;
    const std::string burName = count > 3 && std::string(values[2]) == "--bur" ? values[3] : "330";
    settings.bur = std::make_shared<const instrument::Bur>(instrument::makeBur(burName));
    const auto start = Clock::now();
    const simulation::SimulationSetup mouth = simulation::makeSimulation(mouthCase, settings, true);
    fmt::print("{} teeth, loaded in {:.2f} s\n", mouth.others.size() + 1, 1e-6 * microseconds(Clock::now() - start));
    mouthCase.others.clear();
    const simulation::SimulationSetup lone = simulation::makeSimulation(mouthCase, settings, true);
    const std::unique_ptr<Method> all = mouth.work().method, one = lone.work().method;
    std::mt19937_64 g(test::seed());
    const core::Box box = mouth.tooth->outer.bounds();
    const double topMm = box.max.z() + 0.5;
    fmt::print("{:<44} {:>8} {:>8} {:>8} {:>8}\n", "us a tick", "p50", "p99", "p99.9", "worst");
    const auto compare = [&](const char* what, const Pose& pose) {
        print(fmt::format("{}: the tooth alone", what), ticks(*one, pose, {}));
        print(fmt::format("{}: all teeth, whole handpiece", what), ticks(*all, pose, {}));
    };
    // On the crown, where nothing else is touched.
    for (;;) {
        Pose pose{{test::uniform(g, -2, 2), test::uniform(g, -2, 2), 0}, core::Quat::Identity()};
        const auto found = lowered(*one, pose, topMm, 0.0, kPressMm);
        if (!found) continue;
        compare("crown", *found);
        break;
    }
    bool wedged = false, headed = false;
    for (int i = 0; i < 20000 && !(wedged && headed); ++i) {
        const double side = i % 2 == 0 ? box.max.x() : box.min.x();
        Pose pose{{side + test::uniform(g, -1.5, 1.5), test::uniform(g, -3, 3), 0}, core::Quat::Identity()};
        if (!wedged) {
            const auto found = lowered(*all, pose, topMm, 0.0, kPressMm);
            if (found && heldAt(*all, *found).teeth >= 2) {
                compare("wedged between two teeth", *found);
                wedged = true;
            }
        }
        // The bur on the crown, tilted so far that the head comes down on something.
        const double turn = test::uniform(g, 0, 2.0 * std::numbers::pi);
        pose.orientation =
            core::Quat(Eigen::AngleAxisd(test::uniform(g, 0.3, 1.5), Vec3(std::cos(turn), std::sin(turn), 0))) *
            core::Quat(Eigen::AngleAxisd(test::uniform(g, 0, 6.28), Vec3::UnitZ()));
        pose.positionMm.x() *= test::uniform(g, 0, 1);
        if (!headed) {
            const auto found = lowered(*all, pose, topMm, 0.0, kPressMm);
            if (!found) continue;
            const Held held = heldAt(*all, *found);
            if (held.teeth < 1 || !held.head) continue;
            compare("bur and head at once", *found);
            headed = true;
        }
    }
    if (!wedged) fmt::print("no place was found where the bur touches two teeth\n");
    if (!headed) fmt::print("no pose was found where bur and head touch at once\n");
    pieces(mouth, g);
    return 0;
}

}  // namespace
}  // namespace handpiece::bench

int main(int count, char** values) {
    try {
        return handpiece::bench::run(count, values);
    } catch (const handpiece::core::Error& e) {
        fmt::print(stderr, "{}\n", e.what());
        return 1;
    }
}
