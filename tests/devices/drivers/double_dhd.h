// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a test says to the double of Force Dimension's library (double_dhd.cpp): dlsym "doubleDhd" gives a function
/// that returns it. With HANDPIECE_DHD_DOUBLE set it begins with one omega.6 whose hand goes round, for programs that
/// cannot speak to it. Everything here is in the library's own frame and units.

#include <cstdint>
#include <string>
#include <vector>

namespace handpiece::doubles {

struct DhdArm {
    int type = 33;
    std::string name = "omega.3";
    unsigned short serial = 0;
    bool wrist = false, activeWrist = false, leftHanded = false;
};

struct DhdSent {
    double forceN[3] = {}, torqueNm[3] = {}, gripperN = 0;
    std::uint64_t count = 0;
    bool motorsOn = false;
};

class DhdDouble {
  public:
    virtual ~DhdDouble() = default;
    /// These arms, plugged in, calibrated, closed; the hand at the origin and held there. Waits up to ten seconds until
    /// calls under way have ended and everything is closed; false when something stayed open.
    virtual bool reset(const std::vector<DhdArm>& arms) = 0;
    virtual void move(int arm, const double (&positionM)[3], const double (&frame)[3][3]) = 0;
    /// From here on the hand is a mass on a spring whose other end runs round a circle in the y-z plane.
    virtual void swing(int arm, double massKg, double stiffnessNPerM, double radiusM, double hz) = 0;
    virtual void press(int arm, unsigned mask) = 0;
    [[nodiscard]] virtual DhdSent sent(int arm) = 0;
    virtual void unplug(int arm) = 0;
    virtual void stall(int arm, double seconds) = 0;  ///< every call for the arm takes that long from now
    virtual void raise(int arm, int code) = 0;        ///< positions cannot be read; 0 ends it
    virtual void initialise(int arm, bool done) = 0;
    virtual void forceOff(int arm, int cause) = 0;  ///< the controller switches its force off
    virtual void takenElsewhere(int arm) = 0;       ///< another program has it open
    virtual void failNext(const std::string& function, int code) = 0;
    [[nodiscard]] virtual unsigned breaches() = 0;
    [[nodiscard]] virtual std::string lastBreach() = 0;
};

}  // namespace handpiece::doubles
