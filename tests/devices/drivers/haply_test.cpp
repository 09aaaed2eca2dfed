// SPDX-License-Identifier: Apache-2.0
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <limits>
#include <optional>

#include "devices/drivers/conformance.h"
#include "devices/drivers/haply_service.h"
#include "handpiece/devices/drivers/haply.h"
#include "handpiece/devices/drivers/haply_state.h"
#include "handpiece/devices/drivers/websocket.h"
#include "handpiece/devices/safety/gate.h"
#include "support/error_of.h"
#include "support/random.h"
#include "support/realtime_trap.h"

namespace handpiece::drivers::haply_test {
namespace {

using link::DeviceFault;
using test::errorOf;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;

/// The service of one test, and the driver's way to it.
class Haply : public testing::Test {
  protected:
    explicit Haply(int arms = 1) : service(arms) { ::setenv("HANDPIECE_HAPLY_URL", service.url().c_str(), 1); }
    ~Haply() override { ::unsetenv("HANDPIECE_HAPLY_URL"); }
    [[nodiscard]] std::unique_ptr<link::Driver> streaming(Probe& probe, const OpenOptions& options = {}) {
        auto driver = openHaply(options);
        driver->start(probe);
        EXPECT_TRUE(await([&] { return probe.count() > 2 && probe.last().trouble == DeviceFault::none; }))
            << link::idOf(probe.last().trouble);
        return driver;
    }
    test::HaplyService service;
};
class HaplyPair : public Haply {
  protected:
    HaplyPair() : Haply(2) {}
};

/// A listener that is no WebSocket service: says one thing to whoever comes, then nothing, or hangs up.
class Stranger {
  public:
    explicit Stranger(std::string words, bool hangsUp) : words_(std::move(words)), hangsUp_(hangsUp) {
        socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof at;
        EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&at), size), 0);
        EXPECT_EQ(::listen(socket_, 4), 0);
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&at), &size);
        port_ = ntohs(at.sin_port);
        thread_ = std::thread([this] {
            std::vector<int> kept;
            for (;;) {
                const int client = ::accept(socket_, nullptr, nullptr);
                if (client < 0) break;
                std::array<char, 1024> request{};
                (void)::recv(client, request.data(), request.size(), 0);
                (void)::send(client, words_.data(), words_.size(), MSG_NOSIGNAL);
                if (hangsUp_) {
                    ::close(client);
                } else {
                    kept.push_back(client);
                }
            }
            for (const int client : kept)
                ::close(client);
        });
    }
    ~Stranger() {
        ::shutdown(socket_, SHUT_RDWR);
        thread_.join();
        ::close(socket_);
    }
    [[nodiscard]] std::string url() const { return "ws://127.0.0.1:" + std::to_string(port_); }

  private:
    std::string words_;
    bool hangsUp_;
    int socket_ = -1;
    unsigned port_ = 0;
    std::thread thread_;
};

std::string errorAt(const std::string& url) {
    ::setenv("HANDPIECE_HAPLY_URL", url.c_str(), 1);
    const std::string error = errorOf([] { (void)openHaply({}); });
    ::unsetenv("HANDPIECE_HAPLY_URL");
    return error;
}

TEST(WebSocketClient, theAnswerToAKeyIsThatOfTheStandard) {
    EXPECT_EQ(webSocketAccept("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");  // RFC 6455, 1.3
}

TEST(WebSocketClient, whatIsNoServiceIsToldInWords) {
    for (const char* url : {"http://localhost:10001", "ws://", "ws://localhost:", "ws://localhost:70000",
                            "ws://localhost:1x", "ws://a b:1", "ws://[::1:1"})
        EXPECT_THAT(errorAt(url), HasSubstr("no address")) << url;
    EXPECT_THAT(errorAt("ws://127.0.0.1:1"), HasSubstr("nothing answers there"));
    EXPECT_THAT(errorAt("ws://127.0.0.1:1"), HasSubstr("HANDPIECE_HAPLY_URL")) << "the remedy";
    for (const char* url : {"ws://192.0.2.1:1", "ws://[2001:db8::1]:1", "ws://0.0.0.0:1"})
        EXPECT_THAT(errorAt(url), AllOf(HasSubstr("not on this machine"), HasSubstr("HANDPIECE_HAPLY_REMOTE"))) << url;
    ::setenv("HANDPIECE_HAPLY_REMOTE", "1", 1);
    EXPECT_THAT(errorAt("ws://192.0.2.1:1"), HasSubstr("nothing answers there"));
    ::unsetenv("HANDPIECE_HAPLY_REMOTE");
    EXPECT_THAT(errorAt("ws://there.is.no.such.host.invalid:1"), HasSubstr("not known"));
    EXPECT_THAT(errorAt(Stranger("HTTP/1.1 404 Not Found\r\n\r\n", false).url()), HasSubstr("404"));
    EXPECT_THAT(errorAt(Stranger("\x01\x02\x7f", true).url()), HasSubstr("another program"));
    EXPECT_THAT(errorAt(Stranger("", true).url()), HasSubstr("another program"));
    // The right words, but the answer is not to our key.
    EXPECT_THAT(errorAt(Stranger("HTTP/1.1 101 Switching\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                                 "Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n\r\n",
                                 false)
                            .url()),
                HasSubstr("another program"));
}

TEST(WebSocketClient, aServiceThatNeverAnswersIsLeftInTime) {
    const Stranger silent("", false);
    const auto then = std::chrono::steady_clock::now();
    EXPECT_THAT(errorOf([&] { WebSocket(silent.url(), kSecond / 5, "start it"); }), HasSubstr("does not answer"));
    EXPECT_LT(std::chrono::steady_clock::now() - then, std::chrono::seconds(5));
}

TEST_F(Haply, messagesInPiecesWithPingsBetweenAreWhole) {
    service.fragment(7);
    Probe probe;
    auto driver = streaming(probe);
    service.change(0, [](test::SimulatedArm& arm) { arm.positionM = {0.01, 0.02, 0.03}; });
    EXPECT_TRUE(await([&] { return std::abs(probe.last().positionMm[0] - 10.0) < 1e-6; }));
    driver->stop();
    EXPECT_EQ(service.breaches(), 0u) << service.lastBreach();
}

TEST_F(Haply, messagesLargerThanOneReadingOfTheSocketAreWhole) {
    for (const std::size_t size : {80'000u, 81'920u, 200'000u}) {
        service.say(std::string(size, ' ') + "{}");
        WebSocket socket(service.url(), 2 * kSecond, "");
        std::string_view text;
        WebSocket::Got got = WebSocket::Got::nothing;
        ASSERT_TRUE(await([&] { return (got = socket.receive(kSecond / 10, text)) != WebSocket::Got::nothing; }));
        EXPECT_EQ(got, WebSocket::Got::message);
        EXPECT_EQ(text.size(), size + 2);
        EXPECT_TRUE(text.ends_with(" {}"));
    }
    service.say(std::string(300'000, ' '));  // more than any service says
    WebSocket socket(service.url(), 2 * kSecond, "");
    std::string_view text;
    WebSocket::Got got = WebSocket::Got::nothing;
    ASSERT_TRUE(await([&] { return (got = socket.receive(kSecond / 10, text)) != WebSocket::Got::nothing; }));
    EXPECT_EQ(got, WebSocket::Got::broken);
}

TEST_F(Haply, whatThereIsNotIsToldWithItsRemedy) {
    EXPECT_THAT(errorOf([] { (void)openHaply({"FFFF", 0.0}); }), HasSubstr("049D")) << "names what there is";
    EXPECT_THAT(errorOf([] { (void)openHaply({"", 1e6}); }), HasSubstr("servo rate"));
    service.change(0, [](test::SimulatedArm& arm) { arm.basis = "XZY"; });
    EXPECT_THAT(errorOf([] { (void)openHaply({}); }), HasSubstr("turn or scale"));
    service.change(0, [](test::SimulatedArm& arm) {
        arm.basis = "XYZ";
        arm.scale = 2.0;
    });
    EXPECT_THAT(errorOf([] { (void)openHaply({}); }), HasSubstr("turn or scale"));
    service.change(0, [](test::SimulatedArm& arm) { arm.gone = true; });
    EXPECT_THAT(errorOf([] { (void)openHaply({}); }), HasSubstr("no Inverse3"));
    EXPECT_FALSE(lookHaply().available);
    service.say("no JSON at all");
    EXPECT_THAT(errorOf([] { (void)openHaply({}); }), HasSubstr("not Haply's"));
    service.kill();
    const Found found = lookHaply();
    EXPECT_FALSE(found.available);
    EXPECT_THAT(found.why, HasSubstr("nothing answers"));
    EXPECT_THAT(found.remedy, HasSubstr("Haply Hub"));
}

TEST_F(HaplyPair, bothAreFoundAndAnArmInUseIsNotTaken) {
    service.change(1, [](test::SimulatedArm& arm) { arm.type = "minverse"; });
    const Found found = lookHaply();
    EXPECT_TRUE(found.available);
    EXPECT_THAT(found.models, testing::ElementsAre("Haply Inverse3 049D", "Haply Minverse 04B1"));
    EXPECT_FALSE(found.triedOnHardware);
    Probe probe;
    auto second = streaming(probe, {"04B1", 0.0});
    EXPECT_EQ(second->info().serial, "04B1");
    EXPECT_LT(second->info().capability.workspaceMm.x(), openHaply({})->info().capability.workspaceMm.x());
    EXPECT_THAT(errorOf([] { (void)openHaply({"04B1", 0.0}); }), HasSubstr("another program uses"));
    second->stop();
    EXPECT_EQ(errorOf([] { (void)openHaply({"04B1", 0.0}); }), "");
}

TEST_F(Haply, anOlderServiceIsSpokenToInItsOwnWords) {
    service.older(true);
    service.change(0, [](test::SimulatedArm& arm) {
        arm.wirelessGrip = false;
        arm.buttons = 1;
    });
    Probe probe;
    auto driver = streaming(probe);
    EXPECT_THAT(driver->info().version, HasSubstr("before 3.5"));
    EXPECT_EQ(probe.last().buttons, 1u);
    probe.push({0.25, 0.5, 0});
    EXPECT_TRUE(await([&] { return service.arm(0).forceN == std::array<double, 3>{0.25, 0.0, 0.5}; }));
    driver->stop();
    EXPECT_EQ(service.breaches(), 0u) << service.lastBreach();
}

TEST_F(Haply, withoutAGripItIsAPointInSpace) {
    service.change(0, [](test::SimulatedArm& arm) { arm.gripId.clear(); });
    Probe probe;
    auto driver = streaming(probe);
    EXPECT_FALSE(driver->info().hasOrientation);
    EXPECT_EQ(driver->info().capability.sensedAxes, 3);
    EXPECT_EQ(probe.last().orientation, (std::array<double, 4>{1, 0, 0, 0}));
}

TEST_F(Haply, aServiceThatIsKilledAndStartedAgainIsTakenUpAgain) {
    Probe probe;
    auto driver = streaming(probe);
    for (int round = 0; round < 2; ++round) {
        probe.push({0.5, 0, 0});
        service.kill();
        EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::unplugged; }));
        probe.push(core::Vec3::Zero());
        service.revive();
        EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }))
            << link::idOf(probe.last().trouble);
        EXPECT_EQ(service.arm(0).forceN, (std::array<double, 3>{})) << "no force of before";
    }
    EXPECT_EQ(probe.faultsOfOrder(), 0u);
    driver->stop();
    EXPECT_EQ(service.breaches(), 0u) << service.lastBreach();
}

TEST_F(Haply, garbageOfAllKindsIsTroubleAndPasses) {
    Probe probe;
    auto driver = streaming(probe);
    const std::vector<std::string> texts{
        "",
        "{",
        "[]",
        "null",
        "\xff\xfe",
        R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":1}}}]})",
        R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":1e999,"y":0,"z":0}}}]})",
        R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":nan,"y":0,"z":0}}}]})",
        std::string(10'000, '['),
        std::string(100'000, '{')};
    for (const std::string& text : texts) {
        if (text.empty()) continue;  // stands for "as it should be"
        probe.forget();
        service.say(text);
        EXPECT_TRUE(await([&] { return probe.trouble() == DeviceFault::badData; })) << text.substr(0, 80);
        service.say("");
        EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; })) << text.substr(0, 80);
    }
    // Not even a WebSocket's frames: masked, with bits that mean nothing, a length beyond everything, a cut control.
    for (const std::string& bytes :
         {std::string("\x81\x80"
                      "abcd",
                      6),
          std::string("\xf1\x01x", 3), std::string("\x81\x7f\xff\xff\xff\xff\xff\xff\xff\xff", 10),
          std::string("\x08\x7e\x01\x00", 4), std::string("\x83\x00", 2)}) {
        probe.forget();
        service.breakFrame(bytes);
        EXPECT_TRUE(await([&] { return probe.trouble() != DeviceFault::none; }));
        EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; })) << "connected anew";
    }
    EXPECT_EQ(probe.faultsOfOrder(), 0u);
}

TEST_F(Haply, aStandingServiceFindsZeroForceWhenItGoesOn) {
    Probe probe;
    auto driver = streaming(probe);
    probe.push({0, 0, 1.5});
    EXPECT_TRUE(await([&] { return service.arm(0).forceN[1] == -1.5; }));
    service.stall(0.3);
    EXPECT_TRUE(await([&] { return probe.trouble() == DeviceFault::stalled; }));
    probe.push(core::Vec3::Zero());
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }));
    EXPECT_TRUE(await([&] { return service.arm(0).forceN == std::array<double, 3>{}; }));
    // It stands for so long that it is given up; meanwhile the driver goes on telling so.
    service.stall(1.6);
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::unplugged; }));
    EXPECT_TRUE(await([&] { return probe.last().trouble == DeviceFault::none; }));
    driver->stop();
    EXPECT_EQ(service.breaches(), 0u) << service.lastBreach();
}

/// Arms the trap in the servo thread itself, from one exchange to a later one.
class TrappedServo final : public link::Servo {
  public:
    link::DriverCommand exchange(const link::DriverReading& reading) noexcept override {
        if (reading.trouble == DeviceFault::none && ++well == 50) trap.emplace();
        if (trap && well == 450) {
            allocations = static_cast<int>(trap->allocations());
            trap.reset();
        }
        link::DriverCommand command;
        command.forceN = {0.1, 0.2, 0.3};
        return command;
    }
    std::atomic<int> well{0}, allocations{-1};
    std::optional<test::RealtimeTrap> trap;
};

TEST_F(Haply, theServoThreadTakesNoMemoryWhileItStreams) {
    if (!test::RealtimeTrap::isActive()) GTEST_SKIP() << "the sanitizers own malloc";
    TrappedServo servo;
    auto driver = openHaply({});
    driver->start(servo);
    EXPECT_TRUE(await([&] { return servo.allocations >= 0; }));
    EXPECT_EQ(servo.allocations, 0);
    driver->stop();
}

TEST_F(Haply, theGateIsFadedOutWhenTheServiceDies) {
    /// The gate as it is in use, in the servo thread.
    struct Guarded final : link::Servo {
        safety::Gate gate{[] {
            safety::GateSettings settings = safety::gateSettingsFor(openHaply({})->info().capability);
            settings.fadeInS = 0.02;  // a busy machine has stalls enough without it
            settings.clearAfterS = 0.005;
            return settings;
        }()};
        std::atomic<double> sentN{0.0};
        std::atomic<DeviceFault> trouble{DeviceFault::starting};
        std::uint64_t number = 0;
        link::DriverCommand exchange(const link::DriverReading& reading) noexcept override {
            link::DriverCommand wanted;
            wanted.timeNs = reading.timeNs;
            wanted.number = ++number;
            wanted.forceN = {0, 1.0, 0};
            const link::DriverCommand sent = gate.pass(reading, wanted, reading.timeNs);
            sentN = std::hypot(sent.forceN[0], sent.forceN[1], sent.forceN[2]);
            trouble = gate.status().trouble;
            return sent;
        }
    } guarded;
    auto driver = openHaply({});
    driver->start(guarded);
    EXPECT_TRUE(await([&] { return service.arm(0).forceN[2] > 0.5; })) << "up is its z";
    service.kill();
    EXPECT_TRUE(await([&] { return guarded.trouble == DeviceFault::unplugged && guarded.sentN == 0.0; }));
    service.revive();
    EXPECT_TRUE(await([&] { return guarded.sentN > 0.5; })) << "it fades in again by itself";
    driver->stop();
    EXPECT_EQ(service.arm(0).forceN, (std::array<double, 3>{}));
}

// The scanner alone.

constexpr std::string_view kInventory =
    R"({ "session_id": 7, "inverse3": [ { "device_id": "049D", "config": { "type": "inverse3x",
  "device_info": { "id": "049D", "uuid": "\u2026\"}]" }, "basis": { "permutation": "XYZ" }, "extended_firmware_version": "8C20",
  "mount": { "scale": { "x": 1, "y": 1.0, "z": 1e0 } } }, "state": { "cursor_position": { "x": -0.5e-1, "y": -0.12, "z": 0.15 },
  "angles": [1, [2, {"a": null}], true, false, "x"] }, "status": { "calibrated": true, "in_use": false, "power_supply": null } },
  { "state": {} }, 17, { "device_id": "04BA" } ], "verse_grip": null, "wireless_verse_grip": [ { "device_id": "61548",
  "state": { "orientation": { "x": 0.1, "y": 0.2, "z": 0.3, "w": 0.9 }, "buttons": { "a": true, "b": false, "c": true, "d": 1 } } } ] })";

TEST(HaplyScanner, readsWhatTheDocumentationShows) {
    HaplyState state;
    ASSERT_TRUE(readHaplyState(kInventory, state));
    EXPECT_TRUE(state.hasSession);
    ASSERT_EQ(state.armCount, 2u) << "what has no id is left out";
    const HaplyArm& arm = state.arms[0];
    EXPECT_EQ(textOf(arm.id), "049D");
    EXPECT_EQ(textOf(arm.type), "inverse3x");
    EXPECT_EQ(textOf(arm.basis), "XYZ");
    EXPECT_TRUE(arm.hasPosition);
    EXPECT_EQ(arm.positionM, (std::array<double, 3>{-0.05, -0.12, 0.15}));
    EXPECT_FALSE(arm.scaled);
    EXPECT_EQ(arm.calibrated, Said::yes);
    EXPECT_EQ(arm.inUse, Said::no);
    EXPECT_EQ(arm.powered, Said::nothing);
    EXPECT_EQ(arm.ready, Said::nothing);
    EXPECT_FALSE(state.arm("04BA")->hasPosition);
    EXPECT_EQ(state.arm("049d"), nullptr);
    ASSERT_EQ(state.gripCount, 1u);
    EXPECT_TRUE(state.grips[0].wireless);
    EXPECT_EQ(state.grips[0].orientation, (std::array<double, 4>{0.9, 0.1, 0.2, 0.3}));
    EXPECT_EQ(state.grips[0].buttons, 5u);
}

TEST(HaplyScanner, refusesWhatIsNoWholeObject) {
    HaplyState state;
    for (const char* text :
         {"", " ", "{", "}", "[]", "{}x", R"({"a")", R"({"a":})", R"({"a":1,})", R"({"a":tru})", R"({"a":"\)",
          R"({"a":01x})", R"({"a":-})", R"({"a":inf})", R"({"a":1e400})", "{\"a\":\"\n\"}", R"({a:1})"})
        EXPECT_FALSE(readHaplyState(text, state)) << text;
    for (const char* text : {"{}", " {\"a\" : [ ] , \"b\":{}}\n", R"({"inverse3":{},"verse_grip":[[]]})"})
        EXPECT_TRUE(readHaplyState(text, state)) << text;
    EXPECT_EQ(state.armCount, 0u);
    std::string deep;
    for (int i = 0; i < 31; ++i)
        deep += "[";
    const std::string shut(31, ']');
    EXPECT_TRUE(readHaplyState("{\"a\":" + deep + shut + "}", state));
    EXPECT_FALSE(readHaplyState("{\"a\":[" + deep + shut + "]}", state)) << "33 deep";
    EXPECT_FALSE(readHaplyState("{\"a\":" + std::string(500'000, '['), state));
    std::string many = R"({"inverse3":[)";
    for (int i = 0; i < 20; ++i)
        many += (i > 0 ? ",{\"device_id\":\"" : "{\"device_id\":\"") + std::to_string(i) + "\"}";
    EXPECT_TRUE(readHaplyState(many + "]}", state));
    EXPECT_EQ(state.armCount, HaplyState::kMost);
    EXPECT_TRUE(readHaplyState(R"({"inverse3":[{"device_id":")" + std::string(500, 'x') + "\"}]}", state));
    EXPECT_EQ(textOf(state.arms[0].id).size(), 63u);
}

TEST(HaplyScanner, survivesWhateverIsDoneToAMessage) {
    std::mt19937_64 random(test::seed());
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    int read = 0, refused = 0;
    HaplyState state;
    for (int i = 0; i < 20'000; ++i) {
        std::string text(kInventory);
        for (std::size_t k = 1 + below(8); k > 0; --k) {
            const std::size_t at = below(text.size()), other = below(text.size());
            switch (below(6)) {
                case 0:
                    text[at] = static_cast<char>(random());
                    break;
                case 1:
                    text.resize(at + 1);
                    break;
                case 2:
                    text.erase(at, 1 + below(20));
                    break;
                case 3:
                    text.insert(at, text.substr(other, below(200)));
                    break;
                case 4:
                    text[at] = "{}[]\",:\\-0eE.tfn"[below(16)];
                    break;
                default:
                    std::swap(text[at], text[other]);
                    break;
            }
            if (text.empty()) text = "{";
        }
        if (!readHaplyState(text, state)) {
            ++refused;
            continue;
        }
        ++read;
        ASSERT_LE(state.armCount, HaplyState::kMost);
        ASSERT_LE(state.gripCount, HaplyState::kMost);
        for (std::size_t a = 0; a < state.armCount; ++a) {
            ASSERT_EQ(state.arms[a].id.back(), '\0');
            for (const double p : state.arms[a].positionM)
                ASSERT_TRUE(std::isfinite(p)) << text;
        }
    }
    EXPECT_GT(read, 100);
    EXPECT_GT(refused, 1000);
}

TEST(HaplyScanner, whatIsWrittenIsNoMoreThanAForce) {
    std::array<char, 256> out{};
    const auto written = [&](std::string_view id, const std::array<double, 3>& f, std::size_t room) {
        return std::string(out.data(), writeHaplyForce(id, f, true, out.data(), room));
    };
    EXPECT_EQ(
        written("049D", {0.5, -1.25, 0}, out.size()),
        R"({"inverse3":[{"device_id":"049D","commands":{"set_cursor_force":{"vector":{"x":0.500000,"y":-1.250000,"z":0.000000}}}}]})");
    const std::size_t size = written("049D", {}, out.size()).size();
    EXPECT_EQ(written("049D", {}, size).size(), size);
    for (std::size_t room = 0; room < size; ++room)
        EXPECT_EQ(written("049D", {}, room), "");
    EXPECT_EQ(written("049D", {std::numeric_limits<double>::quiet_NaN(), 0, 0}, out.size()), "");
    EXPECT_EQ(written("049D", {0, std::numeric_limits<double>::infinity(), 0}, out.size()), "");
    EXPECT_EQ(written("049D", {0, 0, 1e9}, out.size()), "");
}

}  // namespace
}  // namespace handpiece::drivers::haply_test
