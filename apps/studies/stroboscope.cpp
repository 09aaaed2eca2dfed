// SPDX-License-Identifier: Apache-2.0
#include "studies/stroboscope.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/model/instrument/piece.h"

namespace handpiece::studies {
namespace {

using core::Vec2;
using core::Vec3;
using EdgeKey = std::pair<std::uint32_t, std::uint32_t>;

/// Closed outlines where the plane y = `y` cuts the mesh, as (x, z).
std::vector<std::vector<Vec2>> sectionOf(const geometry::TriangleMesh& mesh, double y) {
    // Each cut triangle joins two of its edges; walking the joints gives the outlines.
    std::map<EdgeKey, std::vector<EdgeKey>> joints;
    const auto above = [&](std::uint32_t v) { return mesh.vertices[v].y() >= y; };
    for (const geometry::Triangle& t : mesh.triangles) {
        std::vector<EdgeKey> cut;
        for (std::size_t i = 0; i < 3; ++i)
            if (const std::uint32_t a = t[i], b = t[(i + 1) % 3]; above(a) != above(b))
                cut.emplace_back(std::min(a, b), std::max(a, b));
        if (cut.size() != 2) continue;
        joints[cut[0]].push_back(cut[1]);
        joints[cut[1]].push_back(cut[0]);
    }
    const auto pointOn = [&](const EdgeKey& e) {
        const Vec3 &a = mesh.vertices[e.first], &b = mesh.vertices[e.second];
        const Vec3 p = a + (y - a.y()) / (b.y() - a.y()) * (b - a);
        return Vec2(p.x(), p.z());
    };
    std::vector<std::vector<Vec2>> outlines;
    while (!joints.empty()) {
        std::vector<Vec2> outline;
        for (auto at = joints.begin(); at != joints.end();) {
            const std::vector<EdgeKey> next = at->second;
            outline.push_back(pointOn(at->first));
            joints.erase(at);
            at = joints.end();
            for (const EdgeKey& edge : next)
                if (const auto found = joints.find(edge); found != joints.end()) {
                    at = found;
                    break;
                }
        }
        if (outline.size() > 2) outlines.push_back(std::move(outline));
    }
    return outlines;
}

/// The highest and lowest point of the mesh seen along y, column by column: what stands behind the section.
std::vector<Vec2> silhouetteOf(const geometry::TriangleMesh& mesh, int columns) {
    const core::Box box = mesh.bounds();
    const double step = box.size().x() / columns;
    constexpr double kInf = std::numeric_limits<double>::infinity();
    std::vector<double> high(static_cast<std::size_t>(columns) + 1, -kInf), low(high.size(), kInf);
    for (const geometry::Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
            const double from = (std::min(a.x(), b.x()) - box.min.x()) / step;
            const double to = (std::max(a.x(), b.x()) - box.min.x()) / step;
            for (auto c = static_cast<std::size_t>(std::ceil(from)); static_cast<double>(c) <= to && c < high.size();
                 ++c) {
                const double x = box.min.x() + static_cast<double>(c) * step, dx = b.x() - a.x();
                const double z = dx == 0.0 ? std::max(a.z(), b.z()) : a.z() + (x - a.x()) / dx * (b.z() - a.z());
                high[c] = std::max(high[c], z);
                low[c] = std::min(low[c], z);
            }
        }
    std::vector<Vec2> outline;
    for (std::size_t c = 0; c < high.size(); ++c)
        if (high[c] >= low[c]) outline.emplace_back(box.min.x() + static_cast<double>(c) * step, high[c]);
    for (std::size_t c = high.size(); c-- > 0;)
        if (high[c] >= low[c]) outline.emplace_back(box.min.x() + static_cast<double>(c) * step, low[c]);
    return outline;
}

std::vector<Vec2> outlineOf(const instrument::Profile& profile) {
    constexpr int kArcSteps = 16;
    std::vector<Vec2> right;
    for (const instrument::ProfilePiece& piece : profile.pieces) {
        const int steps = piece.isArc ? kArcSteps : 1;
        for (int i = 0; i <= steps; ++i)
            right.push_back(instrument::pointAt(piece, static_cast<double>(i) / steps));
    }
    std::vector<Vec2> all = right;
    for (auto p = right.rbegin(); p != right.rend(); ++p)
        all.emplace_back(-p->x(), p->y());
    return all;
}

}  // namespace

std::string stroboscopeSvg(const geometry::TriangleMesh& tooth, const instrument::Bur& bur, const Stroboscope& shot) {
    if (shot.tipsMm.empty()) throw core::Error("a stroboscope needs a place of the bur", "stroboscope");
    double touchZ = shot.tipsMm.back().z();
    for (std::size_t i = 0; i < shot.tipsMm.size(); ++i)
        if (shot.touching[i]) {
            touchZ = shot.tipsMm[i].z();
            break;
        }
    const core::Box box = tooth.bounds();
    constexpr double kMarginMm = 0.6;
    const double left = box.min.x() - kMarginMm, widthMm = box.size().x() + 2.0 * kMarginMm;
    const double scale = shot.width / widthMm, top = touchZ + shot.upMm;
    const int height = static_cast<int>(2.0 * shot.upMm * scale);
    const auto path = [&](const std::vector<Vec2>& points, const Vec2& offset) {
        std::string d;
        for (const Vec2& p : points)
            d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? "M" : "L", (p.x() + offset.x() - left) * scale,
                             (top - p.y() - offset.y()) * scale);
        return d + "Z";
    };
    std::string body = fmt::format("<path class=\"hp-behind\" d=\"{}\"/>\n", path(silhouetteOf(tooth, 300), {0, 0}));
    const auto sectionPath = [&](const geometry::TriangleMesh& mesh) {
        std::string d;
        for (const std::vector<Vec2>& outline : sectionOf(mesh, shot.tipsMm.front().y()))
            d += path(outline, {0, 0});
        return d;
    };
    if (shot.before != nullptr)
        body += fmt::format("<path class=\"hp-line hp-c7 hp-dash\" d=\"{}\"/>\n", sectionPath(*shot.before));
    if (const std::string section = sectionPath(tooth); !section.empty())
        body += fmt::format("<path class=\"hp-tooth\" fill-rule=\"evenodd\" d=\"{}\"/>\n", section);
    const std::vector<Vec2> outline = outlineOf(bur.profile());
    for (std::size_t i = 0; i < shot.tipsMm.size(); ++i)
        body += fmt::format("<path class=\"{}\" d=\"{}\"/>\n", shot.touching[i] ? "hp-bur-touch" : "hp-bur",
                            path(outline, {shot.tipsMm[i].x(), shot.tipsMm[i].z()}));
    // A millimetre, to see how large it all is.
    const double y = height - 16.0;
    body += fmt::format(
        "<path class=\"hp-frame\" stroke-width=\"1.5\" d=\"M16 {0:.1f}v8M16 {1:.1f}h{2:.1f}M{3:.1f} {0:.1f}v8\"/>"
        "<text x=\"{4:.1f}\" y=\"{5:.1f}\">1 mm</text>\n",
        y - 4, y, scale, 16 + scale, 22 + scale, y + 4);
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"hp\" viewBox=\"0 0 {} {}\" role=\"img\">\n{}</svg>\n",
        shot.width, height, body);
}

}  // namespace handpiece::studies
