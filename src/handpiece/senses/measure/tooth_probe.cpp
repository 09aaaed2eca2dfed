// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/measure/tooth_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/measure/field_ray.h"
#include "handpiece/senses/measure/pulp_surface.h"

namespace handpiece::measure {
namespace {

using cases::Tissue;
using core::Vec3;
using field::kBrickCells;
using field::kBrickNodes;

constexpr double kMaxPixels = 64e6;
constexpr float kAwaySteps = 32.0f;  // of Section::away

/// Calls found(low, high, lowNode, highNode) for the edges of a brick's cells that begin at nodes 0..7.
template <class Found>
void eachEdge(const Found& found) {
    constexpr int kStep[3] = {1, kBrickNodes, kBrickNodes * kBrickNodes};
    for (int z = 0; z < kBrickCells; ++z)
        for (int y = 0; y < kBrickCells; ++y)
            for (int x = 0; x < kBrickCells; ++x) {
                const int low = x + kStep[1] * y + kStep[2] * z;
                for (int axis = 0; axis < 3; ++axis)
                    found(low, low + kStep[axis], std::array<int, 3>{x, y, z}, axis);
            }
}

/// Distances [pixels] of a picture's pixels to a boundary between them: those that are only bounds are held to what the
/// pixels beside them tell, of which one across the boundary is no farther from it than the way between the two.
template <class Same>
void holdToNeighbours(std::vector<float>& away, int width, int height, const Same& same) {
    constexpr float kDiagonal = 1.4142135f;
    const auto from = [&](int x, int y, int dx, int dy) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height) return;
        const auto at = static_cast<std::size_t>(x) + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
        const auto by =
            static_cast<std::size_t>(x + dx) + static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width);
        const float way = dx != 0 && dy != 0 ? kDiagonal : 1.0f;
        away[at] = std::min(away[at], same(at, by) ? away[by] + way : way);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const auto& [dx, dy] : {std::pair{-1, 0}, {-1, -1}, {0, -1}, {1, -1}})
                from(x, y, dx, dy);
    for (int y = height - 1; y >= 0; --y)
        for (int x = width - 1; x >= 0; --x)
            for (const auto& [dx, dy] : {std::pair{1, 0}, {1, 1}, {0, 1}, {-1, 1}})
                from(x, y, dx, dy);
}

std::uint8_t inSteps(float pixels) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(kAwaySteps * pixels), 1L, 255L));
}

bool isUnit(const Vec3& v) {
    return v.allFinite() && std::abs(v.squaredNorm() - 1.0) < 1e-6;
}

}  // namespace

struct ToothProbe::State {
    explicit State(const tooth::ToothMirror& m) : mirror(m), base(m.model()), field(m) {}

    /// Null when the tooth has no pulp. Made when first asked for.
    const PulpSurface* pulp() {
        if (!pulpSurface) pulpSurface = std::make_unique<PulpSurface>(base);
        return pulpSurface->isEmpty() ? nullptr : pulpSurface.get();
    }
    /// Farther than a voxel inside the surface before any cut.
    [[nodiscard]] bool wasDeep(const Vec3& p) const {
        const field::DistanceField& uncut = base.field;
        return uncut.distance(p) < (uncut.isFine(p) ? -uncut.settings().voxelMm : 0.0);
    }
    /// At a point in the tooth; `awayMm` becomes less where what is of another tissue is nearer than that.
    [[nodiscard]] Tissue tissueAt(const Vec3& p, double& awayMm) const {
        const field::TissueMap& map = base.tissues;
        const field::FieldView& view = field.view();
        std::int32_t brick[3];
        int cell[3];
        double t[3];
        for (int k = 0; k < 3; ++k) {
            const double u = (p[k] - view.originMm[k]) * view.inverseVoxelMm;
            if (!(u >= 0.0 && u <= kBrickCells * view.bricks[k])) return map.at(p);
            const int whole = std::min(static_cast<int>(u), kBrickCells * view.bricks[k] - 1);
            brick[k] = whole / kBrickCells;
            cell[k] = whole % kBrickCells;
            t[k] = u - whole;
        }
        const field::TissueMap::Layers layers =
            map.layers(static_cast<std::uint32_t>(brick[0] + view.bricks[0] * (brick[1] + view.bricks[1] * brick[2])));
        const int corner = cell[0] + kBrickNodes * (cell[1] + kBrickNodes * cell[2]);
        for (const field::TissueMap::Layer& layer : layers.layers) {
            double value = 0.0;
            for (int i = 0; i < 8; ++i) {
                const int dx = i & 1, dy = i >> 1 & 1, dz = i >> 2;
                const double weight = (dx ? t[0] : 1.0 - t[0]) * (dy ? t[1] : 1.0 - t[1]) * (dz ? t[2] : 1.0 - t[2]);
                value += weight * layer.values[corner + dx + kBrickNodes * (dy + kBrickNodes * dz)];
            }
            awayMm = std::min(awayMm, std::abs(value) * map.unitMm());
            if (value < 0.0) return layer.tissue;
        }
        return layers.rest;
    }
    /// What a ray along `inward` meets at a point of the surface.
    [[nodiscard]] Tissue under(const Vec3& p, const Vec3& inward) const {
        const double voxel = base.field.settings().voxelMm;
        for (const double depth : {0.5, 1.0, 1.5})
            if (const Tissue t = base.tissues.at(p + depth * voxel * inward); t != Tissue::none) return t;
        return base.field.tissueAt(p);
    }

    const tooth::ToothMirror& mirror;
    const tooth::ToothModel& base;
    FieldRay field;
    std::unique_ptr<PulpSurface> pulpSurface;
};

ToothProbe::ToothProbe(const tooth::ToothMirror& mirror) : state_(std::make_unique<State>(mirror)) {}
ToothProbe::~ToothProbe() = default;

double ToothProbe::signedDistanceMm(const Vec3& pointMm) const {
    return state_->field.signedDistanceMm(pointMm);
}

Tissue ToothProbe::tissueAt(const Vec3& pointMm) const {
    return state_->field.signedDistanceMm(pointMm) < 0.0 ? state_->base.tissues.at(pointMm) : Tissue::none;
}

std::optional<Hit> ToothProbe::cast(const Vec3& originMm, const Vec3& direction, double farMm) const {
    if (!originMm.allFinite() || !isUnit(direction) || !(farMm > 0.0)) return {};
    const std::optional<double> at = state_->field.firstZeroMm(originMm, direction, farMm);
    if (!at) return {};
    Hit hit;
    hit.distanceMm = *at;
    hit.pointMm = originMm + *at * direction;
    hit.normal = state_->field.normal(hit.pointMm);
    if (hit.normal.isZero()) hit.normal = -direction;
    hit.tissue = state_->under(hit.pointMm, -hit.normal);
    hit.cut = state_->wasDeep(hit.pointMm);
    return hit;
}

std::optional<Hit> ToothProbe::castUncut(const Vec3& originMm, const Vec3& direction, double farMm) const {
    if (!originMm.allFinite() || !isUnit(direction) || !(farMm > 0.0)) return {};
    const geometry::TriangleTree& tree = state_->base.tree;
    const geometry::RayMeeting met = tree.firstMeeting(originMm, direction, farMm);
    if (met.triangle == geometry::kNoTriangle) return {};
    Hit hit;
    hit.distanceMm = met.distanceMm;
    hit.pointMm = originMm + met.distanceMm * direction;
    const geometry::TreeTriangle& t = tree.triangles()[met.triangle];
    const Vec3 ab(t.ab[0], t.ab[1], t.ab[2]), ac(t.ac[0], t.ac[1], t.ac[2]);
    hit.normal = ab.cross(ac).normalized();
    hit.tissue = state_->under(hit.pointMm, -hit.normal);
    return hit;
}

double ToothProbe::depthBelowUncutMm(const Vec3& pointMm) const {
    return -state_->base.tree.signedDistance(pointMm);
}

std::optional<double> ToothProbe::depthAlongMm(const Vec3& pointMm, const Vec3& towards) const {
    if (!pointMm.allFinite() || !isUnit(towards)) return {};
    const geometry::TriangleTree& tree = state_->base.tree;
    if (tree.signedDistance(pointMm) >= 0.0) return 0.0;
    const geometry::RayMeeting met = tree.firstMeeting(pointMm, towards);
    if (met.triangle == geometry::kNoTriangle) return {};
    return met.distanceMm;
}

std::optional<double> ToothProbe::leftOverPulpMm(const Vec3& pointMm) const {
    const PulpSurface* pulp = state_->pulp();
    if (pulp == nullptr || !pointMm.allFinite()) return {};
    if (state_->base.tissues.at(pointMm) == Tissue::pulp) return 0.0;
    return pulp->distanceMm(pointMm);
}

std::optional<ToothProbe::Thinnest> ToothProbe::thinnestOverPulp() const {
    State& s = *state_;
    const PulpSurface* pulp = s.pulp();
    if (pulp == nullptr) return {};
    const field::FieldView& view = s.field.view();
    std::vector<std::uint32_t> changed;
    for (std::uint32_t dense = 0; dense < s.base.field.storage().coarse.size(); ++dense)
        if (s.mirror.isChanged(dense)) changed.push_back(dense);
    // Each brick's own thinnest place: what is farther than that found so far costs next to nothing.
    std::vector<std::optional<Thinnest>> found(changed.size());
    core::parallelFor(changed.size(), 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const float* v = s.field.nodes(changed[i]);
            double best = std::numeric_limits<double>::infinity();
            eachEdge([&](int low, int high, const std::array<int, 3>& node, int axis) {
                if ((v[low] < 0.0f) == (v[high] < 0.0f)) return;
                Vec3 p = nodeMm(view, changed[i], node[0], node[1], node[2]);
                p[axis] += view.voxelMm * static_cast<double>(v[low]) / (static_cast<double>(v[low]) - v[high]);
                if (!s.wasDeep(p)) return;
                if (s.base.tissues.at(p) == Tissue::pulp) {
                    if (best > 0.0) found[i] = Thinnest{p, best = 0.0};
                    return;
                }
                const double left = pulp->distanceMm(p, best);
                if (!(left < best)) return;
                best = left;
                found[i] = Thinnest{p, best};
            });
        }
    });
    std::optional<Thinnest> thinnest;
    for (const std::optional<Thinnest>& f : found)
        if (f && (!thinnest || f->leftMm < thinnest->leftMm)) thinnest = f;
    return thinnest;
}

Section ToothProbe::section(const Vec3& normal, double offsetMm, double mmPerPixel) const {
    if (!normal.allFinite() || !(normal.norm() > 1e-9) || !std::isfinite(offsetMm))
        throw core::Error("a section needs a plane", "section", "give a direction and a distance that are finite");
    if (!(mmPerPixel > 0.0) || !std::isfinite(mmPerPixel))
        throw core::Error("a section needs pixels with a size", "section", "0.05 mm is a field's voxel");
    const Vec3 n = normal.normalized();
    // Upright where it can be: the tooth's long axis upwards, else its y.
    const Vec3 up = std::abs(n.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitY();
    Section section;
    section.vAxis = (up - n * n.dot(up)).normalized();
    section.uAxis = section.vAxis.cross(n);
    section.mmPerPixel = mmPerPixel;
    const core::Box box = state_->base.field.bounds();
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p((corner & 1) != 0 ? box.max.x() : box.min.x(), (corner & 2) != 0 ? box.max.y() : box.min.y(),
                     (corner & 4) != 0 ? box.max.z() : box.min.z());
        const double uv[2] = {section.uAxis.dot(p), section.vAxis.dot(p)};
        for (int k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], uv[k]);
            high[k] = std::max(high[k], uv[k]);
        }
    }
    const double wide = std::ceil((high[0] - low[0]) / mmPerPixel), tall = std::ceil((high[1] - low[1]) / mmPerPixel);
    if (wide * tall > kMaxPixels)
        throw core::Error("a section of so many pixels is not worth its memory", "section", "take larger pixels");
    section.width = std::max(1, static_cast<int>(wide));
    section.height = std::max(1, static_cast<int>(tall));
    section.originMm = (low[0] + 0.5 * mmPerPixel) * section.uAxis + (low[1] + 0.5 * mmPerPixel) * section.vAxis +
                       offsetMm / normal.norm() * n;
    const auto width = static_cast<std::size_t>(section.width), height = static_cast<std::size_t>(section.height);
    section.tissue.assign(width * height, 0);
    std::vector<float> others(width * height), surface(width * height);  // [pixels]
    core::parallelFor(height, 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t j = begin; j < end; ++j) {
            const Vec3 row = section.originMm + static_cast<double>(j) * mmPerPixel * section.vAxis;
            for (std::size_t i = 0; i < width; ++i) {
                const Vec3 p = row + static_cast<double>(i) * mmPerPixel * section.uAxis;
                const double outMm = state_->field.signedDistanceMm(p);
                const std::size_t at = j * width + i;
                double awayMm = std::abs(outMm);
                surface[at] = static_cast<float>(awayMm / mmPerPixel);
                if (outMm < 0.0) section.tissue[at] = static_cast<std::uint8_t>(state_->tissueAt(p, awayMm));
                others[at] = static_cast<float>(awayMm / mmPerPixel);
            }
        }
    });
    const auto isOf = [&](std::size_t a, std::size_t b) { return section.tissue[a] == section.tissue[b]; };
    const auto isSide = [&](std::size_t a, std::size_t b) {
        return (section.tissue[a] == 0) == (section.tissue[b] == 0);
    };
    holdToNeighbours(others, section.width, section.height, isOf);
    holdToNeighbours(surface, section.width, section.height, isSide);
    section.away.resize(width * height);
    for (std::size_t at = 0; at < section.away.size(); ++at)
        section.away[at] = {inSteps(others[at]), inSteps(surface[at])};
    return section;
}

std::vector<float> ToothProbe::removedDepths(const std::vector<std::array<float, 3>>& verticesMm) const {
    std::vector<float> depths(verticesMm.size(), 0.0f);
    const field::DistanceField& uncut = state_->base.field;
    const geometry::TriangleTree& tree = state_->base.tree;
    const double nearby = 0.25 * uncut.settings().voxelMm;
    core::parallelFor(verticesMm.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3 p(static_cast<double>(verticesMm[i][0]), static_cast<double>(verticesMm[i][1]),
                         static_cast<double>(verticesMm[i][2]));
            // Most of a tooth is as it was: a surface that is the field's own is not measured against the triangles.
            if (!p.allFinite() || (uncut.isFine(p) && uncut.distance(p) > -nearby)) continue;
            depths[i] = static_cast<float>(std::max(0.0, -tree.signedDistance(p)));
        }
    });
    return depths;
}

}  // namespace handpiece::measure
