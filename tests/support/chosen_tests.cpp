// SPDX-License-Identifier: Apache-2.0
#include "support/chosen_tests.h"

#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <string>
#include <string_view>

namespace handpiece::test {
namespace {

constexpr std::string_view kSources = "--sources=", kFolder = HANDPIECE_SOURCE_DIR "/tests/";

using Strings = std::set<std::string, std::less<>>;

Strings split(std::string_view list, char by) {
    Strings parts;
    while (!list.empty()) {
        const std::size_t end = list.find(by);
        parts.emplace(list.substr(0, end));
        list = end == list.npos ? std::string_view() : list.substr(end + 1);
    }
    return parts;
}

bool isLike(const Strings& patterns, const std::string& name) {
    return patterns.empty() || std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
               return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
           });
}

/// The names of the tests of these files, as a filter, of which `filter` leaves some out.
std::string filterOf(const Strings& files, std::string_view filter) {
    const std::size_t minus = std::min(filter.find('-'), filter.size());
    const Strings wanted = split(filter.substr(0, minus), ':');
    std::string tests;
    Strings found;
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
            const std::string name = std::string(suite.name()) + "." + test.name();
            if (isLike(wanted, name)) tests.append(name).append(":");
        }
    }
    for (const std::string& file : files)
        if (!found.contains(file)) std::printf("%s has no test\n", file.c_str());
    if (!tests.empty()) tests.append(filter.substr(minus));
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
        const std::string chosen = filterOf(split(argument.substr(kSources.size()), ','), GTEST_FLAG_GET(filter));
        if (chosen.empty()) {
            std::printf("no test of %s is like %s\n", argv[i], GTEST_FLAG_GET(filter).c_str());
            return 2;
        }
        GTEST_FLAG_SET(filter, chosen);
    }
    return RUN_ALL_TESTS();
}

}  // namespace handpiece::test
