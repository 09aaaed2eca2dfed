// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/model/case/case.h"

namespace handpiece::cases {
namespace {

std::string place(const core::Vec3& p) {
    return fmt::format("({:.4f}, {:.4f}, {:.4f})", p.x(), p.y(), p.z());
}

std::string counted(std::size_t n, std::string_view one, std::string_view many) {
    return fmt::format("{} {}", n, n == 1 ? one : many);
}

}  // namespace

void requireSolid(const geometry::TriangleMesh& mesh, const std::string& where) {
    constexpr double kSmallestMm = 0.5, kLargestMm = 200.0;  // box diagonals of what a dentist's bur can touch
    const std::string remedy = fmt::format("mend it with: handpiece mesh repair {} OUT", where.empty() ? "IN" : where);
    if (mesh.triangles.empty())
        throw core::Error("the surface has no faces", where, "give a mesh of triangles").as("no-triangles");
    const geometry::MeshReport report = geometry::inspect(mesh);
    const double diagonalMm = report.boxMm.size().norm();
    if (!(diagonalMm >= kSmallestMm && diagonalMm <= kLargestMm))
        throw core::Error(
            fmt::format("the surface is {:.4g} mm across, where {} to {} mm make sense; its unit is probably {}: {}",
                        diagonalMm, kSmallestMm, kLargestMm, geometry::unitName(report.unit.unit), report.unit.reason),
            where, "give --unit, or export it in millimetres")
            .as("wrong-size", {fmt::format("{:.4g}", diagonalMm)});
    if (report.openEdges > 0)
        throw core::Error(fmt::format("the surface is open: {} around {}, the first at {}",
                                      counted(report.openEdges, "open edge", "open edges"),
                                      counted(report.boundaryLoops, "hole", "holes"), place(*report.firstOpenEdgeMm)),
                          where, remedy)
            .as("not-closed", {fmt::format("{}", report.openEdges), fmt::format("{}", report.boundaryLoops),
                               place(*report.firstOpenEdgeMm)});
    if (report.nonManifoldEdges > 0)
        throw core::Error(
            fmt::format("the surface forks: {} of more than two faces, the first at {}",
                        counted(report.nonManifoldEdges, "edge", "edges"), place(*report.firstNonManifoldEdgeMm)),
            where, remedy)
            .as("forks", {fmt::format("{}", report.nonManifoldEdges), place(*report.firstNonManifoldEdgeMm)});
    if (!report.orientable)
        throw core::Error("the surface has only one side (like a Moebius strip)", where, "redraw it").as("one-sided");
    if (report.flippedFaces > 0)
        throw core::Error(fmt::format("{} the other way than {} neighbours, the first at {}",
                                      counted(report.flippedFaces, "face looks", "faces look"),
                                      report.flippedFaces == 1 ? "its" : "their", place(*report.firstFlippedFaceMm)),
                          where, remedy)
            .as("turned-faces", {fmt::format("{}", report.flippedFaces), place(*report.firstFlippedFaceMm)});
    if (report.insideOutShells > 0)
        throw core::Error(fmt::format("{} inside out, the first with a face at {}",
                                      counted(report.insideOutShells, "closed shell is", "closed shells are"),
                                      place(*report.firstFlippedFaceMm)),
                          where, remedy)
            .as("turned-faces", {fmt::format("{}", report.insideOutShells), place(*report.firstFlippedFaceMm)});
    // A sphere has 0.094 of its area to the power of 3/2; what has next to nothing encloses nothing.
    if (!(report.volumeMm3 > 1e-9 * core::pow(report.areaMm2, 1.5)))
        throw core::Error(fmt::format("the surface encloses no volume ({:.3g} mm3)", report.volumeMm3), where,
                          "give a solid")
            .as("no-volume");
    // A vertex where two fans touch is let pass: the sign of a distance is decided by the faces around it all the same.
    const std::vector<geometry::CrossingFaces> crossings = geometry::selfIntersections(mesh);
    if (!crossings.empty())
        throw core::Error(fmt::format("the surface crosses itself: {} of faces, the first at {} (faces {} and {})",
                                      counted(crossings.size(), "pair", "pairs"), place(crossings[0].pointMm),
                                      crossings[0].first + 1, crossings[0].second + 1),
                          where, remedy + ", which replaces small spots; overlapping solids need a mesh editor")
            .as("crosses-itself", {fmt::format("{}", crossings.size()), place(crossings[0].pointMm)});
}

}  // namespace handpiece::cases
