// SPDX-License-Identifier: Apache-2.0
// A window killed while a teacher marks in it: what was told to be kept is there on the next start, at most the one
// change under way is not, and every work has its score again.
#include <sys/wait.h>
#include <unistd.h>

#include <QDockWidget>
#include <QListWidget>
#include <QPushButton>
#include <QThread>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "desktop/features/marking/sheet_panel.h"
#include "marking_support.h"

namespace handpiece::desktop::marking_kill_test {
namespace {

namespace fs = std::filesystem;

/// What was done to a desk, and what was under way when it ended.
struct Change {
    std::string what, code, criterion;
    double points = 0.0;
    int number = 0;
};
struct Told {
    std::vector<Change> done;
    std::optional<Change> underWay;
    int lines = 0;
};

class MarkingKillTest : public MarkingTest {
  protected:
    fs::path folder_ = [] {
        const char* given = std::getenv("HANDPIECE_KILL_FOLDER");
        return given ? fs::path(given) : fs::path();
    }();
    [[nodiscard]] fs::path root() const override { return folder_; }
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options options = ShellTest::options();
        options.folders.settingsFile = folder_ / "handpiece.ini";
        options.folders.sessions = folder_ / "data" / "sessions";
        return options;
    }
    [[nodiscard]] fs::path toldFile(const std::string& marker) const { return folder_ / ("told-" + marker); }
    [[nodiscard]] Told told(const std::string& marker) const {
        Told told;
        std::ifstream in(toldFile(marker));
        for (std::string line; std::getline(in, line);) {
            if (in.eof()) break;  // cut short
            ++told.lines;
            std::istringstream words(line);
            std::string state;
            Change change;
            words >> state >> change.what >> change.code >> change.criterion >> change.points >> change.number;
            if (state == "begun") told.underWay.reset();
            if (state == "will") told.underWay = change;
            if (state == "did") {
                told.done.push_back(*told.underWay);
                told.underWay.reset();
            }
        }
        return told;
    }
    /// Tells of a change before and after it.
    template <class Do>
    void change(const std::string& marker, const Change& c, Do&& make) {
        std::ofstream out(toldFile(marker), std::ios::app);
        out << "will " << c.what << ' ' << c.code << ' ' << c.criterion << ' ' << c.points << ' ' << c.number
            << std::endl;
        make();
        out << "did" << std::endl;
    }
    void waitUntilOpen(const std::string& code) {
        ASSERT_TRUE(waitFor([&] {
            return !simulator().isBusy() && part<SheetPanel>("markingSheet")->code().toStdString() == code &&
                   (simulator().mode() == Simulator::Mode::review || simulator().mode() == Simulator::Mode::replay);
        }));
    }
    /// Whether the desk holds what this change made.
    [[nodiscard]] testing::AssertionResult holds(const Change& c) {
        const marking::Sheet& sheet = desk().sheet(c.code);
        if (c.what == "override") {
            const auto found = sheet.overrides.find(c.criterion);
            if (found == sheet.overrides.end() || found->second.points != c.points ||
                found->second.reason != "reason " + std::to_string(c.number))
                return testing::AssertionFailure() << "override " << c.number << " of " << c.code << " is lost";
        } else if (c.what == "mark") {
            const auto found = sheet.marks.find(c.criterion);
            if (found == sheet.marks.end() || (found->second.points.value_or(-1.0) != c.points))
                return testing::AssertionFailure() << "mark " << c.criterion << " of " << c.code << " is lost";
        } else if (c.what == "in") {
            if (!sheet.isIn) return testing::AssertionFailure() << c.code << " is not in";
        } else if (c.what == "decide") {
            if (!sheet.decision || sheet.decision->reason != "reason " + std::to_string(c.number))
                return testing::AssertionFailure() << "decision " << c.number << " is lost";
        } else {
            const std::string text = "comment " + std::to_string(c.number);
            if (std::none_of(sheet.comments.begin(), sheet.comments.end(),
                             [&](const marking::Comment& one) { return one.text == text; }))
                return testing::AssertionFailure() << text << " is lost";
        }
        return testing::AssertionSuccess();
    }
    void overrideOne(const std::string& marker, const std::string& code, int row, int number) {
        chooseCriterion(row);
        const double points = 1.0 + number % 19;
        setPoints(points);
        type("sheetReason", QStringLiteral("reason %1").arg(number));
        change(marker, {"override", code, row == 0 ? "enamel" : "beside", points, number}, [&] { click("sheetSay"); });
    }
    void commentOne(const std::string& marker, const std::string& code, int number) {
        type("sheetComment", QStringLiteral("comment %1").arg(number));
        change(marker, {"comment", code, "-", 0.0, number}, [&] { click("sheetCommentAdd"); });
    }
    void decideOne(const std::string& marker, const std::string& code, int number) {
        auto* box = part<QComboBox>("sheetDecision");
        box->setFocus();
        QTest::keyClick(box, Qt::Key_Home);
        QTest::keyClick(box, Qt::Key_Down);
        type("sheetDecisionReason", QStringLiteral("reason %1").arg(number));
        change(marker, {"decide", code, "-", 0.0, number}, [&] { click("sheetDecide"); });
    }
    void markOne(const std::string& marker, const std::string& code) {
        chooseCriterion(0);
        chooseBand(1);
        change(marker, {"mark", code, "enamel", -1.0, 0}, [&] { click("sheetSay"); });
        chooseCriterion(1);
        setPoints(15);
        change(marker, {"mark", code, "beside", 15.0, 0}, [&] { click("sheetSay"); });
        chooseCriterion(2);
        setPoints(60);
        change(marker, {"mark", code, "total", 60.0, 0}, [&] { click("sheetSay"); });
        change(marker, {"in", code, "-", 0.0, 0}, [&] { click("sheetGiveIn"); });
    }
};

/// Opens work after work and judges it, without end.
TEST_F(MarkingKillTest, DISABLED_MarksUntilItIsKilled) {
    ASSERT_FALSE(folder_.empty());
    const std::string marker = std::getenv("HANDPIECE_KILL_MARKER");
    const bool isBlind = marker != "Tanaka";
    startWithTooth();
    int number = told(marker).lines;
    std::ofstream(toldFile(marker), std::ios::app) << "begun" << std::endl;
    begin(QString::fromStdString(marker), isBlind);
    ASSERT_EQ(window().errorDialog(), nullptr);
    for (;;) {
        openRow(0);
        for (;;) {
            const std::string code = part<SheetPanel>("markingSheet")->code().toStdString();
            waitUntilOpen(code);
            if (HasFatalFailure()) return;
            if (isBlind && !desk().sheet(code).isIn) markOne(marker, code);
            if (desk().machine(code) != nullptr) {
                overrideOne(marker, code, number % 2, number + 1);
                decideOne(marker, code, number + 2);
            }
            commentOne(marker, code, number + 3);
            number += 3;
            if (HasFailure()) return;
            if (!part<QAbstractButton>("sheetNext")->isEnabled()) break;
            click("sheetNext");
        }
        click("sheetTable");
    }
}

TEST_F(MarkingKillTest, NothingIsLostHoweverOftenItIsKilled) {
    QTemporaryDir place;
    folder_ = toPath(place.path());
    makeWork();
    fs::remove(works() / "broken.handpiece");
    host_.reset();
    const char* asked = std::getenv("HANDPIECE_KILLS");
    const int kills = asked ? std::atoi(asked) : 3;
    const char* given = std::getenv("HANDPIECE_TEST_SEED");
    const auto seed = given ? std::strtoull(given, nullptr, 10) : std::random_device{}();
    std::printf("seed %llu, %d kills\n", static_cast<unsigned long long>(seed), kills);
    std::mt19937_64 random(seed);
    std::size_t changes = 0;
    int underWay = 0, arrived = 0, whileScoring = 0;
    for (int i = 0; i < kills; ++i) {
        // One desk that goes on, and by turns a blind one of somebody else.
        const std::string marker = i % 2 == 0 ? "Tanaka" : "B" + std::to_string(i);
        if (random() % 3 == 0) fs::remove_all(works() / ".marking");  // to be scored anew
        const int before = told(marker).lines;
        const pid_t child = fork();
        if (child == 0) {
            ::setenv("HANDPIECE_KILL_FOLDER", folder_.c_str(), 1);
            ::setenv("HANDPIECE_KILL_MARKER", marker.c_str(), 1);
            ::execl("/proc/self/exe", "killed", "--gtest_filter=MarkingKillTest.DISABLED_MarksUntilItIsKilled",
                    "--gtest_also_run_disabled_tests", nullptr);
            ::_exit(127);
        }
        // From when the desk is begun: any moment of what it does then; three of four a moment after some change.
        const bool isAmid = i % 4 != 3;
        const int enough = before + 1 + (isAmid ? std::uniform_int_distribution(1, 40)(random) : 0);
        ASSERT_TRUE(waitFor([&] { return told(marker).lines >= enough || ::waitpid(child, nullptr, WNOHANG) != 0; }));
        const int waitMs = std::uniform_int_distribution(0, isAmid ? 40 : 6000)(random);
        QThread::msleep(static_cast<unsigned long>(waitMs));
        ASSERT_EQ(::kill(child, SIGKILL), 0);
        int status = 0;
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself";
        const Told all = told(marker);
        SCOPED_TRACE(testing::Message() << "kill " << i << " of " << marker << " after " << waitMs << " ms, "
                                        << all.done.size() << " changes");
        whileScoring += all.lines == before + 1 ? 1 : 0;

        startWithTooth();
        EXPECT_TRUE(simulator().crashed().empty()) << "nobody cut";
        begin(QString::fromStdString(marker), marker != "Tanaka");
        ASSERT_EQ(window().errorDialog(), nullptr);
        ASSERT_NE(feature().desk(), nullptr);
        EXPECT_EQ(desk().codes().size(), marker == "Tanaka" ? 3u : 4u);
        for (const std::string& code : desk().codes()) {
            EXPECT_TRUE(desk().isScored(code));
            EXPECT_EQ(desk().problem(code), "");
        }
        // The last of several changes to one place stands; the one under way may, whole, have come in its place.
        std::map<std::string, Change> last;
        std::size_t comments = 0;
        for (const Change& c : all.done) {
            const bool isComment = c.what == "comment";
            comments += isComment ? 1 : 0;
            last[isComment ? "comment " + std::to_string(c.number) : c.what + c.code + c.criterion] = c;
        }
        if (all.underWay) ++underWay;
        for (const auto& [where, c] : last) {
            if (all.underWay && all.underWay->what == c.what && all.underWay->code == c.code &&
                all.underWay->criterion == c.criterion && holds(*all.underWay))
                continue;
            EXPECT_TRUE(holds(c));
        }
        std::size_t held = 0;
        for (const std::string& code : desk().codes())
            held += desk().sheet(code).comments.size();
        const bool isOneMore = all.underWay && all.underWay->what == "comment" && holds(*all.underWay);
        EXPECT_EQ(held, comments + (isOneMore ? 1 : 0));
        if (all.underWay && holds(*all.underWay)) {
            ++arrived;
            std::ofstream(toldFile(marker), std::ios::app) << "did" << std::endl;
        }
        changes += all.done.size();
        simulator().close();
        host_.reset();
    }
    EXPECT_GE(changes, static_cast<std::size_t>(kills)) << "they were killed while they marked";
    int left = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(works()))
        left += entry.path().filename().string().find(".part") != std::string::npos ? 1 : 0;
    std::printf(
        "%zu changes held, %d under way of which %d had arrived, %d killed while scoring, %d files half written\n",
        changes, underWay, arrived, whileScoring, left);
}

}  // namespace
}  // namespace handpiece::desktop::marking_kill_test
