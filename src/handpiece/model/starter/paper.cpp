// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/starter/paper.h"

#include <fmt/format.h>

#include "handpiece/base/core/error.h"

namespace handpiece::starter {
namespace {
constexpr PaperResolution kResolutions[] = {{"6 %", 4882, 9760},
                                            {"12 %", 9762, 19516},
                                            {"25 %", 20335, 40656},
                                            {"50 %", 34273, 68151},
                                            {"100 %", 162672, 325312}};
constexpr std::uint32_t kSide = 13;

void requirePositive(double value, const char* what) {
    if (!(value > 0.0) || !std::isfinite(value)) throw core::Error(fmt::format("{} mm is not a size", value), what);
}
}  // namespace

std::span<const PaperResolution> paperResolutions() {
    return kResolutions;
}

geometry::TriangleMesh makePlane(double edgeMm) {
    requirePositive(edgeMm, "the plane's edge");
    geometry::TriangleMesh mesh;
    const double step = edgeMm / (kSide - 1);
    for (std::uint32_t y = 0; y < kSide; ++y)
        for (std::uint32_t x = 0; x < kSide; ++x)
            mesh.vertices.emplace_back(x * step - 0.5 * edgeMm, y * step - 0.5 * edgeMm, 0.0);
    for (std::uint32_t y = 0; y + 1 < kSide; ++y)
        for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
            const std::uint32_t a = y * kSide + x, b = a + 1, c = a + kSide, d = c + 1;
            mesh.triangles.push_back({a, b, d});
            mesh.triangles.push_back({a, d, c});
        }
    return mesh;
}

geometry::TriangleMesh makePlaneSlab(double edgeMm, double thicknessMm) {
    requirePositive(thicknessMm, "the slab's thickness");
    geometry::TriangleMesh mesh = makePlane(edgeMm);
    const auto top = static_cast<std::uint32_t>(mesh.vertices.size());
    const std::size_t topFaces = mesh.triangles.size();
    for (std::uint32_t v = 0; v < top; ++v)
        mesh.vertices.push_back(mesh.vertices[v] - core::Vec3(0.0, 0.0, thicknessMm));
    for (std::size_t t = 0; t < topFaces; ++t) {
        const geometry::Triangle f = mesh.triangles[t];
        mesh.triangles.push_back({f[0] + top, f[2] + top, f[1] + top});
    }
    // Around the border, counter-clockwise from above.
    std::vector<std::uint32_t> border;
    for (std::uint32_t i = 0; i + 1 < kSide; ++i)
        border.push_back(i);
    for (std::uint32_t i = 0; i + 1 < kSide; ++i)
        border.push_back(i * kSide + kSide - 1);
    for (std::uint32_t i = kSide - 1; i > 0; --i)
        border.push_back((kSide - 1) * kSide + i);
    for (std::uint32_t i = kSide - 1; i > 0; --i)
        border.push_back(i * kSide);
    for (std::size_t i = 0; i < border.size(); ++i) {
        const std::uint32_t a = border[i], b = border[(i + 1) % border.size()];
        mesh.triangles.push_back({a, a + top, b + top});
        mesh.triangles.push_back({a, b + top, b});
    }
    return mesh;
}

}  // namespace handpiece::starter
