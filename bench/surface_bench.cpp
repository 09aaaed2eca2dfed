// SPDX-License-Identifier: Apache-2.0
// surface/<voxel_um>/<shallow|deep|full>: the surface kept up while a round-ended bur of 1 mm is drawn over the starter
// molar, 6 um a tick. Counters p50_us, p99_us, p999_us, max_us are of one update a tick (the best of all passes for
// each tick), raw_* of every tick of every pass, picture_* of one update for the 17 ticks of a picture (60 a second at
// 1 kHz), with a17th of them a tick's share; dirty_bricks and triangles are those re-meshed in a tick. `full` is the
// whole surface at once. HANDPIECE_BENCH_QUICK=1 makes a smoke test of it.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "handpiece/model/starter/starter.h"
#include "handpiece/model/tooth/cut_field.h"
#include "handpiece/senses/surface/closed_surface.h"
#include "handpiece/senses/surface/surface.h"

namespace handpiece::bench {
namespace {

using core::Vec3;
using tooth::kBrickCells, tooth::kBrickNodes;

constexpr double kRadiusMm = 0.5, kLengthMm = 4.0, kStepMm = 0.006;
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

std::shared_ptr<const tooth::CuttableTooth> molar(int voxelUm) {
    static std::map<int, std::shared_ptr<const tooth::CuttableTooth>> all;
    auto& made = all[voxelUm];
    if (made == nullptr) {
        const tooth::Case toothCase = starter::makeTooth(starter::ToothKind::lowerFirstMolar, {68151});
        tooth::PrepareSettings settings;
        settings.field.voxelMm = 1e-3 * voxelUm;
        settings.cacheFolder = HANDPIECE_BENCH_CACHE;
        made = tooth::prepareCutting(toothCase, tooth::prepareTooth(toothCase, settings), settings);
    }
    return made;
}

/// The bur's axis as a segment; the tip's ball is about `from`.
struct BurPose {
    Vec3 from, to;
};

/// Over the crown from mesial to distal and back a little to the side, tilted by 15 degrees; the tip sinks in by
/// 0.05 to 0.5 mm, or by 1.5 mm where `deep`.
std::vector<BurPose> way(const tooth::ToothField& field, bool deep, std::size_t ticks) {
    const Vec3 axis = Vec3(std::sin(M_PI / 12.0), 0.0, std::cos(M_PI / 12.0));
    const double topMm = field.bounds().max.z();
    std::vector<BurPose> poses;
    for (std::size_t i = 0; i < ticks; ++i) {
        const double along = kStepMm * static_cast<double>(i);
        const double x = 3.0 * std::sin(along / 3.0), y = -1.5 + along / 8.0;
        const double depth = deep ? 1.5 : 0.275 + 0.225 * std::sin(2.0 * M_PI * along / 1.5);
        // Down until the ball touches, then in by the depth.
        Vec3 centre(x, y, topMm + kRadiusMm);
        for (int step = 0; step < 2000 && field.distance(centre) > kRadiusMm; ++step)
            centre.z() -= std::max(0.001, field.distance(centre) - kRadiusMm);
        centre.z() -= depth;
        poses.push_back({centre, centre + (kLengthMm - kRadiusMm) * axis});
    }
    return poses;
}

double burDistance(const BurPose& bur, const Vec3& p) {
    const Vec3 along = bur.to - bur.from;
    const double t = std::clamp((p - bur.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (p - bur.from - t * along).norm() - kRadiusMm;
}

/// All that the bur holds is taken away: plain, and not timed.
void cut(tooth::CutField& field, const BurPose& bur) {
    const tooth::FieldView view = field.field().view();
    const auto band = static_cast<float>(field.base().settings.bandMm);
    const double brickMm = kBrickCells * view.voxelMm;
    const Vec3 origin(view.originMm[0], view.originMm[1], view.originMm[2]);
    core::Box box;
    box.extend(bur.from);
    box.extend(bur.to);
    box = box.grown(kRadiusMm + band);
    std::int32_t low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        low[k] = std::max(0, static_cast<std::int32_t>(std::floor((box.min[k] - origin[k]) / brickMm)));
        high[k] =
            std::min(view.bricks[k] - 1, static_cast<std::int32_t>(std::floor((box.max[k] - origin[k]) / brickMm)));
    }
    for (std::int32_t z = low[2]; z <= high[2]; ++z)
        for (std::int32_t y = low[1]; y <= high[1]; ++y)
            for (std::int32_t x = low[0]; x <= high[0]; ++x) {
                const Vec3 corner = origin + brickMm * Vec3(x, y, z);
                if (burDistance(bur, corner + Vec3::Constant(0.5 * brickMm)) > band + brickMm) continue;
                const auto dense = static_cast<std::uint32_t>(x + view.bricks[0] * (y + view.bricks[1] * z));
                const std::int32_t stored = field.storeBrick(dense);
                if (stored < 0) continue;
                float* values = field.values(stored);
                bool changes = false;
                for (int i = 0; i < tooth::kBrickValues; ++i) {
                    const Vec3 node(8 * x + i % kBrickNodes, 8 * y + i / kBrickNodes % kBrickNodes, 8 * z + i / 81);
                    const auto fresh = static_cast<float>(-burDistance(bur, origin + view.voxelMm * node));
                    if (fresh <= values[i]) continue;
                    values[i] = std::min(fresh, static_cast<float>(field.base().bandOutMm));
                    changes = true;
                }
                if (changes) field.noteChanged(dense, true);
            }
}

struct Pass {
    std::vector<double> us;
    double bricks = 0.0, triangles = 0.0;
};

/// One pass over the way with an update every `every` ticks.
Pass follow(const std::shared_ptr<const tooth::CuttableTooth>& base, const std::vector<BurPose>& poses,
            std::size_t every) {
    tooth::CutField field(base);
    tooth::CutMirror mirror(base);
    const surface::MirrorSource source(mirror);
    surface::Surface shown(source, &base->tissues);
    shown.build();
    Pass pass;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        cut(field, poses[i]);
        field.handOver(field.waitingBricks(), [&](const tooth::BrickSnapshot& snapshot) {
            mirror.apply(snapshot);
            return true;
        });
        if (i % every != every - 1) continue;
        const std::vector<std::uint32_t> touched = mirror.takeTouched();
        const double begin = nowUs();
        const std::vector<std::uint32_t> changed = shown.update(touched);
        pass.us.push_back(nowUs() - begin);
        pass.bricks += static_cast<double>(changed.size());
        for (const std::uint32_t dense : changed)
            if (const auto mesh = shown.mesh(dense)) pass.triangles += static_cast<double>(mesh->triangles.size());
    }
    pass.bricks /= static_cast<double>(pass.us.size());
    pass.triangles /= static_cast<double>(pass.us.size());
    return pass;
}

void reportTimes(benchmark::State& state, const std::string& prefix, std::vector<double> us) {
    std::sort(us.begin(), us.end());
    state.counters[prefix + "p50_us"] = percentile(us, 0.5);
    state.counters[prefix + "p99_us"] = percentile(us, 0.99);
    state.counters[prefix + "p999_us"] = percentile(us, 0.999);
    state.counters[prefix + "max_us"] = us.back();
}

std::vector<double> bestOf(const std::vector<Pass>& passes) {
    std::vector<double> best = passes[0].us;
    for (const Pass& pass : passes)
        for (std::size_t i = 0; i < best.size(); ++i)
            best[i] = std::min(best[i], pass.us[i]);
    return best;
}

void runCut(benchmark::State& state, int voxelUm, bool deep) {
    const auto base = molar(voxelUm);
    const std::vector<BurPose> poses = way(base->tooth->field, deep, isQuick() ? 85 : 1020);
    std::vector<Pass> single, picture;
    std::vector<double> raw;
    for (int pass = 0; pass < (isQuick() ? 1 : 3); ++pass) {
        single.push_back(follow(base, poses, 1));
        picture.push_back(follow(base, poses, kPictureTicks));
        raw.insert(raw.end(), single.back().us.begin(), single.back().us.end());
    }
    const std::vector<double> best = bestOf(single), pictures = bestOf(picture);
    double sum = 0.0;
    for (const double us : best)
        sum += us;
    for (auto _ : state)
        state.SetIterationTime(1e-6 * sum / static_cast<double>(best.size()));
    reportTimes(state, "", best);
    reportTimes(state, "raw_", raw);
    reportTimes(state, "picture_", pictures);
    double shares = 0.0;
    for (const double us : pictures)
        shares += us;
    state.counters["a17th_us"] = shares / static_cast<double>(pictures.size() * kPictureTicks);
    state.counters["dirty_bricks"] = single[0].bricks;
    state.counters["triangles"] = single[0].triangles;
    state.counters["picture_bricks"] = picture[0].bricks;
}

void runFull(benchmark::State& state, int voxelUm) {
    const auto base = molar(voxelUm);
    const tooth::CutMirror mirror(base);
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

int mainOf(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
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
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}

}  // namespace
}  // namespace handpiece::bench

int main(int argc, char** argv) {
    try {
        return handpiece::bench::mainOf(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "surface_bench: %s\n", error.what());
        return 1;
    }
}
