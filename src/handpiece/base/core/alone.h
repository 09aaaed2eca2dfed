// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// For work beside a person's own that must not take the cores from it.

namespace handpiece::core {

/// While it lives parallelFor() on this thread uses this thread alone. Results are the same.
class Alone {
  public:
    Alone();
    ~Alone();
    Alone(const Alone&) = delete;
    Alone& operator=(const Alone&) = delete;

  private:
    bool wasAlone_;
};

}  // namespace handpiece::core
