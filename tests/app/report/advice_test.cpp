// SPDX-License-Identifier: Apache-2.0
// Advice by the sign and the place of an error: every criterion of every rubric that comes along, to both sides, in
// both languages.
#include "handpiece/app/report/advice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "handpiece/base/config/words.h"

namespace handpiece::report::advice_test {
namespace {

using core::Vec3;
using ::testing::HasSubstr;
using ::testing::Not;

/// What a sentence must say when a value is under what was asked, and when it is over it; empty: cannot be.
struct Said {
    const char *measure, *narrowed;
    const char *low, *high, *lowJa, *highJa;
};
// Written by hand from what the measures mean, not from the words' file.
const Said kSaid[] = {
    {"floor-depth", "", "too shallow.*one more pass", "too deep", "浅い", "深い"},
    {"axial-depth", "", "too shallow.*inwards", "too deep", "浅い", "深い"},
    {"floor-flatness", "", "", "uneven", "", "凹凸"},
    {"floor-tilt", "", "", "tilted", "", "傾いて"},
    {"isthmus", "", "too narrow.*widen", "too wide.*one pass at each wall", "狭い.*広げる", "広い"},
    {"isthmus-share", "", "too narrow.*widen", "too wide.*one pass at each wall", "狭い.*広げる", "広い"},
    {"outline-extent", "", "too small.*extend", "too large.*only inside it", "小さい.*広げる", "大きい"},
    {"marginal-ridge-left", "", "thinner.*stop sooner", "thicker", "薄い", "厚い"},
    {"proximal-clearance", "", "too small.*open it", "too wide", "狭い.*開き", "広い"},
    {"wall-angle", "", "leans.*inwards.*outwards", "opens.*outwards.*back", "内側へ倒れ", "外側へ開き"},
    {"wall-height", "", "too low.*less off", "higher", "低く", "高い"},
    {"occlusal-convergence", "", "too parallel", "taper.*too much", "平行", "大きすぎる"},
    {"reduction", "", "too little taken off", "too much taken off", "足りない", "削りすぎた"},
    {"undercut-depth", "", "", "Undercut.*too much", "", "アンダーカット.*大きい"},
    {"margin-width", "", "too narrow.*once more", "too wide", "狭い", "広い"},
    {"margin-continuity", "", "missing", "", "ない所", ""},
    {"margin-height", "", "too low.*stop higher", "too high.*down", "mm 低く", "mm 高い"},
    {"remaining-dentine", "", "too little dentine", "more dentine", "足りない", "厚い"},
    {"pulp-exposed", "", "", "The pulp was opened", "", "露髄した"},
    {"gouge-depth", "", "", "deeper than allowed", "", "深く削った"},
    {"orifices-reached", "", "fewer.*than asked", "", "足りない", ""},
    {"adjacent-depth", "", "", "adjacent tooth was cut", "", "隣在歯を"},
    {"caries-left-periphery", "", "", "too much carious tissue left", "", "残っている"},
    {"caries-left-periphery", "caries-soft", "", "too much carious tissue left", "", "残っている"},
    {"unsupported-enamel", "", "", "without dentine under it", "", "象牙質のない"},
    {"removed-share", "target", "too little of the target.*still stands", "more of the target", "足りない",
     "多く削った"},
    {"removed-share", "leeway-side", "", "gone beside.*only inside it", "", "外側を.*削りすぎた"},
    {"removed", "leeway-side", "", "gone beside.*only inside it", "", "外側を.*削りすぎた"},
    {"removed-share", "leeway-floor", "", "under the target's floor", "", "底の下を.*削りすぎた"},
    {"removed", "container", "", "beyond the leeway", "", "許容域の外"},
    {"removed", "protected", "", "must stay", "", "残すべき"},
    {"removed", "dentine", "", "too much sound tissue", "", "健全な歯質"},
    {"removed", "enamel", "", "too much sound tissue", "", "健全な歯質"},
    {"impulse-not-undone", "gum", "", "bore on the gingiva", "", "歯肉に"},
};

const Said* saidOf(const rubric::Criterion& c) {
    const std::string& by = c.of.zone.empty() ? c.of.tissue : c.of.zone;
    for (const Said& one : kSaid)
        if (one.measure == c.measure && one.narrowed == by) return &one;
    return nullptr;
}

score::CriterionScore scoreOf(const rubric::Criterion& c, double value) {
    score::CriterionScore s;
    s.id = c.id;
    s.measure = c.measure;
    s.unit = c.unit;
    s.of = c.of;
    s.value = value;
    return s;
}

bool says(const std::string& sentence, const char* what) {
    return std::regex_search(sentence, std::regex(what));
}

TEST(Advice, OfEveryCriterionSaysTheRightSide) {
    int sentences = 0;
    for (const std::string& name : rubric::shippedRubrics()) {
        const rubric::Rubric rubric = rubric::shippedRubric(name);
        for (const rubric::Criterion& c : rubric.criteria) {
            if (!c.isGraded() && !c.critical) continue;
            SCOPED_TRACE(name + " " + c.id);
            const Wanted wanted = wantedOf(c, rubric);
            ASSERT_TRUE(wanted.isAnything());
            const Said* said = saidOf(c);
            ASSERT_NE(said, nullptr) << "no sentence is known for " << c.measure << " " << c.of.zone << c.of.tissue;
            for (const char* language : {"en", "ja"}) {
                const config::LanguageHere here(language);
                const bool isEnglish = std::string_view(language) == "en";
                const char *low = isEnglish ? said->low : said->lowJa, *high = isEnglish ? said->high : said->highJa;
                if (wanted.from) {
                    ASSERT_STRNE(low, "") << "it can be too low";
                    const Advice is = adviceOf(scoreOf(c, *wanted.from - 0.3), rubric, {});
                    EXPECT_EQ(is.off, Off::tooLow);
                    EXPECT_TRUE(says(is.words, low)) << is.words;
                    EXPECT_TRUE(*high == '\0' || !says(is.words, high)) << is.words;
                    EXPECT_THAT(is.words, HasSubstr("0.3")) << "by how much";
                    EXPECT_LT(is.fault.size(), is.words.size());
                    ++sentences;
                }
                if (wanted.to) {
                    ASSERT_STRNE(high, "") << "it can be too high";
                    const Advice is = adviceOf(scoreOf(c, *wanted.to + 0.3), rubric, {});
                    EXPECT_EQ(is.off, Off::tooHigh);
                    EXPECT_TRUE(says(is.words, high)) << is.words;
                    EXPECT_TRUE(*low == '\0' || !says(is.words, low)) << is.words;
                    EXPECT_THAT(is.words, HasSubstr("0.3"));
                    ++sentences;
                }
                const double right = wanted.from && wanted.to ? 0.5 * (*wanted.from + *wanted.to)
                                     : wanted.from            ? *wanted.from
                                                              : *wanted.to;
                EXPECT_EQ(adviceOf(scoreOf(c, right), rubric, {}).words, "") << "nothing is off";
            }
        }
    }
    EXPECT_GT(sentences, 200);
}

TEST(Advice, NeverSaysTheSameForBothSides) {
    for (const char* language : {"en", "ja"}) {
        const config::Words& words = config::Words::in(language);
        for (const auto& [id, text] : words.texts())
            if (id.starts_with("advice.") && id.ends_with("-low")) {
                const std::string other = id.substr(0, id.size() - 4) + "-high";
                EXPECT_TRUE(!words.has(other) || text != words.text(other)) << language << " " << id;
                EXPECT_THAT(text, HasSubstr("{0}")) << id << ": by how much";
            }
    }
}

TEST(Advice, NamesThePlaceAsADentistDoes) {
    const rubric::Rubric rubric = rubric::shippedRubric("46-class-i");
    const rubric::Criterion& depth = *rubric.criterion("depth");
    // 6 mm mesiodistally, 3 mm buccolingually, worked on from above; buccal is -y.
    const Bearings molar{{Vec3(-3, -1.5, 0), Vec3(3, 1.5, 2)}, Vec3::UnitZ(), 46, -1};
    score::CriterionScore s = scoreOf(depth, 1.2);
    s.evidence = {{{}, Vec3(0, 0, 1), {}, "depth of the floor"},
                  {{}, Vec3(2.4, 0.1, 1), {}, measures::kLeastHere},
                  {{}, Vec3(-2.4, 0.1, 1), {}, measures::kMostHere}};
    Advice is = adviceOf(s, rubric, molar);
    EXPECT_THAT(is.words, HasSubstr("0.3 mm too shallow, most of all mesially: one more pass there"));
    EXPECT_EQ(is.fault, "0.3 mm too shallow, most of all mesially");
    EXPECT_EQ(is.at, &s.evidence[1]) << "the eye is turned to where it is shallowest";
    EXPECT_EQ(is.exercise, "dexterity-steps");
    s.value = 2.3;
    is = adviceOf(s, rubric, molar);
    EXPECT_THAT(is.words, HasSubstr("0.3 mm too deep, most of all distally"));
    EXPECT_EQ(is.at, &s.evidence[2]);
    {
        const config::LanguageHere here("ja");
        EXPECT_THAT(adviceOf(s, rubric, molar).words, HasSubstr("特に遠心で0.3 mm 深い"));
    }
    const auto side = [](const Bearings& of, const Vec3& p) { return std::string(sideOf(of, p)); };
    EXPECT_EQ(side(molar, {0.1, -1.4, 1}), "buccal");
    EXPECT_EQ(side(molar, {0.1, 1.4, 1}), "lingual");
    EXPECT_EQ(side(molar, {0.2, 0.1, -9}), "") << "along the path of draw nothing is said";
    // A cavity on the labial side of a canine: worked on from there.
    const Bearings canine{{Vec3(-2, 2, 0), Vec3(2, 4, 3)}, Vec3::UnitY(), 33, 1};
    EXPECT_EQ(side(canine, {0, 3, 0.2}), "gingival");
    EXPECT_EQ(side(canine, {0, 3, 2.9}), "occlusal");
    EXPECT_EQ(sideWord(canine, "occlusal"), "incisally");
    EXPECT_EQ(sideWord(canine, "buccal"), "labially");
    EXPECT_EQ(sideWord({{}, Vec3::UnitZ(), 16, 1}, "lingual"), "palatally");
    EXPECT_EQ(side({{Vec3(-3, -3, 0), Vec3(3, 3, 2)}, Vec3::UnitZ(), 0, 0}, {2.9, 0, 0}), "") << "a block has no sides";
}

TEST(Advice, OfASelectedSideNamesThatSide) {
    const Bearings canine{{Vec3(-2, 2, 0), Vec3(2, 4, 3)}, Vec3::UnitY(), 33, 1};
    const rubric::Rubric fifth = rubric::shippedRubric("33-class-v");
    EXPECT_THAT(adviceOf(scoreOf(*fifth.criterion("mesiodistal"), 3.0), fifth, canine).words,
                HasSubstr("1.0 mm too small mesiodistally"));
    EXPECT_THAT(adviceOf(scoreOf(*fifth.criterion("inciso-gingival"), 3.5), fifth, canine).words,
                HasSubstr("0.5 mm too large incisogingivally"));
    const rubric::Rubric onlay = rubric::shippedRubric("46-onlay");
    const Bearings molar{{Vec3(-3, -1.5, 0), Vec3(3, 1.5, 2)}, Vec3::UnitZ(), 46, -1};
    EXPECT_THAT(adviceOf(scoreOf(*onlay.criterion("cusp-mesiobuccal"), 1.0), onlay, molar).words,
                HasSubstr("0.5 mm too little taken off at the mesiobuccal cusp"));
}

TEST(Critical, SaysWhatHappenedAndNotTheCriterion) {
    const rubric::Rubric rubric = rubric::shippedRubric("33-class-v");
    score::CriterionScore s = scoreOf(*rubric.criterion("gingiva"), 0.12);
    s.evidence = {{12.3, Vec3(1.9, 3, 1), 0.8, "first"}, {13.0, Vec3(1.9, 3, 1), 1.0, "most load"}};
    const Bearings canine{{Vec3(-2, 2, 0), Vec3(2, 4, 3)}, Vec3::UnitY(), 33, 1};
    EXPECT_EQ(whatHappened(rubric, s, canine), "the gingiva was cut (0.1 N·s, mesially, first at 12.3 s)");
    // No critical error of any rubric is worded as its opposite.
    for (const std::string& name : rubric::shippedRubrics()) {
        const rubric::Rubric one = rubric::shippedRubric(name);
        for (const rubric::Criterion& c : one.criteria)
            if (c.critical)
                for (const char* language : {"en", "ja"}) {
                    const config::LanguageHere here(language);
                    const std::string words = whatHappened(one, c.id);
                    EXPECT_FALSE(words.empty()) << name << " " << c.id;
                    EXPECT_FALSE(says(words, "untouched|intact|no |触れない|保つ")) << name << " " << words;
                }
    }
}

}  // namespace
}  // namespace handpiece::report::advice_test
