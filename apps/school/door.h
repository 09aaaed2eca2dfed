// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// What is refused by its head alone, before anything of its body is read and whatever its address.

#include <cstdint>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "school/routes.h"

namespace handpiece::school_server {

class Door {
  public:
    static constexpr std::size_t kMostHeaders = 100, kMostHeaderBytes = 32 << 10, kMostRanges = 4;

    explicit Door(const std::vector<Entry>& routes);

    /// The status with which this is answered; none: it is let in.
    [[nodiscard]] std::optional<int> refuses(const httplib::Request& request) const;
    /// Of its body, by what it says. Of a request that was let in.
    [[nodiscard]] static std::uint64_t lengthOf(const httplib::Request& request);

  private:
    struct Way {
        std::string method;
        std::regex address;
    };
    std::vector<Way> ways_;  ///< of those that have a body
};

}  // namespace handpiece::school_server
