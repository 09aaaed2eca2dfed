// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/surfaces.h"

#include <algorithm>
#include <limits>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::dentition {
namespace {
using core::Vec2;
using core::Vec3;

/// Turns a height over the occlusal surface into about a distance: its flanks slope by some 40 degrees.
constexpr double kHeightToDistance = 0.75;
/// Enamel stands this far proud of the root at the cervix: the edge one feels with a probe.
constexpr double kStepMm = 0.08, kStepHeightMm = 0.3;
/// Thickness that the enamel ends with, so that its edge is no razor.
constexpr double kCervicalEnamelMm = 0.06;
constexpr double kMinDentineOverPulpMm = 0.8;
/// Flanks of two crests meet in a valley as sharp as this [mm].
constexpr double kValleyMm = 0.10;
constexpr int kCurvePieces = 6;

double gauss(double t) {
    return core::exp(-0.5 * t * t);
}

/// Distance to a chain of balls whose radius runs evenly from the first to the last point.
double chainValue(const std::vector<Vec3>& points, double from, double to, const Vec3& p) {
    double best = std::numeric_limits<double>::infinity();
    const auto pieces = static_cast<double>(points.size() - 1);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Vec3 d = points[i + 1] - points[i];
        const double t = std::clamp((p - points[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
        const double radius = from + (static_cast<double>(i) + t) / pieces * (to - from);
        best = std::min(best, (p - points[i] - t * d).norm() - radius);
    }
    return best;
}

/// The crown's sides from its four outlines.
Loft crownOf(const Spec& s) {
    const Sizes& z = s.sizes;
    const double halfX = 0.5 * z.mesiodistalCervix, halfY = 0.5 * z.buccolingualCervix;
    std::vector<double> heights = {
        -3.0, 0.0, s.mesial.contourZ, s.distal.contourZ, s.buccal.contourZ, s.lingual.contourZ};
    for (const Outline* o : {&s.mesial, &s.distal, &s.buccal, &s.lingual}) {
        heights.push_back(o->rimZ);
        heights.push_back(o->topZ);
    }
    std::sort(heights.begin(), heights.end());
    // One outline through its own heights, smooth: a small loft of its own, asked at the heights of all.
    const auto outline = [](const Outline& o, double cervix, double contour) {
        const double low = cervix * 0.93;
        return Loft({{-3.0, low, 0, 1, 1, 0},
                     {0.0, cervix, 0, 1, 1, 0},
                     {o.contourZ, contour, 0, 1, 1, 0},
                     {o.rimZ, o.rim, 0, 1, 1, 0},
                     {o.topZ, o.top, 0, 1, 1, 0}},
                    {-9.0, 1.0});
    };
    const Loft mesial = outline(s.mesial, halfX + s.centreX, 0.5 * z.mesiodistal + s.mesial.shift),
               distal = outline(s.distal, halfX - s.centreX, 0.5 * z.mesiodistal - s.mesial.shift),
               buccal = outline(s.buccal, halfY, 0.5 * z.buccolingual + s.buccal.shift),
               lingual = outline(s.lingual, halfY, 0.5 * z.buccolingual - s.buccal.shift);
    std::vector<Section> sections;
    for (const double h : heights) {
        if (!sections.empty() && h - sections.back().z < 0.15) continue;
        const double m = mesial.at(h).cx, d = distal.at(h).cx, b = buccal.at(h).cx, l = lingual.at(h).cx;
        const double contourZ = 0.5 * (s.mesial.contourZ + s.distal.contourZ);
        const double square =
            h < contourZ ? s.cervixSquare + (s.contourSquare - s.cervixSquare) * smoothStep(0.0, contourZ, h)
                         : s.contourSquare + (s.rimSquare - s.contourSquare) * smoothStep(contourZ, s.mesial.rimZ, h);
        sections.push_back({h, 0.5 * (m - d), 0.5 * (l - b), 0.5 * (m + d), 0.5 * (l + b), square});
    }
    // Below the cervix it is the trunk of the roots.
    const double trunk = s.trunk > 0.0 ? s.trunk : 2.4;
    return Loft(sections, {-0.35 * trunk, 0.65 * trunk}, s.lean, s.wedge, s.skew);
}

Loft rootOf(const Root& r) {
    const auto section = [&](double t, double wide) -> Section {
        const Vec3 top(r.cervix.x(), r.cervix.y(), 0.0);
        // Through its middle: a quadratic in the height.
        const double tm = r.middle.z() / r.apex.z();
        const Vec2 chord = r.cervix + tm * (r.apex.head<2>() - r.cervix);
        const Vec2 bow = (r.middle.head<2>() - chord) / (tm * (1.0 - tm));
        const Vec2 c = r.cervix + t * (r.apex.head<2>() - r.cervix) + t * (1.0 - t) * bow;
        return {t * r.apex.z(),
                c.x(),
                c.y(),
                r.half.x() * wide,
                r.half.y() * wide,
                r.square,
                r.waist * smoothStep(0.0, 0.3, t)};
    };
    const double a = r.taper.x(), b = r.taper.y();
    std::vector<Section> sections = {section(0.98, 0.75 * b),
                                     section(0.9, b),
                                     section(0.72, 0.55 * a + 0.45 * b),
                                     section(0.5, a),
                                     section(0.25, 0.45 + 0.55 * a),
                                     section(0.0, 1.0),
                                     section(-0.04, 1.0)};
    const double narrow = b * std::min(r.half.x(), r.half.y());
    return Loft(sections, {r.apex.z() + 1.6 * narrow, 1.6 * narrow, -0.2, 1.4});
}

}  // namespace

double smoothStep(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

Loft::Loft(std::vector<Section> sections, Ends ends, double lean, double wedge, double skew)
    : ends_(ends), lean_(lean), wedge_(wedge), skew_(skew) {
    for (const Section& s : sections)
        knots_.push_back({s.z, {s.cx, s.cy, s.halfX, s.halfY, s.square, s.waist}, {}});
    // Slopes after Fritsch and Carlson: the loft never swings beyond its sections.
    for (int c = 0; c < kValues; ++c)
        for (std::size_t i = 1; i + 1 < knots_.size(); ++i) {
            const double h0 = knots_[i].z - knots_[i - 1].z, h1 = knots_[i + 1].z - knots_[i].z;
            const double d0 = (knots_[i].value[c] - knots_[i - 1].value[c]) / h0,
                         d1 = (knots_[i + 1].value[c] - knots_[i].value[c]) / h1;
            if (d0 * d1 > 0.0) knots_[i].slope[c] = 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / d0 + (h1 + 2.0 * h0) / d1);
        }
}

void Loft::interpolate(double height, double (&v)[kValues]) const {
    const double z = std::clamp(height, knots_.front().z, knots_.back().z);
    std::size_t i = 0;
    while (i + 2 < knots_.size() && z > knots_[i + 1].z)
        ++i;
    const Knot &a = knots_[i], &b = knots_[i + 1];
    const double h = b.z - a.z, t = (z - a.z) / h;
    const double t2 = t * t, t3 = t2 * t;
    const double h01 = 3.0 * t2 - 2.0 * t3, h10 = t3 - 2.0 * t2 + t, h11 = t3 - t2;
    for (int c = 0; c < kValues; ++c)
        v[c] = a.value[c] + h01 * (b.value[c] - a.value[c]) + h * (h10 * a.slope[c] + h11 * b.slope[c]);
}

Section Loft::at(double z) const {
    double v[kValues];
    interpolate(z, v);
    return {z, v[0], v[1], v[2], v[3], v[4], v[5]};
}

double Loft::value(const Vec3& p) const {
    double v[kValues];
    interpolate(p.z(), v);
    const double dy = p.y() - v[1], dx = p.x() - v[0] - skew_ * dy;
    double x = dx / v[2], y = dy / v[3];
    const double longer = 1.0 + lean_ * std::clamp(y, -1.5, 1.5), wide = 1.0 + wedge_ * std::clamp(x, -1.5, 1.5);
    double halfX = v[2] * longer, halfY = v[3] * wide;
    if (v[5] > 0.0) halfX *= 1.0 - v[5] * gauss(y / 0.42);
    x = dx / halfX, y = dy / halfY;
    double w = 0.0, length = 1.0;
    if (p.z() < ends_.bottomZ) w = (ends_.bottomZ - p.z()) / ends_.bottomLength, length = ends_.bottomLength;
    if (ends_.topLength > 0.0 && p.z() > ends_.topZ)
        w = (p.z() - ends_.topZ) / ends_.topLength, length = ends_.topLength;
    // Homogeneous of degree one, so that g - 1 over its gradient is about a distance on all sides of long sections too.
    const double xx = x * x, yy = y * y, sum = xx + yy + 1e-12;
    const double g = std::sqrt(std::max(sum - v[4] * xx * yy / sum + w * w, 1e-12));
    const double gx = x * (1.0 - v[4] * yy * yy / (sum * sum)) / halfX,
                 gy = y * (1.0 - v[4] * xx * xx / (sum * sum)) / halfY, gz = w / length;
    const double steep = std::sqrt(gx * gx + gy * gy + gz * gz) / g;
    return std::max((g - 1.0) / std::max(steep, 1e-3), -1.2 * std::min(halfX, halfY));
}

Anatomy::Anatomy(Spec spec) : spec_(std::move(spec)), crown_(crownOf(spec_)) {
    const Sizes& z = spec_.sizes;
    const double buccal = -0.25 * (z.curveMesial + z.curveDistal);
    cervix_[0] = buccal + z.curveMesial, cervix_[1] = buccal + z.curveDistal, cervix_[2] = cervix_[3] = buccal;
    apexZ_ = 0.0;
    reach_ = 0.5 * std::max(z.mesiodistal, z.buccolingual) +
             std::max(std::abs(spec_.mesial.shift), std::abs(spec_.buccal.shift)) + 0.5;
    for (const Root& r : spec_.roots) {
        roots_.push_back(rootOf(r));
        apexZ_ = std::min(apexZ_, r.apex.z());
        for (const Vec3& p : {r.middle, r.apex})
            reach_ = std::max(reach_, p.head<2>().cwiseAbs().maxCoeff() + r.half.maxCoeff());
    }
    topZ_ = z.crown + buccal + 0.6;
    for (const Crest& c : spec_.crests) {
        Curve curve{{}, c.round, c.slope, 0.0, -1e9, Vec2::Zero()};
        for (int i = 0; i <= kCurvePieces; ++i) {
            const double t = static_cast<double>(i) / kCurvePieces, u = 1.0 - t;
            curve.points.push_back(u * u * c.from + 2.0 * u * t * c.by + t * t * c.to);
            curve.topZ = std::max(curve.topZ, curve.points.back().z());
        }
        curve.middle = 0.5 * (c.from + c.to).head<2>();
        for (const Vec3& p : curve.points)
            curve.reach = std::max(curve.reach, (p.head<2>() - curve.middle).norm());
        topZ_ = std::max(topZ_, curve.topZ + 0.3);
        curves_.push_back(curve);
    }
    for (const Groove& g : spec_.grooves) {
        core::Box box;
        for (const Vec3& p : g.points)
            box.extend(p);
        const Vec2 middle = box.centre().head<2>();
        double reach = 0.0;
        for (const Vec3& p : g.points)
            reach = std::max(reach, (p.head<2>() - middle).norm());
        lines_.push_back({&g, middle, reach + g.halfWidth});
    }
    if (!spec_.chamber.empty())
        chamber_.emplace_back(spec_.chamber, Loft::Ends{spec_.floorZ + 0.5, 0.5, spec_.roofZ - 0.6, 0.6});
    measure();
}

core::Box Anatomy::bounds() const {
    return {Vec3(-reach_, -reach_, apexZ_ - 0.5), Vec3(reach_, reach_, topZ_)};
}

double Anatomy::occlusalHeight(double x, double y) const {
    double height = spec_.groundZ;
    for (const Curve& c : curves_) {
        const double away = std::max(
            std::sqrt((x - c.middle.x()) * (x - c.middle.x()) + (y - c.middle.y()) * (y - c.middle.y())) - c.reach,
            0.0);
        if (c.topZ - c.slope * (std::sqrt(away * away + c.round * c.round) - c.round) < height - kValleyMm) continue;
        double best = -1e9;
        for (std::size_t i = 0; i + 1 < c.points.size(); ++i) {
            const Vec3 &a = c.points[i], &b = c.points[i + 1];
            const double dx = b.x() - a.x(), dy = b.y() - a.y();
            const double t = std::clamp(((x - a.x()) * dx + (y - a.y()) * dy) / (dx * dx + dy * dy + 1e-12), 0.0, 1.0);
            const double ex = x - a.x() - t * dx, ey = y - a.y() - t * dy;
            best = std::max(best, a.z() + t * (b.z() - a.z()) -
                                      c.slope * (std::sqrt(ex * ex + ey * ey + c.round * c.round) - c.round));
        }
        height = smoothMax(height, best, kValleyMm);
    }
    return height;
}

double Anatomy::grooveDepth(const Vec3& p) const {
    double deepest = 0.0;
    for (const Line& line : lines_) {
        const Groove& g = *line.groove;
        if (p.z() <= g.fromZ) continue;
        const double mx = p.x() - line.middle.x(), my = p.y() - line.middle.y();
        if (mx * mx + my * my > line.reach * line.reach) continue;
        double here = 0.0;
        for (std::size_t i = 0; i + 1 < g.points.size(); ++i) {
            const Vec3 &a = g.points[i], &b = g.points[i + 1];
            const double dx = b.x() - a.x(), dy = b.y() - a.y();
            const double t = std::clamp(((p.x() - a.x()) * dx + (p.y() - a.y()) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
            const double ex = p.x() - a.x() - t * dx, ey = p.y() - a.y() - t * dy;
            constexpr double kFloor = 0.04;
            const double d = (std::sqrt(ex * ex + ey * ey + kFloor * kFloor) - kFloor) / g.halfWidth;
            if (d < 1.0) here = std::max(here, (a.z() + t * (b.z() - a.z())) * (1.0 - d) * (1.0 - d));
        }
        if (here > deepest) deepest = std::max(deepest, here * smoothStep(g.fromZ, g.toZ, p.z()));
    }
    return deepest;
}

double Anatomy::body(const Vec3& p) const {
    double value = crown_.value(p);
    if (!curves_.empty() && p.z() > 0.25 * topZ_) {
        const double top = kHeightToDistance * (p.z() - occlusalHeight(p.x(), p.y()));
        value = smoothMax(value, top, spec_.rimRound);
    }
    if (p.z() < 2.0)
        for (const Loft& root : roots_)
            value = smoothMin(value, root.value(p), spec_.rootBlend);
    for (const Hollow& h : spec_.hollows) {
        const double q = (p - h.centre).cwiseQuotient(h.radii).squaredNorm();
        if (q < 1.0) value += h.depth * (1.0 - q) * (1.0 - q);
    }
    return value;
}

double Anatomy::aboveCervix(const Vec3& p) const {
    const double u = 2.0 * (p.x() - spec_.centreX) / spec_.sizes.mesiodistalCervix,
                 v = 2.0 * p.y() / spec_.sizes.buccolingualCervix;
    const double uu = u * u, vv = v * v;
    const double alongX = smoothStep(-0.5, 0.5, u), alongY = smoothStep(-0.5, 0.5, v);
    const double x = cervix_[1] + alongX * (cervix_[0] - cervix_[1]),
                 y = cervix_[2] + alongY * (cervix_[3] - cervix_[2]);
    return p.z() - (uu * x + vv * y) / (uu + vv + 1e-3);
}

double Anatomy::step(double above) const {
    return kStepMm * smoothStep(-0.5 * kStepHeightMm, 0.5 * kStepHeightMm, above);
}

double Anatomy::outer(const Vec3& p) const {
    return body(p) - step(aboveCervix(p)) + grooveDepth(p);
}

double Anatomy::core(const Vec3& p, double bodyValue) const {
    const double above = aboveCervix(p);
    if (above < -0.5) return bodyValue;
    const double side = spec_.enamelSide * smoothStep(-0.6, 0.55 * spec_.sizes.crown, above);
    const double fossaZ = spec_.groundZ > 0.0 ? spec_.groundZ : 0.6 * topZ_;
    double top = (spec_.enamelCusp - spec_.enamelSide) *
                 smoothStep(fossaZ - spec_.enamelFossa, topZ_ - 0.6 - spec_.enamelCusp, p.z());
    return bodyValue + kCervicalEnamelMm * smoothStep(-0.5, 0.5, above) + side + top;
}

double Anatomy::dentine(const Vec3& p) const {
    return core(p, body(p));
}

double Anatomy::enamel(const Vec3& p) const {
    const double above = aboveCervix(p), bodyValue = body(p);
    // Half of the step lies below the line: there the cap ends, blunt.
    const double cap = smoothMax(-core(p, bodyValue), -above - 0.1, 0.08);
    return smoothMax(bodyValue - step(above) + grooveDepth(p), cap, 0.08);
}

double Anatomy::pulp(const Vec3& p) const {
    double value = std::numeric_limits<double>::infinity();
    for (const Loft& c : chamber_)
        value = c.value(p);
    for (const Canal& c : spec_.canals)
        value = smoothMin(value, chainValue(c.points, c.orificeRadius, c.apexRadius, p), 0.3);
    for (const Horn& h : spec_.horns)
        value = smoothMin(value, chainValue({h.base, h.tip}, h.baseRadius, h.tipRadius, p), 0.3);
    return smoothMax(value, core(p, body(p)) + kMinDentineOverPulpMm, 0.2);
}

double Anatomy::cementum(const Vec3& p) const {
    const double above = aboveCervix(p), value = body(p);
    const double thick = 0.05 + 0.15 * smoothStep(0.0, apexZ_, p.z());
    return smoothMax(smoothMax(value, -value - thick, 0.02), above + 0.1, 0.02);
}

bool Anatomy::surfaceAlong(const Vec3& from, const Vec3& direction, Vec3& found) const {
    double t = 0.0;
    for (int i = 0; i < 400; ++i) {
        const Vec3 p = from + t * direction;
        const double value = outer(p);
        if (value < 1e-7) {
            found = p;
            return true;
        }
        t += std::max(value / 2.0, 1e-7);
        if (t > 4.0 * reach_ + 30.0) return false;
    }
    return false;
}

Vec3 Anatomy::onSurface(Vec3 p) const {
    for (int i = 0; i < 30; ++i) {
        const double value = outer(p);
        if (std::abs(value) < 1e-9) break;
        constexpr double kH = 1e-5;
        Vec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 e = Vec3::Zero();
            e[axis] = kH;
            gradient[axis] = (outer(p + e) - outer(p - e)) / (2.0 * kH);
        }
        p -= std::clamp(value / std::max(gradient.squaredNorm(), 0.05), -0.3, 0.3) * gradient;
    }
    return p;
}

Vec3 Anatomy::outermost(const Vec3& direction, const Vec3& start) const {
    const Vec3 away = 2.0 * reach_ * direction + (std::abs(direction.z()) > 0.5 ? 25.0 * direction : Vec3(0, 0, 0));
    const Vec3 one = std::abs(direction.z()) > 0.5 ? Vec3::UnitX() : Vec3::UnitZ(), two = direction.cross(one);
    const auto seen = [&](const Vec3& at, Vec3& found) {
        const Vec3 flat = at - at.dot(direction) * direction;
        return surfaceAlong(flat + away, -direction, found);
    };
    Vec3 best;
    if (!seen(start, best)) return start;
    for (double step = 1.0; step > 2e-3;) {
        bool moved = false;
        for (const Vec3& way : {one, Vec3(-one), two, Vec3(-two)}) {
            Vec3 next;
            if (seen(best + step * way, next) && next.dot(direction) > best.dot(direction) + 1e-9)
                best = next, moved = true;
        }
        if (!moved) step *= 0.5;
    }
    return best;
}

void Anatomy::measure() {
    const Spec& s = spec_;
    mesialContact = outermost(Vec3::UnitX(), Vec3(0, 0, s.mesial.contourZ));
    distalContact = outermost(-Vec3::UnitX(), Vec3(0, 0, s.distal.contourZ));
    buccalContour = outermost(-Vec3::UnitY(), Vec3(0, 0, s.buccal.contourZ));
    lingualContour = outermost(Vec3::UnitY(), Vec3(0, 0, s.lingual.contourZ));
    highest = Vec3(0, 0, -1e9);
    for (const Cusp& c : s.cusps) {
        const Vec3 top = outermost(Vec3::UnitZ(), c.tip);
        if (top.z() > highest.z()) highest = top;
    }
    lowest = Vec3(0, 0, 1e9);
    for (const Root& r : s.roots) {
        const Vec3 tip = outermost(-Vec3::UnitZ(), r.apex);
        if (tip.z() < lowest.z()) lowest = tip;
    }
}

}  // namespace handpiece::dentition
