// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What exercises and rubrics say, in the person's language.

#include <QString>

#include "handpiece/model/case/exercise.h"

namespace handpiece::desktop {

[[nodiscard]] QString inThisLanguage(const cases::Texts& texts);

}  // namespace handpiece::desktop
