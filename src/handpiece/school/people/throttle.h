// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// How fast one may guess: of a login, of an address. No clock of its own.

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace handpiece::school {

/// Failures that cost nothing: of a login; of an address, behind which a whole class may sit.
inline constexpr int kFreeOfLogin = 5, kFreeOfAddress = 60;
/// How long one waits after so many failures in a row [ms]: nothing for the free ones, then 2, 4, 8 s and so on to 15
/// minutes.
[[nodiscard]] std::int64_t waitAfterFailures(int failures, int free = kFreeOfLogin);

/// Failures by key (a login, an address: ask for both). A failure is forgotten an hour after the last one; of more than
/// `kMostKeys` the one that failed longest ago is. One thread.
class Throttle {
  public:
    static constexpr std::size_t kMostKeys = 10'000;
    static constexpr std::int64_t kForgottenMs = 3'600'000;

    /// How long this one has to wait still [ms]; 0: try. A clock that was set back makes nobody wait longer than the
    /// longest wait.
    [[nodiscard]] std::int64_t waitMs(const std::string& key, std::int64_t now, int free = kFreeOfLogin) const;
    void failed(const std::string& key, std::int64_t now);
    void succeeded(const std::string& key);
    /// One failure less: an address's own log-in forgives no guess at others'.
    void takenBack(const std::string& key);
    [[nodiscard]] std::size_t keys() const noexcept { return failures_.size(); }

  private:
    struct Failures {
        int count = 0;
        std::int64_t last = 0;
    };
    std::map<std::string, Failures> failures_;
};

}  // namespace handpiece::school
