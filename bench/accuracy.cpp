// SPDX-License-Identifier: Apache-2.0
// accuracy [--faces N,N...] [--poses N] [--bur NAME]: the field method's depth against brute force on the starter
// molar, one line per bur, face count and source of depth: error and time. accuracy --cut [--json] [--voxel MM] ...:
// the same after a cut, against the tooth minus the exact sweep. accuracy --margins: the edge of the cut in the surface
// as files have it, against the same.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "accuracy_cut.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/model/field/field_builder.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/tick/contact/field_method.h"
#include "measure.h"
#include "support/brute_force_depth.h"
#include "support/random.h"
#include "tick/contact/cut_by_hand.h"

namespace handpiece::bench {
namespace {

using test::uniform;

constexpr const char* kBurs[] = {
    "cylinder-round:1.0x4.0", "taper-round:1.2x4.0",
    "pear:1.2x3.0",           "flame:1.2x4.0",
    "round:1.4x1.3",          "cylinder-flat:1.0x4.0",
    "wheel:2.0x0.8",          "inverted-cone:1.2x1.2",
    "taper-flat:1.2x4.0",     "mesh"};  // the last: the paper bur through its mesh, as an STL would come
constexpr int kPasses = 15;
constexpr unsigned kSeed = 20;
constexpr double kTiltRad = 15.0 * std::numbers::pi / 180.0;

std::shared_ptr<const instrument::Bur> burOf(std::string_view name) {
    if (name == "mesh")
        return std::make_shared<const instrument::Bur>(
            instrument::burFromMesh("mesh", instrument::makeBur("paper").mesh()));
    return std::make_shared<const instrument::Bur>(instrument::makeBur(name));
}

std::shared_ptr<const tooth::ToothModel> molarOf(std::size_t faces, double voxelMm = 0.05) {
    geometry::TriangleMesh mesh = starter::makeOuter(starter::ToothKind::lowerFirstMolar, faces);
    geometry::TriangleTree tree(mesh);
    field::FieldSettings settings;
    settings.voxelMm = voxelMm;
    field::DistanceField field = field::FieldBuilder::fromSurface(mesh, tree, {}, settings);
    auto tissues = field::TissueMap::uniform(field, cases::Tissue::enamel);
    return tooth::withTissues(tooth::ToothModel{"molar", std::move(mesh), std::move(tree), std::move(field)},
                              std::move(tissues));
}

/// Over the crown, tilted by up to 15 degrees, lowered until the depth is the one drawn (even in its logarithm).
core::Pose drawPose(std::mt19937_64& generator, contact::Method& method, const core::Box& tooth, double deepestMm) {
    for (;;) {
        core::Pose pose;
        const double turn = uniform(generator, 0.0, 2.0 * std::numbers::pi);
        const double tilt = uniform(generator, 0.0, kTiltRad);
        pose.orientation = core::Quat(Eigen::AngleAxisd(tilt, core::Vec3(std::cos(turn), std::sin(turn), 0.0)));
        const core::Vec3 centre = tooth.centre(), half = 0.5 * tooth.size();
        const double x = centre.x() + 0.55 * half.x() * uniform(generator, -1.0, 1.0);
        const double y = centre.y() + 0.55 * half.y() * uniform(generator, -1.0, 1.0);
        const double wanted = std::exp(uniform(generator, std::log(0.005), std::log(deepestMm)));
        double high = tooth.max.z() + 1.0, low = tooth.max.z() - 4.0;
        const auto depthAt = [&](double z) {
            pose.positionMm = {x, y, z};
            return method.depth(pose).depthMm;
        };
        if (depthAt(low) < wanted) continue;
        for (int i = 0; i < 30; ++i) {
            const double middle = 0.5 * (low + high);
            (depthAt(middle) < wanted ? high : low) = middle;
        }
        pose.positionMm.z() = low;
        return pose;
    }
}

void report(const std::shared_ptr<const tooth::ToothModel>& tooth, const char* burName, contact::DepthSource source,
            int count) {
    const auto bur = burOf(burName);
    contact::FieldMethodSettings settings;
    settings.depthSource = source;
    const bool exact = source == contact::DepthSource::exact;
    const auto method = contact::makeFieldMethod(tooth, bur, settings),
               exactMethod = contact::makeFieldMethod(tooth, bur);
    std::mt19937_64 generator(kSeed);
    // The field alone promises nothing deeper than the bur's radius.
    const double deepestMm = exact ? 1.5 : 0.95 * bur->maxRadiusMm();
    std::vector<core::Pose> poses;
    for (int i = 0; i < count; ++i)
        poses.push_back(drawPose(generator, *exactMethod, tooth->outer.bounds(), deepestMm));
    std::vector<double> truth(poses.size()), errors, times;
    core::parallelFor(poses.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            truth[i] = test::bruteForceDepth(tooth->tree, *bur, poses[i]).depthMm;
    });
    for (std::size_t i = 0; i < poses.size(); ++i) {
        double told = 0.0, fastest = 1e9;
        for (int pass = 0; pass < kPasses; ++pass) {
            // Elsewhere first: what was sensed at the same pose would serve again.
            (void)method->depth(poses[(i + 1) % poses.size()]);
            const auto begin = std::chrono::steady_clock::now();
            told = method->depth(poses[i]).depthMm;
            fastest = std::min(
                fastest, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
        }
        errors.push_back(1e3 * std::abs(told - truth[i]));
        times.push_back(fastest);
    }
    std::sort(errors.begin(), errors.end());
    std::sort(times.begin(), times.end());
    fmt::print("{:<24} {:>7} {:<6} {:>6} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.2f} {:>9.2f}\n", burName,
               tooth->outer.triangles.size(), exact ? "exact" : "field", count, percentile(errors, 0.5),
               percentile(errors, 0.99), errors.back(), percentile(times, 0.5), percentile(times, 0.99));
    std::fflush(stdout);
}

/// In the cavity that the bur itself has left, pushed on by up to `deepestMm`: the depth is the way it was pushed.
void reportOwnCavity(double deepestMm, int count) {
    const auto cut = test::slabToCut();
    const auto bur = burOf("cylinder-round:1.0x4.0");
    const core::Vec3 tip(0.013, -0.021, -2.0);
    test::carve(*cut, {{-1, -1, -3}, {1, 1, 1}}, [&](const core::Vec3& p) { return test::shaftDistance(p, tip, 0.5); });
    const auto method = contact::makeFieldMethod(std::shared_ptr<const tooth::ToothState>(cut), bur);
    std::mt19937_64 generator(kSeed);
    std::vector<double> errors, times, after;
    contact::ConstraintSet constraints;
    for (int i = 0; i < count; ++i) {
        core::Vec3 way(uniform(generator, -1, 1), uniform(generator, -1, 1), -uniform(generator, 0, 1));
        way *= uniform(generator, 0.0, deepestMm) / way.norm();
        core::Pose pose;
        pose.positionMm = tip + way;
        double told = 0.0, fastest = 1e9, fastestAfter = 1e9;
        for (int pass = 0; pass < kPasses; ++pass) {
            core::Pose elsewhere = pose;
            elsewhere.positionMm.z() += 1e-3;
            (void)method->depth(elsewhere);
            const auto begin = std::chrono::steady_clock::now();
            told = method->depth(pose).depthMm;
            const auto end = std::chrono::steady_clock::now();
            fastest = std::min(fastest, std::chrono::duration<double, std::micro>(end - begin).count());
            (void)method->depth(elsewhere);
            (void)method->constraints(pose, 0.06, constraints);
            const auto again = std::chrono::steady_clock::now();
            (void)method->depth(pose);
            fastestAfter =
                std::min(fastestAfter,
                         std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - again).count());
        }
        errors.push_back(1e3 * std::abs(told - way.norm()));
        times.push_back(fastest);
        after.push_back(fastestAfter);
    }
    std::sort(errors.begin(), errors.end());
    std::sort(times.begin(), times.end());
    std::sort(after.begin(), after.end());
    fmt::print(
        "own cavity, up to {:>5.3f} mm {:>6} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.2f} {:>9.2f}; after constraints {:.2f}\n",
        deepestMm, count, percentile(errors, 0.5), percentile(errors, 0.99), errors.back(), percentile(times, 0.5),
        percentile(times, 0.99), percentile(after, 0.5));
}

void reportCuts(std::size_t faces, double voxelMm, const std::string& only, const std::string& onlyCut, int poses,
                bool json) {
    const auto tooth = molarOf(faces, voxelMm);
    auto rows = nlohmann::ordered_json::array();
    for (const char* name : kBurs)
        for (const char* cut : kCuts) {
            if ((!only.empty() && only != name) || (!onlyCut.empty() && onlyCut != cut)) continue;
            const CutAccuracy a = measureCut(tooth, burOf(name), cut, static_cast<std::size_t>(poses), kSeed);
            if (json) {
                rows.push_back({{"bur", name},
                                {"cut", cut},
                                {"voxel_mm", voxelMm},
                                {"poses", a.poses},
                                {"err_med_um", a.errorMedianUm},
                                {"err_p99_um", a.errorP99Um},
                                {"err_max_um", a.errorWorstUm},
                                {"time_us", a.timeUs},
                                {"time_p99_us", a.timeP99Us}});
                continue;
            }
            fmt::print("{:<24} {:<9} {:>6} {:>6} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.2f} {:>9.2f}\n", name, cut, voxelMm,
                       a.poses, a.errorMedianUm, a.errorP99Um, a.errorWorstUm, a.timeUs, a.timeP99Us);
            std::fflush(stdout);
        }
    if (json) fmt::print("{}\n", rows.dump(2));
}

void reportMargins(std::size_t faces, double voxelMm, const std::string& only, const std::string& onlyCut) {
    fmt::print("{:<24} {:<9} {:>6} {:>6} {:>9} {:>9} {:>9}\n", "bur", "cut", "voxel", "places", "med_um", "p95_um",
               "worst_um");
    const auto tooth = molarOf(faces, voxelMm);
    for (const char* name : kBurs)
        for (const char* cut : kCuts) {
            if ((!only.empty() && only != name) || (!onlyCut.empty() && onlyCut != cut)) continue;
            const MarginAccuracy a = measureMargin(tooth, burOf(name), cut, kSeed);
            fmt::print("{:<24} {:<9} {:>6} {:>6} {:>9.2f} {:>9.2f} {:>9.2f}\n", name, cut, voxelMm, a.places,
                       a.medianUm, a.p95Um, a.worstUm);
            std::fflush(stdout);
        }
}

int mainOf(int argc, char** argv) {
    std::vector<std::size_t> faces = {9760, 68151};
    int poses = 360;
    bool cut = false, margins = false, json = false;
    double voxelMm = 0.05;
    std::string only, onlyCut;
    for (int i = 1; i < argc; ++i) {
        const std::string_view option = argv[i];
        if (option == "--cut" || option == "--margins" || option == "--json") {
            (option == "--cut" ? cut : option == "--margins" ? margins : json) = true;
            continue;
        }
        if (i + 1 == argc || (option != "--faces" && option != "--poses" && option != "--bur" && option != "--voxel" &&
                              option != "--only")) {
            fmt::print(stderr,
                       "usage: accuracy [--faces N,N...] [--poses N] [--bur NAME]\n"
                       "       accuracy --cut [--json] [--voxel MM] [--faces N] [--poses N] [--bur NAME] [--only CUT]\n"
                       "       accuracy --margins [--voxel MM] [--faces N] [--bur NAME] [--only CUT]\n");
            return 2;
        }
        const char* value = argv[++i];
        if (option == "--poses") poses = std::max(1, std::atoi(value));
        if (option == "--bur") only = value;
        if (option == "--only") onlyCut = value;
        if (option == "--voxel") voxelMm = std::atof(value);
        if (option == "--faces") {
            faces.clear();
            for (char* at = const_cast<char*>(value); *at != '\0'; at += *at == ',' ? 1 : 0)
                faces.push_back(std::strtoul(at, &at, 10));
        }
    }
    if (margins) {
        reportMargins(faces.front(), voxelMm, only, onlyCut);
        return 0;
    }
    if (cut) {
        if (!json)
            fmt::print("{:<24} {:<9} {:>6} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "bur", "cut", "voxel", "poses",
                       "med_um", "p99_um", "worst_um", "med_us", "p99_us");
        reportCuts(faces.front(), voxelMm, only, onlyCut, poses, json);
        return 0;
    }
    fmt::print("{:<24} {:>7} {:<6} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "bur", "faces", "source", "poses", "med_um",
               "p99_um", "worst_um", "med_us", "p99_us");
    if (only.empty() || only == "cavity")
        for (const double deepestMm : {0.002, 0.01, 0.1, 0.3, 1.0})
            reportOwnCavity(deepestMm, poses);
    if (only == "cavity") return 0;
    for (const std::size_t n : faces) {
        const auto tooth = molarOf(n);
        for (const char* bur : kBurs)
            for (const auto source : {contact::DepthSource::exact, contact::DepthSource::field})
                if (only.empty() || only == bur) report(tooth, bur, source, poses);
    }
    return 0;
}

}  // namespace
}  // namespace handpiece::bench

int main(int argc, char** argv) {
    try {
        return handpiece::bench::mainOf(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "accuracy: %s\n", error.what());
        return 1;
    }
}
