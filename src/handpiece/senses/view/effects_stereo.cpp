// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/view/effects.h"

namespace handpiece::view {

namespace {

// Rows red, green, blue of the glasses' picture from red, green, blue of the left, then of the right picture.
constexpr std::array<std::array<float, 6>, 3> kDubois{
    {{0.456100f, 0.500484f, 0.176381f, -0.0434706f, -0.0879388f, -0.00155529f},
     {-0.0400822f, -0.0378246f, -0.0157589f, 0.378476f, 0.73364f, -0.0184503f},
     {-0.0152161f, -0.0205971f, -0.00546856f, -0.0721527f, -0.112961f, 1.2264f}}};
constexpr int kSteps = 4096;  // of the way back from linear light

float linearOf(float srgb) {
    return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

struct Tables {
    std::array<float, 256> linear{};
    std::array<std::uint8_t, kSteps + 1> srgb{};
    Tables() {
        for (std::size_t i = 0; i < linear.size(); ++i)
            linear[i] = linearOf(static_cast<float>(i) / 255.0f);
        for (std::size_t i = 0; i < srgb.size(); ++i) {
            const float v = static_cast<float>(i) / kSteps;
            const float s = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
            srgb[i] = static_cast<std::uint8_t>(std::lround(255.0f * s));
        }
    }
};

void mixAnaglyph(const Image& left, const Image& right, Image& out) {
    static const Tables tables;
    core::parallelFor(out.rgba.size() / 4, 1 << 15, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = 4 * begin; i < 4 * end; i += 4) {
            std::array<float, 6> v{};
            for (std::size_t c = 0; c < 3; ++c) {
                v[c] = tables.linear[left.rgba[i + c]];
                v[3 + c] = tables.linear[right.rgba[i + c]];
            }
            for (std::size_t c = 0; c < 3; ++c) {
                float sum = 0.0f;
                for (std::size_t k = 0; k < 6; ++k)
                    sum += kDubois[c][k] * v[k];
                const float step = std::clamp(sum, 0.0f, 1.0f) * kSteps;
                out.rgba[i + c] = tables.srgb[static_cast<std::size_t>(step + 0.5f)];
            }
            out.rgba[i + 3] = 255;
        }
    });
}

void copyInto(const Image& from, Image& to, int column) {
    for (int y = 0; y < from.height; ++y)
        std::copy_n(from.at(0, y), 4 * static_cast<std::size_t>(from.width),
                    to.rgba.begin() + (to.at(column, y) - to.rgba.data()));
}

}  // namespace

Eye stereoEye(const Camera& camera, const Viewport& viewport, double separationMm, int side) {
    const double aside = 0.5 * separationMm * (side < 0 ? -1.0 : 1.0);
    Camera moved = camera;
    moved.eyeMm += aside * camera.right();
    moved.targetMm += aside * camera.right();
    Eye eye = eyeOf(moved, viewport);
    // Depth is -z in the eye's frame: what is at the target's depth comes back by what the eye went aside.
    eye.projection(0, 2) -= eye.projection(0, 0) * static_cast<float>(aside / camera.distanceMm());
    return eye;
}

Viewport stereoViewport(const Viewport& viewport, Stereo stereo) {
    return stereo == Stereo::sideBySide ? Viewport{std::max(1, viewport.width / 2), viewport.height} : viewport;
}

void composeStereo(const Image& left, const Image& right, const Viewport& viewport, Stereo stereo, Image& out) {
    const Viewport each = stereoViewport(viewport, stereo);
    for (const Image* image : {&left, &right})
        if (image->width != each.width || image->height != each.height)
            throw core::Error("the two eyes' pictures are not of the size that the whole asks for");
    out.width = viewport.width;
    out.height = viewport.height;
    out.rgba.assign(4 * static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), 0);
    for (std::size_t i = 3; i < out.rgba.size(); i += 4)
        out.rgba[i] = 255;
    if (stereo == Stereo::anaglyph) {
        mixAnaglyph(left, right, out);
    } else {
        copyInto(left, out, 0);
        if (viewport.width >= 2 * each.width) copyInto(right, out, each.width);
    }
}

}  // namespace handpiece::view
