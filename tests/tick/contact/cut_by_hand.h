// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A slab of tooth that is cut node by node from a closed form, so that what is left is known without any cutting code.

#include <functional>
#include <memory>

#include "handpiece/model/tooth/tooth_state.h"
#include "tick/contact/contact_fixture.h"

namespace handpiece::test {

/// z <= 0 within +-4 mm, 3 mm thick, on triangles and as a field; dentine for x > 0 when `twoTissues`.
inline std::shared_ptr<tooth::ToothState> slabToCut(bool twoTissues = false, double voxelMm = 0.05) {
    geometry::TriangleMesh mesh = boxMesh({-4, -4, -3}, {4, 4, 0}, 24);
    geometry::TriangleTree tree(mesh);
    field::FieldSettings settings;
    settings.voxelMm = voxelMm;
    field::DistanceField field = field::FieldBuilder::fromSurface(mesh, tree, {}, settings);
    auto tissues = field::TissueMap::uniform(field, cases::Tissue::enamel);
    if (twoTissues)
        tissues = field::TissueMap::fromFunctions(
            field,
            std::vector<field::TissueMap::PartFunction>{
                {[](const core::Vec3& p) { return -p.x(); }, cases::Tissue::dentine, 1}},
            cases::Tissue::enamel);
    auto uncut = std::make_shared<const tooth::ToothModel>(
        tooth::ToothModel{"slab", std::move(mesh), std::move(tree), std::move(field)});
    return std::make_shared<tooth::ToothState>(tooth::withTissues(*uncut, std::move(tissues)));
}

/// Takes away where `signedDistance` is negative: every node within `box` that may change.
inline void carve(tooth::ToothState& cut, const core::Box& box,
                  const std::function<double(const core::Vec3&)>& signedDistance) {
    const field::FieldView view = cut.field().view();
    const double brickMm = field::kBrickCells * view.voxelMm;
    const auto low = static_cast<float>(-cut.model().settings.bandMm), high = static_cast<float>(cut.model().bandOutMm);
    std::int32_t first[3], last[3];
    for (int k = 0; k < 3; ++k) {
        const auto at = [&](double x) {
            return static_cast<std::int32_t>(std::floor((x - view.originMm[k]) / brickMm));
        };
        first[k] = std::max(0, at(box.min[k]));
        last[k] = std::min(view.bricks[k] - 1, at(box.max[k]));
    }
    for (std::int32_t z = first[2]; z <= last[2]; ++z)
        for (std::int32_t y = first[1]; y <= last[1]; ++y)
            for (std::int32_t x = first[0]; x <= last[0]; ++x) {
                const auto dense = static_cast<std::uint32_t>(x + view.bricks[0] * (y + view.bricks[1] * z));
                const core::Vec3 corner(view.originMm[0] + brickMm * x, view.originMm[1] + brickMm * y,
                                        view.originMm[2] + brickMm * z);
                const double centre = signedDistance(corner + core::Vec3::Constant(0.5 * brickMm));
                float& coarse = cut.coarse()[dense];
                coarse = std::max(coarse, static_cast<float>(-centre));
                if (centre - 0.87 * brickMm > static_cast<double>(-low)) continue;
                const std::int32_t stored = cut.storeBrick(dense);
                if (stored < 0) continue;
                bool changed = false;
                for (int i = 0; i < field::kBrickValues; ++i) {
                    const core::Vec3 node(i % 9, i / 9 % 9, i / 81);
                    const auto value =
                        std::clamp(static_cast<float>(-signedDistance(corner + view.voxelMm * node)), low, high);
                    float& here = cut.values(stored)[i];
                    changed = changed || value > here;
                    here = std::max(here, value);
                }
                if (changed) cut.noteChanged(dense, true);
            }
}

/// What a round-ended cylinder standing upright with its tip at `tip` leaves when it came down from above.
inline double shaftDistance(const core::Vec3& p, const core::Vec3& tip, double radiusMm) {
    const core::Vec3 w = p - tip - core::Vec3(0.0, 0.0, radiusMm);
    return (w.z() > 0.0 ? std::hypot(w.x(), w.y()) : w.norm()) - radiusMm;
}

}  // namespace handpiece::test
