// SPDX-License-Identifier: Apache-2.0
#include "studies/made_tooth.h"

namespace handpiece::studies {

cases::Case makeTooth(const ToothRequest& request, const core::Progress& progress) {
    if (request.fdi == 0) return starter::makeTooth(starter::toothKindByName(request.kind), request.options, progress);
    cases::Case made;
    static_cast<cases::Tooth&>(made) = dentition::makeTooth(
        request.fdi, request.patient, {request.options.faces, request.options.partFaces}, progress);
    return made;
}

void replaceLesions(cases::Case& tooth, std::span<const lesion::Lesion> lesions, std::uint64_t seed,
                    const core::Progress& progress) {
    if (lesions.empty()) return;
    std::erase_if(tooth.parts, [](const cases::Part& part) { return cases::isCarious(part.tissue); });
    lesion::addLesions(tooth, lesions, {.seed = seed}, progress);
}

}  // namespace handpiece::studies
