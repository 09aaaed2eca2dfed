// SPDX-License-Identifier: Apache-2.0
#include "handpiece/app/report/review_around.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace handpiece::report {
namespace {

using core::Vec3;

constexpr double kReachMm = 6.0, kClusterMm = 0.3;

AroundPart coarse(const cases::Part& part, const Vec3& lowMm, const Vec3& highMm, double cellMm) {
    AroundPart made{part.name, part.tissue, {}, {}};
    using Cell = std::array<std::int32_t, 3>;
    struct Sum {
        Vec3 mm = Vec3::Zero();
        double count = 0.0;
        std::uint32_t number = 0;
    };
    // By their cells, in their order: the same from run to run.
    std::map<Cell, Sum> cells;
    const auto cellOf = [&](const Vec3& p) {
        Cell cell{};
        for (Eigen::Index k = 0; k < 3; ++k)
            cell[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(std::floor((p[k] - lowMm[k]) / cellMm));
        return cell;
    };
    const auto isNear = [&](const Vec3& p) {
        return (p.array() >= lowMm.array()).all() && (p.array() <= highMm.array()).all();
    };
    const geometry::TriangleMesh& mesh = part.mesh;
    std::vector<std::array<Cell, 3>> kept;
    std::set<std::uint32_t> counted;
    for (const geometry::Triangle& t : mesh.triangles) {
        if (!std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return isNear(mesh.vertices[v]); })) continue;
        std::array<Cell, 3> at{};
        for (std::size_t k = 0; k < 3; ++k) {
            at[k] = cellOf(mesh.vertices[t[k]]);
            if (!counted.insert(t[k]).second) continue;
            Sum& sum = cells[at[k]];
            sum.mm += mesh.vertices[t[k]];
            sum.count += 1.0;
        }
        if (at[0] != at[1] && at[1] != at[2] && at[0] != at[2]) kept.push_back(at);
    }
    for (auto& [cell, sum] : cells) {
        sum.number = static_cast<std::uint32_t>(made.vertices.size());
        std::array<std::uint16_t, 3> steps{};
        for (Eigen::Index k = 0; k < 3; ++k)
            steps[static_cast<std::size_t>(k)] =
                static_cast<std::uint16_t>(std::clamp((sum.mm[k] / sum.count - lowMm[k]) / Around::kStepMm + 0.5, 0.0,
                                                      double{std::numeric_limits<std::uint16_t>::max()}));
        made.vertices.push_back(steps);
    }
    if (made.vertices.size() > std::numeric_limits<std::uint16_t>::max())
        return coarse(part, lowMm, highMm, 2.0 * cellMm);
    std::set<std::array<std::uint16_t, 3>> triangles;
    for (const std::array<Cell, 3>& at : kept) {
        std::array<std::uint16_t, 3> t{};
        for (std::size_t k = 0; k < 3; ++k)
            t[k] = static_cast<std::uint16_t>(cells.at(at[k]).number);
        // The same one once, whichever corner it begins with.
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        triangles.insert(t);
    }
    made.triangles.assign(triangles.begin(), triangles.end());
    return made;
}

}  // namespace

Around aroundOf(const cases::Case& toothCase, const Vec3& lowMm, const Vec3& highMm) {
    Around around;
    around.lowMm = lowMm - Vec3::Constant(kReachMm);
    for (const cases::Part& part : cases::surroundings(toothCase)) {
        AroundPart made = coarse(part, around.lowMm, highMm + Vec3::Constant(kReachMm), kClusterMm);
        if (!made.triangles.empty()) around.parts.push_back(std::move(made));
    }
    return around;
}

}  // namespace handpiece::report
