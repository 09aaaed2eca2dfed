// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/cheeks.h"

#include <algorithm>
#include <vector>

#include "handpiece/base/core/error.h"

namespace handpiece::dentition {
namespace {

using core::Box;
using core::Vec2;
using core::Vec3;
using geometry::TriangleMesh;

constexpr double kBehindMolarsMm = 8.0, kAboveCrownsMm = 12.0, kLipHeightMm = 18.0;
constexpr double kCornerBehindLipMm = 8.0;  ///< the corner of the mouth lies farther back than the lips' middle

/// What a line in the plan covers, carried on by `across` and from `low` up to `high`: a closed solid.
TriangleMesh wall(const std::vector<Vec2>& line, const Vec2& across, double low, double high) {
    TriangleMesh mesh;
    const auto n = static_cast<std::uint32_t>(line.size());
    // Four corners a place of the line: inner low, outer low, inner high, outer high.
    for (const Vec2& at : line)
        for (const double z : {low, high})
            for (const Vec2& p : {at, Vec2(at + across)})
                mesh.vertices.emplace_back(p.x(), p.y(), z);
    const auto quad = [&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
        const std::uint32_t a = 4 * i, b = a + 4;
        quad(a, b, b + 1, a + 1);          // below
        quad(a + 2, a + 3, b + 3, b + 2);  // above
        quad(a, a + 2, b + 2, b);          // inside
        quad(a + 1, b + 1, b + 3, a + 3);  // outside
    }
    quad(0, 1, 3, 2);
    const std::uint32_t e = 4 * (n - 1);
    quad(e, e + 2, e + 3, e + 1);
    if (geometry::enclosedVolumeMm3(mesh) < 0.0)
        for (auto& t : mesh.triangles)
            std::swap(t[1], t[2]);
    return mesh;
}

}  // namespace

Cheeks makeCheeks(std::span<const TriangleMesh> teethInMouth) {
    if (teethInMouth.size() != kToothCount) throw core::Error("cheeks need all teeth of a mouth", "cheeks", "give 32");
    std::vector<Box> boxes;
    for (const TriangleMesh& tooth : teethInMouth)
        boxes.push_back(tooth.bounds());
    const auto boxOf = [&](int fdi) -> const Box& { return boxes[indexOf(fdi)]; };

    const double halfWidth = 0.5 * (boxOf(23).max.x() - boxOf(13).min.x()) / kCaninesOverMouth;
    double front = 0.0;  // of the teeth
    for (const Box& box : boxes)
        front = std::min(front, box.min.y());
    const double lip = front - kLipOffTeethMm, corner = lip + kCornerBehindLipMm;
    const double upperEdge = std::min(boxOf(11).min.z(), boxOf(21).min.z());
    const double lowerEdge = std::max(boxOf(31).max.z(), boxOf(41).max.z());
    double top = upperEdge, bottom = lowerEdge;
    for (std::size_t i = 0; i < kToothCount; ++i) {
        // Roots lie under the vestibule: only as far as crowns stand out.
        top = std::max(top, isUpper(i) ? boxes[i].min.z() + kAboveCrownsMm : top);
        bottom = std::min(bottom, isUpper(i) ? bottom : boxes[i].max.z() - kAboveCrownsMm);
    }

    Cheeks made;
    for (const double side : {1.0, -1.0}) {
        // From the corner of the mouth backwards, off the widest of both jaws; never nearer than farther in front.
        std::vector<Vec2> line{{side * halfWidth, corner}};
        double out = halfWidth, back = corner;
        for (int tooth = 4; tooth <= 8; ++tooth) {
            const Box &upper = boxOf((side > 0.0 ? 20 : 10) + tooth), &lower = boxOf((side > 0.0 ? 30 : 40) + tooth);
            const double widest =
                side > 0.0 ? std::max(upper.max.x(), lower.max.x()) : -std::min(upper.min.x(), lower.min.x());
            out = std::max(out, widest + kCheekOffTeethMm);
            back = std::max(back + 0.5, upper.centre().y());
            line.emplace_back(side * out, back);
        }
        line.emplace_back(side * out, back + kBehindMolarsMm);
        (side > 0.0 ? made.left : made.right) = wall(line, {side * kCheekThicknessMm, 0.0}, bottom, top);
    }
    const std::vector<Vec2> lips{{-halfWidth, corner},
                                 {-0.5 * halfWidth, lip + 0.25 * kCornerBehindLipMm},
                                 {0.0, lip},
                                 {0.5 * halfWidth, lip + 0.25 * kCornerBehindLipMm},
                                 {halfWidth, corner}};
    const Vec2 forwards(0.0, -kCheekThicknessMm);
    const double upperLip = upperEdge - kLipOverEdgeMm, lowerLip = lowerEdge + kLipOverEdgeMm;
    made.upperLip = wall(lips, forwards, upperLip, upperLip + kLipHeightMm);
    made.lowerLip = wall(lips, forwards, lowerLip - kLipHeightMm, lowerLip);
    return made;
}

}  // namespace handpiece::dentition
