// SPDX-License-Identifier: Apache-2.0
// An exam in the window, with the real server and the real service that holds a station's exams: begun by codes,
// locked, under its clock, killed and come back to, handed over; and what is said when it cannot be.
#include <sys/wait.h>
#include <unistd.h>

#include <QDateTime>
#include <QLineEdit>
#include <QMessageBox>
#include <QThread>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include "desktop/features/school/exam_bar.h"
#include "desktop/features/school/exam_dialog.h"
#include "desktop/features/school/exam_feature.h"
#include "desktop/framework/language.h"
#include "school_support.h"

namespace handpiece::desktop::exam_window_test {
namespace {

namespace fs = std::filesystem;

class ExamWindowTest : public SchoolStation {
  protected:
    void SetUp() override {
        SchoolStation::SetUp();
        // In the program that is killed the other one's.
        socket_ = qEnvironmentVariable("HANDPIECE_EXAM_TEST_SOCKET", own_.filePath("exam.sock"));
        qputenv("HANDPIECE_EXAM_SOCKET", socket_.toLocal8Bit());
    }
    void TearDown() override {
        host_.reset();
        stopService();
        SchoolStation::TearDown();
    }
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options options = SchoolStation::options();
        if (const char* home = std::getenv("HANDPIECE_EXAM_TEST_HOME"))
            options.folders.sessions = fs::path(home) / "sessions";
        return options;
    }
    static QString utc(qint64 fromNowS) {
        return QDateTime::currentDateTimeUtc().addSecs(fromNowS).toString("yyyy-MM-ddTHH:mm'Z'");
    }
    /// Of 30 minutes, with undo, guide and section locked; s017 has a quarter more, 10 minutes for pauses and the scale
    /// bar, which the exercise locks.
    void makeExam(qint64 opensInS = -600, const char* hours = "2", const char* minutes = "30", bool hasMore = true) {
        const QString d = data();
        const QString hash = makeClass(makeExercise("asked", false, {"scale-bar", "chart"}, [](tasks::Task& task) {
            task.minutes = 5.0;
            task.isTimeHard = true;
        }));
        exam_ = school({"exam",    "new",     "--data",      d,         class_,   hash,           "--title",
                        "Class I", "--opens", utc(opensInS), "--hours", hours,    "--minutes",    minutes,
                        "--lock",  "undo",    "--lock",      "guide",   "--lock", "cross-section"});
        candidate_ = school({"exam", "candidates", "--data", d, exam_}).section(' ', 1);
        if (hasMore)
            school({"exam", "candidates", "--data", d, exam_, "--person", "s017", "--extra", "25", "--pause", "10",
                    "--allow", "scale-bar"});
        school({"exam", "invigilator", "--data", d, exam_, "t01"});
        const QStringList sheet = school({"exam", "sheet", "--data", d, exam_}).split('\n').at(0).split(' ');
        pin_ = sheet.value(1), nextPin_ = sheet.value(2);
        school({"exam", "sign", "--data", d, exam_});
        const QString code = school({"code", "--data", d, "--exam", "exam room 1"});
        startServer(1);
        school({"exam", "enrol", address_, code, "--service", folder()});
        school({"exam", "release", "--data", d, "exam room 1"});
        school({"exam", "fetch", "--service", folder()});
    }
    [[nodiscard]] QString folder() const { return toQString(at("service")); }
    void startService() {
        service_ = std::make_unique<QProcess>();
        service_->setProcessChannelMode(QProcess::ForwardedErrorChannel);
        service_->start(toQString(program_), {"exam", "serve", "--service", folder(), "--socket", socket_});
        ASSERT_TRUE(service_->waitForReadyRead(120000));
    }
    void stopService() {
        if (!service_) return;
        service_->terminate();
        if (!service_->waitForFinished(60000)) service_->kill();
        service_.reset();
    }
    [[nodiscard]] ExamFeature& feature() { return *window().findChild<ExamFeature*>(); }
    [[nodiscard]] ExamBar& bar() { return *part<ExamBar>("examBar"); }
    [[nodiscard]] QString text(const char* label) { return part<QLabel>(label)->text(); }
    void type(const char* field, const QString& what) {
        auto* line = part<QLineEdit>(field);
        line->clear();
        QTest::keyClicks(line, what);
    }
    /// Whether what was asked by the button has been answered.
    [[nodiscard]] bool isAnswered() {
        return part<QPushButton>("examNext")->isEnabled() || !text("examProblem").isEmpty();
    }
    void openDialog() {
        ASSERT_TRUE(waitFor([this] { return action("actionBeginExam")->isEnabled(); }));
        action("actionBeginExam")->trigger();
        ASSERT_TRUE(waitFor([this] { return part<ExamDialog>("examDialog")->isVisible(); }));
    }
    void look(const QString& candidate) {
        type("examCandidate", candidate);
        click("examNext");
        ASSERT_TRUE(
            waitFor([this] { return part<QLineEdit>("examPin")->isVisible() || !text("examProblem").isEmpty(); }));
    }
    void confirm(const QString& invigilator, const QString& pin) {
        type("examInvigilator", invigilator);
        type("examPin", pin);
        click("examNext");
    }
    [[nodiscard]] bool isAtWork() {
        return simulator().exam() && simulator().mode() == Simulator::Mode::liveSession && simulator().isRecorded() &&
               !simulator().document().exam.empty() && !simulator().isBusy();
    }
    void beginExam() {
        openDialog();
        look(candidate_);
        confirm("t01", pin_);
        ASSERT_TRUE(waitFor([this] { return isAtWork(); })) << text("examProblem").toStdString();
        view()->showStandardView(view::StandardView::occlusal);
    }
    void handOver() {
        click("examHandOver");
        auto* question = part<QMessageBox>("examHandOverDialog");
        ASSERT_TRUE(question && question->isVisible());
        QTest::mouseClick(part<QPushButton>("examHandOverDialogYes"), Qt::LeftButton);
        ASSERT_TRUE(waitFor([this] { return part<ReceiptDialog>("examReceiptDialog")->isVisible(); }));
        EXPECT_FALSE(simulator().exam());
        EXPECT_FALSE(bar().isVisible());
    }
    [[nodiscard]] qint64 leftS() {
        const QStringList parts = text("examTime").split(':');
        qint64 seconds = 0;
        for (const QString& one : parts)
            seconds = 60 * seconds + one.toInt();
        return seconds;
    }
    /// What the exam's page leads to, once its work was proven.
    [[nodiscard]] QByteArray provenSitting() {
        QByteArray page;
        EXPECT_TRUE(waitFor([&] {
            QTest::qWait(500);
            const QString exam = QString::fromUtf8(asTeacher("/exams/" + exam_));
            const QString id = exam.section("/sittings/", 1, 1).left(32);
            if (id.size() == 32) page = asTeacher("/sittings/" + id);
            return page.contains("proven");
        })) << page.toStdString();
        return page;
    }

    QString socket_, exam_, candidate_, pin_, nextPin_;
    std::unique_ptr<QProcess> service_;
};

TEST_F(ExamWindowTest, IsBegunByCodesHoldsItsLocksAndIsHandedOver) {
    makeExam();
    startService();
    startWithTooth();
    ASSERT_TRUE(waitFor([this] { return !feature().link().isRunning(); }))
        << "nobody is at an exam: nothing runs beside the window";
    makeExercise("other", false);
    openDialog();
    EXPECT_FALSE(part<QPushButton>("examNext")->isEnabled()) << "nothing was typed";
    look("111-222-333-444");
    EXPECT_TRUE(text("examProblem").contains("No exam at this station knows")) << text("examProblem").toStdString();
    look(candidate_);
    EXPECT_EQ(text("examOfferTitle"), "Class I");
    EXPECT_TRUE(text("examOfferWhat").contains("Line asked") && text("examOfferWhat").contains("Cut the line."));
    EXPECT_EQ(text("examOfferTime"), "Time: 47 min 30 s. 25 % more time and 10 min for pauses are in it.");
    EXPECT_TRUE(text("examOfferLocked").contains("Undo, redo, reset") && text("examOfferLocked").contains("Section"));
    EXPECT_FALSE(text("examOfferLocked").contains("Scale bar")) << "which this candidate has";
    EXPECT_FALSE(part<QLabel>("examOfferAgain")->isVisible());
    picture(part<QDialog>("examDialog"), "exam-begin");
    confirm("t01", "ABC-DEF-GHJ-KMN");
    ASSERT_TRUE(waitFor([this] { return !text("examProblem").isEmpty(); }));
    EXPECT_TRUE(text("examProblem").contains("Nobody who may confirm")) << text("examProblem").toStdString();
    EXPECT_FALSE(simulator().exam());
    // Too many of them are made to wait; the exam's own clock says how long.
    for (int i = 0; i < 10 && !text("examProblem").contains("Too many"); ++i) {
        confirm("t01", "ABC-DEF-GHJ-KMN");
        ASSERT_TRUE(waitFor([this] { return !text("examProblem").isEmpty(); }));
    }
    EXPECT_TRUE(text("examProblem").contains("Too many wrong confirmation codes. Wait "))
        << text("examProblem").toStdString();
    ASSERT_TRUE(waitFor([this] {
        QTest::qWait(1000);
        confirm("t01", pin_);
        (void)waitFor([this] { return !text("examProblem").isEmpty() || simulator().exam(); });
        return simulator().exam().has_value();
    }));
    ASSERT_TRUE(waitFor([this] { return isAtWork(); }));
    EXPECT_FALSE(part<QDialog>("examDialog")->isVisible());
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(waitFor([this] { return bar().isVisible() && leftS() > 0; }));
    EXPECT_EQ(text("examTitle"), "Class I");
    const qint64 before = leftS();
    EXPECT_LE(before, 47 * 60 + 30);
    EXPECT_GT(before, 45 * 60);
    ASSERT_TRUE(waitFor([&] { return leftS() < before; }));
    // The exercise, the exam and the candidate have their say, each in its place.
    ASSERT_TRUE(cut());
    const double removed = removedMm3();
    for (const char* name : {"actionUndo", "actionRedo", "actionReset", "actionSection", "actionLandmarks"})
        EXPECT_FALSE(action(name)->isEnabled()) << name;
    simulator().undo();
    simulator().reset();
    EXPECT_TRUE(isTold("help-locked"));
    EXPECT_TRUE(simulator().permissions().allows(exercise::Operation::scaleBar));
    EXPECT_TRUE(simulator().permissions().locks(exercise::Operation::guidance));
    EXPECT_TRUE(action("actionMeasure")->isEnabled()) << "what is not locked is there";
    EXPECT_TRUE(text("exerciseLocked").contains("Undo, redo, reset"));
    EXPECT_FALSE(part<QPushButton>("exerciseFinish")->isVisible());
    EXPECT_FALSE(simulator().isTimeOver()) << "the exercise's own five minutes are not the exam's";
    // No other work, by whatever way.
    for (const char* name : {"actionOpenCase",      "actionOpenStl",     "actionResume",        "actionSave",
                             "actionSaveAs",        "actionExportStl",   "actionExportTissues", "actionPicture",
                             "actionReport",        "actionRecover",     "actionOpenSession",   "actionReplay",
                             "actionKeepRecording", "actionExercises",   "actionFinish",        "actionResult",
                             "actionProgress",      "actionCode",        "actionHandIn",        "actionNewExercise",
                             "actionEditExercise",  "actionMarkingDesk", "actionNewScan",       "actionChooseTooth",
                             "actionSharePractice", "actionBeginExam"}) {
        EXPECT_FALSE(action(name)->isEnabled()) << name;
        EXPECT_EQ(action(name)->toolTip(), "Not in this exam.") << name;
    }
    const std::string sitting = simulator().document().exam;
    const auto isStillHere = [&] { return simulator().document().exam == sitting && isAtWork(); };
    window().openFile(toQString(at("exercises") / "other"));
    EXPECT_TRUE(isStillHere());
    EXPECT_TRUE(isTold("exam-runs"));
    drop(toQString(at("exercises") / "other"));
    openTooth(11);
    simulator().open(simulator().recording());
    simulator().openExercise(at("exercises") / "other");
    simulator().review(at("exercises") / "other");
    simulator().replayThis();
    simulator().finish();
    simulator().saveAs(at("mine.handpiece"));
    simulator().handIn(at("mine.handpiece"));
    simulator().exportStl(at("mine.stl"));
    simulator().copyRecording(at("mine.h5"));
    simulator().setCode("mine");
    EXPECT_TRUE(isStillHere());
    EXPECT_FALSE(core::isThere(at("mine.handpiece")) || core::isThere(at("mine.stl")) || core::isThere(at("mine.h5")));
    EXPECT_EQ(asked_, 0) << "nobody is asked about unsaved work that cannot be left";
    EXPECT_EQ(removedMm3(), removed);
    // A pause covers the picture, and the pedal is dead.
    click("examPause");
    EXPECT_TRUE(part<QLabel>("examCover")->isVisible());
    QTest::qWait(200);
    press(300);
    EXPECT_EQ(removedMm3(), removed);
    QTest::qWait(1000);  // the pedal comes up
    click("examPause");
    EXPECT_FALSE(part<QLabel>("examCover")->isVisible());
    picture(&window(), "exam-window");
    // The window is asked to close, and stays.
    bool asked = false;
    feature().mayClose = [&] {
        asked = true;
        return false;
    };
    window().close();
    EXPECT_TRUE(asked && window().isVisible());
    // In another language, without losing anything.
    window().languageChosen("ja");
    ASSERT_TRUE(waitFor([this] { return action("actionUndo") && action("actionUndo")->text() == "元に戻す"; }));
    ASSERT_TRUE(waitFor([this] { return bar().isVisible() && leftS() > 0; }));
    EXPECT_TRUE(isStillHere());
    EXPECT_EQ(removedMm3(), removed);
    picture(&window(), "exam-window-ja");
    window().languageChosen("en");
    ASSERT_TRUE(waitFor([this] { return action("actionUndo") && action("actionUndo")->text() == "Undo"; }));
    window().questions.fileToSave = [this](const QString&, const QString&, const QString&) { return file_; };
    ASSERT_TRUE(waitFor([this] { return bar().isVisible() && leftS() > 0; }));
    // Asked once; whoever says no goes on.
    click("examHandOver");
    QTest::mouseClick(part<QPushButton>("examHandOverDialogNo"), Qt::LeftButton);
    ASSERT_TRUE(waitFor([this] { return part<QMessageBox>("examHandOverDialog") == nullptr; }));
    EXPECT_TRUE(isStillHere());
    handOver();
    // Nothing of it stays open, and nothing of its worth is told.
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    EXPECT_TRUE(simulator().document().exam.empty());
    EXPECT_TRUE(action("actionOpenCase")->isEnabled());
    EXPECT_TRUE(store().attempts().empty());
    EXPECT_TRUE(simulator().crashed().empty());
    EXPECT_FALSE(result().isVisible());
    // The school's receipt comes, and can be kept and checked.
    auto* receipt = part<ReceiptDialog>("examReceiptDialog");
    ASSERT_TRUE(waitFor([&] { return receipt->text().startsWith("handpiece exam receipt"); }))
        << receipt->text().toStdString();
    picture(receipt, "exam-receipt");
    file_ = own_.filePath("receipt.txt");
    click("examReceiptSave");
    ASSERT_TRUE(QFile::exists(file_));
    EXPECT_TRUE(school({"verify-receipt", file_, "--server", address_}).contains("to be confirmed"));
    click("examReceiptClose");
    // The server's books: proven, with nothing that was locked used.
    const QByteArray page = provenSitting();
    EXPECT_TRUE(page.contains("Nothing stands out.")) << page.toStdString();
}

/// Begins the exam, cuts, and says so, until it is killed.
TEST_F(ExamWindowTest, DISABLED_SitsUntilItIsKilled) {
    candidate_ = qEnvironmentVariable("HANDPIECE_EXAM_TEST_CANDIDATE");
    pin_ = qEnvironmentVariable("HANDPIECE_EXAM_TEST_PIN");
    startWithTooth();
    beginExam();
    ASSERT_TRUE(cut());
    const double now = removedMm3();
    // The stretch after it is in the file, and so it is.
    const std::uint64_t tick = simulator().status().ticks + 2000;
    ASSERT_TRUE(waitFor([&] { return simulator().status().recording.writtenRecords > tick; }));
    std::ofstream(fs::path(std::getenv("HANDPIECE_EXAM_TEST_HOME")) / "told.txt") << now << std::endl;
    for (;;)
        QTest::qWait(1000);
}

TEST_F(ExamWindowTest, AWindowThatIsKilledComesBackIntoTheExam) {
    makeExam();
    startService();
    const fs::path home = at("data");
    fs::create_directories(home);
    const QString candidate = candidate_, pin = pin_, socket = socket_;
    const pid_t child = fork();
    if (child == 0) {
        ::setenv("HANDPIECE_EXAM_TEST_HOME", home.c_str(), 1);
        ::setenv("HANDPIECE_EXAM_TEST_SOCKET", qPrintable(socket), 1);
        ::setenv("HANDPIECE_EXAM_TEST_CANDIDATE", qPrintable(candidate), 1);
        ::setenv("HANDPIECE_EXAM_TEST_PIN", qPrintable(pin), 1);
        ::execl("/proc/self/exe", "killed", "--gtest_filter=ExamWindowTest.DISABLED_SitsUntilItIsKilled",
                "--gtest_also_run_disabled_tests", nullptr);
        ::_exit(127);
    }
    double told = 0.0;
    ASSERT_TRUE(
        waitFor([&] { return ::waitpid(child, nullptr, WNOHANG) != 0 || (std::ifstream(home / "told.txt") >> told); }));
    ASSERT_GT(told, 0.0) << "it ended by itself";
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    ::waitpid(child, nullptr, 0);
    // The exam goes on without anybody, and the window comes back into it by itself.
    start();
    ASSERT_TRUE(waitFor([this] { return isAtWork(); }));
    EXPECT_GE(removedMm3(), told - 1e-6);
    EXPECT_FALSE(isTold("crashed")) << "it is no crash that one may give up";
    EXPECT_FALSE(action("actionUndo")->isEnabled());
    EXPECT_FALSE(action("actionOpenCase")->isEnabled());
    ASSERT_TRUE(waitFor([this] { return bar().isVisible() && leftS() > 0; }));
    const QString status = school({"exam", "status", "--socket", socket_});
    const qint64 minutes = status.section('(', 1).section(' ', 0, 0).toInt();
    EXPECT_NEAR(static_cast<double>(leftS()), 60.0 * static_cast<double>(minutes) + 30.0, 40.0)
        << "from when the service has it begun: " << status.toStdString();
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(cut());
    const double removed = removedMm3();
    // The service goes for a while: the work goes on, and the window says so.
    stopService();
    ASSERT_TRUE(waitFor([this] { return text("examTrouble").contains("does not answer"); }));
    EXPECT_TRUE(isAtWork());
    click("examHandOver");
    QTest::mouseClick(part<QPushButton>("examHandOverDialogYes"), Qt::LeftButton);
    ASSERT_TRUE(waitFor([this] { return part<QMessageBox>("examHandOverDialog") == nullptr; }));
    ASSERT_TRUE(waitFor([this] { return window().errorDialog() != nullptr; }));
    EXPECT_TRUE(window().errorDialog()->text().contains("does not answer"));
    window().errorDialog()->accept();
    ASSERT_TRUE(waitFor([this] { return isAtWork(); }));
    EXPECT_GE(removedMm3(), removed - 1e-6) << "what could not be handed over is still there";
    startService();
    ASSERT_TRUE(waitFor([this] { return text("examTrouble").isEmpty(); }));
    handOver();
    const QByteArray page = provenSitting();
    // One recording, which goes on where it was cut off; the service that was started again shows.
    EXPECT_TRUE(page.contains("started again 1 times")) << page.toStdString();
    EXPECT_FALSE(page.contains("recording 1") || page.contains("recording 2")) << page.toStdString();
}

TEST_F(ExamWindowTest, SaysWhyItCannotBegin) {
    startWithTooth();
    openDialog();
    look("123-456-789-ABC");
    EXPECT_EQ(
        text("examProblem"),
        "The service that holds this station's exams does not answer. Call the invigilator: it is started on this "
        "computer by its own user.");
    click("examCancel");
    EXPECT_FALSE(feature().link().isRunning());
    makeExam(2 * 3600);
    startService();
    openDialog();
    look(candidate_);
    EXPECT_TRUE(text("examProblem").startsWith("This exam begins ")) << text("examProblem").toStdString();
    EXPECT_FALSE(text("examProblem").contains("UTC")) << "it is told in this place's time";
    // In Japanese as well.
    click("examCancel");
    window().languageChosen("ja");
    ASSERT_TRUE(waitFor(
        [this] { return action("actionBeginExam") && action("actionBeginExam")->text() == "試験を始める..."; }));
    openDialog();
    look(candidate_);
    EXPECT_TRUE(text("examProblem").startsWith("この試験の開始は")) << text("examProblem").toStdString();
    look("1");
    EXPECT_TRUE(text("examProblem").startsWith("この端末の試験に")) << text("examProblem").toStdString();
    picture(part<QDialog>("examDialog"), "exam-problem-ja");
    click("examCancel");
    window().languageChosen("en");
    ASSERT_TRUE(
        waitFor([this] { return action("actionBeginExam") && action("actionBeginExam")->text().startsWith("Begin"); }));
}

TEST_F(ExamWindowTest, AfterItsTimeNothingBeginsAndAtItsEndTheTimeIsToldOnce) {
    // A minute of time, and one or so in which it can be begun.
    makeExam(-270, "0.1", "1", false);
    startService();
    startWithTooth();
    beginExam();
    EXPECT_FALSE(part<QPushButton>("examPause")->isVisible()) << "this candidate has no minutes for it";
    ASSERT_TRUE(cut());
    ASSERT_TRUE(waitFor([this] { return part<QMessageBox>("examOverDialog") != nullptr; }));
    EXPECT_TRUE(part<QMessageBox>("examOverDialog")->text().contains("time of this exam is over"));
    QTest::mouseClick(part<QPushButton>("examOverDialogNo"), Qt::LeftButton);
    ASSERT_TRUE(waitFor([this] { return part<QMessageBox>("examOverDialog") == nullptr; }));
    ASSERT_TRUE(waitFor([this] { return text("examTime").startsWith("over by 00:0"); }))
        << text("examTime").toStdString();
    const double removed = removedMm3();
    ASSERT_TRUE(cut()) << "nothing is taken away";
    EXPECT_GT(removedMm3(), removed);
    EXPECT_EQ(part<QMessageBox>("examOverDialog"), nullptr) << "it is told once";
    handOver();
    click("examReceiptClose");
    openDialog();
    ASSERT_TRUE(waitFor([this] {
        look(candidate_);
        if (!part<QLineEdit>("examPin")->isVisible()) return true;
        EXPECT_TRUE(text("examOfferAgain").contains("1 times")) << "that it was begun before shows";
        click("examBack");
        QTest::qWait(2000);
        return false;
    }));
    EXPECT_TRUE(text("examProblem").startsWith("This exam could be begun until ")) << text("examProblem").toStdString();
}

TEST_F(ExamWindowTest, WhatAnInvigilatorGivesUpIsOver) {
    makeExam();
    startService();
    startWithTooth();
    beginExam();
    school({"exam", "give-up", "--socket", socket_, "--invigilator", "t01"}, nextPin_.toUtf8() + "\n");
    ASSERT_TRUE(waitFor([this] { return part<ReceiptDialog>("examReceiptDialog")->isVisible(); }));
    EXPECT_TRUE(text("examReceiptTitle").contains("given up")) << text("examReceiptTitle").toStdString();
    EXPECT_FALSE(simulator().exam());
    ASSERT_TRUE(waitFor([this] { return action("actionOpenCase")->isEnabled(); }));
}

TEST(ExamBars, TellTimeAsAClockDoes) {
    EXPECT_EQ(ExamBar::timeText(0), "00:00");
    EXPECT_EQ(ExamBar::timeText(1), "00:01") << "some of it is left";
    EXPECT_EQ(ExamBar::timeText(59'999), "01:00");
    EXPECT_EQ(ExamBar::timeText(47 * 60'000 + 30'000), "47:30");
    EXPECT_EQ(ExamBar::timeText(3'600'000), "1:00:00");
    EXPECT_EQ(ExamBar::timeText(-65'000), "01:05");
    EXPECT_EQ(durationWords(2'850'000), "47 min 30 s");
    EXPECT_EQ(durationWords(1'800'000), "30 min");
    EXPECT_EQ(allowanceWords(0, 0), "");
    EXPECT_EQ(allowanceWords(25, 0), "25 % more time is in it.");
    EXPECT_EQ(localClock("not a time UTC"), "not a time UTC");
    EXPECT_NE(localClock("2026-11-26 15:08 UTC"), "2026-11-26 15:08 UTC");
}

}  // namespace
}  // namespace handpiece::desktop::exam_window_test
