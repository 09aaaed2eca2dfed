// SPDX-License-Identifier: Apache-2.0
// surface/<voxel_um>/<shallow|deep|full>: the surface kept up while a 330 bur is drawn over the starter molar, 6 um a
// tick, and takes away all that it sweeps. Counters p50_us, p99_us, p999_us, max_us are of one update a tick (the best
// of all passes for each tick), raw_* of every tick of every pass, picture_* of one update for the 17 ticks of a
// picture (60 a second at 1 kHz), with a17th of them a tick's share, cut_to_mesh_* the same with the picture's cuts and
// their way to the mesh; dirty_bricks and triangles are those whose mesh is another after a tick, touched_bricks those
// with values to look at. `full` is the whole surface at once. HANDPIECE_BENCH_QUICK=1 makes a smoke test of it.
#include "surface_bench.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "handpiece/senses/surface/surface.h"
#include "handpiece/tick/cutting/sweeper.h"

namespace handpiece::bench {
namespace {

using core::Vec3;

constexpr double kStepMm = 0.006;
constexpr std::size_t kPictureTicks = 17;

bool isQuick() {
    const char* quick = std::getenv("HANDPIECE_BENCH_QUICK");
    return quick != nullptr && *quick == '1';
}

double nowUs() {
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double percentile(const std::vector<double>& ascending, double share) {
    if (ascending.empty()) return 0.0;
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(ascending.size())));
    return ascending[std::clamp<std::size_t>(rank, 1, ascending.size()) - 1];
}

std::shared_ptr<const tooth::ToothModel> molar(int voxelUm) {
    static std::map<int, std::shared_ptr<const tooth::ToothModel>> all;
    auto& made = all[voxelUm];
    if (made == nullptr) {
        const cases::Case toothCase = starter::makeTooth(starter::ToothKind::lowerFirstMolar, {68151});
        tooth::LoadSettings settings;
        settings.field.voxelMm = 1e-3 * voxelUm;
        settings.cacheFolder = HANDPIECE_BENCH_CACHE;
        made = tooth::loadModel(toothCase, settings);
    }
    return made;
}

/// Over the crown from mesial to distal and back a little to the side, tilted by 15 degrees; the tip sinks in by
/// 0.05 to 0.5 mm, or by 1.5 mm where `deep`.
std::vector<core::Pose> way(const field::DistanceField& field, bool deep, std::size_t ticks) {
    core::Pose pose;
    pose.orientation = core::Quat(Eigen::AngleAxisd(M_PI / 12.0, Vec3::UnitY()));
    const double topMm = field.bounds().max.z();
    std::vector<core::Pose> poses;
    for (std::size_t i = 0; i < ticks; ++i) {
        const double along = kStepMm * static_cast<double>(i);
        const double x = 3.0 * std::sin(along / 3.0), y = -1.5 + along / 8.0;
        const double depth = deep ? 1.5 : 0.275 + 0.225 * std::sin(2.0 * M_PI * along / 1.5);
        // Down until the tip touches, then in by the depth.
        pose.positionMm = Vec3(x, y, topMm);
        while (pose.positionMm.z() > 0.0 && field.distance(pose.positionMm) > 0.0)
            pose.positionMm.z() -= 0.005;
        pose.positionMm.z() -= depth;
        poses.push_back(pose);
    }
    return poses;
}

struct Pass {
    std::vector<double> us;     ///< of an update
    std::vector<double> allUs;  ///< from the first cut since the last picture until the meshes are there
    double touched = 0.0, bricks = 0.0, triangles = 0.0;
};

/// One pass over the way with an update every `every` ticks. Cutting is part of what is timed as `allUs`: all that lies
/// between a cut and its triangles, save waiting for the next tick and for the next picture.
Pass follow(const std::shared_ptr<const tooth::ToothModel>& base, const instrument::Bur& bur,
            const std::vector<core::Pose>& poses, std::size_t every) {
    tooth::ToothState field(base);
    cutting::Sweeper sweeper(field, bur, core::simdLevel());
    tooth::ToothMirror mirror(base);
    const surface::MirrorSource source(mirror);
    surface::Surface shown(source, &base->tissues);
    shown.build();
    Pass pass;
    double allUs = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const double cutUs = nowUs();
        sweeper.sweepTo(poses[i]);
        field.handOver(field.waitingBricks(), [&](const tooth::BrickSnapshot& snapshot) {
            mirror.apply(snapshot);
            return true;
        });
        allUs += nowUs() - cutUs;
        if (i % every != every - 1) continue;
        const double begin = nowUs();
        const std::vector<std::uint32_t> touched = mirror.takeTouched();
        const std::vector<std::uint32_t> changed = shown.update(touched);
        pass.us.push_back(nowUs() - begin);
        pass.allUs.push_back(allUs + pass.us.back());
        allUs = 0.0;
        pass.touched += static_cast<double>(touched.size());
        pass.bricks += static_cast<double>(changed.size());
        for (const std::uint32_t dense : changed)
            if (const auto mesh = shown.mesh(dense)) pass.triangles += static_cast<double>(mesh->triangles.size());
    }
    const auto updates = static_cast<double>(pass.us.size());
    pass.touched /= updates;
    pass.bricks /= updates;
    pass.triangles /= updates;
    return pass;
}

void reportTimes(benchmark::State& state, const std::string& prefix, std::vector<double> us) {
    std::sort(us.begin(), us.end());
    state.counters[prefix + "p50_us"] = percentile(us, 0.5);
    state.counters[prefix + "p99_us"] = percentile(us, 0.99);
    state.counters[prefix + "p999_us"] = percentile(us, 0.999);
    state.counters[prefix + "max_us"] = us.back();
}

std::vector<double> bestOf(const std::vector<Pass>& passes, std::vector<double> Pass::*of) {
    std::vector<double> best = passes[0].*of;
    for (const Pass& pass : passes)
        for (std::size_t i = 0; i < best.size(); ++i)
            best[i] = std::min(best[i], (pass.*of)[i]);
    return best;
}

void runCut(benchmark::State& state, int voxelUm, bool deep) {
    const auto base = molar(voxelUm);
    const instrument::Bur bur = instrument::makeBur("330");
    const std::vector<core::Pose> poses = way(base->field, deep, isQuick() ? 85 : 1020);
    std::vector<Pass> single, picture;
    std::vector<double> raw;
    for (int pass = 0; pass < (isQuick() ? 1 : 3); ++pass) {
        single.push_back(follow(base, bur, poses, 1));
        picture.push_back(follow(base, bur, poses, kPictureTicks));
        raw.insert(raw.end(), single.back().us.begin(), single.back().us.end());
    }
    const std::vector<double> best = bestOf(single, &Pass::us), pictures = bestOf(picture, &Pass::us);
    double sum = 0.0;
    for (const double us : best)
        sum += us;
    for (auto _ : state)
        state.SetIterationTime(1e-6 * sum / static_cast<double>(best.size()));
    reportTimes(state, "", best);
    reportTimes(state, "raw_", raw);
    reportTimes(state, "picture_", pictures);
    reportTimes(state, "cut_to_mesh_", bestOf(picture, &Pass::allUs));
    double shares = 0.0;
    for (const double us : pictures)
        shares += us;
    state.counters["a17th_us"] = shares / static_cast<double>(pictures.size() * kPictureTicks);
    state.counters["touched_bricks"] = single[0].touched;
    state.counters["dirty_bricks"] = single[0].bricks;
    state.counters["triangles"] = single[0].triangles;
    state.counters["picture_bricks"] = picture[0].bricks;
}

void runFull(benchmark::State& state, int voxelUm) {
    const auto base = molar(voxelUm);
    const tooth::ToothMirror mirror(base);
    const surface::MirrorSource source(mirror);
    double triangles = 0.0, bricks = 0.0;
    for (auto _ : state) {
        surface::Surface shown(source, &base->tissues);
        const double begin = nowUs();
        shown.build();
        state.SetIterationTime(1e-6 * (nowUs() - begin));
        triangles = bricks = 0.0;
        for (const auto& mesh : shown.meshes()) {
            triangles += static_cast<double>(mesh->triangles.size());
            bricks += 1.0;
        }
    }
    state.counters["triangles"] = triangles;
    state.counters["dirty_bricks"] = bricks;
    const double begin = nowUs();
    const auto whole = surface::closedSurface(source);
    state.counters["closed_ms"] = 1e-3 * (nowUs() - begin);
    state.counters["closed_triangles"] = static_cast<double>(whole.triangles.size());
}

}  // namespace

void registerSurface() {
    for (const int voxelUm : {100, 50, 25}) {
        for (const bool deep : {false, true})
            benchmark::RegisterBenchmark(fmt::format("surface/{}/{}", voxelUm, deep ? "deep" : "shallow").c_str(),
                                         [=](benchmark::State& state) { runCut(state, voxelUm, deep); })
                ->UseManualTime()
                ->Iterations(1)
                ->Unit(benchmark::kMicrosecond);
        benchmark::RegisterBenchmark(fmt::format("surface/{}/full", voxelUm).c_str(),
                                     [=](benchmark::State& state) { runFull(state, voxelUm); })
            ->UseManualTime()
            ->Iterations(isQuick() ? 1 : 5)
            ->Unit(benchmark::kMillisecond);
    }
}

}  // namespace handpiece::bench
