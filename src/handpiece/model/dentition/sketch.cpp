// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/isosurface.h"
#include "handpiece/model/dentition/tooth_form.h"

namespace handpiece::dentition {

cases::Tooth makeSketch(int fdi, const Patient& patient) {
    constexpr double kSpacingMm = 0.25;
    const ToothForm form(fdi, patient);
    cases::Tooth made;
    made.name = toothName(fdi);
    made.kind = toothKindName(fdi);
    made.fdiNumber = fdi;
    made.buccalSign = form.buccalSign();
    made.parts = {{"enamel", cases::Tissue::enamel, 0, {}}, {"dentine", cases::Tissue::dentine, 0, {}}};
    geometry::IsosurfaceSettings settings;
    settings.spacingMm = kSpacingMm;
    settings.lipschitz = ToothForm::kLipschitz;
    core::parallelFor(made.parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto surface = i == 0 ? &ToothForm::enamel : &ToothForm::dentine;
            made.parts[i].mesh = geometry::isosurface(
                form.bounds(), [&form, surface](const core::Vec3& p) { return (form.*surface)(p); }, settings);
        }
    });
    return made;
}

}  // namespace handpiece::dentition
