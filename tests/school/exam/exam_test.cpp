// SPDX-License-Identifier: Apache-2.0
// An exam's pack, the chain of what happened at a station, receipts: what is refused, and with which words.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <random>
#include <span>

#include "handpiece/assess/rubric/rubric.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/file.h"
#include "handpiece/model/case/exercise.h"
#include "handpiece/school/exam/invigilation.h"
#include "handpiece/school/exam/receipt.h"
#include "handpiece/school/exam/seal.h"
#include "handpiece/school/people/secret.h"
#include "handpiece/school/store/content_files.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::exam::exam_test {
namespace {

namespace fs = std::filesystem;
using test::errorIdOf;
using test::errorOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr Milliseconds kOpens = 1'790'000'000'000, kHour = 3'600'000, kMinute = 60'000;
const std::string kBytes = "an exercise's bytes", kPin = "ABC-DEF-GHJ-KMN", kNextPin = "ABC-DEF-GHJ-KMP",
                  kOpening = "000-111-222-333", kCode = "123-456-789-ABC", kExtra = "QRS-TVW-XYZ-012";

/// Once: it takes its time.
const std::string& hashOf(const std::string& code) {
    static std::map<std::string, std::string> hashes;
    std::string& hash = hashes[code];
    if (hash.empty()) hash = school::hashOfPassword(code);
    return hash;
}

Pack packOf(std::int64_t format = 2) {
    Pack p;
    p.format = format;
    p.exam = "exam-1", p.title = "Class II, first sitting", p.exercise = std::string(16, 'e');
    p.file = school::sha256(kBytes), p.bytes = static_cast<std::int64_t>(kBytes.size());
    p.rubric = std::string(16, 'a'), p.engine = core::kEngineRevision;
    p.opens = kOpens, p.closes = kOpens + 2 * kHour, p.minutes = 30;
    p.locked = {"undo", "guide"};
    p.candidates = {{candidateHash("exam-1", kCode), 0, 0, {}},
                    {candidateHash("exam-1", kExtra), 25, 10, {"scale-bar"}}};
    if (format == 1) {
        p.invigilators = {{"t1", hashOf(kPin)}};
        return p;
    }
    p.seal = hashOf(kOpening);
    for (Candidate& one : p.candidates)
        one.confirmations = {hashOf(kPin), hashOf(kNextPin)};
    p.invigilators = {{"t1"}};
    return p;
}

class AtAStation : public testing::Test {
  protected:
    void SetUp() override {
        keepStation({"http://school", std::string(32, 'c'), std::string(64, 'd'), server_.open}, folder());
    }
    [[nodiscard]] fs::path folder() const { return folder_.path() / "service"; }
    [[nodiscard]] Signed signedPack(const Pack& pack) const {
        const std::string text = toText(pack);
        return {text, signatureOf(text, server_)};
    }
    void install(const Pack& pack) {
        const fs::path file = folder_.path() / "exercise";
        if (pack.format == 1)
            core::writeFile(file, kBytes);
        else
            core::writeFile(file, sealed(std::as_bytes(std::span(kBytes)), pack.exam, kOpening));
        (void)installPack(folder(), signedPack(pack), file);
        if (pack.format != 1) openExercise(folder(), pack, kOpening);
    }
    [[nodiscard]] const Sitting& begin(Invigilation& at, const std::string& code = kCode,
                                       Milliseconds now = kOpens + kMinute, const std::string& pin = kPin) const {
        return at.begin(code, "t1", pin, kRubricFormat, now);
    }
    static void handOver(Invigilation& at, const std::string& sitting, const std::string& bytes = "a session") {
        core::writeFile(at.placeFor(sitting, 1), bytes);
    }
    /// Of one sitting, from its beginning to its end.
    static std::vector<Entry> entriesOf(const Invigilation& at, const std::string& sitting) {
        std::vector<Entry> all;
        for (const Signed& one : at.entriesAfter(0, 1000)) {
            const Entry e = entryFrom(one.text, "");
            if (e.sitting == sitting || (!all.empty() && e.kind == "started")) all.push_back(e);
        }
        return all;
    }

    test::TemporaryFolder folder_;
    SigningKey server_ = newSigningKey();
};

TEST(Signatures, OfAPackFailForEveryBitAndForAnotherKey) {
    const SigningKey key = newSigningKey(), other = newSigningKey();
    const std::string text = toText(packOf());
    const Signature right = signatureOf(text, key);
    EXPECT_TRUE(isSigned(text, right, key.open));
    const std::string whole = joined({text, right});
    EXPECT_EQ(toText(openedPack(parted(whole, ""), key.open, "")), text);
    std::size_t flipped = 0;
    for (std::size_t i = 0; i < whole.size(); ++i)
        for (int bit = 0; bit < 8; ++bit) {
            std::string changed = whole;
            changed[i] = static_cast<char>(changed[i] ^ (1 << bit));
            const std::string id = errorIdOf([&] { (void)openedPack(parted(changed, ""), key.open, "pack"); });
            ASSERT_THAT(id, testing::AnyOf("exam-changed", "exam-other-key", "exam-damaged")) << i << " " << bit;
            ++flipped;
        }
    EXPECT_GT(flipped, 8u * 700u);
    EXPECT_EQ(errorIdOf([&] {
                  (void)openedPack({text, signatureOf(text, other)}, key.open, "pack");
              }),
              "exam-other-key");
    // Who signs by another key and names the right one is found as well.
    Signature forged = signatureOf(text, other);
    forged.key = key.open;
    EXPECT_EQ(errorIdOf([&] { (void)openedPack({text, forged}, key.open, "pack"); }), "exam-changed");
}

// RFC 8032, 7.1, TEST 2: one byte 0x72.
TEST(Signatures, AreThoseOfTheStandard) {
    const SigningKey key{"3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c",
                         "4ccd089b28ff96da9db6c346ec114e0f5b8a319f35aba624da8cf6ed4fb8a6fb"
                         "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c"};
    EXPECT_EQ(signatureOf("r", key).value,
              "92a009a9f0d4cab8720e820b5f642540a2b27b5416503f8fb3762223ebdb69da"
              "085ac1e43e15996e458f3613d0f11d8c387b2eaeb4302aeeb00d291612bb0c00");
}

TEST(Signatures, AKeyIsMadeOnceAndOnlyItsOwnerReadsIt) {
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "exam.key";
    const SigningKey first = keptSigningKey(file);
    EXPECT_EQ(keptSigningKey(file).secret, first.secret);
    EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    core::writeFile(file, std::string("no key"));
    EXPECT_EQ(errorIdOf([&] { (void)keptSigningKey(file); }), "key-damaged");
}

TEST(Packs, AreWrittenInOneWay) {
    const std::string text = toText(packOf());
    EXPECT_EQ(toText(packFrom(text, "")), text);
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string other = text;
        const std::size_t at = other.find(from);
        EXPECT_NE(at, other.npos) << from;
        return other.replace(at, from.size(), to);
    };
    const auto id = [](const std::string& t) { return errorIdOf([&] { (void)packFrom(t, "pack"); }); };
    EXPECT_EQ(id(changed("minutes: 30", "minutes: 030")), "exam-damaged");
    EXPECT_EQ(id(changed("minutes: 30", "minutes: +30")), "exam-damaged");
    EXPECT_EQ(id(changed("minutes: 30", "minutes: 30\nminutes: 60")), "exam-damaged");
    EXPECT_EQ(id(changed("minutes: 30\n", "")), "exam-damaged");
    EXPECT_EQ(id(text + "x: y\n"), "exam-damaged");
    EXPECT_EQ(id(text.substr(0, text.size() - 1)), "exam-damaged");
    EXPECT_EQ(id(""), "exam-damaged");
    EXPECT_EQ(id(changed("pack 2", "pack 3")), "exam-newer");
    EXPECT_EQ(id(changed("pack 2", "pack 1")), "exam-damaged") << "what is of this format is none of before";
    EXPECT_EQ(toText(packFrom(toText(packOf(1)), "")), toText(packOf(1))) << "those of before stay readable";
    EXPECT_EQ(id(changed("undo guide", "undo telepathy")), "exam-newer");
    EXPECT_THAT(errorOf([&] { (void)packFrom(changed("undo guide", "undo telepathy"), "pack"); }),
                AllOf(HasSubstr("telepathy"), HasSubstr("bring this station up to date")));
    Pack twice = packOf();
    twice.candidates.push_back(twice.candidates.front());
    EXPECT_EQ(errorIdOf([&] { (void)toText(twice); }), "exam-duplicate");
    Pack badly = packOf();
    badly.title = "two\nlines";
    EXPECT_EQ(errorIdOf([&] { (void)toText(badly); }), "books-invalid");
    EXPECT_EQ(packFrom(text, "").candidates.at(0).confirmations.size(), 2u);
    // Codes are not in it.
    EXPECT_THAT(text, AllOf(Not(HasSubstr(kCode)), Not(HasSubstr(kPin))));
    EXPECT_NE(candidateHash("exam-1", kCode), candidateHash("exam-2", kCode));
    EXPECT_EQ(candidateHash("exam-1", "123 456 789 abc"), candidateHash("exam-1", kCode)) << "as it is meant";
}

TEST(Packs, OfChanceComeBackAndDamagedOnesAreOneError) {
    const std::uint64_t seed = test::seed(20261126);
    std::mt19937_64 random(seed);
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    std::size_t read = 0, refused = 0;
    for (int round = 0; round < 300; ++round) {
        Pack p = packOf();
        p.version = 1 + static_cast<std::int64_t>(below(1000)), p.minutes = 1 + static_cast<std::int64_t>(below(1440));
        p.title = std::string(below(300), 'x'), p.locked.clear(), p.candidates.clear();
        for (std::size_t n = below(5); n > 0; --n)
            p.candidates.push_back({school::sha256(std::to_string(random())), static_cast<std::int64_t>(below(301)),
                                    static_cast<std::int64_t>(below(601)),
                                    below(2) == 0 ? std::vector<std::string>{}
                                                  : std::vector<std::string>{std::string(cases::kHelps[below(14)])}});
        const std::string text = toText(p);
        ASSERT_EQ(toText(packFrom(text, "")), text);
        std::string damaged = text;
        for (std::size_t n = 1 + below(4); n > 0; --n) {
            const std::size_t at = below(damaged.size());
            switch (below(3)) {
                case 0:
                    damaged[at] = static_cast<char>(random());
                    break;
                case 1:
                    damaged.erase(at, 1 + below(20));
                    break;
                default:
                    damaged.insert(at, text.substr(below(text.size()), below(40)));
            }
        }
        std::string id;
        try {
            // What is read is written as it was.
            EXPECT_EQ(toText(packFrom(damaged, "")), damaged);
            ++read;
        } catch (const core::Error& e) {
            ++refused;
            EXPECT_THAT(e.id(), testing::AnyOf("exam-damaged", "exam-newer", "exam-duplicate")) << e.what();
        }
    }
    EXPECT_GT(refused, 200u);
    EXPECT_EQ(read + refused, 300u);
}

TEST(Packs, AreBegunInTheirTimeWithWhatOneNeeds) {
    const Pack p = packOf();
    EXPECT_THAT(errorOf([&] { requireOpen(p, kOpens - 1); }),
                AllOf(HasSubstr("begins 2026-09-21 14:13 UTC"), HasSubstr("2026-09-21 14:13 UTC at this station")));
    EXPECT_EQ(errorIdOf([&] { requireOpen(p, kOpens - 24 * kHour); }), "exam-early") << "a clock that is a day behind";
    EXPECT_EQ(errorIdOf([&] { requireOpen(p, kOpens); }), "");
    EXPECT_EQ(errorIdOf([&] { requireOpen(p, p.closes); }), "");
    EXPECT_EQ(errorIdOf([&] { requireOpen(p, p.closes + 1); }), "exam-expired");
    EXPECT_EQ(errorIdOf([&] { (void)candidateOf(p, "AAA-AAA-AAA-AAA"); }), "exam-candidate-unknown");
    const Candidate& plain = candidateOf(p, kCode);
    const Candidate& more = candidateOf(p, "qrs tvw xyz 0i2");
    EXPECT_EQ(deadlineOf(p, plain, 0), 30 * kMinute);
    EXPECT_EQ(deadlineOf(p, more, 0), 37 * kMinute + 30'000 + 10 * kMinute) << "a quarter more, and ten for pauses";
    EXPECT_THAT(lockedFor(p, plain, {"scale-bar"}), ElementsAre("undo", "guide", "scale-bar"));
    EXPECT_THAT(lockedFor(p, more, {"scale-bar"}), ElementsAre("undo", "guide"));
    Pack newer = p;
    newer.rubricFormat = kRubricFormat + 1;
    EXPECT_EQ(errorIdOf([&] { requireFitting(newer, kRubricFormat, p.engine); }), "exam-rubric-newer");
    EXPECT_EQ(errorIdOf([&] { requireFitting(p, kRubricFormat, p.engine + 1); }), "exam-engine-other");
    EXPECT_EQ(errorIdOf([&] { requireFitting(p, kRubricFormat, p.engine); }), "");
    // And that is what this program's own reader knows.
    const auto reads = [](std::int64_t format) {
        return errorOf([&] { (void)rubric::parseRubric(fmt::format("format = {}\n", format), "rubric.toml"); });
    };
    EXPECT_THAT(reads(kRubricFormat), Not(HasSubstr("is not known")));
    EXPECT_THAT(reads(kRubricFormat + 1), HasSubstr("is not known"));
}

TEST_F(AtAStation, APackIsTakenWholeAndOnlyWithItsExercise) {
    for (const std::int64_t format : {1, 2})
        EXPECT_EQ(errorIdOf([&] { (void)installPack(folder(), signedPack(packOf(format)), {}); }),
                  "exam-exercise-other");
    const fs::path file = folder_.path() / "other";
    core::writeFile(file, std::string("another exercise"));
    EXPECT_EQ(errorIdOf([&] { (void)installPack(folder(), signedPack(packOf(1)), file); }), "exam-exercise-other");
    Pack second = packOf();
    second.version = 2;
    install(second);
    EXPECT_EQ(errorIdOf([&] { install(packOf()); }), "exam-older");
    std::vector<std::string> problems;
    EXPECT_THAT(packsIn(folder(), problems), SizeIs(1));
    EXPECT_THAT(problems, IsEmpty());
    // Another exercise under the pack at the station, and a pack that was changed there.
    const fs::path exercise = folder() / "exercises" / (second.file + ".handpiece");
    core::writeFile(exercise, std::string("an easier one"));
    EXPECT_THAT(packsIn(folder(), problems), IsEmpty());
    ASSERT_THAT(problems, SizeIs(1));
    EXPECT_THAT(problems[0], HasSubstr("not the one that its pack names"));
    core::writeFile(exercise, kBytes);
    std::string text = toText(second);
    core::writeFile(folder() / "packs" / "exam-1" / "pack.txt", text.replace(text.find("30"), 2, "90"));
    problems.clear();
    EXPECT_THAT(packsIn(folder(), problems), IsEmpty());
    EXPECT_THAT(problems[0], HasSubstr("changed, if only in one bit"));
}

TEST_F(AtAStation, ACandidateBeginsWithAnInvigilatorAndEveryBeginningStays) {
    install(packOf());
    Invigilation at(folder(), kOpens);
    const auto tried = [&](const std::string& code, const std::string& who, const std::string& pin, Milliseconds now) {
        return errorIdOf([&] { (void)at.begin(code, who, pin, kRubricFormat, now); });
    };
    EXPECT_EQ(tried("AAA-AAA-AAA-AAA", "t1", kPin, kOpens), "exam-candidate-unknown");
    EXPECT_EQ(tried(kCode, "t1", kPin, kOpens - 1), "exam-early");
    EXPECT_EQ(tried(kCode, "t1", kPin, kOpens + 3 * kHour), "exam-expired");
    EXPECT_EQ(tried(kCode, "s1", kPin, kOpens), "exam-invigilator") << "no student confirms a student";
    EXPECT_EQ(errorIdOf([&] { (void)at.begin(kCode, "t1", kPin, 0, kOpens); }), "exam-rubric-newer");
    // To look at what a code begins is to begin nothing.
    const Sitting offered = at.look(kCode, kRubricFormat, kOpens);
    EXPECT_EQ(offered.deadline, kOpens + 30 * kMinute);
    EXPECT_TRUE(offered.id.empty());
    EXPECT_EQ(errorIdOf([&] { (void)at.look(kCode, kRubricFormat, kOpens - 1); }), "exam-early");
    EXPECT_EQ(errorIdOf([&] { (void)at.look("AAA-AAA-AAA-AAA", kRubricFormat, kOpens); }), "exam-candidate-unknown");
    EXPECT_EQ(at.end().number, 1) << "nothing of it was noted but that the service started";
    const std::string first = begin(at).id;
    EXPECT_EQ(at.sitting()->deadline, kOpens + 31 * kMinute);
    EXPECT_EQ(errorIdOf([&] { (void)at.look(kExtra, kRubricFormat, kOpens); }), "exam-running");
    EXPECT_EQ(errorIdOf([&] { (void)at.endOf(first); }), "exam-none") << "it has not ended";
    EXPECT_EQ(tried(kExtra, "t1", kPin, kOpens + kMinute), "exam-running");
    EXPECT_EQ(errorIdOf([&] { at.checkpoint(std::string(32, '0'), 1, 5, std::string(64, '1'), kOpens); }), "exam-none");
    handOver(at, first);
    const Signed finished = at.finish(first, {std::string(16, '9')}, kOpens + 20 * kMinute);
    EXPECT_EQ(entryFrom(finished.text, "").files.front().file, school::sha256("a session"));
    EXPECT_EQ(at.endOf(first).text, finished.text);
    EXPECT_EQ(errorIdOf([&] { (void)at.endOf(std::string(32, '0')); }), "exam-none");
    EXPECT_FALSE(at.sitting());
    EXPECT_EQ(errorIdOf([&] { (void)at.finish(first, {std::string(16, '9')}, kOpens); }), "exam-none");
    // Once more: it can, with an invigilator, and it shows.
    EXPECT_EQ(errorIdOf([&] { (void)begin(at, kCode, kOpens + 30 * kMinute); }), "exam-confirmation-used");
    EXPECT_EQ(begin(at, kCode, kOpens + 30 * kMinute, kNextPin).again, 1);
    EXPECT_THAT(doubtsOf(packOf(), entriesOf(at, at.sitting()->id), {}),
                ElementsAre("this candidate had begun 1 times here before"));
}

TEST_F(AtAStation, ASealedExerciseIsOpenedByItsCodeAlone) {
    const Pack pack = packOf();
    const fs::path file = folder_.path() / "sealed";
    core::writeFile(file, sealed(std::as_bytes(std::span(kBytes)), "exam-1", kOpening));
    (void)installPack(folder(), signedPack(pack), file);
    EXPECT_TRUE(hasExercise(folder(), pack));
    std::vector<std::string> problems;
    ASSERT_THAT(packsIn(folder(), problems), SizeIs(1));
    EXPECT_TRUE(packsIn(folder(), problems).front().isSealed);
    // Nothing of it lies there to be read.
    for (const auto& entry : fs::recursive_directory_iterator(folder()))
        if (entry.is_regular_file()) {
            const std::vector<std::byte> bytes = core::readFile(entry.path());
            EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()).find(kBytes),
                      std::string::npos)
                << entry.path();
        }
    Invigilation at(folder(), kOpens);
    EXPECT_EQ(errorIdOf([&] { (void)at.look(kCode, kRubricFormat, kOpens); }), "exam-sealed");
    EXPECT_EQ(errorIdOf([&] { (void)begin(at); }), "exam-sealed");
    EXPECT_EQ(errorIdOf([&] { at.open("000-111-222-334", kOpens); }), "exam-seal");
    EXPECT_EQ(errorIdOf([&] { openExercise(folder(), pack, "000-111-222-334"); }), "exam-seal");
    at.open("000 iii 222 333", kOpens);
    EXPECT_EQ(at.look(kCode, kRubricFormat, kOpens).candidate.code, candidateHash("exam-1", kCode));
    at.open(kOpening, kOpens);
    // Guessing waits, and one account's guesses are no other's.
    int tries = 0;
    while (errorIdOf([&] { at.open("000-111-222-334", kOpens, "account 1001"); }) == "exam-seal")
        ++tries;
    EXPECT_EQ(tries, 5);
    EXPECT_EQ(errorIdOf([&] { at.open(kOpening, kOpens, "account 1000"); }), "");
    // Of another exam's, a bit of it changed, cut off.
    std::vector<std::byte> bytes = sealed(std::as_bytes(std::span(kBytes)), "exam-1", kOpening);
    EXPECT_EQ(errorIdOf([&] { (void)unsealed(bytes, "exam-2", kOpening); }), "exam-seal");
    for (const std::size_t at2 : {std::size_t{0}, bytes.size() / 2, bytes.size() - 1}) {
        std::vector<std::byte> changed = bytes;
        changed[at2] ^= std::byte{1};
        EXPECT_EQ(errorIdOf([&] { (void)unsealed(changed, "exam-1", kOpening); }), "exam-seal");
        EXPECT_EQ(errorIdOf([&] { (void)unsealed(std::span(bytes).first(at2), "exam-1", kOpening); }), "exam-seal");
    }
    // What it opens to is what the pack names.
    const std::string easier = "an easier one";
    core::writeFile(folder() / "exercises" / (pack.exam + "-" + pack.file + ".sealed"),
                    sealed(std::as_bytes(std::span(easier)), "exam-1", kOpening));
    EXPECT_EQ(errorIdOf([&] { openExercise(folder(), pack, kOpening); }), "exam-exercise-other");
}

TEST_F(AtAStation, AConfirmationIsOfOneCandidateOnceAndStandsInTheChain) {
    Pack pack = packOf();
    const std::string others = "QQQ-WWW-EEE-RRR";
    for (Candidate& one : pack.candidates)
        if (one.code == candidateHash("exam-1", kExtra)) one.confirmations = {hashOf(others)};
    install(pack);
    std::string id;
    {
        Invigilation at(folder(), kOpens);
        EXPECT_EQ(errorIdOf([&] { (void)begin(at, kCode, kOpens, others); }), "exam-invigilator");
        id = begin(at, kCode, kOpens, "abc def ghj kmn").id;
        EXPECT_EQ(errorIdOf([&] { at.giveUp(id, "t1", kPin, kOpens); }), "exam-confirmation-used");
        at.giveUp(id, "t1", kNextPin, kOpens);
    }
    // Also after the service was started again.
    Invigilation at(folder(), kOpens);
    EXPECT_EQ(errorIdOf([&] { (void)begin(at); }), "exam-confirmation-used");
    EXPECT_EQ(errorIdOf([&] { (void)begin(at, kCode, kOpens, kNextPin); }), "exam-confirmation-used");
    const std::vector<Entry> entries = entriesOf(at, id);
    EXPECT_EQ(entries.front().confirmation, kPin);
    EXPECT_EQ(entries.at(1).kind, "given-up");
    EXPECT_EQ(entries.at(1).confirmation, kNextPin);
    // Entries of before have none, and are read.
    Entry before = entries.front();
    before.format = 1, before.confirmation.clear();
    EXPECT_EQ(toText(entryFrom(toText(before), "")), toText(before));
    EXPECT_EQ(toText(before).find("confirmation"), std::string::npos);
}

TEST_F(AtAStation, APackOfBeforeIsSatAsItWas) {
    install(packOf(1));
    Invigilation at(folder(), kOpens);
    const std::string id = begin(at).id;
    at.giveUp(id, "t1", kPin, kOpens + 2 * kMinute);
    EXPECT_EQ(begin(at).again, 1) << "one code for everybody, as often as it is typed";
    EXPECT_EQ(entriesOf(at, id).front().confirmation, "");
}

TEST_F(AtAStation, AnInvigilatorsCodeCannotBeGuessedAtSpeed) {
    install(packOf());
    Invigilation at(folder(), kOpens);
    int tries = 0;
    while (errorIdOf([&] { (void)at.begin(kCode, "t1", "wrong", kRubricFormat, kOpens); }) == "exam-invigilator")
        ++tries;
    EXPECT_EQ(tries, 5);
    EXPECT_EQ(errorIdOf([&] { (void)begin(at, kCode, kOpens); }), "exam-wait") << "the right one waits too";
}

TEST_F(AtAStation, AServiceThatStartsAgainGoesOnAndItShows) {
    install(packOf());
    std::string id;
    {
        Invigilation at(folder(), kOpens);
        id = begin(at, kExtra).id;
        at.checkpoint(id, 1, 1000, std::string(64, '1'), kOpens + 90'000);
    }
    Invigilation at(folder(), kOpens + 100'000);
    ASSERT_TRUE(at.sitting());
    EXPECT_EQ(at.sitting()->id, id);
    EXPECT_EQ(at.sitting()->deadline, kOpens + kMinute + 47 * kMinute + 30'000) << "with the candidate's own time";
    handOver(at, id);
    (void)at.finish(id, {std::string(16, '9')}, kOpens + 3 * kMinute);
    const std::vector<Entry> entries = entriesOf(at, id);
    EXPECT_THAT(doubtsOf(packOf(), entries, {}), ElementsAre("the station's service was started again 1 times"));
}

TEST_F(AtAStation, WhatAChainSaysIsHeldAgainstTheTime) {
    const Pack pack = packOf();
    Entry begun;
    begun.kind = "begun", begun.at = kOpens + kMinute, begun.sitting = std::string(32, '5'), begun.invigilator = "t1";
    begun.candidate = candidateHash("exam-1", kCode);
    const auto entry = [&](const char* kind, Milliseconds at, std::int64_t ticks = 0) {
        Entry e;
        e.kind = kind, e.at = at, e.sitting = begun.sitting, e.part = 1, e.ticks = ticks;
        return e;
    };
    const auto doubts = [&](std::vector<Entry> more, const std::vector<Milliseconds>& received = {}) {
        more.insert(more.begin(), begun);
        return doubtsOf(pack, more, received);
    };
    const Milliseconds from = begun.at;
    EXPECT_THAT(doubts({entry("checkpoint", from + 30'000, 5), entry("finished", from + 60'000)}), IsEmpty());
    EXPECT_THAT(doubts({entry("finished", from + 60'000)}), ElementsAre(HasSubstr("before it was handed over")));
    EXPECT_THAT(doubts({entry("checkpoint", from + 30'000, 5), entry("finished", from + 300'000)}),
                ElementsAre("nothing was heard of the work for 270 s"));
    std::vector<Entry> late;
    for (int i = 1; i <= 34; ++i)
        late.push_back(entry("checkpoint", from + i * kMinute, i));
    late.push_back(entry("finished", from + 34 * kMinute + 1000));
    EXPECT_THAT(doubts(late), ElementsAre("it was handed over 241 s late"));
    begun.candidate = candidateHash("exam-1", kExtra);
    EXPECT_THAT(doubts(late), IsEmpty()) << "who has more time is not late";
    EXPECT_THAT(doubts({entry("checkpoint", from + 30'000, 9), entry("checkpoint", from + 60'000, 5)}),
                ElementsAre("recording 1 went back from 9 to 5 ticks"));
    EXPECT_THAT(doubts({entry("checkpoint", from - 30'000, 9)}), ElementsAre("the station's clock went back by 30 s"));
    EXPECT_THAT(doubts({}, {from - 24 * kHour}), ElementsAre(HasSubstr("ahead of the server's by 86400 s")));
    begun.at = kOpens - kMinute;
    EXPECT_THAT(doubts({}), ElementsAre(HasSubstr("before the exam opened")));
    begun.at = pack.closes + kMinute;
    EXPECT_THAT(doubts({}), ElementsAre(HasSubstr("after the exam closed")));
}

TEST_F(AtAStation, NoEntryCanBeTakenOutPutInOrChanged) {
    install(packOf());
    std::string stationKey;
    std::vector<Signed> all;
    {
        Invigilation at(folder(), kOpens);
        const std::string id = begin(at).id;
        for (int i = 1; i < 6; ++i)
            at.checkpoint(id, 1, 1000 * i, school::sha256(std::to_string(i)), kOpens + kMinute + 30'000 * i);
        handOver(at, id);
        (void)at.finish(id, {std::string(16, '9')}, kOpens + 5 * kMinute);
        all = at.entriesAfter(0, 100);
        stationKey = keptSigningKey(folder() / "station.key").open;
    }
    ASSERT_THAT(all, SizeIs(8));
    const std::string station(32, 'c');
    const auto accepts = [&](const std::vector<Signed>& chain) {
        ChainEnd end;
        for (const Signed& one : chain) {
            const std::string id = errorIdOf([&] { (void)nextOf(end, one, station, stationKey); });
            if (!id.empty()) return id;
            end = {end.number + 1, hashOfEntry(one.text)};
        }
        return std::string();
    };
    EXPECT_EQ(accepts(all), "");
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
        std::vector<Signed> without = all, swapped = all, twice = all, changed = all;
        without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
        EXPECT_EQ(accepts(without), "exam-chain") << i;
        std::swap(swapped[i], swapped[i + 1]);
        EXPECT_EQ(accepts(swapped), "exam-chain") << i;
        twice.insert(twice.begin() + static_cast<std::ptrdiff_t>(i), twice[i]);
        EXPECT_EQ(accepts(twice), "exam-chain") << i;
        changed[i].text[changed[i].text.find("at_ms: ") + 7] ^= 1;
        EXPECT_EQ(accepts(changed), "exam-changed") << i;
    }
    // A student who writes a chain of their own has not the station's key; another station's chain is not this one's.
    const SigningKey own = newSigningKey();
    std::vector<Signed> forged = all;
    for (Signed& one : forged)
        one.signature = signatureOf(one.text, own);
    EXPECT_EQ(accepts(forged), "exam-other-key");
    EXPECT_EQ(errorIdOf([&] { (void)nextOf({}, all[0], std::string(32, 'b'), stationKey); }), "exam-chain");
    // The station itself finds it too: one in the middle gone, the end gone and written anew.
    const fs::path third = folder() / "chain" / "0000000003.txt";
    const std::vector<std::byte> kept = core::readFile(third);
    core::writeFile(third, core::readFile(folder() / "chain" / "0000000004.txt"));
    EXPECT_EQ(errorIdOf([&] { Invigilation at(folder(), kOpens); }), "exam-chain");
    core::writeFile(third, kept);
    for (int i = 6; i <= 8; ++i)
        fs::remove(folder() / "chain" / fmt::format("{:010}.txt", i));
    Invigilation rolledBack(folder(), kOpens + 6 * kMinute);
    // It goes on from what it has, and whoever had the rest sees that this is another chain.
    EXPECT_EQ(errorIdOf([&] {
                  (void)nextOf({8, hashOfEntry(all[7].text)}, rolledBack.entriesAfter(5, 1).at(0), station, stationKey);
              }),
              "exam-chain");
}

TEST(Receipts, AreCheckedByAnybodyWhoHasTheSchoolsKey) {
    const SigningKey key = newSigningKey();
    Receipt r;
    r.sitting = std::string(32, '5'), r.exam = "exam-1", r.candidate = std::string(64, 'a');
    r.station = std::string(32, 'c');
    r.began = kOpens, r.finished = kOpens + kHour, r.received = r.finished + 1, r.made = r.received + 1;
    r.files = {std::string(64, 'f'), std::string(64, '0')};
    r.state = "proven", r.stateHash = std::string(16, '7'), r.verdict = "to be confirmed";
    const std::string text = toText(r), whole = joined({text, signatureOf(text, key)});
    EXPECT_EQ(toText(openedReceipt(whole, key.open, "")), text);
    r.stateHash.clear(), r.state = "waiting", r.files.clear();
    EXPECT_EQ(toText(receiptFrom(toText(r), "")), toText(r));
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::string changed = whole;
        changed[i] = static_cast<char>(changed[i] ^ 1);
        EXPECT_NE(errorIdOf([&] { (void)openedReceipt(changed, key.open, ""); }), "") << i;
    }
    EXPECT_EQ(errorIdOf([&] { (void)openedReceipt(whole, newSigningKey().open, ""); }), "exam-other-key");
    // A signature of a pack is none of a receipt.
    const std::string pack = toText(packOf());
    EXPECT_EQ(errorIdOf([&] {
                  (void)openedReceipt(joined({pack, signatureOf(pack, key)}), key.open, "");
              }),
              "exam-damaged");
    EXPECT_EQ(errorIdOf([&] { (void)openedReceipt("", key.open, ""); }), "exam-damaged");
}

}  // namespace
}  // namespace handpiece::exam::exam_test
