// SPDX-License-Identifier: Apache-2.0
// remaining-dentine, pulp-exposed
#include "handpiece/assess/measures/take.h"
#include "handpiece/senses/measure/tooth_probe.h"

namespace handpiece::measures {
namespace {
using cases::Tissue;
using core::Vec3;

bool hasPulp(CutTooth& tooth) {
    return tooth.whole().volumesMm3[static_cast<std::size_t>(Tissue::pulp)] > 0.0;
}

}  // namespace

Taken takeRemainingDentine(CutTooth& tooth, const Selection&) {
    if (!hasPulp(tooth)) return none("the tooth has no pulp");
    if (tooth.cutPoints().empty()) return none("nothing was cut");
    const measure::ToothProbe probe(*tooth.preparation().cut);
    const auto thinnest = probe.thinnestOverPulp();
    if (!thinnest) return none("what was cut is too shallow for its distance to the pulp");
    if (thinnest->leftMm == 0.0) return at(0.0, thinnest->pointMm, "the pulp is open");
    // Its place is good to a voxel: of the surface about it the nearest.
    double least = thinnest->leftMm + tooth.voxelMm();
    Vec3 place = thinnest->pointMm;
    const double round = 3.0 * tooth.voxelMm();
    for (const SurfacePoint& point : tooth.cutPoints()) {
        if ((point.p - thinnest->pointMm).norm() > round) continue;
        if (const auto left = probe.leftOverPulpMm(point.p); left && *left < least) {
            least = *left;
            place = point.p;
        }
    }
    return at(least, place, "thinnest over the pulp");
}

Taken takePulpExposed(CutTooth& tooth, const Selection&) {
    if (!hasPulp(tooth)) return none("the tooth has no pulp");
    double area = 0.0;
    Vec3 middle = Vec3::Zero();
    for (const SurfacePoint& point : tooth.cutPoints())
        if (tooth.whole().tissues.at(point.p - 0.02 * tooth.voxelMm() * point.n) == Tissue::pulp) {
            area += point.areaMm2;
            middle += point.areaMm2 * point.p;
        }
    if (area == 0.0) return {0.0, {}};
    return at(area, middle / area, "open pulp");
}

}  // namespace handpiece::measures
