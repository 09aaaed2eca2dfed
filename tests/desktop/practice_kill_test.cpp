// SPDX-License-Identifier: Apache-2.0
// A window killed while a student works in it: the work is there on the next start, and no result is lost.
#include <sys/wait.h>
#include <unistd.h>

#include <QPushButton>
#include <QThread>
#include <cstdlib>
#include <fstream>
#include <random>

#include "desktop/features/exercise/practice_feature.h"
#include "desktop/features/exercise/result_dialog.h"
#include "handpiece/app/course/shipped_exercises.h"
#include "handpiece/base/core/file.h"
#include "shell_support.h"

namespace handpiece::desktop::practice_kill_test {
namespace {

namespace fs = std::filesystem;

/// What the killed one has told before it died.
struct Told {
    double removedMm3 = 0.0;  ///< that the recording is known to hold, since it began the exercise last
    int kept = 0;             ///< results that the store has said yes to
    int cuts = 0;
};

class PracticeKillTest : public ShellTest {
  protected:
    fs::path folder_ = [] {
        const char* given = std::getenv("HANDPIECE_KILL_FOLDER");
        return given ? fs::path(given) : fs::path();
    }();
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options options = ShellTest::options();
        options.folders.settingsFile = folder_ / "handpiece.ini";
        options.folders.sessions = folder_ / "data" / "sessions";
        return options;
    }
    [[nodiscard]] school::Store& store() { return *window().findChild<PracticeFeature*>()->store(); }
    [[nodiscard]] bool isAtWork() {
        return simulator().task() && simulator().isRecorded() && simulator().mode() == Simulator::Mode::liveSession &&
               !simulator().isBusy();
    }
    [[nodiscard]] Told told() const {
        Told told;
        std::ifstream in(folder_ / "told.txt");
        for (std::string what; in >> what;) {
            double value = 0.0;
            if (!(in >> value)) break;  // cut short
            if (what == "begun") told.removedMm3 = 0.0;
            if (what == "cut") {
                told.removedMm3 = value;
                ++told.cuts;
            }
            if (what == "kept") {
                told.kept = static_cast<int>(value);
                told.removedMm3 = 0.0;
            }
        }
        return told;
    }
    void tell(const char* what, double value) const {
        std::ofstream out(folder_ / "told.txt", std::ios::app);
        out << what << ' ' << value << std::endl;
    }
};

/// Begins the exercise, cuts, finishes now and then, until it is killed.
TEST_F(PracticeKillTest, DISABLED_WorksUntilItIsKilled) {
    ASSERT_FALSE(folder_.empty());
    startWithTooth();
    for (;;) {
        window().openFile(toQString(folder_ / "line"));
        ASSERT_TRUE(waitFor([&] { return isAtWork() && removedMm3() == 0.0; }));
        tell("begun", 0.0);
        view()->showStandardView(view::StandardView::occlusal);
        for (int i = 0; i < 3; ++i) {
            ASSERT_TRUE(cut());
            const double now = removedMm3();
            const std::uint64_t written = simulator().status().recording.writtenRecords;
            const std::uint64_t tick = simulator().status().ticks;
            ASSERT_TRUE(
                waitFor([&] { return simulator().status().recording.writtenRecords > std::max(written, tick); }));
            tell("cut", now);
        }
        action("actionFinish")->trigger();
        ASSERT_TRUE(waitFor([&] { return simulator().mode() == Simulator::Mode::replay && !simulator().isBusy(); }));
        tell("kept", static_cast<double>(store().attempts().size()));
    }
}

TEST_F(PracticeKillTest, NothingIsLostHoweverOftenItIsKilled) {
    QTemporaryDir place;
    folder_ = toPath(place.path());
    tasks::Task task = course::blockTask("line", 1);
    task.voxelMm = 0.1;
    task.rubric = rubric::shippedRubricText("dexterity-line");
    tasks::writeTask(task, folder_ / "line");
    const char* asked = std::getenv("HANDPIECE_KILLS");
    const int kills = asked ? std::atoi(asked) : 2;
    const char* given = std::getenv("HANDPIECE_TEST_SEED");
    const auto seed = given ? std::strtoull(given, nullptr, 10) : std::random_device{}();
    std::printf("seed %llu, %d kills\n", static_cast<unsigned long long>(seed), kills);
    std::mt19937_64 random(seed);
    int restored = 0, kept = 0, cuts = 0;
    for (int i = 0; i < kills; ++i) {
        fs::remove(folder_ / "told.txt");
        const pid_t child = fork();
        if (child == 0) {
            ::setenv("HANDPIECE_KILL_FOLDER", folder_.c_str(), 1);
            ::execl("/proc/self/exe", "killed", "--gtest_filter=PracticeKillTest.DISABLED_WorksUntilItIsKilled",
                    "--gtest_also_run_disabled_tests", nullptr);
            ::_exit(127);
        }
        // From when it has begun to work: any moment of what it does then.
        ASSERT_TRUE(waitFor([&] { return fs::exists(folder_ / "told.txt"); }));
        const int waitMs = std::uniform_int_distribution(0, 12000)(random);
        QThread::msleep(static_cast<unsigned long>(waitMs));
        ASSERT_EQ(::kill(child, SIGKILL), 0);
        int status = 0;
        ::waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status)) << "it ended by itself";
        const Told before = told();
        cuts += before.cuts;
        SCOPED_TRACE(testing::Message() << "kill " << i << " after " << waitMs << " ms: " << before.removedMm3
                                        << " mm3, kept " << before.kept);
        startWithTooth();
        const std::vector<school::Attempt> attempts = store().attempts();
        EXPECT_GE(static_cast<int>(attempts.size()), std::max(before.kept, kept));
        for (const school::Attempt& attempt : attempts) {
            EXPECT_FALSE(attempt.result.empty());
            EXPECT_TRUE(attempt.proven);
        }
        const bool isKeptSince = static_cast<int>(attempts.size()) > std::max(before.kept, kept);
        kept = static_cast<int>(attempts.size());
        // Kept just before it could say so: what was told to be cut is in that result.
        if (before.removedMm3 > 0.0 && !isKeptSince) {
            const std::vector<Crashed> crashed = simulator().crashed();
            EXPECT_EQ(crashed.size(), 1u);
            if (!crashed.empty()) {
                simulator().recover(crashed.front());
                EXPECT_TRUE(waitFor([&] { return isAtWork(); }));
                EXPECT_GE(removedMm3(), before.removedMm3 - 1e-6);
                EXPECT_EQ(simulator().task()->id, task.id);
                ++restored;
            }
        }
        simulator().close();
        for (const Crashed& crashed : simulator().crashed())
            simulator().forget(crashed);
        host_.reset();
    }
    std::printf("%d cuts told, brought back %d times, %d results kept\n", cuts, restored, kept);
}

}  // namespace
}  // namespace handpiece::desktop::practice_kill_test
