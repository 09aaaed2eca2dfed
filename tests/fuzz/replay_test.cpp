// SPDX-License-Identifier: Apache-2.0
// Each reader of what comes from outside is given its corpus once more, and damaged copies of it: whole, cut short,
// with bytes changed. What a reader must not do it does not survive: it traps, aborts, or throws what is no
// core::Error.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "handpiece/base/core/file.h"
#include "support/random.h"

#define REPLAY(name, corpus) extern "C" int replay_##name(const std::uint8_t* data, std::size_t size);
#include "replays.inc"
#undef REPLAY

namespace handpiece::replay_test {
namespace {

struct Replay {
    const char *name, *corpus;
    int (*reader)(const std::uint8_t*, std::size_t);
};
const Replay kReplays[] = {
#define REPLAY(name, corpus) {#name, #corpus, replay_##name},
#include "replays.inc"
#undef REPLAY
};

class FuzzReplay : public testing::TestWithParam<Replay> {};

TEST_P(FuzzReplay, ReadsOrRefuses) {
    using Bytes = std::vector<std::uint8_t>;
    const Replay& replay = GetParam();
    // As many damaged copies of each file as HANDPIECE_MUTANTS says, or those of every run.
    const char* asked = std::getenv("HANDPIECE_MUTANTS");
    const int mutants = asked != nullptr ? std::atoi(asked) : 6;
    std::vector<Bytes> seeds{{}};
    const std::filesystem::path folder = std::filesystem::path(HANDPIECE_CORPUS) / replay.corpus;
    if (std::filesystem::is_directory(folder))
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            const std::vector<std::byte> bytes = core::readFile(entry.path());
            const auto* begin = reinterpret_cast<const std::uint8_t*>(bytes.data());
            seeds.emplace_back(begin, begin + bytes.size());
        }
    std::sort(seeds.begin(), seeds.end());  // a folder lists them in any order
    std::mt19937_64 generator(test::seed());
    const auto upTo = [&](std::size_t count) { return static_cast<std::size_t>(generator() % count); };
    for (const Bytes& seed : seeds) {
        EXPECT_EQ(replay.reader(seed.data(), seed.size()), 0);
        for (int n = 0; n < mutants && !seed.empty(); ++n) {
            Bytes mutant = seed;
            if (n % 3 == 0) mutant.resize(upTo(mutant.size()));
            for (std::size_t changes = n % 3 == 0 ? upTo(2) : 1 + upTo(8); changes > 0 && !mutant.empty(); --changes)
                mutant[upTo(mutant.size())] = static_cast<std::uint8_t>(generator());
            EXPECT_EQ(replay.reader(mutant.data(), mutant.size()), 0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Readers, FuzzReplay, testing::ValuesIn(kReplays),
                         [](const testing::TestParamInfo<Replay>& one) { return one.param.name; });

}  // namespace
}  // namespace handpiece::replay_test
