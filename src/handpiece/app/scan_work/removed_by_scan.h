// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What of a tooth a scan shows as gone. Private to this room.

#include <memory>
#include <vector>

#include "handpiece/app/scan_work/scan_mesh.h"

namespace handpiece::scan_work {

/// Vertices of cut surface: pieces that lie deep enough, and what hangs on them that is deeper than `growMm`.
[[nodiscard]] std::vector<char> cutVertices(const TriangleMesh& mesh, const std::vector<double>& distances,
                                            const std::vector<double>& areas, double growMm);

/// What a scan shows as gone: how far a place lies from it, negative in it.
class Removed {
  public:
    /// Beside a cut the surface counts where it is deeper than `growMm`, farther off nowhere.
    Removed(const TriangleMesh& mesh, const std::vector<char>& cut, const TriangleTree& whole, double growMm);
    [[nodiscard]] double operator()(const Vec3& p) const;

  private:
    [[nodiscard]] bool isInside(const Vec3& p) const;

    TriangleTree tree_;
    std::unique_ptr<TriangleTree> rim_, cut_, beside_, folded_;
    std::vector<Vec3> even_;  ///< by face
    const TriangleTree& whole_;
    double growMm_;
};

}  // namespace handpiece::scan_work
