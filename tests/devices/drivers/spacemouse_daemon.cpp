// SPDX-License-Identifier: Apache-2.0
#include "devices/drivers/spacemouse_daemon.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace handpiece::test {
namespace {

using Packet = std::array<std::int32_t, 8>;

bool readAll(int socket, void* bytes, std::size_t size) {
    auto* at = static_cast<char*>(bytes);
    while (size > 0) {
        const ssize_t got = ::recv(socket, at, size, 0);
        if (got <= 0) return false;
        at += got;
        size -= static_cast<std::size_t>(got);
    }
    return true;
}

}  // namespace

SpaceMouseDaemon::SpaceMouseDaemon(std::string path, int version) : path_(std::move(path)), version_(version) {
    ::unlink(path_.c_str());
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path_.size() >= sizeof address.sun_path) throw std::runtime_error("too long a path: " + path_);
    std::copy(path_.begin(), path_.end(), address.sun_path);
    listening_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    if (::bind(listening_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 || ::listen(listening_, 8) != 0)
        throw std::runtime_error("cannot listen at " + path_);
    listener_ = std::thread([this] {
        for (;;) {
            const int client = ::accept(listening_, nullptr, nullptr);
            if (client < 0) return;
            const std::lock_guard lock(mutex_);
            if (ends_) {
                ::close(client);
                return;
            }
            clients_.push_back(client);
            threads_.emplace_back([this, client] { serve(client); });
        }
    });
}

SpaceMouseDaemon::~SpaceMouseDaemon() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
        for (const int client : clients_)
            ::shutdown(client, SHUT_RDWR);
        ::shutdown(listening_, SHUT_RDWR);
    }
    changed_.notify_all();
    listener_.join();
    for (std::thread& thread : threads_)
        thread.join();
    ::close(listening_);
    ::unlink(path_.c_str());
}

void SpaceMouseDaemon::serve(int client) {
    std::int32_t word = 0;
    bool good = readAll(client, &word, sizeof word);
    if (good && version_ >= 1) {
        good = word == (0x7faa0000 | 0x5500 | 1);
        if (good) {
            good = ::send(client, &word, sizeof word, MSG_NOSIGNAL) == sizeof word;
        } else {
            const std::lock_guard lock(mutex_);
            ++breaches_;
            breach_ = "the first word asks for no protocol";
        }
    }
    Packet question{};
    // Version 0 takes words for sensitivities, whatever they are.
    while (good) {
        good = version_ >= 1 ? readAll(client, question.data(), sizeof question) && answer(client, question)
                             : readAll(client, &word, sizeof word);
    }
    const std::lock_guard lock(mutex_);
    clients_.erase(std::find(clients_.begin(), clients_.end(), client));
    ::close(client);
}

bool SpaceMouseDaemon::answer(int client, const Packet& question) {
    std::unique_lock lock(mutex_);
    while (!ends_ && std::chrono::steady_clock::now() < stalledUntil_)
        changed_.wait_until(lock, stalledUntil_);
    if (ends_) return false;
    ++questions_;
    const auto tell = [&](const Packet& packet) {
        return ::send(client, packet.data(), sizeof packet, MSG_NOSIGNAL) == sizeof packet;
    };
    Packet reply{question[0]};
    bool good = true;
    if (question[0] == 0x7faa2000) {  // its name, 24 bytes at a time
        const std::string name = "3Dconnexion SpaceMouse Compact";
        reply[7] = there_ ? static_cast<std::int32_t>(name.size()) : -1;
        if (there_) {
            std::memcpy(&reply[1], name.data(), 24);
            good = tell(reply);
            reply = {question[0]};
            std::memcpy(&reply[1], name.data() + 24, name.size() - 24);
            reply[7] = static_cast<std::int32_t>(name.size() - 24) | 0x10000;
        }
    } else if (question[0] == 0x7faa2002) {  // how many axes
        reply[1] = 6;
        reply[7] = there_ ? 0 : -1;
    } else {
        ++breaches_;
        breach_ = "an unknown question " + std::to_string(question[0]);
        reply[7] = -1;
    }
    good = good && tell(reply);
    changed_.notify_all();
    return good;
}

void SpaceMouseDaemon::send(const void* bytes, std::size_t size) {
    const std::lock_guard lock(mutex_);
    for (const int client : clients_)
        (void)::send(client, bytes, size, MSG_NOSIGNAL);  // a client that has gone is noticed by its thread
}

void SpaceMouseDaemon::motion(const std::array<int, 6>& counts) {
    Packet event{0};
    std::copy(counts.begin(), counts.end(), event.begin() + 1);
    event[7] = 8;
    send(event.data(), sizeof event);
}

void SpaceMouseDaemon::button(int number, bool pressed) {
    const Packet event{pressed ? 1 : 2, number};
    send(event.data(), sizeof event);
}

void SpaceMouseDaemon::plug(bool there) {
    const std::lock_guard lock(mutex_);
    there_ = there;
}

void SpaceMouseDaemon::stall(double seconds) {
    const std::lock_guard lock(mutex_);
    stalledUntil_ = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                           std::chrono::duration<double>(seconds));
}

bool SpaceMouseDaemon::settle() {
    std::unique_lock lock(mutex_);
    const std::uint64_t then = questions_;
    return changed_.wait_for(lock, std::chrono::seconds(10), [&] { return questions_ >= then + 3; });
}

std::size_t SpaceMouseDaemon::clients() const {
    const std::lock_guard lock(mutex_);
    return clients_.size();
}
unsigned SpaceMouseDaemon::breaches() const {
    const std::lock_guard lock(mutex_);
    return breaches_;
}
std::string SpaceMouseDaemon::lastBreach() const {
    const std::lock_guard lock(mutex_);
    return breach_;
}

}  // namespace handpiece::test
