// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The functions of Force Dimension's library that are used, by our own declarations, and what its numbers mean.
/// Names, order and numbers: the public documentation of DHD 3.x and open-source callers of it. Unchecked on hardware.

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "handpiece/devices/link/driver.h"
#include "handpiece/devices/link/shared_library.h"

namespace handpiece::drivers::dhd {

/// Error numbers of dhdErrorGetLast(), counted up from 0 in this order.
enum Code : int {
    kNoError,
    kError,
    kCommunication,
    kBusy,
    kNoDriver,
    kNoDevice,
    kNotAvailable,
    kTimeout,
    kGeometry,
    kExpertOff,
    kNotImplemented,
    kOutOfMemory,
    kNotReady,
    kFileNotFound,
    kConfiguration,
    kInvalidIndex,
    kDeprecated,
    kNullArgument,
    kRedundantFail,
    kNotEnabled,
    kInUse,
    kInvalid,
};
/// Our own codes beside them, for why the controller switched its force off: kForceOff + cause 1..6.
inline constexpr int kForceOff = 100;
inline constexpr int kCauseButton = 1, kCauseVelocity = 2, kCauseWatchdog = 3, kCauseUnplugged = 5, kCauseDeadMan = 6;

/// Places in dhdGetStatus().
inline constexpr int kStatusCount = 16, kStatusReset = 3, kStatusForce = 5, kStatusForceOffCause = 14;

/// dhdGetSystemType().
inline constexpr int kTypeFalcon = 60;

/// The library. One for the process: it holds its devices by number.
class Library {
  public:
    /// Throws core::Error: missing, or a version without the functions that are needed. The newest of what it may be:
    /// libdrd holds everything of libdhd and the automatic calibration.
    Library();

    /// "3.17.6", or empty.
    [[nodiscard]] std::string version() const;
    /// Text of the calling thread's last error.
    [[nodiscard]] std::string lastError() const;
    [[nodiscard]] bool autoCalibrates() const noexcept {
        return drdOpenID && drdClose && drdIsInitialized && drdAutoInit;
    }

    link::SharedLibrary file;
    // A `char` names the device; where the library takes a bool or an unsigned char an int does as well.
    int (*dhdGetDeviceCount)() = nullptr;
    int (*dhdGetAvailableCount)() = nullptr;
    int (*dhdOpenID)(char index) = nullptr;
    int (*dhdClose)(char id) = nullptr;
    int (*dhdStop)(char id) = nullptr;
    int (*dhdEnableForce)(int on, char id) = nullptr;
    int (*dhdGetSystemType)(char id) = nullptr;
    const char* (*dhdGetSystemName)(char id) = nullptr;
    int (*dhdGetSerialNumber)(unsigned short* number, char id) = nullptr;
    int (*dhdGetVersion)(double* version, char id) = nullptr;
    void (*dhdGetSDKVersion)(int* major, int* minor, int* release, int* revision) = nullptr;
    int (*dhdGetStatus)(int* status, char id) = nullptr;
    unsigned (*dhdGetButtonMask)(char id) = nullptr;
    int (*dhdGetButton)(int index, char id) = nullptr;
    bool (*dhdHasWrist)(char id) = nullptr;
    bool (*dhdHasActiveWrist)(char id) = nullptr;
    bool (*dhdIsLeftHanded)(char id) = nullptr;
    int (*dhdGetPosition)(double* x, double* y, double* z, char id) = nullptr;
    int (*dhdGetPositionAndOrientationFrame)(double* x, double* y, double* z, double (*frame)[3], char id) = nullptr;
    int (*dhdSetForce)(double x, double y, double z, char id) = nullptr;
    int (*dhdSetForceAndTorqueAndGripperForce)(double fx, double fy, double fz, double tx, double ty, double tz,
                                               double gripper, char id) = nullptr;
    int (*dhdErrorGetLast)() = nullptr;
    const char* (*dhdErrorGetLastStr)() = nullptr;
    int (*drdOpenID)(char index) = nullptr;
    int (*drdClose)(char id) = nullptr;
    bool (*drdIsInitialized)(char id) = nullptr;
    int (*drdAutoInit)(char id) = nullptr;

    /// Devices that this program has open, by their place in the library's list: opening one again would give the same
    /// number, closing that would close it for both.
    struct Device {
        char id = -1;
        int type = 0;
        std::string name, serial;
    };
    std::mutex mutex;
    std::map<int, Device> open;
};

/// The library, loaded at the first call that finds it. Throws core::Error like its constructor.
[[nodiscard]] std::shared_ptr<Library> library();

/// What an error number means and what to do, one sentence each; also for kForceOff + cause.
struct Words {
    std::string_view sentence, remedy;
};
[[nodiscard]] Words wordsOf(int code) noexcept;

/// A kind of device by its number. Figures: docs/devices/forcedimension.md says where each comes from.
struct Model {
    int type;
    const char* name;
    bool wrist, activeWrist;
    double maxForceN, continuousForceN, maxStiffnessNPerMm, maxDampingNSPerMm, radiusMm, maxTorqueNmm, encoderStepMm;
};
/// Null for a number that is not known.
[[nodiscard]] const Model* modelOf(int type) noexcept;
[[nodiscard]] device::Capability capabilityOf(const Model& model);

}  // namespace handpiece::drivers::dhd
