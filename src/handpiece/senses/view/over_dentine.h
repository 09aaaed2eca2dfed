// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How far a place of the tooth lies from its dentine, for the light that goes through enamel. Private to this room.

#include <span>

#include "handpiece/model/case/case.h"
#include "handpiece/senses/view/gl.h"

namespace handpiece::view {

/// Distances on a grid about the enamel, as one picture of tiles, each a layer across z.
class OverDentine {
  public:
    static constexpr int kSide = 24, kTilesAcross = 6;  ///< as the shader has them
    static constexpr double kMostMm = 2.55;             ///< farther away it is all the same

    /// Of a tooth's tissues; without enamel among them there is nothing to tell, without dentine all
    /// is far from it: a block of nothing else has no neck.
    void set(std::span<const cases::Part> parts);
    /// For a shader's overDentine().
    void give(gl::Program& program, int unit) const;

  private:
    gl::Texture tiles_;
    gl::Vec3f lowMm_ = gl::Vec3f::Zero(), perMm_ = gl::Vec3f::Ones();
    enum class Known { nothing, distances, none } known_ = Known::nothing;
};

}  // namespace handpiece::view
