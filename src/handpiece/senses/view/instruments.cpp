// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/instruments.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/base/geometry/mesh_io.h"
#include "handpiece/model/instrument/catalogue.h"
#include "handpiece/model/instrument/turbine.h"
#include "handpiece/senses/view/mesh_pieces.h"

namespace handpiece::view {
namespace {

using gl::Mat4f;
using gl::Vec3f;

constexpr float kShadowReachMm = 6.0f;
constexpr double kShankRadiusMm = 0.8;  // ISO 1797 type 3, friction grip: 1.6 mm wide [R]
constexpr double kBurEndMm = 19.0;      // where a friction-grip bur ends, of ISO 1797 type 3 [R]: in the head
constexpr double kShankShadowMm = 3.5;  // what lies higher throws its shadow beyond the tooth
constexpr float kSoftMm = 0.8f;         // beyond a shadow's core its edge darkens by less than a step
constexpr float kNearMm = 1.6f;         // beyond that nearness darkens by less than a step
/// What is seen through lies over a place this wide about the bur's tip; the crown of a molar is 11 mm wide [R].
constexpr float kSiteMm = 8.0f;
/// So far above the bur's head a thing begins to hide its work, and so much farther it is glass over all of that place.
constexpr float kGlassFromMm = 1.0f, kGlassOverMm = 7.0f;
/// So far above the bur's head its shank begins to go, where the handpiece's head is not drawn.
constexpr float kHeldOverMm = 2.5f;
/// Cosines of bur's axis and line of sight between which that place grows until it holds the whole handpiece.
constexpr float kBeside = 0.70f, kAlong = 0.92f;
/// Nearer to the eye than these shares of the tip's distance a thing is not shown, or less and less.
constexpr float kGoneShare = 0.15f, kWholeShare = 0.4f;
/// Pieces of this size are left out where they are turned away.
constexpr double kBurCellMm = 1.5, kTurbineCellMm = 4.0;
/// Turns a second above which one sees a blur.
constexpr double kBlurRpm = 600.0;

Mat4f matrixOf(const core::Pose& pose) {
    Mat4f m = Mat4f::Identity();
    m.topLeftCorner<3, 3>() = pose.orientation.toRotationMatrix().cast<float>();
    m.topRightCorner<3, 1>() = pose.positionMm.cast<float>();
    return m;
}

/// A capsule along the bur's axis.
struct Capsule {
    Vec3f begin, end;
    float radius;
};
struct Capsules {
    std::array<Capsule, 2> parts;
};

}  // namespace

void Instruments::set(Solid& solid, const geometry::TriangleMesh& mesh, double creaseRad, double cellMm) {
    ++appearance_;
    for (const PooledMesh& old : solid.meshes)
        pool_.remove(old);
    solid = {};
    const core::Box box = mesh.bounds();
    if (box.isEmpty()) return;
    solid.minMm = box.min.cast<float>();
    solid.maxMm = box.max.cast<float>();
    for (const MeshPiece& piece : piecesOf(mesh, cases::Tissue::none, creaseRad, cellMm))
        solid.meshes.push_back(pool_.add(piece));
}

namespace {
using Outline = std::vector<std::pair<double, double>>;  // radius, height

void addTurned(geometry::TriangleMesh& mesh, const Outline& outline) {
    constexpr std::uint32_t kSides = 32;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& [r, z] : outline)
        for (std::uint32_t k = 0; k < kSides; ++k) {
            const double angle = 2.0 * std::numbers::pi * k / kSides;
            mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
        }
    for (std::uint32_t ring = 0; ring + 1 < outline.size(); ++ring)
        for (std::uint32_t k = 0; k < kSides; ++k) {
            const std::uint32_t a = first + ring * kSides + k, b = first + ring * kSides + (k + 1) % kSides;
            mesh.triangles.push_back({a, b, b + kSides});
            mesh.triangles.push_back({a, b + kSides, a + kSides});
        }
}

/// The shank that a bur's mesh does not have: from the mesh's top through a neck to the handpiece. False: it has one.
bool addShank(geometry::TriangleMesh& mesh) {
    const double topMm = mesh.bounds().max.z();
    if (!(topMm < instrument::kBurReachMm)) return false;
    double radiusMm = 0.0;
    for (const core::Vec3& v : mesh.vertices)
        if (v.z() > topMm - 0.05) radiusMm = std::max(radiusMm, v.head<2>().norm());
    const double neckMm = std::min(radiusMm, 0.45), wideMm = std::min(topMm + 3.5, instrument::kBurReachMm);
    addTurned(mesh, {{0.98 * radiusMm, topMm - 0.02},
                     {neckMm, std::min(topMm + 0.25, wideMm)},
                     {neckMm, std::min(topMm + 0.9, wideMm)},
                     {kShankRadiusMm, wideMm},
                     {kShankRadiusMm, instrument::kBurReachMm}});
    return true;
}

/// The part of it that the handpiece holds, rounded off at its end.
geometry::TriangleMesh shankEnd() {
    Outline outline;
    for (double z = instrument::kBurReachMm; z < kBurEndMm - 0.5; z += 1.0)
        outline.emplace_back(kShankRadiusMm, z);
    constexpr double kRoundMm = 0.35;
    for (int i = 0; i <= 4; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / 4.0;
        outline.emplace_back(kShankRadiusMm - kRoundMm * (1.0 - std::cos(angle)),
                             kBurEndMm - kRoundMm * (1.0 - std::sin(angle)));
    }
    outline.emplace_back(0.0, kBurEndMm + 0.06);
    geometry::TriangleMesh mesh;
    addTurned(mesh, outline);
    return mesh;
}
}  // namespace

void Instruments::setBur(const geometry::TriangleMesh& head, double headLengthMm, double headRadiusMm,
                         BurFinish finish) {
    finish_ = finish;
    geometry::TriangleMesh mesh = head;
    const bool added = addShank(mesh);
    set(bur_, mesh, 0.6, kBurCellMm);
    set(shankEnd_, added ? shankEnd() : geometry::TriangleMesh{}, 0.6, kBurCellMm);
    headLengthMm_ = headLengthMm;
    headRadiusMm_ = headRadiusMm;
    topMm_ = std::max<double>(bur_.maxMm.z(), headLengthMm + 0.1);
    shankRadiusMm_ = 0.0;
    for (const core::Vec3& v : mesh.vertices)
        if (v.z() > 0.5 * (headLengthMm + topMm_)) shankRadiusMm_ = std::max(shankRadiusMm_, v.head<2>().norm());
    if (shankRadiusMm_ == 0.0) shankRadiusMm_ = 0.6 * headRadiusMm;
}

BurFinish finishOf(const instrument::Bur& bur, std::string_view cuttingParameters) {
    const instrument::CatalogueEntry* entry = instrument::findBur(bur.name());
    if (cuttingParameters.empty() && entry != nullptr) cuttingParameters = entry->cuttingParameters;
    const bool isFile = geometry::meshFormatOf(bur.name()) != geometry::MeshFormat::unknown;
    const auto says = [&](std::string_view word) { return cuttingParameters.find(word) != std::string_view::npos; };
    if (says("carbide")) return BurFinish::carbide;
    if (says("steel")) return BurFinish::steel;
    // What cuts like a medium diamond because nobody said how it cuts need not look like one.
    if (isFile && (cuttingParameters == instrument::CuttingParameters{}.name || !says("diamond")))
        return BurFinish::plain;
    return BurFinish::diamond;
}

void Instruments::setTurbine(const geometry::TriangleMesh& mesh) {
    set(turbine_, mesh, 0.6, kTurbineCellMm);
    fade_.set(mesh);
}

void Instruments::setWork(const core::Box& tooth) {
    ++appearance_;
    crown_ = crownOf(tooth);
}

namespace {
Capsules capsulesOf(const Moment& moment, double headLengthMm, double headRadiusMm, double shankRadiusMm,
                    double topMm) {
    const Mat4f pose = matrixOf(moment.burInTooth);
    const auto on = [&](double z) {
        return Vec3f((pose * gl::Vec4f(0.0f, 0.0f, static_cast<float>(z), 1.0f)).head<3>());
    };
    const double r = std::min(headRadiusMm, 0.5 * headLengthMm);
    return {
        {{{on(r), on(std::max(headLengthMm - r, r + 0.02)), static_cast<float>(headRadiusMm)},
          {on(headLengthMm), on(std::min(topMm, headLengthMm + kShankShadowMm)), static_cast<float>(shankRadiusMm)}}}};
}
}  // namespace

namespace {
double blurOf(const Moment& moment) {
    return std::clamp(std::abs(moment.speedRpm) / kBlurRpm, 0.0, 1.0);
}
double turnOf(const Moment& moment) {
    return std::fmod(moment.timeS * moment.speedRpm / 60.0, 1.0) * 2.0 * std::numbers::pi;
}
}  // namespace

std::uint64_t Instruments::appearance(const Moment& moment, const Look& look) {
    const Appearance now{moment.burInTooth.positionMm,
                         moment.burInTooth.orientation,
                         moment.burShown,
                         look.bur,
                         look.turbine,
                         look.shadows,
                         blurOf(moment),
                         blurOf(moment) < 1.0 ? turnOf(moment) : 0.0};
    const Appearance& was = last_;
    const bool same = now.positionMm == was.positionMm && now.orientation.coeffs() == was.orientation.coeffs() &&
                      now.shown == was.shown && now.bur == was.bur && now.turbine == was.turbine &&
                      now.shadows == was.shadows && now.blur == was.blur && now.turn == was.turn;
    last_ = now;
    return same ? appearance_ : ++appearance_;
}

namespace {
/// The eye as the bur has it.
Eye inBurOf(const Eye& eye, const core::Pose& burInTooth) {
    Eye in = eye;
    in.view = eye.view * matrixOf(burInTooth);
    in.positionMm =
        (burInTooth.orientation.conjugate() * (eye.positionMm.cast<double>() - burInTooth.positionMm)).cast<float>();
    return in;
}
}  // namespace

Instruments::Sight::Sight(const Eye& eyeInBur, double headLengthMm)
    : eye(eyeInBur.positionMm),
      eyeMm(std::max(1e-3f, eye.norm())),
      fromMm(static_cast<float>(headLengthMm) + kGlassFromMm),
      depth(-eyeInBur.view.row(2)) {
    toEye = eye / eyeMm;
    // Along the bur the head covers all of the picture: then all of it is glass.
    const float along = std::clamp((toEye.z() - kBeside) / (kAlong - kBeside), 0.0f, 1.0f);
    siteMm = kSiteMm * (1.0f + 4.0f * along * along * (3.0f - 2.0f * along));
    const float nearMm = eyeInBur.projection(2, 3) / (eyeInBur.projection(2, 2) - 1.0f);
    goneMm = std::max(1.5f * nearMm, kGoneShare * eyeMm);
    wholeMm = std::max(4.0f * nearMm, kWholeShare * eyeMm);
}

float Instruments::Sight::depthOf(const PooledMesh& mesh) const {
    return depth.head<3>().dot(mesh.centreMm) + depth.w();
}

bool Instruments::Sight::isGone(const PooledMesh& mesh) const {
    return depthOf(mesh) + mesh.radiusMm <= goneMm;
}

bool Instruments::Sight::isNear(const PooledMesh& mesh) const {
    return depthOf(mesh) - mesh.radiusMm < wholeMm;
}

bool Instruments::Sight::isGlass(const PooledMesh& mesh) const {
    // As the shader has it, for the whole ball around the piece.
    const float r = mesh.radiusMm, high = mesh.centreMm.dot(toEye);
    if (isNear(mesh)) return true;
    const float site = siteMm * std::clamp((high + r - fromMm) / kGlassOverMm, 0.0f, 1.0f) + 0.01f;
    const float away = std::max(0.0f, (mesh.centreMm - high * toEye).norm() - r);
    return away * eyeMm < site * std::max(0.05f * eyeMm, eyeMm - high + r);
}

/// How much is drawn of the head that holds the bur; 1 where there is no handpiece to be held by.
float Instruments::heldShare(const Look& look, const HandpieceFade::Solid& solid) const {
    return look.turbine && !turbine_.meshes.empty() ? solid.ofHead() : 1.0f;
}

template <class Found>
void Instruments::eachSeen(const Culler& culler, const Sight& sight, const HandpieceFade::Solid& solid,
                           const Look& look, const Found& found) const {
    constexpr float kWhole = 0.999f, kNone = 0.01f;
    // The end of the shank is seen only where there is no handpiece, and ends before it where that is not drawn.
    const bool endSeen = !look.turbine || turbine_.meshes.empty();
    const bool isHeld = heldShare(look, solid) > kWhole;
    if (look.turbine)
        for (const PooledMesh& mesh : turbine_.meshes)
            if (culler.mayBeSeen(mesh) && !sight.isGone(mesh)) {
                const auto [least, most] = solid.between(mesh.minMm.x(), mesh.maxMm.x());
                const bool isGlass = least < kWhole || sight.isNear(mesh);
                if (most > kNone) found(mesh, true, isGlass);
            }
    if (!look.bur) return;
    const float endFromMm = static_cast<float>(headLengthMm_) + kHeldOverMm;
    for (const Solid* one : {&bur_, &shankEnd_}) {
        if (one == &shankEnd_ && !endSeen) break;
        for (const PooledMesh& mesh : one->meshes)
            if (culler.mayBeSeen(mesh) && !sight.isGone(mesh))
                found(mesh, false, sight.isGlass(mesh) || (!isHeld && mesh.maxMm.z() > endFromMm));
    }
}

HandpieceFade::Solid Instruments::solidOf(const Eye& eyeInBur, const Moment& moment) const {
    const core::Vec3 crown = moment.burInTooth.applyInverse(crown_.centreMm.cast<double>());
    return fade_.seenFrom(eyeInBur.positionMm, crown.cast<float>(), crown_.radiusMm, static_cast<float>(headLengthMm_));
}

PixelRect Instruments::rect(const Eye& eye, const Viewport& viewport, const Look& look, const Moment& moment) const {
    PixelRect rect;
    if (!moment.burShown) return rect;
    const Eye in = inBurOf(eye, moment.burInTooth);
    eachSeen(Culler(in, viewport, {0, 0, viewport.width, viewport.height}, true), Sight(in, headLengthMm_),
             solidOf(in, moment), look, [&](const PooledMesh& mesh, bool, bool) {
                 rect = rect.joined(rectOf(mesh.minMm, mesh.maxMm, in, viewport));
             });
    return rect;
}

namespace {
/// Balls whose hull a capsule's shadow lies in: the capsule's own, and the same a shadow's reach away, where its edge
/// is softest (see the shader). Only the head darkens what it is near; at its far end a shadow has faded.
struct Ball {
    Vec3f centre;
    float radius;
};
std::array<Ball, 4> shadowOf(const Capsule& capsule, bool isHead, const Vec3f& lamp) {
    const Vec3f away = -kShadowReachMm * lamp;
    const float here = capsule.radius + (isHead ? kNearMm : kSoftMm), there = capsule.radius + kSoftMm;
    return {{{capsule.begin, here}, {capsule.end, here}, {capsule.begin + away, there}, {capsule.end + away, there}}};
}
/// Pixels of a ball's radius, a little more than less.
float pixelsOf(const Ball& ball, const Eye& eye, const Viewport& viewport) {
    const float pixelsPerMm = 0.5f * static_cast<float>(viewport.height) * std::abs(eye.projection(1, 1));
    const float depthMm = std::max(1.0f, -(eye.view.row(2).head<3>().dot(ball.centre) + eye.view(2, 3)) - ball.radius);
    return 1.1f * ball.radius * pixelsPerMm / depthMm;
}
}  // namespace

PixelRect Instruments::shadowRect(const Eye& eye, const Viewport& viewport, const Look& look, const Moment& moment,
                                  const Lighting& lighting) const {
    PixelRect rect;
    if (!moment.burShown || !look.bur || !look.shadows || bur_.meshes.empty()) return rect;
    const Capsules capsules = capsulesOf(moment, headLengthMm_, headRadiusMm_, shankRadiusMm_, topMm_);
    for (std::size_t i = 0; i < capsules.parts.size(); ++i)
        for (const Ball& ball : shadowOf(capsules.parts[i], i == 0, lighting.lamp))
            rect = rect.joined(rectOf(ball.centre, ball.centre, eye, viewport)
                                   .grown(static_cast<int>(pixelsOf(ball, eye, viewport)) + 2));
    return rect;
}

void Instruments::drawShadow(Shaders& shaders, const Eye& eye, const Viewport& viewport, const PixelRect& bounds,
                             const Moment& moment, const Lighting& lighting, const gl::Texture& toothDepth) const {
    const Capsules capsules = capsulesOf(moment, headLengthMm_, headRadiusMm_, shankRadiusMm_, topMm_);
    gl::Program& program = shaders.burShadow;
    program.use();
    program.set("depth", toothDepth, 0);
    program.set("toTooth", Mat4f(eye.viewProjection().inverse()));
    program.set("lamp", lighting.lamp);
    const std::array<Vec3f, 2> begin = {capsules.parts[0].begin, capsules.parts[1].begin},
                               end = {capsules.parts[0].end, capsules.parts[1].end};
    const std::array<float, 2> radius = {capsules.parts[0].radius, capsules.parts[1].radius};
    program.set("begin", begin.data(), 2);
    program.set("end", end.data(), 2);
    program.set("radius", radius.data(), 2);
    program.set("reach", kShadowReachMm);
    // Drawn at the very back and let through where something is nearer: the background costs nothing.
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_DST_COLOR, GL_ZERO);
    Strips strips(bounds);
    for (std::size_t i = 0; i < capsules.parts.size(); ++i) {
        std::vector<gl::Vec2f> outline;  // eight corners round each ball
        bool beside = false;
        for (const Ball& ball : shadowOf(capsules.parts[i], i == 0, lighting.lamp)) {
            const gl::Vec4f c = eye.viewProjection() * gl::Vec4f(ball.centre.x(), ball.centre.y(), ball.centre.z(), 1);
            beside = beside || c.w() < 1e-3f;
            const float reach = 1.09f * pixelsOf(ball, eye, viewport);
            for (int k = 0; k < 8; ++k) {
                const float angle = static_cast<float>(k) * static_cast<float>(std::numbers::pi / 4.0);
                outline.emplace_back(
                    (0.5f * c.x() / c.w() + 0.5f) * static_cast<float>(viewport.width) + reach * std::cos(angle),
                    (0.5f * c.y() / c.w() + 0.5f) * static_cast<float>(viewport.height) + reach * std::sin(angle));
            }
        }
        if (beside)
            strips.addAll();
        else
            strips.addHull(outline);
    }
    for (const PixelRect& r : strips.rects()) {
        glScissor(r.x0, r.y0, r.x1 - r.x0, r.y1 - r.y0);
        gl::drawFullScreen();
    }
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
}

namespace {
void prepare(gl::Program& program, const Eye& eye, const Moment& moment, const Lighting& lighting) {
    program.use();
    program.set("viewProjection", eye.viewProjection());
    program.set("burInTooth", matrixOf(moment.burInTooth));
    program.set("eye", eye.positionMm);
    program.set("lamp", lighting.lamp);
    program.set("eyeUp", lighting.up);
    program.set("eyeRight", lighting.right);
    program.set("mirrorPlane", planeOf(eye.clip));
}
}  // namespace

void Instruments::prepareBur(gl::Program& program, const Moment& moment) const {
    program.set("headLength", static_cast<float>(headLengthMm_));
    program.set("headRadius", static_cast<float>(headRadiusMm_));
    program.set("finish", static_cast<int>(finish_));
    program.set("blur", static_cast<float>(blurOf(moment)));
    // A bur that is a blur looks the same at any angle: so does its picture, to the bit.
    program.set("turn", blurOf(moment) < 1.0 ? static_cast<float>(turnOf(moment)) : 0.0f);
}

std::size_t Instruments::draw(Shaders& shaders, const Eye& eye, const Viewport& viewport, const PixelRect& rect,
                              const Look& look, const Moment& moment, const Lighting& lighting) {
    if (!moment.burShown) return 0;
    const Eye inBur = inBurOf(eye, moment.burInTooth);
    const Sight sight(inBur, headLengthMm_);
    const HandpieceFade::Solid solid = solidOf(inBur, moment);
    for (auto* meshes : {&metalBur_, &metalTurbine_, &glassBur_, &glassTurbine_})
        meshes->clear();
    eachSeen(Culler(inBur, viewport, rect, true), sight, solid, look,
             [&](const PooledMesh& mesh, bool isTurbine, bool isGlass) {
                 (isTurbine ? (isGlass ? glassTurbine_ : metalTurbine_) : (isGlass ? glassBur_ : metalBur_))
                     .push_back(&mesh);
             });
    glEnable(GL_CULL_FACE);
    glCullFace(GL_BACK);
    glFrontFace(eye.mirrored ? GL_CCW : GL_CW);
    std::size_t triangles = 0;
    if (!metalBur_.empty()) {
        prepare(shaders.bur, eye, moment, lighting);
        prepareBur(shaders.bur, moment);
        triangles += pool_.draw(metalBur_);
    }
    if (!metalTurbine_.empty()) {
        prepare(shaders.turbine, eye, moment, lighting);
        triangles += pool_.draw(metalTurbine_);
    }
    if (!glassBur_.empty() || !glassTurbine_.empty()) {
        glDepthMask(GL_FALSE);
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
        const auto drawGlass = [&](gl::Program& program, std::vector<const PooledMesh*>& meshes, bool isBur) {
            if (meshes.empty()) return;
            // From far to near: what lies behind glass is seen through it.
            const auto away = [&](const PooledMesh* mesh) { return (mesh->centreMm - sight.eye).squaredNorm(); };
            std::stable_sort(meshes.begin(), meshes.end(),
                             [&](const PooledMesh* a, const PooledMesh* b) { return away(a) > away(b); });
            prepare(program, eye, moment, lighting);
            if (isBur) prepareBur(program, moment);
            const Vec3f tip = moment.burInTooth.positionMm.cast<float>();
            if (isBur) {
                program.set("tip", tip);
                program.set("toEye", Vec3f((eye.positionMm - tip) / sight.eyeMm));
                program.set("eyeMm", sight.eyeMm);
            }
            program.set("goneMm", sight.goneMm);
            program.set("wholeMm", sight.wholeMm);
            if (isBur) {
                program.set("siteMm", sight.siteMm);
                program.set("glassFrom", sight.fromMm);
                program.set("glassOver", kGlassOverMm);
                program.set("heldFrom", static_cast<float>(headLengthMm_) + kHeldOverMm);
                program.set("heldShare", heldShare(look, solid));
            } else {
                program.set("share", solid.share.data(), HandpieceFade::kSlices);
                program.set("shareFrom", solid.fromMm);
                program.set("shareStep", solid.stepMm);
            }
            triangles += pool_.draw(meshes);
        };
        drawGlass(shaders.glassBur, glassBur_, true);
        // With depth: pieces that are solid in part would show through each other, in the shapes of their triangles.
        glDepthMask(GL_TRUE);
        drawGlass(shaders.glassTurbine, glassTurbine_, false);
        glDisable(GL_BLEND);
    }
    glDisable(GL_CULL_FACE);
    return triangles;
}

}  // namespace handpiece::view
