// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where the operator sits, as the hours of a clock about the head of a patient who lies on the back: what it makes of
/// the eye and of the handpiece. docs/working-positions.md has every figure with its source.

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "handpiece/base/core/vec.h"
#include "handpiece/model/case/case.h"
#include "handpiece/senses/view/camera.h"

namespace handpiece::input {

/// 12 behind the head, 3 at the patient's left ear, 9 at the right one. Of a right-handed operator 8 to 12, of a
/// left-handed one 12 to 4.
inline constexpr std::array<int, 5> kRightHandedHours = {8, 9, 10, 11, 12};
inline constexpr std::array<int, 5> kLeftHandedHours = {12, 1, 2, 3, 4};
[[nodiscard]] bool isOperatorsHour(int hour);
/// Throws core::Error naming `where` when it is none.
void requireOperatorsHour(int hour, const std::string& where = "position");
/// The same seat for the other hand: 9 for 3.
[[nodiscard]] constexpr int mirroredHour(int hour) {
    return hour == 12 ? 12 : 12 - hour;
}

/// How the head lies in the case: what turns directions of the mouth frame (dentition/arch.h: +x to the patient's left,
/// +y backwards, +z up) into those of the case. From all teeth of the upper jaw whose numbers are known, else from
/// those of the lower one, taken as opened by 40 mm; nothing where no tooth has a number.
[[nodiscard]] std::optional<core::Quat> headInCase(const cases::Case& toothCase);

/// Where things fall, with the patient on the back and the head tilted for the arch of the case's own tooth: a unit
/// direction in the frame of the case. -z where it is not known how the head lies.
[[nodiscard]] core::Vec3 downInCase(const cases::Case& toothCase);

/// Unit directions in the frame of the case.
struct WorkingPosition {
    core::Vec3 toEye;   ///< from the tooth
    core::Vec3 up;      ///< of what is seen: away from the operator
    core::Vec3 toHand;  ///< from the tooth: out of the mouth and towards the operator
};
/// The head is tilted for the arch that is worked on. Throws core::Error for what is no hour of an operator.
[[nodiscard]] WorkingPosition workingPosition(const core::Quat& headInCase, bool isUpper, int hour);
/// The eye there, such that `bounds` fills the picture.
[[nodiscard]] view::Camera seenFrom(const WorkingPosition& position, const core::Box& bounds,
                                    const view::Viewport& viewport);
/// The bur's orientation turned about its axis, so that its handle points to the hand as nearly as can be.
[[nodiscard]] core::Quat handleTowards(const core::Quat& burInTooth, const core::Vec3& toHand);

/// Where a finger finds support: the highest place of the nearest other tooth of the same arch, nothing where there is
/// none.
[[nodiscard]] std::optional<core::Vec3> fingerRest(const cases::Case& toothCase);

/// From which a tooth is worked on; occlusal: of a front tooth its incisal edge, and what is beside an adjacent tooth.
enum class Surface { occlusal, buccal, lingual };
inline constexpr std::array<std::string_view, 3> kSurfaces = {"occlusal", "buccal", "lingual"};

/// Where one usually sits for a surface of a tooth, and whether one sees it then or needs a mirror: habits of teaching,
/// recalled from textbooks, no rule.
struct UsualPosition {
    int hour;
    bool byMirror;
};
/// Throws core::Error for what is no permanent tooth.
[[nodiscard]] UsualPosition usualPosition(int fdiNumber, Surface surface, bool isLeftHanded);

}  // namespace handpiece::input
