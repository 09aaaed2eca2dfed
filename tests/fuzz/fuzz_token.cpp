// SPDX-License-Identifier: Apache-2.0
// Any text as a platform's token, and as its key set, must give claims or one core::Error; without the platform's key
// never claims.
#include "fuzz_model.h"
#include "school/jwt.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static constexpr std::string_view kKeys =
        R"({"keys":[{"kty":"RSA","kid":"k1","alg":"RS256","use":"sig","e":"AQAB","n":"u1SU1LfVLPHCozMxH2Mo4lgOEePzNm0tRgeLezV6ffAt0gunVTLw7onLRnrq0_IzW7yWR7QkrmBL7jTKEn5u-qKhbwKfBstIs-bMY2Zkp18gnTxKLxoS2tFczGkPLPgizskuemMghRniWaoLcyehkd3qqGElvW_VDL5AaWTg0nLVkjRo9z-40RQzuVaE8AkAFmxZzow3x-VJYKdjykkJ0iT9wCS0DRTXu269V264Vf_3jvredZiKRkgwlL9xNAwxXFg0x_XFw005UWVRIkdgcKWTjpBP2dPwVZ4WWC-9aGVd-Gyn1o0CLelf4rEjGoXbAAEgAqeGUxrcIlbjXfbcmw"}]})";
    (void)handpiece::fuzz::readText(data, size, [](std::string_view text) {
        (void)handpiece::school_server::claimsOf(text, kKeys);
        __builtin_trap();  // nobody signed this
    });
    (void)handpiece::fuzz::readText(data, size, [](std::string_view text) {
        (void)handpiece::school_server::claimsOf("eyJhbGciOiJSUzI1NiIsImtpZCI6ImsxIn0.e30.AAAA", text);
        __builtin_trap();
    });
    return 0;
}
