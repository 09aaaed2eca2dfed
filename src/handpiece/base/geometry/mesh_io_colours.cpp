// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/base/geometry/mesh_io_formats.h"

namespace handpiece::geometry::formats {

VertexColours FoundColours::settle(const Source& source, std::size_t vertices, double leastScale,
                                   double mostScale) const {
    if (found_.empty()) return {};
    constexpr const char* kLeftOut = "the colours are left out: ";
    if (found_.size() != vertices) {
        source.note(fmt::format("{}{} of {} vertices have one", kLeftOut, found_.size(), vertices));
        return {};
    }
    float most = 0.0f;
    std::size_t senseless = 0;
    for (const auto& colour : found_)
        for (const float channel : colour) {
            if (!(channel >= 0.0f && std::isfinite(channel))) ++senseless;
            most = std::max(most, channel);
        }
    constexpr float kRounding = 1.01f;
    const double scale = most <= kRounding && leastScale <= 1.0                            ? 1.0
                         : (most <= 255.0f && leastScale <= 255.0) || !(mostScale > 255.0) ? 255.0
                                                                                           : 65535.0;
    if (senseless > 0 || !(static_cast<double>(most) <= std::max(scale, static_cast<double>(kRounding)))) {
        source.note(
            fmt::format("{}{}", kLeftOut,
                        senseless > 0 ? "some are negative or no numbers" : "they go beyond any scale of colours"));
        return {};
    }
    VertexColours colours(vertices);
    for (std::size_t v = 0; v < vertices; ++v)
        for (std::size_t k = 0; k < 3; ++k)
            colours[v][k] = static_cast<std::uint8_t>(
                std::floor(255.0 * std::min(static_cast<double>(found_[v][k]) / scale, 1.0) + 0.5));
    // As some programs write it for want of any: what is made of it would hide the tissues.
    if (std::all_of(colours.begin(), colours.end(), [&](const Colour& c) { return c == colours.front(); })) {
        source.note(fmt::format("{}all vertices have the same", kLeftOut));
        return {};
    }
    return colours;
}

}  // namespace handpiece::geometry::formats
