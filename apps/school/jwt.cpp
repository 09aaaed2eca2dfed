// SPDX-License-Identifier: Apache-2.0
#include "school/jwt.h"

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/core_names.h>
#include <openssl/evp.h>
#include <openssl/param_build.h>
#include <openssl/pem.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>

#include "handpiece/base/config/outside_json.h"
#include "handpiece/base/core/error.h"
#include "handpiece/base/core/file.h"
#include "handpiece/school/store/content_files.h"
#include "handpiece/school/store/store.h"

namespace handpiece::school_server {
namespace {

using Json = nlohmann::json;
using Bytes = std::vector<unsigned char>;

constexpr std::size_t kMostToken = 1 << 16, kMostKeySet = 1 << 18;
constexpr int kLeastBits = 2048, kMostBits = 8192;

template <auto free>
struct Free {
    template <class T>
    void operator()(T* thing) const {
        free(thing);
    }
};
using PublicKey = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using KeyContext = std::unique_ptr<EVP_PKEY_CTX, Free<EVP_PKEY_CTX_free>>;
using Digest = std::unique_ptr<EVP_MD_CTX, Free<EVP_MD_CTX_free>>;
using Number = std::unique_ptr<BIGNUM, Free<BN_free>>;
using Builder = std::unique_ptr<OSSL_PARAM_BLD, Free<OSSL_PARAM_BLD_free>>;
using Parameters = std::unique_ptr<OSSL_PARAM, Free<OSSL_PARAM_free>>;
using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;

core::Error damaged(const char* why) {
    return core::Error(fmt::format("the platform's token cannot be read: {}", why), "token",
                       "begin anew, from the platform; if it comes again, tell who looks after it")
        .as("token-damaged", {why});
}

constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

std::string encoded(std::span<const unsigned char> bytes) {
    std::string text;
    std::uint32_t held = 0;
    int bits = 0;
    for (const unsigned char byte : bytes) {
        held = (held << 8) | byte, bits += 8;
        while (bits >= 6)
            text += kLetters[(held >> (bits -= 6)) & 63u];
    }
    if (bits > 0) text += kLetters[(held << (6 - bits)) & 63u];
    return text;
}
std::string encoded(std::string_view text) {
    return encoded(std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()));
}
/// Without padding, and in the one way that there is.
std::optional<Bytes> decoded(std::string_view text) {
    if (text.size() % 4 == 1) return {};
    Bytes bytes;
    std::uint32_t held = 0;
    int bits = 0;
    for (const char c : text) {
        const std::size_t at = kLetters.find(c);
        if (at == kLetters.npos) return {};
        held = (held << 6) | static_cast<std::uint32_t>(at), bits += 6;
        if (bits >= 8) bytes.push_back(static_cast<unsigned char>(held >> (bits -= 8)));
    }
    if ((held & ((1u << bits) - 1)) != 0) return {};
    return bytes;
}
Json jsonIn(std::string_view part, const char* what) {
    const auto bytes = decoded(part);
    Json json = bytes ? config::outsideJson<Json>({reinterpret_cast<const char*>(bytes->data()), bytes->size()})
                      : Json(Json::value_t::discarded);
    if (!json.is_object()) throw damaged(what);
    return json;
}
std::string textIn(const Json& json, const char* key) {
    const auto found = json.find(key);
    return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

PublicKey keyOf(const Json& jwk) {
    const auto n = decoded(textIn(jwk, "n")), e = decoded(textIn(jwk, "e"));
    if (!n || !e || n->empty() || e->empty() || n->size() > kMostBits / 8 || e->size() > 8) return nullptr;
    const Number modulus(BN_bin2bn(n->data(), static_cast<int>(n->size()), nullptr)),
        exponent(BN_bin2bn(e->data(), static_cast<int>(e->size()), nullptr));
    const Builder builder(OSSL_PARAM_BLD_new());
    if (!modulus || !exponent || !builder || BN_num_bits(modulus.get()) < kLeastBits ||
        OSSL_PARAM_BLD_push_BN(builder.get(), OSSL_PKEY_PARAM_RSA_N, modulus.get()) != 1 ||
        OSSL_PARAM_BLD_push_BN(builder.get(), OSSL_PKEY_PARAM_RSA_E, exponent.get()) != 1)
        return nullptr;
    const Parameters parameters(OSSL_PARAM_BLD_to_param(builder.get()));
    const KeyContext context(EVP_PKEY_CTX_new_from_name(nullptr, "RSA", nullptr));
    EVP_PKEY* key = nullptr;
    if (!parameters || !context || EVP_PKEY_fromdata_init(context.get()) != 1 ||
        EVP_PKEY_fromdata(context.get(), &key, EVP_PKEY_PUBLIC_KEY, parameters.get()) != 1)
        return nullptr;
    return PublicKey(key);
}

Bytes numberOfKey(const EVP_PKEY* key, const char* which) {
    BIGNUM* value = nullptr;
    if (EVP_PKEY_get_bn_param(key, which, &value) != 1) return {};
    const Number number(value);
    Bytes bytes(static_cast<std::size_t>(BN_num_bytes(number.get())));
    BN_bn2bin(number.get(), bytes.data());
    return bytes;
}

}  // namespace

struct RsaKey::State {
    PublicKey key;
    std::string id;
};

RsaKey::RsaKey(const std::filesystem::path& pem) : state_(std::make_unique<State>()) {
    if (!core::isThere(pem)) {
        const PublicKey made(EVP_RSA_gen(kLeastBits));
        const Bio text(BIO_new(BIO_s_mem()));
        if (!made || !text ||
            PEM_write_bio_PrivateKey(text.get(), made.get(), nullptr, nullptr, 0, nullptr, nullptr) != 1)
            throw core::Error("no key could be made", pem.string(), "check the system's randomness").as("no-random");
        char* bytes = nullptr;
        const long count = BIO_get_mem_data(text.get(), &bytes);
        const std::filesystem::path beside = pem.string() + "." + school::newId();
        core::writeFile(beside, std::string_view(bytes, static_cast<std::size_t>(count)), {.ownerOnly = true});
        std::error_code taken, none;
        std::filesystem::create_hard_link(beside, pem, taken);  // of two that come at once one wins
        std::filesystem::remove(beside, none);
        if (taken && !core::isThere(pem))
            throw core::Error("the key cannot be kept: " + taken.message(), pem.string(), "free the folder")
                .as("not-writable", {taken.message()});
    }
    const std::vector<std::byte> bytes = core::readFile(pem, 1 << 16);
    const Bio text(BIO_new_mem_buf(bytes.data(), static_cast<int>(bytes.size())));
    state_->key.reset(PEM_read_bio_PrivateKey(text.get(), nullptr, nullptr, nullptr));
    if (!state_->key || EVP_PKEY_is_a(state_->key.get(), "RSA") != 1 || EVP_PKEY_bits(state_->key.get()) < kLeastBits)
        throw core::Error("this is no RSA key of 2048 bits or more", pem.string(),
                          "put it back from a backup, or move it away: then a new one is made, which the platform has "
                          "to be told of")
            .as("key-damaged");
    state_->id = school::sha256(encoded(numberOfKey(state_->key.get(), OSSL_PKEY_PARAM_RSA_N))).substr(0, 16);
}
RsaKey::~RsaKey() = default;

std::string RsaKey::keySet() const {
    const EVP_PKEY* key = state_->key.get();
    return Json{{"keys",
                 {{{"kty", "RSA"},
                   {"alg", "RS256"},
                   {"use", "sig"},
                   {"kid", state_->id},
                   {"n", encoded(numberOfKey(key, OSSL_PKEY_PARAM_RSA_N))},
                   {"e", encoded(numberOfKey(key, OSSL_PKEY_PARAM_RSA_E))}}}}}
        .dump();
}

std::string RsaKey::signedToken(std::string_view claims) const {
    const std::string text =
        encoded(Json{{"alg", "RS256"}, {"typ", "JWT"}, {"kid", state_->id}}.dump()) + "." + encoded(claims);
    const Digest digest(EVP_MD_CTX_new());
    std::size_t size = 0;
    const auto* bytes = reinterpret_cast<const unsigned char*>(text.data());
    if (!digest || EVP_DigestSignInit(digest.get(), nullptr, EVP_sha256(), nullptr, state_->key.get()) != 1 ||
        EVP_DigestSign(digest.get(), nullptr, &size, bytes, text.size()) != 1)
        throw core::Error("nothing can be signed", "OpenSSL").as("key-damaged");
    Bytes signature(size);
    if (EVP_DigestSign(digest.get(), signature.data(), &size, bytes, text.size()) != 1)
        throw core::Error("nothing can be signed", "OpenSSL").as("key-damaged");
    signature.resize(size);
    return text + "." + encoded(signature);
}

std::string claimsOf(std::string_view token, std::string_view keySet) {
    if (token.size() > kMostToken) throw damaged("it is too long");
    const std::size_t first = token.find('.'), second = token.find('.', first + 1);
    if (first == token.npos || second == token.npos || token.find('.', second + 1) != token.npos)
        throw damaged("it has not three parts");
    const Json header = jsonIn(token.substr(0, first), "its head is no JSON");
    if (textIn(header, "alg") != "RS256") throw damaged("it is not signed by RS256");
    if (header.contains("crit")) throw damaged("it asks for what is not known here");
    const Json claims = jsonIn(token.substr(first + 1, second - first - 1), "its claims are no JSON");
    const auto signature = decoded(token.substr(second + 1));
    if (!signature) throw damaged("its signature is none");

    const Json keys = keySet.size() > kMostKeySet ? Json() : config::outsideJson<Json>(keySet);
    const auto list = keys.is_object() ? keys.find("keys") : keys.end();
    if (!keys.is_object() || list == keys.end() || !list->is_array())
        throw core::Error("the platform's keys cannot be read", "key set", "check its address").as("token-key");
    const std::string wanted = textIn(header, "kid");
    for (const Json& jwk : *list) {
        if (!jwk.is_object() || textIn(jwk, "kty") != "RSA" || textIn(jwk, "kid") != wanted ||
            (jwk.contains("alg") && textIn(jwk, "alg") != "RS256") ||
            (jwk.contains("use") && textIn(jwk, "use") != "sig"))
            continue;
        const PublicKey key = keyOf(jwk);
        if (!key) continue;
        const Digest digest(EVP_MD_CTX_new());
        if (digest && EVP_DigestVerifyInit(digest.get(), nullptr, EVP_sha256(), nullptr, key.get()) == 1 &&
            EVP_DigestVerify(digest.get(), signature->data(), signature->size(),
                             reinterpret_cast<const unsigned char*>(token.data()), second) == 1)
            return claims.dump();
        throw core::Error("the token is not what the platform signed", "token", "begin anew, from the platform")
            .as("token-forged");
    }
    throw core::Error(fmt::format("the platform has no key \"{}\" of 2048 bits or more", wanted.substr(0, 40)),
                      "key set", "if it changed its keys, try again in a minute")
        .as("token-key");
}

}  // namespace handpiece::school_server
