// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// HTTP on a socket of this machine, where the system says which account is at the other end.

#include <sys/types.h>

#include <map>
#include <mutex>
#include <optional>

#include "school/http.h"

namespace handpiece::school_exam {

/// As many threads as there are connections, and so many of one account: who holds all of theirs holds nobody else's.
class LocalServer final : public httplib::Server {
  public:
    static constexpr int kMostOfAccount = 16;

    LocalServer();
    /// Whose program sent this request; none where the system does not say.
    [[nodiscard]] static std::optional<uid_t> accountOf(const httplib::Request& request);

  private:
    bool process_and_close_socket(socket_t socket) override;

    std::mutex mutex_;
    std::map<uid_t, int> open_;  ///< connections, by account
};

}  // namespace handpiece::school_exam
