// SPDX-License-Identifier: Apache-2.0
// Every window and dialog on the screens of schools: 1366 x 768 with a task bar of 48 pixels at 100, 125, 150 and 200
// %, as the platform's file of screens has it (CMakeLists.txt). Buttons are in sight, what is above them scrolls.
#include <fmt/format.h>
#include <QDialogButtonBox>
#include <QDockWidget>
#include <QMenuBar>
#include <QMessageBox>
#include <QScreen>
#include <QScrollArea>
#include <QTabWidget>
#include <QTimer>

#include "desktop/features/device/first_plug_in.h"
#include "desktop/features/files/mend_dialog.h"
#include "desktop/features/school/exam_dialog.h"
#include "desktop/framework/screen_fit.h"
#include "practice_support.h"

namespace handpiece::desktop::screen_fit_test {
namespace {

bool isScrolled(const QWidget* widget) {
    for (const QWidget* at = widget; !at->isWindow(); at = at->parentWidget())
        if (qobject_cast<const QScrollArea*>(at) != nullptr) return true;
    return false;
}

QRect onScreen(const QWidget& widget) {
    return {widget.mapToGlobal(QPoint(0, 0)), widget.size()};
}

std::string told(const QRect& r) {
    return fmt::format("{}, {}, {} x {}", r.x(), r.y(), r.width(), r.height());
}

class ScreenFitTest : public PracticeTest {
  protected:
    [[nodiscard]] static QRect room() { return roomOn(*QGuiApplication::primaryScreen()); }
    /// At 200 % it is the main window alone that must fit.
    [[nodiscard]] static bool isTiny() { return room().height() < 400; }

    void expectFits(QWidget& window) {
        SCOPED_TRACE(window.objectName().toStdString() + " " + qPrintable(window.windowTitle()));
        picture(&window, qPrintable(QStringLiteral("%1-%2-%3")
                                        .arg(window.objectName(), QLocale().name())
                                        .arg(QGuiApplication::primaryScreen()->size().width())));
        QTest::qWait(30);
        EXPECT_LE(window.width(), room().width()) << window.minimumSizeHint().width();
        if (window.width() > room().width() || window.height() > room().height())
            for (const QWidget* part : window.findChildren<QWidget*>())
                if (part->isVisible() && part->minimumSizeHint().width() > 250)
                    std::cout << "  " << part->metaObject()->className() << ' ' << qPrintable(part->objectName())
                              << ": at least " << part->minimumSizeHint().width() << " x "
                              << part->minimumSizeHint().height() << " min " << part->minimumWidth() << " is "
                              << part->width() << '\n';
        EXPECT_LE(window.height(), room().height()) << window.minimumSizeHint().height();
        const QRect screen = QGuiApplication::primaryScreen()->availableGeometry();
        EXPECT_TRUE(screen.contains(onScreen(window))) << told(onScreen(window)) << " in " << told(screen);
        for (const QPushButton* button : window.findChildren<QPushButton*>()) {
            if (button->window() != &window || !button->isVisible() || isScrolled(button)) continue;
            EXPECT_TRUE(onScreen(window).contains(onScreen(*button))) << qPrintable(button->text());
            EXPECT_TRUE(screen.contains(onScreen(*button))) << qPrintable(button->text());
            EXPECT_GE(button->width(), button->minimumSizeHint().width() - 1) << qPrintable(button->text());
        }
    }
    void expectButtons(QWidget& window, const std::vector<const char*>& names) {
        for (const char* name : names) {
            const auto* button = window.findChild<QPushButton*>(QLatin1String(name));
            ASSERT_NE(button, nullptr) << name;
            EXPECT_TRUE(waitFor([&] { return button->isVisible(); })) << name;
            EXPECT_TRUE(!isScrolled(button)) << name;
        }
    }
    /// Pages of tabs each in turn.
    void expectFitsOnEachPage(QWidget& window) {
        expectFits(window);
        for (QTabWidget* tabs : window.findChildren<QTabWidget*>())
            for (int i = 0; i < tabs->count() && tabs->isVisible(); ++i) {
                tabs->setCurrentIndex(i);
                expectFits(window);
            }
    }
    [[nodiscard]] QDialog* newDialog() {
        for (QWidget* widget : QApplication::topLevelWidgets())
            if (auto* dialog = qobject_cast<QDialog*>(widget); dialog && dialog->isVisible()) return dialog;
        return nullptr;
    }
    /// What the command opens, looked at and closed. One that waits for its answer is looked at from within.
    void expectFitsByCommand(const char* command) {
        SCOPED_TRACE(command);
        bool seen = false;
        const auto look = [&] {
            if (QDialog* dialog = newDialog(); dialog != nullptr && !seen) {
                seen = true;
                expectFitsOnEachPage(*dialog);
                dialog->close();
            }
        };
        QTimer::singleShot(0, &window(), look);
        ASSERT_NE(action(command), nullptr);
        action(command)->trigger();
        ASSERT_TRUE(waitFor([&] {
            look();
            return seen;
        }));
        QTest::qWait(10);
    }
    void expectAllFit(const char* language);
};

void ScreenFitTest::expectAllFit(const char* language) {
    CommandLine line;
    line.language = QLatin1String(language);
    const auto place = makeExercise("small", true);
    startWithTooth(line);
    for (const char* layout : {"actionLayoutPractice", "actionLayoutLaboratory", "actionLayoutPaper"}) {
        SCOPED_TRACE(layout);
        action(layout)->trigger();
        window().resize(MainWindow::firstSize(QGuiApplication::primaryScreen()->availableSize()));
        QTest::qWait(60);
        expectFits(window());
        EXPECT_GT(view()->width(), 100);
        EXPECT_GT(view()->height(), 80);
        EXPECT_TRUE(room().contains(onScreen(*window().menuBar()).translated(0, room().top() - window().y())));
    }
    if (isTiny()) return;
    for (const char* command :
         {"actionChooseTooth", "actionDevicePage", "actionNewExercise", "actionNewScan", "actionMarkingDesk",
          "actionProgress", "actionRadiograph", "actionBindings", "actionAbout", "actionRecover", "actionDeviceNamed"})
        if (action(command) && action(command)->isEnabled()) expectFitsByCommand(command);
    Problem problem = problemById(QStringLiteral("unknown-file"), {}, QString(400, QLatin1Char('x')));
    problem.remedy = QStringLiteral("What to do about it is told at length. ").repeated(30);
    window().showProblem(problem);
    expectFits(*window().errorDialog());
    expectButtons(*window().errorDialog(), {"errorCopy"});
    window().errorDialog()->close();
    {
        FirstPlugIn plugIn(simulator(), false, &window());
        plugIn.show();
        expectFits(plugIn);
        expectButtons(plugIn, {"firstLater", "firstNext"});
        ExamDialog exam(&window());
        exam.show();
        expectFits(exam);
        ExamOffer offer;
        offer.title = QStringLiteral("An exam");
        offer.instructions = QStringLiteral("What to do is told at length. ").repeated(40);
        exam.showOffer(offer);
        exam.showProblem(problem);
        expectFits(exam);
        expectButtons(exam, {"examBack", "examNext", "examCancel"});
    }
    // An exercise from its beginning to its result.
    openExercises();
    chooseInList(language == std::string("ja") ? QStringLiteral("直線") : QStringLiteral("Line small"));
    expectFits(exercises());
    expectButtons(exercises(), {"exercisesBegin"});
    click("exercisesBegin");
    ASSERT_TRUE(waitFor([&] {
        return simulator().task() && simulator().mode() == Simulator::Mode::liveSession && simulator().isRecorded() &&
               !simulator().isBusy();
    }));
    view()->showStandardView(view::StandardView::occlusal);
    ASSERT_TRUE(cut());
    expectFits(window());
    finish();
    expectFits(result());
    // Where one's own judgement is asked for first.
    if (part<QPushButton>("judgeShow")->isVisible()) click("judgeShow");
    ASSERT_TRUE(waitFor([this] { return part<QPushButton>("resultAgain")->isVisible(); }));
    expectFits(result());
    expectButtons(result(), {"resultPage", "resultHandIn", "resultAgain", "resultNext"});
    result().close();
}

TEST_F(ScreenFitTest, EveryWindowFitsInEnglish) {
    expectAllFit("en");
}

TEST_F(ScreenFitTest, EveryWindowFitsInJapanese) {
    expectAllFit("ja");
}

TEST_F(ScreenFitTest, PanelsAreAsTheyWereWhenATinyWindowGrowsAgain) {
    if (room().width() < 1300) GTEST_SKIP() << "the screen has no room to grow into";
    startWithTooth();
    window().resize(1300, 680);
    QTest::qWait(60);
    const auto heights = [this] {
        std::map<std::string, QSize> found;
        for (const QDockWidget* dock : window().findChildren<QDockWidget*>())
            if (dock->isVisible()) found[dock->objectName().toStdString()] = dock->size();
        return found;
    };
    const auto before = heights();
    ASSERT_GT(before.size(), 2u);
    const auto expectAsBefore = [&] {
        QTest::qWait(60);
        for (const auto& [name, size] : heights()) {
            EXPECT_NEAR(size.height(), before.at(name).height(), 6) << name;
            EXPECT_NEAR(size.width(), before.at(name).width(), 6) << name;
        }
    };
    window().resize(420, 330);
    QTest::qWait(60);
    window().resize(1300, 680);
    expectAsBefore();
    // After a restart too: it ended as a tiny one.
    window().resize(420, 330);
    QTest::qWait(60);
    window().rememberAll();
    start();
    window().resize(1300, 680);
    expectAsBefore();
}

}  // namespace
}  // namespace handpiece::desktop::screen_fit_test
