// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "handpiece/senses/view/effects.h"
#include "handpiece/senses/view/effects_solid.h"

namespace handpiece::view {

using core::Vec3;

namespace {

const char* const kVertex = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
uniform mat4 viewProjection;
uniform vec3 centre;
uniform float radius;
out float away;
void main() {
    away = length(place - centre) / radius;
    gl_Position = viewProjection * vec4(place, 1.0);
}
)";
// The reflected eye's picture lies under the glass pixel by pixel: what a mirror shows is its scene as the same eye
// would see it through the glass, turned over.
const char* const kFragment = R"(
in float away;
uniform sampler2D reflection;
uniform vec2 corner, extent;
out vec4 result;
void main() {
    vec3 seen = texture(reflection, (gl_FragCoord.xy - corner) / extent).rgb;
    float bevel = smoothstep(0.955, 0.985, away);
    vec3 glass = 0.93 * seen * vec3(0.97, 0.995, 1.0) + 0.012;
    result = vec4(mix(glass, vec3(0.72, 0.76, 0.78), 0.55 * bevel), 1.0);
}
)";

constexpr int kAround = 64;
constexpr double kGlassShare = 0.9;  // of the radius; the rest is rim
constexpr double kBendRad = 0.55, kBendRadiusMm = 14.0, kNeckMm = 26.0, kHandleMm = 62.0;

/// The glass's frame: the handle's way, across, and out of the glass.
struct Frame {
    Vec3 centre, along, across, out;
    explicit Frame(const MirrorPose& pose) : centre(pose.centreMm), out(pose.normal.normalized()) {
        Vec3 flat = pose.handle - out * pose.handle.dot(out);
        along = flat.norm() > 1e-6 ? Vec3(flat.normalized()) : Vec3(out.unitOrthogonal());
        across = out.cross(along);
    }
};

Solid metalOf(const Frame& f, double r) {
    Solid solid;
    const auto ring = [&](double radius, double high) {
        return Solid::Ring{f.centre + high * f.out, f.out, radius, f.along};
    };
    // From the glass's edge over the rim to the back.
    std::vector<Solid::Ring> rim{ring(kGlassShare * r, 0.0), ring(kGlassShare * r + 0.05, 0.22)};
    const double mid = 0.5 * (1.0 + kGlassShare) * r, half = 0.5 * (1.0 - kGlassShare) * r;
    for (int i = 1; i < 12; ++i) {
        const double angle = std::numbers::pi * (1.0 - i / 12.0);
        rim.push_back(ring(mid + half * std::cos(angle), 0.22 + 0.45 * std::sin(angle)));
    }
    for (const auto& [share, high] :
         {std::pair{1.0, -0.1}, {0.995, -0.6}, {0.97, -1.0}, {0.92, -1.3}, {0.8, -1.5}, {0.0, -1.6}})
        rim.push_back(ring(share * r, high));
    solid.addRings(rim, kAround);

    // Neck and handle: out of the rim in the plane, then bent to the seen side, as mouth mirrors are.
    std::vector<Solid::Ring> rod;
    const Vec3 start = f.centre + (r - 0.4) * f.along - 0.5 * f.out;
    const double arc = kBendRadiusMm * kBendRad;
    const auto at = [&](double s, double radius) {
        const double turned = std::clamp((s - 2.0) / arc, 0.0, 1.0) * kBendRad;
        Vec3 place = start + std::min(s, 2.0) * f.along;
        place += kBendRadiusMm * (std::sin(turned) * f.along + (1.0 - std::cos(turned)) * f.out);
        const Vec3 along = std::cos(turned) * f.along + std::sin(turned) * f.out;
        place += std::max(0.0, s - 2.0 - arc) * along;
        rod.push_back({place, along, radius, f.across});
    };
    at(0.0, 0.0);
    at(0.0, 1.0);
    for (int i = 0; i <= 10; ++i)
        at(2.0 + arc * i / 10.0, 1.0);
    const double neck = kNeckMm - 6.0;
    for (int i = 1; i <= 6; ++i)
        at(neck + i, 1.0 + 1.6 * (0.5 - 0.5 * std::cos(std::numbers::pi * i / 6.0)));
    for (int i = 0; i < 8; ++i) {  // turned grooves for the grip
        const double s = kNeckMm + 2.0 + 1.6 * i;
        at(s, 2.6);
        at(s + 0.15, 2.35);
        at(s + 0.65, 2.35);
        at(s + 0.8, 2.6);
    }
    at(kHandleMm - 1.0, 2.6);
    at(kHandleMm, 1.8);
    at(kHandleMm, 0.0);
    solid.addRings(rod, 32);
    return solid;
}

Eye reflected(const Eye& eye, const Vec3& centre, const Vec3& normal) {
    const gl::Vec3f n = normal.cast<float>(), c = centre.cast<float>();
    gl::Mat4f over = gl::Mat4f::Identity();
    over.topLeftCorner<3, 3>() -= 2.0f * n * n.transpose();
    over.topRightCorner<3, 1>() = 2.0f * n.dot(c) * n;
    Eye out = eye;
    out.view = eye.view * over;
    out.positionMm = eye.positionMm - 2.0f * n.dot(eye.positionMm - c) * n;
    out.mirrored = !eye.mirrored;
    out.clip = Plane{-normal, -normal.dot(centre)};
    return out;
}

class MirrorPass : public Pass {
  public:
    MirrorPass() {
        glGenSamplers(1, &sampler_);
        glSamplerParameteri(sampler_, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glSamplerParameteri(sampler_, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glSamplerParameteri(sampler_, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glSamplerParameteri(sampler_, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    ~MirrorPass() override { glDeleteSamplers(1, &sampler_); }
    MirrorPass(const MirrorPass&) = delete;
    MirrorPass& operator=(const MirrorPass&) = delete;

    PixelRect touches(const PassContext& context) override {
        metal_ = {};
        glass_ = {};
        const auto& pose = context.moment.mirror;
        if (!pose || !(pose->radiusMm > 0.0) || !(pose->normal.norm() > 1e-6)) return {};
        const Frame frame(*pose);
        metal_ = metalOf(frame, pose->radiusMm);
        glass_.addRings({{frame.centre, frame.out, 0.0, frame.along},
                         {frame.centre, frame.out, kGlassShare * pose->radiusMm, frame.along}},
                        kAround);
        return rectOf(context.eye, context.viewport, metal_);
    }

    std::size_t draw(const PassContext& context) override {
        if (metal_.indices.empty()) return 0;
        const Frame frame(*context.moment.mirror);
        std::size_t triangles = drawGlass(context, frame);
        triangles += drawer_.draw(context, metal_, {0.86f, 0.88f, 0.90f}, 1.0f, 0.0f);
        return triangles;
    }

  private:
    std::size_t drawGlass(const PassContext& context, const Frame& frame) {
        const gl::Vec3f centre = frame.centre.cast<float>();
        if (frame.out.cast<float>().dot(context.eye.positionMm - centre) <= 0.0f) return 0;  // seen from behind
        const PixelRect rect = rectOf(context.eye, context.viewport, glass_);
        if (rect.isEmpty()) return 0;

        Eye eye = reflected(context.eye, frame.centre, frame.out);
        // Only the glass's own part of the picture is drawn.
        const auto w = static_cast<float>(context.viewport.width), h = static_cast<float>(context.viewport.height);
        const auto width = static_cast<float>(rect.x1 - rect.x0), height = static_cast<float>(rect.y1 - rect.y0);
        gl::Mat4f crop = gl::Mat4f::Identity();
        crop(0, 0) = w / width;
        crop(0, 3) = (w - static_cast<float>(rect.x0 + rect.x1)) / width;
        crop(1, 1) = h / height;
        crop(1, 3) = (h - static_cast<float>(rect.y0 + rect.y1)) / height;
        eye.projection = crop * eye.projection;
        const float share = context.software && context.look.quality == Quality::fast ? 0.5f : 1.0f;
        const gl::Texture& scene = context.drawScene(eye, std::max(1, static_cast<int>(std::ceil(share * width))),
                                                     std::max(1, static_cast<int>(std::ceil(share * height))));
        restoreTarget(context);

        array_.bind();
        vertices_.fill(GL_ARRAY_BUFFER, glass_.vertices.data(), glass_.vertices.size() * sizeof(Solid::Vertex),
                       GL_STREAM_DRAW);
        array_.attach(vertices_, sizeof(Solid::Vertex), {{0, 3, GL_FLOAT, false, offsetof(Solid::Vertex, placeMm)}});
        indices_.fill(GL_ELEMENT_ARRAY_BUFFER, glass_.indices.data(), glass_.indices.size() * sizeof(std::uint32_t),
                      GL_STREAM_DRAW);
        array_.attachIndices(indices_);
        program_.use();
        program_.set("viewProjection", context.eye.viewProjection());
        program_.set("centre", centre);
        program_.set("radius", static_cast<float>(kGlassShare * context.moment.mirror->radiusMm));
        program_.set("corner", gl::Vec2f(static_cast<float>(rect.x0), static_cast<float>(rect.y0)));
        program_.set("extent", gl::Vec2f(width, height));
        program_.set("reflection", scene, 0);
        glBindSampler(0, sampler_);
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(glass_.indices.size()), GL_UNSIGNED_INT, nullptr);
        glBindSampler(0, 0);
        return glass_.indices.size() / 3;
    }

    SolidDrawer drawer_;
    gl::Program program_{"mirror", kVertex, kFragment};
    gl::Buffer vertices_, indices_;
    gl::VertexArray array_;
    GLuint sampler_ = 0;
    Solid metal_, glass_;
};

}  // namespace

std::unique_ptr<Pass> makeMirrorPass() {
    return std::make_unique<MirrorPass>();
}

}  // namespace handpiece::view
