// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/starter/scene.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/starter/shape.h"

namespace handpiece::starter {
namespace {

using core::Vec3;
using geometry::TriangleMesh;

constexpr std::size_t kSceneFaces = 24000;
constexpr double kSceneSpacingMm = 0.16, kSketchSpacingMm = 0.5;
constexpr double kContactGapMm = 0.04;     ///< between neighbouring crowns
constexpr double kLigamentMm = 0.25;       ///< width of the periodontal ligament space [R: 0.15 to 0.38 mm]
constexpr double kCrestBelowNeckMm = 1.8;  ///< bone's crest below the cervical line [R: 1 to 2 mm]
constexpr double kGumAboveNeckMm = 0.5;    ///< the gum's margin over the cervical line
/// The gum reaches so far into a tooth: the edge of its socket, which is as jagged as its triangles are large, lies
/// unseen, and its margin is where its own smooth surface meets the tooth.
constexpr double kGumIntoToothMm = 0.15;

/// A whole tooth, moved along x, scaled and perhaps mirrored in x.
struct Placed {
    ToothShape shape;
    double atX, scale;
    bool mirrored;

    [[nodiscard]] double outer(const Vec3& p) const {
        Vec3 q = (p - Vec3(atX, 0.0, 0.0)) / scale;
        if (mirrored) q.x() = -q.x();
        return scale * shape.outer(q);
    }
    [[nodiscard]] core::Box bounds() const {
        const core::Box b = shape.bounds();
        return {scale * b.min + Vec3(atX, 0.0, 0.0), scale * b.max + Vec3(atX, 0.0, 0.0)};
    }
};

/// Half of the crown's mesiodistal width.
double halfWidth(const Anatomy& a) {
    double widest = 0.0;
    for (const Section& s : a.crown.sections)
        widest = std::max(widest, s.halfX + std::abs(s.cx));
    return widest;
}

struct Neighbours {
    ToothKind mesial, distal;
    double mesialScale, distalScale;
    bool mesialMirrored;
};

Neighbours neighboursOf(ToothKind kind) {
    switch (kind) {
        case ToothKind::upperIncisor:  // the other central incisor beyond the midline, the smaller lateral one
            return {ToothKind::upperIncisor, ToothKind::upperIncisor, 1.0, 0.82, true};
        case ToothKind::upperPremolar:  // a canine's place is taken by a premolar: recognisable, not exact
            return {ToothKind::upperPremolar, ToothKind::upperPremolar, 1.04, 0.98, false};
        case ToothKind::lowerFirstMolar:
            break;
    }
    return {ToothKind::upperPremolar, ToothKind::lowerFirstMolar, 0.96, 0.95, false};
}

TriangleMesh meshOf(const core::Box& box, const geometry::ScalarFunction& f, bool isSketch) {
    geometry::IsosurfaceSettings settings;
    settings.spacingMm = isSketch ? kSketchSpacingMm : kSceneSpacingMm;
    settings.lipschitz = ToothShape::kLipschitz;
    if (isSketch) {
        settings.relaxations = 0;
        return geometry::isosurface(box, f, settings);
    }
    const TriangleMesh fine = geometry::isosurface(box, f, settings);
    return geometry::decimate(fine, std::min(kSceneFaces, fine.triangles.size())).mesh;
}

}  // namespace

std::vector<cases::Part> makeScene(ToothKind kind, const core::Progress& progress, bool isSketch) {
    const Anatomy own = anatomyOf(kind);
    const Neighbours n = neighboursOf(kind);
    const Anatomy mesialAnatomy = anatomyOf(n.mesial), distalAnatomy = anatomyOf(n.distal);
    const double reach = halfWidth(own) + kContactGapMm;
    const std::vector<Placed> teeth{
        {ToothShape(own), 0.0, 1.0, false},
        {ToothShape(mesialAnatomy), reach + n.mesialScale * halfWidth(mesialAnatomy), n.mesialScale, n.mesialMirrored},
        {ToothShape(distalAnatomy), -reach - n.distalScale * halfWidth(distalAnatomy), n.distalScale, false}};

    const double fromX = teeth[2].bounds().min.x() + 1.0, toX = teeth[1].bounds().max.x() - 1.0;
    const double midX = 0.5 * (fromX + toX), halfX = 0.5 * (toX - fromX);
    const double halfY = own.neckHalfY + 2.6, floorZ = own.apexZ - 2.5;
    const auto sockets = [&](const Vec3& p, double gap) {
        double deepest = 1e9;
        for (const Placed& t : teeth)
            deepest = std::min(deepest, t.outer(p));
        return gap - deepest;
    };
    // A ridge along x with rounded edges, from the floor up to `topZ`, wider below.
    const auto ridge = [&](const Vec3& p, double topZ, double grow) {
        const double width = halfY + grow + 0.10 * std::max(0.0, topZ - p.z());
        const double sides = smoothMax(std::abs(p.y()) - width, std::abs(p.x() - midX) - halfX, 1.5);
        return smoothMax(smoothMax(sides, p.z() - topZ, 2.2), floorZ - p.z(), 1.0);
    };
    const core::Box box{Vec3(fromX - 1.0, -halfY - 4.5, floorZ - 1.0), Vec3(toX + 1.0, halfY + 4.5, 4.0)};
    // The margin follows the cervical line: low at the sides, up between the teeth (the papillae).
    const auto gumTop = [&](const Vec3& p) {
        const double v = p.y() / own.neckHalfY;
        return kGumAboveNeckMm + 1.1 * (1.0 - std::min(1.0, v * v));
    };
    const auto bone = [&](const Vec3& p) {
        return smoothMax(ridge(p, -kCrestBelowNeckMm, 0.0), sockets(p, kLigamentMm), 0.2);
    };
    const auto gum = [&](const Vec3& p) {
        const double body = smoothMax(ridge(p, gumTop(p), 1.3), -4.0 - kCrestBelowNeckMm - p.z(), 0.5);
        return smoothMax(smoothMax(body, sockets(p, -kGumIntoToothMm), 0.1), 0.05 - ridge(p, -kCrestBelowNeckMm, 0.0),
                         0.1);
    };
    struct Shape {
        const char* name;
        cases::Tissue tissue;
        core::Box box;
        geometry::ScalarFunction function;
    };
    const std::array<Shape, 4> shapes{{{"mesial-neighbour", cases::Tissue::neighbour, teeth[1].bounds(),
                                        [&](const Vec3& p) { return teeth[1].outer(p); }},
                                       {"distal-neighbour", cases::Tissue::neighbour, teeth[2].bounds(),
                                        [&](const Vec3& p) { return teeth[2].outer(p); }},
                                       {"gum", cases::Tissue::gum, box, gum},
                                       {"bone", cases::Tissue::bone, box, bone}}};
    std::vector<cases::Part> parts(shapes.size());
    std::atomic<int> done{0};
    core::parallelFor(shapes.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Shape& s = shapes[i];
            parts[i] = {s.name, s.tissue, cases::properties(s.tissue).priority, meshOf(s.box, s.function, isSketch)};
            core::report(progress, 0.25 * ++done);
        }
    });
    return parts;
}

}  // namespace handpiece::starter
