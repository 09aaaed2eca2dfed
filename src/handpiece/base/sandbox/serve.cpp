// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <mutex>
#include <new>

#include "handpiece/base/core/any_error.h"
#include "handpiece/base/sandbox/frames.h"
#include "handpiece/base/sandbox/sandbox.h"

namespace handpiece::sandbox {
namespace {

constexpr int kAsked = STDIN_FILENO, kAnswers = STDOUT_FILENO;

bool sendAll(const char* data, std::size_t size) {
    while (size > 0) {
        const ssize_t n = write(kAnswers, data, size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return false;
        data += n, size -= static_cast<std::size_t>(n);
    }
    return true;
}
bool send(Frame kind, const void* data = nullptr, std::size_t size = 0) {
    std::string head(1, static_cast<char>(kind));
    put(head, size, 4);
    return sendAll(head.data(), head.size()) && sendAll(static_cast<const char*>(data), size);
}
bool send(Frame kind, const std::string& text) {
    return send(kind, text.data(), text.size());
}

int refuse(const core::Error& e) {
    std::string text;
    for (const std::string& one : {e.id(), e.problem(), e.where(), e.remedy()})
        put(text, one);
    for (const std::string& one : e.arguments())
        put(text, one);
    if (text.size() > kMostErrorBytes) {
        text.clear();
        for (const std::string& one : {e.id(), e.problem().substr(0, 1000), std::string(), std::string()})
            put(text, one);
    }
    return send(Frame::error, text) ? 0 : 1;
}

bool readAll(std::string& out) {
    char some[16'384];
    for (;;) {
        const ssize_t n = read(kAsked, some, sizeof some);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return n == 0;
        out.append(some, static_cast<std::size_t>(n));
    }
}

}  // namespace

int serve(const Work& work) {
    Order order;
    {
        std::string asked;
        if (!readAll(asked) || !Order::unpack(asked, order)) {
            std::fputs("this program is started by others, to read files from outside\n", stderr);
            return 2;
        }
    }
    if (const std::string why = confine(order); !why.empty()) {
        std::fprintf(stderr, "%s\n", why.c_str());
        return 3;
    }
    if (!send(Frame::ready)) return 1;
    try {
        std::mutex telling;
        int told = -1;
        const core::Progress progress = [&](double fraction) {
            const int now = static_cast<int>(1000.0 * std::clamp(fraction, 0.0, 1.0));
            const std::lock_guard lock(telling);
            if (now > told) told = now, (void)send(Frame::progress, std::to_string(now));
            return true;
        };
        const Answer answer = work(order.request, progress);
        const bool isSent = send(Frame::text, answer.text) &&
                            send(Frame::bytes, answer.bytes.data(), answer.bytes.size()) && send(Frame::end);
        return isSent ? 0 : 1;
    } catch (const std::bad_alloc&) {
        return refuse(core::Error("it takes more memory than anybody's work may").as("sandbox-large"));
    } catch (const std::exception& e) {
        return refuse(core::asError(e));
    }
}

}  // namespace handpiece::sandbox
