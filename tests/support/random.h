// SPDX-License-Identifier: Apache-2.0
#pragma once
/// @file
/// Random tests whose seed is printed and can be given again through HANDPIECE_TEST_SEED.

#include <cstdint>
#include <filesystem>
#include <random>

#include "handpiece/base/core/vec.h"

namespace handpiece::test {

/// The seed of this run: HANDPIECE_TEST_SEED, else `fallback`. Printed once per process.
[[nodiscard]] std::uint64_t seed(std::uint64_t fallback = 20261121);

[[nodiscard]] core::Vec3 randomDirection(std::mt19937_64& generator);
[[nodiscard]] core::Quat randomRotation(std::mt19937_64& generator);
[[nodiscard]] double uniform(std::mt19937_64& generator, double low, double high);

/// ../shared/data beside the checkout, or empty when this machine has none: then skip with a plain line.
[[nodiscard]] std::filesystem::path realDataFolder();

/// A folder of this test's own, empty, removed with the object.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

}  // namespace handpiece::test
