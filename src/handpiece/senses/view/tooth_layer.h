// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Tooth and scenery as one eye sees them, kept as drawn: colour and depth. Private to this room.

#include <array>
#include <cstdint>
#include <list>
#include <optional>
#include <utility>

#include "handpiece/senses/view/scene.h"
#include "handpiece/senses/view/shaders.h"

namespace handpiece::view {

/// The lamp and what shines besides, tooth frame; of the picture's own camera, also in a mirror.
struct Lighting {
    gl::Vec3f lamp = gl::Vec3f::UnitZ(), up = gl::Vec3f::UnitZ();
    gl::Vec3f sky = gl::Vec3f::UnitZ();  ///< from where it is bright all over; shorter, where from nowhere more
    gl::Vec3f right = gl::Vec3f::UnitX();
    friend bool operator==(const Lighting&, const Lighting&) = default;
};
/// As over a dental chair: above the eye (of an upper crown that hangs, below it), a little to its left, so that what
/// stands over the tooth throws its shadow where it is seen.
[[nodiscard]] Lighting lightingOf(const Camera& camera);

/// From where teeth may be in the way (Scene::inTheWay): not from a mirror's, which shows the mouth as it is.
[[nodiscard]] std::optional<gl::Vec3f> eyeToSee(const Eye& eye);

/// Planes as shaders take them: dot(plane, (p, 1)) < 0 is left out.
[[nodiscard]] gl::Vec4f planeOf(const std::optional<Plane>& plane);

/// A section's face on the graphics card. `serial` tells one from another.
struct Section {
    SectionFace face;
    gl::Texture tissues;
    std::uint64_t serial = 0;

    void set(SectionFace of);
};
/// Of the tooth that is worked on, and of others by their numbers: these in the plane that is drawn.
struct Sections {
    Section own;
    std::list<std::pair<std::uint16_t, Section>> others;
};

struct LayerWants {
    Eye eye;
    Viewport viewport;
    Look look;  ///< what is not about tooth and scenery does not matter
    Lighting lighting;
    Detail detail = Detail::full;
    std::uint64_t sectionSerial = 0;
};

/// Whether tooth and scenery look the same.
[[nodiscard]] bool sameTooth(const Look& a, const Look& b);

class ToothLayer {
  public:
    /// Pixels that are others now; `all` when everything was drawn.
    struct Drawn {
        PixelRect rect;
        bool all = false;
        std::size_t triangles = 0;
    };
    /// How much to draw at once where all must be: a picture in full detail takes several others' time.
    enum class Haste {
        whole,
        refined,  ///< a strip a call where only the detail was lower: what is shown meanwhile is the same view
        strips,   ///< a strip a call, of whatever view: not to be shown before isComplete()
    };
    /// Brings the picture up to date, or nearer to it.
    Drawn update(Shaders& shaders, Scene& scene, const Sections& sections, const gl::Texture& depthScale,
                 const LayerWants& wants, Haste haste = Haste::whole);
    /// All of it is drawn, as wanted; bricks may have changed since.
    [[nodiscard]] bool isComplete(const Scene& scene, const LayerWants& wants) const;
    [[nodiscard]] bool isComplete() const noexcept { return drawn_ && nextRow_ >= drawn_->viewport.height; }
    /// Occlusion reaches farther than what changed was redrawn: update() does the rest when nothing else changes.
    [[nodiscard]] bool owes() const noexcept { return !owed_.isEmpty(); }
    /// Another number when all of it is another.
    [[nodiscard]] std::uint64_t serial() const noexcept { return serial_; }

    [[nodiscard]] const gl::Texture& colour() const noexcept { return colour_; }
    [[nodiscard]] const gl::Texture& depth() const noexcept { return depth_; }
    /// Both, to be copied from.
    [[nodiscard]] const gl::Framebuffer& framebuffer() const noexcept { return both_; }
    [[nodiscard]] Detail detail() const noexcept { return drawn_ ? drawn_->detail : Detail::full; }

  private:
    void allocate(const Viewport& viewport);
    void redraw(Shaders& shaders, Scene& scene, const Sections& sections, const gl::Texture& depthScale,
                const LayerWants& wants, const PixelRect& changed, bool closeBy, Drawn& drawn);
    std::size_t drawSurface(Shaders& shaders, Scene& scene, const Sections& sections, const LayerWants& wants,
                            const PixelRect& rect);
    std::size_t drawSection(Shaders& shaders, const Section& section, const LayerWants& wants);
    void drawOcclusion(Shaders& shaders, const LayerWants& wants, const PixelRect& half, int mostPixels);
    std::size_t drawShadowMap(Shaders& shaders, Scene& scene, const LayerWants& wants);
    void renewBackground(Shaders& shaders, const LayerWants& wants);
    void drawLight(Shaders& shaders, const Scene& scene, const gl::Texture& depthScale, const LayerWants& wants,
                   const PixelRect& rect, const PixelRect& content);

    [[nodiscard]] bool drawsScanned(const Scene& scene, const LayerWants& wants);

    gl::Texture surface_, scanned_, depth_, occlusion_, blurred_, colour_, litDepth_, shadow_;
    gl::Framebuffer geometry_, scannedGeometry_, occlusionTarget_, blurredTarget_, lit_, both_, shadowTarget_;
    gl::VertexArray none_;  ///< for what needs no vertices
    gl::Mat4f toShadow_ = gl::Mat4f::Identity();
    /// The background by itself: it changes only with its colours.
    gl::Texture background_;
    gl::Framebuffer backgroundTarget_;
    std::array<std::uint8_t, 6> backgroundColours_{};
    bool backgroundDrawn_ = false;
    std::optional<LayerWants> drawn_;
    std::uint64_t epoch_ = 0, serial_ = 0;
    std::size_t changesSeen_ = 0;
    int nextRow_ = 0;  ///< rows from here on are still to be drawn
    PixelRect owed_;   ///< changed, and lit anew only close by
};

}  // namespace handpiece::view
