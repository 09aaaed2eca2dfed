// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Teeth with a closed form, and a cutter too plain to be wrong, for tests of the field that is cut.

#include <functional>

#include "handpiece/model/field/brick_index.h"
#include "handpiece/model/tooth/tooth_mirror.h"
#include "handpiece/model/tooth/tooth_state.h"
#include "support/random.h"

namespace handpiece::tooth::in_test {

using core::Vec3;

/// A tooth of which only the field counts; its surface is a token triangle.
inline std::shared_ptr<const ToothModel> toothOf(field::DistanceField field) {
    geometry::TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    geometry::TriangleTree tree(mesh);
    return std::make_shared<ToothModel>(ToothModel{"closed form", mesh, std::move(tree), std::move(field)});
}

inline double ball(const Vec3& p, double radiusMm) {
    return p.norm() - radiusMm;
}

/// A ball of dentine of `innerMm` in one of enamel of `outerMm`.
inline std::shared_ptr<const ToothModel> ballTooth(double outerMm, double innerMm, double voxelMm,
                                                   const CutSettings& settings = {}, double bandInMm = 0.3) {
    const double edge = outerMm + 0.3;
    field::FieldSettings field;
    field.voxelMm = voxelMm;
    field.bandInMm = bandInMm;
    auto tooth = toothOf(field::DistanceField::fromFunction({Vec3::Constant(-edge), Vec3::Constant(edge)}, field,
                                                            [&](const Vec3& p) { return ball(p, outerMm); }));
    const field::TissueMap::PartFunction dentine{[=](const Vec3& p) { return ball(p, innerMm); },
                                                 cases::Tissue::dentine, 1};
    field::TissueMap map = field::TissueMap::fromFunctions(tooth->field, std::span(&dentine, 1), cases::Tissue::enamel);
    return withTissues(*tooth, std::move(map), settings);
}

inline std::uint32_t denseCount(const field::DistanceField& field) {
    const field::FieldView v = field.view();
    return static_cast<std::uint32_t>(v.bricks[0] * v.bricks[1] * v.bricks[2]);
}

/// Takes a shape (its signed distance, negative inside) out of the tooth, brick by brick over the whole grid.
inline void cutAway(ToothState& field, const std::function<double(const Vec3&)>& shape) {
    const field::FieldView view = field.field().view();
    const auto low = static_cast<float>(-field.model().settings.bandMm),
               high = static_cast<float>(field.model().bandOutMm);
    std::array<float, field::kBrickValues> fresh;
    for (std::uint32_t dense = 0; dense < denseCount(field.field()); ++dense) {
        const auto brick = field::brickAt(view.bricks, dense);
        bool reaches = false;
        for (int i = 0; i < field::kBrickValues; ++i) {
            const int node[3] = {i % 9, i / 9 % 9, i / 81};
            Vec3 p;
            for (int k = 0; k < 3; ++k)
                p[k] = view.originMm[k] +
                       view.voxelMm * (field::kBrickCells * brick[static_cast<std::size_t>(k)] + node[k]);
            fresh[static_cast<std::size_t>(i)] = std::clamp(static_cast<float>(-shape(p)), low, high);
            reaches = reaches || fresh[static_cast<std::size_t>(i)] > low;
        }
        if (!reaches) continue;
        const std::int32_t stored = field.storeBrick(dense);
        if (stored < 0) continue;
        float* values = field.values(stored);
        bool changes = false;
        for (std::size_t i = 0; i < field::kBrickValues; ++i) {
            changes = changes || fresh[i] > values[i];
            values[i] = std::max(values[i], fresh[i]);
        }
        if (changes) field.noteChanged(dense, true);
    }
}

/// What is left of a tooth of which a shape was taken.
inline ToothMirror cut(const std::shared_ptr<const ToothModel>& model,
                       const std::function<double(const Vec3&)>& shape) {
    ToothState state(model);
    cutAway(state, shape);
    ToothMirror mirror(model);
    mirror.apply(state.state());
    return mirror;
}

/// Every node that two stored bricks hold has the same bits in both.
inline std::size_t tornNodes(const ToothState& field) {
    const field::FieldView view = field.field().view();
    std::size_t torn = 0;
    for (std::uint32_t dense = 0; dense < denseCount(field.field()); ++dense) {
        if (view.brickIndex[dense] < 0) continue;
        const auto brick = field::brickAt(view.bricks, dense);
        const float* mine = view.values + static_cast<std::size_t>(view.brickIndex[dense]) * field::kBrickValues;
        for (int i = 0; i < field::kBrickValues; ++i) {
            const int node[3] = {i % 9, i / 9 % 9, i / 81};
            for (int corner = 1; corner < 8; ++corner) {
                auto other = brick;
                int there[3];
                bool holds = true;
                for (std::size_t k = 0; k < 3; ++k) {
                    there[k] = node[k];
                    if ((corner >> k & 1) == 0) continue;
                    holds = holds && node[k] == field::kBrickCells && other[k] + 1 < view.bricks[k];
                    ++other[k];
                    there[k] = 0;
                }
                if (!holds) continue;
                const std::int32_t stored = view.brickIndex[field::denseOf(view.bricks, other)];
                if (stored < 0) continue;
                const float theirs = view.values[static_cast<std::size_t>(stored) * field::kBrickValues +
                                                 static_cast<std::size_t>(there[0] + 9 * there[1] + 81 * there[2])];
                torn += std::bit_cast<std::uint32_t>(theirs) != std::bit_cast<std::uint32_t>(mine[i]);
            }
        }
    }
    return torn;
}

}  // namespace handpiece::tooth::in_test
