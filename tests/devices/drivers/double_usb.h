// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What a test says to the double of libusb (double_usb.cpp), which has Falcons plugged in: dlsym "doubleUsb" gives a
/// function that returns it. With HANDPIECE_USB_DOUBLE set it begins with one, its grip in the middle.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace handpiece::doubles {

struct FalconMade {
    std::string serial;
    bool firmware = true;  ///< loaded already
    int refusals = 0;      ///< how often it does not take its firmware before it does
};

struct FalconSent {
    std::array<int, 3> motors{};
    unsigned lights = 0;
    bool homing = false;
    std::uint64_t count = 0;
};

class UsbDouble {
  public:
    virtual ~UsbDouble() = default;
    /// These Falcons and one other device, homed, closed. Waits up to ten seconds until calls have ended and everything
    /// is closed; false when something stayed open.
    virtual bool reset(const std::vector<FalconMade>& falcons) = 0;
    virtual void encoders(int falcon, const std::array<int, 3>& counts) = 0;
    virtual void press(int falcon, unsigned mask) = 0;
    virtual void home(int falcon, unsigned arms) = 0;  ///< bits of arms that have found their zero
    [[nodiscard]] virtual FalconSent sent(int falcon) = 0;
    virtual void unplug(int falcon) = 0;
    virtual void stall(int falcon, double seconds) = 0;
    virtual void raise(int falcon, int code) = 0;      ///< reading fails with it; 0 ends it
    virtual void garble(int falcon, bool on) = 0;      ///< letters that are none
    virtual void openFails(int falcon, int code) = 0;  ///< 0: it can be opened
    virtual void claimFails(int falcon, int code) = 0;
    [[nodiscard]] virtual std::vector<std::uint8_t> uploaded(int falcon) = 0;
    [[nodiscard]] virtual unsigned breaches() = 0;
    [[nodiscard]] virtual std::string lastBreach() = 0;
};

}  // namespace handpiece::doubles
