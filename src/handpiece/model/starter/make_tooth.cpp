// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/error.h"
#include "handpiece/base/geometry/decimate.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/starter/scene.h"
#include "handpiece/model/starter/shape.h"
#include "handpiece/model/starter/starter.h"

namespace handpiece::starter {
namespace {
using core::Progress;
using geometry::TriangleMesh;

/// Finer than this is always sampled, so that a fissure of 0.15 mm keeps its shape in a coarse mesh too.
constexpr double kCoarsestSpacingMm = 0.085;
/// Faces sampled for each face kept.
constexpr double kOversampling = 1.5;
/// Triangles that marching cubes puts on a square of one spacing, on average over directions.
constexpr double kFacesPerCell = 3.0;
constexpr std::size_t kMostPartFaces = 120000, kFewestPartFaces = 2000;

Progress between(const Progress& progress, double from, double to) {
    if (!progress) return {};
    return [progress, from, to](double fraction) { return progress(from + fraction * (to - from)); };
}

struct Surface {
    TriangleMesh mesh;
    double areaMm2 = 0.0;
};

/// The surface f = 0 with `faces` triangles, or with `facesPerMm2` where that is given.
Surface meshOf(const core::Box& box, const geometry::ScalarFunction& f, double lipschitz, std::size_t faces,
               double facesPerMm2, const Progress& progress) {
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = lipschitz;
    settings.spacingMm = 0.35;
    settings.relaxations = 0;
    Surface out;
    out.areaMm2 = geometry::surfaceAreaMm2(geometry::isosurface(box, f, settings));
    if (facesPerMm2 > 0.0)
        faces = std::clamp(static_cast<std::size_t>(std::lround(facesPerMm2 * out.areaMm2)), kFewestPartFaces,
                           kMostPartFaces);
    settings.relaxations = 2;
    settings.spacingMm = std::min(
        kCoarsestSpacingMm, std::sqrt(kFacesPerCell * out.areaMm2 / (kOversampling * static_cast<double>(faces))));
    TriangleMesh fine = geometry::isosurface(box, f, settings, between(progress, 0.0, 0.5));
    out.mesh = geometry::decimate(fine, faces, between(progress, 0.5, 1.0)).mesh;
    return out;
}

void checkFaces(std::size_t faces, const char* option) {
    if (faces < kMinFaces || faces > kMaxFaces)
        throw core::Error(fmt::format("{} faces are not possible", faces), option,
                          fmt::format("give a number from {} to {}", kMinFaces, kMaxFaces));
}

Surface outerOf(const ToothShape& shape, std::size_t faces, const Progress& progress) {
    return meshOf(
        shape.bounds(), [&](const core::Vec3& p) { return shape.outer(p); }, ToothShape::kLipschitz, faces, 0.0,
        progress);
}

tooth::Part partOf(const char* name, tooth::Tissue tissue, TriangleMesh mesh) {
    return {name, tissue, tooth::properties(tissue).priority, std::move(mesh)};
}

}  // namespace

Anatomy anatomyOf(ToothKind kind) {
    switch (kind) {
        case ToothKind::upperIncisor:
            return upperIncisorAnatomy();
        case ToothKind::upperPremolar:
            return upperPremolarAnatomy();
        case ToothKind::lowerFirstMolar:
            break;
    }
    return lowerFirstMolarAnatomy();
}

const std::vector<ToothKindInfo>& toothKinds() {
    // Buccal: for a lower right tooth (46) +x mesial is forwards and +z up, so +y is lingual. For an upper right tooth
    // +z is down: +y of the premolar (14) is buccal, and of the incisor (11, mesial to the left) labial.
    static const std::vector<ToothKindInfo> kinds = {
        {ToothKind::lowerFirstMolar, "lower-first-molar", 46, -1,
         "five cusps, crossing fissures, two roots, a lesion in the central fissure"},
        {ToothKind::upperIncisor, "upper-incisor", 11, +1,
         "a central incisor with one root, a lesion on its mesial side"},
        {ToothKind::upperPremolar, "upper-premolar", 14, +1,
         "a first premolar with two cusps and two roots, a lesion in its fissure"}};
    return kinds;
}

const ToothKindInfo& infoOf(ToothKind kind) {
    for (const ToothKindInfo& info : toothKinds())
        if (info.kind == kind) return info;
    throw core::Error("this kind of tooth is not known", "starter");
}

ToothKind toothKindByName(std::string_view name) {
    std::string known;
    for (const ToothKindInfo& info : toothKinds()) {
        if (info.name == name) return info.kind;
        known += known.empty() ? "" : ", ";
        known += info.name;
    }
    throw core::Error(fmt::format("there is no tooth called \"{}\"", name), "--kind", "choose one of " + known);
}

TriangleMesh makeOuter(ToothKind kind, std::size_t faces, const Progress& progress) {
    checkFaces(faces, "--faces");
    return outerOf(ToothShape(anatomyOf(kind)), faces, progress).mesh;
}

tooth::Case makeTooth(ToothKind kind, const ToothOptions& options, const Progress& progress) {
    checkFaces(options.faces, "--faces");
    if (options.partFaces != 0) checkFaces(options.partFaces, "--part-faces");
    const ToothKindInfo& info = infoOf(kind);
    const ToothShape shape(anatomyOf(kind));
    tooth::Case made;
    made.name = fmt::format("{} ({})", info.name, info.fdiNumber);
    made.kind = info.name;
    made.fdiNumber = info.fdiNumber;
    made.buccalSign = info.buccalSign;
    Surface outer = outerOf(shape, options.faces, between(progress, 0.0, 0.4));
    made.outer = std::move(outer.mesh);
    const double density = options.partFaces > 0 ? 0.0 : static_cast<double>(options.faces) / outer.areaMm2;

    struct Tissue {
        const char* name;
        tooth::Tissue tissue;
        double (ToothShape::*function)(const core::Vec3&) const;
    };
    static constexpr Tissue kTissues[] = {{"enamel", tooth::Tissue::enamel, &ToothShape::enamel},
                                          {"dentine", tooth::Tissue::dentine, &ToothShape::dentine},
                                          {"pulp", tooth::Tissue::pulp, &ToothShape::pulp},
                                          {"caries", tooth::Tissue::caries, &ToothShape::caries}};
    double done = 0.4;
    const double last = options.scene ? 0.8 : 1.0;
    for (const Tissue& tissue : kTissues) {
        const double step = (last - 0.4) / 4.0;
        const auto f = [&](const core::Vec3& p) { return (shape.*tissue.function)(p); };
        made.parts.push_back(partOf(tissue.name, tissue.tissue,
                                    meshOf(shape.bounds(), f, ToothShape::kLipschitz, options.partFaces, density,
                                           between(progress, done, done + step))
                                        .mesh));
        done += step;
    }
    if (options.scene) made.scenery = makeScene(kind, between(progress, last, 1.0));
    core::report(progress, 1.0);
    return made;
}

}  // namespace handpiece::starter
