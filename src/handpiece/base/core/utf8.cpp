// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/utf8.h"

namespace handpiece::core {

std::size_t utf8Length(std::string_view text) noexcept {
    const auto byte = [text](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    if (text.empty()) return 0;
    const unsigned first = byte(0), second = byte(1);
    const std::size_t length = first < 0x80   ? 1
                               : first < 0xc2 ? 0
                               : first < 0xe0 ? 2
                               : first < 0xf0 ? 3
                               : first < 0xf5 ? 4
                                              : 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xc0u) != 0x80u) return 0;
    // Too long a form of a small number, halves of pairs, beyond the last.
    const bool isWrong = (first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) ||
                         (first == 0xf0 && second < 0x90) || (first == 0xf4 && second >= 0x90);
    return isWrong ? 0 : length;
}

std::size_t utf8Prefix(std::string_view text) noexcept {
    std::size_t at = 0;
    while (const std::size_t length = utf8Length(text.substr(at)))
        at += length;
    return at;
}

std::string asUtf8(std::string_view text) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string out;
    for (std::size_t good = utf8Prefix(text); good < text.size(); good = utf8Prefix(text)) {
        const auto odd = static_cast<unsigned char>(text[good]);
        out.append(text.substr(0, good)).append("\\x");
        out += kDigits[odd >> 4];
        out += kDigits[odd & 15u];
        text.remove_prefix(good + 1);
    }
    return out.append(text);
}

std::string printable(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0u;
        if (byte == '\n' || byte == '\r' || byte == '\t')
            out += ' ';
        else if (byte < 0x20 || byte == 0x7f)
            out += '?';
        else if (byte == 0xc2 && next >= 0x80 && next < 0xa0)
            out += '?', ++i;
        else
            out += text[i];
    }
    return out;
}

}  // namespace handpiece::core
