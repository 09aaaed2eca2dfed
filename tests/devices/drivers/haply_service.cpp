// SPDX-License-Identifier: Apache-2.0
// Asio's fences: GCC says of each that its thread sanitizer does not see them. Nothing here relies on them.
#if defined(__SANITIZE_THREAD__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wtsan"
#endif

#include "devices/drivers/haply_service.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace handpiece::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using Clock = std::chrono::steady_clock;

std::string vec3(const std::array<double, 3>& v) {
    return fmt::format(R"({{ "x": {}, "y": {}, "z": {} }})", v[0], v[1], v[2]);
}

}  // namespace

struct HaplyService::State {
    mutable std::mutex mutex;
    std::condition_variable changed;
    std::vector<SimulatedArm> arms;
    std::vector<std::uint64_t> owner;  // session that commands the arm; 0: none
    std::string garbage, bytes, breach;
    std::size_t piece = 0;
    bool older = false, alive = false;
    unsigned breaches = 0;
    std::uint64_t sessions = 0;
    Clock::time_point stalledUntil{};
    unsigned short port = 0;
    std::set<int> sockets;  // open ones, to be cut
    int listening = -1;
    std::thread listener;
    std::vector<std::thread> threads;

    void listen();
    void session(tcp::socket socket);
    bool waitWhileStalled(std::unique_lock<std::mutex>& lock) {
        while (alive && Clock::now() < stalledUntil)
            changed.wait_until(lock, stalledUntil);
        return alive;
    }
    [[nodiscard]] std::string inventory(bool withConfig) const;
    void take(const std::string& message, std::uint64_t session);
};

std::string HaplyService::State::inventory(bool withConfig) const {
    std::string text = "{";
    if (!older) text += R"("session_id": 7, )";
    text += R"("inverse3": [)";
    bool first = true;
    for (std::size_t i = 0; i < arms.size(); ++i) {
        const SimulatedArm& a = arms[i];
        if (a.gone) continue;
        text += fmt::format(R"({}{{ "device_id": "{}", )", first ? "" : ", ", a.id);
        first = false;
        if (withConfig)
            text += fmt::format(
                R"("config": {{ "type": "{}", "port": "COM12", "device_info": {{ "major_version": 7, "id": "{}", "uuid": "\u2026\"}}{{" }}, )"
                R"("extended_firmware_version": "8C20FDC8", "gravity_compensation": {{ "enabled": true, "scaling_factor": 1.0 }}, )"
                R"("preset": "defaults", "basis": {{ "permutation": "{}" }}, "mount": {{ "position": {{ "x": 0, "y": 0, "z": 0 }}, )"
                R"("scale": {{ "x": {}, "y": 1, "z": 1 }} }}, "filters": {{ "force_gate": {{ "gain": 0.3 }} }} }}, )",
                a.type, a.id, a.basis, a.scale);
        text += fmt::format(
            R"("state": {{ "cursor_position": {}, "cursor_velocity": {}, "angular_position": {{ "a0": -69.31704, "a1": 1e2, "a2": 0 }}, )"
            R"("current_cursor_force": {}, "control_mode": "idle", "transform": {{}} }}, )"
            R"("status": {{ "calibrated": {}, "in_use": {}, "power_supply": {}, "ready": {}, "started": true }} }})",
            vec3(a.positionM), vec3({}), vec3(a.forceN), a.calibrated, owner[i] != 0, a.powered, a.ready);
    }
    for (const bool wireless : {true, false}) {
        text += fmt::format(R"(], "{}": [)", wireless ? "wireless_verse_grip" : "verse_grip");
        first = true;
        for (const SimulatedArm& a : arms) {
            if (a.gone || a.gripGone || a.gripId.empty() || a.wirelessGrip != wireless) continue;
            const std::string buttons =
                wireless ? fmt::format(R"("buttons": {{ "a": {}, "b": {}, "c": {} }}, "battery_level": 0.8)",
                                       (a.buttons & 1) != 0, (a.buttons & 2) != 0, (a.buttons & 4) != 0)
                         : fmt::format(R"("button": {}, "hall": 0)", (a.buttons & 1) != 0);
            text += fmt::format(
                R"({}{{ "device_id": "{}", "state": {{ "orientation": {{ "x": {}, "y": {}, "z": {}, "w": {} }}, {} }}, "status": {{}} }})",
                first ? "" : ", ", a.gripId, a.grip[1], a.grip[2], a.grip[3], a.grip[0], buttons);
            first = false;
        }
    }
    return text + "] }";
}

/// Exactly what the documentation shows, or a breach.
void HaplyService::State::take(const std::string& message, std::uint64_t session) {
    std::array<char, 64> id{};
    std::array<double, 3> f{};
    int end = -1;
    const std::string form = std::string(R"({"inverse3":[{"device_id":"%63[^"]","commands":{"set_cursor_force":{")") +
                             (older ? "values" : "vector") + R"(":{"x":%lf,"y":%lf,"z":%lf}}}}]}%n)";
    const auto found = [&] {
        for (std::size_t i = 0; i < arms.size(); ++i)
            if (arms[i].id == id.data()) return i;
        return arms.size();
    };
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    const int read = std::sscanf(message.c_str(), form.c_str(), id.data(), &f[0], &f[1], &f[2], &end);
#pragma GCC diagnostic pop
    const std::size_t which = found();
    if (read != 4 || end != static_cast<int>(message.size()) || which == arms.size()) {
        ++breaches;
        breach = "not as documented: " + message;
        return;
    }
    if (owner[which] != 0 && owner[which] != session) {
        ++breaches;
        breach = "a force into an arm that another session holds";
        return;
    }
    owner[which] = session;
    arms[which].forceN = arms[which].gone ? std::array<double, 3>{} : f;
    ++arms[which].count;
}

void HaplyService::State::session(tcp::socket socket) {
    const int handle = socket.native_handle();
    std::uint64_t number = 0;
    {
        const std::lock_guard lock(mutex);
        if (!alive) return;
        sockets.insert(handle);
        number = ++sessions;
    }
    try {
        beast::websocket::stream<tcp::socket&> ws(socket);
        ws.accept();
        ws.text(true);
        const auto answer = [&](bool first) {
            std::string text, raw;
            std::size_t part = 0;
            {
                std::unique_lock lock(mutex);
                if (!waitWhileStalled(lock)) return;
                text = garbage.empty() ? inventory(first) : garbage;
                part = piece;
                raw.swap(bytes);
            }
            if (!raw.empty()) {
                asio::write(socket, asio::buffer(raw));
            } else if (part == 0) {
                ws.write(asio::buffer(text));
            } else {
                ws.auto_fragment(false);
                for (std::size_t at = 0; at < text.size(); at += part) {
                    ws.ping("here?");
                    ws.write_some(at + part >= text.size(),
                                  asio::buffer(text.data() + at, std::min(part, text.size() - at)));
                }
            }
        };
        answer(true);
        beast::flat_buffer buffer;
        for (;;) {
            buffer.clear();
            ws.read(buffer);
            {
                std::unique_lock lock(mutex);
                if (!waitWhileStalled(lock)) break;
                take(beast::buffers_to_string(buffer.data()), number);
            }
            answer(false);
        }
    } catch (const boost::system::system_error&) {
        // Closed, cut, or no WebSocket: the session is over.
    }
    const std::lock_guard lock(mutex);
    sockets.erase(handle);
    for (std::size_t i = 0; i < arms.size(); ++i) {
        if (owner[i] != number) continue;
        owner[i] = 0;
        arms[i].forceN = {};  // a force is applied once and forgotten
    }
}

void HaplyService::State::listen() {
    asio::io_context io;
    boost::system::error_code error;
    tcp::acceptor acceptor(io);
    acceptor.open(tcp::v4(), error);
    acceptor.set_option(asio::socket_base::reuse_address(true), error);
    acceptor.bind({asio::ip::address_v4::loopback(), port}, error);
    acceptor.listen(16, error);
    {
        const std::lock_guard lock(mutex);
        if (error) {
            ++breaches;
            breach = "cannot listen: " + error.message();
        } else {
            port = acceptor.local_endpoint().port();
        }
        listening = acceptor.native_handle();
        alive = true;
    }
    changed.notify_all();
    for (;;) {
        tcp::socket socket(io);
        acceptor.accept(socket, error);
        if (error) break;
        socket.set_option(tcp::no_delay(true), error);
        const std::lock_guard lock(mutex);
        if (!alive) break;
        threads.emplace_back([this, s = std::make_shared<tcp::socket>(std::move(socket))] { session(std::move(*s)); });
    }
    std::vector<std::thread> all;
    {
        const std::lock_guard lock(mutex);
        listening = -1;
        all.swap(threads);
    }
    for (std::thread& thread : all)
        thread.join();  // before the io_context goes
}

HaplyService::HaplyService(int arms) : state_(std::make_unique<State>()) {
    for (int i = 0; i < arms; ++i) {
        SimulatedArm arm;
        if (i > 0) {
            arm.id = fmt::format("04B{}", i);
            arm.gripId = fmt::format("6155{}", i);
        }
        state_->arms.push_back(arm);
    }
    state_->owner.resize(state_->arms.size(), 0);
    revive();
}

HaplyService::~HaplyService() {
    kill();
}

void HaplyService::revive() {
    if (state_->listener.joinable()) return;
    state_->listener = std::thread([this] { state_->listen(); });
    std::unique_lock lock(state_->mutex);
    state_->changed.wait(lock, [&] { return state_->alive; });
}

void HaplyService::kill() {
    {
        const std::lock_guard lock(state_->mutex);
        state_->alive = false;
        for (const int socket : state_->sockets)
            ::shutdown(socket, SHUT_RDWR);
        if (state_->listening >= 0) ::shutdown(state_->listening, SHUT_RDWR);
    }
    state_->changed.notify_all();
    if (state_->listener.joinable()) state_->listener.join();
}

std::string HaplyService::url() const {
    const std::lock_guard lock(state_->mutex);
    return fmt::format("ws://localhost:{}", state_->port);
}
SimulatedArm HaplyService::arm(int which) const {
    const std::lock_guard lock(state_->mutex);
    return state_->arms.at(static_cast<std::size_t>(which));
}
void HaplyService::set(int which, const SimulatedArm& arm) {
    const std::lock_guard lock(state_->mutex);
    SimulatedArm& mine = state_->arms.at(static_cast<std::size_t>(which));
    const auto force = mine.forceN;
    const std::uint64_t count = arm.count == 0 ? 0 : mine.count;
    mine = arm;
    mine.forceN = arm.gone ? std::array<double, 3>{} : force;  // what arrived meanwhile stays
    mine.count = count;
}
void HaplyService::older(bool older) {
    const std::lock_guard lock(state_->mutex);
    state_->older = older;
}
void HaplyService::stall(double seconds) {
    const std::lock_guard lock(state_->mutex);
    state_->stalledUntil =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    state_->changed.notify_all();
}
void HaplyService::say(const std::string& garbage) {
    const std::lock_guard lock(state_->mutex);
    state_->garbage = garbage;
}
void HaplyService::breakFrame(const std::string& bytes) {
    const std::lock_guard lock(state_->mutex);
    state_->bytes = bytes;
}
void HaplyService::fragment(std::size_t bytes) {
    const std::lock_guard lock(state_->mutex);
    state_->piece = bytes;
}
unsigned HaplyService::breaches() const {
    const std::lock_guard lock(state_->mutex);
    return state_->breaches;
}
std::string HaplyService::lastBreach() const {
    const std::lock_guard lock(state_->mutex);
    return state_->breach;
}
std::uint64_t HaplyService::sessions() const {
    const std::lock_guard lock(state_->mutex);
    return state_->sessions;
}

}  // namespace handpiece::test
