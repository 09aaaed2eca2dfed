// SPDX-License-Identifier: Apache-2.0
// The window as a station of a school, with a real server beside it: work arrives by itself, is watched only where it
// may be, and a server or a program that is dead or stuck holds nobody up.
#include <QLabel>
#include <csignal>

#include "desktop/features/school/school_feature.h"
#include "school_support.h"

namespace handpiece::desktop::school_window_test {
namespace {

namespace fs = std::filesystem;

class SchoolWindowTest : public SchoolStation {
  protected:
    /// The exercise is the school's, given to a class with one student, who sits here.
    void enrol(const fs::path& exercise) {
        const QString d = data();
        const QString hash = makeClass(exercise);
        school({"assign", "--data", d, class_, hash, "--title", "The line"});
        const QString code = school({"code", "--data", d, "chair 1"});
        startServer();
        school({"enrol", address_, code, "--person", "s017", "--home", toQString(at("data"))});
    }
    [[nodiscard]] SchoolFeature& feature() { return *window().findChild<SchoolFeature*>(); }
    [[nodiscard]] QString note() { return part<QLabel>("schoolNote")->text(); }
    [[nodiscard]] std::size_t arrived() {
        return static_cast<std::size_t>(
            school({"results", "--data", data(), "s017"}).split('\n', Qt::SkipEmptyParts).size());
    }
    /// The program beside, as the window has started it.
    [[nodiscard]] pid_t beside() { return static_cast<pid_t>(feature().link().processId()); }
};

TEST_F(SchoolWindowTest, WorkIsWatchedAndArrivesByItself) {
    const fs::path given = makeExercise("one", false);
    makeExercise("two", false, {}, [](tasks::Task& task) { task.voxelMm = 0.125; });
    enrol(given);
    startWithTooth();
    ASSERT_TRUE(waitFor([this] { return feature().link().standing().isConnected; })) << note().toStdString();
    EXPECT_TRUE(part<QLabel>("schoolNote")->isVisible());
    EXPECT_EQ(note(), "School: connected");
    // A tooth of one's own is nobody's business, nor is an exercise that the school did not give.
    openExercises();
    begin("two");
    QTest::qWait(2 * SchoolFeature::kPeriodMs + 500);
    EXPECT_FALSE(feature().link().standing().isShown);
    EXPECT_TRUE(asTeacher("/classes/" + class_ + "/live").contains("Nobody works"));
    // Shared, it is seen; taken back, it is not.
    ASSERT_TRUE(action("actionSharePractice")->isEnabled());
    action("actionSharePractice")->trigger();
    ASSERT_TRUE(waitFor([this] { return feature().link().standing().isShown; }));
    EXPECT_TRUE(asTeacher("/classes/" + class_ + "/live").contains("(shared practice)"));
    action("actionSharePractice")->trigger();
    ASSERT_TRUE(waitFor([this] { return !feature().link().standing().isShown; }));
    EXPECT_TRUE(asTeacher("/classes/" + class_ + "/live").contains("Nobody works"));
    // What the school gave to do can be watched, and the window says who does.
    openExercises();
    begin("one");
    ASSERT_TRUE(waitFor([this] { return feature().link().standing().isShown; }));
    const QByteArray page = asTeacher("/classes/" + class_ + "/live");
    EXPECT_TRUE(page.contains("Ida Ito") && page.contains("The line") && page.contains("chair 1"));
    ASSERT_TRUE(waitFor([this] { return note() == "School: watched by Dr. Sato"; })) << note().toStdString();
    picture(&window(), "school-watched");
    ASSERT_TRUE(cut());
    // The picture is the window's own.
    const QString station = QString::fromLatin1(page).section("data-station=\"", 1, 1).left(32);
    const QString folder = qEnvironmentVariable("HANDPIECE_TEST_PICTURES");
    QImage shown;
    ASSERT_TRUE(waitFor([&] {
        asTeacher("/classes/" + class_ + "/live/feed");
        const QByteArray jpeg = asTeacher("/live/" + station + "/picture");
        if (!shown.loadFromData(jpeg, "JPEG")) return false;
        if (!folder.isEmpty()) {
            QFile file(folder + "/live.jpg");
            if (file.open(QIODevice::WriteOnly)) file.write(jpeg);
        }
        return true;
    }));
    EXPECT_LE(shown.width(), 480);
    EXPECT_LE(shown.height(), 300);
    const QImage own = view()->picture().scaled(shown.size(), Qt::IgnoreAspectRatio, Qt::SmoothTransformation);
    double apart = 0.0;
    for (int y = 0; y < shown.height(); y += 4)
        for (int x = 0; x < shown.width(); x += 4)
            apart += std::abs(qGray(shown.pixel(x, y)) - qGray(own.pixel(x, y)));
    apart /= static_cast<double>((shown.height() / 4) * (shown.width() / 4));
    EXPECT_LT(apart, 12.0) << "of 255, and the bur has moved on";
    // Looked at alone, it is larger.
    ASSERT_TRUE(waitFor([&] {
        asTeacher("/live/" + station + "/feed");
        QTest::qWait(300);
        return shown.loadFromData(asTeacher("/live/" + station + "/picture"), "JPEG") && shown.height() > 300;
    }));
    finish();
    ASSERT_TRUE(waitFor([this] { return arrived() == 1; })) << note().toStdString();
    ASSERT_TRUE(waitFor([this] { return !feature().link().standing().isShown; })) << "the work is over";
    ASSERT_TRUE(waitFor([this] { return note() == "School: connected"; })) << note().toStdString();
    const QString results = school({"results", "--data", data(), "s017"});
    EXPECT_TRUE(results.startsWith(QString::fromStdString(store().attempts().front().id))) << results.toStdString();
}

TEST_F(SchoolWindowTest, WithoutAServerOrTheProgramTheWindowGoesOn) {
    enrol(makeExercise("one", false));
    startWithTooth();
    ASSERT_TRUE(waitFor([this] { return feature().link().standing().isConnected; }));
    openExercises();
    begin("one");
    ASSERT_TRUE(waitFor([this] { return feature().link().standing().isShown; }));
    // The program beside stands still with its pipe open: what it does not take is left out.
    ASSERT_EQ(kill(beside(), SIGSTOP), 0);
    QElapsedTimer longest, since;
    qint64 worstMs = 0;
    longest.start(), since.start();
    QTimer beat;
    QObject::connect(&beat, &QTimer::timeout, &beat, [&] { worstMs = std::max(worstMs, longest.restart()); });
    beat.start(10);
    ASSERT_TRUE(cut());
    QTest::qWait(3 * SchoolFeature::kPeriodMs);
    beat.stop();
    std::printf("longest the window's thread was away: %lld ms\n", static_cast<long long>(worstMs));
    EXPECT_EQ(simulator().mode(), Simulator::Mode::liveSession);
    ASSERT_EQ(kill(beside(), SIGCONT), 0);
    // The server dies, and the work is finished all the same.
    stopServer();
    ASSERT_TRUE(waitFor([this] { return !feature().link().standing().isConnected; }));
    EXPECT_TRUE(note().contains("not reached")) << note().toStdString();
    finish();
    ASSERT_TRUE(waitFor([this] { return note().contains("waiting to send 1"); })) << note().toStdString();
    picture(&window(), "school-dead");
    // It is back, and everything goes there by itself.
    startServer();
    ASSERT_TRUE(waitFor([this] { return note() == "School: connected"; })) << note().toStdString();
    EXPECT_EQ(arrived(), 1u);
    // The program dies, and comes back with the next tooth.
    ASSERT_EQ(kill(beside(), SIGKILL), 0);
    ASSERT_TRUE(waitFor([this] { return !feature().link().missing().isEmpty(); }));
    EXPECT_TRUE(part<QLabel>("schoolNote")->toolTip().contains("ended"));
    click("resultAgain");
    ASSERT_TRUE(waitFor([this] { return feature().link().standing().isShown; })) << note().toStdString();
}

TEST_F(SchoolWindowTest, WithoutASchoolNothingIsSaid) {
    startWithTooth();
    EXPECT_FALSE(part<QLabel>("schoolNote")->isVisible());
    EXPECT_FALSE(action("actionSharePractice")->isEnabled());
    EXPECT_EQ(beside(), 0);
}

}  // namespace
}  // namespace handpiece::desktop::school_window_test
