// SPDX-License-Identifier: Apache-2.0
#include "school/slow_guard.h"

#include <fcntl.h>
#include <linux/tcp.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace handpiece::school_server {
namespace {

struct Address {
    int family = AF_UNSPEC, port = -1;
    std::string host{};    ///< its bytes; empty: any of this machine
    std::string remote{};  ///< "address port", as the HTTP library writes them
};

using Name = int (*)(int, sockaddr*, socklen_t*);
/// None where it is no socket of this kind, or not connected.
std::optional<Address> addressBy(Name name, int fd) {
    sockaddr_storage got{};
    socklen_t size = sizeof got;
    if (name(fd, reinterpret_cast<sockaddr*>(&got), &size) != 0) return {};
    char host[NI_MAXHOST], service[NI_MAXSERV];
    if (getnameinfo(reinterpret_cast<const sockaddr*>(&got), size, host, sizeof host, service, sizeof service,
                    NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        return {};
    const std::string remote = std::string(host) + " " + service;
    const auto of = [&](int family, int port, const auto& numbers) {
        const std::string bytes(reinterpret_cast<const char*>(&numbers), sizeof numbers);
        return Address{family, ntohs(static_cast<std::uint16_t>(port)),
                       bytes.find_first_not_of('\0') == bytes.npos ? std::string() : bytes, remote};
    };
    if (got.ss_family == AF_INET) {
        const auto& four = reinterpret_cast<const sockaddr_in&>(got);
        return of(AF_INET, four.sin_port, four.sin_addr);
    }
    if (got.ss_family != AF_INET6) return {};
    const auto& six = reinterpret_cast<const sockaddr_in6&>(got);
    return of(AF_INET6, six.sin6_port, six.sin6_addr);
}

/// Of this process, one more name: what it means stays the same until it is closed, whoever closes the other.
struct Held {
    explicit Held(int of) : fd(fcntl(of, F_DUPFD_CLOEXEC, 0)) {}
    ~Held() {
        if (fd >= 0) close(fd);
    }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;
    const int fd;
};

/// The connections that came by this socket, and who is at the other end.
void eachConnection(int listening, const std::function<void(int fd, const std::string& remote)>& look) {
    const std::optional<Address> here = addressBy(getsockname, listening);
    if (!here) return;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", none)) {
        int number = -1;
        const std::string name = entry.path().filename().string();
        if (std::from_chars(name.data(), name.data() + name.size(), number).ec != std::errc() ||
            !std::filesystem::read_symlink(entry.path(), none).string().starts_with("socket:"))
            continue;
        const Held held(number);
        const std::optional<Address> own = addressBy(getsockname, held.fd), other = addressBy(getpeername, held.fd);
        if (!own || !other || own->family != here->family || own->port != here->port ||
            (!here->host.empty() && own->host != here->host))
            continue;
        look(held.fd, other->remote);
    }
}

/// Between two looks: what a head without end can grow meanwhile.
constexpr auto kOftenEnough = std::chrono::milliseconds(100);

}  // namespace

SlowGuard::SlowGuard(int listening, std::chrono::milliseconds window) : listening_(listening), window_(window) {
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

void SlowGuard::admit(const std::string& remote, std::uint64_t bytes) {
    const std::lock_guard lock(mutex_);
    admitted_[remote] += bytes + bytes / 16 + kMostHead;  // what TLS adds
}

void SlowGuard::hearNoMore(const std::string& remote) {
    eachConnection(listening_, [&](int fd, const std::string& other) {
        if (other == remote) shutdown(fd, SHUT_RD);
    });
}

SlowGuard::Working::Working(SlowGuard& guard, std::string remote) : guard_(guard), remote_(std::move(remote)) {
    const std::lock_guard lock(guard_.mutex_);
    guard_.working_.insert(remote_);
}
SlowGuard::Working::~Working() {
    const std::lock_guard lock(guard_.mutex_);
    if (const auto found = guard_.working_.find(remote_); found != guard_.working_.end()) guard_.working_.erase(found);
}

void SlowGuard::watch() {
    std::unique_lock lock(mutex_);
    const auto pause = std::min(std::chrono::milliseconds(window_ / 10), kOftenEnough);
    while (!wake_.wait_for(lock, pause, [this] { return ends_; }))
        look(std::chrono::steady_clock::now());
}

void SlowGuard::look(std::chrono::steady_clock::time_point now) {
    std::map<std::uint64_t, Watched> there;
    eachConnection(listening_, [&](int fd, const std::string& remote) {
        tcp_info info{};
        socklen_t size = sizeof info;
        struct stat file {};
        int unread = 0;
        if (getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || fstat(fd, &file) != 0 ||
            ioctl(fd, FIONREAD, &unread) != 0)
            return;
        const std::uint64_t bytes = info.tcpi_bytes_received + info.tcpi_bytes_acked;
        const auto known = watched_.find(file.st_ino);
        Watched one = known == watched_.end() ? Watched{now, bytes} : known->second;
        if (const auto more = admitted_.find(remote); more != admitted_.end()) {
            one.mayRead += more->second;
            admitted_.erase(more);
        }
        if (working_.count(remote) > 0 || bytes >= one.bytes + kLeastBytes) one.since = now, one.bytes = bytes;
        const bool isTooMuch = info.tcpi_bytes_received > one.mayRead + static_cast<std::uint64_t>(unread);
        if (isTooMuch || now - one.since >= window_) {
            // Its thread hears the end and goes on to the next.
            shutdown(fd, SHUT_RDWR);
            return;
        }
        there.emplace(file.st_ino, one);
    });
    // Of connections that are gone.
    admitted_.clear();
    watched_ = std::move(there);
}

}  // namespace handpiece::school_server
