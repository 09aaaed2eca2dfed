// SPDX-License-Identifier: Apache-2.0
#include "support/chosen_tests.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <set>
#include <string>
#include <string_view>

namespace handpiece::test {
namespace {

constexpr std::string_view kSources = "--sources=", kFolder = HANDPIECE_SOURCE_DIR "/tests/";

std::set<std::string, std::less<>> split(std::string_view list) {
    std::set<std::string, std::less<>> files;
    while (!list.empty()) {
        const std::size_t comma = list.find(',');
        files.emplace(list.substr(0, comma));
        list = comma == list.npos ? std::string_view() : list.substr(comma + 1);
    }
    return files;
}

/// The names of the tests of these files, as a filter. What a filter has left out stays out.
std::string filterOf(std::set<std::string, std::less<>> files, std::string_view filter) {
    std::string tests;
    std::set<std::string, std::less<>> found;
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    for (int s = 0; s < all.total_test_suite_count(); ++s) {
        const testing::TestSuite& suite = *all.GetTestSuite(s);
        for (int t = 0; t < suite.total_test_count(); ++t) {
            const testing::TestInfo& test = *suite.GetTestInfo(t);
            std::string_view file = test.file();
            if (!file.starts_with(kFolder)) continue;
            file.remove_prefix(kFolder.size());
            if (!files.contains(file)) continue;
            found.emplace(file);
            tests.append(suite.name()).append(".").append(test.name()).append(":");
        }
    }
    for (const std::string& file : files)
        if (!found.contains(file)) std::printf("%s has no test\n", file.c_str());
    if (found.empty()) return {};
    if (const std::size_t minus = filter.find('-'); minus != filter.npos) tests.append(filter.substr(minus));
    return tests;
}

}  // namespace

int runChosen(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (!argument.starts_with(kSources)) {
            std::printf("unknown: %s\n", argv[i]);
            return 2;
        }
        const std::string chosen = filterOf(split(argument.substr(kSources.size())), GTEST_FLAG_GET(filter));
        if (chosen.empty()) return 2;
        GTEST_FLAG_SET(filter, chosen);
    }
    return RUN_ALL_TESTS();
}

}  // namespace handpiece::test
