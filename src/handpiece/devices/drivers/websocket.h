// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A WebSocket client (RFC 6455) for a servo thread: takes its memory when it connects and never again, and every call
/// ends by its deadline. Plain `ws` to a service on this machine; no compression, no TLS.
///
/// Our own, and not Boost.Beast (9.7 s to compile for the plainest use, measured): Beast's blocking calls have no
/// deadline, and its others allocate.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::drivers {

class WebSocket {
  public:
    enum class Got : std::uint8_t {
        message,
        nothing,  ///< before the deadline
        closed,   ///< the other side is gone
        broken,   ///< what came is no WebSocket, or larger than it may be
    };

    enum class Reach : std::uint8_t { thisMachine, anywhere };

    /// "ws://host:port/path". Throws core::Error ("websocket-address", "websocket-beyond", "websocket-refused",
    /// "websocket-silent", "websocket-wrong"); `remedy` says how the service is started.
    WebSocket(const std::string& url, std::int64_t timeoutNs, const std::string& remedy,
              Reach reach = Reach::thisMachine);
    ~WebSocket();
    WebSocket(const WebSocket&) = delete;
    WebSocket& operator=(const WebSocket&) = delete;

    /// A whole text message within the time; false: the connection is of no use any more.
    [[nodiscard]] bool send(std::string_view text, std::int64_t timeoutNs) noexcept;
    /// The next whole message; `text` holds until the next call. Answers pings.
    [[nodiscard]] Got receive(std::int64_t timeoutNs, std::string_view& text) noexcept;
    /// The same service by its number: connecting again asks no name server.
    [[nodiscard]] const std::string& numericUrl() const noexcept { return numericUrl_; }
    /// Says goodbye if that takes no time.
    void close() noexcept;

  private:
    void handshake(const std::string& host, const std::string& path, std::int64_t deadlineNs,
                   const std::string& remedy);
    [[nodiscard]] bool sendFrame(std::uint8_t opcode, std::string_view payload, std::int64_t deadlineNs) noexcept;
    [[nodiscard]] bool sendAll(const char* bytes, std::size_t size, std::int64_t deadlineNs) noexcept;
    [[nodiscard]] Got take(std::string_view& text) noexcept;

    std::string url_, numericUrl_;
    int socket_ = -1;
    std::vector<char> in_, out_, message_;
    std::size_t inSize_ = 0, taken_ = 0, messageSize_ = 0;
    bool inMessage_ = false, clearMessage_ = false;
    std::uint64_t maskState_ = 1;
};

/// The answer to a Sec-WebSocket-Key.
[[nodiscard]] std::string webSocketAccept(std::string_view key);

}  // namespace handpiece::drivers
