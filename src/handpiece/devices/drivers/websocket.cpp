// SPDX-License-Identifier: Apache-2.0
#include "handpiece/devices/drivers/websocket.h"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <random>

#include "handpiece/base/core/error.h"
#include "handpiece/base/rt/clock.h"

namespace handpiece::drivers {
namespace {

constexpr std::size_t kMaxMessage = 256 * 1024;  // a service with every device there is sends a tenth of it
constexpr std::size_t kInput = 80 * 1024;        // more than a frame with a short head, see take()
constexpr std::size_t kMaxSent = 4 * 1024;
constexpr std::size_t kMaxHeader = 14;
constexpr std::uint8_t kContinued = 0x0, kText = 0x1, kBinary = 0x2, kClose = 0x8, kPing = 0x9, kPong = 0xA;

std::string base64(const std::uint8_t* bytes, std::size_t size) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < size; i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = (group << 8) | (i + k < size ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k <= size ? digits[(group >> (18 - 6 * k)) & 63] : '=';
    }
    return text;
}

/// SHA-1 as the handshake wants it; guards nothing.
std::array<std::uint8_t, 20> sha1(std::string_view text) {
    std::array<std::uint32_t, 5> h{0x67452301, 0xEFCDAB89, 0x98BADCFE, 0x10325476, 0xC3D2E1F0};
    std::string padded(text);
    padded += static_cast<char>(0x80);
    while (padded.size() % 64 != 56)
        padded += '\0';
    for (int i = 7; i >= 0; --i)
        padded += static_cast<char>((static_cast<std::uint64_t>(text.size()) * 8 >> (8 * i)) & 0xFF);
    for (std::size_t block = 0; block < padded.size(); block += 64) {
        std::array<std::uint32_t, 80> w{};
        for (std::size_t i = 0; i < 64; ++i)
            w[i / 4] = (w[i / 4] << 8) | static_cast<std::uint8_t>(padded[block + i]);
        for (std::size_t i = 16; i < 80; ++i)
            w[i] = std::rotl(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
        auto [a, b, c, d, e] = h;
        for (std::size_t i = 0; i < 80; ++i) {
            const auto [f, k] = i < 20   ? std::pair((b & c) | (~b & d), 0x5A827999u)
                                : i < 40 ? std::pair(b ^ c ^ d, 0x6ED9EBA1u)
                                : i < 60 ? std::pair((b & c) | (b & d) | (c & d), 0x8F1BBCDCu)
                                         : std::pair(b ^ c ^ d, 0xCA62C1D6u);
            const std::uint32_t next = std::rotl(a, 5) + f + e + k + w[i];
            e = d;
            d = c;
            c = std::rotl(b, 30);
            b = a;
            a = next;
        }
        h = {h[0] + a, h[1] + b, h[2] + c, h[3] + d, h[4] + e};
    }
    std::array<std::uint8_t, 20> digest{};
    for (std::size_t i = 0; i < 20; ++i)
        digest[i] = static_cast<std::uint8_t>(h[i / 4] >> (24 - 8 * (i % 4)));
    return digest;
}

/// Whether the socket is ready before the deadline.
bool await(int socket, short what, std::int64_t deadlineNs) noexcept {
    for (;;) {
        const std::int64_t left = std::max<std::int64_t>(0, deadlineNs - rt::monotonicNs());
        const timespec time{static_cast<time_t>(left / 1'000'000'000), static_cast<long>(left % 1'000'000'000)};
        pollfd one{socket, what, 0};
        const int ready = ::ppoll(&one, 1, &time, nullptr);
        if (ready > 0) return true;
        if (ready == 0 || errno != EINTR) return false;
    }
}

struct Address {
    std::string host, port, path;
};

Address parse(const std::string& url) {
    const auto wrong = [&] {
        return core::Error("this is no address of a WebSocket service", url,
                           "write it as ws://localhost:10001 or ws://127.0.0.1:10001/path")
            .as("websocket-address", {url});
    };
    constexpr std::string_view scheme = "ws://";
    if (!std::string_view(url).starts_with(scheme)) throw wrong();
    Address address;
    std::string rest = url.substr(scheme.size());
    const std::size_t slash = rest.find('/');
    address.path = slash == std::string::npos ? "/" : rest.substr(slash);
    rest = rest.substr(0, slash);
    std::size_t colon = rest.rfind(':');
    if (!rest.empty() && rest.front() == '[') {  // an IPv6 address
        const std::size_t end = rest.find(']');
        if (end == std::string::npos) throw wrong();
        address.host = rest.substr(1, end - 1);
        colon = end + 1 < rest.size() && rest[end + 1] == ':' ? end + 1 : std::string::npos;
    } else {
        address.host = rest.substr(0, colon);
    }
    address.port = colon == std::string::npos ? "80" : rest.substr(colon + 1);
    const auto bad = [](unsigned char c) { return c <= ' ' || c == 127; };
    if (address.host.empty() || address.port.empty() || address.port.size() > 5 ||
        address.port.find_first_not_of("0123456789") != std::string::npos || std::stoi(address.port) > 65535 ||
        std::any_of(address.host.begin(), address.host.end(), bad) ||
        std::any_of(address.path.begin(), address.path.end(), bad))
        throw wrong();
    return address;
}

bool isThisMachine(const sockaddr& address) {
    if (address.sa_family == AF_INET) {
        sockaddr_in four;
        std::memcpy(&four, &address, sizeof four);
        return ntohl(four.sin_addr.s_addr) >> 24 == 127;
    }
    if (address.sa_family != AF_INET6) return false;
    sockaddr_in6 six;
    std::memcpy(&six, &address, sizeof six);
    return IN6_IS_ADDR_LOOPBACK(&six.sin6_addr) ||
           (IN6_IS_ADDR_V4MAPPED(&six.sin6_addr) && six.sin6_addr.s6_addr[12] == 127);
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// The value of a header, without the blanks about it; empty when it is not there.
std::string headerOf(const std::string& head, const std::string& name) {
    const std::string all = lower(head);
    const std::size_t at = all.find("\r\n" + name + ":");
    if (at == std::string::npos) return {};
    const std::size_t begin = head.find_first_not_of(" \t", at + name.size() + 3);
    std::size_t end = head.find("\r\n", at + 2);
    if (begin == std::string::npos || end == std::string::npos || begin >= end) return {};
    while (end > begin && (head[end - 1] == ' ' || head[end - 1] == '\t'))
        --end;
    return head.substr(begin, end - begin);
}

}  // namespace

std::string webSocketAccept(std::string_view key) {
    const auto digest = sha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11");
    return base64(digest.data(), digest.size());
}

WebSocket::WebSocket(const std::string& url, std::int64_t timeoutNs, const std::string& remedy, Reach reach)
    : url_(url), numericUrl_(url), in_(kInput), out_(kMaxSent + kMaxHeader), message_(kMaxMessage) {
    const Address address = parse(url);
    const std::int64_t deadline = rt::monotonicNs() + timeoutNs;
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    // "localhost" is this machine, also where nothing is there to say so (RFC 6761): without a name both loopbacks.
    const char* node = address.host == "localhost" ? nullptr : address.host.c_str();
    if (const int failed = ::getaddrinfo(node, address.port.c_str(), &hints, &found); failed != 0)
        throw core::Error(fmt::format("this host is not known ({})", ::gai_strerror(failed)), url, remedy)
            .as("websocket-refused", {url, ::gai_strerror(failed)});
    int reason = ECONNREFUSED;
    bool anyNear = false;
    for (const addrinfo* a = found; a != nullptr && socket_ < 0; a = a->ai_next) {
        const bool isNear = isThisMachine(*a->ai_addr);
        anyNear = anyNear || isNear;
        if (!isNear && reach == Reach::thisMachine) continue;
        const int s = ::socket(a->ai_family, a->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, a->ai_protocol);
        if (s < 0) continue;
        int result = ::connect(s, a->ai_addr, a->ai_addrlen) == 0 ? 0 : errno;
        if (result == EINPROGRESS) {
            socklen_t size = sizeof result;
            if (!await(s, POLLOUT, deadline)) {
                result = ETIMEDOUT;
            } else if (::getsockopt(s, SOL_SOCKET, SO_ERROR, &result, &size) != 0) {
                result = errno;
            }
        }
        if (result == 0) {
            socket_ = s;
            std::array<char, 64> number{};
            const bool six = a->ai_family == AF_INET6;
            if (::getnameinfo(a->ai_addr, a->ai_addrlen, number.data(), number.size(), nullptr, 0, NI_NUMERICHOST) == 0)
                numericUrl_ = fmt::format("ws://{}{}{}:{}{}", six ? "[" : "", number.data(), six ? "]" : "",
                                          address.port, address.path);
        } else {
            reason = result;
            ::close(s);
        }
    }
    ::freeaddrinfo(found);
    if (!anyNear && reach == Reach::thisMachine)
        throw core::Error("this service is not on this machine, and was not said to be elsewhere", url,
                          "forces would cross a network, unencrypted and late: set HANDPIECE_HAPLY_REMOTE=1 if that is "
                          "meant")
            .as("websocket-beyond", {url});
    if (socket_ < 0)
        throw core::Error(fmt::format("nothing answers there ({})", std::strerror(reason)), url, remedy)
            .as("websocket-refused", {url, std::strerror(reason)});
    const int on = 1;  // a force of sixty bytes is to leave at once
    (void)::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    try {
        const std::string host = address.host.find(':') == std::string::npos ? address.host : "[" + address.host + "]";
        handshake(host + ":" + address.port, address.path, deadline, remedy);
    } catch (...) {
        ::close(socket_);
        throw;
    }
}

WebSocket::~WebSocket() {
    close();
}

void WebSocket::handshake(const std::string& host, const std::string& path, std::int64_t deadlineNs,
                          const std::string& remedy) {
    std::random_device random;
    std::array<std::uint8_t, 16> nonce{};
    for (std::uint8_t& byte : nonce)
        byte = static_cast<std::uint8_t>(random());
    maskState_ = (static_cast<std::uint64_t>(random()) << 32) | random() | 1u;
    const std::string key = base64(nonce.data(), nonce.size());
    const std::string request = fmt::format(
        "GET {} HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {}\r\n"
        "Sec-WebSocket-Version: 13\r\n\r\n",
        path, host, key);
    const auto silent = [&] {
        return core::Error("something listens there but does not answer", url_, remedy).as("websocket-silent", {url_});
    };
    if (!sendAll(request.data(), request.size(), deadlineNs)) throw silent();
    std::string head;
    while (head.find("\r\n\r\n") == std::string::npos) {
        if (head.size() > 16 * 1024) break;
        if (!await(socket_, POLLIN, deadlineNs)) throw silent();
        char c = 0;  // by the byte: what follows the head is the first frame's
        const ssize_t got = ::recv(socket_, &c, 1, 0);
        if (got == 1) {
            head += c;
        } else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
            break;
        }
    }
    const std::string line = head.substr(0, head.find("\r\n"));
    const bool good = line.starts_with("HTTP/1.1 101") && head.ends_with("\r\n\r\n") &&
                      lower(headerOf(head, "upgrade")) == "websocket" &&
                      headerOf(head, "sec-websocket-accept") == webSocketAccept(key);
    if (good) return;
    std::string said = line.substr(0, 60);
    std::replace_if(
        said.begin(), said.end(), [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
    throw core::Error(fmt::format("another program answers there, not a WebSocket service (it said '{}')", said), url_,
                      remedy)
        .as("websocket-wrong", {url_, said});
}

bool WebSocket::sendAll(const char* bytes, std::size_t size, std::int64_t deadlineNs) noexcept {
    while (size > 0) {
        const ssize_t sent = ::send(socket_, bytes, size, MSG_NOSIGNAL);
        if (sent > 0) {
            bytes += sent;
            size -= static_cast<std::size_t>(sent);
        } else if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            if (!await(socket_, POLLOUT, deadlineNs)) return false;
        } else if (sent == 0 || errno != EINTR) {
            return false;
        }
    }
    return true;
}

bool WebSocket::sendFrame(std::uint8_t opcode, std::string_view payload, std::int64_t deadlineNs) noexcept {
    if (socket_ < 0 || payload.size() > kMaxSent) return false;
    char* const p = out_.data();
    std::size_t n = 0;
    p[n++] = static_cast<char>(0x80 | opcode);
    if (payload.size() < 126) {
        p[n++] = static_cast<char>(0x80 | payload.size());
    } else {
        p[n++] = static_cast<char>(0x80 | 126);
        p[n++] = static_cast<char>(payload.size() >> 8);
        p[n++] = static_cast<char>(payload.size() & 0xFF);
    }
    maskState_ ^= maskState_ << 13;
    maskState_ ^= maskState_ >> 7;
    maskState_ ^= maskState_ << 17;
    std::array<char, 4> mask{};
    std::memcpy(mask.data(), &maskState_, mask.size());
    for (const char m : mask)
        p[n++] = m;
    for (std::size_t i = 0; i < payload.size(); ++i)
        p[n++] = static_cast<char>(payload[i] ^ mask[i % 4]);
    return sendAll(p, n, deadlineNs);
}

bool WebSocket::send(std::string_view text, std::int64_t timeoutNs) noexcept {
    return sendFrame(kText, text, rt::monotonicNs() + timeoutNs);
}

WebSocket::Got WebSocket::receive(std::int64_t timeoutNs, std::string_view& text) noexcept {
    const std::int64_t deadline = rt::monotonicNs() + timeoutNs;
    for (;;) {
        if (socket_ < 0) return Got::closed;
        if (const Got got = take(text); got != Got::nothing) return got;
        if (taken_ > 0) {  // what was taken makes room
            std::memmove(in_.data(), in_.data() + taken_, inSize_ - taken_);
            inSize_ -= taken_;
            taken_ = 0;
        }
        if (!await(socket_, POLLIN, deadline)) return Got::nothing;
        const ssize_t got = ::recv(socket_, in_.data() + inSize_, in_.size() - inSize_, 0);
        if (got > 0) {
            inSize_ += static_cast<std::size_t>(got);
        } else if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
            return Got::closed;
        }
    }
}

/// The next message out of what has arrived. A frame's payload is moved over as it comes, so that a message may be
/// larger than one reading of the socket.
WebSocket::Got WebSocket::take(std::string_view& text) noexcept {
    if (clearMessage_) {
        messageSize_ = 0;
        clearMessage_ = false;
    }
    for (;;) {
        const auto at = [&](std::size_t i) { return static_cast<std::uint8_t>(in_[taken_ + i]); };
        const std::size_t have = inSize_ - taken_;
        if (have < 2) return Got::nothing;
        const bool last = (at(0) & 0x80) != 0, control = (at(0) & 0x08) != 0;
        const std::uint8_t opcode = at(0) & 0x0F;
        std::uint64_t size = at(1) & 0x7F;
        std::size_t header = 2;
        // A server's frames are not masked, nothing was agreed on that uses the other bits.
        if ((at(0) & 0x70) != 0 || (at(1) & 0x80) != 0) return Got::broken;
        if (size >= 126) {
            const std::size_t bytes = size == 126 ? 2 : 8;
            header += bytes;
            if (have < header) return Got::nothing;
            size = 0;
            for (std::size_t i = 0; i < bytes; ++i)
                size = (size << 8) | at(2 + i);
        }
        if (control && (size > 125 || !last)) return Got::broken;
        if (!control && (opcode == kContinued) != inMessage_) return Got::broken;
        if (opcode != kContinued && opcode != kText && opcode != kBinary && opcode != kClose && opcode != kPing &&
            opcode != kPong)
            return Got::broken;
        if (!control && size > message_.size() - messageSize_) return Got::broken;
        if (header + size > in_.size()) {
            // Larger than what is read at once: begin with what is there, the rest comes as frames of our own making.
            if (have <= header) return Got::nothing;
            const std::size_t part = have - header;
            std::memcpy(message_.data() + messageSize_, in_.data() + taken_ + header, part);
            messageSize_ += part;
            // Rewrite the head so that it says what is left.
            const std::uint64_t left = size - part;
            taken_ += part;
            in_[taken_] = static_cast<char>((last ? 0x80 : 0) | kContinued);
            in_[taken_ + 1] = 127;
            for (std::size_t i = 0; i < 8; ++i)
                in_[taken_ + 2 + i] = static_cast<char>(left >> (56 - 8 * i));
            inMessage_ = true;
            return Got::nothing;
        }
        if (have < header + size) return Got::nothing;
        const char* const payload = in_.data() + taken_ + header;
        taken_ += header + static_cast<std::size_t>(size);
        if (opcode == kPing) {
            if (!sendFrame(kPong, {payload, static_cast<std::size_t>(size)}, rt::monotonicNs() + 10'000'000))
                return Got::closed;
        } else if (opcode == kClose) {
            return Got::closed;
        } else if (opcode != kPong) {
            std::memcpy(message_.data() + messageSize_, payload, static_cast<std::size_t>(size));
            messageSize_ += static_cast<std::size_t>(size);
            inMessage_ = !last;
            if (last) {
                text = {message_.data(), messageSize_};
                clearMessage_ = true;
                return Got::message;
            }
        }
    }
}

void WebSocket::close() noexcept {
    if (socket_ < 0) return;
    constexpr std::string_view normal("\x03\xE8", 2);  // 1000
    (void)sendFrame(kClose, normal, rt::monotonicNs());
    ::close(socket_);
    socket_ = -1;
}

}  // namespace handpiece::drivers
