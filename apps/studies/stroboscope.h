// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The paper's stroboscope pictures as SVG: a tooth cut open at the bur's place, and the bur where it successively was.

#include <string>
#include <vector>

#include "handpiece/base/geometry/triangle_mesh.h"
#include "handpiece/model/instrument/bur.h"

namespace handpiece::studies {

struct Stroboscope {
    std::vector<core::Vec3> tipsMm;  ///< the bur's tip, shank along +z; all in one plane y = const
    std::vector<bool> touching;      ///< drawn stronger
    double upMm = 6.0;               ///< how much of the tooth below and of the air above the touch is shown
    int width = 760;
    const geometry::TriangleMesh* before = nullptr;  ///< the tooth before it was cut, shown as a dashed outline
};

/// Section of the tooth through the tips' plane (x to the right, z up), behind it the silhouette, before it the bur.
/// Throws core::Error without tips.
[[nodiscard]] std::string stroboscopeSvg(const geometry::TriangleMesh& tooth, const instrument::Bur& bur,
                                         const Stroboscope& shot);

}  // namespace handpiece::studies
