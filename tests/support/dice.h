// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Draws from a seeded generator, for files that are made at random.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <random>
#include <vector>

#include "support/random.h"

namespace handpiece::test {

class Dice {
  public:
    explicit Dice(std::uint64_t seed) : generator_(seed) {}
    [[nodiscard]] int upTo(int count) { return static_cast<int>(generator_() % static_cast<std::uint64_t>(count)); }
    [[nodiscard]] bool once(int in) { return upTo(in) == 0; }
    [[nodiscard]] int sign() { return once(2) ? -1 : 1; }
    [[nodiscard]] double between(double low, double high) { return uniform(generator_, low, high); }
    template <class T>
    [[nodiscard]] T oneOf(std::initializer_list<T> choices) {
        return *(choices.begin() + upTo(static_cast<int>(choices.size())));
    }
    template <class T>
    void shuffle(std::vector<T>& of) {
        std::shuffle(of.begin(), of.end(), generator_);
    }

  private:
    std::mt19937_64 generator_;
};

/// As many files as HANDPIECE_CORPUS says, or those of every run.
[[nodiscard]] inline int corpusSize(int usual) {
    const char* asked = std::getenv("HANDPIECE_CORPUS");
    return asked != nullptr ? std::atoi(asked) : usual;
}

}  // namespace handpiece::test
