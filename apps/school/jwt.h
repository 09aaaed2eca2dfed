// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Signed claims between this server and a learning platform: JSON Web Tokens by RS256 (RFC 7515, 7518, 7519), OpenSSL
/// does the arithmetic. No other algorithm is known here, "none" least of all.

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace handpiece::school_server {

/// A key of 2048 bits or more, in a file that only its owner reads; made the first time.
class RsaKey {
  public:
    /// Throws core::Error "key-damaged", "not-writable".
    explicit RsaKey(const std::filesystem::path& pem);
    ~RsaKey();
    RsaKey(const RsaKey&) = delete;
    RsaKey& operator=(const RsaKey&) = delete;
    /// The open half as a JSON Web Key Set.
    [[nodiscard]] std::string keySet() const;
    /// `claims`: a JSON object.
    [[nodiscard]] std::string signedToken(std::string_view claims) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The claims of a token, as JSON, after its signature was checked by the key of a set that it names. Throws
/// core::Error: "token-damaged", "token-key" (none of the set's, or too short), "token-forged".
[[nodiscard]] std::string claimsOf(std::string_view token, std::string_view keySet);

}  // namespace handpiece::school_server
