// SPDX-License-Identifier: Apache-2.0
// view/<scene>/<quality>/<WxH>/<faces>: pictures of the starter molar with bur and turbine at 50 um voxels, one after
// the other. Scenes: rest (nothing moves), bur (it moves over the tooth), along (the same, looked at along the bur),
// cut (it cuts; surface and pictures), orbit (the eye moves, in the detail that the quality gives it), full (the eye
// moves, all detail to within half a pixel: every picture is drawn anew) and whole (the same with every triangle).
// Counters: p50_ms, p99_ms, worst_ms of a picture with its reading
// (the best of all passes for each picture), raw_p50_ms and raw_p99_ms of every picture, cpu_p50_ms of all threads
// together (what a busy machine leaves to judge by), mesh_p50_ms of the surface's own work where it cuts,
// fps = 1000 / p50_ms, triangles drawn in a picture.
// HANDPIECE_BENCH_QUICK=1 makes a smoke test of it.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <map>
#include <memory>

#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/model/starter/starter.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "handpiece/senses/surface/surface.h"
#include "handpiece/senses/view/renderer.h"
#include "handpiece/tick/cutting/sweeper.h"
#include "measure.h"

namespace handpiece::bench {
namespace {

using core::Vec3;

constexpr double kVoxelMm = 0.05, kStepMm = 0.006;
constexpr int kPictureTicks = 17;  // of 1 ms, 60 pictures a second

enum class Way { rest, bur, along, cut, orbit, full, whole };
constexpr const char* kWays[] = {"rest", "bur", "along", "cut", "orbit", "full", "whole"};

double nowMs() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::shared_ptr<const tooth::ToothModel> molar(std::size_t faces) {
    static std::map<std::size_t, std::shared_ptr<const tooth::ToothModel>> all;
    auto& made = all[faces];
    if (made == nullptr) {
        const cases::Case toothCase = starter::makeTooth(starter::ToothKind::lowerFirstMolar, {faces});
        tooth::LoadSettings settings;
        settings.field.voxelMm = kVoxelMm;
        settings.cacheFolder = HANDPIECE_BENCH_CACHE;
        made = tooth::loadModel(toothCase, settings);
    }
    return made;
}

/// The tooth as its listeners keep it: cut field, mirror, and surfaces in full and in little detail.
struct Bench {
    Bench(std::shared_ptr<const tooth::ToothModel> uncut, bool coarseToo)
        : withCoarse(coarseToo),
          base(std::move(uncut)),
          field(base),
          mirror(base),
          source(mirror),
          fine(source, &base->tissues),
          coarse(source, &base->tissues) {
        fine.build();
        for (std::uint32_t dense = 0; dense < source.grid().count(); ++dense)
            coarse.setLevel(dense, surface::kMaxLevel);
        coarse.build();
    }
    [[nodiscard]] surface::BrickUpdate brick(std::uint32_t dense) const {
        return {dense, false, fine.mesh(dense), withCoarse ? coarse.mesh(dense) : nullptr, nullptr};
    }
    [[nodiscard]] std::vector<surface::BrickUpdate> all() const {
        std::vector<surface::BrickUpdate> bricks;
        for (std::uint32_t dense = 0; dense < source.grid().count(); ++dense)
            if (surface::BrickUpdate update = brick(dense); update.mesh != nullptr || update.coarse != nullptr)
                bricks.push_back(std::move(update));
        return bricks;
    }
    [[nodiscard]] std::vector<surface::BrickUpdate> news() {
        field.handOver(field.waitingBricks(), [&](const tooth::BrickSnapshot& snapshot) {
            mirror.apply(snapshot);
            return true;
        });
        const std::vector<std::uint32_t> touched = mirror.takeTouched();
        std::vector<std::uint32_t> changed = fine.update(touched);
        const std::vector<std::uint32_t> also = coarse.update(touched);
        changed.insert(changed.end(), also.begin(), also.end());
        std::sort(changed.begin(), changed.end());
        changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
        std::vector<surface::BrickUpdate> bricks;
        for (const std::uint32_t dense : changed)
            bricks.push_back(brick(dense));
        return bricks;
    }

    bool withCoarse;
    std::shared_ptr<const tooth::ToothModel> base;
    tooth::ToothState field;
    tooth::ToothMirror mirror;
    surface::MirrorSource source;
    surface::Surface fine, coarse;
};

/// Over the crown from mesial to distal; sinks in by 0.3 mm where it cuts, hovers 0.5 mm over it where not.
core::Pose poseAt(const field::DistanceField& field, double alongMm, bool cuts) {
    core::Pose pose;
    pose.orientation = core::Quat(Eigen::AngleAxisd(M_PI / 12.0, Vec3::UnitY()));
    pose.positionMm = {3.0 * std::sin(alongMm / 3.0), -1.0 + alongMm / 8.0, field.bounds().max.z()};
    while (pose.positionMm.z() > 0.0 && field.distance(pose.positionMm) > 0.0)
        pose.positionMm.z() -= 0.005;
    pose.positionMm.z() += cuts ? -0.3 : 0.5;
    return pose;
}

struct Pass {
    std::vector<double> drawMs, cpuMs, meshMs;
    std::size_t triangles = 0;
};

Pass follow(const std::shared_ptr<const tooth::ToothModel>& base, Way way, view::Quality quality,
            const view::Viewport& size, int pictures) {
    // Without the coarse meshes an eye in motion has full detail to draw.
    Bench bench(base, way != Way::full && way != Way::whole);
    const core::Box bounds = base->field.bounds();
    const instrument::Bur bur = instrument::makeBur("330");
    view::Renderer renderer;
    renderer.setTooth(bounds);
    renderer.updateBricks(bench.all(), true);
    renderer.setBur(bur.mesh(), bur.lengthMm(), bur.maxRadiusMm());
    renderer.setTurbine(instrument::turbineMesh());
    core::Box crown = bounds;
    crown.min.z() = crown.max.z() - 9.0;
    view::Camera camera = view::standardView(
        way == Way::along ? view::StandardView::occlusal : view::StandardView::oblique, crown, -1, size);
    view::Look look;
    look.quality = quality;
    view::Moment moment;
    moment.speedRpm = 300000.0;
    moment.burInTooth = poseAt(base->field, 0.0, way == Way::cut);
    view::Image picture;
    cutting::Sweeper sweeper(bench.field, bur, core::simdLevel());
    // As in a window, which at rest gets ready for an eye in motion.
    renderer.setResponsive(way == Way::full || way == Way::cut);
    view::FrameReport before;
    for (int i = 0; i < 4 || before.refining || before.preparing; ++i)
        before = renderer.draw(camera, size, look, moment, picture);
    Pass pass;
    for (int i = 0; i < pictures; ++i) {
        moment.timeS += 1.0 / 60.0;
        const double alongMm = kStepMm * kPictureTicks * i;
        if (way == Way::bur || way == Way::along) moment.burInTooth = poseAt(base->field, 3.0 * alongMm, false);
        double uploadMs = 0.0;
        std::clock_t cpu = std::clock();
        if (way == Way::cut) {
            for (int tick = 0; tick < kPictureTicks; ++tick)
                (void)sweeper.sweepTo(moment.burInTooth = poseAt(base->field, alongMm + kStepMm * tick, true));
            moment.removalMm3S = 0.5;
            moment.tissue = cases::Tissue::enamel;
            moment.water = true;
            const double begin = nowMs();
            const std::vector<surface::BrickUpdate> news = bench.news();
            const double upload = nowMs();
            cpu = std::clock();
            pass.meshMs.push_back(upload - begin);
            renderer.updateBricks(news);
            uploadMs = nowMs() - upload;
        }
        if (way == Way::orbit || way == Way::full || way == Way::whole) camera = view::orbited(camera, 0.02, 0.004);
        const view::FrameReport report = renderer.draw(camera, size, look, moment, picture);
        pass.drawMs.push_back(uploadMs + report.drawMs + report.readMs);
        pass.cpuMs.push_back(1e3 * static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC);
        pass.triangles += report.triangles;
    }
    pass.triangles /= static_cast<std::size_t>(pictures);
    return pass;
}

std::vector<double> bestOf(const std::vector<Pass>& passes, std::vector<double> Pass::*of) {
    std::vector<double> best = passes[0].*of;
    for (const Pass& pass : passes)
        for (std::size_t i = 0; i < best.size(); ++i)
            best[i] = std::min(best[i], (pass.*of)[i]);
    std::sort(best.begin(), best.end());
    return best;
}

void run(benchmark::State& state, Way way, view::Quality quality, const view::Viewport& size, std::size_t faces,
         bool quick) {
    const auto base = molar(faces);
    std::vector<Pass> passes;
    std::vector<double> raw;
    for (int i = 0; i < (quick ? 1 : 3); ++i) {
        passes.push_back(follow(base, way, quality, size, quick ? 3 : 60));
        raw.insert(raw.end(), passes.back().drawMs.begin(), passes.back().drawMs.end());
    }
    std::sort(raw.begin(), raw.end());
    const std::vector<double> best = bestOf(passes, &Pass::drawMs);
    double sum = 0.0;
    for (const double ms : best)
        sum += ms;
    for (auto _ : state)
        state.SetIterationTime(1e-3 * sum / static_cast<double>(best.size()));
    state.counters["p50_ms"] = percentile(best, 0.5);
    state.counters["p99_ms"] = percentile(best, 0.99);
    state.counters["worst_ms"] = best.back();
    state.counters["raw_p50_ms"] = percentile(raw, 0.5);
    state.counters["raw_p99_ms"] = percentile(raw, 0.99);
    state.counters["fps"] = 1000.0 / std::max(1e-3, percentile(best, 0.5));
    state.counters["cpu_p50_ms"] = percentile(bestOf(passes, &Pass::cpuMs), 0.5);
    state.counters["triangles"] = static_cast<double>(passes[0].triangles);
    if (way == Way::cut) state.counters["mesh_p50_ms"] = percentile(bestOf(passes, &Pass::meshMs), 0.5);
}

void registerAll(bool quick) {
    struct Faces {
        const char* name;
        std::size_t count;
    };
    struct Named {
        const char* name;
        view::Quality quality;
    };
    for (const Faces& faces : {Faces{"10k", 10000}, Faces{"68k", 68151}, Faces{"325k", 325000}})
        for (const view::Viewport& size : {view::Viewport{1280, 800}, view::Viewport{1920, 1080}})
            for (const Named& named : {Named{"fast", view::Quality::fast}, Named{"fine", view::Quality::fine},
                                       Named{"rich", view::Quality::rich}})
                for (const Way way : {Way::rest, Way::bur, Way::along, Way::cut, Way::orbit, Way::full, Way::whole})
                    benchmark::RegisterBenchmark(
                        fmt::format("view/{}/{}/{}x{}/{}", kWays[static_cast<int>(way)], named.name, size.width,
                                    size.height, faces.name)
                            .c_str(),
                        [=](benchmark::State& state) { run(state, way, named.quality, size, faces.count, quick); })
                        ->UseManualTime()
                        ->Iterations(1)
                        ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace handpiece::bench

int main(int argc, char** argv) {
    return handpiece::bench::runBenchmarks(argc, argv, "view_bench", handpiece::bench::registerAll);
}
