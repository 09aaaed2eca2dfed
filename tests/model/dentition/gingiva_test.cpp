// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/gingiva.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>

#include "handpiece/base/geometry/inspect.h"
#include "handpiece/base/geometry/self_intersection.h"
#include "model/dentition/mouths.h"

namespace handpiece::dentition::gingiva_test {
namespace {

using core::Vec2;

/// What a look from outside at one arch tells.
struct Looks {
    std::vector<double> margins, tips;
    double standsOut = -10.0;  ///< farthest that gingiva between two teeth stands before the line laid on both
    double pit = -10.0;        ///< deepest behind it under the papillae
    int holes = 0, rays = 0;
    bool isClosed = false, isOneShell = false, crosses = true;
};

struct Between {
    std::size_t a, b;
    Vec3 contact, up, along, out;
    bool isInCrowns;
};

Vec3 neckOf(const Mouth& m, std::size_t i, const Vec3& direction) {
    const double side = (m.arches.toothInMouth[i].orientation.conjugate() * direction).y() > 0.0 ? 1.0 : -1.0;
    Vec3 best = Vec3::Zero();
    for (const cases::Landmark& mark : m.teeth[i].landmarks)
        if (mark.kind == LandmarkKind::cementoEnamelJunction)
            for (const Vec3& p : mark.pointsMm)
                if (p.y() * side > best.y() * side) best = p;
    return m.arches.toothInMouth[i].apply(best);
}

Between betweenOf(const Mouth& m, std::size_t a, std::size_t b) {
    Between w{a, b, Vec3::Zero(), {}, {}, {}, false};
    (void)gapOf(m, a, b, 0.3, &w.contact);
    const Pose &one = m.arches.toothInMouth[a], &two = m.arches.toothInMouth[b];
    w.up = (one.orientation * Vec3::UnitZ() + two.orientation * Vec3::UnitZ()).normalized();
    const Vec3 across = two.positionMm - one.positionMm;
    w.along = (across - across.dot(w.up) * w.up).normalized();
    w.out = w.up.cross(w.along);
    if (w.out.dot(one.orientation * Vec3(0.0, m.teeth[a].buccalSign, 0.0)) < 0.0) w.out = -w.out;
    w.isInCrowns = one.applyInverse(w.contact).z() > 1.5 && two.applyInverse(w.contact).z() > 1.5;
    return w;
}

/// What one sees from one side of two teeth at one height: places along the arch, and how far out they are.
struct Outline {
    std::vector<Vec2> one, two;
    /// The line laid on both, at a place between where it touches them.
    [[nodiscard]] std::optional<double> lineAt(double along) const {
        std::optional<double> line;
        for (const Vec2& p : one)
            for (const Vec2& q : two) {
                if (along < p.x() || along > q.x()) continue;
                const double at = p.y() + (along - p.x()) / (q.x() - p.x()) * (q.y() - p.y());
                if (!line || at > *line) line = at;
            }
        return line;
    }
};
Outline outlineOf(const Mouth& m, const Between& w, double side, double height) {
    Outline outline;
    for (const auto& [i, points] : {std::pair{w.a, &outline.one}, std::pair{w.b, &outline.two}}) {
        const double middle = (m.arches.toothInMouth[i].positionMm - w.contact).dot(w.along);
        for (double share = 0.05; share <= 0.76; share += 0.05) {
            const double at = share * middle;
            const Vec3 from = w.contact + height * w.up + at * w.along + side * 9.0 * w.out;
            const geometry::RayMeeting hit = m.trees[i].firstMeeting(from, -side * w.out, 14.0);
            if (hit.triangle != geometry::kNoTriangle) points->push_back({at, 9.0 - hit.distanceMm});
        }
    }
    return outline;
}

/// As seen in the middle of a face: how far over the junction the gingiva comes up.
double marginOf(const Mouth& m, const TriangleTree& gingiva, std::size_t i, double side) {
    const Pose& pose = m.arches.toothInMouth[i];
    const Vec3 neck = pose.applyInverse(neckOf(m, i, pose.orientation * Vec3(0.0, side, 0.0)));
    const Vec3 inwards = pose.orientation * Vec3(0.0, -side, 0.0);
    for (double over = 3.0; over > -3.0; over -= 0.02) {
        const Vec3 from = pose.apply(Vec3(neck.x(), neck.y() + side * 4.0, neck.z() + over));
        const auto tooth = m.trees[i].firstMeeting(from, inwards, 10.0);
        const auto gum = gingiva.firstMeeting(from, inwards, 10.0);
        if (gum.triangle != geometry::kNoTriangle && gum.distanceMm < tooth.distanceMm) return over;
    }
    return -3.0;
}

/// A closed line on a surface, a place every kLineMm.
using Line = std::vector<Vec3>;
constexpr double kLineMm = 0.1;

Line evenly(const Line& rough) {
    Line even;
    double along = 0.0;
    for (std::size_t i = 0; i < rough.size(); ++i) {
        const Vec3 step = rough[(i + 1) % rough.size()] - rough[i];
        const double length = step.norm();
        for (; along < length; along += kLineMm)
            even.push_back(rough[i] + along / length * step);
        along -= length;
    }
    return even;
}

/// Where what the vertices of a closed mesh hold changes its sign.
std::vector<Line> linesBetweenSigns(const TriangleMesh& mesh, const std::vector<double>& values) {
    std::map<std::uint64_t, std::uint64_t> next;  // from edge to edge, through a triangle
    for (const geometry::Triangle& t : mesh.triangles) {
        std::uint64_t in = 0, out = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint64_t a = t[k], b = t[(k + 1) % 3];
            if ((values[a] < 0.0) != (values[b] < 0.0))
                (values[a] < 0.0 ? out : in) = std::min(a, b) << 32 | std::max(a, b);
        }
        if (in != out) next[in] = out;
    }
    std::vector<Line> lines;
    while (!next.empty()) {
        Line rough;
        for (auto at = next.begin(); at != next.end();) {
            const std::uint64_t a = at->first >> 32, b = at->first & 0xffffffffu, to = at->second;
            rough.push_back((values[b] * mesh.vertices[a] - values[a] * mesh.vertices[b]) / (values[b] - values[a]));
            next.erase(at);
            at = next.find(to);
        }
        lines.push_back(evenly(rough));
    }
    return lines;
}

/// How far a place of a line is off the parabola through those 0.8 mm to either side, least squares (Savitzky and
/// Golay): nothing of a scallop as round as a papilla's tip, nearly all of a step.
double stepAt(const Line& line, std::size_t i) {
    constexpr int kTo = 8;
    if (line.size() < 2 * kTo + 1) return 0.0;
    Vec3 smooth = Vec3::Zero();
    for (int j = -kTo; j <= kTo; ++j)
        smooth += 3.0 * (3 * kTo * kTo + 3 * kTo - 1 - 5 * j * j) / ((2 * kTo - 1) * (2 * kTo + 1) * (2 * kTo + 3)) *
                  line[(i + line.size() + static_cast<std::size_t>(j + kTo) - kTo) % line.size()];
    return (line[i] - smooth).norm();
}

/// The margin of the gingiva: where it leaves a tooth. One line round it, if nothing is torn.
std::vector<Line> marginsRound(const Mouth& m, const TriangleMesh& gingiva, std::size_t i) {
    const core::Box near = m.trees[i].bounds().grown(1.0);
    std::vector<double> distances;
    for (const Vec3& p : gingiva.vertices)
        distances.push_back(((p - near.min).array() < 0.0).any() || ((near.max - p).array() < 0.0).any()
                                ? 1.0
                                : m.trees[i].signedDistance(p));
    return linesBetweenSigns(gingiva, distances);
}

Looks lookAt(const Mouth& m, const Held& h) {
    Looks looks;
    const TriangleMesh& mesh = h.tissues.gingiva;
    const geometry::MeshReport report = geometry::inspect(mesh);
    looks.isClosed = report.closed() && report.oriented() && report.nonManifoldVertices == 0;
    looks.isOneShell = report.shells == 1;
    looks.crosses =
        !geometry::selfIntersections(mesh, 1).empty() || !geometry::selfIntersections(h.tissues.bone, 1).empty();
    const TriangleTree gingiva(mesh);
    for (const std::size_t i : h.order)
        for (const double side : {1.0, -1.0}) {
            if (i % 8 < 7) looks.margins.push_back(marginOf(m, gingiva, i, side));
        }
    for (std::size_t k = 1; k < h.order.size(); ++k) {
        const Between w = betweenOf(m, h.order[k - 1], h.order[k]);
        if (!w.isInCrowns || w.a % 8 == 7 || w.b % 8 == 7) continue;  // third molars stand as they can
        double tip = -10.0;
        for (const Vec3& p : mesh.vertices) {
            const Vec3 d = p - w.contact;
            if (std::abs(d.dot(w.along)) < 0.5 && std::abs(d.dot(w.out)) < 1.0) tip = std::max(tip, d.dot(w.up));
        }
        looks.tips.push_back(tip);
        const auto isMet = [&](const TriangleTree& tree, const Vec3& from, const Vec3& to) {
            return tree.firstMeeting(from, to, 18.0).triangle != geometry::kNoTriangle;
        };
        // Straight across, from lip to tongue: nothing passes under the papilla.
        for (double height = tip - 0.4; height > -7.0; height -= 0.3)
            for (double along = -3.0; along <= 3.0; along += 0.15) {
                const Vec3 from = w.contact + height * w.up + along * w.along + 9.0 * w.out;
                ++looks.rays;
                if (isMet(m.trees[w.a], from, -w.out) || isMet(m.trees[w.b], from, -w.out)) continue;
                looks.holes += isMet(gingiva, from, -w.out) ? 0 : 1;
            }
        for (const double side : {1.0, -1.0}) {
            const auto marginAt = [&](std::size_t i) {
                return (neckOf(m, i, side * w.out) - w.contact).dot(w.up) + kMarginOverCervixMm;
            };
            const double one = marginAt(w.a), two = marginAt(w.b);
            const double toOne = (m.arches.toothInMouth[w.a].positionMm - w.contact).dot(w.along),
                         toTwo = (m.arches.toothInMouth[w.b].positionMm - w.contact).dot(w.along);
            for (double height = tip; height > std::min(one, two) - 3.0; height -= 0.25) {
                const Outline outline = outlineOf(m, w, side, height);
                for (double along = -1.5; along <= 1.5; along += 0.25) {
                    const double margin = one + (along - toOne) / (toTwo - toOne) * (two - one);
                    const std::optional<double> line = outline.lineAt(along);
                    const Vec3 from = w.contact + height * w.up + along * w.along + side * 9.0 * w.out;
                    const geometry::RayMeeting gum = gingiva.firstMeeting(from, -side * w.out, 14.0);
                    if (!line || gum.triangle == geometry::kNoTriangle) continue;
                    if (m.trees[w.a].firstMeeting(from, -side * w.out, gum.distanceMm).triangle !=
                            geometry::kNoTriangle ||
                        m.trees[w.b].firstMeeting(from, -side * w.out, gum.distanceMm).triangle !=
                            geometry::kNoTriangle)
                        continue;
                    const double before = 9.0 - gum.distanceMm - *line;
                    if (height > margin + 0.5) looks.standsOut = std::max(looks.standsOut, before);
                    if (height < margin - 0.5 && height > margin - 3.0) looks.pit = std::max(looks.pit, -before);
                }
            }
        }
    }
    std::sort(looks.margins.begin(), looks.margins.end());
    std::sort(looks.tips.begin(), looks.tips.end());
    return looks;
}

void expectWhole(const Mouth& m, const Held& h) {
    const Looks looks = lookAt(m, h);
    fmt::print(
        "margin {:.2f} to {:.2f} mm over the junction, median {:.2f}; papillae {:.2f} to {:.2f} under the contact; "
        "{:.2f} before the teeth at most, {:.2f} behind under the margin; {} of {} rays pass\n",
        looks.margins.front(), looks.margins.back(), looks.margins[looks.margins.size() / 2], -looks.tips.back(),
        -looks.tips.front(), looks.standsOut, looks.pit, looks.holes, looks.rays);
    EXPECT_TRUE(looks.isClosed);
    EXPECT_TRUE(looks.isOneShell);
    EXPECT_FALSE(looks.crosses);
    EXPECT_EQ(looks.holes, 0) << "a way through under a papilla";
    EXPECT_LE(looks.standsOut, 0.05) << "a papilla stands out of the arch";
    EXPECT_LE(looks.pit, 1.2) << "a pit between two teeth";
    EXPECT_GE(looks.margins.front(), 0.5);
    EXPECT_LE(looks.margins.back(), 1.0);
    EXPECT_LE(looks.tips.back(), -0.7);
    EXPECT_GE(looks.tips.front(), -1.6);
}

// Small steps along the free margin catch the eye: of the upper front most of all.
TEST(Gingiva, MarginsRunSmoothlyRoundEachTooth) {
    for (const bool upper : {true, false}) {
        const Mouth& m = mouth(1);
        const Held& h = held(upper);
        for (const std::size_t i : h.order) {
            SCOPED_TRACE(fdiOf(i));
            const std::vector<Line> margins = marginsRound(m, h.tissues.gingiva, i);
            EXPECT_EQ(margins.size(), 1u);
            std::array<std::vector<double>, 2> steps;  // facial, lingual
            for (const Line& margin : margins)
                for (std::size_t k = 0; k < margin.size(); ++k) {
                    const double y = m.arches.toothInMouth[i].applyInverse(margin[k]).y() * m.teeth[i].buccalSign;
                    steps[y > 0.0 ? 0 : 1].push_back(stepAt(margin, k));
                }
            fmt::print("{}:", fdiOf(i));
            for (std::vector<double>& side : steps) {
                std::sort(side.begin(), side.end());
                fmt::print(" {:.3f} {:.3f} {:.3f};", side[side.size() / 2], side[side.size() * 95 / 100], side.back());
                // Of canines a notch is left, towards the lip, where the sheet of the embrasure meets the collar; third
                // molars stand as they can.
                if (i % 8 < 7) {
                    EXPECT_LT(side.back(), i % 8 == 2 ? 0.13 : 0.10);
                }
            }
            fmt::print(" {} lines\n", margins.size());
        }
    }
}

/// Seeds 1 to 3, of the last two one arch; all of as many as HANDPIECE_MOUTHS says.
TEST(Gingiva, FillsEachEmbrasureAndFollowsEachJunction) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed)
        for (const bool upper : {true, false}) {
            if (seed > 1 && upper != (seed == 3)) continue;
            SCOPED_TRACE(testing::Message() << "seed " << seed << (upper ? ", upper" : ", lower"));
            expectWhole(mouth(seed), held(upper, seed));
        }
    const char* asked = std::getenv("HANDPIECE_MOUTHS");
    for (std::uint64_t seed = 2; asked && seed <= std::strtoull(asked, nullptr, 10); ++seed) {
        const Mouth m = madeMouth(seed);
        for (const bool upper : {true, false}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << (upper ? ", upper" : ", lower"));
            expectWhole(m, madeHeld(m, upper));
        }
    }
}

}  // namespace
}  // namespace handpiece::dentition::gingiva_test
