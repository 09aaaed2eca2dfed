// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The words for what is left over the pulp, the same wherever it is read. They tell the limit, and promise nothing.

#include <QCoreApplication>
#include <QLocale>
#include <QString>

#include "handpiece/senses/measure/pulp_light.h"

namespace handpiece::desktop {

[[nodiscard]] inline QString pulpWords(measure::PulpLight light, const measure::PulpLimits& limits) {
    const auto mm = [](double value) { return QLocale().toString(value, 'g', 3); };
    switch (light) {
        case measure::PulpLight::good:
            return QCoreApplication::translate("Pulp", "%1 mm or more").arg(mm(limits.goodMm));
        case measure::PulpLight::near:
            return QCoreApplication::translate("Pulp", "Under %1 mm").arg(mm(limits.goodMm));
        case measure::PulpLight::harmed:
            break;
    }
    return QCoreApplication::translate("Pulp", "Under %1 mm").arg(mm(limits.leastMm));
}

}  // namespace handpiece::desktop
