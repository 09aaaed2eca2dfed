// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a test may do to the double of the HD library (double_hd.cpp), beside what the library itself exports. Names
/// are looked up at run time: the double is loaded as the real one would be.
///
/// From outside, by the environment, read when a device is initialised:
///   HANDPIECE_HD_DOUBLE_SCRIPT   FILE.csv: t_s,x_mm,y_mm,z_mm[,qw,qx,qy,qz],buttons in the device frame. The hand is
///   then
///                                a mass on a spring that follows the path, so that force moves it. t counts frames.
///   HANDPIECE_HD_DOUBLE_FAULTS   "unplug@2;stall@3:0.2;error@1=0x0204;kill@4", seconds as above
///   HANDPIECE_HD_DOUBLE_MODEL    "Touch" (default), "Touch X", "PHANTOM Omni", "PHANTOM Premium 1.5 6DOF"
///   HANDPIECE_HD_DOUBLE_INIT     code that hdInitDevice fails with ("0x0600")
///   HANDPIECE_HD_DOUBLE_LOG      FILE.csv: where the hand was and what pushed it, frame by frame, and the breaches

extern "C" {
/// A healthy double with so many devices ("Default Device", "Second Device", ...), calibrated, hands held at the
/// origin, counters at zero. Waits for what is still open to be closed.
using DoubleReset = void(int devices, const char* model);
/// x y z [mm], w x y z. The hand is there at once, or its spring pulls there.
using DoubleMove = void(int device, const double* pose);
using DoubleSprung = void(int device, int yes);
using DoublePress = void(int device, unsigned buttons);
/// 3 N, 3 N mm: on the motors now. Answers how often a frame set them.
using DoubleForce = unsigned long long(int device, double* out);
using DoubleUnplug = void(int device);
/// hdBeginFrame of this device returns so much later, once.
/// A stall ends with double_wake at the latest.
using DoubleWake = void();
using DoubleStall = void(int device, double seconds);
/// Errors on the stack: `times` of them (below 0: in every frame), at the end of a frame or at its beginning.
using DoubleError = void(int device, unsigned code, int atEnd, int times);
/// style: a sum of 1 encoder reset, 2 automatic, 4 inkwell; answer of hdCheckCalibration.
using DoubleCalibration = void(int device, int style, unsigned answer);
/// 0 out, 1 in; the safety switch likewise; both below 0: the model has none.
using DoubleSwitches = void(int device, int inkwell, int safety);
/// Of the hottest motor; below 0: the model does not tell.
using DoubleTemperature = void(int device, double value);
using DoubleInitError = void(unsigned code);
/// The scheduler's thread ends as if it had crashed.
using DoubleKill = void();
using DoubleCount = unsigned();
using DoubleText = const char*();
}
