// SPDX-License-Identifier: Apache-2.0
// The first minute: what is seen, touched and said before a tooth can be cut, and after a program that was killed.
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QTextBrowser>
#include <fstream>

#include "desktop/features/drill/bur_list.h"
#include "desktop/features/drill/welcome_strip.h"
#include "desktop/features/view/guide_dialog.h"
#include "desktop/widgets/notice_bar.h"
#include "desktop/work/session_shelf.h"
#include "shell_support.h"

namespace handpiece::desktop::first_minute_window_test {
namespace {

namespace fs = std::filesystem;

class FirstMinute : public ShellTest {
  protected:
    [[nodiscard]] Simulator::Options options() const override {
        Simulator::Options mine = ShellTest::options();
        if (roomBytes_ > 0) mine.shelf.roomBytes = roomBytes_;
        mine.voxelUm = voxelUm_;
        return mine;
    }
    [[nodiscard]] WelcomeStrip* welcome() { return window().findChild<WelcomeStrip*>(); }
    [[nodiscard]] NoticeBar* notices() { return window().findChild<NoticeBar*>(); }
    void moveTo(const QPointF& place) {
        QMouseEvent move(QEvent::MouseMove, place, view()->mapToGlobal(place), Qt::NoButton, Qt::NoButton,
                         Qt::NoModifier);
        QApplication::sendEvent(view(), &move);
    }
    void orbit() {
        const QPoint from = view()->rect().center();
        QTest::mousePress(view(), Qt::RightButton, Qt::NoModifier, from);
        const QPointF to = from + QPointF(60, 20);
        QMouseEvent move(QEvent::MouseMove, to, view()->mapToGlobal(to), Qt::NoButton, Qt::RightButton, Qt::NoModifier);
        QApplication::sendEvent(view(), &move);
        QTest::mouseRelease(view(), Qt::RightButton, Qt::NoModifier, to.toPoint());
    }
    /// A recording whose program was killed.
    [[nodiscard]] fs::path leaveWork() const {
        SessionShelf shelf(at("data/sessions"));
        const fs::path session = shelf.begin({"case", "Molar", "", true});
        std::ofstream(session) << "x";
        shelf.leave();
        return session;
    }
    std::uint64_t roomBytes_ = 0;
    int voxelUm_ = 100;
};

TEST_F(FirstMinute, AToothIsTouchedWhileItIsStillPreparedAndNotCut) {
    voxelUm_ = 20;  // takes seconds
    cases::Case egg = eggTooth(46);
    cases::writeCase(egg, at("egg"));
    CommandLine line;
    line.file = own_.filePath("egg");
    start(line);
    EXPECT_TRUE(welcome()->isHidden()) << "nothing can be done yet";
    ASSERT_TRUE(waitFor([this] { return simulator().touch() != nullptr || !simulator().isBusy(); }));
    ASSERT_NE(simulator().touch(), nullptr);
    EXPECT_EQ(simulator().mode(), Simulator::Mode::empty);
    EXPECT_TRUE(welcome()->isHidden());
    const auto feed = simulator().touch()->session->subscribe();
    view()->showStandardView(view::StandardView::occlusal);
    const QPoint middle = view()->rect().center();
    moveTo(middle);
    QTest::mousePress(view(), Qt::LeftButton, Qt::NoModifier, middle);
    double mostN = 0.0, pedal = 0.0, removedMm3 = 0.0;
    const auto look = [&] {
        const messages::HapticSample& now = feed->read();
        mostN = std::max(mostN, core::toVec(now.forceN).norm());
        pedal = std::max(pedal, now.pedal);
        for (const double mm3 : now.removedMm3)
            removedMm3 += mm3;
        return mostN > 0.2;
    };
    EXPECT_TRUE(waitFor([&] { return look() || simulator().touch() == nullptr; }));
    EXPECT_GT(mostN, 0.2) << "it is felt";
    EXPECT_EQ(pedal, 0.0);
    EXPECT_EQ(removedMm3, 0.0) << "and not cut";
    EXPECT_EQ(notices()->current(), "only-touch");
    QTest::mouseRelease(view(), Qt::LeftButton, Qt::NoModifier, middle);
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::liveSession; }));
    EXPECT_EQ(simulator().touch(), nullptr);
    EXPECT_NE(notices()->current(), "only-touch");
    EXPECT_FALSE(welcome()->isHidden()) << "now it can be done";
    EXPECT_EQ(ShellTest::removedMm3(), 0.0);
    EXPECT_FALSE(simulator().isUnsaved());
    ASSERT_TRUE(cut());
}

TEST_F(FirstMinute, AStepCountsOnlyWhenAPersonDidIt) {
    using Step = WelcomeStrip::Step;
    startWithTooth();
    for (const char* name : {"actionViewBuccal", "actionFit", "actionGoToBur", "actionViewOcclusal"})
        action(name)->trigger();
    const std::uint64_t tick = simulator().sample().tick;
    ASSERT_TRUE(waitFor([&] { return simulator().sample().tick > tick + 500; }));
    EXPECT_TRUE(welcome()->done().empty()) << welcome()->done().size();
    EXPECT_TRUE(welcome()->findChild<QLabel*>("welcomeCount")->text().startsWith("1"));
    moveTo(view()->rect().center());
    EXPECT_TRUE(waitFor([&] { return welcome()->done().count(Step::hover) == 1; }));
    orbit();
    EXPECT_EQ(welcome()->done(), (std::set<Step>{Step::hover, Step::orbit}));
    const QPointF middle = view()->rect().center();
    QWheelEvent wheel(middle, view()->mapToGlobal(middle), {}, {0, 120}, Qt::NoButton, Qt::NoModifier,
                      Qt::NoScrollPhase, false);
    QApplication::sendEvent(view(), &wheel);
    EXPECT_EQ(welcome()->done().count(Step::zoom), 1u);
    // Seen again from the menu, from the first.
    for (const Step step : {Step::cut, Step::undo})
        welcome()->markDone(step);
    EXPECT_TRUE(welcome()->isHidden());
    action("actionFirstSteps")->trigger();
    EXPECT_FALSE(welcome()->isHidden());
    EXPECT_TRUE(welcome()->done().empty());
}

TEST_F(FirstMinute, TheStripLiesBelowTheCrownAndOverNoCorner) {
    startWithTooth();
    for (const QSize size : {QSize(1000, 700), QSize(1366, 768)}) {
        window().resize(size);
        QApplication::processEvents();
        const QRect strip = welcome()->geometry();
        EXPECT_TRUE(view()->rect().contains(strip));
        EXPECT_GT(strip.top(), view()->height() / 2);
    }
}

TEST_F(FirstMinute, ASketchIsTurnedAndTheEyeStays) {
    startWithTooth();
    const auto tooth = simulator().tooth();
    view()->clearTooth();
    view()->showSketch(eggTooth(46));
    const view::Camera first = view()->camera();
    orbit();
    const view::Camera turned = view()->camera();
    EXPECT_NE(first.eyeMm, turned.eyeMm);
    view()->showSketch(eggTooth(46));
    EXPECT_EQ(view()->camera().eyeMm, turned.eyeMm);
    view()->clearTooth();
    view()->setTooth(tooth, simulator().toothCase(), nullptr);
    EXPECT_EQ(view()->camera().eyeMm, turned.eyeMm);
    view()->clearTooth();
    view()->showSketch(eggTooth(46));
    EXPECT_EQ(view()->camera().eyeMm, first.eyeMm) << "another one is seen as ever";
}

TEST_F(FirstMinute, WithoutRoomTheWorkThatWasLeftIsOfferedAndKept) {
    (void)leaveWork();
    roomBytes_ = std::uint64_t{1} << 60;
    startWithTooth();
    EXPECT_EQ(notices()->current(), "crashed-no-room");
    const QString said = notices()->findChild<QLabel*>("noticeText")->text();
    EXPECT_TRUE(said.contains("Molar") && said.contains("MB") && said.contains("sessions")) << qPrintable(said);
    emit notices()->remedyChosen("crashed-no-room");
    EXPECT_FALSE(simulator().isBusy());
    EXPECT_EQ(notices()->current(), "crashed-no-room");
    EXPECT_EQ(simulator().crashed().size(), 1u);
}

TEST_F(FirstMinute, OnAFullDiskWorkThatWasLeftIsStillFound) {
    const fs::path session = leaveWork();
    // As a killed program leaves it.
    std::ofstream(fs::path(session).replace_extension(".lock")) << "999999\nhandpiece\n"
                                                                << qPrintable(QSysInfo::machineHostName()) << "\n";
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit none{0, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &none), 0);
    SessionShelf shelf(at("data/sessions"));
    const std::size_t found = shelf.crashed().size();
    std::string id;
    try {
        shelf.goOn(session);
    } catch (const core::Error& error) {
        id = error.id();
    }
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(found, 1u);
    EXPECT_TRUE(id == "no-space" || id == "not-writable") << id << ": a plain word, not that its place is taken";
    EXPECT_EQ(shelf.crashed().size(), 1u);
}

TEST_F(FirstMinute, ARecordingIsCalledByItsToothAndTime) {
    startWithTooth();
    ASSERT_TRUE(cut());
    action("actionReplay")->trigger();
    ASSERT_TRUE(waitFor([this] { return simulator().mode() == Simulator::Mode::replay; }));
    EXPECT_FALSE(window().windowTitle().contains(".h5")) << qPrintable(window().windowTitle());
    EXPECT_TRUE(window().windowTitle().contains("molar")) << qPrintable(window().windowTitle());
    simulator().closeReplay();
    ASSERT_TRUE(idle());
}

TEST_F(FirstMinute, AnOwnBurStandsOnceUnderItsFileOrItsName) {
    BurModel burs;
    instrument::CatalogueEntry entry;
    entry.name = "/burs/mine.stl";
    burs.addOwn(entry, {});
    EXPECT_EQ(burs.rowOf("mine.stl"), 0) << "as a recording names it";
    entry.name = "mine.stl";
    burs.addOwn(entry, {});
    EXPECT_EQ(burs.rowCount(), 1);
    entry.name = "/other/mine.stl";
    EXPECT_EQ(burs.rowOf("other.stl"), -1);
}

TEST_F(FirstMinute, HelpLeadsToTheGuide) {
    start();
    for (const char* language : {"en", "ja"}) {
        GuideDialog guide(language);
        EXPECT_GT(guide.findChild<QListWidget*>("guideChapters")->count(), 2) << language;
    }
    action("actionGuide")->trigger();
    auto* guide = window().findChild<GuideDialog*>();
    ASSERT_NE(guide, nullptr);
    EXPECT_FALSE(guide->findChild<QTextBrowser*>("guideText")->toPlainText().contains("!["));
    auto* words = guide->findChild<QLineEdit*>("guideSearch");
    QTest::keyClicks(words, "Distance");
    QTest::keyClick(words, Qt::Key_Return);
    EXPECT_EQ(guide->findChild<QTextBrowser*>("guideText")->textCursor().selectedText(), "Distance");
    words->setText("no such words anywhere");
    QTest::keyClick(words, Qt::Key_Return);
    EXPECT_FALSE(guide->findChild<QLabel*>("guideSaid")->text().isEmpty());
    guide->close();
    ASSERT_TRUE(idle());
}

}  // namespace
}  // namespace handpiece::desktop::first_minute_window_test
