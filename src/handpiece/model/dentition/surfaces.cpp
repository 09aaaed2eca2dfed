// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/surfaces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "handpiece/base/core/portable_math.h"
#include "handpiece/base/core/split_mix.h"

namespace handpiece::dentition {
namespace {
using core::Vec2;
using core::Vec3;

/// Turns a height over the occlusal surface into about a distance: its flanks slope by some 40 degrees.
constexpr double kHeightToDistance = 0.75;
/// Enamel stands this far proud of the root at the cervix: the edge one feels with a probe.
constexpr double kStepMm = 0.06, kStepHeightMm = 0.6;
/// Thickness that the enamel ends with, so that its edge is no razor.
constexpr double kCervicalEnamelMm = 0.10;
/// Dentine left everywhere over the pulp, in the crown and at the apex.
constexpr double kCrownDentineMm = 1.0, kApicalDentineMm = 0.25;
/// How round the chamber's edges are, how softly horns rise from its roof and how deep the canals' funnels reach.
constexpr double kChamberRoundMm = 0.5, kHornBlendMm = 0.5, kFunnelMm = 2.0;
/// Flanks of two crests meet in a valley as sharp as this [mm]; the ridges of the rim pass into each other softly.
constexpr double kValleyMm = 0.10, kRimMm = 0.45;
/// Incisal edges slope towards lingual.
constexpr double kEdgeBevel = 0.2;
/// A groove's shoulders reach this much farther than where one sees it end.
constexpr double kShoulders = 1.12;
/// Between the places along a curve that its nearest point is looked for from.
constexpr double kPieces = 6.0;
/// Between the nodes of a field of unevenness; every second one has the longer waves.
constexpr double kNodesMm = 1.0;
/// Beyond this from the surface what is carved into it counts no more.
constexpr double kGroovesToMm = 1.6;
/// The finer unevenness: its share of the other, and its waves [mm], as on two real molars (docs/anatomy.md). They run
/// around the crown.
constexpr double kFineShare = 0.14, kFineAcrossMm = 0.34, kFineUpMm = 0.22;
/// How far from a cusp's tip a facet may reach, and how softly it ends.
constexpr double kFacetReachMm = 0.7, kFacetSlope = 0.6, kFacetEdgeMm = 0.06;

double gauss(double t) {
    return core::exp(-0.5 * t * t);
}

/// Distance to a chain of balls; how large they are hangs on the share of the way and the place.
template <class Radius>
double chainValue(std::span<const Vec3> points, const Radius& radius, const Vec3& p) {
    double best = std::numeric_limits<double>::infinity();
    const auto pieces = static_cast<double>(points.size() - 1);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Vec3 d = points[i + 1] - points[i];
        const double t = std::clamp((p - points[i]).dot(d) / d.squaredNorm(), 0.0, 1.0);
        const Vec3 at = points[i] + t * d;
        best = std::min(best, (p - at).norm() - radius((static_cast<double>(i) + t) / pieces, at));
    }
    return best;
}

/// Cross-sections of a root from its end up to the cervix.
std::vector<Section> sectionsOf(const Root& r) {
    const double a = r.taper.x(), b = r.taper.y();
    std::vector<Section> sections;
    for (const auto& [t, wide] :
         {std::pair{1.0, b}, {0.75, 0.62 * a + 0.38 * b}, {0.5, a}, {0.25, 0.4 + 0.6 * a}, {0.0, 1.0}}) {
        const Vec2 c = rootCentre(r, t);
        sections.push_back({t * r.apex.z(), c.x(), c.y(), r.half.x() * wide, r.half.y() * wide, r.square,
                            r.waist * smoothStep(0.0, 0.3, t)});
    }
    return sections;
}

Loft::Ends apexOf(const Root& r) {
    const double narrow = r.taper.y() * std::min(r.half.x(), r.half.y());
    return {r.apex.z() + 2.2 * narrow, 2.2 * narrow};
}

/// The crown's sides from its four outlines, with the root below where there is one, else with the trunk of the roots.
Loft crownOf(const Spec& s) {
    const Sizes& z = s.sizes;
    const double halfX = 0.5 * z.mesiodistalCervix, halfY = 0.5 * z.buccolingualCervix;
    std::vector<Section> below;
    Loft::Ends ends{-0.45 * s.trunk, 0.57 * s.trunk};
    if (s.roots.size() == 1)
        below = sectionsOf(s.roots.front()), below.pop_back(), ends = apexOf(s.roots.front());
    else
        below = {{-s.trunk, s.centreX, 0.0, 0.88 * halfX, 0.9 * halfY, s.cervixSquare}};
    const double buccalZ = -0.25 * (z.curveMesial + z.curveDistal);
    const auto outline = [&](const Outline& o, double cervixZ, double cervix, double contour, auto&& root) {
        std::vector<Profile::Knot> knots;
        for (const Section& b : below)
            knots.push_back({b.z, root(b)});
        knots.push_back({cervixZ, cervix});
        if (o.contourZ > cervixZ + 2.0)
            knots.push_back({0.5 * (cervixZ + o.contourZ), cervix + o.belly * (contour - cervix)});
        knots.insert(knots.end(), {{o.contourZ, contour}, {o.rimZ, o.rim}, {o.topZ, o.top}});
        return Profile(knots);
    };
    std::vector<Profile::Knot> square, waist;
    for (const Section& b : below)
        square.push_back({b.z, b.square}), waist.push_back({b.z, b.waist});
    square.insert(square.end(), {{0.0, s.cervixSquare},
                                 {0.5 * (s.mesial.contourZ + s.distal.contourZ), s.contourSquare},
                                 {s.mesial.rimZ, s.rimSquare}});
    waist.push_back({0.5, 0.0}), waist.push_back({1.0, 0.0});
    return Loft({outline(s.mesial, buccalZ + z.curveMesial, halfX + s.centreX, 0.5 * z.mesiodistal + s.mesial.shift,
                         [](const Section& b) { return b.cx + b.halfX; }),
                 outline(s.distal, buccalZ + z.curveDistal, halfX - s.centreX, 0.5 * z.mesiodistal - s.mesial.shift,
                         [](const Section& b) { return b.halfX - b.cx; }),
                 outline(s.buccal, buccalZ, halfY, 0.5 * z.buccolingual + s.buccal.shift,
                         [](const Section& b) { return b.halfY - b.cy; }),
                 outline(s.lingual, buccalZ, halfY, 0.5 * z.buccolingual - s.buccal.shift,
                         [](const Section& b) { return b.halfY + b.cy; }),
                 Profile(square), Profile(waist)},
                ends, s.lean, s.wedge, s.skew);
}

Loft rootOf(const Root& r) {
    Loft::Ends ends = apexOf(r);
    // It begins within the trunk.
    ends.topZ = -0.5, ends.topLength = 1.5;
    return Loft(sectionsOf(r), ends);
}

Profile profileOf(const std::vector<Section>& sections, double (*of)(const Section&)) {
    std::vector<Profile::Knot> knots;
    for (const Section& s : sections)
        knots.push_back({s.z, of(s)});
    return Profile(knots);
}

}  // namespace

double smoothStep(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

std::vector<Vec3> rounded(std::vector<Vec3> points) {
    std::vector<Vec3> next = {points.front()};
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        if (i > 0) next.push_back(0.75 * points[i] + 0.25 * points[i + 1]);
        if (i + 2 < points.size()) next.push_back(0.25 * points[i] + 0.75 * points[i + 1]);
    }
    next.push_back(points.back());
    return next;
}

Profile::Profile(std::vector<Knot> knots) : knots_(std::move(knots)) {
    for (std::size_t i = 1; i + 1 < knots_.size(); ++i) {
        const double h0 = knots_[i].z - knots_[i - 1].z, h1 = knots_[i + 1].z - knots_[i].z;
        const double d0 = (knots_[i].value - knots_[i - 1].value) / h0,
                     d1 = (knots_[i + 1].value - knots_[i].value) / h1;
        if (d0 * d1 > 0.0) knots_[i].slope = 3.0 * (h0 + h1) / ((2.0 * h1 + h0) / d0 + (h1 + 2.0 * h0) / d1);
    }
    if (knots_.size() > 1) {
        const Knot& before = knots_[knots_.size() - 2];
        knots_.back().slope = (knots_.back().value - before.value) / (knots_.back().z - before.z);
    }
}

double Profile::at(double height) const {
    if (height <= knots_.front().z) return knots_.front().value;
    if (height >= knots_.back().z) return knots_.back().value;
    std::size_t i = 0;
    while (height > knots_[i + 1].z)
        ++i;
    const Knot &a = knots_[i], &b = knots_[i + 1];
    const double h = b.z - a.z, t = (height - a.z) / h, t2 = t * t, t3 = t2 * t;
    return a.value + (3.0 * t2 - 2.0 * t3) * (b.value - a.value) +
           h * ((t3 - 2.0 * t2 + t) * a.slope + (t3 - t2) * b.slope);
}

Loft::Loft(Outlines outlines, Ends ends, double lean, double wedge, double skew)
    : outlines_(std::move(outlines)), ends_(ends), lean_(lean), wedge_(wedge), skew_(skew) {}

Loft::Loft(const std::vector<Section>& s, Ends ends, double lean, double wedge, double skew)
    : Loft({profileOf(s, [](const Section& b) { return b.cx + b.halfX; }),
            profileOf(s, [](const Section& b) { return b.halfX - b.cx; }),
            profileOf(s, [](const Section& b) { return b.halfY - b.cy; }),
            profileOf(s, [](const Section& b) { return b.halfY + b.cy; }),
            profileOf(s, [](const Section& b) { return b.square; }),
            profileOf(s, [](const Section& b) { return b.waist; })},
           ends, lean, wedge, skew) {}

double Loft::value(const Vec3& p) const {
    const double m = outlines_.mesial.at(p.z()), d = outlines_.distal.at(p.z()), b = outlines_.buccal.at(p.z()),
                 l = outlines_.lingual.at(p.z());
    const double square = outlines_.square.at(p.z()), waist = outlines_.waist.at(p.z());
    const double crown = smoothStep(-2.0, 2.0, p.z());
    const double dy = p.y() - 0.5 * (l - b), dx = p.x() - 0.5 * (m - d) - crown * skew_ * dy;
    double halfX = 0.5 * (m + d), halfY = 0.5 * (l + b);
    const double u = std::clamp(dx / halfX, -1.5, 1.5), v = std::clamp(dy / halfY, -1.5, 1.5);
    halfX *= 1.0 + crown * lean_ * v;
    halfY *= 1.0 + crown * wedge_ * u;
    if (waist > 0.0) halfX *= 1.0 - waist * gauss(v / 0.42);
    const double x = dx / halfX, y = dy / halfY;
    double w = 0.0, length = 1.0;
    if (p.z() < ends_.bottomZ) w = (ends_.bottomZ - p.z()) / ends_.bottomLength, length = ends_.bottomLength;
    if (ends_.topLength > 0.0 && p.z() > ends_.topZ)
        w = (p.z() - ends_.topZ) / ends_.topLength, length = ends_.topLength;
    // Homogeneous of degree one, so that g - 1 over its gradient is about a distance on all sides of long sections too.
    const double xx = x * x, yy = y * y, sum = xx + yy + 1e-12;
    const double g = std::sqrt(std::max(sum - square * xx * yy / sum + w * w, 1e-12));
    const double gx = x * (1.0 - square * yy * yy / (sum * sum)) / halfX,
                 gy = y * (1.0 - square * xx * xx / (sum * sum)) / halfY, gz = w / length;
    const double steep = std::sqrt(gx * gx + gy * gy + gz * gz) / g;
    return std::max((g - 1.0) / std::max(steep, 1e-3), -1.2 * std::min(halfX, halfY));
}

Unevenness::Unevenness(std::uint64_t seed, const core::Box& box)
    : origin_(box.min - core::Vec3::Constant(2.0 * kNodesMm)) {
    for (int axis = 0; axis < 3; ++axis)
        size_[axis] = static_cast<int>(box.size()[axis] / kNodesMm) + 6;
    nodes_.resize(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                  static_cast<std::size_t>(size_[2]));
    // White noise once more on a grid half as fine, then what is between.
    std::uint64_t state = seed;
    const auto draw = [&] { return 2.0 * core::unitOf(core::nextSplitMix(state)) - 1.0; };
    for (double& value : nodes_)
        value = 1.9 * draw();
    for (int k = 0; k < size_[2]; k += 2)
        for (int j = 0; j < size_[1]; j += 2)
            for (int i = 0; i < size_[0]; i += 2) {
                const double tall = 3.6 * draw();
                for (int c = -1; c <= 1; ++c)
                    for (int b = -1; b <= 1; ++b)
                        for (int a = -1; a <= 1; ++a)
                            if (i + a >= 0 && j + b >= 0 && k + c >= 0 && i + a < size_[0] && j + b < size_[1] &&
                                k + c < size_[2])
                                nodes_[index(i + a, j + b, k + c)] +=
                                    tall * (a ? 0.5 : 1.0) * (b ? 0.5 : 1.0) * (c ? 0.5 : 1.0);
            }
}

double Unevenness::at(const Vec3& p) const {
    // Quadratic B-splines: smooth, and three nodes a side.
    int from[3];
    double w[3][3];
    for (int axis = 0; axis < 3; ++axis) {
        const double at = std::clamp((p[axis] - origin_[axis]) / kNodesMm, 1.0, size_[axis] - 2.5);
        from[axis] = static_cast<int>(at + 0.5) - 1;
        const double t = at - (from[axis] + 1);
        w[axis][0] = 0.5 * (0.5 - t) * (0.5 - t), w[axis][1] = 0.75 - t * t, w[axis][2] = 0.5 * (0.5 + t) * (0.5 + t);
    }
    double sum = 0.0;
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) {
            const double* row = &nodes_[index(from[0], from[1] + j, from[2] + k)];
            sum += w[2][k] * w[1][j] * (w[0][0] * row[0] + w[0][1] * row[1] + w[0][2] * row[2]);
        }
    return sum;
}

Vec3 Unevenness::folded(const Vec3& p) const {
    Vec3 to;
    for (int axis = 0; axis < 3; ++axis) {
        const double wide = (size_[axis] - 4) * kNodesMm, at = p[axis] / (axis == 2 ? kFineUpMm : kFineAcrossMm);
        // Back and forth, so that it stays smooth.
        const double turn = at / wide - 2.0 * std::floor(0.5 * at / wide);
        to[axis] = origin_[axis] + kNodesMm + wide * (turn < 1.0 ? turn : 2.0 - turn);
    }
    return to;
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
        Curve curve{c.from, c.by - c.from, c.from - 2.0 * c.by + c.to,     c.round, c.slope,
                    0.0,    -1e9,          0.5 * (c.from + c.to).head<2>()};
        for (std::size_t i = 0; i < curve.along.size(); ++i) {
            const double t = static_cast<double>(i) / kPieces;
            const Vec3 at = curve.a + 2.0 * t * curve.b + t * t * curve.c;
            curve.along[i] = at.head<2>();
            curve.topZ = std::max(curve.topZ, at.z());
            curve.reach = std::max(curve.reach, (at.head<2>() - curve.middle).norm());
        }
        topZ_ = std::max(topZ_, curve.topZ + 0.3);
        (c.isRim ? rim_ : curves_).push_back(curve);
    }
    settleGrooves();
    for (const Groove& g : spec_.grooves) {
        Line line{rounded(g.points), {}, kShoulders * g.halfWidth, g.fromZ, g.toZ, Vec2::Zero(), 0.0};
        std::vector<Vec3> widths;
        for (std::size_t i = 0; i < g.points.size(); ++i)
            widths.push_back(Vec3(g.widths.empty() ? 1.0 : g.widths[i], 0.0, 0.0));
        double widest = 0.0;
        for (const Vec3& w : rounded(widths))
            line.widths.push_back(w.x()), widest = std::max(widest, w.x());
        core::Box box;
        for (const Vec3& p : line.points)
            box.extend(p);
        line.middle = box.centre().head<2>();
        for (const Vec3& p : line.points)
            line.reach = std::max(line.reach, (p.head<2>() - line.middle).norm() + widest * line.halfWidth + 0.1);
        lines_.push_back(line);
    }
    for (const Hollow& h : spec_.hollows)
        bumps_.push_back({h.centre, h.radii.cwiseInverse(), h.depth});
    if (spec_.uneven > 0.0) uneven_ = Unevenness(spec_.unevenSeed, bounds());
    // A single root's ends in its canal; with more a floor is cut across.
    if (!spec_.chamber.empty())
        chamber_.emplace_back(
            spec_.chamber, spec_.roots.size() == 1 ? Loft::Ends{spec_.floorZ + 0.4, 0.4} : Loft::Ends{apexZ_, 1.0},
            spec_.isEdge ? 0.0 : spec_.lean, spec_.isEdge ? 0.0 : spec_.wedge, spec_.isEdge ? 0.0 : spec_.skew);
    grind();
    measure();
}

void Anatomy::grind() {
    for (const Facet& f : spec_.facets) {
        Vec3 at;
        if (!surfaceAlong(Vec3(f.place.x(), f.place.y(), topZ_), -Vec3::UnitZ(), at)) continue;
        constexpr double kNear = 0.15;
        Vec3 normal;
        for (int axis = 0; axis < 3; ++axis)
            normal[axis] = body(at + kNear * Vec3::Unit(axis)) - body(at - kNear * Vec3::Unit(axis));
        normal.normalize();
        facets_.push_back({at - f.depth * normal, normal});
    }
}

void Anatomy::settleGrooves() {
    // Fissures run where lobes have met: along the valleys that the crests leave, pits where those are deepest.
    const auto settled = [&](const Vec2& from, const Vec2& across, double reach) {
        Vec2 best = from;
        double least = std::numeric_limits<double>::infinity();
        const bool isLine = across.squaredNorm() > 0.0;
        for (int i = -5; i <= 5; ++i)
            for (int j = isLine ? 0 : -5; j <= (isLine ? 0 : 5); ++j) {
                const Vec2 off = reach / 5.0 * (isLine ? Vec2(i * across) : Vec2(i, j));
                const double height = occlusalHeight(from.x() + off.x(), from.y() + off.y()) + 0.3 * off.squaredNorm();
                if (height < least) least = height, best = from + off;
            }
        return best;
    };
    const auto isInside = [&](const Vec2& p) { return crown_.value(Vec3(p.x(), p.y(), spec_.groundZ)) < -1.6; };
    for (Hollow& h : spec_.hollows)
        if (!h.pit.empty() && !spec_.isEdge && isInside(h.centre.head<2>()))
            h.centre.head<2>() = settled(h.centre.head<2>(), Vec2::Zero(), 0.3);
    for (Groove& g : spec_.grooves) {
        if (g.name.empty()) continue;
        const std::vector<Vec3> before = g.points;
        for (std::size_t i = 0; i < before.size(); ++i) {
            const Vec2 at = before[i].head<2>();
            if (!isInside(at)) continue;
            const bool isEnd = i == 0 || i + 1 == before.size();
            const Vec2 way = isEnd ? Vec2::Zero() : Vec2((before[i + 1] - before[i - 1]).head<2>().normalized());
            g.points[i].head<2>() = settled(at, Vec2(-way.y(), way.x()), isEnd ? 0.2 : 0.35);
        }
        const std::vector<Vec3> rough = g.points;
        for (std::size_t i = 1; i + 1 < rough.size(); ++i)
            g.points[i] = 0.25 * rough[i - 1] + 0.5 * rough[i] + 0.25 * rough[i + 1];
    }
    // A pit is where grooves meet.
    for (Hollow& h : spec_.hollows) {
        if (h.pit.empty() || !isInside(h.centre.head<2>())) continue;
        double nearest = 0.6;
        Vec2 place = h.centre.head<2>();
        for (const Groove& g : spec_.grooves)
            for (const Vec3& end : {g.points.front(), g.points.back()})
                if (const double away = (end.head<2>() - h.centre.head<2>()).norm(); !g.name.empty() && away < nearest)
                    nearest = away, place = end.head<2>();
        h.centre.head<2>() = place;
    }
}

core::Box Anatomy::bounds() const {
    return {Vec3(-reach_, -reach_, apexZ_ - 0.5), Vec3(reach_, reach_, topZ_)};
}

double Anatomy::heightOver(const Curve& c, double x, double y, double atLeast) {
    const Vec2 p(x, y);
    const double away = std::max((p - c.middle).norm() - c.reach, 0.0);
    if (c.topZ - c.slope * (std::sqrt(away * away + c.round * c.round) - c.round) < atLeast) return atLeast;
    // The nearest point of the curve as seen from above: the best of some, then Newton.
    double nearest = std::numeric_limits<double>::infinity(), t = 0.0;
    for (std::size_t i = 0; i < c.along.size(); ++i) {
        const double squared = (c.along[i] - p).squaredNorm();
        if (squared < nearest) nearest = squared, t = static_cast<double>(i) / kPieces;
    }
    for (int i = 0; i < 3; ++i) {
        const Vec2 off = (c.a + 2.0 * t * c.b + t * t * c.c).head<2>() - p, way = 2.0 * (c.b + t * c.c).head<2>();
        const double bend = way.squaredNorm() + 2.0 * off.dot(c.c.head<2>());
        t = std::clamp(t - off.dot(way) / std::max(bend, 0.3 * way.squaredNorm() + 1e-9), 0.0, 1.0);
    }
    const Vec3 at = c.a + 2.0 * t * c.b + t * t * c.c;
    return std::max(at.z() - c.slope * (std::sqrt((at.head<2>() - p).squaredNorm() + c.round * c.round) - c.round),
                    atLeast);
}

double Anatomy::occlusalHeight(double x, double y) const {
    const double across = y;
    if (spec_.isEdge) y = spec_.cusps.front().tip.y();
    const double soft = spec_.isEdge ? kValleyMm : kRimMm;
    double rim = spec_.groundZ;
    for (const Curve& c : rim_)
        rim = smoothMax(rim, heightOver(c, x, y, rim - soft), soft);
    double height = spec_.groundZ;
    for (const Curve& c : curves_)
        height = smoothMax(height, heightOver(c, x, y, height - kValleyMm), kValleyMm);
    if (curves_.empty()) return rim - kEdgeBevel * (across - y);
    return smoothMax(rim, height, kValleyMm);
}

double Anatomy::grooveDepth(const Vec3& p) const {
    double deepest = 0.0;
    for (const Line& g : lines_) {
        if (p.z() <= g.fromZ) continue;
        const double mx = p.x() - g.middle.x(), my = p.y() - g.middle.y();
        if (mx * mx + my * my > g.reach * g.reach) continue;
        double here = 0.0;
        for (std::size_t i = 0; i + 1 < g.points.size(); ++i) {
            const Vec3 &a = g.points[i], &b = g.points[i + 1];
            const double dx = b.x() - a.x(), dy = b.y() - a.y();
            const double t = std::clamp(((p.x() - a.x()) * dx + (p.y() - a.y()) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
            const double ex = p.x() - a.x() - t * dx, ey = p.y() - a.y() - t * dy;
            constexpr double kFloor = 0.08;
            const double width = g.halfWidth * (g.widths[i] + t * (g.widths[i + 1] - g.widths[i]));
            const double d = (std::sqrt(ex * ex + ey * ey + kFloor * kFloor) - kFloor) / width;
            if (d < 1.0) here = std::max(here, (a.z() + t * (b.z() - a.z())) * (1.0 - d) * (1.0 - d));
        }
        if (here > deepest) deepest = std::max(deepest, here * smoothStep(g.fromZ, g.toZ, p.z()));
    }
    return deepest;
}

double Anatomy::body(const Vec3& p) const {
    double value = crown_.value(p);
    if (!spec_.crests.empty() && p.z() > 0.25 * topZ_) {
        // Nowhere is the occlusal surface lower than its ground, but over an edge: down the sides it counts no more.
        const bool counts = spec_.isEdge || value - kHeightToDistance * (p.z() - spec_.groundZ) < spec_.rimRound;
        if (counts) {
            const double top = kHeightToDistance * (p.z() - occlusalHeight(p.x(), p.y()));
            value = smoothMax(value, top, spec_.rimRound);
        }
    }
    if (p.z() < 3.0 && roots_.size() > 1) {
        // They pass into each other towards the furcation, and leave the cervix as it is.
        const double blend = 0.1 + spec_.rootBlend * smoothStep(0.0, -spec_.trunk, p.z());
        for (const Loft& root : roots_)
            value = smoothMin(value, root.value(p), blend);
    }
    for (const Bump& b : bumps_) {
        const double q = (p - b.centre).cwiseProduct(b.inverseRadii).squaredNorm();
        if (q < 1.0) value += b.depth * (1.0 - q) * (1.0 - q);
    }
    // Cusps keep their order: they are the least uneven.
    if (spec_.uneven > 0.0 && std::abs(value) < 1.5) {
        const double wall = 1.0 - 0.75 * smoothStep(topZ_ - 2.4, topZ_ - 1.2, p.z());
        value += wall * spec_.uneven * (uneven_.at(p) + kFineShare * uneven_.at(uneven_.folded(p)));
    }
    for (const Plane& f : facets_) {
        const double away = (p - f.at).head<2>().norm() - kFacetReachMm;
        if (away > 2.0) continue;
        const double limit = std::max(away, 0.0) * (kFacetSlope + 0.8 * std::max(away, 0.0));
        value = smoothMax(value, f.normal.dot(p - f.at) - limit, kFacetEdgeMm);
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
    const double value = body(p);
    // Far from the surface grooves move nothing.
    return value - step(aboveCervix(p)) + (std::abs(value) < kGroovesToMm ? grooveDepth(p) : 0.0);
}

double Anatomy::core(const Vec3& p, double bodyValue) const {
    const double above = aboveCervix(p);
    if (above < -0.5) return bodyValue;
    // Thinner under the fossae than on the sides, thicker on cusps and edges.
    const double deep =
        spec_.isEdge ? 0.0 : (spec_.enamelSide - spec_.enamelFossa) * smoothStep(1.4, 2.6, -crown_.value(p));
    const double side = (spec_.enamelSide - deep) * smoothStep(-0.6, 0.55 * spec_.sizes.crown, above);
    const double fromZ = spec_.isEdge ? topZ_ - 2.8 : spec_.groundZ - spec_.enamelFossa;
    const double top = (spec_.enamelCusp - spec_.enamelSide) * smoothStep(fromZ, topZ_ - 0.6 - spec_.enamelCusp, p.z());
    return bodyValue + kCervicalEnamelMm * smoothStep(-0.5, 0.5, above) + side + top;
}

double Anatomy::dentine(const Vec3& p) const {
    return core(p, body(p));
}

double Anatomy::enamel(const Vec3& p) const {
    const double above = aboveCervix(p), bodyValue = body(p);
    // Half of the step lies below the line: there the cap ends, blunt.
    const double cap = smoothMax(-core(p, bodyValue), -above - 0.1, 0.05);
    return smoothMax(bodyValue - step(above) + grooveDepth(p), cap, 0.08);
}

double Anatomy::chamber(const Vec3& p) const {
    // Between horns the roof is the lowest in its middle, and the floor bulges up between the orifices.
    const Section& top = spec_.chamber.back();
    const auto squared = [](double share) { return std::min(share * share, 1.3); };
    const Vec2 out(squared((p.x() - top.cx) / top.halfX), squared((p.y() - top.cy) / top.halfY));
    const double round = std::min(kChamberRoundMm, 0.5 * (spec_.roofZ - spec_.floorZ));
    const double value = smoothMax(chamber_.front().value(p), p.z() - spec_.roofZ - out.dot(spec_.roofRise), round);
    return spec_.roots.size() == 1 ? value : smoothMax(value, spec_.floorZ - out.dot(spec_.floorFall) - p.z(), round);
}

double Anatomy::pulp(const Vec3& p) const {
    const double cavity = chamber_.empty() ? std::numeric_limits<double>::infinity() : chamber(p);
    // Canals flow into the chamber, not into each other: two of a root stay two.
    double value = cavity;
    for (const Canal& c : spec_.canals) {
        const auto radius = [&](double share, const Vec3& at) {
            const double opens = std::max(1.0 - (c.points.front().z() - at.z()) / kFunnelMm, 0.0);
            return c.orificeRadius + share * (c.apexRadius - c.orificeRadius) + opens * opens * c.funnel;
        };
        const double canal = chainValue(c.points, radius, p);
        value = std::min(value, std::isfinite(cavity) ? smoothMin(cavity, canal, 0.5) : canal);
    }
    for (const Horn& h : spec_.horns) {
        const auto radius = [&](double share, const Vec3&) {
            return h.tipRadius + (1.0 - share) * (1.0 - 0.4 * share) * (h.baseRadius - h.tipRadius);
        };
        value = smoothMin(value, chainValue(std::array{h.base, h.tip}, radius, p), kHornBlendMm);
    }
    return smoothMax(
        value,
        core(p, body(p)) + kApicalDentineMm + (kCrownDentineMm - kApicalDentineMm) * smoothStep(-5.0, 0.0, p.z()), 0.2);
}

double Anatomy::cementum(const Vec3& p) const {
    const double above = aboveCervix(p), value = body(p);
    const double thick = 0.05 + 0.15 * smoothStep(0.0, apexZ_, p.z());
    return smoothMax(smoothMax(value, -value - thick, 0.02), above + 0.1, 0.02);
}

bool Anatomy::surfaceAlong(const Vec3& from, const Vec3& direction, Vec3& found) const {
    double before = 0.0, t = 0.0, last = 1.0;
    while (t < 4.0 * reach_ + 30.0) {
        const double value = outer(from + t * direction);
        if (value <= 0.0) {
            // False position, where the end that stays counts half (Illinois).
            double outside = last, inside = value;
            int moved = 0;  // last: +1 the end outside, -1 the one inside
            for (int i = 0; i < 60 && t - before > 1e-9; ++i) {
                const double between =
                    before + std::clamp(outside / (outside - inside), 1e-3, 1.0 - 1e-3) * (t - before);
                const double here = outer(from + between * direction);
                if (std::abs(here) < 1e-10) {
                    t = between;
                    break;
                }
                if (here > 0.0) {
                    before = between, outside = here;
                    if (moved == 1) inside *= 0.5;
                    moved = 1;
                } else {
                    t = between, inside = here;
                    if (moved == -1) outside *= 0.5;
                    moved = -1;
                }
            }
            found = from + t * direction;
            return true;
        }
        before = t, last = value;
        t += std::clamp(0.5 * value, 0.01, 2.0);
    }
    return false;
}

Vec3 Anatomy::climbed(Vec3 p) const {
    for (double step = 0.2; step > 1e-3;) {
        bool moved = false;
        for (const Vec3& way : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
            Vec3 next;
            const Vec3 from(p.x() + step * way.x(), p.y() + step * way.y(), topZ_);
            if (surfaceAlong(from, -Vec3::UnitZ(), next) && next.z() > p.z() + 1e-9) p = next, moved = true;
        }
        if (!moved) step *= 0.5;
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
    // A side has a lobe for each cusp: the outermost of what is found from more than one place.
    const auto widest = [&](const Vec3& way, double z) {
        const Vec3 aside = 0.2 * s.sizes.mesiodistal * Vec3(way.y(), way.x(), 0.0);
        Vec3 best = outermost(way, Vec3(0, 0, z));
        if (s.cusps.size() < 4) return best;
        for (const double side : {1.0, -1.0})
            if (const Vec3 other = outermost(way, side * aside + Vec3(0, 0, z)); other.dot(way) > best.dot(way))
                best = other;
        return best;
    };
    mesialContact = widest(Vec3::UnitX(), s.mesial.contourZ);
    distalContact = widest(-Vec3::UnitX(), s.distal.contourZ);
    buccalContour = widest(-Vec3::UnitY(), s.buccal.contourZ);
    lingualContour = widest(Vec3::UnitY(), s.lingual.contourZ);
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
