// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The part of the gingiva that a bur has cut, in triangles fine enough for a groove, and the blood on it. Private to
/// this room. Only drawn: nothing of it is felt.

#include <array>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "handpiece/base/core/vec.h"
#include "handpiece/base/messages/gingiva_cut.h"
#include "handpiece/senses/view/mesh_pool.h"

namespace handpiece::view {

/// How deep in the bur a place is [mm]: by the nearer way out, aside or past the tip; negative outside.
[[nodiscard]] double depthInBur(const messages::GingivaCut& cut, const core::Vec3& pMm);

/// Vertices are one a place, however many pieces share it, so that what is displaced stays closed.
class WoundedGingiva {
  public:
    /// So deep a groove is at most [mm]: gingiva gives way before it is cut.
    static constexpr double kDeepestMm = 0.6;

    /// Adds a piece of the gingiva, under a number of its own.
    void add(std::uint32_t piece, const MeshPiece& mesh);
    [[nodiscard]] bool has(std::uint32_t piece) const { return pieces_.contains(piece); }
    /// Opens the gingiva where the bur was; `fineMm`: in there edges are short enough for a trickle.
    void cut(const messages::GingivaCut& cut, const core::Box& fineMm);
    /// Blood comes out of what was cut, and runs, for `stepS`; `down`: unit.
    void flow(double timeS, double stepS, const core::Vec3& down);
    /// The pieces that look different since the last call, or all of them, by their numbers.
    [[nodiscard]] std::vector<std::pair<std::uint32_t, MeshPiece>> takeChanged(bool all);

  private:
    struct Vertex {
        core::Vec3 restMm;                        ///< uncut
        core::Vec3 normal = core::Vec3::Zero();   ///< of the surface as cut, without blood
        core::Vec3 inward = core::Vec3::Zero();   ///< summed over cuts, each as long as it is deep
        core::Vec3 outward = core::Vec3::Zero();  ///< the same of their swollen edges
        double depthMm = 0.0, openedS = 0.0;
        double areaMm2 = 0.0, filmMm = 0.0, drawnFilmMm = 0.0;
        float underMm = 0.0f;
    };
    struct Face {
        std::array<std::uint32_t, 3> corners;
        std::array<core::Vec3, 3> normals;  ///< of the uncut surface, which may have a crease here
        std::uint32_t piece;
    };
    struct Edge {
        std::uint32_t from, to;
        double lengthMm;
    };
    using Middles = std::unordered_map<std::uint64_t, std::uint32_t>;  ///< edge -> vertex in its middle

    [[nodiscard]] static core::Vec3 groundMm(const Vertex& v);
    static void split(const Face& face, const Middles& middles, std::vector<Face>& to);
    void refine(const messages::GingivaCut& cut, const core::Box& fineMm);
    void open(const messages::GingivaCut& cut);
    void connect();
    [[nodiscard]] MeshPiece meshOf(std::uint32_t piece, const std::vector<core::Vec3>& placesMm,
                                   const std::vector<core::Vec3>& normals) const;

    std::vector<Vertex> vertices_;
    std::vector<Face> faces_;
    std::vector<Edge> edges_;
    std::map<std::array<float, 3>, std::uint32_t> known_;  ///< place -> vertex
    std::map<std::uint32_t, bool> pieces_;                 ///< number -> looks different
    std::vector<double> heightMm_, gainMm3_;               ///< of vertices within one step
};

}  // namespace handpiece::view
