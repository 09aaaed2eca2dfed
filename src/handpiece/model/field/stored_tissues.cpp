// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/field/stored_tissues.h"

namespace handpiece::field {
namespace {

constexpr std::uint8_t kMixedTissues = 255;

}  // namespace

StoredTissues StoredTissues::of(const FieldStorage& field) {
    StoredTissues s;
    s.coarseTissue.assign(field.coarse.size(), static_cast<std::uint8_t>(cases::Tissue::none));
    for (std::size_t i = 0; i < field.coarse.size(); ++i) {
        const std::uint8_t* nodes = field.tissues->of(i);
        const bool mixed = field.tissues->isMixed(i);
        if (field.coarse[i] < 0.0f) s.coarseTissue[i] = nodes[kCentreNode];
        if (field.brickIndex[i] < 0) continue;
        s.tissueOfBrick.push_back(mixed ? kMixedTissues : *nodes);
        if (mixed) s.mixedTissues.insert(s.mixedTissues.end(), nodes, nodes + kBrickValues);
    }
    return s;
}

bool StoredTissues::putInto(FieldStorage& field, const TissueSet& known) const {
    if (!known.hasAll(mixedTissues)) return false;
    auto tissues = std::make_shared<BrickTissues>(coarseTissue.size());
    std::size_t mixed = 0;
    for (std::size_t i = 0; i < coarseTissue.size(); ++i) {
        tissues->setUniform(i, coarseTissue[i]);
        if (field.brickIndex[i] < 0) continue;
        const std::uint8_t tissue = tissueOfBrick[static_cast<std::size_t>(field.brickIndex[i])];
        if (tissue != kMixedTissues) {
            if (!known.has(tissue)) return false;
            tissues->setUniform(i, tissue);
        } else {
            if ((mixed + 1) * kBrickValues > mixedTissues.size()) return false;
            tissues->addMixed(i, &mixedTissues[mixed++ * kBrickValues]);
        }
        if (field.coarse[i] < 0.0f && tissues->of(i)[kCentreNode] != coarseTissue[i]) return false;
    }
    field.tissues = std::move(tissues);
    return mixed * kBrickValues == mixedTissues.size();
}

}  // namespace handpiece::field
