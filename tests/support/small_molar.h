// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A molar of the product to cut in: enamel above, dentine below. Its own tissues would take longer to make than most
/// tests last. For programs that use starter.

#include <memory>
#include <utility>
#include <vector>

#include "handpiece/model/starter/starter.h"
#include "handpiece/model/tooth/tooth_model.h"

namespace handpiece::test {

inline std::shared_ptr<const tooth::ToothModel> smallMolar(double voxelMm) {
    cases::Case crown;
    crown.name = "molar";
    crown.outer = starter::makeOuter(starter::ToothKind::lowerFirstMolar, 4000);
    tooth::LoadSettings settings;
    settings.useCache = false;
    settings.field.voxelMm = voxelMm;
    auto uncut = tooth::loadModel(crown, settings);
    const double dentineMm = crown.outer.bounds().max.z() - 3.0;
    const std::vector<field::TissueMap::PartFunction> parts{
        {[dentineMm](const core::Vec3& p) { return p.z() - dentineMm; }, cases::Tissue::dentine, 20}};
    auto tissues = field::TissueMap::fromFunctions(uncut->field, parts, cases::Tissue::enamel);
    return tooth::withTissues(*uncut, std::move(tissues));
}

}  // namespace handpiece::test
