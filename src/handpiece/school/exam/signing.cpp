// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/exam/signing.h"

#include <fmt/format.h>
#include <sodium.h>

#include <array>

#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/exam/lines.h"
#include "handpiece/school/store/content_files.h"
#include "handpiece/school/store/store.h"

namespace handpiece::exam {
namespace {

constexpr std::string_view kKeyKind = "handpiece signing key 1", kSignatureKey = "key: ";
constexpr std::size_t kOpenDigits = 2 * crypto_sign_PUBLICKEYBYTES, kSecretDigits = 2 * crypto_sign_SECRETKEYBYTES,
                      kValueDigits = 2 * crypto_sign_BYTES;

void requireSodium() {
    static const bool isReady = sodium_init() >= 0;
    if (!isReady)
        throw core::Error("the system gives no random numbers", "libsodium", "check /dev/urandom").as("no-random");
}

template <std::size_t n>
std::string digitsOf(const std::array<unsigned char, n>& bytes) {
    std::string text(2 * n + 1, '\0');
    sodium_bin2hex(text.data(), text.size(), bytes.data(), n);
    text.pop_back();
    return text;
}
/// Of digits that were looked at.
template <std::size_t n>
std::array<unsigned char, n> bytesOf(std::string_view digits) {
    std::array<unsigned char, n> bytes{};
    sodium_hex2bin(bytes.data(), n, digits.data(), digits.size(), nullptr, nullptr, nullptr);
    return bytes;
}
const unsigned char* start(std::string_view text) {
    return reinterpret_cast<const unsigned char*>(text.data());
}

SigningKey read(const std::filesystem::path& file) {
    const std::vector<std::byte> bytes = core::readFile(file, 4096);
    try {
        LineReader lines({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, kKeyKind, file.string());
        SigningKey key;
        key.open = lines.hex("open", kOpenDigits), key.secret = lines.hex("secret", kSecretDigits);
        lines.end();
        // libsodium keeps the open half at the secret one's end.
        if (!key.secret.ends_with(key.open)) throw lines.damaged("the two halves are no pair");
        return key;
    } catch (const core::Error& e) {
        throw core::Error("this signing key cannot be read: " + e.problem(), file.string(),
                          "put it back from a backup; a new one is not known to anybody who has the old one")
            .as("key-damaged");
    }
}

}  // namespace

SigningKey newSigningKey() {
    requireSodium();
    std::array<unsigned char, crypto_sign_PUBLICKEYBYTES> open{};
    std::array<unsigned char, crypto_sign_SECRETKEYBYTES> secret{};
    crypto_sign_keypair(open.data(), secret.data());
    SigningKey key{digitsOf(open), digitsOf(secret)};
    sodium_memzero(secret.data(), secret.size());
    return key;
}

SigningKey keptSigningKey(const std::filesystem::path& file) {
    if (core::isThere(file)) return read(file);
    const SigningKey key = newSigningKey();
    LineWriter lines(kKeyKind);
    lines.add("open", key.open).add("secret", key.secret);
    // Whole beside its place, then linked into it: of two that come at once one wins, and both have its key.
    const std::filesystem::path made = file.string() + "." + school::newId();
    core::writeFile(made, lines.text(), {.ownerOnly = true});
    std::error_code taken, none;
    std::filesystem::create_hard_link(made, file, taken);
    std::filesystem::remove(made, none);
    if (taken && !core::isThere(file))
        throw core::Error("the signing key cannot be kept: " + taken.message(), file.string(), "free the folder")
            .as("not-writable", {taken.message()});
    return read(file);
}

Signature signatureOf(std::string_view text, const SigningKey& key) {
    requireSodium();
    const auto secret = bytesOf<crypto_sign_SECRETKEYBYTES>(key.secret);
    std::array<unsigned char, crypto_sign_BYTES> value{};
    crypto_sign_detached(value.data(), nullptr, start(text), text.size(), secret.data());
    return {key.open, digitsOf(value)};
}

bool isSigned(std::string_view text, const Signature& signature, std::string_view knownKey) {
    requireSodium();
    if (!school::isHex(signature.value, kValueDigits) || !school::isHex(knownKey, kOpenDigits)) return false;
    const auto value = bytesOf<crypto_sign_BYTES>(signature.value);
    const auto open = bytesOf<crypto_sign_PUBLICKEYBYTES>(knownKey);
    return crypto_sign_verify_detached(value.data(), start(text), text.size(), open.data()) == 0;
}

void requireSigned(std::string_view text, const Signature& signature, std::string_view knownKey, const char* what,
                   const std::string& where) {
    if (signature.key != knownKey)
        throw core::Error(
            fmt::format("{} is signed by another key ({}...)", what, signature.key.substr(0, 16)), where,
            fmt::format("take one of the school that this belongs to, whose key is {}...", knownKey.substr(0, 16)))
            .as("exam-other-key", {what});
    if (!isSigned(text, signature, knownKey))
        throw core::Error(fmt::format("{} is not what was signed: it was changed, if only in one bit", what), where,
                          "fetch it again from the school's server")
            .as("exam-changed", {what});
}

std::string toText(const Signature& s) {
    return fmt::format("key: {}\nsignature: {}\n", s.key, s.value);
}

Signature signatureFrom(std::string_view text, const std::string& where) {
    const std::string with = "handpiece signature 1\n" + std::string(text);
    LineReader lines(with, "handpiece signature 1", where);
    Signature s;
    s.key = lines.hex("key", kOpenDigits), s.value = lines.hex("signature", kValueDigits);
    lines.end();
    return s;
}

std::string joined(const Signed& both) {
    return both.text + toText(both.signature);
}

Signed parted(std::string_view joined, const std::string& where) {
    // Its length is known.
    constexpr std::size_t kSize = kSignatureKey.size() + kOpenDigits + 1 + 11 + kValueDigits + 1;
    if (joined.size() <= kSize)
        throw core::Error("there is no signature at its end", where, "fetch it again")
            .as("exam-damaged", {"", "short"});
    const std::size_t at = joined.size() - kSize;
    return {std::string(joined.substr(0, at)), signatureFrom(joined.substr(at), where)};
}

}  // namespace handpiece::exam
