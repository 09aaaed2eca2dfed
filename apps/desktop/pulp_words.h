// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The words for what is left over the pulp, the same wherever it is read.

#include <QCoreApplication>
#include <QString>

#include "handpiece/senses/measure/pulp_light.h"

namespace handpiece::desktop {

[[nodiscard]] inline QString pulpWords(measure::PulpLight light) {
    switch (light) {
        case measure::PulpLight::good:
            return QCoreApplication::translate("Pulp", "Enough is left");
        case measure::PulpLight::near:
            return QCoreApplication::translate("Pulp", "Little is left");
        case measure::PulpLight::harmed:
            break;
    }
    return QCoreApplication::translate("Pulp", "Too little is left");
}

}  // namespace handpiece::desktop
