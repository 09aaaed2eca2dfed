// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "handpiece/senses/view/effects.h"

namespace handpiece::view {

namespace {

const char* const kVertex = R"(
layout(location = 0) in vec2 pixel;
layout(location = 1) in vec4 colour;
uniform vec2 size;
out vec4 shade;
void main() {
    shade = colour;
    gl_Position = vec4(2.0 * pixel / size - 1.0, 0.0, 1.0);
}
)";
const char* const kFragment = R"(
in vec4 shade;
out vec4 result;
void main() { result = shade; }
)";

struct Corner {
    float x, y;
    float r, g, b, a;
};

constexpr float kMarginPx = 22.0f, kBarPx = 6.0f, kTickPx = 5.0f, kEdgePx = 1.5f;

/// Lower left: a bar in steps of a millimetre, light and dark by turns, with a tick at each, on a dark edge.
class ScaleBarPass : public Pass {
  public:
    PixelRect touches(const PassContext& context) override {
        corners_.clear();
        if (!context.look.scaleBar) return {};
        const double mm = mmPerPixel(context.camera, context.viewport, context.camera.targetMm);
        if (!(mm > 0.0)) return {};
        const auto perMm = static_cast<float>(kScaleTickMm / mm);
        const float room = 0.8f * static_cast<float>(context.viewport.width) - kMarginPx;
        const float most = static_cast<float>(kScaleBarMm / kScaleTickMm);
        const int steps = static_cast<int>(std::floor(std::min(most, room / perMm)));
        if (steps < 1) return {};  // so near that not a millimetre fits

        // On whole pixels, or its edges would blur where they must be read.
        const float left = kMarginPx, low = static_cast<float>(context.viewport.height) - kMarginPx;
        const float right = std::round(left + static_cast<float>(steps) * perMm);
        addBox(left - kEdgePx, low - kBarPx - kEdgePx, right + kEdgePx, low + kEdgePx, 0.05f, 0.7f);
        const bool ticks = perMm >= 4.0f;
        for (int i = 0; ticks && i <= steps; ++i) {
            const float x = std::round(left + static_cast<float>(i) * perMm);
            addBox(x - 0.5f - kEdgePx, low - kBarPx - kTickPx - kEdgePx, x + 0.5f + kEdgePx, low - kBarPx, 0.05f, 0.7f);
        }
        for (int i = 0; i < steps; ++i)
            addBox(std::round(left + static_cast<float>(i) * perMm), low - kBarPx,
                   std::round(left + static_cast<float>(i + 1) * perMm), low, i % 2 == 0 ? 0.96f : 0.42f, 1.0f);
        for (int i = 0; ticks && i <= steps; ++i) {
            const float x = std::round(left + static_cast<float>(i) * perMm);
            addBox(x - 0.5f, low - kBarPx - kTickPx, x + 0.5f, low - kBarPx, 0.96f, 1.0f);
        }
        return {static_cast<int>(left) - 4, static_cast<int>(low - kBarPx - kTickPx) - 4, static_cast<int>(right) + 4,
                static_cast<int>(low) + 4};
    }

    std::size_t draw(const PassContext& context) override {
        if (corners_.empty()) return 0;
        vertices_.fill(GL_ARRAY_BUFFER, corners_.data(), corners_.size() * sizeof(Corner), GL_STREAM_DRAW);
        array_.attach(vertices_, sizeof(Corner),
                      {{0, 2, GL_FLOAT, false, offsetof(Corner, x)}, {1, 4, GL_FLOAT, false, offsetof(Corner, r)}});
        program_.use();
        program_.set(
            "size", gl::Vec2f(static_cast<float>(context.viewport.width), static_cast<float>(context.viewport.height)));
        glDisable(GL_DEPTH_TEST);
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners_.size()));
        glDisable(GL_BLEND);
        glEnable(GL_DEPTH_TEST);
        return corners_.size() / 3;
    }

  private:
    void addBox(float x0, float y0, float x1, float y1, float grey, float alpha) {
        const auto corner = [&](float x, float y) { return Corner{x, y, grey, grey, grey, alpha}; };
        for (const Corner& c :
             {corner(x0, y0), corner(x1, y0), corner(x1, y1), corner(x0, y0), corner(x1, y1), corner(x0, y1)})
            corners_.push_back(c);
    }

    gl::Program program_{"scale bar", kVertex, kFragment};
    gl::Buffer vertices_;
    gl::VertexArray array_;
    std::vector<Corner> corners_;
};

}  // namespace

std::unique_ptr<Pass> makeScaleBarPass() {
    return std::make_unique<ScaleBarPass>();
}

std::vector<std::unique_ptr<Pass>> makeEffects(std::function<double()> headRadiusMm) {
    std::vector<std::unique_ptr<Pass>> passes;
    passes.push_back(makeMirrorPass());
    passes.push_back(makeArrowPass());
    passes.push_back(makeParticlePass(std::move(headRadiusMm)));
    passes.push_back(makeScaleBarPass());
    return passes;
}

}  // namespace handpiece::view
