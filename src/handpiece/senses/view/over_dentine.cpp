// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/over_dentine.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "handpiece/base/core/parallel.h"
#include "handpiece/base/geometry/triangle_tree.h"

namespace handpiece::view {
namespace {

constexpr double kMarginMm = 0.2;

bool isDentine(cases::Tissue tissue) {
    return tissue == cases::Tissue::dentine ||
           std::find(cases::kCariousLevels.begin(), cases::kCariousLevels.end(), tissue) != cases::kCariousLevels.end();
}

}  // namespace

void OverDentine::set(std::span<const cases::Part> parts) {
    known_ = Known::nothing;
    core::Box box;
    std::vector<geometry::TriangleTree> dentine;
    for (const cases::Part& part : parts) {
        if (part.mesh.triangles.empty()) continue;
        if (part.tissue == cases::Tissue::enamel)
            for (const core::Vec3& v : part.mesh.vertices)
                box.extend(v);
        if (isDentine(part.tissue)) dentine.emplace_back(part.mesh);
    }
    if (box.isEmpty()) return;
    if (dentine.empty()) {
        known_ = Known::none;
        return;
    }
    box = box.grown(kMarginMm);
    const core::Vec3 stepMm = box.size() / (kSide - 1);
    constexpr int kRows = kSide / kTilesAcross, kWide = kSide * kTilesAcross;
    static_assert(kRows * kTilesAcross == kSide);
    std::vector<std::uint8_t> tiles(static_cast<std::size_t>(kWide) * kRows * kSide);
    core::parallelFor(kSide, 1, [&](std::size_t from, std::size_t to) {
        for (int z = static_cast<int>(from); z < static_cast<int>(to); ++z)
            for (int y = 0; y < kSide; ++y)
                for (int x = 0; x < kSide; ++x) {
                    const core::Vec3 p = box.min + stepMm.cwiseProduct(core::Vec3(x, y, z));
                    double mm = kMostMm;
                    for (const geometry::TriangleTree& tree : dentine)
                        mm = std::min(mm, tree.signedDistance(p));
                    const int column = z % kTilesAcross * kSide + x, row = z / kTilesAcross * kSide + y;
                    tiles[static_cast<std::size_t>(row) * kWide + static_cast<std::size_t>(column)] =
                        static_cast<std::uint8_t>(std::lround(255.0 / kMostMm * std::max(0.0, mm)));
                }
    });
    tiles_.fill(kWide, kRows * kSide, GL_R8, GL_RED, GL_UNSIGNED_BYTE, tiles.data(), true);
    lowMm_ = box.min.cast<float>();
    perMm_ = stepMm.cwiseInverse().cast<float>();
    known_ = Known::distances;
}

void OverDentine::give(gl::Program& program, int unit) const {
    program.set("hasDentine", static_cast<int>(known_));
    if (known_ != Known::distances) return;
    program.set("dentineTiles", tiles_, unit);
    program.set("dentineLow", lowMm_);
    program.set("perDentine", perMm_);
}

}  // namespace handpiece::view
