// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The HD interface of OpenHaptics, declared by ourselves from its documented names, types and values; and the one
/// library of a program.

#include <cstdint>
#include <string>

#include "handpiece/devices/link/driver.h"
#include "handpiece/devices/link/shared_library.h"

#ifdef _WIN32
#define HANDPIECE_HD_CALL __stdcall
#else
#define HANDPIECE_HD_CALL
#endif

namespace handpiece::drivers::hd {

using Handle = unsigned int;
using Boolean = unsigned char;
using Job = unsigned long;  // 8 bytes on Linux, 4 on Windows, as the vendor's own
using Callback = unsigned int(HANDPIECE_HD_CALL*)(void*);

inline constexpr Handle kNoDevice = 0xFFFFFFFF;
inline constexpr unsigned kDone = 0, kContinue = 1;  // what a callback answers
inline constexpr unsigned short kPriority = 32767;

struct ErrorInfo {
    unsigned code;
    int internalCode;
    Handle device;
};

enum Parameter : unsigned {
    kButtons = 0x2000,
    kSafetySwitch = 0x2001,
    kInkwellSwitch = 0x2002,
    kTransform = 0x2052,
    kVersion = 0x2500,
    kModel = 0x2501,
    kDriverVersion = 0x2502,
    kSerial = 0x2504,
    kFirmware = 0x2505,
    kUsableWorkspace = 0x2551,
    kInputAxes = 0x2553,
    kOutputAxes = 0x2554,
    kCalibrationStyle = 0x2555,
    kUpdateRate = 0x2600,
    kNominalMaxStiffness = 0x2602,
    kNominalMaxForce = 0x2603,
    kNominalContinuousForce = 0x2604,
    kMotorTemperature = 0x2605,
    kForce = 0x2700,
    kTorque = 0x2701,
    kForceOutput = 0x4000,
    kForceClamping = 0x4001,
    kForceRamping = 0x4002,
    kSoftwareForceLimit = 0x4003,
};
enum CalibrationAnswer : unsigned { kCalibrated = 0x5000, kNeedsUpdate = 0x5001, kNeedsHand = 0x5002 };
enum Style : int { kEncoderReset = 1, kAuto = 2, kInkwell = 4 };
enum Code : unsigned {
    kSuccess = 0,
    kInvalidEnum = 0x0100,
    kInvalidValue = 0x0101,
    kInvalidOperation = 0x0102,
    kInvalidInputType = 0x0103,
    kBadHandle = 0x0104,
    kWarmMotors = 0x0200,
    kExceededMaxForce = 0x0201,
    kExceededForceImpulse = 0x0202,
    kExceededVelocity = 0x0203,
    kForceError = 0x0204,
    kDeviceFault = 0x0300,
    kAlreadyInitiated = 0x0301,
    kCommError = 0x0302,
    kCommConfigError = 0x0303,
    kTimerError = 0x0304,
    kIllegalBegin = 0x0400,
    kIllegalEnd = 0x0401,
    kFrameError = 0x0402,
    kInvalidPriority = 0x0500,
    kSchedulerFull = 0x0501,
    kInvalidLicence = 0x0600,
};

/// How much an error weighs when a frame tells it.
enum class Weight : std::uint8_t {
    note,   ///< told, and the force goes on
    frame,  ///< this frame is not to be trusted
    fatal,  ///< the device is not used again until it is opened anew
};
struct ErrorWords {
    unsigned code;
    Weight weight;
    link::DeviceFault trouble;  ///< of a frame that tells it
    const char* sentence;
    const char* remedy;
};
/// Codes that nobody knows are fatal.
[[nodiscard]] const ErrorWords& wordsOf(unsigned code) noexcept;

/// The functions that are used, of the 36 there are.
struct Library {
    Handle(HANDPIECE_HD_CALL* initDevice)(const char*) = nullptr;
    void(HANDPIECE_HD_CALL* disableDevice)(Handle) = nullptr;
    void(HANDPIECE_HD_CALL* makeCurrent)(Handle) = nullptr;
    void(HANDPIECE_HD_CALL* beginFrame)(Handle) = nullptr;
    void(HANDPIECE_HD_CALL* endFrame)(Handle) = nullptr;
    ErrorInfo(HANDPIECE_HD_CALL* getError)() = nullptr;
    void(HANDPIECE_HD_CALL* enable)(unsigned) = nullptr;
    void(HANDPIECE_HD_CALL* disable)(unsigned) = nullptr;
    void(HANDPIECE_HD_CALL* getBoolean)(unsigned, Boolean*) = nullptr;
    void(HANDPIECE_HD_CALL* getInteger)(unsigned, int*) = nullptr;
    void(HANDPIECE_HD_CALL* getDouble)(unsigned, double*) = nullptr;
    const char*(HANDPIECE_HD_CALL* getString)(unsigned) = nullptr;
    void(HANDPIECE_HD_CALL* setDouble)(unsigned, const double*) = nullptr;
    unsigned(HANDPIECE_HD_CALL* checkCalibration)() = nullptr;
    void(HANDPIECE_HD_CALL* updateCalibration)(unsigned) = nullptr;
    void(HANDPIECE_HD_CALL* startScheduler)() = nullptr;
    void(HANDPIECE_HD_CALL* stopScheduler)() = nullptr;
    void(HANDPIECE_HD_CALL* setSchedulerRate)(unsigned long) = nullptr;
    Job(HANDPIECE_HD_CALL* scheduleAsynchronous)(Callback, void*, unsigned short) = nullptr;
    void(HANDPIECE_HD_CALL* unschedule)(Job) = nullptr;
    std::string path;  ///< where it was loaded from

    /// Empties the stack of errors and gives the one that weighs most; the newest of equals.
    [[nodiscard]] unsigned drain() const noexcept;
};

/// Loads it at the first call and gives the same one ever after. Throws core::Error: "library-missing",
/// "library-wrong", "two-libraries".
[[nodiscard]] const Library& library();

}  // namespace handpiece::drivers::hd
