// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/case_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/points_beyond.h"

namespace handpiece::cases {
namespace {

using core::Vec3;
using geometry::TriangleTree;

constexpr double kUncoveredShare = 0.02;  // of the tooth in no part: more is worth a remark
constexpr int kCoverageSteps = 28;        // along the longest side of the box

std::string place(const Vec3& p) {
    return fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x(), p.y(), p.z());
}

/// A part with its surface's tree; none when the surface is no solid.
struct Checked {
    const Part* part;
    std::shared_ptr<const TriangleTree> tree;
};

/// The vertex with the greatest value.
struct Extreme {
    double valueMm = -std::numeric_limits<double>::infinity();
    Vec3 at = Vec3::Zero();
};

/// Of the vertices for which `sign` times the distance to the tree's surface is above what a case allows, the one where
/// it is most.
Extreme extremeOf(const std::vector<Vec3>& points, const TriangleTree& tree, double sign) {
    Extreme most;
    for (const std::uint32_t i : geometry::pointsBeyond(tree, points, kCaseToleranceMm, sign))
        if (const double value = sign * tree.signedDistance(points[i]); value > most.valueMm) most = {value, points[i]};
    return most;
}

std::shared_ptr<const TriangleTree> solidTree(const geometry::TriangleMesh& mesh, const std::string& name,
                                              std::vector<CaseFinding>& findings) {
    try {
        requireSolid(mesh, name);
        return std::make_shared<const TriangleTree>(mesh);
    } catch (const core::Error& e) {
        findings.push_back({true, name, e.problem(), 0.0, e.remedy()});
        return {};
    }
}

void checkInside(const Checked& part, const TriangleTree& outer, std::vector<CaseFinding>& findings) {
    const Extreme out = extremeOf(part.part->mesh.vertices, outer, 1.0);
    if (out.valueMm <= kCaseToleranceMm) return;
    findings.push_back(
        {true, part.part->name,
         fmt::format("it sticks out of the outer surface by {:.3f} mm at {}", out.valueMm, place(out.at)), out.valueMm,
         "outer must be the whole tooth: the union of its parts"});
}

void checkCrossing(const Checked& a, const Checked& b, std::vector<CaseFinding>& findings) {
    if (a.part->priority != b.part->priority || a.part->tissue == b.part->tissue) return;
    const Extreme ab = extremeOf(a.part->mesh.vertices, *b.tree, -1.0);
    const Extreme ba = extremeOf(b.part->mesh.vertices, *a.tree, -1.0);
    const Extreme& most = ab.valueMm >= ba.valueMm ? ab : ba;
    if (most.valueMm <= kCaseToleranceMm) return;
    findings.push_back({true, a.part->name,
                        fmt::format("it crosses \"{}\" by {:.3f} mm at {}, and both have priority {}", b.part->name,
                                    most.valueMm, place(most.at), a.part->priority),
                        most.valueMm, "give the one that should win a higher priority"});
}

/// Share of the tooth that lies in no part.
double uncoveredShare(const TriangleTree& outer, std::span<const Checked> parts) {
    const Vec3 low = outer.bounds().min, size = outer.bounds().size();
    const double step = size.maxCoeff() / kCoverageSteps;
    int n[3];
    for (int k = 0; k < 3; ++k)
        n[k] = std::max(1, static_cast<int>(std::ceil(size[k] / step)));
    const auto count = static_cast<std::size_t>(n[0]) * n[1] * n[2];
    std::vector<std::uint8_t> found(count, 0);  // 1: in the tooth, 2: in no part either
    core::parallelFor(count, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t x = i % n[0], y = i / n[0] % n[1], z = i / n[0] / n[1];
            const Vec3 p = low + step * Vec3(x + 0.5, y + 0.5, z + 0.5);
            if (outer.signedDistance(p) > -2.0 * kCaseToleranceMm) continue;
            const bool covered = std::any_of(parts.begin(), parts.end(), [&p](const Checked& c) {
                return c.tree && c.tree->signedDistance(p) <= kCaseToleranceMm;
            });
            found[i] = covered ? 1 : 2;
        }
    });
    const auto inside = static_cast<double>(count - std::count(found.begin(), found.end(), 0));
    return inside > 0.0 ? static_cast<double>(std::count(found.begin(), found.end(), 2)) / inside : 0.0;
}

/// Whether the other teeth are solids and stand clear of one another and of the case's own.
void checkOthers(const Case& toothCase, const std::shared_ptr<const TriangleTree>& own,
                 std::vector<CaseFinding>& findings) {
    struct Standing {
        std::string name;
        std::vector<Vec3> points;  ///< of its surface, in the case's frame
        std::shared_ptr<const TriangleTree> tree;
    };
    // Corners alone may all lie outside where triangles are large.
    const auto pointsOf = [](const geometry::TriangleMesh& mesh) {
        std::vector<Vec3> points = mesh.vertices;
        for (const geometry::Triangle& t : mesh.triangles)
            points.push_back((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0);
        return points;
    };
    std::vector<Standing> teeth;
    if (own) teeth.push_back({"the case's own tooth", pointsOf(toothCase.surface()), own});
    for (const PlacedTooth& other : toothCase.others) {
        const std::string name = other.fdiNumber != 0 ? fmt::format("tooth {}", other.fdiNumber) : other.name;
        const geometry::TriangleMesh placed = geometry::transformed(other.surface(), other.inCase);
        teeth.push_back({name, pointsOf(placed), solidTree(placed, name, findings)});
    }
    for (std::size_t i = 0; i < teeth.size(); ++i)
        for (std::size_t j = i + 1; j < teeth.size(); ++j) {
            if (!teeth[i].tree || !teeth[j].tree) continue;
            const core::Box a = teeth[i].tree->bounds(), b = teeth[j].tree->bounds();
            if ((a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any()) continue;
            const Extreme ij = extremeOf(teeth[i].points, *teeth[j].tree, -1.0);
            const Extreme ji = extremeOf(teeth[j].points, *teeth[i].tree, -1.0);
            const Extreme& most = ij.valueMm >= ji.valueMm ? ij : ji;
            if (most.valueMm <= kCaseToleranceMm) continue;
            findings.push_back(
                {true, teeth[i].name,
                 fmt::format("it crosses {} by {:.3f} mm at {}", teeth[j].name, most.valueMm, place(most.at)),
                 most.valueMm, "move one of them (position_mm, orientation)"});
        }
}

}  // namespace

std::vector<CaseFinding> checkCase(const Case& toothCase, const core::Progress& progress) {
    std::vector<CaseFinding> findings;
    core::report(progress, 0.0);
    const bool hasOuter = !toothCase.outer.triangles.empty();
    if (!hasOuter && toothCase.parts.size() != 1)
        findings.push_back(
            {true, "", toothCase.parts.empty() ? "it has no surface at all" : "several parts, but no outer surface",
             0.0, "export the whole tooth as one closed surface and name it as outer"});
    if (toothCase.parts.empty())
        findings.push_back({false, "", "it has no parts: all of it counts as enamel", 0.0, ""});
    std::shared_ptr<const TriangleTree> outer;
    if (hasOuter) outer = solidTree(toothCase.outer, "outer", findings);
    std::vector<Checked> parts;
    bool allSolid = true;
    for (const Part& part : toothCase.parts) {
        // The enamel's part may be the whole tooth itself.
        const bool isOuter =
            outer && part.mesh.triangles == toothCase.outer.triangles && part.mesh.vertices == toothCase.outer.vertices;
        parts.push_back({&part, isOuter ? outer : solidTree(part.mesh, part.name, findings)});
        allSolid = allSolid && parts.back().tree;
        core::report(progress, 0.4 * static_cast<double>(parts.size()) / static_cast<double>(toothCase.parts.size()));
    }
    for (const Part& part : toothCase.scenery)
        if (part.mesh.triangles.empty())
            findings.push_back({true, part.name, "it has no faces", 0.0, "give a mesh of triangles"});
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i].tree) continue;
        if (outer && parts[i].tree != outer) checkInside(parts[i], *outer, findings);
        for (std::size_t j = i + 1; j < parts.size(); ++j)
            if (parts[j].tree) checkCrossing(parts[i], parts[j], findings);
        core::report(progress, 0.4 + 0.4 * static_cast<double>(i + 1) / static_cast<double>(parts.size()));
    }
    if (!toothCase.others.empty())
        checkOthers(toothCase, outer || parts.empty() ? outer : parts.front().tree, findings);
    if (outer && allSolid && !parts.empty())
        if (const double share = uncoveredShare(*outer, parts); share > kUncoveredShare)
            findings.push_back({false, "",
                                fmt::format("{:.1f} % of the tooth lies in no part and takes the nearest part's tissue",
                                            100.0 * share),
                                0.0, ""});
    std::stable_sort(findings.begin(), findings.end(),
                     [](const CaseFinding& a, const CaseFinding& b) { return a.isError && !b.isError; });
    core::report(progress, 1.0);
    return findings;
}

void requireCase(const Case& toothCase) {
    const std::vector<CaseFinding> findings = checkCase(toothCase);
    const auto errors = std::count_if(findings.begin(), findings.end(), [](const auto& f) { return f.isError; });
    if (errors == 0) return;
    const CaseFinding& first = findings.front();
    std::string problem = first.part.empty() ? first.what : fmt::format("part \"{}\": {}", first.part, first.what);
    if (errors > 1) problem += fmt::format("; and {} more", errors - 1);
    throw core::Error(problem, toothCase.source.string(), first.remedy);
}

}  // namespace handpiece::cases
