// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <span>

#include "handpiece/assess/measures/take.h"

namespace handpiece::measures {
namespace {

/// Half-width = fixed + perVoxelMm times the voxel + share times the value + residual times what the surface's
/// unevenness leaves open, in the kind's unit.
struct Row {
    std::string_view kind;
    double fixed, perVoxelMm, share, residual;
};
// From the errors of measures_study's random preparations, checked on another seed (docs/assessment.md, "Uncertainty").
constexpr Row kMeasured[] = {
    {"removed", 0.0, 0.03, 0.00025, 0.0},
    {"removed-share", 0.004, 0.0, 0.0005, 0.0},
    {"floor-depth", 0.0012, 0.0, 0.0, 3.3},
    {"floor-depth-shortest", 0.0012, 0.0, 0.0, 3.6},
    {"floor-flatness", 0.0063, 0.0, 0.0, 5.0},
    {"floor-tilt", 0.01, 0.0, 0.0, 2.8},
    {"isthmus", 0.006, 0.0, 0.0, 4.0},
    {"isthmus-share", 0.27, 0.0, 0.0, 0.0},
    {"wall-height", 0.0045, 0.0, 0.0, 1.0},
    {"wall-angle", 0.001, 0.0, 0.0, 2.0},
    {"undercut-depth", 0.0095, 0.05, 0.0, 0.0},
    {"cavosurface-angle", 0.001, 0.0, 0.0, 2.3},
    {"roughness", 1.25, 0.0, 0.0, 0.0},
    {"marginal-ridge-left", 0.0003, 0.02, 0.0, 0.0},
    {"outline-extent", 0.0, 0.03, 0.0, 0.0},
    {"proximal-clearance", 0.0012, 0.004, 0.0, 0.0},
    {"remaining-dentine", 0.0, 0.065, 0.0, 0.0},
    {"adjacent-depth", 0.0, 0.05, 0.0, 0.0},
    {"occlusal-convergence", 0.002, 0.0, 0.0, 2.5},
    {"margin-width", 0.0006, 0.006, 0.0, 1.4},
    {"margin-height", 0.0, 0.005, 0.0, 1.2},
    {"reduction", 0.0025, 0.0, 0.0, 0.0},
    {"axial-depth", 0.0015, 0.025, 0.0, 0.0},
};
// Bounds that rest on the voxel and on single analytic cases, not on many.
constexpr Row kEstimated[] = {
    {"undercut-area", 0.0, 0.0, 0.2, 0.0},
    {"pulp-exposed", 0.0, 0.0, 0.05, 0.0},
    {"margin-continuity", 1.4, 0.0, 0.0, 0.0},
    {"caries-left", 0.0, 0.0, 0.005, 0.0},
    {"caries-left-periphery", 0.0, 0.0, 0.005, 0.0},
    {"caries-left-pulpal", 0.0, 0.0, 0.005, 0.0},
    {"unsupported-enamel", 0.0, 0.0, 0.15, 0.0},
    {"orifices-reached", 0.0, 0.0, 0.0, 1.0},
    {"gouge-depth", 0.0, 0.7, 0.0, 0.0},
    {"adjacent-removed", 0.0, 0.0, 0.05, 0.0},
};

}  // namespace

double uncertaintyOf(std::string_view kind, double voxelMm, double value, double residual) {
    const auto of = [&](std::span<const Row> rows) -> std::optional<double> {
        for (const Row& row : rows)
            if (row.kind == kind)
                return row.fixed + row.perVoxelMm * voxelMm + row.share * std::abs(value) + row.residual * residual;
        return {};
    };
    if (const auto measured = of(kMeasured)) return *measured;
    return of(kEstimated).value_or(0.0);
}

}  // namespace handpiece::measures
