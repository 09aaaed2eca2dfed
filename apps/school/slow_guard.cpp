// SPDX-License-Identifier: Apache-2.0
#include "school/slow_guard.h"

#include <dirent.h>
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
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace handpiece::school_server {
namespace {

struct SocketAddress {
    int family = AF_UNSPEC, port = -1;
    std::string host{};  ///< its bytes; empty: any of this machine
    sockaddr_storage whole{};
    socklen_t size = sizeof whole;
};

using Name = int (*)(int, sockaddr*, socklen_t*);
/// None where it is no socket of this kind, or not connected.
std::optional<SocketAddress> addressBy(Name name, int fd) {
    SocketAddress got;
    if (name(fd, reinterpret_cast<sockaddr*>(&got.whole), &got.size) != 0) return {};
    const auto set = [&](std::uint16_t port, const auto& numbers) {
        const std::string bytes(reinterpret_cast<const char*>(&numbers), sizeof numbers);
        got.family = got.whole.ss_family, got.port = ntohs(port);
        if (bytes.find_first_not_of('\0') != bytes.npos) got.host = bytes;
    };
    if (got.whole.ss_family == AF_INET) {
        const auto& four = reinterpret_cast<const sockaddr_in&>(got.whole);
        set(four.sin_port, four.sin_addr);
    } else if (got.whole.ss_family == AF_INET6) {
        const auto& six = reinterpret_cast<const sockaddr_in6&>(got.whole);
        set(six.sin6_port, six.sin6_addr);
    } else {
        return {};
    }
    return got;
}

/// "address port", as the HTTP library writes them; empty: it has none.
std::string remoteOf(const SocketAddress& address) {
    char host[NI_MAXHOST], service[NI_MAXSERV];
    if (getnameinfo(reinterpret_cast<const sockaddr*>(&address.whole), address.size, host, sizeof host, service,
                    sizeof service, NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        return {};
    return std::string(host) + " " + service;
}

/// What counts as one address: of IPv6 its network, for who has one of these has 2^64 of the others.
std::string sourceOf(const SocketAddress& address) {
    constexpr std::string_view kFourInSix("\0\0\0\0\0\0\0\0\0\0\xff\xff", 12);
    if (address.host.starts_with(kFourInSix)) return address.host.substr(kFourInSix.size());
    return address.family == AF_INET6 ? "six " + address.host.substr(0, 8) : address.host;
}

}  // namespace

/// Looks with what it has from the beginning: where descriptors have run out, none is left for looking, and that is
/// when it matters.
class SlowGuard::Sight {
  public:
    explicit Sight(int listening)
        : here_(addressBy(getsockname, listening)),
          folder_(opendir("/proc/self/fd")),
          nothing_(open("/dev/null", O_RDONLY | O_CLOEXEC)),
          held_(fcntl(nothing_, F_DUPFD_CLOEXEC, 0)) {}
    ~Sight() {
        if (folder_ != nullptr) closedir(folder_);
        for (const int fd : {nothing_, held_})
            if (fd >= 0) close(fd);
    }
    Sight(const Sight&) = delete;
    Sight& operator=(const Sight&) = delete;

    /// The connections that came by this socket, and who is at the other end.
    void each(const std::function<void(int fd, const SocketAddress& other)>& look) {
        if (folder_ == nullptr || held_ < 0 || !here_) return;
        const std::lock_guard lock(mutex_);
        rewinddir(folder_);
        while (const dirent* const entry = readdir(folder_)) {
            int number = -1;
            const std::string_view name = entry->d_name;
            if (std::from_chars(name.data(), name.data() + name.size(), number).ec != std::errc() || number == held_ ||
                !isOurs(number))
                continue;
            // One more name of it: what that means stays the same, whoever closes the other meanwhile.
            if (dup3(number, held_, O_CLOEXEC) < 0 || !isOurs(held_)) continue;
            if (const auto other = addressBy(getpeername, held_)) look(held_, *other);
        }
        (void)dup3(nothing_, held_, O_CLOEXEC);
    }

  private:
    [[nodiscard]] bool isOurs(int fd) const {
        const auto own = addressBy(getsockname, fd);
        return own && own->family == here_->family && own->port == here_->port &&
               (here_->host.empty() || own->host == here_->host);
    }

    const std::optional<SocketAddress> here_;
    DIR* const folder_;
    const int nothing_, held_;
    std::mutex mutex_;
};

namespace {

/// Between two looks: what a head without end can grow meanwhile.
constexpr auto kOftenEnough = std::chrono::milliseconds(100);

}  // namespace

SlowGuard::SlowGuard(int listening, std::chrono::milliseconds window, Bounds bounds)
    : window_(window), bounds_(std::move(bounds)), sight_(std::make_unique<Sight>(listening)) {
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
    sight_->each([&](int fd, const SocketAddress& other) {
        if (remoteOf(other) == remote) shutdown(fd, SHUT_RD);
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
    std::vector<Seen> seen;
    sight_->each([&](int fd, const SocketAddress& other) {
        tcp_info info{};
        socklen_t size = sizeof info;
        struct stat file {};
        int unread = 0;
        // Of TCP: open at both ends, or at this one. What was cut off has to be closed by its thread only.
        constexpr int kEstablished = 1, kCloseWait = 8;
        if (getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || fstat(fd, &file) != 0 ||
            ioctl(fd, FIONREAD, &unread) != 0 || (info.tcpi_state != kEstablished && info.tcpi_state != kCloseWait))
            return;
        const std::string remote = remoteOf(other);
        const std::uint64_t bytes = info.tcpi_bytes_received + info.tcpi_bytes_acked;
        const auto known = watched_.find(file.st_ino);
        Watched one = known == watched_.end() ? Watched{now, bytes} : known->second;
        if (const auto more = admitted_.find(remote); more != admitted_.end()) {
            one.mayRead += more->second;
            admitted_.erase(more);
        }
        const bool isAnswered = working_.count(remote) > 0;
        if (isAnswered || bytes >= one.bytes + kLeastBytes) one.since = now, one.bytes = bytes;
        const bool isTooMuch = info.tcpi_bytes_received > one.mayRead + static_cast<std::uint64_t>(unread);
        if (isTooMuch || now - one.since >= window_) {
            // Its thread hears the end and goes on to the next.
            shutdown(fd, SHUT_RDWR);
            return;
        }
        there.emplace(file.st_ino, one);
        const bool isExcepted = bounds_.excepted.count(remote.substr(0, remote.find(' '))) > 0;
        seen.push_back({file.st_ino, one.since, info.tcpi_last_data_recv, isExcepted ? std::string() : sourceOf(other),
                        isAnswered});
    });
    // Of connections that are gone.
    admitted_.clear();
    if (const std::set<std::uint64_t> many = tooMany(seen); !many.empty())
        sight_->each([&](int fd, const SocketAddress&) {
            struct stat file {};
            if (fstat(fd, &file) != 0 || many.count(file.st_ino) == 0) return;
            shutdown(fd, SHUT_RDWR);
            there.erase(file.st_ino);
        });
    watched_ = std::move(there);
}

std::set<std::uint64_t> SlowGuard::tooMany(std::vector<Seen>& seen) const {
    std::map<std::string, std::size_t> ofSource;
    bool isMany = seen.size() > bounds_.all;
    for (const Seen& one : seen)
        if (!one.source.empty() && ++ofSource[one.source] > bounds_.ofAddress) isMany = true;
    std::set<std::uint64_t> gone;
    if (!isMany) return gone;
    std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
        return a.since != b.since ? a.since < b.since : a.silentMs > b.silentMs;
    });
    for (const Seen& one : seen)
        if (!one.isAnswered && !one.source.empty() && ofSource[one.source] > bounds_.ofAddress) {
            --ofSource[one.source];
            gone.insert(one.socket);
        }
    for (const Seen& one : seen)
        if (!one.isAnswered && seen.size() > bounds_.all + gone.size()) gone.insert(one.socket);
    return gone;
}

}  // namespace handpiece::school_server
