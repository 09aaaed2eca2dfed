// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/people/secret.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>

#include "handpiece/base/core/error.h"

namespace handpiece::school {
namespace {

constexpr unsigned long long kPasses = 2;
constexpr std::size_t kMemoryBytes = 19456 * 1024;
constexpr std::size_t kLeastCharacters = 10, kMostBytes = 256;
/// Without I, L, O, U.
constexpr std::string_view kCodeLetters = "0123456789ABCDEFGHJKMNPQRSTVWXYZ";
constexpr std::size_t kCodeLength = 12;

void requireSodium() {
    static const bool isReady = sodium_init() >= 0;
    if (!isReady)
        throw core::Error("the system gives no random numbers", "libsodium", "check /dev/urandom").as("no-random");
}

std::string hexOfBytes(const unsigned char* bytes, std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i)
        text += fmt::format("{:02x}", bytes[i]);
    return text;
}

}  // namespace

std::string hashOfPassword(std::string_view password) {
    requireSodium();
    std::array<char, crypto_pwhash_STRBYTES> text{};
    if (crypto_pwhash_str_alg(text.data(), password.data(), password.size(), kPasses, kMemoryBytes,
                              crypto_pwhash_ALG_ARGON2ID13) != 0)
        throw core::Error("there is no memory to check a password", {}, "try again").as("no-memory");
    return text.data();
}

bool isPassword(const std::string& hash, std::string_view password) {
    requireSodium();
    // libsodium reads a field of this size.
    std::array<char, crypto_pwhash_STRBYTES> text{};
    if (hash.empty() || hash.size() >= text.size()) {
        spendPasswordTime(password);
        return false;
    }
    std::copy(hash.begin(), hash.end(), text.begin());
    return crypto_pwhash_str_verify(text.data(), password.data(), password.size()) == 0;
}

bool isHashOutdated(const std::string& hash) {
    requireSodium();
    std::array<char, crypto_pwhash_STRBYTES> text{};
    if (hash.size() >= text.size()) return true;
    std::copy(hash.begin(), hash.end(), text.begin());
    return crypto_pwhash_str_needs_rehash(text.data(), kPasses, kMemoryBytes) != 0;
}

void spendPasswordTime(std::string_view password) {
    static const std::string nobodys = hashOfPassword("nobody's");
    std::array<char, crypto_pwhash_STRBYTES> text{};
    std::copy(nobodys.begin(), nobodys.end(), text.begin());
    [[maybe_unused]] const int no = crypto_pwhash_str_verify(text.data(), password.data(), password.size());
}

void requireGoodPassword(std::string_view password, std::string_view login) {
    const auto unfit = [](const char* why) {
        return core::Error(why, "password", "choose another, several words for example").as("password-unfit", {why});
    };
    // Bytes that begin a character of UTF-8.
    const auto characters = static_cast<std::size_t>(std::count_if(
        password.begin(), password.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }));
    if (characters < kLeastCharacters) throw unfit("it has fewer than 10 characters");
    if (password.size() > kMostBytes) throw unfit("it has more than 256 bytes");
    const auto low = [](std::string_view text) {
        std::string all(text);
        std::transform(all.begin(), all.end(), all.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return all;
    };
    if (!login.empty() && low(password).find(low(login)) != std::string::npos) throw unfit("it has the login in it");
    if (std::all_of(password.begin(), password.end(), [&](char c) { return c == password.front(); }))
        throw unfit("it is one character again and again");
}

std::string newSecret() {
    requireSodium();
    std::array<unsigned char, 32> bytes{};
    randombytes_buf(bytes.data(), bytes.size());
    return hexOfBytes(bytes.data(), bytes.size());
}

std::string newStationCode() {
    requireSodium();
    std::string code;
    for (std::size_t i = 0; i < kCodeLength; ++i) {
        if (i > 0 && i % 3 == 0) code += '-';
        code += kCodeLetters[randombytes_uniform(static_cast<std::uint32_t>(kCodeLetters.size()))];
    }
    return code;
}

std::string typedStationCode(std::string_view typed) {
    std::string code;
    std::size_t count = 0;
    for (const char c : typed) {
        char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        if (letter == ' ' || letter == '-' || letter == '\t') continue;
        if (letter == 'O') letter = '0';
        if (letter == 'I' || letter == 'L') letter = '1';
        if (count > 0 && count % 3 == 0) code += '-';
        code += letter;
        ++count;
    }
    return code;
}

std::string sealOf(std::string_view key, std::string_view text) {
    requireSodium();
    std::array<unsigned char, 32> hash{};
    crypto_generichash(hash.data(), hash.size(), reinterpret_cast<const unsigned char*>(text.data()), text.size(),
                       reinterpret_cast<const unsigned char*>(key.data()),
                       std::min<std::size_t>(key.size(), crypto_generichash_KEYBYTES_MAX));
    return hexOfBytes(hash.data(), hash.size());
}

std::string requestTokenOf(std::string_view loginToken) {
    return sealOf(loginToken, "handpiece request token");
}

bool isSameSecret(std::string_view a, std::string_view b) {
    return a.size() == b.size() && sodium_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace handpiece::school
