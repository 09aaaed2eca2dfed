// SPDX-License-Identifier: Apache-2.0
#include "handpiece/model/case/toml_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "handpiece/base/core/utf8.h"

namespace handpiece::cases {

std::string tomlText(std::string_view text) {
    std::string out = "\"";
    while (!text.empty()) {
        const std::size_t length = core::utf8Length(text);
        const char c = text[0];
        if (length == 0)
            out += '?';
        else if (c == '"' || c == '\\')
            out += fmt::format("\\{}", c);
        else if (c == '\n')
            out += "\\n";
        else if (length == 1 && (static_cast<unsigned char>(c) < 0x20 || c == 0x7f))
            out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
        else
            out += text.substr(0, length);
        text.remove_prefix(std::max<std::size_t>(1, length));
    }
    return out + '"';
}

std::string tomlList(std::span<const std::string> texts) {
    std::string out;
    for (const std::string& text : texts)
        out += (out.empty() ? "" : ", ") + tomlText(text);
    return "[" + out + "]";
}

std::string tomlNumber(double value) {
    std::string text = fmt::format("{}", value);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
}

}  // namespace handpiece::cases
