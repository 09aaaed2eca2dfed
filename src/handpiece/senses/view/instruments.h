// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Bur and turbine as drawn, and the shadow that the bur throws. Private to this room.

#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/senses/view/handpiece_fade.h"
#include "handpiece/senses/view/mesh_pool.h"
#include "handpiece/senses/view/renderer.h"
#include "handpiece/senses/view/shaders.h"
#include "handpiece/senses/view/strips.h"
#include "handpiece/senses/view/tooth_layer.h"

namespace handpiece::view {

class Instruments {
  public:
    void setBur(const geometry::TriangleMesh& mesh, double headLengthMm, double headRadiusMm, BurFinish finish);
    void setTurbine(const geometry::TriangleMesh& mesh);
    /// What is worked at: the handpiece never lies over its crown.
    void setWork(const core::Box& tooth);
    [[nodiscard]] double headRadiusMm() const noexcept { return headRadiusMm_; }

    /// Pixels that shadow and draw() may change.
    [[nodiscard]] PixelRect rect(const Eye& eye, const Viewport& viewport, const Look& look,
                                 const Moment& moment) const;
    /// Another number when the instruments would look other than before, whoever looks at them.
    [[nodiscard]] std::uint64_t appearance(const Moment& moment, const Look& look);
    [[nodiscard]] PixelRect shadowRect(const Eye& eye, const Viewport& viewport, const Look& look, const Moment& moment,
                                       const Lighting& lighting) const;
    /// Darkens the picture in the framebuffer that is bound, within `bounds`; `toothDepth` says where the tooth is.
    /// Changes the scissor rectangle.
    void drawShadow(Shaders& shaders, const Eye& eye, const Viewport& viewport, const PixelRect& bounds,
                    const Moment& moment, const Lighting& lighting, const gl::Texture& toothDepth) const;
    /// `rect`: what of the picture is to be drawn.
    std::size_t draw(Shaders& shaders, const Eye& eye, const Viewport& viewport, const PixelRect& rect,
                     const Look& look, const Moment& moment, const Lighting& lighting);

  private:
    /// Where the bur's tip is seen from, in the bur's frame. What lies over it would hide the work.
    struct Sight {
        Sight(const Eye& eyeInBur, double headLengthMm);
        /// Whether any of the bur is to be seen through; whether a thing is so near to the eye that none is shown.
        [[nodiscard]] bool isGlass(const PooledMesh& mesh) const;
        [[nodiscard]] bool isNear(const PooledMesh& mesh) const;
        [[nodiscard]] bool isGone(const PooledMesh& mesh) const;
        [[nodiscard]] float depthOf(const PooledMesh& mesh) const;
        gl::Vec3f eye, toEye;
        float eyeMm, fromMm, siteMm, goneMm, wholeMm;
        gl::Vec4f depth;  ///< of a point: dot with (p, 1)
    };
    struct Solid {
        std::vector<PooledMesh> meshes;
        gl::Vec3f minMm = gl::Vec3f::Zero(), maxMm = gl::Vec3f::Zero();
    };
    void set(Solid& solid, const geometry::TriangleMesh& mesh, double creaseRad, double cellMm);
    /// Calls `found(mesh, isTurbine)` for what may be seen.
    template <class Found>
    void eachSeen(const Culler& culler, const Sight& sight, const HandpieceFade::Solid& solid, const Look& look,
                  const Found& found) const;
    [[nodiscard]] HandpieceFade::Solid solidOf(const Eye& eyeInBur, const Moment& moment) const;

    [[nodiscard]] float heldShare(const Look& look, const HandpieceFade::Solid& solid) const;
    void prepareBur(gl::Program& program, const Moment& moment) const;

    struct Appearance {
        core::Vec3 positionMm = core::Vec3::Zero();
        core::Quat orientation = core::Quat::Identity();
        bool shown = false, bur = false, turbine = false, shadows = false;
        double blur = 0.0, turn = 0.0;
    };
    Appearance last_;
    std::uint64_t appearance_ = 1;
    MeshPool pool_;
    Solid bur_, shankEnd_, turbine_;
    HandpieceFade fade_;
    CrownBall crown_;
    std::vector<const PooledMesh*> metalBur_, metalTurbine_, glassBur_, glassTurbine_;
    BurFinish finish_ = BurFinish::diamond;
    double headLengthMm_ = 1.0, headRadiusMm_ = 0.5, shankRadiusMm_ = 0.8, topMm_ = 9.0;
};

}  // namespace handpiece::view
