// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>

#include "handpiece/app/scan_work/scan_work.h"
#include "handpiece/base/core/portable_math.h"

namespace handpiece::scan_work {
namespace {

/// How a kind takes up the scan's error.
enum class Takes {
    mean,
    axial,
    height,
    extreme,
    spread,
    slope,
    bothSlopes,
    shortSlope,
    roughness,
    volume,
    share,
    widthShare,
    area,
    pulp,
    ridge,
    beside
};
/// Six teeth beside scanned crowns, of which nothing was gone, read up to 0.13 mm (scan_study, seed 41).
constexpr double kSparedBesideMm = 0.15;
constexpr double kSlopeDeg = 0.1;  ///< that the field made of a scan turns a wall
struct TakesRow {
    std::string_view kind;
    Takes takes;
};
constexpr TakesRow kTakes[] = {
    {"adjacent-depth", Takes::beside},
    {"adjacent-removed", Takes::volume},
    {"axial-depth", Takes::axial},
    {"caries-left", Takes::volume},
    {"caries-left-periphery", Takes::volume},
    {"caries-left-pulpal", Takes::volume},
    {"cavosurface-angle", Takes::shortSlope},
    {"floor-depth", Takes::mean},
    {"floor-depth-shortest", Takes::mean},
    {"floor-flatness", Takes::spread},
    {"floor-tilt", Takes::slope},
    {"gouge-depth", Takes::extreme},
    {"isthmus", Takes::extreme},
    {"isthmus-share", Takes::widthShare},
    {"margin-continuity", Takes::share},
    {"margin-height", Takes::mean},
    {"margin-width", Takes::mean},
    {"marginal-ridge-left", Takes::ridge},
    {"occlusal-convergence", Takes::bothSlopes},
    {"outline-extent", Takes::extreme},
    {"proximal-clearance", Takes::extreme},
    {"pulp-exposed", Takes::pulp},
    {"reduction", Takes::mean},
    {"remaining-dentine", Takes::extreme},
    {"removed", Takes::volume},
    {"removed-share", Takes::share},
    {"roughness", Takes::roughness},
    {"undercut-area", Takes::area},
    {"undercut-depth", Takes::extreme},
    {"unsupported-enamel", Takes::volume},
    {"wall-angle", Takes::slope},
    {"wall-height", Takes::height},
};

}  // namespace

double widened(const measures::Measured& m, const score::ScanFit& scan, std::optional<double> overPulpMm) {
    constexpr double kDegrees = 57.295779513082321;
    const auto row =
        std::find_if(std::begin(kTakes), std::end(kTakes), [&](const TakesRow& one) { return one.kind == m.kind; });
    if (row == std::end(kTakes)) return m.uncertainty;
    // Where the tooth lies, 95 %, from how its surface was held, and the field made of the scan: a tenth of a voxel.
    const double lies = core::hypot(2.0 * scan.liesMm, 0.1 * scan.voxelMm), noise = scan.noiseMm;
    const bool isExtreme =
        m.of.statistic == "least" || m.of.statistic == "greatest" || m.of.statistic == "p5" || m.of.statistic == "p95";
    // Of a mean over four patches; of the one that stands out most.
    const double mean = core::hypot(lies, noise), extreme = core::hypot(lies, 5.0 * noise);
    double more = 0.0;
    switch (row->takes) {
        case Takes::mean:
            more = isExtreme ? extreme : mean;
            break;
        case Takes::axial:  // its outermost part is chosen by a tenth of a quadrant
            more = isExtreme ? extreme : mean + 0.25 * scan.voxelMm;
            break;
        case Takes::height:  // a margin that runs out flat is seen where it is deeper than the noise
            more = isExtreme ? extreme + 10.0 * noise : mean + 0.35 * scan.voxelMm;
            break;
        case Takes::extreme:
            more = extreme;
            break;
        case Takes::spread:
            more = 4.0 * noise + lies;
            break;
        case Takes::slope:  // noise shows in the wall's own residual, which the measure counts already
            more = 2.0 * scan.turnsDeg + (isExtreme ? kDegrees * 2.0 * noise : kSlopeDeg);
            break;
        case Takes::bothSlopes:  // as the tooth is turned, one of two opposite walls gains what the other loses
            more = isExtreme ? kDegrees * 2.0 * noise : kSlopeDeg;
            break;
        case Takes::shortSlope:  // over 0.3 mm
            more = kDegrees * mean / 0.3;
            break;
        case Takes::roughness:
            more = 2e3 * noise;
            break;
        case Takes::volume:
            more = scan.cutMm2 * mean;
            break;
        case Takes::share:  // as deep as a millimetre
            more = 100.0 * mean;
            break;
        case Takes::widthShare:
            more = std::abs(*m.value) * extreme;
            break;
        case Takes::area:
            more = std::sqrt(scan.cutMm2) * extreme;
            break;
        case Takes::ridge:  // which slope is the ridge the measure counts already
            more = core::hypot(lies, 2.5 * noise);
            break;
        case Takes::beside:
            more = kSparedBesideMm;
            break;
        case Takes::pulp:  // none where the pulp lies surely under the surface
            if (!overPulpMm || *overPulpMm <= extreme) more = std::sqrt(scan.cutMm2) * extreme;
            break;
    }
    return m.uncertainty + more;
}

}  // namespace handpiece::scan_work
