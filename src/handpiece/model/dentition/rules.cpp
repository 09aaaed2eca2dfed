// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/dentition/rules.h"

#include <algorithm>

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
            for (const Vec3& rim : {mesial, distal}) {
                const Vec3 a = between(c.inner, rim, 0.14), e = between(between(c.tip, rim, 0.42), c.inner, 0.25);
                const Vec3 m = between(between(a, e, 0.5), rim, -0.04);
                spec.grooves.push_back(
                    {"", {Vec3(a.x(), a.y(), 0.03), Vec3(m.x(), m.y(), 0.12), Vec3(e.x(), e.y(), 0.0)}, 0.3, 2.0, 3.5});
            }
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

void chamberAndCanals(Spec& spec, double ageYears) {
    const double young = youth(ageYears);
    // The roof sinks and the floor rises with the years: the chamber grows lower as it grows narrower.
    spec.roofZ -= 0.8 * (1.0 - young), spec.floorZ += 0.8 * (1.0 - young);
    const double halfX = 0.25 * spec.sizes.mesiodistalCervix * young,
                 halfY = 0.22 * spec.sizes.buccolingualCervix * young;
    // Its walls are hollow: wide towards the horns and the orifices, narrow between.
    spec.chamber = {{spec.floorZ - 0.2, spec.centreX, 0.0, 0.92 * halfX, 0.92 * halfY, 0.4},
                    {0.5 * (spec.floorZ + spec.roofZ), spec.centreX, 0.0, 0.86 * halfX, 0.88 * halfY, 0.3},
                    {spec.roofZ + 0.2, spec.centreX, 0.0, halfX, halfY, 0.4}};
    for (const Cusp& c : spec.cusps) {
        // The mesiobuccal one is the highest.
        const double up = (&c == &spec.cusps.front() ? 1.7 : 1.25) * young;
        const Vec2 at(std::clamp(spec.centreX + 0.62 * (c.tip.x() - spec.centreX), spec.centreX - 0.85 * halfX,
                                 spec.centreX + 0.85 * halfX),
                      std::clamp(0.55 * c.tip.y(), -0.85 * halfY, 0.85 * halfY));
        spec.horns.push_back({c.name, Vec3(0.85 * at.x(), 0.85 * at.y(), spec.roofZ - 0.45),
                              Vec3(at.x(), at.y(), spec.roofZ + up - 0.15), 0.5 * young, 0.15});
    }
    for (const Root& r : spec.roots) {
        const bool isTwo = std::find(spec.twoCanals.begin(), spec.twoCanals.end(), r.name) != spec.twoCanals.end();
        const auto centre = [&](double t) { return rootCentre(r, t); };
        for (const double side : isTwo ? std::vector<double>{-1.0, 1.0} : std::vector<double>{0.0}) {
            const double off = side * 0.4 * r.half.y(), end = 1.0 + 0.7 / r.apex.z();
            Vec2 top(std::clamp(r.cervix.x(), spec.centreX - 0.75 * halfX, spec.centreX + 0.75 * halfX),
                     std::clamp(r.cervix.y(), -0.8 * halfY, 0.8 * halfY));
            if (isTwo && std::abs(r.cervix.y()) < 0.5) top.y() = side * 0.7 * halfY;
            // MB2 opens 1.5 mm palatal of the first.
            if (isTwo && r.cervix.y() < -0.5 && side > 0.0) top.y() += 1.5;
            Canal canal{r.name,
                        {Vec3(top.x(), top.y(), spec.floorZ + 0.15)},
                        (isTwo ? 0.36 : 0.46) * young,
                        0.13 + 0.05 * young};
            // MB2 and the distal root's second one are the smaller.
            if (isTwo) canal.name += side < 0.0 ? " buccal" : " lingual";
            if (isTwo && r.name == "mesiobuccal")
                canal.name = side < 0.0 ? "mesiobuccal" : "second mesiobuccal",
                canal.orificeRadius *= side < 0.0 ? 1.1 : 0.8;
            for (const auto& [t, share] : {std::pair{0.3, 1.0}, {0.5, 0.9}, {0.7, 0.65}, {0.85, 0.45}, {end, 0.3}}) {
                const Vec2 c = centre(t);
                canal.points.push_back(Vec3(c.x(), c.y() + off * share, t * r.apex.z()));
            }
            spec.canals.push_back(canal);
        }
    }
}

void oneCavity(Spec& spec, double ageYears) {
    const double hornZ = spec.roofZ, spread = spec.pulpSpread;
    const double young = youth(ageYears);
    const Root& r = spec.roots.front();
    const double top = hornZ * (0.7 + 0.3 * young), end = 1.0 + 0.7 / r.apex.z();
    const double wide = 0.24 * spec.sizes.mesiodistalCervix * young,
                 deep = 0.25 * spec.sizes.buccolingualCervix * young;
    spec.roofZ = top, spec.floorZ = end * r.apex.z();
    for (const auto& [t, share] : {std::pair{end, 0.0}, {0.75, 0.3}, {0.5, 0.5}, {0.25, 0.75}, {0.0, 1.0}}) {
        const Vec2 c = rootCentre(r, t);
        spec.chamber.push_back(
            {t * r.apex.z(), c.x(), c.y(), std::max(wide * share, 0.17), std::max(deep * share, 0.17), 0.2});
    }
    // Towards the edge it is wide and thin, as the crown is.
    spec.chamber.push_back(
        {0.55 * top, 0.0, 0.3 * spec.cusps.front().tip.y(), wide * (0.8 + spread), 0.65 * deep, 0.2});
    spec.chamber.push_back(
        {top, 0.0, 0.6 * spec.cusps.front().tip.y(), wide * (0.5 + 1.2 * spread), 0.25 * deep + 0.1, 0.2});
    for (const Cusp& c : spec.cusps) {
        const Vec2 at = spec.isEdge ? Vec2(0.0, 0.6 * c.tip.y())
                                    : Vec2(std::clamp(0.4 * c.tip.x(), -0.6 * wide, 0.6 * wide),
                                           std::clamp(0.5 * c.tip.y(), -0.8 * deep, 0.8 * deep));
        // Of incisors one behind each mesial and distal lobe.
        for (const double x : spread > 0.0 ? std::vector<double>{0.8, -0.8} : std::vector<double>{0.0}) {
            const double side = x * wide * (0.5 + 1.2 * spread);
            const double up = (c.tip.z() / spec.cusps.front().tip.z() > 0.9 || spec.isEdge ? 0.75 : 0.3) * young;
            spec.horns.push_back({spread > 0.0 ? x > 0.0 ? "mesial" : "distal" : c.name,
                                  Vec3(at.x() + 0.8 * side, 0.7 * at.y(), 0.6 * top),
                                  Vec3(at.x() + side, at.y(), top + up - 0.15), 0.28 * young, 0.15});
        }
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
