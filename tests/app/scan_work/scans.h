// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Scans of preparations whose truth is known: one's own cut tooth as a mesh, alone or as a scanner sees it between its
/// neighbours and in its gingiva, moved anywhere, noisy.

#include <map>
#include <random>
#include <string>
#include <vector>

#include "handpiece/app/assessment/scan_work.h"
#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::scan_work::test {

using core::Vec3;
using geometry::TriangleMesh;
using geometry::TriangleTree;

enum class Kind { classOne, classTwo, classFive, crown, lesion };

struct Bench {
    tasks::Task task;  ///< 46 (class V: 33); `neighbours`: with the teeth beside it
    rubric::Rubric rubric;
    TriangleMesh gingiva;  ///< closed; empty without neighbours
};
[[nodiscard]] Bench benchOf(Kind kind, bool neighbours);
/// Caries removal in the tooth of a case.
[[nodiscard]] Bench benchOf(const std::string& toothCase);
/// The task's own numbers, each a little off.
[[nodiscard]] preparation::Recipe varied(const preparation::Recipe& recipe, std::mt19937_64& generator);

/// What was cut, as the product has it and as a mesh of all of it.
struct Cut {
    assessment::Work work;
    TriangleMesh mesh;
};
[[nodiscard]] Cut cutBy(const tasks::Task& task, const preparation::Recipe& recipe);

/// Open below, tooth frame, without noise.
[[nodiscard]] TriangleMesh crownOf(const TriangleMesh& mesh, double fromZ);
/// All that a scanner sees from above around a tooth: one surface of tooth, neighbours and gingiva.
[[nodiscard]] TriangleMesh jawOf(const TriangleMesh& tooth, const Bench& bench, double fromZ, double spacingMm = 0.1);
/// Moved anywhere, every vertex off by noise along each axis.
[[nodiscard]] TriangleMesh scanned(TriangleMesh mesh, double noiseMm, std::mt19937_64& generator);

/// Of one measure over many scans.
struct Tally {
    std::string unit;
    std::size_t count = 0, covered = 0, missing = 0;
    double worst = 0.0, stated = 0.0, statedSum = 0.0;
    std::vector<double> errors;
};
using Tallies = std::map<std::string, Tally>;
/// Errors against the virtual tooth's values; a value that only one of them has is missing.
void compare(const assessment::Result& truth, const assessment::Result& scan, Tallies& tallies);

}  // namespace handpiece::scan_work::test
