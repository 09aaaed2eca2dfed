// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/renderer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/senses/view/effects.h"
#include "handpiece/senses/view/effects_glass.h"
#include "handpiece/senses/view/gl.h"
#include "handpiece/senses/view/instruments.h"
#include "handpiece/senses/view/passes.h"
#include "handpiece/senses/view/scene.h"
#include "handpiece/senses/view/shaders.h"
#include "handpiece/senses/view/smoothing.h"
#include "handpiece/senses/view/tooth_layer.h"

namespace handpiece::view {
namespace {

constexpr int kMaxSize = 8192;
/// Pictures for which the eye must have stood still before full detail comes back.
constexpr int kRestPictures = 2;
/// While the eye moves, quick pictures of a software renderer are drawn with no more pixels and made larger.
constexpr double kMotionPixels = 380e3;

double nowMs() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool sameCamera(const Camera& a, const Camera& b) {
    return a.eyeMm == b.eyeMm && a.targetMm == b.targetMm && a.up == b.up && a.fieldOfViewRad == b.fieldOfViewRad &&
           a.mirrored == b.mirrored;
}

/// Whose plane a section's face is: the numbers may have gone through a file.
bool samePlane(const Plane& a, const Plane& b) {
    return (a.normal - b.normal).norm() < 1e-6 && std::abs(a.offsetMm - b.offsetMm) < 1e-6;
}

/// Edges are smoothed after the drawing, not at all while a quick picture moves: by the card, or, of a software
/// renderer's picture, once it has been read.
enum class Smoothing { none, drawn, read };

/// What one eye sees, kept from picture to picture.
struct EyeTarget {
    ToothLayer layer;
    gl::Texture colour, depth, smoothed;
    gl::Framebuffer composed, smooth;
    Image rough;                     ///< as read, to be smoothed
    std::uint64_t layerSerial = 0;   ///< of the layer's picture in this one
    PixelRect instruments, passing;  ///< where instruments, and the rest over the tooth, lay in the last picture
    std::uint64_t appearance = 0;    ///< of the instruments, then
    Smoothing was = Smoothing::none;
    // Its pictures are counted; what changed in each of the last ones is kept, for those who read them.
    std::uint64_t source = 0, number = 0;
    std::array<PixelRect, 8> changed;

    void change(const PixelRect& rect) { changed[++number % changed.size()] = rect; }
    /// Of what `held` shows: to be read again.
    [[nodiscard]] PixelRect changedSince(const Image::Picture& held) const {
        if (held.source != source || number - held.number > changed.size())
            return {0, 0, colour.width(), colour.height()};
        PixelRect rect;
        for (std::uint64_t i = held.number + 1; i <= number; ++i)
            rect = rect.joined(changed[i % changed.size()]);
        return rect;
    }

    void allocate(const Viewport& viewport) {
        if (colour.width() == viewport.width && colour.height() == viewport.height) return;
        colour.allocate(viewport.width, viewport.height, GL_RGBA8, true);
        depth.allocate(viewport.width, viewport.height, GL_DEPTH_COMPONENT24);
        smoothed.allocate(viewport.width, viewport.height, GL_RGBA8);
        composed.attach({&colour}, &depth);
        smooth.attach({&smoothed}, nullptr);
        instruments = {0, 0, viewport.width, viewport.height};
        appearance = 0;
        was = Smoothing::none;
        static std::atomic<std::uint64_t> sources{0};
        source = ++sources;
    }
};

}  // namespace

struct Renderer::State {
    gl::Context context;
    Shaders shaders;
    Scene scene;
    Instruments instruments;
    Sections sections;
    std::optional<Plane> othersPlane;  ///< of sections.others
    std::uint64_t othersEpoch = 0;
    gl::Texture depthScale;
    double depthScaleMm = -1.0, deviationScaleMm = 0.0;
    gl::VertexArray none;
    EyeTarget left, right, mirror, moving;
    std::vector<std::unique_ptr<Pass>> effects;
    GlassPass glass;
    Image rightPicture, leftPicture, smallPicture;

    std::optional<Camera> camera;
    std::optional<Look> lastLook;  ///< drawn
    Viewport viewport;
    int still = 0;
    bool responsive = false;

    State() : effects(makeEffects([this] { return instruments.headRadiusMm(); })) {}

    void renewDepthScale(const Look& look);
    void renewSections(const Look& look);
    [[nodiscard]] bool isSmall(double mm, const Camera& from, const Viewport& size, const Look& look) const;
    Detail detailFor(const Camera& to, const Viewport& size, const Look& look, FrameReport& report);
    [[nodiscard]] LayerWants wantsFor(const Eye& eye, const Viewport& size, const Look& look, const Lighting& lighting,
                                      Detail detail) const;
    std::size_t drawGhost(const Eye& eye, const Viewport& size, const PixelRect& rect, const Look& look,
                          const Lighting& lighting);
    const gl::Texture& drawReflection(const Eye& eye, const Viewport& size, const Look& look, const Moment& moment,
                                      const Lighting& lighting, FrameReport& report);
    void drawEye(EyeTarget& target, const Camera& from, const Eye& eye, const Viewport& size, const Look& look,
                 const Moment& moment, Detail detail, FrameReport& report);
    void smooth(const EyeTarget& target, const PixelRect& rect);
    bool drawSmall(const Camera& camera, const Viewport& size, const Look& look, const Moment& moment, Detail detail,
                   Image& out, FrameReport& report);
    void read(EyeTarget& from, Image& out, FrameReport& report) const;
};

void Renderer::State::renewDepthScale(const Look& look) {
    const double mostMm = look.removedDepthMostMm;
    if (mostMm == depthScaleMm && look.deviationMostMm == deviationScaleMm) return;
    depthScaleMm = mostMm;
    deviationScaleMm = look.deviationMostMm;
    constexpr int kSteps = 256;
    std::vector<std::uint8_t> colours;
    for (int i = 0; i < kSteps; ++i) {
        const double share = static_cast<double>(i) / (kSteps - 1);
        const auto c = deviationScaleMm > 0.0 ? deviationColour(2.0 * share - 1.0, 1.0)
                                              : removedDepthColour(mostMm * share, mostMm);
        colours.insert(colours.end(), {c[0], c[1], c[2], 255});
    }
    depthScale.fill(kSteps, 1, GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, colours.data(), true);
}

void Renderer::State::renewSections(const Look& look) {
    if (othersPlane == look.cutAway && othersEpoch == scene.epoch()) return;
    othersPlane = look.cutAway;
    othersEpoch = scene.epoch();
    sections.others.clear();
    if (!look.cutAway) return;
    for (auto& [tooth, face] : scene.othersCutBy(*look.cutAway)) {
        sections.others.emplace_back();
        sections.others.back().first = tooth;
        sections.others.back().second.set(std::move(face));
    }
}

Detail Renderer::State::detailFor(const Camera& to, const Viewport& size, const Look& look, FrameReport& report) {
    const bool moved =
        camera && (!sameCamera(*camera, to) || viewport.width != size.width || viewport.height != size.height ||
                   (responsive && lastLook && !sameTooth(*lastLook, look)));
    lastLook = look;
    if (!camera)
        still = kRestPictures;
    else
        still = moved ? 0 : std::min(still + 1, kRestPictures);
    camera = to;
    viewport = size;
    const bool mayBeCoarse =
        scene.hasCoarse() && (look.quality == Quality::fast || (look.quality == Quality::fine && context.isSoftware()));
    report.refining = still < kRestPictures;
    if (!report.refining) return Detail::full;
    // All of it looks the same from afar.
    if (!(scene.hasCoarse() && look.quality == Quality::fast) && isSmall(Scene::kNearMm, to, size, look))
        return Detail::near;
    return mayBeCoarse ? Detail::coarse : Detail::full;
}

/// Whether so much of the tooth as it is, wherever it is seen, is less than half a pixel.
bool Renderer::State::isSmall(double mm, const Camera& from, const Viewport& size, const Look& look) const {
    if (!context.isSoftware() || !scene.hasNear() || look.tooth != ToothShown::now || look.removedDepthColours ||
        look.quality == Quality::rich)
        return false;
    const core::Box& box = scene.toothBounds();
    double depthMm = 1e300;
    for (int corner = 0; corner < 8; ++corner) {
        const core::Vec3 at((corner & 1) != 0 ? box.max.x() : box.min.x(),
                            (corner & 2) != 0 ? box.max.y() : box.min.y(),
                            (corner & 4) != 0 ? box.max.z() : box.min.z());
        depthMm = std::min(depthMm, from.forward().dot(at - from.eyeMm));
    }
    const double pixelMm = 2.0 * depthMm * std::tan(0.5 * from.fieldOfViewRad) / size.height;
    // Along the line of sight, towards the picture's corners, it shows by a little more than across.
    return 1.1 * mm <= 0.5 * pixelMm;
}

LayerWants Renderer::State::wantsFor(const Eye& eye, const Viewport& size, const Look& look, const Lighting& lighting,
                                     Detail detail) const {
    LayerWants wants{eye, size, look, lighting, detail, 0};
    if (look.cutAway && sections.own.serial != 0 && samePlane(*look.cutAway, sections.own.face.plane))
        wants.sectionSerial = sections.own.serial;
    return wants;
}

std::size_t Renderer::State::drawGhost(const Eye& eye, const Viewport& size, const PixelRect& rect, const Look& look,
                                       const Lighting& lighting) {
    const Culler culler(eye, size, rect, true);
    const auto& meshes = scene.cutAway(culler, scene.inTheWay(eyeToSee(eye)));
    gl::Program& program = shaders.ghost;
    program.use();
    program.set("viewProjection", eye.viewProjection());
    program.set("eye", eye.positionMm);
    program.set("lamp", lighting.lamp);
    program.set("clipPlane", planeOf(look.cutAway));
    program.set("mirrorPlane", planeOf(eye.clip));
    glEnable(GL_CULL_FACE);
    glFrontFace(eye.mirrored ? GL_CCW : GL_CW);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    const std::size_t triangles = scene.draw(meshes);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glDisable(GL_CULL_FACE);
    return triangles;
}

namespace {
void copy(const gl::Framebuffer& from, const gl::Framebuffer& to, const PixelRect& r, GLbitfield what) {
    if (r.isEmpty()) return;
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from.name());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to.name());
    glBlitFramebuffer(r.x0, r.y0, r.x1, r.y1, r.x0, r.y0, r.x1, r.y1, what, GL_NEAREST);
    glEnable(GL_SCISSOR_TEST);
    to.bind();
}
void scissorTo(const PixelRect& r) {
    glScissor(r.x0, r.y0, std::max(0, r.x1 - r.x0), std::max(0, r.y1 - r.y0));
}
}  // namespace

const gl::Texture& Renderer::State::drawReflection(const Eye& eye, const Viewport& size, const Look& look,
                                                   const Moment& moment, const Lighting& lighting,
                                                   FrameReport& report) {
    mirror.allocate(size);
    const Detail detail = context.isSoftware() && scene.hasCoarse() ? Detail::coarse : Detail::full;
    Look seen = look;
    // One shadow map a picture is enough, and it is the main eye's.
    if (seen.quality == Quality::rich) seen.quality = Quality::fine;
    const PixelRect whole{0, 0, size.width, size.height};
    // What the glass shows, the lamp lights by way of the glass too: mostly from there.
    Lighting also = lighting;
    if (eye.clip) {
        const gl::Vec3f n = eye.clip->normal.cast<float>();
        also.lamp = (0.5f * lighting.lamp + lighting.lamp - 2.0f * n.dot(lighting.lamp) * n).normalized();
        if (-n.dot(lighting.lamp) <= 0.0f) also.lamp = lighting.lamp;
    }
    report.triangles +=
        mirror.layer.update(shaders, scene, sections, depthScale, wantsFor(eye, size, seen, also, detail)).triangles;
    copy(mirror.layer.framebuffer(), mirror.composed, whole, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glViewport(0, 0, size.width, size.height);
    const PixelRect shadow = instruments.shadowRect(eye, size, look, moment, lighting).common(whole);
    if (!shadow.isEmpty()) {
        scissorTo(shadow);
        none.bind();
        instruments.drawShadow(shaders, eye, size, shadow, moment, lighting, mirror.layer.depth());
    }
    scissorTo(whole);
    report.triangles += instruments.draw(shaders, eye, size, whole, look, moment, lighting);
    return mirror.colour;
}

void Renderer::State::drawEye(EyeTarget& target, const Camera& from, const Eye& eye, const Viewport& size,
                              const Look& look, const Moment& moment, Detail detail, FrameReport& report) {
    const PixelRect whole{0, 0, size.width, size.height};
    const Lighting lighting = lightingOf(from);
    target.allocate(size);
    const ToothLayer::Drawn drawn =
        target.layer.update(shaders, scene, sections, depthScale, wantsFor(eye, size, look, lighting, detail),
                            responsive ? ToothLayer::Haste::refined : ToothLayer::Haste::whole);
    report.triangles += drawn.triangles;
    report.toothRedrawn = report.toothRedrawn || drawn.all;
    report.refining = report.refining || !target.layer.isComplete();
    report.preparing = report.preparing || target.layer.owes();

    PassContext context_{from,
                         size,
                         eye,
                         look,
                         moment,
                         lighting.lamp,
                         target.layer.depth(),
                         target.depth,
                         target.layer.colour(),
                         target.composed.name(),
                         whole,
                         context.isSoftware(),
                         [&](const Eye& other, int width, int height) -> const gl::Texture& {
                             return drawReflection(other, {width, height}, look, moment, lighting, report);
                         }};
    const core::Box& bounds = scene.bounds();
    const PixelRect content =
        bounds.isEmpty() ? PixelRect{} : rectOf(bounds.min.cast<float>(), bounds.max.cast<float>(), eye, size);
    const PixelRect shadow = instruments.shadowRect(eye, size, look, moment, lighting).common(content);
    const PixelRect solid = shadow.joined(instruments.rect(eye, size, look, moment).common(whole));
    PixelRect passing;
    std::vector<Pass*> passes;
    for (const auto& effect : effects) {
        const PixelRect touched = effect->touches(context_).common(whole);
        if (touched.isEmpty()) continue;
        passing = passing.joined(touched);
        passes.push_back(effect.get());
    }
    if (const PixelRect touched = glass.touches(context_).common(whole); !touched.isEmpty()) {
        passing = passing.joined(touched);
        passes.push_back(&glass);
    }
    const bool ghost = look.tooth == ToothShown::ghost && scene.isCut();
    const PixelRect ghostRect = ghost ? scene.rectOfCut(eye, size).common(whole) : PixelRect{};
    passing = passing.joined(ghostRect);

    const bool quick = look.quality == Quality::fast;
    const Smoothing smoothing = quick && report.refining ? Smoothing::none
                                : context.isSoftware()   ? Smoothing::read
                                                         : Smoothing::drawn;
    PixelRect dirty = passing.joined(target.passing).joined(drawn.rect);
    // Instruments that look as they did are there already.
    const std::uint64_t appearance = instruments.appearance(moment, look);
    if (appearance != target.appearance) dirty = dirty.joined(solid).joined(target.instruments);
    dirty = dirty.common(whole);
    const bool all = drawn.all || target.layerSerial != target.layer.serial() || smoothing != target.was;
    target.layerSerial = target.layer.serial();
    if (all) dirty = whole;
    target.instruments = solid;
    target.passing = passing;
    target.appearance = appearance;
    target.was = smoothing;
    target.change(smoothing == Smoothing::none || dirty.isEmpty() ? dirty : dirty.grown(kSmoothMargin).common(whole));
    if (dirty.isEmpty()) return;

    copy(target.layer.framebuffer(), target.composed, dirty, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glViewport(0, 0, size.width, size.height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glFrontFace(GL_CW);
    if (const PixelRect darkened = shadow.common(dirty); !darkened.isEmpty()) {
        scissorTo(darkened);
        none.bind();
        instruments.drawShadow(shaders, eye, size, darkened, moment, lighting, target.layer.depth());
    }
    scissorTo(dirty);
    context_.scissor = dirty;
    report.triangles += instruments.draw(shaders, eye, size, dirty, look, moment, lighting);
    if (ghost) report.triangles += drawGhost(eye, size, ghostRect, look, lighting);
    for (Pass* pass : passes)
        report.triangles += pass->draw(context_);

    if (smoothing == Smoothing::drawn) smooth(target, target.changed[target.number % target.changed.size()]);
}

void Renderer::State::smooth(const EyeTarget& target, const PixelRect& rect) {
    target.smooth.bind();
    glDisable(GL_DEPTH_TEST);
    none.bind();
    shaders.smooth.use();
    shaders.smooth.set("picture", target.colour, 0);
    shaders.smooth.set("pixel", gl::Vec2f(1.0f / static_cast<float>(target.colour.width()),
                                          1.0f / static_cast<float>(target.colour.height())));
    scissorTo(rect);
    gl::drawFullScreen();
    glEnable(GL_DEPTH_TEST);
}

/// A picture in motion, drawn small and made as large as asked for; whether that is worth it.
bool Renderer::State::drawSmall(const Camera& from, const Viewport& size, const Look& look, const Moment& moment,
                                Detail detail, Image& out, FrameReport& report) {
    const double scale = std::sqrt(kMotionPixels / (static_cast<double>(size.width) * size.height));
    if (look.quality != Quality::fast || !context.isSoftware() || scale > 0.9 || detail == Detail::near) return false;
    if (detail == Detail::full) {
        // A small picture goes on being shown until the large one is there, unseen, strip by strip.
        if (!responsive || !moving.layer.isComplete() || !scene.hasCoarse()) return false;
        const LayerWants wants = wantsFor(eyeOf(from, size), size, look, lightingOf(from), Detail::full);
        if (left.layer.isComplete(scene, wants)) return false;
        report.triangles +=
            left.layer.update(shaders, scene, sections, depthScale, wants, ToothLayer::Haste::strips).triangles;
        if (left.layer.isComplete()) return false;
        detail = Detail::coarse;
        report.refining = true;
    }
    const Viewport small{static_cast<int>(std::lround(scale * size.width)),
                         static_cast<int>(std::lround(scale * size.height))};
    drawEye(moving, from, eyeOf(from, small), small, look, moment, detail, report);
    smallPicture.blueFirst = out.blueFirst;
    read(moving, smallPicture, report);
    enlarge(smallPicture, size, out);
    out.picture = {};
    return true;
}

namespace {
/// Brings `out` up to the target's picture; the part of it that changed.
PixelRect readChanged(const EyeTarget& from, const gl::Framebuffer* picture, Image& out) {
    const int width = from.colour.width(), height = from.colour.height();
    const std::size_t bytes = 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (out.width != width || out.height != height || out.rgba.size() != bytes) out.picture = {};
    out.width = width;
    out.height = height;
    out.rgba.resize(bytes);
    const PixelRect rect = from.changedSince(out.picture);
    out.picture = {from.source, from.number};
    if (rect.isEmpty() || picture == nullptr) return rect;
    picture->bind();
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glPixelStorei(GL_PACK_ROW_LENGTH, width);
    glReadPixels(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0, out.blueFirst ? GL_BGRA : GL_RGBA,
                 GL_UNSIGNED_BYTE,
                 &out.rgba[4 * (static_cast<std::size_t>(rect.y0) * static_cast<std::size_t>(width) +
                                static_cast<std::size_t>(rect.x0))]);
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
    return rect;
}
}  // namespace

void Renderer::State::read(EyeTarget& from, Image& out, FrameReport& report) const {
    glFinish();
    const double begin = nowMs();
    if (from.was == Smoothing::read) {
        if (from.rough.blueFirst != out.blueFirst) from.rough.picture = {};
        from.rough.blueFirst = out.blueFirst;
        readChanged(from, &from.composed, from.rough);
        smoothEdges(from.rough, readChanged(from, nullptr, out), out);
    } else {
        readChanged(from, from.was == Smoothing::drawn ? &from.smooth : &from.composed, out);
    }
    report.readMs += nowMs() - begin;
}

Renderer::Renderer() : state_(std::make_unique<State>()) {}
Renderer::~Renderer() {
    state_->context.makeCurrent();
}

const std::string& Renderer::description() const noexcept {
    return state_->context.description();
}
bool Renderer::isSoftware() const noexcept {
    return state_->context.isSoftware();
}

void Renderer::setTooth(const core::Box& bounds) {
    state_->context.makeCurrent();
    state_->scene.setTooth(bounds);
    state_->instruments.setWork(bounds);
    state_->glass.set({});
}

void Renderer::updateBricks(std::span<const surface::BrickUpdate> bricks, bool before) {
    state_->context.makeCurrent();
    state_->scene.updateBricks(bricks, before);
}

void Renderer::setMesh(const geometry::TriangleMesh& mesh, cases::Tissue tissue,
                       const geometry::VertexColours& colours) {
    state_->context.makeCurrent();
    state_->scene.setMesh(mesh, tissue, colours);
    state_->instruments.setWork(mesh.bounds());
    state_->glass.set({});
}

void Renderer::setOthers(std::shared_ptr<const std::vector<cases::PlacedTooth>> others) {
    state_->context.makeCurrent();
    state_->scene.setOthers(std::move(others));
}

void Renderer::setScenery(std::span<const cases::Part> parts) {
    state_->context.makeCurrent();
    state_->scene.setScenery(parts);
}

void Renderer::setGingivaCuts(std::vector<messages::GingivaCut> cuts, const core::Vec3& down) {
    state_->scene.setGingivaCuts(std::move(cuts), down);
}

void Renderer::setParts(std::span<const cases::Part> parts) {
    state_->context.makeCurrent();
    state_->scene.setParts(parts);
}

void Renderer::setBur(const geometry::TriangleMesh& mesh, double headLengthMm, double headRadiusMm, BurFinish finish) {
    state_->context.makeCurrent();
    state_->instruments.setBur(mesh, headLengthMm, headRadiusMm, finish);
}

void Renderer::setTurbine(const geometry::TriangleMesh& mesh) {
    state_->context.makeCurrent();
    state_->instruments.setTurbine(mesh);
}

void Renderer::setGlass(const std::vector<GlassSurface>& surfaces) {
    state_->context.makeCurrent();
    state_->glass.set(surfaces);
}

void Renderer::setResponsive(bool responsive) {
    state_->responsive = responsive;
}

void Renderer::setSectionFace(SectionFace face) {
    state_->context.makeCurrent();
    const auto pixels =
        static_cast<std::size_t>(std::max(0, face.width)) * static_cast<std::size_t>(std::max(0, face.height));
    if (pixels == 0 || face.tissue.size() != pixels || (!face.away.empty() && face.away.size() != pixels) ||
        !(face.mmPerPixel > 0.0))
        throw core::Error("a section's face has no size, or not one tissue a pixel", "section face",
                          "give width x height tissues and a positive size of a pixel");
    state_->sections.own.set(std::move(face));
}

FrameReport Renderer::draw(const Camera& camera, const Viewport& viewport, const Look& look, const Moment& moment,
                           Image& out) {
    if (viewport.width < 1 || viewport.height < 1 || viewport.width > kMaxSize || viewport.height > kMaxSize)
        throw core::Error("a picture cannot have this size", "viewport", "choose 1 to 8192 pixels a side");
    State& s = *state_;
    s.context.makeCurrent();
    FrameReport report;
    const double begin = nowMs();
    s.renewDepthScale(look);
    s.renewSections(look);
    report.bleeding = s.scene.bleed(moment.timeS);
    const Detail detail = s.detailFor(camera, viewport, look, report);
    const std::uint64_t drawnBefore = s.left.number;
    const bool one = look.stereo == Stereo::none;
    if (one && s.drawSmall(camera, viewport, look, moment, detail, out, report)) {
        // Done.
    } else if (one) {
        s.drawEye(s.left, camera, eyeOf(camera, viewport), viewport, look, moment, detail, report);
        s.read(s.left, out, report);
    } else {
        const Viewport each = stereoViewport(viewport, look.stereo);
        s.drawEye(s.left, camera, stereoEye(camera, each, look.eyeSeparationMm, -1), each, look, moment, detail,
                  report);
        s.read(s.left, s.leftPicture, report);
        s.drawEye(s.right, camera, stereoEye(camera, each, look.eyeSeparationMm, 1), each, look, moment, detail,
                  report);
        s.read(s.right, s.rightPicture, report);
        composeStereo(s.leftPicture, s.rightPicture, viewport, look.stereo, out);
        out.picture = {};
        if (out.blueFirst)
            for (std::size_t i = 0; i + 3 < out.rgba.size(); i += 4)
                std::swap(out.rgba[i], out.rgba[i + 2]);
    }
    // In pictures in which nothing changes, a window gets ready for an eye that moves.
    if (s.responsive && s.context.isSoftware() && !report.refining) {
        if (s.left.number == drawnBefore + 1 && s.left.changed[s.left.number % s.left.changed.size()].isEmpty())
            s.scene.simplifySome();
        report.preparing = report.preparing || s.scene.isStale();
    }
    gl::check("a picture");
    report.drawMs = nowMs() - begin - report.readMs;
    return report;
}

}  // namespace handpiece::view
