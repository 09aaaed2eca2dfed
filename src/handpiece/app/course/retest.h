// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// When what was lost is to be shown once more, without helps: a pure function of what was due and what was shown.

#include <array>
#include <vector>

#include "handpiece/assess/score/score.h"
#include "handpiece/school/store/store.h"

namespace handpiece::course {

/// Days until it is to be shown, after it was lost, and after each time that it was shown since. That practice spread
/// over time is kept better is known [R]; these numbers are a judgement of the project.
inline constexpr std::array<int, 3> kRetestDays{7, 21, 60};
/// How many are taken up from one result, those first that cost most.
inline constexpr std::size_t kMostNewRetests = 3;

/// Of the attempt's exercise, as it stands when that was finished. What is lost (again) is due in a week; what is shown
/// unaided when it is due waits longer, and is done with after the last of kRetestDays; what is not due, or is shown
/// with helps, or could not be measured, stays as it is.
[[nodiscard]] std::vector<school::Retest> nextRetests(std::vector<school::Retest> open, const school::Attempt& attempt,
                                                      const score::Assessment& result, bool isUnaided);

}  // namespace handpiece::course
