// SPDX-License-Identifier: Apache-2.0
// What people do with any window: letters of menus, another language in the middle, the pointer over the panels, a
// crash.
#include <QCheckBox>
#include <QComboBox>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QProcess>
#include <QRegularExpression>

#include <set>

#include "desktop/features/drill/drill_bar.h"
#include "desktop/features/measure/measure_box.h"
#include "desktop/framework/mnemonics.h"
#include "desktop/picture/measuring.h"
#include "practice_support.h"

namespace handpiece::desktop::window_habits_test {
namespace {

class WindowHabits : public PracticeTest {
  protected:
    /// Of what is seen in it, each with a letter that no other has.
    void expectLetters(const QList<QAction*>& entries, const QString& where, bool isJapanese) {
        static const QRegularExpression letter(QStringLiteral("(?<!&)&([^&])"));
        QSet<QChar> taken;
        for (const QAction* action : entries) {
            if (action->isSeparator() || !action->isVisible()) continue;
            const auto found = letter.match(action->text());
            EXPECT_TRUE(found.hasMatch()) << qPrintable(where) << ": " << qPrintable(action->text());
            if (!found.hasMatch()) continue;
            const QChar c = found.captured(1).front().toUpper();
            EXPECT_TRUE(c.unicode() < 128 && c.isLetterOrNumber()) << qPrintable(action->text());
            EXPECT_FALSE(taken.contains(c)) << qPrintable(where) << ": " << qPrintable(action->text());
            taken.insert(c);
            const QString plain = withoutMnemonic(action->text());
            const bool isLatin =
                std::all_of(plain.begin(), plain.end(), [](QChar one) { return one.unicode() < 0x3000; });
            if (isJapanese && !isLatin) {
                EXPECT_TRUE(action->text().contains(QStringLiteral("(&%1)").arg(c))) << qPrintable(action->text());
            }
        }
    }
    void chooseLanguage(const char* code) {
        action(qPrintable(QStringLiteral("actionLanguage_%1").arg(QLatin1String(code))))->trigger();
        QTest::qWait(50);
        ASSERT_TRUE(idle());
    }
    void moveOverTooth() {
        const QPoint middle = view()->rect().center();
        QMouseEvent move(QEvent::MouseMove, QPointF(middle), view()->mapToGlobal(QPointF(middle)), Qt::NoButton,
                         Qt::NoButton, Qt::NoModifier);
        QApplication::sendEvent(view(), &move);
    }
    [[nodiscard]] core::Quat turnWanted() {
        const auto& turn = view()->hand()->target().orientation;
        return {turn[0], turn[1], turn[2], turn[3]};
    }
    void leavePicture() {
        QEvent leave(QEvent::Leave);
        QApplication::sendEvent(view(), &leave);
    }
};

TEST_F(WindowHabits, EveryMenuGivesEachEntryALetterOfItsOwn) {
    for (const char* language : {"en", "ja"}) {
        SCOPED_TRACE(language);
        const bool isJapanese = language == std::string("ja");
        CommandLine line;
        line.language = QLatin1String(language);
        startWithTooth(line);
        expectLetters(window().menuBar()->actions(), QStringLiteral("menu bar"), isJapanese);
        EXPECT_EQ(window().menuBar()->actions().front()->text(),
                  isJapanese ? QStringLiteral("ファイル(&F)") : QStringLiteral("&File"));
        int menus = 0;
        for (QMenu* menu : window().findChildren<QMenu*>()) {
            if (menu->actions().isEmpty() || menu->objectName().startsWith(QLatin1String("qt_"))) continue;
            // Made anew while they are open, as devices are found.
            if (menu->objectName() == QLatin1String("menuDevice") || menu->objectName() == QLatin1String("menuPedal"))
                continue;
            if (menu->objectName().isEmpty()) continue;  // Qt's own, of what has no room in a bar
            menu->popup(window().mapToGlobal(QPoint(10, 10)));
            QTest::qWait(10);  // what is listed only now has its letters a moment later
            expectLetters(menu->actions(), menu->objectName(), isJapanese);
            menu->close();
            for (const QAction* action : menu->actions())
                EXPECT_FALSE(action->text().contains(QLatin1Char('&'))) << qPrintable(action->text());
            ++menus;
        }
        EXPECT_GE(menus, 12);
    }
}

TEST(Mnemonics, AreReadOutOfATextAndPutIntoOne) {
    EXPECT_EQ(withoutMnemonic(QStringLiteral("Save &as...")), "Save as...");
    EXPECT_EQ(withoutMnemonic(QStringLiteral("保存(&S)...")), QStringLiteral("保存..."));
    EXPECT_EQ(withoutMnemonic(menuText(QStringLiteral("teeth/a&b"))), "teeth/a&b");
    QAction save(QStringLiteral("Save")), saveAs(QStringLiteral("Save as...")), first(QStringLiteral("保存...")),
        second(QStringLiteral("保存")), none(QStringLiteral("aaa")), again(QStringLiteral("aaa"));
    first.setObjectName(QStringLiteral("actionSave"));
    second.setObjectName(QStringLiteral("actionSaveAs"));
    giveMnemonics({&save, &saveAs, &none, &again});
    EXPECT_EQ(save.text(), "&Save");
    EXPECT_EQ(saveAs.text(), "Save &as...");
    EXPECT_TRUE(none.text().contains(QLatin1String("(&"))) << qPrintable(none.text());
    EXPECT_TRUE(again.text().contains(QLatin1String("(&"))) << qPrintable(again.text());
    EXPECT_NE(none.text(), again.text());
    giveMnemonics({&first, &second});
    EXPECT_EQ(first.text(), QStringLiteral("保存(&S)..."));
    EXPECT_EQ(second.text(), QStringLiteral("保存(&A)"));
}

/// Alt+V opens the menu View; V alone is the picture's, and sets the depth stop.
TEST_F(WindowHabits, ALetterWithAltIsTheMenus) {
    startWithTooth();
    window().activateWindow();
    ASSERT_TRUE(QTest::qWaitForWindowActive(&window()));
    view()->setFocus();
    view()->setStop(std::nullopt);
    QTest::keyClick(view(), Qt::Key_V, Qt::AltModifier);
    EXPECT_FALSE(view()->hand()->stopMm());
    QWidget* popup = QApplication::activePopupWidget();
    ASSERT_NE(popup, nullptr);
    EXPECT_EQ(popup->objectName(), "menuView");
    popup->close();
    view()->setFocus();
    QTest::keyClick(view(), Qt::Key_V);
    EXPECT_TRUE(view()->hand()->stopMm());
}

TEST_F(WindowHabits, AnotherLanguageKeepsWhatIsInTheHand) {
    startWithTooth();
    view()->setLoad(1.8);
    view()->setStop(0.7);
    window().findChild<QLineEdit*>("burSearch")->setText(QStringLiteral("round"));
    auto* shape = window().findChild<QComboBox*>("burShape");
    shape->setCurrentIndex(2);
    const QVariant wanted = shape->currentData();
    view()->hand()->roll(0.6);
    ASSERT_TRUE(waitFor([this] { return simulator().sample().tick > 600; }));
    const auto turnOf = [](const messages::HapticSample& s) {
        return core::Quat(s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]);
    };
    ASSERT_TRUE(waitFor(
        [&] { return turnOf(simulator().sample()).angularDistance(simulator().startPose().orientation) > 0.5; }));
    const core::Quat held = turnOf(simulator().sample());
    QTest::qWait(1200);  // it is noted once a second
    for (const char* code : {"ja", "en"}) {
        SCOPED_TRACE(code);
        chooseLanguage(code);
        EXPECT_DOUBLE_EQ(view()->hand()->loadN(), 1.8);
        EXPECT_DOUBLE_EQ(view()->hand()->stopMm().value_or(0.0), 0.7);
        EXPECT_DOUBLE_EQ(window().findChild<MeasureBox*>()->depthStopMm().value_or(0.0), 0.7);
        EXPECT_EQ(window().findChild<QLineEdit*>("burSearch")->text(), "round");
        EXPECT_EQ(window().findChild<QComboBox*>("burShape")->currentData(), wanted);
        EXPECT_LT(turnWanted().angularDistance(held), 0.05);
    }
    // The list of burs is whole again at the next start; load and stop are as they were.
    startWithTooth();
    EXPECT_EQ(window().findChild<QLineEdit*>("burSearch")->text(), QString());
    EXPECT_DOUBLE_EQ(view()->hand()->loadN(), 1.8);
    EXPECT_DOUBLE_EQ(view()->hand()->stopMm().value_or(0.0), 0.7);
}

TEST_F(WindowHabits, ADepthStopThatIsKeptStaysOffWhereAnExerciseHasNone) {
    makeExercise("plain", false, {"guide"});
    startWithTooth();
    view()->setStop(0.7);
    startWithTooth();
    ASSERT_TRUE(view()->hand()->stopMm());
    openExercises();
    begin("plain");
    EXPECT_FALSE(view()->hand()->stopMm());
    EXPECT_FALSE(window().findChild<MeasureBox*>()->depthStopMm());
    openTooth(46);
    ASSERT_TRUE(waitFor([this] {
        return !simulator().task() && simulator().mode() == Simulator::Mode::liveSession && !simulator().isBusy();
    }));
    EXPECT_DOUBLE_EQ(view()->hand()->stopMm().value_or(0.0), 0.7);
}

TEST_F(WindowHabits, TheBurIsLiftedWhenThePointerGoesToThePanels) {
    startWithTooth();
    moveOverTooth();
    EXPECT_FALSE(view()->hand()->isAway());
    leavePicture();
    EXPECT_TRUE(view()->hand()->isAway());
    EXPECT_DOUBLE_EQ(view()->hand()->target().pedal, 0.0);
    moveOverTooth();
    EXPECT_FALSE(view()->hand()->isAway());
    // A foot that stays down is not taken off by a glance at a panel.
    view()->latchPedal(true);
    leavePicture();
    EXPECT_FALSE(view()->hand()->isAway());
    EXPECT_TRUE(view()->hand()->pedalLatched());
    view()->latchPedal(false);
    // Moved by keys it stays where it is: the mouse has no part in it.
    moveOverTooth();
    QTest::keyClick(view(), Qt::Key_Left);
    leavePicture();
    EXPECT_FALSE(view()->hand()->isAway());
}

TEST_F(WindowHabits, ASectionIsSeenFromWhereverItIsLaid) {
    startWithTooth();
    for (const auto& [standard, name] : view::standardViews()) {
        for (const auto direction : {SectionPlace::Direction::buccoLingual, SectionPlace::Direction::mesioDistal,
                                     SectionPlace::Direction::horizontal}) {
            SCOPED_TRACE(std::string(name) + " " + std::to_string(static_cast<int>(direction)));
            view()->showStandardView(standard);
            const view::Camera before = view()->camera();
            SectionPlace place;
            place.direction = direction;
            view()->setSection(place);
            ASSERT_TRUE(view()->section());
            EXPECT_GT(-view()->camera().forward().dot(planeOf(*view()->section()).normal), 0.2);
            EXPECT_NEAR(view()->camera().distanceMm(), before.distanceMm(), 1e-9);
            view()->setSection(std::nullopt);
            EXPECT_LT((view()->camera().eyeMm - before.eyeMm).norm(), 1e-9);
            EXPECT_LT((view()->camera().upward() - before.upward()).norm(), 1e-9);
        }
    }
    // Who has turned it meanwhile keeps that.
    view()->showStandardView(view::StandardView::occlusal);
    view()->setSection(SectionPlace{});
    view::Camera own = view()->camera();
    own.eyeMm += core::Vec3(0.5, 0.0, 0.0);
    view()->setCamera(own);
    view()->setSection(std::nullopt);
    EXPECT_LT((view()->camera().eyeMm - own.eyeMm).norm(), 1e-9);
}

/// An exercise begins turned as the occlusal view is, not half round.
TEST_F(WindowHabits, AnExerciseBeginsTurnedAsTheOcclusalViewIs) {
    makeExercise("turned", false);
    startWithTooth();
    openExercises();
    begin("turned");
    const view::Camera over = view()->camera();
    const auto& start = simulator().toothCase()->exercise->view;
    ASSERT_TRUE(start);
    view::Camera first = over;
    first.eyeMm = start->eyeMm, first.targetMm = start->targetMm, first.up = start->up;
    EXPECT_GT(first.upward().dot(over.upward()), 0.5);
}

/// Not a test of its own: the program that is killed.
TEST_F(WindowHabits, DISABLED_HoldsTheBurAndIsKilled) {
    own_ = QTemporaryDir(qEnvironmentVariable("HANDPIECE_TEST_FOLDER") + "/XXXXXX");
    Simulator::Options mine = options();
    mine.folders.sessions = toPath(qEnvironmentVariable("HANDPIECE_TEST_FOLDER") + "/data/sessions");
    mine.folders.settingsFile = toPath(qEnvironmentVariable("HANDPIECE_TEST_FOLDER") + "/config/handpiece.ini");
    mine.folders.starters = toPath(qEnvironmentVariable("HANDPIECE_TEST_STARTER"));
    host_ = std::make_unique<Host>(*qApp, CommandLine{}, mine);
    window().resize(1000, 700);
    host_->start();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    view()->showStandardView(view::StandardView::occlusal);
    view()->setLoad(1.4);
    view()->setStop(0.6);
    view()->hand()->roll(0.7);
    QTest::qWait(1200);  // it is noted once a second
    ASSERT_TRUE(cut());
    const std::uint64_t soFar = simulator().sample().tick;
    ASSERT_TRUE(waitFor([&] { return simulator().status().recording.writtenRecords > soFar; }));
    const auto& turn = simulator().sample().orientation;
    std::printf("held %.9f %.9f %.9f %.9f\n", turn[0], turn[1], turn[2], turn[3]);
    std::fflush(stdout);
    (void)waitFor([] { return false; });
}

TEST_F(WindowHabits, AfterACrashTheHandHoldsAsBefore) {
    QProcess child;
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    environment.insert("HANDPIECE_TEST_FOLDER", own_.path());
    environment.insert("HANDPIECE_TEST_STARTER", shared().filePath("teeth"));
    child.setProcessEnvironment(environment);
    child.start(QCoreApplication::applicationFilePath(),
                {"--gtest_also_run_disabled_tests", "--gtest_filter=*DISABLED_HoldsTheBurAndIsKilled"});
    QByteArray said;
    const bool holds = waitFor([&] {
        said += child.readAllStandardOutput();
        const auto at = said.indexOf("\nheld ");
        return (at >= 0 && said.indexOf('\n', at + 1) > 0) || child.state() == QProcess::NotRunning;
    });
    child.kill();
    child.waitForFinished();
    ASSERT_TRUE(holds && said.contains("\nheld ")) << said.constData();
    const auto parts = said.mid(said.indexOf("\nheld ") + 6).split('\n').front().split(' ');
    ASSERT_EQ(parts.size(), 4);
    const core::Quat held(parts[0].toDouble(), parts[1].toDouble(), parts[2].toDouble(), parts[3].toDouble());

    startWithTooth();
    EXPECT_DOUBLE_EQ(view()->hand()->loadN(), 1.4);
    EXPECT_DOUBLE_EQ(view()->hand()->stopMm().value_or(0.0), 0.6);
    EXPECT_GT(turnWanted().angularDistance(held), 0.5);
    ASSERT_EQ(simulator().crashed().size(), 1u);
    simulator().recover(simulator().crashed().front());
    ASSERT_TRUE(waitFor([this] {
        return simulator().crashed().empty() && simulator().mode() == Simulator::Mode::liveSession &&
               !simulator().isBusy();
    }));
    EXPECT_DOUBLE_EQ(view()->hand()->loadN(), 1.4);
    EXPECT_DOUBLE_EQ(view()->hand()->stopMm().value_or(0.0), 0.6);
    EXPECT_LT(turnWanted().angularDistance(held), 0.05);
}

}  // namespace
}  // namespace handpiece::desktop::window_habits_test
