// SPDX-License-Identifier: Apache-2.0
#include "measure.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "handpiece/base/core/simd.h"

namespace handpiece::bench {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::duration d) {
    return std::chrono::duration<double, std::micro>(d).count();
}

// The compiler must not drop a query whose answer nobody reads.
void keep(double value) {
    asm volatile("" : : "x"(value) : "memory");
}

int chosenCore() {
    if (const char* asked = std::getenv("HANDPIECE_BENCH_CORE")) return std::atoi(asked);
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return -1;
    int last = -1;
    for (int i = 0; i < CPU_SETSIZE; ++i)
        if (CPU_ISSET(i, &allowed)) last = i;
    return last;
}

}  // namespace

PinnedToCore::PinnedToCore() {
    cpu_set_t allowed, one;
    const int core = chosenCore();
    if (core < 0 || core >= CPU_SETSIZE || sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
    CPU_ZERO(&one);
    CPU_SET(static_cast<unsigned>(core), &one);
    if (sched_setaffinity(0, sizeof one, &one) != 0) return;
    before_.resize(sizeof allowed);
    std::memcpy(before_.data(), &allowed, sizeof allowed);
}

PinnedToCore::~PinnedToCore() {
    if (before_.empty()) return;
    cpu_set_t allowed;
    std::memcpy(&allowed, before_.data(), sizeof allowed);
    sched_setaffinity(0, sizeof allowed, &allowed);
}

std::string PinnedToCore::description() {
    const PinnedToCore pin;
    return pin.before_.empty() ? "not pinned" : fmt::format("core {}", chosenCore());
}

double percentile(const std::vector<double>& ascending, double share) {
    if (ascending.empty()) return 0.0;
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(ascending.size())));
    return ascending[std::clamp<std::size_t>(rank, 1, ascending.size()) - 1];
}

Timing measure(Query& query, std::span<const core::Pose> poses, const MeasureSettings& settings) {
    const PinnedToCore pin;
    // How long does it take? A few ticks spread over the way tell how many can be afforded.
    constexpr std::size_t kProbes = 16;
    const auto begin = Clock::now();
    std::size_t probes = 0;
    while (probes < kProbes && (probes < 4 || microseconds(Clock::now() - begin) < 0.1e6 * settings.budgetS))
        keep(query.depthMm(poses[poses.size() * probes++ / kProbes]));
    const double tickUs = microseconds(Clock::now() - begin) / static_cast<double>(probes);
    const double wantedUs = tickUs * static_cast<double>(poses.size()) * settings.repeats;
    const auto stride = static_cast<std::size_t>(std::max(1.0, std::ceil(wantedUs / (settings.budgetS * 1e6))));

    Timing timing;
    const auto batch = static_cast<std::size_t>(settings.batch);
    const std::size_t spans = poses.size() / stride / batch;
    timing.ticks = static_cast<int>(spans * batch);
    timing.bestUs.assign(spans, std::numeric_limits<double>::infinity());
    timing.rawUs.reserve(spans * static_cast<std::size_t>(settings.repeats));
    for (int repeat = 0; repeat < settings.repeats; ++repeat) {
        // One tick before the first: the jump back from the end of the way is not a tick of it.
        keep(query.depthMm(poses[0]));
        for (std::size_t s = 0; s < spans; ++s) {
            const auto start = Clock::now();
            for (std::size_t i = 0; i < batch; ++i)
                keep(query.depthMm(poses[(s * batch + i) * stride]));
            const double us = microseconds(Clock::now() - start) / static_cast<double>(batch);
            timing.rawUs.push_back(us);
            timing.bestUs[s] = std::min(timing.bestUs[s], us);
        }
    }
    std::sort(timing.bestUs.begin(), timing.bestUs.end());
    std::sort(timing.rawUs.begin(), timing.rawUs.end());
    return timing;
}

ConstantLoad::ConstantLoad(double us) : steps_(1000) {
    const PinnedToCore pin;
    double best = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2000; ++i) {
        const auto start = Clock::now();
        keep(depthMm({}));
        best = std::min(best, microseconds(Clock::now() - start));
    }
    steps_ = std::max(1L, std::lround(1000.0 * us / best));
}

double ConstantLoad::depthMm(const core::Pose&) {
    double x = 0.5;
    for (long i = 0; i < steps_; ++i)
        x = 3.7 * x * (1.0 - x);  // each step waits for the last
    return x;
}

namespace {

const char* simdName() {
    switch (core::simdLevel()) {
        case core::SimdLevel::avx512:
            return "AVX-512";
        case core::SimdLevel::avx2:
            return "AVX2";
        case core::SimdLevel::base:
            break;
    }
    return "baseline";
}

}  // namespace

int runBenchmarks(int argc, char** argv, const char* name, const std::function<void(bool quick)>& registerAll) {
    try {
        const bool quick = std::getenv("HANDPIECE_BENCH_QUICK") != nullptr;
        benchmark::Initialize(&argc, argv);
        if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
        benchmark::AddCustomContext("handpiece_simd", simdName());
        benchmark::AddCustomContext("pinned", PinnedToCore::description());
        benchmark::AddCustomContext("scheduler", sched_getscheduler(0) == SCHED_FIFO ? "SCHED_FIFO" : "normal");
        benchmark::AddCustomContext("quick", quick ? "yes" : "no");
        registerAll(quick);
        benchmark::RunSpecifiedBenchmarks();
        benchmark::Shutdown();
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", name, error.what());
        return 1;
    }
}

}  // namespace handpiece::bench
