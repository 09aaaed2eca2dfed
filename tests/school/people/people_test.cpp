// SPDX-License-Identifier: Apache-2.0
// Passwords, tokens, how fast one may guess, and who may do what.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "handpiece/school/people/permission.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/people/throttle.h"
#include "support/error_of.h"

namespace handpiece::school::people_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(Passwords, AreHashedWithTheirOwnSaltAndKnownAgain) {
    const std::string hash = hashOfPassword("correct horse battery");
    EXPECT_THAT(hash, StartsWith("$argon2id$v=19$m=19456,t=2,p=1$"));
    EXPECT_NE(hash, hashOfPassword("correct horse battery"));
    EXPECT_TRUE(isPassword(hash, "correct horse battery"));
    EXPECT_FALSE(isPassword(hash, "correct horse batterx"));
    EXPECT_FALSE(isPassword(hash, ""));
    EXPECT_FALSE(isPassword(hash, std::string("correct horse battery\0x", 23)));
    EXPECT_FALSE(isHashOutdated(hash));
    for (const std::string& none : {std::string(), std::string("x"), std::string(500, '$'), hash.substr(0, 40)}) {
        EXPECT_FALSE(isPassword(none, "correct horse battery")) << none;
        EXPECT_TRUE(isHashOutdated(none)) << none;
    }
}

// Made by Debian's argon2 program: printf password123 | argon2 handpiecesalt -id -t 2 -k 19456 -p 1 -l 32 -e
TEST(Passwords, OfTheReferenceProgramAreKnown) {
    const std::string hash =
        "$argon2id$v=19$m=19456,t=2,p=1$aGFuZHBpZWNlc2FsdA$zFAPlTzRBvgE7vARgMa45VMpqm5MQSNx5PyWPZDdIAc";
    EXPECT_TRUE(isPassword(hash, "password123"));
    EXPECT_FALSE(isPassword(hash, "password124"));
    EXPECT_FALSE(isHashOutdated(hash));
}

TEST(Passwords, ThatAreEasyToGuessAreRefused) {
    const auto id = [](const char* password, const char* login) {
        return test::errorIdOf([&] { requireGoodPassword(password, login); });
    };
    EXPECT_EQ(id("three plain words", "mori"), "");
    const std::string three = "\xe6\xad\xaf\xe3\x81\xaf\xe5\xa4\xa7";  // of nine bytes
    EXPECT_EQ(id((three + three + three + "!").c_str(), "mori"), "") << "ten characters";
    EXPECT_EQ(id(three.c_str(), "mori"), "password-unfit");
    EXPECT_EQ(id("short", "mori"), "password-unfit");
    EXPECT_EQ(id("123 Mori 456", "mori"), "password-unfit");
    EXPECT_EQ(id("aaaaaaaaaaaaa", "mori"), "password-unfit");
    EXPECT_EQ(id(std::string(257, 'x').append("y").c_str(), "mori"), "password-unfit");
    EXPECT_FALSE(test::errorFrom([] { requireGoodPassword("", ""); })->remedy().empty());
}

TEST(Secrets, AreByChanceAndComparedWhole) {
    std::set<std::string> all;
    for (int i = 0; i < 1000; ++i)
        all.insert(newSecret());
    EXPECT_EQ(all.size(), 1000u);
    EXPECT_EQ(all.begin()->size(), 64u);
    const std::string token = *all.begin(), other = *all.rbegin();
    EXPECT_EQ(requestTokenOf(token), requestTokenOf(token));
    EXPECT_NE(requestTokenOf(token), requestTokenOf(other));
    EXPECT_THAT(requestTokenOf(token), Not(HasSubstr(token)));
    EXPECT_NE(requestTokenOf(token), requestTokenOf(token.substr(0, 63) + (token[63] == '0' ? "1" : "0")));
    EXPECT_TRUE(isSameSecret(token, std::string(token)));
    EXPECT_FALSE(isSameSecret(token, other));
    EXPECT_FALSE(isSameSecret(token, token.substr(1)));
    EXPECT_TRUE(isSameSecret("", ""));
}

TEST(StationCodes, AreReadAsTheyAreMeant) {
    std::set<std::string> all;
    std::map<char, int> letters;
    for (int i = 0; i < 2000; ++i) {
        const std::string code = newStationCode();
        all.insert(code);
        ASSERT_EQ(code.size(), 15u);
        EXPECT_EQ(typedStationCode(code), code);
        for (const char c : code)
            ++letters[c];
    }
    EXPECT_EQ(all.size(), 2000u);
    EXPECT_EQ(letters.size(), 33u) << "32 letters and the hyphen";
    // 24,000 letters: 750 of each, within six times the spread of chance.
    for (const auto& [letter, count] : letters)
        if (letter != '-') {
            EXPECT_NEAR(count, 750, 6 * 27) << letter;
        }
    EXPECT_EQ(typedStationCode("abc def ghj k1o"), "ABC-DEF-GHJ-K10");
    EXPECT_EQ(typedStationCode("ABCDEFGHJKlO"), "ABC-DEF-GHJ-K10");
}

TEST(Throttling, LetsFiveGuessesPassAndThenEverFewer) {
    EXPECT_EQ(waitAfterFailures(0), 0);
    EXPECT_EQ(waitAfterFailures(4), 0);
    EXPECT_EQ(waitAfterFailures(5), 2000);
    EXPECT_EQ(waitAfterFailures(6), 4000);
    for (int n = 1; n < 3000; ++n)
        EXPECT_GE(waitAfterFailures(n), waitAfterFailures(n - 1));
    EXPECT_EQ(waitAfterFailures(2'000'000'000), 900'000);

    // Who guesses as fast as it is let: how many guesses a day?
    Throttle throttle;
    int guesses = 0;
    const std::int64_t day = 86'400'000;
    for (std::int64_t now = 0; now < day; now += std::max<std::int64_t>(1, throttle.waitMs("mori", now))) {
        ASSERT_EQ(throttle.waitMs("mori", now + throttle.waitMs("mori", now)), 0);
        if (throttle.waitMs("mori", now) > 0) continue;
        throttle.failed("mori", now);
        ++guesses;
    }
    EXPECT_LT(guesses, 115);
    EXPECT_GT(guesses, 90) << "and who forgot theirs is not shut out for good";
    EXPECT_EQ(throttle.waitMs("sato", day), 0) << "nobody else waits";
    EXPECT_GT(throttle.waitMs("mori", day), 0);
    EXPECT_EQ(throttle.waitMs("mori", day, 100'000), 0) << "as an address, behind which a class sits";
    throttle.takenBack("mori");
    EXPECT_GT(throttle.waitMs("mori", day), 0) << "one of many";
    throttle.succeeded("mori");
    EXPECT_EQ(throttle.waitMs("mori", day), 0);
}

TEST(Throttling, ForgetsAfterAnHourMinesNoMemoryAndBearsAClockThatJumps) {
    Throttle throttle;
    for (int i = 0; i < 20; ++i)
        throttle.failed("a", 1000);
    EXPECT_EQ(throttle.waitMs("a", 1000), 900'000);
    EXPECT_EQ(throttle.waitMs("a", -5'000'000), 900'000) << "set back: the longest wait and no longer";
    throttle.failed("a", 1000 + Throttle::kForgottenMs + 1);
    EXPECT_EQ(throttle.waitMs("a", 1000 + Throttle::kForgottenMs + 1), 0) << "the first again";
    for (int i = 0; i < 20'000; ++i)
        throttle.failed(fmt::format("address {}", i), 10'000'000 + i);
    EXPECT_EQ(throttle.keys(), Throttle::kMostKeys);
    for (int i = 0; i < 6; ++i)
        throttle.failed("b", 20'000'000);
    for (int i = 0; i < 5000; ++i)
        throttle.failed(fmt::format("more {}", i), 20'000'001 + i);
    EXPECT_GT(throttle.waitMs("b", 20'000'001), 0) << "who failed last is still known";
}

// What each may, written down once more in words: role, action, and of what: own, class (shared or an assignment's),
// private (another's practice in that class), other (of no class of theirs).
constexpr const char* kAllowed = R"(
student see-attempt own
student see-name own
student see-marks own
student share own
student comment own
student export-person own
student see-audit own
teacher see-attempt own class
teacher see-name own class
teacher see-marks own class
teacher mark class
teacher mark-blind class
teacher share own
teacher comment own class
teacher see-class own class
teacher watch-station own class
teacher assign own class
teacher rescore own class
teacher set-exercise own class private other
teacher export-person own
teacher see-audit own
examiner see-attempt own class
examiner mark-blind class
examiner share own
examiner comment own class
examiner export-person own
examiner see-audit own
administrator see-name own class private other
administrator manage-people own class private other
administrator manage-classes own class private other
administrator manage-stations own class private other
administrator export-person own class private other
administrator erase-person own class private other
administrator see-audit own class private other
)";

TEST(Permissions, AreThoseWrittenDownAndNoOthers) {
    std::set<std::string> allowed;
    std::istringstream lines(kAllowed);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string role, action, of;
        words >> role >> action;
        while (words >> of)
            allowed.insert(role + " " + action + " " + of);
    }
    std::size_t granted = 0;
    for (std::size_t r = 0; r < kRoles; ++r)
        for (std::size_t a = 0; a < kActions; ++a) {
            const Role role = static_cast<Role>(r);
            const Action action = static_cast<Action>(a);
            const std::map<std::string, Relation> relations = {
                {"own", {true, false, std::nullopt}},
                {"class", {false, false, role}},
                {"private", {false, true, role}},
                {"other", {false, false, std::nullopt}},
            };
            for (const auto& [of, relation] : relations) {
                const std::string what = fmt::format("{} {} {}", nameOf(role), nameOf(action), of);
                EXPECT_EQ(may(std::vector{role}, action, relation), allowed.contains(what)) << what;
                granted += allowed.contains(what) ? 1 : 0;
                // Without a role nothing at all.
                EXPECT_FALSE(may(std::vector<Role>{}, action, relation)) << what;
                // Two roles: what either may, and no role lends another its class.
                for (std::size_t s = 0; s < kRoles; ++s) {
                    const Role second = static_cast<Role>(s);
                    EXPECT_EQ(may(std::vector{role, second}, action, relation),
                              may(std::vector{role}, action, relation) || may(std::vector{second}, action, relation));
                }
            }
            // In another role in that class: as anybody else.
            for (std::size_t s = 0; s < kRoles; ++s)
                if (s != r) {
                    EXPECT_EQ(may(std::vector{role}, action, {false, false, static_cast<Role>(s)}),
                              may(std::vector{role}, action, relations.at("other")));
                }
        }
    EXPECT_EQ(granted, allowed.size()) << "a line names what there is not";
    // Nobody marks their own work, also not as a teacher of the class.
    for (const Action action : {Action::mark, Action::markBlind})
        EXPECT_FALSE(
            may(std::vector{Role::teacher, Role::examiner, Role::administrator}, action, {true, false, Role::teacher}));
}

TEST(Permissions, KnowTheirNames) {
    for (std::size_t r = 0; r < kRoles; ++r)
        EXPECT_EQ(roleOf(nameOf(static_cast<Role>(r))), static_cast<Role>(r));
    EXPECT_FALSE(roleOf("king"));
    std::set<std::string_view> names;
    for (std::size_t a = 0; a < kActions; ++a)
        names.insert(nameOf(static_cast<Action>(a)));
    EXPECT_EQ(names.size(), kActions);
}

}  // namespace
}  // namespace handpiece::school::people_test
