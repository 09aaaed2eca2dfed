// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How much of the handpiece is seen. Private to this room.

#include <array>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/senses/view/gl.h"

namespace handpiece::view {

/// What of it would lie over the crown that is worked at, or over the bur's tip, is not drawn, and neither is all from
/// there to the head: what is left is one piece, from some place of the handle outwards, that no hole parts in two.
/// Everything in the bur's frame, where the handle runs along +x.
class HandpieceFade {
  public:
    static constexpr int kSlices = 32;
    /// Of 1 all is drawn, of 0 nothing; by slices across the handle.
    struct Solid {
        std::array<float, kSlices> share{};
        float fromMm = 0.0f, stepMm = 1.0f;
        /// The least and the most between two places of the handle.
        [[nodiscard]] std::array<float, 2> between(float lowMm, float highMm) const;
        /// How much is drawn of the head, where the bur is held: metal ends on a short way, as the shader has it.
        [[nodiscard]] float ofHead() const;
    };

    void set(const geometry::TriangleMesh& handpiece);
    /// `crown`: middle and radius of what is worked at; a radius of 0: nothing is.
    [[nodiscard]] Solid seenFrom(const gl::Vec3f& eyeMm, const gl::Vec3f& crownMm, float crownRadiusMm,
                                 float headLengthMm) const;

  private:
    struct Ball {
        gl::Vec3f centreMm = gl::Vec3f::Zero();
        float radiusMm = 0.0f;
        int slice = 0;
    };
    std::vector<Ball> balls_;
    float fromMm_ = 0.0f, stepMm_ = 1.0f;
};

/// The ball about a tooth's crown: as high as the tooth is wide, at its occlusal end.
struct CrownBall {
    gl::Vec3f centreMm = gl::Vec3f::Zero();
    float radiusMm = 0.0f;
};
[[nodiscard]] CrownBall crownOf(const core::Box& tooth);

}  // namespace handpiece::view
