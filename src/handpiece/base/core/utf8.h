// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Text as pages and databases take it.

#include <cstddef>
#include <string>
#include <string_view>

namespace handpiece::core {

/// Bytes of the UTF-8 character that begins the text (RFC 3629); 0: none does.
[[nodiscard]] std::size_t utf8Length(std::string_view text) noexcept;
/// Bytes until the first that is none of UTF-8; all of them where there is none.
[[nodiscard]] std::size_t utf8Prefix(std::string_view text) noexcept;
/// With every byte that is none of UTF-8 written out (backslash, x, two digits): names of files are bytes.
[[nodiscard]] std::string asUtf8(std::string_view text);
/// For a terminal, on one line: a blank for each end of line and tab, a question mark for every other control character
/// (C0, DEL, C1). A terminal obeys them, and a NUL ends the sentence for whoever prints it as a C string.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace handpiece::core
