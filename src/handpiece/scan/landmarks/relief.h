// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A surface seen from above: heights on a square grid. Private to this room.

#include <optional>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/geometry/triangle_mesh.h"

namespace handpiece::landmarks {

/// Heights do not hang on how the mesh is cut into triangles, and its noise is blurred.
class Relief {
  public:
    /// Seen along z, from above. `blurMm`: standard deviation.
    Relief(const geometry::TriangleMesh& mesh, double blurMm);

    /// At a place of the mesh's frame, by the node next to it; none where nothing is seen.
    [[nodiscard]] std::optional<double> heightAt(const core::Vec2& p) const;

    /// Tops of the blurred heights that stand so far above the highest saddle towards a higher one, by falling height:
    /// places in the mesh's frame, between the nodes. Edges of what is seen count too.
    [[nodiscard]] std::vector<core::Vec3> peaks(double leastProminenceMm) const;
    /// The same of what lies low; where nothing is seen all runs off.
    [[nodiscard]] std::vector<core::Vec3> hollows(double leastProminenceMm) const;

  private:
    static constexpr double kStepMm = 0.1;

    [[nodiscard]] std::size_t size() const { return height_.size(); }
    [[nodiscard]] std::size_t at(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i);
    }
    [[nodiscard]] bool isThere(std::size_t node) const { return weight_[node] > 0.5; }
    void raster(const geometry::TriangleMesh& mesh);
    void blur(double blurMm);

    core::Vec2 from_ = core::Vec2::Zero();
    int columns_ = 0, rows_ = 0;
    std::vector<double> height_, weight_;
};

}  // namespace handpiece::landmarks
