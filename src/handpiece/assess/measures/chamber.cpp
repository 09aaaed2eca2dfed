// SPDX-License-Identifier: Apache-2.0
// orifices-reached, gouge-depth
#include <algorithm>
#include <cmath>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/parallel.h"
#include "handpiece/senses/measure/tooth_probe.h"

namespace handpiece::measures {
namespace {
using cases::Tissue;
using core::Vec3;

// A canal's direction is that of its first millimetres under the funnel of its orifice, by the middles of its sections.
constexpr double kSectionMm = 0.25, kFunnelMm = 1.0, kCanalMm = 3.0, kCanalRadiusMm = 0.6, kSectionStepMm = 0.05;
constexpr std::size_t kLeastMiddles = 3;
constexpr double kLineStepMm = 0.02, kLineMm = 30.0;
constexpr double kOverFloorMm = 2.0;  // higher over the orifices no chamber begins

std::vector<const cases::Landmark*> orificesOf(const Preparation& p) {
    std::vector<const cases::Landmark*> found;
    for (const cases::Landmark& mark : p.landmarks)
        if (mark.kind == cases::LandmarkKind::orifice) found.push_back(&mark);
    return found;
}
bool wasPulp(const tooth::ToothModel& whole, const Vec3& p) {
    return whole.field.distance(p) < 0.0 && whole.tissues.at(p) == Tissue::pulp;
}

/// Unit, out of the canal; the long axis where the canal shows none.
Vec3 canalWay(const tooth::ToothModel& whole, const Vec3& orifice, const DrawFrame& frame) {
    std::vector<Vec3> middles;
    Vec3 step = -kSectionMm * frame.w, centre = orifice;
    for (double deep = kSectionMm; deep < kCanalMm + 0.5 * kSectionMm; deep += kSectionMm) {
        const Vec3 about = centre + step;
        Vec3 sum = Vec3::Zero();
        int count = 0;
        const int half = static_cast<int>(kCanalRadiusMm / kSectionStepMm);
        for (int j = -half; j <= half; ++j)
            for (int i = -half; i <= half; ++i) {
                if (i * i + j * j > half * half) continue;
                const Vec3 p = about + kSectionStepMm * (i * frame.u + j * frame.v);
                if (!wasPulp(whole, p)) continue;
                sum += p;
                ++count;
            }
        if (count == 0) break;
        const Vec3 next = sum / count;
        if (deep > kFunnelMm + kSectionMm) step = next - centre;
        middles.push_back(next);
        centre = next;
    }
    // A section of the funnel opens towards the chamber, and its middle leans there: where the canal goes on it does
    // not count.
    constexpr auto kInFunnel = static_cast<std::ptrdiff_t>(kFunnelMm / kSectionMm);
    if (middles.size() >= kInFunnel + 2 * kLeastMiddles) middles.erase(middles.begin(), middles.begin() + kInFunnel);
    if (middles.size() < kLeastMiddles) return frame.w;
    // Least squares over the depth.
    double depth = 0.0;
    Vec3 mean = Vec3::Zero();
    for (const Vec3& p : middles)
        depth += frame.w.dot(p), mean += p;
    depth /= static_cast<double>(middles.size());
    mean /= static_cast<double>(middles.size());
    double xx = 0.0;
    Vec3 xy = Vec3::Zero();
    for (const Vec3& p : middles) {
        const double x = frame.w.dot(p) - depth;
        xx += x * x;
        xy += x * (p - mean);
    }
    return xx > 0.0 ? Vec3((xy / xx).normalized()) : frame.w;
}

/// Of the long axis, not of the path of draw.
DrawFrame alongTooth(const Axes& axes) {
    DrawFrame frame;
    frame.w = axes.longAxis;
    frame.u = (axes.mesial - axes.mesial.dot(frame.w) * frame.w).normalized();
    frame.v = frame.w.cross(frame.u);
    return frame;
}

}  // namespace

Taken takeOrificesReached(CutTooth& tooth, const Selection&) {
    const Preparation& p = tooth.preparation();
    const auto orifices = orificesOf(p);
    if (orifices.empty()) return none("the case names no orifice of a root canal");
    if (tooth.whole().volumesMm3[static_cast<std::size_t>(Tissue::pulp)] == 0.0) return none("the tooth has no pulp");
    if (tooth.cutPoints().empty()) return none(kNothing);
    const DrawFrame frame = alongTooth(p.axes);
    CutTooth::Look look(tooth);
    // Out through air and pulp, past no hard tissue.
    const auto isOpen = [&](const Vec3& from, const Vec3& way) {
        for (double t = 0.0; t < kLineMm; t += kLineStepMm) {
            const Vec3 q = from + t * way;
            if (look.now(q) < 0.0 && tooth.whole().tissues.at(q) != Tissue::pulp) return false;
        }
        return true;
    };
    std::size_t reached = 0, unsure = 0;
    Taken taken;
    for (const cases::Landmark* orifice : orifices) {
        const Vec3& from = orifice->pointsMm.front();
        const Vec3 way = canalWay(tooth.whole(), from, frame);
        const bool isReached = isOpen(from, way);
        // Half a voxel aside it may be otherwise.
        const double off = 0.5 * tooth.voxelMm();
        bool isSure = true;
        for (const Vec3& aside : {frame.u, Vec3(-frame.u), frame.v, Vec3(-frame.v)})
            isSure = isSure && isOpen(from + off * aside, way) == isReached;
        reached += isReached ? 1 : 0;
        unsure += isSure ? 0 : 1;
        if (!isReached) taken.evidence.push_back({{}, from, {}, "not in a straight line: " + orifice->name});
    }
    const double each = 100.0 / static_cast<double>(orifices.size());
    taken.value = each * static_cast<double>(reached);
    taken.residual = each * static_cast<double>(unsure);
    return taken;
}

Taken takeGougeDepth(CutTooth& tooth, const Selection&) {
    const Preparation& p = tooth.preparation();
    const auto orifices = orificesOf(p);
    if (orifices.empty()) return none("the case names no orifice of a root canal");
    if (tooth.cutPoints().empty()) return none(kNothing);
    // The chamber's roof, over the middle of the orifices.
    const Vec3& up = p.axes.longAxis;
    Vec3 middle = Vec3::Zero();
    for (const cases::Landmark* orifice : orifices)
        middle += orifice->pointsMm.front() / static_cast<double>(orifices.size());
    double over = 0.0;
    while (over < kOverFloorMm && !wasPulp(tooth.whole(), middle + over * up))
        over += kLineStepMm;
    if (!(over < kOverFloorMm)) return none("no pulp chamber lies over the orifices");
    while (wasPulp(tooth.whole(), middle + over * up))
        over += kLineStepMm;
    const double roof = up.dot(middle) + over;
    const measure::ToothProbe probe(*p.cut);
    Taken deepest;
    for (const SurfacePoint& point : tooth.cutPoints()) {
        if (!(up.dot(point.p) < roof)) continue;
        double deep = probe.leftOverPulpMm(point.p).value_or(0.0);
        // Straight walls go wider than a chamber that bulges: what the task asks for is no gouge.
        if (p.zones != nullptr) deep = std::min(deep, std::max(0.0, p.zones->targetMm(point.p)));
        if (deepest.value && deep <= *deepest.value) continue;
        deepest = at(deep, point.p, "cut into floor or walls of the chamber");
    }
    if (!deepest.value) return none("nothing was cut lower than the roof of the pulp chamber");
    return deepest;
}

}  // namespace handpiece::measures
