// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

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
#ifdef MIST
uniform sampler2D solidDepth;
uniform vec2 pixelsPerPixel;
#endif
out vec4 result;
void main() {
#ifdef MIST
    // A pixel stands for several of the whole.
    ivec2 pixel = min(ivec2(pixelsPerPixel * gl_FragCoord.xy), textureSize(solidDepth, 0) - 1);
    if (gl_FragCoord.z >= texelFetch(solidDepth, pixel, 0).r) discard;
#else
    ivec2 pixel = ivec2(gl_FragCoord.xy);
#endif
    // 0 at the head, 1 at the tail: what the eye smears of a drop ends in nothing.
    float along = clamp((at.x + halfLength) / max(2.0 * halfLength, 1e-3), 0.0, 1.0);
    float narrow = mix(1.0, 0.45, along * min(1.0, halfLength));
    float d = length(vec2(max(abs(at.x) - halfLength, 0.0), at.y)) / narrow;
    if (d >= 1.0) discard;
    float edge = mix(0.0, 0.75, hard);
    float cover = 1.0 - smoothstep(edge, 1.0, d);
    if (hard < 0.3) {
        // Mist has no edge where it meets the tooth.
        float z = texelFetch(toothDepth, pixel, 0).r;
        float behind = unproject.y / (2.0 * z - 1.0 + unproject.x) - depthMm;
        cover *= clamp(1.2 * behind + 0.15, 0.0, 1.0);
    }
    cover *= 1.0 - along * min(1.0, 0.8 * halfLength);
    result = vec4(shade.rgb * mix(1.12 - 0.35 * d, 1.0, 1.0 - hard), shade.a * cover);
}
)";

// What mist lets through, laid over the picture in mist's own colour.
const char* const kVeilFragment = R"(
in vec2 uv;
uniform sampler2D through;
uniform vec3 mist;
out vec4 result;
void main() {
    float veil = 1.0 - texture(through, uv).r;
    if (veil < 0.002) discard;
    result = vec4(mist, veil);
}
)";

/// Mist is drawn at a half or a quarter of the size; of the least puff's radius so many pixels are left.
constexpr float kLeastPuffPixels = 5.0f;

class ParticlePass : public Pass {
  public:
    explicit ParticlePass(std::function<double()> headRadiusMm) : headRadiusMm_(std::move(headRadiusMm)) {}

    PixelRect touches(const PassContext& context) override {
        particles_.advance(context.moment, context.look, headRadiusMm_());
        const gl::Mat4f m = context.eye.viewProjection();
        const Viewport& v = context.viewport;
        PixelRect rect;
        mist_.clear();
        specks_.clear();
        mistRect_ = {};
        float leastPuff = std::numeric_limits<float>::infinity();
        for (const Speck& s : particles_.specks()) {
            // A jet is too thin to be drawn small.
            const bool isMist = s.hardness == 0.0f && s.streakMm == std::array<float, 3>{};
            PixelRect& reached = isMist ? mistRect_ : rect;
            (isMist ? mist_ : specks_).push_back(s);
            const gl::Vec3f head(s.positionMm[0], s.positionMm[1], s.positionMm[2]);
            const gl::Vec3f streak(s.streakMm[0], s.streakMm[1], s.streakMm[2]);
            for (const gl::Vec3f& p : {head, gl::Vec3f(head + streak)}) {
                const gl::Vec4f c = m * p.homogeneous();
                if (c.w() < 0.05f) continue;  // behind the eye; its other end, if seen, is near the edge
                const float radius =
                    0.5f * static_cast<float>(v.height) * std::abs(context.eye.projection(1, 1)) * s.radiusMm / c.w();
                const float reach = 1.5f + radius;
                if (isMist) leastPuff = std::min(leastPuff, radius);
                const float x = 0.5f * (c.x() / c.w() + 1.0f) * static_cast<float>(v.width);
                const float y = 0.5f * (c.y() / c.w() + 1.0f) * static_cast<float>(v.height);
                const auto pixel = [](float a) { return static_cast<int>(std::clamp(a, -1e6f, 1e6f)); };
                const PixelRect one =
                    PixelRect{pixel(x - reach) - 1, pixel(y - reach) - 1, pixel(x + reach) + 2, pixel(y + reach) + 2}
                        .common({0, 0, v.width, v.height});
                reached = reached.joined(one);
            }
        }
        mistShrinks_ = context.software && leastPuff >= 4 * kLeastPuffPixels ? 4 : 2;
        return rect.joined(mistRect_);
    }

    std::size_t draw(const PassContext& context) override {
        const PixelRect misty = mistRect_.common(context.scissor);
        if (!mist_.empty() && !misty.isEmpty()) drawMist(context, misty);
        if (specks_.empty()) return 2 * mist_.size();
        prepare(program_, context, specks_);
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        glDepthMask(GL_FALSE);
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(specks_.size()));
        glDepthMask(GL_TRUE);
        glDisable(GL_BLEND);
        return 2 * (mist_.size() + specks_.size());
    }

  private:
    void prepare(gl::Program& program, const PassContext& context, const std::vector<Speck>& specks) {
        array_.bind();
        vertices_.fill(GL_ARRAY_BUFFER, specks.data(), specks.size() * sizeof(Speck), GL_STREAM_DRAW);
        array_.attach(vertices_, sizeof(Speck),
                      {{0, 3, GL_FLOAT, false, offsetof(Speck, positionMm), false, 1},
                       {1, 1, GL_FLOAT, false, offsetof(Speck, radiusMm), false, 1},
                       {2, 3, GL_FLOAT, false, offsetof(Speck, streakMm), false, 1},
                       {3, 1, GL_FLOAT, false, offsetof(Speck, hardness), false, 1},
                       {4, 4, GL_UNSIGNED_BYTE, true, offsetof(Speck, rgba), false, 1}});
        const gl::Mat4f& p = context.eye.projection;
        program.use();
        program.set("view", context.eye.view);
        program.set("projection", p);
        program.set("pixelShare", 2.0f / (std::abs(p(1, 1)) * static_cast<float>(context.viewport.height)));
        // NDC z is -p22 + p23 / depth.
        program.set("unproject", gl::Vec2f(p(2, 2), p(2, 3)));
        program.set("toothDepth", context.toothDepth, 0);
    }

    /// Mist is large and soft, and puffs lie over each other by the dozen: it is drawn small. All of it has one colour,
    /// so what is kept is only how much of what lies behind comes through all puffs.
    void drawMist(const PassContext& context, const PixelRect& rect) {
        const int by = mistShrinks_;
        const int width = (context.viewport.width + by - 1) / by, height = (context.viewport.height + by - 1) / by;
        if (through_.width() != width || through_.height() != height) {
            through_.allocate(width, height, GL_R16F, true);
            throughTarget_.attach({&through_}, nullptr);
        }
        const PixelRect small =
            PixelRect{rect.x0 / by, rect.y0 / by, (rect.x1 + by - 1) / by, (rect.y1 + by - 1) / by}.grown(1).common(
                {0, 0, width, height});
        throughTarget_.bind();
        glViewport(0, 0, width, height);
        glScissor(small.x0, small.y0, small.x1 - small.x0, small.y1 - small.y0);
        glDisable(GL_DEPTH_TEST);
        constexpr std::array<float, 4> kAll{1.0f, 1.0f, 1.0f, 1.0f};
        glClearBufferfv(GL_COLOR, 0, kAll.data());
        prepare(mistProgram_, context, mist_);
        mistProgram_.set("solidDepth", context.solidDepth, 1);
        mistProgram_.set("pixelsPerPixel",
                         gl::Vec2f(static_cast<float>(context.viewport.width) / static_cast<float>(width),
                                   static_cast<float>(context.viewport.height) / static_cast<float>(height)));
        glEnable(GL_BLEND);
        glBlendFunc(GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
        glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(mist_.size()));

        restoreTarget(context);
        glDisable(GL_DEPTH_TEST);
        glScissor(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
        none_.bind();
        veilProgram_.use();
        veilProgram_.set("through", through_, 0);
        veilProgram_.set("mist", gl::Vec3f(gl::Vec3f(kMistColour[0], kMistColour[1], kMistColour[2]) / 255.0f));
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        gl::drawFullScreen();
        glDisable(GL_BLEND);
        restoreTarget(context);
    }

    std::function<double()> headRadiusMm_;
    Particles particles_;
    std::vector<Speck> specks_, mist_;  ///< of this picture
    PixelRect mistRect_;
    int mistShrinks_ = 2;
    gl::Program program_{"particles", kVertex, kFragment};
    gl::Program mistProgram_{"mist", kVertex, std::string("#define MIST\n").append(kFragment)};
    gl::Program veilProgram_{"veil of mist", gl::kFullScreenVertex, kVeilFragment};
    gl::Texture through_;  ///< what mist lets through
    gl::Framebuffer throughTarget_;
    gl::Buffer vertices_;
    gl::VertexArray array_, none_;
};

}  // namespace

std::unique_ptr<Pass> makeParticlePass(std::function<double()> headRadiusMm) {
    return std::make_unique<ParticlePass>(std::move(headRadiusMm));
}

}  // namespace handpiece::view
