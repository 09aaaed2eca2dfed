// SPDX-License-Identifier: Apache-2.0
#include "handpiece/base/core/csv_cell.h"

#include <string_view>

namespace handpiece::core {
namespace {

bool isNumber(const std::string& text) {
    return text.find_first_not_of("0123456789+-.eE") == std::string::npos &&
           text.find_first_of("0123456789") != std::string::npos;
}

}  // namespace

std::string csvCell(std::string text) {
    if (!text.empty() && std::string_view("=+-@\t\r").find(text.front()) != std::string_view::npos && !isNumber(text))
        text.insert(text.begin(), '\'');
    if (text.find_first_of(",;\"\r\n") == std::string::npos && !text.starts_with(' ') && !text.ends_with(' '))
        return text;
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

}  // namespace handpiece::core
