// SPDX-License-Identifier: Apache-2.0
// Kept measures come back to the bit, or not at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "handpiece/app/assessment/measure_store.h"
#include "handpiece/app/assessment/rescore.h"
#include "handpiece/base/core/engine_revision.h"
#include "handpiece/base/core/file.h"
#include "support/error_of.h"
#include "support/random.h"

namespace handpiece::assessment::measure_store_test {
namespace {

namespace fs = std::filesystem;
using measures::Measured;

MeasuredWork someWork() {
    MeasuredWork work;
    work.identity = {"class-one", "e1", "c1", "s1", {"h1", "h2"}, true, core::kEngineRevision};
    work.context = {"pointer \"x\"", 0.1 + 0.2};
    work.proof = "as it says, größer";
    Measured depth{"floor-depth", {}, 1.0 / 3.0, 0x1.23456789abcdep-7, {}, {}};
    depth.of.side = "mesial";
    depth.of.statistic = "p95";
    depth.evidence = {{12.345678901234567, core::Vec3(1e-17, -2.0 / 7.0, 3), {}, "deepest", 1}, {}};
    Measured over{"load-over-limit", {}, 0.0, 0.0, {}, {}};
    over.of.limit = 1.1;
    Measured none{"isthmus", {}, {}, 0.0, "the cavity has no walls", {}};
    work.measured = {depth, over, none};
    return work;
}

bool isSame(const MeasuredWork& a, const MeasuredWork& b) {
    if (a.measured.size() != b.measured.size() || a.proof != b.proof ||
        a.identity.sessionHashes != b.identity.sessionHashes || a.identity.stateHash != b.identity.stateHash ||
        a.identity.proven != b.identity.proven || a.context.device != b.context.device ||
        a.context.motionScale != b.context.motionScale)
        return false;
    for (std::size_t i = 0; i < a.measured.size(); ++i) {
        const Measured &m = a.measured[i], &n = b.measured[i];
        if (m.kind != n.kind || m.of != n.of || m.value != n.value || m.uncertainty != n.uncertainty ||
            m.reason != n.reason || m.evidence.size() != n.evidence.size())
            return false;
        for (std::size_t j = 0; j < m.evidence.size(); ++j) {
            const measures::Evidence &e = m.evidence[j], &f = n.evidence[j];
            if (e.timeS != f.timeS || e.placeMm != f.placeMm || e.forceN != f.forceN || e.text != f.text ||
                e.session != f.session)
                return false;
        }
    }
    return true;
}

const StoreKey kKey{"w1", "e1"};

TEST(MeasureStore, GivesBackWhatItWasGiven) {
    const std::string text = encodeMeasures(kKey, someWork());
    const auto back = decodeMeasures(text, kKey);
    ASSERT_TRUE(back);
    EXPECT_TRUE(isSame(*back, someWork()));
    EXPECT_EQ(text, encodeMeasures(kKey, *back));
    EXPECT_FALSE(decodeMeasures(text, {"w2", "e1"}));
    EXPECT_FALSE(decodeMeasures(text, {"w1", "e2"}));
}

TEST(MeasureStore, BelievesNothingThatWasChanged) {
    const std::string text = encodeMeasures(kKey, someWork());
    for (std::size_t i = 0; i < text.size(); ++i)
        for (const int bit : {0, 3, 6}) {
            std::string other = text;
            other[i] = static_cast<char>(other[i] ^ (1 << bit));
            EXPECT_FALSE(decodeMeasures(other, kKey)) << i << " bit " << bit;
        }
    for (std::size_t n = 0; n < text.size(); ++n)
        EXPECT_FALSE(decodeMeasures(std::string_view(text).substr(0, n), kKey)) << n;
    EXPECT_FALSE(decodeMeasures(text + " ", kKey));
}

TEST(MeasureStore, BelievesNoFileThatOthersMayWrite) {
    const test::TemporaryFolder folder;
    const MeasureStore store(folder.path() / "kept");
    EXPECT_FALSE(store.find(kKey));
    store.keep(kKey, someWork());
    ASSERT_TRUE(store.find(kKey));
    const fs::path file = fs::directory_iterator(folder.path() / "kept")->path();
    fs::permissions(file, fs::perms::others_write, fs::perm_options::add);
    EXPECT_FALSE(store.find(kKey));
    // Nothing that would not come back as it was.
    MeasuredWork broken = someWork();
    broken.measured[0].value = std::nan("");
    store.keep({"w2", "e1"}, broken);
    EXPECT_FALSE(store.find({"w2", "e1"}));
    const MeasureStore nowhere{fs::path()};
    nowhere.keep(kKey, someWork());
    EXPECT_FALSE(nowhere.find(kKey));
    // Where nothing can be written nothing is lost.
    core::writeFile(folder.path() / "file", "x");
    MeasureStore(folder.path() / "file" / "in").keep(kKey, someWork());
}

TEST(MeasureStore, AddsToTheSameToothOnly) {
    const test::TemporaryFolder folder;
    const MeasureStore store(folder.path() / "kept");
    store.keep(kKey, someWork());
    MeasuredWork more = someWork();
    more.measured = {{"removed", {}, 2.5, 0.1, {}, {}}, someWork().measured[1]};
    store.add(kKey, more);
    MeasuredWork both = more;
    both.measured.push_back(someWork().measured[0]);
    both.measured.push_back(someWork().measured[2]);
    ASSERT_TRUE(store.find(kKey));
    EXPECT_TRUE(isSame(*store.find(kKey), both));
    for (const bool isOtherTooth : {true, false}) {
        MeasuredWork other = more;
        if (isOtherTooth)
            other.identity.stateHash = "s2";
        else
            other.identity.proven = false;
        store.keep(kKey, someWork());
        store.add(kKey, other);
        EXPECT_TRUE(isSame(*store.find(kKey), other));
    }
}

TEST(MeasureStore, TakesWhatIsMissingAndKeepsWhoseItIs) {
    MeasuredWork kept = someWork(), more = someWork();
    more.identity.proven = false;
    more.measured = {{"removed", {}, 2.5, 0.1, {}, {}}, {"isthmus", {}, 9.0, 0.1, {}, {}}};
    ASSERT_TRUE(takeMissing(kept, more));
    EXPECT_TRUE(kept.identity.proven);
    ASSERT_EQ(kept.measured.size(), 4u) << "what it has stays as it is";
    EXPECT_FALSE(findMeasured(kept, "isthmus", {})->value);
    EXPECT_EQ(findMeasured(kept, "removed", {})->value, 2.5);
    EXPECT_EQ(findMeasured(kept, "floor-depth", {}), nullptr) << "that is of the mesial side";
    more.identity.stateHash = "s2";
    more.measured.push_back({"ridge", {}, 1.0, 0.1, {}, {}});
    EXPECT_FALSE(takeMissing(kept, more));
    EXPECT_EQ(kept.measured.size(), 4u);
}

TEST(Rescore, OfWhatIsNoWorkIsRowsWithReasonsAndStopsWhenAsked) {
    const test::TemporaryFolder folder;
    EXPECT_THAT(test::errorOf([&] { (void)worksIn(folder.path() / "nowhere"); }), testing::HasSubstr("no such folder"));
    core::writeFile(folder.path() / "notes.txt", "x");
    EXPECT_THAT(test::errorOf([&] { (void)worksIn(folder.path()); }), testing::HasSubstr("nothing to score"));
    for (const char* name : {"b.h5", "a.h5", "=c,\"d.h5", "e.handpiece"})
        core::writeFile(folder.path() / name, "no session");
    const std::vector<fs::path> works = worksIn(folder.path());
    ASSERT_EQ(works.size(), 4u);
    const rubric::Rubric rubric = rubric::shippedRubric("46-class-i");
    double most = 0.0;
    const std::vector<Rescored> all = rescore(works, {}, rubric, MeasureStore({}), [&](double fraction) {
        most = std::max(most, fraction);
        return true;
    });
    EXPECT_DOUBLE_EQ(most, 1.0);
    for (std::size_t i = 0; i < works.size(); ++i) {
        EXPECT_EQ(all[i].work, works[i]);
        EXPECT_FALSE(all[i].result);
        EXPECT_FALSE(all[i].problem.empty());
    }
    const std::string csv = rescoredCsv(all, rubric);
    EXPECT_THAT(csv, testing::HasSubstr("\n\"'=c,\"\"d.h5\","));
    const auto commas = [](std::string_view line) {
        std::size_t n = 0;
        bool isIn = false;
        for (const char c : line) {
            if (c == '"') isIn = !isIn;
            n += c == ',' && !isIn;
        }
        return n;
    };
    const std::string_view view = csv;
    const std::size_t head = commas(view.substr(0, view.find('\n')));
    EXPECT_EQ(commas(view), head * 5);
    EXPECT_THAT(
        test::errorOf([&] { (void)rescore(works, {}, rubric, MeasureStore({}), [](double) { return false; }); }),
        testing::HasSubstr("cancelled"));
}

}  // namespace
}  // namespace handpiece::assessment::measure_store_test
