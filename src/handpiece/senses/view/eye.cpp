// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/senses/view/passes.h"

namespace handpiece::view {

Eye eyeOf(const Camera& camera, const Viewport& viewport) {
    Eye eye;
    const core::Vec3 forward = camera.forward(), right = camera.right(), up = camera.upward();
    core::Mat3 turn;
    turn.row(0) = right;
    turn.row(1) = up;
    turn.row(2) = -forward;
    eye.view.topLeftCorner<3, 3>() = turn.cast<float>();
    eye.view.topRightCorner<3, 1>() = (-(turn * camera.eyeMm)).cast<float>();
    eye.positionMm = camera.eyeMm.cast<float>();
    eye.mirrored = camera.mirrored;

    const double distance = camera.distanceMm();
    const double nearMm = std::max(0.3, 0.05 * distance), farMm = distance + std::max(150.0, distance);
    const double f = 1.0 / std::tan(0.5 * camera.fieldOfViewRad);
    const double aspect = static_cast<double>(viewport.width) / std::max(1, viewport.height);
    eye.projection.setZero();
    eye.projection(0, 0) = static_cast<float>(f / aspect);
    eye.projection(1, 1) = static_cast<float>(-f);
    eye.projection(2, 2) = static_cast<float>((farMm + nearMm) / (nearMm - farMm));
    eye.projection(2, 3) = static_cast<float>(2.0 * farMm * nearMm / (nearMm - farMm));
    eye.projection(3, 2) = -1.0f;
    return eye;
}

void restoreTarget(const PassContext& context) {
    glBindFramebuffer(GL_FRAMEBUFFER, context.framebuffer);
    glViewport(0, 0, context.viewport.width, context.viewport.height);
    const PixelRect& s = context.scissor;
    glEnable(GL_SCISSOR_TEST);
    glScissor(s.x0, s.y0, s.x1 - s.x0, s.y1 - s.y0);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glFrontFace(GL_CW);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

}  // namespace handpiece::view
