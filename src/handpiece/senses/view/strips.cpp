// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/strips.h"

#include <algorithm>
#include <cmath>

namespace handpiece::view {
namespace {

constexpr int kRowPixels = 32;
constexpr float kMarginPixels = 2.0f, kFarPixels = 1e6f;

int wholePixel(float x) {
    return static_cast<int>(std::floor(std::clamp(x, -kFarPixels, kFarPixels)));
}

}  // namespace

Strips::Strips(const PixelRect& bounds) : bounds_(bounds) {
    const int rows = bounds.isEmpty() ? 0 : (bounds.y1 - bounds.y0 + kRowPixels - 1) / kRowPixels;
    rows_.assign(static_cast<std::size_t>(rows), {bounds.x1, bounds.x0});
}

void Strips::addHull(std::span<const gl::Vec2f> points) {
    for (std::size_t row = 0; row < rows_.size(); ++row) {
        const float top = static_cast<float>(bounds_.y0 + kRowPixels * static_cast<int>(row)) - kMarginPixels;
        const float low = top + kRowPixels + 2.0f * kMarginPixels;
        float x0 = kFarPixels, x1 = -kFarPixels;
        // The hull's edges are among the lines between any two points.
        for (std::size_t i = 0; i < points.size(); ++i)
            for (std::size_t k = i; k < points.size(); ++k) {
                const gl::Vec2f &a = points[i], &b = points[k];
                const float begin = std::max(top, std::min(a.y(), b.y())), end = std::min(low, std::max(a.y(), b.y()));
                if (begin > end) continue;
                for (const float y : {begin, end}) {
                    const float high = b.y() - a.y();
                    const float share = std::abs(high) > 1e-6f ? std::clamp((y - a.y()) / high, 0.0f, 1.0f) : 0.0f;
                    const float x = a.x() + share * (b.x() - a.x());
                    x0 = std::min({x0, x, high == 0.0f ? b.x() : x});
                    x1 = std::max({x1, x, high == 0.0f ? b.x() : x});
                }
            }
        if (x0 > x1) continue;
        rows_[row].x0 = std::min(rows_[row].x0, wholePixel(x0 - kMarginPixels));
        rows_[row].x1 = std::max(rows_[row].x1, wholePixel(x1 + kMarginPixels) + 1);
    }
}

void Strips::addAll() {
    for (Range& row : rows_)
        row = {bounds_.x0, bounds_.x1};
}

std::vector<PixelRect> Strips::rects() const {
    std::vector<PixelRect> rects;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
        const int y0 = bounds_.y0 + kRowPixels * static_cast<int>(row);
        const PixelRect rect = PixelRect{rows_[row].x0, y0, rows_[row].x1, y0 + kRowPixels}.common(bounds_);
        if (!rect.isEmpty()) rects.push_back(rect);
    }
    return rects;
}

}  // namespace handpiece::view
