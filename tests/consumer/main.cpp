// SPDX-License-Identifier: Apache-2.0
// A researcher's first program: a cube, a ball bur 0.25 mm deep in its top, the depth printed.
#include <cmath>
#include <cstdio>
#include <memory>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/shapes.h"
#include "handpiece/model/tooth/tooth_model.h"
#include "handpiece/tick/contact/field_method.h"

int main() {
    using namespace handpiece;
    try {
        cases::Case block;
        block.name = "block";
        for (int i = 0; i < 8; ++i)
            block.outer.vertices.emplace_back(i & 1 ? 4.0 : -4.0, i & 2 ? 4.0 : -4.0, i & 4 ? 0.0 : -8.0);
        block.outer.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
        tooth::LoadSettings settings;
        settings.useCache = false;
        const auto bur = std::make_shared<instrument::Bur>(instrument::makeBur("round:1.0x1.0"));
        const auto method = contact::makeFieldMethod(tooth::loadModel(block, settings), bur);
        const contact::Depth depth = method->depth({core::Vec3(0.3, 0.2, -0.25), core::Quat::Identity()});
        std::printf("depth %.7f mm\n", depth.depthMm);
        return std::abs(depth.depthMm - 0.25) < 1e-6 ? 0 : 1;
    } catch (const core::Error& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
