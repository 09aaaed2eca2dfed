// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How the parts of a picture that lie over the tooth are drawn: mirror, particles, arrows, scale bar. Private to this
/// room.
///
/// Row 0 of every texture here is the picture's top row: `projection` is upside down for OpenGL, so that pictures are
/// read without being turned over. gl_FragCoord.xy are pixels from the top left, NDC y points down, and
/// counter-clockwise triangles (seen from outside) arrive clockwise: glFrontFace(GL_CW) is set.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>

#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/gl.h"
#include "handpiece/senses/view/look.h"
#include "handpiece/senses/view/renderer.h"

namespace handpiece::view {

/// Pixels x0 <= x < x1, y0 <= y < y1, from the top left.
struct PixelRect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    [[nodiscard]] bool isEmpty() const { return x1 <= x0 || y1 <= y0; }
    [[nodiscard]] PixelRect joined(const PixelRect& b) const {
        if (isEmpty()) return b;
        if (b.isEmpty()) return *this;
        return {std::min(x0, b.x0), std::min(y0, b.y0), std::max(x1, b.x1), std::max(y1, b.y1)};
    }
    [[nodiscard]] PixelRect common(const PixelRect& b) const {
        return {std::max(x0, b.x0), std::max(y0, b.y0), std::min(x1, b.x1), std::min(y1, b.y1)};
    }
    [[nodiscard]] PixelRect grown(int by) const { return {x0 - by, y0 - by, x1 + by, y1 + by}; }
    friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// An eye as matrices; a mirror's is reflected (its view matrix has determinant -1).
struct Eye {
    gl::Mat4f view = gl::Mat4f::Identity();        ///< tooth frame to eye: x right, y up, z towards the viewer
    gl::Mat4f projection = gl::Mat4f::Identity();  ///< y turned over, see above
    gl::Vec3f positionMm = gl::Vec3f::Zero();
    bool mirrored = false;
    std::optional<Plane> clip;  ///< what lies beyond is left out: behind a mirror

    [[nodiscard]] gl::Mat4f viewProjection() const { return projection * view; }
    friend bool operator==(const Eye&, const Eye&) = default;
};
/// With near and far planes 1 mm and up, as far as the scene needs.
[[nodiscard]] Eye eyeOf(const Camera& camera, const Viewport& viewport);

/// What a pass may know. The target's framebuffer is bound, with the viewport and a scissor rectangle set that must be
/// left as they are; depth test on (GL_LESS), depth writes on, blending off, culling off: to be left like that.
struct PassContext {
    const Camera& camera;
    Viewport viewport;
    Eye eye;
    const Look& look;
    const Moment& moment;
    gl::Vec3f lightDirection;        ///< unit, from the scene to the lamp, tooth frame
    const gl::Texture& toothDepth;   ///< window depth (0..1) of tooth and scenery; 1: nothing. Not the one written to.
    const gl::Texture& solidDepth;   ///< the same with instruments: the one written to, to be read from elsewhere only
    const gl::Texture& toothColour;  ///< tooth and scenery as lit, sRGB values
    GLuint framebuffer;              ///< to bind again after drawing elsewhere
    PixelRect scissor;               ///< to set again likewise
    bool software;
    /// Draws the scene (tooth, scenery, bur, turbine; no passes) for another eye at this size and gives the picture,
    /// good until the next call. Changes framebuffer, viewport and scissor.
    std::function<const gl::Texture&(const Eye& eye, int width, int height)> drawScene;
};

/// Puts framebuffer, viewport, scissor and the states above back.
void restoreTarget(const PassContext& context);

/// One of the things drawn over the tooth. Made after the context, dropped before it.
class Pass {
  public:
    virtual ~Pass() = default;
    /// Pixels that draw() may change now; empty: nothing to draw. Called before draw(), once a picture and eye.
    virtual PixelRect touches(const PassContext& context) = 0;
    /// Returns the triangles drawn.
    virtual std::size_t draw(const PassContext& context) = 0;
};

}  // namespace handpiece::view
