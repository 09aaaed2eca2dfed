// SPDX-License-Identifier: Apache-2.0
#include "handpiece/school/exam/seal.h"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <array>

#include "handpiece/base/core/error.h"
#include "handpiece/school/people/secret.h"

namespace handpiece::exam {
namespace {

constexpr std::string_view kKind = "handpiece sealed exercise 1\n";
constexpr unsigned long long kPasses = 2;
constexpr std::size_t kMemoryBytes = 19456 * 1024;  // as a password's
using Key = std::array<unsigned char, crypto_secretbox_KEYBYTES>;

core::Error notThis() {
    return core::Error("this code does not open the exam's exercise", "the opening code",
                       "type it as it stands on the invigilator's sheet of this exam")
        .as("exam-seal");
}

Key keyOf(std::string_view exam, std::string_view code) {
    if (sodium_init() < 0)
        throw core::Error("the system gives no random numbers", "libsodium", "check /dev/urandom").as("no-random");
    const std::string typed = school::typedStationCode(code);
    std::array<unsigned char, crypto_pwhash_SALTBYTES> salt{};
    crypto_generichash(salt.data(), salt.size(), reinterpret_cast<const unsigned char*>(exam.data()), exam.size(),
                       nullptr, 0);
    Key key{};
    if (crypto_pwhash(key.data(), key.size(), typed.data(), typed.size(), salt.data(), kPasses, kMemoryBytes,
                      crypto_pwhash_ALG_ARGON2ID13) != 0)
        throw core::Error("there is no memory to open or to close an exercise", {}, "try again").as("no-memory");
    return key;
}

}  // namespace

std::vector<std::byte> sealed(std::span<const std::byte> bytes, std::string_view exam, std::string_view code) {
    const Key key = keyOf(exam, code);
    std::vector<std::byte> out(kKind.size() + crypto_secretbox_NONCEBYTES + crypto_secretbox_MACBYTES + bytes.size());
    auto* to = reinterpret_cast<unsigned char*>(out.data());
    std::copy(kKind.begin(), kKind.end(), to);
    unsigned char* const nonce = to + kKind.size();
    randombytes_buf(nonce, crypto_secretbox_NONCEBYTES);
    crypto_secretbox_easy(nonce + crypto_secretbox_NONCEBYTES, reinterpret_cast<const unsigned char*>(bytes.data()),
                          bytes.size(), nonce, key.data());
    return out;
}

std::vector<std::byte> unsealed(std::span<const std::byte> sealed, std::string_view exam, std::string_view typedCode) {
    constexpr std::size_t kAround = kKind.size() + crypto_secretbox_NONCEBYTES + crypto_secretbox_MACBYTES;
    const auto* from = reinterpret_cast<const unsigned char*>(sealed.data());
    if (sealed.size() < kAround || !std::equal(kKind.begin(), kKind.end(), from)) throw notThis();
    const Key key = keyOf(exam, typedCode);
    std::vector<std::byte> out(sealed.size() - kAround);
    const unsigned char* const nonce = from + kKind.size();
    if (crypto_secretbox_open_easy(reinterpret_cast<unsigned char*>(out.data()), nonce + crypto_secretbox_NONCEBYTES,
                                   sealed.size() - kKind.size() - crypto_secretbox_NONCEBYTES, nonce, key.data()) != 0)
        throw notThis();
    return out;
}

}  // namespace handpiece::exam
