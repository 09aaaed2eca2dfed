// SPDX-License-Identifier: Apache-2.0
// mouth_bench CASE [--bur NAME] [--only crown|wedged|head|both|pieces] [--ticks N]: what a tick's contact and force
// cost among all teeth of a case (handpiece make mouth) and with its own tooth alone: on the crown, with the bur wedged
// between two teeth, with bur and head touching at once, with the bur wedged and the head on another tooth. Each tick's
// best of several runs, by turns with what it is held against, so that the machine's own stalls do not count. Beside
// the lone tooth, which has half of a wedge's contact, stands each tooth that is touched by itself, and their sum.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "handpiece/app/simulation/simulation_setup.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/simd.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/tick/contact/field_method.h"
#include "handpiece/tick/contact/mouth_method.h"
#include "handpiece/tick/force/force_model.h"
#include "support/random.h"

namespace handpiece::bench {
namespace {

using contact::Method;
using core::Pose;
using core::Vec3;
using Clock = std::chrono::steady_clock;

constexpr int kRuns = 5;
int ticksOf = 8000;
std::array<double, 8> passesOf{};  // of all ticks of the last scene, by method
constexpr double kPeriodS = 1e-3, kPressMm = 0.1, kSwingMm = 0.25;

double microseconds(Clock::duration d) {
    return std::chrono::duration<double, std::micro>(d).count();
}

struct Spread {
    double p50, p99, p999, most;
};
Spread spreadOf(std::vector<double> us) {
    std::sort(us.begin(), us.end());
    const auto at = [&](double share) {
        return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
    };
    return {at(0.5), at(0.99), at(0.999), us.back()};
}
void print(const std::string& what, const Spread& s) {
    fmt::print("{:<48} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f}\n", what, s.p50, s.p99, s.p999, s.most);
}
void printTimes(const std::string& what, const Spread& s, const Spread& of) {
    fmt::print("{:<48} {:>8.2f} {:>8.2f} {:>8.2f}\n", what, s.p50 / of.p50, s.p99 / of.p99, s.p999 / of.p999);
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

/// Ticks about a pose, the hand swinging along a slow curve, of each method in turn; by tick the best of the runs.
std::vector<std::vector<double>> ticks(const std::vector<Method*>& methods, const Pose& about) {
    passesOf.fill(0.0);
    std::vector<std::vector<double>> best(methods.size(), std::vector<double>(static_cast<std::size_t>(ticksOf), 1e9));
    for (int run = 0; run < kRuns; ++run)
        for (std::size_t m = 0; m < methods.size(); ++m) {
            Method& method = *methods[m];
            force::ForceModel model({}, force::defaultParameters());
            method.reset();
            for (int i = 0; i < ticksOf; ++i) {
                Pose pose = about;
                const double t = kPeriodS * i;
                pose.positionMm += kSwingMm * Vec3(std::sin(7.0 * t), std::sin(11.0 * t), 0.3 * std::sin(5.0 * t));
                const auto start = Clock::now();
                const force::Touch& touch = model.feel(method, pose, false, kPeriodS);
                (void)model.compute(touch, kPeriodS);
                passesOf[m] += touch.passes;
                auto& mine = best[m][static_cast<std::size_t>(i)];
                mine = std::min(mine, microseconds(Clock::now() - start));
            }
        }
    return best;
}

/// Which teeth hold the bur there, and which the head.
struct Held {
    std::vector<std::uint16_t> bur, head;
};
Held heldAt(Method& method, const Pose& pose) {
    contact::ConstraintSet set;
    method.constraints(pose, 0.02, set);
    Held held;
    for (const contact::Constraint& c : set)
        if (c.piece == contact::Piece::bur || c.piece == contact::Piece::head)
            (c.piece == contact::Piece::bur ? held.bur : held.head).push_back(c.tooth);
    for (std::vector<std::uint16_t>* teeth : {&held.bur, &held.head}) {
        std::sort(teeth->begin(), teeth->end());
        teeth->erase(std::unique(teeth->begin(), teeth->end()), teeth->end());
    }
    return held;
}

/// One of a setup's teeth with the bur alone, where it stands.
std::unique_ptr<Method> toothAlone(const simulation::SimulationSetup& mouth, std::uint16_t tooth) {
    if (tooth == 0)
        return contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(mouth.field), mouth.settings.bur);
    const simulation::StandingTooth& other = mouth.others[tooth - 1u];
    contact::PlacedMethod placed;
    placed.method = other.field ? contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(other.field),
                                                           mouth.settings.bur)
                                : contact::makeFieldMethod(other.model, mouth.settings.bur);
    placed.solid = mouth.settings.bur;
    placed.toothInScene = other.inCase;
    placed.toothBoxMm = other.model->outer.bounds();
    placed.tooth = tooth;
    placed.isCuttable = other.field != nullptr;
    std::vector<contact::PlacedMethod> one;
    one.push_back(std::move(placed));
    return contact::makeMouthMethod(std::move(one));
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
              spreadOf(std::move(us)));
    }
}

int run(int count, char** values) {
    if (count < 2)
        throw core::Error("no case was named", "mouth_bench", "handpiece make mouth --out mouth; mouth_bench mouth");
    std::string burName = "330", only;
    for (int i = 2; i + 1 < count; i += 2) {
        const std::string option = values[i];
        if (option == "--bur") burName = values[i + 1];
        if (option == "--only") only = values[i + 1];
        if (option == "--ticks") ticksOf = std::max(1, std::atoi(values[i + 1]));
    }
    const auto wants = [&only](const char* scene) { return only.empty() || only == scene; };
    const auto begin = Clock::now();
    cases::Case mouthCase = cases::readCase(values[1]);
    simulation::SimulationSettings settings;
    settings.bur = std::make_shared<const instrument::Bur>(instrument::makeBur(burName));
    const auto start = Clock::now();
    const simulation::SimulationSetup mouth = simulation::makeSimulation(mouthCase, settings, true);
    const auto loaded = Clock::now();
    fmt::print("{} teeth, read in {:.2f} s, loaded in {:.2f} s, ", mouth.others.size() + 1,
               1e-6 * microseconds(start - begin), 1e-6 * microseconds(loaded - start));
    mouthCase.others.clear();
    const simulation::SimulationSetup lone = simulation::makeSimulation(mouthCase, settings, true);
    const auto again = Clock::now();
    const std::unique_ptr<Method> all = mouth.work().method, one = lone.work().method, bare = toothAlone(lone, 0);
    fmt::print("its own tooth again in {:.2f} s, methods in {:.2f} s; instructions: {}\n",
               1e-6 * microseconds(again - loaded), 1e-6 * microseconds(Clock::now() - again),
               std::array{"base", "", "AVX2", "AVX-512"}[static_cast<std::size_t>(core::simdLevel())]);
    std::mt19937_64 g(test::seed());
    const core::Box box = mouth.tooth->outer.bounds();
    const double topMm = box.max.z() + 0.5;
    fmt::print("{:<48} {:>8} {:>8} {:>8} {:>8}\n", "us a tick", "p50", "p99", "p99.9", "worst");
    const auto compare = [&](const char* what, const Pose& pose) {
        const Held held = heldAt(*all, pose);
        std::vector<std::uint16_t> touched = held.bur;
        touched.insert(touched.end(), held.head.begin(), held.head.end());
        std::string names;
        for (const std::uint16_t t : touched)
            names += fmt::format(" {}", t == 0 ? mouthCase.fdiNumber : mouth.others[t - 1u].fdiNumber);
        fmt::print("{}: bur and head on{}\n", what, names);
        std::vector<std::unique_ptr<Method>> others;
        std::vector<Method*> methods{bare.get(), one.get(), all.get()};
        for (const std::uint16_t t : held.bur)
            if (t != 0) methods.push_back(others.emplace_back(toothAlone(mouth, t)).get());
        const std::vector<std::vector<double>> us = ticks(methods, pose);
        const Spread whole = spreadOf(us[2]);
        std::vector<double> sum = us[0];
        print("  its own tooth alone, the bur", spreadOf(us[0]));
        print("  its own tooth and gingiva, whole handpiece", spreadOf(us[1]));
        for (std::size_t m = 3; m < us.size(); ++m) {
            print("  the other tooth alone, the bur", spreadOf(us[m]));
            for (std::size_t i = 0; i < sum.size(); ++i)
                sum[i] += us[m][i];
        }
        print("  all teeth, whole handpiece", whole);
        fmt::print("  passes a tick of the proxy:");
        for (std::size_t m = 0; m < us.size(); ++m)
            fmt::print(" {:.2f}", passesOf.at(m) / (kRuns * static_cast<double>(ticksOf)));
        fmt::print(" in this order\n");
        printTimes("  times its own tooth alone, the bur", whole, spreadOf(us[0]));
        printTimes("  times its own tooth and gingiva", whole, spreadOf(us[1]));
        if (us.size() > 3) printTimes("  times the touched teeth, each alone, together", whole, spreadOf(sum));
    };
    // On the crown, where nothing else is touched.
    for (bool isDone = !wants("crown"); !isDone;) {
        Pose pose{{test::uniform(g, -2, 2), test::uniform(g, -2, 2), 0}, core::Quat::Identity()};
        const auto found = lowered(*one, pose, topMm, 0.0, kPressMm);
        if (!found) continue;
        compare("crown", *found);
        isDone = true;
    }
    struct Scene {
        const char *name, *what;
        bool isDone;
    };
    Scene wedged{"wedged", "wedged between two teeth", !wants("wedged")},
        headed{"head", "bur and head at once", !wants("head")},
        both{"both", "bur wedged between two teeth, head on another", !wants("both")};
    for (int i = 0; i < 40000 && !(wedged.isDone && headed.isDone && both.isDone); ++i) {
        const double side = i % 2 == 0 ? box.max.x() : box.min.x();
        Pose pose{{side + test::uniform(g, -1.5, 1.5), test::uniform(g, -3, 3), 0}, core::Quat::Identity()};
        const Vec3 between = pose.positionMm;
        if (!wedged.isDone) {
            const auto found = lowered(*all, pose, topMm, 0.0, kPressMm);
            if (found && heldAt(*all, *found).bur.size() >= 2) {
                compare(wedged.what, *found);
                wedged.isDone = true;
            }
        }
        // The bur on the crown, tilted so far that the head comes down on something.
        const double turn = test::uniform(g, 0, 2.0 * std::numbers::pi);
        pose.orientation =
            core::Quat(Eigen::AngleAxisd(test::uniform(g, 0.3, 1.5), Vec3(std::cos(turn), std::sin(turn), 0))) *
            core::Quat(Eigen::AngleAxisd(test::uniform(g, 0, 6.28), Vec3::UnitZ()));
        pose.positionMm.x() *= test::uniform(g, 0, 1);
        if (!headed.isDone) {
            const auto found = lowered(*all, pose, topMm, 0.0, kPressMm);
            if (found) {
                const Held held = heldAt(*all, *found);
                if (!held.bur.empty() && !held.head.empty()) {
                    compare(headed.what, *found);
                    headed.isDone = true;
                }
            }
        }
        if (!both.isDone) {
            pose.positionMm = between;
            const auto found = lowered(*all, pose, topMm, 0.0, kPressMm);
            if (found) {
                const Held held = heldAt(*all, *found);
                if (held.bur.size() >= 2 && !held.head.empty()) {
                    compare(both.what, *found);
                    both.isDone = true;
                }
            }
        }
    }
    for (const Scene& scene : {wedged, headed, both})
        if (!scene.isDone) fmt::print("no pose was found: {}\n", scene.what);
    if (wants("pieces")) pieces(mouth, g);
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
