// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Signatures of texts: Ed25519 by libsodium. The first line of a text says what it is, so that a signature of one kind
/// never stands for another. Keys and signatures are small hexadecimal digits.

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace handpiece::exam {

struct SigningKey {
    std::string open;    ///< 64 digits: everybody may have it
    std::string secret;  ///< 128
};
/// By whom, and what. The key is only told so that the right error is: what counts is the one that is known already.
struct Signature {
    std::string key;    ///< 64 digits
    std::string value;  ///< 128
};

[[nodiscard]] SigningKey newSigningKey();
/// Read from a file that only its owner reads; made the first time, once also where two come at once. Throws
/// core::Error
/// ("key-damaged", "not-writable").
[[nodiscard]] SigningKey keptSigningKey(const std::filesystem::path& file);

[[nodiscard]] Signature signatureOf(std::string_view text, const SigningKey& key);
[[nodiscard]] bool isSigned(std::string_view text, const Signature& signature, std::string_view knownKey);
/// Throws core::Error "exam-other-key" or "exam-changed"; `what` as in "the pack".
void requireSigned(std::string_view text, const Signature& signature, std::string_view knownKey, const char* what,
                   const std::string& where);

/// As a file of its own, and at the end of what it signs.
[[nodiscard]] std::string toText(const Signature& signature);
/// Throw core::Error "exam-damaged".
[[nodiscard]] Signature signatureFrom(std::string_view text, const std::string& where);
struct Signed {
    std::string text;
    Signature signature;
};
[[nodiscard]] std::string joined(const Signed& both);
[[nodiscard]] Signed parted(std::string_view joined, const std::string& where);

}  // namespace handpiece::exam
