// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A tooth on which everything that is measured is known.

#include <memory>

#include "handpiece/model/tooth/tooth_model.h"
#include "support/closed_meshes.h"

namespace handpiece::desktop {

inline constexpr double kRadius = 5.0, kPulpRadius = 2.0;

/// A ball of enamel with a ball of pulp in it: what is measured on it is known.
inline cases::Case ballCase() {
    cases::Case ball;
    ball.name = "ball";
    ball.buccalSign = 1;
    ball.outer = test::sphereMesh(5, kRadius);
    ball.parts.push_back({"enamel", cases::Tissue::enamel, 1, ball.outer});
    ball.parts.push_back({"pulp", cases::Tissue::pulp, 5, test::sphereMesh(4, kPulpRadius)});
    return ball;
}

inline const std::shared_ptr<const tooth::ToothModel>& cuttableBall() {
    static const std::shared_ptr<const tooth::ToothModel> ball = [] {
        tooth::LoadSettings settings;
        settings.useCache = false;
        settings.field.voxelMm = 0.2;
        const cases::Case toothCase = ballCase();
        return tooth::loadModel(toothCase, settings);
    }();
    return ball;
}

}  // namespace handpiece::desktop
