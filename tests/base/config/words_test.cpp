// SPDX-License-Identifier: Apache-2.0
// The catalogue of texts against itself and against the sources: every name in every language with the same places,
// none missing, none left over.
#include "handpiece/base/config/words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "handpiece/base/core/error.h"

namespace handpiece::config::words_test {
namespace {

/// Number and format of each place: "0:.2f".
std::multiset<std::string> placesOf(const std::string& text) {
    static const std::regex place(R"(\{(\d*)(:[^}]*)?\})");
    std::multiset<std::string> places;
    int next = 0;
    for (std::sregex_iterator i(text.begin(), text.end(), place), end; i != end; ++i)
        places.insert(((*i)[1].length() > 0 ? (*i)[1].str() : std::to_string(next++)) + (*i)[2].str());
    return places;
}

std::string sources(const std::set<std::string>& kinds = {".cpp", ".h"}) {
    std::ostringstream all;
    for (const char* folder : {"/src", "/apps"})
        for (const auto& entry : std::filesystem::recursive_directory_iterator(std::string(HANDPIECE_SOURCES) + folder))
            if (kinds.count(entry.path().extension().string()) > 0) all << std::ifstream(entry.path()).rdbuf();
    return all.str();
}

/// What the viewer in a page asks for, which has those of "review." under the rest of their names.
std::set<std::string> askedByTheViewer(const std::string& viewer) {
    static const std::regex used(R"re(\bwords(?:\.([a-z]+)\b|\["([a-z-]+)"\]))re");
    std::set<std::string> asked;
    for (std::sregex_iterator i(viewer.begin(), viewer.end(), used), end; i != end; ++i)
        asked.insert("review." + (*i)[1].str() + (*i)[2].str());
    // Put together: `view-${name}` of names that stand in it.
    static const std::regex family(R"re(words\[`([a-z]+-)\$\{)re"), name(R"re("([a-z]+)")re");
    for (std::sregex_iterator i(viewer.begin(), viewer.end(), family), end; i != end; ++i)
        for (std::sregex_iterator n(viewer.begin(), viewer.end(), name); n != end; ++n)
            if (const std::string id = "review." + (*i)[1].str() + (*n)[1].str(); Words::in("en").has(id))
                asked.insert(id);
    return asked;
}

TEST(Words, EveryTextIsInEveryLanguageWithTheSamePlaces) {
    const Words& english = Words::in("en");
    ASSERT_GT(english.texts().size(), 100u);
    for (const std::string& language : Words::languages()) {
        const Words& words = Words::in(language);
        EXPECT_EQ(words.texts().size(), english.texts().size()) << language;
        for (const auto& [id, text] : english.texts()) {
            ASSERT_TRUE(words.has(id)) << language << " lacks " << id;
            EXPECT_FALSE(words.text(id).empty()) << language << ", " << id;
            EXPECT_EQ(placesOf(words.text(id)), placesOf(text)) << language << ", " << id;
            static const std::regex numbered(R"(\{\d)"), counted(R"(\{[:}])");
            EXPECT_FALSE(std::regex_search(words.text(id), numbered) && std::regex_search(words.text(id), counted))
                << language << ", " << id << " numbers some of its places and not all";
        }
    }
}

TEST(Words, EveryTextThatIsUsedIsThereAndEveryOneIsUsed) {
    const std::string all = sources();
    static const std::regex used(R"re((?:words\(\)|phrase)\(\s*"([a-z0-9.-]+)")re");
    std::size_t count = 0;
    for (std::sregex_iterator i(all.begin(), all.end(), used), end; i != end; ++i, ++count)
        EXPECT_TRUE((*i)[1].str().ends_with('.') || (*i)[1].str().ends_with('-') || Words::in("en").has((*i)[1].str()))
            << (*i)[1];
    EXPECT_GT(count, 100u);
    const std::set<std::string> asked = askedByTheViewer(sources({".js"}));
    EXPECT_GT(asked.size(), 30u);
    for (const std::string& id : asked)
        EXPECT_TRUE(Words::in("en").has(id)) << id;
    // Events have spaces in their names.
    static const std::string kEvent = "review.event-";
    const auto isEvent = [&](const std::string& id) {
        if (id.rfind(kEvent, 0) != 0) return false;
        std::string name = id.substr(kEvent.size());
        std::replace(name.begin(), name.end(), '-', ' ');
        return all.find('"' + name + '"') != std::string::npos;
    };
    // Advice has a sentence for either side.
    const auto isAdvice = [&](const std::string& id) {
        static const std::regex side(R"re(advice\.([a-z-]+)-(?:low|high))re");
        std::smatch name;
        return std::regex_match(id, name, side) && all.find('"' + name[1].str() + '"') != std::string::npos;
    };
    for (const auto& [id, text] : Words::in("en").texts()) {
        // Names of families are put together: a tissue, a finding, a verdict, what scheduling, where figures come from.
        bool isFamily = false;
        for (const char* family :
             {"tissue.", "fidelity.name.", "fidelity.verdict.", "scheduling.class.", "rubric.status.", "view.",
              "measure.", "assessment.scan-on-", "school-exam.", "school-exam.kind-", "school-exam.state-",
              "school-live.flag-", "school-office.", "where.", "side.", "along.", "along.front-"})
            isFamily = isFamily || (id.rfind(family, 0) == 0 &&
                                    all.find('"' + id.substr(std::string(family).size()) + '"') != std::string::npos);
        EXPECT_TRUE(isFamily || isAdvice(id) || asked.count(id) > 0 || isEvent(id) ||
                    all.find('"' + id + '"') != std::string::npos)
            << id << " is used by nobody";
    }
}

TEST(Words, FillIn) {
    EXPECT_EQ(Words::in("en")("session.times-of", 1, 3), "1 of 3 times");
    EXPECT_EQ(Words::in("ja")("session.times-of", 1, 3), "3 回のうち 1 回");
    EXPECT_EQ(Words::in("en")(phrase("fidelity.gaps", std::string("2"), "10.0")), "2 in 10.0 s");
    EXPECT_EQ(Words::in("ja")(verbatim("{} as it is")), "{} as it is");
    EXPECT_THROW((void)Words::in("xx"), core::Error);
    EXPECT_THROW((void)Words::in("en").text("no.such"), core::Error);
}

TEST(Words, ABrowserAsksByWeights) {
    EXPECT_EQ(languageAsked("ja"), "ja");
    EXPECT_EQ(languageAsked("de-DE,de;q=0.9,ja;q=0.5,en;q=0.7"), "en");
    EXPECT_EQ(languageAsked("ja-JP, en;q=0.8"), "ja");
    EXPECT_EQ(languageAsked("ja;q=0,en;q=0.1"), "en");
    for (const char* none : {"", "de", "*", ",,;q=", "ja;q=x", "ja;q=nan"})
        EXPECT_EQ(languageAsked(none), "") << none;
}

TEST(Words, AThreadHasALanguageOfItsOwn) {
    const std::string before = words().language();
    {
        const LanguageHere here("ja");
        EXPECT_EQ(words().language(), "ja");
        std::string other;
        std::thread([&] { other = words().language(); }).join();
        EXPECT_EQ(other, before);
        const LanguageHere inner("en");
        EXPECT_EQ(words().language(), "en");
    }
    EXPECT_EQ(words().language(), before);
}

TEST(Words, TheEnvironmentChooses) {
    for (const char* name : {"LC_ALL", "LC_MESSAGES"})
        ::unsetenv(name);
    ::setenv("LANG", "ja_JP.UTF-8", 1);
    EXPECT_EQ(languageOfEnvironment(), "ja");
    ::setenv("LC_ALL", "C", 1);
    EXPECT_EQ(languageOfEnvironment(), "en");
    ::unsetenv("LC_ALL");
    ::setenv("LANG", "de_DE.UTF-8", 1);
    EXPECT_EQ(languageOfEnvironment(), "en");
}

}  // namespace
}  // namespace handpiece::config::words_test
