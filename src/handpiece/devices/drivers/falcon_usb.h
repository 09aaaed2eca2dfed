// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What goes over a Falcon's cable: a serial chip (FTDI) that carries sixteen letters there and sixteen back. As open
/// source drivers describe it; unchecked on hardware.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "handpiece/base/core/realtime.h"
#include "handpiece/devices/link/shared_library.h"

namespace handpiece::drivers::falcon {

/// What the device tells in a frame.
struct Report {
    std::array<int, 3> counts{};  ///< encoders: top, right, left arm
    unsigned buttons = 0;         ///< bits: right, front, middle, left
    unsigned homed = 0;           ///< bits of the arms whose encoder has found its zero
};
enum Light : unsigned { kGreen = 2, kBlue = 4, kRed = 8 };
inline constexpr unsigned kAllHomed = 7;
inline constexpr int kMaxMotor = 4096;  ///< of the numbers sent to the motors; recalled, unchecked

using Frame = std::array<std::uint8_t, 16>;
/// '<', four letters a motor, lights and homing, one letter that means nothing, '>'. A letter is 'A' plus a number.
[[nodiscard]] Frame encode(const std::array<int, 3>& motors, unsigned lights, bool homing) noexcept HANDPIECE_REALTIME;
/// False when `frame` is none.
[[nodiscard]] bool decode(const Frame& frame, Report& report) noexcept HANDPIECE_REALTIME;

/// Finds frames in what arrives, wherever it was cut.
class FrameReader {
  public:
    /// True when a frame ended in `bytes`; the newest is in `report`.
    bool take(std::span<const std::uint8_t> bytes, Report& report) noexcept HANDPIECE_REALTIME;
    void clear() noexcept { filled_ = 0; }
    [[nodiscard]] std::uint64_t spoilt() const noexcept { return spoilt_; }  ///< frames that could not be read

  private:
    Frame frame_{};
    std::size_t filled_ = 0;
    std::uint64_t spoilt_ = 0;
};

/// Error numbers of libusb that are told apart.
enum UsbCode : int { kIo = -1, kAccess = -3, kGone = -4, kBusy = -6, kTimedOut = -7, kPipe = -9 };

/// libusb, by our own declarations.
struct Usb {
    struct Context;
    struct Device;
    struct Handle;
    struct Descriptor {  // of USB itself
        std::uint8_t length, kind;
        std::uint16_t usb;
        std::uint8_t deviceClass, subclass, protocol, packet;
        std::uint16_t vendor, product, release;
        std::uint8_t makerText, productText, serialText, configurations;
    };
    /// Throws core::Error: missing, or without a function that is needed.
    Usb();

    link::SharedLibrary file;
    int (*init)(Context** context) = nullptr;
    void (*exit)(Context* context) = nullptr;
    std::ptrdiff_t (*list)(Context* context, Device*** devices) = nullptr;
    void (*freeList)(Device** devices, int unreference) = nullptr;
    int (*descriptor)(Device* device, Descriptor* descriptor) = nullptr;
    int (*open)(Device* device, Handle** handle) = nullptr;
    void (*close)(Handle* handle) = nullptr;
    int (*claim)(Handle* handle, int interface) = nullptr;
    int (*release)(Handle* handle, int interface) = nullptr;
    int (*detach)(Handle* handle, int enable) = nullptr;  // may be missing
    int (*text)(Handle* handle, std::uint8_t index, unsigned char* data, int length) = nullptr;
    int (*control)(Handle* handle, std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
                   unsigned char* data, std::uint16_t length, unsigned timeoutMs) = nullptr;
    int (*bulk)(Handle* handle, unsigned char endpoint, unsigned char* data, int length, int* transferred,
                unsigned timeoutMs) = nullptr;
};
[[nodiscard]] std::shared_ptr<const Usb> usb();

/// How many Falcons are plugged in. Throws core::Error.
[[nodiscard]] int countFalcons(const Usb& usb);

/// A Falcon whose interface is claimed. One thread at a time.
class Connection {
  public:
    /// `which`: a serial number, a number from 1, or empty: the first that is free. Throws core::Error.
    Connection(std::shared_ptr<const Usb> usb, const std::string& which);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    [[nodiscard]] const std::string& serial() const noexcept { return serial_; }
    /// Speed and buffers for frames. Throws core::Error.
    void setFrames();
    /// True when it answers frames within `seconds`: then its firmware is loaded. Throws core::Error when it is gone.
    [[nodiscard]] bool answers(double seconds);
    /// Throws core::Error when the device does not take it.
    void upload(std::span<const std::byte> firmware);

    /// 0, or libusb's error. Waits no longer than a few milliseconds.
    int write(const Frame& frame) noexcept;
    /// 0 when a frame came within `forNs`; kTimedOut; libusb's error.
    int read(Report& report, std::int64_t forNs) noexcept;
    [[nodiscard]] std::uint64_t spoilt() const noexcept { return reader_.spoilt(); }

  private:
    void close() noexcept;
    void tell(std::uint8_t request, std::uint16_t value, const char* what);
    [[nodiscard]] std::vector<std::uint8_t> ask(std::span<const std::uint8_t> bytes, std::size_t wanted);
    bool tryUpload(std::span<const std::byte> firmware);

    std::shared_ptr<const Usb> usb_;
    Usb::Context* context_ = nullptr;
    Usb::Handle* handle_ = nullptr;
    bool claimed_ = false;
    std::string serial_;
    FrameReader reader_;
};

/// What one of libusb's numbers means and what to do, two sentences.
[[nodiscard]] std::string usbErrorInWords(int code);

}  // namespace handpiece::drivers::falcon
