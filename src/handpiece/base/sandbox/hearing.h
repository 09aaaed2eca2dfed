// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a sandbox's child says, taken apart where something is to lose.

#include <cstddef>
#include <string>
#include <string_view>

#include "handpiece/base/core/error.h"
#include "handpiece/base/sandbox/frames.h"
#include "handpiece/base/sandbox/sandbox.h"

namespace handpiece::sandbox {

/// What was read ended its reader.
[[nodiscard]] core::Error died(const std::string& how);

/// What the child sends, as it comes.
class Hearing {
  public:
    explicit Hearing(std::size_t mostBytes) : most_(mostBytes) {}
    /// Takes whole pieces off the front. Throws core::Error: what the child threw, or that this is no answer.
    void hear(std::string& come);

    bool isReady = false, isWhole = false;
    double progress = 0.0;
    Answer answer;

  private:
    [[nodiscard]] std::size_t mostOf(Frame kind) const;
    void take(Frame kind, std::string_view piece);

    const std::size_t most_;
};

}  // namespace handpiece::sandbox
