// SPDX-License-Identifier: Apache-2.0
/// @file
/// A double of libusb with Falcons on the bus: the serial chip's requests, the boot program that takes the firmware,
/// and the frames that the firmware speaks. Answers come cut in pieces, as the chip sends them. Breaches are counted.

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <mutex>

#include "devices/drivers/double_usb.h"

#define EXPORT extern "C" __attribute__((visibility("default")))

namespace {

using Clock = std::chrono::steady_clock;
using handpiece::doubles::FalconMade;
using handpiece::doubles::FalconSent;
using handpiece::doubles::UsbDouble;

enum : int { kAccess = -3, kGone = -4, kBusy = -6, kTimedOut = -7, kPipe = -9 };
enum class Boot { none, hailed, taking };

struct Falcon {
    FalconMade made;
    bool plugged = true, claimed = false, garbled = false, loaded = true, dtr = false;
    int handles = 0, raised = 0, openCode = 0, claimCode = 0, speed = 0;
    Boot boot = Boot::none;
    std::array<int, 3> counts{};
    unsigned buttons = 0, homed = 7;
    FalconSent sent;
    std::deque<std::uint8_t> answer;
    std::vector<std::uint8_t> firmware;
    Clock::time_point stallUntil;
    int cut = 0;
};

struct Device {
    int falcon = -1;  // -1: something else on the bus
};
struct Handle {
    int falcon = -1;
    bool claimed = false;
};

class Double final : public UsbDouble {
  public:
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<Falcon> falcons;
    std::vector<Device> devices;
    int inside = 0, contexts = 0;
    unsigned breachCount = 0;
    std::string breach;

    void wrong(const char* what) {
        ++breachCount;
        breach = what;
    }
    Falcon& at(int falcon) { return falcons.at(static_cast<std::size_t>(falcon)); }

    bool reset(const std::vector<FalconMade>& wanted) override {
        std::unique_lock lock(mutex);
        for (Falcon& falcon : falcons)
            falcon.stallUntil = {};
        changed.notify_all();
        const bool ended = changed.wait_for(lock, std::chrono::seconds(10), [&] {
            return inside == 0 && contexts == 0 &&
                   std::all_of(falcons.begin(), falcons.end(), [](const Falcon& f) { return f.handles == 0; });
        });
        falcons.clear();
        devices.assign(1, Device{});
        for (const FalconMade& made : wanted) {
            devices.push_back({static_cast<int>(falcons.size())});
            falcons.emplace_back();
            falcons.back().made = made;
            falcons.back().loaded = made.firmware;
        }
        breachCount = 0;
        breach.clear();
        return ended;
    }
    void encoders(int falcon, const std::array<int, 3>& counts) override {
        const std::lock_guard lock(mutex);
        at(falcon).counts = counts;
    }
    void press(int falcon, unsigned mask) override {
        const std::lock_guard lock(mutex);
        at(falcon).buttons = mask;
    }
    void home(int falcon, unsigned arms) override {
        const std::lock_guard lock(mutex);
        at(falcon).homed = arms;
    }
    FalconSent sent(int falcon) override {
        const std::lock_guard lock(mutex);
        return at(falcon).sent;
    }
    void unplug(int falcon) override {
        const std::lock_guard lock(mutex);
        at(falcon).plugged = false;
        at(falcon).sent.motors = {};
    }
    void stall(int falcon, double seconds) override {
        const std::lock_guard lock(mutex);
        at(falcon).stallUntil =
            Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    }
    void raise(int falcon, int code) override {
        const std::lock_guard lock(mutex);
        at(falcon).raised = code;
    }
    void garble(int falcon, bool on) override {
        const std::lock_guard lock(mutex);
        at(falcon).garbled = on;
    }
    void openFails(int falcon, int code) override {
        const std::lock_guard lock(mutex);
        at(falcon).openCode = code;
    }
    void claimFails(int falcon, int code) override {
        const std::lock_guard lock(mutex);
        at(falcon).claimCode = code;
    }
    std::vector<std::uint8_t> uploaded(int falcon) override {
        const std::lock_guard lock(mutex);
        return at(falcon).firmware;
    }
    unsigned breaches() override {
        const std::lock_guard lock(mutex);
        return breachCount;
    }
    std::string lastBreach() override {
        const std::lock_guard lock(mutex);
        return breach;
    }

    /// What the serial chip hands on to the device.
    void arrives(Falcon& falcon, const std::uint8_t* bytes, int length) {
        constexpr int kBootSpeed = 0x4138, kUploadSpeed = 0x15, kFrameSpeed = 2;
        if (falcon.speed == kBootSpeed && falcon.dtr && length == 3 && std::memcmp(bytes, "\x0a\x43\x0d", 3) == 0) {
            if (falcon.made.refusals > 0) {
                --falcon.made.refusals;
                falcon.answer.push_back(0x3f);
                return;
            }
            for (const std::uint8_t byte : {0x00, 0x0a, 0x44, 0x2c, 0x0d})
                falcon.answer.push_back(byte);
            falcon.boot = Boot::hailed;
            falcon.loaded = false;
        } else if (falcon.speed == kUploadSpeed && falcon.boot == Boot::hailed && !falcon.dtr && length == 1 &&
                   *bytes == 'A') {
            falcon.answer.push_back('A');
            falcon.boot = Boot::taking;
            falcon.firmware.clear();
        } else if (falcon.speed == kUploadSpeed && falcon.boot == Boot::taking) {
            falcon.firmware.insert(falcon.firmware.end(), bytes, bytes + length);
            falcon.answer.insert(falcon.answer.end(), bytes, bytes + length);
        } else if (falcon.speed == kFrameSpeed) {
            if (falcon.loaded) frame(falcon, bytes, length);
        } else {
            wrong("bytes that neither boot program nor firmware knows");
        }
    }
    void frame(Falcon& falcon, const std::uint8_t* bytes, int length) {
        if (length != 16 || bytes[0] != '<' || bytes[15] != '>') return wrong("no frame of sixteen letters");
        for (int motor = 0; motor < 3; ++motor) {
            unsigned bits = 0;
            for (int i = 3; i >= 0; --i)
                bits = bits * 16 + static_cast<unsigned>(bytes[1 + 4 * motor + i] - 'A');
            const int value = static_cast<std::int16_t>(bits);
            if (std::abs(value) > 4096) wrong("a motor beyond its end");
            falcon.sent.motors[static_cast<std::size_t>(motor)] = value;
        }
        const auto state = static_cast<unsigned>(bytes[13] - 'A');
        falcon.sent.lights = state & 0xe;
        falcon.sent.homing = (state & 1) != 0;
        ++falcon.sent.count;
        falcon.answer.push_back('<');
        for (const int count : falcon.counts)
            for (int i = 0; i < 4; ++i)
                falcon.answer.push_back(static_cast<std::uint8_t>(
                    (falcon.garbled ? 'a' : 'A') + ((static_cast<std::uint16_t>(count) >> (4 * i)) & 0xf)));
        falcon.answer.push_back(static_cast<std::uint8_t>('A' + (falcon.buttons & 0xf) + (falcon.homed << 4)));
        falcon.answer.push_back('A');
        falcon.answer.push_back('>');
    }
};

Double& state() {
    static auto* const one = [] {
        auto* made = new Double;
        made->devices.assign(1, Device{});
        if (std::getenv("HANDPIECE_USB_DOUBLE")) {
            made->devices.push_back({0});
            made->falcons.emplace_back();
            made->falcons.back().made.serial = "F1";
            made->falcons.back().counts = {-345, -345, -345};
        }
        return made;
    }();
    return *one;
}

class Call {
  public:
    explicit Call(Handle* handle) : lock_(state().mutex) {
        Double& all = state();
        ++all.inside;
        falcon_ = &all.at(handle->falcon);
        all.changed.wait(lock_, [&] {
            const auto until = falcon_->stallUntil;
            if (Clock::now() >= until) return true;
            all.changed.wait_until(lock_, until);
            return Clock::now() >= falcon_->stallUntil;
        });
        if (!handle->claimed) all.wrong("a transfer before the interface was claimed");
    }
    ~Call() {
        --state().inside;
        state().changed.notify_all();
    }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;
    Falcon* operator->() const { return falcon_; }
    Falcon& operator*() const { return *falcon_; }
    void wait(std::chrono::microseconds time) {
        state().changed.wait_for(lock_, time, [] { return false; });
    }

  private:
    std::unique_lock<std::mutex> lock_;
    Falcon* falcon_ = nullptr;
};

}  // namespace

EXPORT UsbDouble* doubleUsb() {
    return &state();
}

EXPORT int libusb_init(void** context) {
    const std::lock_guard lock(state().mutex);
    ++state().contexts;
    *context = &state();
    return 0;
}
EXPORT void libusb_exit(void*) {
    const std::lock_guard lock(state().mutex);
    if (--state().contexts < 0) state().wrong("a context left twice");
    state().changed.notify_all();
}
EXPORT std::ptrdiff_t libusb_get_device_list(void*, Device*** list) {
    const std::lock_guard lock(state().mutex);
    auto** all = new Device*[state().devices.size() + 1]();
    std::ptrdiff_t count = 0;
    for (Device& device : state().devices)
        if (device.falcon < 0 || state().at(device.falcon).plugged) all[count++] = &device;
    *list = all;
    return count;
}
EXPORT void libusb_free_device_list(Device** list, int) {
    delete[] list;
}
EXPORT int libusb_get_device_descriptor(Device* device, void* to) {
    const std::uint16_t vendor = device->falcon < 0 ? 0x1d6b : 0x0403, product = device->falcon < 0 ? 2 : 0xcb48;
    std::uint8_t bytes[18] = {18, 1, 0, 2, 0, 0, 0, 64};
    std::memcpy(bytes + 8, &vendor, 2);
    std::memcpy(bytes + 10, &product, 2);
    bytes[16] = device->falcon < 0 ? 0 : 3;
    bytes[17] = 1;
    std::memcpy(to, bytes, sizeof bytes);
    return 0;
}
EXPORT int libusb_open(Device* device, Handle** handle) {
    const std::lock_guard lock(state().mutex);
    if (device->falcon < 0) return kAccess;
    Falcon& falcon = state().at(device->falcon);
    if (falcon.openCode != 0) return falcon.openCode;
    if (!falcon.plugged) return kGone;
    ++falcon.handles;
    *handle = new Handle{device->falcon, false};
    return 0;
}
EXPORT void libusb_close(Handle* handle) {
    const std::lock_guard lock(state().mutex);
    Falcon& falcon = state().at(handle->falcon);
    if (handle->claimed) state().wrong("closed without releasing the interface");
    --falcon.handles;
    delete handle;
    state().changed.notify_all();
}
EXPORT int libusb_claim_interface(Handle* handle, int interface) {
    const std::lock_guard lock(state().mutex);
    Falcon& falcon = state().at(handle->falcon);
    if (interface != 0) state().wrong("an interface that is not there");
    if (falcon.claimCode != 0) return falcon.claimCode;
    if (falcon.claimed) return kBusy;
    falcon.claimed = handle->claimed = true;
    return 0;
}
EXPORT int libusb_release_interface(Handle* handle, int) {
    const std::lock_guard lock(state().mutex);
    Falcon& falcon = state().at(handle->falcon);
    if (falcon.sent.motors != std::array<int, 3>{}) state().wrong("left with its motors on");
    falcon.claimed = handle->claimed = false;
    return 0;
}
EXPORT int libusb_get_string_descriptor_ascii(Handle* handle, std::uint8_t index, unsigned char* data, int length) {
    const std::lock_guard lock(state().mutex);
    const std::string& serial = state().at(handle->falcon).made.serial;
    if (index != 3) return kPipe;
    const int count = std::min(length, static_cast<int>(serial.size()));
    std::memcpy(data, serial.data(), static_cast<std::size_t>(count));
    return count;
}
EXPORT int libusb_control_transfer(Handle* handle, std::uint8_t type, std::uint8_t request, std::uint16_t value,
                                   std::uint16_t, unsigned char*, std::uint16_t, unsigned) {
    const Call call(handle);
    if (!call->plugged) return kGone;
    if (type != 0x40) return kPipe;
    switch (request) {
        case 0:
            call->answer.clear();
            break;
        case 1:
            if (value >> 8 & 1) call->dtr = (value & 1) != 0;
            break;
        case 3:
            // From upload to frames: the device begins to run what it was given.
            if (value == 2 && call->boot == Boot::taking) {
                call->boot = Boot::none;
                call->loaded = !call->firmware.empty();
            }
            call->speed = value;
            break;
        case 2:
        case 4:
        case 9:
            break;
        default:
            return kPipe;
    }
    return 0;
}
EXPORT int libusb_bulk_transfer(Handle* handle, unsigned char endpoint, unsigned char* data, int length,
                                int* transferred, unsigned timeoutMs) {
    Call call(handle);
    *transferred = 0;
    if (!call->plugged) return kGone;
    if (endpoint == 0x02) {
        state().arrives(*call, data, length);
        *transferred = length;
        return 0;
    }
    if (endpoint != 0x81) return kPipe;
    if (call->raised != 0) {
        call.wait(std::chrono::microseconds(500));
        return call->raised;
    }
    // A packet comes every millisecond, with or without something in it; long answers come in pieces.
    if (call->answer.empty()) call.wait(std::chrono::microseconds(std::min(timeoutMs, 1u) * 1000));
    if (length < 2) return kPipe;
    data[0] = 0x01;
    data[1] = 0x60;
    int count = 2;
    const int most = ++call->cut % 5 == 0 ? std::min(length, 9) : length;
    while (count < most && !call->answer.empty()) {
        data[count++] = call->answer.front();
        call->answer.pop_front();
    }
    *transferred = count;
    return 0;
}
