// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Draws the tooth, the bur and what is around them, with OpenGL 3.3, into a picture. The same on screen and off: a
/// window shows the picture, a file keeps it; no display is needed.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/base/messages/gingiva_cut.h"
#include "handpiece/model/case/case.h"
#include "handpiece/senses/surface/brick_update.h"
#include "handpiece/senses/view/camera.h"
#include "handpiece/senses/view/image.h"
#include "handpiece/senses/view/look.h"

namespace handpiece::instrument {
class Bur;
}

namespace handpiece::view {

/// A section's face: a picture of the tissues in the plane of Look::cutAway. Transparent where there is no tooth.
struct SectionFace {
    Plane plane;
    core::Vec3 originMm, uAxis,
        vAxis;  ///< middle of pixel (0, 0); unit axes in the plane, v x u... right-handed with the normal
    double mmPerPixel = 0.05;
    int width = 0, height = 0;
    std::vector<std::uint8_t> tissue;  ///< cases::Tissue by pixel, none outside the tooth
    /// By pixel, in 32nds of one: how far it lies from what is of another tissue, and from the tooth's surface; empty:
    /// boundaries run half way between two pixels.
    std::vector<std::array<std::uint8_t, 2>> away;
};

struct MirrorPose {
    core::Vec3 centreMm = core::Vec3::Zero(), normal = core::Vec3::UnitZ();  ///< unit, towards the seen side
    core::Vec3 handle = core::Vec3::UnitX();                                 ///< where the handle points, in the plane
    double radiusMm = 11.0;                                                  ///< a no. 5 mirror is 24 mm wide [R]
};

/// What a bur's head is of, as one sees it: grains; blades of hard metal or of steel; nothing but its own shape.
enum class BurFinish { diamond, carbide, steel, plain };
/// By an ability's name; empty: the one that the catalogue gives this bur. A bur from a mesh file is plain unless its
/// ability is another than that of one of which nothing is known.
[[nodiscard]] BurFinish finishOf(const instrument::Bur& bur, std::string_view cuttingParameters = {});

/// A closed surface to be seen through all that is solid: a zone of a task. Tooth frame.
struct GlassSurface {
    std::shared_ptr<const geometry::TriangleMesh> mesh;
    std::array<float, 3> colour{1.0f, 1.0f, 1.0f};  ///< sRGB, 0 to 1
    float alpha = 0.25f;                            ///< of a side seen squarely; at its rim more
};

/// All that moves from picture to picture. Poses as in messages::HapticSample: the proxy's, never sunk in.
struct Moment {
    double timeS = 0.0;  ///< of the simulation: particles move by it; may stand still or jump
    core::Pose burInTooth;
    bool burShown = true;
    double speedRpm = 0.0;
    double removalMm3S = 0.0;  ///< what is being cut away: debris
    cases::Tissue tissue = cases::Tissue::none;
    bool water = false;  ///< spray is on
    bool contact = false;
    core::Vec3 contactPointMm = core::Vec3::Zero(), contactNormal = core::Vec3::UnitZ();
    core::Vec3 forceN = core::Vec3::Zero();  ///< on the hand
    std::optional<MirrorPose> mirror;
};

/// What a picture took.
struct FrameReport {
    double drawMs = 0.0, readMs = 0.0;
    std::size_t triangles = 0;  ///< drawn, all passes
    bool toothRedrawn = false;  ///< all of it, or only where it changed (false)
    bool bleeding = false;      ///< blood runs: some time later the picture is another
    bool refining = false;      ///< the view is still in motion or being refined: draw again soon
    /// Drawn again with nothing changed, the renderer gets on with what lets a moving eye see all detail.
    bool preparing = false;
};

/// Owns an OpenGL context of its own (EGL, surfaceless) and all that it holds. One thread: the one that made it.
///
/// The tooth is kept as drawn while camera and look stay: pictures in which only the bur moves, or a few bricks change,
/// cost only what changed. While the camera moves, detail goes down as far as `Quality` says and comes back at rest; a
/// software renderer leaves out triangles that show by less than half a pixel.
class Renderer {
  public:
    /// Throws core::Error when there is no OpenGL 3.3: what was tried, and what to install.
    Renderer();
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5"; and whether it draws without a GPU.
    [[nodiscard]] const std::string& description() const noexcept;
    [[nodiscard]] bool isSoftware() const noexcept;

    /// Another tooth: forgets the bricks there were. `bounds` of the tooth itself [mm].
    void setTooth(const core::Box& bounds);
    /// New triangles for these bricks. What a brick showed first is kept as "before"; `before` says that these are
    /// that, as after setTooth().
    void updateBricks(std::span<const surface::BrickUpdate> bricks, bool before = false);
    /// A tooth that is one mesh and is not cut (an STL to look at); `tissue` colours it, or what a scanner saw.
    void setMesh(const geometry::TriangleMesh& mesh, cases::Tissue tissue, const geometry::VertexColours& colours = {});
    /// cases::Case::others: their tissues are seen in a section while they are whole. Those of which none are known are
    /// filled in the colour of their surface. Before the scenery, whose teeth have their necks where their enamel ends.
    void setOthers(std::shared_ptr<const std::vector<cases::PlacedTooth>> others);
    /// cases::surroundings(): tooth number n is the part n - 1, and drawn no more once bricks of it have come.
    void setScenery(std::span<const cases::Part> parts);
    /// What burs did to the gingiva of the scenery, by rising time, over which Moment::timeS goes; `down`: unit, as
    /// gravity acts on the patient. None: it is whole.
    void setGingivaCuts(std::vector<messages::GingivaCut> cuts, const core::Vec3& down);
    /// The tissues of the tooth under its surface, uncut: seen where Look::visible leaves out one of them. Forgotten by
    /// setTooth() and setMesh().
    void setParts(std::span<const cases::Part> parts);
    /// Meshes in the bur frame.
    void setBur(const geometry::TriangleMesh& mesh, double headLengthMm, double headRadiusMm,
                BurFinish finish = BurFinish::diamond);
    void setTurbine(const geometry::TriangleMesh& mesh);
    /// The face shown at Look::cutAway when its plane is the same; without it the inside shows as walls only.
    void setSectionFace(SectionFace face);

    /// Over the tooth, in this order; forgotten by setTooth() and setMesh(). None: away with it.
    void setGlass(const std::vector<GlassSurface>& surfaces);

    /// For a window at work on a software renderer: full detail comes back strip by strip over several pictures, and a
    /// new look of the tooth counts as motion, so that no single picture keeps the hand waiting. Off: in one go.
    void setResponsive(bool responsive);

    /// Draws. The picture has viewport's size; with Stereo::sideBySide both halves share it.
    FrameReport draw(const Camera& camera, const Viewport& viewport, const Look& look, const Moment& moment,
                     Image& out);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace handpiece::view
