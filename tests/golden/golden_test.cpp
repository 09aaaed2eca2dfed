// SPDX-License-Identifier: Apache-2.0
// The same inputs give the same tooth and the same touch, bit for bit: on every machine, at any number of threads, at
// every instruction set, today and after the next change.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace handpiece::golden_test {
namespace {

/// What a child process prints; tests run one session a setting, because both settings are read once a process.
std::string session(const std::string& threads, const std::string& simd, const std::string& environment = "") {
    const std::string command =
        environment + " HANDPIECE_SIMD=" + simd + " \"" HANDPIECE_GOLDEN_SESSION "\" " + threads;
    std::FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return "popen failed";
    std::string text;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
        text += static_cast<char>(c);
    const int status = pclose(pipe);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << command;
    return text;
}

/// tests/golden/hashes.txt without its comments.
std::string golden() {
    std::ifstream file(HANDPIECE_SOURCE_DIR "/tests/golden/hashes.txt");
    EXPECT_TRUE(file.good());
    std::string text;
    for (std::string line; std::getline(file, line);)
        if (!line.empty() && line.front() != '#') text += line + "\n";
    return text;
}

TEST(Golden, theSessionIsTheOneOnRecord) {
    EXPECT_EQ(session("2", "avx512"), golden()) << "tests/golden/hashes.txt says what to do";
}

TEST(Golden, oneThreadAndEveryInstructionSetGiveTheSame) {
    // The C library as on a processor without FMA: there its own sine and power have other bits.
    EXPECT_EQ(session("1", "base", "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX512F"), golden());
    // The two extremes; what lies between, with HANDPIECE_EVERY_SIMD=1 (tools/nightly). Tests of the kernels hold each
    // to the same bits.
    if (std::getenv("HANDPIECE_EVERY_SIMD") != nullptr) {
        EXPECT_EQ(session("3", "avx2"), golden());
    }
}

}  // namespace
}  // namespace handpiece::golden_test
