// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/parameters.h"

namespace handpiece::force {

Parameters defaultParameters() {
    Parameters parameters;
    for (std::size_t i = 0; i < tooth::kTissueCount; ++i) {
        const tooth::TissueProperties& t = tooth::properties(static_cast<tooth::Tissue>(i));
        parameters.tissues[i] = {t.stiffnessFraction, t.dampingNSPerMm};
    }
    return parameters;
}

}  // namespace handpiece::force
