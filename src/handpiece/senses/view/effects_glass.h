// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Translucent surfaces over the tooth: zones of a task. Private to this room.

#include <vector>

#include "handpiece/senses/view/passes.h"

namespace handpiece::view {

/// Drawn in their order, both sides, what lies behind something solid paler. Depth is tested, not written.
class GlassPass : public Pass {
  public:
    GlassPass();
    /// The context must be current.
    void set(const std::vector<GlassSurface>& surfaces);
    PixelRect touches(const PassContext& context) override;
    std::size_t draw(const PassContext& context) override;

  private:
    struct Surface {
        gl::Buffer vertices, indices;
        gl::VertexArray array;
        GLsizei count = 0;
        gl::Vec3f srgb;
        float alpha = 0.0f;
    };
    gl::Program program_;
    std::vector<Surface> surfaces_;
    core::Box box_;
};

}  // namespace handpiece::view
