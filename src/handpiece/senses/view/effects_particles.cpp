// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/senses/view/effects.h"
#include "handpiece/senses/view/particles.h"

namespace handpiece::view {

namespace {

// A capsule from head to tail, turned to the eye, that thins out towards its tail; never thinner than a pixel, but
// paler then.
const char* const kVertex = R"(
layout(location = 0) in vec3 place;
layout(location = 1) in float radius;
layout(location = 2) in vec3 streak;
layout(location = 3) in float hardness;
layout(location = 4) in vec4 colour;
uniform mat4 view, projection;
uniform float pixelShare;
out vec2 at;
flat out float halfLength, hard;
flat out vec4 shade;
out float depthMm;
void main() {
    vec3 head = (view * vec4(place, 1.0)).xyz;
    vec3 tail = head + mat3(view) * streak;
    float least = 0.6 * pixelShare * -head.z;
    float r = max(radius, least);
    vec2 along = tail.xy - head.xy;
    float len = length(along);
    vec2 dir = len > 1e-5 ? along / len : vec2(1.0, 0.0);
    vec2 corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0);
    vec3 end = corner.x < 0.0 ? head : tail;
    vec3 p = end + r * vec3(corner.x * dir + corner.y * vec2(-dir.y, dir.x), 0.0);
    halfLength = 0.5 * len / r;
    at = vec2(corner.x * (halfLength + 1.0), corner.y);
    hard = hardness;
    shade = vec4(colour.rgb, colour.a * min(1.0, radius / r));
    depthMm = -p.z;
    gl_Position = projection * vec4(p, 1.0);
}
)";
const char* const kFragment = R"(
in vec2 at;
flat in float halfLength, hard;
flat in vec4 shade;
in float depthMm;
uniform sampler2D toothDepth;
uniform vec2 unproject;
out vec4 result;
void main() {
    // 0 at the head, 1 at the tail: what the eye smears of a drop ends in nothing.
    float along = clamp((at.x + halfLength) / max(2.0 * halfLength, 1e-3), 0.0, 1.0);
    float narrow = mix(1.0, 0.45, along * min(1.0, halfLength));
    float d = length(vec2(max(abs(at.x) - halfLength, 0.0), at.y)) / narrow;
    if (d >= 1.0) discard;
    float edge = mix(0.0, 0.75, hard);
    float cover = 1.0 - smoothstep(edge, 1.0, d);
    if (hard < 0.3) {
        // Mist has no edge where it meets the tooth.
        float z = texelFetch(toothDepth, ivec2(gl_FragCoord.xy), 0).r;
        float behind = unproject.y / (2.0 * z - 1.0 + unproject.x) - depthMm;
        cover *= clamp(1.2 * behind + 0.15, 0.0, 1.0);
    }
    cover *= 1.0 - along * min(1.0, 0.8 * halfLength);
    result = vec4(shade.rgb * mix(1.12 - 0.35 * d, 1.0, 1.0 - hard), shade.a * cover);
}
)";

class ParticlePass : public Pass {
  public:
    explicit ParticlePass(std::function<double()> headRadiusMm) : headRadiusMm_(std::move(headRadiusMm)) {}

    PixelRect touches(const PassContext& context) override {
        particles_.advance(context.moment, context.look, headRadiusMm_());
        const gl::Mat4f m = context.eye.viewProjection();
        const Viewport& v = context.viewport;
        PixelRect rect;
        for (const Speck& s : particles_.specks()) {
            const gl::Vec3f head(s.positionMm[0], s.positionMm[1], s.positionMm[2]);
            const gl::Vec3f streak(s.streakMm[0], s.streakMm[1], s.streakMm[2]);
            for (const gl::Vec3f& p : {head, gl::Vec3f(head + streak)}) {
                const gl::Vec4f c = m * p.homogeneous();
                if (c.w() < 0.05f) continue;  // behind the eye; its other end, if seen, is near the edge
                const float reach = 1.5f + 0.5f * static_cast<float>(v.height) *
                                               std::abs(context.eye.projection(1, 1)) * s.radiusMm / c.w();
                const float x = 0.5f * (c.x() / c.w() + 1.0f) * static_cast<float>(v.width);
                const float y = 0.5f * (c.y() / c.w() + 1.0f) * static_cast<float>(v.height);
                const auto pixel = [](float a) { return static_cast<int>(std::clamp(a, -1e6f, 1e6f)); };
                const PixelRect one =
                    PixelRect{pixel(x - reach) - 1, pixel(y - reach) - 1, pixel(x + reach) + 2, pixel(y + reach) + 2}
                        .common({0, 0, v.width, v.height});
                rect = rect.joined(one);
            }
        }
        return rect;
    }

    std::size_t draw(const PassContext& context) override {
        const auto specks = particles_.specks();
        if (specks.empty()) return 0;
        array_.bind();
        vertices_.fill(GL_ARRAY_BUFFER, specks.data(), specks.size() * sizeof(Speck), GL_STREAM_DRAW);
        array_.attach(vertices_, sizeof(Speck),
                      {{0, 3, GL_FLOAT, false, offsetof(Speck, positionMm), false, 1},
                       {1, 1, GL_FLOAT, false, offsetof(Speck, radiusMm), false, 1},
                       {2, 3, GL_FLOAT, false, offsetof(Speck, streakMm), false, 1},
                       {3, 1, GL_FLOAT, false, offsetof(Speck, hardness), false, 1},
                       {4, 4, GL_UNSIGNED_BYTE, true, offsetof(Speck, rgba), false, 1}});
        const gl::Mat4f& p = context.eye.projection;
        program_.use();
        program_.set("view", context.eye.view);
        program_.set("projection", p);
        program_.set("pixelShare", 2.0f / (std::abs(p(1, 1)) * static_cast<float>(context.viewport.height)));
        // NDC z is -p22 + p23 / depth.
        program_.set("unproject", gl::Vec2f(p(2, 2), p(2, 3)));
        program_.set("toothDepth", context.toothDepth, 0);
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        glDepthMask(GL_FALSE);
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(specks.size()));
        glDepthMask(GL_TRUE);
        glDisable(GL_BLEND);
        return 2 * specks.size();
    }

  private:
    std::function<double()> headRadiusMm_;
    Particles particles_;
    gl::Program program_{"particles", kVertex, kFragment};
    gl::Buffer vertices_;
    gl::VertexArray array_;
};

}  // namespace

std::unique_ptr<Pass> makeParticlePass(std::function<double()> headRadiusMm) {
    return std::make_unique<ParticlePass>(std::move(headRadiusMm));
}

}  // namespace handpiece::view
