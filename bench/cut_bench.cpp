// SPDX-License-Identifier: Apache-2.0
// cut/<method>/<voxel_um>/<shallow|deep|buried>[/<faces>/<bur>]: query and cut in one tick, ours and the peers on the
// same poses in the same process. Without faces and bur: 68k and the analytic round-ended bur. docs/benchmarks.md says
// what each counter is. HANDPIECE_BENCH_QUICK=1 makes a smoke test of it.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numbers>

#include "handpiece/model/instrument/shapes.h"
#include "handpiece/tick/cutting/cutter.h"
#include "measure.h"
#include "peers/cut_peer.h"
#include "surface_bench.h"
#include "workload.h"

namespace handpiece::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kStepMm = 0.006;  // a tick
constexpr std::size_t kReserveBricks = 40000;

struct BurKind {
    std::string name, made;
    bool fromMesh;  ///< by the envelope of its mesh, as a bur from an STL file is
};
const BurKind kAnalytic{"round", "cylinder-round:1.0x4.0", false}, kPaper{"paper", "paper", true};

enum class Depth { shallow, deep, buried };
constexpr const char* kDepthNames[] = {"shallow", "deep", "buried"};

std::shared_ptr<const instrument::Bur> burOf(const BurKind& kind) {
    static std::map<std::string, std::shared_ptr<const instrument::Bur>> all;
    auto& bur = all[kind.name];
    if (bur) return bur;
    instrument::Bur made = instrument::makeBur(kind.made);
    if (kind.fromMesh) made = instrument::burFromMesh(kind.name, made.mesh());
    return bur = std::make_shared<const instrument::Bur>(std::move(made));
}

/// Shallow: the contact benchmark's way over cusps and fissures, 0.05 to 0.5 mm deep. Deep: 0.8 mm farther in along the
/// bur. Buried: to and fro through the crown with the whole head inside.
std::vector<core::Pose> posesOf(Workload& workload, const instrument::Bur& bur, const field::DistanceField& field,
                                Depth depth, std::size_t count) {
    std::vector<core::Pose> poses;
    if (depth != Depth::buried) {
        const auto way = workload.poses(Way::touch);
        poses.assign(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(std::min(count, way.size())));
        if (depth == Depth::deep)
            for (core::Pose& pose : poses)
                pose.positionMm -= 0.8 * (pose.orientation * core::Vec3::UnitZ());
        return poses;
    }
    const core::Quat tilt(Eigen::AngleAxisd(15.0 * std::numbers::pi / 180.0, core::Vec3::UnitX()));
    const core::Box box = field.bounds();
    core::Vec3 at = box.centre();
    // As high as the whole head is inside all along the middle of the way.
    const auto isInside = [&](double z) {
        for (double x = -1.5; x <= 1.5; x += 0.25)
            for (const double up : {0.0, bur.lengthMm()})
                if (field.distance(core::Vec3(at.x() + x, at.y(), z) + tilt * core::Vec3(0, 0, up)) > -0.7)
                    return false;
        return true;
    };
    at.z() = box.max.z();
    while (at.z() > box.min.z() && !isInside(at.z()))
        at.z() -= 0.05;
    const int perPass = static_cast<int>(3.0 / kStepMm);
    for (std::size_t i = 0; i < count; ++i) {
        const int pass = static_cast<int>(i) / perPass, k = static_cast<int>(i) % perPass;
        const double x = -1.5 + kStepMm * (pass % 2 == 0 ? k : perPass - 1 - k);
        poses.push_back({core::Vec3(at.x() + x, at.y() + 0.25 * pass, at.z()), tilt});
    }
    return poses;
}

/// Ours: contact on the live field, then the cut.
class FieldRun {
  public:
    FieldRun(std::shared_ptr<const tooth::ToothModel> base, std::shared_ptr<const instrument::Bur> bur)
        : field_(std::make_shared<tooth::ToothState>(base)), bur_(bur), method_(contact::makeFieldMethod(field_, bur)) {
        cutting::Cutter::Settings settings;
        settings.fullRemoval = true;
        cutter_ = std::make_unique<cutting::Cutter>(field_, bur_, instrument::CuttingParameters{},
                                                    cases::builtInTissues(), settings);
    }
    double tick(const core::Pose& pose) {
        const auto from = Clock::now();
        const double depth = method_->depth(pose).depthMm;
        queryUs_ = std::chrono::duration<double, std::micro>(Clock::now() - from).count();
        cutting::CutInput input;
        input.proxyInTooth = input.deviceInTooth = pose;
        input.speedRadS = 40000.0;
        changed_ = cutter_->cut(*method_, input).changedBricks;
        return depth;
    }
    /// Between ticks, as the loop hands over after its sending.
    void handOver() {
        while (field_->handOver(256, [](const tooth::BrickSnapshot&) { return true; }) == 256) {
        }
    }
    std::uint32_t changed() const { return changed_; }
    double queryUs() const { return queryUs_; }
    double removedMm3() const {
        double sum = 0.0;
        for (const double v : field_->removedMm3())
            sum += v;
        return sum;
    }
    /// The deepest of the bur's surface points in what the field says is left.
    double leftMm(const core::Pose& pose) const {
        double left = 0.0;
        for (const instrument::SurfaceRing& ring : bur_->rings())
            for (std::uint32_t j = 0; j < ring.count; ++j) {
                const double a = 2.0 * std::numbers::pi * (j + 0.5) / ring.count;
                left = std::max(left, -field_->field().distance(pose.apply(
                                          core::Vec3(ring.rhoMm * std::cos(a), ring.rhoMm * std::sin(a), ring.zMm))));
            }
        return left;
    }

  private:
    std::shared_ptr<tooth::ToothState> field_;
    std::shared_ptr<const instrument::Bur> bur_;
    std::unique_ptr<contact::Method> method_;
    std::unique_ptr<cutting::Cutter> cutter_;
    std::uint32_t changed_ = 0;
    double queryUs_ = 0.0;
};

double microsecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

/// Every pass starts with an uncut tooth, so that a tick does the same work in each.
template <class Start, class Tick, class After>
Timing measureCut(std::span<const core::Pose> poses, int repeats, double budgetS, Start&& start, Tick&& tick,
                  After&& after) {
    const PinnedToCore pin;
    Timing timing;
    timing.bestUs.assign(poses.size(), std::numeric_limits<double>::infinity());
    std::size_t count = poses.size();
    for (int repeat = 0; repeat < repeats; ++repeat) {
        start();
        const auto begin = Clock::now();
        for (std::size_t i = 0; i < count; ++i) {
            const auto from = Clock::now();
            const double depth = tick(poses[i]);
            const double us = microsecondsSince(from);
            asm volatile("" : : "x"(depth) : "memory");
            after(poses[i], i, repeat);
            timing.rawUs.push_back(us);
            timing.bestUs[i] = std::min(timing.bestUs[i], us);
            // What is slower than this is asked at the first ticks only.
            if (repeat == 0 && i >= 3 && microsecondsSince(begin) > 1e6 * budgetS) count = i + 1;
        }
    }
    timing.bestUs.resize(count);
    // The first tick finds all of the bur's hole at once.
    if (timing.bestUs.size() > 1) timing.bestUs.erase(timing.bestUs.begin());
    timing.ticks = static_cast<int>(count);
    std::sort(timing.bestUs.begin(), timing.bestUs.end());
    std::sort(timing.rawUs.begin(), timing.rawUs.end());
    return timing;
}

void report(benchmark::State& state, const Timing& timing, int repeats) {
    for (auto _ : state)
        state.SetIterationTime(1e-6 * percentile(timing.bestUs, 0.5));
    const auto put = [&](const char* name, double value) { state.counters[name] = value; };
    put("p50_us", percentile(timing.bestUs, 0.5));
    put("p99_us", percentile(timing.bestUs, 0.99));
    put("p999_us", percentile(timing.bestUs, 0.999));
    put("max_us", timing.bestUs.back());
    put("raw_p50_us", percentile(timing.rawUs, 0.5));
    put("raw_p99_us", percentile(timing.rawUs, 0.99));
    put("raw_p999_us", percentile(timing.rawUs, 0.999));
    put("raw_max_us", timing.rawUs.back());
    put("ticks", timing.ticks);
    put("repeats", repeats);
}

struct Session {
    Workload workload;
    bool quick;
    std::string key;
    std::shared_ptr<const tooth::ToothModel> base;

    std::shared_ptr<const tooth::ToothModel> cuttable(const Resolution& resolution, double voxelMm) {
        const std::string wanted = fmt::format("{} {}", resolution.name, voxelMm);
        if (key != wanted) {
            base.reset();
            auto uncut = workload.tooth(resolution, voxelMm);
            auto tissues = field::TissueMap::uniform(uncut->field, cases::Tissue::enamel);
            tooth::CutSettings settings;
            settings.reserveBricks = kReserveBricks;
            base = tooth::withTissues(*uncut, std::move(tissues), settings);
            key = wanted;
        }
        return base;
    }
    std::size_t ticks() const { return quick ? 60 : 1500; }
};

void runField(benchmark::State& state, Session& session, const Resolution& resolution, double voxelMm, Depth depth,
              const BurKind& kind) {
    const auto bur = burOf(kind);
    const auto base = session.cuttable(resolution, voxelMm);
    const auto poses = posesOf(session.workload, *bur, base->field, depth, session.ticks());
    const int repeats = session.quick ? 2 : 5;
    std::unique_ptr<FieldRun> run;
    std::vector<double> dirty, query(poses.size(), std::numeric_limits<double>::infinity());
    const Timing timing = measureCut(
        poses, repeats, 60.0,
        [&] {
            run.reset();
            run = std::make_unique<FieldRun>(base, bur);
        },
        [&](const core::Pose& pose) { return run->tick(pose); },
        [&](const core::Pose&, std::size_t tick, int repeat) {
            query[tick] = std::min(query[tick], run->queryUs());
            if (repeat == 0) dirty.push_back(run->changed());
            run->handOver();
        });
    report(state, timing, repeats);
    state.counters["removed_mm3"] = run->removedMm3();
    // What is left is looked at in a pass of its own.
    run = std::make_unique<FieldRun>(base, bur);
    std::vector<double> left;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        run->tick(poses[i]);
        run->handOver();
        if (i % 20 == 0) left.push_back(1e3 * run->leftMm(poses[i]));
    }
    std::sort(left.begin(), left.end());
    std::sort(dirty.begin(), dirty.end());
    std::sort(query.begin(), query.end());
    state.counters["query_p50_us"] = percentile(query, 0.5);
    state.counters["left_depth_um"] = left.back();
    state.counters["left_depth_med_um"] = percentile(left, 0.5);
    state.counters["dirty_bricks"] = percentile(dirty, 0.5);
    state.counters["dirty_bricks_p99"] = percentile(dirty, 0.99);
}

using MakePeer = std::function<std::unique_ptr<CutPeer>(const PeerInput&, const instrument::Bur&, double voxelMm)>;

void runPeer(benchmark::State& state, Session& session, const Resolution& resolution, double voxelMm, Depth depth,
             const BurKind& kind, const MakePeer& make) {
    const auto bur = burOf(kind);
    const auto poses =
        posesOf(session.workload, *bur, session.workload.tooth(resolution, voxelMm)->field, depth, session.ticks());
    PeerInput input = session.workload.peerInput(resolution);
    const PeerInput own{input.tooth, bur->mesh(), bur->maxRadiusMm(), bur->lengthMm()};
    const int repeats = session.quick ? 1 : 2;
    std::unique_ptr<CutPeer> peer;
    double before = 0.0;
    const Timing timing = measureCut(
        poses, repeats, session.quick ? 0.1 : 3.0,
        [&] {
            peer = make(own, *bur, voxelMm);
            before = peer->volumeMm3();
        },
        [&](const core::Pose& pose) { return peer->cutMm(pose); }, [](const core::Pose&, std::size_t, int) {});
    report(state, timing, repeats);
    state.counters["removed_mm3"] = before - peer->volumeMm3();
}

void runConstantLoad(benchmark::State& state, double us, bool quick) {
    ConstantLoad load(us);
    MeasureSettings settings;
    settings.repeats = 5;
    settings.budgetS = quick ? 0.1 : 1.5;
    const std::vector<core::Pose> poses(1500);
    report(state, measure(load, poses, settings), settings.repeats);
}

template <class Body>
void add(const std::string& name, Body body) {
    // One method that fails must not cost the others their figures; tools/bench refuses such a run.
    benchmark::RegisterBenchmark(name.c_str(),
                                 [body](benchmark::State& state) {
                                     try {
                                         body(state);
                                     } catch (const std::exception& error) {
                                         state.SkipWithError(error.what());
                                     }
                                 })
        ->Iterations(1)
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
}

void registerAll(Session& session) {
    const auto resolution = [](std::string_view name) -> const Resolution& {
        for (const Resolution& r : resolutions())
            if (r.name == name) return r;
        std::abort();
    };
    const Resolution &ten = resolution("10k"), &usual = resolution("68k"), &fine = resolution("325k");
    const Depth depths[] = {Depth::shallow, Depth::deep, Depth::buried};
    const auto nameOf = [](const char* method, int um, Depth depth) {
        return fmt::format("cut/{}/{}/{}", method, um, kDepthNames[static_cast<int>(depth)]);
    };
    for (const int um : {100, 50, 25})
        for (const Depth depth : depths)
            add(nameOf("field", um, depth), [&session, &usual, um, depth](benchmark::State& s) {
                runField(s, session, usual, 1e-3 * um, depth, kAnalytic);
            });
    for (const Resolution* r : {&ten, &usual, &fine})
        for (const BurKind* kind : {&kAnalytic, &kPaper})
            for (const int um : {50, 25})
                for (const Depth depth : depths)
                    if (!(r == &usual && kind == &kAnalytic))
                        add(fmt::format("{}/{}/{}", nameOf("field", um, depth), r->name, kind->name),
                            [&session, r, um, depth, kind](benchmark::State& s) {
                                runField(s, session, *r, 1e-3 * um, depth, *kind);
                            });
    const std::pair<const char*, MakePeer> peers[] = {
        {"openvdb_inplace",
         [](const PeerInput& input, const instrument::Bur& bur, double voxelMm) {
             return makeOpenvdbInPlace(input, bur, voxelMm, std::max(0.1, 2.0 * voxelMm), std::max(0.2, 3.0 * voxelMm));
         }},
        {"openvdb_csg",
         [](const PeerInput& input, const instrument::Bur&, double voxelMm) {
             return makeOpenvdbCsg(input, voxelMm, std::max(0.1, 2.0 * voxelMm), std::max(0.2, 3.0 * voxelMm));
         }},
        {"rehull_epa",
         [](const PeerInput& input, const instrument::Bur& bur, double) { return makeRehullEpa(input, bur); }}};
    for (const auto& [name, make] : peers)
        for (const Depth depth : depths) {
            add(nameOf(name, 50, depth), [&session, &usual, depth, make = make](benchmark::State& s) {
                runPeer(s, session, usual, 0.05, depth, kAnalytic, make);
            });
            if (std::string_view(name) != "openvdb_inplace") continue;
            add(nameOf(name, 25, depth), [&session, &usual, depth, make = make](benchmark::State& s) {
                runPeer(s, session, usual, 0.025, depth, kAnalytic, make);
            });
        }
    for (const int us : {4, 16, 64})
        add(fmt::format("load/constant/{}", us),
            [&session, us](benchmark::State& s) { runConstantLoad(s, us, session.quick); });
}

}  // namespace
}  // namespace handpiece::bench

int main(int argc, char** argv) {
    using namespace handpiece::bench;
    std::unique_ptr<Session> session;
    return runBenchmarks(argc, argv, "cut_bench", [&](bool quick) {
        session.reset(new Session{Workload(quick), quick, {}, nullptr});
        registerAll(*session);
        registerSurface();
    });
}
