// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "handpiece/assess/measures/take.h"
#include "handpiece/base/core/error.h"

namespace handpiece::measures {
namespace {

struct Registered {
    std::string_view kind;
    Take take;
};
constexpr Registered kRegistered[] = {
    {"removed", takeRemoved},
    {"removed-share", takeRemovedShare},
    {"floor-depth", takeFloorDepth},
    {"floor-depth-shortest", takeFloorDepthShortest},
    {"floor-flatness", takeFloorFlatness},
    {"floor-tilt", takeFloorTilt},
    {"isthmus", takeIsthmus},
    {"isthmus-share", takeIsthmusShare},
    {"marginal-ridge-left", takeMarginalRidge},
    {"wall-height", takeWallHeight},
    {"wall-angle", takeWallAngle},
    {"undercut-area", takeUndercutArea},
    {"undercut-depth", takeUndercutDepth},
    {"roughness", takeRoughness},
    {"remaining-dentine", takeRemainingDentine},
    {"pulp-exposed", takePulpExposed},
    {"cavosurface-angle", takeCavosurfaceAngle},
    {"reduction", takeReduction},
    {"occlusal-convergence", takeConvergence},
    {"margin-width", takeMarginWidth},
    {"margin-continuity", takeMarginContinuity},
    {"margin-height", takeMarginHeight},
    {"axial-depth", takeAxialDepth},
    {"caries-left", takeCariesLeft},
    {"caries-left-periphery", takeCariesLeftPeriphery},
    {"caries-left-pulpal", takeCariesLeftPulpal},
    {"unsupported-enamel", takeUnsupportedEnamel},
    {"adjacent-depth", takeAdjacentDepth},
    {"adjacent-removed", takeAdjacentRemoved},
    {"outline-extent", takeOutlineExtent},
    {"proximal-clearance", takeProximalClearance},
    {"orifices-reached", takeOrificesReached},
    {"gouge-depth", takeGougeDepth},
};

}  // namespace

std::vector<Measured> measure(const Preparation& preparation, std::span<const Request> requests) {
    if (!preparation.whole || preparation.cut == nullptr)
        throw core::Error("a preparation needs a whole and a cut tooth", "measure", "give both");
    CutTooth tooth(preparation);
    std::vector<Measured> results;
    for (const Request& request : requests) {
        if (requireKind(request).subject != Subject::tooth)
            throw core::Error("this measure is of the hand", request.kind, "take it of a session's samples");
        Measured result{request.kind, request.of, {}, 0.0, {}, {}};
        const auto* registered = std::find_if(std::begin(kRegistered), std::end(kRegistered),
                                              [&](const Registered& r) { return r.kind == request.kind; });
        if (registered == std::end(kRegistered)) {
            result.reason = "not taken by this version";
        } else {
            Taken taken = registered->take(tooth, request.of);
            result.value = taken.value;
            result.reason = std::move(taken.reason);
            result.evidence = std::move(taken.evidence);
            if (result.value)
                result.uncertainty =
                    uncertaintyOf(request.kind, tooth.voxelMm(), *result.value, taken.residual) + taken.offMm;
        }
        results.push_back(std::move(result));
    }
    return results;
}

}  // namespace handpiece::measures
