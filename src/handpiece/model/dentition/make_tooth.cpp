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
#include "handpiece/base/geometry/fit_creases.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/model/dentition/tooth_body.h"
#include "handpiece/model/dentition/tooth_form.h"

namespace handpiece::dentition {
namespace {
using core::Progress;
using geometry::TriangleMesh;

/// Faces sampled for each face kept, and those that marching cubes puts on a square of one spacing, on average.
constexpr double kOversampling = 1.5, kFacesPerCell = 3.0;
/// Tissues are hidden and mostly smooth: so many faces for one of the outer surface on the same area.
constexpr double kPartDensity = 0.5;
constexpr double kUsualSlope = 1.0;
constexpr std::size_t kMaxPartFaces = 120000, kFewestPartFaces = 2000;

TriangleMesh sampled(const core::Box& box, const geometry::ScalarFunction& f, double spacingMm, int relaxations,
                     const Progress& progress = {}) {
    geometry::IsosurfaceSettings settings;
    settings.lipschitz = ToothForm::kLipschitz;
    settings.usualSlope = kUsualSlope;
    settings.spacingMm = spacingMm;
    settings.relaxations = relaxations;
    settings.project = relaxations > 0;
    settings.keepGradients = true;
    return geometry::isosurface(box, f, settings, progress);
}

void checkFaces(std::size_t faces, const char* option) {
    if (faces < kMinFaces || faces > kMaxFaces)
        throw core::Error(fmt::format("{} faces are not possible", faces), option,
                          fmt::format("give a number from {} to {}", kMinFaces, kMaxFaces));
}

}  // namespace

cases::Tooth makeTooth(int fdi, const Patient& patient, const ToothOptions& options, const Progress& progress) {
    checkFaces(options.faces, "--faces");
    if (options.partFaces != 0) checkFaces(options.partFaces, "--part-faces");
    const ToothForm form(fdi, patient);
    cases::Tooth made;
    made.name = fmt::format("{} ({})", toothName(fdi), fdi);
    made.kind = toothKindName(fdi);
    made.fdiNumber = fdi;
    made.buccalSign = form.buccalSign();

    struct Layer {
        const char* name;
        cases::Tissue tissue;
        double (ToothForm::*function)(const core::Vec3&) const;
        double share;       ///< of the work
        double coarsestMm;  ///< spacing: fissures keep their shape in a coarse mesh too, and thin enamel stays whole
    };
    static constexpr Layer kLayers[] = {{"", cases::Tissue::none, &ToothForm::outer, 0.4, 0.1},
                                        {"enamel", cases::Tissue::enamel, &ToothForm::enamel, 0.3, 0.085},
                                        {"dentine", cases::Tissue::dentine, &ToothForm::dentine, 0.25, 0.13},
                                        {"pulp", cases::Tissue::pulp, &ToothForm::pulp, 0.05, 0.13}};
    constexpr std::size_t kCount = std::size(kLayers);
    std::array<double, kCount> done{};
    std::mutex mutex;
    const auto told = [&](std::size_t i, double from, double to) -> Progress {
        if (!progress) return {};
        return [&, i, from, to](double fraction) {
            const std::lock_guard lock(mutex);
            done[i] = kLayers[i].share * (from + fraction * (to - from));
            return progress(std::accumulate(done.begin(), done.end(), 0.0));
        };
    };
    const auto of = [&](std::size_t i) -> geometry::ScalarFunction {
        return [&form, f = kLayers[i].function](const core::Vec3& p) { return (form.*f)(p); };
    };
    std::array<double, kCount> areaMm2{};
    core::parallelFor(kCount, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            areaMm2[i] = geometry::surfaceAreaMm2(sampled(form.bounds(), of(i), 0.3, 0));
    });
    const auto facesOf = [&](std::size_t i) {
        if (i == 0) return options.faces;
        if (options.partFaces > 0) return options.partFaces;
        const double density = kPartDensity * static_cast<double>(options.faces) / areaMm2[0];
        return std::clamp(static_cast<std::size_t>(std::lround(density * areaMm2[i])), kFewestPartFaces, kMaxPartFaces);
    };
    // Surfaces side by side: each is thinned out by one thread.
    std::array<TriangleMesh, kCount> meshes;
    core::parallelFor(kCount, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t faces = facesOf(i);
            const double spacing =
                std::min(kLayers[i].coarsestMm,
                         std::sqrt(kFacesPerCell * areaMm2[i] / (kOversampling * static_cast<double>(faces))));
            // Where thin edges have come to cross or are pierced, other samples are not.
            constexpr int kTries = 5;
            constexpr double kHoldMm = 0.3;
            bool isSolid = false;
            for (int attempt = 0; attempt < kTries && !isSolid; ++attempt) {
                const double cellMm = spacing * (1.0 - 0.04 * attempt);
                TriangleMesh fine = largestShell(sampled(form.bounds(), of(i), cellMm, 2, told(i, 0.0, 0.5)));
                if (i == 0) geometry::fitCreases(fine, of(i), cellMm);
                meshes[i] = geometry::decimate(fine, faces, told(i, 0.5, 1.0)).mesh;
                const bool isBall = 2 * meshes[i].vertices.size() == meshes[i].triangles.size() + 4;
                isSolid = isBall && geometry::selfIntersections(meshes[i], 1).empty();
                if (isSolid || !isBall || !geometry::selfIntersections(fine, 1).empty()) continue;
                if (auto thinned = geometry::decimateUncrossed(fine, faces, kHoldMm))
                    meshes[i] = *std::move(thinned), isSolid = true;
            }
            if (!isSolid)
                throw core::Error(fmt::format("the surface of tooth {} crosses itself with {} faces", fdi, faces),
                                  "--faces", "ask for more faces, or for another patient");
        }
    });
    made.outer = std::move(meshes[0]);
    for (std::size_t i = 1; i < kCount; ++i)
        made.parts.push_back(
            {kLayers[i].name, kLayers[i].tissue, cases::properties(kLayers[i].tissue).priority, std::move(meshes[i])});
    made.landmarks = form.landmarks();
    core::report(progress, 1.0);
    return made;
}

}  // namespace handpiece::dentition
