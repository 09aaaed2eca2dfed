// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Pictures of the tooth of a session that is played. Private to this room.

#include <optional>
#include <vector>

#include "handpiece/app/simulation/live_tooth.h"
#include "handpiece/app/simulation/session_player.h"
#include "handpiece/model/case/exercise.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::report {

class Artist {
  public:
    /// Throws core::Error without OpenGL, and of a player that has no tooth().
    Artist(const simulation::SessionPlayer& player, const view::Viewport& viewport);
    /// What changed of the tooth; teeth beside it are not drawn.
    void cut(std::vector<surface::BrickUpdate> news);
    [[nodiscard]] view::Image picture(view::StandardView from, view::ToothShown shown);
    /// From where an exercise begins, near enough to fill the picture; from occlusal without one.
    [[nodiscard]] view::Image pictureFrom(const std::optional<cases::View>& from);
    /// Across x, at a place.
    [[nodiscard]] view::Image section(const simulation::LiveTooth& tooth, const core::Vec3& atMm);

  private:
    view::Image drawn(const view::Camera& camera);

    view::Renderer renderer_;
    core::Box bounds_;
    view::Standing standing_;
    view::Viewport viewport_;
    view::Look look_;
    view::Moment moment_;
};

}  // namespace handpiece::report
