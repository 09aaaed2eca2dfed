// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// The one exception of everything outside the tick: what went wrong, where, and what to do about it.

#include <exception>
#include <string>
#include <vector>

namespace handpiece::core {

/// Thrown for every expected failure off the tick; caught once, in each main.
class Error : public std::exception {
  public:
    /// @param what    one sentence, what is wrong ("the file ends in the middle of facet 17").
    /// @param where   file, option or value it is about; may be empty.
    /// @param remedy  what the person can do; may be empty.
    Error(std::string what, std::string where = {}, std::string remedy = {});
    /// Names what a program may tell in another language: throw Error(...).as("no-space", {reason}). The window's table
    /// of them is apps/desktop/framework/problem.cpp.
    [[nodiscard]] Error as(std::string id, std::vector<std::string> arguments = {}) &&;

    /// "where: what (remedy)" on one line.
    [[nodiscard]] const char* what() const noexcept override { return message_.c_str(); }
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
    [[nodiscard]] const std::string& where() const noexcept { return where_; }
    [[nodiscard]] const std::string& remedy() const noexcept { return remedy_; }
    /// Empty for what has no name: then the texts are all there is.
    [[nodiscard]] const std::string& id() const noexcept { return id_; }
    /// What varies in the sentence, in the order of its places.
    [[nodiscard]] const std::vector<std::string>& arguments() const noexcept { return arguments_; }

  private:
    std::string problem_, where_, remedy_, message_, id_;
    std::vector<std::string> arguments_;
};

}  // namespace handpiece::core
