// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/rules.h"

#include <algorithm>
#include <numbers>

#include "handpiece/base/core/portable_math.h"

namespace handpiece::dentition {
namespace {
using core::Vec2;
using core::Vec3;

Vec3 between(const Vec3& a, const Vec3& b, double t) {
    return a + t * (b - a);
}

/// From a tip down to a notch or corner of the rim: falls slowly at first, bulges outwards.
Crest cuspRidge(const Vec3& tip, const Vec3& end, double side, double slope) {
    Vec3 by = between(tip, end, 0.5);
    by.y() += 0.15 * side;
    by.z() += 0.25 * (tip.z() - end.z());
    return {tip, by, end, 0.9, std::max(1.0, slope - 0.25), true};
}

}  // namespace

Vec2 rootCentre(const Root& r, double t) {
    // Through its middle: a quadratic in the height.
    const double tm = r.middle.z() / r.apex.z();
    const Vec2 chord = r.cervix + tm * (r.apex.head<2>() - r.cervix);
    const Vec2 bow = (r.middle.head<2>() - chord) / (tm * (1.0 - tm));
    return r.cervix + t * (r.apex.head<2>() - r.cervix) + t * (1.0 - t) * bow;
}

void vary(OcclusalPlan& plan, Draws& draws) {
    for (std::vector<CuspPlan>* side : {&plan.buccal, &plan.lingual})
        for (CuspPlan& c : *side) {
            c.tip += draws.shift(0.2, 0.14, 0.05);
            c.inner += draws.shift(0.2, 0.2, 0.1);
            c.round *= 1.0 + 0.12 * draws.normal(), c.slope *= 1.0 + 0.04 * draws.normal();
            c.bow += 0.2 * draws.normal();
        }
    for (std::vector<Vec3>* side : {&plan.buccalNotch, &plan.lingualNotch})
        for (Vec3& notch : *side)
            notch += draws.shift(0.2, 0.08, 0.12);
    for (MarginalPlan* m : {&plan.mesial, &plan.distal}) {
        m->buccal += draws.shift(0.08, 0.15, 0.08), m->lingual += draws.shift(0.08, 0.15, 0.08);
        m->middle += draws.shift(0.08, 0.25, 0.12);
        m->round *= 1.0 + 0.15 * draws.normal();
    }
}

std::vector<Vec3> bent(const Vec3& from, const Vec3& to, Draws& draws) {
    const Vec3 way = to - from, across(-way.y(), way.x(), 0.0);
    const double one = 0.12 * draws.normal(), two = 0.7 * one + 0.09 * draws.normal();
    return {from, between(from, to, 0.35) + one * across, between(from, to, 0.68) + two * across, to};
}

namespace {
/// From a point towards an angle, curving, fading out; some fork on their way.
void twig(Spec& spec, const Vec3& from, double rad, double length, Draws& draws, int forks = 1) {
    const auto on = [](const Vec3& p, double angle, double by, double depth) {
        return Vec3(p.x() + by * core::cos(angle), p.y() + by * core::sin(angle), depth);
    };
    const double bend = 0.35 * draws.normal();
    const Vec3 middle = on(from, rad, 0.5 * length, 0.7 * from.z()), end = on(middle, rad + bend, 0.5 * length, 0.0);
    spec.grooves.push_back(
        {"", {from, middle, end}, 0.2 + 0.07 * draws.uniform(), spec.groundZ + 0.1, spec.groundZ + 0.8});
    if (forks > 0 && draws.uniform() < 0.35)
        twig(spec, middle, rad + (draws.uniform() < 0.5 ? -0.8 : 0.8) - bend, 0.6 * length, draws, forks - 1);
}
}  // namespace

void supplementalGrooves(Spec& spec, const OcclusalPlan& plan, Draws& draws) {
    for (const std::vector<CuspPlan>* side : {&plan.buccal, &plan.lingual})
        for (const CuspPlan& c : *side)
            for (const double turn : {1.0, -1.0}) {
                if (draws.uniform() < 0.3) continue;
                // Beside the triangular ridge, up the cusp's slope.
                const Vec3 up = c.tip - c.inner;
                const double rad = core::atan2(up.y(), up.x()) + turn * (0.35 + 0.5 * draws.uniform());
                const double start = 0.1 + 0.5 * draws.uniform();
                Vec3 from = c.inner + Vec3(start * core::cos(rad), start * core::sin(rad), 0.0);
                from.z() = 0.06 + 0.12 * draws.uniform();
                twig(spec, from, rad - 0.3 * turn, (0.45 + 0.3 * draws.uniform()) * up.head<2>().norm(), draws);
            }
    for (const Hollow& pit : std::vector<Hollow>(spec.hollows)) {
        if (pit.pit != "mesial" && pit.pit != "distal") continue;
        const double out = pit.pit == "mesial" ? 1.0 : -1.0;
        // To the corners of the triangular fossa, now and then over the marginal ridge.
        for (const double side : {-1.0, 0.0, 1.0}) {
            const double chance = draws.uniform(), deep = draws.uniform(),
                         length = (side == 0.0 ? 0.7 : 0.9) + 0.8 * draws.uniform();
            if (chance < (side == 0.0 ? 0.7 : 0.12)) continue;
            const double turn = side * (0.65 + 0.6 * draws.uniform()), angle = turn + 0.2 * draws.normal();
            twig(spec, Vec3(pit.centre.x(), pit.centre.y(), side == 0.0 ? 0.08 + 0.08 * deep : 0.18 + 0.14 * deep),
                 out > 0.0 ? angle : std::numbers::pi - angle, length, draws);
        }
    }
}

void occlusalSurface(Spec& spec, const OcclusalPlan& plan) {
    for (const bool isBuccal : {true, false}) {
        const std::vector<CuspPlan>& cusps = isBuccal ? plan.buccal : plan.lingual;
        const std::vector<Vec3>& notches = isBuccal ? plan.buccalNotch : plan.lingualNotch;
        const double side = isBuccal ? -1.0 : 1.0;
        for (std::size_t i = 0; i < cusps.size(); ++i) {
            const CuspPlan& c = cusps[i];
            spec.cusps.push_back({c.name, c.tip});
            const Vec3 mesial = i > 0 ? notches[i - 1] : isBuccal ? plan.mesial.buccal : plan.mesial.lingual;
            const Vec3 distal = i + 1 < cusps.size() ? notches[i] : isBuccal ? plan.distal.buccal : plan.distal.lingual;
            Vec3 by = between(c.tip, c.inner, 0.5);
            by.x() += c.bow;
            by.z() += 0.24 * (c.tip.z() - c.inner.z());
            spec.crests.push_back(
                {c.tip, by, c.inner, 1.3 * c.round, c.slope, false, std::string("triangular ") + c.name});
            spec.crests.push_back(cuspRidge(c.tip, mesial, side, c.slope));
            spec.crests.push_back(cuspRidge(c.tip, distal, side, c.slope));
        }
    }
    for (const MarginalPlan* m : {&plan.mesial, &plan.distal}) {
        const double outwards = m == &plan.mesial ? 0.25 : -0.25;
        const Vec3 out(outwards, 0, 0);
        const char* name = m == &plan.mesial ? "mesial" : "distal";
        spec.crests.push_back(
            {m->buccal, between(m->buccal, m->middle, 0.5) + out, m->middle, 1.5 * m->round, 1.0, true, name, true});
        spec.crests.push_back(
            {m->middle, between(m->middle, m->lingual, 0.5) + out, m->lingual, 1.5 * m->round, 1.0, true, name, true});
    }
}

namespace {
/// Pulps grow narrower all life long.
double youth(double ageYears) {
    return std::clamp(1.0 - 0.009 * (ageYears - 25.0), 0.4, 1.1);
}

/// From the middle of a section of the chamber towards a place, this share of the way to the wall.
Vec2 towards(const Section& in, const Vec2& to, double share) {
    const Vec2 middle(in.cx, in.cy), way = to - middle;
    const double xx = way.x() * way.x() / (in.halfX * in.halfX), yy = way.y() * way.y() / (in.halfY * in.halfY),
                 sum = std::max(xx + yy, 1e-12);
    return middle + share / std::sqrt(sum - in.square * xx * yy / sum) * way;
}

/// From the roof's edge straight towards a cusp or edge, ending so far over the middle of the roof; a horn runs out
/// slender from a broad base.
Horn hornTo(const std::string& name, const Spec& spec, const Vec2& base, const Vec3& cusp, double up, double radius) {
    // Thin crowns leave little room: there it begins deep in the pulp, so that some of it always lies within.
    const double tip = 0.15, under = spec.isEdge ? 1.2 : 0.2;
    const Vec3 from(base.x(), base.y(), spec.roofZ - under);
    return {name, from, between(from, cusp, (up + under - tip) / (cusp.z() - from.z())), radius, tip};
}

void chamberAndCanals(Spec& spec, double ageYears) {
    const double young = youth(ageYears);
    const bool isMolar = spec.cusps.size() > 2;
    // The roof sinks and the floor rises with the years: the chamber grows lower as it grows narrower.
    spec.roofZ -= 0.8 * (1.0 - young), spec.floorZ += 0.8 * (1.0 - young);
    // Molars' walls are as thick all round at the cervix.
    const Vec2 cervix(spec.sizes.mesiodistalCervix, spec.sizes.buccolingualCervix);
    const double wall = 0.13 * cervix.sum();
    const double halfX = (isMolar ? 0.5 * cervix.x() - wall : 0.19 * cervix.x()) * young,
                 halfY = (isMolar ? 0.5 * cervix.y() - wall : 0.22 * cervix.y()) * young;
    // The outline of the cervix, smaller. Its walls are hollow: wide towards the horns and the orifices, narrow
    // between.
    const auto section = [&](double z, double share) -> Section {
        return {z, spec.centreX, 0.0, share * halfX, share * halfY, spec.cervixSquare};
    };
    spec.chamber = {section(spec.floorZ - 0.2, 0.95), section(0.5 * (spec.floorZ + spec.roofZ), 0.91),
                    section(spec.roofZ + 0.2, 1.03)};
    // Concave between horns, the floor convex between orifices; of a premolar, across the row of the two both are
    // round.
    spec.roofRise = {(isMolar ? 0.4 : -0.8) * halfX, 0.36 * halfY};
    spec.floorFall = {isMolar ? 0.35 * young : -0.5 * halfX, 0.35 * young};
    const Section &floor = spec.chamber.front(), &roof = spec.chamber.back();
    for (const Cusp& c : spec.cusps) {
        // The mesiobuccal one is the highest, mesial ones are higher than distal ones.
        const double up = (&c == &spec.cusps.front() ? 1.7 : 1.25 + 0.12 * c.tip.x()) * young;
        spec.horns.push_back(
            hornTo(c.name, spec, towards(roof, c.tip.head<2>(), 0.75), c.tip, up, (isMolar ? 0.8 : 0.65) * young));
    }
    for (const Root& r : spec.roots) {
        const bool isTwo = std::find(spec.twoCanals.begin(), spec.twoCanals.end(), r.name) != spec.twoCanals.end();
        const auto centre = [&](double t) { return rootCentre(r, t); };
        for (const double side : isTwo ? std::vector<double>{-1.0, 1.0} : std::vector<double>{0.0}) {
            const double off = side * 0.4 * r.half.y(), end = 1.0 + 0.7 / r.apex.z();
            Vec2 top(std::clamp(r.cervix.x(), spec.centreX - 0.75 * halfX, spec.centreX + 0.75 * halfX),
                     std::clamp(r.cervix.y(), -0.8 * halfY, 0.8 * halfY));
            if (isTwo && std::abs(r.cervix.y()) < 0.5) top.y() = side * 0.7 * halfY;
            top = towards(floor, top, 0.82);
            // MB2 opens 1.5 mm palatal of the first.
            if (isTwo && r.cervix.y() < -0.5 && side > 0.0) top.y() += 1.5;
            Canal canal{r.name,
                        {Vec3(top.x(), top.y(), spec.floorZ + 0.15)},
                        (isTwo ? 0.36 : 0.46) * young,
                        0.13 + 0.05 * young,
                        0.2 * young};
            // MB2 and the distal root's second one are the smaller.
            if (isTwo) canal.name += side < 0.0 ? " buccal" : " lingual";
            if (isTwo && r.name == "mesiobuccal")
                canal.name = side < 0.0 ? "mesiobuccal" : "second mesiobuccal",
                canal.orificeRadius *= side < 0.0 ? 1.1 : 0.8;
            for (const auto& [t, share] : {std::pair{0.3, 1.0}, {0.5, 0.9}, {0.7, 0.72}, {0.85, 0.62}, {end, 0.55}}) {
                const Vec2 c = centre(t);
                canal.points.push_back(Vec3(c.x(), c.y() + off * share, t * r.apex.z()));
            }
            spec.canals.push_back(canal);
        }
    }
}

/// A single root's pulp: shares of the cervix that it has as half its width and depth there, and shares of these
/// half-way up to the roof and at the roof [R].
struct Cavity {
    double wide, deep, halfwayWide, halfwayDeep, roofWide, roofDeep;
};
/// Towards an incisal edge wide and thin, as the crown is; a flame in canines; between two rows of cusps a ribbon.
constexpr Cavity kIncisor{0.20, 0.19, 1.15, 0.70, 1.40, 0.30}, kCanine{0.20, 0.20, 0.85, 0.75, 0.50, 0.35},
    kPremolar{0.20, 0.23, 0.95, 0.95, 0.90, 0.90};

void oneCavity(Spec& spec, double ageYears) {
    const double young = youth(ageYears);
    const bool isIncisor = spec.edgeHorns, isPremolar = !spec.isEdge;
    const Cavity& is = isIncisor ? kIncisor : isPremolar ? kPremolar : kCanine;
    const Root& r = spec.roots.front();
    const double end = 1.0 + 0.7 / r.apex.z();
    // Slender teeth keep their dentine at the sides.
    const double across = spec.sizes.mesiodistalCervix,
                 wide = std::min(is.wide * across, std::max(0.5 * across - 1.35, 0.09 * across)) * young,
                 deep = is.deep * spec.sizes.buccolingualCervix * young;
    spec.roofZ *= 0.7 + 0.3 * young, spec.floorZ = end * r.apex.z();
    for (const auto& [t, share] : {std::pair{end, 0.0}, {0.75, 0.3}, {0.5, 0.5}, {0.25, 0.75}, {0.0, 1.0}}) {
        const Vec2 c = rootCentre(r, t);
        spec.chamber.push_back(
            {t * r.apex.z(), c.x(), c.y(), std::max(wide * share, 0.17), std::max(deep * share, 0.17), 0.2});
    }
    const Vec3 highest = spec.cusps.front().tip;
    const double leans = (isPremolar ? 0.1 : 0.6) * highest.y();
    spec.chamber.push_back({0.5 * spec.roofZ, 0.0, 0.5 * leans, wide * is.halfwayWide, deep * is.halfwayDeep, 0.2});
    spec.chamber.push_back({spec.roofZ, 0.0, leans, wide * is.roofWide, deep * is.roofDeep + 0.1, 0.2});
    const Section& roof = spec.chamber.back();
    if (isIncisor) {
        // One behind each mesial and distal lobe; they are the first to go.
        spec.roofRise.x() = 0.3 * roof.halfX;
        for (const double side : {1.0, -1.0}) {
            const double x = side * 0.6 * roof.halfX;
            spec.horns.push_back(hornTo(side > 0.0 ? "mesial" : "distal", spec, Vec2(x, leans),
                                        Vec3(1.2 * x, highest.y(), highest.z()),
                                        (side > 0.0 ? 1.0 : 0.85) * young * young, 0.36 * young));
        }
        return;
    }
    if (isPremolar) spec.roofRise = {-0.8 * roof.halfX, 0.3 * roof.halfY};
    for (const Cusp& c : spec.cusps) {
        // The lower a cusp, the less of a horn: hardly any under the lingual one of a first lower premolar.
        const double up = 1.2 * std::clamp((c.tip.z() / highest.z() - 0.6) / 0.4, 0.3, 1.0) * young;
        const Vec2 base = isPremolar ? towards(roof, c.tip.head<2>(), 0.72) : Vec2(0.0, leans);
        spec.horns.push_back(hornTo(c.name, spec, base, c.tip, up, (isPremolar ? 0.48 : 0.5) * young));
    }
}

}  // namespace

void addPulp(Spec& spec, double ageYears) {
    spec.roots.size() == 1 ? oneCavity(spec, ageYears) : chamberAndCanals(spec, ageYears);
}

void wear(Spec& spec, double byMm) {
    if (spec.isEdge)
        for (Crest& c : spec.crests)
            for (Vec3* p : {&c.from, &c.by, &c.to})
                p->z() -= byMm;
    for (Crest& c : spec.crests) {
        double tip = -1e9;
        for (const Cusp& cusp : spec.cusps)
            if ((cusp.tip - c.from).head<2>().norm() < 0.05) tip = cusp.tip.z();
        if (spec.isEdge || tip < 0.0) continue;
        c.from.z() = std::min(c.from.z(), tip - byMm);
        c.by.z() = std::min(c.by.z(), tip - byMm);
    }
    for (Cusp& c : spec.cusps)
        c.tip.z() -= byMm;
}

void scale(Spec& s, double x, double y, double crown, double root) {
    const auto height = [&](double& z) { z *= z > 0.0 ? crown : root; };
    const auto point = [&](Vec3& p) { p.x() *= x, p.y() *= y, height(p.z()); };
    Sizes& z = s.sizes;
    z.crown *= crown, z.root *= root, z.mesiodistal *= x, z.mesiodistalCervix *= x, z.buccolingual *= y,
        z.buccolingualCervix *= y;
    z.curveMesial *= crown, z.curveDistal *= crown;
    for (Outline* o : {&s.mesial, &s.distal, &s.buccal, &s.lingual}) {
        const double across = o == &s.mesial || o == &s.distal ? x : y;
        o->contourZ *= crown, o->rimZ *= crown, o->topZ *= crown;
        o->rim *= across, o->top *= across, o->shift *= across;
    }
    s.centreX *= x, s.groundZ *= crown, s.trunk *= root, s.roofZ *= crown;
    for (Cusp& c : s.cusps)
        point(c.tip);
    for (Crest& c : s.crests)
        point(c.from), point(c.by), point(c.to);
    for (Groove& g : s.grooves) {
        g.fromZ *= crown, g.toZ *= crown;
        for (Vec3& p : g.points)
            p.x() *= x, p.y() *= y;
    }
    for (Hollow& h : s.hollows)
        point(h.centre);
    for (Root& r : s.roots) {
        r.cervix.x() *= x, r.cervix.y() *= y, r.half.x() *= x, r.half.y() *= y;
        point(r.middle), point(r.apex);
    }
}

}  // namespace handpiece::dentition
