// SPDX-License-Identifier: Apache-2.0
#include "handpiece/tick/force/parameters.h"

namespace handpiece::force {

Parameters defaultParameters(const cases::TissueTable& tissues) {
    Parameters parameters;
    for (std::size_t i = 0; i < cases::kTissueCount; ++i) {
        const cases::TissueProperties& t = tissues.rows[i];
        parameters.tissues[i] = {t.stiffnessFraction, t.dampingNSPerMm, t.friction};
    }
    return parameters;
}

}  // namespace handpiece::force
