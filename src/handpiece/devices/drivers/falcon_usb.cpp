// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/falcon_usb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>
#include <utility>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"

namespace handpiece::drivers::falcon {
namespace {

constexpr std::uint8_t kFirst = 'A', kOpens = '<', kCloses = '>';
constexpr std::uint16_t kVendor = 0x0403, kProduct = 0xcb48;
constexpr unsigned char kIn = 0x81, kOut = 0x02;
constexpr unsigned kCommandMs = 1000;

// Requests of the serial chip, and its divisors for the three speeds that are used.
constexpr std::uint8_t kToChip = 0x40, kReset = 0, kModem = 1, kFlow = 2, kSpeed = 3, kFormat = 4, kLatency = 9;
constexpr std::uint16_t kPurgeIn = 1, kPurgeOut = 2, kDtrLow = 0x0100, kDtrHigh = 0x0101, kRtsLow = 0x0200,
                        kEightBits = 8;
constexpr std::uint16_t kSpeedBoot = 0x4138, kSpeedUpload = 0x0015, kSpeedFrames = 0x0002;  // 9600, 140000, 1.5 M

struct Words {
    int code;
    const char *sentence, *remedy;
};
constexpr Words kWords[] = {
    {kIo, "The cable does not carry", "Check the cable; plug it into another USB port"},
    {kAccess, "This account may not use the Falcon",
     "Install the udev rules of Handpiece (docs/devices/falcon.md), then plug it in again"},
    {kGone, "The Falcon was unplugged", "Check its cable and power, then connect it again"},
    {kBusy, "Another program uses the Falcon", "Close that program"},
    {kTimedOut, "The Falcon does not answer", "Check its power; plug it in again"},
    {kPipe, "The Falcon refuses what is sent to it", "Switch it off and on"},
};
const Words& wordsOf(int code) noexcept {
    for (const Words& words : kWords)
        if (words.code == code) return words;
    return kWords[0];
}

core::Error refusal(int code, const std::string& where) {
    const Words& words = wordsOf(code);
    const char* id = code == kAccess ? "device-permission"
                     : code == kBusy ? "device-busy"
                     : code == kGone ? "device-missing"
                                     : "device-error";
    return core::Error(fmt::format("{} (libusb {})", words.sentence, code), where, words.remedy)
        .as(id, {"Falcon", words.sentence, std::to_string(code)});
}

/// Devices on the bus, freed with their context.
class List {
  public:
    explicit List(const Usb& usb) : usb_(usb) {
        if (const int code = usb_.init(&context_); code < 0) throw refusal(code, "USB");
        const std::ptrdiff_t count = usb_.list(context_, &devices_);
        if (count < 0) {
            usb_.exit(context_);
            throw refusal(static_cast<int>(count), "USB");
        }
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            Usb::Descriptor d{};
            if (usb_.descriptor(devices_[i], &d) < 0) continue;
            if (d.vendor == kVendor && d.product == kProduct) falcons.emplace_back(devices_[i], d);
        }
    }
    ~List() {
        usb_.freeList(devices_, 1);
        if (context_) usb_.exit(context_);
    }
    List(const List&) = delete;
    List& operator=(const List&) = delete;
    /// The caller's to exit, after this has gone.
    Usb::Context* keep() noexcept { return std::exchange(context_, nullptr); }
    std::vector<std::pair<Usb::Device*, Usb::Descriptor>> falcons;

  private:
    const Usb& usb_;
    Usb::Context* context_ = nullptr;
    Usb::Device** devices_ = nullptr;
};

}  // namespace

Frame encode(const std::array<int, 3>& motors, unsigned lights, bool homing) noexcept {
    Frame frame;
    frame.fill(kFirst);
    frame.front() = kOpens;
    frame.back() = kCloses;
    for (std::size_t motor = 0; motor < 3; ++motor) {
        const auto bits = static_cast<std::uint16_t>(std::clamp(motors[motor], -kMaxMotor, kMaxMotor));
        for (std::size_t nibble = 0; nibble < 4; ++nibble)
            frame[1 + 4 * motor + nibble] = static_cast<std::uint8_t>(kFirst + ((bits >> (4 * nibble)) & 0xf));
    }
    frame[13] = static_cast<std::uint8_t>(kFirst + ((lights & 0xe) | (homing ? 1u : 0u)));
    return frame;
}

bool decode(const Frame& frame, Report& report) noexcept {
    if (frame.front() != kOpens || frame.back() != kCloses) return false;
    Report read;
    for (std::size_t arm = 0; arm < 3; ++arm) {
        unsigned bits = 0;
        for (std::size_t nibble = 0; nibble < 4; ++nibble) {
            const int digit = frame[1 + 4 * arm + nibble] - kFirst;
            if (digit < 0 || digit > 15) return false;
            bits |= static_cast<unsigned>(digit) << (4 * nibble);
        }
        read.counts[arm] = static_cast<std::int16_t>(bits);
    }
    const unsigned state = static_cast<std::uint8_t>(frame[13] - kFirst);
    read.buttons = state & 0xf;
    read.homed = (state >> 4) & kAllHomed;
    report = read;
    return true;
}

bool FrameReader::take(std::span<const std::uint8_t> bytes, Report& report) noexcept {
    bool any = false;
    for (const std::uint8_t byte : bytes) {
        if (filled_ == 0 && byte != kOpens) continue;
        frame_[filled_++] = byte;
        if (filled_ < frame_.size()) continue;
        filled_ = 0;
        if (decode(frame_, report)) {
            any = true;
        } else {
            ++spoilt_;
            // A beginning may stand inside what was taken for a frame.
            const auto again = std::find(frame_.begin() + 1, frame_.end(), kOpens);
            filled_ = static_cast<std::size_t>(std::distance(again, frame_.end()));
            std::copy(again, frame_.end(), frame_.begin());
        }
    }
    return any;
}

Usb::Usb()
    : file("libusb", {"libusb-1.0.so.0", "libusb-1.0.so"}, "HANDPIECE_LIBUSB_LIBRARY",
           "Install it: apt install libusb-1.0-0") {
    file.require(init, "libusb_init");
    file.require(exit, "libusb_exit");
    file.require(list, "libusb_get_device_list");
    file.require(freeList, "libusb_free_device_list");
    file.require(descriptor, "libusb_get_device_descriptor");
    file.require(open, "libusb_open");
    file.require(close, "libusb_close");
    file.require(claim, "libusb_claim_interface");
    file.require(release, "libusb_release_interface");
    file.require(text, "libusb_get_string_descriptor_ascii");
    file.require(control, "libusb_control_transfer");
    file.require(bulk, "libusb_bulk_transfer");
    file.find(detach, "libusb_set_auto_detach_kernel_driver");
}

std::shared_ptr<const Usb> usb() {
    static std::mutex mutex;
    static std::shared_ptr<const Usb> loaded;
    static std::string loadedFrom;
    const char* path = std::getenv("HANDPIECE_LIBUSB_LIBRARY");
    const std::string from = path ? path : "";
    const std::lock_guard lock(mutex);
    if (!loaded || loadedFrom != from) {
        loaded = std::make_shared<const Usb>();
        loadedFrom = from;
    }
    return loaded;
}

int countFalcons(const Usb& usb) {
    return static_cast<int>(List(usb).falcons.size());
}

Connection::Connection(std::shared_ptr<const Usb> usb, const std::string& which) : usb_(std::move(usb)) {
    List list(*usb_);
    std::optional<core::Error> refused;
    int number = 0;
    for (const auto& [device, descriptor] : list.falcons) {
        ++number;
        const auto label = fmt::format("Falcon {}", number);
        if (const int code = usb_->open(device, &handle_); code < 0) {
            if (!refused) refused = refusal(code, label);
            continue;
        }
        unsigned char text[64] = {};
        const int length =
            descriptor.serialText == 0 ? 0 : usb_->text(handle_, descriptor.serialText, text, sizeof text - 1);
        serial_.assign(reinterpret_cast<const char*>(text), static_cast<std::size_t>(std::max(length, 0)));
        if (!which.empty() && which != serial_ && which != std::to_string(number)) {
            close();
            continue;
        }
        if (usb_->detach) (void)usb_->detach(handle_, 1);
        if (const int code = usb_->claim(handle_, 0); code < 0) {
            if (!refused) refused = refusal(code, label);
            close();
            continue;
        }
        claimed_ = true;
        context_ = list.keep();
        return;
    }
    if (refused) throw *refused;
    throw core::Error(which.empty() ? "no Falcon is plugged in" : fmt::format("no Falcon is called \"{}\"", which),
                      "USB", "Check its cable and power, then connect it again")
        .as("device-missing", {"Falcon"});
}

Connection::~Connection() {
    close();
    if (context_) usb_->exit(context_);
}

void Connection::close() noexcept {
    if (claimed_) (void)usb_->release(handle_, 0);
    claimed_ = false;
    if (handle_) usb_->close(handle_);
    handle_ = nullptr;
}

void Connection::tell(std::uint8_t request, std::uint16_t value, const char* what) {
    const int code = usb_->control(handle_, kToChip, request, value, 0, nullptr, 0, kCommandMs);
    if (code < 0) throw refusal(code, fmt::format("Falcon {}, {}", serial_, what));
}

void Connection::setFrames() {
    tell(kLatency, 1, "latency");
    tell(kSpeed, kSpeedFrames, "speed");
    tell(kReset, kPurgeIn, "purge");
    tell(kReset, kPurgeOut, "purge");
    reader_.clear();
}

bool Connection::answers(double seconds) {
    const std::int64_t untilNs = rt::monotonicNs() + static_cast<std::int64_t>(seconds * 1e9);
    while (rt::monotonicNs() < untilNs) {
        Report report;
        int code = write(encode({0, 0, 0}, 0, false));
        if (code == 0) code = read(report, 20'000'000);
        if (code == 0) return true;
        if (code != kTimedOut) throw refusal(code, fmt::format("Falcon {}", serial_));
    }
    return false;
}

std::vector<std::uint8_t> Connection::ask(std::span<const std::uint8_t> bytes, std::size_t wanted) {
    std::vector<std::uint8_t> out(bytes.begin(), bytes.end()), answer;
    int done = 0;
    if (const int code = usb_->bulk(handle_, kOut, out.data(), static_cast<int>(out.size()), &done, kCommandMs);
        code < 0)
        throw refusal(code, fmt::format("Falcon {}, firmware", serial_));
    const std::int64_t untilNs = rt::monotonicNs() + 150'000'000;
    while (answer.size() < wanted && rt::monotonicNs() < untilNs) {
        std::array<unsigned char, 64> packet{};
        done = 0;
        const int code = usb_->bulk(handle_, kIn, packet.data(), packet.size(), &done, 100);
        if (code < 0 && code != kTimedOut) throw refusal(code, fmt::format("Falcon {}, firmware", serial_));
        if (done > 2) answer.insert(answer.end(), packet.begin() + 2, packet.begin() + done);
    }
    return answer;
}

bool Connection::tryUpload(std::span<const std::byte> firmware) {
    tell(kReset, kPurgeIn, "purge");
    tell(kReset, kPurgeOut, "purge");
    tell(kLatency, 16, "latency");
    tell(kSpeed, kSpeedBoot, "speed");
    tell(kFormat, kEightBits, "format");
    tell(kFlow, 0, "flow");
    tell(kModem, kRtsLow, "RTS");
    tell(kModem, kDtrLow, "DTR");
    tell(kModem, kDtrHigh, "DTR");
    // The boot program greets; a zero may stand before its answer.
    constexpr std::array<std::uint8_t, 3> kHail{0x0a, 0x43, 0x0d};
    constexpr std::array<std::uint8_t, 4> kHailed{0x0a, 0x44, 0x2c, 0x0d};
    const std::vector<std::uint8_t> hailed = ask(kHail, kHailed.size());
    if (std::search(hailed.begin(), hailed.end(), kHailed.begin(), kHailed.end()) == hailed.end()) return false;
    tell(kModem, kDtrLow, "DTR");
    tell(kSpeed, kSpeedUpload, "speed");
    constexpr std::array<std::uint8_t, 1> kBegin{'A'};
    if (ask(kBegin, 1) != std::vector<std::uint8_t>(kBegin.begin(), kBegin.end())) return false;
    constexpr std::size_t kPiece = 62;  // what a packet of 64 carries beside the chip's two bytes of state
    for (std::size_t at = 0; at < firmware.size(); at += kPiece) {
        const auto piece = firmware.subspan(at, std::min(kPiece, firmware.size() - at));
        const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(piece.data()), piece.size());
        const std::vector<std::uint8_t> echo = ask(bytes, bytes.size());
        if (!std::equal(echo.begin(), echo.end(), bytes.begin(), bytes.end())) return false;
    }
    return true;
}

void Connection::upload(std::span<const std::byte> firmware) {
    constexpr int kTries = 10;  // others report that the first ones often fail
    for (int i = 0; i < kTries; ++i) {
        if (!tryUpload(firmware)) continue;
        setFrames();
        if (answers(1.0)) return;
    }
    throw core::Error("the Falcon does not take its firmware", fmt::format("Falcon {}", serial_),
                      "Switch it off and on; check HANDPIECE_FALCON_FIRMWARE")
        .as("firmware-wrong", {serial_});
}

int Connection::write(const Frame& frame) noexcept {
    Frame bytes = frame;
    int done = 0;
    const int code = usb_->bulk(handle_, kOut, bytes.data(), static_cast<int>(bytes.size()), &done, 5);
    if (code < 0) return code;
    return done == static_cast<int>(bytes.size()) ? 0 : static_cast<int>(kTimedOut);
}

int Connection::read(Report& report, std::int64_t forNs) noexcept {
    const std::int64_t untilNs = rt::monotonicNs() + forNs;
    do {
        std::array<unsigned char, 64> packet{};
        int done = 0;
        const int code = usb_->bulk(handle_, kIn, packet.data(), packet.size(), &done, 2);
        // What came before the time was over counts.
        if (done > 2 && reader_.take({packet.data() + 2, static_cast<std::size_t>(done - 2)}, report)) return 0;
        if (code < 0 && code != kTimedOut) return code;
    } while (rt::monotonicNs() < untilNs);
    return kTimedOut;
}

std::string usbErrorInWords(int code) {
    const Words& words = wordsOf(code);
    return fmt::format("{} (libusb error {}): {}.", words.sentence, code, words.remedy);
}

}  // namespace handpiece::drivers::falcon
