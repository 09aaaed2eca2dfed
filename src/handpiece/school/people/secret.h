// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Passwords and tokens, by libsodium.

#include <string>
#include <string_view>

namespace handpiece::school {

/// Argon2id with 19 MiB and two passes (the least that OWASP's password storage sheet gives [R]): a room that logs in
/// at once must not fill a small server's memory. A text that carries its own salt and parameters.
/// Throws core::Error ("no-memory") where there is no room for it.
[[nodiscard]] std::string hashOfPassword(std::string_view password);
/// False also for a hash that is none. As long as for a right one.
[[nodiscard]] bool isPassword(const std::string& hash, std::string_view password);
/// True for one that was made with less than is used now: hash again at the next log-in.
[[nodiscard]] bool isHashOutdated(const std::string& hash);
/// What the time of an answer would tell of a login that does not exist: as long as isPassword() for one that does.
void spendPasswordTime(std::string_view password);
/// Throws core::Error ("password-unfit") unless it has 10 characters to 256 bytes and neither is nor has its login.
void requireGoodPassword(std::string_view password, std::string_view login);

/// 256 random bits as 64 hexadecimal digits: a log-in's token, a station's key.
[[nodiscard]] std::string newSecret();
/// One-time code to type: 12 of 32 letters and digits that nobody mistakes for each other (60 bits), in threes.
[[nodiscard]] std::string newStationCode();
/// As typed: small letters, spaces and missing hyphens count as the code they mean.
[[nodiscard]] std::string typedStationCode(std::string_view typed);
/// Of this text, by whoever has the key (up to 64 bytes of it count): 64 hexadecimal digits.
[[nodiscard]] std::string sealOf(std::string_view key, std::string_view text);
/// Proves that a form came from a page of this log-in: made from its token, and does not tell it.
[[nodiscard]] std::string requestTokenOf(std::string_view loginToken);
/// In the same time wherever they differ.
[[nodiscard]] bool isSameSecret(std::string_view a, std::string_view b);

}  // namespace handpiece::school
