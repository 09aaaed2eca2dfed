// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Where the bytes of a file are taken from that somebody else may have made. A program that has such files read apart
/// first (docs/sandbox.md) answers with the very copy that was read; all others open a file where it lies.

#include <filesystem>
#include <functional>
#include <memory>

namespace handpiece::core {

/// May throw core::Error: then the file is not opened.
using TakenFrom = std::function<std::filesystem::path(const std::filesystem::path& file)>;

/// While it lives, takenFrom() asks it, on whatever thread; of several the one made last.
class TakingFrom {
  public:
    explicit TakingFrom(TakenFrom ask);
    TakingFrom(const TakingFrom&) = delete;
    TakingFrom& operator=(const TakingFrom&) = delete;
    ~TakingFrom();

  private:
    std::shared_ptr<const TakenFrom> ask_;
};

/// Of a session or a .handpiece file that is about to be opened; itself where nobody is to be asked.
[[nodiscard]] std::filesystem::path takenFrom(const std::filesystem::path& file);

}  // namespace handpiece::core
