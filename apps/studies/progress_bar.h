// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// A bar on stderr for long work, drawn only where a person looks at a terminal; Ctrl-C cancels the work cleanly.

#include <memory>
#include <string>

#include "handpiece/base/core/progress.h"

namespace handpiece::studies {

class ProgressBar {
  public:
    explicit ProgressBar(std::string label);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// To hand to long work; safe to call from several threads.
    [[nodiscard]] core::Progress listener();
    /// Removes the bar.
    void finish();

  private:
    struct State;
    std::shared_ptr<State> state_;
};

/// True once the person has pressed Ctrl-C. installCancel() once per process makes the key set it instead of killing.
[[nodiscard]] bool cancelled() noexcept;
void installCancel();

}  // namespace handpiece::studies
