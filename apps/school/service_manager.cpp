// SPDX-License-Identifier: Apache-2.0
#include "school/service_manager.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "studies/progress_bar.h"

namespace handpiece::school_cli {
namespace {

std::atomic<bool> terminated{false};
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void tellManager(const char* state) {
    const char* const address = std::getenv("NOTIFY_SOCKET");
    if (!address || (*address != '/' && *address != '@')) return;
    sockaddr_un to{};
    to.sun_family = AF_UNIX;
    const std::size_t length = std::strlen(address);
    if (length >= sizeof to.sun_path) return;
    std::memcpy(to.sun_path, address, length);
    if (*address == '@') to.sun_path[0] = '\0';
    const int line = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (line < 0) return;
    if (sendto(line, state, std::strlen(state), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to),
               static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + length)) < 0)
        std::fprintf(stderr, "handpiece-school: the service manager does not hear: %s\n", std::strerror(errno));
    close(line);
}

void listenForEnd() {
    std::signal(SIGTERM, [](int) { terminated = true; });
}

void waitForEnd(const std::atomic<bool>& ended) {
    while (!studies::cancelled() && !terminated && !ended)
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
}

}  // namespace handpiece::school_cli
