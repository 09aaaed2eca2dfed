// SPDX-License-Identifier: Apache-2.0
#include "handpiece/senses/view/slice.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace handpiece::view {
namespace {

using core::Vec2;
using core::Vec3;

struct Segment {
    Vec2 from, to;
};
struct Outline {
    const cases::Part* part;
    std::vector<Segment> segments;
};

/// Distances are told up to here [pixels].
constexpr double kReach = 3.0;
/// Meshes of tissues that touch leave slits of some hundredths of a millimetre: a pixel between two of a tissue is
/// filled.
constexpr int kSlit = 1;

/// Where a mesh goes through the plane, along two axes in it.
std::vector<Segment> segmentsOf(const geometry::TriangleMesh& mesh, const Plane& plane, const Vec3& u, const Vec3& v) {
    std::vector<double> above(mesh.vertices.size());
    for (std::size_t i = 0; i < above.size(); ++i)
        above[i] = plane.normal.dot(mesh.vertices[i]) - plane.offsetMm;
    const auto crossing = [&](std::uint32_t a, std::uint32_t b) {
        if (a > b) std::swap(a, b);  // to the bit the same for both triangles at an edge
        const Vec3 p = mesh.vertices[a] + above[a] / (above[a] - above[b]) * (mesh.vertices[b] - mesh.vertices[a]);
        return Vec2(u.dot(p), v.dot(p));
    };
    std::vector<Segment> segments;
    for (const geometry::Triangle& t : mesh.triangles) {
        const bool isAbove[3] = {above[t[0]] >= 0.0, above[t[1]] >= 0.0, above[t[2]] >= 0.0};
        if (isAbove[0] == isAbove[1] && isAbove[1] == isAbove[2]) continue;
        // The corner that lies alone on its side.
        const int alone = isAbove[1] == isAbove[2] ? 0 : isAbove[0] == isAbove[2] ? 1 : 2;
        const std::uint32_t a = t[static_cast<std::size_t>(alone)], b = t[static_cast<std::size_t>((alone + 1) % 3)],
                            c = t[static_cast<std::size_t>((alone + 2) % 3)];
        segments.push_back({crossing(a, b), crossing(a, c)});
    }
    return segments;
}

double distanceTo(const Vec2& p, const Segment& s) {
    const Vec2 along = s.to - s.from;
    const double squared = along.squaredNorm();
    const double share = squared > 0.0 ? std::clamp((p - s.from).dot(along) / squared, 0.0, 1.0) : 0.0;
    return (p - s.from - share * along).norm();
}

/// Pixels by tissue; places in pixels.
class Raster {
  public:
    Raster(int width, int height)
        : width_(width), height_(height), tissue_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

    [[nodiscard]] std::uint8_t at(int x, int y) const {
        return x < 0 || y < 0 || x >= width_ || y >= height_ ? std::uint8_t{0} : tissue_[place(x, y)];
    }
    [[nodiscard]] std::uint8_t at(const Vec2& p) const {
        return at(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
    }

    /// What lies within the outline, by how often a row comes across it.
    void fill(const std::vector<Segment>& outline, std::uint8_t tissue) {
        std::vector<std::vector<double>> crossings(static_cast<std::size_t>(height_));
        for (const Segment& s : outline) {
            const auto [low, high] = std::minmax({s.from.y(), s.to.y()});
            for (int y = std::max(0, static_cast<int>(std::ceil(low))); y < height_ && y < high; ++y)
                crossings[static_cast<std::size_t>(y)].push_back(
                    s.from.x() + (y - s.from.y()) / (s.to.y() - s.from.y()) * (s.to.x() - s.from.x()));
        }
        for (int y = 0; y < height_; ++y) {
            auto& row = crossings[static_cast<std::size_t>(y)];
            std::sort(row.begin(), row.end());
            for (std::size_t i = 0; i + 1 < row.size(); i += 2)
                for (int x = std::max(0, static_cast<int>(std::ceil(row[i]))); x < width_ && x < row[i + 1]; ++x)
                    tissue_[place(x, y)] = tissue;
        }
    }

    void fillSlits() {
        const std::vector<std::uint8_t> was = tissue_;
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                if (was[place(x, y)] != 0) continue;
                for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
                    std::uint8_t before = 0, after = 0;
                    for (int k = kSlit; k > 0; --k) {
                        if (const int bx = x - k * dx, by = y - k * dy; bx >= 0 && by >= 0 && was[place(bx, by)] != 0)
                            before = was[place(bx, by)];
                        if (const int ax = x + k * dx, ay = y + k * dy;
                            ax < width_ && ay < height_ && was[place(ax, ay)] != 0)
                            after = was[place(ax, ay)];
                    }
                    if (before != 0 && after != 0) tissue_[place(x, y)] = before;
                }
            }
    }

    /// How far the pixels beside a boundary lie from it, as SectionFace has them.
    void measure(const std::vector<Segment>& outline) {
        if (away_.empty()) away_.resize(tissue_.size(), {kReach, kReach});
        for (const Segment& whole : outline) {
            const Vec2 along = whole.to - whole.from;
            const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm())));
            for (int i = 0; i < pieces; ++i) {
                const Segment s{whole.from + along * i / pieces, whole.from + along * (i + 1) / pieces};
                const Vec2 middle = 0.5 * (s.from + s.to), across = 1.5 * Vec2(-along.y(), along.x()).normalized();
                const std::uint8_t one = at(Vec2(middle - across)), other = at(Vec2(middle + across));
                if (one == other) continue;  // it lies within another part
                const int x0 = static_cast<int>(std::floor(middle.x() - kReach)),
                          y0 = static_cast<int>(std::floor(middle.y() - kReach));
                for (int y = std::max(0, y0); y < std::min(height_, y0 + 8); ++y)
                    for (int x = std::max(0, x0); x < std::min(width_, x0 + 8); ++x) {
                        const double far = distanceTo(Vec2(x, y), s);
                        auto& [others, surface] = away_[place(x, y)];
                        others = std::min(others, far);
                        if (one == 0 || other == 0) surface = std::min(surface, far);
                    }
            }
        }
    }

    void give(SectionFace& face) {
        face.width = width_;
        face.height = height_;
        face.tissue = std::move(tissue_);
        for (const std::array<double, 2>& far : away_)
            face.away.push_back({inSteps(far[0]), inSteps(far[1])});
    }

  private:
    [[nodiscard]] std::size_t place(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    static std::uint8_t inSteps(double pixels) {
        return static_cast<std::uint8_t>(std::clamp(std::lround(32.0 * pixels), 1L, 255L));
    }

    int width_, height_;
    std::vector<std::uint8_t> tissue_;
    std::vector<std::array<double, 2>> away_;
};

}  // namespace

std::optional<SectionFace> sliceOf(const cases::PlacedTooth& tooth, const Plane& plane, double mmPerPixel) {
    // Upright as a probe's section; then in the tooth's own frame.
    const Vec3 &n = plane.normal, up = std::abs(n.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitY();
    SectionFace face;
    face.plane = plane;
    face.mmPerPixel = mmPerPixel;
    face.vAxis = (up - n * n.dot(up)).normalized();
    face.uAxis = face.vAxis.cross(n);
    const core::Quat toOwn = tooth.inCase.orientation.conjugate();
    const Plane own{toOwn * n, plane.offsetMm - n.dot(tooth.inCase.positionMm)};
    const Vec3 u = toOwn * face.uAxis, v = toOwn * face.vAxis;
    std::vector<Outline> outlines;
    Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);
    for (const cases::Part& part : tooth.parts) {
        Outline outline{&part, segmentsOf(part.mesh, own, u, v)};
        for (const Segment& s : outline.segments) {
            low = low.cwiseMin(s.from).cwiseMin(s.to);
            high = high.cwiseMax(s.from).cwiseMax(s.to);
        }
        if (!outline.segments.empty()) outlines.push_back(std::move(outline));
    }
    if (outlines.empty()) return std::nullopt;
    std::stable_sort(outlines.begin(), outlines.end(),
                     [](const Outline& a, const Outline& b) { return a.part->priority < b.part->priority; });
    low -= Vec2::Constant(kReach * mmPerPixel);
    const Vec2 size = (high - low) / mmPerPixel + Vec2::Constant(kReach);
    Raster raster(static_cast<int>(std::ceil(size.x())), static_cast<int>(std::ceil(size.y())));
    for (Outline& outline : outlines) {
        for (Segment& s : outline.segments)
            s = {(s.from - low) / mmPerPixel, (s.to - low) / mmPerPixel};
        raster.fill(outline.segments, static_cast<std::uint8_t>(outline.part->tissue));
    }
    raster.fillSlits();
    for (const Outline& outline : outlines)
        raster.measure(outline.segments);
    face.originMm = tooth.inCase.apply(low.x() * u + low.y() * v + own.offsetMm * own.normal);
    raster.give(face);
    return face;
}

}  // namespace handpiece::view
