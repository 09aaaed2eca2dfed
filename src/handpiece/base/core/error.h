// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The one exception of everything outside the tick: what went wrong, where, and what to do about it.

#include <exception>
#include <string>

namespace handpiece::core {

/// Thrown for every expected failure off the tick; caught once, in each main.
class Error : public std::exception {
  public:
    /// @param what    one sentence, what is wrong ("the file ends in the middle of facet 17").
    /// @param where   file, option or value it is about; may be empty.
    /// @param remedy  what the person can do; may be empty.
    Error(std::string what, std::string where = {}, std::string remedy = {});

    /// "where: what (remedy)" on one line.
    [[nodiscard]] const char* what() const noexcept override { return message_.c_str(); }
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
    [[nodiscard]] const std::string& where() const noexcept { return where_; }
    [[nodiscard]] const std::string& remedy() const noexcept { return remedy_; }

  private:
    std::string problem_, where_, remedy_, message_;
};

}  // namespace handpiece::core
