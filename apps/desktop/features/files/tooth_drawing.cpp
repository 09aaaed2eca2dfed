// SPDX-License-Identifier: Apache-2.0
#include "desktop/features/files/tooth_drawing.h"

#include <algorithm>

namespace handpiece::desktop {
namespace {

/// Of a tooth's height, from above: what is seen of a crown.
constexpr double kCrownShare = 0.4;

/// Around the points, none of them outside.
QPolygonF hullOf(std::vector<QPointF> points) {
    std::sort(points.begin(), points.end(),
              [](const QPointF& a, const QPointF& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
    QPolygonF hull;
    const auto half = [&hull](auto begin, auto end) {
        const qsizetype first = hull.size();
        for (auto p = begin; p != end; ++p) {
            while (hull.size() >= first + 2) {
                const QPointF a = hull.last() - hull[hull.size() - 2], b = *p - hull.last();
                if (a.x() * b.y() - a.y() * b.x() > 0.0) break;
                hull.removeLast();
            }
            hull << *p;
        }
        if (!hull.isEmpty()) hull.removeLast();  // the other half begins with it
    };
    half(points.begin(), points.end());
    half(points.rbegin(), points.rend());
    return hull;
}

}  // namespace

ToothDrawing drawingOf(const cases::Tooth& tooth) {
    const double buccal = tooth.buccalSign < 0 ? -1.0 : 1.0;
    const geometry::TriangleMesh& surface = tooth.surface();
    const core::Box box = surface.bounds();
    const double from = box.max.z() - kCrownShare * (box.max.z() - box.min.z());
    std::vector<QPointF> crown;
    for (const core::Vec3& v : surface.vertices)
        if (v.z() >= from) crown.emplace_back(v.x(), buccal * v.y());
    ToothDrawing drawing{hullOf(std::move(crown)), {}};
    for (const cases::Landmark& mark : tooth.landmarks) {
        if (mark.kind != cases::LandmarkKind::fissure) continue;
        QPolygonF& line = drawing.grooves.emplace_back();
        for (const core::Vec3& p : mark.pointsMm)
            line << QPointF(p.x(), buccal * p.y());
    }
    return drawing;
}

std::map<int, ToothDrawing> drawingsOf(const cases::Case& toothCase) {
    std::map<int, ToothDrawing> drawings;
    const auto add = [&drawings](const cases::Tooth& tooth) {
        if (tooth.fdiNumber != 0 && tooth.surface().vertices.size() > 3) drawings[tooth.fdiNumber] = drawingOf(tooth);
    };
    add(toothCase);
    for (const cases::PlacedTooth& other : toothCase.others)
        add(other);
    return drawings;
}

}  // namespace handpiece::desktop
