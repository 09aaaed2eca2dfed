// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a session keeps of a tick, an event, a moment and of itself: plain data, as the file stores it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/messages/haptic_sample.h"
#include "handpiece/model/case/tissue.h"

namespace handpiece::session {

// Of the inputs: what the loop rounds them to.
using messages::kOrientationStep, messages::kPedalStep, messages::kPositionStepMm;
/// Stands for an input that was not finite or out of range; such ticks carry messages::kInvalidPose.
inline constexpr std::int32_t kNoNumber = std::numeric_limits<std::int32_t>::min();

/// One tick. The inputs (pose, pedal, buttons, elapsedPeriods) are exact; the rest is rounded to steps far below what a
/// hand can feel, so that it packs well: layout.h lists them.
struct Record {
    std::uint64_t tick = 0;
    std::uint64_t lastCommand = 0;  ///< newest staged command that has taken effect
    std::array<double, cases::kTissueCount> removedMm3{};
    double removedOthersMm3 = 0.0;              ///< of the teeth around the one worked on
    std::array<std::int32_t, 3> position{};     ///< of the bur's tip, in kPositionStepMm
    std::array<std::int32_t, 3> orientation{};  ///< x y z of the quaternion, bur in tooth, in kOrientationStep
    std::int32_t orientationW = 0;  ///< its w, by what it differs from sqrt(1 - x2 - y2 - z2): see wCodeOf()
    std::int32_t pedal = 0;         ///< in kPedalStep
    std::array<float, 3> velocityMmS{};
    std::array<float, 3> forceN{};
    std::array<float, 3> torqueNmm{};
    float depthMm = 0, speedRpm = 0, loadTorqueNmm = 0, feedMmS = 0;
    std::uint32_t buttons = 0, flags = 0;  ///< flags: messages::SampleFlag
    std::uint16_t elapsedPeriods = 1;
    std::uint8_t tissue = 0;  ///< cases::Tissue that carries most of the pressure
    std::uint8_t tooth = 0;   ///< that it is of: 0 the one worked on, else its number among those around it

    bool operator==(const Record&) const = default;
};
static_assert(std::is_trivially_copyable_v<Record> && std::is_standard_layout_v<Record>);

/// What the session keeps of a sample. Any thread; never allocates.
[[nodiscard]] Record recordOf(const messages::HapticSample& sample) noexcept;

/// w of a quaternion whose x, y, z are known, all in kOrientationStep, as a number that packs to nothing: twice the
/// amount by which |w| exceeds the root of 2^60 - x2 - y2 - z2 rounded down, plus one when w is negative. kNoNumber for
/// quaternions far from unit length.
[[nodiscard]] std::int32_t wCodeOf(const std::array<std::int32_t, 3>& xyz, std::int32_t w) noexcept;
[[nodiscard]] std::int32_t wOf(const std::array<std::int32_t, 3>& xyz, std::int32_t code) noexcept;

/// The inputs of a tick as the loop used them.
struct Inputs {
    std::array<double, 3> positionMm;   ///< NaN where the device gave no number
    std::array<double, 4> orientation;  ///< w x y z
    double pedal;
    std::uint32_t buttons;
};
[[nodiscard]] Inputs inputsOf(const Record& record) noexcept;

/// What is worth a name on the time axis.
enum class EventName : std::uint8_t {
    strokeBegin,
    strokeEnd,
    burChange,
    firstDentine,
    pulpExposure,
    neighbourTouched,
    stall,
    forceLimit,
    undo,
    redo,
    reset,
    parameterChange,
    fault,
    keyFrame,
    end,
    resume,      ///< after a pause or a crash: what follows was done by a new loop on the tooth of the key frame there
    scheduling,  ///< what real time the tick has from here on
    gingivaCut,
    headTouched,  ///< shank, head or handle met a tooth
    workingWay,   ///< from where, by mirror or not, with a finger rest or not: from here on
    neighbourCut  ///< the bur has taken something off a tooth beside the one worked on
};
inline constexpr std::size_t kEventNameCount = 21;
/// "stroke begin", as in the file.
[[nodiscard]] std::string_view nameOf(EventName name) noexcept;

struct Event {
    std::uint64_t tick = 0;
    std::string name;  ///< one of EventName's, or one of a later version's
    std::string text;  ///< what the event is about; UTF-8, may be long

    bool operator==(const Event&) const = default;
};

/// The cut state at a tick, as bytes that this room does not look into.
struct KeyFrame {
    std::uint64_t tick = 0;
    std::vector<std::byte> state;

    bool operator==(const KeyFrame&) const = default;
};

/// What holds for the whole session.
struct SessionInfo {
    double rateHz = 1000;
    std::string code;  ///< typed by the student; never a user's or a machine's name. Up to 32 letters, digits, - and _
    std::string version;               ///< of the program
    std::string settings;              ///< JSON: bur, parameters, all that a replay needs beside the tooth
    std::vector<std::byte> tooth;      ///< the tooth it is cut from (cases::encodeCase), or nothing
    std::vector<std::byte> scenery{};  ///< what stands around it (the parts of a cases::encodeCase), or nothing
    std::vector<std::byte> history{};  ///< strokes before it that can be undone, of a tooth that was cut before
    std::int32_t engineRevision = core::kEngineRevision;  ///< of the program that recorded its first tick
};

}  // namespace handpiece::session
