// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <mutex>
#include <numeric>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
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
constexpr std::size_t kMaxPartFaces = 120000, kFewestPartFaces = 2000;

Progress between(const Progress& progress, double from, double to) {
    if (!progress) return {};
    return [progress, from, to](double fraction) { return progress(from + fraction * (to - from)); };
}

/// The surface f = 0 as far as it takes to know its area.
TriangleMesh roughOf(const core::Box& box, const geometry::ScalarFunction& f) {
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = ToothShape::kLipschitz;
    settings.spacingMm = 0.35;
    settings.relaxations = 0;
    return geometry::isosurface(box, f, settings);
}

/// The surface f = 0, of this area, with `faces` triangles.
TriangleMesh meshOf(const core::Box& box, const geometry::ScalarFunction& f, double areaMm2, std::size_t faces,
                    const Progress& progress) {
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = ToothShape::kLipschitz;
    settings.relaxations = 2;
    settings.spacingMm =
        std::min(kCoarsestSpacingMm, std::sqrt(kFacesPerCell * areaMm2 / (kOversampling * static_cast<double>(faces))));
    const TriangleMesh fine = geometry::isosurface(box, f, settings, between(progress, 0.0, 0.5));
    return geometry::decimate(fine, faces, between(progress, 0.5, 1.0)).mesh;
}

void checkFaces(std::size_t faces, const char* option) {
    if (faces < kMinFaces || faces > kMaxFaces)
        throw core::Error(fmt::format("{} faces are not possible", faces), option,
                          fmt::format("give a number from {} to {}", kMinFaces, kMaxFaces));
}

/// How far works are that go on side by side, each with its share of the whole.
class Shares {
  public:
    Shares(const Progress& progress, std::vector<double> shares)
        : progress_(progress), shares_(std::move(shares)), done_(shares_.size(), 0.0) {}
    [[nodiscard]] Progress of(std::size_t i) {
        if (!progress_) return {};
        return [this, i](double fraction) {
            const std::lock_guard lock(mutex_);
            done_[i] = shares_[i] * fraction;
            return progress_(std::accumulate(done_.begin(), done_.end(), 0.0));
        };
    }

  private:
    const Progress& progress_;
    const std::vector<double> shares_;
    std::mutex mutex_;
    std::vector<double> done_;
};

cases::Part partOf(const char* name, cases::Tissue tissue, TriangleMesh mesh) {
    return {name, tissue, cases::properties(tissue).priority, std::move(mesh)};
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
    const ToothShape shape(anatomyOf(kind));
    const auto f = [&](const core::Vec3& p) { return shape.outer(p); };
    return meshOf(shape.bounds(), f, geometry::surfaceAreaMm2(roughOf(shape.bounds(), f)), faces, progress);
}

cases::Case makeSketch(ToothKind kind) {
    const ToothShape shape(anatomyOf(kind));
    cases::Case made;
    made.buccalSign = infoOf(kind).buccalSign;
    made.fdiNumber = infoOf(kind).fdiNumber;
    made.parts.resize(2);
    core::parallelFor(3, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (i == 0)
                made.parts[0] = partOf("enamel", cases::Tissue::enamel,
                                       roughOf(shape.bounds(), [&](const core::Vec3& p) { return shape.enamel(p); }));
            if (i == 1)
                made.parts[1] = partOf("dentine", cases::Tissue::dentine,
                                       roughOf(shape.bounds(), [&](const core::Vec3& p) { return shape.dentine(p); }));
            if (i == 2) made.scenery = makeScene(kind, {}, true);
        }
    });
    return made;
}

cases::Case makeTooth(ToothKind kind, const ToothOptions& options, const Progress& progress) {
    checkFaces(options.faces, "--faces");
    if (options.partFaces != 0) checkFaces(options.partFaces, "--part-faces");
    const ToothKindInfo& info = infoOf(kind);
    const ToothShape shape(anatomyOf(kind));
    cases::Case made;
    made.name = fmt::format("{} ({})", info.name, info.fdiNumber);
    made.kind = info.name;
    made.fdiNumber = info.fdiNumber;
    made.buccalSign = info.buccalSign;

    struct Layer {
        const char* name;
        cases::Tissue tissue;
        double (ToothShape::*function)(const core::Vec3&) const;
        double share;  ///< of the work
    };
    static constexpr Layer kLayers[] = {{"", cases::Tissue::none, &ToothShape::outer, 0.3},
                                        {"enamel", cases::Tissue::enamel, &ToothShape::enamel, 0.2},
                                        {"dentine", cases::Tissue::dentine, &ToothShape::dentine, 0.2},
                                        {"pulp", cases::Tissue::pulp, &ToothShape::pulp, 0.05},
                                        {"caries", cases::Tissue::caries, &ToothShape::caries, 0.05}};
    constexpr std::size_t kCount = std::size(kLayers);
    const auto of = [&](std::size_t i) -> geometry::ScalarFunction {
        return [&shape, f = kLayers[i].function](const core::Vec3& p) { return (shape.*f)(p); };
    };
    std::array<double, kCount> areaMm2{};
    core::parallelFor(kCount, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            areaMm2[i] = geometry::surfaceAreaMm2(roughOf(shape.bounds(), of(i)));
    });
    // As fine as the outer surface, where nothing else was asked for.
    const auto facesOf = [&](std::size_t i) {
        if (i == 0) return options.faces;
        if (options.partFaces > 0) return options.partFaces;
        const double density = static_cast<double>(options.faces) / areaMm2[0];
        return std::clamp(static_cast<std::size_t>(std::lround(density * areaMm2[i])), kFewestPartFaces, kMaxPartFaces);
    };
    // Surfaces side by side: each is thinned out by one thread.
    std::array<TriangleMesh, kCount> meshes;
    std::vector<double> shares;
    for (const Layer& layer : kLayers)
        shares.push_back(layer.share);
    shares.push_back(0.2);
    Shares told(progress, shares);
    core::parallelFor(options.scene ? kCount + 1 : kCount, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (i == kCount)
                made.scenery = makeScene(kind, told.of(i));
            else
                meshes[i] = meshOf(shape.bounds(), of(i), areaMm2[i], facesOf(i), told.of(i));
        }
    });
    made.outer = std::move(meshes[0]);
    for (std::size_t i = 1; i < kCount; ++i)
        made.parts.push_back(partOf(kLayers[i].name, kLayers[i].tissue, std::move(meshes[i])));
    core::report(progress, 1.0);
    return made;
}

}  // namespace handpiece::starter
