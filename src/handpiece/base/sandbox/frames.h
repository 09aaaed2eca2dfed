// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a sandbox's child is given, and what it sends: pieces of one letter, their length in 4 bytes, their bytes.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::sandbox {

enum class Frame : char {
    ready = 'r',     ///< locked in; what goes wrong from here on is the fault of what is read
    progress = 'p',  ///< in thousandths, as text
    text = 't',
    bytes = 'b',
    end = 'e',    ///< the answer is whole
    error = 'x',  ///< strings: id, problem, where, remedy, arguments
};
constexpr std::size_t kHeadBytes = 5;
constexpr std::size_t kMostErrorBytes = 64u << 10;

inline void put(std::string& out, std::uint64_t number, int bytes = 8) {
    for (int i = 0; i < bytes; ++i)
        out += static_cast<char>(number >> (8 * i));
}
inline void put(std::string& out, std::string_view text) {
    put(out, text.size());
    out += text;
}

/// Takes off the front of what put() made. `isWhole` turns false, and all further answers are empty, where it ends
/// before.
class Taker {
  public:
    explicit Taker(std::string_view from) : left_(from) {}
    std::uint64_t number(int bytes = 8) {
        if (!isWhole || left_.size() < static_cast<std::size_t>(bytes)) return isWhole = false, 0;
        std::uint64_t value = 0;
        for (int i = 0; i < bytes; ++i)
            value |= std::uint64_t{static_cast<unsigned char>(left_[static_cast<std::size_t>(i)])} << (8 * i);
        left_.remove_prefix(static_cast<std::size_t>(bytes));
        return value;
    }
    std::string text() {
        const std::uint64_t size = number();
        if (!isWhole || size > left_.size()) return isWhole = false, std::string();
        const std::string out(left_.substr(0, size));
        left_.remove_prefix(size);
        return out;
    }
    [[nodiscard]] bool isEmpty() const { return left_.empty(); }

    bool isWhole = true;

  private:
    std::string_view left_;
};

/// What the child is told before its request.
struct Order {
    std::uint64_t memoryBytes = 0, cpuS = 0;
    std::vector<std::string> readable{};
    std::string request{};

    [[nodiscard]] std::string packed() const {
        std::string out;
        put(out, memoryBytes), put(out, cpuS), put(out, readable.size());
        for (const std::string& one : readable)
            put(out, one);
        put(out, request);
        return out;
    }
    [[nodiscard]] static bool unpack(std::string_view from, Order& order) {
        Taker taker(from);
        order.memoryBytes = taker.number(), order.cpuS = taker.number();
        for (std::uint64_t n = taker.number(); taker.isWhole && n > 0; --n)
            order.readable.push_back(taker.text());
        order.request = taker.text();
        return taker.isWhole && taker.isEmpty();
    }
};

/// Locks this process in, for good: memory and time, files (Landlock), system calls (seccomp). Before any thread.
/// Empty, or why it is not locked in.
[[nodiscard]] std::string confine(const Order& order);

}  // namespace handpiece::sandbox
