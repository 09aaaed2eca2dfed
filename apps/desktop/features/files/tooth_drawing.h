// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The teeth of a case as a chart draws them.

#include <map>

#include "desktop/widgets/tooth_chart.h"
#include "handpiece/model/case/case.h"

namespace handpiece::desktop {

/// Outline of the crown from above, and the fissures among its landmarks.
[[nodiscard]] ToothDrawing drawingOf(const cases::Tooth& tooth);
/// Those of a case that have a number, by it.
[[nodiscard]] std::map<int, ToothDrawing> drawingsOf(const cases::Case& toothCase);

}  // namespace handpiece::desktop
