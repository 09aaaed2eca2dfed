// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/starter/shape.h"

#include <algorithm>
#include <limits>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::starter {
namespace {
using core::Vec2;
using core::Vec3;

double smoothStep(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

double gauss(double d, double sigma) {
    return core::exp(-0.5 * (d / sigma) * (d / sigma));
}

/// How steep the occlusal height field may count: turns a height difference into about a distance.
constexpr double kHeightToDistance = 0.75;
/// Enamel stands this far proud of the root at the neck: the edge one feels with a probe.
constexpr double kNeckStepMm = 0.1, kNeckStepHeightMm = 0.3;
/// Thickness that the enamel ends with at the neck, so that its edge is no razor.
constexpr double kNeckEnamelMm = 0.06;
constexpr double kMinDentineOverPulpMm = 0.7;

/// Distance to a chain of balls whose radius runs evenly from one to the next.
double chainValue(const Canal& canal, const Vec3& p) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < canal.points.size(); ++i) {
        const Vec3 d = canal.points[i + 1] - canal.points[i];
        const double t = std::clamp((p - canal.points[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
        const double radius = canal.radii[i] + t * (canal.radii[i + 1] - canal.radii[i]);
        best = std::min(best, (p - canal.points[i] - t * d).norm() - radius);
    }
    return best;
}

}  // namespace

double smoothMax(double a, double b, double width) {
    const double h = std::max(width - std::abs(a - b), 0.0) / width;
    return std::max(a, b) + 0.25 * width * h * h;
}

LoftedColumn::LoftedColumn(const Column& column)
    : bottomZ_(column.bottomZ),
      bottomLength_(column.bottomLength),
      topZ_(column.topZ),
      topLength_(column.topLength),
      wedge_(column.wedge),
      lean_(column.lean) {
    for (const Section& s : column.sections)
        knots_.push_back({s.z, {s.cx, s.cy, s.halfX, s.halfY, s.square}, {}});
    // Slopes after Fritsch and Carlson: the loft never swings beyond its sections.
    const std::size_t n = knots_.size();
    for (int c = 0; c < 5; ++c)
        for (std::size_t i = 1; i + 1 < n; ++i) {
            const double h0 = knots_[i].z - knots_[i - 1].z, h1 = knots_[i + 1].z - knots_[i].z;
            const double d0 = (knots_[i].value[c] - knots_[i - 1].value[c]) / h0,
                         d1 = (knots_[i + 1].value[c] - knots_[i].value[c]) / h1;
            if (d0 * d1 > 0.0) knots_[i].slope[c] = 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / d0 + (h1 + 2.0 * h0) / d1);
        }
}

double LoftedColumn::value(const Vec3& p) const {
    // The sections go on tapering beyond the ends while the end closes them: no kink where it begins.
    const double z = std::clamp(p.z(), knots_.front().z, knots_.back().z);
    std::size_t i = 0;
    while (i + 2 < knots_.size() && z > knots_[i + 1].z)
        ++i;
    const Knot &a = knots_[i], &b = knots_[i + 1];
    const double h = b.z - a.z, t = (z - a.z) / h;
    const double t2 = t * t, t3 = t2 * t;
    const double h01 = 3.0 * t2 - 2.0 * t3, h10 = t3 - 2.0 * t2 + t, h11 = t3 - t2;
    double v[5];
    for (int c = 0; c < 5; ++c)
        v[c] = a.value[c] + h01 * (b.value[c] - a.value[c]) + h * (h10 * a.slope[c] + h11 * b.slope[c]);

    double x = (p.x() - v[0]) / v[2], y = (p.y() - v[1]) / v[3];
    const double wide = 1.0 + wedge_ * std::clamp(x, -1.5, 1.5), longer = 1.0 + lean_ * std::clamp(y, -1.5, 1.5);
    x /= longer;
    y /= wide;
    double w = 0.0;
    if (p.z() < bottomZ_) w = (bottomZ_ - p.z()) / bottomLength_;
    if (topLength_ > 0.0 && p.z() > topZ_) w = (p.z() - topZ_) / topLength_;
    const double xx = x * x, yy = y * y;
    const double g = std::sqrt(xx + yy - v[4] * xx * yy / (xx + yy + 1e-12) + w * w);
    const double across = std::min(v[2], v[3]), along = p.z() < bottomZ_ ? bottomLength_ : topLength_;
    return (g - 1.0) * (across + smoothStep(0.0, 0.8, w) * (std::min(across, along) - across));
}

ToothShape::ToothShape(const Anatomy& anatomy)
    : anatomy_(anatomy), crown_(anatomy.crown), chamber_(anatomy.pulpChamber) {
    for (const Column& root : anatomy.roots)
        roots_.emplace_back(root);
}

core::Box ToothShape::bounds() const {
    return {Vec3(-anatomy_.reach, -anatomy_.reach, anatomy_.apexZ),
            Vec3(anatomy_.reach, anatomy_.reach, anatomy_.crownTopZ)};
}

double ToothShape::occlusalHeight(double x, double y) const {
    // A soft maximum over the roofs of all ridges: where two of them meet in a valley there is a groove, as in nature
    // where two lobes of the crown have grown together.
    double heights[64];
    double highest = -1e9;
    const std::size_t count = std::min<std::size_t>(anatomy_.ridges.size(), 64);
    for (std::size_t i = 0; i < count; ++i) {
        const Ridge& ridge = anatomy_.ridges[i];
        const double dx = ridge.to.x() - ridge.from.x(), dy = ridge.to.y() - ridge.from.y();
        const double t =
            std::clamp(((x - ridge.from.x()) * dx + (y - ridge.from.y()) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
        const double ex = x - ridge.from.x() - t * dx, ey = y - ridge.from.y() - t * dy;
        constexpr double kRound = 0.45;
        heights[i] = ridge.from.z() + t * (ridge.to.z() - ridge.from.z()) -
                     ridge.slope * (std::sqrt(ex * ex + ey * ey + kRound * kRound) - kRound);
        highest = std::max(highest, heights[i]);
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const double below = anatomy_.ridgeSoftness * (heights[i] - highest);
        if (below > -16.0) sum += core::exp(below);
    }
    return highest + core::log(sum) / anatomy_.ridgeSoftness;
}

double ToothShape::body(const Vec3& p) const {
    double value = crown_.value(p);
    for (const Flute& flute : anatomy_.flutes) {
        const double dx = p.x() - flute.x;
        if (std::abs(dx) > 4.0 * flute.sigma || p.z() < flute.fromZ) continue;
        value += flute.depth * gauss(dx, flute.sigma) * smoothStep(flute.fromZ, flute.toZ, p.z()) *
                 smoothStep(0.3, 2.5, flute.side * p.y());
    }
    if (!anatomy_.ridges.empty() && p.z() > 1.0) {
        // Nothing of the top is felt that far below it.
        const double top = kHeightToDistance * (p.z() - occlusalHeight(p.x(), p.y()));
        value = smoothMax(value, top, anatomy_.edgeRadius);
    }
    for (const LoftedColumn& root : roots_) {
        if (p.z() > 3.0) break;
        value = smoothMin(value, root.value(p), anatomy_.rootBlend);
    }
    return value;
}

double ToothShape::fissureDepth(const Vec3& p) const {
    if (p.z() < anatomy_.fissureFromZ) return 0.0;
    double deepest = 0.0;
    for (const FissureStretch& s : anatomy_.fissures) {
        const double dx = s.to.x() - s.from.x(), dy = s.to.y() - s.from.y();
        const double t =
            std::clamp(((p.x() - s.from.x()) * dx + (p.y() - s.from.y()) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
        const double ex = p.x() - s.from.x() - t * dx, ey = p.y() - s.from.y() - t * dy;
        const double squared = ex * ex + ey * ey;
        if (squared > 20.0 * anatomy_.fissureSigma * anatomy_.fissureSigma) continue;
        const double depth = s.fromDepth + t * (s.toDepth - s.fromDepth);
        if (depth <= deepest) continue;
        deepest =
            std::max(deepest, depth * core::exp(-0.5 * squared / (anatomy_.fissureSigma * anatomy_.fissureSigma)));
    }
    return deepest * smoothStep(anatomy_.fissureFromZ, anatomy_.fissureToZ, p.z());
}

double ToothShape::aboveNeck(const Vec3& p) const {
    const double u = p.x() / anatomy_.neckHalfX, v = p.y() / anatomy_.neckHalfY;
    const double uu = u * u, vv = v * v;
    const double alongX = smoothStep(-0.5, 0.5, u), alongY = smoothStep(-0.5, 0.5, v);
    const double neckX = anatomy_.neckDistal + alongX * (anatomy_.neckMesial - anatomy_.neckDistal);
    const double neckY = anatomy_.neckMinusY + alongY * (anatomy_.neckPlusY - anatomy_.neckMinusY);
    return p.z() - (uu * neckX + vv * neckY) / (uu + vv + 1e-3);
}

double ToothShape::outer(const Vec3& p) const {
    double value = body(p);
    const double above = aboveNeck(p);
    value -= kNeckStepMm * smoothStep(-0.5 * kNeckStepHeightMm, 0.5 * kNeckStepHeightMm, above);
    return value + fissureDepth(p);
}

double ToothShape::core(const Vec3& p, double bodyValue) const {
    const double above = aboveNeck(p);
    if (above < -0.5) return bodyValue;
    const double side = anatomy_.enamelSide * smoothStep(-0.6, 4.5, above);
    const double top =
        (anatomy_.enamelTop - anatomy_.enamelSide) * smoothStep(anatomy_.enamelTopFromZ, anatomy_.enamelTopToZ, p.z());
    return bodyValue + kNeckEnamelMm * smoothStep(-0.5, 0.5, above) + side + top;
}

double ToothShape::dentine(const Vec3& p) const {
    return core(p, body(p));
}

double ToothShape::enamel(const Vec3& p) const {
    const double above = aboveNeck(p);
    const double bodyValue = body(p);
    const double outside = bodyValue -
                           kNeckStepMm * smoothStep(-0.5 * kNeckStepHeightMm, 0.5 * kNeckStepHeightMm, above) +
                           fissureDepth(p);
    // Half of the neck's step lies below the line: there the cap ends, blunt.
    const double cap = smoothMax(-core(p, bodyValue), -above - 0.1, 0.08);
    return smoothMax(outside, cap, 0.08);
}

double ToothShape::pulp(const Vec3& p) const {
    double value = chamber_.value(p);
    for (const Canal& canal : anatomy_.canals)
        value = smoothMin(value, chainValue(canal, p), 0.5);
    return smoothMax(value, core(p, body(p)) + kMinDentineOverPulpMm, 0.2);
}

double ToothShape::caries(const Vec3& p) const {
    const CariesLesion& lesion = anatomy_.caries;
    const double neck = chainValue({{lesion.pit, lesion.spread}, {lesion.neckRadius, 0.7 * lesion.neckRadius}}, p);
    const Vec3 d = (p - lesion.spread).cwiseQuotient(lesion.spreadHalf);
    const double spread = (d.norm() - 1.0) * lesion.spreadHalf.minCoeff();
    const double value = smoothMin(neck, spread, 0.5);
    // A little proud of the surface, so that what is felt at the pit's mouth is the lesion.
    return smoothMax(value, outer(p) - 0.03, 0.05);
}

}  // namespace handpiece::starter
