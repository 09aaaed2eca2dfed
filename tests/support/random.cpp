// SPDX-License-Identifier: Apache-2.0
#include "support/random.h"

#include <cstdio>
#include <cstdlib>
#include <string>

namespace handpiece::test {

std::uint64_t seed(std::uint64_t fallback) {
    static const std::uint64_t value = [&] {
        const char* given = std::getenv("HANDPIECE_TEST_SEED");
        const std::uint64_t s = given ? std::strtoull(given, nullptr, 10) : fallback;
        std::printf("random seed %llu (set HANDPIECE_TEST_SEED to repeat)\n", static_cast<unsigned long long>(s));
        return s;
    }();
    return value;
}

double uniform(std::mt19937_64& generator, double low, double high) {
    return low + (high - low) * static_cast<double>(generator() >> 11) * 0x1p-53;
}

core::Vec3 randomDirection(std::mt19937_64& generator) {
    for (;;) {
        const core::Vec3 v(uniform(generator, -1, 1), uniform(generator, -1, 1), uniform(generator, -1, 1));
        const double n = v.norm();
        if (n > 0.1 && n <= 1.0) return v / n;
    }
}

core::Quat randomRotation(std::mt19937_64& generator) {
    for (;;) {
        core::Quat q(uniform(generator, -1, 1), uniform(generator, -1, 1), uniform(generator, -1, 1),
                     uniform(generator, -1, 1));
        const double n = q.norm();
        if (n > 0.1 && n <= 1.0) return core::Quat(q.coeffs() / n);
    }
}

std::filesystem::path realDataFolder() {
    const std::filesystem::path folder = std::filesystem::path(HANDPIECE_SOURCE_DIR) / ".." / "shared" / "data";
    return std::filesystem::is_directory(folder) ? folder : std::filesystem::path{};
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "handpiece-test-XXXXXX").string();
    if (!mkdtemp(name.data())) std::abort();
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ec;
    std::filesystem::remove_all(path_, ec);
}

}  // namespace handpiece::test
