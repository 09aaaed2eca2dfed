// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/tooth_layer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace handpiece::view {
namespace {

using gl::Vec2f;
using gl::Vec3f;
using gl::Vec4f;

constexpr float kOcclusionMm = 1.5f, kShadowMm = 4.0f;
constexpr int kShadowMapSize = 2048;
// A strip is higher than occlusion reaches: its neighbours are put right by the one after it.
constexpr int kStrips = 8, kMinRows = 112;
/// Pixels around a change that are lit anew at once while one cuts: farther off, what it occludes is not seen to
/// change.
constexpr int kCloseBy = 20;
constexpr double kCrownMm = 7.0;  // from the neck to the tips: a first molar's is 7.5 mm high [R]

bool sameLook(Look a, Look b) {
    for (Look* look : {&a, &b}) {
        const Look standard;
        look->stereo = standard.stereo;
        look->eyeSeparationMm = standard.eyeSeparationMm;
        look->bur = look->turbine = look->debris = look->spray = true;
        look->contactArrow = look->forceArrow = look->scaleBar = false;
    }
    return a == b;
}

bool same(const LayerWants& a, const LayerWants& b) {
    return a.eye == b.eye && a.viewport.width == b.viewport.width && a.viewport.height == b.viewport.height &&
           sameLook(a.look, b.look) && a.lighting == b.lighting && a.detail == b.detail &&
           a.sectionSerial == b.sectionSerial;
}

float linear(std::uint8_t value) {
    return std::pow(static_cast<float>(value) / 255.0f, 2.2f);
}

Vec3f linear(const std::array<std::uint8_t, 3>& c) {
    return {linear(c[0]), linear(c[1]), linear(c[2])};
}
Vec3f plain(const std::array<std::uint8_t, 3>& c) {
    return Vec3f(c[0], c[1], c[2]) / 255.0f;
}

int visibleBits(const Look& look) {
    int bits = 1;  // a surface without tissues is always seen
    for (std::size_t i = 1; i < cases::kTissueCount; ++i)
        bits |= look.visible[i] ? 1 << i : 0;
    return bits;
}

void setScissor(const PixelRect& r) {
    glScissor(r.x0, r.y0, std::max(0, r.x1 - r.x0), std::max(0, r.y1 - r.y0));
}

/// By kind: how far light wraps round, gloss, sharpness of the gloss, how far light goes under.
std::array<Vec4f, kKinds> materials() {
    std::array<Vec4f, kKinds> m;
    m.fill(Vec4f(0.15f, 0.25f, 0.8f, 0.2f));
    const auto set = [&](cases::Tissue tissue, const Vec4f& value) { m[static_cast<std::size_t>(tissue)] = value; };
    set(cases::Tissue::none, {0.22f, 0.6f, 1.3f, 0.5f});
    set(cases::Tissue::enamel, {0.22f, 0.85f, 1.6f, 1.0f});
    set(cases::Tissue::neighbour, {0.22f, 0.85f, 1.6f, 1.0f});
    set(cases::Tissue::dentine, {0.12f, 0.38f, 0.8f, 0.4f});
    set(cases::Tissue::cementum, {0.12f, 0.35f, 0.7f, 0.3f});
    set(cases::Tissue::pulp, {0.30f, 0.75f, 1.2f, 0.8f});
    set(cases::Tissue::caries, {0.05f, 0.28f, 0.6f, 0.1f});
    for (std::size_t i = 0; i < cases::kCariousLevels.size(); ++i) {  // the firmer, the more like dentine
        const float firm = static_cast<float>(i + 1) / static_cast<float>(cases::kCariousLevels.size() + 1);
        set(cases::kCariousLevels[i],
            {0.05f + 0.07f * firm, 0.28f + 0.1f * firm, 0.6f + 0.2f * firm, 0.1f + 0.3f * firm});
    }
    set(cases::Tissue::demineralisedEnamel, {0.22f, 0.30f, 0.7f, 0.6f});
    set(cases::Tissue::stainedEnamel, {0.10f, 0.45f, 1.0f, 0.2f});
    set(cases::Tissue::calculus, {0.10f, 0.15f, 0.5f, 0.2f});
    set(cases::Tissue::gum, {0.35f, 0.50f, 1.1f, 0.9f});
    set(cases::Tissue::bone, {0.15f, 0.20f, 0.5f, 0.3f});
    set(cases::Tissue::restoration, {0.05f, 0.8f, 1.5f, 0.0f});
    m[kInsideKind] = {0.3f, 0.0f, 0.5f, 0.0f};
    return m;
}

std::array<Vec3f, kKinds> palette(Palette which) {
    std::array<Vec3f, kKinds> colours;
    colours.fill(Vec3f(0.5f, 0.0f, 0.5f));
    for (std::size_t i = 0; i < cases::kTissueCount; ++i)
        colours[i] = linear(colourOf(static_cast<cases::Tissue>(i), which));
    // A surface that is of no tissue is shown as plaster is.
    colours[0] = Vec3f(0.66f, 0.62f, 0.54f);
    colours[kInsideKind] = Vec3f(0.16f, 0.115f, 0.075f);
    colours[kGridKind] = Vec3f(0.20f, 0.24f, 0.28f);
    colours[kEdgeKind] = Vec3f(0.035f, 0.025f, 0.02f);
    return colours;
}

}  // namespace

Lighting lightingOf(const Camera& camera) {
    // The lamp stands where it stands, mirror or not.
    const core::Vec3 back = -camera.forward(), up = camera.upward(), right = back.cross(-up);
    // Where the crown hangs the light comes from below: a lamp over a chair is turned to shine into the mouth.
    const double hangs = std::clamp((-up.z() - 0.05) / 0.45, 0.0, 1.0),
                 way = 1.0 - 2.0 * hangs * hangs * (3.0 - 2.0 * hangs);
    return {(0.80 * back + 0.52 * way * up - 0.42 * right).normalized().cast<float>(), up.cast<float>(),
            (way * up).cast<float>(), right.cast<float>()};
}

std::optional<Vec3f> eyeToSee(const Eye& eye) {
    if (eye.clip) return std::nullopt;
    return eye.positionMm;
}

Vec4f planeOf(const std::optional<Plane>& plane) {
    if (!plane) return {0.0f, 0.0f, 0.0f, 1.0f};
    const Vec3f normal = plane->normal.cast<float>();
    return {-normal.x(), -normal.y(), -normal.z(), static_cast<float>(plane->offsetMm)};
}

void Section::set(SectionFace of) {
    constexpr std::uint8_t kHalfPixel = 16;
    std::vector<std::array<std::uint8_t, 4>> texels(of.tissue.size());
    for (std::size_t i = 0; i < texels.size(); ++i)
        texels[i] = {of.tissue[i], of.away.empty() ? kHalfPixel : of.away[i][0],
                     of.away.empty() ? kHalfPixel : of.away[i][1], 0};
    tissues.fill(of.width, of.height, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
    face = std::move(of);
    ++serial;
}

void ToothLayer::allocate(const Viewport& viewport) {
    const int w = viewport.width, h = viewport.height, w2 = (w + 1) / 2, h2 = (h + 1) / 2;
    if (colour_.width() == w && colour_.height() == h) return;
    surface_.allocate(w, h, GL_RGBA16);
    depth_.allocate(w, h, GL_DEPTH_COMPONENT24);
    colour_.allocate(w, h, GL_RGBA8, true);
    occlusion_.allocate(w2, h2, GL_RGBA16F);
    blurred_.allocate(w2, h2, GL_RGBA16F);
    geometry_.attach({&surface_}, &depth_);
    litDepth_.allocate(w, h, GL_DEPTH_COMPONENT24);
    lit_.attach({&colour_}, &litDepth_);
    both_.attach({&colour_}, &depth_);
    occlusionTarget_.attach({&occlusion_}, nullptr);
    background_.allocate(w, h, GL_RGBA8);
    backgroundTarget_.attach({&background_}, nullptr);
    backgroundDrawn_ = false;
    blurredTarget_.attach({&blurred_}, nullptr);
    drawn_.reset();
}

bool sameTooth(const Look& a, const Look& b) {
    return sameLook(a, b);
}

bool ToothLayer::isComplete(const Scene& scene, const LayerWants& wants) const {
    return isComplete() && epoch_ == scene.epoch() && same(*drawn_, wants);
}

ToothLayer::Drawn ToothLayer::update(Shaders& shaders, Scene& scene, const Sections& sections,
                                     const gl::Texture& depthScale, const LayerWants& wants, Haste haste) {
    allocate(wants.viewport);
    const PixelRect whole{0, 0, wants.viewport.width, wants.viewport.height};
    const bool shadows = wants.look.quality == Quality::rich && wants.look.shadows;
    const auto& changes = scene.changes();
    bool anew = !drawn_ || epoch_ != scene.epoch() || !same(*drawn_, wants);
    PixelRect changed;
    if (!anew) {
        for (std::size_t i = changesSeen_; i < changes.size(); ++i)
            changed = changed.joined(rectOf(changes[i].minMm, changes[i].maxMm, wants.eye, wants.viewport));
        anew = shadows && changesSeen_ < changes.size();  // a shadow may fall anywhere
    }
    bool inStrips = haste == Haste::strips;
    if (haste == Haste::refined) {
        LayerWants coarser = wants;
        if (drawn_) coarser.detail = drawn_->detail;
        inStrips = !anew || (coarser.detail != Detail::full && isComplete(scene, coarser));
    }
    if (anew) {
        nextRow_ = 0;
        ++serial_;
        owed_ = {};
    }
    drawn_ = wants;
    epoch_ = scene.epoch();
    changesSeen_ = changes.size();

    const int begin = nextRow_, rows = std::max(whole.y1 / kStrips, kMinRows);
    nextRow_ = inStrips ? std::min(whole.y1, begin + rows) : whole.y1;
    Drawn result;
    result.all = nextRow_ - begin == whole.y1;
    const PixelRect strip = nextRow_ > begin ? PixelRect{0, begin, whole.x1, nextRow_} : PixelRect{};
    changed = changed.common({0, 0, whole.x1, begin});  // farther on it is drawn anyway
    const bool closeBy = haste == Haste::refined && !changed.isEmpty();
    if (closeBy)
        owed_ = owed_.joined(changed);
    else if (strip.isEmpty())
        changed = changed.joined(std::exchange(owed_, {}));
    if (changed.isEmpty() && strip.isEmpty()) return result;

    glEnable(GL_SCISSOR_TEST);
    glFrontFace(wants.eye.mirrored ? GL_CCW : GL_CW);
    glDisable(GL_BLEND);
    if (shadows && anew) result.triangles += drawShadowMap(shaders, scene, wants);
    if (!changed.isEmpty()) redraw(shaders, scene, sections, depthScale, wants, changed, closeBy, result);
    if (!strip.isEmpty()) redraw(shaders, scene, sections, depthScale, wants, strip, false, result);
    if (result.all) result.rect = whole;
    return result;
}

void ToothLayer::redraw(Shaders& shaders, Scene& scene, const Sections& sections, const gl::Texture& depthScale,
                        const LayerWants& wants, const PixelRect& changed, bool closeBy, Drawn& drawn) {
    const PixelRect whole{0, 0, wants.viewport.width, wants.viewport.height};
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glViewport(0, 0, wants.viewport.width, wants.viewport.height);
    drawn.triangles += drawSurface(shaders, scene, sections, wants, changed);

    // Occlusion reaches as far as its radius where the scene is nearest.
    const core::Box& bounds = scene.bounds();
    const PixelRect content =
        bounds.isEmpty() ? PixelRect{}
                         : rectOf(bounds.min.cast<float>(), bounds.max.cast<float>(), wants.eye, wants.viewport);
    const int mostPixels = wants.look.quality == Quality::fast ? 64 : 96;
    glDisable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    none_.bind();
    const PixelRect reached = changed.grown(closeBy ? kCloseBy : mostPixels + 4).common(whole);
    const PixelRect half{reached.x0 / 2, reached.y0 / 2, (reached.x1 + 1) / 2, (reached.y1 + 1) / 2};
    const PixelRect contentHalf{content.x0 / 2 - 2, content.y0 / 2 - 2, content.x1 / 2 + 2, content.y1 / 2 + 2};
    const PixelRect wholeHalf{0, 0, occlusion_.width(), occlusion_.height()};
    drawOcclusion(shaders, wants, half.common(contentHalf).common(wholeHalf), mostPixels);
    glViewport(0, 0, wants.viewport.width, wants.viewport.height);
    const PixelRect lit = reached.grown(8).common(whole);
    drawLight(shaders, scene, depthScale, wants, lit, content.common(lit));
    drawn.rect = drawn.rect.joined(lit);
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
}

/// Whether a scan's colours are to be seen; then there is room for them.
bool ToothLayer::drawsScanned(const Scene& scene, const LayerWants& wants) {
    if (!scene.isScanned() || !wants.look.scanColours || wants.look.palette != Palette::natural) return false;
    const int w = surface_.width(), h = surface_.height();
    if (scanned_.width() != w || scanned_.height() != h) {
        scanned_.allocate(w, h, GL_RGBA8);
        scannedGeometry_.attach({&surface_, &scanned_}, &depth_);
    }
    return true;
}

std::size_t ToothLayer::drawSurface(Shaders& shaders, Scene& scene, const Sections& sections, const LayerWants& wants,
                                    const PixelRect& rect) {
    const Look& look = wants.look;
    geometry_.bind();
    setScissor(rect);
    glEnable(GL_DEPTH_TEST);
    glClearColor(1.0f, 1.0f, 1.0f, 1.0f);  // no normal
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    // The inside can be seen where something is cut away or left out.
    const bool open = look.cutAway.has_value() || visibleBits(look) != (1 << cases::kTissueCount) - 1;
    const Scene::InTheWay out = scene.inTheWay(eyeToSee(wants.eye));
    const Culler culler(wants.eye, wants.viewport, rect, !open && !out.plane);
    const Scene::Visible& visible = scene.visible(look, wants.detail, culler, out);
    const bool isScanned = drawsScanned(scene, wants);
    if (isScanned) scannedGeometry_.bind();  // cleared where there is a surface: by what is drawn there
    const auto draw = [&](const std::vector<const PooledMesh*>& meshes, const std::optional<Plane>& end) {
        const bool clipped = look.cutAway || end;
        gl::Program& program = isScanned ? (clipped ? shaders.scanned().clippedSurface : shaders.scanned().surface)
                                         : (clipped ? shaders.clippedSurface : shaders.surface);
        program.use();
        program.set("viewProjection", wants.eye.viewProjection());
        program.set("visibleTissues", visibleBits(look));
        if (clipped) {
            program.set("clipPlane", planeOf(look.cutAway));
            program.set("endPlane", planeOf(end));
            glEnable(GL_CLIP_DISTANCE0);
            glEnable(GL_CLIP_DISTANCE1);
        }
        if (open || (end && !wants.eye.clip)) {
            glDisable(GL_CULL_FACE);
        } else {
            glEnable(GL_CULL_FACE);
            glCullFace(GL_BACK);
        }
        const std::size_t drawn = scene.draw(meshes);
        glDisable(GL_CULL_FACE);
        glDisable(GL_CLIP_DISTANCE0);
        glDisable(GL_CLIP_DISTANCE1);
        return drawn;
    };
    // A mirror's eye ends all at the mirror, another only what is in the way.
    std::size_t triangles = draw(visible.tooth, wants.eye.clip);
    triangles += draw(visible.around, out.plane ? out.plane : wants.eye.clip);

    if (isScanned) geometry_.bind();
    if (!look.cutAway) return triangles;
    if (wants.sectionSerial != 0) triangles += drawSection(shaders, sections.own, wants);
    if (look.visible[static_cast<std::size_t>(cases::Tissue::neighbour)])
        for (const auto& [tooth, section] : sections.others)
            if (!out.teeth.contains(tooth)) triangles += drawSection(shaders, section, wants);
    return triangles;
}

std::size_t ToothLayer::drawSection(Shaders& shaders, const Section& section, const LayerWants& wants) {
    const Look& look = wants.look;
    const SectionFace& face = section.face;
    gl::Program& cap = shaders.cap;
    cap.use();
    cap.set("viewProjection", wants.eye.viewProjection());
    cap.set("visibleTissues", visibleBits(look));
    const auto step = static_cast<float>(face.mmPerPixel);
    cap.set("origin", Vec3f(face.originMm.cast<float>()));
    cap.set("uStep", Vec3f(step * face.uAxis.cast<float>()));
    cap.set("vStep", Vec3f(step * face.vAxis.cast<float>()));
    cap.set("size", Vec2f(static_cast<float>(face.width), static_cast<float>(face.height)));
    cap.set("mmPerPixel", step);
    cap.set("grid", look.sectionGrid ? 1 : 0);
    cap.set("gridOrigin", Vec2f(static_cast<float>(face.uAxis.dot(face.originMm)),
                                static_cast<float>(face.vAxis.dot(face.originMm))));
    cap.set("tissues", section.tissues, 0);
    none_.bind();
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    return 2;
}

void ToothLayer::drawOcclusion(Shaders& shaders, const LayerWants& wants, const PixelRect& half, int mostPixels) {
    if (half.isEmpty()) return;
    const gl::Mat4f& p = wants.eye.projection;
    const auto w = static_cast<float>(wants.viewport.width), h = static_cast<float>(wants.viewport.height);
    glViewport(0, 0, occlusion_.width(), occlusion_.height());
    occlusionTarget_.bind();
    setScissor(half);
    gl::Program& program = shaders.occlusion;
    program.use();
    program.set("surface", surface_, 0);
    program.set("depth", depth_, 1);
    program.set("toEye", gl::Mat3f(wants.eye.view.topLeftCorner<3, 3>()));
    // (x - p02 ... ) keeps an eye whose frustum leans right, as two eyes have.
    program.set("unproject", Vec4f(2.0f / (w * p(0, 0)), 2.0f / (h * p(1, 1)), (-1.0f + p(0, 2)) / p(0, 0),
                                   (-1.0f + p(1, 2)) / p(1, 1)));
    program.set("depthTerms", Vec2f(p(2, 2), p(2, 3)));
    program.set("radiusMm", kOcclusionMm);
    program.set("pixelsPerMm", 0.5f * h * std::abs(p(1, 1)));
    program.set("mostPixels", static_cast<float>(mostPixels));
    const bool coarse = wants.detail == Detail::coarse;
    const bool many = wants.look.quality == Quality::fine && wants.detail == Detail::full;
    const int samples = wants.look.quality == Quality::rich ? 24 : many ? 14 : 9;
    program.set("samples", coarse ? 6 : samples);
    program.set("turns", coarse ? 9.0f : 16.0f);
    program.set("lamp", gl::Vec3f(wants.eye.view.topLeftCorner<3, 3>() * wants.lighting.lamp));
    program.set("shadowMm", kShadowMm);
    program.set("shadowSteps", !wants.look.shadows ? 0 : coarse ? 4 : wants.look.quality == Quality::fast ? 6 : 10);
    gl::drawFullScreen();

    blurredTarget_.bind();
    const PixelRect wholeHalf{0, 0, occlusion_.width(), occlusion_.height()};
    setScissor(half.grown(2).common(wholeHalf));
    shaders.occlusionBlur.use();
    shaders.occlusionBlur.set("occlusion", occlusion_, 0);
    gl::drawFullScreen();
}

std::size_t ToothLayer::drawShadowMap(Shaders& shaders, Scene& scene, const LayerWants& wants) {
    if (shadow_.width() == 0) {
        shadow_.allocate(kShadowMapSize, kShadowMapSize, GL_DEPTH_COMPONENT24, true);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
        shadowTarget_.attach({}, &shadow_);
    }
    // Along the lamp's rays, wide enough for the tooth and what stands beside it.
    const Vec3f z = wants.lighting.lamp, x = wants.lighting.up.cross(z).normalized(), y = z.cross(x);
    core::Box box = scene.toothBounds().isEmpty() ? scene.bounds() : scene.toothBounds();
    const Vec3f centre = box.isEmpty() ? Vec3f::Zero() : Vec3f(box.centre().cast<float>());
    const float radius = box.isEmpty() ? 10.0f : 0.5f * static_cast<float>(box.size().norm()) + 2.0f;
    gl::Mat4f view = gl::Mat4f::Identity();
    view.block<1, 3>(0, 0) = x.transpose() / radius;
    view.block<1, 3>(1, 0) = y.transpose() / radius;
    view.block<1, 3>(2, 0) = -z.transpose() / (3.0f * radius);
    view.block<3, 1>(0, 3) = -(view.topLeftCorner<3, 3>() * centre);
    gl::Mat4f bias = gl::Mat4f::Identity() * 0.5f;
    bias.block<3, 1>(0, 3).setConstant(0.5f);
    bias(3, 3) = 1.0f;
    toShadow_ = bias * view;

    shadowTarget_.bind();
    const Viewport viewport{kShadowMapSize, kShadowMapSize};
    const PixelRect rect{0, 0, kShadowMapSize, kShadowMapSize};
    glViewport(0, 0, kShadowMapSize, kShadowMapSize);
    setScissor(rect);
    glEnable(GL_DEPTH_TEST);
    glClear(GL_DEPTH_BUFFER_BIT);
    glDisable(GL_CULL_FACE);
    Eye lamp;
    lamp.view = view;
    // What is left out of the picture throws no shadow.
    const Scene::InTheWay out = scene.inTheWay(eyeToSee(wants.eye));
    const Scene::Visible& visible = scene.visible(wants.look, wants.detail, Culler(lamp, viewport, rect, false), out);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5f, 4.0f);
    const auto draw = [&](const std::vector<const PooledMesh*>& meshes, const std::optional<Plane>& end) {
        const bool clipped = wants.look.cutAway || end;
        gl::Program& program = clipped ? shaders.clippedSurface : shaders.surface;
        program.use();
        program.set("viewProjection", view);
        program.set("visibleTissues", visibleBits(wants.look));
        if (clipped) {
            program.set("clipPlane", planeOf(wants.look.cutAway));
            program.set("endPlane", planeOf(end));
            glEnable(GL_CLIP_DISTANCE0);
            glEnable(GL_CLIP_DISTANCE1);
        }
        const std::size_t drawn = scene.draw(meshes);
        glDisable(GL_CLIP_DISTANCE0);
        glDisable(GL_CLIP_DISTANCE1);
        return drawn;
    };
    const std::size_t triangles = draw(visible.tooth, {}) + draw(visible.around, out.plane);
    glDisable(GL_POLYGON_OFFSET_FILL);
    return triangles;
}

void ToothLayer::renewBackground(Shaders& shaders, const LayerWants& wants) {
    const auto &top = wants.look.backgroundTop, &bottom = wants.look.backgroundBottom;
    const std::array<std::uint8_t, 6> colours = {top[0], top[1], top[2], bottom[0], bottom[1], bottom[2]};
    if (backgroundDrawn_ && colours == backgroundColours_) return;
    backgroundTarget_.bind();
    setScissor({0, 0, wants.viewport.width, wants.viewport.height});
    glDisable(GL_DEPTH_TEST);
    shaders.background.use();
    shaders.background.set("top", plain(top));
    shaders.background.set("bottom", plain(bottom));
    gl::drawFullScreen();
    backgroundColours_ = colours;
    backgroundDrawn_ = true;
}

void ToothLayer::drawLight(Shaders& shaders, const Scene& scene, const gl::Texture& depthScale, const LayerWants& wants,
                           const PixelRect& rect, const PixelRect& content) {
    const Look& look = wants.look;
    renewBackground(shaders, wants);
    // The background as kept; then a copy of the depth lets light through only where there is a surface.
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, backgroundTarget_.name());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, lit_.name());
    glBlitFramebuffer(rect.x0, rect.y0, rect.x1, rect.y1, rect.x0, rect.y0, rect.x1, rect.y1, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, both_.name());
    glDepthMask(GL_TRUE);
    glBlitFramebuffer(rect.x0, rect.y0, rect.x1, rect.y1, rect.x0, rect.y0, rect.x1, rect.y1, GL_DEPTH_BUFFER_BIT,
                      GL_NEAREST);
    glDepthMask(GL_FALSE);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    lit_.bind();
    glDepthFunc(GL_GREATER);
    setScissor(content);
    const bool shadows = look.quality == Quality::rich && look.shadows;
    const bool isPlain = look.quality == Quality::fast || wants.detail == Detail::coarse;
    const bool isScanned = drawsScanned(scene, wants);
    gl::Program& light = isScanned ? (shadows   ? shaders.scanned().shadowedLight
                                      : isPlain ? shaders.scanned().light
                                                : shaders.scanned().fineLight)
                         : shadows ? shaders.shadowedLight
                         : isPlain ? shaders.light
                                   : shaders.fineLight;
    light.use();
    if (isScanned) light.set("scanned", scanned_, 6);
    light.set("surface", surface_, 0);
    light.set("depth", depth_, 1);
    light.set("occlusion", blurred_, 2);
    light.set("depthScale", depthScale, 3);
    if (shadows) {
        light.set("shadowMap", shadow_, 4);
        light.set("toShadow", toShadow_);
    }
    light.set("toTooth", gl::Mat4f(wants.eye.viewProjection().inverse()));
    const gl::Mat4f& p = wants.eye.projection;
    light.set("depthTerms", Vec2f(p(2, 2), p(2, 3)));
    light.set("eye", wants.eye.positionMm);
    light.set("lamp", wants.lighting.lamp);
    light.set("sky", wants.lighting.sky);
    light.set("eyeRight", wants.lighting.right);
    const auto colours = palette(look.palette);
    light.set("palette", colours.data(), kKinds);
    static const auto kMaterials = materials();
    light.set("material", kMaterials.data(), kKinds);
    light.set("wet", look.wet ? 1.0f : 0.0f);
    light.set("natural", look.palette == Palette::natural && !look.removedDepthColours ? 1 : 0);
    scene.overDentine().give(light, 5);
    const core::Box& box = scene.toothBounds();
    const double top = box.isEmpty() ? 0.0 : box.max.z();
    light.set("crown", Vec2f(static_cast<float>(top - kCrownMm), static_cast<float>(top)));
    light.set("removedColours", look.removedDepthColours ? 1 : 0);
    light.set("removedMost", static_cast<float>(std::max(1e-3, look.deviationMostMm > 0.0 ? 2.0 * look.deviationMostMm
                                                                                          : look.removedDepthMostMm)));
    gl::drawFullScreen();
    glDepthFunc(GL_LESS);
}

}  // namespace handpiece::view
