// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/scan_colours.h"

#include <algorithm>

namespace handpiece::surface {
namespace {

/// What a tooth had when it was scanned.
bool isSound(cases::Tissue tissue) {
    return tissue == cases::Tissue::none || tissue == cases::Tissue::enamel || tissue == cases::Tissue::dentine ||
           tissue == cases::Tissue::cementum;
}

}  // namespace

double nearScanMm(const tooth::ToothModel& model, int level) {
    constexpr double kLeastMm = 0.02, kOfACell = 0.5;
    return std::max(kLeastMm, kOfACell * model.field.settings().voxelMm) * (1.0 + level);
}

std::shared_ptr<const std::vector<ScanColour>> scanColours(const tooth::ToothModel& model, const BrickMesh* mesh) {
    if (model.colours.empty() || mesh == nullptr) return nullptr;
    const double nearMm = nearScanMm(model, mesh->level);
    auto colours = std::make_shared<std::vector<ScanColour>>(mesh->vertices.size(), ScanColour{0, 0, 0, 0});
    std::uint32_t seed = geometry::kNoTriangle;  // the next vertex lies beside this one
    for (std::size_t v = 0; v < mesh->vertices.size(); ++v) {
        const SurfaceVertex& vertex = mesh->vertices[v];
        if (!isSound(vertex.tissue)) continue;
        const core::Vec3 p(static_cast<double>(vertex.positionMm[0]), static_cast<double>(vertex.positionMm[1]),
                           static_cast<double>(vertex.positionMm[2]));
        const geometry::NearestPoint nearest = model.tree.nearest(p, nearMm, seed);
        if (nearest.triangle == geometry::kNoTriangle) continue;
        seed = nearest.triangle;
        const geometry::Colour c = geometry::colourAt(model.outer, model.tree, model.colours, nearest);
        (*colours)[v] = {c[0], c[1], c[2], 255};
    }
    return colours;
}

}  // namespace handpiece::surface
