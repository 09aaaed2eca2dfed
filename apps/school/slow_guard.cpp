// SPDX-License-Identifier: Apache-2.0
#include "school/slow_guard.h"

#include <arpa/inet.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <charconv>
#include <filesystem>
#include <string>

namespace handpiece::school_server {
namespace {

int portOf(const sockaddr_storage& address) {
    if (address.ss_family == AF_INET) return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
    if (address.ss_family == AF_INET6) return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
    return -1;
}

}  // namespace

SlowGuard::SlowGuard(int port, std::chrono::milliseconds window) : port_(port), window_(window) {
    thread_ = std::thread([this] { watch(); });
}
SlowGuard::~SlowGuard() {
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

SlowGuard::Working::Working(SlowGuard& guard, int remotePort) : guard_(guard), port_(remotePort) {
    const std::lock_guard lock(guard_.mutex_);
    guard_.working_.insert(port_);
}
SlowGuard::Working::~Working() {
    const std::lock_guard lock(guard_.mutex_);
    if (const auto found = guard_.working_.find(port_); found != guard_.working_.end()) guard_.working_.erase(found);
}

void SlowGuard::watch() {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, window_ / 10, [this] { return ends_; }))
        look(std::chrono::steady_clock::now());
}

void SlowGuard::look(std::chrono::steady_clock::time_point now) {
    std::map<std::uint64_t, Watched> there;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", none)) {
        int fd = -1;
        const std::string name = entry.path().filename().string();
        if (std::from_chars(name.data(), name.data() + name.size(), fd).ec != std::errc()) continue;
        sockaddr_storage own{}, other{};
        socklen_t ownSize = sizeof own, otherSize = sizeof other;
        if (getsockname(fd, reinterpret_cast<sockaddr*>(&own), &ownSize) != 0 || portOf(own) != port_ ||
            getpeername(fd, reinterpret_cast<sockaddr*>(&other), &otherSize) != 0)
            continue;
        tcp_info info{};
        socklen_t size = sizeof info;
        struct stat file {};
        if (getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || fstat(fd, &file) != 0) continue;
        const std::uint64_t bytes = info.tcpi_bytes_received + info.tcpi_bytes_acked;
        const auto known = watched_.find(file.st_ino);
        Watched one = known == watched_.end() ? Watched{now, bytes} : known->second;
        if (working_.count(portOf(other)) > 0 || bytes >= one.bytes + kLeastBytes) one = {now, bytes};
        if (now - one.since >= window_) {
            // Its thread hears the end and goes on to the next.
            shutdown(fd, SHUT_RDWR);
            continue;
        }
        there.emplace(file.st_ino, one);
    }
    watched_ = std::move(there);
}

}  // namespace handpiece::school_server
