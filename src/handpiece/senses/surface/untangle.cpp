// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/surface/untangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "handpiece/base/geometry/self_intersection.h"
#include "handpiece/senses/surface/cell_cases.h"

namespace handpiece::surface {
namespace {

using core::Vec3;

/// How far a vertex is on its way back: nearer its cell, in it, then by halves to the mean of its crossings.
constexpr std::uint8_t kInCell = 4, kAtMean = 7;
/// Of what a vertex stands out of its cell, this share is left by a step before it is in.
constexpr double kLeftOut = 0.6;
constexpr int kRounds = 32;
/// From here on the vertices round those that cross go back with them.
constexpr int kRoundsAlone = 20;
/// Vertices keep this far from the faces of their cell [voxels].
constexpr double kMargin = 1.0 / 64.0;

class Untangler {
  public:
    Untangler(const BrickSource& source, const std::vector<std::unique_ptr<BrickState>>& bricks,
              geometry::TriangleMesh& mesh)
        : source_(source), grid_(source.grid()), bricks_(bricks), mesh_(mesh) {
        for (std::uint32_t dense = 0; dense < bricks.size(); ++dense) {
            if (bricks[dense] == nullptr) continue;
            held_.push_back(dense);
            first_.push_back(movable_);
            movable_ += static_cast<std::uint32_t>(bricks[dense]->contour.vertices.size());
        }
    }

    void run(const core::Progress& progress) {
        std::vector<geometry::CrossingFaces> crossings = geometry::selfIntersections(mesh_);
        for (int round = 0; round < kRounds && !crossings.empty(); ++round) {
            core::report(progress, 0.5 + 0.5 * static_cast<double>(round) / kRounds);
            std::vector<std::uint32_t> moved;
            for (const geometry::CrossingFaces& pair : crossings)
                addCulprits(pair, moved);
            if (round >= kRoundsAlone) addNeighbours(moved);
            std::sort(moved.begin(), moved.end());
            moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
            for (const std::uint32_t v : moved)
                pullBack(v);
            crossings = crossingsNear(moved);
        }
        core::report(progress, 1.0);
    }

  private:
    /// The one that stands farthest out of its cell; all six when none does.
    void addCulprits(const geometry::CrossingFaces& pair, std::vector<std::uint32_t>& culprits) const {
        std::uint32_t farthest = 0;
        double most = 1e-6;
        for (const std::uint32_t face : {pair.first, pair.second})
            for (const std::uint32_t v : mesh_.triangles[face]) {
                if (v >= movable_) continue;
                const Vec3 p = inVoxels(v), corner = homeOf(v).corner;
                const double out = std::max((corner - p).maxCoeff(), (p - corner).maxCoeff() - 1.0);
                if (out <= most) continue;
                most = out;
                farthest = v;
            }
        if (most > 1e-6) {
            culprits.push_back(farthest);
            return;
        }
        for (const std::uint32_t face : {pair.first, pair.second})
            culprits.insert(culprits.end(), mesh_.triangles[face].begin(), mesh_.triangles[face].end());
    }

    [[nodiscard]] Vec3 inVoxels(std::uint32_t v) const { return (mesh_.vertices[v] - grid_.originMm) / grid_.voxelMm; }

    /// Where the crossings of a vertex's sheet lie, and its cell's corner [voxels from the grid's first node].
    struct Home {
        Vec3 mean, corner;
    };
    [[nodiscard]] Home homeOf(std::uint32_t v) const {
        const auto at =
            static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), v) - first_.begin()) - 1;
        const BrickContour& contour = bricks_[held_[at]]->contour;
        const std::uint32_t index = v - first_[at];
        const std::uint16_t cell = contour.vertices[index].cell;
        const int x = cell & 7, y = cell >> 3 & 7, z = cell >> 6;
        std::array<float, field::kBrickValues> scratch;
        const float* values = source_.values(held_[at], scratch.data());
        const CellCase& sheets = cellCases()[contour.cases[cell]];
        const std::uint32_t sheet = index - contour.first[cell];
        Vec3 sum = Vec3::Zero();
        int count = 0;
        for (std::size_t i = 0; i < sheets.edgeCount; ++i) {
            const std::uint8_t edge = sheets.edges[i];
            if (sheets.sheetOf[edge] != sheet) continue;
            const int from = edgeCorner(edge), axis = edge / 4, to = from | 1 << axis;
            const auto value = [&](int c) {
                return static_cast<double>(values[x + (c & 1) + 9 * (y + (c >> 1 & 1) + 9 * (z + (c >> 2)))]);
            };
            sum += Vec3(from & 1, from >> 1 & 1, from >> 2);
            sum[axis] += value(from) / (value(from) - value(to));
            ++count;
        }
        const std::array<std::int32_t, 3> brick = grid_.at(held_[at]);
        const Vec3 corner(8 * brick[0] + x, 8 * brick[1] + y, 8 * brick[2] + z);
        return {corner + sum / count, corner};
    }

    void pullBack(std::uint32_t v) {
        if (v >= movable_) return;
        std::uint8_t& stage = stages_[v];
        if (stage == kAtMean) return;
        ++stage;
        const Home home = homeOf(v);
        const Vec3 low = home.corner + Vec3::Constant(kMargin), high = home.corner + Vec3::Constant(1.0 - kMargin);
        const Vec3 mean = home.mean.cwiseMax(low).cwiseMin(high);
        Vec3 p = inVoxels(v);
        const Vec3 within = p.cwiseMax(low).cwiseMin(high);
        p = stage < kInCell ? (within + kLeftOut * (p - within)).eval() : within;
        if (stage > kInCell) p = stage == kAtMean ? mean : (0.5 * (p + mean)).eval();
        // As files keep them.
        mesh_.vertices[v] = (grid_.originMm + grid_.voxelMm * p).cast<float>().cast<double>();
    }

    void addNeighbours(std::vector<std::uint32_t>& vertices) const {
        std::vector<bool> isGiven(mesh_.vertices.size(), false);
        for (const std::uint32_t v : vertices)
            isGiven[v] = true;
        for (const geometry::Triangle& t : mesh_.triangles)
            if (isGiven[t[0]] || isGiven[t[1]] || isGiven[t[2]]) vertices.insert(vertices.end(), t.begin(), t.end());
    }

    /// Among the faces that have a vertex within a few cells of these: no others can have come to cross.
    [[nodiscard]] std::vector<geometry::CrossingFaces> crossingsNear(const std::vector<std::uint32_t>& moved) const {
        const auto blockOf = [&](const Vec3& p) {
            const Vec3 block = (p - grid_.originMm) / (4.0 * grid_.voxelMm);
            return std::array{static_cast<std::int64_t>(std::floor(block[0])),
                              static_cast<std::int64_t>(std::floor(block[1])),
                              static_cast<std::int64_t>(std::floor(block[2]))};
        };
        const auto keyOf = [](std::int64_t x, std::int64_t y, std::int64_t z) {
            return static_cast<std::uint64_t>((x + 16) | (y + 16) << 20 | (z + 16) << 40);
        };
        std::unordered_map<std::uint64_t, bool> isNear;
        for (const std::uint32_t v : moved) {
            const auto [x, y, z] = blockOf(mesh_.vertices[v]);
            for (int n = 0; n < 27; ++n)
                isNear[keyOf(x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1)] = true;
        }
        std::vector<std::uint8_t> marks(mesh_.vertices.size());
        for (std::size_t v = 0; v < marks.size(); ++v) {
            const auto [x, y, z] = blockOf(mesh_.vertices[v]);
            marks[v] = isNear.contains(keyOf(x, y, z)) ? 1 : 0;
        }
        geometry::TriangleMesh part;
        std::vector<std::uint32_t> faces, number(mesh_.vertices.size(), ~std::uint32_t{0});
        for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
            const geometry::Triangle& t = mesh_.triangles[f];
            if ((marks[t[0]] | marks[t[1]] | marks[t[2]]) == 0) continue;
            faces.push_back(f);
            geometry::Triangle& made = part.triangles.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                std::uint32_t& to = number[t[k]];
                if (to == ~std::uint32_t{0}) {
                    to = static_cast<std::uint32_t>(part.vertices.size());
                    part.vertices.push_back(mesh_.vertices[t[k]]);
                }
                made[k] = to;
            }
        }
        std::vector<geometry::CrossingFaces> found = geometry::selfIntersections(part);
        for (geometry::CrossingFaces& pair : found) {
            pair.first = faces[pair.first];
            pair.second = faces[pair.second];
        }
        return found;
    }

    const BrickSource& source_;
    const BrickGrid& grid_;
    const std::vector<std::unique_ptr<BrickState>>& bricks_;
    geometry::TriangleMesh& mesh_;
    std::vector<std::uint32_t> held_, first_;  ///< bricks with surface, and the number of the first vertex of each
    std::uint32_t movable_ = 0;
    std::unordered_map<std::uint32_t, std::uint8_t> stages_;
};

}  // namespace

void untangle(const BrickSource& source, const std::vector<std::unique_ptr<BrickState>>& bricks,
              geometry::TriangleMesh& mesh, const core::Progress& progress) {
    Untangler(source, bricks, mesh).run(progress);
}

}  // namespace handpiece::surface
