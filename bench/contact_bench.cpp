// SPDX-License-Identifier: Apache-2.0
// contact/<method>/<faces>/<hover|touch>: ours and the peers on the same poses in the same process.
// burs/<bur>/<faces>/<touch|deep>: ours with sharp rims, and with a bur as an STL brings it, each on its own way.
// docs/benchmarks.md says what each counter is. HANDPIECE_BENCH_QUICK=1 makes a smoke test of it.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>

#include "measure.h"
#include "peers/bullet.h"
#include "peers/embree.h"
#include "peers/fcl.h"
#include "peers/libccd.h"
#include "peers/ode.h"
#include "peers/openvdb.h"
#include "workload.h"

namespace handpiece::bench {
namespace {

constexpr int kHoverBatch = 16;
constexpr const char* kBurs[] = {"cylinder-flat:1.0x4.0", "wheel:2.0x0.8", "inverted-cone:1.2x1.2",
                                 "taper-flat:1.2x4.0", "mesh"};

struct MethodEntry {
    std::string name;
    bool isPeer;
    std::function<std::unique_ptr<Query>(Workload&, const Resolution&)> make;
};

std::vector<MethodEntry> methods() {
    const auto field = [](double voxelMm) {
        return [=](Workload& w, const Resolution& r) { return w.fieldQuery(r, voxelMm); };
    };
    return {
        {"exact", false, [](Workload& w, const Resolution& r) { return w.exactQuery(r, kReachMm); }},
        {"field25", false, field(0.025)},
        {"field50", false, field(0.05)},
        {"field100", false, field(0.1)},
        {"fieldonly50", false, [](Workload& w, const Resolution& r) { return w.fieldOnlyQuery(r, 0.05); }},
        {"hull", false, [](Workload& w, const Resolution& r) { return w.hullQuery(r); }},
        {"libccd_all", true, [](Workload& w, const Resolution& r) { return makeLibccd(w.peerInput(r), false); }},
        {"libccd_hull", true, [](Workload& w, const Resolution& r) { return makeLibccd(w.peerInput(r), true); }},
        {"fcl_mesh", true, [](Workload& w, const Resolution& r) { return makeFcl(w.peerInput(r)); }},
        {"bullet_mesh", true, [](Workload& w, const Resolution& r) { return makeBullet(w.peerInput(r)); }},
        {"ode_capsule", true, [](Workload& w, const Resolution& r) { return makeOde(w.peerInput(r)); }},
        {"embree170", true, [](Workload& w, const Resolution& r) { return makeEmbree(w.peerInput(r)); }},
        {"openvdb170", true, [](Workload& w, const Resolution& r) { return makeOpenvdb(w.peerInput(r)); }},
    };
}

class Session {
  public:
    explicit Session(bool quick) : workload_(quick), quick_(quick) {}

    Workload& workload() { return workload_; }
    [[nodiscard]] bool isQuick() const { return quick_; }
    /// The query of the last benchmark is kept: hover and touch share it.
    Query& query(const MethodEntry& method, const Resolution& resolution) {
        const std::string key = method.name + "/" + resolution.name;
        if (key_ != key) {
            query_.reset();
            query_ = method.make(workload_, resolution);
            key_ = key;
        }
        return *query_;
    }
    MeasureSettings settings(bool isPeer, Way way) const {
        MeasureSettings s;
        s.repeats = isPeer ? 3 : 7;
        s.batch = way == Way::hover ? kHoverBatch : 1;
        s.budgetS = quick_ ? 0.1 : isPeer ? 0.8 : 1.5;
        return s;
    }

  private:
    Workload workload_;
    bool quick_;
    std::string key_;
    std::unique_ptr<Query> query_;
};

void report(benchmark::State& state, const Timing& timing, const MeasureSettings& settings) {
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
    put("repeats", settings.repeats);
    put("batch", settings.batch);
}

// "No contact" is right where there is none, whatever the distance; a contact missed is an error of the whole depth.
double errorUm(double told, double depthMm) {
    if (told == kNoContact) return 1e3 * std::max(0.0, depthMm);
    return 1e3 * std::abs(told - depthMm);
}

void reportErrors(benchmark::State& state, Query& query, std::span<const core::Pose> poses,
                  const std::vector<Reference>& references) {
    std::vector<double> errors;
    int untold = 0, falseContacts = 0, apart = 0;
    for (const Reference& reference : references) {
        const double told = query.depthMm(poses[reference.tick]);
        errors.push_back(errorUm(told, reference.depthMm));
        untold += told == kNoContact;
        apart += reference.depthMm < 0.0;
        falseContacts += reference.depthMm < 0.0 && told > 0.0;
    }
    std::sort(errors.begin(), errors.end());
    state.counters["err_med_um"] = percentile(errors, 0.5);
    state.counters["err_p99_um"] = percentile(errors, 0.99);
    state.counters["err_max_um"] = errors.back();
    state.counters["err_ticks"] = static_cast<double>(references.size());
    state.counters["no_number"] = static_cast<double>(untold) / static_cast<double>(references.size());
    state.counters["false_contact"] = apart > 0 ? static_cast<double>(falseContacts) / apart : 0.0;
}

void run(benchmark::State& state, Session& session, const MethodEntry& method, const Resolution& resolution, Way way) {
    const std::span<const core::Pose> poses = session.workload().poses(way);
    const std::vector<Reference>& references = session.workload().references(resolution, way);
    Query& query = session.query(method, resolution);
    const MeasureSettings settings = session.settings(method.isPeer, way);
    const Timing timing = measure(query, poses, settings);
    report(state, timing, settings);
    reportErrors(state, query, poses, references);
    std::string label =
        way == Way::hover && !method.isPeer && method.name != "hull" ? fmt::format("reach {} mm", kReachMm) : "";
    if (timing.ticks + settings.batch <= static_cast<int>(poses.size()))
        label += label.empty() ? "every n-th tick" : ", every n-th tick";
    if (!label.empty()) state.SetLabel(label);
}

void runBur(benchmark::State& state, Session& session, const char* bur, const Resolution& resolution, Way way) {
    const Workload::BurDrag drag = session.workload().drag(bur, resolution, way);
    const MeasureSettings settings = session.settings(false, way);
    report(state, measure(*drag.query, drag.poses, settings), settings);
    reportErrors(state, *drag.query, drag.poses, drag.references);
}

void runConstantLoad(benchmark::State& state, Session& session, double us) {
    ConstantLoad load(us);
    const MeasureSettings settings = session.settings(false, Way::touch);
    const std::vector<core::Pose> poses(4000);
    report(state, measure(load, poses, settings), settings);
}

void registerAll(Session& session) {
    static const std::vector<MethodEntry> all = methods();
    for (const MethodEntry& method : all)
        for (const Resolution& resolution : resolutions())
            for (const Way way : {Way::hover, Way::touch}) {
                const std::string name = fmt::format("contact/{}/{}/{}", method.name, resolution.name,
                                                     way == Way::hover ? "hover" : "touch");
                // One method that fails must not cost the others their figures; tools/bench refuses such a run.
                const auto body = [&, way](benchmark::State& state) {
                    try {
                        run(state, session, method, resolution, way);
                    } catch (const std::exception& error) {
                        state.SkipWithError(error.what());
                    }
                };
                benchmark::RegisterBenchmark(name.c_str(), body)
                    ->Iterations(1)
                    ->UseManualTime()
                    ->Unit(benchmark::kMicrosecond);
            }
    for (const char* bur : kBurs)
        for (const Way way : {Way::touch, Way::deep}) {
            const Resolution& resolution = resolutions()[session.isQuick() ? 0 : 3];
            const std::string name =
                fmt::format("burs/{}/{}/{}", bur, resolution.name, way == Way::touch ? "touch" : "deep");
            benchmark::RegisterBenchmark(
                name.c_str(), [&, bur, way](benchmark::State& state) { runBur(state, session, bur, resolution, way); })
                ->Iterations(1)
                ->UseManualTime()
                ->Unit(benchmark::kMicrosecond);
        }
    for (const int us : {1, 2, 4, 8, 16})
        benchmark::RegisterBenchmark(fmt::format("load/constant/{}", us).c_str(),
                                     [&session, us](benchmark::State& state) { runConstantLoad(state, session, us); })
            ->Iterations(1)
            ->UseManualTime()
            ->Unit(benchmark::kMicrosecond);
}

}  // namespace
}  // namespace handpiece::bench

int main(int argc, char** argv) {
    using namespace handpiece::bench;
    std::unique_ptr<Session> session;
    return runBenchmarks(argc, argv, "contact_bench", [&](bool quick) {
        session = std::make_unique<Session>(quick);
        registerAll(*session);
    });
}
