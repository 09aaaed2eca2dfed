// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A picture as a station sends them.

#include <string>
#include <string_view>

namespace handpiece::school_server {

/// 48 x 32, grey, of libjpeg-turbo (cjpeg).
inline std::string picture(char mark = 0) {
    constexpr std::string_view hex =
        "ffd8ffe000104a46494600010100000100010000ffdb004300140e0f120f0d14121012171514181e32211e1c1c1e3d2c2e24"
        "3249404c4b47404645505a736250556d5645466488656d777b8182814e608d978c7d96737e817cffc0000b08002000300101"
        "1100ffc400160001010100000000000000000000000000000506ffc400161000030000000000000000000000000000001461"
        "ffda0008010100003f00d3b543543543543543548ad50d50d50d50d50d522b5435435435435435488d50d50d50d50d50d53f"
        "ffd9";
    std::string bytes;
    for (std::size_t i = 0; i < hex.size(); i += 2)
        bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
    // A comment of one letter, by which it is known again.
    return mark == 0 ? bytes : bytes.substr(0, 2) + std::string("\xFF\xFE\0\x03", 4) + mark + bytes.substr(2);
}

}  // namespace handpiece::school_server
