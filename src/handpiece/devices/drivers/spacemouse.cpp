// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/spacemouse.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"
#include "handpiece/base/rt/realtime_thread.h"
#include "handpiece/devices/drivers/rate_hand.h"

namespace handpiece::drivers {
namespace {

using core::Vec3;
using link::DeviceFault;

// The daemon's protocol, from the declarations that its library publishes: packets of eight 32-bit integers in the
// machine's order, first the kind. Version 1 answers requests; version 0 only tells motion and buttons.
using Packet = std::array<std::int32_t, 8>;
constexpr std::int32_t kMotion = 0, kPress = 1, kRelease = 2;
constexpr std::int32_t kRequest = 0x7faa0000;
constexpr std::int32_t kDeviceName = kRequest | 0x2000, kAxes = kRequest | 0x2002;
constexpr std::int32_t kChangeProtocol = kRequest | 0x5500;
constexpr std::int32_t kStatusAt = 7;  // of an answer: below 0, no

constexpr double kFullDeflection = 350.0;  // counts of a cap pushed home [R]
constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kAskNs = 25 * kMs;      // whether the daemon lives and has its device
constexpr std::int64_t kSilentNs = 100 * kMs;  // without an answer: it stands
constexpr std::int64_t kHoldNs =
    1'500 * kMs;  // a deflection that is not told again is none: the cap trembles in a hand
constexpr std::int64_t kAgainNs = 250 * kMs;
constexpr const char* kRemedy =
    "install spacenavd and start it (systemctl start spacenavd), or name its socket in HANDPIECE_SPNAV_SOCKET";

std::string socketPath() {
    const char* const path = std::getenv("HANDPIECE_SPNAV_SOCKET");
    return path != nullptr && *path != '\0' ? path : "/var/run/spnav.sock";
}

/// The daemon's socket: whole packets, no waiting beyond a deadline.
class Daemon {
  public:
    /// Throws core::Error.
    Daemon(const std::string& path, std::int64_t timeoutNs);
    ~Daemon() { ::close(socket_); }
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;

    enum class Got : std::uint8_t { packet, nothing, closed };
    Got receive(Packet& packet, std::int64_t deadlineNs) noexcept;
    bool send(const void* bytes, std::size_t size) noexcept {
        return ::send(socket_, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(size);
    }
    bool ask(std::int32_t what) noexcept {
        const Packet packet{what};
        return send(packet.data(), sizeof packet);
    }
    /// Empty when it has none or does not say.
    std::string deviceName(std::int64_t timeoutNs);
    [[nodiscard]] bool answers() const noexcept { return answers_; }  ///< version 1

  private:
    bool fill(std::size_t size, std::int64_t deadlineNs, bool& gone) noexcept;
    int socket_ = -1;
    std::array<char, sizeof(Packet)> buffer_{};
    std::size_t have_ = 0;
    bool answers_ = false;
};

Daemon::Daemon(const std::string& path, std::int64_t timeoutNs) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path)
        throw core::Error("the path of the socket is too long", path, kRemedy).as("spnav-missing", {path, ""});
    std::copy(path.begin(), path.end(), address.sun_path);
    socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as sockets are
    if (socket_ < 0 || ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        const int reason = errno;
        if (socket_ >= 0) ::close(socket_);
        if (reason == EACCES)
            throw core::Error("this person may not speak to spacenavd", path,
                              "let the daemon's socket be written by everybody, as it is when installed")
                .as("spnav-forbidden", {path});
        throw core::Error(fmt::format("spacenavd does not run ({})", std::strerror(reason)), path, kRemedy)
            .as("spnav-missing", {path, std::strerror(reason)});
    }
    // An old daemon takes the question for a sensitivity and says nothing.
    const std::int32_t question = kChangeProtocol | 1;
    bool gone = !send(&question, sizeof question);
    if (!gone && fill(sizeof question, rt::monotonicNs() + timeoutNs, gone)) {
        std::int32_t answer = 0;
        std::memcpy(&answer, buffer_.data(), sizeof answer);
        answers_ = (answer & ~0xFF) == kChangeProtocol && (answer & 0xFF) >= 1;
        if (answers_) have_ = 0;  // else it is the beginning of an old daemon's event
    } else if (!gone) {
        const float plain = 1.0f;
        gone = !send(&plain, sizeof plain);
    }
    if (gone) {
        ::close(socket_);
        throw core::Error("spacenavd closed the connection at once", path, "start it again, or update it")
            .as("spnav-missing", {path, ""});
    }
}

/// Until `size` bytes of a packet are there; false at the deadline and when the daemon is gone.
bool Daemon::fill(std::size_t size, std::int64_t deadlineNs, bool& gone) noexcept {
    while (have_ < size) {
        const std::int64_t left = std::max<std::int64_t>(0, deadlineNs - rt::monotonicNs());
        const timespec time{static_cast<time_t>(left / 1'000'000'000), static_cast<long>(left % 1'000'000'000)};
        pollfd one{socket_, POLLIN, 0};
        const int ready = ::ppoll(&one, 1, &time, nullptr);
        if (ready < 0 && errno == EINTR) continue;
        if (ready <= 0) return false;
        const ssize_t got = ::recv(socket_, buffer_.data() + have_, size - have_, MSG_DONTWAIT);
        if (got > 0) {
            have_ += static_cast<std::size_t>(got);
        } else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
            gone = true;
            return false;
        }
    }
    return true;
}

Daemon::Got Daemon::receive(Packet& packet, std::int64_t deadlineNs) noexcept {
    bool gone = false;
    if (!fill(sizeof(Packet), deadlineNs, gone)) return gone ? Got::closed : Got::nothing;
    std::memcpy(packet.data(), buffer_.data(), sizeof packet);
    have_ = 0;
    return Got::packet;
}

std::string Daemon::deviceName(std::int64_t timeoutNs) {
    if (!answers_ || !ask(kDeviceName)) return {};
    const std::int64_t deadline = rt::monotonicNs() + timeoutNs;
    std::string name;
    Packet packet{};
    while (receive(packet, deadline) == Got::packet) {
        if (packet[0] != kDeviceName) continue;  // somebody moves it meanwhile
        if (packet[kStatusAt] < 0) return {};
        // 24 bytes a packet; how many were left stands in its end.
        const auto left = static_cast<std::size_t>(packet[kStatusAt] & 0xFFFF);
        std::array<char, 24> text{};
        std::memcpy(text.data(), &packet[1], text.size());
        name.append(text.data(), std::min(left, text.size()));
        if (left <= text.size() || name.size() > 200) break;
    }
    return name.substr(0, name.find('\0'));
}

class SpaceMouseDriver final : public link::Driver {
  public:
    explicit SpaceMouseDriver(const OpenOptions& options);
    ~SpaceMouseDriver() override { stop(); }
    [[nodiscard]] const link::DriverInfo& info() const noexcept override { return info_; }
    void start(link::Servo& servo) override;
    void stop() noexcept override {
        stopped_ = true;
        stopping_ = true;
        thread_.reset();  // every wait of the thread has a deadline
        daemon_.reset();
    }

  private:
    void run(std::int64_t periodNs) noexcept;
    [[nodiscard]] bool listen(std::int64_t untilNs) noexcept;
    void take(const Packet& packet) noexcept;
    void letGo() noexcept;
    void connectAgain() noexcept;

    link::DriverInfo info_;
    std::string path_;
    std::unique_ptr<Daemon> daemon_;
    std::unique_ptr<rt::RealtimeThread> thread_;
    std::atomic<bool> stopping_{false};
    bool stopped_ = false;
    link::Servo* servo_ = nullptr;

    // The thread's own.
    RateHand hand_{RateHandSettings{}};
    link::DriverReading reading_;
    Vec3 move_ = Vec3::Zero(), turn_ = Vec3::Zero();
    bool hasDevice_ = true;
    std::int64_t movedNs_ = 0, askedNs_ = 0, answeredNs_ = 0, triedNs_ = 0;
};

SpaceMouseDriver::SpaceMouseDriver(const OpenOptions& options) : path_(socketPath()) {
    info_.servoHz = options.servoHz > 0.0 ? options.servoHz : 250.0;
    if (!(info_.servoHz >= 20.0 && info_.servoHz <= 2000.0))
        throw core::Error(fmt::format("a rate of {} Hz", info_.servoHz), "spacemouse", "ask for 20 to 2000 Hz")
            .as("servo-rate", {fmt::format("{}", info_.servoHz)});
    daemon_ = std::make_unique<Daemon>(path_, 300 * kMs);
    const std::string name = daemon_->deviceName(300 * kMs);
    if (daemon_->answers() && name.empty())
        throw core::Error("spacenavd runs, but no SpaceMouse is connected to it", path_,
                          "plug it in; a new one may need spacenavd to be restarted")
            .as("device-missing", {"SpaceMouse"});
    info_.driver = "spacemouse";
    info_.model = name.empty() ? "SpaceMouse" : name;
    info_.version = fmt::format("spacenavd, protocol {}", daemon_->answers() ? 1 : 0);
    info_.capability.name = info_.model;
    info_.capability.workspaceMm = Vec3(2.0 * RateHandSettings{}.reachMm);
    info_.capability.rateHz = info_.servoHz;
    info_.pushes = false;
    info_.sources = "no force; full deflection of 350 counts unchecked";
}

void SpaceMouseDriver::start(link::Servo& servo) {
    link::requireStartable(servo_ != nullptr, stopped_, info_.model);
    servo_ = &servo;
    const auto periodNs = static_cast<std::int64_t>(1e9 / info_.servoHz);
    thread_ = std::make_unique<rt::RealtimeThread>([this, periodNs] { run(periodNs); });
}

void SpaceMouseDriver::letGo() noexcept {
    move_.setZero();
    turn_.setZero();
    reading_.buttons = 0;
}

void SpaceMouseDriver::take(const Packet& packet) noexcept {
    switch (packet[0]) {
        case kMotion:
            // The daemon's z goes away from the user, its library turns it round for right-handed frames; so do we.
            move_ = Vec3(packet[1], packet[2], -static_cast<double>(packet[3])) / kFullDeflection;
            turn_ = Vec3(packet[4], packet[5], -static_cast<double>(packet[6])) / kFullDeflection;
            movedNs_ = rt::monotonicNs();
            break;
        case kPress:
            if (packet[1] >= 0 && packet[1] < 32) reading_.buttons |= 1u << packet[1];
            break;
        case kRelease:
            if (packet[1] >= 0 && packet[1] < 32) reading_.buttons &= ~(1u << packet[1]);
            break;
        case kAxes:
            answeredNs_ = rt::monotonicNs();
            hasDevice_ = packet[kStatusAt] >= 0;
            break;
        default:
            break;  // news of devices and settings
    }
}

/// Takes what comes until then; false when the daemon is gone.
bool SpaceMouseDriver::listen(std::int64_t untilNs) noexcept {
    for (;;) {
        Packet packet{};
        switch (daemon_->receive(packet, untilNs)) {
            case Daemon::Got::packet:
                take(packet);
                break;
            case Daemon::Got::nothing:
                return true;
            case Daemon::Got::closed:
                return false;
        }
        if (rt::monotonicNs() > untilNs) return true;  // a daemon that never ends is heard at the next beat
    }
}

void SpaceMouseDriver::connectAgain() noexcept {
    triedNs_ = rt::monotonicNs();
    try {
        daemon_ = std::make_unique<Daemon>(path_, 50 * kMs);
        answeredNs_ = askedNs_ = rt::monotonicNs();
    } catch (const std::exception&) {
        // Still gone, or no memory for it: the trouble is told every frame, and the next try comes.
    }
}

void SpaceMouseDriver::run(std::int64_t periodNs) noexcept {
    std::int64_t lastNs = rt::monotonicNs(), nextNs = lastNs;
    answeredNs_ = askedNs_ = lastNs;
    while (!stopping_.load(std::memory_order_acquire)) {
        nextNs = std::max(nextNs + periodNs, rt::monotonicNs());
        DeviceFault trouble = DeviceFault::none;
        if (daemon_ && !listen(nextNs)) {
            daemon_.reset();
            triedNs_ = rt::monotonicNs();
        }
        if (!daemon_) {
            const std::int64_t left = nextNs - rt::monotonicNs();
            const timespec pause{0, static_cast<long>(std::clamp<std::int64_t>(left, 0, 100 * kMs))};
            ::nanosleep(&pause, nullptr);
            if (rt::monotonicNs() - triedNs_ > kAgainNs) connectAgain();
        }
        const std::int64_t now = rt::monotonicNs();
        if (!daemon_) {
            trouble = DeviceFault::unplugged;
        } else if (daemon_->answers()) {
            if (now - askedNs_ > kAskNs) {
                (void)daemon_->ask(kAxes);  // a daemon that takes no more questions gives no more answers
                askedNs_ = now;
            }
            if (now - answeredNs_ > kSilentNs) trouble = DeviceFault::stalled;
            if (!hasDevice_) trouble = DeviceFault::unplugged;
        }
        if (trouble != DeviceFault::none) letGo();
        if (now - movedNs_ > kHoldNs) {
            move_.setZero();
            turn_.setZero();
        }
        const bool both = (reading_.buttons & 3u) == 3u;
        hand_.step(move_, turn_, both, static_cast<double>(now - lastNs) * 1e-9);
        lastNs = now;
        reading_.timeNs = now;
        ++reading_.frame;
        reading_.trouble = trouble;
        hand_.tell(reading_);
        (void)servo_->exchange(reading_);  // it cannot push
    }
}

}  // namespace

Found lookSpaceMouse() {
    Found found;
    found.driver = "spacemouse";
    found.makes = "3Dconnexion SpaceMouse, SpaceNavigator and others (spacenavd)";
    found.pushes = false;
    try {
        Daemon daemon(socketPath(), 60 * kMs);
        const std::string name = daemon.deviceName(60 * kMs);
        if (!name.empty()) found.models.push_back(name);
        found.available = !name.empty() || !daemon.answers();
        if (!found.available) {
            found.why = "spacenavd runs, but no SpaceMouse is connected to it.";
            found.remedy = "Plug it in; a new one may need spacenavd to be restarted.";
        }
    } catch (const core::Error& e) {
        found.why = fmt::format("{}: {}.", e.where(), e.problem());
        found.remedy = e.remedy();
    }
    return found;
}

std::unique_ptr<link::Driver> openSpaceMouse(const OpenOptions& options) {
    return std::make_unique<SpaceMouseDriver>(options);
}

}  // namespace handpiece::drivers
