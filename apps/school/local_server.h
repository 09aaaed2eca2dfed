// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// HTTP on a socket of this machine, where the system says which account is at the other end.

#include <sys/types.h>

#include <optional>

#include "school/http.h"

namespace handpiece::school_exam {

class LocalServer final : public httplib::Server {
  public:
    /// Whose program sent this request; none where the system does not say.
    [[nodiscard]] static std::optional<uid_t> accountOf(const httplib::Request& request);

  private:
    bool process_and_close_socket(socket_t socket) override;
};

}  // namespace handpiece::school_exam
