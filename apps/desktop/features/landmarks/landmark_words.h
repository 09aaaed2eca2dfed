// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Landmarks in the person's language.

#include <QString>
#include <string>

#include "handpiece/model/case/landmark.h"

namespace handpiece::desktop {

[[nodiscard]] QString kindText(cases::LandmarkKind kind);
[[nodiscard]] QString sourceText(cases::LandmarkSource source);
/// A landmark's name as the case has it, in the words known here.
[[nodiscard]] QString nameText(const std::string& name);
/// "Cusp tip, mesiobuccal".
[[nodiscard]] QString landmarkText(const cases::Landmark& mark);

}  // namespace handpiece::desktop
