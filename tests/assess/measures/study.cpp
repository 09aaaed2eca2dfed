// SPDX-License-Identifier: Apache-2.0
// How far the measures of a tooth can be trusted: random preparations of which everything is known, measured and judged
// by the shipped rubrics; and errors put in one at a time, found or not. docs/assessment.md has its tables.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>

#include "assess/measures/trials.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/assess/score/score.h"
#include "handpiece/base/core/parallel.h"

namespace handpiece::measures::test {
namespace {

struct Options {
    double voxelMm = 0.1;
    int count = 20, each = 10;
    std::uint64_t seed = 1;
    bool faults = false, show = false;
    std::string kinds = "123CVM";
};

constexpr const char* kLetters = "123VCM";  // in the order of Kind

struct Borderline {
    int preparations = 0, criteria = 0, judged = 0, any = 0, passed = 0;
};

/// What a rubric asks of the tooth, zones apart.
std::vector<Request> askedBy(const rubric::Rubric& rubric) {
    std::vector<Request> requests;
    for (const rubric::Criterion& criterion : rubric.criteria)
        if (findMeasureKind(criterion.measure)->subject == Subject::tooth && criterion.of.zone.empty())
            requests.push_back({criterion.measure, criterion.of});
    return requests;
}

void judgeBy(const rubric::Rubric& rubric, std::span<const Measured> measured, Borderline& borderline) {
    const score::Assessment result = score::evaluate(rubric, measured, {"pointer", 1.0});
    ++borderline.preparations;
    int here = 0;
    for (const score::CriterionScore& s : result.criteria) {
        if (s.standing != score::Standing::judged || (s.possibleBands.empty() && s.critical == score::Verdict::no))
            continue;
        ++borderline.judged;
        here += s.borderline ? 1 : 0;
    }
    borderline.criteria += here;
    borderline.any += here > 0 ? 1 : 0;
    borderline.passed += result.borderline ? 1 : 0;
}

void showUncovered(const Trial& trial, const std::vector<Measured>& got, int number) {
    for (std::size_t i = 0; i < trial.truths.size(); ++i)
        if (const Truth& truth = trial.truths[i];
            !got[i].value || std::abs(*got[i].value - truth.value) > got[i].uncertainty) {
            const Vec3 place = got[i].evidence.empty() ? Vec3(Vec3::Zero())
                                                       : trial.body.inGrid.applyInverse(*got[i].evidence[0].placeMm);
            std::printf("  %s %d: %s %s is %.4f, not %.4f, +-%.4f at %.3f %.3f %.3f %s\n",
                        kKindNames[static_cast<int>(trial.kind)], number, truth.row.c_str(),
                        truth.request.of.side.c_str(), got[i].value.value_or(0.0), truth.value, got[i].uncertainty,
                        place.x(), place.y(), place.z(), got[i].reason.c_str());
        }
}

void accuracy(const Options& o) {
    std::mt19937_64 random(o.seed);
    Table table;
    std::map<std::string, Borderline> borderline;
    std::map<std::string, std::size_t> missing;
    for (int k = 0; k < 6; ++k) {
        if (o.kinds.find(kLetters[k]) == std::string::npos) continue;
        for (int done = 0; done < o.count;) {
            Lab lab(o.voxelMm, random);
            for (int i = 0; i < o.each && done < o.count; ++i, ++done) {
                // Volumes take longest to integrate: of some.
                const Trial trial = lab.make(static_cast<Kind>(k), done % 4 == 0);
                const rubric::Rubric rubric = rubric::shippedRubric(trial.rubric());
                const std::vector<Measured> got = trial.judge(table, askedBy(rubric));
                if (o.show) showUncovered(trial, got, done);
                judgeBy(rubric, std::span(got).subspan(trial.truths.size()), borderline[trial.rubric()]);
            }
        }
    }
    print(table);
    for (const auto& [name, errors] : table)
        for (const std::string& why : errors.missing)
            ++missing[name + ": " + why];
    for (const auto& [why, count] : missing)
        std::printf("  no value, %zu times: %s\n", count, why.c_str());
    std::printf("\n  %-18s %5s %10s %22s %20s\n", "rubric", "n", "pass open", "a criterion borderline",
                "criteria borderline");
    for (const auto& [name, b] : borderline)
        std::printf("  %-18s %5d %8.1f %% %20.1f %% %18.1f %%\n", name.c_str(), b.preparations,
                    100.0 * b.passed / b.preparations, 100.0 * b.any / b.preparations,
                    100.0 * b.criteria / std::max(1, b.judged));
}

void faults(const Options& o) {
    std::mt19937_64 random(o.seed);
    int made[kFaults] = {}, found[kFaults][kFaults] = {}, open[kFaults] = {}, falsely = 0, all = 0;
    for (int done = 0; done < o.count;) {
        Lab lab(o.voxelMm, random);
        for (int i = 0; i < o.each && done < o.count; ++i, ++done) {
            const Kind kind = done % 2 == 0 ? Kind::classOne : Kind::classTwo;
            for (int f = 0; f < kFaults; ++f) {
                const Trial trial = lab.makeRight(kind, static_cast<Fault>(f));
                const auto seen = findings(trial);
                ++made[f];
                ++all;
                bool isFalse = false;
                for (int g = 1; g < kFaults; ++g) {
                    const Finding& finding = seen[static_cast<std::size_t>(g)];
                    found[f][g] += finding.isFound ? 1 : 0;
                    open[g] += finding.isBorderline ? 1 : 0;
                    isFalse = isFalse || (g != f && finding.isFound);
                    if (o.show && finding.isFound != (g == f))
                        std::printf("  %s %d, %s put in: %s %s\n", kKindNames[static_cast<int>(kind)], done,
                                    kFaultNames[f], kFaultNames[g], finding.said.c_str());
                }
                falsely += isFalse ? 1 : 0;
            }
        }
    }
    std::printf("  %-22s %6s %12s %12s %11s\n", "error", "made", "sensitivity", "specificity", "borderline");
    for (int g = 1; g < kFaults; ++g) {
        int others = 0, alarms = 0;
        for (int f = 0; f < kFaults; ++f)
            if (f != g) others += made[f], alarms += found[f][g];
        std::printf("  %-22s %6d %12.4f %12.4f %9.2f %%\n", kFaultNames[g], made[g],
                    static_cast<double>(found[g][g]) / std::max(1, made[g]),
                    1.0 - static_cast<double>(alarms) / std::max(1, others), 100.0 * open[g] / std::max(1, all));
    }
    std::printf("  of %d preparations %d have something found that was not put in\n", all, falsely);
    std::printf("  found, by what was put in:\n");
    for (int f = 0; f < kFaults; ++f) {
        std::printf("  %-22s", kFaultNames[f]);
        for (int g = 1; g < kFaults; ++g)
            std::printf(" %5d", found[f][g]);
        std::printf("\n");
    }
}

int usage() {
    std::fprintf(stderr,
                 "measures_study [--faults] [--show] [--count N] [--each N] [--voxel MM] [--seed N] [--kinds 123VCM] "
                 "[--threads N]\n"
                 "  count: preparations of each kind; each: of them in one turned grid\n"
                 "  show: what is not covered, one by one; kinds: 1, 2, 3, V classes, C crown, M class I in a molar\n");
    return 2;
}

}  // namespace
}  // namespace handpiece::measures::test

int main(int argc, char** argv) {
    using namespace handpiece::measures::test;
    Options o;
    for (int i = 1; i < argc; ++i) {
        const std::string name = argv[i];
        if (name == "--faults" || name == "--show") {
            (name == "--show" ? o.show : o.faults) = true;
            continue;
        }
        if (i + 1 >= argc) return usage();
        const char* value = argv[++i];
        if (name == "--count")
            o.count = std::atoi(value);
        else if (name == "--each")
            o.each = std::atoi(value);
        else if (name == "--voxel")
            o.voxelMm = std::atof(value);
        else if (name == "--seed")
            o.seed = std::strtoull(value, nullptr, 10);
        else if (name == "--kinds")
            o.kinds = value;
        else if (name == "--threads")
            handpiece::core::setThreadCount(static_cast<std::size_t>(std::atoi(value)));
        else
            return usage();
    }
    if (o.count < 1 || o.each < 1 || !(o.voxelMm >= 0.02 && o.voxelMm <= 0.2)) return usage();
    std::printf("%s: voxel %g mm, %d of each kind, %d in a turned grid, seed %llu\n",
                o.faults ? "errors put in" : "errors of the measures", o.voxelMm, o.count, o.each,
                static_cast<unsigned long long>(o.seed));
    o.faults ? faults(o) : accuracy(o);
    return 0;
}
