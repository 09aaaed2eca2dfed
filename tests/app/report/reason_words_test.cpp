// SPDX-License-Identifier: Apache-2.0
// Why work was refused: English in a school's books, and in a reader's language on its pages.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "handpiece/app/report/assessment_words.h"
#include "handpiece/base/config/words.h"

namespace handpiece::report::reason_words_test {
namespace {

using config::Words;

/// What stands in the sources, with strings that are broken over lines put together.
std::string sources() {
    std::ostringstream all;
    for (const char* folder : {"/src/handpiece/app", "/apps/school"})
        for (const auto& entry :
             std::filesystem::recursive_directory_iterator(HANDPIECE_SOURCE_DIR + std::string(folder)))
            if (entry.path().extension() == ".cpp") all << std::ifstream(entry.path()).rdbuf();
    return std::regex_replace(all.str(), std::regex("\"\\s*\n\\s*\""), "");
}

TEST(ReasonWords, EachIsSaidSomewhereAndFoundAgain) {
    const std::string all = sources();
    const config::LanguageHere here("ja");
    const Words &english = Words::in("en"), &japanese = Words::in("ja");
    int found = 0;
    for (const auto& [id, text] : english.texts()) {
        if (id.rfind("reason.", 0) != 0) continue;
        ++found;
        // Its pieces between what differs are those of the program.
        std::size_t at = 0;
        for (std::size_t from = 0; from < text.size();) {
            const std::size_t end = std::min(text.find("{}", from), text.size());
            const std::string piece = text.substr(from, end - from);
            if (piece.size() > 3) at = all.find(piece);
            EXPECT_NE(at, std::string::npos) << id << ": nobody says \"" << piece << "\"";
            from = end + 2;
        }
        std::vector<std::string> places;
        for (std::size_t place = text.find("{}"); place != text.npos; place = text.find("{}", place + 2))
            places.push_back("x" + std::to_string(places.size()));
        EXPECT_EQ(reasonOf(english(config::Phrase{id, places})), japanese(config::Phrase{id, places})) << id;
    }
    EXPECT_GT(found, 25);
}

TEST(ReasonWords, SeveralInOneAndWhatHasWordsOfItsOwn) {
    const std::string english =
        "session 1: bur A was another; session 2: bur B had another shape; enamel was another than the exercise's";
    EXPECT_EQ(reasonOf(english), english);
    const config::LanguageHere here("ja");
    const Words& words = Words::in("ja");
    EXPECT_EQ(reasonOf("bur A had another shape; enamel was another than the exercise's"),
              words("reason.bur-shape", "A") + "; " + words("reason.other-tissue", words.text("tissue.enamel")));
    EXPECT_EQ(reasonOf("session 2: bur B is not in the catalogue"),
              words("reason.of-session", "2", words("reason.unknown-bur", "B")));
    EXPECT_EQ(reasonOf("its station said 99 of 100, passed: teacher"),
              words("reason.station-said", "99", "100", words.text("assessment.teacher")));
    EXPECT_EQ(reasonOf("its station said that it was felt by touch, and its recording says simulated"),
              words("reason.other-device", "touch", "simulated"));
    EXPECT_EQ(reasonOf("not cut again"), words.text("said.not-cut-again"));
    for (const char* unknown : {"", "{}", "; ", "a file's name: it is damaged", "session ; : "})
        EXPECT_EQ(reasonOf(unknown), unknown) << "stays as it is";
}

}  // namespace
}  // namespace handpiece::report::reason_words_test
