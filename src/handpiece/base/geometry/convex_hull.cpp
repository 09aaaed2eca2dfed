// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/geometry/convex_hull.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "handpiece/base/core/error.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace handpiece::geometry {
namespace {

// Qhull writes its complaints to a FILE; this one ends in a string.
class Complaints {
  public:
    Complaints() : file_(open_memstream(&text_, &size_)) {
        if (!file_) throw core::Error("no memory left for the convex hull");
    }
    ~Complaints() {
        std::fclose(file_);
        std::free(text_);
    }
    Complaints(const Complaints&) = delete;
    Complaints& operator=(const Complaints&) = delete;
    [[nodiscard]] std::FILE* file() const { return file_; }
    [[nodiscard]] std::string firstLine() const {
        std::fflush(file_);
        const std::string all(text_, size_);
        return all.substr(0, all.find('\n'));
    }

  private:
    char* text_ = nullptr;
    std::size_t size_ = 0;
    std::FILE* file_;
};

class Qhull {
  public:
    Qhull() { qh_zero(&state_, complaints_.file()); }
    ~Qhull() {
        qh_freeqhull(&state_, !qh_ALL);
        int blocks = 0, bytes = 0;
        qh_memfreeshort(&state_, &blocks, &bytes);
    }
    Qhull(const Qhull&) = delete;
    Qhull& operator=(const Qhull&) = delete;

    /// The triangles of the hull of `points` (x, y, z, x, ...), as indices into the points.
    std::vector<Triangle> run(std::vector<double>& points) {
        // Qt triangulates merged facets; QJ (joggling) would move the input and is not used.
        char options[] = "qhull Qt Pp";
        const int exitCode = qh_new_qhull(&state_, 3, static_cast<int>(points.size() / 3), points.data(), False,
                                          options, nullptr, complaints_.file());
        if (exitCode == qh_ERRsingular || exitCode == qh_ERRprec)
            throw core::Error("all points lie in one plane, so they have no convex hull with a volume", "convex hull",
                              "give a closed surface");
        if (exitCode != 0) throw core::Error(fmt::format("Qhull failed: {}", complaints_.firstLine()), "convex hull");
        const qhT* const qh = &state_;
        std::vector<Triangle> triangles;
        triangles.reserve(static_cast<std::size_t>(state_.num_facets));
        facetT* facet = nullptr;
        FORALLfacets {
            Triangle triangle{};
            int corner = 0;
            vertexT *vertex = nullptr, **vertexp = nullptr;
            FOREACHvertex_(facet->vertices) {
                if (corner < 3)
                    triangle[static_cast<std::size_t>(corner)] =
                        static_cast<std::uint32_t>(qh_pointid(&state_, vertex->point));
                ++corner;
            }
            if (corner != 3) throw core::Error("Qhull left a facet that is no triangle", "convex hull");
            if (facet->toporient != qh_ORIENTclock) std::swap(triangle[1], triangle[2]);
            triangles.push_back(triangle);
        }
        return triangles;
    }

  private:
    Complaints complaints_;
    qhT state_{};
};

}  // namespace

ConvexHull::ConvexHull(std::span<const core::Vec3> points) {
    if (points.size() < 4)
        throw core::Error(fmt::format("{} points have no convex hull with a volume", points.size()), "convex hull",
                          "give a closed surface");
    if (points.size() > 100'000'000)
        throw core::Error("more than 100 million points", "convex hull", "coarsen the surface");
    std::vector<double> flat;
    flat.reserve(points.size() * 3);
    for (const core::Vec3& p : points) {
        if (!p.allFinite()) throw core::Error("a point is not a finite number", "convex hull", "repair the surface");
        flat.insert(flat.end(), {p.x(), p.y(), p.z()});
    }
    mesh_.triangles = Qhull().run(flat);

    // Keep only the points on the hull, in the order they were given.
    std::vector<std::uint32_t> place(points.size(), kNoVertex);
    for (const Triangle& t : mesh_.triangles)
        for (const std::uint32_t corner : t)
            place[corner] = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (place[i] == kNoVertex) continue;
        place[i] = static_cast<std::uint32_t>(mesh_.vertices.size());
        mesh_.vertices.push_back(points[i]);
    }
    for (Triangle& t : mesh_.triangles)
        for (std::uint32_t& corner : t)
            corner = place[corner];
    for (const core::Vec3& v : mesh_.vertices) {
        centreMm_ += v;
        for (int axis = 0; axis < 3; ++axis)
            coordinates_[static_cast<std::size_t>(axis)].push_back(v[axis]);
    }
    centreMm_ /= static_cast<double>(mesh_.vertices.size());
    tieMm_ = 1e-9 * mesh_.bounds().size().norm();
    buildAdjacency();
    buildStarts();
}

void ConvexHull::buildAdjacency() {
    std::vector<std::vector<std::uint32_t>> rings(mesh_.vertices.size());
    for (const Triangle& t : mesh_.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            rings[t[i]].push_back(t[(i + 1) % 3]);
            rings[t[i]].push_back(t[(i + 2) % 3]);
        }
    firstNeighbour_.push_back(0);
    for (auto& ring : rings) {
        std::sort(ring.begin(), ring.end());
        ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
        for (const std::uint32_t i : ring) {
            const core::Vec3& v = mesh_.vertices[i];
            neighbours_.push_back({v.x(), v.y(), v.z(), i});
        }
        firstNeighbour_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
    }
}

void ConvexHull::buildStarts() {
    binsPerEdge_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(vertexCount()) / 6.0)), 8, 64);
    std::uint32_t start = 0;
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < binsPerEdge_; ++row)
            for (int column = 0; column < binsPerEdge_; ++column) {
                core::Vec3 direction;
                direction[face / 2] = face % 2 == 0 ? 1.0 : -1.0;
                direction[(face / 2 + 1) % 3] = (2 * column + 1.0) / binsPerEdge_ - 1.0;
                direction[(face / 2 + 2) % 3] = (2 * row + 1.0) / binsPerEdge_ - 1.0;
                start = climb(direction, start, direction.dot(vertex(start))).vertex;
                starts_.push_back(start);
            }
}

std::uint32_t ConvexHull::binOf(const core::Vec3& d) const noexcept {
    const double ax = std::abs(d.x()), ay = std::abs(d.y()), az = std::abs(d.z());
    const int axis = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;
    const double length = axis == 0 ? ax : axis == 1 ? ay : az;
    const double scale = 0.5 * binsPerEdge_ / length;
    const auto cell = [&](double value) {
        return std::min(static_cast<int>(value * scale + 0.5 * binsPerEdge_), binsPerEdge_ - 1);
    };
    const int face = 2 * axis + (d[axis] < 0.0 ? 1 : 0);
    return static_cast<std::uint32_t>((face * binsPerEdge_ + cell(d[(axis + 2) % 3])) * binsPerEdge_ +
                                      cell(d[(axis + 1) % 3]));
}

ConvexHull::Summit ConvexHull::climb(const core::Vec3& d, std::uint32_t from, double value) const noexcept {
    const double x = d.x(), y = d.y(), z = d.z();
    Summit summit{from, value, 0.0};
    for (;;) {
        const std::uint32_t here = summit.vertex;
        summit.nextValue = -std::numeric_limits<double>::infinity();
        for (std::uint32_t i = firstNeighbour_[here], end = firstNeighbour_[here + 1]; i != end; ++i) {
            const Neighbour& n = neighbours_[i];
            const double v = x * n.x + y * n.y + z * n.z;
            if (v > summit.value) {
                summit.value = v;
                summit.vertex = n.vertex;
            } else if (v > summit.nextValue) {
                summit.nextValue = v;
            }
        }
        if (summit.vertex == here) return summit;
    }
}

std::uint32_t ConvexHull::support(const core::Vec3& d, std::uint32_t startVertex) const noexcept {
    const auto at = [&](std::uint32_t i) {
        const core::Vec3& v = mesh_.vertices[i];
        return d.x() * v.x() + d.y() * v.y() + d.z() * v.z();
    };
    const double length = d.cwiseAbs().maxCoeff();
    if (!(length > 0.0) || !std::isfinite(length)) return startVertex == kNoVertex ? 0 : startVertex;
    std::uint32_t start = starts_[binOf(d)];
    double value = at(start);
    if (startVertex != kNoVertex) {
        const double given = at(startVertex);
        if (given > value) {
            start = startVertex;
            value = given;
        }
    }
    Summit summit = climb(d, start, value);
    // A merged facet is flat only to rounding, so a summit can be a false one: look behind neighbours that (almost)
    // tie.
    const double tie = tieMm_ * length;
    for (bool again = summit.value - summit.nextValue <= tie; again;) {
        again = false;
        for (std::uint32_t i = firstNeighbour_[summit.vertex], end = firstNeighbour_[summit.vertex + 1]; i != end;
             ++i) {
            const Neighbour& n = neighbours_[i];
            const double v = d.x() * n.x + d.y() * n.y + d.z() * n.z;
            if (summit.value - v > tie) continue;
            const Summit behind = climb(d, n.vertex, v);
            if (behind.value > summit.value) {
                summit = behind;
                again = true;
                break;
            }
        }
    }
    return summit.vertex;
}

std::vector<std::uint32_t> ConvexHull::neighbours(std::uint32_t i) const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t k = firstNeighbour_[i]; k != firstNeighbour_[i + 1]; ++k)
        result.push_back(neighbours_[k].vertex);
    return result;
}

}  // namespace handpiece::geometry
