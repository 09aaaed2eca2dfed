// SPDX-License-Identifier: Apache-2.0
#include "school/local_server.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <string>
#include <string_view>

#include "school/growing_pool.h"

namespace handpiece::school_exam {
namespace {

constexpr std::string_view kAccount = "account ";
constexpr int kPatienceMs = 20'000, kSliceMs = 100, kIdleSlices = 50;

class LocalStream final : public httplib::Stream {
  public:
    explicit LocalStream(socket_t socket) : socket_(socket) {}
    [[nodiscard]] bool isThere(short what, int patienceMs) const {
        pollfd one{socket_, what, 0};
        int got = 0;
        while ((got = poll(&one, 1, patienceMs)) < 0 && errno == EINTR)
            ;
        return got > 0;
    }
    [[nodiscard]] bool is_readable() const override { return isThere(POLLIN, kPatienceMs); }
    [[nodiscard]] bool is_writable() const override { return isThere(POLLOUT, kPatienceMs); }
    ssize_t read(char* to, std::size_t size) override {
        if (!is_readable()) return -1;
        ssize_t n = 0;
        while ((n = recv(socket_, to, size, 0)) < 0 && errno == EINTR)
            ;
        return n;
    }
    ssize_t write(const char* from, std::size_t size) override {
        if (!is_writable()) return -1;
        ssize_t n = 0;
        while ((n = send(socket_, from, size, MSG_NOSIGNAL)) < 0 && errno == EINTR)
            ;
        return n;
    }
    void get_remote_ip_and_port(std::string& ip, int& port) const override {
        ucred other{};
        socklen_t size = sizeof other;
        port = 0;
        ip = getsockopt(socket_, SOL_SOCKET, SO_PEERCRED, &other, &size) == 0
                 ? std::string(kAccount) + std::to_string(other.uid)
                 : std::string();
    }
    void get_local_ip_and_port(std::string& ip, int& port) const override { ip.clear(), port = 0; }
    [[nodiscard]] socket_t socket() const override { return socket_; }

  private:
    const socket_t socket_;
};

}  // namespace

std::optional<uid_t> LocalServer::accountOf(const httplib::Request& request) {
    std::string_view said = request.remote_addr;
    uid_t account = 0;
    if (!said.starts_with(kAccount)) return {};
    said.remove_prefix(kAccount.size());
    const auto [end, ec] = std::from_chars(said.data(), said.data() + said.size(), account);
    return ec == std::errc() && end == said.data() + said.size() ? std::optional(account) : std::nullopt;
}

LocalServer::LocalServer() {
    constexpr std::size_t kMost = 400;
    new_task_queue = [] { return new school_server::GrowingPool(kMost); };
}

bool LocalServer::process_and_close_socket(socket_t socket) {
    LocalStream stream(socket);
    ucred other{};
    socklen_t size = sizeof other;
    bool isWell = getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &other, &size) == 0;
    {
        const std::lock_guard lock(mutex_);
        isWell = ++open_[other.uid] <= kMostOfAccount && isWell;
    }
    // In slices, so that who ends the server waits for none that says nothing.
    for (int idle = 0; isWell && idle < kIdleSlices && svr_sock_ != INVALID_SOCKET; ++idle) {
        if (!stream.isThere(POLLIN, kSliceMs)) continue;
        bool isClosed = false;
        isWell = process_request(stream, false, isClosed, nullptr) && !isClosed;
        idle = 0;
    }
    shutdown(socket, SHUT_RDWR);
    close(socket);
    const std::lock_guard lock(mutex_);
    if (--open_[other.uid] == 0) open_.erase(other.uid);
    return isWell;
}

}  // namespace handpiece::school_exam
