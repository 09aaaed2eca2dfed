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
Crest cuspRidge(const Vec3& tip, const Vec3& end, double side) {
    Vec3 by = between(tip, end, 0.5);
    by.y() += 0.15 * side;
    by.z() += 0.15 * (tip.z() - end.z());
    return {tip, by, end, 0.55, 1.0, true};
}

}  // namespace

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
            by.z() += 0.12 * (c.tip.z() - c.inner.z());
            spec.crests.push_back({c.tip, by, c.inner, c.round, c.slope});
            spec.crests.push_back(cuspRidge(c.tip, mesial, side));
            spec.crests.push_back(cuspRidge(c.tip, distal, side));
            // Between the triangular ridge and the rim a lower secondary ridge: supplemental grooves run on both sides.
            for (const Vec3& rim : {mesial, distal}) {
                Vec3 from = between(c.tip, rim, 0.62), to = between(c.inner, rim, 0.3);
                from.z() -= 0.12, to.z() = c.inner.z() + 0.1;
                Vec3 half = between(between(from, to, 0.5), c.tip, -0.08);
                half.z() -= 0.05 * (from.z() - to.z());
                spec.crests.push_back({from, half, to, 0.35, 1.1});
                // The groove beside the triangular ridge is cut a little sharper than the valley it lies in.
                const Vec3 a = between(c.inner, rim, 0.14), e = between(between(c.tip, rim, 0.42), c.inner, 0.25);
                const Vec3 m = between(between(a, e, 0.5), rim, -0.04);
                spec.grooves.push_back(
                    {"", {Vec3(a.x(), a.y(), 0.03), Vec3(m.x(), m.y(), 0.09), Vec3(e.x(), e.y(), 0.0)}, 0.2, 2.0, 3.5});
            }
        }
    }
    for (const MarginalPlan* m : {&plan.mesial, &plan.distal}) {
        const double outwards = m == &plan.mesial ? 0.25 : -0.25;
        const Vec3 out(outwards, 0, 0);
        spec.crests.push_back({m->buccal, between(m->buccal, m->middle, 0.5) + out, m->middle, m->round, 1.0, true});
        spec.crests.push_back({m->middle, between(m->middle, m->lingual, 0.5) + out, m->lingual, m->round, 1.0, true});
    }
}

void pulpOf(Spec& spec, double ageYears, const std::vector<std::string>& twoCanals) {
    const double young = std::clamp(1.0 - 0.008 * (ageYears - 25.0), 0.45, 1.15);
    const double halfX = 0.24 * spec.sizes.mesiodistalCervix * young,
                 halfY = 0.22 * spec.sizes.buccolingualCervix * young;
    spec.chamber = {{spec.floorZ - 0.5, spec.centreX, 0.0, 0.85 * halfX, 0.85 * halfY, 0.6},
                    {0.5 * (spec.floorZ + spec.roofZ), spec.centreX, 0.0, halfX, halfY, 0.6},
                    {spec.roofZ + 0.5, spec.centreX, 0.0, 0.95 * halfX, 0.95 * halfY, 0.6}};
    bool isFirst = true;
    for (const Cusp& c : spec.cusps) {
        // The mesiobuccal one is the highest.
        const double up = (isFirst ? 1.6 : 1.2) * young;
        const Vec2 across(spec.centreX + 0.62 * (c.tip.x() - spec.centreX), 0.55 * c.tip.y());
        const Vec2 at(std::clamp(across.x(), spec.centreX - 0.95 * halfX, spec.centreX + 0.95 * halfX),
                      std::clamp(across.y(), -0.95 * halfY, 0.95 * halfY));
        spec.horns.push_back({c.name, Vec3(0.8 * at.x(), 0.8 * at.y(), spec.roofZ - 0.3),
                              Vec3(at.x(), at.y(), spec.roofZ + up - 0.14), 0.36 * young, 0.14});
        isFirst = false;
    }
    for (const Root& r : spec.roots) {
        const bool isTwo = std::find(twoCanals.begin(), twoCanals.end(), r.name) != twoCanals.end();
        for (const double side : isTwo ? std::vector<double>{-1.0, 1.0} : std::vector<double>{0.0}) {
            const double off = side * 0.42 * r.half.y();
            const Vec3 start(std::clamp(r.cervix.x(), spec.centreX - 0.8 * halfX, spec.centreX + 0.8 * halfX),
                             std::clamp(r.cervix.y() + off, -0.85 * halfY, 0.85 * halfY), spec.floorZ + 0.3);
            const Vec3 third(0.5 * (r.cervix.x() + r.middle.x()), 0.5 * (r.cervix.y() + r.middle.y()) + off,
                             0.5 * r.middle.z());
            const Vec3 middle(r.middle.x(), r.middle.y() + 0.85 * off, r.middle.z());
            const Vec3 low = between(r.middle, r.apex, 0.6) + Vec3(0, 0.3 * off, 0);
            const Vec3 end = between(r.middle, r.apex,
                                     1.0 - 0.8 / (r.apex.z() - r.middle.z() < -0.1 ? r.middle.z() - r.apex.z() : 1.0)) +
                             Vec3(0, 0.2 * off, 0);
            std::string name = r.name;
            if (isTwo) name += side < 0.0 ? " buccal" : " lingual";
            spec.canals.push_back({name, {start, third, middle, low, end}, (isTwo ? 0.38 : 0.5) * young, 0.15});
        }
    }
}

void singleRootPulp(Spec& spec, double ageYears, double hornZ, double spread) {
    const double young = std::clamp(1.0 - 0.008 * (ageYears - 25.0), 0.45, 1.15);
    const Root& r = spec.roots.front();
    const auto wide = [&](double t) {
        return Vec2(0.26 * spec.sizes.mesiodistalCervix * young * t, 0.26 * spec.sizes.buccolingualCervix * young * t);
    };
    const double top = hornZ * (0.75 + 0.25 * young), apex = r.apex.z() + 0.8;
    spec.roofZ = top - 0.2, spec.floorZ = apex;
    const auto centre = [&](double z) {
        const double t = std::clamp(z / r.apex.z(), 0.0, 1.0), tm = r.middle.z() / r.apex.z();
        const Vec2 bow = (r.middle.head<2>() - r.cervix - tm * (r.apex.head<2>() - r.cervix)) / (tm * (1.0 - tm));
        return Vec2(r.cervix + t * (r.apex.head<2>() - r.cervix) + t * (1.0 - t) * bow);
    };
    for (const auto& [z, w] : std::vector<std::pair<double, double>>{
             {apex, 0.17}, {0.5 * apex, 0.5}, {0.0, 1.0}, {0.5 * top, 0.85}, {top, 0.35}}) {
        const Vec2 half = wide(w), c = centre(z);
        spec.chamber.push_back({z, c.x(), c.y(), std::max(half.x() * (z > 0.0 ? 1.0 + spread * z / top : 1.0), 0.16),
                                std::max(half.y(), 0.16), 0.2});
    }
}

void wear(Spec& spec, double byMm) {
    for (Crest& c : spec.crests) {
        double tip = -1e9;
        for (const Cusp& cusp : spec.cusps)
            if ((cusp.tip - c.from).head<2>().norm() < 0.05) tip = cusp.tip.z();
        if (tip < 0.0) continue;
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
    s.centreX *= x, s.groundZ *= crown, s.trunk *= root;
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
