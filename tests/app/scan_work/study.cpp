// SPDX-License-Identifier: Apache-2.0
// How far scans of preparations can be trusted: own cut teeth as meshes, alone and in their jaw, moved at random,
// noisy, scored, against the virtual tooth. docs/assessment.md#scans has its table.
#include <fmt/format.h>

#include <cstdlib>
#include <cstring>

#include "app/scan_work/scans.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::scan_work::test {
namespace {

struct Options {
    int count = 2, repeats = 2;
    std::uint64_t seed = 1;
    double noiseMm = 0.03, spacingMm = 0.1;
    std::string kinds = "12VCjkBR";
    std::string toothCase;  ///< instead of a made tooth: its carious tissue taken away
    bool show = false;
};

/// One letter: what was cut, and what the scan shows.
struct Plan {
    char letter;
    Kind kind;
    bool isJaw, isBefore;
    const char* says;
    double fromZ;
};
constexpr Plan kPlans[] = {
    {'1', Kind::classOne, false, false, "class I, crown alone", 0.5},
    {'2', Kind::classTwo, true, false, "class II, in its jaw", -1.0},
    {'V', Kind::classFive, false, false, "class V, crown alone", -1.0},
    {'C', Kind::crown, false, false, "crown, 1.5 mm under the cervix too", -2.5},
    {'j', Kind::classOne, true, false, "class I, in its jaw", -1.0},
    {'k', Kind::crown, true, false, "crown, in its jaw", -1.0},
    {'B', Kind::crown, true, true, "crown, in its jaw, with a scan of before", -1.0},
    {'R', Kind::lesion, false, false, "caries removal in the tooth of a case, crown alone", 0.0},
};

void run(const Options& o) {
    for (const Plan& plan : kPlans) {
        if (o.kinds.find(plan.letter) == std::string::npos || (plan.letter == 'R' && o.toothCase.empty())) continue;
        Tallies tallies;
        std::map<std::string, int> on;
        int scans = 0, refused = 0;
        double lies = 0.0;
        std::mt19937_64 generator(o.seed * 1000 + static_cast<unsigned char>(plan.letter));
        const Bench bench = plan.kind == Kind::lesion ? benchOf(o.toothCase) : benchOf(plan.kind, plan.isJaw);
        for (int i = 0; i < o.count; ++i) {
            const Cut cut = cutBy(bench.task, varied(*bench.task.preparation, generator));
            const assessment::Result truth = assessment::scoreWork(cut.work, bench.task, bench.rubric);
            const TriangleMesh shown =
                plan.isJaw ? jawOf(cut.mesh, bench, plan.fromZ, o.spacingMm) : crownOf(cut.mesh, plan.fromZ);
            std::optional<TriangleMesh> before;
            if (plan.isBefore) before = jawOf(bench.task.toothCase.outer, bench, plan.fromZ, o.spacingMm);
            for (int k = 0; k < o.repeats; ++k) {
                ++scans;
                try {
                    const TriangleMesh mesh = scanned(shown, o.noiseMm, generator);
                    std::optional<TriangleMesh> earlier;
                    if (before) earlier = scanned(*before, o.noiseMm, generator);
                    ScannedTeeth teeth = teethOfScan(mesh, bench.task, "scan", earlier ? &*earlier : nullptr);
                    const score::ScanFit fit = teeth.fit;
                    ++on[std::string(wordsOf(fit.registeredOn))];
                    lies = std::max(lies, fit.liesMm);
                    const assessment::Result result =
                        assessment::scoreWork(assessment::workOfScan(std::move(teeth)), bench.task, bench.rubric);
                    compare(truth, result, tallies);
                    if (o.show) {
                        fmt::print("  scan {}.{}: rms {:.4f} noise {:.4f} lies {:.4f} turns {:.3f} cut {:.1f}\n", i, k,
                                   fit.rmsMm, fit.noiseMm, fit.liesMm, fit.turnsDeg, fit.cutMm2);
                        for (std::size_t c = 0; c < result.assessment.criteria.size(); ++c) {
                            const auto &is = result.assessment.criteria[c], &own = truth.assessment.criteria[c];
                            const std::string at =
                                is.evidence.empty() || !is.evidence.front().placeMm
                                    ? std::string()
                                    : fmt::format("{:.2f} {:.2f} {:.2f}", is.evidence.front().placeMm->x(),
                                                  is.evidence.front().placeMm->y(), is.evidence.front().placeMm->z());
                            if (is.value && own.value)
                                fmt::print(
                                    "    {:<22} {:9.4f} is {:9.4f} error {:8.4f} stated {:.4f} (own {:.4f}) at {}\n",
                                    is.id, *own.value, *is.value, *is.value - *own.value, is.uncertainty,
                                    own.uncertainty, at);
                            else if (!is.value && own.value)
                                fmt::print("    {:<22} {}\n", is.id, is.reason);
                        }
                    }
                } catch (const core::Error& error) {
                    ++refused;
                    fmt::print("  refused: {}\n", error.problem());
                }
                std::fflush(stdout);
            }
        }
        fmt::print("\n{}: {} scans, {} refused; lies to {:.4f} mm at most; ", plan.says, scans, refused, lies);
        for (const auto& [name, times] : on)
            fmt::print("on {}: {} ", name, times);
        fmt::print(
            "\n| measure | within what is stated | error p50 / worst | half-width mean / widest "
            "|\n|---|---|---|---|\n");
        for (auto& [id, t] : tallies) {
            std::sort(t.errors.begin(), t.errors.end());
            fmt::print("| {}, {} | {} of {}{} | {:.3f} / {:.3f} | {:.3f} / {:.3f} |\n", id, t.unit, t.covered,
                       t.count - t.missing, t.missing ? fmt::format(" ({} not measured)", t.missing) : "",
                       t.errors.empty() ? 0.0 : t.errors[t.errors.size() / 2], t.worst,
                       t.errors.empty() ? 0.0 : t.statedSum / static_cast<double>(t.errors.size()), t.stated);
        }
        std::fflush(stdout);
    }
}

}  // namespace
}  // namespace handpiece::scan_work::test

int main(int argc, char** argv) {
    using namespace handpiece::scan_work::test;
    Options o;
    for (int i = 1; i < argc; ++i) {
        const std::string name = argv[i];
        if (name == "--show") {
            o.show = true;
            continue;
        }
        const char* value = i + 1 < argc ? argv[++i] : "";
        if (name == "--count")
            o.count = std::atoi(value);
        else if (name == "--repeats")
            o.repeats = std::atoi(value);
        else if (name == "--seed")
            o.seed = std::strtoull(value, nullptr, 10);
        else if (name == "--noise")
            o.noiseMm = std::atof(value);
        else if (name == "--spacing")
            o.spacingMm = std::atof(value);
        else if (name == "--kinds")
            o.kinds = value;
        else if (name == "--case")
            o.toothCase = value;
        else if (name == "--threads")
            handpiece::core::setThreadCount(static_cast<std::size_t>(std::atoi(value)));
        else {
            std::fputs(
                "scan_study [--count N] [--repeats N] [--seed N] [--noise MM] [--spacing MM] [--kinds 12VCjkBR] "
                "[--case CASE] "
                "[--show] [--threads N]\n",
                stderr);
            return 2;
        }
    }
    run(o);
    return 0;
}
